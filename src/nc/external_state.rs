//! State outside the program text: positions and live values; and its version without a machine. Source: spec B3, T4.

use super::cutter::CutterShape;
use super::op::{Feed, Op, REFERENCE_POINTS, SpeedMode};
use super::op_effect::{ArcMove, MotionSegment, OpEffect, OscillationChange, SegmentSpeed};
use super::settings::NcSettings;
use super::work_offsets::{OriginPlace, ToolOffsetPlace, WorkOffsets};
use crate::defs::system_variable::{self, VariableAccess};
use crate::units::{Axis, MachinePos, PerAxis, WorkPos};

/// Position, path length, time and extents so far.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RunTotals {
    position: WorkPos,
    length_mm: f64,
    seconds: f64,
    extents: Option<(WorkPos, WorkPos)>,
}

impl RunTotals {
    /// Adds a segment of a path.
    #[inline]
    fn add(&mut self, segment: &MotionSegment, rapid_mm_min: PerAxis<f64>, rpm: f64) {
        let (from, to) = (self.position, segment.to);
        self.extend_to(from);
        let length = match &segment.arc {
            None => distance(from, to),
            Some(arc) => {
                let normal = arc.plane.normal_axis();
                self.extend_along(arc, to).hypot(to[normal] - from[normal])
            }
        };
        self.extend_to(to);
        self.seconds += match segment.speed {
            SegmentSpeed::Rapid => {
                let minutes = |axis: Axis| (to[axis] - from[axis]).abs() / rapid_mm_min[axis].max(1.0);
                60.0 * Axis::ALL.into_iter().map(minutes).fold(0.0, f64::max)
            }
            SegmentSpeed::Feed(Feed::PerMinute(feed)) => 60.0 * length / feed,
            SegmentSpeed::Feed(Feed::PerRev(feed)) => 60.0 * length / (feed * rpm),
            SegmentSpeed::Revolutions(turns) => 60.0 * (turns / rpm),
        };
        self.length_mm += length;
        self.position = to;
    }

    /// Extends the extents by the bulges of an arc; returns its length.
    fn extend_along(&mut self, arc: &ArcMove, to: WorkPos) -> f64 {
        let from = self.position;
        let (radius, swept) = (arc.radius_at(from), arc.sweep(from, to));
        for quarter in 0..4 {
            let compass = f64::from(quarter) * std::f64::consts::FRAC_PI_2;
            if arc.sweep_to_angle(from, compass) < swept {
                self.extend_to(arc.point_at(from, radius, compass));
            }
        }
        radius * swept
    }

    #[inline]
    fn extend_to(&mut self, point: WorkPos) {
        let (low, high) = self.extents.get_or_insert((point, point));
        for axis in Axis::ALL {
            if point[axis] < low[axis] {
                low[axis] = point[axis];
            }
            if point[axis] > high[axis] {
                high[axis] = point[axis];
            }
        }
    }
}

/// The result of reading a live value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LiveValue {
    /// The value; `None` for null.
    Value(Option<f64>),
    /// All motion must be done first; the same block is read again then.
    Drain,
    /// The variable does not exist.
    Unknown,
}

/// State outside the program text.
pub trait ExternalState {
    /// The position at the end of all operations returned so far, active work coordinates, radius mm.
    fn position(&self) -> WorkPos;
    /// Reads a system variable: #434–#439, #1000 and up except #4001–#4130. X positions are diameters if X words are.
    /// `#1000` + port − 1 is input `port`: 1 while it is active (low).
    fn system_variable(&mut self, number: u32) -> LiveValue;
    /// Tool compensation of tool 1 to 4, slide travel, radius mm (L8).
    fn tool_compensation(&self, _tool: u32) -> PerAxis<f64> {
        PerAxis::default()
    }
    /// The active tool, 0 for none.
    fn active_tool(&self) -> u32 {
        0
    }
    /// The circle with which offset 1 to 16 touches the contour; without one for every other number.
    fn cutter(&self, _offset: usize) -> CutterShape {
        CutterShape::default()
    }
    /// The tool-change point: the position at program start, active work coordinates, radius mm. It is a fixed machine
    /// position of the tip: G92 and homing do not move it (L3).
    fn program_start(&self) -> WorkPos {
        self.position()
    }
    /// The 跳段 (block skip) switch: blocks with `/` are skipped.
    fn block_skip(&self) -> bool;
}

/// The state while blocks are read whose moves are not returned yet: only the position differs.
pub(crate) struct AheadState<'w> {
    pub inner: &'w mut dyn ExternalState,
    /// The end of the last block read.
    pub position: WorkPos,
    /// The machine can be asked for values.
    pub reads_machine: bool,
}

impl ExternalState for AheadState<'_> {
    fn position(&self) -> WorkPos {
        self.position
    }

    fn system_variable(&mut self, number: u32) -> LiveValue {
        if self.reads_machine { self.inner.system_variable(number) } else { LiveValue::Drain }
    }

    fn tool_compensation(&self, tool: u32) -> PerAxis<f64> {
        self.inner.tool_compensation(tool)
    }

    fn active_tool(&self) -> u32 {
        self.inner.active_tool()
    }

    fn cutter(&self, offset: usize) -> CutterShape {
        self.inner.cutter(offset)
    }

    fn program_start(&self) -> WorkPos {
        self.inner.program_start()
    }

    fn block_skip(&self) -> bool {
        self.inner.block_skip()
    }
}

/// System variables and their values, in the order of their numbers.
pub type SystemVariables = Vec<(u32, Option<f64>)>;

/// State without a machine: every operation is done at once.
#[derive(Clone, Debug)]
pub struct OfflineMachine {
    axes: PerAxis<bool>,
    diameter: bool,
    rapid_mm_min: PerAxis<f64>,
    totals: RunTotals,
    /// The tip before the first operation, machine coordinates (L3).
    start: Option<MachinePos>,
    work_offsets: WorkOffsets,
    references: [MachinePos; REFERENCE_POINTS],
    /// In the order of their numbers.
    system_variables: SystemVariables,
    /// Values that only the machine knows are not 0: reading one returns `LiveValue::Drain`.
    known_values_only: bool,
    block_skip: bool,
    rpm: f64,
    /// While an axis oscillates, #438 and #439 toggle on every read, so that a wait for a reversal point ends.
    oscillation_end: Option<bool>,
    /// A value was read that only the machine knows.
    guesses: bool,
}

/// Speed for a feed per revolution as long as no S is programmed, rpm.
const DEFAULT_RPM: f64 = 1_000.0;

impl OfflineMachine {
    /// All axes at zero, all inputs inactive.
    #[must_use]
    pub fn new(settings: &NcSettings) -> Self {
        Self {
            axes: settings.axes,
            diameter: settings.diameter,
            rapid_mm_min: settings.rapid_mm_min,
            totals: RunTotals::default(),
            start: None,
            // L8: a turret that was never indexed has station 1 active.
            work_offsets: WorkOffsets { tool: u32::from(settings.start_is_work_zero), ..WorkOffsets::default() },
            references: [MachinePos::default(); REFERENCE_POINTS],
            system_variables: SystemVariables::new(),
            known_values_only: false,
            block_skip: false,
            rpm: if settings.start_is_work_zero { settings.superman.spindle_rpm } else { DEFAULT_RPM },
            oscillation_end: None,
            guesses: false,
        }
    }

    /// Whether a value was read that only the machine knows: what follows from it is not certain.
    pub(super) const fn guesses(&self) -> bool {
        self.guesses
    }

    /// Starts at another position: work coordinates, radius mm.
    #[must_use]
    pub fn with_position(mut self, position: WorkPos) -> Self {
        self.totals.position = position;
        self
    }

    /// Sets work offsets and tool offsets; the work position does not change.
    #[must_use]
    pub fn with_work_offsets(mut self, offsets: WorkOffsets) -> Self {
        let tool = if offsets.tool == 0 { self.work_offsets.tool } else { offsets.tool };
        self.work_offsets = WorkOffsets { tool, ..offsets };
        self
    }

    /// Sets the reference points of G28 and G30, machine coordinates, radius mm. Homing ends at the first.
    #[must_use]
    pub const fn with_references(mut self, references: [MachinePos; REFERENCE_POINTS]) -> Self {
        self.references = references;
        self
    }

    /// Makes values that were not set unreadable, instead of 0.
    #[must_use]
    pub const fn with_known_values_only(mut self) -> Self {
        self.known_values_only = true;
        self
    }

    /// Sets the 跳段 (block skip) switch.
    #[must_use]
    pub fn with_block_skip(mut self, skip: bool) -> Self {
        self.block_skip = skip;
        self
    }

    /// Sets a system variable.
    pub fn set_system(&mut self, number: u32, value: Option<f64>) {
        match self.system_variables.binary_search_by_key(&number, |(known, _)| *known) {
            Ok(index) => self.system_variables[index].1 = value,
            Err(index) => self.system_variables.insert(index, (number, value)),
        }
    }

    /// Keeps system variables in this memory.
    #[must_use]
    pub fn with_system_variables(mut self, mut memory: SystemVariables) -> Self {
        memory.clear();
        self.system_variables = memory;
        self
    }

    /// The memory of the system variables.
    #[must_use]
    pub fn into_system_variables(self) -> SystemVariables {
        self.system_variables
    }

    /// The active work offsets and tool offsets.
    #[must_use]
    pub const fn work_offsets(&self) -> &WorkOffsets {
        &self.work_offsets
    }

    /// The work position, radius mm.
    #[must_use]
    pub const fn work_position(&self) -> WorkPos {
        self.totals.position
    }

    /// The path length so far, mm.
    #[must_use]
    pub const fn length_mm(&self) -> f64 {
        self.totals.length_mm
    }

    /// The time so far without acceleration, seconds.
    #[must_use]
    pub const fn seconds(&self) -> f64 {
        self.totals.seconds
    }

    /// Least and greatest work coordinates of all moves, radius mm.
    #[must_use]
    pub const fn extents(&self) -> Option<(WorkPos, WorkPos)> {
        self.totals.extents
    }

    /// The totals so far.
    pub(crate) const fn totals(&self) -> RunTotals {
        self.totals
    }

    /// Restores earlier totals.
    pub(crate) const fn restore_totals(&mut self, to: RunTotals) {
        self.totals = to;
    }

    /// Clears the extents.
    pub const fn reset_extents(&mut self) {
        self.totals.extents = None;
    }

    /// Executes one operation.
    #[inline]
    pub fn apply(&mut self, op: &Op) {
        self.apply_traced(op, |_, _| {});
    }

    /// Executes one operation and passes every segment of its path to `sink`, with its start: work coordinates, radius
    /// mm.
    #[inline]
    pub fn apply_traced(&mut self, op: &Op, mut sink: impl FnMut(WorkPos, &MotionSegment)) {
        if self.start.is_none() {
            self.start = Some(self.machine_position());
        }
        match op.effect() {
            OpEffect::Motion(motion) => {
                let Self { totals, work_offsets, references, rapid_mm_min, rpm, .. } = self;
                motion.trace(totals.position, work_offsets, references, |segment| {
                    sink(totals.position, &segment);
                    totals.add(&segment, *rapid_mm_min, *rpm);
                });
            }
            OpEffect::Coordinates(change) => {
                let machine = self.machine_position();
                change.apply(&mut self.work_offsets, machine);
                self.totals.position = self.work_offsets.work_from_machine(machine);
            }
            OpEffect::IndexTurret { station, by } => self.change_tool(station, by),
            // An oscillating axis returns to its start.
            OpEffect::Oscillation(OscillationChange::Axis { .. } | OscillationChange::Cylinder { .. }) => {
                self.oscillation_end = Some(false);
            }
            OpEffect::Oscillation(OscillationChange::Off) => self.oscillation_end = None,
            OpEffect::Dwell(seconds) => self.totals.seconds += seconds,
            OpEffect::Speed(value, SpeedMode::Rpm) if value > 0.0 => self.rpm = value,
            OpEffect::SystemVariable(number, value) => {
                let shown = value.unwrap_or(0.0);
                // A value out of range changes nothing: the run refuses it.
                let is_cutter = self.work_offsets.set_cutter_variable(number, shown).is_some();
                if !is_cutter && !self.set_offset(number, shown) {
                    self.set_system(number, value);
                }
            }
            OpEffect::Speed(..) | OpEffect::SpeedLimit(_) | OpEffect::PathMode(_) | OpEffect::MCode(_) => {}
            OpEffect::Variable(..) | OpEffect::Message(_) => {}
        }
    }

    /// Sets an origin or a tool offset by its variable, mm as displayed; the slides stand still. False: the variable is
    /// neither.
    fn set_offset(&mut self, number: u32, value: f64) -> bool {
        let machine = self.machine_position();
        let radius = |axis: Axis| if self.diameter && axis == Axis::X { value / 2.0 } else { value };
        if let Some(place) = ToolOffsetPlace::of_variable(number) {
            let value = radius(place.axis);
            self.work_offsets.set_tool_offset_value(place, value);
        } else if let Some((place, index)) = OriginPlace::of_variable(number) {
            let Some(axis) = Axis::ALL.into_iter().filter(|axis| self.axes[*axis]).nth(index) else { return true };
            let mut origin = self.work_offsets.origin(place);
            origin[axis] = radius(axis);
            self.work_offsets.set_origin(place, origin);
        } else {
            return false;
        }
        self.totals.position = self.work_offsets.work_from_machine(machine);
        true
    }

    fn machine_position(&self) -> MachinePos {
        self.work_offsets.machine_from_work(self.totals.position)
    }

    /// Changes the tool. With compensation, the slides and the stored start position move by the difference.
    fn change_tool(&mut self, station: u8, by: Option<PerAxis<f64>>) {
        self.work_offsets.change_tool(station, by);
        if let (Some(start), Some(by)) = (&mut self.start, by) {
            *start = *start + by;
        }
    }
}

fn distance(from: WorkPos, to: WorkPos) -> f64 {
    let square = |axis: Axis| (to[axis] - from[axis]) * (to[axis] - from[axis]);
    (square(Axis::X) + square(Axis::Y) + square(Axis::Z)).sqrt()
}

impl ExternalState for OfflineMachine {
    fn position(&self) -> WorkPos {
        self.totals.position
    }

    fn system_variable(&mut self, number: u32) -> LiveValue {
        // The machine changes it behind the program.
        self.guesses |= number == system_variable::CONTACT_SEEN.first;
        if let Ok(index) = self.system_variables.binary_search_by_key(&number, |(known, _)| *known) {
            return LiveValue::Value(self.system_variables[index].1);
        }
        let axis = |index: u32| Axis::ALL.into_iter().filter(|axis| self.axes[*axis]).nth(index as usize);
        let shown =
            |axis: Axis, mm: f64| LiveValue::Value(Some(if self.diameter && axis == Axis::X { mm * 2.0 } else { mm }));
        // A missing axis reads as null.
        let none = LiveValue::Value(None);
        if let Some(value) = self.work_offsets.cutter_variable(number) {
            return LiveValue::Value(Some(value));
        }
        if let Some(place) = ToolOffsetPlace::of_variable(number) {
            // The operator has set offsets that a check does not know.
            self.guesses = true;
            return shown(place.axis, self.work_offsets.tool_offset_value(place));
        }
        if let Some((place, index)) = OriginPlace::of_variable(number) {
            let origin = self.work_offsets.origin(place);
            return axis(index as u32).map_or(none, |axis| shown(axis, origin[axis]));
        }
        self.guesses |= !matches!(number, 5001..=5003) && number != system_variable::X_SCALE.first;
        match number {
            // No dressing point is set.
            _ if system_variable::DRESSING_POINT.index(number).is_some() => none,
            // No contact monitor is fitted.
            _ if number == system_variable::CONTACT_SEEN.first => none,
            _ if number == system_variable::X_SCALE.first => {
                LiveValue::Value(Some(if self.diameter { 2.0 } else { 1.0 }))
            }
            // Values that only the machine knows.
            434..=439 | 5061..=5063 if self.known_values_only => LiveValue::Drain,
            5001..=5003 | 5041..=5043 | 5061..=5063 => {
                axis(number % 20 - 1).map_or(none, |axis| shown(axis, self.totals.position[axis]))
            }
            5021..=5023 => axis(number - 5021).map_or(none, |axis| {
                shown(axis, self.totals.position[axis] + self.work_offsets.machine_minus_work(axis))
            }),
            438 | 439 => {
                self.oscillation_end = self.oscillation_end.map(|end| !end);
                LiveValue::Value(Some(f64::from(u8::from(self.oscillation_end == Some(true)))))
            }
            // Values that only the machine knows read as 0. Write-only variables have no value.
            _ => match system_variable::find(number).map(|range| range.access) {
                Some(VariableAccess::Read | VariableAccess::ReadWrite) if self.known_values_only => LiveValue::Drain,
                Some(VariableAccess::Read | VariableAccess::ReadWrite) => LiveValue::Value(Some(0.0)),
                Some(VariableAccess::Write) | None => LiveValue::Unknown,
            },
        }
    }

    fn tool_compensation(&self, tool: u32) -> PerAxis<f64> {
        self.work_offsets.tool_compensation(tool)
    }

    fn active_tool(&self) -> u32 {
        self.work_offsets.tool
    }

    fn cutter(&self, offset: usize) -> CutterShape {
        self.work_offsets.cutter_of(offset)
    }

    fn program_start(&self) -> WorkPos {
        self.start.map_or(self.totals.position, |start| self.work_offsets.work_from_machine(start))
    }

    fn block_skip(&self) -> bool {
        self.block_skip
    }
}
