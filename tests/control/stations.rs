//! Stations on Modbus TCP beside the bus, played here: their values, their silence, and the way back.

use std::sync::{Arc, Mutex, MutexGuard};

use kt830::defs::key::{Key, Mode};
use kt830::defs::kind::Kind;
use kt830::defs::param::{ParamAddress, Params};
use kt830::defs::signal::{Input, Output};
use kt830::io::drive::DriveState;
use kt830::io::fieldbus::FieldBusMachine;
use kt830::io::fieldbus::bus_fault::BusFault;
use kt830::io::fieldbus::description::MachineDescription;
use kt830::io::fieldbus::station::{StationFault, StationHealth, StationLink};
use kt830::io::{Backend, OutputImage};
use kt830::link::command::Command;
use kt830::units::{Axis, Micros};

use crate::field_bus::{MACHINE, Shop};

/// What a station has sent and got.
#[derive(Default)]
struct Wire {
    inputs: Vec<u8>,
    outputs: Vec<u8>,
    health: StationHealth,
    taken: u64,
    held: u32,
}

#[derive(Clone, Default)]
struct PlayedStation(Arc<Mutex<Wire>>);

impl PlayedStation {
    fn wire(&self) -> MutexGuard<'_, Wire> {
        self.0.lock().unwrap()
    }

    /// The station answers.
    fn answer(&self, inputs: &[u8]) {
        let mut wire = self.wire();
        wire.inputs = inputs.to_vec();
        wire.health.exchanges += 1;
        wire.health.fault = None;
    }

    fn fail(&self, fault: StationFault) {
        let mut wire = self.wire();
        wire.health.failures += 1;
        wire.health.fault = Some(fault);
    }
}

impl StationLink for PlayedStation {
    fn receive(&mut self, inputs: &mut [u8]) -> bool {
        let mut wire = self.wire();
        let is_new = wire.health.exchanges > wire.taken;
        wire.taken = wire.health.exchanges;
        if is_new {
            inputs.copy_from_slice(&wire.inputs);
        }
        is_new
    }

    fn send(&mut self, outputs: &[u8]) {
        self.wire().outputs = outputs.to_vec();
    }

    fn hold(&mut self, _: Micros) {
        self.wire().held += 1;
    }

    fn release(&mut self) {
        self.wire().health.locked = None;
    }

    fn health(&self) -> StationHealth {
        self.wire().health
    }
}

/// An inverter for the wheel: registers 0 and 1 are its controlword (bit 0 runs) and speed; it sends its statusword (bit 3
/// is a user input) and the count of a handwheel.
const STATION: &str = "stations: [(
        name: \"wheel inverter\", address: \"127.0.0.1:502\", period_ms: 20, timeout_ms: 50, max_age_ms: 100,
        inputs: [(table: InputRegisters, from: 0, count: 2)],
        outputs: [(table: HoldingRegisters, from: 0, count: 2)],
    )],
    wheel_speed: (device: 101, bit: 16, bits: 16, counts_at_10_v: 10000.0),
    handwheel: (device: 101, bit: 16, bits: 16, counts: 4.0),
    x:";

/// The port that no terminal of the bus has any more: that of the wheel.
fn machine(params: &Params) -> String {
    let wheel = params.output_port(Output::Wheel);
    let user = params.input_port(Input::User1);
    assert!(wheel == 1 && user > 1, "the blocks below leave them out: {wheel} {user}");
    let split = format!(
        "inputs: [(device: 3, count: {}, port: 1), (device: 101, bit: 3, port: {user}), (device: 3, bit: {user}, count: {}, port: {})],",
        user - 1,
        64 - user,
        user + 1
    );
    MACHINE.replacen("x:", STATION, 1).replacen("inputs: [(device: 3, count: 64, port: 1)],", &split, 1).replacen(
        "outputs: [(device: 3, count: 32, port: 1)],",
        "outputs: [(device: 101, port: 1), (device: 3, bit: 1, count: 31, port: 2)],",
        1,
    )
}

struct StationShop {
    shop: Shop,
    station: PlayedStation,
}

impl StationShop {
    fn new() -> Self {
        Self::of(&machine(&Params::factory(Kind::Gc)))
    }

    fn of(machine: &str) -> Self {
        let station = PlayedStation::default();
        station.answer(&[0, 0, 0, 0]);
        let shop = Shop::with_stations(machine, vec![Box::new(station.clone())], None, 0);
        Self { shop, station }
    }

    /// Ticks of 1 ms; the station answers in every twentieth.
    fn ticks(&mut self, ticks: u32, inputs: &[u8]) {
        for tick in 0..ticks {
            if tick % 20 == 0 {
                self.station.answer(inputs);
            }
            self.shop.ticks(1);
        }
    }
}

#[test]
fn p1_values_of_a_station_are_inputs_and_outputs_of_the_machine() {
    let mut at = StationShop::new();
    at.ticks(300, &[0, 0, 0, 0]);
    assert!(at.shop.alarms().is_empty(), "{:?}", at.shop.alarms());
    assert_eq!(at.station.wire().outputs, [0; 4]);
    at.ticks(100, &[0x08, 0, 0, 0]);
    assert!(at.shop.host.snapshot().inputs.has(Input::User1), "bit 3 of the statusword");
}

#[test]
fn p1_the_wheel_runs_by_the_registers_of_its_inverter() {
    let station = PlayedStation::default();
    let description = MachineDescription::parse(&machine(&Params::factory(Kind::Gc))).unwrap();
    let bus = Shop::with_stations(MACHINE, Vec::new(), None, 0).bus();
    let mut machine = FieldBusMachine::new(description, bus, vec![Box::new(station.clone())]);
    let mut outputs = OutputImage { wheel_volts: 5.0, ..OutputImage::default() };
    outputs.terminals.set(1, true);
    for (volts, terminals, registers) in [(5.0, true, [1, 5_000]), (-10.0, true, [1, -10_000]), (0.0, false, [0, 0])] {
        outputs.wheel_volts = volts;
        outputs.terminals.set(1, terminals);
        machine.write(Micros::ZERO, &outputs);
        let [c0, c1, s0, s1] = station.wire().outputs[..] else { panic!() };
        assert_eq!([i16::from_le_bytes([c0, c1]), i16::from_le_bytes([s0, s1])], registers);
    }
}

/// What one is as a fault, and what the alarm says.
#[test]
fn b8_a_station_that_falls_silent_stops_the_machine_and_reset_brings_it_back() {
    for (fault, words) in [
        (StationFault::TimedOut, "does not answer"),
        (StationFault::ConnectionRefused, "refuses the connection"),
        (StationFault::Exception(2), "exception 2 no such address"),
        (StationFault::Exception(99), "exception 99"),
    ] {
        let mut at = StationShop::new();
        at.ticks(300, &[0; 4]);
        at.shop.press(Mode::Manual.key());
        at.shop.press(Key::ZPlus);
        at.station.fail(fault);
        // The last answer is 20 ticks old, two more go by with the keys; values of 100 ms are still good.
        for tick in 0..78 {
            if tick % 50 == 0 {
                at.shop.host.send(Command::StillHeld(Key::ZPlus));
            }
            at.shop.ticks(1);
        }
        assert!(at.shop.alarms().is_empty() && !at.shop.host.controller().is_at_rest(), "{:?}", at.shop.alarms());
        at.shop.ticks(3);
        assert_eq!(at.shop.alarms(), [format!("405 remote station not responding: station 101 {words}")]);
        at.shop.ticks(500);
        assert!(at.shop.host.controller().is_at_rest() && !at.shop.host.trace_row().outputs.drives_on);
        // While it is silent, RESET does not bring the drives back.
        at.shop.press(Key::Reset);
        // RESET goes on for 2 s. Hydraulics that nobody has switched on are an alarm of their own by then (180).
        at.shop.ticks(2_100);
        let is_silent = |shop: &mut Shop| shop.alarms().iter().any(|alarm| alarm.starts_with("405"));
        assert!(is_silent(&mut at.shop) && !at.shop.host.trace_row().outputs.drives_on);
        at.ticks(40, &[0; 4]);
        assert!(is_silent(&mut at.shop), "an answer alone clears nothing");
        at.shop.press(Key::Reset);
        at.ticks(300, &[0; 4]);
        assert!(!is_silent(&mut at.shop), "{:?}", at.shop.alarms());
        assert_eq!(at.shop.drive(Axis::Z), DriveState::Enabled);
        // The encoders are on the bus: nothing is to be homed again.
    }
}

#[test]
fn p1_a_handwheel_that_was_turned_while_its_station_was_silent_moves_nothing() {
    let mut at = StationShop::new();
    at.ticks(300, &[0; 4]);
    let detents = |at: &mut StationShop, count: i16| {
        let [low, high] = count.to_le_bytes();
        at.station.answer(&[0, 0, low, high]);
        at.shop.ticks(1);
        at.shop.host.trace_row().inputs.handwheel_detents
    };
    assert_eq!(detents(&mut at, 8), 2);
    assert_eq!(detents(&mut at, -4), -3, "its counter wraps");
    at.shop.ticks(200);
    assert_eq!(at.shop.alarms().len(), 1);
    assert_eq!(detents(&mut at, 400), 0);
    assert_eq!(detents(&mut at, 408), 2);
}

/// Without a value of the station no drive comes on.
#[test]
fn b8_a_station_that_is_not_there_at_the_start_is_an_alarm() {
    let station = PlayedStation::default();
    station.fail(StationFault::Unreachable);
    let machine = machine(&Params::factory(Kind::Gc));
    let mut shop = Shop::with_stations(&machine, vec![Box::new(station)], None, 0);
    shop.ticks(1);
    assert_eq!(shop.alarms(), ["405 remote station not responding: station 101 cannot be reached"]);
    shop.ticks(300);
    assert!(!shop.host.trace_row().outputs.drives_on);
    assert_eq!(shop.drive(Axis::Z), DriveState::Off);
}

/// It may have been without power for less than the age of its values: nothing goes on again by itself.
#[test]
fn b8_a_station_that_keeps_its_outputs_off_stops_the_machine_until_reset() {
    let mut at = StationShop::new();
    at.ticks(300, &[0; 4]);
    at.station.wire().health.locked = Some(StationFault::ConnectedAnew);
    at.ticks(300, &[0; 4]);
    let text = "405 remote station not responding: station 101 is connected anew, its outputs are off";
    assert_eq!(at.shop.alarms(), [text]);
    let bus = at.shop.host.snapshot().bus.clone().unwrap();
    assert!(bus.stations[0].fault.is_some(), "the page says it, too");
    assert!(!at.shop.host.trace_row().outputs.drives_on);
    at.shop.press(Key::Reset);
    at.ticks(300, &[0; 4]);
    assert!(at.shop.alarms().is_empty(), "one RESET is enough: {:?}", at.shop.alarms());
    assert_eq!(at.shop.drive(Axis::Z), DriveState::Enabled);
}

/// RESET of a lost bus takes longer than the outputs of a station are good for: they are held meanwhile.
#[test]
fn b8_a_new_start_of_the_bus_holds_the_outputs_of_the_stations() {
    let mut at = StationShop::new();
    at.ticks(300, &[0; 4]);
    at.shop.devices.faults.borrow_mut().extend([BusFault::FrameLost; 5]);
    at.ticks(300, &[0; 4]);
    assert_eq!(at.station.wire().held, 0);
    at.shop.press(Key::Reset);
    at.ticks(300, &[0; 4]);
    assert_eq!(at.station.wire().held, 1);
    assert!(at.shop.alarms().is_empty(), "{:?}", at.shop.alarms());
}

/// Another process runs the machine: its stations get nothing from this one.
#[test]
fn b8_stations_of_a_machine_that_is_in_use_are_left_alone() {
    let station = PlayedStation::default();
    station.answer(&[0; 4]);
    let machine = machine(&Params::factory(Kind::Gc));
    let mut shop = Shop::with_stations(&machine, vec![Box::new(station.clone())], Some(BusFault::InUse), 0);
    shop.ticks(100);
    shop.press(Key::Reset);
    shop.ticks(100);
    assert!(station.wire().outputs.is_empty(), "{:?}", station.wire().outputs);
}

/// The alarm names the station that is silent when RESET is pressed, not the one that was.
#[test]
fn b8_reset_states_the_silence_of_now() {
    let stations = [PlayedStation::default(), PlayedStation::default()];
    stations.iter().for_each(|station| station.answer(&[0; 4]));
    let second = "(name: \"panel\", address: \"127.0.0.1:503\", period_ms: 20, timeout_ms: 50, max_age_ms: 100,
        inputs: [(table: Coils, from: 0, count: 32)])";
    let machine = machine(&Params::factory(Kind::Gc)).replacen("stations: [", &format!("stations: [{second},"), 1);
    let machine = machine.replace("device: 101", "device: 102");
    let links = stations.iter().map(|station| Box::new(station.clone()) as Box<dyn StationLink>).collect();
    let mut shop = Shop::with_stations(&machine, links, None, 0);
    let ticks = |shop: &mut Shop, count: u32, answering: usize| {
        for _ in 0..count {
            stations[answering].answer(&[0; 4]);
            shop.ticks(1);
        }
    };
    ticks(&mut shop, 200, 0);
    assert!(shop.alarms()[0].contains("station 102"), "{:?}", shop.alarms());
    ticks(&mut shop, 200, 1);
    shop.press(Key::Reset);
    ticks(&mut shop, 5, 1);
    assert_eq!(shop.alarms(), ["405 remote station not responding: station 101 does not answer"]);
}

#[test]
fn p1_a_wrong_station_is_refused_with_its_place() {
    let right = machine(&Params::factory(Kind::Gc));
    assert!(MachineDescription::parse(&right).is_ok());
    for (from, to, said) in [
        ("127.0.0.1:502", "127.0.0.1:0", "station 101: address: the port must not be 0"),
        ("127.0.0.1:502", "inverter:502", "invalid socket address"),
        ("period_ms: 20", "period_ms: 2", "station 101: period_ms: must be 5 to 1 000 ms"),
        ("timeout_ms: 50", "timeout_ms: 0", "station 101: timeout_ms"),
        ("timeout_ms: 50", "timeout_ms: 90", "station 101: max_age_ms: must be at least `period_ms` and"),
        ("port: 20", "port: 1", "x.brake: a brake is on the bus"),
        ("max_age_ms: 100", "max_age_ms: 30", "station 101: max_age_ms: must be at least twice"),
        ("inputs: [(table: InputRegisters, from: 0, count: 2)],", "", "station 101: inputs: something must be read"),
        (
            "table: InputRegisters, from: 0, count: 2",
            "table: InputRegisters, from: 65535, count: 2",
            "ends at address 65 535",
        ),
        (
            "table: InputRegisters, from: 0, count: 2",
            "table: InputRegisters, from: 0, count: 126",
            "1 to 125 registers",
        ),
        (
            "table: HoldingRegisters, from: 0, count: 2",
            "table: HoldingRegisters, from: 0, count: 0",
            "1 to 120 registers",
        ),
        ("table: HoldingRegisters", "table: InputRegisters", "coils and holding registers alone"),
        ("table: HoldingRegisters", "table: Registers", "Registers"),
        ("wheel_speed: (device: 101, bit: 16", "wheel_speed: (device: 102, bit: 16", "those of `stations` from 101"),
        ("wheel_speed: (device: 101, bit: 16", "wheel_speed: (device: 101, bit: 24", "the device has not so many bits"),
        ("wheel_speed: (device: 101, bit: 16", "wheel_speed: (device: 101, bit: 0", "an output has one writer"),
        ("x: (device: 1", "x: (device: 101", "x.device: there is no device of this number"),
    ] {
        let text = right.replacen(from, to, 1);
        assert_ne!(text, right, "{from}");
        let error = MachineDescription::parse(&text).expect_err(to).to_string();
        assert!(error.contains(said), "{to}: {error}");
    }
}

/// Signals that must act in the cycle are on the bus.
#[test]
fn p1_an_emergency_stop_at_a_station_is_refused() {
    let params = Params::factory(Kind::Gc);
    for input in [Input::EmergencyStop, Input::LimitXPlus, Input::GuardClosed, Input::DriveZ] {
        let user = params.input_port(Input::User1);
        let mut swapped = params.clone();
        let port = params.input_port(input);
        for (input, port) in [(Input::User1, 64), (input, user), (Input::User1, port)] {
            swapped.write(ParamAddress { number: input.port_param(), bit: None }, f64::from(port)).unwrap();
        }
        // The brake of these tests is at the port of a function.
        let description = MachineDescription::parse(&machine(&params).replacen("port: 20", "port: 32", 1)).unwrap();
        assert!(description.check_against(&params).is_ok());
        let error = description.check_against(&swapped).unwrap_err().to_string();
        assert!(error.contains(input.id()) && error.contains("on the bus"), "{error}");
    }
}

/// The age is what the page shows.
#[test]
fn p1_the_bus_page_has_the_age_of_the_values() {
    let mut at = StationShop::new();
    at.ticks(101, &[0; 4]);
    at.shop.ticks(250);
    let bus = at.shop.host.snapshot().bus.clone().unwrap();
    let station = &bus.stations[0];
    assert_eq!((station.number, station.name.as_str(), station.is_heard), (101, "wheel inverter", false));
    assert!(station.age >= Micros::from_millis(150), "{station:?}");
}

/// The station sends in its first byte the load of the inverter in half percent, in the second one its fault, in its
/// second register the speed in half r/min.
const INVERTER: &str = "inverter: (
        fault: (device: 101, bit: 8, bits: 8), reset: (device: 101, bit: 7),
        speed: (device: 101, bit: 16, bits: 16, counts: 2.0), load: (device: 101, bit: 0, bits: 8, counts: 2.0),
        faults: [(code: 17, zh: \"输出过流\", en: \"overcurrent\")],
    ),";

fn with_inverter() -> String {
    let handwheel = "handwheel: (device: 101, bit: 16, bits: 16, counts: 4.0),";
    machine(&Params::factory(Kind::Gc)).replacen(handwheel, INVERTER, 1)
}

#[test]
fn b8_a_fault_of_the_inverter_stops_the_machine_and_says_what_it_is() {
    let mut at = StationShop::of(&with_inverter());
    at.ticks(300, &[0; 4]);
    assert!(at.shop.alarms().is_empty(), "{:?}", at.shop.alarms());
    // Alarm 180 comes by itself: no pump runs here.
    let of_inverter = |at: &mut StationShop| -> Vec<String> {
        at.shop.alarms().into_iter().filter(|alarm| !alarm.starts_with("180")).collect()
    };
    let is_reset = |at: &StationShop| at.station.wire().outputs[0] & 0x80 != 0;
    for (code, says) in [(17, "17 overcurrent"), (9, "code 9")] {
        at.ticks(300, &[0, code, 0, 0]);
        assert_eq!(of_inverter(&mut at), [format!("407 inverter of the wheel in a fault: {says}")]);
        let bus = at.shop.host.snapshot().bus.clone().unwrap();
        assert!(bus.inverter.as_ref().unwrap().fault.is_some());
        // RESET resets the inverter for a second; while its fault is there the alarm stands.
        assert!(!is_reset(&at));
        at.shop.press(Key::Reset);
        at.ticks(200, &[0, code, 0, 0]);
        assert_eq!((is_reset(&at), of_inverter(&mut at).len()), (true, 1));
        assert!(!at.shop.host.trace_row().outputs.drives_on);
        at.ticks(1_000, &[0; 4]);
        assert_eq!((is_reset(&at), of_inverter(&mut at).len()), (false, 0), "one RESET is enough");
        assert_eq!(at.shop.drive(Axis::Z), DriveState::Enabled);
    }
}

#[test]
fn p1_the_bus_page_has_the_actual_speed_and_the_load_of_the_inverter() {
    let mut at = StationShop::of(&with_inverter());
    // 0xfed4 is -300: 150 r/min backwards.
    at.ticks(600, &[100, 0, 0xd4, 0xfe]);
    let bus = at.shop.host.snapshot().bus.clone().unwrap();
    let inverter = bus.inverter.clone().unwrap();
    assert_eq!((inverter.device, inverter.rpm, inverter.fault), (101, Some(-150.0), None));
    assert_eq!(at.shop.host.snapshot().wheel_load_percent(), Some(50.0), "the load display");
}

#[test]
fn p1_a_wrong_inverter_is_refused_with_its_place() {
    let text = with_inverter();
    for (from, to, says) in [
        ("bit: 8, bits: 8", "bit: 8, bits: 32", "inverter.fault: the device has not so many bits"),
        ("reset: (device: 101, bit: 7)", "reset: (device: 101, bit: 0)", "an output has one writer"),
        ("reset: (device: 101, bit: 7)", "reset: (device: 109, bit: 7)", "inverter.reset: there is no device"),
        ("bits: 16, counts: 2.0", "bits: 16, counts: 0.0", "inverter.speed: counts must not be 0"),
        ("bits: 8, counts: 2.0", "bits: 8, counts: 0.0", "inverter.load: counts must not be 0"),
        ("code: 17", "code: 0", "inverter.faults: code 0: 0 is no fault"),
        ("faults: [", "faults: [(code: 17, zh: \"\"), ", "inverter.faults: code 17: a code has one text"),
    ] {
        assert!(text.contains(from), "{from}");
        let said = MachineDescription::parse(&text.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(said.contains(says), "{said}");
    }
}
