//! Wheel size: every dressing reduces it, and all dependent values follow.
//!
//! A dressing program writes the new diameter to #5801. The loss of radius is subtracted from the wear of the active
//! offset on the wheel axis, so that the wheel face keeps its work coordinate. The dressing point is shifted as well.
//! Constant surface speed and wheel rating use the new diameter from this tick on.
//! Source: spec K4.2, K5.17, B2 (G96); docs/decisions.md "Grinding functions".

use std::sync::Arc;

use super::run::ProgramRun;
use super::{Controller, PanelSwitches, StorageRequest};
use crate::defs::alarm;
use crate::defs::param::{self, NumberParam};
use crate::defs::text::LocalizedText;
use crate::nc::SpeedMode;

use super::axes::SECONDS_PER_MINUTE;

impl Controller {
    /// Records a new wheel diameter, mm, written by a program. False: refused, with the alarm raised.
    pub(super) fn record_dressing(&mut self, run: &mut ProgramRun, diameter_mm: f64) -> bool {
        let PanelSwitches { machine_lock, aux_function_lock: mst_lock, dry_run, .. } = self.switches;
        if machine_lock || mst_lock || dry_run {
            self.show_note(LocalizedText::new(
                "锁定或空运行：修整不计入砂轮直径",
                "locked or dry run: no dressing is booked",
            ));
            return true;
        }
        let before = self.params.get(param::WHEEL_DIAMETER);
        let refusal = if diameter_mm > before || diameter_mm < param::WHEEL_DIAMETER.min {
            Some(LocalizedText::new(
                format!("#5801={diameter_mm:.4}，现直径 {before:.4}"),
                format!("#5801={diameter_mm:.4}, the wheel has {before:.4}"),
            ))
        } else if self.work_offsets.tool_offset == 0 {
            Some(LocalizedText::new("没有刀补生效", "no offset is in force"))
        } else {
            None
        };
        if let Some(why) = refusal {
            self.raise(alarm::WHEEL_DIAMETER_REFUSED, Some(why));
            return false;
        }
        let lost_mm = (before - diameter_mm) / 2.0;
        let (axis, index) = (self.kind_row.wheel_axis, self.work_offsets.tool_offset - 1);
        self.work_offsets.wear[index][axis] -= lost_mm;
        self.store_offset(index);
        run.lookahead.work_offsets = Arc::new(self.work_offsets.clone());
        if let Some(point) = &mut self.dressing.points[axis] {
            *point += lost_mm * self.params.get(param::DRESSING_POINT_SIDE);
            self.storage_requests.push(StorageRequest::DressPoint(axis, *point));
        }
        run.lookahead.dress_points = self.dressing.points;
        self.store_param(param::WHEEL_DIAMETER.address(), diameter_mm);
        self.store_param(param::DRESSING_COUNT.address(), self.params.get(param::DRESSING_COUNT) + 1.0);
        self.store_param(param::PARTS_SINCE_DRESSING.address(), 0.0);
        true
    }

    /// Counts a ground part since the last dressing.
    pub(super) fn count_since_dressing(&mut self) {
        let parts = self.params.get(param::PARTS_SINCE_DRESSING) + 1.0;
        self.store_param(param::PARTS_SINCE_DRESSING.address(), parts);
        let interval = self.params.get(param::DRESSING_INTERVAL);
        if interval > 0.0 && parts >= interval {
            self.show_note(LocalizedText::new(
                format!("已磨 {parts:.0} 件，应修整砂轮 (P95)"),
                format!("{parts:.0} parts ground: the wheel is due for dressing (P95)"),
            ));
        }
    }

    /// New wheel: resets the counts of ground parts and dressings.
    pub(super) fn reset_dressing_counts(&mut self) {
        let none: [NumberParam; 2] = [param::PARTS_SINCE_DRESSING, param::DRESSING_COUNT];
        none.into_iter().for_each(|row| self.store_param(row.address(), 0.0));
    }

    /// The programmed wheel speed, rpm, with the present diameter.
    pub(super) fn wheel_rpm(&self) -> f64 {
        wheel_rpm_of(self.wheel_speed, self.wheel_rpm_limit, self.params.get(param::WHEEL_DIAMETER))
    }
}

/// Wheel speed, rpm, for S in the unit of its mode; `limit`, rpm, applies under G96.
pub(super) fn wheel_rpm_of((value, mode): (f64, SpeedMode), limit: Option<f64>, diameter_mm: f64) -> f64 {
    let girth_m = std::f64::consts::PI * diameter_mm / 1_000.0;
    match mode {
        SpeedMode::Rpm => value,
        SpeedMode::MetresPerSecond => value * SECONDS_PER_MINUTE / girth_m,
        SpeedMode::SurfaceSpeed => (value / girth_m).min(limit.unwrap_or(f64::INFINITY)),
    }
}
