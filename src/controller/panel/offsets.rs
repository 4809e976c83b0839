//! Tool offset edits by pages: absolute values, increments, measurements.
//!
//! An edit applies from the next block that is read: blocks already read ahead keep their targets. Queued offset
//! changes are edited as well, so that they do not undo the edit when they are executed.
//! Source: spec K4.1, K5.10, K7.6, K7.7.

use super::edit_protection::{check_not_running, check_unlocked};
use super::{Edited, Parts, PartsView};
use crate::controller::plant::{Plant, offset_in_range};
use crate::defs::page::Page;
use crate::defs::system_variable::{self, SystemVariableRange};
use crate::defs::text::arg::Arg;
use crate::defs::text::{LocalizedText, Template, Text, phrase};
use crate::link::edit::{MAX_INCREMENT, OffsetCommand, OffsetPart, OriginChange, origin_name};
use crate::machine::panel_key::NOT_IN_RUN;
use crate::nc::work_offsets::TOOL_OFFSET_COUNT;
use crate::nc::{CutterShape, OriginPlace, WorkOffsets};
use crate::units::{Axis, PerAxis};

const NO_NUMBER: Text = Text::new("刀补号应为 1-16", "tool offset numbers are 1 to 16");
const NOT_HERE: Text = Text::new("请在刀补或砂轮修整页面修改", "edit it on the offset or dressing page");
const OPEN_RUN: Text = Text::new("程序未结束，不能测量", "a program is active: no measurement");
const WEAR_CLEARED: &Template = &Template::new("{message}，磨耗已清零", "{message}, wear cleared", &["message"]);
const NO_ORIGIN: Text = Text::new("没有此工件坐标系", "there is no such work offset");
const CUTTER_RANGE: Text =
    Text::new("R 为 0–999.999，T 为 0–9 的整数", "R is 0 to 999.999, T a whole number from 0 to 9");
const MOVING: Text = Text::new("轴还在运动，不能测量", "the axes are still moving: no measurement");

/// Executes a command of the offset or the dressing page.
pub fn handle_offset_command(parts: &mut Parts<'_>, command: OffsetCommand) -> Edited {
    let index = match command {
        OffsetCommand::Set { number, axis, .. }
        | OffsetCommand::AddGeometry { number, axis, .. }
        | OffsetCommand::Measure { number, axis, .. } => offset_index(parts.plant, number, axis)?,
        OffsetCommand::SetRadius { number, .. } | OffsetCommand::SetTip { number, .. } => index_of(number)?,
        OffsetCommand::Origin { row, axis, change } => return change_origin(parts, row, axis, change),
    };
    match command {
        OffsetCommand::Set { part, axis, value, .. } => {
            // K7.7: P22.0 does not protect the geometry; the dressing page has no protection.
            if part == OffsetPart::Geometry && parts.plant.operator.page == Page::Offset {
                check_not_running(parts.view())?;
            } else {
                check_offset_page(parts.view(), part)?;
            }
            set_offset_value(parts, index, part, axis, value / parts.plant.displayed_per_mm(axis))
        }
        OffsetCommand::AddGeometry { axis, increment: by, .. } => {
            check_offset_page(parts.view(), OffsetPart::Geometry)?;
            check_increment(by)?;
            let sum = parts.plant.work.offsets.geometry[index][axis] + by / parts.plant.displayed_per_mm(axis);
            set_offset_value(parts, index, OffsetPart::Geometry, axis, sum)
        }
        OffsetCommand::SetRadius { value, .. } => set_cutter(parts, index, &system_variable::CUTTER_RADIUS, value),
        OffsetCommand::SetTip { value, .. } => set_cutter(parts, index, &system_variable::CUTTER_TIP, value),
        OffsetCommand::Measure { axis, value, .. } => {
            check_offset_page(parts.view(), OffsetPart::Geometry)?;
            measure(parts, index, axis, value)
        }
        OffsetCommand::Origin { .. } => Err(NO_ORIGIN.into()),
    }
}

/// Changes a coordinate of a work offset. As with the geometry, P22.0 protects increments and measurements.
fn change_origin(parts: &mut Parts<'_>, row: usize, axis: Axis, change: OriginChange) -> Edited {
    let place = OriginPlace::at(row).ok_or(NO_ORIGIN)?;
    if !parts.plant.axes.is_present(axis) {
        return Err(phrase!("没有 {axis} 轴", "there is no axis {axis}", axis));
    }
    let per_mm = parts.plant.displayed_per_mm(axis);
    let mut origin = parts.plant.work.offsets.origin(place);
    match change {
        OriginChange::Set(value) => {
            if parts.plant.operator.page != Page::Offset {
                return Err(NOT_HERE.into());
            }
            check_not_running(parts.view())?;
            origin[axis] = value / per_mm;
        }
        OriginChange::Add(by) => {
            check_offset_page(parts.view(), OffsetPart::Geometry)?;
            check_increment(by)?;
            origin[axis] += by / per_mm;
        }
        OriginChange::Measure(value) => {
            check_offset_page(parts.view(), OffsetPart::Geometry)?;
            check_measurable(parts, axis)?;
            // What the page shows of the position in this work offset becomes the value.
            let mut offsets = WorkOffsets { local: PerAxis::default(), ..parts.plant.work.offsets.clone() };
            offsets.set_origin(place, PerAxis::default());
            if let OriginPlace::Work(index) = place {
                offsets.active = index;
            }
            let without = parts.plant.axes.actual()[axis] - offsets.machine_minus_work(axis);
            origin[axis] = without - value / per_mm;
        }
    }
    let (shown, most) = (origin[axis] * per_mm, OffsetPart::Geometry.max_abs());
    if !offset_in_range(OffsetPart::Geometry, shown) {
        return Err(phrase!("超出范围 ±{most:.3}：{shown:.3}", "out of range ±{most:.3}: {shown:.3}", most, shown));
    }
    parts.plant.work.offsets.set_origin(place, origin);
    parts.program.change_offsets_read_ahead(|offsets| offsets.set_origin(place, origin));
    parts.plant.store_origin(place);
    let name = Arg::from(format_args!("{}", origin_name(row)));
    Ok(phrase!("坐标系 {name} {axis} = {shown:.3}", "work offset {name} {axis} = {shown:.3}", name, axis, shown))
}

/// A wear increment typed on a page.
pub fn edit_wear_increment(parts: &mut Parts<'_>, number: usize, axis: Axis, by: f64) -> Edited {
    offset_index(parts.plant, number, axis)?;
    check_offset_page(parts.view(), OffsetPart::Wear)?;
    check_increment(by)?;
    add_wear(parts, number, axis, by)
}

/// Adds to the wear of an offset, mm as displayed (U, V, W on a page). G10 has the same range (K4.1).
///
/// # Errors
/// No such offset or axis, or the sum is out of range. Nothing is changed then.
pub fn add_wear(parts: &mut Parts<'_>, number: usize, axis: Axis, by: f64) -> Edited {
    let index = offset_index(parts.plant, number, axis)?;
    let sum = parts.plant.work.offsets.wear[index][axis] + by / parts.plant.displayed_per_mm(axis);
    set_offset_value(parts, index, OffsetPart::Wear, axis, sum)
}

/// Whether an axis stands at a known place, and no program is open.
fn check_measurable(parts: &Parts<'_>, axis: Axis) -> Result<(), LocalizedText> {
    if parts.program.is_open() {
        return Err(OPEN_RUN.into());
    }
    if !parts.plant.axes.is_at_rest() {
        return Err(MOVING.into());
    }
    if !parts.plant.axes.is_homed(axis) {
        return Err(phrase!("{axis} 未回零，不能测量", "{axis} is not homed: no measurement", axis));
    }
    Ok(())
}

/// K5.10: a measurement sets the geometry and clears the wear of its axis.
fn measure(parts: &mut Parts<'_>, index: usize, axis: Axis, value: f64) -> Edited {
    check_measurable(parts, axis)?;
    let frame = WorkOffsets { tool_offset: 0, local: PerAxis::default(), ..parts.plant.work.offsets.clone() };
    let frame = frame.machine_minus_work(axis);
    let geometry = parts.plant.axes.actual()[axis] - frame - value / parts.plant.displayed_per_mm(axis);
    let message = set_offset_value(parts, index, OffsetPart::Geometry, axis, geometry)?;
    set_offset_value(parts, index, OffsetPart::Wear, axis, 0.0)?;
    Ok(LocalizedText::phrase_of(WEAR_CLEARED, [], [message]))
}

/// Sets one value, radius mm, and stores it on disk.
fn set_offset_value(parts: &mut Parts<'_>, index: usize, part: OffsetPart, axis: Axis, value: f64) -> Edited {
    let shown = value * parts.plant.displayed_per_mm(axis);
    let most = part.max_abs();
    if !offset_in_range(part, shown) {
        return Err(phrase!("超出范围 ±{most:.3}：{shown:.3}", "out of range ±{most:.3}: {shown:.3}", most, shown));
    }
    let old = std::mem::replace(&mut offset_table(&mut parts.plant.work.offsets, part)[index][axis], value);
    parts.program.change_offsets_read_ahead(|offsets| {
        let place = &mut offset_table(offsets, part)[index][axis];
        *place = if place.to_bits() == old.to_bits() { value } else { *place + (value - old) };
    });
    parts.plant.store_offset(index);
    let (name, number) = (part.name(), index + 1);
    Ok(phrase!(
        "刀补 {number:02} {name} {axis} = {shown:.3}",
        "offset {number:02} {name} {axis} = {shown:.3}",
        number,
        name,
        axis,
        shown
    ))
}

/// Sets R and T of an offset without a page, while no run is open.
pub fn preset_cutter(parts: &mut Parts<'_>, number: usize, radius_mm: f64, tip: u8) {
    let mut cutter = CutterShape::default();
    let set = cutter.set_radius(radius_mm).and_then(|()| cutter.set_tip(f64::from(tip)));
    match index_of(number) {
        Ok(_) if parts.program.is_open() => parts.plant.refuse(NOT_IN_RUN),
        Ok(_) if set.is_err() => parts.plant.refuse(CUTTER_RANGE),
        Ok(index) => {
            parts.plant.work.offsets.cutter[index] = cutter;
            parts.plant.store_cutter(index);
        }
        Err(why) => parts.plant.refuse(why),
    }
}

/// Sets R or T of an offset. As the geometry, P22.0 does not protect it.
fn set_cutter(parts: &mut Parts<'_>, index: usize, range: &SystemVariableRange, value: f64) -> Edited {
    if parts.plant.operator.page != Page::Offset {
        return Err(NOT_HERE.into());
    }
    check_not_running(parts.view())?;
    let variable = range.first + index as u32;
    let changed = parts.plant.work.offsets.set_cutter_variable(variable, value);
    if !matches!(changed, Some(Ok(_))) {
        return Err(CUTTER_RANGE.into());
    }
    let cutter = parts.plant.work.offsets.cutter[index];
    parts.program.change_offsets_read_ahead(|offsets| offsets.cutter[index] = cutter);
    parts.plant.store_cutter(index);
    let (number, CutterShape { radius_mm, tip }) = (index + 1, cutter);
    Ok(phrase!(
        "刀补 {number:02} R = {radius_mm:.3}，T = {tip}",
        "offset {number:02} R = {radius_mm:.3}, T = {tip}",
        number,
        radius_mm,
        tip
    ))
}

/// The index of an offset, if the machine has the axis.
fn offset_index(plant: &Plant, number: usize, axis: Axis) -> Result<usize, LocalizedText> {
    if !plant.axes.is_present(axis) {
        return Err(phrase!("没有 {axis} 轴", "there is no axis {axis}", axis));
    }
    index_of(number)
}

fn index_of(number: usize) -> Result<usize, LocalizedText> {
    number.checked_sub(1).filter(|index| *index < TOOL_OFFSET_COUNT).ok_or_else(|| NO_NUMBER.into())
}

/// Whether the open page may change this value now.
fn check_offset_page(parts: PartsView<'_>, part: OffsetPart) -> Result<(), LocalizedText> {
    match parts.plant.operator.page {
        Page::Offset => check_unlocked(parts)?,
        Page::Dressing if part == OffsetPart::Wear => {}
        _ => return Err(NOT_HERE.into()),
    }
    check_not_running(parts)
}

fn offset_table(offsets: &mut WorkOffsets, part: OffsetPart) -> &mut [PerAxis<f64>; TOOL_OFFSET_COUNT] {
    match part {
        OffsetPart::Geometry => &mut offsets.geometry,
        OffsetPart::Wear => &mut offsets.wear,
    }
}

fn check_increment(by: f64) -> Result<(), LocalizedText> {
    if by.abs() <= MAX_INCREMENT {
        return Ok(());
    }
    Err(phrase!("一次增量最大 ±{MAX_INCREMENT:.3}", "the increment must be at most ±{MAX_INCREMENT:.3}", MAX_INCREMENT))
}
