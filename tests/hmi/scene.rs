//! The live scene: what the magnifier says of the contact is what the simulated machine does.
//! Source: spec B6, H8, P5.

use kt830::controller::PowerOnState;
use kt830::defs::grinding_workspace::PartSection;
use kt830::defs::key::Key;
use kt830::hmi::repaint::changed_field;
use kt830::hmi::scene::{MachineScene, Magnifier};
use kt830::host::headless::{HeadlessHost, HostSetup};
use kt830::io::sim::PartFile;
use kt830::link::command::Command;
use kt830::link::snapshot::RunState;

/// Ticks between two looks, and the most looks until the part is ground.
const STRIDE: u32 = 20;
const LONGEST: u32 = 20_000;
/// A wheel that grinds is drawn at most so far above the part, µm: half of the blank's runout of 0.02 mm, for the mean is drawn and
/// the highest point is ground, and a slice of the rim, 1 mm on the taper 1:50 of O1006, 10 µm of radius.
const DRAWN_UM: f64 = 20.0;
/// It is drawn at most so deep in the part, µm: the deflection of wheel and part under the force.
const ENGAGED_UM: f64 = 200.0;
/// Looks after the first contact.
const ENGAGED_STRIDES: u32 = 100;

/// A control that grinds a program's part, at its start.
fn started(program: &str) -> HeadlessHost {
    let part = PartFile::builtin(kt830::defs::program_number::from_name(program)).unwrap().unwrap();
    let retained = PowerOnState::factory(part.kind);
    let folders = crate::stories::folders_of(part.kind);
    let mut rig = HeadlessHost::new(HostSetup { kind: part.kind, retained, store: None, folders, seed: 1 }).unwrap();
    rig.mount_part(&part);
    rig.step();
    rig.make_ready();
    rig.mount_part(&part);
    let number = rig.find_program(program).unwrap();
    rig.send(Command::LoadProgram(number));
    rig.step();
    rig.send(Command::Press(Key::CycleStart));
    rig.step();
    rig.send(Command::Release(Key::CycleStart));
    rig
}

fn gap_um(rig: &mut HeadlessHost) -> Option<f64> {
    let snapshot = rig.snapshot();
    let scene = MachineScene::of(snapshot).expect("a grinding machine has a scene");
    Magnifier::of(&scene, snapshot).map(|contact| contact.gap_um())
}

fn part(rig: &HeadlessHost) -> Vec<PartSection> {
    rig.machine().grinding_workspace().unwrap().part
}

/// Steps until the wheel takes something of the part.
fn step_to_removal(rig: &mut HeadlessHost) {
    for _ in 0..LONGEST {
        let before = part(rig);
        (0..STRIDE).for_each(|_| rig.step());
        assert_eq!(rig.controller().state(), RunState::Running);
        if part(rig) != before {
            return;
        }
    }
    panic!("the wheel never grinds");
}

#[test]
fn h8_the_magnifier_is_engaged_where_the_machine_grinds_and_shows_a_gap_before() {
    // An outside, a cone, a face by the side of the wheel, a plane under strokes, a disc on the rotary table, an outside
    // from above.
    for program in ["O1002", "O1006", "O1005", "O1007", "O1010", "VGRIND"] {
        let mut rig = started(program);
        let mut gaps = Vec::new();
        let unground = part(&rig);
        while part(&rig) == unground {
            gaps.extend(gap_um(&mut rig));
            (0..STRIDE).for_each(|_| rig.step());
            assert_eq!(rig.controller().state(), RunState::Running, "{program}");
        }
        // Of the two faces of O1005 the nearer one is shown: that of the reference, which the gauge touches, too.
        assert!(gaps.iter().any(|gap| *gap > 0.0), "{program}: no gap was seen on the way");
        (0..ENGAGED_STRIDES * STRIDE).for_each(|_| rig.step());
        step_to_removal(&mut rig);
        let gap = gap_um(&mut rig);
        // The wheel is drawn at most a revolution's infeed inside: the part is brought up to date every look.
        assert!(gap.is_some_and(|gap| (-ENGAGED_UM..DRAWN_UM).contains(&gap)), "{program}: {gap:?}");
    }
}

#[test]
fn h8_a_wheel_that_turns_asks_for_a_frame_every_40_ms_and_one_that_stands_for_none() {
    let mut rig = crate::stories::ready();
    crate::stories::tell(&mut rig, "page position\nwait 0.2 s");
    let standing = rig.snapshot().clone();
    rig.step();
    let mut later = standing.clone();
    later.now.0 += 80_000;
    assert_eq!(changed_field(&standing, &later), None);
    crate::stories::tell(&mut rig, "key wheel-start\nwait 8 s");
    let turning = rig.snapshot().clone();
    let mut later = turning.clone();
    later.now.0 += 40_000;
    assert_eq!(changed_field(&turning, &later), Some("now"));
}
