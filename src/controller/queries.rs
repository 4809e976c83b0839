//! What hosts and tests ask of the controller besides the snapshot.

use super::Controller;
use super::panel::run_state;
use super::plant::ControlPhase;
use crate::defs::key::Mode;
use crate::defs::kind::Kind;
use crate::defs::param::Params;
use crate::defs::signal::{OutputSet, Terminals};
use crate::defs::text::LocalizedText;
use crate::io::OutputImage;
use crate::link::part_result::PartResult;
use crate::link::snapshot::{OwnMotion, RunState};
use crate::link::thread_cut::ThreadCut;
use crate::nc::{BlockLocation, WorkOffsets};
use crate::units::{Axis, MachinePos, Micros, PerAxis};

impl Controller {
    /// Work units of the last tick: reading of blocks, look-ahead and feed scaling. Counted, not timed, and not above
    /// [`WORK_PER_TICK`](super::WORK_PER_TICK) but for the contour of one cycle (G70–G73).
    #[must_use]
    pub const fn work_of_last_tick(&self) -> usize {
        self.plant.tick_budget.spent()
    }

    /// The part that the last cycle has finished.
    #[must_use]
    pub const fn part_result(&self) -> Option<PartResult> {
        self.panel.part_result
    }

    /// Why a command of the last tick was refused; `None` if all were executed.
    #[must_use]
    pub const fn refusal(&self) -> Option<&LocalizedText> {
        self.plant.outbox.refusal.as_ref()
    }

    /// The threads cut since power-on with their lead error, mm; at most 256.
    #[must_use]
    pub fn threads(&self) -> &[ThreadCut] {
        self.plant.spindles.threads.threads()
    }

    /// The value of a system variable; `None` if it is null or does not exist.
    #[must_use]
    pub fn system_variable(&self, number: u32) -> Option<f64> {
        self.plant.system_variable(number)
    }

    /// Outputs by function, as of the last tick.
    #[must_use]
    pub const fn output_set(&self) -> OutputSet {
        self.plant.outputs.on
    }

    /// The value of a common variable as executed.
    #[must_use]
    pub fn variable(&self, number: u32) -> Option<f64> {
        self.plant.work.variables.get(number).ok().flatten()
    }

    /// Work offsets and tool offsets as executed.
    #[must_use]
    pub const fn work_offsets(&self) -> &WorkOffsets {
        &self.plant.work.offsets
    }

    /// The present block: program, line, N.
    #[must_use]
    pub const fn current_block(&self) -> BlockLocation {
        self.plant.execution.current_block
    }

    /// The output image of the last tick.
    #[must_use]
    pub const fn outputs(&self) -> &OutputImage {
        &self.plant.outputs.image
    }

    /// The parameters in force.
    #[must_use]
    pub fn params(&self) -> &Params {
        &self.plant.params
    }

    /// The kind of machine.
    #[must_use]
    pub const fn kind(&self) -> Kind {
        self.plant.kind
    }

    /// The operating mode.
    #[must_use]
    pub const fn mode(&self) -> Mode {
        self.plant.operator.mode
    }

    /// What moves by itself.
    #[must_use]
    pub fn own_motion(&self) -> Option<OwnMotion> {
        self.program.own_motion(&self.plant)
    }

    /// Whether an axis or the cylinder oscillates, whoever began it.
    #[must_use]
    pub fn is_oscillating(&self) -> bool {
        self.plant.is_oscillating()
    }

    /// Whether the key has begun an oscillation that goes on.
    #[must_use]
    pub fn oscillates_by_key(&self) -> bool {
        self.plant.oscillates_by_key()
    }

    /// When the last program has reached its M30 with a finished part; none from the next cycle start by the
    /// operator on.
    #[must_use]
    pub fn part_finished_at(&self) -> Option<Micros> {
        self.plant.execution.finished_cycle.map(|cycle| cycle.ended_at)
    }

    /// Whether a thread is cut: Z follows the spindle.
    #[must_use]
    pub fn is_threading(&self) -> bool {
        self.plant.axes.thread().is_some()
    }

    /// Whether an axis was homed since power-on.
    #[must_use]
    pub fn is_homed(&self, axis: Axis) -> bool {
        self.plant.axes.is_homed(axis)
    }

    /// Dressing points, machine coordinates, radius mm; `None` where not set.
    #[must_use]
    pub const fn dress_points(&self) -> &PerAxis<Option<f64>> {
        &self.plant.work.dress_points
    }

    /// Tick time.
    #[must_use]
    pub const fn tick_time(&self) -> Micros {
        self.plant.axes.tick_time()
    }

    /// Blocks executed since power-on.
    #[must_use]
    pub const fn block_count(&self) -> u64 {
        self.plant.execution.block_count
    }

    /// Whether the program repeats a loop that only the operator can end: by a variable, or RESET.
    #[must_use]
    pub const fn is_in_endless_loop(&self) -> bool {
        self.plant.execution.is_endless
    }

    /// Whether the axes are braking to a hold or a reset.
    #[must_use]
    pub const fn is_braking(&self) -> bool {
        matches!(self.plant.execution.phase, ControlPhase::Holding | ControlPhase::Aborting)
    }

    /// Whether the axes stand in position.
    #[must_use]
    pub fn is_in_position(&self) -> bool {
        self.plant.is_in_position()
    }

    /// Whether no set-point moves; an axis that goes on oscillating does not count.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        self.plant.has_braked()
    }

    /// The axes of the machine.
    pub fn axes_present(&self) -> impl Iterator<Item = Axis> + use<> {
        self.plant.axes.present()
    }

    /// Machine set-point, radius mm.
    #[must_use]
    pub const fn set_point(&self) -> MachinePos {
        self.plant.axes.set_point()
    }

    /// Machine position from the encoders, radius mm.
    #[must_use]
    pub const fn actual(&self) -> MachinePos {
        self.plant.axes.actual()
    }

    /// Wear of an offset (1 to 16), mm as displayed.
    #[must_use]
    pub fn wear(&self, number: usize, axis: Axis) -> Option<f64> {
        let wear = self.plant.work.offsets.wear.get(number.checked_sub(1)?)?;
        Some(wear[axis] * self.plant.displayed_per_mm(axis))
    }

    /// Controller time.
    #[must_use]
    pub const fn now(&self) -> Micros {
        self.plant.now
    }

    /// #438 and #439.
    #[must_use]
    pub fn oscillation_flags(&self) -> (bool, bool) {
        self.plant.oscillation_flags()
    }

    /// Terminals that keep their level in the safe state: spindles and fluids off, clamps hold (table after K3).
    #[must_use]
    pub fn kept_in_safe_state(&self) -> Terminals {
        self.plant.kept_in_safe_state()
    }

    /// The run state.
    #[must_use]
    pub fn state(&self) -> RunState {
        run_state(self.view())
    }
}
