//! The planner: queued moves to nominal set-points on the trail.
//!
//! Owns which moves are planned and how far ahead the trail is laid. Knows nothing of holds and overrides below 100 %.

use std::collections::VecDeque;

use super::path::Queued;
use super::stroke::Stroke;
use super::trail::{PLACES, Place, Spot, Trail};
use super::{LEAST_FEED_MM_S, Limits, Rate};

/// The planner keeps this part of every limit, so that the differences of set-points stay below it despite rounding.
const LIMIT_SHARE: f64 = 0.999_99;
/// Places laid in a tick at most.
const PLACES_PER_TICK: usize = 24;
/// Moves of no length passed in a tick at most.
const EMPTY_PER_TICK: usize = 32;
/// The trail is laid ahead of the axes by this many of the longest braking times.
const BRAKES_AHEAD: f64 = 2.0;
const LEAST_AHEAD: f64 = 96.0;

/// Plans the moves of a queue.
#[derive(Clone, Debug)]
pub struct Planner {
    limits: Limits,
    ahead: u64,
    /// Moves at the front of the queue that are laid or under way.
    taken: usize,
    stroke: Option<Stroke>,
    planned_override: f64,
}

impl Planner {
    /// A planner with nothing under way.
    #[must_use]
    pub fn new(limits: &Limits) -> Self {
        let brake =
            |l: &super::AxisLimits| l.velocity_mm_s / l.acceleration_mm_s2 + l.acceleration_mm_s2 / l.jerk_mm_s3;
        let longest = limits.axes.iter().map(|(_, l)| brake(l)).fold(0.0, f64::max) / limits.tick_s;
        let ahead = (longest * BRAKES_AHEAD + LEAST_AHEAD).min(PLACES as f64 / 2.0) as u64;
        let share = limits.axes.map(|l| super::AxisLimits {
            velocity_mm_s: l.velocity_mm_s * LIMIT_SHARE,
            acceleration_mm_s2: l.acceleration_mm_s2 * LIMIT_SHARE,
            jerk_mm_s3: l.jerk_mm_s3 * LIMIT_SHARE,
        });
        let limits = Limits { axes: share, ..*limits };
        Self { limits, ahead, taken: 0, stroke: None, planned_override: 1.0 }
    }

    /// Forget what is under way.
    pub fn clear(&mut self) {
        self.taken = 0;
        self.stroke = None;
    }

    /// The first move of the queue has gone.
    pub const fn forget_first(&mut self) {
        self.taken = self.taken.saturating_sub(1);
    }

    /// Lay some more of the trail. `feed_override` is at least 1.
    pub fn tick(&mut self, moves: &mut VecDeque<Queued>, trail: &mut Trail, spot: Spot, feed_override: f64) {
        for _ in 0..EMPTY_PER_TICK {
            if self.stroke.is_some() || !self.take_next(moves, trail, feed_override) {
                break;
            }
        }
        if (feed_override - self.planned_override).abs() > 0.0 {
            self.planned_override = feed_override;
            if let (Some(stroke), Some(queued)) = (&mut self.stroke, moves.get(self.taken.saturating_sub(1))) {
                stroke.set_speed(top_speed(queued, &self.limits, feed_override));
            }
        }
        for _ in 0..PLACES_PER_TICK {
            if trail.end() >= spot.tick + self.ahead {
                return;
            }
            let Some(stroke) = &mut self.stroke else { return };
            let Some(queued) = moves.get_mut(self.taken.saturating_sub(1)) else { return };
            if !trail.is_open() {
                trail.pad_for_start(spot);
            }
            let rapid = queued.program.rate == Rate::Rapid;
            trail.push(Place { at: stroke.next(), planned_override: self.planned_override, rapid });
            let over = stroke.is_over();
            trail.set_open(!over);
            if over {
                queued.ends_at = Some(trail.end());
                self.stroke = None;
                if !self.take_next(moves, trail, feed_override) {
                    return;
                }
            }
        }
    }

    /// Take the next move of the queue; false when there is none.
    fn take_next(&mut self, moves: &mut VecDeque<Queued>, trail: &Trail, feed_override: f64) -> bool {
        let Some(queued) = moves.get_mut(self.taken) else { return false };
        self.taken += 1;
        if queued.segment.is_nothing() {
            queued.ends_at = Some(trail.end());
            return true;
        }
        let mut limits = queued.segment.limits(&self.limits);
        limits.velocity_mm_s = top_speed(queued, &self.limits, feed_override);
        self.planned_override = feed_override;
        self.stroke = Some(Stroke::new(queued.segment, limits, self.limits.tick_s));
        true
    }
}

fn top_speed(queued: &Queued, limits: &Limits, feed_override: f64) -> f64 {
    let axes = queued.segment.limits(limits).velocity_mm_s;
    match queued.program.rate {
        Rate::Rapid => axes,
        Rate::Feed { mm_s } => axes.min(mm_s.max(LEAST_FEED_MM_S) * feed_override),
    }
}
