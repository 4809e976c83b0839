//! One shift at the cylindrical grinder, from the cold start to the second part, done twice: by touch alone and by
//! keyboard alone. Both end with parts of the same size and the same course of the outputs. The surface grinder and the
//! rotary-table grinder do a shorter one. Source: spec H6, B6 (everything reachable by touch and by keyboard), K2.1.

use std::fs;
use std::path::Path;

use crate::operators::{Hand, Operator};
use egui::Key::{ArrowRight, Enter};
use egui::Modifiers;
use kt830::defs::key::Key;
use kt830::defs::kind::{Dialect, Kind};
use kt830::defs::page::Page;
use kt830::host::folders::Folders;
use kt830::io::sim::PartFile;
use kt830::link::snapshot::RunState;
use kt830::units::Axis;

/// What a shift came to.
#[derive(Debug)]
struct Outcome {
    /// Sizes of every part, as measured.
    sizes: Vec<Vec<f64>>,
    outputs: Vec<String>,
    parts: u32,
    edited: String,
}

/// A cold machine with the part of a program laid in; its programs in a folder of their own, for they are edited.
fn cold(kind: Kind, hand: Hand, program: u32, folder: &Path) -> Operator {
    let shipped = crate::stories::folders();
    for entry in fs::read_dir(shipped.programs).unwrap().filter_map(Result::ok).filter(|entry| entry.path().is_file()) {
        fs::copy(entry.path(), folder.join(entry.file_name())).unwrap();
    }
    let folders =
        Folders { programs: folder.to_owned(), screens: shipped.screens, by_name: false, dialect: Dialect::LatheA };
    let mut rig = crate::stories::rig_of(kind, folders);
    rig.mount_part(&PartFile::builtin(program).unwrap().unwrap());
    Operator::new(hand, rig)
}

fn idle(operator: &mut Operator, longest_s: f64) {
    operator.until("the end", longest_s, |snapshot| !snapshot.state.is_active() && snapshot.state != RunState::Held);
    assert_eq!(operator.snapshot().state, RunState::Idle, "{:?}", operator.snapshot().alarms);
}

/// Hydraulics, then every axis of the kind to its home, the wheel's first.
fn hydraulics_and_homing(operator: &mut Operator, axes: &[Key]) {
    operator.key(Key::CycleStart);
    assert!(operator.says("自动"), "not in this mode: {}", operator.snapshot().message.text.zh());
    operator.key(Key::Hydraulic);
    operator.wait(4.0);
    operator.key(Key::ModeHome);
    for key in axes {
        operator.key(*key);
        idle(operator, 60.0);
    }
    let homed = |axis: Axis| operator.snapshot().axes[axis].homed || !operator.snapshot().axes[axis].present;
    assert!(Axis::ALL.into_iter().all(homed));
    operator.key(Key::ModeManual);
}

/// Cycle start, feed hold at a place, three seconds, cycle start, to the end.
fn grind_with_a_hold(operator: &mut Operator, longest_s: f64, there: impl FnMut(&kt830::link::Snapshot) -> bool) {
    operator.key(Key::ModeAuto);
    operator.pace();
    operator.key(Key::CycleStart);
    assert_eq!(operator.snapshot().state, RunState::Running, "{}", operator.snapshot().message.text.zh());
    operator.until("the place to hold at", longest_s, there);
    operator.key(Key::FeedHold);
    operator.until("the hold", 3.0, |snapshot| snapshot.state == RunState::Held && snapshot.feed_mm_min < 0.001);
    operator.wait(3.0);
    operator.key(Key::CycleStart);
    idle(operator, longest_s);
}

/// The simulator page shows the part; its sizes.
fn measured(operator: &mut Operator) -> Vec<f64> {
    operator.page(Page::Simulator);
    let right = (ArrowRight, Modifiers::NONE);
    operator.page_key("工件与砂轮 sim-part", &[right, right, right, (Enter, Modifiers::NONE)]);
    assert!(operator.sees("换上新毛坯 sim-new-part"));
    operator.snapshot().simulated.as_ref().unwrap().sizes.iter().map(|size| size.mm).collect()
}

fn gc_shift(hand: Hand) -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let mut operator = cold(Kind::Gc, hand, 1_002, folder.path());
    let one = &mut operator;
    hydraulics_and_homing(one, &[Key::XPlus, Key::ZPlus]);
    one.key(Key::TailstockAdvance);
    one.wait(2.0);
    one.load(1_002);
    one.page(Page::Grinding);
    for (variable, text) in [(521, "40.05"), (524, "0.35"), (525, "0.05"), (528, "4"), (529, "1")] {
        one.value(variable, text);
    }
    one.key(Key::WheelStart);
    one.wait(10.0);
    // In the roughing: below 40.35.
    grind_with_a_hold(one, 200.0, |snapshot| snapshot.axes[Axis::X].work < 40.2);
    let first = measured(one);

    // A block more at the end of the spark-out: a second of dwell.
    one.key(Key::ModeEdit);
    one.page(Page::Program);
    one.page_key("编辑 edit-begin", &[(egui::Key::E, Modifiers::CTRL)]);
    one.number("187350");
    one.page_key("定位 edit-go", &[(egui::Key::G, Modifiers::CTRL)]);
    one.words("N200");
    if hand == Hand::Fingers && !one.sees("输入 letter-done") {
        one.tap("键盘 edit-board");
    }
    one.words("N195 G04 X1");
    one.page_key("保存 edit-save", &[(egui::Key::S, Modifiers::CTRL)]);
    let edited = fs::read_to_string(folder.path().join("O1002.NC")).unwrap();
    assert!(edited.contains("\nN195 G04 X1\nN200 "), "{hand:?}: {edited}");
    one.key(Key::Reset);

    one.key(Key::ModeAuto);
    one.load(1_011);
    one.page(Page::Dressing);
    one.pace();
    one.key(Key::CycleStart);
    assert_eq!(one.snapshot().state, RunState::Running, "{}", one.snapshot().message.text.zh());
    idle(one, 200.0);

    one.load(1_002);
    measured(one);
    one.page_key("换上新毛坯 sim-new-part", &[(ArrowRight, Modifiers::NONE), (Enter, Modifiers::NONE)]);
    one.page(Page::Grinding);
    one.value(521, "40");
    one.pace();
    one.key(Key::CycleStart);
    idle(one, 200.0);
    let second = measured(one);
    one.key(Key::ModeManual);
    one.key(Key::TailstockRetract);
    one.wait(2.0);
    one.key(Key::Hydraulic);
    one.wait(1.0);
    let parts = one.snapshot().parts_counted;
    Outcome { sizes: vec![first, second], outputs: operator.trace, parts, edited }
}

fn gs_shift(hand: Hand) -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let mut operator = cold(Kind::Gs, hand, 1_007, folder.path());
    let one = &mut operator;
    hydraulics_and_homing(one, &[Key::YPlus, Key::XPlus, Key::ZPlus]);
    one.load(1_007);
    one.key(Key::Magnetise);
    one.wait(2.0);
    one.key(Key::WheelStart);
    one.wait(10.0);
    one.key(Key::ModeMdi);
    one.page(Page::Mdi);
    for line in ["G90 G00 Y60", "G00 X-30 Z-45"] {
        one.words(line);
        assert_eq!(&*one.snapshot().prepared_mdi, line, "{hand:?}");
        one.key(Key::CycleStart);
        idle(one, 30.0);
    }
    one.page(Page::Grinding);
    for (variable, text) in [(681, "20.06"), (687, "0.02"), (690, "6000"), (693, "0")] {
        one.value(variable, text);
    }
    grind_with_a_hold(one, 400.0, |snapshot| snapshot.axes[Axis::Y].work < 20.1);
    let sizes = measured(one);
    one.key(Key::ModeManual);
    one.key(Key::Demagnetise);
    one.wait(8.0);
    let parts = one.snapshot().parts_counted;
    Outcome { sizes: vec![sizes], outputs: operator.trace, parts, edited: String::new() }
}

fn ga_shift(hand: Hand) -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let mut operator = cold(Kind::Ga, hand, 1_010, folder.path());
    let one = &mut operator;
    hydraulics_and_homing(one, &[Key::ZPlus, Key::XPlus]);
    one.load(1_010);
    one.key(Key::Magnetise);
    one.wait(2.0);
    one.key(Key::WheelStart);
    one.wait(10.0);
    one.page(Page::Grinding);
    for (variable, text) in [(741, "25.03"), (748, "600"), (749, "1"), (751, "0")] {
        one.value(variable, text);
    }
    grind_with_a_hold(one, 400.0, |snapshot| snapshot.axes[Axis::Z].work < 25.05);
    let sizes = measured(one);
    one.key(Key::ModeManual);
    one.key(Key::Demagnetise);
    one.wait(8.0);
    let parts = one.snapshot().parts_counted;
    Outcome { sizes: vec![sizes], outputs: operator.trace, parts, edited: String::new() }
}

/// The same by touch and by keyboard. Presses come some milliseconds apart, so chance falls a little differently: the
/// sizes agree to half a micrometre, the outputs in their order.
fn check(shift: fn(Hand) -> Outcome, wanted_mm: &[f64]) {
    let by_keyboard = std::thread::spawn(move || shift(Hand::Keyboard));
    let touched = shift(Hand::Fingers);
    let typed = by_keyboard.join().unwrap();
    assert_eq!(touched.outputs, typed.outputs);
    assert_eq!((touched.parts, &touched.edited), (typed.parts, &typed.edited));
    assert_eq!(touched.parts as usize, wanted_mm.len());
    for ((one, other), wanted) in touched.sizes.iter().zip(&typed.sizes).zip(wanted_mm) {
        assert!(!one.is_empty() && one.len() == other.len());
        for (a, b) in one.iter().zip(other) {
            assert!((a - b).abs() < 0.000_5, "{a} by touch, {b} by keyboard");
            assert!((a - wanted).abs() < 0.004, "{a} instead of {wanted}");
        }
    }
}

#[test]
fn b6_a_shift_at_the_cylindrical_grinder_by_touch_and_by_keyboard() {
    check(gc_shift, &[40.05, 40.0]);
}

#[test]
fn b6_a_shift_at_the_surface_grinder_by_touch_and_by_keyboard() {
    check(gs_shift, &[20.06]);
}

#[test]
fn b6_a_shift_at_the_rotary_table_grinder_by_touch_and_by_keyboard() {
    check(ga_shift, &[25.03]);
}
