//! Motion of a single axis: jog, handwheel, homing, return to a point, oscillation.
//!
//! Holds position, velocity and acceleration of the axis and its bounds. Knows nothing of programs and paths. Every
//! command takes effect from the present state, moving or not.
//! Source: spec, motion: jog and handwheel; software limits that brake in time.

use super::profile::{AxisLimits, AxisState, MotionProfile};

/// Factor on the jerk limit in an emergency stop; deceleration stays at its limit.
pub const EMERGENCY_JERK_FACTOR: f64 = 10.0;

/// The active command of the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
enum MoverCommand {
    Rest,
    Velocity(f64),
    Position { target: f64, velocity: f64 },
    Stop,
    Emergency,
}

/// Moves one axis within velocity, acceleration and jerk.
#[derive(Clone, Debug)]
pub struct AxisMover {
    limits: AxisLimits,
    tick_s: f64,
    bounds: Option<(f64, f64)>,
    command: MoverCommand,
    profile: MotionProfile,
    ticks: u32,
    state: AxisState,
}

/// After this many ticks a constant velocity is planned again, so that the tick count never overflows.
const MAX_PROFILE_TICKS: u32 = 1 << 30;

impl AxisMover {
    /// An axis at rest at `position` mm; `tick_s` is the length of a tick, s.
    #[must_use]
    pub fn new(limits: AxisLimits, position: f64, tick_s: f64) -> Self {
        let state = AxisState::at_rest(position);
        let profile = MotionProfile::resting_at(position);
        Self { limits, tick_s, bounds: None, command: MoverCommand::Rest, profile, ticks: 0, state }
    }

    /// Sets the limits; they apply at once, and a velocity above them decreases at once.
    pub fn set_limits(&mut self, limits: AxisLimits) {
        self.limits = limits;
        self.plan(self.command);
    }

    /// Sets the position, mm, at rest and discards any motion; after homing or motion by another module.
    pub fn set_position(&mut self, position: f64) {
        self.state = AxisState::at_rest(position);
        self.plan(MoverCommand::Rest);
    }

    /// Takes over the axis in motion; it brakes until the next command.
    pub fn set_state(&mut self, state: AxisState) {
        self.state = state;
        self.plan(MoverCommand::Stop);
    }

    /// Sets the soft limits (low, high), mm. An active motion is planned again: it ends at or before the limit, or
    /// returns to it if it was too near to brake. From outside the limits, the axis moves only inward.
    pub fn set_bounds(&mut self, bounds: Option<(f64, f64)>) {
        if bounds != self.bounds {
            self.bounds = bounds;
            self.plan(self.command);
        }
    }

    /// Jogs at `velocity` mm/s (clamped to the axis limit) until the next command or a soft limit; 0 stops.
    pub fn set_velocity_target(&mut self, velocity: f64) {
        let top = self.limits.velocity_mm_s;
        self.set_command(MoverCommand::Velocity(velocity.clamp(-top, top)));
    }

    /// Moves to `position` mm (clamped to the bounds) at no more than `velocity` mm/s and stops there exactly. A new
    /// target may be given at any time, moving or not.
    pub fn set_position_target(&mut self, position: f64, velocity: f64) {
        let velocity = velocity.abs().min(self.limits.velocity_mm_s);
        self.set_command(MoverCommand::Position { target: position, velocity });
    }

    /// Brakes to rest within the limits.
    pub fn stop(&mut self) {
        self.set_command(MoverCommand::Stop);
    }

    /// Brakes to rest at full deceleration with [`EMERGENCY_JERK_FACTOR`] times the jerk limit.
    pub fn emergency_stop(&mut self) {
        self.set_command(MoverCommand::Emergency);
    }

    /// Advances by one tick; returns position in mm and velocity in mm/s at its end.
    pub fn tick(&mut self) -> (f64, f64) {
        if self.ticks >= MAX_PROFILE_TICKS {
            self.plan(self.command);
        }
        self.ticks += 1;
        self.state = self.profile.at(f64::from(self.ticks) * self.tick_s);
        (self.state.position, self.state.velocity)
    }

    /// Position, mm.
    #[must_use]
    pub const fn position(&self) -> f64 {
        self.state.position
    }

    /// Velocity, mm/s.
    #[must_use]
    pub const fn velocity_mm_s(&self) -> f64 {
        self.state.velocity
    }

    /// Whether the axis is at rest and its command is done.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        let end = self.profile.end();
        f64::from(self.ticks) * self.tick_s >= self.profile.seconds() && end == AxisState::at_rest(end.position)
    }

    fn set_command(&mut self, demand: MoverCommand) {
        if demand != self.command {
            self.plan(demand);
        }
    }

    fn plan(&mut self, demand: MoverCommand) {
        self.command = demand;
        self.ticks = 0;
        let (start, limits) = (self.state, self.limits);
        self.profile = match demand {
            MoverCommand::Rest => MotionProfile::to_velocity(start, 0.0, limits),
            MoverCommand::Velocity(velocity) => self.jog_profile(velocity),
            MoverCommand::Position { target, velocity } if velocity > 0.0 => {
                let target = self.clamp_to_bounds(target);
                MotionProfile::to_position(start, target, AxisLimits { velocity_mm_s: velocity, ..limits })
            }
            MoverCommand::Position { .. } | MoverCommand::Stop => self.stop_profile(limits),
            MoverCommand::Emergency => {
                let jerk_mm_s3 = limits.jerk_mm_s3 * EMERGENCY_JERK_FACTOR;
                MotionProfile::to_velocity(start, 0.0, AxisLimits { jerk_mm_s3, ..limits })
            }
        };
    }

    /// A target clamped to the bounds. From outside, the bounds are extended to the axis position, so that it moves
    /// only inward and no farther than requested.
    fn clamp_to_bounds(&self, target: f64) -> f64 {
        let from = self.state.position;
        self.bounds.map_or(target, |(low, high)| target.max(low.min(from)).min(high.max(low).max(from)))
    }

    /// Profile to rest. If braking would cross a bound that was set too late, it ends on the bound.
    fn stop_profile(&self, limits: AxisLimits) -> MotionProfile {
        let brake = MotionProfile::to_velocity(self.state, 0.0, limits);
        match self.bounds {
            Some((low, high)) => {
                let (from, end) = (self.state.position, brake.end().position);
                // Already outside: the stop ends where it comes to rest unless that is farther out.
                let target = end.max(low.min(from)).min(high.max(from).max(low));
                if (target - end).abs() > 0.0 { MotionProfile::to_position(self.state, target, limits) } else { brake }
            }
            None => brake,
        }
    }

    fn jog_profile(&self, velocity: f64) -> MotionProfile {
        let limits = self.limits;
        if velocity.is_nan() || velocity.abs() <= 0.0 {
            return self.stop_profile(limits);
        }
        let cruise = AxisLimits { velocity_mm_s: velocity.abs(), ..limits };
        match self.bounds {
            None => MotionProfile::to_velocity(self.state, velocity, limits),
            Some((_, high)) if velocity > 0.0 && high >= self.state.position => {
                MotionProfile::to_position(self.state, high, cruise)
            }
            Some((low, _)) if velocity < 0.0 && low <= self.state.position => {
                MotionProfile::to_position(self.state, low, cruise)
            }
            // The axis is beyond the bound in the jog direction: refused.
            Some(_) => self.stop_profile(limits),
        }
    }
}
