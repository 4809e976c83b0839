//! Passwords whose files are damaged or gone: they survive, or nothing opens. Source: safety stance; spec B6, K6.2.

use std::fs;

use crate::data_loss::{DATABASE, change_password, matches, open, remove_copies, session};

#[test]
fn b6_damaged_passwords_open_nothing() {
    let folder = session();
    fs::remove_file(folder.path().join(DATABASE)).unwrap();
    remove_copies(folder.path());
    fs::write(folder.path().join("passwords.ron"), "{}").unwrap();
    let _ = fs::remove_file(folder.path().join("passwords.ron.bak"));
    let (mut store, _) = open(folder.path());
    assert!(["830830", "4711", "123456", ""].iter().all(|password| !matches(&mut store, password)));
}

/// What was lost with every copy is not known to be the initial password.
#[test]
fn k6_2_passwords_that_are_lost_with_all_data_open_nothing_at_any_start() {
    for left in ["machine-kind.ron", "settings.ron"] {
        let folder = session();
        fs::write(folder.path().join("settings.ron"), "(kind: Some(Gc))").unwrap();
        for file in fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap()) {
            match file.file_name().to_string_lossy() == left {
                true => {}
                false if file.path().is_dir() => fs::remove_dir_all(file.path()).unwrap(),
                false => fs::remove_file(file.path()).unwrap(),
            }
        }
        for start in 1..=3 {
            let (mut store, found) = open(folder.path());
            assert!(found.loss.is_some_and(|loss| loss.state_of.is_none()), "{left}, start {start}");
            let opens = ["830830", "4711", ""].iter().any(|password| matches(&mut store, password));
            assert!(!opens, "{left}, start {start}");
        }
    }
}

/// Passwords that nobody has changed are known to be the initial ones: the file beside the data says so.
#[test]
fn k6_2_initial_passwords_are_not_locked_by_a_loss_of_the_values() {
    let folder = tempfile::tempdir().unwrap();
    drop(open(folder.path()));
    fs::remove_file(folder.path().join(DATABASE)).unwrap();
    remove_copies(folder.path());
    for start in 1..=3 {
        let (mut store, found) = open(folder.path());
        assert!(found.loss.is_some() && matches(&mut store, "830830"), "start {start}");
    }
}

/// A copy beside whole data is made anew before the data are lost, too.
#[test]
fn k6_2_a_copy_of_the_passwords_that_is_damaged_or_gone_is_made_anew_by_the_next_start() {
    for damage in ["gone", "damaged"] {
        let folder = session();
        let copy = folder.path().join("passwords.ron");
        let whole = fs::read(&copy).unwrap();
        match damage {
            "gone" => fs::remove_file(&copy).unwrap(),
            _ => fs::write(&copy, "{}").unwrap(),
        }
        let _ = fs::remove_file(folder.path().join("passwords.ron.bak"));
        let (_, found) = open(folder.path());
        assert!(found.loss.is_none(), "{damage}");
        assert_eq!(fs::read(&copy).unwrap(), whole, "{damage}");
    }
}

/// The password changed last is valid after a loss, not the one of the last generation.
#[test]
fn k6_2_the_newest_password_outlives_an_older_generation() {
    let folder = session();
    drop(open(folder.path()));
    let (mut store, _) = open(folder.path());
    change_password(&mut store, "4711", "4712");
    std::mem::forget(store); // A crash: no generation is kept.
    let copy = tempfile::tempdir().unwrap();
    for name in ["passwords.ron", "generations"] {
        let (from, to) = (folder.path().join(name), copy.path().join(name));
        if from.is_dir() {
            fs::create_dir(&to).unwrap();
            for entry in fs::read_dir(&from).unwrap().map(Result::unwrap) {
                fs::copy(entry.path(), to.join(entry.file_name())).unwrap();
            }
        } else {
            fs::copy(from, to).unwrap();
        }
    }
    let (mut store, found) = open(copy.path());
    assert!(found.loss.is_some() && matches(&mut store, "4712") && !matches(&mut store, "4711"));
}

/// The copy before the last change never takes the place of a newer password.
#[test]
fn k6_2_an_earlier_copy_of_the_passwords_brings_no_old_password_back() {
    for damage in ["flipped", "gone", "empty"] {
        let folder = session();
        let (mut store, _) = open(folder.path());
        change_password(&mut store, "4711", "5822");
        drop(store);
        let copy = folder.path().join("passwords.ron");
        assert!(copy.with_extension("ron.bak").exists());
        match damage {
            "flipped" => {
                let mut bytes = fs::read(&copy).unwrap();
                bytes[10] ^= 1;
                fs::write(&copy, bytes).unwrap();
            }
            "gone" => fs::remove_file(&copy).unwrap(),
            _ => fs::write(&copy, "").unwrap(),
        }
        fs::write(folder.path().join(DATABASE), "damaged").unwrap();
        for start in 1..=2 {
            let (mut store, found) = open(folder.path());
            assert!(found.loss.is_some(), "{damage}");
            let opens = |store: &mut _| ["5822", "4711", "830830"].map(|password| matches(store, password));
            assert_eq!(opens(&mut store), [true, false, false], "{damage}, start {start}");
        }
    }
}

/// Kept states may be older than a change of a password: without its copy nothing opens.
#[test]
fn k6_2_states_from_before_a_change_do_not_open_with_the_initial_password() {
    let folder = tempfile::tempdir().unwrap();
    drop(open(folder.path()));
    let (mut store, _) = open(folder.path());
    store.commit(&[kt830::controller::StorageRequest::Variable(860, Some(1.0))]).unwrap();
    drop(store);
    fs::remove_file(folder.path().join(DATABASE)).unwrap();
    fs::remove_file(folder.path().join("retained.journal")).unwrap();
    fs::remove_file(folder.path().join("passwords.ron")).unwrap();
    let (mut store, found) = open(folder.path());
    assert!(found.loss.is_some_and(|loss| loss.state_of.is_some()));
    assert!(!matches(&mut store, "830830"));
}

/// A lock that says that there were data, and the files before the last ones, are traces, too.
#[test]
fn k6_2_a_lock_in_use_or_an_earlier_file_is_no_first_start() {
    for left in ["retained.lock", "passwords.ron.bak"] {
        let folder = session();
        fs::write(folder.path().join("passwords.ron.bak"), "{}").unwrap();
        for file in fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap()) {
            match file.file_name().to_string_lossy() == left {
                true => {}
                false if file.path().is_dir() => fs::remove_dir_all(file.path()).unwrap(),
                false => fs::remove_file(file.path()).unwrap(),
            }
        }
        let (mut store, found) = open(folder.path());
        assert!(found.loss.is_some() && !matches(&mut store, "830830"), "{left}");
    }
}

/// A database from before the change, with all that belongs to it, and that of another machine: the copy beside it holds.
#[test]
fn k6_2_an_old_or_foreign_database_brings_no_other_password() {
    let old = session();
    let earlier = tempfile::tempdir().unwrap();
    for name in [DATABASE, "retained.journal"] {
        fs::copy(old.path().join(name), earlier.path().join(name)).unwrap();
    }
    let (mut store, _) = open(old.path());
    change_password(&mut store, "4711", "5822");
    drop(store);
    let foreign = tempfile::tempdir().unwrap();
    let (mut store, _) = open(foreign.path());
    change_password(&mut store, "830830", "1111");
    for value in 0..200 {
        store.commit(&[kt830::controller::StorageRequest::Variable(860, Some(f64::from(value)))]).unwrap();
    }
    drop(store);
    for from in [earlier.path(), foreign.path()] {
        let _ = fs::remove_dir_all(old.path().join("generations"));
        for name in [DATABASE, "retained.journal"] {
            fs::copy(from.join(name), old.path().join(name)).unwrap();
        }
        for start in 1..=2 {
            let (mut store, _) = open(old.path());
            let opens = ["5822", "4711", "1111", "830830"].map(|password| matches(&mut store, password));
            assert_eq!(opens, [true, false, false, false], "{}, start {start}", from.display());
        }
    }
    // The next change is newer than all of them.
    let (mut store, _) = open(old.path());
    change_password(&mut store, "5822", "6933");
    drop(store);
    let (mut store, _) = open(old.path());
    assert!(matches(&mut store, "6933") && !matches(&mut store, "5822"));
}

/// The power goes after the commit and before its copy: the new password holds.
#[test]
fn k6_2_a_change_that_was_not_copied_yet_holds() {
    let folder = session();
    let copy = fs::read(folder.path().join("passwords.ron")).unwrap();
    let (mut store, _) = open(folder.path());
    change_password(&mut store, "4711", "5822");
    drop(store);
    fs::write(folder.path().join("passwords.ron"), copy).unwrap();
    let (mut store, found) = open(folder.path());
    assert!(found.loss.is_none() && matches(&mut store, "5822") && !matches(&mut store, "4711"));
}
