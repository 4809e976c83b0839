//! Wheel change: sets size and rating, removes the dressing point of the wheel axis, and blocks cycle start until the
//! wheel is dressed.
//! Source: spec K5.17; seed 000 (the dressing point is set again after the wheel was mounted).

use super::{Edited, Parts};
use crate::defs::page::Page;
use crate::defs::param::{self, NumberParam};
use crate::defs::signal::Output;
use crate::defs::text::{Text, phrase};

const WHEEL_RUNS: Text = Text::new("砂轮还在转，先停砂轮", "the wheel is running: stop it first");
const OPEN_RUN: Text = Text::new("程序未结束，先复位", "a program is active: press RESET first");
const NOT_HERE: Text = Text::new("请在换砂轮页面操作", "use the wheel change page");

/// Sets P77–P79 (diameter and width, mm; rated speed, m/s) and P6.7, all or nothing.
pub fn change_wheel(parts: &mut Parts<'_>, [diameter_mm, width_mm, rated_m_s]: [f64; 3]) -> Edited {
    if parts.plant.operator.page != Page::Wheel {
        return Err(NOT_HERE.into());
    }
    if parts.plant.outputs.on.has(Output::Wheel) {
        return Err(WHEEL_RUNS.into());
    }
    if parts.program.is_open() {
        return Err(OPEN_RUN.into());
    }
    let values: [(&'static NumberParam, f64); 3] = [
        (&param::WHEEL_DIAMETER, diameter_mm),
        (&param::WHEEL_WIDTH, width_mm),
        (&param::WHEEL_RATED_SPEED, rated_m_s),
    ];
    for (row, value) in values {
        if !(row.min..=row.max).contains(&value) {
            return Err(phrase!(
                "P{number} {name} 超出范围 {min} … {max} {unit}",
                "P{number} {name}: out of range {min} … {max} {unit}",
                number = row.number,
                name = &row.name,
                min = row.min,
                max = row.max,
                unit = row.unit
            ));
        }
    }
    let flag = (param::WHEEL_UNDRESSED.address(), 1.0);
    for (at, value) in values.map(|(row, value)| (row.address(), value)).into_iter().chain([flag]) {
        parts.plant.store_param(at, value);
    }
    parts.plant.reset_dressing_counts();
    // The rim of the new wheel touches the dresser elsewhere.
    parts.plant.remove_dress_point(parts.plant.kind.row().wheel_axis);
    Ok(phrase!("已换砂轮：先设修整点并修整", "wheel changed: set its dressing point and dress it"))
}
