//! Program restart from a selected block, and resuming after a power failure.
//!
//! The blocks before it are read without motion. The resulting modal codes, work offset, tool offset, variables and
//! axis positions are shown first. Nothing starts automatically: a wheel or workpiece that would turn there must be
//! started by key. Cycle start then moves the axes to the position, the wheel axis last, and runs from the block.
//! Source: spec B5.

use std::sync::Arc;

use super::planned::Planned;
use super::run::{Item, Origin, PlannedMove, Proving, Run, Speed};
use super::system::nc_settings;
use super::{Controller, Effect, Event, Phase};
use crate::defs::key::Mode;
use crate::defs::param;
use crate::defs::text::{Lang, Said, Text};
use crate::defs::variable;
use crate::link::edit::ModalView;
use crate::link::snapshot::RestartView;
use crate::motion::Shape;
use crate::nc::{self, AxisSet, CheckWorld, Memory, Modals, Next, Op, SpeedMode, World};
use crate::units::{Axis, Micros, PerAxis};

/// Maximum ticks for reading the blocks before: about two million blocks. A loop that waits for the machine never ends.
const TICKS: u32 = 1_000;
/// The last common variable.
const LAST_VARIABLE: u32 = 999;
/// Minimum interval between two records of the run position for a power failure.
const KEEP_EVERY: Micros = Micros::from_millis(1_000);

const NO_PROGRAM: Text = Text::new("没有当前程序：先在目录中选择", "no current program: choose one in the directory");
const WHEEL_FIRST: Text = Text::new(
    "该段之前已启动砂轮：先按砂轮启动，再循环启动",
    "the wheel runs there: start it by its key before cycle start",
);
const DRIVE_FIRST: Text = Text::new(
    "该段之前工件已转动：先启动，再循环启动",
    "the workpiece turns there: start it by its key before cycle start",
);

/// Machine state that the blocks before the selected one produce.
#[derive(Clone, Debug, Default)]
struct Switched {
    wheel: bool,
    drive: bool,
    coolant: bool,
    /// An axis oscillates at the block.
    oscillates: bool,
    /// G50, G27, G31 or G78 is among them: the resulting position cannot be computed.
    unknown: bool,
    /// First alarm raised by the program before the block.
    alarm: Option<Said>,
    /// The last S, and the limit of G50 S, rpm.
    speed: Option<(f64, SpeedMode)>,
    limit: Option<f64>,
}

impl Switched {
    fn see(&mut self, op: &Op) {
        match op {
            Op::M { code: 3 | 4, .. } => self.wheel = true,
            Op::M { code: 5, .. } => self.wheel = false,
            Op::M { code: 63 | 64, .. } => self.drive = true,
            Op::M { code: 65, .. } => self.drive = false,
            Op::M { code: 8, .. } => self.coolant = true,
            Op::M { code: 9, .. } => self.coolant = false,
            Op::OscillationOn { .. } => self.oscillates = true,
            Op::OscillationOff => self.oscillates = false,
            Op::Preset { .. } | Op::DressReturn { .. } | Op::Skip { .. } | Op::Gauge(_) => self.unknown = true,
            Op::Alarm { text, .. } if self.alarm.is_none() => self.alarm = Some(Said::new(&**text, &**text)),
            Op::S { value, mode } => self.speed = Some((*value, *mode)),
            Op::SpeedLimit { rpm } => self.limit = Some(*rpm),
            _ => {}
        }
    }
}

/// A restart in preparation.
pub(super) struct Restart {
    line: u32,
    run: Box<Run>,
    world: CheckWorld,
    switched: Switched,
    ticks: u32,
    /// The selected block has been reached.
    found: bool,
}

/// Position of the run for a power failure.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Kept {
    /// Program and line (from 1) of a run interrupted before this power-on.
    pub interrupted: Option<(u32, u32)>,
    /// Line of the present run last stored on disk, and when.
    told: Option<(u32, Micros)>,
}

impl Kept {
    /// Starts from the record of the last power-on.
    pub const fn new(interrupted: Option<(u32, u32)>) -> Self {
        Self { interrupted, told: None }
    }
}

impl Controller {
    /// At power-on: shows the program that was interrupted.
    pub(super) fn tell_interrupted(&mut self) {
        if let Some((program, line)) = self.kept.interrupted {
            self.say(Said::new(
                format!("O{program:04} 在第 {line} 行断电中断：回零后可从该段继续（程序页）"),
                format!(
                    "O{program:04} was cut off at line {line}: home the axes, then go on from there (program page)"
                ),
            ));
        }
    }

    /// Starts reading the current program up to a line (from 1), to run it from there.
    pub(super) fn restart_at(&mut self, line: u32) {
        self.restart = None;
        if let Some(why) = self.restart_refused() {
            return self.refuse(why);
        }
        let Some(program) = self.programs.get(self.current) else { return self.refuse(NO_PROGRAM) };
        if line == 0 || line as usize > program.source.line_count() {
            return self.refuse(Said::new(
                format!("O{:04} 没有第 {line} 行", self.current),
                format!("O{:04} has no line {line}", self.current),
            ));
        }
        let source = Arc::clone(&program.source);
        let settings = nc::Settings { axes: self.axes.fitted(), ..nc_settings(self.kind, &self.params) };
        let modals = Modals::new(&settings);
        let mut frames = self.frames.clone();
        frames.activate(modals.frame);
        let world = CheckWorld::new(&settings)
            .with_references(super::references(&self.params))
            .with_frames(frames.clone())
            .at(frames.work_from_machine(self.axes.set()))
            .with_block_skip(self.switches.block_skip)
            .with_known_only();
        let world = self.tell(world);
        let planned = Planned::new(frames, self.axes.set(), self.dress.points, modals.path);
        let library = Arc::clone(&self.programs);
        let start = (self.memory.clone(), planned);
        let proof = self.proof(&source, &settings);
        let before = (self.frames.clone(), self.lathe.start);
        let mut run = Box::new(Run::new(source, library, (settings, modals), start, self.now));
        run.proving = proof.map(|proof| Box::new(Proving { proof, told: false, before }));
        let switched = Switched::default();
        self.restart = Some(Box::new(Restart { line, run, world, switched, ticks: 0, found: false }));
        self.say(Said::new(format!("正在查找第 {line} 行…"), format!("reading up to line {line} …")));
    }

    /// Resumes the run that a power failure interrupted.
    pub(super) fn resume_interrupted(&mut self) {
        let Some((program, line)) = self.kept.interrupted else {
            return self.refuse(Said::new("没有断电中断的程序", "no program was cut off by a power failure"));
        };
        if self.current != program {
            self.load_program(program);
        }
        if self.current == program {
            self.restart_at(line);
        }
    }

    /// Copies system variables to a check world: offsets, counts, wheel data.
    fn tell(&self, mut world: CheckWorld) -> CheckWorld {
        let kept = [
            variable::WEAR_X,
            variable::WEAR_Y,
            variable::WEAR_Z,
            variable::GEOMETRY_X,
            variable::GEOMETRY_Y,
            variable::GEOMETRY_Z,
            variable::PARTS_DONE,
        ];
        let params = super::PARAM_VARIABLES.iter().map(|(range, _)| *range);
        for range in kept.into_iter().chain(params) {
            for number in range.first..range.first + range.count {
                if let Some(value) = self.read_system(number) {
                    world.set_system(number, value);
                }
            }
        }
        world
    }

    fn restart_refused(&self) -> Option<Text> {
        if self.run.is_some() || !matches!(self.phase, Phase::Idle) {
            return Some(crate::machine::press::NOT_IN_RUN);
        }
        if self.mode != Mode::Auto {
            return Some(Text::new("自动方式下才能选择起始段", "a block is chosen in mode AUTO"));
        }
        (!self.axes.all_homed()).then_some(Text::new("先回零，再选择起始段", "home the axes before a block is chosen"))
    }

    /// One tick of the search; shows the result.
    pub(super) fn step_restart(&mut self) {
        let Some(mut restart) = self.restart.take_if(|restart| !restart.found) else { return };
        let Restart { line, run, world, switched, .. } = &mut *restart;
        let line = *line;
        match run.interpreter.advance_to(line, world, &mut |op| switched.see(op)) {
            Ok(Next::Block) => {
                restart.found = true;
                self.found_block(restart);
            }
            Ok(Next::End | Next::Drain) => self.refuse(Said::new(
                format!("程序运行不到第 {line} 行，不能从该行开始"),
                format!("the program does not come to line {line}: it cannot begin there"),
            )),
            Ok(Next::Busy) if restart.ticks < TICKS => {
                restart.ticks += 1;
                self.restart = Some(restart);
            }
            Ok(Next::Busy) => self.refuse(Said::new(
                format!("第 {line} 行之前有等待机床的循环，不能从该行开始"),
                format!("a loop before line {line} waits for the machine: the program cannot begin there"),
            )),
            Err(fault) => self.refuse(Said::new(fault.text(Lang::Zh), fault.text(Lang::En))),
        }
    }

    fn found_block(&mut self, mut restart: Box<Restart>) {
        let Restart { run, world, switched, line, .. } = &mut *restart;
        if let Some(alarm) = switched.alarm.take() {
            return self.refuse(alarm);
        }
        if switched.unknown || switched.oscillates {
            let line = *line;
            return self.refuse(Said::new(
                format!("第 {line} 行之前有 G50、G27、G31、G78，或该处在振荡 (G35)，不能从该行开始"),
                format!(
                    "G50, G27, G31 or G78 before line {line}, or G35 in force there: the program cannot begin there"
                ),
            ));
        }
        let mut frames = self.frames.clone();
        let there = world.frames();
        (frames.active, frames.tool, frames.offset) = (there.active, there.tool, there.offset);
        run.planned = Planned::new(
            frames.clone(),
            frames.machine_from_work(world.place()),
            self.dress.points,
            run.interpreter.modals().path,
        );
        run.block.modals = *run.interpreter.modals();
        self.restart = Some(restart);
        if let Some(view) = self.restart_view() {
            let said = view.said();
            self.say(said);
        }
    }

    /// The view for the program page before the start.
    pub(super) fn restart_view(&self) -> Option<RestartView> {
        let restart = self.restart.as_ref().filter(|restart| restart.found)?;
        let work = restart.world.place();
        let Switched { wheel, drive, coolant, .. } = restart.switched.clone();
        Some(RestartView {
            program: self.current,
            line: restart.line,
            modals: self.restart_modals()?,
            start: PerAxis::from_fn(|axis| {
                self.axes.is_present(axis).then(|| work[axis] * self.displayed_per_mm(axis))
            }),
            wheel,
            drive,
            coolant,
        })
    }

    /// The modal codes at the selected block.
    pub(super) fn restart_modals(&self) -> Option<ModalView> {
        let restart = self.restart.as_ref().filter(|restart| restart.found)?;
        Some(self.view_of(&restart.run.block.modals))
    }

    /// Cycle start with a selected block. True: the restart was started or refused.
    pub(super) fn start_restart(&mut self) -> bool {
        let Some(restart) = self.restart.as_ref() else { return false };
        let [wheel, drive] = self.what_turns();
        if !restart.found {
            self.refuse(Said::new("正在查找起始段，请稍候", "the block is still being looked for"));
        } else if restart.switched.wheel && !wheel && !self.switches.dry_run && !self.switches.mst_lock {
            self.refuse(WHEEL_FIRST);
        } else if restart.switched.drive && !drive && !self.switches.mst_lock {
            self.refuse(DRIVE_FIRST);
        } else if let Some(restart) = self.restart.take() {
            self.begin_at(*restart);
        }
        true
    }

    fn begin_at(&mut self, Restart { mut run, world, switched, .. }: Restart) {
        let (from, to, wheel_axis) = (self.axes.set(), run.planned.machine, self.row.slow_axis);
        let mut beside = to;
        beside[wheel_axis] = from[wheel_axis];
        let forbidden = |axis: Axis| super::run::within(axis, to[axis], &self.params).err();
        if let Some(forbidden) = self.axes.present().find_map(forbidden) {
            let said = self.forbidden(&forbidden);
            return self.refuse(said);
        }
        for number in (1..=LAST_VARIABLE).filter(|number| Memory::has(*number)) {
            let of = |memory: &Memory| memory.get(number).ok().flatten();
            let there = of(run.interpreter.memory());
            if there != of(&self.memory) {
                let _ = self.store_variable(number, there);
            }
        }
        self.frames.clone_from(&run.planned.frames);
        self.lathe.start = Some(self.frames.machine_from_work(world.start()));
        self.wheel_speed = switched.speed.unwrap_or(self.wheel_speed);
        self.wheel_rpm_limit = switched.limit.or(self.wheel_rpm_limit);
        let speed = Speed::PerMinute(self.params.get(param::WHEEL_ON_SPEED));
        for (target, speed) in [(beside, Speed::Rapid), (to, speed)] {
            run.items.push_back(Item::Move(PlannedMove::new(target, Shape::Line, speed, (all(), AxisSet::NONE))));
        }
        run.planned.oscillating = self.oscillating_axis();
        run.planned.system = self.row.system;
        run.since = self.now;
        run.origin = Origin::Program;
        run.next_tag = self.axes.path.finished_tag().map_or(1, |tag| tag + 1);
        self.run = Some(run);
        self.happen(Event::Start);
    }

    /// Records the position of the run for a power failure: the line in the main program.
    pub(super) fn keep_place(&mut self) {
        let Some(run) = self.run.as_ref().filter(|run| run.origin == Origin::Program) else { return };
        // In a subprogram, the calling block counts.
        let (program, line) = (self.current, self.place.line);
        if self.place.program != program || run.since == self.now {
            return;
        }
        let due = self.kept.told.is_none_or(|(told, at)| told != line && self.now.since(at) >= KEEP_EVERY);
        if due {
            self.kept.told = Some((line, self.now));
            self.effects.push(Effect::RunningAt(Some((program, line))));
        }
    }

    /// The run is over: clears the recorded position.
    pub(super) fn forget_place(&mut self) {
        self.kept.interrupted = None;
        if self.kept.told.take().is_some() {
            self.effects.push(Effect::RunningAt(None));
        }
    }
}

/// All axes, programmed absolutely.
fn all() -> AxisSet {
    let mut all = AxisSet::NONE;
    Axis::ALL.into_iter().for_each(|axis| all.insert(axis));
    all
}
