//! `kt830 plot-path`: runs a program on the simulated machine and draws its path: contour, band, speed, acceleration, jerk.
//! Source: docs/motion.md.

use std::sync::Arc;

use super::args::{PlotPathArgs, SharedArgs};
use super::run::stop_reason;
use super::setup::ProgramToRun;
use super::{CallError, FAILED, SUCCESS, print_line, setup};
use crate::controller::{nc_settings, reference_points, stored_system_variables};
use crate::defs::param;
use crate::hmi::path_plot::{self, PlottedLimits, RecordedMotion};
use crate::host::headless::HeadlessHost;
use crate::host::headless_run::{RunEnd, RunLimits};
use crate::link::snapshot::VARIABLE_COUNT;
use crate::nc::{BlockLocation, CommonVariables, OfflineMachine, ProgramCheck, SharedLibrary, WorkOffsets};
use crate::units::{Axis, MachinePos, Micros, PerAxis};

/// Longest run that is drawn.
const LONGEST: Micros = Micros::from_millis(3_600_000);
/// Distance between chord and arc, mm, and most chords of an arc: a hundredth of a usual tolerance.
const CHORD_TOLERANCE_MM: f64 = 0.000_1;
const MAX_CHORDS: u32 = 20_000;
/// How far along the contour the nearest place is looked for, mm, and in chords.
const SEARCH_REACH_MM: f64 = 2.0;
const SEARCH_CHORDS: usize = 8;

/// Runs the program and writes the picture.
///
/// # Errors
/// The call or a file is wrong, or nothing moves.
pub fn plot_path(shared: &SharedArgs, call: &PlotPathArgs) -> Result<u8, CallError> {
    let mut host = setup::unstored_host(shared, setup::check_retained(shared)?)?;
    let number = setup::prepare_run(&mut host, shared, ProgramToRun::Word(&call.program))?;
    let is_drawn =
        |at: BlockLocation| call.lines.as_ref().is_none_or(|lines| at.program == number && lines.contains(&at.line));
    let contour = ProgrammedContour::new(&host, number, is_drawn)?;
    let (mut set_points, mut drawn) = (Vec::new(), Vec::new());
    let end = host.run_program(&RunLimits { through_stops: true, longest: LONGEST, once: false }, &mut |host| {
        set_points.push(host.controller().set_point());
        drawn.push(is_drawn(host.controller().current_block()));
        true
    });
    let moves = |tick: &usize| *tick > 0 && drawn[*tick] && set_points[*tick] != set_points[*tick - 1];
    let (first, last) = ((0..drawn.len()).find(moves), (0..drawn.len()).rfind(moves));
    let (Some(first), Some(last)) = (first, last) else {
        return Err(CallError::new(format!("{}: nothing moves in these lines", call.program)));
    };
    // Some ticks before and behind, so that the first and the last jerk are seen.
    let ticks = first.saturating_sub(3)..(last + 4).min(set_points.len());
    let control = host.controller();
    let (params, tick_s) = (control.params(), control.tick_time().as_secs_f64());
    let seconds = (last + 1 - first) as f64 * tick_s;
    let title = host.program_source(number).map(|source| source.title()).unwrap_or_default();
    let in_work = |at: &MachinePos| contour.offsets.work_from_machine(*at);
    let motion = RecordedMotion {
        title: format!("{title}   {seconds:.3} s"),
        plane: control.kind().ui().drawing_planes[0],
        axes: control.axes_present().collect(),
        deviation: contour.deviations(&set_points)[ticks.clone()].to_vec(),
        contour: contour.drawn().map(|piece| piece.iter().map(in_work).collect()).collect(),
        set_points: set_points[ticks].iter().map(in_work).collect(),
        tolerance: params.get(param::PATH_TOLERANCE),
        limits: PerAxis::from_fn(|axis| PlottedLimits {
            acceleration: params.get_axis(param::ACCELERATION_X, axis),
            jerk: params.get_axis(param::JERK_X, axis),
        }),
        tick_s,
    };
    let out = &call.out;
    let picture = path_plot::draw(&motion, shared.lang, call.size);
    picture.save(out).map_err(CallError::at(format!("--out {}", out.display())))?;
    let most_um = motion.deviation.iter().copied().fold(0.0, f64::max) * 1_000.0;
    print_line(format!("{}: {seconds:.3} s, deviation up to {most_um:.1} µm", out.display()));
    if let Some(why) = stop_reason(&mut host, end, LONGEST) {
        warn_line!("kt830: stopped: {}", why.get(shared.lang));
    }
    for alarm in &host.snapshot().alarms {
        warn_line!("kt830: {}", alarm.text.get(shared.lang));
    }
    Ok(if end == RunEnd::Finished { SUCCESS } else { FAILED })
}

/// The programmed contour from where the machine stands: machine coordinates, arcs as chords.
struct ProgrammedContour {
    /// Pieces without an interruption, and whether they are drawn.
    pieces: Vec<(bool, Vec<MachinePos>)>,
    /// The offsets at the first move that is drawn: a change on the way does not move the picture.
    offsets: WorkOffsets,
}

impl ProgrammedContour {
    fn new(host: &HeadlessHost, number: u32, is_drawn: impl Fn(BlockLocation) -> bool) -> Result<Self, CallError> {
        let control = host.controller();
        let settings = nc_settings(control.kind(), control.params());
        let library: SharedLibrary = Arc::clone(host.programs()) as _;
        let source = host.program_source(number).ok_or_else(|| CallError::new("the program is gone"))?;
        let mut offsets = control.work_offsets().clone();
        let mut memory = CommonVariables::default();
        for variable in 100..VARIABLE_COUNT as u32 {
            if let Some(value) = control.variable(variable) {
                let _ = memory.set(variable, Some(value)); // a variable of the control is a valid one
            }
        }
        let mut world = OfflineMachine::new(&settings)
            .with_references(reference_points(control.params()))
            .with_position(offsets.work_from_machine(control.set_point()))
            .with_work_offsets(offsets.clone());
        for (number, value) in stored_system_variables(control.params(), host.retained().dress_points) {
            world.set_system(number, value);
        }
        let (mut pen, mut begun) = (world.clone(), false);
        let mut pieces: Vec<(bool, Vec<MachinePos>)> = Vec::new();
        ProgramCheck::new(&source, &library, &settings, memory).run(&mut world, &mut |block| {
            let is_drawn = is_drawn(block.location);
            for op in &block.ops {
                // A motion changes no offset.
                let at_op = pen.work_offsets().clone();
                let mut moved = false;
                pen.apply_traced(op, |from, segment| {
                    let begin = at_op.machine_from_work(from);
                    let goes_on = |piece: &(bool, Vec<_>)| piece.0 == is_drawn && piece.1.last() == Some(&begin);
                    if !pieces.last().is_some_and(goes_on) {
                        pieces.push((is_drawn, vec![begin]));
                    }
                    let points = segment.chords(from, CHORD_TOLERANCE_MM, MAX_CHORDS);
                    if let Some((_, piece)) = pieces.last_mut() {
                        piece.extend(points.map(|at| at_op.machine_from_work(at)));
                    }
                    moved = true;
                });
                if moved && is_drawn && !begun {
                    (offsets, begun) = (at_op, true);
                }
            }
        });
        Ok(Self { pieces, offsets })
    }

    /// The pieces that are drawn.
    fn drawn(&self) -> impl Iterator<Item = &[MachinePos]> {
        self.pieces.iter().filter(|(is_drawn, _)| *is_drawn).map(|(_, piece)| piece.as_slice())
    }

    /// The distance of each set-point from the whole contour, mm; the nearest place only goes forward along it.
    fn deviations(&self, set_points: &[MachinePos]) -> Vec<f64> {
        let chords: Vec<(MachinePos, MachinePos)> =
            self.pieces.iter().flat_map(|(_, piece)| piece.windows(2).map(|pair| (pair[0], pair[1]))).collect();
        let mut nearest = 0;
        let near = |at: MachinePos, from: usize| {
            let (mut reach, mut best) = (0.0, (f64::INFINITY, from));
            for (index, (begin, end)) in chords.iter().enumerate().skip(from) {
                let distance = distance_to_chord(*begin, *end, at);
                if distance < best.0 {
                    best = (distance, index);
                }
                let way = *end - *begin;
                reach += dot(way, way).sqrt();
                if reach > SEARCH_REACH_MM && index >= from + SEARCH_CHORDS {
                    break;
                }
            }
            best
        };
        set_points
            .iter()
            .map(|at| {
                let (distance, index) = near(*at, nearest);
                nearest = index;
                if distance.is_finite() { distance } else { 0.0 }
            })
            .collect()
    }
}

fn distance_to_chord(begin: MachinePos, end: MachinePos, at: MachinePos) -> f64 {
    let (chord, to) = (end - begin, at - begin);
    let square = dot(chord, chord);
    let part = if square > 0.0 { (dot(chord, to) / square).clamp(0.0, 1.0) } else { 0.0 };
    let off = PerAxis::from_fn(|axis| to[axis] - part * chord[axis]);
    dot(off, off).sqrt()
}

fn dot(a: PerAxis<f64>, b: PerAxis<f64>) -> f64 {
    Axis::ALL.iter().map(|axis| a[*axis] * b[*axis]).sum()
}
