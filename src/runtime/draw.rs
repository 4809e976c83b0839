//! The check run of a program as a drawing: every move of it, arcs as chords, with progress and a way to stop it.
//! Source: spec B6 (图形), H8.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::office::line_fault;
use crate::controller::files::{Job, Start};
use crate::controller::{Program, Programs};
use crate::defs::text::Text;
use crate::link::drawing::{Drawing, MOST_POINTS, Point, Way};
use crate::link::files::FileAnswer;
use crate::nc::{CheckWorld, Library, Op, World, check_until};
use crate::units::PerAxis;

/// What is being done.
pub const NAME: Text = Text::new("正在计算图形", "computing the path");
/// Blocks between two looks at progress and cancel.
const LOOK_EVERY: u64 = 4_096;
/// Most chords of a full circle, and how far a chord may lie off its arc, mm.
const CHORDS: f64 = 180.0;
const SAG_MM: f64 = 0.002;

/// Draws a program.
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
    let mut pen = Pen { world: world.clone(), points: Vec::new(), last: None };
    let (lines, mut blocks, mut furthest) = (program.source.line_count().max(1), 0_u64, 0);
    let memory = start.memory.clone();
    let checked = check_until(&program.source, &library, &job.settings, memory, &mut world, &mut |block| {
        block.ops.iter().for_each(|op| pen.go(op));
        blocks += 1;
        if blocks.is_multiple_of(LOOK_EVERY) {
            if block.at.program == program.number {
                furthest = furthest.max(block.at.line as usize);
            }
            // The degrees of detail take the last tenth.
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
        faults: checked.faults.iter().filter(|fault| fault.place.program == program.number).map(line_fault).collect(),
        finished: checked.finished,
    };
    drawing.take_path(pen.points);
    drawing
}

/// Follows the operations with a world of its own and notes where they lead.
struct Pen {
    world: CheckWorld,
    points: Vec<Point>,
    /// Where the path ended; a change of frame leaves it elsewhere.
    last: Option<[f32; 3]>,
}

impl Pen {
    fn go(&mut self, op: &Op) {
        let from = self.world.position();
        self.world.apply(op);
        let to = self.world.position();
        match op {
            Op::Rapid { .. } | Op::MachineMove { feed: None, .. } => self.line(from, to, Way::Rapid),
            Op::Feed { .. } | Op::Skip { .. } | Op::MachineMove { feed: Some(_), .. } => self.line(from, to, Way::Feed),
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
