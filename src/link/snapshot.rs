//! The state that the core publishes for the screen. It is overwritten in place; only the newest value counts.
//! Lengths are as displayed: diameters where diameter mode is on.

use std::ops::RangeInclusive;
use std::sync::Arc;

use super::bus::BusView;
use super::command::Command;
use super::cycle::CycleView;
use super::edit::{EditAnswer, ModalView, OffsetTables};
use super::files::FilesView;
use super::host_view::HostView;
use super::internal_signal::{InternalSignal, InternalSignalSet};
use super::page_command::KeptState;
use super::part_result::SizeValues;
use super::production::ProductionView;
use super::program_view::ProgramView;
use super::restart_view::RestartView;
use super::scope::ScopeView;
use super::screens::{PROGRAMS_WITH_PAGE, ScreenFiles, Screens};
use super::simulation::SimView;
use super::start_guide::StartGuide;
use super::teach::TeachView;
use super::terminals::TerminalView;
use super::toolpath::StockBox;
use crate::defs::alarm_history::AlarmHistory;
use crate::defs::date::DateTime;
use crate::defs::fitted::Fitted;
use crate::defs::key::{Key, Mode};
use crate::defs::kind::Kind;
use crate::defs::leadscrew::LeadscrewCompensation;
use crate::defs::page::Page;
use crate::defs::param::{self, AccessLevel, Params};
use crate::defs::signal::{InputSet, OutputSet};
use crate::defs::soft_key::CoordinateView;
use crate::defs::text::{Lang, LocalizedText, Text};
use crate::defs::{program_kind, program_number};
use crate::units::{Axis, Micros, PerAxis};

/// Number of macro variables shown: #0 to #999.
pub const VARIABLE_COUNT: usize = 1_000;

/// The six run states shown (H7); stories distinguish the two kinds of hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum RunState {
    /// 停止: nothing runs.
    #[default]
    Idle,
    /// 运行: a program or an MDI line runs.
    Running,
    /// 暂停: feed hold.
    Held,
    /// 暂停: M00, M01 or the end of a single block.
    Stopped,
    /// 等待: M80–M89.
    Waiting,
    /// 回零: axes are homing.
    Homing,
    /// 报警: an alarm has stopped the machine.
    Alarm,
}

impl RunState {
    /// The id used in stories.
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            Self::Idle => "idle",
            Self::Running => "running",
            Self::Held => "held",
            Self::Stopped => "stopped",
            Self::Waiting => "waiting",
            Self::Homing => "homing",
            Self::Alarm => "alarm",
        }
    }

    /// A program or homing is in progress: the stop keys must stay within reach.
    #[must_use]
    pub const fn is_active(self) -> bool {
        matches!(self, Self::Running | Self::Waiting | Self::Homing)
    }

    /// The text of the status line.
    #[must_use]
    pub const fn name(self) -> Text {
        match self {
            Self::Idle => Text::new("停止", "IDLE"),
            Self::Running => Text::new("运行", "RUN"),
            Self::Held | Self::Stopped => Text::new("暂停", "HOLD"),
            Self::Waiting => Text::new("等待", "WAIT"),
            Self::Homing => Text::new("回零", "HOMING"),
            Self::Alarm => Text::new("报警", "ALARM"),
        }
    }
}

/// A motion that a key began and that goes on by itself; the run state does not speak of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OwnMotion {
    /// 振荡: an axis or the cylinder oscillates by its key.
    Oscillation,
    /// 回修整点: an axis returns to its dressing point.
    DressReturn,
    /// 回退: the one-key retract moves the wheel.
    Retract,
}

impl OwnMotion {
    /// The text of header and status line.
    #[must_use]
    pub const fn name(self) -> Text {
        match self {
            Self::Oscillation => Text::new("振荡", "OSCILL."),
            Self::DressReturn => Text::new("回修整点", "TO DRESS"),
            Self::Retract => Text::new("回退", "RETRACT"),
        }
    }
}

/// One axis as the position page shows it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisView {
    /// Whether the machine has the axis.
    pub present: bool,
    /// Work coordinate, from the encoder.
    pub work: f64,
    /// Machine coordinate, from the encoder.
    pub machine: f64,
    /// Relative coordinate.
    pub relative: f64,
    /// Distance to go in the block.
    pub to_go: f64,
    /// Homed since power-on.
    pub homed: bool,
    /// Moving now.
    pub moving: bool,
    /// Decimals of the coordinates (P22.2).
    pub decimals: usize,
}

/// The state of one key.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct KeyView {
    /// The lamp is on: the actual output or state, not the command.
    pub lamp: bool,
    /// The feedback is still missing; the lamp blinks.
    pub pending: bool,
    /// Why pressing the key now would be refused.
    pub blocked: Option<Text>,
}

/// One active alarm.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AlarmView {
    /// Number.
    pub number: u16,
    /// The alarm text, with its place.
    pub text: LocalizedText,
    /// The cause; empty where the text says it.
    pub cause: LocalizedText,
    /// The remedy.
    pub remedy: LocalizedText,
    /// The variable whose value is wrong, if the program says so (B8).
    pub variable: Option<u16>,
    /// When it was raised.
    pub since: Micros,
    /// Program and line that ran when it was raised; none outside a run.
    pub place: Option<(u32, u32)>,
}

/// The unlocked access level and the result of the last password.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AccessView {
    /// The unlocked level.
    pub level: AccessLevel,
    /// Programs may be edited: the program password was given (K6.2).
    pub program_unlocked: bool,
    /// The disk thread is checking a password.
    pub password_pending: bool,
    /// Number of answers so far; a page recognises a new answer by it.
    pub answer_count: u32,
    /// Why the last password was refused.
    pub refused: Option<Text>,
}

/// Severity of a message.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tone {
    /// Something was executed.
    #[default]
    Info,
    /// Something was executed or has happened, and the operator must know more.
    Warning,
    /// Something was refused, with the reason, or an alarm has come.
    Refused,
}

/// The message line.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Message {
    /// The text.
    pub text: LocalizedText,
    /// Severity.
    pub tone: Tone,
    /// When it was raised.
    pub since: Micros,
}

/// What the handwheel moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandwheelView {
    /// The axis.
    pub axis: Axis,
    /// Displayed way of a detent, and of a step in mode STEP, mm.
    pub step_mm: f64,
}

/// Overrides, percent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overrides {
    /// Feed.
    pub feed: u16,
    /// Rapid; 0 is P for F0.
    pub rapid: u16,
    /// Wheel speed.
    pub spindle: u16,
}

impl Default for Overrides {
    fn default() -> Self {
        Self { feed: 100, rapid: 100, spindle: 100 }
    }
}

/// Everything that a page can show.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// Machine kind.
    pub kind: Kind,
    /// Controller time.
    pub now: Micros,
    /// Mode.
    pub mode: Mode,
    /// State.
    pub state: RunState,
    /// What moves by itself.
    pub own_motion: Option<OwnMotion>,
    /// Open page.
    pub page: Page,
    /// Coordinates shown by the position page.
    pub coordinates: CoordinateView,
    /// Which row of soft keys is shown, from 0.
    pub soft_key_row: usize,
    /// Whether X is shown as a diameter.
    pub x_as_diameter: bool,
    /// State of the axes.
    pub axes: PerAxis<AxisView>,
    /// The current program.
    pub program: ProgramView,
    /// The handwheel.
    pub handwheel: HandwheelView,
    /// The overrides.
    pub overrides: Overrides,
    /// Speed along the path, mm/min.
    pub feed_mm_min: f64,
    /// Wheel speed commanded, rpm; on a lathe the actual speed of the main spindle.
    pub wheel_rpm: f64,
    /// Active station of the tool turret, 1 to 4, 0 if unknown; none on kinds without a turret (L8).
    pub tool_station: Option<u32>,
    /// The teach-in recording of manual moves (L9).
    pub teach: TeachView,
    /// Measured strokes per minute of the oscillating axis (K4.3).
    pub strokes_per_min: Option<f64>,
    /// Changed values are not on the disk yet, for longer than usual.
    pub is_storing: bool,
    /// Number of workpieces counted.
    pub parts_counted: u32,
    /// The running or last cycle.
    pub cycle: CycleView,
    /// Inputs, debounced, by function.
    pub inputs: InputSet,
    /// Outputs by function.
    pub outputs: OutputSet,
    /// State of every key, by `Key as usize`.
    pub keys: [KeyView; Key::COUNT],
    /// What is still missing for the next cycle start.
    pub start_guide: StartGuide,
    /// Macro variables at the current state of execution.
    pub variables: Box<[Option<f64>; VARIABLE_COUNT]>,
    /// The block at which cycle start would restart the program, with its modal state (B5).
    pub restart: Option<Box<RestartView>>,
    /// Program and line of the run that the last power cut ended; resume is offered after homing (B5).
    pub interrupted: Option<(u32, u32)>,
    /// Active alarms; the one that stopped the machine comes first.
    pub alarms: Vec<AlarmView>,
    /// The message line.
    pub message: Message,
    /// The message of the program (`MSG`), or what the run waits for.
    pub waiting_for: Option<LocalizedText>,
    /// Terminals and analog outputs.
    pub terminals: TerminalView,
    /// Internal signals of the control.
    pub internals: InternalSignalSet,
    /// Past alarms, also before the last power-off, newest last.
    pub alarm_history: AlarmHistory,
    /// Parts, hours and orders.
    pub production: ProductionView,
    /// Leadscrew tables of the axes (B7).
    pub leadscrews: PerAxis<LeadscrewCompensation>,
    /// Date and time of day; none if unknown.
    pub date: Option<DateTime>,
    /// The parameters; the `Arc` is replaced only when one changes.
    pub params: Arc<Params>,
    /// The simulated machine, if the machine is simulated.
    pub simulated: Option<Arc<SimView>>,
    /// The field bus, if the machine is a real one.
    pub bus: Option<Arc<BusView>>,
    /// What the core does not know: network services, demonstration.
    pub host: HostView,
    /// The scope.
    pub scope: ScopeView,
    /// Boxes of the workpiece and its fixture, as far as known.
    pub stock: Arc<[StockBox]>,
    /// Results of file requests and long calculations; the `Arc` is replaced only on a change.
    pub files: Arc<FilesView>,
    /// The unlocked access level.
    pub access: AccessView,
    /// Kind of machine from the next start on.
    pub next_kind: Kind,
    /// Earlier states that may take the place of lost data, the newest first; none unless data were lost.
    pub kept_states: Arc<[KeptState]>,
    /// Answer to the last value typed at a page.
    pub edit_answer: EditAnswer,
    /// Tool offsets and work offsets.
    pub offsets: OffsetTables,
    /// The active modal codes.
    pub modals: ModalView,
    /// The MDI line prepared for cycle start; empty if none.
    pub prepared_mdi: String,
    /// Dressing point of each axis, machine coordinates, where it is set (K4.2).
    pub dressing_point: PerAxis<Option<f64>>,
    /// Number of the page files of a kind with its own grinding page; none where each program has a page.
    pub kind_page: Option<u32>,
    /// Sheet of the grinding page, from 0, and the number of sheets.
    pub grinding_sheet: (usize, usize),
    /// Page files found on disk.
    pub screens: Arc<Screens>,
    /// Programs found on disk, by number.
    pub directory: Arc<Vec<DirectoryRow>>,
}

/// One program of the folder.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DirectoryRow {
    /// Its internal number.
    pub number: u32,
    /// Its title: `O1001`, or its name.
    pub name: String,
    /// Bytes.
    pub size: u64,
    /// Comment of its first line.
    pub comment: String,
    /// Its English title, if it gives one (H9).
    pub english: Option<String>,
    /// Date of the last change as shown, local time.
    pub modified: String,
    /// The kinds of machine that it is for; empty: every kind.
    pub kinds: Vec<Kind>,
}

impl DirectoryRow {
    /// Whether it is for a kind of machine.
    #[must_use]
    pub fn is_for(&self, kind: Kind) -> bool {
        program_kind::includes(&self.kinds, kind)
    }

    /// The title in a language: the comment, unless the program gives an English one.
    #[must_use]
    pub fn comment_in(&self, lang: Lang) -> &str {
        lang.pick_of(&self.comment, self.english.as_deref())
    }
}

impl Snapshot {
    /// The state that header and status line show: what moves by itself comes before stop, run and hold.
    #[must_use]
    pub const fn state_name(&self) -> Text {
        match (self.own_motion, self.state) {
            (Some(motion), RunState::Idle | RunState::Running | RunState::Held | RunState::Stopped) => motion.name(),
            _ => self.state.name(),
        }
    }

    /// The command of a pressed key. The emergency stop is a state: its key latches it, or turns it out if the screen
    /// shows it latched.
    #[must_use]
    pub fn press_command(&self, key: Key) -> Command {
        match key {
            Key::EmergencyStop => Command::EmergencyStop(!self.internals.has(InternalSignal::ScreenEmergencyStop)),
            key => Command::Press(key),
        }
    }

    /// The initial state, before the machine has been read.
    #[must_use]
    pub fn new(kind: Kind) -> Self {
        Self {
            kind,
            now: Micros::ZERO,
            mode: Mode::default(),
            state: RunState::default(),
            own_motion: None,
            page: Page::default(),
            coordinates: CoordinateView::default(),
            soft_key_row: 0,
            x_as_diameter: false,
            axes: PerAxis::default(),
            program: ProgramView::default(),
            handwheel: HandwheelView { axis: Axis::X, step_mm: 0.001 },
            overrides: Overrides::default(),
            feed_mm_min: 0.0,
            wheel_rpm: 0.0,
            tool_station: None,
            teach: TeachView::default(),
            strokes_per_min: None,
            is_storing: false,
            parts_counted: 0,
            cycle: CycleView::default(),
            inputs: InputSet::NONE,
            outputs: OutputSet::NONE,
            keys: [KeyView::default(); Key::COUNT],
            start_guide: StartGuide::default(),
            variables: Box::new([None; VARIABLE_COUNT]),
            restart: None,
            interrupted: None,
            alarms: Vec::new(),
            message: Message::default(),
            waiting_for: None,
            terminals: TerminalView::default(),
            internals: InternalSignalSet::default(),
            alarm_history: AlarmHistory::default(),
            production: ProductionView::default(),
            leadscrews: PerAxis::default(),
            date: None,
            params: Arc::new(Params::factory(kind)),
            simulated: None,
            bus: None,
            host: HostView::default(),
            scope: ScopeView::default(),
            stock: Arc::from([]),
            files: Arc::default(),
            access: AccessView::default(),
            next_kind: kind,
            kept_states: Arc::from([]),
            edit_answer: EditAnswer::default(),
            offsets: OffsetTables::default(),
            modals: ModalView::default(),
            prepared_mdi: String::new(),
            dressing_point: PerAxis::default(),
            kind_page: None,
            grinding_sheet: (0, 1),
            screens: Arc::default(),
            directory: Arc::default(),
        }
    }

    /// Clears inputs, outputs and lamps: the control has no power.
    pub fn clear_for_power_off(&mut self) {
        self.inputs = InputSet::NONE;
        self.outputs = OutputSet::NONE;
        for key in &mut self.keys {
            (key.lamp, key.pending) = (false, false);
        }
    }

    /// Whether grinding values, offsets and variables are locked: a run is open and P6.3 does not allow edits (K7.7).
    #[must_use]
    pub fn values_locked(&self) -> bool {
        self.program.is_open && !self.params.bit(param::EDIT_VALUES_IN_RUN)
    }

    /// Number of the page files of the grinding page; none if the current program has no page (K7.2).
    #[must_use]
    pub fn grinding_page_number(&self) -> Option<u32> {
        self.kind_page.or_else(|| PROGRAMS_WITH_PAGE.contains(&self.program.number).then_some(self.program.number))
    }

    /// The files of the grinding page.
    #[must_use]
    pub fn page_files(&self) -> Option<&ScreenFiles> {
        self.screens.find(self.grinding_page_number()?)
    }

    /// What the machine is fitted with.
    #[must_use]
    pub fn fitted(&self) -> Fitted {
        Fitted { kind: self.kind, ..self.params.fitted() }
    }

    /// Surface speed of the wheel as it turns now, m/s.
    #[must_use]
    pub fn wheel_rim_m_s(&self) -> f64 {
        std::f64::consts::PI * self.params.get(param::WHEEL_DIAMETER) * self.wheel_rpm / 60_000.0
    }

    /// Load of the wheel's motor in percent of the rated one, as the simulated machine or the inverter says it.
    #[must_use]
    pub fn wheel_load_percent(&self) -> Option<f64> {
        let simulated = self.simulated.as_ref().map(|sim| sim.wheel_load_percent);
        simulated.or_else(|| self.bus.as_ref()?.inverter.as_ref()?.load_percent)
    }

    /// The values that the sizes of the part are taken from, as they are now.
    #[must_use]
    pub fn size_values(&self) -> SizeValues<'_, impl Fn(u16) -> Option<f64>> {
        let files = self.screens.find(self.program.number);
        let page = files.and_then(|files| files.text.as_deref().ok());
        let variable = |variable: u16| self.variables.get(usize::from(variable)).copied().flatten();
        SizeValues { params: &self.params, page, variable }
    }

    /// Numbers of the dressing programs (P91, P92).
    #[must_use]
    pub fn dressing_programs(&self) -> RangeInclusive<u32> {
        let number = |of| self.params.get(of) as u32;
        number(param::DRESSING_PROGRAM_FIRST)..=number(param::DRESSING_PROGRAM_LAST)
    }

    /// Parts between two dressings, as set by P95 or by the page of the current program.
    #[must_use]
    pub fn dressing_interval(&self) -> Option<f64> {
        self.size_values().dressing_interval()
    }

    /// The title of a program.
    #[must_use]
    pub fn title(&self, program: u32) -> String {
        let row = self.directory.iter().find(|row| row.number == program);
        row.map_or_else(|| program_number::name_of(program), |row| row.name.clone())
    }

    /// The state of a key.
    #[must_use]
    pub const fn key(&self, key: Key) -> KeyView {
        self.keys[key as usize]
    }
}
