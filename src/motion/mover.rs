//! One axis by itself: jog, handwheel, homing, return to a point, oscillation.
//!
//! Owns position, velocity and acceleration of the axis while it moves so, and the bounds it must stay within. Knows
//! nothing of programs and paths, nor who asks. Every demand takes effect from the state of the moment, whatever it is.
//! Source: spec, motion: jog and handwheel; software limits that brake in time.

use super::profile::{AxisLimits, Profile, State};

/// The jerk of an emergency stop is this many times the axis limit; deceleration stays at its limit.
pub const EMERGENCY_JERK_FACTOR: f64 = 10.0;

/// What the axis has been asked to do.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Demand {
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
    demand: Demand,
    profile: Profile,
    ticks: u32,
    state: State,
}

/// Beyond this many ticks a lasting velocity is planned afresh, so that the count never overflows.
const LONGEST_PROFILE: u32 = 1 << 30;

impl AxisMover {
    /// An axis at rest at `position` mm, moved once every `tick_s` seconds.
    #[must_use]
    pub fn new(limits: AxisLimits, position: f64, tick_s: f64) -> Self {
        let state = State::at_rest(position);
        let profile = Profile::standing(position);
        Self { limits, tick_s, bounds: None, demand: Demand::Rest, profile, ticks: 0, state }
    }

    /// New limits; they shape everything from this moment, and a velocity above them falls at once.
    pub fn set_limits(&mut self, limits: AxisLimits) {
        self.limits = limits;
        self.plan(self.demand);
    }

    /// Stand at `position` mm; forgets any motion. For an axis that was moved by others, or has found its reference.
    pub fn set_position(&mut self, position: f64) {
        self.state = State::at_rest(position);
        self.plan(Demand::Rest);
    }

    /// Take the axis over in motion; it brakes until told otherwise.
    pub fn set_state(&mut self, state: State) {
        self.state = state;
        self.plan(Demand::Stop);
    }

    /// Software limits in mm, low then high. A motion under way is planned again: it lands at or before the limit, or
    /// comes back to it when it was too near to brake. From outside, the axis only moves inward.
    pub fn set_bounds(&mut self, bounds: Option<(f64, f64)>) {
        if bounds != self.bounds {
            self.bounds = bounds;
            self.plan(self.demand);
        }
    }

    /// Jog at `velocity` mm/s (cut to the axis limit) until told otherwise or a bound is reached; 0 stops.
    pub fn velocity_target(&mut self, velocity: f64) {
        let top = self.limits.velocity_mm_s;
        self.ask(Demand::Velocity(velocity.clamp(-top, top)));
    }

    /// Go to `position` mm (cut to the bounds) at no more than `velocity` mm/s and land on it exactly. May be called at
    /// any moment, moving or not, with a new target.
    pub fn position_target(&mut self, position: f64, velocity: f64) {
        let velocity = velocity.abs().min(self.limits.velocity_mm_s);
        self.ask(Demand::Position { target: position, velocity });
    }

    /// Brake to rest within the limits.
    pub fn stop(&mut self) {
        self.ask(Demand::Stop);
    }

    /// Brake to rest at full deceleration with [`EMERGENCY_JERK_FACTOR`] times the jerk.
    pub fn emergency_stop(&mut self) {
        self.ask(Demand::Emergency);
    }

    /// One tick on: position in mm and velocity in mm/s at its end.
    pub fn tick(&mut self) -> (f64, f64) {
        if self.ticks >= LONGEST_PROFILE {
            self.plan(self.demand);
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

    /// Whether the axis stands and nothing asked of it is left to do.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        let end = self.profile.end();
        f64::from(self.ticks) * self.tick_s >= self.profile.seconds() && end == State::at_rest(end.position)
    }

    fn ask(&mut self, demand: Demand) {
        if demand != self.demand {
            self.plan(demand);
        }
    }

    fn plan(&mut self, demand: Demand) {
        self.demand = demand;
        self.ticks = 0;
        let (start, limits) = (self.state, self.limits);
        self.profile = match demand {
            Demand::Rest => Profile::to_velocity(start, 0.0, limits),
            Demand::Velocity(velocity) => self.jog(velocity),
            Demand::Position { target, velocity } if velocity > 0.0 => {
                let target = self.within(target);
                Profile::to_position(start, target, AxisLimits { velocity_mm_s: velocity, ..limits })
            }
            Demand::Position { .. } | Demand::Stop => self.halt(limits),
            Demand::Emergency => {
                let jerk_mm_s3 = limits.jerk_mm_s3 * EMERGENCY_JERK_FACTOR;
                Profile::to_velocity(start, 0.0, AxisLimits { jerk_mm_s3, ..limits })
            }
        };
    }

    /// A target cut to the bounds; from outside they are taken to where the axis stands, so that it goes inward only and no
    /// farther than asked.
    fn within(&self, target: f64) -> f64 {
        let from = self.state.position;
        self.bounds.map_or(target, |(low, high)| target.max(low.min(from)).min(high.max(low).max(from)))
    }

    /// Brakes; where braking alone would cross a bound that was set too late, ends on the bound.
    fn halt(&self, limits: AxisLimits) -> Profile {
        let brake = Profile::to_velocity(self.state, 0.0, limits);
        match self.bounds {
            Some((low, high)) => {
                let (from, end) = (self.state.position, brake.end().position);
                // Outside already, a stop stays where it comes to rest unless it would lead further out.
                let target = end.max(low.min(from)).min(high.max(from).max(low));
                if (target - end).abs() > 0.0 { Profile::to_position(self.state, target, limits) } else { brake }
            }
            None => brake,
        }
    }

    fn jog(&self, velocity: f64) -> Profile {
        let limits = self.limits;
        if velocity.is_nan() || velocity.abs() <= 0.0 {
            return self.halt(limits);
        }
        let cruise = AxisLimits { velocity_mm_s: velocity.abs(), ..limits };
        match self.bounds {
            None => Profile::to_velocity(self.state, velocity, limits),
            Some((_, high)) if velocity > 0.0 && high >= self.state.position => {
                Profile::to_position(self.state, high, cruise)
            }
            Some((low, _)) if velocity < 0.0 && low <= self.state.position => {
                Profile::to_position(self.state, low, cruise)
            }
            // Beyond the bound that the jog points at: refused.
            Some(_) => self.halt(limits),
        }
    }
}
