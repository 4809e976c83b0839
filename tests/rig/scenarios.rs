//! The scenarios: a whole program from a cold start, then faults, each with its reaction and the way back.

use std::process::Command;

use kt830::io::drive::DriveState;
use kt830::io::fieldbus::description::{
    AbsoluteEncoder, ClockDescription, DigitalChannels, MachineDescription, ServoAxisDescription,
};
use kt830::io::trace::TraceRow;
use kt830::units::{Axis, PerAxis};

use crate::modbus;
use crate::plant::PlantLink;
use crate::session::{Scenario, Session, StoryPart, observe, simulated, tell};
use crate::wire::Wire;

/// A scenario on the machine as it is described.
const fn scenario(name: &'static str, play: fn(&mut Session<'_>)) -> Scenario {
    Scenario { name, describe: |_| {}, has_y: false, play, after_panic: None }
}

/// A scenario on a machine that differs from its description.
const fn differing(name: &'static str, describe: fn(&mut MachineDescription), play: fn(&mut Session<'_>)) -> Scenario {
    Scenario { name, describe, has_y: false, play, after_panic: None }
}

/// Every scenario.
pub const ALL: &[Scenario] = &[
    scenario("cold_start_o1002", |rig| grind(rig, 1_002)),
    scenario("cold_start_o1004", |rig| grind(rig, 1_004)),
    scenario("same_course", same_course),
    scenario("drive_fault_at_rest", drive_fault_at_rest),
    scenario("drive_fault_in_a_path", drive_fault_in_a_path),
    scenario("drive_blocked", drive_blocked),
    scenario("quick_stop_of_a_drive", quick_stop_of_a_drive),
    scenario("emergency_stop_in_a_path", emergency_stop_in_a_path),
    scenario("frames_lost", frames_lost),
    scenario("frame_late", frame_late),
    scenario("cable_behind_a_drive", cable_behind_a_drive),
    scenario("cable_at_the_control", cable_at_the_control),
    scenario("terminal_mute", terminal_mute),
    scenario("device_reset", device_reset),
    differing("distributed_clocks", with_clocks, distributed_clocks),
    differing("clock_jump", with_clocks, clock_jump),
    scenario("bus_slow", bus_slow),
    scenario("stuck_input", stuck_input),
    scenario("interface_gone", interface_gone),
    differing(
        "wrong_device",
        |machine| machine.devices.swap(1, 3),
        |rig| {
            different(rig, "device 2: E0000830h/1616h expected, 29Ch/3B11002h found");
        },
    ),
    differing(
        "foreign_revision",
        |machine| machine.devices[0].revision = 0x7777,
        |rig| {
            different(rig, "device 1: revision 7777h expected");
        },
    ),
    differing(
        "device_missing",
        |machine| machine.devices.push(machine.devices[4].clone()),
        |rig| {
            different(rig, "6 devices expected, 5 found");
        },
    ),
    differing(
        "other_process_data",
        |machine| machine.devices[3].inputs[0].count = 24,
        |rig| {
            different(rig, "device 4: 3/2 bytes of inputs/outputs expected, 2/2 found");
        },
    ),
    differing(
        "no_interface",
        |machine| machine.ethercat.interface = "kt-none".to_owned(),
        |rig| {
            different(rig, "no such network interface");
        },
    ),
    differing("absolute_encoders", with_absolute_encoders, absolute_encoders),
    differing("modbus_inverter", modbus::with_inverter, modbus::inverter),
    scenario("hold", hold),
    Scenario { has_y: true, ..differing("three_axes", with_third_axis, three_axes) },
    Scenario { after_panic: Some(outputs_are_safe), ..scenario("control_panics", wheel_on) },
];

/// What takes long: played by its name alone.
pub const LONG: &[Scenario] = &[scenario("ten_minutes", ten_minutes)];

/// The drives come on, hydraulics on.
fn power_on(rig: &mut Session<'_>) {
    rig.ticks_until("drives on", 1_000, |row| row.inputs.drives[Axis::X] == DriveState::Enabled);
    rig.story("expect no alarm\nkey 液压\nwait 3 s\nexpect input hydraulic-pressure on\n");
}

/// Homing over the switches.
fn home(rig: &mut Session<'_>) {
    rig.story("home all\nexpect machine X 0.000 ±0.01\nexpect machine Z 0.000 ±0.01\nexpect no alarm\n");
}

/// Ready for a program: homed, part between centres, wheel running.
pub fn ready(rig: &mut Session<'_>) {
    power_on(rig);
    home(rig);
    rig.story(
        "key 尾座进\nwait 2 s\nexpect input tailstock-advanced on\nkey 砂轮启动\nwait 10 s\nexpect output wheel on\n",
    );
}

/// A long move in both axes, on its way.
fn moving(rig: &mut Session<'_>) {
    ready(rig);
    long_move(rig);
}

/// The same from where the axes are.
pub fn long_move(rig: &mut Session<'_>) {
    rig.story("mode mdi\nmdi G01 U-100 W-100 F3000\nexpect state running\n");
}

/// The largest distance between set-points and encoders, mm.
fn following_error(row: &TraceRow) -> f64 {
    let of = |axis: Axis| (row.outputs.set_point_mm[axis] - row.inputs.encoder_mm[axis]).abs();
    of(Axis::X).max(of(Axis::Z))
}

/// Cold start, homing and a whole program, on the rig and on the simulated machine.
fn grind(rig: &mut Session<'_>, number: u32) {
    let begin =
        format!("part assets/parts/O{number}.ron\nload O{number}\nmode auto\nkey 循环启动\nexpect state running\n");
    ready(rig);
    let mut gauge = PlayedGauge::new(rig);
    rig.story(&begin);
    let (mut ticks, mut error_mm, mut lost) = (0_u32, 0.0_f64, 0_u32);
    let ended = |state: kt830::link::snapshot::RunState| state == kt830::link::snapshot::RunState::Idle;
    while !ended(rig.snapshot().state) {
        let row = rig.turn();
        gauge.follow(rig);
        ticks += 1;
        lost += u32::from(!row.inputs.bus_alive);
        error_mm = error_mm.max(following_error(&row));
        assert!(ticks < 600_000 && rig.snapshot().alarms.is_empty(), "{ticks} ticks, {:?}", rig.alarms());
    }
    let on_rig = end_position(rig.snapshot());
    let mut reference = simulated();
    tell(&mut reference, "power on\nkey 液压\nwait 4 s\nhome all\nkey 尾座进\nwait 2 s\nkey 砂轮启动\nwait 10 s\n");
    tell(&mut reference, &begin);
    let begun = reference.now();
    tell(&mut reference, "wait until idle max 600 s\nexpect no alarm\n");
    let off = on_rig.iter().zip(end_position(reference.snapshot())).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let simulated_s = reference.now().since(begun).as_secs_f64();
    let rig_s = f64::from(ticks) / 1_000.0;
    println!("  O{number}: {rig_s:.3} s on the rig, {simulated_s:.3} s simulated; end positions {off:.4} mm apart");
    println!("  following error up to {error_mm:.3} mm, {lost} ticks without the bus");
    assert!(off < 0.005, "{off}");
}

/// A story with a part, a hold, refusals and an emergency stop: what the operator sees is the same on both machines.
const STORY: &[StoryPart] = &[
    StoryPart::Tell(
        "load O1002\nmode auto\nkey 循环启动\nwait 1 s\nkey 砂轮启动\nwait 1 s\nkey 复位\nwait 1 s\nmode manual\nkey 液压\nwait 4 s\n\
         home all\nkey 循环启动\nwait 1 s\nmode auto\nkey 循环启动\nwait 1 s\nkey 复位\nwait 1 s\nmode manual\nkey 尾座进\nwait 3 s\n\
         key 砂轮启动\nwait 10 s\nkey 冷却\nwait 1 s\nkey 冷却\nwait 1 s\nkey 液压\nwait 1 s\n",
    ),
    StoryPart::Tell(
        "part assets/parts/O1002.ron\nmode auto\nkey 循环启动\nwait 6 s\nkey 进给保持\nwait 2 s\nexpect state held\nmode manual\nwait 1 s\n\
         key 循环启动\nwait until idle max 120 s\nexpect no alarm\nwait 1 s\n",
    ),
    StoryPart::Tell("mode mdi\nmdi G01 X9999 F100\nwait 1 s\nkey 复位\nwait 1 s\nmdi G01 U-20 W-20 F600\nwait 1 s\n"),
    StoryPart::EmergencyStop(true),
    StoryPart::Tell("wait 2 s\nkey 复位\nwait 1 s\nkey 砂轮启动\nwait 1 s\n"),
    StoryPart::EmergencyStop(false),
    StoryPart::Tell("wait 1 s\nkey 复位\nwait 3 s\nexpect no alarm\nhome all\nwait 1 s\nexpect no alarm\n"),
];

fn same_course(rig: &mut Session<'_>) {
    rig.ticks_until("drives on", 1_000, |row| row.inputs.drives[Axis::X] == DriveState::Enabled);
    rig.turns(1_000);
    let on_rig = rig.observe(STORY);
    let mut reference = simulated();
    tell(&mut reference, "power on\nwait 1 s\n");
    let on_simulator = observe(&mut reference, STORY, |stage, pressed| {
        tell(stage, if pressed { "input emergency-stop on" } else { "input emergency-stop off" });
    });
    let changes = on_rig.values.values().map(|values| values.len() - 1).sum::<usize>();
    let differences = on_rig.differences(&on_simulator);
    println!("  {changes} changes of {} quantities, {} differ", on_rig.values.len(), differences.len());
    assert!(changes > 30 && differences.is_empty(), "rig {}", differences.join("\n  "));
}

/// O1002 again and again: no cycle is lost, none is without the bus.
fn ten_minutes(rig: &mut Session<'_>) {
    ready(rig);
    rig.story("part assets/parts/O1002.ron\nload O1002\nmode auto\n");
    let (mut ticks, mut parts) = (0_u32, 0);
    while ticks < 600_000 {
        if rig.snapshot().state == kt830::link::snapshot::RunState::Idle {
            rig.story("key 循环启动\nexpect state running\n");
            parts += 1;
        }
        let row = rig.turn();
        ticks += 1;
        assert!(row.inputs.bus_alive && rig.snapshot().alarms.is_empty(), "tick {ticks}: {:?}", rig.alarms());
    }
    println!("  {ticks} ticks, {parts} parts begun");
}

/// The radial gauge of O1004: the part is where the wheel is. The rig has no gauge, so its stages are forced.
struct PlayedGauge {
    on: [bool; 4],
}

/// Inputs of the rig that are the stages, and how far above the finished size they come, mm (machine file of GC).
const GAUGE_STAGES: [(u8, f64); 4] = [(0, 0.1), (1, 0.02), (12, 0.005), (15, 0.0)];
/// Finished diameter of O1004's part, mm.
const GAUGE_SIZE_MM: f64 = 40.0;

impl PlayedGauge {
    fn new(rig: &mut Session<'_>) -> Self {
        GAUGE_STAGES.iter().for_each(|(bit, _)| rig.plant.send(&format!("force {bit} 0")));
        Self { on: [false; 4] }
    }

    fn follow(&mut self, rig: &mut Session<'_>) {
        let diameter = rig.snapshot().axes[Axis::X].work;
        for (was, (bit, above)) in self.on.iter_mut().zip(GAUGE_STAGES) {
            let on = diameter <= GAUGE_SIZE_MM + above;
            if on != *was {
                *was = on;
                rig.plant.send(&format!("force {bit} {}", u8::from(on)));
            }
        }
    }
}

fn end_position(snapshot: &kt830::link::snapshot::Snapshot) -> [f64; 2] {
    [snapshot.axes[Axis::X].machine, snapshot.axes[Axis::Z].machine]
}

/// A drive trips at rest: its code is read, RESET brings it back, and the axes are homed again.
fn drive_fault_at_rest(rig: &mut Session<'_>) {
    power_on(rig);
    rig.plant.send("fault Z 0x2310");
    rig.alarm(104, "Z 2310h continuous overcurrent");
    rig.story("key 复位\nwait 1 s\nexpect no alarm\n");
    home(rig);
}

/// The other axis stops along its path, without a jump, and everything goes safe.
fn drive_fault_in_a_path(rig: &mut Session<'_>) {
    moving(rig);
    rig.plant.send("fault X 0x3220");
    let tripped = rig.ticks_until("fault", 200, |row| row.inputs.drives[Axis::X].fault().is_some());
    let ticks = stop(rig);
    println!("  fault in the inputs after {tripped} ticks, standstill after {ticks} more");
    rig.alarm(104, "X 3220h DC link undervoltage");
    rig.story("expect output wheel off\nkey 复位\nwait 1 s\nexpect no alarm\n");
    home(rig);
}

/// Ticks until all set-points rest; a set-point must not jump meanwhile.
fn stop(rig: &mut Session<'_>) -> u32 {
    let (mut before, mut rests) = (rig.turn(), 0);
    for ticks in 1..1_000 {
        let row = rig.turn();
        let step = |axis: Axis| (row.outputs.set_point_mm[axis] - before.outputs.set_point_mm[axis]).abs();
        // 3000 mm/min are 0.05 mm in a tick of 1 ms; at the end of braking the set-point may take the encoder's place.
        let steps = PerAxis::from_fn(step);
        if before.outputs.drives_on && row.outputs.drives_on {
            assert!(steps[Axis::X] < 0.06 && steps[Axis::Z] < 0.06, "{steps:?}");
        }
        rests = if steps.0.iter().all(|step| *step < 1e-9) { rests + 1 } else { 0 };
        before = row;
        if rests == 5 {
            return ticks;
        }
    }
    panic!("it does not stop");
}

/// The slide is blocked: the drive's own supervision trips.
fn drive_blocked(rig: &mut Session<'_>) {
    ready(rig);
    rig.plant.send("stall Z on");
    rig.story("mode mdi\nmdi G01 W-100 F1200\n");
    let ticks = rig.ticks_until("alarm", 3_000, |row| !row.outputs.drives_on);
    println!("  {:?} after {ticks} ticks", rig.alarms());
    rig.plant.send("stall Z off");
    rig.story("wait 1 s\nkey 复位\nwait 1 s\nexpect no alarm\n");
    home(rig);
}

/// A drive stops by itself: it stays off, and the other axis stops along its path.
fn quick_stop_of_a_drive(rig: &mut Session<'_>) {
    moving(rig);
    rig.plant.send("qstop Z");
    rig.alarm(104, "Z has switched itself off");
    stop(rig);
    assert_eq!(rig.turn().inputs.drives[Axis::Z], DriveState::Off);
    rig.story("wait 1 s\nkey 复位\nwait 1 s\nexpect no alarm\n");
    home(rig);
}

/// Category 1: the axes stop along their path, then the torque goes; RESET after release brings everything back.
fn emergency_stop_in_a_path(rig: &mut Session<'_>) {
    moving(rig);
    rig.plant.send("estop press");
    let seen = rig.ticks_until("emergency stop", 200, |row| !row.outputs.terminals.is_closed(1));
    let ticks = rig.ticks_until("torque off", 1_000, |row| !row.outputs.drives_on);
    println!("  wheel output off after {seen} ticks, torque off {ticks} ticks later");
    assert!(rig.alarms().iter().any(|text| text.contains("emergency stop")), "{:?}", rig.alarms());
    rig.turns(1_000);
    rig.plant.send("estop release");
    rig.story("wait 1 s\nkey 复位\nwait 2 s\nexpect no alarm\n");
    home(rig);
}

/// As many lost frames as are bridged are no alarm; one more stops the machine.
fn frames_lost(rig: &mut Session<'_>) {
    moving(rig);
    for _ in 0..5 {
        rig.plant.send("lose 1");
        rig.turns(50);
    }
    assert!(rig.alarms().is_empty(), "{:?}", rig.alarms());
    rig.plant.send("lose 5");
    rig.alarm(402, "frames are lost");
    back(rig);
}

/// A reply that comes after its time-out is one lost frame, and the bus goes on.
fn frame_late(rig: &mut Session<'_>) {
    moving(rig);
    for _ in 0..5 {
        rig.plant.send("delay 15000 1");
        rig.turns(100);
    }
    assert!(rig.alarms().is_empty(), "{:?}", rig.alarms());
    rig.story("key 复位\nwait until idle max 10 s\n");
}

/// RESET sets the bus up again; the axes are homed again.
fn back(rig: &mut Session<'_>) {
    // A terminal that was away has dropped the tailstock for a moment: that alarm is right, and the second RESET clears it.
    rig.story("wait 1 s\nkey 复位\nwait 2 s\nkey 复位\nwait 1 s\nexpect no alarm\n");
    rig.ticks_until("drives on", 1_000, |row| row.inputs.drives[Axis::X] == DriveState::Enabled);
    home(rig);
}

fn cable_behind_a_drive(rig: &mut Session<'_>) {
    moving(rig);
    rig.plant.send("cable 1 2 out");
    rig.alarm(402, "device 3 does not answer");
    rig.story("expect output wheel off\n");
    // While it is out, RESET says so.
    rig.story("wait 1 s\nkey 复位\nwait 3 s\nexpect alarm 402\n");
    assert!(rig.alarms()[0].contains("device 3 does not answer"), "{:?}", rig.alarms());
    rig.plant.send("cable 1 2 in");
    back(rig);
}

fn cable_at_the_control(rig: &mut Session<'_>) {
    moving(rig);
    rig.plant.send("cable master out");
    rig.alarm(402, "frames are lost");
    rig.story("wait 1 s\nkey 复位\nwait 3 s\nexpect alarm 402\n");
    assert!(rig.alarms()[0].contains("no device answers"), "{:?}", rig.alarms());
    rig.plant.send("cable master in");
    back(rig);
}

/// A terminal lets the frames pass and takes no part: its inputs are not those of the machine.
fn terminal_mute(rig: &mut Session<'_>) {
    moving(rig);
    rig.plant.send("mute io on");
    rig.alarm(402, "device 4");
    rig.plant.send("mute io off");
    back(rig);
}

/// A terminal, then a drive, is reset while the axes move: it has lost address and settings. RESET sets all devices up.
fn device_reset(rig: &mut Session<'_>) {
    moving(rig);
    for device in [4, 2] {
        Wire::open().reset_device(device);
        let ticks = rig.alarm(402, &format!("device {device}"));
        println!("  device {device}: alarm after {ticks} ticks");
        rig.story("wait 1 s\nexpect output wheel off\n");
        back(rig);
        long_move(rig);
    }
}

/// The drives work at SYNC0.
fn with_clocks(machine: &mut MachineDescription) {
    machine.ethercat.distributed_clocks = Some(ClockDescription { cycle_us: 1_000, shift_us: None });
    machine.devices.iter_mut().take(3).for_each(|drive| drive.sync0 = true);
}

/// The third drive is axis Y; its home switch is a cam at input 1, its limit switches are those of X.
fn with_third_axis(machine: &mut MachineDescription) {
    machine.y = machine.x.clone().map(|axis| ServoAxisDescription { device: 3, ..axis });
    machine.devices[2].startup = machine.devices[0].startup.clone();
    let of_y = [(1, 1, 24), (13, 1, 32), (8, 2, 36)];
    let gauges = machine.inputs.iter_mut().find(|block| block.port == 7).expect("gauge signals");
    gauges.count = 1;
    machine.inputs.extend(of_y.map(|(bit, count, port)| DigitalChannels { device: 4, bit, count, port }));
}

/// Three axes homed from the panel, then moved along a line in space.
fn three_axes(rig: &mut Session<'_>) {
    // The slide of Y stands 30 mm below its home switch; travel rises where the axis falls.
    rig.plant.send("sim cam 3 1 2 -2000000000 -300000");
    power_on(rig);
    home(rig);
    rig.story("expect machine Y 0.000 ±0.01\n");
    assert_eq!(Axis::ALL.map(|axis| rig.snapshot().axes[axis].homed), [true; 3]);
    rig.story("mode mdi\nmdi G98 G53 G01 X-20 Y-10 Z-30 F600\nwait 6 s\nexpect no alarm\n");
    rig.story("expect machine X -20.000 ±0.005\nexpect machine Y -10.000 ±0.005\nexpect machine Z -30.000 ±0.005\n");
}

/// The encoders read 0 where X stands at 35 mm and Z at 120 mm of the plant, which counts against the axes.
fn with_absolute_encoders(machine: &mut MachineDescription) {
    for (axis, zero_counts) in [(&mut machine.x, -350_000), (&mut machine.z, -1_200_000)] {
        let axis = axis.as_mut().expect("an axis");
        axis.absolute = Some(AbsoluteEncoder { zero_counts });
    }
}

/// Homed from power-on on, at the places where the slides are; so again behind a broken cable.
fn absolute_encoders(rig: &mut Session<'_>) {
    power_on(rig);
    let homed = |rig: &mut Session<'_>| [Axis::X, Axis::Z].map(|axis| rig.snapshot().axes[axis].homed);
    assert_eq!(homed(rig), [true; 2]);
    rig.story("expect machine X -70.000\nexpect machine Z -120.000\nmode mdi\nmdi G53 G00 Z-100\nwait 4 s\n");
    rig.story("expect machine Z -100.000\n");
    rig.plant.send("cable 1 2 out");
    rig.alarm(402, "device 3 does not answer");
    rig.plant.send("cable 1 2 in");
    rig.story("wait 1 s\nkey 复位\nwait 2 s\nkey 复位\nwait 1 s\nexpect no alarm\nexpect machine Z -100.000\n");
    assert_eq!(homed(rig), [true; 2], "nothing was homed, nothing is to be");
}

/// The ticks follow the clock of the devices: half of the frames are within a tenth of a cycle of their place. Without
/// it they would be anywhere in it.
fn distributed_clocks(rig: &mut Session<'_>) {
    moving(rig);
    rig.turns(5_000);
    assert!(rig.alarms().is_empty(), "{:?}", rig.alarms());
    let clock = rig.snapshot().bus.as_deref().and_then(|bus| bus.clock).expect("clocks");
    assert!(clock.distance.percentiles.median.0 < 100, "{clock:?}");
    // A device that falls out of operation comes back with its clock.
    rig.plant.send("cable 1 2 out");
    rig.alarm(402, "device 3 does not answer");
    rig.plant.send("cable 1 2 in");
    back(rig);
}

/// The clock of the bus jumps by 0.4 of a cycle, forward and backward: the drives would take their set-points at another time.
fn clock_jump(rig: &mut Session<'_>) {
    moving(rig);
    rig.turns(2_000);
    assert!(rig.alarms().is_empty(), "{:?}", rig.alarms());
    for ns in [400_000, -400_000] {
        Wire::open().move_clock(1, ns);
        let ticks = rig.alarm(402, "the clock of the bus has jumped");
        println!("  {ns} ns: alarm after {ticks} ticks");
        rig.story("wait 1 s\nexpect output wheel off\n");
        back(rig);
        rig.turns(5_000);
        assert!(rig.alarms().is_empty(), "{:?}", rig.alarms());
        let clock = rig.snapshot().bus.as_deref().and_then(|bus| bus.clock).expect("clocks");
        println!("  {clock:?}");
    }
}

/// Frames take longer than the cycle: ticks are late, and after ten in a row the machine stops.
fn bus_slow(rig: &mut Session<'_>) {
    moving(rig);
    rig.plant.send("delay 3000 200");
    let ticks = rig.alarm(401, "control cycle late");
    println!("  alarm after {ticks} ticks");
    stop(rig);
    rig.story("expect output wheel off\nwait 1 s\nkey 复位\nwait 1 s\nexpect no alarm\n");
    rig.ticks_until("drives on", 1_000, |row| row.inputs.drives[Axis::X] == DriveState::Enabled);
    rig.story("key 砂轮启动\nwait 10 s\nexpect output wheel on\n");
}

/// A home switch that never opens is no zero point.
fn stuck_input(rig: &mut Session<'_>) {
    power_on(rig);
    rig.plant.send("force 7 1");
    rig.story("mode home\nkey Z+\nwait 2 s\n");
    println!("  {:?} {:?}", rig.alarms(), rig.snapshot().axes[Axis::Z].homed);
    assert!(!rig.snapshot().axes[Axis::Z].homed);
    rig.plant.send("force 7 off");
    rig.story("wait 1 s\nkey 复位\nwait 1 s\nexpect no alarm\n");
    home(rig);
}

fn interface_gone(rig: &mut Session<'_>) {
    moving(rig);
    let interface = std::env::var("KT_ETHERCAT_IF").expect("interface");
    let set = |state: &str| {
        let set = Command::new("ip").args(["link", "set", &interface, state]).status().expect("ip");
        assert!(set.success());
    };
    set("down");
    rig.alarm(402, "frames are lost");
    set("up");
    back(rig);
}

/// A machine that differs from its description stands, says why, and no output goes on.
fn different(rig: &mut Session<'_>, words: &str) {
    rig.alarm(402, words);
    rig.story("key 液压\nwait 1 s\nkey 复位\nwait 1 s\nexpect alarm 402\n");
    let row = rig.turn();
    assert!(row.inputs.drives.0.iter().all(|drive| *drive == DriveState::Off) && !row.outputs.drives_on);
    let on: Vec<_> = rig.plant.outputs().into_iter().filter(|(_, on)| *on).collect();
    assert!(on.is_empty(), "{on:?}");
}

/// The wheel runs and the axes move; then the control fails by a panic.
fn wheel_on(rig: &mut Session<'_>) {
    moving(rig);
}

/// The wheel runs for a while: the process is killed meanwhile.
fn hold(rig: &mut Session<'_>) {
    power_on(rig);
    rig.story("mode manual\nkey 尾座进\nwait 2 s\nkey 砂轮启动\nwait 1 s\nexpect output wheel on\nwait 15 s\n");
}

/// The bus goes on with the safe image: the outputs are off by it, not by the watchdogs of the devices, and the drives
/// have no torque.
fn outputs_are_safe(plant: &mut PlantLink) {
    let status = plant.status();
    println!("  after the panic: outputs {}, X {}", status["outputs"], status["axes"]["X"]["state"]);
    let outputs =
        status["outputs"].as_str().and_then(|word| u16::from_str_radix(word.trim_start_matches("0x"), 16).ok());
    // Clamps and their pressure hold (tailstock, bit 3; hydraulic, bit 9); a watchdog would have switched them off, too.
    assert_eq!(outputs, Some(1 << 3 | 1 << 9));
    for axis in ["X", "Z"] {
        assert_ne!(status["axes"][axis]["state"], "operation enabled");
        assert_eq!(status["axes"][axis]["error"], "0x0000");
    }
}
