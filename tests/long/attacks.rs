//! Attacks on what must survive: kills, damaged stores, damaged settings, deletions. Each is a random case; nothing that was
//! acknowledged is lost, nothing is replaced without a word, no start is refused. `KT830_ATTACKS=10` repeats them ten times
//! as often. Power cuts are those of `torture`. Source: safety stance; spec K1, K4.2, B6.

use std::collections::BTreeMap;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command as Process, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};

use kt830::controller::StorageRequest;
use kt830::defs::kind::Kind;
use kt830::host::retained_store::{RetainedStore, StoreReport};
use kt830::io::random::SplitMix64;
use kt830::link::page_command::{PasswordScope, Secret, SettingsRequest};
use kt830::store::{StoredLang, StoredSettings, silence_database_check};
use tempfile::TempDir;

use crate::command::kt830;

/// Names the folder to the process that is killed.
const FOLDER: &str = "KT830_ATTACKED_FOLDER";
/// Values that a killed process writes, over and over.
const VALUES: std::ops::Range<u32> = 900..920;

/// One after the other: a process that is just being started holds the locks of other data directories, too.
static ALONE: Mutex<()> = Mutex::new(());

fn alone() -> MutexGuard<'static, ()> {
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A number of cases.
fn cases(often: usize) -> usize {
    let times: usize = std::env::var("KT830_ATTACKS").ok().and_then(|times| times.parse().ok()).unwrap_or(1);
    often * times
}

fn below(chance: &mut SplitMix64, count: usize) -> usize {
    (chance.next_unit() * count as f64) as usize
}

fn open(folder: &Path) -> (RetainedStore, StoreReport) {
    RetainedStore::open(folder, Kind::Gc).unwrap()
}

fn values(found: &StoreReport) -> BTreeMap<u32, f64> {
    let value = |number: u32| Some((number, found.retained.variables.get(number).unwrap()?));
    VALUES.filter_map(value).collect()
}

fn write(store: &mut RetainedStore, number: u32, value: f64) {
    store.commit(&[StorageRequest::Variable(number, Some(value))]).unwrap();
}

/// Value `count` belongs to this variable.
fn variable_of(count: u32) -> u32 {
    VALUES.start + count % VALUES.len() as u32
}

/// Writes values and acknowledges each on its output: for ever if another test is to kill it, else twenty.
#[test]
fn b3_values_are_acknowledged_after_they_are_stored() {
    let _alone = alone();
    let own = tempfile::tempdir().unwrap();
    let attacked = std::env::var_os(FOLDER).map(PathBuf::from);
    let folder = attacked.as_deref().unwrap_or(own.path());
    let (mut store, found) = open(folder);
    let first = values(&found).values().fold(0.0_f64, |most, value| most.max(*value)) as u32 + 1;
    for count in first.. {
        write(&mut store, variable_of(count), f64::from(count));
        println!("acknowledged {count}");
        if attacked.is_none() && count == 20 {
            break;
        }
    }
    drop(store);
    assert_eq!(values(&open(folder).1).len(), 20);
}

#[test]
fn b3_a_killed_process_loses_nothing_that_it_has_acknowledged() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let mut chance = SplitMix64::new(340);
    let kills = cases(34);
    let mut acknowledged = 0;
    for kill in 0..kills {
        let mut process = Process::new(std::env::current_exe().unwrap())
            .args(["--exact", "attacks::b3_values_are_acknowledged_after_they_are_stored", "--nocapture"])
            .env(FOLDER, folder.path())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let lines = BufReader::new(process.stdout.take().unwrap()).lines();
        let told =
            lines.map_while(Result::ok).filter_map(|line| line.rsplit("acknowledged ").next()?.parse::<u32>().ok());
        // Killed after some acknowledgements, wherever it is by then.
        let mut told = told.into_iter();
        acknowledged = told.by_ref().take(1 + below(&mut chance, 12)).last().unwrap_or(acknowledged);
        process.kill().unwrap();
        acknowledged = told.last().unwrap_or(acknowledged);
        process.wait().unwrap();
        let (store, found) = open(folder.path());
        drop(store);
        assert!(found.loss.is_none(), "kill {kill}: {:?}", found.loss);
        let newest = values(&found).values().fold(0.0_f64, |most, value| most.max(*value));
        // One more may be stored and not acknowledged.
        assert!(
            (newest - f64::from(acknowledged)).abs() < 1.5 && newest >= f64::from(acknowledged),
            "kill {kill}: {newest}, {acknowledged}"
        );
        for count in acknowledged.saturating_sub(VALUES.len() as u32 - 2)..=acknowledged {
            assert!(
                count == 0 || values(&found).get(&variable_of(count)).is_some_and(|value| *value >= f64::from(count))
            );
        }
    }
    println!("{kills} kills, {acknowledged} acknowledgements, none lost");
}

/// Data with generations: every value is 4 when all is stored.
fn session() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for session in 1..=4 {
        let (mut store, _) = open(folder.path());
        VALUES.for_each(|number| write(&mut store, number, f64::from(session)));
    }
    folder
}

/// Damages bytes as disks, sticks and careless people do.
fn damage(bytes: &mut Vec<u8>, chance: &mut SplitMix64) {
    let at = below(chance, bytes.len().max(1));
    match below(chance, 6) {
        0..=1 => {
            for _ in 0..=below(chance, 8) {
                let at = below(chance, bytes.len());
                bytes[at] ^= 1 << below(chance, 8);
            }
        }
        2 => bytes.truncate(at),
        3 => {
            let to = (at + 4_096).min(bytes.len());
            bytes[at..to].fill(0);
        }
        4 => {
            let to = (at + 512).min(bytes.len());
            bytes[at..to].reverse();
        }
        _ => bytes.extend(std::iter::repeat_n(0x5a, 1 + at)),
    }
}

#[test]
fn b6_a_damaged_store_is_told_and_its_last_state_is_there() {
    silence_database_check();
    let _alone = alone();
    let folder = session();
    let file = folder.path().join("retained.redb");
    let whole = fs::read(&file).unwrap();
    let mut chance = SplitMix64::new(300);
    let (stores, mut told) = (cases(60), 0);
    for case in 0..stores {
        let mut bytes = whole.clone();
        damage(&mut bytes, &mut chance);
        fs::write(&file, &bytes).unwrap();
        let (store, found) = open(folder.path());
        drop(store);
        assert!(values(&found).values().all(|value| *value >= 3.0), "case {case}: {:?}", values(&found));
        let is_whole = values(&found).len() == VALUES.len() && values(&found).values().all(|value| *value > 3.5);
        assert!(is_whole || found.loss.is_some(), "case {case}: an older state without a word");
        assert!(values(&found).len() == VALUES.len(), "case {case}: values are gone: {:?}", found.loss);
        told += usize::from(found.loss.is_some());
    }
    println!("{stores} damaged stores, {told} told, the others had no effect; 0 silent, 0 lost, 0 refused starts");
    assert!(told > stores / 4);
}

/// Starts the control on a data directory: whether it starts as a cylindrical grinder, and what it says.
fn start(folder: &Path) -> (bool, String) {
    let story = folder.join("start.story");
    // Other kinds have no such key: the story is refused.
    fs::write(&story, "key headstock-stop\n").unwrap();
    let out = kt830(&["play", &story.to_string_lossy(), "--data", &folder.to_string_lossy(), "--lang", "en"]);
    (out.status.success(), String::from_utf8_lossy(&out.stderr).into_owned())
}

#[test]
fn k1_damaged_settings_change_no_kind_and_refuse_no_start() {
    let _alone = alone();
    let folder = session();
    let settings = StoredSettings {
        kind: Some(Kind::Gc),
        lang: Some(StoredLang::Zh),
        brightness: Some(70),
        ..StoredSettings::default()
    };
    settings.write(folder.path()).unwrap();
    let file = folder.path().join("settings.ron");
    let whole = fs::read(&file).unwrap();
    let mut chance = SplitMix64::new(226);
    let (files, mut told) = (cases(23), 0);
    for case in 0..files {
        let mut bytes = whole.clone();
        damage(&mut bytes, &mut chance);
        fs::write(&file, &bytes).unwrap();
        let _ = fs::remove_file(folder.path().join("settings.ron.bak"));
        let (started, words) = start(folder.path());
        assert!(started, "case {case}: {words}");
        let unchanged = StoredSettings::read(folder.path()).is_ok_and(|read| read == settings);
        assert!(unchanged || words.contains("settings"), "case {case}: without a word");
        told += usize::from(words.contains("settings"));
    }
    println!(
        "{files} damaged settings, {told} told, the others had no effect; 0 silent, 0 other kinds, 0 refused starts"
    );
}

#[test]
fn b6_whatever_is_deleted_is_told_or_made_again_and_no_value_is_lost() {
    let _alone = alone();
    for gone in [
        "retained.redb",
        "retained.lock",
        "settings.ron",
        "passwords.ron",
        "generations",
        "machine-kind.ron",
        "programs",
    ] {
        let folder = session();
        StoredSettings { kind: Some(Kind::Gc), ..StoredSettings::default() }.write(folder.path()).unwrap();
        let (mut store, _) = open(folder.path());
        let (old, new) = (Secret::new("830830".into()), Secret::new("471100".into()));
        store.answer(&SettingsRequest::ChangePassword { scope: PasswordScope::Builder, old, new });
        drop(store);
        let path = folder.path().join(gone);
        if gone == "programs" {
            fs::create_dir(&path).unwrap();
        }
        if path.is_dir() {
            fs::remove_dir_all(&path).unwrap()
        } else {
            fs::remove_file(&path).unwrap()
        }
        let (started, words) = start(folder.path());
        assert!(started, "{gone}: {words}");
        let (store, found) = open(folder.path());
        drop(store);
        assert!(
            values(&found).values().all(|value| *value > 3.5) && values(&found).len() == VALUES.len(),
            "{gone}: {words}"
        );
        assert_eq!(found.loss.is_some(), gone == "retained.redb", "{gone}");
    }
}
