//! State outside the program text: positions and live values; and its version without a machine. Source: spec B3, T4.

use std::collections::BTreeMap;

use super::op::{ArcPlane, Feed, Op, REFERENCE_POINTS};
use super::settings::NcSettings;
use super::work_offsets::WorkOffsets;
use crate::defs::system_variable::{self, VariableAccess};
use crate::units::{Axis, PerAxis};

/// Position, path length, time and extents so far.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RunTotals {
    position: PerAxis<f64>,
    length_mm: f64,
    seconds: f64,
    extents: Option<(PerAxis<f64>, PerAxis<f64>)>,
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
    fn position(&self) -> PerAxis<f64>;
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
    /// The tool-change point: the position at program start, active work coordinates, radius mm. It is a fixed machine
    /// position of the tip: G92 and homing do not move it (L3).
    fn program_start(&self) -> PerAxis<f64> {
        self.position()
    }
    /// The 跳段 (block skip) switch: blocks with `/` are skipped.
    fn block_skip(&self) -> bool;
}

/// State without a machine: every operation is done at once.
#[derive(Clone, Debug)]
pub struct OfflineMachine {
    axes: PerAxis<bool>,
    diameter: bool,
    rapid_mm_min: PerAxis<f64>,
    position: PerAxis<f64>,
    /// The tip before the first operation, machine coordinates (L3).
    start: Option<PerAxis<f64>>,
    work_offsets: WorkOffsets,
    references: [PerAxis<f64>; REFERENCE_POINTS],
    system_variables: BTreeMap<u32, Option<f64>>,
    /// Values that only the machine knows are not 0: reading one returns `LiveValue::Drain`.
    known_values_only: bool,
    block_skip: bool,
    rpm: f64,
    /// While an axis oscillates, #438 and #439 toggle on every read, so that a wait for a reversal point ends.
    oscillation_end: Option<bool>,
    length_mm: f64,
    seconds: f64,
    extents: Option<(PerAxis<f64>, PerAxis<f64>)>,
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
            position: PerAxis::default(),
            start: None,
            // L8: a turret that was never indexed has station 1 active.
            work_offsets: WorkOffsets { tool: u32::from(settings.start_is_work_zero), ..WorkOffsets::default() },
            references: [PerAxis::default(); REFERENCE_POINTS],
            system_variables: BTreeMap::new(),
            known_values_only: false,
            block_skip: false,
            rpm: if settings.start_is_work_zero { settings.superman.spindle_rpm } else { DEFAULT_RPM },
            oscillation_end: None,
            length_mm: 0.0,
            seconds: 0.0,
            extents: None,
        }
    }

    /// Starts at another position: work coordinates, radius mm.
    #[must_use]
    pub fn with_position(mut self, position: PerAxis<f64>) -> Self {
        self.position = position;
        self
    }

    /// Sets work offsets and tool offsets; the work position does not change.
    #[must_use]
    pub fn with_work_offsets(mut self, frames: WorkOffsets) -> Self {
        let tool = if frames.tool == 0 { self.work_offsets.tool } else { frames.tool };
        self.work_offsets = WorkOffsets { tool, ..frames };
        self
    }

    /// Sets the reference points of G28 and G30, machine coordinates, radius mm. Homing ends at the first.
    #[must_use]
    pub const fn with_references(mut self, references: [PerAxis<f64>; REFERENCE_POINTS]) -> Self {
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
        self.system_variables.insert(number, value);
    }

    /// The active work offsets and tool offsets.
    #[must_use]
    pub const fn work_offsets(&self) -> &WorkOffsets {
        &self.work_offsets
    }

    /// The work position, radius mm.
    #[must_use]
    pub const fn work_position(&self) -> PerAxis<f64> {
        self.position
    }

    /// The path length so far, mm.
    #[must_use]
    pub const fn length_mm(&self) -> f64 {
        self.length_mm
    }

    /// The time so far without acceleration, seconds.
    #[must_use]
    pub const fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Least and greatest work coordinates of all moves, radius mm.
    #[must_use]
    pub const fn extents(&self) -> Option<(PerAxis<f64>, PerAxis<f64>)> {
        self.extents
    }

    /// The totals so far.
    pub(crate) const fn totals(&self) -> RunTotals {
        let Self { position, length_mm, seconds, extents, .. } = *self;
        RunTotals { position, length_mm, seconds, extents }
    }

    /// Restores earlier totals.
    pub(crate) const fn restore_totals(&mut self, to: RunTotals) {
        let RunTotals { position, length_mm, seconds, extents } = to;
        (self.position, self.length_mm, self.seconds, self.extents) = (position, length_mm, seconds, extents);
    }

    /// Clears the extents.
    pub const fn reset_extents(&mut self) {
        self.extents = None;
    }

    /// Executes one operation.
    pub fn apply(&mut self, op: &Op) {
        let machine = self.work_offsets.machine_from_work(self.position);
        self.start.get_or_insert(machine);
        match op {
            Op::Rapid { to, feed: None, .. } => self.rapid_move(*to),
            Op::Rapid { to, feed: Some(feed), .. } | Op::Feed { to, feed, .. } | Op::Skip { to, feed, .. } => {
                let length = distance(self.position, *to);
                self.feed_move(*to, length, *feed);
            }
            Op::Arc { to, center, plane, turn, feed, .. } => self.arc_move(*to, *center, *plane, *turn, *feed),
            Op::Dwell { s } => self.seconds += s,
            Op::SetCoordinateSystem { values } => {
                let machine = self.work_offsets.machine_from_work(self.position);
                self.change_offsets(|frames| frames.set_coordinates(machine, values));
            }
            Op::SelectWorkOffset { g } => self.change_offsets(|frames| frames.activate(*g)),
            Op::AddWear { number, by } => self.change_offsets(|frames| frames.add_wear(*number, *by)),
            Op::Gauge(gauging) => {
                // Without a part the axis moves to the limit and retracts.
                let (mut to, from) = (self.position, self.position[gauging.axis]);
                to[gauging.axis] = gauging.to;
                self.feed_move(to, distance(self.position, to), Feed::PerMinute(gauging.fast_mm_min));
                to[gauging.axis] += gauging.retract_mm.copysign(from - gauging.to);
                self.feed_move(to, gauging.retract_mm, Feed::PerMinute(gauging.fast_mm_min));
            }
            Op::T { tool, offset } => self.change_offsets(|frames| frames.call_tool(*tool, *offset)),
            Op::MachineMove { to, feed } => {
                let to = PerAxis::from_fn(|axis| {
                    to[axis].map_or(self.position[axis], |to| to - self.work_offsets.machine_minus_work(axis))
                });
                match feed {
                    Some(feed) => self.feed_move(to, distance(self.position, to), *feed),
                    None => self.rapid_move(to),
                }
            }
            Op::ReturnToReference { number, via, words, .. } => {
                self.rapid_move(*via);
                let at = self.references[usize::from(*number).clamp(1, REFERENCE_POINTS) - 1];
                let home = self.work_offsets.work_from_machine(at);
                let home = |axis| if words.contains(axis) { home[axis] } else { via[axis] };
                self.rapid_move(PerAxis::from_fn(home));
            }
            Op::S { value, mode: super::op::SpeedMode::Rpm } if *value > 0.0 => self.rpm = *value,
            Op::SetSystemVariable { number, value } => self.set_system(*number, *value),
            Op::Thread(threading) => {
                // The run-out takes the time of the thread's last millimetres: X retracts meanwhile.
                let minutes = (threading.to[Axis::Z] - self.position[Axis::Z]).abs() / threading.lead_mm / self.rpm;
                self.seconds += 60.0 * minutes;
                self.length_mm +=
                    distance(self.position, threading.run_out_start) + distance(threading.run_out_start, threading.to);
                self.move_to(threading.run_out_start);
                self.move_to(threading.to);
            }
            Op::HomeSwitch { axes } => {
                let home = self.work_offsets.work_from_machine(self.references[0]);
                let (axes, from) = (*axes, self.position);
                self.rapid_move(PerAxis::from_fn(|axis| if axes.contains(axis) { home[axis] } else { from[axis] }));
            }
            Op::IndexTurret { station, by } => self.change_tool(*station, *by),
            Op::S { .. } | Op::SetPathMode(_) | Op::SpeedLimit { .. } | Op::M { .. } => {}
            // Only the machine knows the dressing point.
            Op::DressReturn { .. } => {}
            // An oscillating axis returns to its start.
            Op::OscillationOn { .. } => self.oscillation_end = Some(false),
            Op::OscillationOff => self.oscillation_end = None,
            Op::SetVariable { .. } | Op::Alarm { .. } | Op::StopWithMessage { .. } | Op::DisplayMessage { .. } => {}
        }
    }

    /// Changes the tool. With compensation, the slides and the stored start position move by the difference.
    fn change_tool(&mut self, station: u8, by: Option<PerAxis<f64>>) {
        self.work_offsets.change_tool(station, by);
        if let (Some(start), Some(by)) = (&mut self.start, by) {
            *start = PerAxis::from_fn(|axis| start[axis] + by[axis]);
        }
    }

    /// Changes work offset or tool offset: the machine position stays, the work position changes.
    fn change_offsets(&mut self, change: impl FnOnce(&mut WorkOffsets)) {
        let machine = self.work_offsets.machine_from_work(self.position);
        change(&mut self.work_offsets);
        self.position = self.work_offsets.work_from_machine(machine);
    }

    fn rapid_move(&mut self, to: PerAxis<f64>) {
        let minutes = |axis: Axis| (to[axis] - self.position[axis]).abs() / self.rapid_mm_min[axis].max(1.0);
        self.seconds += 60.0 * Axis::ALL.into_iter().map(minutes).fold(0.0, f64::max);
        self.length_mm += distance(self.position, to);
        self.move_to(to);
    }

    fn feed_move(&mut self, to: PerAxis<f64>, length: f64, feed: Feed) {
        let mm_min = match feed {
            Feed::PerMinute(feed) => feed,
            Feed::PerRev(feed) => feed * self.rpm,
        };
        self.seconds += 60.0 * length / mm_min;
        self.length_mm += length;
        self.move_to(to);
    }

    fn arc_move(&mut self, to: PerAxis<f64>, center: PerAxis<f64>, plane: ArcPlane, turn: i8, feed: Feed) {
        let (first, second) = plane.axes();
        let angle = |point: PerAxis<f64>| (point[second] - center[second]).atan2(point[first] - center[first]);
        let radius = (self.position[first] - center[first]).hypot(self.position[second] - center[second]);
        let start = angle(self.position);
        let swept = (f64::from(turn) * (angle(to) - start)).rem_euclid(std::f64::consts::TAU);
        let swept = if swept <= 1e-9 { std::f64::consts::TAU } else { swept };
        for quarter in 0..4 {
            let compass = f64::from(quarter) * std::f64::consts::FRAC_PI_2;
            if (f64::from(turn) * (compass - start)).rem_euclid(std::f64::consts::TAU) < swept {
                let mut point = self.position;
                point[first] = center[first] + radius * compass.cos();
                point[second] = center[second] + radius * compass.sin();
                self.extend_to(point);
            }
        }
        self.feed_move(to, radius * swept, feed);
    }

    fn move_to(&mut self, to: PerAxis<f64>) {
        self.extend_to(self.position);
        self.extend_to(to);
        self.position = to;
    }

    fn extend_to(&mut self, point: PerAxis<f64>) {
        let (low, high) = self.extents.get_or_insert((point, point));
        for (axis, value) in point.iter() {
            low[axis] = low[axis].min(*value);
            high[axis] = high[axis].max(*value);
        }
    }
}

fn distance(from: PerAxis<f64>, to: PerAxis<f64>) -> f64 {
    let square = |axis: Axis| (to[axis] - from[axis]) * (to[axis] - from[axis]);
    (square(Axis::X) + square(Axis::Y) + square(Axis::Z)).sqrt()
}

impl ExternalState for OfflineMachine {
    fn position(&self) -> PerAxis<f64> {
        self.position
    }

    fn system_variable(&mut self, number: u32) -> LiveValue {
        if let Some(value) = self.system_variables.get(&number) {
            return LiveValue::Value(*value);
        }
        let axis = |index: u32| Axis::ALL.into_iter().filter(|axis| self.axes[*axis]).nth(index as usize);
        let shown =
            |axis: Axis, mm: f64| LiveValue::Value(Some(if self.diameter && axis == Axis::X { mm * 2.0 } else { mm }));
        // A missing axis reads as null.
        let none = LiveValue::Value(None);
        match number {
            // Values that only the machine knows.
            434..=439 | 5061..=5063 if self.known_values_only => LiveValue::Drain,
            5001..=5003 | 5041..=5043 | 5061..=5063 => {
                axis(number % 20 - 1).map_or(none, |axis| shown(axis, self.position[axis]))
            }
            5021..=5023 => axis(number - 5021)
                .map_or(none, |axis| shown(axis, self.position[axis] + self.work_offsets.machine_minus_work(axis))),
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

    fn program_start(&self) -> PerAxis<f64> {
        self.start.map_or(self.position, |start| self.work_offsets.work_from_machine(start))
    }

    fn block_skip(&self) -> bool {
        self.block_skip
    }
}
