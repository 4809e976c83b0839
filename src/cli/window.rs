//! Opens the control in a window, with the real-time thread (T1) or with a story (T2).

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, Sender, bounded};

use super::args::SharedArgs;
use super::{CallError, SUCCESS, setup};
use crate::controller::{Controller, PowerOnState};
use crate::defs::param;
use crate::hmi::window::{CoreConnection, WindowError, WindowOptions, run};
use crate::host::headless::{HostObserver, part_setup_commands};
use crate::host::job_runner::JobRunner;
use crate::host::realtime::{HostLink, Pace};
use crate::host::retained_store::RetainedStore;
use crate::host::simulation_control::SimulationControl;
use crate::host::{bar, clock, realtime, storage_thread};
use crate::io::sim::{MachineFile, PartFile, SimulatedMachine};
use crate::io::{Backend, InputImage, OutputImage};
use crate::link::simulation::{SimCommand, SimView};
use crate::link::snapshot::RunState;
use crate::link::{Command, Snapshot};
use crate::nc::Source;
use crate::store::DataDir;
use crate::units::Micros;

/// Capacity of the command queue from the window to a story.
const COMMAND_QUEUE: usize = 256;
/// Update interval of the simulator page.
const SIM_VIEW_INTERVAL: Micros = Micros::from_millis(100);
/// Ticks per snapshot in a demo.
const SNAPSHOT_TICKS: u64 = 16;

/// Opens the control (T1); returns when the window is closed.
///
/// # Errors
/// There is no display, or data and folders cannot be opened.
pub fn open(shared: &SharedArgs, fullscreen: bool) -> Result<u8, CallError> {
    let data = DataDir::resolve(shared.data.as_deref()).map_err(CallError::new)?;
    let (keeper, found) = RetainedStore::open(data.root(), shared.kind).map_err(CallError::new)?;
    let retained = setup::apply_overrides(shared, found.retained)?;
    let program = retained.current_program;
    let mut machine = simulated_machine(shared, &retained)?;
    let image = machine.read(Micros::ZERO);
    let mut controller = Controller::new(shared.kind, retained, image, Micros::ZERO);
    if let Some(damaged) = found.damaged {
        let said = crate::defs::text::LocalizedText::new(damaged.clone(), damaged);
        controller.report_alarm(crate::defs::alarm::RETAINED_DATA_DAMAGED, Some(said));
    }
    let folders = setup::folders(shared)?;
    let office = JobRunner::new(folders.clone()).with_drives(Some(data.screenshots()), shared.usb.clone());
    let office = office.with_serial(shared.serial.clone(), Some(data.root().to_path_buf()));
    let (bring, parts) = bounded(4);
    let (ask, asked) = bounded(16);
    let shown = Arc::new(Mutex::new(Arc::new(SimView::default())));
    let mut simulator = SimulationControl::default();
    simulator.part = setup::part(shared, program)?;
    let looked = Micros::ZERO;
    let backend = SimulatedBackend {
        machine,
        parts,
        commands: asked,
        simulation: simulator,
        view: Arc::clone(&shown),
        viewed_at: looked,
    };
    let (link, disk) = realtime::start(controller, backend, Pace::Simulated).map_err(CallError::new)?;
    let disk = storage_thread::start(disk, Some(keeper), folders, office).map_err(CallError::new)?;
    let newest = Arc::new(Snapshot::new(shared.kind));
    let desk = ControlConnection {
        snapshot: newest,
        link,
        parts: bring,
        mounted_bar: (0, [0.0; 2]),
        sim_commands: ask,
        simulated: shown,
    };
    let closed = run_window(Box::new(desk), shared, fullscreen);
    drop(disk.join());
    closed
}

/// The simulated machine as a backend that also mounts parts and executes commands of the simulator page.
struct SimulatedBackend {
    machine: SimulatedMachine,
    parts: Receiver<PartFile>,
    commands: Receiver<SimCommand>,
    simulation: SimulationControl,
    /// The view for the simulator page.
    view: Arc<Mutex<Arc<SimView>>>,
    viewed_at: Micros,
}

impl Backend for SimulatedBackend {
    fn read(&mut self, now: Micros) -> InputImage {
        if let Ok(part) = self.parts.try_recv() {
            self.machine.set_part(Some(&part));
            self.simulation.part = Some(part);
        }
        while let Ok(asked) = self.commands.try_recv() {
            self.simulation.execute(&mut self.machine, asked);
            self.viewed_at = Micros::ZERO;
        }
        if now.since(self.viewed_at) >= SIM_VIEW_INTERVAL {
            self.viewed_at = now;
            // While the window reads the view, this update is skipped.
            if let Ok(mut shown) = self.view.try_lock() {
                let view = self.simulation.view(&self.machine);
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

fn simulated_machine(shared: &SharedArgs, retained: &PowerOnState) -> Result<SimulatedMachine, CallError> {
    let file = MachineFile::builtin(shared.kind).map_err(CallError::new)?;
    let part = setup::part(shared, retained.current_program)?;
    Ok(SimulatedMachine::new(file, part.as_ref(), &retained.params, shared.seed))
}

/// Runs the window for a connection.
///
/// # Errors
/// There is no display.
pub fn run_window(desk: Box<dyn CoreConnection>, shared: &SharedArgs, fullscreen: bool) -> Result<u8, CallError> {
    match run(desk, WindowOptions { fullscreen, lang: shared.lang, light: shared.light, brightness: shared.brightness })
    {
        Ok(()) => Ok(SUCCESS),
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
struct ControlConnection {
    link: HostLink,
    snapshot: Arc<Snapshot>,
    parts: Sender<PartFile>,
    /// The program whose bar is mounted in the lathe, and the bar's diameter and length (P384, P385), mm.
    mounted_bar: (u32, [f64; 2]),
    sim_commands: Sender<SimCommand>,
    simulated: Arc<Mutex<Arc<SimView>>>,
}

impl ControlConnection {
    /// After the choice of a program: mounts its built-in part and sends the set-up to the control.
    fn mount_builtin_part(&self, number: u32) {
        if let Ok(Some(part)) = PartFile::builtin(number) {
            self.mount_part(part);
        }
    }

    fn mount_part(&self, part: PartFile) {
        for command in part_setup_commands(&part, |variable| self.snapshot.variables[usize::from(variable)]) {
            self.link.send(command);
        }
        drop(self.parts.try_send(part));
    }

    /// Mounts the bar of a lathe when program, bar diameter or bar length have changed.
    fn mount_bar(&mut self) {
        let number = self.snapshot.program.number;
        let defined = [param::BAR_DIAMETER, param::BAR_LENGTH].map(|row| self.snapshot.params.get(row));
        let idle = self.snapshot.state == RunState::Idle;
        if (number, defined) == self.mounted_bar || !idle || bar::program_subfolder(self.snapshot.kind).is_none() {
            return;
        }
        self.mounted_bar = (number, defined);
        let row = self.snapshot.directory.iter().find(|row| row.number == number);
        let name = row.map_or("", |row| row.name.as_str());
        let text = self.snapshot.program.text.bytes().collect::<Vec<u8>>();
        let source = Arc::new(Source::new(number, name, text, self.snapshot.kind.dialect()));
        if let Some(part) = bar::bar_of_program(self.snapshot.kind, &self.snapshot.params, &source) {
            self.mount_part(part);
        }
    }
}

impl CoreConnection for ControlConnection {
    fn newest(&mut self) -> Arc<Snapshot> {
        let newest = Arc::make_mut(&mut self.snapshot);
        self.link.copy_snapshot(newest);
        newest.simulated = Some(Arc::clone(&self.simulated.lock().unwrap_or_else(PoisonError::into_inner)));
        self.mount_bar();
        Arc::clone(&self.snapshot)
    }

    fn send(&mut self, command: Command) {
        if let Command::Simulate(asked) = command {
            // A command is dropped when the queue is full.
            let _ = self.sim_commands.try_send(asked);
            return;
        }
        let chosen = match command {
            Command::LoadProgram(number) if self.snapshot.state != RunState::Running => Some(number),
            _ => None,
        };
        self.link.send(command);
        if let Some(number) = chosen {
            self.mount_builtin_part(number);
        }
    }
}

/// The window's connection to a story.
pub struct StoryConnection {
    snapshot: Arc<Mutex<Arc<Snapshot>>>,
    commands: Sender<Command>,
}

/// The story's connection to the window: paces the ticks to real time, publishes snapshots, receives commands.
pub struct StoryObserver {
    snapshot: Arc<Mutex<Arc<Snapshot>>>,
    commands: Receiver<Command>,
    started: Option<(Instant, Micros)>,
    ticks: u64,
}

/// Creates both ends of a story's connection from a first snapshot.
#[must_use]
pub fn story_connection(first: Snapshot) -> (StoryConnection, StoryObserver) {
    let newest = Arc::new(Mutex::new(Arc::new(first)));
    let (commands, heard) = bounded(COMMAND_QUEUE);
    let desk = StoryConnection { snapshot: Arc::clone(&newest), commands };
    (desk, StoryObserver { snapshot: newest, commands: heard, started: None, ticks: 0 })
}

impl CoreConnection for StoryConnection {
    fn newest(&mut self) -> Arc<Snapshot> {
        Arc::clone(&self.snapshot.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn send(&mut self, command: Command) {
        drop(self.commands.try_send(command));
    }
}

impl HostObserver for StoryObserver {
    fn after_tick(&mut self, now: Micros, control: &Controller, inbox: &mut Vec<Command>) -> bool {
        if self.started.is_none() {
            inbox.push(Command::WallClock(clock::local_time()));
        }
        let (begun, from) = *self.started.get_or_insert((Instant::now(), now));
        let due = begun + Duration::from_micros(now.since(from).0);
        std::thread::sleep(due.saturating_duration_since(Instant::now()));
        self.ticks += 1;
        if self.ticks.is_multiple_of(SNAPSHOT_TICKS) {
            let mut snapshot = Snapshot::new(control.kind());
            control.snapshot(&mut snapshot);
            *self.snapshot.lock().unwrap_or_else(PoisonError::into_inner) = Arc::new(snapshot);
        }
        let mut touched = false;
        for command in self.commands.try_iter() {
            touched |= !matches!(command, Command::KeepAlive);
            inbox.push(command);
        }
        touched
    }
}
