//! Connects a control to the simulated machine and steps both tick by tick. Used by headless runs, stories, demo,
//! tests. Time is the number of ticks stepped; nothing here waits.
//! Source: spec tools.md T3, T5; simulator.md.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use super::folders::Folders;
use super::job_runner::JobRunner;
use super::password_store::PasswordStore;
use super::retained_store::{RetainedStore, apply_effect};
use super::simulation_control::SimulationControl;
use crate::controller::files::BackgroundJob;
use crate::controller::{Controller, PowerOnState, StorageRequest};
use crate::defs::alarm;
use crate::defs::kind::Kind;
use crate::defs::param;
use crate::defs::text::LocalizedText;
use crate::io::sim::{FaceDirection, MachineFile, PartFile, SimFileError, SimulatedMachine, SurfaceFile};
use crate::io::{Backend, InputImage, OutputImage};
use crate::link::command::{Command, Screens};
use crate::link::page_command::{PageCommand, StorageAnswer};
use crate::link::snapshot::{DirectoryRow, Snapshot};
use crate::link::toolpath::StockBox;
use crate::store::FolderError;
use crate::units::{Micros, PerAxis};

/// Why a rig could not be created.
#[derive(Debug, thiserror::Error)]
pub enum HostError {
    /// A machine or part file is invalid.
    #[error(transparent)]
    File(#[from] SimFileError),
    /// A folder cannot be read.
    #[error(transparent)]
    Folder(#[from] FolderError),
}

/// The initial state of a rig.
pub struct HostSetup {
    /// Kind of machine.
    pub kind: Kind,
    /// The retained data.
    pub retained: PowerOnState,
    /// The store for retained data; `None` keeps them in memory only.
    pub store: Option<RetainedStore>,
    /// Folders of programs and page files.
    pub folders: Folders,
    /// Random seed of the simulated machine.
    pub seed: u64,
}

/// The commands that set a part up in the control: work offset G54, tool geometry, stock, and values for the variables
/// that have none. `present` reads a variable.
pub fn part_setup_commands(part: &PartFile, present: impl Fn(u16) -> Option<f64>) -> Vec<Command> {
    let place = part.g54_mm;
    let mut commands = vec![Command::SetWorkOffset(0, PerAxis([place.x, place.y, place.z]))];
    for offset in &part.offsets {
        let geometry = PerAxis([offset.x / 2.0, 0.0, offset.z]);
        commands.push(Command::SetGeometry(usize::from(offset.number), geometry));
    }
    commands.push(Command::SetStock(stock_boxes(part).into()));
    let missing = part.variables.iter().filter(|(number, _)| present(**number).is_none());
    commands.extend(missing.map(|(number, value)| Command::SetVariable(*number, Some(*value))));
    commands
}

/// Bounding boxes of the part and its holders for the drawing, mm.
fn stock_boxes(part: &PartFile) -> Vec<StockBox> {
    let turned = |radius: f64, z: (f64, f64)| (PerAxis([-radius, 0.0, z.0]), PerAxis([radius, 0.0, z.1]));
    let behind = |looks: FaceDirection, at: f64, thick: f64| match looks {
        FaceDirection::PlusZ => (at - thick, at),
        FaceDirection::MinusZ => (at, at + thick),
    };
    let surface = |surface: &SurfaceFile| match *surface {
        SurfaceFile::Diameter { z_from, z_to, stock, .. } => turned(stock / 2.0, (z_from, z_to)),
        SurfaceFile::Cone { z_from, z_to, stock_from, stock_to, .. } => {
            turned(stock_from.max(stock_to) / 2.0, (z_from, z_to))
        }
        SurfaceFile::Bore { z_from, z_to, stock_from, stock_to, thickness, .. } => {
            turned(stock_from.max(stock_to) / 2.0 + thickness, (z_from, z_to))
        }
        SurfaceFile::Face { looks, x_from, x_to, stock, thickness, turns, .. } => {
            let z = behind(looks, stock, thickness);
            let low = if turns { -x_to / 2.0 } else { x_from / 2.0 };
            (PerAxis([low, 0.0, z.0]), PerAxis([x_to / 2.0, 0.0, z.1]))
        }
        SurfaceFile::Plane { x_from, x_to, z_from, z_to, stock, .. } => {
            (PerAxis([x_from, 0.0, z_from]), PerAxis([x_to, stock, z_to]))
        }
        SurfaceFile::Wall { looks, x_from, x_to, y_from, y_to, stock, thickness, .. } => {
            let z = behind(looks, stock, thickness);
            (PerAxis([x_from, y_from, z.0]), PerAxis([x_to, y_to, z.1]))
        }
        SurfaceFile::Disc { x_from, x_to, stock, .. } => (PerAxis([x_from, 0.0, 0.0]), PerAxis([x_to, 0.0, stock])),
    };
    let holders = part.bodies.iter().map(|body| turned(body.diameter / 2.0, (body.z_from, body.z_to)));
    let holders = holders.map(|(low, high)| StockBox { low, high, is_workpiece: false });
    let surfaces = part.surfaces.iter().map(surface).map(|(low, high)| StockBox { low, high, is_workpiece: true });
    holders.chain(surfaces).collect()
}

/// An observer of the rig: it paces the ticks, publishes snapshots and passes on an operator's commands.
pub trait HostObserver: Send {
    /// Called after each tick; returns true when the operator has sent a command other than `Alive`.
    fn after_tick(&mut self, now: Micros, control: &Controller, inbox: &mut Vec<Command>) -> bool;
}

/// A control and its simulated machine.
pub struct HeadlessHost {
    kind: Kind,
    controller: Controller,
    machine: SimulatedMachine,
    image: InputImage,
    retained: PowerOnState,
    store: Option<RetainedStore>,
    /// Passwords when there is no store.
    passwords: PasswordStore,
    jobs: JobRunner,
    simulation: SimulationControl,
    folders: Folders,
    /// Programs that are not in the folder.
    added_programs: Vec<crate::controller::StoredProgram>,
    effects: Vec<StorageRequest>,
    inbox: Vec<Command>,
    now: Micros,
    tick: Micros,
    powered: bool,
    programs: Arc<crate::controller::Programs>,
    directory: Arc<Vec<DirectoryRow>>,
    screens: Arc<Screens>,
    snapshot: Snapshot,
    observer: Option<Box<dyn HostObserver>>,
    touched: bool,
    /// Report of damaged retained data; the alarm is raised again at every power-on.
    damage: Option<String>,
}

impl HeadlessHost {
    /// Creates a machine and a control at power-on.
    ///
    /// # Errors
    /// The machine file of the kind is invalid, or a folder cannot be read.
    pub fn new(setup: HostSetup) -> Result<Self, HostError> {
        let HostSetup { kind, retained, store: keeper, folders, seed } = setup;
        let (programs, directory) = folders.read_programs()?;
        let screens = folders.read_screens()?;
        let mut machine = SimulatedMachine::new(MachineFile::builtin(kind)?, None, &retained.params, seed);
        let now = Micros::ZERO;
        let image = machine.read(now);
        let controller = Controller::new(kind, retained.clone(), image, now);
        let tick = Micros(retained.params.get(param::TICK_TIME) as u64);
        let mut rig = Self {
            kind,
            controller,
            machine,
            image,
            retained,
            store: keeper,
            passwords: PasswordStore::default(),
            jobs: JobRunner::new(folders.clone()),
            simulation: SimulationControl::default(),
            folders,
            added_programs: Vec::new(),
            effects: Vec::new(),
            inbox: Vec::new(),
            now,
            tick,
            powered: true,
            programs: Arc::new(programs),
            directory: Arc::new(directory),
            screens: Arc::new(screens),
            snapshot: Snapshot::new(kind),
            observer: None,
            touched: false,
            damage: None,
        };
        rig.deliver_files();
        Ok(rig)
    }

    /// Delivers programs, page files and a damage report to a new control.
    fn deliver_files(&mut self) {
        self.controller.set_programs(Arc::clone(&self.programs), Arc::clone(&self.directory));
        self.inbox.push(Command::ScreensLoaded(Arc::clone(&self.screens)));
        if let Some(what) = &self.damage {
            self.controller.report_alarm(alarm::RETAINED_DATA_DAMAGED, Some(LocalizedText::new(what, what)));
        }
    }

    /// Adds a program that is not in the folder (a file named on the command line).
    pub fn add_program(&mut self, program: crate::controller::StoredProgram) {
        self.add_programs(vec![program]);
    }

    /// Adds programs that are not in the folder.
    pub fn add_programs(&mut self, programs: Vec<crate::controller::StoredProgram>) {
        self.added_programs.extend(programs.iter().cloned());
        Arc::make_mut(&mut self.programs).replace(programs);
        self.controller.set_programs(Arc::clone(&self.programs), Arc::clone(&self.directory));
    }

    /// Mounts a part in the machine and sends its work offset and tool geometry to the control. Variables without a
    /// value get the part's value.
    pub fn mount_part(&mut self, part: &PartFile) {
        self.machine.set_part(Some(part));
        self.simulation.part = Some(part.clone());
        let variables = &self.retained.variables;
        let present = |variable: u16| variables.get(u32::from(variable)).ok().flatten();
        self.inbox.extend(part_setup_commands(part, present));
    }

    /// Replaces the machine by another one of the same kind (another leadscrew or wheel) and restarts the control.
    pub fn swap_machine(&mut self, machine: MachineFile, seed: u64) {
        self.machine = SimulatedMachine::new(machine, None, &self.retained.params, seed);
        self.image = self.machine.read(self.now);
        self.controller = Controller::new(self.kind, self.retained.clone(), self.image, self.now);
        self.deliver_files();
    }

    /// Restarts the machine's random generator with a seed.
    pub fn reseed(&mut self, seed: u64) {
        self.machine.reseed(seed);
    }

    /// Starts a headless run (T3): axes homed, hydraulics on, part clamped. Restarts the control.
    pub fn make_ready(&mut self) {
        self.machine.make_ready();
        self.image = self.machine.read(self.now);
        self.controller = Controller::new(self.kind, self.retained.clone(), self.image, self.now);
        self.controller.make_ready(self.machine.encoder_zero_mm());
        self.deliver_files();
    }

    /// Queues a command for the next tick; simulator commands act on the machine at once.
    pub fn send(&mut self, command: Command) {
        match command {
            Command::Simulate(asked) => self.simulation.execute(&mut self.machine, asked),
            other => self.inbox.push(other),
        }
    }

    /// Steps control and machine by one tick.
    pub fn step(&mut self) {
        self.step_timed(|_| {});
    }

    /// Steps by one tick and reports the duration of `Controller::tick` in nanoseconds, for benchmarks.
    pub fn step_timed(&mut self, told: impl FnOnce(u64)) {
        self.now = self.now + self.tick;
        self.image = self.machine.read(self.now);
        if !self.powered {
            self.inbox.clear();
            return;
        }
        let begun = Instant::now();
        let outputs = *self.controller.tick(self.now, &self.image, &self.inbox);
        told(begun.elapsed().as_nanos() as u64);
        self.inbox.clear();
        self.machine.write(self.now, &outputs);
        self.store_effects();
        if let Some(companion) = &mut self.observer {
            self.touched |= companion.after_tick(self.now, &self.controller, &mut self.inbox);
        }
    }

    /// Sets the observer.
    pub fn set_observer(&mut self, companion: Box<dyn HostObserver>) {
        self.observer = Some(companion);
    }

    /// Whether the operator has sent a command since [`HeadlessHost::take_touch`].
    #[must_use]
    pub const fn is_touched(&self) -> bool {
        self.touched
    }

    /// Whether the operator has sent a command; clears the flag.
    pub const fn take_touched(&mut self) -> bool {
        std::mem::replace(&mut self.touched, false)
    }

    /// Carries out the control's storage requests. There is no disk thread: the acknowledgement comes in the next tick.
    fn store_effects(&mut self) {
        self.controller.drain_storage_requests(&mut self.effects);
        if self.effects.is_empty() {
            return;
        }
        for effect in &self.effects {
            apply_effect(&mut self.retained, effect);
            if let StorageRequest::Page(wish) = effect {
                let vault = &mut self.passwords;
                let answer = self.store.as_mut().map_or_else(|| vault.answer(wish, None), |keeper| keeper.answer(wish));
                self.inbox.push(answer);
            }
        }
        if self.effects.iter().any(StorageRequest::changes_machine_setup) {
            self.machine.rewire(&self.retained.params);
        }
        if let Some(keeper) = &mut self.store {
            self.inbox.push(match keeper.commit(&self.effects) {
                Ok(generation) => Command::Stored(generation),
                Err(error) => Command::DiskFailed(LocalizedText::new(error.to_string(), error.to_string())),
            });
        }
        let effects = std::mem::take(&mut self.effects);
        for effect in &effects {
            if let StorageRequest::Job(job) = effect {
                self.run_job(job);
            }
        }
    }

    /// Runs a job at once. The window runs it on a thread of its own.
    fn run_job(&mut self, job: &BackgroundJob) {
        let inbox = &mut self.inbox;
        let changed = self.jobs.run(job, &mut |answer| {
            inbox.push(Command::Page(PageCommand::StorageAnswered(StorageAnswer::File(job.ticket, answer))))
        });
        if changed.programs
            && let Ok((programs, directory)) = self.folders.read_programs()
        {
            (self.programs, self.directory) = (Arc::new(programs), Arc::new(directory));
            for program in std::mem::take(&mut self.added_programs) {
                self.add_program(program);
            }
            self.controller.set_programs(Arc::clone(&self.programs), Arc::clone(&self.directory));
        }
        if changed.screens
            && let Ok(screens) = self.folders.read_screens()
        {
            self.screens = Arc::new(screens);
            self.inbox.push(Command::ScreensLoaded(Arc::clone(&self.screens)));
        }
    }

    /// Sets the folder for screenshots and the folder used as the USB drive. Resets the serial port.
    pub fn set_drives(&mut self, prints: Option<PathBuf>, stick: Option<PathBuf>) {
        self.jobs = JobRunner::new(self.folders.clone()).with_drives(prints, stick);
    }

    /// Sets the RS232 port.
    pub fn set_serial_port(&mut self, port: String) {
        self.jobs = self.jobs.clone().with_serial(Some(port), None);
    }

    /// Cuts the power at this tick: all outputs go off.
    pub fn power_cut(&mut self) {
        self.powered = false;
        self.machine.write(self.now, &OutputImage { set_point_mm: self.image.encoder_mm, ..OutputImage::default() });
    }

    /// Whether the control has power.
    #[must_use]
    pub const fn is_powered(&self) -> bool {
        self.powered
    }

    /// Restores the power: a cold start with the retained data so far.
    pub fn power_on(&mut self) {
        self.powered = true;
        self.machine.power_on(&self.retained.params);
        self.image = self.machine.read(self.now);
        self.controller = Controller::new(self.kind, self.retained.clone(), self.image, self.now);
        self.deliver_files();
    }

    /// Raises the alarm for damaged retained data, now and at every power-on.
    pub fn report_damage(&mut self, what: &str) {
        self.damage = Some(what.to_owned());
        self.controller.report_alarm(alarm::RETAINED_DATA_DAMAGED, Some(LocalizedText::new(what, what)));
    }

    /// The snapshot that a page would show now.
    pub fn snapshot(&mut self) -> &Snapshot {
        self.controller.snapshot(&mut self.snapshot);
        self.snapshot.simulated = Some(Arc::new(self.simulation.view(&self.machine)));
        if !self.powered {
            self.snapshot.clear_for_power_off();
        }
        &self.snapshot
    }

    /// The control.
    #[must_use]
    pub const fn controller(&self) -> &Controller {
        &self.controller
    }

    /// The machine.
    #[must_use]
    pub const fn machine(&self) -> &SimulatedMachine {
        &self.machine
    }

    /// The machine, for forcing inputs and faults.
    pub const fn machine_mut(&mut self) -> &mut SimulatedMachine {
        &mut self.machine
    }

    /// Voltage of the second analog output, 0 to 10 V.
    #[must_use]
    pub const fn analog_2_volts(&self) -> f64 {
        self.controller.outputs().analog_2_volts
    }

    /// Simulated time since the start.
    #[must_use]
    pub const fn now(&self) -> Micros {
        self.now
    }

    /// Length of a tick.
    #[must_use]
    pub const fn tick_time(&self) -> Micros {
        self.tick
    }

    /// The kind of machine.
    #[must_use]
    pub const fn kind(&self) -> Kind {
        self.kind
    }

    /// Whether a program is known.
    #[must_use]
    pub fn has_program(&self, number: u32) -> bool {
        self.programs.get(number).is_some()
    }

    /// The text of a program.
    #[must_use]
    pub fn program_source(&self, number: u32) -> Option<Arc<crate::nc::Source>> {
        self.programs.get(number).map(|program| Arc::clone(&program.source))
    }

    /// The number of the program whose file has this name, with or without its extension.
    #[must_use]
    pub fn find_program(&self, word: &str) -> Option<u32> {
        let stem = |name: &str| name.rsplit_once('.').map_or(name, |(stem, _)| stem).to_ascii_uppercase();
        let wanted = stem(word);
        let named = |program: &&crate::controller::StoredProgram| stem(program.source.name()) == wanted;
        self.programs.iter().find(named).map(|program| program.number)
    }

    /// The bar for a program of a lathe.
    #[must_use]
    pub fn bar_of_program(&self, number: u32) -> Option<PartFile> {
        super::bar::bar_of_program(self.kind, &self.retained.params, &self.program_source(number)?)
    }

    /// The retained data.
    #[must_use]
    pub const fn retained(&self) -> &PowerOnState {
        &self.retained
    }
}
