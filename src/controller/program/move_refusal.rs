//! Why a move or an operation is refused.

use crate::controller::plant::displayed_per_mm;
use crate::defs::param::Params;
use crate::defs::text::{LocalizedText, phrase};
use crate::units::Axis;

/// Why a move or operation is refused.
#[derive(Clone, Debug, PartialEq)]
pub enum MoveRefusal {
    /// Target beyond a soft limit: axis, target, limit; machine coordinates, radius mm.
    SoftLimit(Axis, f64, f64),
    /// Move before the axes are homed.
    NotHomed,
    /// Move of an oscillating axis, or oscillation of a second axis.
    Oscillating(Axis),
    /// Oscillation with zero stroke, or of an axis that is not homed.
    NoStroke(Axis),
    /// Wear outside the range of the offset page: axis and sum, mm of slide travel.
    WearOutOfRange(Axis, f64),
    /// Return to a dressing point that is not set.
    NoDressPoint(Axis),
    /// M code that this version does not support.
    Unsupported(u8),
}

impl MoveRefusal {
    /// The text of a refusal.
    pub fn text(&self, params: &Params) -> LocalizedText {
        match *self {
            MoveRefusal::SoftLimit(axis, to, limit) => {
                let factor = displayed_per_mm(params, axis);
                let (to, limit) = (to * factor, limit * factor);
                phrase!(
                    "{axis} 目标 {to:.3} 超出软限位 {limit:.3} (机床坐标)",
                    "{axis} target {to:.3} is beyond the soft limit {limit:.3} (machine)",
                    axis,
                    to,
                    limit
                )
            }
            MoveRefusal::NotHomed => phrase!("先回零", "home the axes first"),
            MoveRefusal::Oscillating(axis) => {
                phrase!("{axis} 轴在振荡中，先用 G36 关闭", "{axis} is oscillating: stop it with G36 first", axis)
            }
            MoveRefusal::NoStroke(axis) => {
                phrase!(
                    "{axis} 轴没有振荡行程：终点就是现在的位置",
                    "{axis} has no oscillation stroke: it stands at the end point",
                    axis
                )
            }
            MoveRefusal::WearOutOfRange(axis, sum) => {
                let sum = sum * displayed_per_mm(params, axis);
                phrase!("{axis} 磨耗 {sum:.3}", "wear of {axis} {sum:.3}", axis, sum)
            }
            MoveRefusal::NoDressPoint(axis) => {
                phrase!("{axis} 轴没有设置修整点", "{axis} has no dressing point", axis)
            }
            MoveRefusal::Unsupported(code) => {
                phrase!("M{code:02} 在本版本中还没有", "M{code:02} is not available in this version", code)
            }
        }
    }
}
