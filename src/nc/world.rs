//! State outside the program text: positions and live values; and its version without a machine. Source: spec B3, T4.

use std::collections::BTreeMap;

use super::frames::Frames;
use super::op::{Feed, Op, Plane, REFERENCES};
use super::settings::Settings;
use crate::defs::variable::{self, Access};
use crate::units::{Axis, PerAxis};

/// Position, path length, time and extents so far.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Come {
    position: PerAxis<f64>,
    length_mm: f64,
    seconds: f64,
    extents: Option<(PerAxis<f64>, PerAxis<f64>)>,
}

/// The result of reading a live value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Live {
    /// The value; `None` for null.
    Value(Option<f64>),
    /// All motion must be done first; the same block is read again then.
    Drain,
    /// The variable does not exist.
    Unknown,
}

/// State outside the program text.
pub trait World {
    /// The position at the end of all operations returned so far, active work coordinates, radius mm.
    fn position(&self) -> PerAxis<f64>;
    /// Reads a system variable: #434–#439, #1000 and up except #4001–#4130. X positions are diameters if X words are.
    /// `#1000` + port − 1 is input `port`: 1 while it is active (low).
    fn system(&mut self, number: u32) -> Live;
    /// Tool compensation of tool 1 to 4, slide travel, radius mm (L8).
    fn compensation(&self, _tool: u32) -> PerAxis<f64> {
        PerAxis::default()
    }
    /// The active tool, 0 for none.
    fn tool(&self) -> u32 {
        0
    }
    /// The tool-change point: the position at program start, active work coordinates, radius mm. It is a fixed machine
    /// position of the tip: G92 and homing do not move it (L3).
    fn start(&self) -> PerAxis<f64> {
        self.position()
    }
    /// The 跳段 (block skip) switch: blocks with `/` are skipped.
    fn block_skip(&self) -> bool;
}

/// State without a machine: every operation is done at once.
#[derive(Clone, Debug)]
pub struct CheckWorld {
    axes: PerAxis<bool>,
    diameter: bool,
    rapid_mm_min: PerAxis<f64>,
    position: PerAxis<f64>,
    /// The tip before the first operation, machine coordinates (L3).
    start: Option<PerAxis<f64>>,
    frames: Frames,
    references: [PerAxis<f64>; REFERENCES],
    system: BTreeMap<u32, Option<f64>>,
    /// Values that only the machine knows are not 0: reading one returns `Live::Drain`.
    only_known: bool,
    skip: bool,
    rpm: f64,
    /// While an axis oscillates, #438 and #439 toggle on every read, so that a wait for a reversal point ends.
    stroke_end: Option<bool>,
    length_mm: f64,
    seconds: f64,
    extents: Option<(PerAxis<f64>, PerAxis<f64>)>,
}

/// Speed for a feed per revolution as long as no S is programmed, rpm.
const USUAL_RPM: f64 = 1_000.0;

impl CheckWorld {
    /// All axes at zero, all inputs inactive.
    #[must_use]
    pub fn new(settings: &Settings) -> Self {
        Self {
            axes: settings.axes,
            diameter: settings.diameter,
            rapid_mm_min: settings.rapid_mm_min,
            position: PerAxis::default(),
            start: None,
            // L8: a turret that was never indexed has station 1 active.
            frames: Frames { tool: u32::from(settings.zero_at_start), ..Frames::default() },
            references: [PerAxis::default(); REFERENCES],
            system: BTreeMap::new(),
            only_known: false,
            skip: false,
            rpm: if settings.zero_at_start { settings.turning.spindle_rpm } else { USUAL_RPM },
            stroke_end: None,
            length_mm: 0.0,
            seconds: 0.0,
            extents: None,
        }
    }

    /// Starts at another position: work coordinates, radius mm.
    #[must_use]
    pub fn at(mut self, position: PerAxis<f64>) -> Self {
        self.position = position;
        self
    }

    /// Sets work offsets and tool offsets; the work position does not change.
    #[must_use]
    pub fn with_frames(mut self, frames: Frames) -> Self {
        let tool = if frames.tool == 0 { self.frames.tool } else { frames.tool };
        self.frames = Frames { tool, ..frames };
        self
    }

    /// Sets the reference points of G28 and G30, machine coordinates, radius mm. Homing ends at the first.
    #[must_use]
    pub const fn with_references(mut self, references: [PerAxis<f64>; REFERENCES]) -> Self {
        self.references = references;
        self
    }

    /// Makes values that were not set unreadable, instead of 0.
    #[must_use]
    pub const fn with_known_only(mut self) -> Self {
        self.only_known = true;
        self
    }

    /// Sets the 跳段 (block skip) switch.
    #[must_use]
    pub fn with_block_skip(mut self, skip: bool) -> Self {
        self.skip = skip;
        self
    }

    /// Sets a system variable.
    pub fn set_system(&mut self, number: u32, value: Option<f64>) {
        self.system.insert(number, value);
    }

    /// The active work offsets and tool offsets.
    #[must_use]
    pub const fn frames(&self) -> &Frames {
        &self.frames
    }

    /// The work position, radius mm.
    #[must_use]
    pub const fn place(&self) -> PerAxis<f64> {
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
    pub(crate) const fn come(&self) -> Come {
        let Self { position, length_mm, seconds, extents, .. } = *self;
        Come { position, length_mm, seconds, extents }
    }

    /// Restores earlier totals.
    pub(crate) const fn go_back(&mut self, to: Come) {
        let Come { position, length_mm, seconds, extents } = to;
        (self.position, self.length_mm, self.seconds, self.extents) = (position, length_mm, seconds, extents);
    }

    /// Clears the extents.
    pub const fn forget_extents(&mut self) {
        self.extents = None;
    }

    /// Executes one operation.
    pub fn apply(&mut self, op: &Op) {
        let machine = self.frames.machine_from_work(self.position);
        self.start.get_or_insert(machine);
        match op {
            Op::Rapid { to, feed: None, .. } => self.rapid(*to),
            Op::Rapid { to, feed: Some(feed), .. } | Op::Feed { to, feed, .. } | Op::Skip { to, feed, .. } => {
                let length = distance(self.position, *to);
                self.cut(*to, length, *feed);
            }
            Op::Arc { to, center, plane, turn, feed, .. } => self.arc(*to, *center, *plane, *turn, *feed),
            Op::Dwell { s } => self.seconds += s,
            Op::Preset { values } => {
                let machine = self.frames.machine_from_work(self.position);
                self.reframe(|frames| frames.preset(machine, values));
            }
            Op::Frame { g } => self.reframe(|frames| frames.activate(*g)),
            Op::AddWear { number, by } => self.reframe(|frames| frames.add_wear(*number, *by)),
            Op::Gauge(gauging) => {
                // Without a part the axis moves to the limit and retracts.
                let (mut to, from) = (self.position, self.position[gauging.axis]);
                to[gauging.axis] = gauging.to;
                self.cut(to, distance(self.position, to), Feed::PerMinute(gauging.fast_mm_min));
                to[gauging.axis] += gauging.retract_mm.copysign(from - gauging.to);
                self.cut(to, gauging.retract_mm, Feed::PerMinute(gauging.fast_mm_min));
            }
            Op::T { tool, offset } => self.reframe(|frames| frames.call_tool(*tool, *offset)),
            Op::MachineMove { to, feed } => {
                let to = PerAxis::from_fn(|axis| {
                    to[axis].map_or(self.position[axis], |to| to - self.frames.machine_minus_work(axis))
                });
                match feed {
                    Some(feed) => self.cut(to, distance(self.position, to), *feed),
                    None => self.rapid(to),
                }
            }
            Op::Reference { number, via, words, .. } => {
                self.rapid(*via);
                let at = self.references[usize::from(*number).clamp(1, REFERENCES) - 1];
                let home = self.frames.work_from_machine(at);
                let home = |axis| if words.contains(axis) { home[axis] } else { via[axis] };
                self.rapid(PerAxis::from_fn(home));
            }
            Op::S { value, mode: super::op::SpeedMode::Rpm } if *value > 0.0 => self.rpm = *value,
            Op::SetSystem { number, value } => self.set_system(*number, *value),
            Op::Thread(threading) => {
                // The run-out takes the time of the thread's last millimetres: X retracts meanwhile.
                let minutes = (threading.to[Axis::Z] - self.position[Axis::Z]).abs() / threading.lead_mm / self.rpm;
                self.seconds += 60.0 * minutes;
                self.length_mm += distance(self.position, threading.out) + distance(threading.out, threading.to);
                self.reach(threading.out);
                self.reach(threading.to);
            }
            Op::HomeSwitch { axes } => {
                let home = self.frames.work_from_machine(self.references[0]);
                let (axes, from) = (*axes, self.position);
                self.rapid(PerAxis::from_fn(|axis| if axes.contains(axis) { home[axis] } else { from[axis] }));
            }
            Op::Post { station, by } => self.change_tool(*station, *by),
            Op::S { .. } | Op::Path(_) | Op::SpeedLimit { .. } | Op::M { .. } => {}
            // Only the machine knows the dressing point.
            Op::DressReturn { .. } => {}
            // An oscillating axis returns to its start.
            Op::OscillationOn { .. } => self.stroke_end = Some(false),
            Op::OscillationOff => self.stroke_end = None,
            Op::Set { .. } | Op::Alarm { .. } | Op::Message { .. } | Op::Note { .. } => {}
        }
    }

    /// Changes the tool. With compensation, the slides and the stored start position move by the difference.
    fn change_tool(&mut self, station: u8, by: Option<PerAxis<f64>>) {
        self.frames.change_tool(station, by);
        if let (Some(start), Some(by)) = (&mut self.start, by) {
            *start = PerAxis::from_fn(|axis| start[axis] + by[axis]);
        }
    }

    /// Changes work offset or tool offset: the machine position stays, the work position changes.
    fn reframe(&mut self, change: impl FnOnce(&mut Frames)) {
        let machine = self.frames.machine_from_work(self.position);
        change(&mut self.frames);
        self.position = self.frames.work_from_machine(machine);
    }

    fn rapid(&mut self, to: PerAxis<f64>) {
        let minutes = |axis: Axis| (to[axis] - self.position[axis]).abs() / self.rapid_mm_min[axis].max(1.0);
        self.seconds += 60.0 * Axis::ALL.into_iter().map(minutes).fold(0.0, f64::max);
        self.length_mm += distance(self.position, to);
        self.reach(to);
    }

    fn cut(&mut self, to: PerAxis<f64>, length: f64, feed: Feed) {
        let mm_min = match feed {
            Feed::PerMinute(feed) => feed,
            Feed::PerRev(feed) => feed * self.rpm,
        };
        self.seconds += 60.0 * length / mm_min;
        self.length_mm += length;
        self.reach(to);
    }

    fn arc(&mut self, to: PerAxis<f64>, center: PerAxis<f64>, plane: Plane, turn: i8, feed: Feed) {
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
                self.stretch(point);
            }
        }
        self.cut(to, radius * swept, feed);
    }

    fn reach(&mut self, to: PerAxis<f64>) {
        self.stretch(self.position);
        self.stretch(to);
        self.position = to;
    }

    fn stretch(&mut self, point: PerAxis<f64>) {
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

impl World for CheckWorld {
    fn position(&self) -> PerAxis<f64> {
        self.position
    }

    fn system(&mut self, number: u32) -> Live {
        if let Some(value) = self.system.get(&number) {
            return Live::Value(*value);
        }
        let axis = |index: u32| Axis::ALL.into_iter().filter(|axis| self.axes[*axis]).nth(index as usize);
        let shown =
            |axis: Axis, mm: f64| Live::Value(Some(if self.diameter && axis == Axis::X { mm * 2.0 } else { mm }));
        // A missing axis reads as null.
        let none = Live::Value(None);
        match number {
            // Values that only the machine knows.
            434..=439 | 5061..=5063 if self.only_known => Live::Drain,
            5001..=5003 | 5041..=5043 | 5061..=5063 => {
                axis(number % 20 - 1).map_or(none, |axis| shown(axis, self.position[axis]))
            }
            5021..=5023 => axis(number - 5021)
                .map_or(none, |axis| shown(axis, self.position[axis] + self.frames.machine_minus_work(axis))),
            438 | 439 => {
                self.stroke_end = self.stroke_end.map(|end| !end);
                Live::Value(Some(f64::from(u8::from(self.stroke_end == Some(true)))))
            }
            // Values that only the machine knows read as 0. Write-only variables have no value.
            _ => match variable::find(number).map(|range| range.access) {
                Some(Access::Read | Access::ReadWrite) if self.only_known => Live::Drain,
                Some(Access::Read | Access::ReadWrite) => Live::Value(Some(0.0)),
                Some(Access::Write) | None => Live::Unknown,
            },
        }
    }

    fn compensation(&self, tool: u32) -> PerAxis<f64> {
        self.frames.compensation(tool)
    }

    fn tool(&self) -> u32 {
        self.frames.tool
    }

    fn start(&self) -> PerAxis<f64> {
        self.start.map_or(self.position, |start| self.frames.work_from_machine(start))
    }

    fn block_skip(&self) -> bool {
        self.skip
    }
}
