//! The program: the open run, its start and end, retract, restart and MDI.
//! Source: spec B3, B5, K3.14.

mod actions;
mod activity;
mod cycle;
mod executor;
mod gauge;
mod hold;
mod lathe;
pub mod library;
pub mod lookahead_state;
mod mdi;
pub mod move_refusal;
mod power_fail;
mod preflight;
pub mod queue;
pub mod restart;
pub mod retract;
pub mod run;
mod run_world;
mod signal_place;
pub mod start_check;

use std::sync::Arc;

use activity::Activity;
use lookahead_state::LookaheadState;
use preflight::preflight_world;
use run::{Origin, PreflightStart, ProgramRun, RunPool, RunStart};
use start_check::StartVerdict;

use super::plant::system_variables::nc_settings;
use super::plant::{ControlEvent, ControlPhase, Plant, ProgramControls};
use crate::controller::axes::oscillation::Oscillation;
use crate::defs::kind::Kind;
use crate::defs::text::arg::Arg;
use crate::defs::text::{LocalizedText, Template, Text, phrase};
use crate::link::snapshot::OwnMotion;
use crate::nc::{self, ModalState, Source, VariableError, WorkOffsets};
use crate::units::{Axis, Micros, PerAxis};

/// The program part.
pub struct Program {
    /// The open run.
    run: Option<Box<ProgramRun>>,
    /// Runs that are not open.
    pool: RunPool,
    /// The one-key retract and the run that it suspends.
    pub retract: retract::Retract,
    /// The texts that call O9000 and O9001.
    retract_calls: [Option<Arc<Source>>; 2],
    /// A restart in preparation.
    pub restart: Option<restart::Restart>,
    /// Position of the run for a power failure.
    pub power_cut: restart::PowerCutPosition,
    /// What the wheel does when the supply fails.
    power_fail: power_fail::PowerFailRetract,
    /// Modal state kept from one MDI line to the next.
    mdi_modals: Option<ModalState>,
    /// The MDI line.
    pub mdi: mdi::MdiLine,
    /// Whether the chosen program accepts its values.
    start_check: start_check::StartCheck,
}

impl Program {
    /// At power-on nothing runs.
    #[must_use]
    pub fn new(kind: Kind, interrupted: Option<(u32, u32)>) -> Self {
        Self {
            run: None,
            pool: RunPool::new(),
            retract: retract::Retract::default(),
            retract_calls: retract::retract_calls(kind.row().dialect),
            restart: None,
            power_cut: restart::PowerCutPosition::new(interrupted),
            power_fail: power_fail::PowerFailRetract::default(),
            mdi_modals: None,
            mdi: mdi::MdiLine::new(kind.row().dialect),
            start_check: start_check::StartCheck::default(),
        }
    }

    /// Start time of the open run.
    #[must_use]
    pub fn started_at(&self) -> Option<Micros> {
        self.run.as_ref().map(|run| run.started_at)
    }

    /// Changes the work offsets that the open run has read ahead.
    pub fn change_offsets_read_ahead(&mut self, change: impl Fn(&mut WorkOffsets)) {
        if let Some(run) = &mut self.run {
            change(&mut run.lookahead.work_offsets);
        }
    }

    /// Whether a run is open.
    #[must_use]
    pub const fn is_open(&self) -> bool {
        self.run.is_some()
    }

    /// What the chosen program says of its values (B8).
    #[must_use]
    pub fn start_verdict(&self, plant: &Plant) -> &StartVerdict {
        self.start_check.verdict_of(plant.execution.current_program)
    }

    /// One tick of the check of the chosen program; while something runs there is none.
    pub fn step_start_check(&mut self, plant: &mut Plant) {
        match plant.execution.phase {
            ControlPhase::Idle if self.run.is_none() && self.restart.is_none() => {
                self.start_check.step(&mut self.pool, plant);
            }
            _ => self.start_check.abandon(&mut self.pool),
        }
    }

    /// The programs are replaced: the check begins anew.
    pub fn forget_start_check(&mut self) {
        self.start_check.forget(&mut self.pool);
    }

    /// Whether the open run is that of the current program, not an MDI line or a retract.
    #[must_use]
    pub fn runs_program(&self) -> bool {
        self.run.as_ref().is_some_and(|run| run.origin == Origin::Program)
    }

    /// Opens a run of the text and starts it.
    pub fn open_run(&mut self, plant: &mut Plant, source: Arc<Source>, origin: Origin) {
        self.start_check.abandon(&mut self.pool);
        let settings = nc_settings(plant.kind, &plant.params);
        let numbered = settings.needs_block_numbers && origin != Origin::Mdi;
        let (axes, runs_once) = (plant.axes.fitted(), plant.execution.runs_once);
        let settings = nc::NcSettings { axes, needs_block_numbers: numbered, runs_once, ..settings };
        // A program starts from the power-on modal state; MDI continues from its last line.
        plant.clear_program_message(origin == Origin::Mdi);
        let kept = self.mdi_modals.take().filter(|_| origin == Origin::Mdi);
        let modals = kept.unwrap_or_else(|| ModalState::new(&settings));
        let before = (plant.work.offsets.clone(), plant.work.tool_change_point);
        plant.work.offsets.activate(modals.work_offset);
        if origin != Origin::Mdi {
            // A program begins without a local zero (G52).
            plant.work.offsets.local = PerAxis::default();
        }
        if settings.start_is_work_zero {
            plant.start_lathe_program(origin == Origin::Program);
        }
        if settings.start_is_work_zero && origin == Origin::Program {
            // L3: at program start, work zero, reference point and start point coincide.
            plant.work.offsets.set_coordinates(plant.axes.set_point(), &PerAxis([Some(0.0), None, Some(0.0)]));
        }
        let (offsets, at) = (plant.work.offsets.clone(), plant.axes.set_point());
        let mut lookahead = LookaheadState::new(offsets, at, plant.work.dress_points, modals.path_mode);
        lookahead.oscillating = plant.oscillating_axis();
        lookahead.soft_limits_active = plant.axes.all_homed();
        lookahead.homed = lookahead.soft_limits_active || plant.kind.row().may_start_unhomed();
        lookahead.dialect = plant.kind.row().dialect;
        let checked = origin == Origin::Program && nc::ProgramPreflight::is_supported(settings.dialect);
        let preflight = checked.then(|| PreflightStart { world: preflight_world(plant, &settings), before });
        let program: (_, nc::SharedLibrary) = (source, Arc::clone(&plant.work.programs) as _);
        let memory = &plant.work.variables;
        let start = RunStart { program, settings, modals, memory, lookahead, preflight };
        let mut run = self.pool.open(start, plant.now);
        run.origin = origin;
        if origin == Origin::Program {
            (plant.execution.part_finished, plant.execution.finished_cycle) = (false, None);
            plant.work.program_start = Some((plant.execution.current_program, at));
        }
        if origin != Origin::Retract {
            plant.execution.begin_cycle(plant.work.offsets.tool_offset);
        }
        // The planner keeps the tag of the last finished move across runs.
        run.next_tag = plant.axes.planner.finished_tag().map_or(1, |tag| tag + 1);
        self.run = Some(run);
        plant.transition(ControlEvent::Start);
    }

    /// One tick of the run.
    pub fn step_run(&mut self, plant: &mut Plant) {
        let Some(run) = &mut self.run else { return };
        let needs_axes = matches!(plant.execution.phase, ControlPhase::Running) && run.activity != Activity::Homing;
        if needs_axes && !run.return_axes_to_run(plant) {
            return;
        }
        run.extend_dwell(plant);
        self.retract.extend_dwell(plant.axes.tick_time());
        if !run.step(plant, self.retract.suspended_run()) {
            return;
        }
        match run.origin {
            Origin::Retract => self.finish_retract(plant),
            origin @ (Origin::Program | Origin::Mdi) => {
                self.close_run(plant);
                plant.transition(ControlEvent::Finish);
                if origin == Origin::Program {
                    plant.execution.is_completed = true;
                    self.repeat_program(plant);
                }
            }
        }
    }

    /// Handles the end of braking and the drive state.
    pub fn finish_braking(&mut self, plant: &mut Plant) {
        let rest = plant.has_braked();
        if rest && matches!(plant.execution.phase, ControlPhase::Holding | ControlPhase::Aborting) {
            if matches!(plant.execution.phase, ControlPhase::Aborting) {
                if self.withdraws_at_power_fail(plant) {
                    return;
                }
                self.close_run(plant);
                self.abandon_retract(plant);
            }
            let held = matches!(plant.execution.phase, ControlPhase::Holding);
            plant.transition(ControlEvent::AtRest);
            if held && !self.retract_if_requested(plant) {
                self.withdraw_wheel(plant);
            }
        }
        if !plant.drives_follow() && rest {
            plant.axes.unlock();
            plant.axes.follow_actual(plant.axes_without_drive());
        }
    }

    /// Closes the run and discards items not yet executed.
    pub fn close_run(&mut self, plant: &mut Plant) {
        if let Some(run) = self.run.take() {
            if run.origin == Origin::Program {
                plant.note_end_of(&run.interpreter);
                // The local zero (G52) ends with its program: later measurements must not contain it.
                plant.work.offsets.local = PerAxis::default();
                self.clear_run_position(plant);
            }
            if run.origin != Origin::Retract {
                plant.work.program_controls = ProgramControls::default();
                plant.end_cycle(plant.now.since(run.started_at));
                self.mdi_modals = (run.origin == Origin::Mdi).then(|| *run.interpreter.modals());
            }
            self.pool.close(run);
            plant.leave_subprogram();
        }
        plant.axes.homing = None;
        plant.axes.switch_to_manual();
    }

    /// Sets a common variable. False: refused, with the reason shown.
    pub fn set_variable(&mut self, plant: &mut Plant, variable: u16, value: Option<f64>) -> bool {
        let number = u32::from(variable);
        if let Err(error) = plant.store_variable(number, value) {
            plant.refuse(variable_refusal(error, plant.kind));
            return false;
        }
        // A run suspended by the retract has its own copy.
        if let Some(waiting) = self.retract.suspended_run() {
            let _ = waiting.interpreter.update_variable(number, value);
        }
        if let Some(run) = &mut self.run
            && run.interpreter.update_variable(number, value).is_err()
        {
            plant.refuse(phrase!("程序没有接受此值", "the running program did not accept the value"));
            return false;
        }
        true
    }

    /// Distance to go, mm displayed: of the present block, of a step, of a stroke of the oscillation.
    pub fn distance_to_go(&self, plant: &Plant) -> PerAxis<f64> {
        let block = if self.run.is_some() { plant.axes.planner.distance_to_go() } else { PerAxis::default() };
        PerAxis::from_fn(|axis: Axis| {
            let stroke = plant.oscillation.as_ref().filter(|oscillation| oscillation.axis == axis);
            let own = plant.jog.target(axis).map(|target| target - plant.axes.set_point()[axis]);
            stroke.map(Oscillation::way_to_end).or(own).unwrap_or(block[axis]) * plant.displayed_per_mm(axis)
        })
    }

    /// What moves by itself while the run state does not speak of it.
    pub fn own_motion(&self, plant: &Plant) -> Option<OwnMotion> {
        if self.retract.is_moving() {
            Some(OwnMotion::Retract)
        } else if plant.jog.moves_to_point() {
            Some(OwnMotion::DressReturn)
        } else {
            let running = matches!(plant.execution.phase, ControlPhase::Running);
            // M30 and the end of an MDI line do not end what G35 has begun.
            let unowned = plant.is_oscillating() && !plant.execution.phase.is_run_open();
            ((plant.oscillates_by_key() || unowned) && !running).then_some(OwnMotion::Oscillation)
        }
    }

    /// Whether the run waits for an input (M80–M89).
    pub fn is_awaiting_input(&self) -> bool {
        self.run.as_ref().is_some_and(|run| matches!(run.activity, Activity::AwaitInput(_)))
    }

    /// What the run waits for, in words: cycle start after M00, M01 and #3006, an input (M80–M89).
    pub fn awaited_event(&self, plant: &Plant) -> Option<LocalizedText> {
        if matches!(plant.execution.phase, ControlPhase::Stopped) {
            return plant.execution.stop_reason.clone();
        }
        match self.run.as_ref()?.activity {
            Activity::AwaitInput(input) if !matches!(plant.execution.phase, ControlPhase::Aborting) => {
                Some(actions::awaited_input_text(input, plant.params.input_port(input)))
            }
            Activity::AwaitInput(_)
            | Activity::Idle
            | Activity::Settling { .. }
            | Activity::AwaitUnit
            | Activity::Dwell { .. }
            | Activity::Skip { .. }
            | Activity::Gauge(_)
            | Activity::Thread
            | Activity::Homing => None,
        }
    }
}

const UNKNOWN_VARIABLE: Text = Text::new("{name} 不存在或不能修改", "there is no common variable #{number}");
const SWITCH_VARIABLE: Text = Text::new("{name} 只能输入 0 或 1", "variable #{number} must be 0 or 1");
const NOT_A_NUMBER: Text = Text::new("{name} 的值不是数字", "the value for #{number} is not a number");

/// Why a common variable was not set. English names it by its number, Chinese by its name on the machine.
fn variable_refusal(error: VariableError, kind: Kind) -> LocalizedText {
    const NAMES: &[&str] = &["name", "number"];
    let (template, number) = match error {
        VariableError::Unknown(number) => (&Template { text: UNKNOWN_VARIABLE, names: NAMES }, number),
        VariableError::Switch(number) => (&Template { text: SWITCH_VARIABLE, names: NAMES }, number),
        VariableError::NotFinite(number) => (&Template { text: NOT_A_NUMBER, names: NAMES }, number),
    };
    LocalizedText::phrase(template, [Arg::Variable(number, kind.dialect()), number.into()])
}
