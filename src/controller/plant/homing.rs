//! Homing of an axis and the limits of manual motion, as manual and programmed homing share them.
//! Source: spec B5, K5.9, K5.16, L6.

use super::{ControlPhase, MM_S_PER_MM_MIN, Plant};
use crate::controller::axes::homing::{AxisHoming, HomingFailure, HomingPlan, HomingProgress};
use crate::controller::axes::soft_limits;
use crate::defs::alarm;
use crate::defs::param::{self, BitParam};
use crate::defs::signal::{Input, Output};
use crate::defs::text::phrase;
use crate::units::{Axis, PerAxis};

impl Plant {
    pub fn home_direction(&self, axis: Axis) -> f64 {
        let minus: BitParam = [param::HOME_MINUS_X, param::HOME_MINUS_Y, param::HOME_MINUS_Z][axis as usize];
        if self.params.bit(minus) { -1.0 } else { 1.0 }
    }

    /// Direction in which HOME moves an axis: to its switch, or with an absolute encoder to its zero point.
    pub fn homing_direction(&self, axis: Axis) -> f64 {
        if self.inputs.image.absolute[axis] { self.way_to_zero_mm(axis).signum() } else { self.home_direction(axis) }
    }

    fn way_to_zero_mm(&self, axis: Axis) -> f64 {
        self.params.get_axis(param::HOME_X, axis) - self.axes.set_point()[axis]
    }

    /// Whether HOME of another axis moves this one to its zero point first (K5.16): it is not homed, or its absolute encoder
    /// says that it stands elsewhere.
    pub fn is_to_withdraw(&self, axis: Axis) -> bool {
        let stands_elsewhere = self.way_to_zero_mm(axis).abs() > self.params.get(param::IN_POSITION);
        !self.axes.is_homed(axis) || self.inputs.image.absolute[axis] && stands_elsewhere
    }

    /// Speeds and maximum travel of an axis to its home switch or its zero point.
    pub fn plan_homing(&self, axis: Axis) -> AxisHoming {
        let direction = self.homing_direction(axis);
        // K5.9: with the wheel turning, its minus direction is slow.
        let slow = axis == self.kind.row().wheel_axis && direction < 0.0 && self.outputs.on.has(Output::Wheel);
        let most = if slow { self.params.get(param::WHEEL_ON_INFEED_SPEED) } else { f64::INFINITY };
        let plan = HomingPlan {
            direction,
            fast_mm_s: self.params.get(param::HOME_FAST).min(most) * MM_S_PER_MM_MIN,
            slow_mm_s: self.params.get(param::HOME_SLOW) * MM_S_PER_MM_MIN,
            travel_mm: self.params.get(param::HOMING_TRAVEL),
            coordinate: self.params.get_axis(param::HOME_X, axis),
            over_switch: self.kind.row().homes_over_switch(),
            width_mm: self.params.get(param::IN_POSITION),
            is_absolute: self.inputs.image.absolute[axis],
        };
        AxisHoming::new(axis, plan)
    }

    /// One tick of homing an axis.
    pub fn tick_homing(&mut self, homing: &mut AxisHoming) -> HomingProgress {
        const SWITCHES: [Input; 3] = [Input::HomeX, Input::HomeY, Input::HomeZ];
        let (axis, switch) = (homing.axis, SWITCHES[homing.axis as usize]);
        let at = self.axes.actual()[axis];
        homing.tick(&mut self.axes.movers[axis], self.inputs.filtered.has(switch), self.inputs.raw.has(switch), at)
    }

    /// Sets the zero of an axis: its switch was at `edge` in present machine coordinates and is from now on at the
    /// coordinate of the parameter.
    pub fn apply_zero(&mut self, axis: Axis, edge: f64) {
        self.shift_zero(axis, edge, self.params.get_axis(param::HOME_X, axis));
    }

    /// Axes with absolute encoders need no homing: they are homed as soon as their position is read. Beyond their soft limits,
    /// after a limit switch or a fault of the encoder they wait for HOME.
    pub fn adopt_absolute_positions(&mut self) {
        if !self.inputs.image.bus_alive || !matches!(self.execution.phase, ControlPhase::Idle) {
            return;
        }
        for axis in Axis::ALL {
            let is_told = self.inputs.image.absolute[axis] && self.inputs.image.drives[axis].fault().is_none();
            if !is_told || !self.axes.awaits_absolute_position(axis) {
                continue;
            }
            // The set-point may be that of the tick before; it keeps its place, too.
            let set = self.axes.absolute_position(axis, self.axes.encoder_set_points()[axis]);
            self.shift_zero(axis, self.axes.set_point()[axis], set);
            let at = self.axes.absolute_position(axis, self.inputs.image.encoder_mm[axis]);
            let (low, high) = soft_limits(&self.params, axis);
            // A machine that was left within its limits does not stand beyond them.
            if (low..=high).contains(&at) {
                self.axes.finish_homing(axis, &self.params);
            } else {
                self.axes.doubt(axis);
            }
        }
    }

    /// What is `edge` in present machine coordinates is `coordinate` from now on. The tool-change point keeps its physical
    /// position (L3).
    fn shift_zero(&mut self, axis: Axis, edge: f64, coordinate: f64) {
        self.axes.set_zero(axis, edge, coordinate);
        let mut by = PerAxis::default();
        by[axis] = coordinate - edge;
        self.work.move_starts(by);
    }

    /// Raises the alarm of a failed homing.
    pub fn raise_homing_failed(&mut self, axis: Axis, why: HomingFailure) {
        let n = param::HOME_X.number + axis as u16;
        let message = match why {
            HomingFailure::NoSwitch => phrase!("{axis}", "{axis}", axis),
            HomingFailure::TooFar => phrase!(
                "{axis} 离零点超过 P{n}：位置可疑",
                "{axis} is further than P{n} from its zero point: its position is doubtful",
                axis,
                n = param::HOMING_TRAVEL.number
            ),
            HomingFailure::NotAtZero => phrase!(
                "{axis} 到不了零点坐标 P{n}={zero:.3}",
                "{axis} cannot reach its home coordinate P{n}={zero:.3}",
                axis,
                n,
                zero = self.params.get_axis(param::HOME_X, axis)
            ),
        };
        self.raise(alarm::HOMING_FAILED, Some(message));
    }

    /// Whether a homed axis is at the soft limit in this direction.
    pub fn is_at_soft_limit(&self, axis: Axis, direction: f64) -> bool {
        let (low, high) = soft_limits(&self.params, axis);
        let at = self.axes.set_point()[axis];
        let width = self.params.get(param::IN_POSITION);
        self.axes.is_homed(axis) && if direction > 0.0 { at >= high - width } else { at <= low + width }
    }

    /// Whether an axis is on the limit switch of this direction.
    pub fn is_on_limit_switch(&self, axis: Axis, direction: f64) -> bool {
        let side = if direction > 0.0 { 0 } else { 1 };
        self.inputs.limit_switches >> (2 * axis as u8 + side) & 1 == 1
    }
}
