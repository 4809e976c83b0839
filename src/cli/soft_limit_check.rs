//! Soft limit check: if the part file gives work zero and start position in machine coordinates, a move beyond a limit
//! is reported with its block, as in the run. Source: spec B5, T4.

use crate::controller::axes::soft_limits;
use crate::controller::interlock_check::PredictedRefusal;
use crate::defs::param::Params;
use crate::defs::text::{LocalizedText, phrase};
use crate::nc::{Block, OfflineMachine, OpEffect};
use crate::units::{Axis, PerAxis};

/// Rounding slack of a limit, mm: far below the resolution.
const SLACK_MM: f64 = 1e-6;
/// Maximum number of blocks reported.
const MAX_VIOLATIONS: usize = 20;

/// Executes the blocks of a check.
pub struct SoftLimitCheck<'a> {
    world: OfflineMachine,
    params: &'a Params,
    /// Displayed millimetres per millimetre of slide travel.
    shown_per_mm: PerAxis<f64>,
    violations: Vec<PredictedRefusal>,
}

impl<'a> SoftLimitCheck<'a> {
    /// Starts with the state of the check; the world has the machine's work offsets.
    #[must_use]
    pub const fn new(world: OfflineMachine, params: &'a Params, shown: PerAxis<f64>) -> Self {
        Self { world, params, shown_per_mm: shown, violations: Vec::new() }
    }

    /// Checks a block.
    pub fn check_block(&mut self, block: &Block) {
        for op in &block.ops {
            self.world.reset_extents();
            self.world.apply(op);
            // Homing may move beyond the limits to its switch.
            let exempt = matches!(op.effect(), OpEffect::Motion(motion) if motion.ignores_soft_limits());
            let told = self.violations.last().is_some_and(|last| last.at == block.location);
            if !exempt && !told && self.violations.len() < MAX_VIOLATIONS {
                let refusal = self.exceeded_limit().map(|text| PredictedRefusal { at: block.location, text });
                self.violations.extend(refusal);
            }
        }
    }

    /// The violations found.
    #[must_use]
    pub fn into_violations(self) -> Vec<PredictedRefusal> {
        self.violations
    }

    /// The soft limit that the last operation exceeded, if any.
    fn exceeded_limit(&self) -> Option<LocalizedText> {
        let (low, high) = self.world.extents()?;
        let offsets = self.world.work_offsets();
        let (low, high) = (offsets.machine_from_work(low), offsets.machine_from_work(high));
        Axis::ALL.into_iter().filter(|axis| high[*axis] - low[*axis] > 0.0).find_map(|axis| {
            let (least, most) = soft_limits(self.params, axis);
            let (at, limit) = match (low[axis], high[axis]) {
                (at, _) if at < least - SLACK_MM => (at, least),
                (_, at) if at > most + SLACK_MM => (at, most),
                _ => return None,
            };
            let (at, limit) = (at * self.shown_per_mm[axis], limit * self.shown_per_mm[axis]);
            Some(phrase!(
                "{axis} 到 {at:.3}，超出软限位 {limit:.3} (机床坐标)",
                "{axis} goes to {at:.3}, beyond the soft limit {limit:.3} (machine)",
                axis,
                at,
                limit
            ))
        })
    }
}
