//! Runs a program of a headless host from cycle start to its end.
//! Source: spec tools.md T3.

use super::Host;
use super::simulated::HostedSimulation;
use super::storage::Storage;
use crate::controller::WORK_PER_TICK;
use crate::defs::key::Key;
use crate::defs::page::Page;
use crate::io::sim::PartFile;
use crate::link::command::Command;
use crate::link::snapshot::RunState;
use crate::units::Micros;

/// Ticks after cycle start until the state is evaluated.
const START_TICKS: u32 = 5;
/// After this time without a move, and so many blocks, the run counts as an endless loop. The time is longer than the longest
/// dwell, 9 999.99 s (L2); a program may have several of them, one after the other.
const MAX_STALLED_TIME: Micros = Micros::from_millis(10_000_000);
const MAX_STALLED_BLOCKS: u64 = 1_000;
/// Work of a tick that reads statements all the time.
const COMPUTING_WORK: usize = WORK_PER_TICK / 100;
/// After so much time in which it only computes, it counts as one, too: some hundred million statements without a move.
const MAX_COMPUTING_TIME: Micros = Micros::from_millis(1_800_000);

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunEnd {
    /// M30, M02 and the like.
    Finished,
    /// An alarm.
    Alarm,
    /// Cycle start was refused: nothing ran.
    Refused,
    /// Program stop M00 or M01.
    Pause,
    /// Held by an interlock of the machine.
    Held,
    /// It waits for an input (M80–M89) that a headless run never gets.
    Waiting,
    /// The maximum simulated time is over, or the caller has ended it.
    TimedOut,
    /// No axis has moved for so long that it is an endless loop.
    Stalled,
    /// A loop repeats in which nothing changes.
    Endless,
}

impl RunEnd {
    /// The word in the report; the exit status and the message distinguish the kinds of `stopped`.
    pub const fn report_word(self) -> &'static str {
        match self {
            Self::Finished => "finished",
            Self::Alarm => "alarm",
            Self::Refused
            | Self::Pause
            | Self::Held
            | Self::Waiting
            | Self::TimedOut
            | Self::Stalled
            | Self::Endless => "stopped",
        }
    }
}

/// How far a run goes.
#[derive(Clone, Copy, Debug)]
pub struct RunLimits {
    /// Cycle start is pressed again at M00 and M01.
    pub through_stops: bool,
    /// Maximum simulated time.
    pub longest: Micros,
    /// P390 and M99 in the main program do not repeat it: for the time of one pass.
    pub once: bool,
}

impl<S: Storage> Host<HostedSimulation, S> {
    /// A part like the one that was ground takes its place, once that is measured.
    pub fn next_part(&mut self, part: &PartFile) {
        self.type_measured_size(part);
        self.machine_mut().set_part(Some(part));
    }

    /// Types the measured sizes of the part that was ground on its page, where its program asks for them.
    pub fn type_measured_size(&mut self, part: &PartFile) {
        let report = self.machine().measure();
        let length = part.typed_length.zip(report.face_distance(&part.drawing));
        let typed: Vec<(u16, f64)> = report.typed_sizes(&part.drawing).into_iter().chain(length).collect();
        for (variable, mm) in typed {
            self.send(Command::OpenPage(Page::Grinding));
            self.send(Command::EnterVariable(variable, Some(mm)));
            self.step();
        }
    }

    /// Presses cycle start and steps to the end of the program, an alarm, or a state that needs an operator.
    /// `goes_on` is called after every tick.
    pub fn run_program(&mut self, limits: &RunLimits, goes_on: &mut dyn FnMut(&Self) -> bool) -> RunEnd {
        let started = self.now();
        let mut still = Standstill { since: started, blocks: self.controller().block_count(), computing: Micros::ZERO };
        let mut refused = false;
        self.controller.set_runs_once(limits.once);
        self.send(Command::Press(Key::CycleStart));
        loop {
            self.step();
            if !self.controller().is_at_rest() {
                still =
                    Standstill { since: self.now(), blocks: self.controller().block_count(), computing: Micros::ZERO };
            } else if self.controller().work_of_last_tick() > COMPUTING_WORK {
                still.computing = still.computing + self.tick_time();
            }
            if !goes_on(self) {
                return RunEnd::TimedOut;
            }
            refused |= self.now().since(started) <= self.tick_time() && self.controller().refusal().is_some();
            let young = self.now().since(started).0 < u64::from(START_TICKS) * self.tick_time().0;
            match self.controller().state() {
                RunState::Stopped if limits.through_stops => self.send(Command::Press(Key::CycleStart)),
                RunState::Stopped => return RunEnd::Pause,
                RunState::Held => return RunEnd::Held,
                RunState::Idle if !young => return if refused { RunEnd::Refused } else { RunEnd::Finished },
                RunState::Alarm if self.controller().is_at_rest() => return RunEnd::Alarm,
                // A headless run has no operator who gives the input.
                RunState::Waiting => return RunEnd::Waiting,
                RunState::Running if self.now().since(started) > limits.longest => return RunEnd::TimedOut,
                RunState::Running if still.is_endless(self.now(), self.controller().block_count()) => {
                    return RunEnd::Stalled;
                }
                RunState::Running if self.controller().is_in_endless_loop() && self.controller().is_at_rest() => {
                    return RunEnd::Endless;
                }
                RunState::Idle | RunState::Running | RunState::Homing | RunState::Alarm => {}
            }
        }
    }
}

/// The time without a move.
struct Standstill {
    /// When an axis has moved last.
    since: Micros,
    /// Blocks that were executed until then.
    blocks: u64,
    /// How much of the time since then went into computing alone.
    computing: Micros,
}

impl Standstill {
    /// Whether it is too long for a program that goes on.
    fn is_endless(&self, now: Micros, blocks: u64) -> bool {
        let is_long = now.since(self.since) > MAX_STALLED_TIME && blocks - self.blocks > MAX_STALLED_BLOCKS;
        is_long || self.computing > MAX_COMPUTING_TIME
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn t3_a_loop_ends_by_the_time_that_it_computes_or_repeats_without_a_move() {
        let still = |computing_s: u64| Standstill {
            since: Micros::from_millis(1_000),
            blocks: 5,
            computing: Micros::from_millis(computing_s * 1_000),
        };
        let after = |seconds: u64| Micros::from_millis(1_000 + seconds * 1_000);
        // Half an hour of computing is too long, however few blocks have effects.
        assert!(!still(1_800).is_endless(after(1_900), 5) && still(1_801).is_endless(after(1_900), 5));
        // Dwells: some long ones are a program, a thousand short ones are a loop.
        assert!(!still(0).is_endless(after(60_000), 5 + 1_000) && still(0).is_endless(after(10_001), 5 + 1_001));
        assert!(!still(0).is_endless(after(10_000), 5 + 5_000));
    }
}
