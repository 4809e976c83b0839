//! Plays a story on a host: each statement does what an operator would do, then the control runs until it has answered.
//! Source: spec tools.md T5, "Story language".

use std::path::{Path, PathBuf};

use super::stage::Stage;
use super::statement::{Expectation, InputForce, Quantity, Statement, StoryLine, WaitCondition};
use crate::defs::key::{Key, Mode};
use crate::defs::leadscrew::LeadscrewCompensation;
use crate::defs::page::Page;
use crate::defs::text::Lang;
use crate::host::Host;
use crate::host::hosted_machine::HostedMachine;
use crate::host::part::PartRule;
use crate::host::storage::Storage;
use crate::io::sim::{PartFile, SimulatedMachine};
use crate::link::command::Command;
use crate::link::demo_view::DemoView;
use crate::link::files::{FileRequest, Requester, Ticket};
use crate::link::media::{Direction, TransferRequest, TransferSet};
use crate::link::page_command::PageCommand;
use crate::link::snapshot::{AlarmView, RunState, Snapshot};
use crate::units::{Axis, Micros};
use ropey::Rope;

/// Maximum size of a file named in a story, bytes.
const FILE_LIMIT: u64 = 16 * 1024 * 1024;
/// Ticks after every statement.
const ANSWER_TICKS: u32 = 2;
/// Maximum wait for an answer.
const ANSWER_TIMEOUT: Micros = Micros::from_millis(48);
/// Ticks after an input was forced: longer than the input debounce time.
const INPUT_TICKS: u32 = 20;
/// Interval of `Hold` commands for a held key.
const HOLD_INTERVAL: Micros = Micros::from_millis(50);
/// Maximum wait of `mdi` and `handwheel` for standstill.
const STANDSTILL_TIMEOUT: Micros = Micros::from_millis(1_000);
/// Maximum wait for the part of a program from the storage thread.
const PART_TIMEOUT: Micros = Micros::from_millis(2_000);
/// Maximum duration of homing.
const HOMING_TIMEOUT: Micros = Micros::from_millis(300_000);

/// Reads the texts of the open page for `expect page … shows`. A build without the screen has none.
pub type PageReader = Box<dyn Fn(&Snapshot) -> Vec<String>>;

/// Plays a story. Waiting ends at once when the stage is interrupted.
pub struct Player<'a, G: Stage> {
    stage: &'a mut G,
    page_reader: Option<PageReader>,
    folder: PathBuf,
    /// Jog keys that are held: `Hold` is repeated as by the screen, until they are released.
    held_keys: Vec<Key>,
    /// Time of the next `Hold`.
    next_hold: Micros,
}

/// Releases all held keys at the end of the story.
impl<G: Stage> Drop for Player<'_, G> {
    fn drop(&mut self) {
        for key in self.held_keys.drain(..) {
            self.stage.host().send(Command::Release(key));
        }
    }
}

impl<'a, G: Stage> Player<'a, G> {
    /// Creates a player. Files named in the story are searched in `folder`. `part_given`: a part is mounted already, so
    /// loading a program does not mount another.
    #[must_use]
    pub fn new(stage: &'a mut G, eyes: Option<PageReader>, folder: &Path, part_given: bool) -> Self {
        stage.host().set_part_rule(if part_given { PartRule::Keep } else { PartRule::FollowProgram });
        Self { stage, page_reader: eyes, folder: folder.to_owned(), held_keys: Vec::new(), next_hold: Micros::ZERO }
    }

    /// The host.
    #[must_use]
    pub fn host(&mut self) -> &mut Host<G::Machine, G::Storage> {
        self.stage.host()
    }

    /// The stage.
    #[must_use]
    pub const fn stage(&mut self) -> &mut G {
        self.stage
    }

    /// Plays one line.
    ///
    /// # Errors
    /// Why an expectation or a statement failed.
    pub fn play(&mut self, line: &StoryLine) -> Result<(), String> {
        match &line.statement {
            Statement::Kind(_) | Statement::Prepared => Ok(()),
            Statement::PowerOn => self.power_on(),
            Statement::PowerCut => {
                self.held_keys.clear();
                self.stage.power_cut();
                Ok(())
            }
            Statement::Param(at, value) => self.set(Command::SetParam(*at, *value)),
            Statement::Set(number, value) => self.set(Command::SetVariable(*number, *value)),
            Statement::Load(number) => self.load(*number),
            Statement::LoadNamed(name) => match self.host().find_program(name) {
                Some(number) => self.load(number),
                None => Err(format!("程序目录中没有 {name}; {name} is not in the programs folder")),
            },
            Statement::Mode(mode) => self.press(mode.key()),
            Statement::HomeAll => self.home_all(),
            Statement::Key(key) => self.press(*key),
            Statement::Press(key) => {
                self.press_and_hold(*key);
                self.wait_for_answer()
            }
            Statement::Release(key) => self.release(*key),
            Statement::Hold(key, seconds) => self.hold(*key, *seconds),
            Statement::Handwheel(axis, detents, step) => self.handwheel(*axis, *detents, *step),
            Statement::Mdi(text) => self.mdi(text),
            Statement::Page(page) => self.send(Command::OpenPage(*page)),
            Statement::Teach(command) => self.send(Command::Teach(*command)),
            Statement::WriteProgram(number, text) => self.write_program(*number, text),
            Statement::DeleteProgram(number) => self.ask(FileRequest::Delete(*number)),
            Statement::Transfer(direction, set) => self.transfer(*direction, *set),
            Statement::Stall => self.stall(),
            Statement::Settings(command) => self.send(Command::Page(command.clone())),
            Statement::Order(command) => self.send(Command::Order(*command)),
            Statement::ProposeOrder(proposal) => self.send(Command::ProposeOrder(*proposal)),
            Statement::Disk(condition) => self.stage.set_disk(*condition),
            Statement::ScreenHangs(seconds) => self.stage.hang_screen(*seconds),
            Statement::ShowDemo(demo) => self.show_demo(demo.clone()),
            Statement::Sheet(number) => self.send(Command::ShowGrindingSheet(number - 1)),
            Statement::Type(number, value) => self.send(Command::EnterVariable(*number, *value)),
            Statement::Input(name, force) => self.force_input(name, *force),
            Statement::Fault(text) => self.inject_fault(text),
            Statement::FaultOff(text) => self.clear_fault(text),
            Statement::FaultList => Ok(()),
            Statement::Wait(seconds) => {
                self.wait(Micros::from_secs_f64(*seconds));
                Ok(())
            }
            Statement::WaitUntil(until, most) => self.wait_until(*until, Micros::from_secs_f64(*most)),
            Statement::Seed(seed) => {
                self.simulated()?.reseed(*seed);
                Ok(())
            }
            Statement::Part(file) => self.part(file),
            Statement::Screw(axis, file) => self.screw(*axis, file),
            Statement::Expect(expectation) => self.expect(expectation),
        }
    }

    fn show_demo(&mut self, demo: DemoView) -> Result<(), String> {
        self.host().show_demo(demo);
        self.wait_for_answer()
    }

    fn write_program(&mut self, number: u32, text: &str) -> Result<(), String> {
        let text = Rope::from_str(&format!("{}\r\n", text.replace("\\n", "\r\n")));
        self.ask(FileRequest::Save { number, text, base_stamp: 0, overwrite: true })
    }

    /// Copies a whole set; what exists already is overwritten.
    fn transfer(&mut self, direction: Direction, set: TransferSet) -> Result<(), String> {
        let yes = Some(true);
        let ask = TransferRequest { set, direction, names: Vec::new(), overwrite: yes, convert: yes, split: yes };
        self.ask(FileRequest::Transfer(ask))
    }

    /// Asks for a job of the storage, as a page does.
    fn ask(&mut self, request: FileRequest) -> Result<(), String> {
        self.send(Command::Page(PageCommand::File(Ticket::without_reply(Requester::Editor), request)))
    }

    /// The simulated machine: part, faults and inputs of a real one are not ours.
    fn simulated(&mut self) -> Result<&mut SimulatedMachine, String> {
        let missing = || "only the simulated machine has this".to_owned();
        self.host().simulation().ok_or_else(missing)
    }

    fn inject_fault(&mut self, text: &str) -> Result<(), String> {
        self.simulated()?.inject_fault(text).map_err(|error| error.to_string())?;
        self.wait_for_answer()
    }

    fn clear_fault(&mut self, text: &str) -> Result<(), String> {
        self.simulated()?.clear_fault(text).map_err(|error| error.to_string())?;
        self.wait_for_answer()
    }

    fn stall(&mut self) -> Result<(), String> {
        self.host().report_stall();
        self.wait_for_answer()
    }

    fn power_on(&mut self) -> Result<(), String> {
        self.held_keys.clear();
        self.stage.power_on();
        self.wait_for_answer()
    }

    fn mdi(&mut self, text: &str) -> Result<(), String> {
        self.press(Mode::Mdi.key())?;
        self.send(Command::Mdi(text.to_owned()))?;
        self.wait_for_standstill();
        Ok(())
    }

    fn force_input(&mut self, name: &str, force: InputForce) -> Result<(), String> {
        let level = if let InputForce::To(on) = force { Some(on) } else { None };
        self.simulated()?.force_input(name, level).map_err(|error| error.to_string())?;
        self.ticks(INPUT_TICKS);
        Ok(())
    }

    /// Steps by one tick and repeats `Hold` for held keys.
    fn step(&mut self) {
        self.stage.step();
        if !self.held_keys.is_empty() && self.host().now() >= self.next_hold {
            self.next_hold = self.host().now() + HOLD_INTERVAL;
            for key in &self.held_keys {
                self.stage.host().send(Command::StillHeld(*key));
            }
        }
    }

    fn ticks(&mut self, count: u32) {
        (0..count).for_each(|_| self.step());
    }

    /// Waits until the control has answered: two ticks, and up to 48 ms more while it brakes.
    fn wait_for_answer(&mut self) -> Result<(), String> {
        self.ticks(ANSWER_TICKS);
        self.run_until(ANSWER_TIMEOUT, |host| !host.controller().is_braking());
        Ok(())
    }

    fn send(&mut self, command: Command) -> Result<(), String> {
        self.host().send(command);
        self.wait_for_answer()
    }

    /// Changes a setting without the panel. A refusal by the control is an error of the story (T5).
    fn set(&mut self, command: Command) -> Result<(), String> {
        self.host().send(command);
        self.wait_for_setting()
    }

    /// Waits for the answer to settings; the error is the control's refusal.
    fn wait_for_setting(&mut self) -> Result<(), String> {
        if !self.host().is_powered() {
            return Err("the control has no power".to_owned());
        }
        self.step();
        let refused = self.host().controller().refusal().map(|message| format!("{}; {}", message.zh(), message.en()));
        self.ticks(ANSWER_TICKS - 1);
        self.run_until(ANSWER_TIMEOUT, |host| !host.controller().is_braking());
        refused.map_or(Ok(()), Err)
    }

    /// The command of a pressed key. The mushroom of the emergency stop is turned out when it is latched.
    fn press_command(&mut self, key: Key) -> Command {
        match key {
            Key::EmergencyStop => self.host().snapshot().press_command(key),
            key => Command::Press(key),
        }
    }

    fn press_and_hold(&mut self, key: Key) {
        let command = self.press_command(key);
        self.host().send(command);
        if key.jog_direction().is_some() && !self.held_keys.contains(&key) {
            if self.held_keys.is_empty() {
                self.next_hold = self.host().now() + HOLD_INTERVAL;
            }
            self.held_keys.push(key);
        }
    }

    fn release(&mut self, key: Key) -> Result<(), String> {
        self.held_keys.retain(|held| *held != key);
        self.send(Command::Release(key))
    }

    fn press(&mut self, key: Key) -> Result<(), String> {
        let command = self.press_command(key);
        self.send(command)?;
        self.send(Command::Release(key))
    }

    fn wait(&mut self, span: Micros) {
        let end = self.host().now() + span;
        while self.host().now() < end && !self.stage.is_interrupted() {
            self.step();
        }
    }

    /// Runs until the condition is true; returns false after the timeout or a touch.
    fn run_until(&mut self, most: Micros, done: impl Fn(&mut Host<G::Machine, G::Storage>) -> bool) -> bool {
        let end = self.host().now() + most;
        while !done(self.host()) {
            if self.host().now() >= end || self.stage.is_interrupted() {
                return false;
            }
            self.step();
        }
        true
    }

    fn wait_for_standstill(&mut self) {
        self.run_until(STANDSTILL_TIMEOUT, |host| {
            let state = host.controller().state();
            host.controller().is_in_position() && !matches!(state, RunState::Running | RunState::Homing)
        });
    }

    fn load(&mut self, number: u32) -> Result<(), String> {
        let changes = self.host().part_changes();
        self.set(Command::LoadProgram(number))?;
        self.run_until(PART_TIMEOUT, |host| !host.awaits_part());
        if self.host().part_changes() != changes {
            self.wait_for_setting()?;
        }
        Ok(())
    }

    /// Path and text of a file named in the story.
    fn read(&self, file: &str) -> Result<(String, String), String> {
        let path = self.folder.join(file);
        let place = path.display().to_string();
        let refused = |error: String| format!("{place}: {error}");
        let metadata = std::fs::metadata(&path).map_err(|error| refused(error.to_string()))?;
        if !metadata.is_file() || metadata.len() > FILE_LIMIT {
            return Err(refused(format!("not a regular file of at most {FILE_LIMIT} bytes")));
        }
        std::fs::read_to_string(path).map_err(|error| refused(error.to_string())).map(|text| (place.clone(), text))
    }

    fn part(&mut self, file: &str) -> Result<(), String> {
        let (place, text) = self.read(file)?;
        let part = PartFile::parse(&text).map_err(|error| format!("{place}: {error}"))?;
        self.host().set_part_rule(PartRule::Keep);
        self.host().mount_part(&part);
        self.wait_for_setting()
    }

    fn screw(&mut self, axis: Axis, file: &str) -> Result<(), String> {
        let (place, text) = self.read(file)?;
        let table = LeadscrewCompensation::parse(&text).map_err(|fault| format!("{place} {fault}"))?;
        self.set(Command::SetLeadscrew(axis, table))
    }

    /// Homes all axes as an operator does: mode home, then one axis key after the other.
    fn home_all(&mut self) -> Result<(), String> {
        self.press(Mode::Home.key())?;
        let axes: Vec<Axis> = self.host().controller().axes_present().collect();
        for axis in axes {
            self.press(Key::from_jog(axis, true))?;
        }
        let homing = |host: &mut Host<G::Machine, G::Storage>| host.controller().state() != RunState::Homing;
        if !self.run_until(HOMING_TIMEOUT, homing) {
            return Err("homing did not end".to_owned());
        }
        let snapshot = self.host().snapshot();
        let missing = snapshot.axes.iter().find(|(_, view)| view.present && !view.homed).map(|(axis, _)| axis);
        missing.map_or(Ok(()), |axis| Err(format!("{axis} is not homed: {}", snapshot.message.text.zh())))
    }

    fn hold(&mut self, key: Key, seconds: f64) -> Result<(), String> {
        self.press_and_hold(key);
        self.wait(Micros::from_secs_f64(seconds));
        self.release(key)
    }

    fn handwheel(&mut self, axis: Axis, detents: i32, step: Key) -> Result<(), String> {
        if !self.host().snapshot().axes[axis].present {
            return Err(format!("this machine has no {axis}"));
        }
        let chosen = match axis {
            Axis::X => Key::HandwheelX,
            Axis::Y => Key::HandwheelY,
            Axis::Z => Key::HandwheelZ,
        };
        for key in [Mode::Handwheel.key(), chosen, step] {
            self.press(key)?;
        }
        self.send(Command::Handwheel(detents))?;
        self.wait_for_standstill();
        Ok(())
    }

    fn wait_until(&mut self, until: WaitCondition, most: Micros) -> Result<(), String> {
        let there = self.run_until(most, |host| match until {
            WaitCondition::State(state) => host.controller().state() == state,
            WaitCondition::Axis(axis, below, value) => {
                let at = host.snapshot().axes[axis].work;
                if below { at < value } else { at > value }
            }
        });
        if there { Ok(()) } else { Err(format!("not within {} s", most.as_secs_f64())) }
    }

    fn expect(&mut self, expectation: &Expectation) -> Result<(), String> {
        let on_off = |on: bool| if on { "on" } else { "off" };
        let switched = |name: &str, is: bool, wanted: bool| {
            if is == wanted { Ok(()) } else { Err(format!("{name} is {}", on_off(is))) }
        };
        match expectation {
            Expectation::Output(output, on) => switched(output.id(), self.host().snapshot().outputs.has(*output), *on),
            Expectation::Input(input, on) => switched(input.id(), self.host().snapshot().inputs.has(*input), *on),
            Expectation::Lamp(key, on) => switched(key.id(), self.host().snapshot().key(*key).lamp, *on),
            Expectation::Alarm(number) => {
                self.alarm(|alarm| alarm.number == *number, &format!("alarm {number} is not present"))
            }
            Expectation::AnyAlarm => self.alarm(|_| true, "no alarm is present"),
            Expectation::AlarmText(text) => {
                let has = |alarm: &AlarmView| alarm.text.zh().contains(text) || alarm.text.en().contains(text);
                self.alarm(has, "no alarm has this text")
            }
            Expectation::NoAlarm => match self.host().snapshot().alarms.first() {
                None => Ok(()),
                Some(alarm) => Err(format!("alarm {}: {}", alarm.number, alarm.text.zh())),
            },
            Expectation::Event(kind) => {
                let seen: Vec<_> = self.simulated()?.events().iter().map(|event| event.kind).collect();
                if seen.contains(kind) { Ok(()) } else { Err(format!("events: {seen:?}")) }
            }
            Expectation::NoEvent => match self.simulated()?.events().first() {
                None => Ok(()),
                Some(event) => Err(format!("event {} at {:.3} s on {}", event.kind.id(), event.seconds, event.place)),
            },
            Expectation::State(state) => {
                let is = self.host().controller().state();
                if is == *state { Ok(()) } else { Err(format!("state is {}", is.id())) }
            }
            Expectation::Value { of, is, tolerance } => self.value(*of, *is, *tolerance),
            Expectation::Message(text) => {
                let message = &self.host().snapshot().message.text;
                let shown = message.zh().contains(text) || message.en().contains(text);
                if shown { Ok(()) } else { Err(format!("the message is \"{}\"", message.zh())) }
            }
            Expectation::Page(page, text) => self.page_shows(*page, text),
        }
    }

    fn alarm(&mut self, is: impl Fn(&AlarmView) -> bool, no: &str) -> Result<(), String> {
        let alarms = &self.host().snapshot().alarms;
        if alarms.iter().any(is) {
            return Ok(());
        }
        let present: Vec<_> = alarms.iter().map(|alarm| format!("{} {}", alarm.number, alarm.text.zh())).collect();
        Err(format!("{no}; present: [{}]", present.join(", ")))
    }

    fn value(&mut self, of: Quantity, is: f64, tolerance: f64) -> Result<(), String> {
        let found = match of {
            Quantity::Work(axis) => Some(self.host().snapshot().axes[axis].work),
            Quantity::Machine(axis) => Some(self.host().snapshot().axes[axis].machine),
            Quantity::Variable(number) => {
                let host = self.host();
                match host.snapshot().variables.get(usize::from(number)).copied().flatten() {
                    Some(value) => Some(value),
                    None => host.controller().system_variable(u32::from(number)),
                }
            }
            Quantity::Wear(number, axis) => self.host().controller().wear(number, axis),
            Quantity::PartDiameter(z) => self.simulated()?.diameter_at(z),
            Quantity::PartFace(x) => self.simulated()?.face_at(x, None),
            Quantity::PartHeight(x, z) => self.simulated()?.height_at(x, z),
        };
        match found {
            // 1e-9 compensates binary rounding of the tolerance.
            Some(found) if (found - is).abs() <= tolerance + 1e-9 => Ok(()),
            Some(found) => Err(format!("it is {found:.4}, {:+.4} off", found - is)),
            None => Err("there is no such value".to_owned()),
        }
    }

    fn page_shows(&mut self, page: Page, text: &str) -> Result<(), String> {
        let snapshot = self.stage.host().snapshot();
        if snapshot.page != page {
            return Err(format!("the open page is {}", snapshot.page.id()));
        }
        let Some(texts_on) = &self.page_reader else {
            return Err("this build has no screen: pages cannot be looked at".to_owned());
        };
        let texts = texts_on(snapshot);
        // Labels may be split into several texts; spaces are ignored.
        let squeeze = |text: &str| text.split_whitespace().collect::<String>();
        let shown = squeeze(&texts.join("\n")).contains(&squeeze(text));
        if shown { Ok(()) } else { Err(format!("the page shows: {}", texts.join(" | "))) }
    }
}

/// A report of the control's state after a failed line.
#[must_use]
pub fn state_report<P: HostedMachine, S: Storage>(host: &mut Host<P, S>, lang: Lang) -> String {
    let now = host.now().as_secs_f64();
    let snapshot = host.snapshot();
    let present = snapshot.axes.iter().filter(|(_, view)| view.present);
    let axes = present
        .map(|(axis, view)| format!("{axis} {:.3} (machine {:.3}, to go {:.3})", view.work, view.machine, view.to_go));
    let outputs: Vec<_> = snapshot.outputs.iter().map(|output| output.id()).collect();
    let alarms: Vec<_> =
        snapshot.alarms.iter().map(|alarm| format!("{} {}", alarm.number, alarm.text.get(lang))).collect();
    format!(
        "  at {now:.3} s: state {}, mode {}, page {}, {} line {}\n  {}\n  outputs: {}\n  alarms: {}\n  message: {}",
        snapshot.state.id(),
        snapshot.mode.name().en,
        snapshot.page.id(),
        snapshot.title(snapshot.program.number),
        snapshot.program.line,
        axes.collect::<Vec<_>>().join(", "),
        outputs.join(" "),
        alarms.join("; "),
        snapshot.message.text.get(lang),
    )
}
