//! The effect of an operation on the modelled machine. This is the one place that says what an operation does. Every
//! model of the machine (look-ahead, check, restart, drawing, interlocks, finished size) matches on the effect.
//! Source: spec B3, B5, K4, L5, L6, L8.

use super::op::{AxisSet, Feed, GaugeMove, Op, PathMode, REFERENCE_POINTS, SpeedMode, ThreadMove};
use super::work_offsets::WorkOffsets;
use crate::defs::kind::Dialect;
use crate::defs::mcode::SwitchedUnit;
use crate::defs::system_variable;
use crate::defs::text::arg::Arg;
use crate::units::{Axis, MachinePos, PerAxis, Plane, WorkPos};

/// What an operation does. Lengths are radius millimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "the fields are what their names say, in the units of the variant")]
pub enum OpEffect<'a> {
    /// Axes move.
    Motion(OpMotion<'a>),
    /// Work coordinates change. The slides stand still.
    Coordinates(CoordinateChange),
    /// The tool turret turns to a station, 1 to 4. With compensation the slides move by `by`; work coordinates stay (L8).
    IndexTurret { station: u8, by: Option<PerAxis<f64>> },
    /// An oscillation starts or ends.
    Oscillation(OscillationChange),
    /// The path mode changes.
    PathMode(PathMode),
    /// Time passes, seconds.
    Dwell(f64),
    /// S: speed of wheel or spindle.
    Speed(f64, SpeedMode),
    /// Speed limit under G96, rpm.
    SpeedLimit(f64),
    /// An M code acts by its row in the M-code table of the dialect.
    MCode(MCodeWords),
    /// A common variable is set.
    Variable(u32, Option<f64>),
    /// A system variable is written.
    SystemVariable(u32, Option<f64>),
    /// The program shows a text.
    Message(ProgramMessage<'a>),
}

/// A motion.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "the fields are what their names say, in the units of the variant")]
pub enum OpMotion<'a> {
    /// A line or an arc in work coordinates.
    Work(WorkMove),
    /// A line in machine coordinates; rapid without a feed.
    Machine { to: PerAxis<Option<f64>>, feed: Option<Feed> },
    /// Rapid via a work position to a reference point, 1 to 4.
    Reference { number: u8, via: WorkPos, words: AxisSet, incremental: AxisSet },
    /// To the stored dressing point; feed in mm/min.
    DressPoint { axes: AxisSet, feed: Option<f64> },
    /// Positioning by a gauge.
    Gauge(&'a GaugeMove),
    /// A thread with its run-out.
    Thread(&'a ThreadMove),
    /// Homing by the reference switches, X first.
    HomeSwitch(AxisSet),
}

/// A line or an arc to a work position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorkMove {
    /// End point.
    pub to: WorkPos,
    /// The arc; a line without it.
    pub arc: Option<ArcMove>,
    /// G00. It may have a feed (L2).
    pub rapid: bool,
    /// Feed.
    pub feed: Option<Feed>,
    /// The signal (1–6) that ends the move (G31).
    pub skip_signal: Option<u8>,
    /// Programmed axes.
    pub words: AxisSet,
    /// Those of them with an incremental word.
    pub incremental: AxisSet,
}

/// An arc. Its turn is 1 counter-clockwise, −1 clockwise, seen with the plane's first axis to the right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArcMove {
    /// Centre; only the two axes of the plane are used.
    pub center: WorkPos,
    /// Plane.
    pub plane: Plane,
    /// Turn.
    pub turn: i8,
}

/// A part of a motion: a line or an arc in work coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionSegment {
    /// End point.
    pub to: WorkPos,
    /// The arc; a line without it.
    pub arc: Option<ArcMove>,
    /// The tool must not cut: rapid, also with a feed (L2).
    pub rapid: bool,
    /// Speed.
    pub speed: SegmentSpeed,
}

impl MotionSegment {
    /// Points along the segment, without its start; the chords between them lie within `tolerance_mm` of it, unless an arc
    /// would need more than `most` of them. The last one is its end.
    pub fn chords(&self, from: WorkPos, tolerance_mm: f64, most: u32) -> impl Iterator<Item = WorkPos> + use<> {
        let (arc, to) = (self.arc, self.to);
        let (radius, begin, swept) =
            arc.map_or((0.0, 0.0, 0.0), |arc| (arc.radius_at(from), arc.angle_of(from), arc.sweep(from, to)));
        let step = 2.0 * (1.0 - tolerance_mm / radius.max(tolerance_mm)).clamp(-1.0, 1.0).acos();
        let count = (swept / step.max(1e-6)).ceil().clamp(1.0, f64::from(most)) as u32;
        (1..=count).map(move |chord| {
            let part = f64::from(chord) / f64::from(count);
            let along = WorkPos::from_fn(|axis| from[axis] + (to[axis] - from[axis]) * part);
            match arc {
                Some(arc) if chord < count => arc.point_at(along, radius, begin + f64::from(arc.turn) * swept * part),
                _ => to,
            }
        })
    }
}

/// The speed of a path segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SegmentSpeed {
    /// The rapid speed of the axes.
    Rapid,
    /// A feed.
    Feed(Feed),
    /// Synchronised with the spindle: revolutions until the end of the segment.
    Revolutions(f64),
}

/// A change of work coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "the fields are what their names say, in the units of the variant")]
pub enum CoordinateChange {
    /// G54–G59; G54.1 P1–P48 as 101–148.
    Select(u8),
    /// G52: the local zero.
    Local(PerAxis<Option<f64>>),
    /// G50, G92: assigns work coordinates to the present position.
    Set(PerAxis<Option<f64>>),
    /// T: tool 0 keeps the tool, offset 0 cancels the offset.
    Tool { tool: u16, offset: u16 },
    /// G10: adds to the wear of a tool offset, 1 to 16.
    AddWear { number: u8, by: PerAxis<f64> },
}

/// A change of the oscillation (K4.3, K4.4).
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "the fields are what their names say, in the units of the variant")]
pub enum OscillationChange {
    /// An axis oscillates between its position and a work coordinate; ramp in ms to 10 m/min.
    Axis { axis: Axis, to: f64, ramp_ms: Option<f64>, strokes_min: Option<f64> },
    /// A cylinder oscillates.
    Cylinder { ramp_ms: Option<f64>, strokes_min: Option<f64> },
    /// Nothing oscillates.
    Off,
}

/// An M code with its words.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "the fields are the words of the block")]
pub struct MCodeWords {
    pub code: u8,
    pub s: Option<f64>,
    pub p: Option<f64>,
    pub l: Option<f64>,
}

/// A text from the program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ProgramMessage<'a> {
    /// Raises an alarm, 3000–3999, and stops.
    Alarm(u32, &'a Arg),
    /// Stops until cycle start; the number is 0–999.
    Stop(u32, &'a Arg),
    /// Shows a text until the next one.
    Show(&'a Arg),
    /// Adds a line to the file of printed lines.
    Print(&'a Arg),
}

impl Op {
    /// What the operation does.
    #[must_use]
    #[inline]
    pub fn effect(&self) -> OpEffect<'_> {
        use OpEffect::{Coordinates, Message, Motion};
        match *self {
            Self::Rapid { to, feed, words, incremental } => {
                motion(WorkMove { rapid: true, feed, ..line(to, words, incremental) })
            }
            Self::Feed { to, feed, words, incremental } => {
                motion(WorkMove { feed: Some(feed), ..line(to, words, incremental) })
            }
            Self::Skip { to, feed, signal, words, incremental } => {
                motion(WorkMove { feed: Some(feed), skip_signal: Some(signal), ..line(to, words, incremental) })
            }
            Self::Arc { to, center, plane, turn, feed, words, incremental } => {
                let arc = Some(ArcMove { center, plane, turn });
                motion(WorkMove { arc, feed: Some(feed), ..line(to, words, incremental) })
            }
            Self::MachineMove { to, feed } => Motion(OpMotion::Machine { to, feed }),
            Self::ReturnToReference { number, via, words, incremental } => {
                Motion(OpMotion::Reference { number, via, words, incremental })
            }
            Self::DressReturn { axes, feed } => Motion(OpMotion::DressPoint { axes, feed }),
            Self::Gauge(ref gauging) => Motion(OpMotion::Gauge(gauging)),
            Self::Thread(ref threading) => Motion(OpMotion::Thread(threading)),
            Self::HomeSwitch { axes } => Motion(OpMotion::HomeSwitch(axes)),
            Self::SelectWorkOffset { g } => Coordinates(CoordinateChange::Select(g)),
            Self::SetLocalZero { values } => Coordinates(CoordinateChange::Local(values)),
            Self::SetCoordinateSystem { values } => Coordinates(CoordinateChange::Set(values)),
            Self::T { tool, offset } => Coordinates(CoordinateChange::Tool { tool, offset }),
            Self::AddWear { number, by } => Coordinates(CoordinateChange::AddWear { number, by }),
            Self::IndexTurret { station, by } => OpEffect::IndexTurret { station, by },
            Self::OscillationOn { stroke, ramp_ms, strokes_min } => OpEffect::Oscillation(match stroke {
                Some((axis, to)) => OscillationChange::Axis { axis, to, ramp_ms, strokes_min },
                None => OscillationChange::Cylinder { ramp_ms, strokes_min },
            }),
            Self::OscillationOff => OpEffect::Oscillation(OscillationChange::Off),
            Self::SetPathMode(mode) => OpEffect::PathMode(mode),
            Self::Dwell { s } => OpEffect::Dwell(s),
            Self::S { value, mode } => OpEffect::Speed(value, mode),
            Self::SpeedLimit { rpm } => OpEffect::SpeedLimit(rpm),
            Self::M { code, s, p, l } => OpEffect::MCode(MCodeWords { code, s, p, l }),
            Self::SetVariable { variable, value } => OpEffect::Variable(variable, value),
            Self::SetSystemVariable { number, value } => OpEffect::SystemVariable(number, value),
            Self::Alarm { number, ref text } => Message(ProgramMessage::Alarm(number, text)),
            Self::StopWithMessage { number, ref text } => Message(ProgramMessage::Stop(number, text)),
            Self::Print { ref text } => Message(ProgramMessage::Print(text)),
            Self::DisplayMessage { ref text } => Message(ProgramMessage::Show(text)),
        }
    }

    /// Whether it may stand between the moves of a contour that is calculated ahead: it changes no position and does not
    /// stop reading ahead.
    pub(super) fn may_stand_in_contour(&self) -> bool {
        match self.effect() {
            OpEffect::PathMode(_) | OpEffect::Dwell(_) | OpEffect::Speed(..) | OpEffect::SpeedLimit(_) => true,
            OpEffect::MCode(_) => !self.stops_look_ahead(),
            OpEffect::Variable(..) | OpEffect::Message(ProgramMessage::Show(_) | ProgramMessage::Print(_)) => true,
            OpEffect::SystemVariable(number, _) => system_variable::is_display_only(number),
            OpEffect::Message(_) | OpEffect::Oscillation(_) => false,
            OpEffect::Motion(_) | OpEffect::Coordinates(_) | OpEffect::IndexTurret { .. } => false,
        }
    }
}

#[inline]
const fn line(to: WorkPos, words: AxisSet, incremental: AxisSet) -> WorkMove {
    WorkMove { to, arc: None, rapid: false, feed: None, skip_signal: None, words, incremental }
}

#[inline]
const fn motion<'a>(by: WorkMove) -> OpEffect<'a> {
    OpEffect::Motion(OpMotion::Work(by))
}

impl OpEffect<'_> {
    /// Whether the axes move. Oscillation does not count.
    #[must_use]
    pub const fn is_motion(&self) -> bool {
        match self {
            Self::Motion(_) | Self::IndexTurret { by: Some(_), .. } => true,
            Self::IndexTurret { by: None, .. } | Self::Coordinates(_) | Self::Oscillation(_) => false,
            Self::PathMode(_) | Self::Dwell(_) | Self::Speed(..) | Self::SpeedLimit(_) => false,
            Self::MCode(_) | Self::Variable(..) | Self::SystemVariable(..) | Self::Message(_) => false,
        }
    }

    /// Whether the position afterwards can be computed without the machine: not after G31, G50, G27 and G78.
    #[must_use]
    pub const fn leaves_position_known(&self) -> bool {
        match self {
            Self::Motion(motion) => match motion {
                OpMotion::Work(by) => by.skip_signal.is_none(),
                OpMotion::DressPoint { .. } | OpMotion::Gauge(_) => false,
                OpMotion::Machine { .. } | OpMotion::Reference { .. } => true,
                OpMotion::Thread(_) | OpMotion::HomeSwitch(_) => true,
            },
            Self::Coordinates(change) => match change {
                CoordinateChange::Set(_) => false,
                CoordinateChange::Select(_) | CoordinateChange::Local(_) => true,
                CoordinateChange::Tool { .. } | CoordinateChange::AddWear { .. } => true,
            },
            Self::IndexTurret { .. } | Self::Oscillation(_) | Self::PathMode(_) | Self::Dwell(_) => true,
            Self::Speed(..) | Self::SpeedLimit(_) | Self::MCode(_) | Self::Message(_) => true,
            Self::Variable(..) | Self::SystemVariable(..) => true,
        }
    }

    /// The axes that the operation moves by name.
    #[must_use]
    pub fn named_axes(&self) -> AxisSet {
        match self {
            Self::Motion(motion) => motion.named_axes(),
            Self::IndexTurret { by: Some(_), .. } => AxisSet::XZ,
            Self::IndexTurret { by: None, .. } | Self::Coordinates(_) | Self::Oscillation(_) => AxisSet::NONE,
            Self::PathMode(_) | Self::Dwell(_) | Self::Speed(..) | Self::SpeedLimit(_) => AxisSet::NONE,
            Self::MCode(_) | Self::Variable(..) | Self::SystemVariable(..) | Self::Message(_) => AxisSet::NONE,
        }
    }
}

impl OpMotion<'_> {
    /// Whether the motion may leave the soft limits: homing moves on until its switch.
    #[must_use]
    pub const fn ignores_soft_limits(&self) -> bool {
        match self {
            Self::HomeSwitch(_) => true,
            Self::Work(_) | Self::Machine { .. } | Self::Reference { .. } | Self::DressPoint { .. } => false,
            Self::Gauge(_) | Self::Thread(_) => false,
        }
    }

    /// The programmed axes.
    #[must_use]
    pub fn named_axes(&self) -> AxisSet {
        match self {
            Self::Work(WorkMove { words, .. }) | Self::Reference { words, .. } => *words,
            Self::DressPoint { axes, .. } | Self::HomeSwitch(axes) => *axes,
            Self::Machine { to, .. } => AxisSet::of_some(*to),
            Self::Gauge(gauging) => AxisSet::of(gauging.axis),
            Self::Thread(_) => AxisSet::XZ,
        }
    }

    /// Passes the path to `put`, one segment after the other, from a work position.
    #[inline]
    pub fn trace(
        &self,
        from: WorkPos,
        offsets: &WorkOffsets,
        references: &[MachinePos; REFERENCE_POINTS],
        mut put: impl FnMut(MotionSegment),
    ) {
        match *self {
            Self::Work(WorkMove { to, arc, rapid, feed, .. }) => {
                put(MotionSegment { to, arc, rapid, speed: feed.map_or(SegmentSpeed::Rapid, SegmentSpeed::Feed) });
            }
            Self::Machine { to, feed } => {
                let work = |axis: Axis| to[axis].map_or(from[axis], |to| to - offsets.machine_minus_work(axis));
                let to = WorkPos::from_fn(work);
                put(feed.map_or_else(|| MotionSegment::rapid(to), |feed| MotionSegment::feed(to, feed)));
            }
            Self::Reference { number, via, words, .. } => {
                put(MotionSegment::rapid(via));
                let at = references[usize::from(number).clamp(1, REFERENCE_POINTS) - 1];
                let home = offsets.work_from_machine(at);
                let end = |axis: Axis| if words.contains(axis) { home[axis] } else { via[axis] };
                put(MotionSegment::rapid(WorkPos::from_fn(end)));
            }
            // Only the machine knows the dressing point.
            Self::DressPoint { .. } => {}
            Self::Gauge(gauging) => {
                // Without a part the axis moves to the limit and retracts.
                let (mut to, begin) = (from, from[gauging.axis]);
                let feed = Feed::PerMinute(gauging.fast_mm_min);
                to[gauging.axis] = gauging.to;
                put(MotionSegment::feed(to, feed));
                to[gauging.axis] += gauging.retract_mm.copysign(begin - gauging.to);
                put(MotionSegment::feed(to, feed));
            }
            Self::Thread(&ThreadMove { to, run_out_start, lead_mm }) => {
                // The run-out takes the time of the thread's last millimetres: X retracts meanwhile.
                let turns = (to[Axis::Z] - from[Axis::Z]).abs() / lead_mm;
                for (to, turns) in [(run_out_start, turns), (to, 0.0)] {
                    put(MotionSegment { to, arc: None, rapid: false, speed: SegmentSpeed::Revolutions(turns) });
                }
            }
            Self::HomeSwitch(axes) => {
                let (home, mut to) = (offsets.work_from_machine(references[0]), from);
                for axis in axes.iter() {
                    to[axis] = home[axis];
                    put(MotionSegment::rapid(to));
                }
            }
        }
    }
}

impl MotionSegment {
    const fn rapid(to: WorkPos) -> Self {
        Self { to, arc: None, rapid: true, speed: SegmentSpeed::Rapid }
    }

    const fn feed(to: WorkPos, feed: Feed) -> Self {
        Self { to, arc: None, rapid: false, speed: SegmentSpeed::Feed(feed) }
    }
}

/// Smaller sweeps are a full circle, radian.
const MIN_SWEEP: f64 = 1e-9;

impl ArcMove {
    /// The angle of a point around the centre, radian, from the plane's first axis to the second.
    #[must_use]
    pub fn angle_of(&self, point: WorkPos) -> f64 {
        let (first, second) = self.plane.axes();
        (point[second] - self.center[second]).atan2(point[first] - self.center[first])
    }

    /// Radius at a point, mm.
    #[must_use]
    pub fn radius_at(&self, point: WorkPos) -> f64 {
        let (first, second) = self.plane.axes();
        (point[first] - self.center[first]).hypot(point[second] - self.center[second])
    }

    /// The angle from one point to another in the direction of the arc, radian; a full turn if they are equal.
    #[must_use]
    pub fn sweep(&self, from: WorkPos, to: WorkPos) -> f64 {
        let swept = self.sweep_to_angle(from, self.angle_of(to));
        if swept <= MIN_SWEEP { std::f64::consts::TAU } else { swept }
    }

    /// The angle from a point to an angle in the direction of the arc, radian, from 0 to a full turn.
    #[must_use]
    pub fn sweep_to_angle(&self, from: WorkPos, angle: f64) -> f64 {
        (f64::from(self.turn) * (angle - self.angle_of(from))).rem_euclid(std::f64::consts::TAU)
    }

    /// `base` with the two axes of the plane on the circle at an angle.
    #[must_use]
    pub fn point_at(&self, mut base: WorkPos, radius: f64, angle: f64) -> WorkPos {
        let (first, second) = self.plane.axes();
        base[first] = self.center[first] + radius * angle.cos();
        base[second] = self.center[second] + radius * angle.sin();
        base
    }
}

impl CoordinateChange {
    /// Changes the offsets. `machine` is the present machine position.
    pub fn apply(&self, offsets: &mut WorkOffsets, machine: MachinePos) {
        match *self {
            Self::Select(g) => offsets.activate(g),
            Self::Local(values) => offsets.set_local(&values),
            Self::Set(values) => offsets.set_coordinates(machine, &values),
            Self::Tool { tool, offset } => offsets.call_tool(tool, offset),
            Self::AddWear { number, by } => offsets.add_wear(number, by),
        }
    }
}

impl MCodeWords {
    /// The unit that the code switches in a dialect, and whether on.
    #[must_use]
    pub fn switched_unit(&self, dialect: Dialect) -> Option<(SwitchedUnit, bool)> {
        dialect.m_code(u16::from(self.code)).and_then(|row| row.action.switched_unit())
    }
}
