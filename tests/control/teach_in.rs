//! The recorder of the teach-in, without host and disk: what becomes a block, and when a recording ends.

use kt830::defs::key::{Key, Mode};
use kt830::defs::kind::Kind;
use kt830::defs::param;
use kt830::defs::program_number::from_name;
use kt830::defs::text::LocalizedText;
use kt830::link::Command;
use kt830::link::files::{FileAnswer, FileRequest, Refusal, Requester, Ticket};
use kt830::link::teach::{TeachCommand, block_text, program_text};
use kt830::units::Axis;

use crate::core_alone::Core;

/// The ticket of a recording that is saved.
const SAVED: Ticket = Ticket::without_reply(Requester::Teach);

/// A recording in mode HANDWHEEL on the Z axis, at 0.1 mm a detent, that has just begun; no password for programs.
fn recording() -> Core {
    let mut core = Core::ready(Kind::Lathe, &[(from_name("LONG"), "N0010G04F5\r\nN0020M02")]);
    core.send(Command::SetParam(param::PROGRAM_PASSWORD.address(), 0.0));
    core.send(Command::Press(Mode::Handwheel.key()));
    core.send(Command::Press(Key::HandwheelZ));
    core.send(Command::Press(Key::Step01));
    teach(&mut core, TeachCommand::Start);
    core
}

fn teach(core: &mut Core, command: TeachCommand) {
    core.send(Command::Teach(command));
}

/// Turns the handwheel and waits until the axis stands.
fn turn(core: &mut Core, detents: i32) {
    core.send(Command::Handwheel(detents));
    core.wait(1_500);
}

/// The blocks without their numbers and feeds.
fn words(core: &mut Core) -> Vec<String> {
    let blocks = core.shown().teach.blocks.iter().enumerate().map(|(index, block)| block_text(index, block));
    blocks.map(|text| text[5..].split('F').next().unwrap_or_default().to_owned()).collect()
}

fn z(core: &mut Core) -> f64 {
    core.shown().axes[Axis::Z].work
}

/// A coordinate as a block has it.
fn mm(value: f64) -> String {
    format!("{}", (value * 1_000.0).round() / 1_000.0)
}

#[test]
fn l9_detents_in_one_direction_are_one_block_and_a_turn_back_begins_another() {
    let mut core = recording();
    let begun = z(&mut core);
    for _ in 0..3 {
        turn(&mut core, 5);
    }
    let there = z(&mut core);
    turn(&mut core, -4);
    teach(&mut core, TeachCommand::Stop);
    let lines = words(&mut core);
    assert_eq!(lines.len(), 3, "{lines:?}");
    assert!(lines[0].starts_with("G92X"), "{lines:?}");
    assert_eq!(lines[1], format!("G01Z{}", mm(there)));
    assert_eq!(lines[2], format!("G01Z{}", mm(z(&mut core))));
    assert!((there - begun).abs() > 1.0 && !core.shown().teach.recording);
    turn(&mut core, 5);
    assert_eq!(words(&mut core), lines, "nothing is recorded after the stop");
}

#[test]
fn l9_undo_takes_blocks_back_but_never_the_start() {
    let mut core = recording();
    teach(&mut core, TeachCommand::Undo);
    assert_eq!(core.refusal().as_deref(), Some("nothing has been recorded"));
    teach(&mut core, TeachCommand::Save);
    assert_eq!(core.refusal().as_deref(), Some("nothing has been recorded"), "a start alone is no program");
    turn(&mut core, 5);
    core.send(Command::Press(Key::Coolant));
    core.wait(100);
    assert_eq!(words(&mut core)[2], "M07");
    teach(&mut core, TeachCommand::Undo);
    assert_eq!(words(&mut core).len(), 2);
    teach(&mut core, TeachCommand::Undo);
    assert_eq!(words(&mut core).len(), 1);
    teach(&mut core, TeachCommand::Undo);
    assert!(core.refusal().is_some() && words(&mut core).len() == 1);
}

#[test]
fn l9_a_recording_is_saved_when_the_disk_says_so() {
    let mut core = recording();
    core.send(Command::Press(Key::Coolant));
    core.wait(100);
    core.jobs();
    teach(&mut core, TeachCommand::Save);
    let FileRequest::SaveRecording(blocks) = core.jobs().remove(0) else { panic!("no recording") };
    let text = program_text(&blocks);
    let lines: Vec<&str> = text.split("\r\n").collect();
    assert!(lines[0].starts_with("N0010G92X"), "{lines:?}");
    assert_eq!(lines[1..], ["N0020M07", "N0030M02", ""]);
    core.answer(SAVED, FileAnswer::Refused(Refusal::Conflict));
    assert!(!core.shown().teach.saved);
    teach(&mut core, TeachCommand::Save);
    core.answer(SAVED, FileAnswer::Done(LocalizedText::same("TEACH01")));
    assert!(core.shown().teach.saved && core.shown().teach.recording, "the recording goes on");
    core.send(Command::Press(Key::Coolant));
    core.wait(100);
    assert!(!core.shown().teach.saved, "another block has come");
    teach(&mut core, TeachCommand::Start);
    assert_eq!(words(&mut core).len(), 1, "a new recording discards the one before");
}

#[test]
fn l9_a_program_that_starts_ends_the_recording() {
    let mut core = recording();
    turn(&mut core, 5);
    core.send(Command::LoadProgram(from_name("LONG")));
    core.send(Command::Press(Mode::Auto.key()));
    core.send(Command::Press(Key::CycleStart));
    core.wait(500);
    assert!(!core.shown().teach.recording);
    assert_eq!(words(&mut core).len(), 2, "what was recorded stays");
    teach(&mut core, TeachCommand::Start);
    assert_eq!(core.refusal().as_deref(), Some("no teach-in while a program runs"));
    assert_eq!(words(&mut core).len(), 2);
}

#[test]
fn l9_a_full_recording_stops_with_its_last_number() {
    let mut core = recording();
    // Every switching of the coolant is a block; numbers have four digits, and M02 needs the last.
    for _ in 0..1_000 {
        core.send(Command::Press(Key::Coolant));
        core.wait(20);
    }
    let teach_in = core.shown().teach.clone();
    assert!(!teach_in.recording);
    assert_eq!(teach_in.blocks.len(), 998);
    assert!(block_text(997, &teach_in.blocks[997]).starts_with("N9980M0"), "{:?}", teach_in.blocks[997]);
    core.jobs();
    teach(&mut core, TeachCommand::Save);
    let FileRequest::SaveRecording(blocks) = core.jobs().remove(0) else { panic!("no recording") };
    let text = program_text(&blocks);
    assert!(text.ends_with("N9990M02\r\n"));
}

#[test]
fn l9_a_grinder_has_no_teach_in() {
    let mut core = Core::ready(Kind::Gc, &[]);
    teach(&mut core, TeachCommand::Start);
    assert_eq!(core.refusal().as_deref(), Some("this machine has no teach-in"));
    assert!(core.shown().teach.blocks.is_empty());
}
