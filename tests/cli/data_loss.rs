//! Retained data and settings that are damaged, gone or of another kind: never factory values without an alarm that stands,
//! never another kind of machine, never an open password. Source: safety stance; spec K1, K4.2, B6.

use std::cell::RefCell;
use std::fs;
use std::io;
use std::path::Path;
use std::rc::Rc;

use kt830::controller::StorageRequest;
use kt830::defs::alarm;
use kt830::defs::kind::Kind;
use kt830::host::folders::Folders;
use kt830::host::job_runner::JobRunner;
use kt830::host::retained_store::{RetainedStore, StoreReport};
use kt830::host::storage::{Arrival, RetainedWorker, Storage, StorageWorker, ThreadedStorage};
use kt830::link::Command;
use kt830::link::page_command::{
    DataChoice, PageCommand, PasswordCheck, PasswordScope, Secret, SettingsRequest, StorageAnswer,
};
use kt830::store::disk::{self, DiskChange, DiskObserver};
use kt830::store::{DataDir, StoredSettings};
use kt830::units::Axis;
use tempfile::TempDir;

use crate::command::kt830;

pub const DATABASE: &str = "retained.redb";

pub fn open(folder: &Path) -> (RetainedStore, StoreReport) {
    RetainedStore::open(folder, Kind::Gc).unwrap()
}

/// Data of a session: values, and a changed builder password.
pub fn session() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let (mut store, found) = open(folder.path());
    assert_eq!(found.loss, None);
    let values: Vec<_> =
        (860..900).map(|number| StorageRequest::Variable(number, Some(f64::from(number) / 8.0))).collect();
    store.commit(&values).unwrap();
    change_password(&mut store, "830830", "4711");
    folder
}

/// Changes the builder's password.
pub fn change_password(store: &mut RetainedStore, old: &str, new: &str) {
    let [old, new] = [old, new].map(|password| Secret::new(password.into()));
    let change = SettingsRequest::ChangePassword { scope: PasswordScope::Builder, old, new };
    assert_eq!(answer(store, &change), StorageAnswer::PasswordChanged(PasswordScope::Builder, true));
}

pub fn answer(store: &mut RetainedStore, request: &SettingsRequest) -> StorageAnswer {
    match store.answer(request) {
        Command::Page(PageCommand::StorageAnswered(answer)) => answer,
        other => panic!("{other:?}"),
    }
}

/// A person with the builder's password decides about lost data.
pub fn choose(store: &mut RetainedStore, choice: DataChoice) {
    let request = SettingsRequest::AcceptData(choice.clone());
    assert_eq!(answer(store, &request), StorageAnswer::DataAccepted(choice));
}

pub fn matches(store: &mut RetainedStore, password: &str) -> bool {
    let request = SettingsRequest::CheckPassword(PasswordScope::Builder, Secret::new(password.into()));
    answer(store, &request) != StorageAnswer::PasswordChecked(PasswordScope::Builder, PasswordCheck::Wrong)
}

pub fn value(found: &StoreReport, number: u32) -> Option<f64> {
    found.retained.variables.get(number).unwrap()
}

pub fn has_values(found: &StoreReport) -> bool {
    (860..900).all(|number| value(found, number) == Some(f64::from(number) / 8.0))
}

/// Removes all that data can be restored from.
pub fn remove_copies(folder: &Path) {
    fs::remove_dir_all(folder.join("generations")).unwrap();
    fs::remove_file(folder.join("retained.journal")).unwrap();
}

/// The files of a running control, as a power cut leaves them.
fn cut_off(folder: &Path) -> TempDir {
    let copy = tempfile::tempdir().unwrap();
    let kept = fs::read_dir(folder.join("generations")).unwrap().map(|entry| entry.unwrap().path());
    fs::create_dir(copy.path().join("generations")).unwrap();
    for from in kept {
        fs::copy(&from, copy.path().join("generations").join(from.file_name().unwrap())).unwrap();
    }
    for name in [DATABASE, "retained.journal", "passwords.ron", "machine-kind.ron"] {
        fs::copy(folder.join(name), copy.path().join(name)).unwrap();
    }
    copy
}

/// What a start after a loss must do, at every start until a person accepts.
fn assert_restored(folder: &Path, what: &str) {
    for start in 1..=3 {
        let (mut store, found) = open(folder);
        assert!(found.loss.as_ref().is_some_and(|loss| loss.state_of.is_some()), "{what}, start {start}");
        assert!(has_values(&found), "{what}, start {start}: values");
        assert!(matches(&mut store, "4711") && !matches(&mut store, "830830"), "{what}, start {start}: password");
    }
    let (mut store, _) = open(folder);
    choose(&mut store, DataChoice::Present);
    drop(store);
    let (_, found) = open(folder);
    assert!(found.loss.is_none() && has_values(&found), "{what}: accepted");
}

#[test]
fn b6_a_database_that_is_gone_is_told_until_a_person_accepts_and_the_last_generation_is_used() {
    let folder = session();
    fs::remove_file(folder.path().join(DATABASE)).unwrap();
    assert_restored(folder.path(), "removed");
}

#[test]
fn b6_a_power_cut_between_put_aside_and_made_anew_is_no_first_start() {
    let folder = session();
    fs::rename(folder.path().join(DATABASE), folder.path().join("retained.damaged-1.redb")).unwrap();
    assert_restored(folder.path(), "put aside");
}

#[test]
fn b6_one_bad_bit_anywhere_in_the_file_loses_no_value() {
    let folder = session();
    let whole = fs::read(folder.path().join(DATABASE)).unwrap();
    let (mut told, step) = (0, whole.len() / 40);
    for at in (0..40).map(|k| k * step + 7 * k % step) {
        let mut bytes = whole.clone();
        bytes[at] ^= 1 << (at % 8);
        fs::write(folder.path().join(DATABASE), &bytes).unwrap();
        let (_, found) = open(folder.path());
        assert!(has_values(&found), "byte {at}: {:?}", found.loss);
        told += usize::from(found.loss.is_some());
    }
    assert!(told > 0, "some bits are in used pages");
}

/// A power cut soon after values were stored, and a bad bit, or no file at all: no state was kept since.
#[test]
fn b6_what_was_acknowledged_just_before_the_power_went_survives_a_bad_bit() {
    let folder = session();
    let (mut store, _) = open(folder.path());
    for number in 860..870 {
        store.commit(&[StorageRequest::Variable(number, Some(1.5))]).unwrap();
    }
    store.commit(&[StorageRequest::DressPoint(Axis::X, Some(12.345)), StorageRequest::PartCount(77)]).unwrap();
    let size = fs::metadata(folder.path().join(DATABASE)).unwrap().len() as usize;
    let mut told = 0;
    // The header says which commit is the last one.
    let header = (0..400).step_by(3);
    for at in header.chain((1..40).map(|k| k * (size / 40) + 13 * k)).map(Some).chain([None]) {
        let copy = cut_off(folder.path());
        let path = copy.path().join(DATABASE);
        let mut bytes = fs::read(&path).unwrap();
        match at {
            Some(at) => {
                bytes[at] ^= 1 << (at % 8);
                fs::write(&path, bytes).unwrap();
            }
            None => fs::remove_file(&path).unwrap(),
        }
        let (_, found) = open(copy.path());
        assert!((860..870).all(|number| value(&found, number) == Some(1.5)), "{at:?}: {:?}", found.loss);
        assert_eq!((found.retained.dress_points[Axis::X], found.retained.part_count), (Some(12.345), 77), "{at:?}");
        told += usize::from(found.loss.is_some());
    }
    assert!(told > 1, "some bits are in used pages");
}

/// An older database in its place is a rolled-back disk or a copy that was put there: nothing of what was acknowledged since
/// goes without a word, no kind of machine and no password comes back. The older one is put aside.
#[test]
fn b6_an_older_database_that_is_put_back_is_told_and_loses_nothing() {
    let folder = session();
    let older = fs::read(folder.path().join(DATABASE)).unwrap();
    let (mut store, _) = open(folder.path());
    store.commit(&[StorageRequest::Variable(861, Some(1.0))]).unwrap();
    drop(store);
    for passwords in ["whole", "gone", "of the first start"] {
        let copy = cut_off(folder.path());
        fs::write(copy.path().join(DATABASE), &older).unwrap();
        match passwords {
            "gone" => fs::remove_file(copy.path().join("passwords.ron")).unwrap(),
            "of the first start" => {
                let first = tempfile::tempdir().unwrap();
                drop(open(first.path()));
                fs::copy(first.path().join("passwords.ron"), copy.path().join("passwords.ron")).map(drop).unwrap();
            }
            _ => {}
        }
        for start in 1..=2 {
            let (mut store, found) = open(copy.path());
            assert!(found.loss.as_ref().is_some_and(|loss| loss.copy.is_some()), "{passwords}, start {start}");
            assert_eq!([860, 861].map(|number| value(&found, number)), [Some(860.0 / 8.0), Some(1.0)], "{passwords}");
            assert!(matches(&mut store, "4711") && !matches(&mut store, "830830"), "{passwords}, start {start}");
        }
        assert_eq!(fs::read(copy.path().join("retained.damaged-1.redb")).unwrap(), older);
    }
    // Without the journal the kept state is the newer one.
    let copy = cut_off(folder.path());
    fs::write(copy.path().join(DATABASE), &older).unwrap();
    fs::remove_file(copy.path().join("retained.journal")).unwrap();
    let (_, found) = open(copy.path());
    assert_eq!((found.loss.is_some(), value(&found, 861)), (true, Some(1.0)));
}

/// The database of another machine with as many commits: the journal beside it does not lead to it.
#[test]
fn b6_a_database_that_its_journal_does_not_lead_to_is_told_and_put_aside() {
    let value_of = |folder: &Path, number: f64| {
        let (mut store, _) = open(folder);
        store.commit(&[StorageRequest::Variable(860, Some(number))]).unwrap();
    };
    let [ours, other] = [1.25, 99.5].map(|number| {
        let folder = tempfile::tempdir().unwrap();
        value_of(folder.path(), number);
        folder
    });
    fs::copy(other.path().join(DATABASE), ours.path().join(DATABASE)).unwrap();
    for start in 1..=2 {
        let (_, found) = open(ours.path());
        assert!(found.loss.as_ref().is_some_and(|loss| loss.copy.is_some()), "start {start}: {:?}", found.loss);
        assert_eq!(value(&found, 860), Some(1.25), "start {start}");
    }
}

/// The data of a real machine are gone but for their mark: no first start.
#[test]
fn b6_the_mark_of_a_real_machine_alone_is_no_first_start() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("real-machine.txt"), "").unwrap();
    let (mut store, found) = open(folder.path());
    assert!(found.loss.is_some_and(|loss| loss.state_of.is_none()) && !matches(&mut store, "830830"));
}

/// The database of another machine is a loss, whatever its number of commits: ours come from the copies. So is one whose
/// journal and states of another machine stand beside it; a state that somebody has put there is none of ours.
#[test]
fn b6_the_data_of_another_machine_are_not_taken_for_ours() {
    let other = tempfile::tempdir().unwrap();
    let (mut store, _) = open(other.path());
    for number in 0..200 {
        store.commit(&[StorageRequest::Variable(860, Some(f64::from(number)))]).unwrap();
    }
    drop(store);
    let take = |folder: &Path, name: &str| fs::copy(other.path().join(name), folder.join(name)).map(|_| ()).unwrap();
    let folder = session();
    take(folder.path(), DATABASE);
    assert_restored(folder.path(), "database");
    // The lock is lost, too: the journal says whose the data are.
    let folder = session();
    take(folder.path(), DATABASE);
    fs::remove_file(folder.path().join("retained.lock")).unwrap();
    assert_restored(folder.path(), "database, lock gone");
    let folder = session();
    take(folder.path(), DATABASE);
    take(folder.path(), "retained.journal");
    assert_restored(folder.path(), "database and journal");
    // A newer state of theirs among ours.
    let folder = session();
    let state = fs::read_dir(other.path().join("generations")).unwrap().next().unwrap().unwrap();
    fs::copy(state.path(), folder.path().join("generations/retained-0000999999.ron")).unwrap();
    let (_, found) = open(folder.path());
    assert!(found.loss.is_none() && has_values(&found), "{:?}", found.loss);
}

/// The lock says whose the data are. One flipped bit of it makes them nobody else's.
#[test]
fn b6_no_bit_of_the_lock_makes_our_data_those_of_another_machine() {
    let folder = session();
    let lock = folder.path().join("retained.lock");
    let whole = fs::read(&lock).unwrap();
    for bit in 0..whole.len() * 8 {
        let mut bytes = whole.clone();
        bytes[bit / 8] ^= 1 << (bit % 8);
        fs::write(&lock, bytes).unwrap();
        let (_, found) = open(folder.path());
        assert!(found.loss.is_none() && has_values(&found), "bit {bit}: {:?}", found.loss);
        assert_eq!(fs::read(&lock).unwrap(), whole, "bit {bit}: written anew");
    }
}

/// The data of a machine of another kind that were put here whole: the kind is told until a person has chosen it.
#[test]
fn k1_a_database_of_another_kind_is_told() {
    let folder = session();
    let other = tempfile::tempdir().unwrap();
    let (mut store, _) = RetainedStore::open(other.path(), Kind::Gs).unwrap();
    for value in 0..50 {
        store.commit(&[StorageRequest::Variable(860, Some(f64::from(value)))]).unwrap();
    }
    drop(store);
    fs::copy(other.path().join(DATABASE), folder.path().join(DATABASE)).unwrap();
    // The database alone is a loss of ours.
    assert_eq!(RetainedStore::kind_of(folder.path()), Some(Kind::Gc));
    fs::copy(other.path().join("retained.journal"), folder.path().join("retained.journal")).unwrap();
    fs::remove_file(folder.path().join("retained.lock")).unwrap();
    // The kept states say whose data they are.
    assert_eq!(RetainedStore::kind_of(folder.path()), Some(Kind::Gc));
    fs::remove_dir_all(folder.path().join("generations")).unwrap();
    assert_eq!(RetainedStore::kind_of(folder.path()), Some(Kind::Gs));
    for start in 1..=2 {
        let (_, found) = RetainedStore::open(folder.path(), Kind::Gs).unwrap();
        assert!(found.standing().iter().any(|(number, _)| *number == alarm::SETTINGS_INVALID), "start {start}");
    }
    // Choosing the kind settles it.
    let (mut store, _) = RetainedStore::open(folder.path(), Kind::Gs).unwrap();
    assert_eq!(answer(&mut store, &SettingsRequest::SaveKind(Kind::Gs)), StorageAnswer::KindSaved(Kind::Gs));
    drop(store);
    assert_eq!(RetainedStore::open(folder.path(), Kind::Gs).unwrap().1.standing(), []);
}

/// What removes or cuts the journal while the control runs does not take the second copy away.
#[test]
fn b6_a_journal_that_is_removed_or_cut_in_operation_is_made_anew() {
    for damage in ["removed", "cut", "replaced"] {
        for check in [false, true] {
            let folder = session();
            let (mut store, _) = open(folder.path());
            store.commit(&[StorageRequest::Variable(860, Some(1.0))]).unwrap();
            let journal = folder.path().join("retained.journal");
            match damage {
                "removed" => fs::remove_file(&journal).unwrap(),
                "cut" => fs::write(&journal, "").unwrap(),
                _ => {
                    let copy = fs::read(&journal).unwrap();
                    fs::remove_file(&journal).unwrap();
                    fs::write(&journal, copy).unwrap();
                }
            }
            if check {
                store.check_files().unwrap();
            } else {
                store.commit(&[StorageRequest::Variable(861, Some(2.0))]).unwrap();
            }
            let copy = cut_off(folder.path());
            fs::remove_file(copy.path().join(DATABASE)).unwrap();
            fs::remove_dir_all(copy.path().join("generations")).unwrap();
            let (_, found) = open(copy.path());
            let wanted = if check { 861.0 / 8.0 } else { 2.0 };
            assert_eq!([860, 861].map(|number| value(&found, number)), [Some(1.0), Some(wanted)], "{damage} {check}");
        }
    }
}

/// What outlives the database is there again after it was removed, while the control runs.
#[test]
fn b6_passwords_and_states_that_are_removed_in_operation_are_made_anew() {
    let folder = session();
    let (mut store, _) = open(folder.path());
    fs::remove_file(folder.path().join("passwords.ron")).unwrap();
    fs::remove_dir_all(folder.path().join("generations")).unwrap();
    store.check_files().unwrap();
    let copy = cut_off(folder.path());
    for name in [DATABASE, "retained.journal"] {
        fs::remove_file(copy.path().join(name)).unwrap();
    }
    assert_restored(copy.path(), "from what was made anew");
}

/// Another folder in the place of ours, such as a backup: its states stay as they are.
#[test]
fn b6_a_folder_that_is_put_in_the_place_of_the_data_is_not_written_into() {
    let folder = session();
    let (mut store, _) = open(folder.path());
    store.commit(&[StorageRequest::Variable(860, Some(1.0))]).unwrap();
    let backup = cut_off(folder.path());
    let listed = |folder: &Path| -> Vec<_> {
        let mut names: Vec<_> =
            fs::read_dir(folder.join("generations")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        names
    };
    let before = listed(backup.path());
    let aside = folder.path().with_extension("aside");
    fs::rename(folder.path(), &aside).unwrap();
    fs::rename(backup.path(), folder.path()).unwrap();
    assert!(store.commit(&[StorageRequest::Variable(860, Some(2.0))]).is_err());
    drop(store);
    assert_eq!(listed(folder.path()), before);
    fs::remove_dir_all(aside).unwrap();
}

/// A database that belongs to somebody else, or lies in a bad sector.
#[cfg(unix)]
#[test]
fn b6_a_database_that_cannot_be_read_is_restored_from_its_copies() {
    let folder = session();
    fs::remove_file(folder.path().join(DATABASE)).unwrap();
    // As root every file can be read: a socket cannot be opened by anybody.
    let _socket = std::os::unix::net::UnixListener::bind(folder.path().join(DATABASE)).unwrap();
    let (_, found) = open(folder.path());
    assert!(found.loss.is_some() && has_values(&found), "{:?}", found.loss);
}

#[test]
fn b6_a_disk_that_damages_one_file_after_the_other_does_not_keep_the_control_from_starting() {
    let folder = session();
    for number in 1..=99 {
        fs::write(folder.path().join(format!("retained.damaged-{number}.redb")), b"put aside").unwrap();
    }
    for _ in 0..2 {
        fs::write(folder.path().join(DATABASE), b"damaged").unwrap();
        let (_, found) = open(folder.path());
        assert!(found.loss.is_some() && has_values(&found), "{:?}", found.loss);
    }
    let first = fs::read(folder.path().join("retained.damaged-1.redb")).unwrap();
    assert_eq!(first, b"put aside", "the first ones stay");
}

#[cfg(unix)]
#[test]
fn b6_data_and_passwords_are_for_the_user_of_the_control_alone() {
    use std::os::unix::fs::PermissionsExt;
    let folder = session();
    StoredSettings { kind: Some(Kind::Gc), ..StoredSettings::default() }.write(folder.path()).unwrap();
    let generations = fs::read_dir(folder.path().join("generations")).unwrap().map(|entry| entry.unwrap().path());
    let own = [DATABASE, "retained.journal", "retained.lock", "passwords.ron", "settings.ron"]
        .map(|name| folder.path().join(name));
    for file in own.into_iter().chain(generations) {
        let mode = fs::metadata(&file).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o600, "{}", file.display());
    }
}

#[test]
fn b6_without_a_whole_generation_factory_values_stand_under_an_alarm_and_passwords_survive() {
    let folder = session();
    fs::remove_file(folder.path().join(DATABASE)).unwrap();
    remove_copies(folder.path());
    for start in 1..=2 {
        let (mut store, found) = open(folder.path());
        assert!(found.loss.as_ref().is_some_and(|loss| loss.state_of.is_none()), "start {start}");
        assert_eq!(value(&found, 860), None);
        assert!(matches(&mut store, "4711") && !matches(&mut store, "830830"), "start {start}");
    }
    // What nobody has accepted becomes no generation.
    assert!(!folder.path().join("generations").exists());
}

#[test]
fn b6_a_damaged_generation_gives_way_to_the_one_before() {
    let folder = session();
    let (mut store, _) = open(folder.path());
    store.commit(&[StorageRequest::Variable(860, Some(1.0))]).unwrap();
    drop(store);
    let mut files: Vec<_> =
        fs::read_dir(folder.path().join("generations")).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    assert!(files.len() >= 2, "{files:?}");
    let newest = files.last().unwrap();
    fs::write(newest, fs::read_to_string(newest).unwrap().replace("860: 1.0", "860: 2.0")).unwrap();
    fs::remove_file(folder.path().join(DATABASE)).unwrap();
    fs::write(folder.path().join("retained.journal"), "damaged").unwrap();
    let (_, found) = open(folder.path());
    assert!(has_values(&found), "{:?}", found.loss);
}

/// The program runs with data that nobody has accepted only after that.
#[test]
fn b6_cycle_start_is_refused_until_the_data_are_accepted() {
    let folder = session();
    fs::remove_file(folder.path().join(DATABASE)).unwrap();
    let data = folder.path().to_string_lossy().into_owned();
    let run = || kt830(&["run", "O1002", "--data", &data, "--lang", "en"]);
    let out = run();
    let told = String::from_utf8_lossy(&out.stdout).into_owned();
    assert!(!out.status.success() && told.contains("300"), "{told}");
    let (mut store, _) = open(folder.path());
    choose(&mut store, DataChoice::Present);
    drop(store);
    assert!(run().status.success());
}

/// The database and its generations are gone, or nothing of them is whole: the kind of the machine is known all the same.
#[test]
fn k1_data_that_are_lost_with_their_generations_keep_the_kind_and_are_a_loss() {
    for damaged in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        drop(RetainedStore::open(folder.path(), Kind::Gs).unwrap());
        fs::remove_dir_all(folder.path().join("generations")).unwrap();
        if damaged {
            fs::write(folder.path().join(DATABASE), [7; 20_000]).unwrap();
        } else {
            fs::remove_file(folder.path().join(DATABASE)).unwrap();
        }
        assert_eq!(RetainedStore::kind_of(folder.path()), Some(Kind::Gs), "damaged: {damaged}");
        let (_, found) = RetainedStore::open(folder.path(), Kind::Gs).unwrap();
        assert!(found.loss.is_some(), "damaged: {damaged}");
    }
}

/// The lock is no file, but a pipe, a folder or a link into nothing.
#[test]
fn b6_whatever_is_in_the_place_of_the_lock_refuses_no_start() {
    for what in ["pipe", "folder", "link"] {
        let folder = session();
        let lock = folder.path().join("retained.lock");
        fs::remove_file(&lock).unwrap();
        match what {
            "pipe" => assert!(std::process::Command::new("mkfifo").arg(&lock).status().unwrap().success()),
            "folder" => fs::create_dir(&lock).unwrap(),
            _ => std::os::unix::fs::symlink("/nowhere/lock", &lock).unwrap(),
        }
        assert!(has_values(&open(folder.path()).1), "{what}");
    }
}

#[test]
fn b6_a_file_with_the_name_of_an_impossible_generation_is_none() {
    let folder = session();
    fs::write(folder.path().join("generations/retained-18446744073709551615.ron"), "").unwrap();
    let (mut store, _) = open(folder.path());
    let generation = store.commit(&[StorageRequest::Variable(504, Some(9.5))]).unwrap();
    assert!(generation < 1_000_000, "{generation}");
    drop(store);
    fs::remove_file(folder.path().join(DATABASE)).unwrap();
    let found = open(folder.path()).1;
    assert_eq!(found.retained.variables.get(504).unwrap(), Some(9.5));
}

/// Values that are no longer allowed are factory values under alarm 305 until a person has accepted them, also at the next
/// starts; RESET does not.
#[test]
fn b6_values_that_are_dropped_stand_as_an_alarm_until_they_are_accepted() {
    let folder = session();
    let mut database = kt830::store::RetainedDatabase::open(folder.path()).unwrap().database;
    let bad = kt830::store::RetainedChange::Param { key: "P42".into(), value: Some(1e9) };
    database.commit(&[bad]).unwrap();
    drop(database);
    let data = folder.path().to_string_lossy().into_owned();
    let play = |text: &str| {
        let story = tempfile::NamedTempFile::new().unwrap();
        fs::write(story.path(), text).unwrap();
        let out = kt830(&["--kind", "gc", "--data", &data, "play", &story.path().to_string_lossy()]);
        assert!(out.status.success(), "{text}: {}", String::from_utf8_lossy(&out.stdout));
    };
    play("wait 1 s\nexpect alarm 305\nexpect alarm \"P42 = 1000000000\"\nkey reset\nwait 1 s\nexpect alarm 305");
    play("key reset\nwait 1 s\nexpect alarm 305\nunlock builder 4711\naccept data\nwait 1 s\nexpect no alarm");
    play("wait 1 s\nexpect no alarm");
    // The person sets what the alarm names, and accepts: the value stays.
    let mut database = kt830::store::RetainedDatabase::open(folder.path()).unwrap().database;
    let bad = kt830::store::RetainedChange::Param { key: "P42".into(), value: Some(1e9) };
    database.commit(&[bad]).unwrap();
    drop(database);
    play(
        "unlock builder 4711\nwait 0.5 s\nexpect alarm 305\nparam P42 50\nwait 0.5 s\naccept data\nwait 0.5 s\nexpect no alarm",
    );
    play("wait 1 s\nexpect no alarm");
    let (_, found) = open(folder.path());
    assert_eq!(found.retained.params.read(kt830::defs::param::ParamAddress::parse("P42").unwrap()).ok(), Some(50.0));
}

/// Whatever bit of the settings flips: the value is as before, or the control says that the file is not as it was written.
#[test]
fn b6_no_bit_of_the_settings_flips_without_a_word() {
    let folder = tempfile::tempdir().unwrap();
    let settings = StoredSettings {
        kind: Some(Kind::Gc),
        brightness: Some(70),
        serial: Some("/dev/ttyS0".into()),
        ..StoredSettings::default()
    };
    settings.write(folder.path()).unwrap();
    let file = folder.path().join("settings.ron");
    let whole = fs::read(&file).unwrap();
    let mut told = 0;
    for bit in 0..whole.len() * 8 {
        let mut bytes = whole.clone();
        bytes[bit / 8] ^= 1 << (bit % 8);
        fs::write(&file, &bytes).unwrap();
        let _ = fs::remove_file(folder.path().join("settings.ron.bak"));
        match StoredSettings::read_with_warnings(folder.path()) {
            Ok((read, warnings)) if warnings.is_empty() => assert_eq!(read, settings, "bit {bit}"),
            Ok(_) | Err(_) => told += 1,
        }
    }
    assert!(told > whole.len() * 4, "{told} of {}", whole.len() * 8);
}

#[test]
fn k1_a_flipped_bit_in_the_settings_changes_no_kind_of_machine() {
    let folder = session();
    let settings = StoredSettings { kind: Some(Kind::Gc), ..StoredSettings::default() };
    settings.write(folder.path()).unwrap();
    let file = folder.path().join("settings.ron");
    let data = folder.path().to_string_lossy().into_owned();
    let text = fs::read_to_string(&file).unwrap();
    for (bad, what) in
        [(text.replace("Gc", "Ga"), "Ga"), (text.replace("kind", "k\u{1}nd"), "syntax"), (String::new(), "empty")]
    {
        fs::write(&file, bad).unwrap();
        let _ = fs::remove_file(folder.path().join("settings.ron.bak"));
        let out = kt830(&["run", "O1002", "--data", &data, "--lang", "en"]);
        let told = String::from_utf8_lossy(&out.stdout).into_owned();
        assert!(!out.status.success() && told.contains("304"), "{what}: {told}");
        // Its axes are those of the data: a cylindrical grinder has no Y.
        assert!(!told.contains("Y  work"), "{what}: {told}");
    }
    // The kind is chosen again: settings and data agree.
    let (mut store, _) = open(folder.path());
    assert_eq!(answer(&mut store, &SettingsRequest::SaveKind(Kind::Gc)), StorageAnswer::KindSaved(Kind::Gc));
    drop(store);
    assert!(kt830(&["run", "O1002", "--data", &data]).status.success());
}

/// Damaged settings whose backup is of another kind: the kind of the data counts, under alarm 304.
#[test]
fn k1_an_old_backup_of_the_settings_of_another_kind_changes_no_kind_of_machine() {
    let folder = session();
    let file = folder.path().join("settings.ron");
    StoredSettings { kind: Some(Kind::Ga), ..StoredSettings::default() }.write(folder.path()).unwrap();
    fs::rename(&file, folder.path().join("settings.ron.bak")).unwrap();
    let data = folder.path().to_string_lossy().into_owned();
    for bad in [Some("(kind: Some("), None] {
        let _ = fs::remove_file(&file);
        bad.into_iter().for_each(|text| fs::write(&file, text).unwrap());
        let out = kt830(&["run", "O1002", "--data", &data, "--lang", "en"]);
        let told = String::from_utf8_lossy(&out.stdout).into_owned();
        assert!(!out.status.success() && told.contains("304"), "{bad:?}: {told}");
        assert!(!told.contains("Y  work"), "{bad:?}: {told}");
    }
}

#[test]
fn k1_another_kind_is_asked_for_in_vain() {
    let folder = session();
    let data = folder.path().to_string_lossy().into_owned();
    let out = kt830(&["run", "O1002", "--data", &data, "--kind", "gs"]);
    let told = String::from_utf8_lossy(&out.stderr).into_owned();
    assert!(out.status.code() == Some(2) && told.contains("those of kind gc"), "{told}");
    // A change of the kind on the settings page takes the data along.
    let (mut store, _) = open(folder.path());
    answer(&mut store, &SettingsRequest::SaveKind(Kind::Gs));
    drop(store);
    assert_eq!(RetainedStore::kind_of(folder.path()), Some(Kind::Gs));
    assert_eq!(StoredSettings::read(folder.path()).unwrap().kind, Some(Kind::Gs));
}

/// A folder that is removed or replaced under a running control takes no commit in silence.
#[test]
fn b6_a_data_folder_that_is_removed_or_replaced_is_noticed_by_the_next_commit() {
    for is_replaced in [false, true] {
        let folder = session();
        let (mut store, _) = open(folder.path());
        let change = [StorageRequest::Variable(860, Some(1.0))];
        store.commit(&change).unwrap();
        let aside = folder.path().with_extension("aside");
        fs::rename(folder.path(), &aside).unwrap();
        if is_replaced {
            fs::create_dir(folder.path()).unwrap();
            fs::copy(aside.join(DATABASE), folder.path().join(DATABASE)).unwrap();
        }
        let refused = store.commit(&change).unwrap_err().to_string();
        assert!(refused.contains("removed or replaced"), "{refused}");
        assert!(store.commit(&change).is_err(), "and by every later one");
        drop(store);
        fs::remove_dir_all(&aside).unwrap();
    }
}

#[test]
fn b6_a_damaged_database_is_told_in_words() {
    let folder = session();
    let whole = fs::read(folder.path().join(DATABASE)).unwrap();
    let data = folder.path().to_string_lossy().into_owned();
    for at in (0..12).map(|k| k * 4_096 + 17 * k) {
        let mut bytes = whole.clone();
        bytes[at] ^= 0x40;
        fs::write(folder.path().join(DATABASE), &bytes).unwrap();
        let out = kt830(&["check", "programs/O1001.NC", "--data", &data]);
        let told = String::from_utf8_lossy(&out.stderr).into_owned();
        assert!(out.status.success() && !told.contains("panicked"), "byte {at}: {told}");
    }
}

/// What is no regular file is not read, and nothing waits for it.
#[cfg(unix)]
#[test]
fn t4_devices_and_pipes_are_refused_by_every_command() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("O0001.NC");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    for path in ["/dev/zero", &pipe.to_string_lossy()] {
        for words in [&["check", path][..], &["run", path], &["play", path], &["run", "O1002", "--part", path]] {
            let out = kt830(words);
            let told = String::from_utf8_lossy(&out.stderr).into_owned();
            assert_eq!(out.status.code(), Some(2), "{words:?}: {told}");
        }
    }
    // A trace does not wait for a reader either.
    let out = kt830(&["run", "O1002", "--trace", &pipe.to_string_lossy()]);
    let told = String::from_utf8_lossy(&out.stderr).into_owned();
    assert!(out.status.code() == Some(2) && told.contains("a pipe; name a file"), "{told}");
}

/// A folder that cannot be written, or a disk that is mounted read-only after a fault, is no dead panel.
#[test]
fn b6_data_whose_folder_cannot_be_written_start_under_alarm_301() {
    let folder = session();
    let data = folder.path().to_string_lossy().into_owned();
    fs::write(folder.path().join("backups"), "no folder").unwrap();
    let story = tempfile::NamedTempFile::new().unwrap();
    fs::write(story.path(), "wait 1 s\nexpect alarm 301\nexpect alarm \"backups\"\nexpect #860 107.5\n").unwrap();
    let out = kt830(&["--kind", "gc", "--data", &data, "play", &story.path().to_string_lossy()]);
    assert!(out.status.success(), "{}{}", String::from_utf8_lossy(&out.stdout), String::from_utf8_lossy(&out.stderr));
    // Also with the database gone: that is a loss, not a first start.
    fs::remove_file(folder.path().join(DATABASE)).unwrap();
    fs::write(story.path(), "wait 1 s\nexpect alarm 300\nexpect alarm 301\nexpect #860 107.5\n").unwrap();
    let out = kt830(&["--kind", "gc", "--data", &data, "play", &story.path().to_string_lossy()]);
    assert!(out.status.success(), "{}{}", String::from_utf8_lossy(&out.stdout), String::from_utf8_lossy(&out.stderr));
    // A first start there is refused: nothing is lost, and the place is wrong.
    let first = tempfile::tempdir().unwrap();
    fs::write(first.path().join("backups"), "no folder").unwrap();
    let data = first.path().to_string_lossy().into_owned();
    let out = kt830(&["--kind", "gc", "--data", &data, "play", &story.path().to_string_lossy()]);
    assert_eq!(out.status.code(), Some(2));
}

/// A damaged database that cannot be put aside stays where it is: the control starts with the copies, and says that it
/// stores nothing. Once it can be put aside, the next start does it.
#[test]
fn b6_a_damaged_database_that_cannot_be_put_aside_is_no_dead_panel() {
    let folder = session();
    let names: Vec<_> = (1..=99).map(|number| folder.path().join(format!("retained.damaged-{number}.redb"))).collect();
    names.iter().for_each(|name| fs::create_dir(name).unwrap());
    fs::write(folder.path().join(DATABASE), [7; 20_000]).unwrap();
    for start in 1..=2 {
        let (_, found) = open(folder.path());
        assert!(found.loss.is_some() && has_values(&found), "start {start}");
        assert!(found.standing().iter().any(|(number, _)| *number == alarm::STORE_FAILED), "start {start}");
        assert_eq!(fs::read(folder.path().join(DATABASE)).unwrap(), [7; 20_000], "start {start}: it is kept");
    }
    fs::remove_dir(&names[0]).unwrap();
    assert_restored(folder.path(), "put aside");
    assert_eq!(fs::read(&names[0]).unwrap(), [7; 20_000]);
}

/// A lock that cannot be made or moved: the folder itself is locked.
#[test]
fn b6_a_lock_that_cannot_be_made_is_no_dead_panel() {
    let folder = session();
    fs::remove_file(folder.path().join("retained.lock")).unwrap();
    for name in ["retained.lock", "retained.lock.damaged"] {
        fs::create_dir_all(folder.path().join(name).join("not empty")).unwrap();
    }
    let (store, found) = open(folder.path());
    assert!(found.loss.is_none() && has_values(&found));
    assert!(RetainedStore::open(folder.path(), Kind::Gc).is_err(), "two controls on one folder");
    drop(store);
    assert!(has_values(&open(folder.path()).1));
}

/// A control whose lock was deleted still has its database: a second one does not judge what the first one writes.
#[test]
fn b6_a_second_control_is_refused_although_the_lock_is_gone() {
    let folder = session();
    let (mut store, _) = open(folder.path());
    fs::remove_file(folder.path().join("retained.lock")).unwrap();
    for value in 0..20 {
        store.commit(&[StorageRequest::Variable(859, Some(f64::from(value)))]).unwrap();
        let second = RetainedStore::open(folder.path(), Kind::Gc);
        assert!(second.is_err_and(|refused| refused.to_string().contains("another kt830")), "{value}");
    }
    drop(store);
    let (_, found) = open(folder.path());
    assert!(found.loss.is_none() && has_values(&found) && value(&found, 859) == Some(19.0));
}

/// A link to a share that is not mounted, or a file, in the place of a folder: with data it is told and no dead panel.
#[test]
fn b6_a_folder_of_programs_that_is_gone_refuses_no_start() {
    let folder = session();
    drop(DataDir::resolve(Some(folder.path())).unwrap());
    for name in ["programs", "screens"] {
        fs::remove_dir_all(folder.path().join(name)).unwrap();
        fs::write(folder.path().join(name), "no folder").unwrap();
    }
    let data_again = DataDir::resolve(Some(folder.path())).unwrap();
    assert!(data_again.fault().is_some_and(|what| what.en().contains("screens")), "alarm 301 names it");
    let folders = Folders::of_data(&data_again, Kind::Gc).unwrap();
    // The storage of the window starts and says which folder it is.
    let told = folders.read_programs().unwrap_err().message();
    assert!(told.en().contains("programs"), "{}", told.en());
    let storage = ThreadedStorage::start(RetainedWorker::new(None), StorageWorker::new(JobRunner::new(folders)));
    let mut told = Vec::new();
    storage.unwrap().poll(&mut told);
    let failed = |arrival: &Arrival| matches!(arrival, Arrival::Command(Command::DiskFailed(_)));
    assert_eq!(told.iter().filter(|arrival| failed(arrival)).count(), 2, "programs and screens");
    // A first start there is refused, with the name of the folder.
    let first = tempfile::tempdir().unwrap();
    let data = DataDir::resolve(Some(first.path())).unwrap();
    fs::remove_dir_all(first.path().join("programs")).unwrap();
    fs::write(first.path().join("programs"), "no folder").unwrap();
    let refused = Folders::of_data(&data, Kind::Gc);
    assert!(refused.is_err_and(|why| why.to_string().contains("programs")));
}

/// A start that was cut after the lock is a first start; whatever else a control leaves behind is not.
#[test]
fn b6_what_a_control_leaves_behind_tells_a_first_start_from_a_loss() {
    let first = tempfile::tempdir().unwrap();
    fs::write(first.path().join("retained.lock"), "").unwrap();
    assert_eq!(open(first.path()).1.loss, None);
    for left in ["generations", "passwords.ron"] {
        let folder = session();
        for name in [DATABASE, "retained.lock", "generations", "passwords.ron", "passwords.ron.bak"] {
            let path = folder.path().join(name);
            match name == left {
                true => {}
                false if path.is_dir() => fs::remove_dir_all(path).unwrap(),
                false => drop(fs::remove_file(path)),
            }
        }
        assert!(open(folder.path()).1.loss.is_some(), "{left}");
    }
}

/// The replacement comes with the file: there is no moment with an empty database in the place of the lost one.
#[test]
fn b6_a_power_cut_while_lost_data_are_replaced_leaves_them_lost() {
    let folder = session();
    fs::write(folder.path().join(DATABASE), [7; 20_000]).unwrap();
    // Put aside, the new file complete under its other name, not yet renamed.
    drop(open(folder.path()));
    let made = folder.path().join(DATABASE);
    fs::rename(&made, folder.path().join("retained.fresh.redb")).unwrap();
    let (_, found) = open(folder.path());
    assert!(found.loss.is_some() && has_values(&found));
}

/// A database of some days ago, put back: its next states are newer than those that are kept.
#[test]
fn b6_states_after_an_old_database_was_put_back_are_kept() {
    let folder = session();
    let old = fs::read(folder.path().join(DATABASE)).unwrap();
    for value in 1..=6 {
        let (mut store, _) = open(folder.path());
        store.commit(&[StorageRequest::Variable(860, Some(f64::from(value)))]).unwrap();
    }
    fs::write(folder.path().join(DATABASE), old).unwrap();
    let (mut store, _) = open(folder.path());
    choose(&mut store, DataChoice::Present);
    store.commit(&[StorageRequest::Variable(860, Some(77.0))]).unwrap();
    drop(store);
    fs::remove_file(folder.path().join(DATABASE)).unwrap();
    assert_eq!(value(&open(folder.path()).1, 860), Some(77.0));
}

#[test]
fn b6_states_that_cannot_be_kept_do_not_keep_the_control_from_starting() {
    let folder = session();
    fs::remove_dir_all(folder.path().join("generations")).unwrap();
    fs::write(folder.path().join("generations"), "in the way").unwrap();
    let (_, found) = open(folder.path());
    assert!(found.unkept.is_some_and(|why| why.contains("generations")) && found.loss.is_none());
}

#[test]
fn k1_a_story_of_another_kind_does_not_touch_the_data() {
    let folder = session();
    let data = folder.path().to_string_lossy().into_owned();
    let story = folder.path().join("gs.story");
    fs::write(&story, "kind gs\nwait 0.1 s\n").unwrap();
    let out = kt830(&["play", &story.to_string_lossy(), "--data", &data]);
    let told = String::from_utf8_lossy(&out.stderr).into_owned();
    assert!(out.status.code() == Some(2) && told.contains("those of kind gc"), "{told}");
}

#[test]
fn t4_a_check_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().to_string_lossy().into_owned();
    assert!(kt830(&["check", "programs/O1001.NC", "--data", &data]).status.success());
    assert!(!folder.path().join(DATABASE).exists());
}

/// A disk that takes no more bytes.
struct FullDisk;

impl DiskObserver for FullDisk {
    fn before(&mut self, change: DiskChange<'_>) -> io::Result<()> {
        match change {
            DiskChange::Write { .. } | DiskChange::SetLength { .. } => Err(io::ErrorKind::StorageFull.into()),
            _ => Ok(()),
        }
    }
}

/// A start on a full disk ended with a line on the console.
#[test]
fn b6_a_start_on_a_full_disk_has_all_values_under_an_alarm_and_stores_again_when_there_is_room() {
    let folder = session();
    let full = disk::observe(Rc::new(RefCell::new(FullDisk)));
    let (mut store, found) = open(folder.path());
    assert!(has_values(&found) && found.loss.is_none());
    let standing: Vec<u16> = found.standing().iter().map(|(number, _)| *number).collect();
    assert_eq!(standing, [alarm::STORE_FAILED]);
    assert!(matches(&mut store, "4711"));
    let change = [StorageRequest::Variable(850, Some(1.5))];
    assert!(store.commit(&change).is_err(), "nothing is acknowledged");
    drop(full);
    store.commit(&[]).unwrap();
    drop(store);
    let (_, found) = open(folder.path());
    assert!(has_values(&found) && value(&found, 850) == Some(1.5) && found.standing().is_empty());
}

/// The first start of all, and one after damage: the file is made once there is room.
#[test]
fn b6_a_database_that_cannot_be_made_is_made_by_a_later_commit() {
    let folder = tempfile::tempdir().unwrap();
    let full = disk::observe(Rc::new(RefCell::new(FullDisk)));
    let (mut store, found) = open(folder.path());
    assert_eq!(found.standing().len(), 1);
    drop(full);
    store.commit(&[StorageRequest::Variable(850, Some(2.5))]).unwrap();
    drop(store);
    let (_, found) = open(folder.path());
    assert_eq!((value(&found, 850), found.standing().len()), (Some(2.5), 0));
    assert_eq!(RetainedStore::kind_of(folder.path()), Some(Kind::Gc), "bound to its kind");
}
