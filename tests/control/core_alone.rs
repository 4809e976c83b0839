//! A control with its machine alone: no host, no disk. What the control wants stored is kept, and its answers are given
//! by hand.

use std::sync::Arc;

use kt830::controller::{Controller, PowerOnState, Programs, StorageRequest};
use kt830::defs::alarm;
use kt830::defs::kind::Kind;
use kt830::host::folders::program_from_bytes;
use kt830::io::Backend;
use kt830::io::sim::{MachineFile, SimulatedMachine};
use kt830::link::files::{FileAnswer, FileRequest, Refusal, Ticket};
use kt830::link::page_command::{PageCommand, StorageAnswer};
use kt830::link::{Command, Snapshot};
use kt830::units::Micros;

/// The control, its machine and what it has asked to be stored.
pub struct Core {
    controller: Controller,
    machine: SimulatedMachine,
    now: Micros,
    stored: Vec<StorageRequest>,
    /// Marks that the disk has not acknowledged; it does in the next tick, unless it hangs.
    marks: Vec<u64>,
    pub disk_hangs: bool,
    snapshot: Snapshot,
}

impl Core {
    /// A homed machine, nothing running, with programs by number and text.
    pub fn ready(kind: Kind, programs: &[(u32, &str)]) -> Self {
        let retained = PowerOnState::factory(kind);
        let mut machine = SimulatedMachine::new(MachineFile::builtin(kind).unwrap(), None, &retained.params, 1);
        machine.make_ready();
        let image = machine.read(Micros::ZERO);
        let mut controller = Controller::new(kind, retained, image, Micros::ZERO);
        controller.make_ready(machine.encoder_zero_mm());
        let stored = |(number, text): &(u32, &str)| {
            program_from_bytes(*number, "TEST.NC", text.as_bytes().to_vec(), kind.dialect())
        };
        controller.set_programs(Arc::new(Programs::new(programs.iter().map(stored).collect())), Arc::default());
        let snapshot = Snapshot::new(kind);
        let mut core = Self {
            controller,
            machine,
            now: Micros::ZERO,
            stored: Vec::new(),
            marks: Vec::new(),
            disk_hangs: false,
            snapshot,
        };
        core.wait(100);
        core
    }

    fn tick(&mut self, commands: &[Command]) {
        self.now = self.now + self.controller.tick_time();
        let image = self.machine.read(self.now);
        let mut commands = commands.to_vec();
        if !self.disk_hangs {
            commands.extend(self.marks.drain(..).map(Command::Stored));
        }
        let outputs = *self.controller.tick(self.now, &image, &commands);
        self.machine.write(self.now, &outputs);
        self.controller.drain_storage_requests(&mut self.stored);
        let marks = &mut self.marks;
        self.stored.retain(|request| match request {
            StorageRequest::Mark(mark) => {
                marks.push(*mark);
                false
            }
            _ => true,
        });
    }

    /// One tick with a command.
    pub fn send(&mut self, command: Command) {
        self.tick(&[command]);
    }

    /// Ticks without a command.
    pub fn wait(&mut self, milliseconds: u64) {
        let end = self.now + Micros::from_millis(milliseconds);
        while self.now < end {
            self.tick(&[]);
        }
    }

    /// The message of the refusal that ended the last tick's command.
    pub fn refusal(&self) -> Option<String> {
        self.controller.refusal().map(|said| said.en().to_string())
    }

    /// What the pages show.
    pub fn shown(&mut self) -> &Snapshot {
        self.controller.snapshot(&mut self.snapshot);
        &self.snapshot
    }

    pub const fn controller(&self) -> &Controller {
        &self.controller
    }

    /// A page asks; returns the requests that went on to the background thread.
    pub fn ask(&mut self, ticket: Ticket, request: FileRequest) -> Vec<FileRequest> {
        self.stored.clear();
        self.send(Command::Page(PageCommand::File(ticket, request)));
        self.jobs()
    }

    /// The file requests that went on to the background thread since the last question.
    pub fn jobs(&mut self) -> Vec<FileRequest> {
        let jobs = self.stored.drain(..).filter_map(|request| match request {
            StorageRequest::Job(job) => Some(job.request),
            _ => None,
        });
        jobs.collect()
    }

    /// The background thread answers.
    pub fn answer(&mut self, ticket: Ticket, answer: FileAnswer) {
        self.storage_answers(StorageAnswer::File(ticket, answer));
    }

    pub fn storage_answers(&mut self, answer: StorageAnswer) {
        self.send(Command::Page(PageCommand::StorageAnswered(answer)));
    }

    /// The result that a page has got on its ticket: the message, or the refusal.
    pub fn result(&mut self, ticket: Ticket) -> Option<Result<String, Refusal>> {
        let answer = self.shown().files.answers.iter().rev().find(|answer| answer.ticket == ticket)?;
        Some(answer.result.clone().map(|done| done.message.en().to_string()))
    }
}

/// A disk that hangs: the value is marked after a tenth of a second, an alarm comes after one second, and both end with the
/// acknowledgement. What is sent meanwhile waits for its own.
#[test]
fn b6_a_value_is_shown_as_stored_only_when_it_is() {
    let mut core = Core::ready(Kind::Gc, &[]);
    let storing = |core: &mut Core| {
        core.wait(1);
        let shown = core.shown();
        (shown.is_storing, shown.alarms.iter().any(|alarm| alarm.number == alarm::STORE_SLOW))
    };
    assert_eq!(storing(&mut core), (false, false));
    core.disk_hangs = true;
    core.send(Command::SetVariable(500, Some(1.0)));
    core.wait(90);
    assert_eq!(storing(&mut core), (false, false), "a commit takes some milliseconds");
    core.wait(20);
    assert_eq!(storing(&mut core), (true, false));
    core.wait(700);
    core.send(Command::SetVariable(501, Some(1.0)));
    core.wait(200);
    assert_eq!(storing(&mut core), (true, true));
    core.disk_hangs = false;
    core.wait(2);
    assert_eq!(storing(&mut core), (false, false));
    assert_eq!(core.shown().message.text.en(), "the values are stored");
}
