//! What programs write is stored together: few commits, in order, at once where the program stops (rows B3, B6).

use kt830::controller::PowerOnState;
use kt830::defs::key::Key;
use kt830::defs::kind::Kind;
use kt830::host::folders::program_from_bytes;
use kt830::host::headless::{HeadlessHost, HostSetup};
use kt830::host::retained_store::RetainedStore;
use kt830::link::Command;
use kt830::link::snapshot::RunState;

use kt830::units::{Axis, PerAxis};

use crate::stories::{folders, ready_with, tell};

/// A ready control that stores in a folder, with a program as the current one.
fn stored_in(folder: &std::path::Path, text: &str) -> HeadlessHost {
    let (store, found) = RetainedStore::open(folder, Kind::Gc).unwrap();
    let setup = HostSetup { kind: Kind::Gc, retained: found.retained, store: Some(store), folders: folders(), seed: 1 };
    let mut host = HeadlessHost::new(setup).unwrap();
    host.make_ready();
    host.add_program(program_from_bytes(7_000, "O7000.NC", text.as_bytes().to_vec(), host.kind().dialect()));
    tell(&mut host, "load O7000");
    host
}

/// The commits so far, and the value of a variable on the disk.
fn on_disk(folder: &std::path::Path, number: u32) -> (u64, Option<f64>) {
    let (mut store, found) = RetainedStore::open(folder, Kind::Gc).unwrap();
    (store.commit(&[]).unwrap(), found.retained.variables.get(number).unwrap())
}

fn run_to_end(host: &mut HeadlessHost) -> u32 {
    host.send(Command::Press(Key::CycleStart));
    (0..5).for_each(|_| host.step());
    let mut ticks = 5;
    while host.controller().state() == RunState::Running {
        host.step();
        ticks += 1;
    }
    ticks
}

/// 20 000 assignments wrote 36 MB. At four commits a second and some at both ends a run of 1.3 s makes ten or so.
#[test]
fn b6_a_loop_that_counts_commits_a_few_times_a_second() {
    let folder = tempfile::tempdir().unwrap();
    let mut host = stored_in(folder.path(), "#500=0\nWHILE[#500LT20000]DO1\n#500=#500+1\nEND1\nM30\n");
    drop(host);
    let (before, _) = on_disk(folder.path(), 500);
    host = stored_in(folder.path(), "#500=0\nWHILE[#500LT20000]DO1\n#500=#500+1\nEND1\nM30\n");
    let seconds = f64::from(run_to_end(&mut host)) / 1000.0;
    drop(host);
    let (after, value) = on_disk(folder.path(), 500);
    assert_eq!(value, Some(20_000.0));
    let most = 4.0 * seconds + 8.0;
    assert!(((after - before) as f64) < most, "{} commits in {seconds} s", after - before);
}

/// M00, feed hold, RESET and M30: what was written before them is on the disk when the machine stands.
#[test]
fn b3_what_a_program_has_written_is_kept_from_every_stop_on() {
    for (text, stop) in [
        ("#500=7\nM00\nM30\n", ""),
        ("#500=7\nG01 X-90 F60\nM30\n", "key feed-hold\nwait until held"),
        ("#500=7\nG04 P60000\nM30\n", "key reset"),
        ("#500=7\nM30\n", ""),
        ("#500=7\n#3000=1(STOP)\n", ""),
    ] {
        let mut host = ready_with(text);
        host.send(Command::Press(Key::CycleStart));
        (0..20).for_each(|_| host.step());
        if !stop.is_empty() {
            tell(&mut host, stop);
        }
        (0..3).for_each(|_| host.step());
        host.power_cut();
        host.power_on();
        host.step();
        assert_eq!(host.controller().variable(500), Some(7.0), "{text}");
    }
}

/// Cut at any tick of a run: at most a quarter of a second is lost, and no value is kept without those written before it.
#[test]
fn b3_a_power_cut_in_a_run_keeps_the_order_of_what_was_written() {
    let text = "#501=0\n#502=0\nWHILE[1EQ1]DO1\n#501=#501+1\n#502=#501\n#503=#3001\nEND1\n";
    for cut in [50, 251, 252, 260, 499, 500, 501, 777, 1_003, 1_600] {
        let mut host = ready_with(text);
        host.send(Command::Press(Key::CycleStart));
        (0..cut).for_each(|_| host.step());
        let of = |host: &HeadlessHost, number| host.controller().variable(number).unwrap_or(0.0);
        let (count, milliseconds) = (of(&host, 501), of(&host, 503));
        host.power_cut();
        host.power_on();
        host.step();
        let kept = [501, 502, 503].map(|number| of(&host, number));
        assert!(kept[0] <= count && [0, 1].contains(&((kept[0] - kept[1]) as i64)), "{cut}: {kept:?} of {count}");
        // A tick to note the first value, one until it is due, one for the commit.
        assert!(kept[2] >= milliseconds - 253.0, "{cut}: {kept:?} at {milliseconds} ms");
    }
}

/// What the operator enters during a run does not wait, and takes what the program has written along.
#[test]
fn b3_a_value_of_the_operator_is_stored_at_once() {
    let mut host = ready_with("#500=7\nG04 P60000\nM30\n");
    tell(&mut host, "param P6.3 1");
    host.send(Command::Press(Key::CycleStart));
    (0..20).for_each(|_| host.step());
    host.send(Command::SetVariable(600, Some(3.5)));
    host.step();
    host.power_cut();
    host.power_on();
    host.step();
    assert_eq!([500, 600].map(|number| host.controller().variable(number)), [Some(7.0), Some(3.5)]);
}

/// The wear that a program changes with each pass is gathered as well.
#[test]
fn b3_wear_that_a_program_writes_is_kept_at_its_end() {
    let mut host = ready_with("#1=0\nWHILE[#1LT100]DO1\n#1=#1+1\nG10 D4 U0.001\nEND1\nM30\n");
    run_to_end(&mut host);
    host.power_cut();
    host.power_on();
    host.step();
    // A hundred steps of 0.001, shown as a diameter.
    let wear = host.snapshot().offsets.tools[3].wear[Axis::X];
    assert!((wear - 0.1).abs() < 1e-9, "{wear}");
    assert_eq!(PowerOnState::factory(Kind::Gc).work_offsets.wear[3], PerAxis::default());
}

/// What the operator enters and what a program writes in the same tick is stored in the order in which it came.
#[test]
fn b6_the_disk_keeps_the_value_that_was_written_last() {
    for millis in 285..315 {
        let mut rig = crate::stories::ready_with("G04 P300\n#500=5\nG04 P3000\nM30");
        let wait = f64::from(millis) / 1e3;
        crate::stories::tell(&mut rig, &format!("mode auto\nkey cycle-start\nwait {wait} s\nset #500 = 7\nwait 1 s"));
        let shown = rig.snapshot().variables[500];
        crate::stories::tell(&mut rig, "power cut\npower on");
        assert_eq!(rig.snapshot().variables[500], shown, "{wait} s");
    }
}
