//! Storage in the step: what it answers to jobs and requests.

use std::collections::BTreeSet;
use std::sync::Arc;

use kt830::controller::files::BackgroundJob;
use kt830::controller::{PowerOnState, StorageRequest, nc_settings};
use kt830::defs::kind::Kind;
use kt830::defs::program_number;
use kt830::host::folders::Folders;
use kt830::host::job_runner::JobRunner;
use kt830::host::retained_store::RetainedStore;
use kt830::host::storage::{Arrival, DirectStorage, RetainedWorker, Storage};
use kt830::link::Command;
use kt830::link::files::{FileRequest, Requester, Ticket};
use kt830::link::media::{Direction, TransferRequest, TransferSet};
use kt830::link::page_command::{PageCommand, PasswordCheck, PasswordScope, Secret, SettingsRequest, StorageAnswer};
use kt830::store::DataDir;
use tempfile::TempDir;

/// Storage in memory with empty folders and a USB drive, and what it has told so far taken.
fn storage() -> (DirectStorage, TempDir) {
    let files = tempfile::tempdir().unwrap();
    let [programs, screens, usb_drive] = ["programs", "screens", "stick"].map(|name| files.path().join(name));
    for folder in [&programs, &screens, &usb_drive] {
        std::fs::create_dir(folder).unwrap();
    }
    let folders = Folders { programs, screens, by_name: false, dialect: Kind::Gc.dialect() };
    let jobs = JobRunner::new(folders).with_drives(None, Some(usb_drive));
    let mut storage = DirectStorage::new(RetainedWorker::new(None), jobs).unwrap();
    assert_eq!(answers(&mut storage, Vec::new()).len(), 2, "programs and page files");
    (storage, files)
}

fn answers(storage: &mut DirectStorage, mut requests: Vec<StorageRequest>) -> Vec<Arrival> {
    let mut told = Vec::new();
    storage.submit(&mut requests);
    storage.poll(&mut told);
    told
}

#[test]
fn a_folder_that_cannot_be_read_after_a_job_is_told() {
    let (mut storage, files) = storage();
    for folder in ["programs", "screens"] {
        std::fs::remove_dir(files.path().join(folder)).unwrap();
    }
    // There is no backup on the drive; both folders are read again nevertheless.
    let restore = TransferRequest {
        set: TransferSet::Backup,
        direction: Direction::Import,
        names: Vec::new(),
        overwrite: None,
        convert: None,
        split: None,
    };
    let job = BackgroundJob {
        ticket: Ticket::without_reply(Requester::Transfer),
        request: FileRequest::Transfer(restore),
        settings: nc_settings(Kind::Gc, &PowerOnState::factory(Kind::Gc).params),
        programs: Arc::default(),
        subprograms_locked: false,
        transfer_values: None,
        start: None,
        date: None,
    };
    let told = answers(&mut storage, vec![StorageRequest::Job(Box::new(job))]);
    let [first, second, Arrival::Command(Command::Page(_))] = told.as_slice() else {
        panic!("{} answers", told.len());
    };
    assert!([first, second].iter().all(|arrival| matches!(arrival, Arrival::Command(Command::DiskFailed(_)))));
}

#[test]
fn without_a_store_passwords_are_checked_and_nothing_is_acknowledged() {
    let (mut storage, _files) = storage();
    let ask = SettingsRequest::CheckPassword(PasswordScope::User, Secret::new("123456".into()));
    let told = answers(&mut storage, vec![StorageRequest::PartCount(3), StorageRequest::Page(ask)]);
    let [Arrival::Command(Command::Page(PageCommand::StorageAnswered(answer)))] = told.as_slice() else {
        panic!("{} answers", told.len());
    };
    assert!(
        matches!(answer, StorageAnswer::PasswordChecked(PasswordScope::User, PasswordCheck::Initial)),
        "{answer:?}"
    );
}

/// As one number, program and line of a named program or of one with eight digits lost the last digits of the line.
#[test]
fn b5_the_place_of_a_run_is_kept_exactly_whatever_its_program_is_called() {
    let folder = tempfile::tempdir().unwrap();
    let programs = [1_001, 99_999_999, program_number::from_l(9_999_999), program_number::from_name("VGRIND")];
    for (program, line) in programs.into_iter().zip([1, 1_234_567, 13, 999_999]) {
        let (mut store, _) = RetainedStore::open(folder.path(), Kind::Gc).unwrap();
        store.commit(&[StorageRequest::RunningAt(Some((program, line)))]).unwrap();
        drop(store);
        let (mut store, found) = RetainedStore::open(folder.path(), Kind::Gc).unwrap();
        assert_eq!(found.retained.interrupted, Some((program, line)));
        store.commit(&[StorageRequest::RunningAt(None)]).unwrap();
        drop(store);
        let (_, found) = RetainedStore::open(folder.path(), Kind::Gc).unwrap();
        assert_eq!(found.retained.interrupted, None);
    }
}

/// A check and a run on one new folder at the same moment: each found the other's half of the files.
#[test]
fn b6_first_starts_at_the_same_moment_install_one_whole_set() {
    let folder = tempfile::tempdir().unwrap();
    let data = DataDir::resolve(Some(folder.path())).unwrap();
    let starts: Vec<_> = (0..8)
        .map(|_| {
            std::thread::spawn({
                let data = data.clone();
                move || Folders::of_data(&data, Kind::Gc).map(|_| ()).map_err(|error| error.to_string())
            })
        })
        .collect();
    for start in starts {
        start.join().unwrap().unwrap();
    }
    let left: Vec<_> = std::fs::read_dir(data.screens()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert!(left.len() > 40 && left.iter().all(|name| !name.to_string_lossy().ends_with("part")), "{left:?}");
    assert!(!data.screens().join(".installing").exists());
}

/// A first start on a disk that was full, or one that was cut off, left half of the pages away for ever.
#[test]
fn b6_an_installation_that_was_cut_off_goes_on_at_the_next_start() {
    let folder = tempfile::tempdir().unwrap();
    let data = DataDir::resolve(Some(folder.path())).unwrap();
    let names = || {
        let entries = std::fs::read_dir(data.screens()).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect::<BTreeSet<_>>()
    };
    Folders::of_data(&data, Kind::Gc).unwrap();
    let whole = names();
    assert!(whole.len() > 40 && !whole.contains(".installing"), "{whole:?}");
    // Cut off behind some of them; one was edited since.
    let gone: Vec<&String> = whole.iter().skip(5).collect();
    gone.iter().for_each(|name| std::fs::remove_file(data.screens().join(name)).unwrap());
    std::fs::write(data.screens().join(".installing"), "").unwrap();
    let edited = data.screens().join(whole.first().unwrap());
    std::fs::write(&edited, "edited").unwrap();
    Folders::of_data(&data, Kind::Gc).unwrap();
    assert_eq!(names(), whole);
    assert_eq!(std::fs::read_to_string(edited).unwrap(), "edited");
    // What a person has deleted stays deleted.
    std::fs::remove_file(data.screens().join(gone[0])).unwrap();
    Folders::of_data(&data, Kind::Gc).unwrap();
    assert_eq!(names().len(), whole.len() - 1);
}
