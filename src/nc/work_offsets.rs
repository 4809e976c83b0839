//! Machine and work coordinates: work offsets, local zero, G50 shift, tool offsets.
//!
//! All values are radius millimetres of slide travel.
//! machine = work + external offset + G5x offset + G52 local zero + G50 shift + geometry + wear.
//! Source: spec B2 (G50, G52–G59, T), B3 (#5201 …), K4.1, K5.10.

use super::cutter::{CutterRangeError, CutterShape};
use crate::defs::system_variable;
use crate::units::{Axis, MachinePos, PerAxis, WorkPos};

/// Number of tool offsets: T xx01 … xx16.
pub const TOOL_OFFSET_COUNT: usize = 16;
/// Number of work offsets: G54 … G59, then G54.1 P1 … P48.
pub const WORK_OFFSET_COUNT: usize = 6 + EXTRA_WORK_OFFSETS;
/// Number of work offsets of G54.1.
pub const EXTRA_WORK_OFFSETS: usize = 48;
/// Added to P in the number by which G54.1 P1 … P48 are selected; G54 … G59 have their own. Without P it is G500 of the
/// 802D: no work offset.
pub const EXTRA_G: u8 = 100;

/// An origin that a page, a parameter file or a program can set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OriginPlace {
    /// The external offset, which acts on all others.
    External,
    /// A work offset: 0 is G54, 6 is G54.1 P1.
    Work(usize),
}

impl OriginPlace {
    /// All of them: external, G54 … G59, P1 … P48.
    pub const COUNT: usize = WORK_OFFSET_COUNT + 1;

    /// The place at an index in this order.
    #[must_use]
    pub const fn at(index: usize) -> Option<Self> {
        match index {
            0 => Some(Self::External),
            1..=WORK_OFFSET_COUNT => Some(Self::Work(index - 1)),
            _ => None,
        }
    }

    /// Its index in this order.
    #[must_use]
    pub const fn index(self) -> usize {
        match self {
            Self::External => 0,
            Self::Work(index) => index + 1,
        }
    }

    /// The active work offset; none under G500.
    #[must_use]
    pub const fn of_active(offsets: &WorkOffsets) -> Option<Self> {
        if offsets.active < WORK_OFFSET_COUNT { Some(Self::Work(offsets.active)) } else { None }
    }

    /// The index by which it is stored: 0 is G54, the external offset comes last.
    #[must_use]
    pub const fn stored_index(self) -> usize {
        match self {
            Self::External => WORK_OFFSET_COUNT,
            Self::Work(index) => index,
        }
    }

    /// The place that is stored by an index.
    #[must_use]
    pub const fn of_stored_index(index: usize) -> Option<Self> {
        match index {
            WORK_OFFSET_COUNT => Some(Self::External),
            0..WORK_OFFSET_COUNT => Some(Self::Work(index)),
            _ => None,
        }
    }

    /// Place and index of the axis (in the order of the fitted axes) of #5201 … #5323 and #7001 … #7943.
    #[must_use]
    pub fn of_variable(number: u32) -> Option<(Self, usize)> {
        if let Some(index) = system_variable::EXTERNAL_ORIGIN.index(number) {
            return Some((Self::External, index));
        }
        let step = system_variable::ORIGIN_STEP as usize;
        let (first, index) = match system_variable::EXTRA_ORIGINS.index(number) {
            Some(index) => (WORK_OFFSET_COUNT - EXTRA_WORK_OFFSETS, index),
            None => (0, system_variable::ORIGINS.index(number)?),
        };
        (index % step < system_variable::EXTERNAL_ORIGIN.count as usize)
            .then_some((Self::Work(first + index / step), index % step))
    }

    /// The variable of its first axis.
    #[must_use]
    pub const fn first_variable(self) -> u32 {
        const PLAIN: usize = WORK_OFFSET_COUNT - EXTRA_WORK_OFFSETS;
        match self {
            Self::External => system_variable::EXTERNAL_ORIGIN.first,
            Self::Work(index) if index < PLAIN => {
                system_variable::ORIGINS.first + index as u32 * system_variable::ORIGIN_STEP
            }
            Self::Work(index) => {
                system_variable::EXTRA_ORIGINS.first + (index - PLAIN) as u32 * system_variable::ORIGIN_STEP
            }
        }
    }
}

/// A value of a tool offset that a page or a program can set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ToolOffsetPlace {
    /// Wear, else geometry.
    pub is_wear: bool,
    /// The offset, from 0.
    pub index: usize,
    /// The axis.
    pub axis: Axis,
}

impl ToolOffsetPlace {
    /// The place of #2001 … #2816.
    #[must_use]
    pub fn of_variable(number: u32) -> Option<Self> {
        use system_variable::{GEOMETRY_X, GEOMETRY_Y, GEOMETRY_Z, WEAR_X, WEAR_Y, WEAR_Z};
        let wear = [(WEAR_X, Axis::X), (WEAR_Y, Axis::Y), (WEAR_Z, Axis::Z)].map(|row| (row, true));
        let geometry = [(GEOMETRY_X, Axis::X), (GEOMETRY_Y, Axis::Y), (GEOMETRY_Z, Axis::Z)].map(|row| (row, false));
        let mut rows = wear.into_iter().chain(geometry);
        rows.find_map(|((range, axis), is_wear)| Some(Self { is_wear, index: range.index(number)?, axis }))
    }
}

/// All offsets, and which of them are active.
#[derive(Clone, Debug, PartialEq)]
pub struct WorkOffsets {
    /// The external offset, added to every work offset.
    pub external: PerAxis<f64>,
    /// G52: the local zero in the active work offset; a program begins without one.
    pub local: PerAxis<f64>,
    /// G54 … G59, G54.1 P1 … P48.
    pub work: [PerAxis<f64>; WORK_OFFSET_COUNT],
    /// Index of the active work offset, from 0; [`WORK_OFFSET_COUNT`] for none.
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
            external: PerAxis::default(),
            local: PerAxis::default(),
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
        let origin = self.work.get(self.active).map_or(0.0, |origin| origin[axis]);
        self.external[axis] + origin + self.local[axis] + self.shift[axis] + tool
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

    /// Activates the work offset G54 … G59, or G54.1 P1 … P48 as [`EXTRA_G`] + P; [`EXTRA_G`] alone is none.
    pub fn activate(&mut self, g: u8) {
        let plain = WORK_OFFSET_COUNT - EXTRA_WORK_OFFSETS;
        self.active = match g.checked_sub(EXTRA_G) {
            None => usize::from(g.saturating_sub(54)).min(plain - 1),
            Some(0) => WORK_OFFSET_COUNT,
            Some(extra) => (plain + usize::from(extra) - 1).min(WORK_OFFSET_COUNT - 1),
        };
    }

    /// An origin, machine coordinates.
    #[must_use]
    pub fn origin(&self, place: OriginPlace) -> PerAxis<f64> {
        match place {
            OriginPlace::External => self.external,
            OriginPlace::Work(index) => self.work.get(index).copied().unwrap_or_default(),
        }
    }

    /// Sets an origin; one that does not exist stays away.
    pub fn set_origin(&mut self, place: OriginPlace, origin: PerAxis<f64>) {
        match place {
            OriginPlace::External => self.external = origin,
            OriginPlace::Work(index) => self.work.get_mut(index).into_iter().for_each(|work| *work = origin),
        }
    }

    /// G52: the local zero of the named axes.
    pub fn set_local(&mut self, values: &PerAxis<Option<f64>>) {
        values.iter().for_each(|(axis, value)| self.local[axis] = value.unwrap_or(self.local[axis]));
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

    /// Wear or geometry of an offset, radius mm.
    #[must_use]
    pub fn tool_offset_value(&self, ToolOffsetPlace { is_wear, index, axis }: ToolOffsetPlace) -> f64 {
        let table = if is_wear { &self.wear } else { &self.geometry };
        table[index][axis]
    }

    /// Sets wear or geometry of an offset, radius mm.
    pub fn set_tool_offset_value(&mut self, ToolOffsetPlace { is_wear, index, axis }: ToolOffsetPlace, value: f64) {
        let table = if is_wear { &mut self.wear } else { &mut self.geometry };
        table[index][axis] = value;
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

    /// G50: assigns the work coordinates `values` to a machine position; the local zero of the named axes ends. K5.10:
    /// clears the wear of the active offset.
    pub fn set_coordinates(&mut self, machine: MachinePos, values: &PerAxis<Option<f64>>) {
        if let Some(offset) = self.tool_offset.checked_sub(1) {
            self.wear[offset] = PerAxis::default();
        }
        for (axis, value) in values.iter() {
            if let Some(value) = value {
                self.local[axis] = 0.0;
                self.shift[axis] += machine[axis] - self.machine_minus_work(axis) - value;
            }
        }
    }
}
