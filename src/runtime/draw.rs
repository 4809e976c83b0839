//! Computes the toolpath of a program in a check run: every move, arcs as chords, with progress and cancellation.
//! Source: spec B6 (图形), H8.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::office::line_fault;
use crate::controller::files::{Job, Start};
use crate::controller::{Program, Programs};
use crate::defs::text::{Said, Text};
use crate::io::sim::{LatheRehearsal, MachineFile};
use crate::link::drawing::{Drawing, MOST_POINTS, Point, Way};
use crate::link::files::{FileAnswer, LineFault};
use crate::nc::{CheckWorld, Library, Op, World, check_until};
use crate::units::PerAxis;

/// Text shown with the progress.
pub const NAME: Text = Text::new("正在计算图形", "computing the path");
/// Blocks between two progress reports.
const LOOK_EVERY: u64 = 4_096;
/// Maximum number of interferences reported.
const CRASHES: usize = 20;
/// Maximum number of chords per arc, and the largest distance between chord and arc, mm.
const CHORDS: f64 = 180.0;
const SAG_MM: f64 = 0.002;

/// Computes the toolpath of a program.
pub fn draw(
    program: &Program,
    job: &Job,
    start: &Start,
    cancelled: &AtomicBool,
    tell: &mut dyn FnMut(FileAnswer),
) -> Drawing {
    let programs: Arc<Programs> = Arc::clone(&job.programs);
    let library: Arc<dyn Library + Send + Sync> = programs;
    let mut world = CheckWorld::new(&job.settings)
        .with_references(start.references)
        .with_block_skip(start.block_skip)
        .at(start.position)
        .with_frames(start.frames.clone());
    start.system.iter().for_each(|(number, value)| world.set_system(*number, Some(*value)));
    let rehearsal = rehearsal(program, start);
    let mut pen = Pen { world: world.clone(), points: Vec::new(), last: None, rehearsal, met: Vec::new() };
    let (lines, mut blocks, mut furthest) = (program.source.line_count().max(1), 0_u64, 0);
    let memory = start.memory.clone();
    let checked = check_until(&program.source, &library, &job.settings, memory, &mut world, &mut |block| {
        let line = if block.at.program == program.number { block.at.line } else { 0 };
        block.ops.iter().for_each(|op| pen.go(op, line));
        blocks += 1;
        if blocks.is_multiple_of(LOOK_EVERY) {
            if block.at.program == program.number {
                furthest = furthest.max(block.at.line as usize);
            }
            // The last tenth is left for the levels of detail.
            tell(FileAnswer::Progress(NAME, (furthest * 900 / lines) as u16));
        }
        !cancelled.load(Ordering::Acquire) && pen.points.len() < MOST_POINTS
    });
    let mut drawing = Drawing {
        number: program.number,
        stamp: program.stamp,
        levels: Vec::new(),
        extents: checked.extents,
        length_mm: checked.length_mm,
        seconds: checked.seconds,
        lines: checked.lines,
        crashes: pen.met.iter().map(|met| met.at).collect(),
        faults: checked.faults.iter().filter(|fault| fault.place.program == program.number).map(line_fault).collect(),
        finished: checked.finished,
    };
    drawing.faults.extend(pen.met.iter().map(Met::fault));
    drawing.faults.sort_by_key(|fault| fault.line);
    drawing.take_path(pen.points);
    drawing
}

/// Interference check of a lathe program's bar and tools (L9); `None` on other kinds.
fn rehearsal(program: &Program, start: &Start) -> Option<LatheRehearsal> {
    let part = super::bar::of_program(start.kind, &start.params, &program.source)?;
    let machine = MachineFile::builtin(start.kind).ok()?;
    LatheRehearsal::new(&part, machine.tool_post.as_ref()?, &start.params)
}

/// A collision of a tool: line, cause and position.
#[derive(Debug)]
struct Met {
    line: u32,
    what: &'static str,
    at: [f32; 3],
}

impl Met {
    fn fault(&self) -> LineFault {
        let zh = match self.what {
            "chuck" => "刀具碰卡盘",
            "part, shank of the tool" => "刀杆碰工件",
            "part, spindle standing" => "主轴不转时切入工件",
            _ => "快速切入工件",
        };
        let (x, z) = (2.0 * self.at[0], self.at[2]);
        let said = Said::new(
            format!("干涉：{zh}，X{x:.2} Z{z:.2}；请改路径或换刀"),
            format!("interference: {}, X{x:.2} Z{z:.2}; change the path or the tool", self.what),
        );
        LineFault { line: self.line, column: 1, said }
    }
}

/// Executes the operations in its own check world and records the toolpath.
struct Pen {
    world: CheckWorld,
    points: Vec<Point>,
    /// End of the path so far; a change of work offset can move it away from the current position.
    last: Option<[f32; 3]>,
    rehearsal: Option<LatheRehearsal>,
    met: Vec<Met>,
}

impl Pen {
    /// Executes one operation; `line` is 0 for an operation of another program.
    fn go(&mut self, op: &Op, line: u32) {
        let from = self.world.position();
        let before = self.points.len();
        self.world.apply(op);
        self.draw(op, from);
        if let Some(mut rehearsal) = self.rehearsal.take() {
            let met = self.rehearse(&mut rehearsal, op, from, before);
            if let Some((what, at)) = met.filter(|_| self.met.len() < CRASHES) {
                self.met.push(Met { line, what, at });
            }
            self.rehearsal = Some(rehearsal);
        }
    }

    /// Runs the interference check for one operation: the first collision and the end point of its path segment.
    fn rehearse(
        &self,
        rehearsal: &mut LatheRehearsal,
        op: &Op,
        from: PerAxis<f64>,
        before: usize,
    ) -> Option<(&'static str, [f32; 3])> {
        match op {
            Op::Preset { .. } => rehearsal.rename(from, self.world.position()),
            Op::Post { station, by } => rehearsal.change(usize::from(*station).saturating_sub(1), *by),
            Op::M { code: 3 | 4, .. } => rehearsal.turn(true),
            Op::M { code: 5, .. } => rehearsal.turn(false),
            _ => {}
        }
        // The path segments recorded for this operation.
        let mut at = from;
        for point in self.points.iter().skip(before).filter(|point| point.way != Way::Lift) {
            let to = PerAxis(point.at.map(f64::from));
            if let Some(what) = rehearsal.go(at, to, point.way == Way::Rapid) {
                return Some((what, point.at));
            }
            at = to;
        }
        None
    }

    fn draw(&mut self, op: &Op, from: PerAxis<f64>) {
        let to = self.world.position();
        match op {
            Op::Rapid { .. } | Op::MachineMove { feed: None, .. } => self.line(from, to, Way::Rapid),
            Op::Feed { .. } | Op::Skip { .. } | Op::MachineMove { feed: Some(_), .. } => self.line(from, to, Way::Feed),
            Op::Thread(threading) => {
                self.line(from, threading.out, Way::Feed);
                self.line(threading.out, to, Way::Feed);
            }
            Op::Reference { via, .. } => {
                self.line(from, *via, Way::Rapid);
                self.line(*via, to, Way::Rapid);
            }
            Op::Gauge(gauging) => {
                let mut touch = from;
                touch[gauging.axis] = gauging.to;
                self.line(from, touch, Way::Feed);
                self.line(touch, to, Way::Feed);
            }
            Op::Arc { center, plane, turn, .. } => {
                let (first, second) = plane.axes();
                let angle = |at: PerAxis<f64>| (at[second] - center[second]).atan2(at[first] - center[first]);
                let radius = (from[first] - center[first]).hypot(from[second] - center[second]);
                let (begin, turn) = (angle(from), f64::from(*turn));
                let swept = (turn * (angle(to) - begin)).rem_euclid(std::f64::consts::TAU);
                let swept = if swept <= 1e-9 { std::f64::consts::TAU } else { swept };
                let step = 2.0 * (1.0 - SAG_MM / radius.max(SAG_MM)).clamp(-1.0, 1.0).acos();
                let chords = (swept / step.max(1e-3)).ceil().clamp(1.0, CHORDS) as u32;
                let mut last = from;
                for chord in 1..=chords {
                    let part = f64::from(chord) / f64::from(chords);
                    let at = begin + turn * swept * part;
                    let mut next = PerAxis::from_fn(|axis| from[axis] + (to[axis] - from[axis]) * part);
                    next[first] = center[first] + radius * at.cos();
                    next[second] = center[second] + radius * at.sin();
                    let next = if chord == chords { to } else { next };
                    self.line(last, next, Way::Feed);
                    last = next;
                }
            }
            _ => {}
        }
    }

    fn line(&mut self, from: PerAxis<f64>, to: PerAxis<f64>, way: Way) {
        let three = |at: PerAxis<f64>| at.0.map(|value| value as f32);
        let (from, to) = (three(from), three(to));
        if self.last.is_none_or(|last| last.map(f32::to_bits) != from.map(f32::to_bits)) {
            self.points.push(Point { at: from, way: Way::Lift });
        }
        if from.map(f32::to_bits) != to.map(f32::to_bits) {
            self.points.push(Point { at: to, way });
        }
        self.last = Some(to);
    }
}
