//! G31 and G78 with a signal that the drive latches, too: the place of the edge, not that of the tick that has seen it.
//! Source: spec B2 (G31), K4.5 (G78); CiA 402-2, objects 60B8h to 60BBh.

use std::cell::Cell;
use std::rc::Rc;

use kt830::controller::PowerOnState;
use kt830::defs::device_state::DeviceState;
use kt830::defs::key::{Key, Mode};
use kt830::defs::kind::Kind;
use kt830::defs::signal::Input;
use kt830::host::Host;
use kt830::host::field_machine::HostedFieldBus;
use kt830::host::job_runner::JobRunner;
use kt830::host::storage::{DirectStorage, RetainedWorker};
use kt830::io::fieldbus::bus_fault::BusFault;
use kt830::io::fieldbus::description::{DeviceDescription, MachineDescription};
use kt830::io::fieldbus::process_image::DeviceImage;
use kt830::io::fieldbus::{ClockReading, FieldBus, FieldBusMachine};
use kt830::link::command::Command;
use kt830::link::snapshot::RunState;
use kt830::units::{Axis, Micros};

use crate::field_bus::{MACHINE, PlayedBus, Shop};
use crate::stories::folders_of;

/// Cycles from the edge until the input terminal shows it: its filter, and the bus.
const TERMINAL_CYCLES: u32 = 4;

/// The machine with absolute encoders; signal 4 is wired to the probe of the drive of Z, too.
fn machine() -> String {
    let z = "name: \"Z\", vendor: 1, product: 1, outputs: [(object: 0x6040, bits: 16), (object: 0x607a, bits: 32)";
    let inputs = "inputs: [(object: 0x6041, bits: 16), (object: 0x6064, bits: 32)";
    let text = MACHINE.replace(z, &format!("{z}, (object: 0x60b8, bits: 16)"));
    let (head, tail) = text.split_once("0x60b8").unwrap();
    let tail = tail.replacen(inputs, &format!("{inputs}, (object: 0x60b9, bits: 16), (object: 0x60ba, bits: 32)"), 1);
    format!("{head}0x60b8{tail}").replace("reversed: true,", "reversed: true, absolute: (zero_counts: 0),").replace(
        "counts_per_mm: 1000.0)",
        "counts_per_mm: 1000.0, absolute: (zero_counts: 100000), touch_probe: (signal: 4))",
    )
}

/// What the probe of the drive of Z does.
#[derive(Default)]
struct ProbedDrive {
    /// Counts at which the contact closes, from below.
    contact: Cell<i32>,
    /// A pulse of noise at the probe's input, not at the terminal's.
    noise: Cell<Option<i32>>,
    /// Bits 0 and 1 of 60B9h, and 60BAh.
    status: Cell<(u16, i32)>,
    position: Cell<i32>,
    closed_for: Cell<u32>,
    /// The probe was armed at least once.
    was_armed: Cell<bool>,
}

/// The played bus; the drive of Z has a probe.
struct ProbedBus {
    inner: PlayedBus,
    drive: Rc<ProbedDrive>,
    /// Port of the signal, and all inputs without it.
    signal: (u8, u64),
    inputs: Rc<dyn Fn(u64)>,
}

impl ProbedBus {
    /// A cycle of the probe: `function` is 60B8h.
    fn latch(&self, function: u16, position: i32) {
        let drive = &self.drive;
        let before = drive.position.replace(position);
        drive.was_armed.set(drive.was_armed.get() || function != 0);
        let crossed = |at: i32| before < at && position >= at;
        let edge = Some(drive.contact.get()).filter(|at| crossed(*at)).or(drive.noise.get().filter(|at| crossed(*at)));
        let (status, latched) = drive.status.get();
        drive.status.set(match (function & 1, edge) {
            (0, _) => (0, 0),
            // The first event only.
            (_, Some(at)) if status & 2 == 0 && function & 0x10 != 0 => (3, at),
            _ => (status | 1, latched),
        });
        let closed = if position >= drive.contact.get() { drive.closed_for.get() + 1 } else { 0 };
        drive.closed_for.set(closed);
        let (port, rest) = self.signal;
        (self.inputs)(rest ^ u64::from(closed > TERMINAL_CYCLES) << (port - 1));
    }
}

impl FieldBus for ProbedBus {
    fn connect(&mut self, devices: &[DeviceDescription], images: &mut [DeviceImage]) -> Result<(), BusFault> {
        self.inner.connect(devices, images)
    }

    fn recover(&mut self, images: &mut [DeviceImage]) -> Result<(), BusFault> {
        self.inner.recover(images)
    }

    fn exchange(&mut self, images: &mut [DeviceImage]) -> Result<(), BusFault> {
        let outputs = images[1].outputs.split_off(6);
        let inputs = images[1].inputs.split_off(6);
        let exchanged = self.inner.exchange(images);
        images[1].outputs.extend(&outputs);
        let position = i32::from_le_bytes(images[1].inputs[2..6].try_into().unwrap());
        self.latch(u16::from_le_bytes([outputs[0], outputs[1]]), position);
        let (status, latched) = self.drive.status.get();
        assert_eq!(inputs.len(), 6);
        images[1].inputs.extend(status.to_le_bytes());
        images[1].inputs.extend(latched.to_le_bytes());
        exchanged
    }

    fn device_state(&self, device: usize) -> DeviceState {
        self.inner.device_state(device)
    }

    fn round_trip(&self) -> Micros {
        self.inner.round_trip()
    }

    fn working_counter(&self) -> Option<(u16, u16)> {
        self.inner.working_counter()
    }

    fn clock(&self) -> Option<ClockReading> {
        self.inner.clock()
    }

    fn read_error_code(&mut self, device: usize) -> Option<u16> {
        self.inner.read_error_code(device)
    }
}

struct Probed {
    host: Host<HostedFieldBus<ProbedBus>, DirectStorage>,
    drive: Rc<ProbedDrive>,
}

/// A homed machine in MDI; Z stands 100 mm below its zero, the contact so many counts above it.
fn probed(contact: i32) -> Probed {
    let played = Shop::with_stations(MACHINE, Vec::new(), None, 0);
    let retained = PowerOnState::factory(Kind::Gc);
    let drive = Rc::new(ProbedDrive::default());
    drive.contact.set(contact);
    let devices = Rc::clone(&played.devices);
    // No contact is made but that of the pressure.
    let pressure = 1 << (retained.params.input_port(Input::HydraulicPressure) - 1);
    let quiet = retained.params.inverted_inputs() ^ pressure;
    let bus = ProbedBus {
        inner: played.bus(),
        drive: Rc::clone(&drive),
        signal: (retained.params.input_port(Input::Gauge4), quiet),
        inputs: Rc::new(move |bits| devices.inputs.set(bits)),
    };
    let description = MachineDescription::parse(&machine()).unwrap();
    let jobs = JobRunner::new(folders_of(Kind::Gc));
    let storage = DirectStorage::new(RetainedWorker::new(None), jobs).unwrap();
    let machine = HostedFieldBus::new(FieldBusMachine::new(description, bus, Vec::new()));
    let mut host = Host::connect(Kind::Gc, retained, machine, storage);
    host.begin();
    (0..300).for_each(|_| host.step());
    let mut probed = Probed { host, drive };
    for key in [Key::Hydraulic, Mode::Mdi.key()] {
        probed.press(key);
    }
    (0..4_000).for_each(|_| probed.host.step());
    probed
}

impl Probed {
    fn press(&mut self, key: Key) {
        self.host.send(Command::Press(key));
        self.host.step();
        self.host.send(Command::Release(key));
        self.host.step();
    }

    /// Runs an MDI line to its end; the alarms.
    fn mdi(&mut self, line: &str) -> Vec<String> {
        self.host.send(Command::Mdi(line.into()));
        (0..20).for_each(|_| self.host.step());
        for _ in 0..60_000 {
            self.host.step();
            if self.host.controller().state() != RunState::Running {
                break;
            }
        }
        self.host.snapshot().alarms.iter().map(|alarm| format!("{} {}", alarm.number, alarm.text.en())).collect()
    }

    /// #5062 from where Z stood at power-on, mm: the machine zero is 100 mm away.
    fn found(&self) -> f64 {
        self.host.controller().system_variable(5_062).unwrap() + 100.0
    }
}

/// At 600 mm/min the tick sees a terminal of 4 ms some 0.04 mm late.
#[test]
fn b2_g31_takes_the_place_that_the_drive_has_latched() {
    let mut probed = probed(5_003);
    assert_eq!(probed.mdi("G98 G31 W10 F600 P4"), [""; 0]);
    assert!((probed.found() - 5.003).abs() < 1e-9, "{}", probed.found());
    // The probe is not armed any more.
    (0..3).for_each(|_| probed.host.step());
    assert_eq!(probed.drive.status.get(), (0, 0));
    assert_eq!(probed.host.trace_row().inputs.latches[Axis::Z], None);
}

/// A pulse at the probe's input long before the contact is not the contact: the probe is armed anew. One less than 20 ms
/// before it cannot be told from it: 10 ms are 0.1 mm at 10 mm/s.
#[test]
fn b2_g31_with_a_pulse_of_noise_before_the_contact() {
    let mut early = probed(5_003);
    early.drive.noise.set(Some(1_000));
    assert_eq!(early.mdi("G98 G31 W10 F600 P4"), [""; 0]);
    assert!((early.found() - 5.003).abs() < 1e-9, "{}", early.found());
    let mut late = probed(5_003);
    late.drive.noise.set(Some(4_903));
    assert_eq!(late.mdi("G98 G31 W10 F600 P4"), [""; 0]);
    assert!((late.found() - 4.903).abs() < 1e-9, "{}", late.found());
}

/// FEED HOLD before, in and behind the edge: the place is that of the edge.
#[test]
fn b2_g31_keeps_the_latch_over_a_hold() {
    for hold_at in [2_000, 4_995, 5_004, 5_030] {
        let mut probed = probed(5_003);
        probed.host.send(Command::Mdi("G98 G31 W10 F600 P4".into()));
        while probed.drive.position.get() < hold_at {
            probed.host.step();
        }
        probed.press(Key::FeedHold);
        (0..1_000).for_each(|_| probed.host.step());
        probed.press(Key::CycleStart);
        (0..5_000).for_each(|_| probed.host.step());
        assert_eq!(probed.host.controller().state(), RunState::Idle, "{hold_at}");
        assert!((probed.found() - 5.003).abs() < 1e-9, "{hold_at}: {}", probed.found());
    }
}

/// The second of two G31 is measured anew, and a G31 that begins on the contact ends where it stands.
#[test]
fn b2_each_g31_has_a_latch_of_its_own() {
    let mut probed = probed(5_003);
    assert_eq!(probed.mdi("G98 G31 W10 F600 P4"), [""; 0]);
    assert_eq!(probed.mdi("G00 W-3"), [""; 0]);
    probed.drive.contact.set(4_321);
    assert_eq!(probed.mdi("G98 G31 W10 F60 P4"), [""; 0]);
    assert!((probed.found() - 4.321).abs() < 1e-9, "{}", probed.found());
    let stands = f64::from(probed.drive.position.get()) / 1_000.0;
    assert_eq!(probed.mdi("G98 G31 W10 F60 P4"), [""; 0]);
    assert!((probed.found() - stands).abs() < 0.005, "{} {stands}", probed.found());
}

/// A signal that a station reads comes too late for the latch.
#[test]
fn p1_the_signal_of_a_probe_is_on_the_bus() {
    let params = PowerOnState::factory(Kind::Gc).params;
    let port = u16::from(params.input_port(Input::Gauge4));
    let station = "stations: [(name: \"island\", address: \"127.0.0.1:502\", period_ms: 20, timeout_ms: 50, \
                   max_age_ms: 100, inputs: [(table: InputRegisters, from: 0, count: 1)])],";
    let inputs = format!(
        "{station} inputs: [(device: 3, count: {}, port: 1), (device: 101, port: {port}), (device: 3, bit: {port}, \
         count: {}, port: {})]",
        port - 1,
        64 - port,
        port + 1
    );
    let text = machine().replace("inputs: [(device: 3, count: 64, port: 1)]", &inputs);
    let text = text.replace(", brake: (port: 20, release_s: 0.05, engage_s: 0.03)", "");
    let described = MachineDescription::parse(&text).unwrap_or_else(|error| panic!("{error}"));
    let wrong = described.check_against(&params).unwrap_err().to_string();
    assert!(wrong.starts_with("z.touch_probe: gauge-4: must act in the cycle"), "{wrong}");
}

/// Another signal than the wired one: by the tick.
#[test]
fn b2_g31_of_another_signal_does_not_arm_the_probe() {
    let mut probed = probed(5_003);
    assert_eq!(probed.mdi("G98 G31 W10 F600 P3"), [""; 0]);
    assert!((probed.found() - 10.0).abs() < 1e-9, "no signal came");
    assert!(!probed.drive.was_armed.get());
}

/// The first contact at F, the second one at J: both places are those of the drive.
#[test]
fn k4_5_g78_takes_both_contacts_from_the_drive() {
    let mut probed = probed(5_003);
    assert_eq!(probed.mdi("G98 G78 Z-90 F600 J60 P4 L1"), [""; 0]);
    let found = [435, 436].map(|number| probed.host.snapshot().variables[number].unwrap() + 100.0);
    assert!(found.iter().all(|at| (at - 5.003).abs() < 1e-9), "{found:?}");
}

#[test]
fn p1_a_touch_probe_without_its_objects_is_refused() {
    let refused = |text: String| MachineDescription::parse(&text).unwrap_err().to_string();
    let wrong = refused(machine().replace("signal: 4", "signal: 7"));
    assert!(wrong.starts_with("z.touch_probe: the signal must be 1 to 6, or 9"), "{wrong}");
    for object in ["0x60b8", "0x60b9", "0x60ba"] {
        let wrong = refused(machine().replace(object, "0x2000"));
        assert!(wrong.starts_with("z.touch_probe: its drive needs 60B8h"), "{object}: {wrong}");
    }
    let wrong = refused(machine().replace("signal: 4", "signal: 4, falling: true"));
    assert!(wrong.contains("60BBh"), "{wrong}");
    assert!(MachineDescription::parse(&machine()).is_ok());
}

#[test]
fn b2_the_latch_is_exact_to_a_count_at_any_place() {
    for contact in [1, 4_999, 9_998] {
        let mut probed = probed(contact);
        assert_eq!(probed.mdi("G98 G31 W12 F300 P4"), [""; 0]);
        let found = probed.found() * 1_000.0;
        assert!((found - f64::from(contact)).abs() < 1e-6, "{contact} {found}");
    }
}
