//! The list of the wheels of the shop: a wheel is kept under its number, mounted from the list, balanced, has hit something.
//! Source: spec K5.17; issue "the face", part 6.

use super::wheel_change::change_wheel;
use super::{Edited, Panel, Parts};
use crate::controller::plant::Plant;
use crate::controller::storage_request::StorageRequest;
use crate::defs::page::Page;
use crate::defs::param;
use crate::defs::text::{Text, phrase};
use crate::defs::wheel_record::{MAX_WHEELS, WHEEL_NUMBERS, WheelRecord};
use crate::link::wheels::WheelCommand;

const NOT_HERE: Text = Text::new("请在换砂轮页面操作", "use the wheel change page");
const NO_WHEEL: Text = Text::new("砂轮库中没有这个编号", "the list has no wheel of this number");
const IS_FULL: Text = Text::new("砂轮库已满：先删除不用的", "the list is full: remove wheels that are used up first");
const IS_MOUNTED: Text = Text::new("这片砂轮装在机床上", "this wheel is on the machine");
const NOT_KEPT: Text = Text::new("先给机床上的砂轮编号存入", "keep the wheel on the machine under a number first");

/// The wheels, by their numbers.
#[derive(Default)]
pub struct WheelList(Vec<WheelRecord>);

impl WheelList {
    /// As kept since the last power-off.
    pub fn at_power_on(kept: &[WheelRecord]) -> Self {
        let mut wheels = Vec::with_capacity(MAX_WHEELS);
        wheels.extend_from_slice(kept);
        Self(wheels)
    }

    /// Writes the view.
    pub fn write_view(&self, out: &mut Vec<WheelRecord>) {
        if *out != self.0 {
            out.clone_from(&self.0);
        }
    }

    fn find(&self, number: u16) -> Option<WheelRecord> {
        self.0.iter().find(|wheel| wheel.number == number).copied()
    }

    /// Enters a wheel, or changes the one of its number; stores it.
    fn set(&mut self, plant: &mut Plant, wheel: WheelRecord) {
        self.0.retain(|known| known.number != wheel.number);
        let place = self.0.partition_point(|known| known.number < wheel.number);
        self.0.insert(place, wheel);
        plant.store(StorageRequest::Wheel(wheel.number, Some(wheel)));
    }

    fn remove(&mut self, plant: &mut Plant, number: u16) {
        self.0.retain(|known| known.number != number);
        plant.store(StorageRequest::Wheel(number, None));
    }

    /// The wheel on the machine as it is now, if it is in the list.
    fn mounted(&self, plant: &Plant) -> Option<WheelRecord> {
        self.0.iter().find(|wheel| wheel.is_mounted).map(|wheel| as_it_is(plant, *wheel))
    }
}

/// A record with the size and rating of the wheel on the machine.
fn as_it_is(plant: &Plant, wheel: WheelRecord) -> WheelRecord {
    let value = |row| plant.params.get(row);
    WheelRecord {
        diameter_mm: value(param::WHEEL_DIAMETER),
        width_mm: value(param::WHEEL_WIDTH),
        rated_m_s: value(param::WHEEL_RATED_SPEED),
        smallest_mm: value(param::WHEEL_MIN_DIAMETER),
        ..wheel
    }
}

impl Panel {
    pub(super) fn handle_wheel_command(&mut self, parts: &mut Parts<'_>, command: WheelCommand) -> Edited {
        if parts.plant.operator.page != Page::Wheel {
            return Err(NOT_HERE.into());
        }
        match command {
            WheelCommand::Keep(number) => self.keep_wheel(parts.plant, number),
            WheelCommand::Mount(number) => self.mount_wheel(parts, number),
            WheelCommand::Remove(number) => {
                if self.wheels.find(number).ok_or(NO_WHEEL)?.is_mounted {
                    return Err(IS_MOUNTED.into());
                }
                self.wheels.remove(parts.plant, number);
                Ok(phrase!("{number} 号砂轮已删除", "wheel {number} removed from the list", number))
            }
            WheelCommand::Balanced => {
                let wheel = self.wheels.mounted(parts.plant).ok_or(NOT_KEPT)?;
                let balanced = Some(parts.plant.date);
                self.wheels.set(parts.plant, WheelRecord { balanced, is_suspect: false, ..wheel });
                let number = wheel.number;
                Ok(phrase!("{number} 号砂轮：平衡日期已记", "wheel {number}: balanced now", number))
            }
            WheelCommand::Crashed => {
                let wheel = self.wheels.mounted(parts.plant).ok_or(NOT_KEPT)?;
                let (number, crashes, crashed) = (wheel.number, wheel.crashes + 1, Some(parts.plant.date));
                self.wheels.set(parts.plant, WheelRecord { crashes, crashed, is_suspect: true, ..wheel });
                Ok(phrase!(
                    "{number} 号砂轮：已记碰撞，先检查、敲听，再平衡",
                    "wheel {number}: crash noted; look at it and sound it, then balance it",
                    number
                ))
            }
        }
    }

    /// Keeps the wheel on the machine under a number; under another one than before it is renumbered.
    fn keep_wheel(&mut self, plant: &mut Plant, number: u16) -> Edited {
        let (least, most) = (*WHEEL_NUMBERS.start(), *WHEEL_NUMBERS.end());
        if !WHEEL_NUMBERS.contains(&number) {
            return Err(phrase!("编号应在 {least} 到 {most}", "a number from {least} to {most}", least, most));
        }
        if self.wheels.find(number).is_some_and(|wheel| !wheel.is_mounted) {
            return Err(phrase!("{number} 号是另一片砂轮", "number {number} is another wheel", number));
        }
        let wheel = match self.wheels.mounted(plant) {
            None if self.wheels.0.len() >= MAX_WHEELS => return Err(IS_FULL.into()),
            None => as_it_is(
                plant,
                WheelRecord { number, mounted: Some(plant.date), is_mounted: true, ..WheelRecord::default() },
            ),
            Some(known) => {
                self.wheels.remove(plant, known.number);
                WheelRecord { number, ..known }
            }
        };
        self.wheels.set(plant, wheel);
        Ok(phrase!("{number} 号砂轮已存入", "wheel {number} is in the list", number))
    }

    /// A wheel of the list comes onto the machine: a wheel change with its data.
    fn mount_wheel(&mut self, parts: &mut Parts<'_>, number: u16) -> Edited {
        let wheel = self.wheels.find(number).ok_or(NO_WHEEL)?;
        if wheel.is_mounted {
            return Err(IS_MOUNTED.into());
        }
        if wheel.is_worn() {
            let (diameter, smallest) = (wheel.diameter_mm, wheel.smallest_mm);
            return Err(phrase!(
                "{number} 号砂轮 Ø{diameter} 已到最小直径 {smallest}",
                "wheel {number}, Ø{diameter}, is down to its smallest diameter {smallest}",
                number,
                diameter,
                smallest
            ));
        }
        let done = self.change_wheel(parts, [wheel.diameter_mm, wheel.width_mm, wheel.rated_m_s])?;
        parts.plant.store_param(param::WHEEL_MIN_DIAMETER.address(), wheel.smallest_mm);
        self.wheels.set(parts.plant, WheelRecord { mounted: Some(parts.plant.date), is_mounted: true, ..wheel });
        Ok(done)
    }

    /// Another wheel is on the machine (K5.17); what has become of the one before is kept in the list. A smallest diameter
    /// that the new one does not have was that of the old one.
    pub(super) fn change_wheel(&mut self, parts: &mut Parts<'_>, size: [f64; 3]) -> Edited {
        let (before, dressings) =
            (self.wheels.mounted(parts.plant), parts.plant.params.get(param::DRESSING_COUNT) as u32);
        let done = change_wheel(parts, &self.screens, size)?;
        if let Some(wheel) = before {
            let dressings = wheel.dressings + dressings;
            self.wheels.set(parts.plant, WheelRecord { dressings, is_mounted: false, ..wheel });
        }
        if parts.plant.params.get(param::WHEEL_MIN_DIAMETER) >= size[0] {
            parts.plant.store_param(param::WHEEL_MIN_DIAMETER.address(), 0.0);
        }
        self.forget_offset_of_part();
        Ok(done)
    }
}
