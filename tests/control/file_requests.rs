//! File requests of pages: what is allowed now, which answer belongs to which request, and what an answer changes. The
//! background thread is played by the test.

use kt830::defs::alarm;
use kt830::defs::key::{Key, Mode};
use kt830::defs::kind::Kind;
use kt830::defs::param;
use kt830::defs::text::{LocalizedText, Text};
use kt830::link::Command;
use kt830::link::files::{FileAnswer, FileRequest, Refusal, Requester, RestoredValues, Ticket};
use kt830::link::media::{Direction, MediaView, TransferRequest, TransferSet};
use kt830::link::page_command::{PageCommand, PasswordCheck, PasswordScope, Secret, StorageAnswer};
use kt830::link::snapshot::RunState;

use crate::core_alone::Core;

const MINE: Ticket = Ticket { requester: Requester::Directory, number: 7 };
const OTHER: Ticket = Ticket { requester: Requester::Editor, number: 7 };
const SAVING: Text = Text::new("保存", "saving");
const PROGRAMS: &[(u32, &str)] = &[(1_001, "G04 P60000\nM30"), (1_002, "M30"), (9_001, "M99")];

/// A control in mode EDIT without a password for the programs below O9000.
fn editing() -> Core {
    let mut core = Core::ready(Kind::Gc, PROGRAMS);
    core.send(Command::SetParam(param::PROGRAM_PASSWORD.address(), 0.0));
    core.send(Command::LoadProgram(1_001));
    core.send(Command::Press(Mode::Edit.key()));
    core
}

/// The same while a program runs.
fn running() -> Core {
    let mut core = editing();
    core.send(Command::Press(Mode::Auto.key()));
    core.send(Command::Press(Key::CycleStart));
    core.wait(200);
    assert_eq!(core.shown().state, RunState::Running);
    core
}

fn unlock(core: &mut Core, scope: PasswordScope) {
    core.send(Command::Page(PageCommand::Unlock(scope, Secret::new("1234".into()))));
    core.storage_answers(StorageAnswer::PasswordChecked(scope, PasswordCheck::Right));
}

fn transfer(set: TransferSet, direction: Direction, names: &[&str]) -> FileRequest {
    let names = names.iter().map(|name| (*name).to_owned()).collect();
    FileRequest::Transfer(TransferRequest { set, direction, names, overwrite: None, convert: None, split: None })
}

fn done() -> FileAnswer {
    FileAnswer::Done(LocalizedText::new("好", "done"))
}

fn other_refusal(result: Option<Result<String, Refusal>>) -> String {
    match result {
        Some(Err(Refusal::Other(said))) => said.en().to_string(),
        result => panic!("{result:?}"),
    }
}

#[test]
fn b6_one_request_at_a_time_and_what_only_reads_in_between() {
    let mut core = editing();
    assert_eq!(core.ask(MINE, FileRequest::New(5)), [FileRequest::New(5)]);
    assert!(core.ask(OTHER, FileRequest::New(6)).is_empty());
    assert!(other_refusal(core.result(OTHER)).contains("the previous job is not finished"));
    assert!(core.refusal().is_some(), "the operator is told as well");
    for reads in [FileRequest::ListMedia, FileRequest::SaveTable("t".into())] {
        assert_eq!(core.ask(OTHER, reads.clone()), [reads]);
    }
    assert_eq!(core.result(MINE), None, "still pending");
    core.answer(MINE, done());
    assert_eq!(core.result(MINE), Some(Ok("done".into())));
    assert_eq!(core.ask(OTHER, FileRequest::New(6)), [FileRequest::New(6)]);
}

#[test]
fn b6_an_answer_ends_the_request_of_its_ticket_alone() {
    let mut core = editing();
    core.ask(MINE, FileRequest::New(5));
    core.answer(MINE, FileAnswer::Progress(SAVING, 250));
    assert_eq!(core.shown().files.busy, Some((SAVING, 250)));
    core.answer(OTHER, FileAnswer::Progress(SAVING, 900));
    assert_eq!(core.shown().files.busy, Some((SAVING, 250)), "late progress of another request");
    core.answer(OTHER, done());
    assert_eq!(core.shown().files.busy, Some((SAVING, 250)));
    assert!(core.ask(OTHER, FileRequest::New(6)).is_empty(), "mine is still pending");
    core.answer(MINE, FileAnswer::BytesReceived(SAVING, 4_096));
    assert_eq!((core.shown().files.busy, core.shown().files.bytes_received), (Some((SAVING, 0)), Some(4_096)));
    core.answer(MINE, FileAnswer::Refused(Refusal::Conflict));
    assert_eq!((core.shown().files.busy, core.shown().files.bytes_received), (None, None));
    assert_eq!(core.result(MINE), Some(Err(Refusal::Conflict)));
}

#[test]
fn h8_cancel_goes_on_only_while_something_is_pending() {
    let mut core = editing();
    assert!(core.ask(OTHER, FileRequest::Cancel).is_empty());
    core.ask(MINE, FileRequest::ComputeToolpath(1_001));
    assert_eq!(core.ask(OTHER, FileRequest::Cancel), [FileRequest::Cancel]);
    assert!(core.ask(OTHER, FileRequest::New(6)).is_empty(), "the job itself says when it has ended");
    core.answer(MINE, FileAnswer::Refused(Refusal::Other(LocalizedText::new("已取消", "cancelled"))));
    assert_eq!(other_refusal(core.result(MINE)), "cancelled");
    assert!(core.ask(OTHER, FileRequest::Cancel).is_empty());
}

#[test]
fn k6_2_programs_change_in_mode_edit_without_a_run_and_with_the_password() {
    let saves = FileRequest::Copy { from: 1_001, to: 5 };
    let mut core = Core::ready(Kind::Gc, PROGRAMS);
    assert!(core.ask(MINE, saves.clone()).is_empty());
    assert!(other_refusal(core.result(MINE)).contains("press EDIT"));
    core.send(Command::Press(Mode::Edit.key()));
    assert!(core.ask(MINE, saves.clone()).is_empty());
    assert_eq!(core.result(MINE), Some(Err(Refusal::Password)));
    core.ask(OTHER, FileRequest::CheckEditable(1_001));
    assert_eq!(core.result(OTHER), Some(Err(Refusal::Password)));
    unlock(&mut core, PasswordScope::Program);
    assert!(core.ask(OTHER, FileRequest::CheckEditable(1_001)).is_empty(), "answered at once");
    assert_eq!(core.result(OTHER), Some(Ok("ready for editing".into())));
    assert_eq!(core.ask(MINE, saves.clone()), std::slice::from_ref(&saves));
    let mut core = running();
    for request in [saves, FileRequest::Delete(1_002), FileRequest::SaveRecording(Vec::new())] {
        assert!(core.ask(MINE, request).is_empty());
        assert!(other_refusal(core.result(MINE)).contains("cannot be edited while one runs"));
    }
}

#[test]
fn k6_2_o9000_to_o9999_have_a_password_of_their_own() {
    let mut core = editing();
    assert_eq!(core.ask(MINE, FileRequest::Delete(8_999)).len(), 1);
    core.answer(MINE, done());
    for request in [FileRequest::Delete(9_000), FileRequest::Rename { from: 5, to: 9_999 }] {
        assert!(core.ask(MINE, request).is_empty());
        assert_eq!(core.result(MINE), Some(Err(Refusal::Password)));
    }
    let import = |names: &[&str]| transfer(TransferSet::Programs, Direction::Import, names);
    assert!(core.ask(MINE, import(&["O9001.NC"])).is_empty());
    assert!(core.ask(MINE, import(&[])).is_empty(), "all of a medium may be O9001 too");
    assert_eq!(core.ask(MINE, import(&["O1003.NC"])).len(), 1);
    core.answer(MINE, done());
    core.send(Command::SetParam(param::SUBPROGRAM_PASSWORD.address(), 0.0));
    assert_eq!(core.ask(MINE, import(&[])).len(), 1);
}

#[test]
fn b6_a_program_gets_no_number_that_programs_cannot_call() {
    let mut core = editing();
    for request in [FileRequest::New(10_000), FileRequest::Copy { from: 5, to: 10_000 }] {
        assert!(core.ask(MINE, request).is_empty());
        assert!(other_refusal(core.result(MINE)).contains("1 to 9999; P418"));
    }
    core.send(Command::SetParam(param::PROGRAM_DIGITS.address(), 8.0));
    assert_eq!(core.ask(MINE, FileRequest::New(12_345_678)).len(), 1);
}

#[test]
fn k7_8_export_is_always_allowed_and_import_needs_the_password_of_its_set() {
    let mut core = running();
    for set in TransferSet::ALL {
        assert_eq!(core.ask(MINE, transfer(set, Direction::Export, &[])).len(), 1, "{set:?}");
        core.answer(MINE, done());
        assert!(core.ask(MINE, transfer(set, Direction::Import, &[])).is_empty(), "{set:?}");
        assert!(other_refusal(core.result(MINE)).contains("nothing can be imported"), "{set:?}");
    }
    let mut core = Core::ready(Kind::Gc, PROGRAMS);
    for (set, refused) in [
        (TransferSet::Programs, Some(Refusal::Password)),
        (TransferSet::Serial, Some(Refusal::Password)),
        (TransferSet::Params, Some(Refusal::Builder)),
        (TransferSet::Backup, Some(Refusal::Builder)),
        (TransferSet::Screens, None),
        (TransferSet::Variables, None),
    ] {
        let went = core.ask(MINE, transfer(set, Direction::Import, &[])).len();
        assert_eq!(went, usize::from(refused.is_none()), "{set:?}");
        assert_eq!(core.result(MINE).and_then(Result::err), refused, "{set:?}");
        core.answer(MINE, done());
    }
    unlock(&mut core, PasswordScope::Builder);
    assert_eq!(core.ask(MINE, transfer(TransferSet::Backup, Direction::Import, &[])).len(), 1);
}

#[test]
fn l9_a_new_transmission_clears_the_serial_alarms_of_the_last_one() {
    let mut core = editing();
    let send = transfer(TransferSet::Serial, Direction::Export, &["O1001.NC"]);
    core.ask(MINE, send.clone());
    let why = LocalizedText::new("COM1", "COM1");
    core.answer(MINE, FileAnswer::Refused(Refusal::Alarm(alarm::SERIAL_PORT_NOT_OPEN, why)));
    let raised = |core: &mut Core| core.shown().alarms.iter().any(|row| row.number == alarm::SERIAL_PORT_NOT_OPEN);
    assert!(raised(&mut core));
    core.ask(MINE, FileRequest::ListMedia);
    assert!(raised(&mut core));
    core.ask(MINE, send);
    assert!(!raised(&mut core));
}

#[test]
fn b6_the_current_program_follows_a_rename_and_a_deletion_that_succeeded() {
    let mut core = editing();
    let rename = FileRequest::Rename { from: 1_001, to: 5 };
    core.ask(MINE, rename.clone());
    core.answer(MINE, FileAnswer::Refused(Refusal::Conflict));
    assert_eq!(core.shown().program.number, 1_001);
    core.ask(MINE, rename);
    core.answer(MINE, done());
    assert_eq!(core.shown().program.number, 5);
    core.ask(MINE, FileRequest::Delete(1_002));
    core.answer(MINE, done());
    assert_eq!(core.shown().program.number, 5, "another one was deleted");
    core.ask(MINE, FileRequest::Delete(5));
    core.answer(MINE, done());
    assert_eq!(core.shown().program.number, 0);
}

#[test]
fn k7_8_values_of_a_file_are_applied_only_while_nothing_runs() {
    let restored = RestoredValues {
        params: vec![(param::PROGRAM_PASSWORD.address(), 1.0)],
        variables: vec![(500, 12.5)],
        ..RestoredValues::default()
    };
    let import = transfer(TransferSet::Variables, Direction::Import, &[]);
    let mut core = editing();
    core.ask(MINE, import.clone());
    core.answer(MINE, FileAnswer::Restored(Box::new(restored.clone())));
    assert_eq!(core.result(MINE), Some(Ok("imported: 1 parameters, 1 variables".into())));
    assert!(core.controller().params().bit(param::PROGRAM_PASSWORD));
    assert_eq!(core.controller().variable(500), Some(12.5));

    let mut core = editing();
    core.ask(MINE, import);
    core.send(Command::Press(Mode::Auto.key()));
    core.send(Command::Press(Key::CycleStart));
    core.wait(200);
    assert_eq!(core.shown().state, RunState::Running, "started while the file was read");
    core.answer(MINE, FileAnswer::Restored(Box::new(restored)));
    assert!(other_refusal(core.result(MINE)).contains("nothing can be imported"));
    assert!(!core.controller().params().bit(param::PROGRAM_PASSWORD));
    assert_ne!(core.controller().variable(500), Some(12.5));
}

#[test]
fn h8_the_last_sixteen_answers_are_kept_and_a_list_is_replaced_only_by_another_one() {
    let mut core = editing();
    let ticket = |number| Ticket { requester: Requester::Directory, number };
    for number in 1..=20 {
        core.ask(ticket(number), FileRequest::CheckEditable(1_001));
    }
    let kept: Vec<u32> = core.shown().files.answers.iter().map(|answer| answer.ticket.number).collect();
    assert_eq!(kept, (5..=20).collect::<Vec<_>>());
    core.answer(MINE, FileAnswer::Media(MediaView::default()));
    let listed = core.shown().files.media.clone().unwrap();
    core.answer(MINE, FileAnswer::Media(MediaView::default()));
    assert!(std::sync::Arc::ptr_eq(&listed, core.shown().files.media.as_ref().unwrap()));
    core.answer(MINE, FileAnswer::Media(MediaView { free_bytes: Some(1), ..MediaView::default() }));
    assert_eq!(core.shown().files.media.as_ref().unwrap().free_bytes, Some(1));
}
