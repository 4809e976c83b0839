//! The axes: who controls them, their set-points and their actual positions.
//!
//! Owns the trajectory planner, one mover per axis and the machine zero set by homing. Machine coordinates, radius mm.
//! Source: spec B5, B7.

pub mod homing;
pub mod jog_demand;
mod leadscrew;
pub mod oscillation;
pub mod spindle_encoder;
pub mod thread_recorder;

use homing::AxisHoming;
use leadscrew::LeadscrewCompensator;

use crate::defs::leadscrew::LeadscrewCompensation;
use crate::defs::param::{self, Params};
use crate::io::InputImage;
use crate::motion::{AxisLimits, AxisMover, MotionLimits, Override, ThreadMover, TrajectoryPlanner};
use crate::units::{Axis, EncoderPos, MachinePos, Micros, PerAxis, WorkBudget};

/// Seconds in a minute: parameters are per minute, motion per second.
pub const SECONDS_PER_MINUTE: f64 = 60.0;

/// Two positions closer than this, mm, count as equal; far below the resolution.
const SAME_POSITION_MM: f64 = 1e-5;

/// Who moves the axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisOwner {
    /// Jog, step, handwheel, homing.
    Manual,
    /// The program.
    Program,
}

/// Set-points and the direction from which they were reached.
#[derive(Clone, Copy, Debug)]
struct Commanded {
    set_point: MachinePos,
    /// The last move of each axis was in the minus direction: backlash is taken up on that side.
    last_move_minus: PerAxis<bool>,
}

/// Positions from the encoders.
#[derive(Clone, Copy, Debug)]
struct Feedback {
    /// Machine coordinate minus encoder reading.
    machine_minus_encoder_mm: PerAxis<f64>,
    /// Measured positions.
    measured: MachinePos,
    /// Displayed positions: equal to `measured`, except under machine lock.
    actual: MachinePos,
    /// Change of `measured` in the last tick, mm/s.
    velocity_mm_s: PerAxis<f64>,
}

/// An axis that oscillates independently of the owner.
#[derive(Clone, Copy, Debug)]
struct OscillatingAxis {
    axis: Axis,
    position: f64,
    velocity_mm_s: f64,
    /// Position of the axis when oscillation began, machine mm: the position that program and planner use for it.
    start_mm: f64,
    /// The oscillation is over. The axis holds its position until the path has come to rest.
    releasing: bool,
}

/// All axes of the machine.
#[derive(Debug)]
pub struct Axes {
    /// The program's moves.
    pub planner: TrajectoryPlanner,
    /// One mover per axis for everything else.
    pub movers: PerAxis<AxisMover>,
    present: PerAxis<bool>,
    owner: AxisOwner,
    homed: PerAxis<bool>,
    /// Axes whose absolute encoder is not believed until they are homed.
    doubted: PerAxis<bool>,
    feedback: Feedback,
    commanded: Commanded,
    velocity_mm_s: PerAxis<f64>,
    oscillating: Option<OscillatingAxis>,
    /// Leadscrew compensation added to the set-points.
    compensation: LeadscrewCompensator,
    /// The thread being cut.
    thread: Option<ThreadMover>,
    /// The homing that a program has started.
    pub homing: Option<AxisHoming>,
    /// Machine lock: the real set-points while the displayed positions keep counting.
    locked: Option<Commanded>,
    /// Tick time, as read at power-on (P58).
    tick_time: Micros,
    /// Sum of all shifts of the machine zero by homing, mm.
    zero_shift_mm: PerAxis<f64>,
}

impl Axes {
    /// Axes at rest at their encoder positions; not homed.
    #[must_use]
    pub fn new(params: &Params, image: &InputImage, screws: PerAxis<LeadscrewCompensation>) -> Self {
        let tick_time = Micros(params.get(param::TICK_TIME) as u64);
        let tick_s = tick_time.as_secs_f64();
        let limits = limits(params, tick_s);
        // Not homed: the machine zero is where the drives were switched on.
        let start = MachinePos::new(image.encoder_mm.coordinates());
        let movers = PerAxis::from_fn(|axis| AxisMover::new(limits.axes[axis], start[axis], limits.tick_s));
        Self {
            planner: TrajectoryPlanner::new(limits, start),
            movers,
            present: params.fitted().axes(),
            owner: AxisOwner::Manual,
            homed: PerAxis::default(),
            doubted: PerAxis::default(),
            feedback: Feedback {
                machine_minus_encoder_mm: PerAxis::default(),
                measured: start,
                actual: start,
                velocity_mm_s: PerAxis::default(),
            },
            commanded: Commanded { set_point: start, last_move_minus: PerAxis::default() },
            velocity_mm_s: PerAxis::default(),
            oscillating: None,
            compensation: LeadscrewCompensator::new(screws, params, tick_s),
            thread: None,
            homing: None,
            locked: None,
            tick_time,
            zero_shift_mm: PerAxis::default(),
        }
    }

    /// Applies changed limits. Call only while nothing runs.
    pub fn configure(&mut self, params: &Params) {
        let limits = limits(params, self.tick_time.as_secs_f64());
        if self.planner.is_done() {
            self.planner.set_limits(limits);
        }
        for axis in Axis::ALL {
            self.movers[axis].set_limits(limits.axes[axis]);
            self.apply_soft_limits(axis, params);
        }
        self.compensation.configure(params);
    }

    /// Applies the soft limits if the axis is homed (B5). An axis that homing left beyond a limit may only move back.
    pub fn apply_soft_limits(&mut self, axis: Axis, params: &Params) {
        let bounds = self.homed[axis].then(|| soft_limits(params, axis));
        self.movers[axis].set_bounds(bounds);
    }

    /// Sets the machine zero of an axis: the position `edge` (in present machine coordinates) becomes `coordinate`.
    /// The axis must be at rest. It is homed only when it reaches its zero point, see [`Self::finish_homing`].
    pub fn set_zero(&mut self, axis: Axis, edge: f64, coordinate: f64) {
        let shift = coordinate - edge;
        self.zero_shift_mm[axis] += shift;
        self.feedback.machine_minus_encoder_mm[axis] += shift;
        self.feedback.measured[axis] += shift;
        self.feedback.actual[axis] += shift;
        self.commanded.set_point[axis] += shift;
        self.movers[axis].set_position(self.commanded.set_point[axis]);
        // From here on the leadscrew table applies. The axis does not move for it; the zero is shifted instead.
        self.feedback.machine_minus_encoder_mm[axis] +=
            self.compensation.apply_at_once(axis, self.commanded.set_point[axis], self.commanded.last_move_minus[axis]);
    }

    /// Whether an absolute encoder may say where an axis is: it is not homed and nothing moves.
    #[must_use]
    pub fn awaits_absolute_position(&self, axis: Axis) -> bool {
        let is_free = self.homing.is_none() && self.locked.is_none() && self.is_at_rest();
        self.present[axis] && !self.homed[axis] && !self.doubted[axis] && is_free
    }

    /// The machine position of an axis whose absolute encoder is at `encoder_mm`, mm.
    #[must_use]
    pub fn absolute_position(&self, axis: Axis, encoder_mm: f64) -> f64 {
        self.compensation.machine_mm(axis, encoder_mm, self.commanded.last_move_minus[axis])
    }

    /// The absolute encoder of an axis is not believed until the axis has been homed by hand.
    pub fn doubt(&mut self, axis: Axis) {
        self.doubted[axis] = true;
        self.lift_soft_limits(axis);
    }

    /// The axis has reached its zero point: it is now homed and its soft limits apply.
    pub fn finish_homing(&mut self, axis: Axis, params: &Params) {
        (self.homed[axis], self.doubted[axis]) = (true, false);
        self.apply_soft_limits(axis, params);
    }

    /// Homing searches for the switch without soft limits.
    pub fn lift_soft_limits(&mut self, axis: Axis) {
        self.homed[axis] = false;
        self.movers[axis].set_bounds(None);
    }

    /// All axes must be homed again (hard limit, drive fault, following error).
    pub fn clear_homed(&mut self) {
        self.homed = PerAxis::default();
        for axis in Axis::ALL {
            self.movers[axis].set_bounds(None);
        }
    }

    /// Reads the encoders.
    pub fn read(&mut self, image: &InputImage) {
        let applied = self.compensation.applied_mm();
        let before = self.feedback.measured;
        self.feedback.measured = MachinePos::from_fn(|axis| {
            image.encoder_mm[axis] + self.feedback.machine_minus_encoder_mm[axis] - applied[axis]
        });
        let (now, tick_s) = (self.feedback.measured, self.tick_time().as_secs_f64());
        self.feedback.velocity_mm_s = PerAxis::from_fn(|axis| (now[axis] - before[axis]) / tick_s);
        self.feedback.actual = if self.locked.is_some() { self.commanded.set_point } else { self.feedback.measured };
    }

    /// One tick of the owner of the axes. A thread follows `spindle_turns` (revolutions).
    pub fn tick(&mut self, rate: Override, spindle_turns: f64, budget: &mut WorkBudget) {
        let before = self.commanded.set_point;
        self.release_oscillation();
        match self.owner {
            AxisOwner::Program => {
                let point = self.planner.tick_within(rate, budget);
                (self.commanded.set_point, self.velocity_mm_s) = (point.position, point.velocity_mm_s);
            }
            AxisOwner::Manual => {
                for axis in Axis::ALL {
                    (self.commanded.set_point[axis], self.velocity_mm_s[axis]) = self.movers[axis].tick();
                }
            }
        }
        if let Some(OscillatingAxis { axis, position, velocity_mm_s, .. }) = self.oscillating {
            (self.commanded.set_point[axis], self.velocity_mm_s[axis]) = (position, velocity_mm_s);
        }
        if let Some(thread) = &mut self.thread {
            let point = thread.tick(spindle_turns);
            for axis in [Axis::X, Axis::Z] {
                self.commanded.set_point[axis] = point.position[axis];
                self.velocity_mm_s[axis] = point.velocity_mm_s[axis];
            }
            if thread.is_finished() {
                self.thread = None;
                self.planner.reset_to(self.commanded.set_point);
            }
        }
        for axis in Axis::ALL {
            let moved = self.commanded.set_point[axis] - before[axis];
            if moved.abs() > 0.0 {
                self.commanded.last_move_minus[axis] = moved < 0.0;
            }
        }
        let Commanded { set_point: set, last_move_minus: minus } = self.physical_position();
        for axis in Axis::ALL {
            self.compensation.step(axis, set[axis], minus[axis], self.homed[axis]);
        }
    }

    /// Starts a thread, which takes over X and Z. The path must be at rest.
    pub fn begin_thread(&mut self, mover: ThreadMover) {
        self.thread = Some(mover);
    }

    /// The thread being cut, if any.
    #[must_use]
    pub const fn thread(&self) -> Option<&ThreadMover> {
        self.thread.as_ref()
    }

    /// The limits for moves of the program.
    #[must_use]
    pub fn path_limits(&self, params: &Params) -> MotionLimits {
        limits(params, self.tick_time.as_secs_f64())
    }

    /// Sets position (mm) and velocity (mm/s) of the oscillating axis for this tick; `None` ends the oscillation.
    pub fn set_oscillation(&mut self, strokes: Option<(Axis, f64, f64)>) {
        match (&mut self.oscillating, strokes) {
            (Some(oscillating), None) => {
                oscillating.releasing = true;
                self.release_oscillation();
            }
            (before, Some((axis, position, velocity_mm_s))) => {
                let start_mm = before.map_or(self.commanded.set_point[axis], |before| before.start_mm);
                *before = Some(OscillatingAxis { axis, position, velocity_mm_s, start_mm, releasing: false });
            }
            (None, None) => {}
        }
    }

    /// Releases the axis once the path is at rest, so that no pending move can displace it.
    fn release_oscillation(&mut self) {
        let Some(oscillating) = self.oscillating.as_mut().filter(|oscillating| oscillating.releasing) else { return };
        if self.owner == AxisOwner::Program && !self.planner.is_at_rest() {
            oscillating.velocity_mm_s = 0.0;
            return;
        }
        let OscillatingAxis { axis, position, start_mm, .. } = *oscillating;
        self.movers[axis].set_position(position);
        // Stopped at its start point, the path continues from there. Stopped elsewhere, its moves are discarded.
        let elsewhere = (position - start_mm).abs() > SAME_POSITION_MM;
        if self.owner == AxisOwner::Program && (elsewhere || self.planner.is_done()) {
            self.planner.reset_to(self.commanded.set_point);
        }
        self.oscillating = None;
    }

    /// The set-points as the program sees them: an oscillating axis counts as being at its start point.
    #[must_use]
    pub fn program_set_point(&self) -> MachinePos {
        let mut set = self.commanded.set_point;
        if let Some(OscillatingAxis { axis, start_mm, .. }) = self.oscillating {
            set[axis] = start_mm;
        }
        set
    }

    /// The set-point of each axis in encoder coordinates, mm.
    #[must_use]
    pub fn encoder_set_points(&self) -> EncoderPos {
        let Commanded { set_point: set, .. } = self.physical_position();
        let applied = self.compensation.applied_mm();
        EncoderPos::from_fn(|axis| set[axis] - self.feedback.machine_minus_encoder_mm[axis] + applied[axis])
    }

    /// The real set-points and last directions, with machine lock on or off.
    fn physical_position(&self) -> Commanded {
        self.locked.unwrap_or(self.commanded)
    }

    /// Replaces the leadscrew table of an axis. The correction is applied by a ramp.
    pub fn set_leadscrew_table(&mut self, axis: Axis, table: LeadscrewCompensation) {
        self.compensation.set_table(axis, table);
    }

    /// The leadscrew table of an axis.
    #[must_use]
    pub fn leadscrew_table(&self, axis: Axis) -> &LeadscrewCompensation {
        self.compensation.table(axis)
    }

    /// Machine lock on: the displayed positions count while the axes stand. The axes must be at rest.
    pub const fn lock(&mut self) {
        if self.locked.is_none() {
            self.locked = Some(self.commanded);
        }
    }

    /// Whether machine lock is on.
    #[must_use]
    pub const fn is_locked(&self) -> bool {
        self.locked.is_some()
    }

    /// Tick time, as read at power-on (P58).
    #[must_use]
    pub const fn tick_time(&self) -> Micros {
        self.tick_time
    }

    /// Machine lock off: displays the real positions again.
    pub fn unlock(&mut self) {
        let Some(real) = self.locked.take() else { return };
        (self.commanded, self.feedback.actual) = (real, self.feedback.measured);
        let set = real.set_point;
        self.planner.reset_to(set);
        self.set_movers(set);
    }

    /// Hands the axes over to the program at their present position.
    pub fn switch_to_program(&mut self) {
        if self.owner == AxisOwner::Manual && self.planner.is_at_rest() {
            self.planner.reset_to(self.program_set_point());
            self.owner = AxisOwner::Program;
        }
    }

    /// Hands the axes over to the movers at their present position.
    pub fn switch_to_manual(&mut self) {
        if self.owner == AxisOwner::Program && self.planner.is_at_rest() {
            self.set_movers(self.commanded.set_point);
            self.owner = AxisOwner::Manual;
        }
    }

    /// Sets the positions from which the movers continue, machine mm.
    fn set_movers(&mut self, at: MachinePos) {
        for axis in Axis::ALL {
            self.movers[axis].set_position(at[axis]);
        }
    }

    /// Who moves the axes.
    #[must_use]
    pub const fn owner(&self) -> AxisOwner {
        self.owner
    }

    /// Brakes all motion: the path along its contour, the movers at full deceleration.
    pub fn brake(&mut self) {
        if let Some(thread) = &mut self.thread {
            thread.abort();
        }
        match self.owner {
            AxisOwner::Program => self.planner.abort(),
            AxisOwner::Manual => {
                for mover in &mut self.movers.0 {
                    mover.emergency_stop();
                }
            }
        }
    }

    /// Whether no set-point moves.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        if self.thread.is_some() {
            return false;
        }
        match self.owner {
            AxisOwner::Program => self.planner.is_at_rest(),
            AxisOwner::Manual => self.movers.iter().all(|(_, mover)| mover.is_at_rest()),
        }
    }

    /// Whether every axis is within the in-position width (mm) of its set-point; an oscillating axis is not checked.
    #[must_use]
    pub fn is_in_position(&self, params: &Params) -> bool {
        let oscillating = self.oscillating.map(|oscillating| oscillating.axis);
        self.present().all(|axis| Some(axis) == oscillating || self.is_axis_in_position(axis, params))
    }

    /// Whether one axis is within the in-position width of its set-point.
    #[must_use]
    pub fn is_axis_in_position(&self, axis: Axis, params: &Params) -> bool {
        (self.commanded.set_point[axis] - self.feedback.actual[axis]).abs() <= params.get(param::IN_POSITION)
    }

    /// The first axis whose following error exceeds the limit, mm. Only supervised while the drives are on.
    #[must_use]
    pub fn first_following_error(&self, params: &Params) -> Option<Axis> {
        let limit = params.get(param::FOLLOWING_LIMIT);
        let set = self.locked.map_or(self.commanded.set_point, |locked| locked.set_point);
        self.present().find(|axis| (set[*axis] - self.feedback.measured[*axis]).abs() > limit)
    }

    /// Drives off: the set-points of these axes follow the actual positions, so that switching on causes no jump.
    pub fn follow_actual(&mut self, which: PerAxis<bool>) {
        if self.planner.is_at_rest() {
            for axis in Axis::ALL.into_iter().filter(|axis| which[*axis]) {
                self.commanded.set_point[axis] = self.feedback.actual[axis];
            }
            self.set_movers(self.commanded.set_point);
            self.owner = AxisOwner::Manual;
        }
    }

    /// Which axes the machine has.
    #[must_use]
    pub const fn fitted(&self) -> PerAxis<bool> {
        self.present
    }

    /// Whether the machine has an axis.
    #[must_use]
    pub fn is_present(&self, axis: Axis) -> bool {
        self.present[axis]
    }

    /// The axes of the machine.
    pub fn present(&self) -> impl Iterator<Item = Axis> + use<> {
        let present = self.present;
        Axis::ALL.into_iter().filter(move |axis| present[*axis])
    }

    /// Whether an axis is homed.
    #[must_use]
    pub fn is_homed(&self, axis: Axis) -> bool {
        self.homed[axis]
    }

    /// Whether all axes are homed.
    #[must_use]
    pub fn all_homed(&self) -> bool {
        self.present().all(|axis| self.homed[axis])
    }

    /// The machine position of an axis at a position of its encoder, mm, as it is compensated now; none while the
    /// machine is locked.
    #[must_use]
    pub fn position_at(&self, axis: Axis, encoder_mm: f64) -> Option<f64> {
        let applied = self.compensation.applied_mm();
        let at = encoder_mm + self.feedback.machine_minus_encoder_mm[axis] - applied[axis];
        self.locked.is_none().then_some(at)
    }

    /// Speed of each axis by its encoder in the last tick, mm/s.
    #[must_use]
    pub const fn actual_velocity_mm_s(&self) -> PerAxis<f64> {
        self.feedback.velocity_mm_s
    }

    /// Machine position from the encoders, mm.
    #[must_use]
    pub const fn actual(&self) -> MachinePos {
        self.feedback.actual
    }

    /// Sum of all shifts of the machine zero by homing, mm: coordinates of before and after differ by what it grows.
    #[must_use]
    pub const fn zero_shift_mm(&self) -> PerAxis<f64> {
        self.zero_shift_mm
    }

    /// Machine set-point, mm.
    #[must_use]
    pub const fn set_point(&self) -> MachinePos {
        self.commanded.set_point
    }

    /// Commanded velocity, mm/s.
    #[must_use]
    pub const fn velocity_mm_s(&self) -> PerAxis<f64> {
        self.velocity_mm_s
    }
}

/// Soft limits of an axis, machine coordinates, radius mm: low, high.
#[must_use]
pub fn soft_limits(params: &Params, axis: Axis) -> (f64, f64) {
    (params.get_axis(param::SOFT_MINUS_X, axis), params.get_axis(param::SOFT_PLUS_X, axis))
}

/// The planner's limits from the parameters.
pub fn limits(params: &Params, tick_s: f64) -> MotionLimits {
    MotionLimits {
        axes: PerAxis::from_fn(|axis| AxisLimits {
            velocity_mm_s: params.get_axis(param::RAPID_X, axis) / SECONDS_PER_MINUTE,
            acceleration_mm_s2: params.get_axis(param::ACCELERATION_X, axis),
            jerk_mm_s3: params.get_axis(param::JERK_X, axis),
        }),
        tick_s,
    }
}
