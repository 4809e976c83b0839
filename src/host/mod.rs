//! Hosts the core: one [`Host`] connects the control with a machine and with storage. It is stepped by tests, stories
//! and `run` ([`headless`]), or paced on a thread of its own for the window and the demo ([`thread`]).
//! The only room with a clock and threads.
//! Source: spec tools.md T1–T6; simulator.md; notes "reliability".

#[cfg(all(feature = "hmi", target_os = "linux"))]
pub mod absent_machine;
pub mod bar;
pub mod buzzer;
pub mod clock;
pub mod control_end;
pub mod cycle_time;
pub mod data_loss;
mod description_lines;
pub mod field_machine;
pub mod folders;
pub mod headless;
pub mod headless_run;
pub mod hosted_machine;
mod job_answer;
pub mod job_runner;
mod leadscrew_files;
pub mod link;
pub mod modbus;
pub mod pace;
mod page_file;
pub mod part;
pub mod password_store;
pub mod picture_labels;
mod print_file;
mod program_file;
mod program_split;
pub mod retained_store;
pub mod serial;
mod shipped;
pub mod simulated;
pub mod storage;
pub mod thread;
pub mod toolpath;
pub mod transfer;
pub mod value_set;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use crate::controller::{Controller, PowerOnState, Programs, StorageRequest, StoredProgram};
use crate::defs::alarm;
use crate::defs::date::DateTime;
use crate::defs::kind::Kind;
use crate::defs::signal::Terminals;
use crate::defs::text::{LocalizedText, phrase};
use crate::io::sim::{PartFile, SimulatedMachine};
use crate::io::trace::TraceRow;
use crate::io::{InputImage, OutputImage};
use crate::link::command::Command;
use crate::link::demo_view::DemoView;
use crate::link::page_command::{DataChoice, PageCommand, StorageAnswer};
use crate::link::production::PartInspection;
use crate::link::screens::Screens;
use crate::link::snapshot::{DirectoryRow, RunState, Snapshot};
use crate::nc::Source;
use crate::units::Micros;

use hosted_machine::HostedMachine;
use pace::{Pace, ThreadTimes};
use part::{PartQuery, PartRule};
use retained_store::apply_request;
use storage::{Arrival, Storage};

/// Maximum number of storage requests that wait for a full queue; the oldest are dropped first, with an alarm.
const MAX_WAITING_REQUESTS: usize = 100_000;

/// What storage has delivered; a control that gets its power back receives it again.
#[derive(Default)]
struct Delivered {
    programs: Arc<Programs>,
    directory: Arc<Vec<DirectoryRow>>,
    screens: Option<Arc<Screens>>,
    /// The time of day, and the host's time at which it came.
    wall_clock: Option<(DateTime, Micros)>,
    /// Alarms of data and settings that stand until a person has decided, with their detail.
    standing: Vec<(u16, LocalizedText)>,
}

/// The part in the machine, and the part that belongs to the current program.
struct MountedPart {
    rule: PartRule,
    /// A question that storage has not taken yet.
    to_ask: Option<u32>,
    /// Number of questions that storage has not answered.
    asked: u32,
    /// A part that waits for the end of the run.
    waiting: Option<Box<PartFile>>,
    /// The part in the machine.
    mounted: Option<PartFile>,
    /// Number of parts mounted because of a program.
    changes: u32,
    /// End of the cycle whose part was measured last.
    measured_at: Option<Micros>,
}

/// A control with its machine and its storage.
pub struct Host<P, S> {
    kind: Kind,
    controller: Controller,
    plant: P,
    storage: S,
    /// What the next power-on begins with.
    retained: PowerOnState,
    delivered: Delivered,
    part: MountedPart,
    requests: Vec<StorageRequest>,
    arrivals: Vec<Arrival>,
    inbox: Vec<Command>,
    image: InputImage,
    outputs: OutputImage,
    now: Micros,
    powered: bool,
    /// Times of its thread; nothing of a host that is stepped.
    times: ThreadTimes,
    /// What spectators of a demonstration are told.
    demo: DemoView,
    /// Number of the control on its thread: another one takes its place in a demonstration.
    control: u32,
    snapshot: Option<Box<Snapshot>>,
}

impl<P: HostedMachine, S: Storage> Host<P, S> {
    /// Connects a control with its machine and switches it on, with what storage has ready.
    pub fn connect(kind: Kind, retained: PowerOnState, mut plant: P, storage: S) -> Self {
        let now = Micros::ZERO;
        let image = plant.read(now);
        let controller = Controller::new(kind, retained.clone(), image, now);
        let part = MountedPart {
            rule: PartRule::Keep,
            to_ask: None,
            asked: 0,
            waiting: None,
            mounted: None,
            changes: 0,
            measured_at: None,
        };
        let mut host = Self {
            kind,
            controller,
            plant,
            storage,
            retained,
            delivered: Delivered::default(),
            part,
            requests: Vec::new(),
            arrivals: Vec::new(),
            inbox: Vec::new(),
            image,
            outputs: OutputImage::default(),
            now,
            powered: true,
            times: ThreadTimes::default(),
            demo: DemoView::Silent,
            control: 0,
            snapshot: None,
        };
        host.take_arrivals();
        host
    }

    /// The ticks begin now.
    pub fn begin(&mut self) {
        self.plant.begin();
    }

    /// Queues a command for the next tick; a command of the simulator page acts on the machine at once.
    pub fn send(&mut self, command: Command) {
        match command {
            Command::Simulate(asked) => self.plant.simulate(asked),
            Command::ClearBusCounters => {
                self.times.clear();
                self.plant.clear_counters();
            }
            other => self.queue(other),
        }
    }

    /// Queues a command and notes what a control needs again after a power cut.
    fn queue(&mut self, command: Command) {
        match &command {
            Command::ScreensLoaded(screens) => self.delivered.screens = Some(Arc::clone(screens)),
            Command::WallClock(date) => self.delivered.wall_clock = Some((*date, self.now)),
            Command::Page(PageCommand::StorageAnswered(StorageAnswer::DataAccepted(DataChoice::Present))) => {
                self.delivered
                    .standing
                    .retain(|(number, _)| !matches!(*number, alarm::RETAINED_DATA_DAMAGED | alarm::VALUES_DROPPED));
            }
            Command::Page(PageCommand::StorageAnswered(StorageAnswer::KindSaved(_))) => {
                self.delivered.standing.retain(|(number, _)| *number != alarm::SETTINGS_INVALID);
            }
            _ => {}
        }
        self.inbox.push(command);
    }

    /// The commands that wait for the next tick.
    #[must_use]
    pub fn queued_commands(&self) -> &[Command] {
        &self.inbox
    }

    /// The machine.
    pub const fn machine_side(&mut self) -> &mut P {
        &mut self.plant
    }

    /// The machine, to look at.
    pub const fn machine_side_ref(&self) -> &P {
        &self.plant
    }

    /// Times of its thread.
    #[must_use]
    pub const fn times(&self) -> &ThreadTimes {
        &self.times
    }

    /// The storage.
    pub const fn storage(&mut self) -> &mut S {
        &mut self.storage
    }

    /// Number of requests of the control that storage has not taken.
    #[must_use]
    pub const fn waiting_requests(&self) -> usize {
        self.requests.len()
    }

    /// Steps control and machine by one tick.
    pub fn step(&mut self) {
        self.step_with(|controller, now, image, commands| *controller.tick(now, image, commands));
    }

    /// One tick in its order: inputs, control, outputs, storage requests, answers for the next tick. Without power only
    /// the machine goes on.
    fn step_with(&mut self, tick: impl FnOnce(&mut Controller, Micros, &InputImage, &[Command]) -> OutputImage) {
        self.now = self.now + self.controller.tick_time();
        self.image = self.plant.read(self.now);
        if let Some((number, detail)) = self.plant.take_bus_fault() {
            self.controller.report_bus_fault(number, detail);
        }
        if !self.powered {
            self.take_arrivals();
            self.inbox.clear();
            return;
        }
        self.outputs = tick(&mut self.controller, self.now, &self.image, &self.inbox);
        self.inbox.clear();
        self.plant.write(self.now, &self.outputs);
        self.note_end_of_cycle();
        self.submit_requests();
        self.take_arrivals();
        self.mount_waiting_part();
    }

    /// The part of a cycle is measured once, at its end.
    fn note_end_of_cycle(&mut self) {
        let finished = self.controller.part_result();
        let ended = finished.map(|part| part.ended_at);
        if let Some(part) = finished.filter(|_| ended != self.part.measured_at) {
            self.plant.measure_finished_part();
            if let Some(view) = self.plant.view(self.now) {
                let size = part.judged_size(Some(&view)).map(|size| size.mm());
                let (ended_at, verdict) = (part.ended_at, part.verdict(Some(&view)));
                self.inbox.push(Command::PartInspected(PartInspection { ended_at, size, verdict }));
            }
        }
        self.part.measured_at = ended;
    }

    /// Hands the control's storage requests on. What storage cannot take now is submitted again after the next tick.
    fn submit_requests(&mut self) {
        let old = self.requests.len();
        self.controller.drain_storage_requests(&mut self.requests);
        let mut rewired = false;
        for request in &self.requests[old..] {
            apply_request(&mut self.retained, request);
            rewired |= request.changes_machine_setup();
            if self.part.rule == PartRule::FollowProgram && part::changes_part(request) {
                self.part.to_ask = Some(self.retained.current_program);
            }
        }
        if rewired {
            self.plant.rewire(&self.retained.params);
        }
        if !self.requests.is_empty() {
            self.storage.submit(&mut self.requests);
        }
        if self.requests.len() > MAX_WAITING_REQUESTS {
            self.requests.drain(..self.requests.len() - MAX_WAITING_REQUESTS / 2);
            self.inbox.push(Command::DiskFailed(phrase!(
                "存储线程没有响应，较早的数据没有保存",
                "the storage thread does not answer: older values are not stored"
            )));
        }
        if let Some(number) = self.part.to_ask {
            self.ask_for_part(number);
        }
    }

    fn ask_for_part(&mut self, number: u32) {
        let source = self.program_source(number);
        let params = self.retained.params.clone();
        let taken = self.storage.find_part(PartQuery { kind: self.kind, params, number, source });
        self.part.asked += u32::from(taken);
        self.part.to_ask = (!taken).then_some(number);
    }

    /// Takes what storage has delivered: programs at once, commands for the next tick, a part when nothing runs.
    fn take_arrivals(&mut self) {
        let mut arrivals = std::mem::take(&mut self.arrivals);
        self.storage.poll(&mut arrivals);
        for arrival in arrivals.drain(..) {
            match arrival {
                Arrival::Command(command) => self.queue(command),
                Arrival::Programs(programs, directory) => self.set_programs(programs, directory),
                Arrival::Part(part) => {
                    self.part.asked = self.part.asked.saturating_sub(1);
                    self.part.waiting = part;
                }
            }
        }
        self.arrivals = arrivals;
    }

    fn set_programs(&mut self, programs: Arc<Programs>, directory: Arc<Vec<DirectoryRow>>) {
        self.controller.set_programs(Arc::clone(&programs), Arc::clone(&directory));
        (self.delivered.programs, self.delivered.directory) = (programs, directory);
    }

    /// Mounts the part of the current program, unless the machine is working on another one.
    fn mount_waiting_part(&mut self) {
        if matches!(self.controller.state(), RunState::Running | RunState::Homing) {
            return;
        }
        if let Some(part) = self.part.waiting.take() {
            self.part.changes += 1;
            self.mount_part(&part);
            self.inbox.push(Command::PartMounted);
        }
    }

    /// Mounts a part in the machine and sends its work offset and tool geometry to the control. Variables without a
    /// value get the part's value.
    pub fn mount_part(&mut self, part: &PartFile) {
        self.plant.mount_part(part);
        self.part.mounted = Some(part.clone());
        let variables = &self.retained.variables;
        let present = |variable: u16| variables.get(u32::from(variable)).ok().flatten();
        self.inbox.extend(part::part_setup_commands(part, present));
    }

    /// Mounts a part in a machine that has been set up for it: the control gets its outline only. What lies in a real
    /// machine nobody knows: it gets none.
    pub fn place_part(&mut self, part: &PartFile) {
        if self.plant.pace() == Pace::Real {
            return;
        }
        self.plant.mount_part(part);
        self.part.mounted = Some(part.clone());
        self.inbox.push(part::stock_command(part));
    }

    /// Sets which part is mounted when the current program changes. In a real machine the operator mounts and measures
    /// the part: no program replaces his work offset.
    pub fn set_part_rule(&mut self, rule: PartRule) {
        self.part.rule = if self.plant.pace() == Pace::Real { PartRule::Keep } else { rule };
    }

    /// Whether the part of the current program has been asked for and is not mounted yet.
    #[must_use]
    pub const fn awaits_part(&self) -> bool {
        self.part.to_ask.is_some() || self.part.asked > 0 || self.part.waiting.is_some()
    }

    /// How many parts have been mounted because the current program changed.
    #[must_use]
    pub const fn part_changes(&self) -> u32 {
        self.part.changes
    }

    /// The simulated machine, if it is one.
    pub fn simulation(&mut self) -> Option<&mut SimulatedMachine> {
        self.plant.simulation()
    }

    /// Cuts the power at this tick: all outputs go off.
    pub fn power_cut(&mut self) {
        self.powered = false;
        self.outputs = OutputImage { set_point_mm: self.image.encoder_mm, ..OutputImage::default() };
        self.plant.write(self.now, &self.outputs);
    }

    /// Restores the power: a cold start with the retained data so far.
    pub fn power_on(&mut self) {
        self.powered = true;
        self.plant.power_on(&self.retained.params);
        self.restart_controller();
        self.deliver_again();
    }

    /// Restores the power with what the storage has kept, and the alarms of its data that stand.
    pub fn power_on_with(&mut self, retained: PowerOnState, standing: Vec<(u16, LocalizedText)>) {
        self.retained = retained;
        self.delivered = Delivered { standing, ..Delivered::default() };
        self.requests.clear();
        self.arrivals.clear();
        self.power_on();
        self.take_arrivals();
    }

    /// A new control with the retained data so far.
    fn restart_controller(&mut self) {
        self.image = self.plant.read(self.now);
        self.controller = Controller::new(self.kind, self.retained.clone(), self.image, self.now);
    }

    /// Delivers programs, page files, the time of day, the outline of the part and a damage report to a new control.
    fn deliver_again(&mut self) {
        let delivered = &self.delivered;
        self.controller.set_programs(Arc::clone(&delivered.programs), Arc::clone(&delivered.directory));
        if let Some(screens) = &delivered.screens {
            self.inbox.push(Command::ScreensLoaded(Arc::clone(screens)));
        }
        if let Some((DateTime(seconds), at)) = delivered.wall_clock {
            let passed = self.now.since(at).0 / 1_000_000;
            self.inbox.push(Command::WallClock(DateTime(seconds + passed as i64)));
        }
        self.inbox.extend(self.part.mounted.as_ref().map(part::stock_command));
        for (number, what) in &self.delivered.standing {
            self.controller.report_alarm(*number, Some(what.clone()));
        }
    }

    /// The computer has held the control up for so long that nothing must simply go on (alarm 404).
    pub fn report_stall(&mut self) {
        self.controller.report_stall();
    }

    /// Raises an alarm of data or settings, now and at every power-on until a person has decided.
    pub fn report_standing(&mut self, number: u16, what: &LocalizedText) {
        self.delivered.standing.push((number, what.clone()));
        self.controller.report_alarm(number, Some(what.clone()));
    }

    /// Writes the safe image without a tick: spindles, fluids, drives and analog outputs off, clamps hold. Also after a
    /// panic of control or machine.
    pub fn leave_safe(&mut self) {
        let kept = catch_unwind(AssertUnwindSafe(|| self.controller.kept_in_safe_state())).unwrap_or_default();
        let terminals = Terminals(self.outputs.terminals.0 & kept.0);
        self.outputs = OutputImage {
            terminals,
            drives_on: false,
            fault_reset: false,
            awaited_signal: 0,
            wheel_volts: 0.0,
            analog_2_volts: 0.0,
            ..self.outputs
        };
        drop(catch_unwind(AssertUnwindSafe(|| self.plant.write(self.now, &self.outputs))));
    }

    /// The machine gets the safe image on, and nothing else, for another tick.
    pub fn hold_safe_image(&mut self) {
        self.now = self.now + self.controller.tick_time();
        let (plant, now, outputs) = (&mut self.plant, self.now, &self.outputs);
        // A machine that fails in this has its watchdogs left.
        drop(catch_unwind(AssertUnwindSafe(|| {
            plant.read(now);
            plant.write(now, outputs);
        })));
    }

    /// The control is to end: what moves brakes in the next ticks, and the place of an open run is kept.
    pub fn begin_end(&mut self) {
        self.controller.begin_end();
    }

    /// Stores everything and ends the storage.
    pub fn close(&mut self) {
        if self.powered {
            self.controller.store_everything();
            self.submit_requests();
        }
        self.storage.close();
    }

    /// Writes what a page shows now into a snapshot.
    pub fn snapshot_into(&mut self, into: &mut Snapshot) {
        self.controller.snapshot(into);
        into.simulated = self.plant.view(self.now);
        into.bus = self.plant.bus_view(self.now, &self.times);
        if !self.powered {
            into.clear_for_power_off();
        }
        into.host.demo.clone_from(&self.demo);
        into.host.control = self.control;
    }

    /// Tells spectators of a demonstration something; the control knows nothing of it.
    pub fn show_demo(&mut self, demo: DemoView) {
        self.demo = demo;
    }

    /// The snapshot that a page would show now.
    pub fn snapshot(&mut self) -> &Snapshot {
        let mut newest = self.snapshot.take().unwrap_or_else(|| Box::new(Snapshot::new(self.kind)));
        self.snapshot_into(&mut newest);
        self.snapshot.insert(newest)
    }

    /// Inputs and outputs of the last tick.
    #[must_use]
    pub const fn trace_row(&self) -> TraceRow {
        TraceRow { now: self.now, inputs: self.image, outputs: self.outputs }
    }

    /// Whether the control has power.
    #[must_use]
    pub const fn is_powered(&self) -> bool {
        self.powered
    }

    /// The control.
    #[must_use]
    pub const fn controller(&self) -> &Controller {
        &self.controller
    }

    /// Voltage of the second analog output, 0 to 10 V.
    #[must_use]
    pub const fn analog_2_volts(&self) -> f64 {
        self.controller.outputs().analog_2_volts
    }

    /// Time since the start: the sum of the ticks.
    #[must_use]
    pub const fn now(&self) -> Micros {
        self.now
    }

    /// Length of a tick.
    #[must_use]
    pub const fn tick_time(&self) -> Micros {
        self.controller.tick_time()
    }

    /// The kind of machine.
    #[must_use]
    pub const fn kind(&self) -> Kind {
        self.kind
    }

    /// The retained data.
    #[must_use]
    pub const fn retained(&self) -> &PowerOnState {
        &self.retained
    }

    /// Whether a program is known.
    #[must_use]
    pub fn has_program(&self, number: u32) -> bool {
        self.delivered.programs.get(number).is_some()
    }

    /// The programs.
    #[must_use]
    pub fn programs(&self) -> &Arc<Programs> {
        &self.delivered.programs
    }

    /// The text of a program.
    #[must_use]
    pub fn program_source(&self, number: u32) -> Option<Arc<Source>> {
        self.delivered.programs.get(number).map(|program| Arc::clone(&program.source))
    }

    /// The number of the first program of the file with this name, with or without its extension.
    #[must_use]
    pub fn find_program(&self, word: &str) -> Option<u32> {
        let stem = |name: &str| name.rsplit_once('.').map_or(name, |(stem, _)| stem).to_ascii_uppercase();
        let wanted = stem(word);
        let is_first = |program: &StoredProgram| program.part.as_ref().is_none_or(|part| part.lines_before == 0);
        let named = |program: &&StoredProgram| is_first(program) && stem(program.source.name()) == wanted;
        self.delivered.programs.iter().find(named).map(|program| program.number)
    }

    /// The part of a program.
    #[must_use]
    pub fn part_of_program(&self, number: u32) -> Option<PartFile> {
        let source = self.program_source(number);
        PartQuery { kind: self.kind, params: self.retained.params.clone(), number, source }.find()
    }
}
