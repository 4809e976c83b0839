//! Wheel size: every dressing reduces it, and all dependent values follow.
//!
//! A dressing program writes the new diameter to #5801. The loss of radius is subtracted from the wear of the active
//! offset on the wheel axis, so that the wheel face keeps its work coordinate. The dressing point is shifted as well.
//! Constant surface speed and wheel rating use the new diameter from this tick on.
//! Source: spec K4.2, K5.17, B2 (G96); docs/decisions.md "Grinding functions".

use super::Plant;
use crate::controller::axes::SECONDS_PER_MINUTE;
use crate::controller::storage_request::StorageRequest;
use crate::defs::param::{self, NumberParam, Params};
use crate::defs::text::phrase;
use crate::nc::SpeedMode;
use crate::units::Axis;

impl Plant {
    /// Counts a ground part since the last dressing.
    pub fn count_since_dressing(&mut self) {
        let parts = self.params.get(param::PARTS_SINCE_DRESSING) + 1.0;
        self.store_param(param::PARTS_SINCE_DRESSING.address(), parts);
        let interval = self.params.get(param::DRESSING_INTERVAL);
        if interval > 0.0 && parts >= interval {
            self.show_note(phrase!(
                "已磨 {parts:.0} 件，应修整砂轮 (P95)",
                "{parts:.0} parts ground: the wheel is due for dressing (P95)",
                parts
            ));
        }
    }

    /// Removes the dressing point of an axis.
    pub fn remove_dress_point(&mut self, axis: Axis) {
        if self.work.dress_points[axis].take().is_some() {
            self.store(StorageRequest::DressPoint(axis, None));
        }
    }

    /// New wheel: resets the counts of ground parts and dressings.
    pub fn reset_dressing_counts(&mut self) {
        let none: [NumberParam; 2] = [param::PARTS_SINCE_DRESSING, param::DRESSING_COUNT];
        none.into_iter().for_each(|row| self.store_param(row.address(), 0.0));
    }
}

/// The speed, rpm, at which the rim of a wheel has its rated speed (P79).
pub fn rated_wheel_rpm(params: &Params, diameter_mm: f64) -> f64 {
    params.get(param::WHEEL_RATED_SPEED) * 60_000.0 / (std::f64::consts::PI * diameter_mm)
}

/// Wheel speed, rpm, for S in the unit of its mode; `limit`, rpm, applies under G96.
pub fn wheel_rpm_of((value, mode): (f64, SpeedMode), limit: Option<f64>, diameter_mm: f64) -> f64 {
    let girth_m = std::f64::consts::PI * diameter_mm / 1_000.0;
    match mode {
        SpeedMode::Rpm => value,
        SpeedMode::MetresPerSecond => value * SECONDS_PER_MINUTE / girth_m,
        SpeedMode::SurfaceSpeed => (value / girth_m).min(limit.unwrap_or(f64::INFINITY)),
    }
}
