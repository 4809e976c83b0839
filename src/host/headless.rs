//! The headless host: a control and its simulated machine, stepped tick by tick by runs, stories and tests. Time is the
//! number of ticks stepped; nothing here waits. Files count as they are at the start and after jobs that change them.
//! Source: spec tools.md T3, T5; simulator.md.

use std::path::PathBuf;
use std::sync::Arc;

use super::Host;
use super::cycle_time;
use super::folders::Folders;
use super::job_runner::JobRunner;
use super::retained_store::RetainedStore;
use super::simulated::HostedSimulation;
use super::storage::{DirectStorage, RetainedWorker, Storage};
use crate::controller::{PowerOnState, StoredProgram};
use crate::defs::kind::Kind;
use crate::io::OutputImage;
use crate::io::sim::{MachineFile, PartFile, SimFileError, SimulatedMachine};
use crate::store::FolderError;
use crate::units::Micros;

/// Why a host could not be created.
#[derive(Debug, thiserror::Error)]
pub enum HostError {
    /// A machine or part file is invalid.
    #[error(transparent)]
    File(#[from] SimFileError),
    /// A folder cannot be read.
    #[error(transparent)]
    Folder(#[from] FolderError),
}

/// The initial state of a headless host.
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

/// A control and its simulated machine with storage in the step.
pub type HeadlessHost = Host<HostedSimulation, DirectStorage>;

impl HeadlessHost {
    /// Creates a machine and a control at power-on.
    ///
    /// # Errors
    /// The machine file of the kind is invalid, or a folder cannot be read.
    pub fn new(setup: HostSetup) -> Result<Self, HostError> {
        let HostSetup { kind, retained, store, folders, seed } = setup;
        let jobs = JobRunner::new(folders).with_cycle_timer(cycle_time::simulate);
        let storage = DirectStorage::new(RetainedWorker::new(store), jobs)?;
        let machine = SimulatedMachine::new(MachineFile::builtin(kind)?, None, &retained.params, seed);
        Ok(Self::connect(kind, retained, HostedSimulation::new(machine, Micros::ZERO), storage))
    }

    /// Steps by one tick; `around` runs `Controller::tick`, to time it or to count its allocations.
    pub fn step_around(&mut self, around: impl FnOnce(&mut dyn FnMut())) {
        self.step_with(|controller, now, image, commands| {
            let mut outputs = OutputImage::default();
            around(&mut || outputs = *controller.tick(now, image, commands));
            outputs
        });
    }

    /// Gives the control a number: pages that have shown another one begin anew.
    pub const fn number_control(&mut self, number: u32) {
        self.control = number;
    }

    /// Adds a program that is not in the folder (a file named on the command line).
    pub fn add_program(&mut self, program: StoredProgram) {
        self.add_programs(vec![program]);
    }

    /// Adds programs that are not in the folder.
    pub fn add_programs(&mut self, added: Vec<StoredProgram>) {
        self.storage.keep_programs(&added);
        let mut programs = Arc::clone(&self.delivered.programs);
        Arc::make_mut(&mut programs).replace(added);
        let directory = Arc::clone(&self.delivered.directory);
        self.set_programs(programs, directory);
    }

    /// Takes the lines that programs have printed (DPRNT).
    pub fn take_printed(&mut self) -> Vec<String> {
        self.storage.take_printed()
    }

    /// Sets the folder for screenshots and the folder used as the USB drive.
    pub fn set_drives(&mut self, prints: Option<PathBuf>, usb: Option<PathBuf>) {
        self.storage.change_jobs(|jobs| jobs.with_drives(prints, usb));
    }

    /// Sets the RS232 port.
    pub fn set_serial_port(&mut self, port: String) {
        self.storage.change_jobs(|jobs| jobs.with_serial(Some(port), None));
    }
}

impl<S: Storage> Host<HostedSimulation, S> {
    /// Replaces the machine by another one of the same kind (another leadscrew or wheel), without a part and without
    /// faults, and restarts the control.
    pub fn swap_machine(&mut self, machine: MachineFile, seed: u64) {
        let machine = SimulatedMachine::new(machine, None, &self.retained.params, seed);
        self.plant = HostedSimulation::new(machine, Micros::ZERO);
        self.part.mounted = None;
        self.restart_controller();
        self.deliver_again();
    }

    /// Restarts the machine's random generator with a seed.
    pub fn reseed(&mut self, seed: u64) {
        self.plant.machine_mut().reseed(seed);
    }

    /// Starts a headless run (T3): axes homed, hydraulics on, part clamped. Restarts the control.
    pub fn make_ready(&mut self) {
        self.plant.machine_mut().make_ready();
        self.restart_controller();
        self.controller.make_ready(self.plant.machine().encoder_zero_mm());
        self.deliver_again();
    }

    /// The machine.
    #[must_use]
    pub const fn machine(&self) -> &SimulatedMachine {
        self.plant.machine()
    }

    /// The machine, for forcing inputs and faults.
    pub const fn machine_mut(&mut self) -> &mut SimulatedMachine {
        self.plant.machine_mut()
    }

    /// The bar for a program of a lathe.
    #[must_use]
    pub fn bar_of_program(&self, number: u32) -> Option<PartFile> {
        super::bar::bar_of_program(self.kind, &self.retained.params, &self.program_source(number)?)
    }
}
