//! Absolute encoders: the axes are homed from power-on on; a doubtful position waits for HOME.

use kt830::controller::PowerOnState;
use kt830::defs::key::{Key, Mode};
use kt830::defs::kind::Kind;
use kt830::defs::leadscrew::LeadscrewCompensation;
use kt830::host::headless::{HeadlessHost, HostSetup};
use kt830::io::drive::DriveState;
use kt830::io::fieldbus::bus_fault::BusFault;
use kt830::io::fieldbus::cia402::PowerState;
use kt830::io::sim::MachineFile;
use kt830::units::Axis;

use crate::field_bus::{MACHINE, Shop};
use crate::stories::{folders, tell};

/// The machine with absolute encoders, whose counts at the machine zero are these.
fn shop(zero_counts: [i32; 2], position: i32) -> Shop {
    let [x, z] = zero_counts;
    let machine = MACHINE
        .replace("reversed: true,", &format!("reversed: true, absolute: (zero_counts: {x}),"))
        .replace("counts_per_mm: 1000.0)", &format!("counts_per_mm: 1000.0, absolute: (zero_counts: {z}))"));
    Shop::with_stations(&machine, Vec::new(), None, position)
}

fn homed(shop: &mut Shop) -> [bool; 2] {
    let axes = &shop.host.snapshot().axes;
    [axes[Axis::X].homed, axes[Axis::Z].homed]
}

#[test]
fn b5_absolute_encoders_need_no_homing() {
    // X is reversed: 40 000 counts above its zero are -40 mm, shown as a diameter of -80. Z stands 30 mm below its zero.
    let mut shop = shop([60_000, 130_000], 100_000);
    shop.ticks(200);
    let axes = &shop.host.snapshot().axes;
    let shown = [axes[Axis::X].machine, axes[Axis::Z].machine];
    assert!((shown[0] + 80.0).abs() < 1e-9 && (shown[1] + 30.0).abs() < 1e-9, "{shown:?}");
    assert_eq!((homed(&mut shop), shop.drive(Axis::Z)), ([true; 2], DriveState::Enabled));
    assert!(shop.alarms().is_empty());
    assert_eq!(shop.devices.drives.borrow().map(|drive| drive.largest_step), [0; 2], "nothing has moved");
    // The soft limits hold from power-on on: without homing a jog goes on.
    shop.jog(Key::ZPlus, 5_000);
    let at = shop.host.snapshot().axes[Axis::Z].machine;
    let limit = PowerOnState::factory(Kind::Gc).params.get_axis(kt830::defs::param::SOFT_PLUS_X, Axis::Z);
    assert!(at <= limit + 1e-3, "{at} {limit}");
}

#[test]
fn b5_the_zero_of_an_absolute_encoder_may_lie_beyond_the_wrap_of_its_counter() {
    // 0x8000_0100 as a count is -2 147 483 392: 512 counts above the zero at 0x7fff_ff00.
    let mut shop = shop([0x7fff_ff00; 2], (0x7fff_ff00_i32).wrapping_add(512));
    shop.ticks(200);
    let at = shop.host.snapshot().axes[Axis::Z].machine;
    assert!((at - 0.512).abs() < 1e-9, "{at}");
}

#[test]
fn b5_a_lost_bus_costs_no_homing_where_the_encoders_are_absolute() {
    let mut shop = shop([80_000, 100_000], 90_000);
    shop.ticks(200);
    shop.devices.faults.borrow_mut().extend([BusFault::FrameLost; 3]);
    shop.ticks(10);
    assert_eq!(homed(&mut shop), [false; 2], "nobody sees the encoders");
    // The slide is pushed by hand meanwhile.
    shop.ticks(500);
    shop.devices.drives.borrow_mut()[1].position -= 5_000;
    shop.press(Key::Reset);
    shop.ticks(200);
    assert!(shop.alarms().is_empty(), "{:?}", shop.alarms());
    let at = shop.host.snapshot().axes[Axis::Z].machine;
    assert!(homed(&mut shop) == [true; 2] && (at + 15.0).abs() < 1e-9, "{at}");
}

#[test]
fn b5_a_fault_of_the_encoder_makes_its_position_doubtful_until_home() {
    let mut shop = shop([80_000, 100_000], 90_000);
    shop.ticks(200);
    // 7305h: incremental sensor 1 faulty (CiA 402-2). 2310h, overcurrent, says nothing about the position.
    for (code, homes_itself) in [(0x2310, true), (0x7305, false)] {
        {
            let mut drives = shop.devices.drives.borrow_mut();
            (drives[1].error_code, drives[1].state) = (code, PowerState::Fault);
        }
        shop.ticks(300);
        assert!(shop.alarms()[0].contains(&format!("Z {code:04X}h")), "{:?}", shop.alarms());
        shop.press(Key::Reset);
        shop.ticks(300);
        assert!(shop.alarms().is_empty(), "{:?}", shop.alarms());
        assert_eq!(homed(&mut shop), [true, homes_itself], "{code:x}");
    }
    // HOME moves the axis to its zero point; there the person sees whether it is right.
    shop.press(Mode::Home.key());
    shop.press(Key::ZPlus);
    shop.ticks(1_000);
    assert_eq!((homed(&mut shop), shop.alarms()), ([true; 2], Vec::new()));
    let at = shop.host.snapshot().axes[Axis::Z].machine;
    let home = PowerOnState::factory(Kind::Gc).params.get_axis(kt830::defs::param::HOME_X, Axis::Z);
    assert!((at - home).abs() < 1e-3, "{at} {home}");
}

/// The built-in grinder with absolute encoders and a leadscrew that is 0.1 mm long at Z-100.
fn rig() -> HeadlessHost {
    let mut retained = PowerOnState::factory(Kind::Gc);
    retained.leadscrew_tables[Axis::Z] = LeadscrewCompensation::parse("-200,0,0.2\n0,0,0\n").unwrap();
    let setup = HostSetup { kind: Kind::Gc, retained, store: None, folders: folders(), seed: 1 };
    let mut rig = HeadlessHost::new(setup).unwrap();
    let text = Kind::Gc.row().machine_file.replace("power_on_mm:", "absolute: true, power_on_mm:");
    rig.swap_machine(MachineFile::parse(&text).unwrap(), 1);
    rig
}

#[test]
fn b5_b7_the_leadscrew_table_counts_from_power_on_on_and_the_axis_does_not_move_for_it() {
    let mut rig = rig();
    tell(&mut rig, "wait 1 s\nexpect no alarm");
    let row = rig.trace_row();
    assert!(row.inputs.absolute[Axis::Z] && rig.snapshot().axes[Axis::X].homed && rig.snapshot().axes[Axis::Z].homed);
    let set = row.outputs.set_point_mm[Axis::Z];
    assert!((set - row.inputs.encoder_mm[Axis::Z]).abs() < 1e-6, "{set}");
    // The slide is 0.001 mm further in plus for each mm below zero: machine = encoder - 0.001 * machine.
    let (machine, encoder) = (rig.snapshot().axes[Axis::Z].machine, row.inputs.encoder_mm[Axis::Z]);
    assert!(encoder < -1.0 && (machine - encoder / 1.001).abs() < 1e-6, "{machine} {encoder}");
}

#[test]
fn b5_after_a_limit_switch_an_absolute_axis_is_homed_by_hand() {
    let mut rig = rig();
    tell(
        &mut rig,
        "wait 1 s\ninput limit-z-plus on\nwait 0.5 s\ninput limit-z-plus off\nkey reset\nwait 1 s\nexpect no alarm",
    );
    assert!(!rig.snapshot().axes[Axis::Z].homed && rig.snapshot().axes[Axis::X].homed);
    tell(&mut rig, "key hydraulic\nwait 4 s\nmode home\nkey Z+\nwait 30 s\nexpect no alarm");
    assert!(rig.snapshot().axes[Axis::Z].homed);
}

#[test]
fn k5_16_an_absolute_wheel_axis_withdraws_before_another_axis_is_homed() {
    // Z has an incremental encoder; X stands at -40 mm, at the part.
    let machine = MACHINE.replace("reversed: true,", "reversed: true, absolute: (zero_counts: 60000),");
    let mut shop = Shop::with_stations(&machine, Vec::new(), None, 100_000);
    shop.ticks(200);
    assert_eq!(homed(&mut shop), [true, false]);
    shop.press(Mode::Home.key());
    shop.press(Key::ZPlus);
    let z = |shop: &mut Shop| shop.host.snapshot().axes[Axis::Z].machine;
    let start = z(&mut shop);
    shop.ticks(300);
    let x = shop.host.snapshot().axes[Axis::X].machine;
    assert!(x > -79.0 && (z(&mut shop) - start).abs() < 1e-9, "X moves first: {x}");
    shop.ticks(2_000);
    assert!(shop.host.snapshot().axes[Axis::X].machine.abs() < 1e-3 && z(&mut shop) > start + 0.1);
}

#[test]
fn b5_a_position_beyond_the_limits_is_not_believed_and_home_does_not_follow_it() {
    // 30 m above the zero point: turns of the encoder were lost.
    let mut shop = shop([90_000, -29_900_000], 100_000);
    shop.ticks(200);
    let at = shop.host.snapshot().axes[Axis::Z].machine;
    assert_eq!((homed(&mut shop), shop.alarms().len()), ([true, false], 0), "{at}");
    let before = shop.devices.drives.borrow()[1].position;
    shop.press(Mode::Home.key());
    shop.press(Key::ZPlus);
    // X withdraws first.
    shop.ticks(1_500);
    let alarms = shop.alarms().join("\n");
    assert!(alarms.contains("Z is further than P60 from its zero point"), "{alarms}");
    assert_eq!(shop.devices.drives.borrow()[1].position, before);
}
