//! A control on a field bus whose drives are played here: lost frames, faults, brakes, and the way back.

use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::path::PathBuf;
use std::rc::Rc;

use kt830::controller::PowerOnState;
use kt830::defs::device_state::DeviceState;
use kt830::defs::key::{Key, Mode};
use kt830::defs::kind::Kind;
use kt830::defs::param::{ParamAddress, Params};
use kt830::defs::port_errors::PortErrors;
use kt830::defs::signal::Output;
use kt830::host::Host;
use kt830::host::field_machine::HostedFieldBus;
use kt830::host::job_runner::JobRunner;
use kt830::host::storage::{DirectStorage, RetainedWorker};
use kt830::io::drive::{DriveFault, DriveState};
use kt830::io::fieldbus::bus_fault::BusFault;
use kt830::io::fieldbus::cia402::PowerState;
use kt830::io::fieldbus::description::{DeviceDescription, MachineDescription, field_of};
use kt830::io::fieldbus::process_image::DeviceImage;
use kt830::io::fieldbus::servo_axis::ServoAxis;
use kt830::io::fieldbus::station::StationLink;
use kt830::io::fieldbus::{ClockReading, FieldBus, FieldBusMachine};
use kt830::link::command::Command;
use kt830::units::{Axis, Micros};

use crate::stories::folders_of;

/// Two drives and a terminal; X has a brake at port 20.
pub const MACHINE: &str = "(
    kind: Gc,
    ethercat: (interface: \"none\", bridged_frames: 2),
    devices: [
        (name: \"X\", vendor: 1, product: 1, outputs: [(object: 0x6040, bits: 16), (object: 0x607a, bits: 32)],
            inputs: [(object: 0x6041, bits: 16), (object: 0x6064, bits: 32)], startup: [(object: 0x6060, bits: 8, value: 8)]),
        (name: \"Z\", vendor: 1, product: 1, outputs: [(object: 0x6040, bits: 16), (object: 0x607a, bits: 32)],
            inputs: [(object: 0x6041, bits: 16), (object: 0x6064, bits: 32)], startup: [(object: 0x6060, bits: 8, value: 8)]),
        (name: \"terminal\", vendor: 1, product: 2, outputs: [(object: 0x7000, sub: 1, bits: 1, count: 32)],
            inputs: [(object: 0x6000, sub: 1, bits: 1, count: 64)]),
    ],
    x: (device: 1, counts_per_mm: 1000.0, reversed: true, brake: (port: 20, release_s: 0.05, engage_s: 0.03)),
    z: (device: 2, counts_per_mm: 1000.0),
    inputs: [(device: 3, count: 64, port: 1)],
    outputs: [(device: 3, count: 32, port: 1)],
)";

/// A drive as CiA 402 describes it; it follows at once. Every transition takes a cycle.
#[derive(Clone, Copy, Debug)]
pub struct PlayedDrive {
    pub state: PowerState,
    pub position: i32,
    last_control: u16,
    /// The largest step of an enabled drive, counts.
    pub largest_step: i32,
    pub error_code: u16,
}

impl PlayedDrive {
    fn cycle(&mut self, control: u16, target: i32) {
        use PowerState::*;
        let reset = control & 0x80 != 0 && self.last_control & 0x80 == 0;
        self.state = match (self.state, control & 0x0f) {
            (NotReadyToSwitchOn, _) => SwitchOnDisabled,
            (FaultReactionActive, _) => Fault,
            (Fault, _) if reset => SwitchOnDisabled,
            (Fault, _) => Fault,
            (SwitchOnDisabled, 0x06) => ReadyToSwitchOn,
            (ReadyToSwitchOn, 0x07) => SwitchedOn,
            (SwitchedOn, 0x0f) => OperationEnabled,
            (OperationEnabled, 0x07) => SwitchedOn,
            (SwitchedOn, 0x06) => ReadyToSwitchOn,
            (_, 0x00) => SwitchOnDisabled,
            (state, _) => state,
        };
        if self.state == OperationEnabled {
            self.largest_step = self.largest_step.max((target.wrapping_sub(self.position)).abs());
            self.position = target;
        }
        self.last_control = control;
    }

    const fn statusword(&self) -> u16 {
        match self.state {
            PowerState::NotReadyToSwitchOn => 0x00,
            PowerState::SwitchOnDisabled => 0x40,
            PowerState::ReadyToSwitchOn => 0x21,
            PowerState::SwitchedOn => 0x23,
            PowerState::OperationEnabled => 0x27,
            PowerState::QuickStopActive => 0x07,
            PowerState::FaultReactionActive => 0x0f,
            PowerState::Fault => 0x08,
        }
    }
}

/// The played devices.
pub struct Devices {
    pub drives: RefCell<[PlayedDrive; 2]>,
    pub inputs: Cell<u64>,
    outputs: Cell<u32>,
    /// What the next exchanges meet.
    pub faults: RefCell<VecDeque<BusFault>>,
    /// The device that does not answer.
    missing: Cell<Option<usize>>,
    /// What connecting meets.
    refusal: Cell<Option<BusFault>>,
    pub connected: Cell<u32>,
    /// The reference clock.
    pub clock: Cell<Option<ClockReading>>,
    /// What the ports of the drive of Z have counted.
    pub ports: Cell<[PortErrors; 4]>,
}

/// Working counter of a whole exchange: three devices with inputs and outputs.
const WHOLE_COUNT: u16 = 9;

pub struct PlayedBus(Rc<Devices>);

impl FieldBus for PlayedBus {
    fn connect(&mut self, devices: &[DeviceDescription], _: &mut [DeviceImage]) -> Result<(), BusFault> {
        assert_eq!(devices.len(), 3);
        self.0.connected.set(self.0.connected.get() + 1);
        self.0.refusal.get().map_or(Ok(()), Err)
    }

    fn recover(&mut self, _: &mut [DeviceImage]) -> Result<(), BusFault> {
        self.0.refusal.get().map_or(Ok(()), Err)
    }

    fn exchange(&mut self, images: &mut [DeviceImage]) -> Result<(), BusFault> {
        if let Some(fault) = self.0.faults.borrow_mut().pop_front() {
            return Err(fault);
        }
        for (drive, image) in self.0.drives.borrow_mut().iter_mut().zip(images.iter_mut()) {
            let [c0, c1, t0, t1, t2, t3] = image.outputs[..] else { panic!("{image:?}") };
            drive.cycle(u16::from_le_bytes([c0, c1]), i32::from_le_bytes([t0, t1, t2, t3]));
            image.inputs[..2].copy_from_slice(&drive.statusword().to_le_bytes());
            image.inputs[2..].copy_from_slice(&drive.position.to_le_bytes());
        }
        images[2].inputs.copy_from_slice(&self.0.inputs.get().to_le_bytes());
        self.0.outputs.set(u32::from_le_bytes(images[2].outputs[..].try_into().unwrap()));
        Ok(())
    }

    fn device_state(&self, device: usize) -> DeviceState {
        let missing = self.0.missing.get() == Some(device);
        if missing { DeviceState::Missing } else { DeviceState::Operational }
    }

    fn round_trip(&self) -> Micros {
        Micros(70)
    }

    fn working_counter(&self) -> Option<(u16, u16)> {
        let found = if self.0.missing.get().is_some() { WHOLE_COUNT - 3 } else { WHOLE_COUNT };
        Some((found, WHOLE_COUNT))
    }

    fn clock(&self) -> Option<ClockReading> {
        self.0.clock.get()
    }

    fn read_error_code(&mut self, device: usize) -> Option<u16> {
        Some(self.0.drives.borrow()[device].error_code)
    }

    fn read_port_errors(&mut self, device: usize, clears: bool) -> Option<[PortErrors; 4]> {
        let ports = (device == 1).then_some(&self.0.ports)?;
        if clears {
            ports.set(Default::default());
        }
        Some(ports.get())
    }
}

/// A control on the played bus.
pub struct Shop {
    pub host: Host<HostedFieldBus<PlayedBus>, DirectStorage>,
    pub devices: Rc<Devices>,
}

impl Shop {
    /// A bus that refuses with this, or none that does; the encoders of both drives stand at `position`.
    pub fn new(refusal: Option<BusFault>, position: i32) -> Self {
        Self::with_stations(MACHINE, Vec::new(), refusal, position)
    }

    /// The same with stations beside the bus.
    pub fn with_stations(
        machine: &str,
        links: Vec<Box<dyn StationLink>>,
        refusal: Option<BusFault>,
        position: i32,
    ) -> Self {
        let drive = PlayedDrive {
            state: PowerState::NotReadyToSwitchOn,
            position,
            last_control: 0,
            largest_step: 0,
            error_code: 0x2310,
        };
        let retained = PowerOnState::factory(Kind::Gc);
        let devices = Rc::new(Devices {
            drives: RefCell::new([drive; 2]),
            // All functions inactive: the normally closed contacts are closed.
            inputs: Cell::new(retained.params.inverted_inputs()),
            outputs: Cell::new(0),
            faults: RefCell::default(),
            missing: Cell::default(),
            refusal: Cell::new(refusal),
            connected: Cell::new(0),
            clock: Cell::default(),
            ports: Cell::default(),
        });
        let description = MachineDescription::parse(machine).unwrap();
        let bus = PlayedBus(Rc::clone(&devices));
        let machine = HostedFieldBus::new(FieldBusMachine::new(description, bus, links));
        let jobs = JobRunner::new(folders_of(Kind::Gc));
        let storage = DirectStorage::new(RetainedWorker::new(None), jobs).unwrap();
        let mut host = Host::connect(Kind::Gc, retained, machine, storage);
        host.begin();
        Self { host, devices }
    }

    /// The bus with the same devices, for a machine without a control.
    pub fn bus(&self) -> PlayedBus {
        PlayedBus(Rc::clone(&self.devices))
    }

    pub fn ticks(&mut self, ticks: u32) {
        (0..ticks).for_each(|_| self.host.step());
    }

    pub fn press(&mut self, key: Key) {
        self.host.send(Command::Press(key));
        self.host.step();
    }

    pub fn drive(&self, axis: Axis) -> DriveState {
        self.host.trace_row().inputs.drives[axis]
    }

    pub fn alarms(&mut self) -> Vec<String> {
        self.host.snapshot().alarms.iter().map(|alarm| format!("{} {}", alarm.number, alarm.text.en())).collect()
    }

    /// Holds a jog key for a number of ticks; it stays pressed.
    pub fn jog(&mut self, key: Key, ticks: u32) {
        self.press(Mode::Manual.key());
        self.press(key);
        for tick in 0..ticks {
            if tick % 50 == 0 {
                self.host.send(Command::StillHeld(key));
            }
            self.host.step();
        }
    }

    /// Lets a key go and waits for standstill.
    fn release(&mut self, key: Key) {
        self.host.send(Command::Release(key));
        self.ticks(500);
    }

    fn output(&self, port: u32) -> bool {
        self.devices.outputs.get() >> (port - 1) & 1 == 1
    }
}

/// 0x7fff_ff00 is just below the wrap of the counter.
#[test]
fn p1_drives_come_on_without_a_jump_and_their_counters_may_wrap() {
    for position in [0, -123_456, 0x7fff_ff00] {
        let mut shop = Shop::new(None, position);
        shop.ticks(5);
        assert_eq!(shop.drive(Axis::Z), DriveState::Enabled, "four transitions, then it follows");
        assert_eq!(shop.drive(Axis::X), DriveState::SwitchingOn, "its brake is being released");
        assert!(
            shop.output(20) || {
                shop.ticks(1);
                shop.output(20)
            }
        );
        shop.jog(Key::ZPlus, 10);
        assert!(shop.host.controller().is_at_rest(), "the drives are switching on");
        shop.release(Key::ZPlus);
        assert_eq!(shop.drive(Axis::X), DriveState::Enabled);
        let [x, z] = *shop.devices.drives.borrow();
        assert_eq!([x.largest_step, z.largest_step], [0, 0]);
        for key in [Key::XMinus, Key::ZPlus] {
            shop.jog(key, 300);
            shop.release(key);
        }
        assert!(shop.alarms().is_empty(), "{:?}", shop.alarms());
        let moved = shop.devices.drives.borrow().map(|drive| f64::from(drive.position.wrapping_sub(position)));
        // X is reversed and shown as a diameter: minus is the rising direction, and 2 mm shown are 1000 counts.
        let axes = &shop.host.snapshot().axes;
        let shown = [-500.0 * axes[Axis::X].machine, 1_000.0 * axes[Axis::Z].machine];
        for (counts, shown) in moved.into_iter().zip(shown) {
            assert!(counts > 1_000.0 && (counts - shown).abs() < 1.0, "{moved:?} {shown}");
        }
    }
}

#[test]
fn b8_two_lost_frames_are_bridged_and_the_third_one_stops_the_machine() {
    let mut shop = Shop::new(None, 0);
    shop.ticks(100);
    shop.jog(Key::ZPlus, 500);
    for lost in 1..=2 {
        shop.devices.faults.borrow_mut().extend(vec![BusFault::FrameLost; lost]);
        shop.ticks(20);
        assert!(shop.alarms().is_empty(), "{:?}", shop.alarms());
    }
    let before = shop.host.trace_row().inputs.encoder_mm[Axis::Z];
    shop.devices.faults.borrow_mut().extend([BusFault::FrameLost; 3]);
    shop.ticks(2);
    // The jog speed (P56) of 1000 mm/min is 1/60 mm in a tick: the encoder goes on meanwhile.
    let bridged = shop.host.trace_row().inputs.encoder_mm[Axis::Z];
    assert!((bridged - before - 2.0 / 60.0).abs() < 0.002, "{before} {bridged}");
    shop.ticks(1);
    assert_eq!(shop.alarms(), ["402 I/O bus not responding: frames are lost"]);
    // The axis brakes along its path, then the torque goes.
    shop.ticks(500);
    let row = shop.host.trace_row();
    assert!(!row.outputs.drives_on && shop.devices.drives.borrow()[1].largest_step <= 70, "{row:?}");
    // RESET brings it back without a new start of the devices; the axes are to be homed again.
    shop.press(Key::Reset);
    shop.ticks(200);
    assert!(shop.alarms().is_empty() && shop.devices.connected.get() == 1, "{:?}", shop.alarms());
    assert!(!shop.host.snapshot().axes[Axis::Z].homed);
    assert_eq!(shop.drive(Axis::Z), DriveState::Enabled);
}

/// The counters are read while the drives are off: behind a lost bus they tell which cable it was.
#[test]
fn p1_the_ports_of_a_device_tell_which_cable_is_bad() {
    let mut shop = Shop::new(None, 0);
    shop.ticks(100);
    let bad =
        [PortErrors::default(), PortErrors { damaged: 3, lost_links: 1 }, PortErrors::default(), PortErrors::default()];
    shop.devices.ports.set(bad);
    let shown = |shop: &mut Shop| shop.host.snapshot().bus.as_ref().expect("a bus").devices[1].ports;
    shop.ticks(1_000);
    assert_eq!(shown(&mut shop), [PortErrors::default(); 4], "not while the drives are on");
    shop.devices.faults.borrow_mut().extend([BusFault::FrameLost; 3]);
    shop.ticks(1_500);
    assert_eq!(shown(&mut shop), bad);
    // The fitter has changed the cable: the counters begin anew, those of the device, too.
    shop.host.send(Command::ClearBusCounters);
    shop.ticks(1_000);
    assert_eq!((shown(&mut shop), shop.devices.ports.get()), ([PortErrors::default(); 4], [PortErrors::default(); 4]));
}

#[test]
fn p1_the_counters_of_the_bus_begin_anew_when_they_are_cleared() {
    let mut shop = Shop::new(None, 0);
    let shown = |shop: &mut Shop| shop.host.snapshot().bus.clone().expect("a bus");
    shop.ticks(600);
    shop.devices.faults.borrow_mut().push_back(BusFault::FrameLost);
    shop.ticks(600);
    let before = shown(&mut shop);
    assert_eq!((before.lost, before.working_counter), (1, Some((WHOLE_COUNT, WHOLE_COUNT))));
    assert!((1_000..=1_200).contains(&before.cycles), "{}", before.cycles);
    // Every answered frame took 70 µs: the class from 50 µs.
    assert_eq!(before.round_trip.counts[3], before.cycles - 1);
    shop.host.send(Command::ClearBusCounters);
    shop.ticks(300);
    let after = shown(&mut shop);
    assert!(after.lost == 0 && (1..=300).contains(&after.cycles), "{} {}", after.lost, after.cycles);
    assert_eq!(after.round_trip.counts[3], after.cycles);
    shop.devices.missing.set(Some(0));
    shop.ticks(300);
    assert_eq!(shown(&mut shop).working_counter, Some((WHOLE_COUNT - 3, WHOLE_COUNT)));
}

#[test]
fn b8_a_machine_that_differs_stands_and_says_why_until_it_is_right() {
    let found = BusFault::DeviceCount { expected: 3, found: 2 };
    let mut shop = Shop::new(Some(found), 0);
    shop.ticks(50);
    let text = "402 I/O bus not responding: 3 devices expected, 2 found";
    assert_eq!(shop.alarms(), [text], "and no alarm of inputs that nobody has read");
    shop.devices.refusal.set(Some(BusFault::DeviceMissing { device: 3 }));
    shop.press(Key::Reset);
    shop.ticks(50);
    assert_eq!(shop.alarms(), ["402 I/O bus not responding: device 3 does not answer"], "the newest fault counts");
    assert_eq!((shop.drive(Axis::Z), shop.devices.outputs.get()), (DriveState::Off, 0));
    shop.devices.refusal.set(None);
    shop.press(Key::Reset);
    shop.ticks(200);
    assert!(shop.alarms().is_empty(), "{:?}", shop.alarms());
    assert_eq!([shop.drive(Axis::X), shop.drive(Axis::Z)], [DriveState::Enabled; 2]);
}

#[test]
fn b8_a_drive_fault_has_its_code_in_words_and_reset_brings_the_drive_back() {
    let mut shop = Shop::new(None, 0);
    shop.ticks(100);
    shop.jog(Key::ZPlus, 500);
    shop.devices.drives.borrow_mut()[0].state = PowerState::FaultReactionActive;
    shop.ticks(2);
    assert!(shop.alarms()[0].starts_with("104 drive fault: X"), "{:?}", shop.alarms());
    // The other axis brakes; the code is read when the drives are off.
    shop.ticks(500);
    assert_eq!(shop.alarms(), ["104 drive fault: X 2310h continuous overcurrent"]);
    assert!(!shop.host.trace_row().outputs.drives_on);
    assert!(shop.devices.drives.borrow()[1].largest_step <= 17);
    shop.press(Key::Reset);
    shop.ticks(200);
    assert!(shop.alarms().is_empty(), "{:?}", shop.alarms());
    assert_eq!([shop.drive(Axis::X), shop.drive(Axis::Z)], [DriveState::Enabled; 2]);
}

/// It does not come back while the others brake: it would jump to a set-point that went on without it.
#[test]
fn b8_a_drive_that_goes_off_by_itself_is_a_fault_and_stays_off() {
    for by_itself in [PowerState::SwitchOnDisabled, PowerState::QuickStopActive] {
        let mut shop = Shop::new(None, 0);
        shop.ticks(100);
        shop.jog(Key::ZPlus, 500);
        shop.devices.drives.borrow_mut()[1].state = by_itself;
        let mut enabled = 0;
        for _ in 0..500 {
            shop.host.step();
            enabled += u32::from(shop.devices.drives.borrow()[1].state == PowerState::OperationEnabled);
        }
        assert_eq!((shop.alarms(), enabled), (vec!["104 drive fault: Z has switched itself off".to_owned()], 0));
        shop.press(Key::Reset);
        shop.ticks(200);
        assert!(shop.alarms().is_empty() && shop.devices.drives.borrow()[1].largest_step <= 17);
        assert_eq!(shop.drive(Axis::Z), DriveState::Enabled);
    }
}

/// A drive with torque holds its axis where it is while its brake is released: a set-point that followed the encoder
/// would let a vertical axis sink.
#[test]
fn p1_an_axis_is_held_while_the_brakes_are_released() {
    let mut shop = Shop::new(None, 0);
    let mut targets = Vec::new();
    for _ in 0..100 {
        shop.host.step();
        let mut drives = shop.devices.drives.borrow_mut();
        // The load pulls both axes by a count in every tick that they have torque.
        for drive in drives.iter_mut().filter(|drive| drive.state == PowerState::OperationEnabled) {
            drive.position -= 1;
        }
        targets.push(drives.map(|drive| drive.largest_step));
    }
    // Each tick the drive takes the one count back: the target has not moved.
    assert_eq!(targets.last(), Some(&[1, 1]));
    assert_eq!([shop.drive(Axis::X), shop.drive(Axis::Z)], [DriveState::Enabled; 2]);
    let [x, z] = *shop.devices.drives.borrow();
    assert!(x.position >= -3 && z.position >= -3, "{x:?} {z:?}");
}

/// P1: with the torque gone nothing holds the axis but its brake; it engages first.
#[test]
fn p1_the_brake_holds_before_the_torque_goes() {
    let mut shop = Shop::new(None, 0);
    shop.ticks(100);
    assert!(shop.output(20));
    shop.host.send(Command::EmergencyStop(true));
    let (mut engaged, mut without_torque) = (None, None);
    for tick in 0..200 {
        shop.host.step();
        engaged = engaged.or((!shop.output(20)).then_some(tick));
        let torque = shop.devices.drives.borrow()[0].state == PowerState::OperationEnabled;
        without_torque = without_torque.or((!torque).then_some(tick));
    }
    // 0.03 s of engaging.
    let (engaged, without_torque) = (engaged.unwrap(), without_torque.unwrap());
    assert!((30..=33).contains(&(without_torque - engaged)), "{engaged} {without_torque}");
}

/// The drive of X is gone: nothing but its brake holds the axis. The other one brakes along its path meanwhile.
#[test]
fn p1_the_brake_of_a_drive_that_is_gone_engages_at_once() {
    let mut shop = Shop::new(None, 0);
    shop.ticks(100);
    shop.jog(Key::ZPlus, 500);
    shop.devices.missing.set(Some(0));
    shop.devices.faults.borrow_mut().extend([BusFault::DeviceMissing { device: 1 }; 3]);
    shop.ticks(3);
    assert!(shop.alarms()[0].contains("device 1 does not answer"), "{:?}", shop.alarms());
    shop.ticks(1);
    assert!(!shop.output(20) && shop.host.trace_row().outputs.drives_on, "the brake of X; Z still brakes");
}

/// RESET while the brake engages: it is released anew, with its whole time, before the axis may move.
#[test]
fn p1_a_brake_that_has_begun_to_engage_is_released_anew() {
    let mut shop = Shop::new(None, 0);
    shop.ticks(100);
    shop.host.send(Command::EmergencyStop(true));
    shop.ticks(3);
    shop.host.send(Command::EmergencyStop(false));
    shop.ticks(20); // the release is debounced
    assert!(!shop.output(20) && shop.devices.drives.borrow()[0].state == PowerState::OperationEnabled);
    shop.press(Key::Reset);
    // 0.05 s of release.
    let ticks = (0..200).take_while(|_| {
        shop.host.step();
        shop.drive(Axis::X) != DriveState::Enabled
    });
    let ticks = ticks.count();
    assert!((48..=53).contains(&ticks), "{ticks}");
}

/// A drive that stops by its own quick stop is not disturbed: disabled voltage would let the axis coast.
#[test]
fn p1_a_quick_stop_of_the_drive_goes_on_until_it_stands() {
    let mut shop = Shop::new(None, 0);
    shop.ticks(100);
    shop.devices.drives.borrow_mut()[1].state = PowerState::QuickStopActive;
    let mut disabled = None;
    for tick in 0..60 {
        {
            let mut drives = shop.devices.drives.borrow_mut();
            // It ramps down for 40 ticks.
            drives[1].position += (40 - tick).max(0);
            disabled = disabled.or((drives[1].state != PowerState::QuickStopActive).then_some(tick));
        }
        shop.host.step();
    }
    assert!(disabled.is_some_and(|tick| tick >= 39), "{disabled:?}");
}

/// A fault that stays is reset for a second; after that it waits for the next RESET.
#[test]
fn b8_reset_does_not_go_on_for_ever() {
    let mut shop = Shop::new(None, 0);
    shop.ticks(100);
    shop.devices.drives.borrow_mut()[1].state = PowerState::Fault;
    shop.ticks(10);
    shop.press(Key::Reset);
    for _ in 0..1_500 {
        shop.host.step();
        // Its cause is still there.
        shop.devices.drives.borrow_mut()[1].state = PowerState::Fault;
    }
    shop.ticks(1_000);
    assert_eq!(shop.devices.drives.borrow()[1].state, PowerState::Fault, "nobody has pressed RESET");
    assert!(shop.alarms()[0].starts_with("104"), "{:?}", shop.alarms());
    shop.press(Key::Reset);
    shop.ticks(100);
    assert!(shop.alarms().is_empty() && shop.drive(Axis::Z) == DriveState::Enabled, "{:?}", shop.alarms());
}

/// The emergency stop is pressed, a drive in a fault; its release within the time of RESET switches nothing on.
#[test]
fn b5_a_reset_before_the_release_of_the_emergency_stop_switches_no_drive_on() {
    let mut shop = Shop::new(None, 0);
    shop.ticks(100);
    shop.host.send(Command::EmergencyStop(true));
    shop.ticks(100);
    shop.devices.drives.borrow_mut()[1].state = PowerState::Fault;
    shop.ticks(10);
    shop.press(Key::Reset);
    shop.host.send(Command::EmergencyStop(false));
    shop.ticks(2_500);
    assert!(shop.alarms().iter().any(|text| text.starts_with("0 ")), "{:?}", shop.alarms());
    assert!(!shop.host.trace_row().outputs.drives_on);
    shop.press(Key::Reset);
    shop.ticks(200);
    assert!(shop.alarms().is_empty() && shop.host.trace_row().outputs.drives_on, "{:?}", shop.alarms());
}

#[test]
fn p1_codes_of_drives_have_words() {
    let said = |code: u16| DriveFault(code).text().get(kt830::defs::text::Lang::En).to_owned();
    assert_eq!(
        [said(0x3220), said(0x3299), said(0x7399), said(0xff01)],
        [
            "DC link undervoltage".to_owned(),
            "DC link voltage".to_owned(),
            "sensor".to_owned(),
            "see the manual of the drive".to_owned()
        ]
    );
    assert_eq!(DriveFault(0x8611).to_string(), "8611h");
}

/// 6077h: 0.1 % of the rated torque, signed.
#[test]
fn p1_the_torque_of_a_drive_is_in_percent() {
    let text = example("gc");
    let description = MachineDescription::parse(&text).unwrap();
    let drive = &description.devices[0];
    let mut axis = ServoAxis::new(description.axes()[Axis::X].unwrap(), drive).unwrap();
    let mut image = DeviceImage { inputs: vec![0; usize::from(drive.process_data_bytes().0)], outputs: Vec::new() };
    let field = field_of(&drive.inputs, 0x6077).unwrap();
    field.write(&mut image.inputs, (-375_i32) as u32);
    axis.read(Micros::ZERO, &image);
    assert_eq!(axis.torque_percent(), Some(-37.5));
    // Of an axis whose counts fall where it rises the torque turns round, too.
    let mut reversed = description.axes()[Axis::X].unwrap().clone();
    reversed.reversed = !reversed.reversed;
    let mut axis = ServoAxis::new(&reversed, drive).unwrap();
    axis.read(Micros::ZERO, &image);
    assert_eq!(axis.torque_percent(), Some(37.5));
    // The drives of the other tests do not send it.
    let plain = MachineDescription::parse(MACHINE).unwrap();
    let axis = ServoAxis::new(plain.axes()[Axis::X].unwrap(), &plain.devices[0]).unwrap();
    assert_eq!(axis.torque_percent(), None);
}

/// Each wrong value of a description, and what is said of it.
#[test]
fn p1_a_wrong_description_is_refused_with_its_place() {
    for (from, to, said) in [
        ("x: (device: 1", "x: (device: 9", "x.device: there is no device of this number"),
        ("x: (device: 1", "x: (device: 2", "x.device: two axes have the same drive"),
        ("x: (device: 1", "x: (device: 3", "x: its drive needs 6040h"),
        ("counts_per_mm: 1000.0, reversed", "counts_per_mm: -5.0, reversed", "x.counts_per_mm: must be greater than 0"),
        ("port: 20", "port: 65", "x.brake: the port must be 1 to 64"),
        ("release_s: 0.05", "release_s: 5.0", "x.brake: the times must be 0 to 2 s"),
        ("count: 64, port: 1", "count: 64, port: 2", "inputs[0]: ports are 1 to 64"),
        ("count: 32, port: 1)]", "count: 33, port: 1)]", "outputs[0]: the device has not so many bits"),
        (
            "inputs: [(device: 3, count: 64, port: 1)]",
            "inputs: [(device: 3, port: 1), (device: 3, bit: 1, port: 1)]",
            "inputs[1]: a port is given twice",
        ),
        ("bits: 1, count: 64", "bits: 33, count: 64", "devices[3].inputs: an entry has 1 to 32 bits"),
        ("bits: 1, count: 64", "bits: 32, count: 65535", "devices[3].inputs: there must be at most 64 entries"),
        (
            "(object: 0x7000, sub: 1, bits: 1, count: 32)",
            "(object: 0, bits: 32, count: 64), (object: 0, bits: 32, count: 1)",
            "devices[3].outputs: there must be at most 64",
        ),
        ("count: 64, port: 1", "bit: 65535, count: 64, port: 1", "inputs[0]: the device has not so many bits"),
        ("port: 20", "port: 40", "x.brake: its port is not among the outputs"),
        ("object: 0x6064, bits: 32", "object: 0x6064, bits: 16", "x: its drive needs 6040h (16 bits)"),
        ("startup: [(object: 0x6060, bits: 8, value: 8)]", "startup: []", "x: its drive needs the mode 6060h"),
        (
            "bits: 8, value: 8",
            "bits: 8, value: 300",
            "devices[1].startup: an object has 8, 16 or 32 bits, and a value that fits",
        ),
        ("sub: 1, bits: 1, count: 64", "sub: 200, bits: 1, count: 64", "devices[3].inputs: the last subindex"),
        (
            "outputs: [(device: 3, count: 32, port: 1)],",
            "outputs: [(device: 3, count: 32, port: 1)], wheel_speed: (device: 1, bit: 16, bits: 16, counts_at_10_v: 1000.0),",
            "wheel_speed and axis X: bit 16 of device 1: an output has one writer",
        ),
        ("bridged_frames: 2", "distributed_clocks: (cycle_us: 1000)", "ethercat.distributed_clocks: SYNC0 needs both"),
        ("product: 1, outputs", "product: 1, sync0: true, outputs", "ethercat.distributed_clocks: SYNC0 needs both"),
        ("bridged_frames: 2", "bridged_frames: 99", "ethercat.bridged_frames: must be 0 to 20"),
        ("interface: \"none\"", "interface: \"\"", "ethercat.interface: the network interface must have a name"),
        ("z: (device: 2, counts_per_mm: 1000.0),", "", "x, z: every machine has the axes X and Z"),
        ("kind: Gc", "kind: Gx", "1:"),
        ("bits: 16), (object: 0x607a", "bits: 16, colour: 3), (object: 0x607a", "colour"),
    ] {
        let text = MACHINE.replacen(from, to, 1);
        assert_ne!(text, MACHINE, "{from}");
        let error = MachineDescription::parse(&text).expect_err(to).to_string();
        assert!(error.contains(said) || (said == "1:" && error.contains("2:")), "{to}: {error}");
    }
}

/// The example of a kind.
fn example(kind: &str) -> String {
    let file = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("assets/machines/{kind}_ethercat.ron"));
    std::fs::read_to_string(file).unwrap()
}

#[test]
fn p1_a_description_that_differs_from_the_parameters_is_refused() {
    let refused = |text: &str, params: &Params| {
        let description = MachineDescription::parse(text).unwrap();
        description.check_against(params).map_err(|error| error.to_string())
    };
    for (kind, name) in [(Kind::Gc, "gc"), (Kind::Gs, "gs"), (Kind::Ga, "ga"), (Kind::Lathe, "lathe")] {
        assert_eq!(refused(&example(name), &Params::factory(kind)), Ok(()), "{name}");
    }
    let (params, gs) = (Params::factory(Kind::Gc), Params::factory(Kind::Gs));
    let mut with_y = params.clone();
    with_y.write(ParamAddress::parse("P6.6").unwrap(), 1.0).unwrap();
    let port = params.output_port(Output::Coolant);
    // P30 as delivered: 6 000 mm/min are 100 mm/s.
    let at_most = |mm_s: &str| {
        let with_speed = format!("counts_per_mm: 26214.4, highest_mm_s: {mm_s})");
        example("gc").replacen("counts_per_mm: 26214.4, highest_mm_s: 250.0)", &with_speed, 1)
    };
    assert_eq!(refused(&at_most("100.0"), &params), Ok(()));
    let brake = format!("counts_per_mm: 26214.4, brake: (port: {port}, release_s: 0.1, engage_s: 0.1))");
    for (text, params, said) in [
        // The cycle is 1 ms: a frame of 1 ms would be late in every one.
        (example("gc").replace("reply_time_us: 500", "reply_time_us: 1000"), &params, "(P58)"),
        (example("gc"), &with_y, "y: the control has this axis"),
        (example("gs"), &params, "y: has a drive"),
        (at_most("99.9"), &params, "x.highest_mm_s: the rapid traverse of the control (P30–P32)"),
        (example("gs").replacen("counts_per_mm: 26214.4)", &brake, 1), &gs, "x.brake: port 2 and coolant (P"),
    ] {
        let told = refused(&text, params).unwrap_err();
        assert!(told.contains(said), "{said}: {told}");
    }
}

/// The examples that come along are right, and their ports reach every function of their kind.
#[test]
fn p1_the_example_descriptions_are_right() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("assets/machines");
    let mut kinds = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap) {
        let name = entry.file_name().into_string().unwrap();
        if name.ends_with("_ethercat.ron") {
            let text = std::fs::read_to_string(entry.path()).unwrap();
            let machine = MachineDescription::parse(&text).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!(name.starts_with(machine.kind.id()), "{name}");
            let params = PowerOnState::factory(machine.kind).params;
            let fitted = params.fitted().axes();
            assert!(Axis::ALL.into_iter().all(|axis| fitted[axis] == machine.axes()[axis].is_some()), "{name}");
            kinds.push(machine.kind);
        }
    }
    kinds.sort_by_key(|kind| kind.id());
    assert_eq!(kinds, [Kind::Ga, Kind::Gc, Kind::Gs, Kind::Lathe]);
}
