//! The axes: who controls them, their set-points and their actual positions.
//!
//! Owns the trajectory planner, one mover per axis and the machine zero set by homing. Machine coordinates, radius mm.
//! Source: spec B5, B7.

use super::screw::Compensation;
use crate::defs::param::{self, Params};
use crate::defs::screw::ScrewTable;
use crate::io::InputImage;
use crate::machine::kind::KindRow;
use crate::motion::{AxisLimits, AxisMover, Limits, Override, Path, ThreadMover};
use crate::units::{Axis, PerAxis};

/// Seconds in a minute: parameters are per minute, motion per second.
pub const MINUTE: f64 = 60.0;

/// Two positions closer than this, mm, count as equal; far below the resolution.
const SAME_PLACE_MM: f64 = 1e-5;

/// Who moves the axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Owner {
    /// Jog, step, handwheel, homing.
    Hand,
    /// The program.
    Path,
}

/// The real set-points while machine lock is on.
#[derive(Clone, Copy, Debug)]
struct Locked {
    set: PerAxis<f64>,
    minus: PerAxis<bool>,
}

/// All axes of the machine.
#[derive(Debug)]
pub struct Axes {
    /// The program's moves.
    pub path: Path,
    /// One mover per axis for everything else.
    pub movers: PerAxis<AxisMover>,
    present: PerAxis<bool>,
    owner: Owner,
    /// Machine coordinate minus encoder reading.
    zero_mm: PerAxis<f64>,
    homed: PerAxis<bool>,
    /// Actual positions from the encoders.
    encoder: PerAxis<f64>,
    /// Displayed positions: equal to `encoder`, except under machine lock.
    actual: PerAxis<f64>,
    /// Set-points.
    set: PerAxis<f64>,
    velocity_mm_s: PerAxis<f64>,
    /// The last move of each axis was in the minus direction: backlash is taken up on that side.
    minus: PerAxis<bool>,
    drives_on: bool,
    /// An axis that oscillates independently of the owner: its set-point (mm) and velocity (mm/s).
    oscillated: Option<(Axis, f64, f64)>,
    /// Position of the axis when oscillation began, machine mm: the position that program and planner use for it.
    frozen: f64,
    /// The oscillation is over. The axis holds its position until the path has come to rest.
    releasing: bool,
    /// Leadscrew compensation added to the set-points.
    screws: Compensation,
    /// The thread being cut.
    thread: Option<ThreadMover>,
    /// Machine lock: the real set-points while the displayed positions keep counting.
    locked: Option<Locked>,
    /// Tick time, s, as read at power-on (P58).
    tick_s: f64,
}

impl Axes {
    /// Axes at rest at their encoder positions; not homed.
    #[must_use]
    pub fn new(params: &Params, row: &KindRow, image: &InputImage, screws: PerAxis<ScrewTable>) -> Self {
        let tick_s = params.get(param::TICK_TIME) / 1e6;
        let limits = limits(params, tick_s);
        let start = image.encoder_mm;
        let movers = PerAxis::from_fn(|axis| AxisMover::new(limits.axes[axis], start[axis], limits.tick_s));
        Self {
            path: Path::new(limits, start),
            movers,
            present: row.fitted(params),
            owner: Owner::Hand,
            zero_mm: PerAxis::default(),
            homed: PerAxis::default(),
            encoder: start,
            actual: start,
            set: start,
            velocity_mm_s: PerAxis::default(),
            minus: PerAxis::default(),
            drives_on: true,
            oscillated: None,
            frozen: 0.0,
            releasing: false,
            screws: Compensation::new(screws, params, tick_s),
            thread: None,
            locked: None,
            tick_s,
        }
    }

    /// Applies changed limits. Call only while nothing runs.
    pub fn configure(&mut self, params: &Params) {
        let limits = limits(params, self.tick_s);
        if self.path.is_done() {
            self.path.set_limits(limits);
        }
        for axis in Axis::ALL {
            self.movers[axis].set_limits(limits.axes[axis]);
            self.bound(axis, params);
        }
        self.screws.configure(params);
    }

    /// Applies the soft limits if the axis is homed (B5). An axis that homing left beyond a limit may only move back.
    pub fn bound(&mut self, axis: Axis, params: &Params) {
        let bounds = self.homed[axis].then(|| soft_limits(params, axis));
        self.movers[axis].set_bounds(bounds);
    }

    /// Sets the machine zero of an axis: the position `edge` (in present machine coordinates) becomes `coordinate`.
    /// The axis must be at rest. It is homed only when it reaches its zero point, see [`Self::finish_homing`].
    pub fn set_zero(&mut self, axis: Axis, edge: f64, coordinate: f64) {
        let shift = coordinate - edge;
        self.zero_mm[axis] += shift;
        self.encoder[axis] += shift;
        self.actual[axis] += shift;
        self.set[axis] += shift;
        self.movers[axis].set_position(self.set[axis]);
        // From here on the leadscrew table applies. The axis does not move for it; the zero is shifted instead.
        self.zero_mm[axis] += self.screws.settle(axis, self.set[axis], self.minus[axis]);
    }

    /// The axis has reached its zero point: it is now homed and its soft limits apply.
    pub fn finish_homing(&mut self, axis: Axis, params: &Params) {
        self.homed[axis] = true;
        self.bound(axis, params);
    }

    /// Homing searches for the switch without soft limits.
    pub fn unbound(&mut self, axis: Axis) {
        self.homed[axis] = false;
        self.movers[axis].set_bounds(None);
    }

    /// All axes must be homed again (hard limit, drive fault, following error).
    pub fn forget_zero(&mut self) {
        self.homed = PerAxis::default();
        for axis in Axis::ALL {
            self.movers[axis].set_bounds(None);
        }
    }

    /// Reads the encoders.
    pub fn read(&mut self, image: &InputImage) {
        let applied = self.screws.applied_mm();
        self.encoder = PerAxis::from_fn(|axis| image.encoder_mm[axis] + self.zero_mm[axis] - applied[axis]);
        self.actual = if self.locked.is_some() { self.set } else { self.encoder };
    }

    /// One tick of the owner of the axes. A thread follows `spindle_turns` (revolutions).
    pub fn tick(&mut self, rate: Override, spindle_turns: f64) {
        let before = self.set;
        self.release();
        match self.owner {
            Owner::Path => {
                let point = self.path.tick(rate);
                self.set = point.position;
                self.velocity_mm_s = point.velocity_mm_s;
            }
            Owner::Hand => {
                for axis in Axis::ALL {
                    let (position, velocity) = self.movers[axis].tick();
                    self.set[axis] = position;
                    self.velocity_mm_s[axis] = velocity;
                }
            }
        }
        if let Some((axis, position, velocity)) = self.oscillated {
            self.set[axis] = position;
            self.velocity_mm_s[axis] = velocity;
        }
        if let Some(thread) = &mut self.thread {
            let point = thread.tick(spindle_turns);
            for axis in [Axis::X, Axis::Z] {
                self.set[axis] = point.position[axis];
                self.velocity_mm_s[axis] = point.velocity_mm_s[axis];
            }
            if thread.is_over() {
                self.thread = None;
                self.path.clear_at(self.set);
            }
        }
        for axis in Axis::ALL {
            let moved = self.set[axis] - before[axis];
            if moved.abs() > 0.0 {
                self.minus[axis] = moved < 0.0;
            }
        }
        let Locked { set, minus } = self.standing();
        for axis in Axis::ALL {
            self.screws.step(axis, set[axis], minus[axis], self.homed[axis]);
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
    pub fn path_limits(&self, params: &Params) -> Limits {
        limits(params, self.tick_s)
    }

    /// Sets position (mm) and velocity (mm/s) of the oscillating axis for this tick; `None` ends the oscillation.
    pub fn oscillate(&mut self, strokes: Option<(Axis, f64, f64)>) {
        match (self.oscillated, strokes) {
            (None, Some((axis, ..))) => self.frozen = self.set[axis],
            (Some(_), None) => {
                self.releasing = true;
                return self.release();
            }
            (None, None) | (Some(_), Some(_)) => {}
        }
        (self.oscillated, self.releasing) = (strokes, false);
    }

    /// Releases the axis once the path is at rest, so that no pending move can displace it.
    fn release(&mut self) {
        let Some((axis, position, _)) = self.oscillated.filter(|_| self.releasing) else { return };
        if self.owner == Owner::Path && !self.path.is_at_rest() {
            self.oscillated = Some((axis, position, 0.0));
            return;
        }
        self.movers[axis].set_position(position);
        // Stopped at its start point, the path continues from there. Stopped elsewhere, its moves are discarded.
        let elsewhere = (position - self.frozen).abs() > SAME_PLACE_MM;
        if self.owner == Owner::Path && (elsewhere || self.path.is_done()) {
            self.path.clear_at(self.set);
        }
        (self.oscillated, self.releasing) = (None, false);
    }

    /// The set-points as the program sees them: an oscillating axis counts as being at its start point.
    #[must_use]
    pub fn program_set(&self) -> PerAxis<f64> {
        let mut set = self.set;
        if let Some((axis, ..)) = self.oscillated {
            set[axis] = self.frozen;
        }
        set
    }

    /// The set-point of each axis in encoder coordinates, mm.
    #[must_use]
    pub fn set_points(&self) -> PerAxis<f64> {
        let Locked { set, .. } = self.standing();
        let applied = self.screws.applied_mm();
        PerAxis::from_fn(|axis| set[axis] - self.zero_mm[axis] + applied[axis])
    }

    /// The real set-points and last directions, with machine lock on or off.
    fn standing(&self) -> Locked {
        self.locked.unwrap_or(Locked { set: self.set, minus: self.minus })
    }

    /// Replaces the leadscrew table of an axis. The correction is applied by a ramp.
    pub fn set_screw(&mut self, axis: Axis, table: ScrewTable) {
        self.screws.set_table(axis, table);
    }

    /// The leadscrew table of an axis.
    #[must_use]
    pub fn screw(&self, axis: Axis) -> &ScrewTable {
        self.screws.table(axis)
    }

    /// Machine lock on: the displayed positions count while the axes stand. The axes must be at rest.
    pub const fn lock(&mut self) {
        if self.locked.is_none() {
            self.locked = Some(Locked { set: self.set, minus: self.minus });
        }
    }

    /// Machine lock off: displays the real positions again.
    pub fn unlock(&mut self) {
        let Some(Locked { set, minus }) = self.locked.take() else { return };
        (self.set, self.minus, self.actual) = (set, minus, self.encoder);
        self.path.clear_at(set);
        for axis in Axis::ALL {
            self.movers[axis].set_position(set[axis]);
        }
    }

    /// Hands the axes over to the program at their present position.
    pub fn give_to_path(&mut self) {
        if self.owner == Owner::Hand && self.path.is_at_rest() {
            self.path.clear_at(self.program_set());
            self.owner = Owner::Path;
        }
    }

    /// Hands the axes over to the movers at their present position.
    pub fn give_to_hand(&mut self) {
        if self.owner == Owner::Path && self.path.is_at_rest() {
            for axis in Axis::ALL {
                self.movers[axis].set_position(self.set[axis]);
            }
            self.owner = Owner::Hand;
        }
    }

    /// Who moves the axes.
    #[must_use]
    pub const fn owner(&self) -> Owner {
        self.owner
    }

    /// Brakes all motion: the path along its contour, the movers at full deceleration.
    pub fn brake(&mut self) {
        if let Some(thread) = &mut self.thread {
            thread.abort();
        }
        match self.owner {
            Owner::Path => self.path.abort(),
            Owner::Hand => {
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
            Owner::Path => self.path.is_at_rest(),
            Owner::Hand => self.movers.iter().all(|(_, mover)| mover.is_at_rest()),
        }
    }

    /// Whether every axis is within the in-position width (mm) of its set-point; an oscillating axis is not checked.
    #[must_use]
    pub fn is_in_position(&self, params: &Params) -> bool {
        let oscillating = self.oscillated.map(|(axis, ..)| axis);
        self.present().all(|axis| Some(axis) == oscillating || self.is_axis_in_position(axis, params))
    }

    /// Whether one axis is within the in-position width of its set-point.
    #[must_use]
    pub fn is_axis_in_position(&self, axis: Axis, params: &Params) -> bool {
        (self.set[axis] - self.actual[axis]).abs() <= params.get(param::IN_POSITION)
    }

    /// The first axis whose following error exceeds the limit, mm.
    #[must_use]
    pub fn lost(&self, params: &Params) -> Option<Axis> {
        let limit = params.get(param::FOLLOWING_LIMIT);
        let set = self.locked.map_or(self.set, |locked| locked.set);
        self.present().find(|axis| self.drives_on && (set[*axis] - self.encoder[*axis]).abs() > limit)
    }

    /// Drives on or off. While they are off, no following error is supervised.
    pub fn set_drives(&mut self, on: bool) {
        self.drives_on = on;
    }

    /// Drives off: the set-points follow the actual positions, so that switching on causes no jump.
    pub fn follow_actual(&mut self) {
        if self.path.is_at_rest() {
            self.set = self.actual;
            for axis in Axis::ALL {
                self.movers[axis].set_position(self.actual[axis]);
            }
            self.owner = Owner::Hand;
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

    /// Machine position from the encoders, mm.
    #[must_use]
    pub const fn actual(&self) -> PerAxis<f64> {
        self.actual
    }

    /// Machine set-point, mm.
    #[must_use]
    pub const fn set(&self) -> PerAxis<f64> {
        self.set
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
    (params.of_axis(param::SOFT_MINUS_X, axis), params.of_axis(param::SOFT_PLUS_X, axis))
}

/// The planner's limits from the parameters.
pub fn limits(params: &Params, tick_s: f64) -> Limits {
    Limits {
        axes: PerAxis::from_fn(|axis| AxisLimits {
            velocity_mm_s: params.of_axis(param::RAPID_X, axis) / MINUTE,
            acceleration_mm_s2: params.of_axis(param::ACCELERATION_X, axis),
            jerk_mm_s3: params.of_axis(param::JERK_X, axis),
        }),
        tick_s,
    }
}
