//! Wheel change: sets size and rating, removes the dressing point of the wheel axis, set by key or by value, and blocks
//! cycle start until the wheel is dressed.
//! Source: spec K5.17; seed 000 (the dressing point is set again after the wheel was mounted).

use super::{Edited, Parts};
use crate::defs::page::Page;
use crate::defs::page_meaning::PageMeaning;
use crate::defs::param::{self, NumberParam};
use crate::defs::signal::Output;
use crate::defs::text::arg::Arg;
use crate::defs::text::{Text, phrase};
use crate::link::screens::Screens;

const WHEEL_RUNS: Text = Text::new("砂轮还在转，先停砂轮", "the wheel is running: stop it first");
const OPEN_RUN: Text = Text::new("程序未结束，先复位", "a program is active: press RESET first");
const NOT_HERE: Text = Text::new("请在换砂轮页面操作", "use the wheel change page");

/// Sets P77–P79 (diameter and width, mm; rated speed, m/s) and P6.7, all or nothing. `screens` names the variables that
/// hold dressing points.
pub fn change_wheel(parts: &mut Parts<'_>, screens: &Screens, [diameter_mm, width_mm, rated_m_s]: [f64; 3]) -> Edited {
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
    let cleared = clear_point_values(parts, screens);
    let Some((variable, value)) = cleared.first else {
        return Ok(phrase!("已换砂轮：先设修整点并修整", "wheel changed: set its dressing point and dress it"));
    };
    let name = Arg::Variable(u32::from(variable), parts.plant.kind.dialect());
    Ok(match cleared.count {
        1 => phrase!(
            "已换砂轮：先设修整点并修整（旧修整点 {name} = {value} 已清空）",
            "wheel changed: set its dressing point and dress it (the old point {name} = {value} was cleared)",
            name,
            value
        ),
        count => phrase!(
            "已换砂轮：先设修整点并修整（{count} 个旧修整点已清空，第一个 {name} = {value}）",
            "wheel changed: set its dressing point and dress it ({count} old points were cleared, the first {name} = {value})",
            count,
            name,
            value
        ),
    })
}

/// Variables that were cleared.
#[derive(Default)]
struct ClearedValues {
    count: u32,
    /// The first one with its value.
    first: Option<(u16, f64)>,
}

/// Clears the variables that hold the dressing point of the wheel axis. The pages name them; pages of programs for other
/// kinds of machine keep theirs.
fn clear_point_values(parts: &mut Parts<'_>, screens: &Screens) -> ClearedValues {
    let (kind, mut cleared) = (parts.plant.kind, ClearedValues::default());
    let wanted = PageMeaning::DressingPoint(kind.row().wheel_axis);
    for (number, files) in &screens.pages {
        let is_own = parts.plant.work.programs.get(*number).is_none_or(|program| program.is_for(kind));
        let Some(text) = files.text.as_ref().ok().filter(|_| is_own) else { continue };
        for row in text.rows().filter(|row| row.meaning() == Some(wanted)) {
            if let Ok(Some(value)) = parts.plant.work.variables.get(u32::from(row.variable))
                && parts.program.set_variable(parts.plant, row.variable, None)
            {
                cleared.count += 1;
                cleared.first.get_or_insert((row.variable, value));
            }
        }
    }
    cleared
}
