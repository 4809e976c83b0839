//! EtherCAT by the `ethercrab` stack: scan, comparison with the description, start-up objects, operation, exchange.
//! Files: `link` the socket and the loop that runs the stack, `clocks` the distributed clocks.
//! Source: ETG.1000; docs of ethercrab 0.7.

mod clocks;
mod link;

use core::time::Duration;

use ethercrab::error::{Error, TimeoutError};
use ethercrab::std::ethercat_now;
use ethercrab::subdevice_group::{HasDc, NoDc, Op, PreOp, SafeOp};
use ethercrab::{
    Command, DefaultLock, MainDevice, MainDeviceConfig, PduStorage, SubDevice, SubDeviceGroup, SubDeviceRef,
    SubDeviceState, Timeouts,
};
use rustix::event::Timespec;

use self::link::EtherCatLink;
use super::fieldbus::bus_fault::{BusFault, DeviceIdentity};
use super::fieldbus::description::{
    ClockDescription, DeviceDescription, ERROR_CODE, EtherCatDescription, MAX_DEVICES, PdoEntry, SdoWrite,
};
use super::fieldbus::process_image::DeviceImage;
use super::fieldbus::{ClockReading, FieldBus};
use crate::defs::device_state::DeviceState;
use crate::defs::port_errors::{PORT_REGISTERS, PORTS_OF_DEVICE, PortErrors};
use crate::units::Micros;

/// Most bytes of process data.
const MAX_PROCESS_DATA: usize = 1_024;
/// Frames on their way, and bytes of one.
const MAX_FRAMES: usize = 16;
const FRAME_BYTES: usize = PduStorage::element_size(1_100);
/// Frames that settle the clocks of the devices at the start.
const CLOCK_FRAMES: u32 = 100;
/// Cycles until all devices must be in operation, and the time between them.
const MAX_START_CYCLES: u32 = 3_000;
const START_CYCLE: Timespec = Timespec { tv_sec: 0, tv_nsec: 1_000_000 };
/// Cycles until devices that were brought back must be in operation.
const MAX_RECOVERY_CYCLES: u32 = 300;
/// Longest wait for a mailbox in operation: less than the process data watchdogs of the devices (100 ms).
const MAILBOX_TIME_NS: u64 = 20_000_000;
/// Register that every device has: its type.
const DEVICE_TYPE: u16 = 0x0000;
/// First register of the error counters of the ports.
const PORT_ERRORS: u16 = 0x0300;
/// First register of the counters of lost links among them.
const LOST_LINKS: u16 = 0x0310;
/// Registers: AL control, AL status.
const AL_CONTROL: u16 = 0x0120;
const AL_STATUS: u16 = 0x0130;
/// AL states, and the bit that acknowledges an error.
const STATE_MASK: u16 = 0x0f;
const SAFE_OPERATIONAL: u16 = 0x04;
const OPERATIONAL: u16 = 0x08;
const ERROR_BIT: u16 = 0x10;
/// Register of the AL status code.
const AL_STATUS_CODE: u16 = 0x0134;

/// The frame memory of the stack. There is one bus in a process.
static STORAGE: PduStorage<MAX_FRAMES, FRAME_BYTES> = PduStorage::new();

type Devices<State, Clocks> = SubDeviceGroup<MAX_DEVICES, MAX_PROCESS_DATA, DefaultLock, State, Clocks>;
type Device<'a> = SubDeviceRef<'a, &'a SubDevice>;

/// The devices, with or without synchronised clocks.
enum Group<State> {
    Free(Devices<State, NoDc>),
    Clocked(Devices<State, HasDc>),
}

/// The same work on the devices of either kind: they have types of their own, and the same methods.
macro_rules! in_group {
    ($group:expr, $devices:ident => $work:expr) => {
        match $group {
            Group::Free($devices) => $work,
            Group::Clocked($devices) => $work,
        }
    };
}

/// An EtherCAT network.
pub struct EtherCat {
    interface: String,
    main_device: MainDevice<'static>,
    link: EtherCatLink,
    /// The devices, once all of them are in operation.
    group: Option<Group<Op>>,
    /// Working counter of a whole exchange.
    expected: u16,
    /// That of the last frame.
    found: Option<u16>,
    /// States of the devices as of the last frame.
    states: Vec<SubDeviceState>,
    round_trip: Micros,
    clocks: Option<ClockDescription>,
    /// The reference clock as the last frame passed it.
    clock: Option<ClockReading>,
}

impl EtherCat {
    /// A network that is not open yet; `None` where the process has one already.
    #[must_use]
    pub fn new(description: &EtherCatDescription) -> Option<Self> {
        let (tx, rx, pdu_loop) = STORAGE.try_split().ok()?;
        let timeouts = Timeouts { pdu: Duration::from_micros(description.reply_time_us), ..Timeouts::default() };
        let config = MainDeviceConfig { dc_static_sync_iterations: CLOCK_FRAMES, ..MainDeviceConfig::default() };
        Some(Self {
            interface: description.interface.clone(),
            main_device: MainDevice::new(pdu_loop, timeouts, config),
            link: EtherCatLink::new(tx, rx),
            group: None,
            expected: 0,
            found: None,
            states: Vec::with_capacity(MAX_DEVICES),
            round_trip: Micros::ZERO,
            clocks: description.distributed_clocks,
            clock: None,
        })
    }

    /// Finds the devices and compares them; sets up what the description says.
    fn pre_operational(&mut self, devices: &[DeviceDescription]) -> Result<Devices<PreOp, NoDc>, BusFault> {
        let Self { main_device, link, .. } = self;
        let found = link.run(main_device.init_single_group::<MAX_DEVICES, MAX_PROCESS_DATA>(ethercat_now));
        let group: Devices<PreOp, NoDc> = found.map_err(|error| at_start(&error))?;
        let (expected, found) = (devices.len() as u16, group.len() as u16);
        for ((device, described), place) in group.iter(main_device).zip(devices).zip(1..) {
            let is = device.identity();
            let found = DeviceIdentity { vendor: is.vendor_id, product: is.product_id, revision: is.revision };
            let expected = described.identity();
            let any_revision = expected.revision == 0 || expected.revision == found.revision;
            if (expected.vendor, expected.product) != (found.vendor, found.product) || !any_revision {
                return Err(BusFault::WrongDevice { device: place, expected, found });
            }
        }
        match found {
            0 => return Err(BusFault::NoReply),
            found if found != expected => return Err(BusFault::DeviceCount { expected, found }),
            _ => {}
        }
        for ((device, described), place) in group.iter(main_device).zip(devices).zip(1..) {
            link.run(set_up(&device, described)).map_err(|object| BusFault::ObjectRefused { device: place, object })?;
        }
        Ok(group)
    }

    /// Compares the process data and counts what a whole exchange adds to the working counter.
    fn safe_operational(
        &mut self,
        group: Devices<PreOp, NoDc>,
        devices: &[DeviceDescription],
    ) -> Result<Group<SafeOp>, BusFault> {
        let Self { main_device, link, .. } = self;
        let group = match self.clocks {
            Some(clocks) => {
                let group = clocks::synchronise(link, main_device, group, (clocks, devices))?;
                link.run(group.into_safe_op(main_device)).map(Group::Clocked)
            }
            None => link.run(group.into_safe_op(main_device)).map(Group::Free),
        };
        let group = group.map_err(|error| at_start(&error))?;
        self.expected = 0;
        in_group!(&group, found => for ((device, described), place) in found.iter(main_device).zip(devices).zip(1..) {
            let image = device.io_raw();
            let found = (image.inputs().len() as u16, image.outputs().len() as u16);
            let expected = described.process_data_bytes();
            if found != expected {
                return Err(BusFault::ProcessDataSize { device: place, expected, found });
            }
            // A read counts 1, a write 2.
            self.expected += u16::from(found.0 > 0) + 2 * u16::from(found.1 > 0);
        });
        Ok(group)
    }

    /// Brings the devices into operation: they need process data for it.
    fn operational(&mut self, group: Group<SafeOp>, images: &mut [DeviceImage]) -> Result<(), BusFault> {
        let Self { main_device, link, .. } = self;
        let group = match group {
            Group::Free(devices) => link.run(devices.request_into_op(main_device)).map(Group::Free),
            Group::Clocked(devices) => link.run(devices.request_into_op(main_device)).map(Group::Clocked),
        };
        self.group = Some(group.map_err(|error| at_start(&error))?);
        let begun = self.cycle_until_operational(MAX_START_CYCLES, images);
        if begun.is_err() {
            self.group = None;
        }
        begun
    }

    fn cycle_until_operational(&mut self, most: u32, images: &mut [DeviceImage]) -> Result<(), BusFault> {
        let mut last = BusFault::NoReply;
        for _ in 0..most {
            match self.exchange(images) {
                Ok(()) => return Ok(()),
                Err(fault) => last = fault,
            }
            self.link.pause(&START_CYCLE);
        }
        Err(last)
    }

    /// Asks every device that has left operation to come back.
    fn request_operation(&mut self) -> Result<(), BusFault> {
        let Self { main_device, link, group, .. } = self;
        let Some(group) = group else { return Err(BusFault::NoReply) };
        in_group!(group, devices => for (device, place) in devices.iter(main_device).zip(1..) {
            let lost = |error: Error| match error {
                Error::Timeout(_) => BusFault::NoReply,
                _ => BusFault::DeviceMissing { device: place },
            };
            let status = match link.run(device.register_read::<u16>(AL_STATUS)).map_err(lost) {
                Ok(status) => status,
                // A device that was without power has no address any more. If all are there, they start anew.
                Err(fault @ BusFault::DeviceMissing { .. }) => {
                    let all = Command::brd(DEVICE_TYPE).with_wkc(devices.len() as u16);
                    let all_there = link.run(all.receive::<u8>(main_device)).is_ok();
                    return Err(if all_there {
                        BusFault::NotOperational { device: place, al_status: 0 }
                    } else {
                        fault
                    });
                }
                Err(fault) => return Err(fault),
            };
            match status & (STATE_MASK | ERROR_BIT) {
                OPERATIONAL => continue,
                state if matches!(state & STATE_MASK, SAFE_OPERATIONAL | OPERATIONAL) => {}
                _ => return Err(BusFault::NotOperational { device: place, al_status: 0 }),
            }
            for asked in [SAFE_OPERATIONAL | ERROR_BIT, OPERATIONAL] {
                link.run(device.register_write(AL_CONTROL, asked)).map_err(lost)?;
            }
        });
        Ok(())
    }

    /// Which device is missing or has left operation.
    fn locate(&mut self, fault: BusFault) -> BusFault {
        let Self { main_device, link, group, states, .. } = self;
        let Some(group) = group else { return fault };
        let Some(index) = states.iter().position(|state| *state != SubDeviceState::Op) else { return fault };
        let device = index as u16 + 1;
        if states.get(index) == Some(&SubDeviceState::None) {
            return BusFault::DeviceMissing { device };
        }
        let al_status = in_group!(group, devices => match devices.subdevice(main_device, index) {
            Ok(at_fault) => link.run(at_fault.register_read::<u16>(AL_STATUS_CODE)).unwrap_or(0),
            Err(_) => return fault,
        });
        BusFault::NotOperational { device, al_status }
    }
}

/// Writes the process data assignment and the start-up objects; the object that is refused is the error.
async fn set_up(device: &Device<'_>, described: &DeviceDescription) -> Result<(), u16> {
    if described.assign {
        assign(device, 0x1600, 0x1c12, &described.outputs).await?;
        assign(device, 0x1a00, 0x1c13, &described.inputs).await?;
    }
    for SdoWrite { object, sub, bits, value } in described.startup.iter().copied() {
        let written = match bits {
            8 => device.sdo_write(object, sub, value as u8).await,
            16 => device.sdo_write(object, sub, value as u16).await,
            _ => device.sdo_write(object, sub, value as u32).await,
        };
        written.map_err(|_| object)?;
    }
    Ok(())
}

/// Maps entries into one process data object and assigns it to its sync manager.
async fn assign(device: &Device<'_>, mapping: u16, manager: u16, entries: &[PdoEntry]) -> Result<(), u16> {
    let refused = |object: u16| move |_: Error| object;
    device.sdo_write(manager, 0, 0_u8).await.map_err(refused(manager))?;
    if entries.is_empty() {
        return Ok(());
    }
    device.sdo_write(mapping, 0, 0_u8).await.map_err(refused(mapping))?;
    let mut at = 0_u8;
    for entry in entries {
        for step in 0..entry.count {
            let sub = if entry.object == 0 { 0 } else { u16::from(entry.sub) + step };
            let mapped = u32::from(entry.object) << 16 | u32::from(sub) << 8 | u32::from(entry.bits);
            at += 1;
            device.sdo_write(mapping, at, mapped).await.map_err(refused(mapping))?;
        }
    }
    device.sdo_write(mapping, 0, at).await.map_err(refused(mapping))?;
    device.sdo_write(manager, 1, mapping).await.map_err(refused(manager))?;
    device.sdo_write(manager, 0, 1_u8).await.map_err(refused(manager))
}

/// What an error of the stack says at the start.
fn at_start(error: &Error) -> BusFault {
    match error {
        Error::Timeout(TimeoutError::Pdu) => BusFault::NoReply,
        _ => BusFault::Other,
    }
}

impl FieldBus for EtherCat {
    fn connect(&mut self, devices: &[DeviceDescription], images: &mut [DeviceImage]) -> Result<(), BusFault> {
        self.group = None;
        self.states.clear();
        // The interface may have been away.
        self.link.open(&self.interface)?;
        let group = self.pre_operational(devices)?;
        let group = self.safe_operational(group, devices)?;
        self.operational(group, images)
    }

    fn recover(&mut self, images: &mut [DeviceImage]) -> Result<(), BusFault> {
        let mut requested = self.request_operation();
        if requested == Err(BusFault::NoReply) {
            // The interface may have been away.
            self.link.open(&self.interface)?;
            requested = self.request_operation();
        }
        requested?;
        self.cycle_until_operational(MAX_RECOVERY_CYCLES, images)
    }

    fn exchange(&mut self, images: &mut [DeviceImage]) -> Result<(), BusFault> {
        let Self { main_device, link, group, expected, found, states, round_trip, .. } = self;
        *found = None;
        let Some(group) = group else { return Err(BusFault::NoReply) };
        in_group!(&*group, devices => for (device, image) in devices.iter(main_device).zip(images.iter()) {
            device.outputs_raw_mut().copy_from_slice(&image.outputs);
        });
        let sent = ethercat_now();
        states.clear();
        self.clock = None;
        let answered = match (&*group, self.clocks) {
            (Group::Clocked(devices), Some(clocks)) => link.run(devices.tx_rx_dc(main_device)).map(|response| {
                self.clock = Some(clocks::reading(clocks, &response.extra, sent));
                states.extend_from_slice(&response.subdevice_states);
                response.working_counter
            }),
            (group, _) => in_group!(group, devices => link.run(devices.tx_rx(main_device)).map(|response| {
                states.extend_from_slice(&response.subdevice_states);
                response.working_counter
            })),
        };
        let Ok(counted) = answered else { return Err(BusFault::FrameLost) };
        *found = Some(counted);
        *round_trip = Micros(ethercat_now().saturating_sub(sent) / 1_000);
        in_group!(&*group, devices => for (device, image) in devices.iter(main_device).zip(images.iter_mut()) {
            image.inputs.copy_from_slice(&device.inputs_raw());
        });
        let expected = *expected;
        if counted == expected && states.iter().all(|state| *state == SubDeviceState::Op) {
            return Ok(());
        }
        let fault = BusFault::WorkingCounter { expected, found: counted };
        Err(self.locate(fault))
    }

    fn device_state(&self, device: usize) -> DeviceState {
        match self.states.get(device) {
            Some(SubDeviceState::Init) => DeviceState::Init,
            Some(SubDeviceState::PreOp) => DeviceState::PreOperational,
            Some(SubDeviceState::SafeOp) => DeviceState::SafeOperational,
            Some(SubDeviceState::Op) => DeviceState::Operational,
            _ => DeviceState::Missing,
        }
    }

    fn round_trip(&self) -> Micros {
        self.round_trip
    }

    fn working_counter(&self) -> Option<(u16, u16)> {
        self.found.map(|found| (found, self.expected))
    }

    fn clock(&self) -> Option<ClockReading> {
        self.clock
    }

    fn read_error_code(&mut self, device: usize) -> Option<u16> {
        let Self { main_device, link, group, .. } = self;
        in_group!(group.as_ref()?, devices => {
            let device = devices.subdevice(main_device, device).ok()?;
            link.run_for(MAILBOX_TIME_NS, device.sdo_read(ERROR_CODE, 0))?.ok()
        })
    }

    fn read_port_errors(&mut self, device: usize, clears: bool) -> Option<[PortErrors; PORTS_OF_DEVICE]> {
        let Self { main_device, link, group, .. } = self;
        in_group!(group.as_ref()?, devices => {
            let device = devices.subdevice(main_device, device).ok()?;
            if clears {
                // Writing to a counter of either group clears the group.
                for first in [PORT_ERRORS, LOST_LINKS] {
                    link.run(device.register_write(first, 0_u16)).ok()?;
                }
            }
            let counters = link.run(device.register_read::<[u8; PORT_REGISTERS]>(PORT_ERRORS)).ok()?;
            Some(PortErrors::of_registers(counters))
        })
    }
}
