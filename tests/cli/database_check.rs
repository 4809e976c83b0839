//! The database is inspected in a process of its own before it is opened: one that would take all memory does not end the
//! control (B6).

#![cfg(target_os = "linux")]

use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use crate::command::kt830_in;

/// Bytes of the first table pages.
const PAGES: std::ops::Range<usize> = 4096..98_304;
/// The highest byte of a page number holds its order: 20 stands for 4 KiB · 2^20 = 4 GiB.
const ORDER_20: u8 = 20 << 3;

/// Whether the inspection of the bytes comes to its end.
fn comes_to_its_end(bytes: &[u8]) -> bool {
    let mut check = Command::new(env!("CARGO_BIN_EXE_kt830"))
        .arg("check-database")
        .stdin(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    check.stdin.take().unwrap().write_all(bytes).unwrap();
    check.wait().unwrap().success()
}

fn flipped(whole: &[u8], at: usize) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    bytes[at] ^= ORDER_20;
    bytes
}

/// Runs a program on the data, with no more than 2 GB of memory.
fn run_with_little_memory(data: &Path) -> Output {
    Command::new("sh")
        .args(["-c", r#"ulimit -v 2000000; exec "$0" run O1002 --data "$1" --lang en"#, env!("CARGO_BIN_EXE_kt830")])
        .arg(data)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap()
}

/// What the control was started with is no damage: limits of its own, a parent that ignores its children.
#[test]
fn b6_a_whole_database_is_whole_whatever_the_control_is_started_with() {
    let data = tempfile::tempdir().unwrap();
    let folder = data.path().to_string_lossy().into_owned();
    let first = kt830_in(Path::new(env!("CARGO_MANIFEST_DIR")), data.path(), &["run", "O1002", "--data", &folder]);
    assert!(first.status.success(), "{first:?}");
    for environment in ["trap '' CHLD", "ulimit -t 10", "ulimit -v 400000", "ulimit -c 0"] {
        let run = format!(r#"{environment}; exec "$0" run O1002 --data "$1" --lang en"#);
        let out = Command::new("sh")
            .args(["-c", &run, env!("CARGO_BIN_EXE_kt830"), &folder])
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .output()
            .unwrap();
        assert!(out.status.success(), "{environment}: {out:?}");
        assert!(!data.path().join("retained.damaged-1.redb").exists(), "{environment}");
    }
}

#[test]
fn b6_a_database_that_would_take_all_memory_is_damage_and_no_end_of_the_control() {
    let data = tempfile::tempdir().unwrap();
    let folder = data.path().to_string_lossy().into_owned();
    let first = kt830_in(Path::new(env!("CARGO_MANIFEST_DIR")), data.path(), &["run", "O1002", "--data", &folder]);
    assert!(first.status.success(), "{first:?}");
    let file = data.path().join("retained.redb");
    let whole = std::fs::read(&file).unwrap();
    assert!(comes_to_its_end(&whole) && comes_to_its_end(b"this is no database") && comes_to_its_end(b""));
    // Page numbers stand at multiples of 8; most of these bytes are none, and come to their end as intact or damaged.
    // Where this version of redb has one comes first: each look takes a process of its own.
    let places = (36_863..PAGES.end).step_by(8).chain((PAGES.start + 7..36_863).step_by(8));
    let hungry = places.into_iter().find(|&at| !comes_to_its_end(&flipped(&whole, at)));
    let hungry = hungry.expect("a page number whose order takes 4 GiB");
    let damaged = flipped(&whole, hungry);
    std::fs::write(&file, &damaged).unwrap();
    let out = run_with_little_memory(data.path());
    let told = String::from_utf8_lossy(&out.stderr).into_owned();
    assert!(out.status.code().is_some_and(|code| code < 2), "byte {hungry}: {out:?}");
    assert!(told.contains("file damaged (copy retained.damaged-1.redb)"), "byte {hungry}: {told}");
    assert_eq!(std::fs::read(data.path().join("retained.damaged-1.redb")).unwrap(), damaged, "byte {hungry}: kept");
}
