//! Retained data over restarts, power cuts and damaged files.

use std::fs;
use std::path::Path;

use kt830::defs::alarm_history::{AlarmEnd, MAX_ALARM_HISTORY, PastAlarm};
use kt830::defs::date::DateTime;
use kt830::defs::hour_record::HourRecord;
use kt830::defs::part_record::PartRecord;
use kt830::defs::part_verdict::PartVerdict;
use kt830::defs::text::{LocalizedText, SharedWords};
use kt830::store::{
    Generation, OpenedDatabase, RetainedChange, RetainedData, RetainedDatabase, RetainedError, ToolOffset,
};
use kt830::units::PerAxis;
use proptest::prelude::*;
use redb::ReadableDatabase;

/// How often the data are asked for while a process holds their lock.
const TRIES: usize = 100_000;

/// Opens the data. A process that another test starts has the lock of all open files for a moment, between its birth and
/// its own program: the data are asked for again.
fn open(folder: &Path) -> OpenedDatabase {
    for _ in 0..TRIES {
        match RetainedDatabase::open(folder) {
            Err(RetainedError::AlreadyRunning(_)) => std::thread::yield_now(),
            opened => return opened.expect("opens"),
        }
    }
    panic!("another control has {} open", folder.display())
}

fn variable(number: u16, value: f64) -> RetainedChange {
    RetainedChange::Variable { number, value: Some(value) }
}

/// One of each kind.
fn one_of_each() -> Vec<RetainedChange> {
    let offset = ToolOffset { geometry: PerAxis([1.0, 2.0, 3.0]), wear: PerAxis([-0.005, 0.0, 0.01]) };
    vec![
        variable(500, 12.345),
        RetainedChange::Param { key: "P16.0".to_owned(), value: Some(1.0) },
        RetainedChange::Offset { number: 16, offset },
        RetainedChange::WorkOffset { index: 5, origin: PerAxis([-100.0, 0.0, 50.5]) },
        RetainedChange::Number { key: "dressing point X".to_owned(), value: Some(-12.5) },
        RetainedChange::Text { key: "program".to_owned(), value: Some("O1001 外圆".to_owned()) },
        RetainedChange::Alarm(alarm(7, "急停")),
        RetainedChange::Part(part(1_001)),
        RetainedChange::Hour(HourRecord {
            hour: 498_686,
            seconds: [1_800, 600, 60, 1_140],
            explained: [0, 1_200, 0, 0, 0, 300],
            good: 37,
            bad: 1,
        }),
    ]
}

/// A finished part.
fn part(count: u64) -> PartRecord {
    PartRecord {
        count,
        number: 12,
        program: 1_002,
        order: 501,
        ended: DateTime(1_795_273_316),
        cycle_seconds: 27.02,
        size: Some(40.0012),
        limits: Some([40.0, 39.995, 40.005]),
        verdict: PartVerdict::Good,
        since_dressing: 3,
        wheel_mm: Some(598.4),
        alarms: [103, 0, 0, 0],
    }
}

/// An alarm of the history.
fn alarm(count: u64, text: &str) -> PastAlarm {
    let ended = Some((AlarmEnd::Reset, Some(DateTime(1_795_273_400))));
    PastAlarm {
        count,
        number: 0,
        text: LocalizedText::new(text, text),
        cause: SharedWords::default(),
        remedy: SharedWords::either("改数值", "correct the value"),
        place: Some((1_001, 7)),
        came: DateTime(1_795_273_316),
        ended,
    }
}

/// The same machine without any value.
fn none_of(data: &RetainedData) -> RetainedData {
    RetainedData { identity: data.identity, ..RetainedData::default() }
}

/// A file of 400 variables, closed; returns what was in it.
fn filled(folder: &Path) -> RetainedData {
    let mut retained = open(folder).database;
    let changes: Vec<RetainedChange> = (200..600).map(|number| variable(number, f64::from(number) / 8.0)).collect();
    retained.commit(&changes).expect("commits");
    retained.commit(&one_of_each()).expect("commits");
    retained.load().expect("loads")
}

#[test]
fn what_was_committed_is_there_after_a_restart() {
    let folder = tempfile::tempdir().unwrap();
    let first = open(folder.path());
    assert!(first.fresh && first.damaged.is_none());
    let mut retained = first.database;
    assert_eq!(retained.load().unwrap(), none_of(&retained.load().unwrap()));
    assert_eq!(retained.commit(&one_of_each()).unwrap(), Generation(1));
    let before = retained.load().unwrap();
    drop(retained);

    let again = open(folder.path());
    assert!(!again.fresh && again.damaged.is_none());
    let mut retained = again.database;
    assert_eq!(retained.load().unwrap(), before);
    assert_eq!(before.variables.get(&500), Some(&12.345));
    assert_eq!(before.params.get("P16.0"), Some(&1.0));
    assert_eq!(before.offsets[&16].wear, PerAxis([-0.005, 0.0, 0.01]));
    assert_eq!(before.work_offsets[&5], PerAxis([-100.0, 0.0, 50.5]));
    assert_eq!(before.numbers.get("dressing point X"), Some(&-12.5));
    assert_eq!(before.texts.get("program").map(String::as_str), Some("O1001 外圆"));
    assert_eq!(retained.commit(&[]).unwrap(), Generation(2));
}

#[test]
fn b3_a_variable_set_to_null_is_absent_and_the_later_change_of_a_commit_wins() {
    let folder = tempfile::tempdir().unwrap();
    let mut retained = open(folder.path()).database;
    retained.commit(&[variable(500, 1.0), variable(500, 2.0), variable(501, 3.0)]).unwrap();
    let clear = |key: &str| RetainedChange::Param { key: key.to_owned(), value: None };
    retained.commit(&[RetainedChange::Variable { number: 501, value: None }, clear("P270")]).unwrap();
    retained.commit(&[RetainedChange::Text { key: "never set".to_owned(), value: None }]).unwrap();
    drop(retained);
    let opened = open(folder.path());
    assert!(opened.damaged.is_none(), "{:?}", opened.damaged);
    let mut retained = opened.database;
    let loaded = retained.load().unwrap();
    assert_eq!(loaded.variables.into_iter().collect::<Vec<_>>(), [(500, 2.0)]);
    assert!(loaded.params.is_empty());
}

#[test]
fn a_bad_change_refuses_the_whole_commit() {
    let folder = tempfile::tempdir().unwrap();
    let mut retained = open(folder.path()).database;
    let zero = ToolOffset::default();
    let bad = [
        variable(500, f64::NAN),
        RetainedChange::Param { key: String::new(), value: Some(1.0) },
        RetainedChange::Param { key: "P".repeat(65), value: Some(1.0) },
        RetainedChange::Offset { number: 0, offset: zero },
        RetainedChange::Offset { number: 17, offset: zero },
        RetainedChange::WorkOffset { index: 55, origin: PerAxis([0.0; 3]) },
        RetainedChange::WorkOffset { index: 0, origin: PerAxis([0.0, f64::INFINITY, 0.0]) },
        RetainedChange::Text { key: "note".to_owned(), value: Some("x".repeat(5000)) },
    ];
    for change in bad {
        let refused = retained.commit(&[variable(501, 1.0), change.clone()]);
        assert!(matches!(refused, Err(RetainedError::BadChange { .. })), "{change:?}: {refused:?}");
    }
    assert_eq!(retained.load().unwrap(), none_of(&retained.load().unwrap()));
}

#[test]
fn a_second_control_on_the_same_data_is_refused_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let first = open(folder.path());
    let refused = RetainedDatabase::open(folder.path()).expect_err("refused").to_string();
    assert!(refused.contains("another kt830 is running on this data"), "{refused}");
    drop(first);
    assert!(!open(folder.path()).fresh);
}

/// Puts a damaged file in place and sees it kept, told, and a fresh start that works.
fn check_damage(what: &str, bytes: &[u8]) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("retained.redb");
    fs::write(&file, bytes).unwrap();
    let opened = open(folder.path());
    let report = opened.damaged.unwrap_or_else(|| panic!("{what}: not noticed"));
    assert!(opened.fresh, "{what}");
    assert!(!report.cause.is_empty(), "{what}");
    assert_eq!(report.kept_as, folder.path().join("retained.damaged-1.redb"), "{what}");
    assert!(fs::read(&report.kept_as).unwrap() == bytes, "{what}: not kept as it was");
    let mut retained = opened.database;
    assert_eq!(retained.load().unwrap(), none_of(&retained.load().unwrap()), "{what}");
    retained.commit(&[variable(500, 1.0)]).unwrap();
    drop(retained);
    let again = open(folder.path());
    assert!(!again.fresh && again.damaged.is_none(), "{what}");
}

#[test]
fn a_file_cut_off_anywhere_is_kept_and_told() {
    let folder = tempfile::tempdir().unwrap();
    filled(folder.path());
    let whole = fs::read(folder.path().join("retained.redb")).unwrap();
    for length in [0, 1, 9, 320, 4096, 4097, 8192, whole.len() / 2, whole.len() - 1] {
        check_damage(&format!("cut to {length}"), &whole[..length]);
    }
}

#[test]
fn a_foreign_file_is_kept_and_told() {
    check_damage("text", b"this is not a database at all, only a note that someone saved here");
    check_damage("zeros", &vec![0; 100_000]);
    let other = tempfile::tempdir().unwrap();
    let path = other.path().join("other.redb");
    let database = redb::Database::create(&path).unwrap();
    let transaction = database.begin_write().unwrap();
    transaction.open_table(redb::TableDefinition::<u64, u64>::new("meta")).unwrap().insert(1, 2).unwrap();
    transaction.commit().unwrap();
    drop(database);
    check_damage("another program's database", &fs::read(&path).unwrap());
}

/// Flips one byte in each stretch of the file. What opens as whole must hold exactly what was committed.
#[test]
fn a_flipped_byte_never_gives_other_values() {
    let folder = tempfile::tempdir().unwrap();
    let good = filled(folder.path());
    let whole = fs::read(folder.path().join("retained.redb")).unwrap();
    let trial = tempfile::tempdir().unwrap();
    let (mut noticed, mut tried) = (0, 0);
    let header = (0..320).step_by(7);
    let pages = (4096..whole.len().min(300_000)).step_by(1021);
    for offset in header.chain(pages) {
        let mut flipped = whole.clone();
        flipped[offset] ^= 0x10;
        let place = trial.path().join(offset.to_string());
        fs::create_dir(&place).unwrap();
        fs::write(place.join("retained.redb"), &flipped).unwrap();
        tried += 1;
        match RetainedDatabase::open(&place) {
            Ok(OpenedDatabase { damaged: Some(report), .. }) => {
                noticed += 1;
                assert!(fs::read(report.kept_as).unwrap() == flipped, "offset {offset}");
            }
            Ok(mut opened) => assert_eq!(opened.database.load().unwrap(), good, "offset {offset}"),
            Err(refused) => panic!("offset {offset}: {refused}"),
        }
        fs::remove_dir_all(&place).unwrap();
    }
    assert!(noticed > 10, "only {noticed} of {tried} noticed");
}

/// The file as it lies on the disk while the control runs: what a power cut after a commit leaves.
#[test]
fn a_power_cut_after_a_commit_loses_nothing_and_is_no_damage() {
    let folder = tempfile::tempdir().unwrap();
    let mut retained = open(folder.path()).database;
    for round in 0..5_u16 {
        retained.commit(&[variable(500 + round, f64::from(round)), variable(700, f64::from(round))]).unwrap();
        let cut = tempfile::tempdir().unwrap();
        fs::copy(retained.path(), cut.path().join("retained.redb")).unwrap();
        let opened = open(cut.path());
        assert!(opened.damaged.is_none(), "{:?}", opened.damaged);
        let mut after = opened.database;
        assert_eq!(after.load().unwrap(), retained.load().unwrap());
    }
}

#[test]
fn a_file_of_a_newer_control_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    filled(folder.path());
    let path = folder.path().join("retained.redb");
    let database = redb::Database::open(&path).unwrap();
    let transaction = database.begin_write().unwrap();
    let meta = redb::TableDefinition::<&str, u64>::new("meta");
    transaction.open_table(meta).unwrap().insert("kt830 retained format", 3).unwrap();
    transaction.commit().unwrap();
    drop(database);
    let before = fs::read(&path).unwrap();
    let refused = RetainedDatabase::open(folder.path()).expect_err("refused");
    assert!(matches!(refused, RetainedError::Newer { found: 3, known: 2, .. }), "{refused}");
    assert!(fs::read(&path).unwrap() == before);
}

#[test]
fn a_row_changed_behind_the_control_is_damage() {
    let folder = tempfile::tempdir().unwrap();
    filled(folder.path());
    let path = folder.path().join("retained.redb");
    let database = redb::Database::open(&path).unwrap();
    let transaction = database.begin_write().unwrap();
    let variables = redb::TableDefinition::<u16, f64>::new("variables");
    transaction.open_table(variables).unwrap().insert(501, 999.0).unwrap();
    transaction.commit().unwrap();
    drop(database);
    let opened = open(folder.path());
    assert_eq!(opened.damaged.expect("noticed").cause, "rows do not match their checksum");
}

/// The checksum of the other rows does not know the parts: a control that has no parts reads the rest, and an update can
/// be taken back. Data of such a control have neither table nor sum.
#[test]
fn b6_parts_are_kept_apart_so_that_an_older_control_reads_the_rest() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("retained.redb");
    let meta = redb::TableDefinition::<&str, u64>::new("meta");
    let rows = || {
        let transaction = redb::Database::open(&path).unwrap().begin_read().unwrap();
        let table = transaction.open_table(meta).unwrap();
        ["rows", "production rows"].map(|key| table.get(key).unwrap().map(|sum| sum.value()))
    };
    open(folder.path()).database.commit(&[variable(500, 1.5)]).unwrap();
    let before = rows();
    open(folder.path()).database.commit(&[RetainedChange::Part(part(7))]).unwrap();
    let after = rows();
    assert!(before[0] == after[0] && before[1] != after[1], "{before:?} {after:?}");
    assert_eq!(open(folder.path()).database.load().unwrap().parts[&7], part(7));
    // A part changed behind the control is damage.
    let database = redb::Database::open(&path).unwrap();
    let transaction = database.begin_write().unwrap();
    let parts = redb::TableDefinition::<u16, &str>::new("parts");
    let other = serde_json::to_string(&part(1_007)).unwrap();
    transaction.open_table(parts).unwrap().insert(7, other.as_str()).unwrap();
    transaction.commit().unwrap();
    drop(database);
    assert_eq!(open(folder.path()).damaged.expect("noticed").cause, "rows do not match their checksum");
    // Without table and sum there are no parts.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("retained.redb");
    open(folder.path()).database.commit(&[variable(500, 1.5)]).unwrap();
    let database = redb::Database::open(&path).unwrap();
    let transaction = database.begin_write().unwrap();
    transaction.delete_table(parts).unwrap();
    transaction.delete_table(redb::TableDefinition::<u16, &str>::new("hours")).unwrap();
    transaction.open_table(meta).unwrap().remove("production rows").unwrap();
    transaction.commit().unwrap();
    drop(database);
    let mut opened = open(folder.path());
    assert!(opened.damaged.is_none() && opened.data.parts.is_empty());
    opened.database.commit(&[RetainedChange::Part(part(8))]).unwrap();
    assert_eq!(opened.database.load().unwrap().parts.len(), 1);
}

#[test]
fn b6_the_data_of_a_control_without_a_history_are_taken_over() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("retained.redb");
    open(folder.path()).database.commit(&[variable(500, 1.5)]).unwrap();
    // As the format before had it: without the table of alarms.
    let database = redb::Database::open(&path).unwrap();
    let transaction = database.begin_write().unwrap();
    assert!(transaction.delete_table(redb::TableDefinition::<u16, &str>::new("alarms")).unwrap());
    let meta = redb::TableDefinition::<&str, u64>::new("meta");
    transaction.open_table(meta).unwrap().insert("kt830 retained format", 1).unwrap();
    transaction.open_table(meta).unwrap().remove("identity").unwrap();
    transaction.commit().unwrap();
    drop(database);
    // Nothing said whose the data are.
    fs::write(folder.path().join("retained.lock"), "used\n").unwrap();
    fs::remove_file(folder.path().join("retained.journal")).unwrap();
    let opened = open(folder.path());
    assert!(opened.damaged.is_none() && !opened.fresh);
    let mut retained = opened.database;
    assert_eq!(retained.load().unwrap().variables[&500].to_bits(), 1.5_f64.to_bits());
    retained.commit(&[RetainedChange::Alarm(alarm(1, "急停"))]).unwrap();
    let identity = retained.load().unwrap().identity;
    drop(retained);
    let data = open(folder.path()).database.load().unwrap();
    assert_eq!((data.alarms.len(), data.identity), (1, identity));
    assert!(identity.is_some());
}

#[test]
fn b6_the_history_takes_the_place_of_the_oldest() {
    let folder = tempfile::tempdir().unwrap();
    let mut retained = open(folder.path()).database;
    let most = MAX_ALARM_HISTORY as u64;
    let changes: Vec<RetainedChange> = (1..=most + 20).map(|count| RetainedChange::Alarm(alarm(count, "x"))).collect();
    retained.commit(&changes).unwrap();
    let kept: Vec<u64> = retained.load().unwrap().alarms.values().map(|past| past.count).collect();
    assert_eq!(kept.len(), MAX_ALARM_HISTORY);
    assert_eq!((kept.iter().min(), kept.iter().max()), (Some(&21), Some(&(most + 20))));
    let long = "长".repeat(2_000);
    assert!(matches!(retained.commit(&[RetainedChange::Alarm(alarm(1, &long))]), Err(RetainedError::BadChange { .. })));
}

/// Any change of few keys, so that later ones meet earlier ones.
fn any_change() -> impl Strategy<Value = RetainedChange> {
    (0..9_u8, 0..9_u8, proptest::option::of(-1e5..1e5_f64)).prop_map(|(kind, key, value)| {
        let at = PerAxis([value.unwrap_or(0.0), -0.0, 1e-9]);
        match kind {
            0 => RetainedChange::Variable { number: 500 + u16::from(key), value },
            1 => RetainedChange::Param { key: format!("P{key}"), value },
            2 => RetainedChange::Offset { number: 1 + key, offset: ToolOffset { geometry: at, wear: at } },
            3 => RetainedChange::WorkOffset { index: key, origin: at },
            4 => RetainedChange::Number { key: format!("n{key}"), value },
            5 => RetainedChange::Text {
                key: format!("t{key}"),
                value: value.map(|value| format!("行\n\"{value}\" \\")),
            },
            // A size may have all its digits.
            6 => RetainedChange::Part(PartRecord { size: value.map(|value| value / 3e3), ..part(1 + u64::from(key)) }),
            7 => RetainedChange::Hour(HourRecord { hour: u64::from(key), good: key.into(), ..HourRecord::default() }),
            _ => RetainedChange::Alarm(alarm(1 + u64::from(key), "急停 \n emergency stop")),
        }
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 8, failure_persistence: None, ..ProptestConfig::default() })]

    /// The journal and the database say the same after every commit, and after a restart.
    #[test]
    fn b6_the_copy_beside_the_database_is_the_same_after_every_commit(
        sessions in proptest::collection::vec(
            proptest::collection::vec(proptest::collection::vec(any_change(), 0..4), 1..20),
            1..4,
        )
    ) {
        let folder = tempfile::tempdir().unwrap();
        let copy = || RetainedDatabase::newest_copy(folder.path()).unwrap().data;
        for session in sessions {
            let mut store = open(folder.path()).database;
            prop_assert_eq!(copy(), store.load().unwrap());
            for changes in session {
                store.commit(&changes).unwrap();
                prop_assert_eq!(copy(), store.load().unwrap());
            }
        }
    }
}

/// A power cut leaves the file of an open database; then a bit of it flips. What was acknowledged is there, or the file
/// is damaged: the commit before it must not come back without a word.
#[test]
fn b3_a_flipped_bit_never_brings_an_earlier_commit_back() {
    let folder = tempfile::tempdir().unwrap();
    let mut store = open(folder.path()).database;
    for value in [1.5, 2.5] {
        store.commit(&[RetainedChange::Variable { number: 789, value: Some(value) }]).unwrap();
    }
    let bytes = fs::read(folder.path().join("retained.redb")).unwrap();
    let (mut damaged, mut kept) = (0, 0);
    for at in (0..bytes.len()).step_by(1_511) {
        let mut flipped = bytes.clone();
        flipped[at] ^= 0x10;
        let copy = tempfile::tempdir().unwrap();
        fs::write(copy.path().join("retained.redb"), flipped).unwrap();
        let opened = open(copy.path());
        match opened.damaged {
            Some(_) => damaged += 1,
            None => {
                assert_eq!(opened.data.variables.get(&789), Some(&2.5), "bit of byte {at}");
                kept += 1;
            }
        }
    }
    assert!(damaged > 0 && kept > 0, "{damaged} damaged, {kept} kept");
}
