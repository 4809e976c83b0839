//! Tool offset edits by pages: absolute values, increments, measurements.
//!
//! An edit applies from the next block that is read: blocks already read ahead keep their targets. Queued offset
//! changes are edited as well, so that they do not undo the edit when they are executed.
//! Source: spec K4.1, K5.10, K7.6, K7.7.

use std::sync::Arc;

use super::run::{QueueItem, QueuedAction};
use super::{Controller, StorageRequest};
use crate::defs::page::Page;
use crate::defs::text::{LocalizedText, Text};
use crate::link::edit::{MAX_INCREMENT, OffsetCommand, OffsetPart};
use crate::nc::WorkOffsets;
use crate::nc::work_offsets::TOOL_OFFSET_COUNT;
use crate::units::{Axis, PerAxis};

const NO_NUMBER: Text = Text::new("刀补号应为 1-16", "offsets are numbered 1 to 16");
const NOT_HERE: Text = Text::new("请在刀补或砂轮修整页面修改", "edit it on the offset or dressing page");
const OPEN_RUN: Text = Text::new("程序未结束，不能测量", "a program is open: no measurement");
const MOVING: Text = Text::new("轴还在运动，不能测量", "the axes still move: no measurement");

/// Whether an offset value, mm as displayed, is within the range for pages and programs.
pub(super) fn offset_in_range(part: OffsetPart, shown: f64) -> bool {
    shown.is_finite() && shown.abs() <= part.max_abs()
}

impl Controller {
    /// Executes a command of the offset or the dressing page.
    pub(super) fn handle_offset_command(&mut self, command: OffsetCommand) -> Result<LocalizedText, LocalizedText> {
        match command {
            OffsetCommand::Set { number, part, axis, value } => {
                let index = self.offset_index(number, axis)?;
                // K7.7: P22.0 does not protect the geometry; the dressing page has no protection.
                if part == OffsetPart::Geometry && self.page == Page::Offset {
                    self.check_not_running()?;
                } else {
                    self.check_offset_page(part)?;
                }
                self.set_offset_value(index, part, axis, value / self.displayed_per_mm(axis))
            }
            OffsetCommand::AddGeometry { number, axis, increment: by } => {
                let index = self.offset_index(number, axis)?;
                self.check_offset_page(OffsetPart::Geometry)?;
                check_increment(by)?;
                let sum = self.work_offsets.geometry[index][axis] + by / self.displayed_per_mm(axis);
                self.set_offset_value(index, OffsetPart::Geometry, axis, sum)
            }
            OffsetCommand::Measure { number, axis, value } => {
                let index = self.offset_index(number, axis)?;
                self.check_offset_page(OffsetPart::Geometry)?;
                self.measure(index, axis, value)
            }
        }
    }

    /// A wear increment typed on a page.
    pub(super) fn edit_wear_increment(
        &mut self,
        number: usize,
        axis: Axis,
        by: f64,
    ) -> Result<LocalizedText, LocalizedText> {
        self.offset_index(number, axis)?;
        self.check_offset_page(OffsetPart::Wear)?;
        check_increment(by)?;
        self.add_wear(number, axis, by)
    }

    /// Adds to the wear of an offset, mm as displayed (U, V, W on a page). G10 has the same range (K4.1).
    ///
    /// # Errors
    /// No such offset or axis, or the sum is out of range. Nothing is changed then.
    pub(super) fn add_wear(&mut self, number: usize, axis: Axis, by: f64) -> Result<LocalizedText, LocalizedText> {
        let index = self.offset_index(number, axis)?;
        let sum = self.work_offsets.wear[index][axis] + by / self.displayed_per_mm(axis);
        self.set_offset_value(index, OffsetPart::Wear, axis, sum)
    }

    /// K5.10: a measurement sets the geometry and clears the wear of its axis.
    fn measure(&mut self, index: usize, axis: Axis, value: f64) -> Result<LocalizedText, LocalizedText> {
        if self.run.is_some() {
            return Err(OPEN_RUN.into());
        }
        if !self.axes.is_at_rest() {
            return Err(MOVING.into());
        }
        if !self.axes.is_homed(axis) {
            return Err(LocalizedText::new(
                format!("{axis} 未回零，不能测量"),
                format!("{axis} is not homed: no measurement"),
            ));
        }
        let frame = self.work_offsets.work[self.work_offsets.active][axis] + self.work_offsets.shift[axis];
        let geometry = self.axes.actual()[axis] - frame - value / self.displayed_per_mm(axis);
        let said = self.set_offset_value(index, OffsetPart::Geometry, axis, geometry)?;
        self.set_offset_value(index, OffsetPart::Wear, axis, 0.0)?;
        Ok(LocalizedText::new(format!("{}，磨耗已清零", said.zh), format!("{}, wear cleared", said.en)))
    }

    /// The index of an offset, if the machine has the axis.
    fn offset_index(&self, number: usize, axis: Axis) -> Result<usize, LocalizedText> {
        if !self.axes.is_present(axis) {
            return Err(LocalizedText::new(format!("没有 {axis} 轴"), format!("there is no axis {axis}")));
        }
        number.checked_sub(1).filter(|index| *index < TOOL_OFFSET_COUNT).ok_or_else(|| NO_NUMBER.into())
    }

    /// Whether the open page may change this value now.
    fn check_offset_page(&self, part: OffsetPart) -> Result<(), LocalizedText> {
        match self.page {
            Page::Offset => self.check_unlocked()?,
            Page::Dressing if part == OffsetPart::Wear => {}
            _ => return Err(NOT_HERE.into()),
        }
        self.check_not_running()
    }

    /// Sets one value, radius mm, and stores it on disk.
    fn set_offset_value(
        &mut self,
        index: usize,
        part: OffsetPart,
        axis: Axis,
        value: f64,
    ) -> Result<LocalizedText, LocalizedText> {
        let shown = value * self.displayed_per_mm(axis);
        let most = part.max_abs();
        if !offset_in_range(part, shown) {
            return Err(LocalizedText::new(
                format!("超出范围 ±{most:.3}：{shown:.3}"),
                format!("out of range ±{most:.3}: {shown:.3}"),
            ));
        }
        let old = std::mem::replace(&mut offset_table(&mut self.work_offsets, part)[index][axis], value);
        let carry = |frames: &mut WorkOffsets| {
            let place = &mut offset_table(frames, part)[index][axis];
            *place = if place.to_bits() == old.to_bits() { value } else { *place + (value - old) };
        };
        if let Some(run) = &mut self.run {
            carry(Arc::make_mut(&mut run.lookahead.work_offsets));
            for item in &mut run.queue {
                if let QueueItem::Action(QueuedAction::SetWorkOffsets(frames)) = item {
                    carry(Arc::make_mut(frames));
                }
            }
        }
        let (geometry, wear) = (self.work_offsets.geometry[index], self.work_offsets.wear[index]);
        self.storage_requests.push(StorageRequest::Offset { number: index + 1, geometry, wear });
        let (name, number) = (part.name(), index + 1);
        Ok(LocalizedText::new(
            format!("刀补 {number:02} {} {axis} = {shown:.3}", name.zh),
            format!("offset {number:02} {} {axis} = {shown:.3}", name.en),
        ))
    }

    /// Converts radius mm to displayed mm.
    pub(super) fn displayed(&self, values: &PerAxis<f64>) -> PerAxis<f64> {
        PerAxis::from_fn(|axis| values[axis] * self.displayed_per_mm(axis))
    }
}

fn offset_table(frames: &mut WorkOffsets, part: OffsetPart) -> &mut [PerAxis<f64>; TOOL_OFFSET_COUNT] {
    match part {
        OffsetPart::Geometry => &mut frames.geometry,
        OffsetPart::Wear => &mut frames.wear,
    }
}

fn check_increment(by: f64) -> Result<(), LocalizedText> {
    if by.abs() <= MAX_INCREMENT {
        return Ok(());
    }
    Err(LocalizedText::new(
        format!("一次增量最大 ±{MAX_INCREMENT:.3}"),
        format!("an increment is ±{MAX_INCREMENT:.3} at most"),
    ))
}
