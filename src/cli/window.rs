//! Opens the control in a window, with the real-time thread (T1) or with a story (T2).

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, Sender, bounded};

use super::args::Shared;
use super::{CallError, FINE, bench};
use crate::controller::{Controller, Retained};
use crate::defs::param;
use crate::hmi::window::{Desk, Options, WindowError, run};
use crate::io::sim::{MachineFile, PartFile, SimulatedMachine};
use crate::io::{Backend, InputImage, OutputImage};
use crate::link::simulated::{SimCommand, SimView};
use crate::link::snapshot::RunState;
use crate::link::{Command, Snapshot};
use crate::nc::Source;
use crate::runtime::keeper::Keeper;
use crate::runtime::office::Office;
use crate::runtime::realtime::{Link, Pace};
use crate::runtime::rig::{Companion, set_up};
use crate::runtime::simulator::Simulator;
use crate::runtime::{bar, clock, disk_thread, realtime};
use crate::store::DataDir;
use crate::units::Micros;

/// Capacity of the command queue from the window to a story.
const COMMANDS: usize = 256;
/// Update interval of the simulator page.
const SIMULATED_EVERY: Micros = Micros::from_millis(100);
/// Ticks per snapshot in a demo.
const SNAPSHOT_EVERY: u64 = 16;

/// Opens the control (T1); returns when the window is closed.
///
/// # Errors
/// There is no display, or data and folders cannot be opened.
pub fn open(shared: &Shared, fullscreen: bool) -> Result<u8, CallError> {
    let data = DataDir::resolve(shared.data.as_deref()).map_err(CallError::new)?;
    let (keeper, found) = Keeper::open(data.root(), shared.kind).map_err(CallError::new)?;
    let retained = bench::begin(shared, found.retained)?;
    let program = retained.current_program;
    let mut machine = simulated(shared, &retained)?;
    let image = machine.read(Micros::ZERO);
    let mut controller = Controller::new(shared.kind, retained, image, Micros::ZERO);
    if let Some(damaged) = found.damaged {
        let said = crate::defs::text::Said::new(damaged.clone(), damaged);
        controller.report(crate::defs::alarm::DATA_DAMAGED, Some(said));
    }
    let folders = bench::folders(shared)?;
    let office = Office::new(folders.clone()).with(Some(data.prints()), shared.usb.clone());
    let office = office.on_line(shared.serial.clone(), Some(data.root().to_path_buf()));
    let (bring, parts) = bounded(4);
    let (ask, asked) = bounded(16);
    let shown = Arc::new(Mutex::new(Arc::new(SimView::default())));
    let mut simulator = Simulator::default();
    simulator.part = bench::part(shared, program)?;
    let looked = Micros::ZERO;
    let backend = Workshop { machine, parts, asked, simulator, shown: Arc::clone(&shown), looked };
    let (link, disk) = realtime::start(controller, backend, Pace::Simulated).map_err(CallError::new)?;
    let disk = disk_thread::start(disk, Some(keeper), folders, office).map_err(CallError::new)?;
    let newest = Arc::new(Snapshot::new(shared.kind));
    let desk = LinkDesk { newest, link, bring, bar_of: (0, [0.0; 2]), ask, simulated: shown };
    let closed = show(Box::new(desk), shared, fullscreen);
    drop(disk.join());
    closed
}

/// The simulated machine as a backend that also mounts parts and executes commands of the simulator page.
struct Workshop {
    machine: SimulatedMachine,
    parts: Receiver<PartFile>,
    asked: Receiver<SimCommand>,
    simulator: Simulator,
    /// The view for the simulator page.
    shown: Arc<Mutex<Arc<SimView>>>,
    looked: Micros,
}

impl Backend for Workshop {
    fn read(&mut self, now: Micros) -> InputImage {
        if let Ok(part) = self.parts.try_recv() {
            self.machine.set_part(Some(&part));
            self.simulator.part = Some(part);
        }
        while let Ok(asked) = self.asked.try_recv() {
            self.simulator.act(&mut self.machine, asked);
            self.looked = Micros::ZERO;
        }
        if now.since(self.looked) >= SIMULATED_EVERY {
            self.looked = now;
            // While the window reads the view, this update is skipped.
            if let Ok(mut shown) = self.shown.try_lock() {
                let view = self.simulator.view(&self.machine);
                if **shown != view {
                    *shown = Arc::new(view);
                }
            }
        }
        self.machine.read(now)
    }

    fn write(&mut self, now: Micros, outputs: &OutputImage) {
        self.machine.write(now, outputs);
    }
}

fn simulated(shared: &Shared, retained: &Retained) -> Result<SimulatedMachine, CallError> {
    let file = MachineFile::builtin(shared.kind).map_err(CallError::new)?;
    let part = bench::part(shared, retained.current_program)?;
    Ok(SimulatedMachine::new(file, part.as_ref(), &retained.params, shared.seed))
}

/// Runs the window for a connection.
///
/// # Errors
/// There is no display.
pub fn show(desk: Box<dyn Desk>, shared: &Shared, fullscreen: bool) -> Result<u8, CallError> {
    match run(desk, Options { fullscreen, lang: shared.lang, light: shared.light, brightness: shared.brightness }) {
        Ok(()) => Ok(FINE),
        Err(error @ WindowError::NoDisplay(_)) => Err(CallError::new(format!(
            "{error}. Without a display use `kt830 demo` (a story to its end), `kt830 run PROGRAM` or `kt830 shot PAGE --out FILE.png`"
        ))),
        Err(error @ WindowError::Graphics(_)) => Err(CallError::new(error)),
    }
}

/// Whether there is a display.
#[must_use]
pub fn has_display() -> bool {
    let named = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    cfg!(any(not(unix), target_os = "macos")) || named("DISPLAY")
}

/// The window's connection to the real-time control.
struct LinkDesk {
    link: Link,
    newest: Arc<Snapshot>,
    bring: Sender<PartFile>,
    /// The program whose bar is mounted in the lathe, and the bar's diameter and length (P384, P385), mm.
    bar_of: (u32, [f64; 2]),
    ask: Sender<SimCommand>,
    simulated: Arc<Mutex<Arc<SimView>>>,
}

impl LinkDesk {
    /// After the choice of a program: mounts its built-in part and sends the set-up to the control.
    fn mount(&self, number: u32) {
        if let Ok(Some(part)) = PartFile::builtin(number) {
            self.put_in(part);
        }
    }

    fn put_in(&self, part: PartFile) {
        for command in set_up(&part, |variable| self.newest.variables[usize::from(variable)]) {
            self.link.send(command);
        }
        drop(self.bring.try_send(part));
    }

    /// Mounts the bar of a lathe when program, bar diameter or bar length have changed.
    fn put_bar_in(&mut self) {
        let number = self.newest.program.number;
        let defined = [param::BAR_DIAMETER, param::BAR_LENGTH].map(|row| self.newest.params.get(row));
        let idle = self.newest.state == RunState::Idle;
        if (number, defined) == self.bar_of || !idle || bar::own_programs(self.newest.kind).is_none() {
            return;
        }
        self.bar_of = (number, defined);
        let row = self.newest.directory.iter().find(|row| row.number == number);
        let name = row.map_or("", |row| row.name.as_str());
        let source = Arc::new(Source::new(number, name, self.newest.program.text.bytes().collect::<Vec<u8>>()));
        if let Some(part) = bar::of_program(self.newest.kind, &self.newest.params, &source) {
            self.put_in(part);
        }
    }
}

impl Desk for LinkDesk {
    fn newest(&mut self) -> Arc<Snapshot> {
        let newest = Arc::make_mut(&mut self.newest);
        self.link.newest(newest);
        newest.simulated = Some(Arc::clone(&self.simulated.lock().unwrap_or_else(PoisonError::into_inner)));
        self.put_bar_in();
        Arc::clone(&self.newest)
    }

    fn send(&mut self, command: Command) {
        if let Command::Simulate(asked) = command {
            // A command is dropped when the queue is full.
            let _ = self.ask.try_send(asked);
            return;
        }
        let chosen = match command {
            Command::LoadProgram(number) if self.newest.state != RunState::Running => Some(number),
            _ => None,
        };
        self.link.send(command);
        if let Some(number) = chosen {
            self.mount(number);
        }
    }
}

/// The window's connection to a story.
pub struct StoryDesk {
    newest: Arc<Mutex<Arc<Snapshot>>>,
    commands: Sender<Command>,
}

/// The story's connection to the window: paces the ticks to real time, publishes snapshots, receives commands.
pub struct Beside {
    newest: Arc<Mutex<Arc<Snapshot>>>,
    commands: Receiver<Command>,
    begun: Option<(Instant, Micros)>,
    ticks: u64,
}

/// Creates both ends of a story's connection from a first snapshot.
#[must_use]
pub fn story_desk(first: Snapshot) -> (StoryDesk, Beside) {
    let newest = Arc::new(Mutex::new(Arc::new(first)));
    let (commands, heard) = bounded(COMMANDS);
    let desk = StoryDesk { newest: Arc::clone(&newest), commands };
    (desk, Beside { newest, commands: heard, begun: None, ticks: 0 })
}

impl Desk for StoryDesk {
    fn newest(&mut self) -> Arc<Snapshot> {
        Arc::clone(&self.newest.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn send(&mut self, command: Command) {
        drop(self.commands.try_send(command));
    }
}

impl Companion for Beside {
    fn accompany(&mut self, now: Micros, control: &Controller, inbox: &mut Vec<Command>) -> bool {
        if self.begun.is_none() {
            inbox.push(Command::Calendar(clock::local()));
        }
        let (begun, from) = *self.begun.get_or_insert((Instant::now(), now));
        let due = begun + Duration::from_micros(now.since(from).0);
        std::thread::sleep(due.saturating_duration_since(Instant::now()));
        self.ticks += 1;
        if self.ticks.is_multiple_of(SNAPSHOT_EVERY) {
            let mut snapshot = Snapshot::new(control.kind());
            control.snapshot(&mut snapshot);
            *self.newest.lock().unwrap_or_else(PoisonError::into_inner) = Arc::new(snapshot);
        }
        let mut touched = false;
        for command in self.commands.try_iter() {
            touched |= !matches!(command, Command::Alive);
            inbox.push(command);
        }
        touched
    }
}
