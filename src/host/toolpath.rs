//! Computes the toolpath of a program in a check run: every move, arcs as chords, with progress and cancellation.
//! Source: spec B6 (图形), H8.

use std::sync::Arc;

use super::job_answer::line_fault;
use crate::controller::files::{BackgroundJob, DrawingStart};
use crate::controller::{StoredProgram, stored_system_variables};
use crate::defs::kind::Dialect;
use crate::defs::mcode::SwitchedUnit;
use crate::defs::text::{LocalizedText, Text};
use crate::io::sim::{InterferenceCheck, MachineFile};
use crate::link::files::FileAnswer;
use crate::link::line_fault::LineFault;
use crate::link::toolpath::{CycleTime, MAX_POINTS, MoveKind, PathPoint, Toolpath};
use crate::nc::{CoordinateChange, ExternalState, Library, MotionSegment, OfflineMachine, Op, OpEffect, ProgramCheck};
use crate::units::WorkPos;

/// Text shown with the progress.
pub const PROGRESS_TEXT: Text = Text::new("正在计算图形", "computing the path");
/// Text shown while the program runs on the simulated machine for its time.
pub const TIMING_TEXT: Text = Text::new("正在模拟，计算时间", "simulating for the time");
/// Thousandths of the progress when that begins.
pub const TIMING_PROGRESS: u16 = 950;

/// Runs a program on a simulated machine; returns the seconds to its end, `None` if it does not come there. The last
/// argument ends the run early.
pub type CycleTimer = fn(&StoredProgram, &BackgroundJob, &DrawingStart, &dyn Fn() -> bool) -> Option<f64>;

/// Blocks between two progress reports.
const PROGRESS_INTERVAL_BLOCKS: u64 = 4_096;
/// Maximum number of interferences reported.
const MAX_INTERFERENCES: usize = 20;
/// Maximum number of chords per arc, and the largest distance between chord and arc, mm.
const MAX_CHORDS: u32 = 180;
const CHORD_TOLERANCE_MM: f64 = 0.002;

/// Computes the toolpath of a program; `stopped` ends it early.
pub fn compute_toolpath(
    program: &StoredProgram,
    job: &BackgroundJob,
    start: &DrawingStart,
    stopped: &dyn Fn() -> bool,
    tell: &mut dyn FnMut(FileAnswer),
) -> Toolpath {
    let library: Arc<dyn Library + Send + Sync> = job.programs.clone();
    let mut world = OfflineMachine::new(&job.settings)
        .with_references(start.reference_points)
        .with_block_skip(start.block_skip)
        .with_position(start.position)
        .with_work_offsets(start.work_offsets.clone());
    for (number, value) in stored_system_variables(&start.params, start.dress_points) {
        world.set_system(number, value);
    }
    let (path, interference_check) = (RecordedPath::default(), interference_check(program, start));
    let (dialect, interferences) = (job.settings.dialect, Vec::new());
    let mut pen = ToolpathRecorder { world: world.clone(), dialect, path, interference_check, interferences };
    let (lines, mut blocks, mut furthest) = (program.source.line_count().max(1), 0_u64, 0);
    let checking = ProgramCheck::new(&program.source, &library, &job.settings, start.memory.clone());
    let checked = checking.run_until(&mut world, &mut |block| {
        let line = if block.location.program == program.number { block.location.line } else { 0 };
        block.ops.iter().for_each(|op| pen.record(op, line));
        blocks += 1;
        if blocks.is_multiple_of(PROGRESS_INTERVAL_BLOCKS) {
            if block.location.program == program.number {
                furthest = furthest.max(block.location.line as usize);
            }
            // The last tenth is left for the levels of detail.
            tell(FileAnswer::Progress(PROGRESS_TEXT, (furthest * 900 / lines) as u16));
        }
        !stopped() && pen.path.points.len() < MAX_POINTS
    });
    let own_faults = checked.faults.iter().filter(|fault| fault.location.program == program.number);
    let mut drawing = Toolpath {
        number: program.number,
        stamp: program.stamp,
        extents: checked.extents,
        length_mm: checked.length_mm,
        cycle_time: CycleTime::AtFeeds(checked.seconds),
        lines: checked.lines,
        crashes: pen.interferences.iter().map(|met| met.at).collect(),
        faults: own_faults.map(line_fault).collect(),
        finished: checked.finished,
        ..Toolpath::default()
    };
    drawing.faults.extend(pen.interferences.iter().map(Interference::line_fault));
    drawing.faults.sort_by_key(|fault| fault.line);
    drawing.set_path(pen.path.points);
    drawing
}

/// Interference check of a lathe program's bar and tools (L9); `None` on other kinds.
fn interference_check(program: &StoredProgram, start: &DrawingStart) -> Option<InterferenceCheck> {
    let part = super::bar::bar_of_program(start.kind, &start.params, &program.source)?;
    let machine = MachineFile::builtin(start.kind).ok()?;
    InterferenceCheck::new(&part, machine.tool_post.as_ref()?, &start.params)
}

/// A collision of a tool: line, cause and position.
#[derive(Debug)]
struct Interference {
    line: u32,
    cause: &'static str,
    at: [f32; 3],
}

impl Interference {
    fn line_fault(&self) -> LineFault {
        let zh = match self.cause {
            "chuck" => "刀具碰卡盘",
            "part, tool shank" => "刀杆碰工件",
            "part, spindle stopped" => "主轴不转时切入工件",
            _ => "快速切入工件",
        };
        let (x, z) = (2.0 * self.at[0], self.at[2]);
        let message = LocalizedText::new(
            format!("干涉：{zh}，X{x:.2} Z{z:.2}；请改路径或换刀"),
            format!("interference: {}, X{x:.2} Z{z:.2}; change the path or the tool", self.cause),
        );
        LineFault { line: self.line, column: 1, message }
    }
}

/// Executes the operations in its own check world and records the toolpath.
struct ToolpathRecorder {
    world: OfflineMachine,
    dialect: Dialect,
    path: RecordedPath,
    interference_check: Option<InterferenceCheck>,
    interferences: Vec<Interference>,
}

impl ToolpathRecorder {
    /// Executes one operation; `line` is 0 for an operation of another program.
    fn record(&mut self, op: &Op, line: u32) {
        let from = self.world.position();
        let before = self.path.points.len();
        let Self { world, path, .. } = self;
        world.apply_traced(op, |from, segment| path.record(from, segment));
        if let Some(mut rehearsal) = self.interference_check.take() {
            let met = self.check_interference(&mut rehearsal, op, from, before);
            if let Some((what, at)) = met.filter(|_| self.interferences.len() < MAX_INTERFERENCES) {
                self.interferences.push(Interference { line, cause: what, at });
            }
            self.interference_check = Some(rehearsal);
        }
    }

    /// Runs the interference check for one operation: the first collision and the end point of its path segment.
    fn check_interference(
        &self,
        rehearsal: &mut InterferenceCheck,
        op: &Op,
        from: WorkPos,
        before: usize,
    ) -> Option<(&'static str, [f32; 3])> {
        match op.effect() {
            OpEffect::Coordinates(CoordinateChange::Set(_)) => {
                rehearsal.set_coordinate_system(from, self.world.position());
            }
            OpEffect::IndexTurret { station, by } => rehearsal.change_tool(usize::from(station).saturating_sub(1), by),
            OpEffect::MCode(words) => match words.switched_unit(self.dialect) {
                Some((SwitchedUnit::WorkDrive, on)) => rehearsal.set_spindle(on),
                Some((SwitchedUnit::Wheel | SwitchedUnit::Coolant, _)) | None => {}
            },
            // The lathe has neither work offsets nor tool offsets. The path of a motion is checked below.
            OpEffect::Motion(_) | OpEffect::Coordinates(_) | OpEffect::Oscillation(_) => {}
            OpEffect::PathMode(_) | OpEffect::Dwell(_) | OpEffect::Speed(..) | OpEffect::SpeedLimit(_) => {}
            OpEffect::Variable(..) | OpEffect::SystemVariable(..) | OpEffect::Message(_) => {}
        }
        // The path segments recorded for this operation.
        let mut at = from;
        for point in self.path.points.iter().skip(before).filter(|point| point.kind != MoveKind::Break) {
            let to = WorkPos::new(point.at.map(f64::from));
            if let Some(what) = rehearsal.check_move(at, to, point.kind == MoveKind::Rapid) {
                return Some((what, point.at));
            }
            at = to;
        }
        None
    }
}

/// The points of a toolpath.
#[derive(Default)]
struct RecordedPath {
    points: Vec<PathPoint>,
    /// End of the path so far; a change of work offset can move it away from the current position.
    last: Option<[f32; 3]>,
}

impl RecordedPath {
    /// Records a segment, an arc as chords.
    fn record(&mut self, from: WorkPos, segment: &MotionSegment) {
        let kind = if segment.rapid { MoveKind::Rapid } else { MoveKind::Feed };
        let mut last = from;
        for next in segment.chords(from, CHORD_TOLERANCE_MM, MAX_CHORDS) {
            self.record_line(last, next, kind);
            last = next;
        }
    }

    fn record_line(&mut self, from: WorkPos, to: WorkPos, way: MoveKind) {
        let three = |at: WorkPos| at.coordinates().map(|value| value as f32);
        let (from, to) = (three(from), three(to));
        if self.last.is_none_or(|last| last.map(f32::to_bits) != from.map(f32::to_bits)) {
            self.points.push(PathPoint { at: from, kind: MoveKind::Break });
        }
        if from.map(f32::to_bits) != to.map(f32::to_bits) {
            self.points.push(PathPoint { at: to, kind: way });
        }
        self.last = Some(to);
    }
}
