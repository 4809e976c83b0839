//! Leadscrew compensation: the correction added to the set-points for pitch error and backlash. After a reversal,
//! backlash is taken up by a ramp with limited speed and acceleration, never in one tick.
//! Source: spec B7, S6.

use super::SECONDS_PER_MINUTE;
use crate::defs::leadscrew::LeadscrewCompensation;
use crate::defs::param::{self, Params};
use crate::units::{Axis, PerAxis};

/// Share of the axis acceleration available to compensation.
const ACCELERATION_SHARE: f64 = 0.5;

/// Rounds until position and correction fit. Backlash and pitch error change by 0.02 mm in a millimetre at most each, so a
/// round leaves a twenty-fifth of the rest: of 4 mm less than a nanometre after five.
const CORRECTION_ROUNDS: u32 = 5;

/// Compensation of all axes.
#[derive(Clone, Debug)]
pub struct LeadscrewCompensator {
    tables: PerAxis<LeadscrewCompensation>,
    /// Backlash P50 to P52, mm.
    backlash_mm: PerAxis<f64>,
    speed_mm_s: f64,
    acceleration_mm_s2: PerAxis<f64>,
    tick_s: f64,
    /// Correction applied now, mm, and its velocity, mm/s.
    applied_mm: PerAxis<f64>,
    velocity_mm_s: PerAxis<f64>,
}

impl LeadscrewCompensator {
    /// State at power-on: no correction applied.
    #[must_use]
    pub fn new(tables: PerAxis<LeadscrewCompensation>, params: &Params, tick_s: f64) -> Self {
        let mut compensation = Self {
            tables,
            backlash_mm: PerAxis::default(),
            speed_mm_s: 0.0,
            acceleration_mm_s2: PerAxis::default(),
            tick_s,
            applied_mm: PerAxis::default(),
            velocity_mm_s: PerAxis::default(),
        };
        compensation.configure(params);
        compensation
    }

    /// Applies changed parameters.
    pub fn configure(&mut self, params: &Params) {
        self.backlash_mm = PerAxis::from_fn(|axis| params.get_axis(param::BACKLASH_X, axis));
        self.speed_mm_s = params.get(param::COMPENSATION_SPEED) / SECONDS_PER_MINUTE;
        self.acceleration_mm_s2 =
            PerAxis::from_fn(|axis| ACCELERATION_SHARE * params.get_axis(param::ACCELERATION_X, axis));
    }

    /// Replaces the table of an axis.
    pub fn set_table(&mut self, axis: Axis, table: LeadscrewCompensation) {
        self.tables[axis] = table;
    }

    /// The table of an axis.
    #[must_use]
    pub fn table(&self, axis: Axis) -> &LeadscrewCompensation {
        &self.tables[axis]
    }

    /// The correction of each axis now, mm.
    #[must_use]
    pub const fn applied_mm(&self) -> PerAxis<f64> {
        self.applied_mm
    }

    /// The required correction at a position, mm. The table applies only after homing.
    fn needed_mm(&self, axis: Axis, at_mm: f64, minus: bool, homed: bool) -> f64 {
        let table = &self.tables[axis];
        let (play, pitch) = if homed { (table.backlash_mm(at_mm), table.pitch_error_mm(at_mm)) } else { (0.0, 0.0) };
        let play = if minus { play + self.backlash_mm[axis] } else { 0.0 };
        -(play + pitch)
    }

    /// One tick of an axis with its set-point, mm; `minus`: the last move was in the minus direction.
    pub fn step(&mut self, axis: Axis, at_mm: f64, minus: bool, homed: bool) {
        let rest = self.needed_mm(axis, at_mm, minus, homed) - self.applied_mm[axis];
        let most = self.acceleration_mm_s2[axis] * self.tick_s;
        // The highest speed that still stops at the end: n ticks of v, v − most, … add up to n·v − n(n − 1)/2·most.
        let whole = rest.abs() / self.tick_s;
        let ticks = (((1.0 + 8.0 * whole / most).sqrt() - 1.0) / 2.0).ceil().max(1.0);
        let brake = whole / ticks + most * (ticks - 1.0) / 2.0;
        let wanted = brake.min(self.speed_mm_s).copysign(rest);
        let velocity = self.velocity_mm_s[axis];
        let velocity = wanted.clamp(velocity - most, velocity + most);
        self.velocity_mm_s[axis] = velocity;
        self.applied_mm[axis] += velocity * self.tick_s;
    }

    /// The machine position of a homed axis whose encoder is at `encoder_mm` from the machine zero, mm.
    #[must_use]
    pub fn machine_mm(&self, axis: Axis, encoder_mm: f64, minus: bool) -> f64 {
        let mut at_mm = encoder_mm;
        for _ in 0..CORRECTION_ROUNDS {
            at_mm = encoder_mm - self.needed_mm(axis, at_mm, minus, true);
        }
        at_mm
    }

    /// The axis position has become known: the required correction counts as applied and the axis does not move.
    /// Returns the change of the correction, mm.
    pub fn apply_at_once(&mut self, axis: Axis, at_mm: f64, minus: bool) -> f64 {
        let needed = self.needed_mm(axis, at_mm, minus, true);
        let more = needed - self.applied_mm[axis];
        (self.applied_mm[axis], self.velocity_mm_s[axis]) = (needed, 0.0);
        more
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::defs::kind::Kind;

    #[test]
    fn b7_backlash_is_taken_up_by_a_ramp_with_limited_speed_and_acceleration() {
        let mut params = Params::factory(Kind::Gc);
        params.write(param::BACKLASH_X.address(), 0.03).unwrap();
        let mut screw = LeadscrewCompensator::new(PerAxis::default(), &params, 0.001);
        let (mut before, mut speed, mut ticks) = (0.0, 0.0, 0);
        while (screw.applied_mm()[Axis::X] + 0.03).abs() > 1e-9 {
            screw.step(Axis::X, -50.0, true, false);
            let now = screw.applied_mm()[Axis::X];
            let velocity = (now - before) / 0.001;
            assert!(velocity.abs() <= 10.0 + 1e-9, "P99 600 mm/min: {velocity}");
            assert!((velocity - speed).abs() <= 0.5 * 800.0 * 0.001 + 1e-9, "half of P33: {velocity} after {speed}");
            assert!(now >= -0.03 - 1e-12, "it does not shoot over");
            (before, speed, ticks) = (now, velocity, ticks + 1);
            assert!(ticks < 100, "{now}");
        }
        // 2 · √(0.03/400) = 17.3 ms, and a few ticks at the end.
        assert!((17..=25).contains(&ticks), "{ticks}");
    }

    #[test]
    fn b7_the_table_counts_from_homing_on() {
        let table = LeadscrewCompensation::parse("-100,0.04,0.01\n0,0,0").unwrap();
        let params = Params::factory(Kind::Gc);
        let tables = PerAxis([table.clone(), LeadscrewCompensation::default(), table]);
        let screw = LeadscrewCompensator::new(tables, &params, 0.001);
        let close = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert!(close(screw.needed_mm(Axis::X, -50.0, true, false), 0.0));
        assert!(close(screw.needed_mm(Axis::X, -50.0, true, true), -0.025));
        assert!(close(screw.needed_mm(Axis::X, -50.0, false, true), -0.005));
        assert!(close(screw.needed_mm(Axis::Y, -50.0, true, true), 0.0));
    }
}
