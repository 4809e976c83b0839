//! Tool offset edits by pages: absolute values, increments, measurements.
//!
//! An edit applies from the next block that is read: blocks already read ahead keep their targets. Queued offset
//! changes are edited as well, so that they do not undo the edit when they are executed.
//! Source: spec K4.1, K5.10, K7.6, K7.7.

use std::sync::Arc;

use super::run::{Act, Item};
use super::{Controller, Effect};
use crate::defs::page::Page;
use crate::defs::text::{Said, Text};
use crate::link::edit::{MOST_INCREMENT, OffsetCommand, Part};
use crate::nc::Frames;
use crate::nc::frames::OFFSETS;
use crate::units::{Axis, PerAxis};

const NO_NUMBER: Text = Text::new("刀补号应为 1-16", "offsets are numbered 1 to 16");
const NOT_HERE: Text = Text::new("请在刀补或砂轮修整页面修改", "edit it on the offset or dressing page");
const OPEN_RUN: Text = Text::new("程序未结束，不能测量", "a program is open: no measurement");
const MOVING: Text = Text::new("轴还在运动，不能测量", "the axes still move: no measurement");

/// Whether an offset value, mm as displayed, is within the range for pages and programs.
pub(super) fn in_range(part: Part, shown: f64) -> bool {
    shown.is_finite() && shown.abs() <= part.most()
}

impl Controller {
    /// Executes a command of the offset or the dressing page.
    pub(super) fn take_offset(&mut self, command: OffsetCommand) -> Result<Said, Said> {
        match command {
            OffsetCommand::Set { number, part, axis, value } => {
                let index = self.offset_place(number, axis)?;
                // K7.7: P22.0 does not protect the geometry; the dressing page has no protection.
                if part == Part::Geometry && self.page == Page::Offset {
                    self.check_run()?;
                } else {
                    self.check_offset_page(part)?;
                }
                self.put_offset(index, part, axis, value / self.displayed_per_mm(axis))
            }
            OffsetCommand::AddGeometry { number, axis, by } => {
                let index = self.offset_place(number, axis)?;
                self.check_offset_page(Part::Geometry)?;
                check_increment(by)?;
                let sum = self.frames.geometry[index][axis] + by / self.displayed_per_mm(axis);
                self.put_offset(index, Part::Geometry, axis, sum)
            }
            OffsetCommand::Measure { number, axis, value } => {
                let index = self.offset_place(number, axis)?;
                self.check_offset_page(Part::Geometry)?;
                self.measure(index, axis, value)
            }
        }
    }

    /// A wear increment typed on a page.
    pub(super) fn type_wear_increment(&mut self, number: usize, axis: Axis, by: f64) -> Result<Said, Said> {
        self.offset_place(number, axis)?;
        self.check_offset_page(Part::Wear)?;
        check_increment(by)?;
        self.add_wear(number, axis, by)
    }

    /// Adds to the wear of an offset, mm as displayed (U, V, W on a page). G10 has the same range (K4.1).
    ///
    /// # Errors
    /// No such offset or axis, or the sum is out of range. Nothing is changed then.
    pub(super) fn add_wear(&mut self, number: usize, axis: Axis, by: f64) -> Result<Said, Said> {
        let index = self.offset_place(number, axis)?;
        let sum = self.frames.wear[index][axis] + by / self.displayed_per_mm(axis);
        self.put_offset(index, Part::Wear, axis, sum)
    }

    /// K5.10: a measurement sets the geometry and clears the wear of its axis.
    fn measure(&mut self, index: usize, axis: Axis, value: f64) -> Result<Said, Said> {
        if self.run.is_some() {
            return Err(OPEN_RUN.into());
        }
        if !self.axes.is_at_rest() {
            return Err(MOVING.into());
        }
        if !self.axes.is_homed(axis) {
            return Err(Said::new(format!("{axis} 未回零，不能测量"), format!("{axis} is not homed: no measurement")));
        }
        let frame = self.frames.work[self.frames.active][axis] + self.frames.shift[axis];
        let geometry = self.axes.actual()[axis] - frame - value / self.displayed_per_mm(axis);
        let said = self.put_offset(index, Part::Geometry, axis, geometry)?;
        self.put_offset(index, Part::Wear, axis, 0.0)?;
        Ok(Said::new(format!("{}，磨耗已清零", said.zh), format!("{}, wear cleared", said.en)))
    }

    /// The index of an offset, if the machine has the axis.
    fn offset_place(&self, number: usize, axis: Axis) -> Result<usize, Said> {
        if !self.axes.is_present(axis) {
            return Err(Said::new(format!("没有 {axis} 轴"), format!("there is no axis {axis}")));
        }
        number.checked_sub(1).filter(|index| *index < OFFSETS).ok_or_else(|| NO_NUMBER.into())
    }

    /// Whether the open page may change this value now.
    fn check_offset_page(&self, part: Part) -> Result<(), Said> {
        match self.page {
            Page::Offset => self.check_unlocked()?,
            Page::Dressing if part == Part::Wear => {}
            _ => return Err(NOT_HERE.into()),
        }
        self.check_run()
    }

    /// Sets one value, radius mm, and stores it on disk.
    fn put_offset(&mut self, index: usize, part: Part, axis: Axis, value: f64) -> Result<Said, Said> {
        let shown = value * self.displayed_per_mm(axis);
        let most = part.most();
        if !in_range(part, shown) {
            return Err(Said::new(
                format!("超出范围 ±{most:.3}：{shown:.3}"),
                format!("out of range ±{most:.3}: {shown:.3}"),
            ));
        }
        let old = std::mem::replace(&mut half(&mut self.frames, part)[index][axis], value);
        let carry = |frames: &mut Frames| {
            let place = &mut half(frames, part)[index][axis];
            *place = if place.to_bits() == old.to_bits() { value } else { *place + (value - old) };
        };
        if let Some(run) = &mut self.run {
            carry(Arc::make_mut(&mut run.planned.frames));
            for item in &mut run.items {
                if let Item::Do(Act::Frames(frames)) = item {
                    carry(Arc::make_mut(frames));
                }
            }
        }
        let (geometry, wear) = (self.frames.geometry[index], self.frames.wear[index]);
        self.effects.push(Effect::Offset { number: index + 1, geometry, wear });
        let (name, number) = (part.name(), index + 1);
        Ok(Said::new(
            format!("刀补 {number:02} {} {axis} = {shown:.3}", name.zh),
            format!("offset {number:02} {} {axis} = {shown:.3}", name.en),
        ))
    }

    /// Converts radius mm to displayed mm.
    pub(super) fn displayed(&self, values: &PerAxis<f64>) -> PerAxis<f64> {
        PerAxis::from_fn(|axis| values[axis] * self.displayed_per_mm(axis))
    }
}

fn half(frames: &mut Frames, part: Part) -> &mut [PerAxis<f64>; OFFSETS] {
    match part {
        Part::Geometry => &mut frames.geometry,
        Part::Wear => &mut frames.wear,
    }
}

fn check_increment(by: f64) -> Result<(), Said> {
    if by.abs() <= MOST_INCREMENT {
        return Ok(());
    }
    Err(Said::new(
        format!("一次增量最大 ±{MOST_INCREMENT:.3}"),
        format!("an increment is ±{MOST_INCREMENT:.3} at most"),
    ))
}
