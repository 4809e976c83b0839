//! A control wired to the simulated machine and stepped tick by tick by whoever holds it: headless runs, stories,
//! demo, tests. Time is what has been stepped; nothing here waits.
//! Source: spec tools.md T3, T5; simulator.md.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use super::disk::Folders;
use super::keeper::{Keeper, remember};
use super::office::Office;
use super::simulator::Simulator;
use super::vault::Vault;
use crate::controller::files::Job;
use crate::controller::{Controller, Effect, Retained};
use crate::defs::alarm;
use crate::defs::kind::Kind;
use crate::defs::param;
use crate::defs::text::Said;
use crate::io::sim::{Looks, MachineFile, PartFile, SimFileError, SimulatedMachine, SurfaceFile};
use crate::io::{Backend, InputImage, OutputImage};
use crate::link::command::{Command, Screens};
use crate::link::drawing::StockBox;
use crate::link::page_command::{PageAnswer, PageCommand};
use crate::link::snapshot::{DirectoryRow, Snapshot};
use crate::store::FolderError;
use crate::units::{Micros, PerAxis};

/// Why a rig could not be set up.
#[derive(Debug, thiserror::Error)]
pub enum RigError {
    /// A machine or part file.
    #[error(transparent)]
    File(#[from] SimFileError),
    /// A folder.
    #[error(transparent)]
    Folder(#[from] FolderError),
}

/// What a rig begins with.
pub struct Setup {
    /// Kind of machine.
    pub kind: Kind,
    /// What the control remembers.
    pub retained: Retained,
    /// Where to keep what it is to remember; none keeps it in memory.
    pub keeper: Option<Keeper>,
    /// Folders of programs and page files.
    pub folders: Folders,
    /// Seed of the simulated machine's chance.
    pub seed: u64,
}

/// What setting a part up means for the control: its work zero, its tool geometry, and values for the variables that
/// have none.
pub fn set_up(part: &PartFile, present: impl Fn(u16) -> Option<f64>) -> Vec<Command> {
    let place = part.g54_mm;
    let mut commands = vec![Command::SetFrame(0, PerAxis([place.x, place.y, place.z]))];
    for offset in &part.offsets {
        let geometry = PerAxis([offset.x / 2.0, 0.0, offset.z]);
        commands.push(Command::SetGeometry(usize::from(offset.number), geometry));
    }
    commands.push(Command::SetStock(outline(part).into()));
    let missing = part.variables.iter().filter(|(number, _)| present(**number).is_none());
    commands.extend(missing.map(|(number, value)| Command::SetVariable(*number, Some(*value))));
    commands
}

/// The boxes of a part and of what holds it, for the drawing.
fn outline(part: &PartFile) -> Vec<StockBox> {
    let turned = |radius: f64, z: (f64, f64)| (PerAxis([-radius, 0.0, z.0]), PerAxis([radius, 0.0, z.1]));
    let behind = |looks: Looks, at: f64, thick: f64| match looks {
        Looks::PlusZ => (at - thick, at),
        Looks::MinusZ => (at, at + thick),
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
    let holders = holders.map(|(low, high)| StockBox { low, high, part: false });
    let surfaces = part.surfaces.iter().map(surface).map(|(low, high)| StockBox { low, high, part: true });
    holders.chain(surfaces).collect()
}

/// Somebody beside the rig: paces it, shows it, brings commands of a person.
pub trait Companion: Send {
    /// Called after each tick; true when the person has touched something.
    fn accompany(&mut self, now: Micros, control: &Controller, inbox: &mut Vec<Command>) -> bool;
}

/// Control and machine.
pub struct Rig {
    kind: Kind,
    controller: Controller,
    machine: SimulatedMachine,
    image: InputImage,
    retained: Retained,
    keeper: Option<Keeper>,
    /// Passwords, where nothing keeps them.
    vault: Vault,
    office: Office,
    simulator: Simulator,
    folders: Folders,
    /// Programs that are in no folder.
    added: Vec<crate::controller::Program>,
    effects: Vec<Effect>,
    inbox: Vec<Command>,
    now: Micros,
    tick: Micros,
    powered: bool,
    programs: Arc<crate::controller::Programs>,
    directory: Arc<Vec<DirectoryRow>>,
    screens: Arc<Screens>,
    snapshot: Snapshot,
    companion: Option<Box<dyn Companion>>,
    touched: bool,
    /// The retained data were damaged: told again at every power-on of this rig.
    damage: Option<String>,
}

impl Rig {
    /// A machine at power-on.
    ///
    /// # Errors
    /// The kind is not driven, or a file cannot be read.
    pub fn new(setup: Setup) -> Result<Self, RigError> {
        let Setup { kind, retained, keeper, folders, seed } = setup;
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
            keeper,
            vault: Vault::default(),
            office: Office::new(folders.clone()),
            simulator: Simulator::default(),
            folders,
            added: Vec::new(),
            effects: Vec::new(),
            inbox: Vec::new(),
            now,
            tick,
            powered: true,
            programs: Arc::new(programs),
            directory: Arc::new(directory),
            screens: Arc::new(screens),
            snapshot: Snapshot::new(kind),
            companion: None,
            touched: false,
            damage: None,
        };
        rig.deliver();
        Ok(rig)
    }

    /// A control gets what the disk has found.
    fn deliver(&mut self) {
        self.controller.deliver_programs(Arc::clone(&self.programs), Arc::clone(&self.directory));
        self.inbox.push(Command::Screens(Arc::clone(&self.screens)));
        if let Some(what) = &self.damage {
            self.controller.report(alarm::DATA_DAMAGED, Some(Said::new(what, what)));
        }
    }

    /// Adds a program that is not in the folder (a file named on the command line).
    pub fn add_program(&mut self, program: crate::controller::Program) {
        self.add_programs(vec![program]);
    }

    /// Adds programs that are not in the folder.
    pub fn add_programs(&mut self, programs: Vec<crate::controller::Program>) {
        self.added.extend(programs.iter().cloned());
        Arc::make_mut(&mut self.programs).put(programs);
        self.controller.deliver_programs(Arc::clone(&self.programs), Arc::clone(&self.directory));
    }

    /// Puts a part into the machine, and its work zero and tool geometry into the control; variables that have no
    /// value get the part's.
    pub fn mount(&mut self, part: &PartFile) {
        self.machine.set_part(Some(part));
        self.simulator.part = Some(part.clone());
        let variables = &self.retained.variables;
        let present = |variable: u16| variables.get(u32::from(variable)).ok().flatten();
        self.inbox.extend(set_up(part, present));
    }

    /// Puts another machine of the same kind behind the control, its power just come: another screw, another wheel.
    pub fn swap_machine(&mut self, machine: MachineFile, seed: u64) {
        self.machine = SimulatedMachine::new(machine, None, &self.retained.params, seed);
        self.image = self.machine.read(self.now);
        self.controller = Controller::new(self.kind, self.retained.clone(), self.image, self.now);
        self.deliver();
    }

    /// Begins the machine's chance anew.
    pub fn reseed(&mut self, seed: u64) {
        self.machine.reseed(seed);
    }

    /// Homed, hydraulics on, part clamped: where a headless run begins (T3).
    pub fn make_ready(&mut self) {
        self.machine.start_ready();
        self.image = self.machine.read(self.now);
        self.controller = Controller::new(self.kind, self.retained.clone(), self.image, self.now);
        self.controller.make_ready(self.machine.encoder_zero_mm());
        self.deliver();
    }

    /// Hands a command to the control; it is taken in the next tick.
    pub fn send(&mut self, command: Command) {
        match command {
            Command::Simulate(asked) => self.simulator.act(&mut self.machine, asked),
            other => self.inbox.push(other),
        }
    }

    /// One tick of control and machine.
    pub fn step(&mut self) {
        self.step_timed(|_| {});
    }

    /// One tick; tells how many nanoseconds the control's part of it took, for measuring.
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
        self.keep();
        if let Some(companion) = &mut self.companion {
            self.touched |= companion.accompany(self.now, &self.controller, &mut self.inbox);
        }
    }

    /// From now on somebody stands beside the rig.
    pub fn accompany(&mut self, companion: Box<dyn Companion>) {
        self.companion = Some(companion);
    }

    /// Whether a person has touched something since [`Rig::take_touch`].
    #[must_use]
    pub const fn is_touched(&self) -> bool {
        self.touched
    }

    /// Whether a person has touched something; the next touch is told anew.
    pub const fn take_touch(&mut self) -> bool {
        std::mem::replace(&mut self.touched, false)
    }

    /// Keeps what the control wishes; without a disk thread the acknowledgement comes at once.
    fn keep(&mut self) {
        self.controller.drain_effects(&mut self.effects);
        if self.effects.is_empty() {
            return;
        }
        for effect in &self.effects {
            remember(&mut self.retained, effect);
            if let Effect::Ask(wish) = effect {
                let vault = &mut self.vault;
                let answer =
                    self.keeper.as_mut().map_or_else(|| vault.answer(wish, None), |keeper| keeper.answer(wish));
                self.inbox.push(answer);
            }
        }
        if self.effects.iter().any(Effect::refits_machine) {
            self.machine.rewire(&self.retained.params);
        }
        if let Some(keeper) = &mut self.keeper {
            self.inbox.push(match keeper.commit(&self.effects) {
                Ok(generation) => Command::Stored(generation),
                Err(error) => Command::DiskFailed(Said::new(error.to_string(), error.to_string())),
            });
        }
        let effects = std::mem::take(&mut self.effects);
        for effect in &effects {
            if let Effect::Job(job) = effect {
                self.work(job);
            }
        }
    }

    /// Does at once what the window's control has a thread for.
    fn work(&mut self, job: &Job) {
        let inbox = &mut self.inbox;
        let changed = self.office.work(job, &mut |answer| {
            inbox.push(Command::Page(PageCommand::Answered(PageAnswer::File(job.ticket, answer))))
        });
        if changed.programs
            && let Ok((programs, directory)) = self.folders.read_programs()
        {
            (self.programs, self.directory) = (Arc::new(programs), Arc::new(directory));
            for program in std::mem::take(&mut self.added) {
                self.add_program(program);
            }
            self.controller.deliver_programs(Arc::clone(&self.programs), Arc::clone(&self.directory));
        }
        if changed.screens
            && let Ok(screens) = self.folders.read_screens()
        {
            self.screens = Arc::new(screens);
            self.inbox.push(Command::Screens(Arc::clone(&self.screens)));
        }
    }

    /// Gives the rig a folder for pictures of the screen and one that stands for a medium.
    pub fn plug_in(&mut self, prints: Option<PathBuf>, stick: Option<PathBuf>) {
        self.office = Office::new(self.folders.clone()).with(prints, stick);
    }

    /// Gives the rig an RS232 port.
    pub fn plug_line(&mut self, port: String) {
        self.office = self.office.clone().on_line(Some(port), None);
    }

    /// The power goes at this tick.
    pub fn power_cut(&mut self) {
        self.powered = false;
        self.machine.write(self.now, &OutputImage { set_point_mm: self.image.encoder_mm, ..OutputImage::default() });
    }

    /// Whether the control has power.
    #[must_use]
    pub const fn is_powered(&self) -> bool {
        self.powered
    }

    /// The power comes (again): a cold start with the data so far.
    pub fn power_on(&mut self) {
        self.powered = true;
        self.machine.power_on(&self.retained.params);
        self.image = self.machine.read(self.now);
        self.controller = Controller::new(self.kind, self.retained.clone(), self.image, self.now);
        self.deliver();
    }

    /// Tells the operator that the retained data were damaged.
    pub fn report_damage(&mut self, what: &str) {
        self.damage = Some(what.to_owned());
        self.controller.report(alarm::DATA_DAMAGED, Some(Said::new(what, what)));
    }

    /// What a page would show now.
    pub fn snapshot(&mut self) -> &Snapshot {
        self.controller.snapshot(&mut self.snapshot);
        self.snapshot.simulated = Some(Arc::new(self.simulator.view(&self.machine)));
        if !self.powered {
            self.snapshot.darken();
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

    /// The machine, to force inputs and faults.
    pub const fn machine_mut(&mut self) -> &mut SimulatedMachine {
        &mut self.machine
    }

    /// What the control puts on its second analog output, volts.
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

    /// Whether a program is in the folder.
    #[must_use]
    pub fn has_program(&self, number: u32) -> bool {
        self.programs.get(number).is_some()
    }

    /// The text of a program.
    #[must_use]
    pub fn program_source(&self, number: u32) -> Option<Arc<crate::nc::Source>> {
        self.programs.get(number).map(|program| Arc::clone(&program.source))
    }

    /// The program whose file has this name, with or without its extension.
    #[must_use]
    pub fn program_named(&self, word: &str) -> Option<u32> {
        let stem = |name: &str| name.rsplit_once('.').map_or(name, |(stem, _)| stem).to_ascii_uppercase();
        let wanted = stem(word);
        let named = |program: &&crate::controller::Program| stem(program.source.name()) == wanted;
        self.programs.iter().find(named).map(|program| program.number)
    }

    /// The bar of a lathe's program.
    #[must_use]
    pub fn bar(&self, number: u32) -> Option<PartFile> {
        super::bar::of_program(self.kind, &self.retained.params, &self.program_source(number)?)
    }

    /// What the control remembers.
    #[must_use]
    pub const fn retained(&self) -> &Retained {
        &self.retained
    }
}
