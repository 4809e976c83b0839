//! Thread cutting: Z synchronised with the spindle, X with it on a taper, and the run-out at the end.
//!
//! Computes the set-points of X and Z from the spindle index to the end of the run-out. Knows nothing of programs and
//! the spindle drive. The target of Z is `from + lead · turns since the index`. From rest it synchronises by
//! a jerk-limited profile *in the moving frame of the spindle*, so that the phase is the same in every pass. It starts
//! half a run-up before the index, so that nothing has to be caught up: it is synchronised after v·T/2, 0.63 mm at
//! 20 mm/s, 800 mm/s², 20 000 mm/s³. The servo lag is compensated in the set-points. A filter removes the quantisation
//! of the encoder. In the run-out Z brakes to its end and X retracts, each axis by itself.
//! Source: spec L5, seed 5.1.6 note 5.

use super::axis_mover::AxisMover;
use super::profile::{AxisLimits, AxisState, MotionProfile};
use super::{MotionLimits, Setpoint};
use crate::units::{Axis, MachinePos, PerAxis};

/// The thread to be cut; machine coordinates, mm (radius).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreadPass {
    /// Start of the run-out.
    pub run_out_start: MachinePos,
    /// End of the run-out.
    pub run_out_end: MachinePos,
    /// Lead along Z, mm.
    pub lead_mm: f64,
}

impl ThreadPass {
    /// Shifts the thread, mm.
    pub fn shift_by(&mut self, by: &PerAxis<f64>) {
        self.run_out_start = self.run_out_start + *by;
        self.run_out_end = self.run_out_end + *by;
    }
}

/// Filter for the encoder: position and speed without lag at constant speed.
#[derive(Clone, Copy, Debug)]
struct SpindleFilter {
    turns: f64,
    turns_per_tick: f64,
}

/// Filter gains on the deviation for position and speed: a time constant of about 20 ticks.
const FILTER_POSITION_GAIN: f64 = 0.1;
const FILTER_SPEED_GAIN: f64 = 0.005;
/// Ticks for which the filter settles before a thread starts: ten time constants.
const MEASURING_TICKS: u32 = 200;
/// Below this speed, turns per second, the spindle counts as stopped.
const STANDSTILL_HZ: f64 = 0.01;

impl SpindleFilter {
    fn step(&mut self, turns: f64) {
        self.turns += self.turns_per_tick;
        let off = turns - self.turns;
        self.turns += FILTER_POSITION_GAIN * off;
        self.turns_per_tick += FILTER_SPEED_GAIN * off;
    }
}

#[derive(Clone, Copy, Debug)]
enum ThreadStage {
    /// Measuring the spindle speed.
    MeasuringSpindle { ticks: u32 },
    /// Waiting until half a run-up before the next index; `sense` is the spindle direction, +1 forward.
    WaitingForIndex { index: f64, sense: f64 },
    /// Synchronising, then synchronised.
    Following { index: f64, sense: f64, profile: MotionProfile, ticks: u32 },
    /// Run-out: Z moves to its end, X retracts.
    RunningOut,
    /// Aborted: braking.
    Braking,
}

/// Cuts one thread.
#[derive(Clone, Debug)]
pub struct ThreadMover {
    thread: ThreadPass,
    from: MachinePos,
    limits: MotionLimits,
    /// Servo lag of the drives at constant speed, s.
    lag_s: f64,
    spindle: SpindleFilter,
    stage: ThreadStage,
    setpoint: Setpoint,
    x: AxisMover,
    z: AxisMover,
}

impl ThreadMover {
    /// A thread from the axis position `from`, mm, with the spindle at `turns`; `lag_s` is the servo lag, s.
    #[must_use]
    pub fn new(thread: ThreadPass, from: MachinePos, limits: MotionLimits, turns: f64, lag_s: f64) -> Self {
        let mover = |axis: Axis| AxisMover::new(limits.axes[axis], from[axis], limits.tick_s);
        Self {
            thread,
            from,
            limits,
            lag_s,
            spindle: SpindleFilter { turns, turns_per_tick: 0.0 },
            stage: ThreadStage::MeasuringSpindle { ticks: 0 },
            setpoint: Setpoint { position: from, velocity_mm_s: PerAxis::default() },
            x: mover(Axis::X),
            z: mover(Axis::Z),
        }
    }

    /// Advances by one tick with the spindle at `turns` (positive forward); returns the set-points of X and Z.
    pub fn tick(&mut self, turns: f64) -> Setpoint {
        self.spindle.step(turns);
        match self.stage {
            ThreadStage::MeasuringSpindle { ticks } if ticks < MEASURING_TICKS => {
                self.stage = ThreadStage::MeasuringSpindle { ticks: ticks + 1 }
            }
            ThreadStage::MeasuringSpindle { .. } if !self.is_turning() => {}
            ThreadStage::MeasuringSpindle { .. } => {
                let sense = self.spindle.turns_per_tick.signum();
                let index = (sense * self.spindle.turns + self.start_lead_turns()).ceil();
                self.stage = ThreadStage::WaitingForIndex { index, sense };
            }
            ThreadStage::WaitingForIndex { index, sense }
                if sense * self.spindle.turns + self.start_lead_turns() < index => {}
            ThreadStage::WaitingForIndex { index, sense } => {
                let begun = self.synchronized_z_mm(index, sense) - self.from[Axis::Z];
                let start = AxisState { position: -begun, velocity: -self.speed_mm_s(), acceleration: 0.0 };
                // At most the synchronous speed: Z may wait for a fraction of a tick but never moves back.
                let limits = AxisLimits { velocity_mm_s: self.speed_mm_s().abs(), ..self.limits.axes[Axis::Z] };
                let profile = MotionProfile::to_position(start, 0.0, limits);
                self.stage = ThreadStage::Following { index, sense, profile, ticks: 0 };
            }
            ThreadStage::Following { index, sense, profile, ticks } => self.follow((index, sense), profile, ticks + 1),
            ThreadStage::RunningOut | ThreadStage::Braking => self.tick_movers(),
        }
        self.setpoint
    }

    /// Turns before the index at which Z starts: half of its run-up plus one tick.
    fn start_lead_turns(&self) -> f64 {
        let seconds = self.limits.axes[Axis::Z].ramp_s(self.speed_mm_s().abs()) / 2.0 + self.limits.tick_s;
        self.spindle.turns_per_tick.abs() / self.limits.tick_s * seconds
    }

    /// Whether the spindle turns.
    #[must_use]
    pub fn is_turning(&self) -> bool {
        self.spindle.turns_per_tick.abs() / self.limits.tick_s > STANDSTILL_HZ
    }

    /// Whether Z is synchronised with the spindle.
    #[must_use]
    pub fn is_synchronized(&self) -> bool {
        let seconds = |ticks: u32| f64::from(ticks) * self.limits.tick_s;
        matches!(&self.stage, ThreadStage::Following { profile, ticks, .. } if seconds(*ticks) >= profile.seconds())
    }

    /// Nominal position of Z with the spindle at `turns`, mm; `None` before the index and in the run-out.
    #[must_use]
    pub fn nominal_z_mm(&self, turns: f64) -> Option<f64> {
        let ThreadStage::Following { index, sense, .. } = self.stage else { return None };
        Some(self.from[Axis::Z] + self.z_direction() * self.thread.lead_mm * (sense * turns - index).max(0.0))
    }

    /// Whether the thread with its run-out, or braking after an abort, is finished.
    #[must_use]
    pub fn is_finished(&self) -> bool {
        matches!(self.stage, ThreadStage::RunningOut | ThreadStage::Braking)
            && self.x.is_at_rest()
            && self.z.is_at_rest()
    }

    /// Brakes both axes at full deceleration.
    pub fn abort(&mut self) {
        self.hand_over_to_movers();
        self.x.emergency_stop();
        self.z.emergency_stop();
        self.stage = ThreadStage::Braking;
    }

    /// Direction of Z: +1 or −1.
    fn z_direction(&self) -> f64 {
        (self.thread.run_out_end[Axis::Z] - self.from[Axis::Z]).signum()
    }

    /// Synchronous speed of Z with its sign, mm/s.
    fn speed_mm_s(&self) -> f64 {
        self.z_direction() * self.thread.lead_mm * self.spindle.turns_per_tick.abs() / self.limits.tick_s
    }

    /// Synchronous position of Z for the filtered spindle position, mm.
    fn synchronized_z_mm(&self, index: f64, sense: f64) -> f64 {
        self.from[Axis::Z] + self.z_direction() * self.thread.lead_mm * (sense * self.spindle.turns - index)
    }

    fn follow(&mut self, (index, sense): (f64, f64), profile: MotionProfile, ticks: u32) {
        self.stage = ThreadStage::Following { index, sense, profile, ticks };
        let off = profile.at(f64::from(ticks) * self.limits.tick_s);
        let before = self.setpoint.position;
        // A second-order position loop with input z + T·v + T²/4·a outputs z: u = x + 2/ω·x' + 1/ω²·x'', T = 2/ω.
        let early = self.lag_s * (self.speed_mm_s() + off.velocity) + self.lag_s.powi(2) / 4.0 * off.acceleration;
        let z = self.synchronized_z_mm(index, sense) + off.position + early;
        let whole = self.thread.run_out_start[Axis::Z] - self.from[Axis::Z];
        let share = ((z - self.from[Axis::Z]) / whole).clamp(0.0, 1.0);
        let x = self.from[Axis::X] + share * (self.thread.run_out_start[Axis::X] - self.from[Axis::X]);
        self.setpoint.position[Axis::X] = x;
        self.setpoint.position[Axis::Z] = z;
        let velocity = |axis: Axis| (self.setpoint.position[axis] - before[axis]) / self.limits.tick_s;
        self.setpoint.velocity_mm_s = PerAxis::from_fn(velocity);
        if (z - self.thread.run_out_start[Axis::Z]) * self.z_direction() >= 0.0 {
            self.hand_over_to_movers();
            let (end, top) = (self.thread.run_out_end, self.limits.axes.map(|axis| axis.velocity_mm_s));
            self.x.set_position_target(end[Axis::X], top[Axis::X]);
            self.z.set_position_target(end[Axis::Z], top[Axis::Z].min(self.speed_mm_s().abs()));
            self.stage = ThreadStage::RunningOut;
        }
    }

    /// Hands each axis over to its mover in its present state.
    fn hand_over_to_movers(&mut self) {
        let (at, speed) = (self.setpoint.position, self.setpoint.velocity_mm_s);
        let state = |axis: Axis| AxisState { position: at[axis], velocity: speed[axis], acceleration: 0.0 };
        let (x, z) = (state(Axis::X), state(Axis::Z));
        self.x.set_state(x);
        self.z.set_state(z);
    }

    fn tick_movers(&mut self) {
        for (axis, mover) in [(Axis::X, &mut self.x), (Axis::Z, &mut self.z)] {
            (self.setpoint.position[axis], self.setpoint.velocity_mm_s[axis]) = mover.tick();
        }
    }
}
