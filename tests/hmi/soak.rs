//! Production for hours: the control on its thread, as fast as it computes; a screen that shows its snapshots, is paged
//! through and typed into; programs edited, backups made. Nothing may grow, drift or be miscounted.
//! `KT830_SOAK_HOURS=24 cargo test --release --test hmi soak -- --nocapture` is the whole day; the default is some minutes.
//! Source: safety stance; spec B6, K7.3, H6.

#![allow(clippy::print_stdout, reason = "the figures are for people: `--nocapture`")]

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};

use kt830::defs::kind::Kind;
use kt830::defs::page::Page;
use kt830::host::Host;
use kt830::host::folders::Folders;
use kt830::host::job_runner::JobRunner;
use kt830::host::part::PartRule;
use kt830::host::retained_store::RetainedStore;
use kt830::host::simulated::HostedSimulation;
use kt830::host::storage::{RetainedWorker, StorageWorker, ThreadedStorage};
use kt830::host::thread::{HostThread, start};
use kt830::io::sim::{MachineFile, SimulatedMachine};
use kt830::link::Command;
use kt830::link::simulation::SimCommand;
use kt830::story::statement::DiskCondition;
use kt830::story::{Player, Stage, parse};
use kt830::units::Micros;

use crate::screen::open;

/// Simulated hours without the variable.
const DEFAULT_HOURS: f64 = 0.2;
/// A program is edited, and a backup made, after so many parts.
const PARTS_PER_EDIT: u32 = 10;
const PARTS_PER_BACKUP: u32 = 200;
/// Resident memory may grow by so much in the second half: what the allocator keeps.
const GROWTH_KB: u64 = 20_000;

type Thread = HostThread<HostedSimulation, ThreadedStorage>;

/// What the operator at the machine has done.
#[derive(Default)]
struct Production {
    parts: AtomicU32,
    backups: AtomicU32,
    usb: PathBuf,
    /// Simulated time from each cycle start to its end, µs: without the time that the disk took, which has its own.
    in_cycle: AtomicU64,
    /// The longest of them: a part with dressing, µs.
    longest: AtomicU64,
    ticks: AtomicU64,
}

/// The control thread as a stage that a touch of the screen does not interrupt.
struct Shift<'a>(&'a mut Thread);

impl Stage for Shift<'_> {
    type Machine = HostedSimulation;
    type Storage = ThreadedStorage;

    fn host(&mut self) -> &mut Host<HostedSimulation, ThreadedStorage> {
        self.0.host()
    }

    fn step(&mut self) {
        self.0.turn();
    }

    fn power_cut(&mut self) {}

    fn power_on(&mut self) {}

    fn set_disk(&mut self, _condition: DiskCondition) -> Result<(), String> {
        Err("a real disk".to_owned())
    }

    fn is_interrupted(&self) -> bool {
        self.0.is_stopped()
    }
}

/// Tells the control thread what to do; every line must succeed.
fn tell(thread: &mut Thread, text: &str) {
    let (_, lines) = parse(text, Kind::Gc).unwrap();
    let mut shift = Shift(thread);
    let mut player = Player::new(&mut shift, None, Path::new("."), false);
    for line in &lines {
        player.play(line).unwrap_or_else(|why| panic!("{}: {why}", line.text));
    }
}

/// Goes on until the disk, which has its own time, has done something; looked at once a simulated second.
fn until(thread: &mut Thread, what: &str, done: impl Fn(&mut Thread) -> bool) {
    for _ in 0..100_000 {
        if done(thread) {
            return;
        }
        (0..1_000).for_each(|_| thread.turn());
    }
    panic!("{what}");
}

fn produce(thread: &mut Thread, span: Micros, (programs, made): (&Path, &Production)) {
    // Not as a line of a story: a page that the screen asks for in the same tick may be refused, which that line would see.
    thread.host().send(Command::LoadProgram(1_002));
    tell(thread, "key hydraulic\nwait 4 s\nkey tailstock-advance\nwait 4 s");
    tell(thread, "home all\nmode auto");
    until(thread, "the part brings its values", |thread| thread.host().controller().variable(520).is_some());
    let text = || fs::read_to_string(programs.join("O2001.NC")).unwrap_or_default();
    while made.in_cycle.load(Ordering::Relaxed) < span.0 {
        thread.host().send(Command::Simulate(SimCommand::NewPart));
        let start = thread.host().now();
        tell(thread, "key cycle-start\nwait until idle max 600 s");
        let cycle = thread.host().now().since(start).0;
        made.longest.fetch_max(cycle, Ordering::Relaxed);
        made.in_cycle.fetch_add(cycle, Ordering::Relaxed);
        let parts = made.parts.fetch_add(1, Ordering::Relaxed) + 1;
        if parts.is_multiple_of(PARTS_PER_EDIT) {
            let comment = format!("(PART {parts})");
            // A drawing that a page has asked for is one job, too: the operator tries again.
            until(thread, "the program is stored", |thread| {
                tell(thread, &format!("unlock program 187350\nmode edit\nwrite O2001 \"{comment}\\nM30\"\nwait 5 s"));
                text().contains(&comment)
            });
            tell(thread, "mode auto");
        }
        if parts.is_multiple_of(PARTS_PER_BACKUP) {
            let backups = made.backups.fetch_add(1, Ordering::Relaxed) + 1;
            until(thread, "the backup is there", |thread| {
                tell(thread, "export backup\nwait 5 s");
                fs::read_dir(&made.usb).unwrap().count() as u32 >= backups
            });
        }
    }
    until(thread, "everything is stored", |thread| !thread.host().snapshot().is_storing);
    made.ticks.store(thread.host().now().0 / 1_000, Ordering::Relaxed);
}

/// Resident memory of this process, kB.
fn resident_kb() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmRSS"));
    line.and_then(|line| line.split_whitespace().nth(1)).and_then(|kb| kb.parse().ok()).unwrap_or(0)
}

#[test]
fn b6_hours_of_production_leave_memory_time_and_counts_as_they_must_be() {
    let hours = std::env::var("KT830_SOAK_HOURS").ok().and_then(|hours| hours.parse().ok()).unwrap_or(DEFAULT_HOURS);
    let span = Micros::from_secs_f64(hours * 3_600.0);
    let folder = tempfile::tempdir().unwrap();
    let [programs, screens, data, usb] = ["programs", "screens", "data", "usb"].map(|name| folder.path().join(name));
    [&programs, &screens, &data, &usb].into_iter().for_each(|path| fs::create_dir(path).unwrap());
    let shipped = crate::stories::folders();
    for (from, to) in [(&shipped.programs, &programs), (&shipped.screens, &screens)] {
        for file in fs::read_dir(from).unwrap().map(Result::unwrap).filter(|file| file.path().is_file()) {
            fs::copy(file.path(), to.join(file.file_name())).unwrap();
        }
    }
    let folders = Folders { programs: programs.clone(), screens, ..shipped };
    let (store, found) = RetainedStore::open(&data, Kind::Gc).unwrap();
    let jobs = JobRunner::new(folders).with_drives(None, Some(usb.clone()));
    let storage = ThreadedStorage::start(RetainedWorker::new(Some(store)), StorageWorker::new(jobs)).unwrap();
    let machine = SimulatedMachine::new(MachineFile::builtin(Kind::Gc).unwrap(), None, &found.retained.params, 1);
    let machine = HostedSimulation::new(machine, Micros::from_millis(100)).unpaced();
    let mut host = Host::connect(Kind::Gc, found.retained, machine, storage);
    host.set_part_rule(PartRule::FollowProgram);
    let made = Arc::new(Production { usb: usb.clone(), ..Production::default() });
    let own = Arc::clone(&made);
    let mut link = start(host, move |thread: &mut Thread| {
        produce(thread, span, (&programs, &own));
        kt830::host::thread::run_until_stopped(thread);
    })
    .unwrap();

    let mut screen = open(link.newest().clone());
    let (mut frames, mut typed, mut memory_kb) = (0_u32, 0_u32, Vec::new());
    while made.ticks.load(Ordering::Relaxed) == 0 {
        assert!(
            !link.health().failed.load(Ordering::Acquire),
            "the control thread has failed: {:?}",
            screen.state().snapshot.alarms
        );
        screen.state_mut().snapshot = link.newest().clone();
        screen.step();
        let shown = screen.state().snapshot.now;
        let page = Page::ALL[frames as usize / 3 % Page::ALL.len()];
        // No keep-alive: its time-out is simulated time, too.
        if frames % 3 == 0 {
            link.send(Command::OpenPage(page));
        }
        if frames % 10 == 0 {
            typed += 1;
            // A value that no program uses, from the variables page.
            link.send(Command::SetVariable(990, Some(f64::from(typed))));
        }
        for command in std::mem::take(&mut screen.state_mut().sent) {
            link.send(command);
        }
        frames += 1;
        // A sample after each tenth.
        if shown.0 > span.0 / 10 * (memory_kb.len() as u64 + 1) {
            memory_kb.push(resident_kb());
        }
    }
    let shown = link.newest().clone();
    let parts = made.parts.load(Ordering::Relaxed);
    println!(
        "{hours} h: {parts} parts, {frames} frames, {typed} values typed, {} backups; resident {memory_kb:?} kB",
        made.backups.load(Ordering::Relaxed)
    );

    // Time: the control's clock has counted every cycle, and the last one has ended soon after the span.
    let in_cycle = Micros(made.in_cycle.load(Ordering::Relaxed));
    assert!(shown.now >= in_cycle && in_cycle >= span, "{:?}, {in_cycle:?} of it in cycles", shown.now);
    let longest = Micros(made.longest.load(Ordering::Relaxed));
    // A part takes 36 s at most. A dressing crosses the wheel of 50 mm twice at 300 mm/min and twice at 60: 120 s.
    assert!(in_cycle.since(span) < longest && longest < Micros::from_millis(156_000), "{in_cycle:?} {longest:?}");
    // Counts: M30 of every part.
    assert_eq!(shown.parts_counted, parts);
    assert!(f64::from(parts) > hours * 3_600.0 / 60.0, "{parts} parts of under a minute in {hours} h");
    // Memory.
    let (half, last) = (memory_kb[memory_kb.len() / 2], *memory_kb.last().unwrap());
    assert!(half > 0 && last < half + GROWTH_KB, "{memory_kb:?} kB");
    drop(link);
    // What was typed, edited and backed up is on the disk.
    let (_, kept) = RetainedStore::open(&data, Kind::Gc).unwrap();
    assert!(kept.loss.is_none(), "{:?}", kept.loss);
    assert_eq!(kept.retained.part_count, parts);
    assert_eq!(kept.retained.variables.get(990).unwrap(), Some(f64::from(typed)));
    assert_eq!(fs::read_dir(&usb).unwrap().count() as u32, made.backups.load(Ordering::Relaxed));
}
