//! Start of a run along its first move: the axes move while the first window is planned.
//!
//! If the first move is a line and long enough, its beginning from rest to rest is the first plan. It needs no window. The
//! first window then starts in motion on it, before it brakes. Knows nothing of the choice of that handover.

use super::super::blending::band_move;
use super::super::lookahead_window::{PLAN_JERK_SHARE, PLAN_LIMIT_SHARE, PlanPoint};
use super::super::profile::{AxisState, MotionProfile};
use super::super::queued_move::MoveQueue;
use super::super::{AxisLimits, per_coordinate};
use super::handover::rate_reserve;
use super::{MAX_PLAN_TICKS, MAX_WORK_PER_TICK, PlanRequest, SetpointBuffer, SetpointPlanner, append_rest, top_speed};
use crate::units::WorkBudget;

/// Work units of the profile of the first move, and of one set-point of it.
const COST_PROFILE: usize = 1_500;
const COST_SETPOINT: usize = 50;

impl SetpointPlanner {
    /// Plans the beginning of the first move of a run; false if it is too short for the planning of a window meanwhile.
    pub(super) fn begin_on_first_move(
        &mut self,
        moves: &MoveQueue,
        buffer: &mut SetpointBuffer,
        request: PlanRequest,
        budget: &mut WorkBudget,
    ) -> bool {
        let Some(queued) = moves.get(self.planned_moves) else { return false };
        let segment = &queued.segment;
        if segment.curvature() > 0.0 {
            return false;
        }
        // The same shares of the limits as a window: the next one starts on this plan as on any other.
        let share = PLAN_LIMIT_SHARE * (1.0 - rate_reserve(request));
        let axes = segment.limits(&self.limits);
        let limits = AxisLimits {
            velocity_mm_s: top_speed(queued, &self.limits, request.feed_override).min(axes.velocity_mm_s * share),
            acceleration_mm_s2: axes.acceleration_mm_s2 * share,
            jerk_mm_s3: axes.jerk_mm_s3 * share * PLAN_JERK_SHARE,
        };
        let needed_s = self.first_handover_ticks(queued.tolerance_mm) as f64 * self.limits.tick_s;
        // From rest to rest a way takes at least as long as at the top speed: enough for the handover and the braking.
        let length = segment.length().min(limits.velocity_mm_s * (needed_s + self.influence_s(limits.velocity_mm_s)));
        let profile = MotionProfile::to_position(AxisState::at_rest(0.0), length, limits);
        let ticks = (profile.seconds() / self.limits.tick_s).ceil() as usize;
        let at_handover = profile.at(needed_s.min(profile.seconds()));
        budget.spend(COST_PROFILE);
        if profile.seconds() - needed_s < self.influence_s(at_handover.velocity) + self.limits.tick_s
            || ticks >= MAX_PLAN_TICKS.min(MAX_WORK_PER_TICK / COST_SETPOINT)
        {
            return false;
        }
        budget.spend(ticks * COST_SETPOINT);
        let (start, end) = (segment.at(0.0), segment.at(length));
        let direction = per_coordinate(|x| (end[x] - start[x]) / length);
        self.plan.clear();
        self.plan.extend((1..ticks).map(|tick| {
            let state = profile.at(tick as f64 * self.limits.tick_s);
            PlanPoint {
                at: segment.at(state.position),
                velocity: direction.map(|share| share * state.velocity),
                acceleration: direction.map(|share| share * state.acceleration),
                along: state.position,
                segment: 0,
            }
        }));
        self.plan.push(PlanPoint::at_rest(end, length, 0));
        self.best_handover_index = self.best_handover();
        self.band.clear();
        self.band.add(band_move(queued, &self.limits).with_override(request.feed_override));
        self.band.end = length;
        self.band.finish();
        self.window.begin_run(share);
        (self.appended, self.is_extendable, self.failed_handover) = (0, true, None);
        self.planned_override = request.feed_override;
        append_rest(buffer);
        true
    }
}
