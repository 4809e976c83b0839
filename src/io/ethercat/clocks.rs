//! Distributed clocks: the clocks of the devices settle, SYNC0 begins, and every frame is measured against it.
//! Source: ETG.1000.4 (distributed clocks, registers 0900h to 09A8h); docs of ethercrab 0.7.

use core::time::Duration;

use ethercrab::error::{DistributedClockError, Error};
use ethercrab::std::ethercat_now;
use ethercrab::subdevice_group::{CycleInfo, DcConfiguration, HasDc, NoDc, PreOp, PreOpPdi};
use ethercrab::{DcSync, MainDevice};

use super::link::EtherCatLink;
use super::{Devices, START_CYCLE, at_start};
use crate::io::fieldbus::ClockReading;
use crate::io::fieldbus::bus_fault::BusFault;
use crate::io::fieldbus::description::{ClockDescription, DeviceDescription};

/// Frames until the clocks must agree.
const MAX_SETTLING_FRAMES: u32 = 3_000;
/// Frames from one look at the differences to the next.
const FRAMES_PER_LOOK: u32 = 50;
/// Largest difference of a clock that has settled, ns.
const MAX_DIFFERENCE_NS: u32 = 1_000;
/// Register: difference from the time of the reference clock, ns.
const DIFFERENCE: u16 = 0x092c;
/// Magnitude of the difference in its register; the bit above is the sign.
const MAGNITUDE: u32 = 0x7fff_ffff;
/// From the setting until the first SYNC0: the devices are in safe operation by then.
const START_DELAY: Duration = Duration::from_millis(100);

/// Lets the clocks settle and starts SYNC0.
///
/// # Errors
/// No device has a clock, one that is to have SYNC0 has none, or a clock does not settle.
pub(super) fn synchronise(
    link: &mut EtherCatLink,
    main_device: &MainDevice<'static>,
    mut group: Devices<PreOp, NoDc>,
    (clocks, devices): (ClockDescription, &[DeviceDescription]),
) -> Result<Devices<PreOpPdi, HasDc>, BusFault> {
    for ((mut device, described), place) in group.iter_mut(main_device).zip(devices).zip(1..) {
        if described.sync0 {
            if !device.dc_support().any() {
                return Err(BusFault::NoClock { device: place });
            }
            device.set_dc_sync(DcSync::Sync0);
        }
    }
    let group = link.run(group.into_pre_op_pdi(main_device)).map_err(|error| at_start(&error))?;
    let mut apart = None;
    for frame in 1..=MAX_SETTLING_FRAMES {
        link.run(group.tx_rx_sync_system_time(main_device)).map_err(|error| at_start(&error))?;
        if frame % FRAMES_PER_LOOK == 0 {
            apart = None;
            for ((device, described), place) in group.iter(main_device).zip(devices).zip(1..) {
                let difference = link.run(device.register_read::<u32>(DIFFERENCE)).unwrap_or_default();
                if described.sync0 && difference & MAGNITUDE > MAX_DIFFERENCE_NS {
                    apart = Some(place);
                }
            }
            if apart.is_none() {
                break;
            }
        }
        link.pause(&START_CYCLE);
    }
    if let Some(device) = apart {
        return Err(BusFault::ClockApart { device });
    }
    let sync0_period = Duration::from_micros(clocks.cycle_us.into());
    let sync0_shift = Duration::from_micros(clocks.shift_us().into());
    let configuration = DcConfiguration { start_delay: START_DELAY, sync0_period, sync0_shift };
    link.run(group.configure_dc_sync(main_device, configuration)).map_err(|error| match error {
        Error::DistributedClock(DistributedClockError::NoReference) => BusFault::NoClock { device: 1 },
        error => at_start(&error),
    })
}

/// When a frame that was sent at `sent_ns` has passed the reference clock; its distance from the time that is asked for is within half a cycle.
pub(super) fn reading(clocks: ClockDescription, cycle: &CycleInfo, sent_ns: u64) -> ClockReading {
    let period = i64::from(clocks.cycle_us) * 1_000;
    let late = cycle.cycle_start_offset.as_nanos() as i64 - i64::from(clocks.shift_us()) * 1_000;
    let error_ns = (late + period / 2).rem_euclid(period) - period / 2;
    ClockReading { error_ns, time_ns: cycle.dc_system_time, sent_ns, received_ns: ethercat_now() }
}
