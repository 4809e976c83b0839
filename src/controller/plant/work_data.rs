//! Work data: offsets, variables, dressing points, programs, counts and measured positions.
//! Source: spec B2, B3, K4.1, K4.2, L3.

use std::sync::Arc;

use super::Plant;
use crate::controller::program::library::Programs;
use crate::controller::storage_request::StorageRequest;
use crate::link::edit::OffsetPart;
use crate::nc::{CommonVariables, CoordinateChange, CutterShape, Interpreter, OriginPlace, VariableError, WorkOffsets};
use crate::units::{MachinePos, PerAxis, WorkPos};

/// Results of the last G78 for the program: #434 to #437, mm as displayed.
pub type GaugePositions = [Option<f64>; 4];

/// What a program asks of single block and feed hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ProgramControls {
    /// #3003, 0 to 3: bit 0 runs through single blocks.
    pub single_block: u8,
    /// #3004, 0 to 7; it has no effect.
    pub hold: u8,
}

/// The data a program works with, as executed.
#[derive(Debug, Default)]
pub struct WorkData {
    /// Work offsets and tool offsets.
    pub offsets: WorkOffsets,
    /// Macro variables.
    pub variables: CommonVariables,
    /// Dressing points, machine coordinates, radius mm (K4.2); `None` where not set.
    pub dress_points: PerAxis<Option<f64>>,
    /// The programs of the folder.
    pub programs: Arc<Programs>,
    /// Workpiece count.
    pub part_count: u32,
    /// Offsets added to the time since power-on in #3001 (ms) and #3002 (h).
    pub timer_offset: [f64; 2],
    /// #3003 and #3004 as the program in progress has set them.
    pub program_controls: ProgramControls,
    /// Position latched by the last G31, work coordinates, radius mm.
    pub skip_position: WorkPos,
    /// The wheel has touched something since a program has reset this (#5827).
    pub contact_seen: bool,
    /// Results of the last G78.
    pub gauge_positions: GaugePositions,
    /// The tool-change point: tip position at the start of the last program, machine coordinates (L3).
    pub tool_change_point: Option<MachinePos>,
    /// The program that was started last, and where the axes stood then: a run from a chosen block reckons from there.
    /// None since power-on, and once the program has begun anew elsewhere.
    pub program_start: Option<(u32, MachinePos)>,
}

impl WorkData {
    /// Moves the places that count from a start of a program, with the slides or with the machine's zero.
    pub fn move_starts(&mut self, by: PerAxis<f64>) {
        let Self { tool_change_point, program_start, .. } = self;
        let starts = tool_change_point.iter_mut().chain(program_start.iter_mut().map(|(_, start)| start));
        starts.for_each(|start| *start = *start + by);
    }

    /// Where the axes stood when a program was started last; none if another one was, or if that is not known.
    pub fn start_of(&self, program: u32) -> Option<MachinePos> {
        self.program_start.filter(|(number, _)| *number == program).map(|(_, start)| start)
    }
}

/// Whether an offset value, mm as displayed, is within the range for pages and programs.
pub fn offset_in_range(part: OffsetPart, shown: f64) -> bool {
    shown.is_finite() && shown.abs() <= part.max_abs()
}

impl Plant {
    /// Sets a common variable for the operator; retained variables are also stored on disk.
    pub fn store_variable(&mut self, variable: u32, value: Option<f64>) -> Result<(), VariableError> {
        self.work.variables.set(variable, value)?;
        if CommonVariables::is_retained(variable) {
            self.store(StorageRequest::Variable(variable, value));
        }
        Ok(())
    }

    /// Changes the work coordinates for a program, and the wear with them.
    pub fn change_coordinates(&mut self, change: CoordinateChange) {
        let before = self.work.offsets.wear;
        change.apply(&mut self.work.offsets, self.axes.set_point());
        for (index, wear) in before.iter().enumerate() {
            if *wear != self.work.offsets.wear[index] {
                self.note_offset(index);
            }
        }
    }

    /// Changes to the tool of a turret station. The tool-change point moves with the slides (L8).
    pub fn change_tool(&mut self, station: u8, by: Option<PerAxis<f64>>) {
        self.work.offsets.change_tool(station, by);
        by.into_iter().for_each(|by| self.work.move_starts(by));
    }

    /// A program ends. One that M99 has led back to its head has begun elsewhere than it was started.
    pub fn note_end_of(&mut self, program: &Interpreter) {
        if program.has_begun_anew() {
            self.work.program_start = None;
        }
    }

    /// Stores a changed offset (index from 0) on disk.
    pub fn store_offset(&mut self, index: usize) {
        let (geometry, wear) = (self.work.offsets.geometry[index], self.work.offsets.wear[index]);
        self.store(StorageRequest::Offset { number: index + 1, geometry, wear });
    }

    /// Stores an origin on disk.
    pub fn store_origin(&mut self, place: OriginPlace) {
        self.store(StorageRequest::WorkOffset(place, self.work.offsets.origin(place)));
    }

    /// Stores the circle of an offset (index from 0) on disk.
    pub fn store_cutter(&mut self, index: usize) {
        let CutterShape { radius_mm, tip } = self.work.offsets.cutter[index];
        self.store(StorageRequest::CutterRadius(index + 1, radius_mm));
        self.store(StorageRequest::CutterTip(index + 1, tip));
    }

    /// Counts a finished part.
    pub fn count_part(&mut self) {
        self.work.part_count += 1;
        self.store(StorageRequest::PartCount(self.work.part_count));
        self.count_since_dressing();
    }

    /// Run start: sets the tool-change point (programs only) and reads the present tool from its switch (L3, L8).
    pub fn start_lathe_program(&mut self, program: bool) {
        if program {
            self.work.tool_change_point = Some(self.axes.set_point());
        }
        if let Some(station) = self.turret_station() {
            self.work.offsets.tool = u32::from(station);
        }
    }
}
