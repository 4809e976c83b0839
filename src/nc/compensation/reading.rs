//! How the interpreter reads blocks between G41 and G40. Source: spec B2 (G40 G41 G42).

use std::sync::Arc;

use super::{CompensationRefusal, ContourFault};
use crate::defs::text::arg::Arg;
use crate::nc::block::{Block, BlockPlace};
use crate::nc::external_state::{AheadState, ExternalState};
use crate::nc::fault::{BlockLocation, E, ErrorAt, ProgramFault, ReadStop, StepStop};
use crate::nc::interpreter::{Interpreter, StepStatus};
use crate::units::{PerAxis, WorkPos};

impl Interpreter {
    /// Whether the cutter is beside a contour, or blocks of one wait to be returned.
    #[must_use]
    pub fn is_in_compensation(&self) -> bool {
        self.compensation.is_open() || self.compensation.has_blocks()
    }

    /// Whether a block waits for the move behind its corner.
    #[must_use]
    pub fn is_in_corner(&self) -> bool {
        !self.corners.is_idle()
    }

    /// The operator has moved the axes by hand in a hold: blocks that wait follow (K6.3).
    pub fn shift_by_hand(&mut self, by: PerAxis<f64>) {
        self.corners.shift_by_hand(by);
        self.compensation.shift_by_hand(by);
    }

    /// Whether the main program has begun again, and all blocks before that have been returned.
    pub(in crate::nc) fn has_restarted(&self) -> bool {
        self.flow.restarted && !self.is_in_compensation() && self.corners.is_idle()
    }

    /// Whether all blocks have been returned.
    pub(in crate::nc) fn is_over(&self) -> bool {
        self.ended && !self.compensation.has_blocks() && self.corners.is_idle()
    }

    /// As [`Self::step`]; blocks between G41 and G40 are returned with the moves of the cutter's centre.
    #[inline]
    pub(in crate::nc) fn step_compensated(
        &mut self,
        world: &mut dyn ExternalState,
        block: &mut Block,
    ) -> Result<StepStatus, StepStop> {
        if self.modals.compensation.is_none() && !self.is_in_compensation() {
            let stepped = self.step_cornered(world, block)?;
            if self.modals.compensation.is_none() {
                return Ok(stepped);
            }
            let from = world.position();
            return self.take_block(stepped, block, from);
        }
        self.step_beside_contour(world, block)
    }

    fn step_beside_contour(
        &mut self,
        world: &mut dyn ExternalState,
        block: &mut Block,
    ) -> Result<StepStatus, StepStop> {
        if let Some(fault) = &self.compensation.fault {
            return Err(StepStop::Fault(fault.fault.clone()));
        }
        if self.compensation.release(block) {
            return Ok(StepStatus::Block);
        }
        if self.ended && self.corners.is_idle() {
            return Ok(StepStatus::End);
        }
        let (is_active, place) = (self.compensation.is_open(), self.next_place());
        let from = if is_active { self.compensation.programmed } else { world.position() };
        let stepped = if is_active {
            let mut ahead = AheadState { inner: world, position: from, reads_machine: false };
            self.step_cornered(&mut ahead, block)
        } else {
            self.step_cornered(world, block)
        };
        match stepped {
            Ok(stepped) => self.take_block(stepped, block, from),
            // Behind G40 the contour ends here, and the block is read again when the machine stands.
            Err(StepStop::Drain) if is_active && self.modals.compensation.is_none() => {
                match self.compensation.end_contour(None, place) {
                    Ok(()) => Ok(StepStatus::Empty),
                    Err(wrong) => self.fail_compensation(wrong, false),
                }
            }
            Err(StepStop::Drain) if is_active => {
                let g = self.modals.compensation.map_or(40, |active| active.g());
                self.fail_compensation(place.refusal(E::NotInCompensation, g), false)
            }
            Err(stop) => Err(stop),
        }
    }

    pub(in crate::nc) fn stopped(&self, stop: ReadStop) -> StepStop {
        match stop {
            ReadStop::Drain => StepStop::Drain,
            ReadStop::Error(wrong) => StepStop::Fault(self.locate(wrong)),
        }
    }

    /// Lets a block that was read wait, and returns the next one whose path is known.
    fn take_block(&mut self, stepped: StepStatus, block: &mut Block, from: WorkPos) -> Result<StepStatus, StepStop> {
        if block.is_cycle && !self.is_in_compensation() {
            return Ok(stepped);
        }
        let (mut place, mut modals) = (self.corners.place, &self.modals);
        if matches!(stepped, StepStatus::Block) {
            (place.location, modals) = (block.location, &block.modals);
        }
        if let Err(wrong) = self.compensation.check_unchanged(modals, place) {
            return self.fail_compensation(wrong, true);
        }
        // The block that ends the program ends the contour, too.
        let was_open = self.compensation.is_open();
        if matches!(stepped, StepStatus::Block)
            && let Err(wrong) = self.compensation.accept(block, from, place)
        {
            return self.fail_compensation(wrong, true);
        }
        let restarts = self.flow.is_main() && self.flow.place.line == 0 && place.location.line > 1;
        if (self.ended || restarts) && self.corners.is_idle() || matches!(stepped, StepStatus::End) {
            if was_open {
                self.warn_at_end(place.at);
            }
            if let Err(wrong) = self.compensation.end_contour(None, place) {
                return self.fail_compensation(wrong, true);
            }
        }
        block.clear();
        Ok(match (self.compensation.release(block), stepped) {
            (true, _) => StepStatus::Block,
            (false, StepStatus::End) => StepStatus::End,
            (false, StepStatus::Empty | StepStatus::Block) => StepStatus::Empty,
        })
    }

    /// A program that ends beside the contour.
    fn warn_at_end(&mut self, at: usize) {
        if let (Some(on), Some(notes)) = (self.modals.compensation, &mut self.warnings) {
            let details = [Arg::from(format_args!("G{}", on.g())), Arg::None];
            notes.push(ErrorAt { at, error: E::CompensationNotEnded, details });
        }
    }

    /// The block that is read next; its number is not known yet.
    pub(in crate::nc) fn next_place(&self) -> BlockPlace {
        let location = BlockLocation { program: self.flow.source.number(), line: self.flow.place.line + 1, n: None };
        BlockPlace { location, at: self.flow.place.at }
    }

    /// A mistake of a block that was read before, here or in another program.
    pub(in crate::nc) fn fault_in(&self, location: BlockLocation, wrong: ErrorAt) -> ProgramFault {
        let here = &self.flow.source;
        let is_here = location.program == here.number();
        let elsewhere = if is_here { None } else { self.library.find(location.program) };
        let fault = elsewhere.unwrap_or_else(|| Arc::clone(here)).fault(location.n, wrong);
        // How the run came to a block of another program is not known any more.
        if is_here { fault.with_calls(self.flow.calls()) } else { fault }
    }

    /// Ends reading with a mistake of the contour.
    #[cold]
    fn fail_compensation(&mut self, refusal: CompensationRefusal, block_read: bool) -> Result<StepStatus, StepStop> {
        let CompensationRefusal { location, wrong } = refusal;
        let fault = self.fault_in(location, wrong);
        self.compensation.fault = Some(ContourFault { fault: fault.clone(), block_read });
        Err(StepStop::Fault(fault))
    }
}
