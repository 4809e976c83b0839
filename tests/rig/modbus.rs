//! The wheel's inverter as a Modbus TCP station, by a server that was not written here (pymodbus): its values, its
//! silence, and the way back.

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, Command, Stdio};
use std::sync::LazyLock;
use std::sync::mpsc::{Receiver, channel};

use kt830::io::fieldbus::channel::WordChannel;
use kt830::io::fieldbus::description::{DigitalChannels, MachineDescription};
use kt830::io::fieldbus::inverter::{InverterDescription, InverterFaultText};
use kt830::io::fieldbus::station_description::{FIRST_STATION, ModbusBlock, ModbusTable, StationDescription};
use kt830::io::trace::TraceRow;

use crate::scenarios::{long_move, ready};
use crate::session::Session;

const PORT: u16 = 5_020;
/// Port of the input that is bit 3 of the statusword.
const STATUS_PORT: u8 = 60;

/// The wheel runs by the inverter, not by the terminal.
pub fn with_inverter(machine: &mut MachineDescription) {
    if !*HAS_SERVER {
        return;
    }
    let block = |table, from| ModbusBlock { table, from, count: 2 };
    machine.stations.push(StationDescription {
        name: "wheel inverter".to_owned(),
        address: ([127, 0, 0, 1], PORT).into(),
        unit: 1,
        period_ms: 20,
        timeout_ms: 100,
        max_age_ms: 300,
        inputs: vec![block(ModbusTable::InputRegisters, 10)],
        outputs: vec![block(ModbusTable::HoldingRegisters, 0)],
    });
    let wheel = &mut machine.outputs[0];
    (wheel.bit, wheel.count, wheel.port) = (wheel.bit + 1, wheel.count - 1, wheel.port + 1);
    let channel = |bit, port| DigitalChannels { device: FIRST_STATION, bit, count: 1, port };
    machine.outputs.push(channel(0, 1));
    machine.inputs.push(channel(3, STATUS_PORT));
    let overcurrent = InverterFaultText { code: 17, zh: "过流".to_owned(), en: "overcurrent".to_owned() };
    machine.inverter = Some(InverterDescription {
        fault: WordChannel { device: FIRST_STATION, bit: 8, bits: 8 },
        faults: vec![overcurrent],
        reset: None,
        speed: None,
        load: None,
    });
    let speed = machine.wheel_speed.as_mut().expect("wheel speed");
    (speed.device, speed.bit, speed.counts_at_10_v) = (FIRST_STATION, 16, 10_000.0);
}

/// The server; it ends with the scenario.
struct Inverter {
    process: Child,
    lines: Receiver<String>,
}

impl Inverter {
    fn start() -> Self {
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/rig/modbus_server.py");
        let mut process = Command::new("python3")
            .args([script, &PORT.to_string()])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("python3");
        let reader = BufReader::new(process.stdout.take().expect("its output"));
        let (sender, lines) = channel();
        std::thread::spawn(move || reader.lines().map_while(Result::ok).try_for_each(|line| sender.send(line)));
        Self { process, lines }
    }

    fn status(&mut self, word: u16) {
        writeln!(self.process.stdin.as_mut().expect("its input"), "status {word}").expect("inverter");
    }

    fn signal(&self, name: &str) {
        let sent = Command::new("kill").args([name, &self.process.id().to_string()]).status().expect("kill");
        assert!(sent.success());
    }

    /// The last line since the last call.
    fn newest(&self) -> String {
        self.lines.try_iter().last().unwrap_or_default()
    }
}

impl Drop for Inverter {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Whether the server can be run. Asked before the control starts: it takes longer than the watchdogs of the devices.
static HAS_SERVER: LazyLock<bool> = LazyLock::new(|| {
    let asked = Command::new("python3").args(["-c", "import pymodbus.simulator"]).stderr(Stdio::null()).status();
    asked.is_ok_and(|status| status.success())
});

const RESET: &str = "wait 1 s\nkey 复位\nwait 1 s\nexpect no alarm\n";

/// The inverter is switched on after the control; it runs, hangs in a path, goes on, is switched off and on again.
pub fn inverter(rig: &mut Session<'_>) {
    if !*HAS_SERVER {
        panic!("NOT tested: python3 has no pymodbus 3.16 or newer");
    }
    rig.alarm(405, "station 101 refuses the connection");
    let mut inverter = Inverter::start();
    rig.ticks_until("the inverter", 2_500, |row| !row.inputs.station_silent);
    rig.story("key 复位\nwait 0.3 s\nexpect no alarm\n");
    ready(rig);
    println!("  wheel on: {}", running(&inverter));
    let on = |row: &TraceRow| row.inputs.terminals.is_closed(STATUS_PORT);
    inverter.status(8);
    let ticks = rig.ticks_until("bit 3 of the statusword", 500, on);
    println!("  its statusword in the inputs after {ticks} ticks");
    long_move(rig);
    inverter.status(17 << 8);
    let ticks = rig.alarm(407, "17 overcurrent");
    let stopped = rig.ticks_until("torque off", 1_000, |row| !row.outputs.drives_on);
    println!("  fault 17: alarm after {ticks} ticks, torque off {stopped} ticks later");
    rig.story("expect output wheel off\nkey 复位\nwait 1 s\nexpect alarm 407\n");
    inverter.status(0);
    rig.story("wait 0.5 s\nkey 复位\nwait 1 s\nexpect no alarm\n");
    long_move(rig);
    inverter.signal("-STOP");
    let ticks = rig.alarm(405, "station 101 does not answer");
    let stopped = rig.ticks_until("torque off", 1_000, |row| !row.outputs.drives_on);
    println!("  hangs: alarm after {ticks} ticks, torque off {stopped} ticks later");
    rig.story("expect output wheel off\nkey 复位\nwait 1 s\nexpect alarm 405\n");
    inverter.signal("-CONT");
    rig.story(RESET);
    assert!(inverter.newest().starts_with("control 0 speed"), "it has been told to stop");
    // The encoders were on the bus all the time.
    assert!(rig.snapshot().axes.iter().all(|(_, axis)| axis.homed || axis.machine == 0.0));
    rig.story("mode mdi\nmdi G01 U50 W50 F3000\nexpect state running\n");
    drop(inverter);
    let ticks = rig.alarm(405, "station 101");
    println!("  switched off: alarm after {ticks} ticks");
    let inverter = Inverter::start();
    rig.story("wait 2 s\n");
    rig.story(RESET);
    rig.story("mode manual\nkey 砂轮启动\nwait 10 s\nexpect output wheel on\n");
    println!("  back: {}", running(&inverter));
}

/// What the inverter was told last: to run, at a speed.
fn running(inverter: &Inverter) -> String {
    let line = inverter.newest();
    let speed = line.strip_prefix("control 1 speed ").and_then(|speed| speed.parse::<u16>().ok());
    assert!(speed.is_some_and(|speed| speed > 0), "{line}");
    line
}
