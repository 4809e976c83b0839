//! Machine and work coordinates: work offsets, G50 shift, tool offsets.
//!
//! All values are radius millimetres of slide travel. machine = work + G5x offset + G50 shift + geometry + wear.
//! Source: spec B2 (G50, G53–G59, T), K4.1, K5.10.

use super::cutter::{CutterRangeError, CutterShape};
use crate::defs::system_variable;
use crate::units::{Axis, MachinePos, PerAxis, WorkPos};

/// Number of tool offsets: T xx01 … xx16.
pub const TOOL_OFFSET_COUNT: usize = 16;
/// Number of work offsets: G54 … G59.
pub const WORK_OFFSET_COUNT: usize = 6;

/// All offsets, and which of them are active.
#[derive(Clone, Debug, PartialEq)]
pub struct WorkOffsets {
    /// G54 … G59.
    pub work: [PerAxis<f64>; WORK_OFFSET_COUNT],
    /// Index of the active work offset, from 0.
    pub active: usize,
    /// The shift by G50 (G92).
    pub shift: PerAxis<f64>,
    /// Geometry of each tool offset.
    pub geometry: [PerAxis<f64>; TOOL_OFFSET_COUNT],
    /// Wear of each tool offset.
    pub wear: [PerAxis<f64>; TOOL_OFFSET_COUNT],
    /// Circle of each tool offset, for G41 and G42.
    pub cutter: [CutterShape; TOOL_OFFSET_COUNT],
    /// Active tool, 0 for none.
    pub tool: u32,
    /// Active tool offset, 1 to 16; 0 for none.
    pub tool_offset: usize,
}

impl Default for WorkOffsets {
    fn default() -> Self {
        Self {
            work: [PerAxis::default(); WORK_OFFSET_COUNT],
            active: 0,
            shift: PerAxis::default(),
            geometry: [PerAxis::default(); TOOL_OFFSET_COUNT],
            wear: [PerAxis::default(); TOOL_OFFSET_COUNT],
            cutter: [CutterShape::default(); TOOL_OFFSET_COUNT],
            tool: 0,
            tool_offset: 0,
        }
    }
}

impl WorkOffsets {
    /// Machine coordinate minus work coordinate.
    #[must_use]
    pub fn machine_minus_work(&self, axis: Axis) -> f64 {
        let tool = match self.tool_offset {
            0 => 0.0,
            offset => self.geometry[offset - 1][axis] + self.wear[offset - 1][axis],
        };
        self.work[self.active][axis] + self.shift[axis] + tool
    }

    /// The work coordinate of a machine position.
    #[must_use]
    pub fn work_from_machine(&self, machine: MachinePos) -> WorkPos {
        WorkPos::from_fn(|axis| machine[axis] - self.machine_minus_work(axis))
    }

    /// The machine position of a work coordinate.
    #[must_use]
    pub fn machine_from_work(&self, work: WorkPos) -> MachinePos {
        MachinePos::from_fn(|axis| work[axis] + self.machine_minus_work(axis))
    }

    /// Activates the work offset G54 … G59.
    pub fn activate(&mut self, g: u8) {
        self.active = usize::from(g.saturating_sub(54)).min(WORK_OFFSET_COUNT - 1);
    }

    /// Activates tool and offset of a T word; tool 0 keeps the tool.
    pub fn call_tool(&mut self, tool: u16, offset: u16) {
        if tool != 0 {
            self.tool = u32::from(tool);
        }
        self.tool_offset = usize::from(offset).min(TOOL_OFFSET_COUNT);
    }

    /// Activates another turret station. With compensation the machine moves by `by` and the work coordinates stay;
    /// without it nothing moves (L8).
    pub fn change_tool(&mut self, station: u8, by: Option<PerAxis<f64>>) {
        self.tool = u32::from(station);
        if let Some(by) = by {
            self.shift = PerAxis::from_fn(|axis| self.shift[axis] + by[axis]);
        }
    }

    /// The tool compensation: the geometry of the tool, slide travel (L8).
    #[must_use]
    pub fn tool_compensation(&self, tool: u32) -> PerAxis<f64> {
        (tool as usize).checked_sub(1).and_then(|index| self.geometry.get(index)).copied().unwrap_or_default()
    }

    /// The circle of a tool offset, 1 to 16; none for every other number.
    #[must_use]
    pub fn cutter_of(&self, offset: usize) -> CutterShape {
        offset.checked_sub(1).and_then(|index| self.cutter.get(index)).copied().unwrap_or_default()
    }

    /// R or T of an offset by its system variable.
    #[must_use]
    pub fn cutter_variable(&self, number: u32) -> Option<f64> {
        let radius = system_variable::CUTTER_RADIUS.index(number).map(|index| self.cutter[index].radius_mm);
        radius.or_else(|| system_variable::CUTTER_TIP.index(number).map(|index| f64::from(self.cutter[index].tip)))
    }

    /// Sets R or T of an offset by its system variable; the index of the offset, from 0.
    ///
    /// # Errors
    /// The value is out of range; nothing is changed. `None`: the variable is neither.
    pub fn set_cutter_variable(&mut self, number: u32, value: f64) -> Option<Result<usize, CutterRangeError>> {
        let radius = system_variable::CUTTER_RADIUS.index(number);
        let index = radius.or_else(|| system_variable::CUTTER_TIP.index(number))?;
        let cutter = &mut self.cutter[index];
        let changed = if radius.is_some() { cutter.set_radius(value) } else { cutter.set_tip(value) };
        Some(changed.map(|()| index))
    }

    /// G10: adds to the wear of an offset, 1 to 16.
    pub fn add_wear(&mut self, number: u8, by: PerAxis<f64>) {
        if let Some(wear) = usize::from(number).checked_sub(1).and_then(|index| self.wear.get_mut(index)) {
            *wear = PerAxis::from_fn(|axis| wear[axis] + by[axis]);
        }
    }

    /// G50: assigns the work coordinates `values` to a machine position. K5.10: clears the wear of the active offset.
    pub fn set_coordinates(&mut self, machine: MachinePos, values: &PerAxis<Option<f64>>) {
        if let Some(offset) = self.tool_offset.checked_sub(1) {
            self.wear[offset] = PerAxis::default();
        }
        for (axis, value) in values.iter() {
            if let Some(value) = value {
                self.shift[axis] += machine[axis] - self.machine_minus_work(axis) - value;
            }
        }
    }
}
