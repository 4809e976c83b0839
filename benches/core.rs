//! Measures the duration of a controller tick and the speed of a headless run relative to real time.
//! `cargo bench --bench core`

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a bench prints its figures")]

use std::path::Path;
use std::time::Instant;

use kt830::controller::{Controller, PowerOnState, StorageRequest};
use kt830::defs::key::{Key, Mode};
use kt830::defs::kind::{Dialect, Kind};
use kt830::host::folders::Folders;
use kt830::host::headless::{HeadlessHost, HostSetup};
use kt830::host::retained_store::RetainedStore;
use kt830::io::Backend;
use kt830::io::sim::{MachineFile, PartFile, SimulatedMachine};
use kt830::link::Command;
use kt830::link::snapshot::RunState;
use kt830::units::Micros;

fn rig(program: u32) -> HeadlessHost {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders = Folders {
        programs: root.join("programs"),
        screens: root.join("screens"),
        by_name: false,
        dialect: Dialect::LatheA,
    };
    let setup = HostSetup { kind: Kind::Gc, retained: PowerOnState::factory(Kind::Gc), store: None, folders, seed: 1 };
    let mut rig = HeadlessHost::new(setup).unwrap();
    let part = PartFile::builtin(program).unwrap().unwrap();
    rig.mount_part(&part);
    rig.send(Command::LoadProgram(program));
    rig.step();
    rig.make_ready();
    rig.mount_part(&part);
    rig.send(Command::LoadProgram(program));
    rig.send(Command::Press(Mode::Auto.key()));
    rig.step();
    rig.send(Command::Press(Key::CycleStart));
    rig.step();
    rig
}

/// Sorted durations of the controller ticks of a whole program, ns, without the time of the simulated machine.
fn program_tick_nanos(program: u32) -> Vec<u64> {
    let mut rig = rig(program);
    let mut taken = Vec::new();
    while rig.controller().state() != RunState::Idle {
        rig.step_around(|tick| {
            let begun = Instant::now();
            tick();
            taken.push(begun.elapsed().as_nanos() as u64);
        });
    }
    taken.sort_unstable();
    taken
}

/// Sorted durations of controller ticks while no program runs, ns.
fn idle_tick_nanos() -> Vec<u64> {
    let retained = PowerOnState::factory(Kind::Gc);
    let mut machine = SimulatedMachine::new(MachineFile::builtin(Kind::Gc).unwrap(), None, &retained.params, 1);
    let image = machine.read(Micros::ZERO);
    let mut controller = Controller::new(Kind::Gc, retained, image, Micros::ZERO);
    let mut taken: Vec<u64> = (1..=100_000_u64)
        .map(|tick| {
            let now = Micros(tick * 1_000);
            let image = machine.read(now);
            let begun = Instant::now();
            controller.tick(now, &image, &[]);
            begun.elapsed().as_nanos() as u64
        })
        .collect();
    taken.sort_unstable();
    taken
}

/// Sorted durations from the request of the control to the acknowledged commit, ns; `values` change at once.
fn commit_nanos(values: u32) -> Vec<u64> {
    let folder = tempfile::tempdir_in(env!("CARGO_MANIFEST_DIR")).unwrap();
    let (mut store, _) = RetainedStore::open(folder.path(), Kind::Gc).unwrap();
    let commit = |count: u32| {
        let change = |number| StorageRequest::Variable(number, Some(f64::from(count)));
        let requests: Vec<StorageRequest> = (500..500 + values).map(change).collect();
        let begun = Instant::now();
        store.commit(&requests).unwrap();
        begun.elapsed().as_nanos() as u64
    };
    let mut taken: Vec<u64> = (0..500).map(commit).collect();
    taken.sort_unstable();
    taken
}

fn print_percentiles(name: &str, sorted: &[u64]) {
    let at = |share: f64| sorted[((sorted.len() - 1) as f64 * share) as usize] as f64 / 1_000.0;
    println!(
        "{name}: p50 {:.2} µs  p99 {:.2} µs  p99.9 {:.2} µs  max {:.0} µs  ({} times)",
        at(0.5),
        at(0.99),
        at(0.999),
        at(1.0),
        sorted.len()
    );
}

fn main() {
    for values in [1, 100] {
        print_percentiles(&format!("{values} values stored"), &commit_nanos(values));
    }
    print_percentiles("tick idle", &idle_tick_nanos());
    for program in [1_001, 1_002] {
        print_percentiles(&format!("tick O{program}"), &program_tick_nanos(program));
    }
    for program in [1_001, 1_002] {
        let mut rig = rig(program);
        let (begun, from) = (Instant::now(), rig.now());
        while rig.controller().state() != RunState::Idle {
            rig.step();
        }
        let (simulated, real) = (rig.now().since(from).as_secs_f64(), begun.elapsed().as_secs_f64());
        println!("run O{program}: {simulated:.1} s simulated in {real:.4} s, {:.0} × real time", simulated / real);
    }
}
