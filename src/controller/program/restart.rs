//! Program restart from a selected block, and resuming after a power failure.
//!
//! The blocks before it are read without motion. The resulting modal codes, work offset, tool offset, variables and
//! axis positions are shown first. Nothing starts automatically: a wheel or workpiece that would turn there must be
//! started by key. Cycle start then moves the axes to the position, the wheel axis last, and runs from the block.
//! Source: spec B5.

use std::sync::Arc;

use super::Program;
use super::lookahead_state::{LookaheadState, reference_points};
use super::mdi::modal_view_of;
use super::preflight::preflight_world;
use super::queue::{PlannedMove, ProgrammedFeed, QueueItem, check_soft_limits};
use super::run::{Origin, PreflightStart, ProgramRun, RunStart};
use crate::controller::plant::system_variables::{PARAM_VARIABLES, nc_settings};
use crate::controller::plant::{ControlEvent, ControlPhase, Plant, WORK_PER_TICK};
use crate::controller::storage_request::StorageRequest;
use crate::defs::key::Mode;
use crate::defs::kind::Dialect;
use crate::defs::mcode::SwitchedUnit;
use crate::defs::param;
use crate::defs::system_variable;
use crate::defs::text::arg::Arg;
use crate::defs::text::{LocalizedText, Text, phrase};
use crate::link::edit::ModalView;
use crate::link::restart_view::RestartView;
use crate::motion::MoveShape;
use crate::nc::{
    self, AxisSet, CommonVariables, ExternalState, ModalState, NextStatus, OfflineMachine, Op, OpEffect, OpMotion,
    OriginPlace, OscillationChange, ProgramMessage, SpeedMode,
};
use crate::units::{Axis, Micros, PerAxis, WorkBudget};

/// Maximum ticks for reading the blocks before: about two million blocks. A loop that waits for the machine never ends.
const MAX_SEARCH_TICKS: u32 = 3_000;
/// The last common variable.
const LAST_VARIABLE: u32 = 999;
/// Minimum interval between two records of the run position for a power failure.
const STORE_INTERVAL: Micros = Micros::from_millis(1_000);

const NO_PROGRAM: Text = Text::new("没有当前程序：先在目录中选择", "no current program: choose one in the directory");
const WHEEL_FIRST: Text = Text::new(
    "该段之前已启动砂轮：先按砂轮启动，再循环启动",
    "the wheel is on at this block: start it with its key before cycle start",
);
const DRIVE_FIRST: Text = Text::new(
    "该段之前工件已转动：先启动，再循环启动",
    "the workpiece turns at this block: start it with its key before cycle start",
);

const START_BOTH: Text = Text::new("先启动 砂轮 工件；", "start wheel and workpiece first; ");
const START_WHEEL: Text = Text::new("先启动 砂轮；", "start the wheel first; ");
const START_WORKPIECE: Text = Text::new("先启动 工件；", "start the workpiece first; ");
const START_NOTHING: Text = Text::new("", "");

/// Machine state that the blocks before the selected one produce.
#[derive(Clone, Debug, Default)]
struct StateBeforeBlock {
    wheel: bool,
    drive: bool,
    coolant: bool,
    /// An axis oscillates at the block.
    oscillates: bool,
    /// G50, G27, G31 or G78 is among them: the resulting position cannot be computed.
    position_unknown: bool,
    /// Axes whose place the blocks have named; those that they have only moved by increments hang on the start.
    placed: AxisSet,
    moved: AxisSet,
    /// First alarm raised by the program before the block.
    alarm: Option<LocalizedText>,
    /// The last S, and the limit of G50 S, rpm.
    speed: Option<(f64, SpeedMode)>,
    rpm_limit: Option<f64>,
    /// S of the last M63 or M64, rpm.
    drive_rpm: f64,
}

impl StateBeforeBlock {
    fn apply(&mut self, op: &Op, dialect: Dialect) {
        let effect = op.effect();
        self.position_unknown |= !effect.leaves_position_known();
        self.note_places(&effect);
        match effect {
            OpEffect::MCode(words) => match words.switched_unit(dialect) {
                Some((SwitchedUnit::Wheel, on)) => self.wheel = on,
                Some((SwitchedUnit::WorkDrive, on)) => {
                    (self.drive, self.drive_rpm) = (on, words.s.unwrap_or(0.0));
                }
                Some((SwitchedUnit::Coolant, on)) => self.coolant = on,
                None => {}
            },
            OpEffect::Oscillation(change) => self.oscillates = change != OscillationChange::Off,
            OpEffect::Message(ProgramMessage::Alarm(_, text)) => {
                self.alarm.get_or_insert_with(|| LocalizedText::of_program(text));
            }
            OpEffect::Speed(value, mode) => self.speed = Some((value, mode)),
            OpEffect::SpeedLimit(rpm) => self.rpm_limit = Some(rpm),
            // The check world has the position, the offsets and the variables; the interpreter has the path mode.
            OpEffect::Motion(_) | OpEffect::Coordinates(_) | OpEffect::IndexTurret { .. } => {}
            OpEffect::PathMode(_) | OpEffect::Variable(..) | OpEffect::SystemVariable(..) => {}
            OpEffect::Dwell(_)
            | OpEffect::Message(ProgramMessage::Stop(..) | ProgramMessage::Show(_) | ProgramMessage::Print(_)) => {}
        }
    }

    /// Notes which axes a move has placed, and which it has moved.
    fn note_places(&mut self, effect: &OpEffect<'_>) {
        let OpEffect::Motion(motion) = effect else { return };
        let increments = if let OpMotion::Work(by) = motion { by.incremental } else { AxisSet::NONE };
        for axis in motion.named_axes().iter() {
            self.moved.insert(axis);
            if !increments.contains(axis) {
                self.placed.insert(axis);
            }
        }
    }

    /// An axis that the blocks have only moved by increments.
    fn unplaced(&self) -> Option<Axis> {
        self.moved.iter().find(|axis| !self.placed.contains(*axis))
    }
}

/// A restart in preparation.
pub struct Restart {
    /// The place of the program's start is known: it was started since power-on.
    start_is_known: bool,
    line: u32,
    run: Box<ProgramRun>,
    world: OfflineMachine,
    state: StateBeforeBlock,
    ticks: u32,
    /// The selected block has been reached.
    block_found: bool,
}

enum SearchStatus {
    Searching,
    Found,
}

/// Refuses a block that the contour before it decides.
fn can_start_here(interpreter: &nc::Interpreter, line: u32) -> Result<(), LocalizedText> {
    if interpreter.is_in_compensation() {
        return Err(phrase!(
            "第 {line} 行处在半径补偿 (G41、G42) 中，不能从该行开始：请选 G41、G42 段或 G40 之后的段",
            "line {line} is between G41 or G42 and G40: the program cannot start there, choose the block of G41 or G42, or one behind G40",
            line
        ));
    }
    if interpreter.is_in_corner() {
        return Err(phrase!(
            "第 {line} 行的起点在倒角或倒圆角处，不能从该行开始：请选前一段",
            "line {line} begins at a chamfer or rounding: the program cannot start there, choose the block before it",
            line
        ));
    }
    Ok(())
}

impl Restart {
    /// Reads on for a tick.
    fn search(&mut self, dialect: Dialect, budget: &mut WorkBudget) -> Result<SearchStatus, LocalizedText> {
        let Self { line, run, world, state, .. } = self;
        let line = *line;
        let mut advanced = NextStatus::Busy;
        while advanced == NextStatus::Busy && !budget.is_spent() {
            let read = run.interpreter.read_towards(line, world, &mut run.block, budget);
            advanced = read.map_err(|fault| fault.phrase())?;
            run.block.ops.iter().for_each(|op| state.apply(op, dialect));
        }
        match advanced {
            NextStatus::Block => {}
            NextStatus::End | NextStatus::Drain => {
                return Err(phrase!(
                    "程序运行不到第 {line} 行，不能从该行开始",
                    "the program does not reach line {line}: it cannot start there",
                    line
                ));
            }
            NextStatus::Busy | NextStatus::Waiting if self.ticks < MAX_SEARCH_TICKS => {
                self.ticks += 1;
                return Ok(SearchStatus::Searching);
            }
            NextStatus::Busy | NextStatus::Waiting => {
                return Err(phrase!(
                    "第 {line} 行之前有等待机床的循环，不能从该行开始",
                    "a loop before line {line} waits for the machine: the program cannot start there",
                    line
                ));
            }
        }
        if let Some(alarm) = state.alarm.take() {
            return Err(alarm);
        }
        if state.position_unknown {
            return Err(phrase!(
                "第 {line} 行之前有 G50、G27、G31 或 G78，位置算不出，不能从该行开始",
                "G50, G27, G31 or G78 before line {line}: the position there is not known, the program cannot start there",
                line
            ));
        }
        if let Some(axis) = state.unplaced().filter(|_| !self.start_is_known) {
            return Err(phrase!(
                "第 {line} 行之前 {axis} 只有增量移动，起点不知道，不能从该行开始：从头启动",
                "before line {line} {axis} moves by increments alone, and the start is not known: start the program at its head",
                line,
                axis
            ));
        }
        can_start_here(&run.interpreter, line)?;
        if state.oscillates {
            return Err(phrase!(
                "第 {line} 行处在振荡 (G35)，不能从该行开始",
                "an axis oscillates (G35) at line {line}: the program cannot start there",
                line
            ));
        }
        self.block_found = true;
        Ok(SearchStatus::Found)
    }

    /// Whether origins and tool post are those of the block.
    fn check_machine(&self, plant: &Plant) -> Result<(), LocalizedText> {
        let there = self.world.work_offsets();
        // The interrupted run has done it already, and an increment must not be added twice.
        let is_other = |place: &OriginPlace| there.origin(*place) != plant.work.offsets.origin(*place);
        if let Some(place) = (0..OriginPlace::COUNT).filter_map(OriginPlace::at).find(is_other) {
            let number = place.first_variable();
            return Err(phrase!(
                "该行之前的程序段改变工件原点 (#{number})：从头启动，或先使原点与该段一致",
                "blocks before change a work origin (#{number}): start the program at its head, or set the origin as they do",
                number
            ));
        }
        let station = plant.turret_station().map(u32::from).filter(|_| there.tool > 0);
        match station.is_some_and(|station| station != there.tool) {
            true => Err(phrase!(
                "该行需要 {tool} 号刀：先用刀架键换到 {tool} 号，再选择该行",
                "this line needs tool {tool}: turn the tool post to it with its key, then choose the line again",
                tool = there.tool
            )),
            false => Ok(()),
        }
    }

    /// What the message line says when the block is found. The program page shows all of its state.
    fn found_note(&self, plant: &Plant) -> LocalizedText {
        let (program, line, state) = (plant.execution.current_program, self.line, &self.state);
        let first = match (state.wheel, state.drive) {
            (true, true) => &START_BOTH,
            (true, false) => &START_WHEEL,
            (false, true) => &START_WORKPIECE,
            (false, false) => &START_NOTHING,
        };
        let work = self.world.work_position();
        let [x, y, z] = Axis::ALL.map(|axis| match plant.axes.is_present(axis) {
            true => Arg::from(format_args!("{axis}{:.3} ", work[axis] * plant.displayed_per_mm(axis))),
            false => Arg::None,
        });
        phrase!(
            "O{program:04} 第{line}行：起点 {x}{y}{z}；{first}循环启动",
            "O{program:04} line {line}: from {x}{y}{z}; {first}cycle start",
            program,
            line,
            x,
            y,
            z,
            first
        )
    }
}

/// Position of the run for a power failure.
#[derive(Clone, Copy, Debug, Default)]
pub struct PowerCutPosition {
    /// Program and line (from 1) of a run interrupted before this power-on.
    pub interrupted: Option<(u32, u32)>,
    /// Line of the present run last stored on disk, and when.
    stored: Option<(u32, Micros)>,
    /// The control or its supply ends the open run: the record stays.
    is_kept: bool,
}

impl PowerCutPosition {
    /// Starts from the record of the last power-on.
    pub const fn new(interrupted: Option<(u32, u32)>) -> Self {
        Self { interrupted, stored: None, is_kept: false }
    }
}

impl Program {
    /// At power-on: shows the program that was interrupted.
    pub fn announce_interrupted(&self, plant: &mut Plant) {
        if let Some((program, line)) = self.power_cut.interrupted {
            plant.show_note(phrase!(
                "O{program:04} 在第 {line} 行断电中断：回零后可从该段继续（程序页）",
                "O{program:04} was interrupted at line {line}: home the axes, then continue from there (program page)",
                program,
                line
            ));
        }
    }

    /// Starts reading the current program up to a line (from 1), to run it from there.
    pub fn restart_at(&mut self, plant: &mut Plant, line: u32) {
        self.abandon_restart();
        if let Some(why) = self.restart_refused(plant) {
            return plant.refuse(why);
        }
        let Some(program) = plant.work.programs.get(plant.execution.current_program) else {
            return plant.refuse(NO_PROGRAM);
        };
        if line == 0 || line as usize > program.source.line_count() {
            return plant.refuse(phrase!(
                "O{program:04} 没有第 {line} 行",
                "O{program:04} has no line {line}",
                program = plant.execution.current_program,
                line
            ));
        }
        let started = plant.work.start_of(plant.execution.current_program);
        let source = Arc::clone(&program.source);
        let settings = nc::NcSettings { axes: plant.axes.fitted(), ..nc_settings(plant.kind, &plant.params) };
        let modals = ModalState::new(&settings);
        let mut offsets = plant.work.offsets.clone();
        offsets.activate(modals.work_offset);
        offsets.local = PerAxis::default();
        let world = OfflineMachine::new(&settings)
            .with_references(reference_points(&plant.params))
            .with_work_offsets(offsets.clone())
            .with_position(offsets.work_from_machine(started.unwrap_or(plant.axes.set_point())))
            .with_block_skip(plant.operator.switches.block_skip)
            .with_system_variables(std::mem::take(&mut self.pool.search_memory))
            .with_known_values_only();
        let world = copy_system_variables(plant, world);
        let lookahead = LookaheadState::new(offsets, plant.axes.set_point(), plant.work.dress_points, modals.path_mode);
        let before = (plant.work.offsets.clone(), plant.work.tool_change_point);
        let checked = nc::ProgramPreflight::is_supported(settings.dialect);
        let preflight = checked.then(|| PreflightStart { world: preflight_world(plant, &settings), before });
        let program: (_, nc::SharedLibrary) = (source, Arc::clone(&plant.work.programs) as _);
        let memory = &plant.work.variables;
        let start = RunStart { program, settings, modals, memory, lookahead, preflight };
        let run = self.pool.open(start, plant.now);
        let switched = StateBeforeBlock::default();
        let start_is_known = started.is_some();
        self.restart =
            Some(Restart { start_is_known, line, run, world, state: switched, ticks: 0, block_found: false });
        plant.show_note(phrase!("正在查找第 {line} 行…", "searching for line {line} …", line));
    }

    /// Drops the restart in preparation.
    pub fn abandon_restart(&mut self) {
        if let Some(Restart { run, world, .. }) = self.restart.take() {
            self.pool.close(run);
            self.pool.search_memory = world.into_system_variables();
        }
    }

    fn restart_refused(&self, plant: &Plant) -> Option<Text> {
        if self.run.is_some() || !matches!(plant.execution.phase, ControlPhase::Idle) {
            return Some(crate::machine::panel_key::NOT_IN_RUN);
        }
        if plant.operator.mode != Mode::Auto {
            return Some(Text::new("自动方式下才能选择起始段", "choose a block in mode AUTO"));
        }
        if !plant.axes.all_homed() {
            return Some(Text::new("先回零，再选择起始段", "home the axes before choosing a block"));
        }
        // L3: without G92 the work zero is where the program was started.
        let starts_at_zero = nc_settings(plant.kind, &plant.params).start_is_work_zero;
        let is_started = plant.work.start_of(plant.execution.current_program).is_some();
        (starts_at_zero && !is_started).then_some(Text::new(
            "通电后没有启动过该程序，起点不知道：从头启动",
            "the program was not started since power-on and its start point is not known: start it at its head",
        ))
    }

    /// One tick of the search; shows the result.
    pub fn step_restart(&mut self, plant: &mut Plant) {
        // A retract that was begun meanwhile reads its program first.
        let waits = self.run.is_some();
        let Some(restart) = self.restart.as_mut().filter(|restart| !restart.block_found && !waits) else { return };
        // No program runs: the search may take the share of the planner, too.
        let mut budget = plant.tick_budget.share(WORK_PER_TICK);
        let found = restart.search(plant.kind.row().dialect, &mut budget);
        plant.charge_reading(budget);
        match found {
            Ok(SearchStatus::Searching) => {}
            Ok(SearchStatus::Found) => match restart.check_machine(plant) {
                Ok(()) => {
                    plant.show_note(restart.found_note(plant));
                    self.finish_search(plant);
                }
                Err(why) => {
                    self.abandon_restart();
                    plant.refuse(why);
                }
            },
            Err(why) => {
                self.abandon_restart();
                plant.refuse(why);
            }
        }
    }

    /// Sets the run to the state at the block that was found.
    fn finish_search(&mut self, plant: &Plant) {
        let Some(Restart { run, world, .. }) = self.restart.as_mut() else { return };
        let mut offsets = plant.work.offsets.clone();
        let there = world.work_offsets();
        (offsets.active, offsets.tool, offsets.tool_offset) = (there.active, there.tool, there.tool_offset);
        // The compensation of the tools on a post (L8) is part of the shift.
        (offsets.local, offsets.shift) = (there.local, there.shift);
        run.lookahead = LookaheadState::new(
            offsets.clone(),
            offsets.machine_from_work(world.work_position()),
            plant.work.dress_points,
            run.interpreter.modals().path_mode,
        );
        run.block.modals = *run.interpreter.modals();
    }

    /// The view for the program page before the start.
    pub fn restart_view(&self, plant: &Plant) -> Option<RestartView> {
        let restart = self.restart.as_ref().filter(|restart| restart.block_found)?;
        let work = restart.world.work_position();
        let StateBeforeBlock { wheel, drive, coolant, .. } = restart.state.clone();
        Some(RestartView {
            program: plant.execution.current_program,
            line: restart.line,
            modals: self.restart_modals(plant)?,
            start: PerAxis::from_fn(|axis| {
                plant.axes.is_present(axis).then(|| work[axis] * plant.displayed_per_mm(axis))
            }),
            wheel_turns: wheel,
            workpiece_turns: drive,
            coolant_on: coolant,
        })
    }

    /// The modal codes at the selected block.
    pub fn restart_modals(&self, plant: &Plant) -> Option<ModalView> {
        let restart = self.restart.as_ref().filter(|restart| restart.block_found)?;
        Some(modal_view_of(plant, &restart.run.block.modals))
    }

    /// Cycle start with a selected block. True: the restart was started or refused.
    pub fn start_restart(&mut self, plant: &mut Plant) -> bool {
        let Some(restart) = self.restart.as_ref() else { return false };
        let [wheel, drive] = plant.running_spindles();
        if !restart.block_found {
            plant.refuse(phrase!("正在查找起始段，请稍候", "still searching for the block"));
        } else if restart.state.wheel
            && !wheel
            && !plant.operator.switches.dry_run
            && !plant.operator.switches.aux_function_lock
        {
            plant.refuse(WHEEL_FIRST);
        } else if restart.state.drive && !drive && !plant.operator.switches.aux_function_lock {
            plant.refuse(DRIVE_FIRST);
        } else if let Some(restart) = self.restart.take() {
            self.start_at_block(plant, restart);
        }
        true
    }

    fn start_at_block(&mut self, plant: &mut Plant, Restart { mut run, world, state: switched, .. }: Restart) {
        let (from, to, wheel_axis) =
            (plant.axes.set_point(), run.lookahead.machine_position, plant.kind.row().wheel_axis);
        let mut beside = to;
        beside[wheel_axis] = from[wheel_axis];
        let tool_change_point = run.lookahead.work_offsets.machine_from_work(world.program_start());
        self.pool.search_memory = world.into_system_variables();
        let forbidden = |axis: Axis| check_soft_limits(axis, to[axis], &plant.params).err();
        if let Some(forbidden) = plant.axes.present().find_map(forbidden) {
            self.pool.close(run);
            return plant.refuse(forbidden.text(&plant.params));
        }
        for number in (1..=LAST_VARIABLE).filter(|number| CommonVariables::contains(*number)) {
            let of = |memory: &CommonVariables| memory.get(number).ok().flatten();
            let there = of(run.interpreter.common_variables());
            if there != of(&plant.work.variables) {
                let _ = plant.store_variable(number, there);
            }
        }
        plant.work.offsets.clone_from(&run.lookahead.work_offsets);
        plant.work.tool_change_point = Some(tool_change_point);
        plant.spindles.wheel_speed = switched.speed.unwrap_or(plant.spindles.wheel_speed);
        plant.spindles.wheel_rpm_limit = switched.rpm_limit.or(plant.spindles.wheel_rpm_limit);
        if switched.drive {
            plant.spindles.analog_2_rpm = switched.drive_rpm;
        }
        let speed = ProgrammedFeed::PerMinute(plant.params.get(param::WHEEL_ON_INFEED_SPEED));
        for (target, speed) in [(beside, ProgrammedFeed::Rapid), (to, speed)] {
            let planned = PlannedMove::new(target, MoveShape::Line, speed, (all_axes(), AxisSet::NONE));
            run.queue.push_back(QueueItem::Move(planned));
        }
        run.lookahead.oscillating = plant.oscillating_axis();
        run.lookahead.dialect = plant.kind.row().dialect;
        run.started_at = plant.now;
        run.origin = Origin::Program;
        (plant.execution.part_finished, plant.execution.finished_cycle) = (false, None);
        plant.execution.begin_cycle(plant.work.offsets.tool_offset);
        run.next_tag = plant.axes.planner.finished_tag().map_or(1, |tag| tag + 1);
        self.run = Some(run);
        plant.transition(ControlEvent::Start);
    }

    /// Records the position of the run for a power failure: the line in the main program.
    pub fn store_run_position(&mut self, plant: &mut Plant) {
        self.store_position_after(STORE_INTERVAL, plant);
    }

    /// Stores the line if it is another one than stored, and that `pause` ago.
    fn store_position_after(&mut self, pause: Micros, plant: &mut Plant) {
        let Some(run) = self.run.as_ref().filter(|run| run.origin == Origin::Program) else { return };
        // In a subprogram, the calling block counts.
        let (program, line) = (plant.execution.current_program, plant.execution.current_block.line);
        if plant.execution.current_block.program != program || run.started_at == plant.now {
            return;
        }
        let due = self.power_cut.stored.is_none_or(|(told, at)| told != line && plant.now.since(at) >= pause);
        if due {
            self.power_cut.stored = Some((line, plant.now));
            plant.outbox.requests.push(StorageRequest::RunningAt(Some((program, line))));
        }
    }

    /// The control ends, or its supply fails: stores the position of the open run and keeps it.
    pub fn keep_run_position(&mut self, plant: &mut Plant) {
        self.store_position_after(Micros::ZERO, plant);
        self.power_cut.is_kept = self.power_cut.stored.is_some();
    }

    /// The run is over: clears the recorded position.
    pub fn clear_run_position(&mut self, plant: &mut Plant) {
        let stored = self.power_cut.stored.take().map(|(line, _)| (plant.execution.current_program, line));
        let is_kept = std::mem::take(&mut self.power_cut.is_kept);
        self.power_cut.interrupted = stored.filter(|_| is_kept);
        if stored.is_some() && !is_kept {
            plant.outbox.requests.push(StorageRequest::RunningAt(None));
        }
    }
}

/// Copies system variables to a check world: offsets, counts, wheel data, dressing points.
fn copy_system_variables(plant: &Plant, mut world: OfflineMachine) -> OfflineMachine {
    let kept = [
        system_variable::WEAR_X,
        system_variable::WEAR_Y,
        system_variable::WEAR_Z,
        system_variable::GEOMETRY_X,
        system_variable::GEOMETRY_Y,
        system_variable::GEOMETRY_Z,
        system_variable::CUTTER_RADIUS,
        system_variable::CUTTER_TIP,
        system_variable::PARTS_DONE,
        system_variable::DRESSING_POINT,
    ];
    let params = PARAM_VARIABLES.iter().map(|(range, _)| *range);
    for range in kept.into_iter().chain(params) {
        for number in range.first..range.first + range.count {
            if let Some(value) = plant.read_system_variable(number) {
                world.set_system(number, value);
            }
        }
    }
    world
}

/// All axes, programmed absolutely.
fn all_axes() -> AxisSet {
    let mut all = AxisSet::NONE;
    Axis::ALL.into_iter().for_each(|axis| all.insert(axis));
    all
}
