//! How the interpreter reads blocks between G41 and G40. Source: spec B2 (G40 G41 G42).

use std::sync::Arc;

use super::{BlockPlace, CompensationRefusal};
use crate::defs::text::arg::Arg;
use crate::nc::block::Block;
use crate::nc::external_state::{AheadState, ExternalState};
use crate::nc::fault::{BlockLocation, E, ErrorAt, ReadStop, StepStop};
use crate::nc::interpreter::{Interpreter, StepStatus};
use crate::units::WorkPos;

impl Interpreter {
    /// Whether the cutter is beside a contour, or blocks of one wait to be returned.
    #[must_use]
    pub fn is_in_compensation(&self) -> bool {
        self.compensation.is_open() || self.compensation.has_blocks()
    }

    /// Whether all blocks have been returned.
    pub(in crate::nc) fn is_over(&self) -> bool {
        self.ended && !self.compensation.has_blocks()
    }

    /// As [`Self::step`]; blocks between G41 and G40 are returned with the moves of the cutter's centre.
    #[inline]
    pub(in crate::nc) fn step_compensated(
        &mut self,
        world: &mut dyn ExternalState,
        block: &mut Block,
    ) -> Result<StepStatus, StepStop> {
        if self.modals.compensation.is_none() && !self.is_in_compensation() {
            let place = self.next_place();
            let stepped = match self.step(world, block) {
                Err(stop) => return Err(self.stopped(stop)),
                Ok(stepped) => stepped,
            };
            if self.modals.compensation.is_none() {
                return Ok(stepped);
            }
            let from = world.position();
            return self.take_block(stepped, block, from, place);
        }
        self.step_beside_contour(world, block)
    }

    fn step_beside_contour(
        &mut self,
        world: &mut dyn ExternalState,
        block: &mut Block,
    ) -> Result<StepStatus, StepStop> {
        if let Some(fault) = &self.compensation.fault {
            return Err(StepStop::Fault(fault.clone()));
        }
        if self.compensation.release(block) {
            return Ok(StepStatus::Block);
        }
        if self.ended {
            return Ok(StepStatus::End);
        }
        let (is_active, place) = (self.compensation.is_open(), self.next_place());
        let from = if is_active { self.compensation.programmed } else { world.position() };
        let stepped = if is_active {
            let mut ahead = AheadState { inner: world, position: from, reads_machine: false };
            self.step(&mut ahead, block)
        } else {
            self.step(world, block)
        };
        match stepped {
            Ok(stepped) => self.take_block(stepped, block, from, place),
            Err(ReadStop::Drain) if is_active => {
                let g = self.modals.compensation.map_or(40, |active| active.g());
                self.fail_compensation(place.refusal(E::NotInCompensation, g))
            }
            Err(stop) => Err(self.stopped(stop)),
        }
    }

    fn stopped(&self, stop: ReadStop) -> StepStop {
        match stop {
            ReadStop::Drain => StepStop::Drain,
            ReadStop::Error(wrong) => StepStop::Fault(self.locate(wrong)),
        }
    }

    /// Lets a block that was read wait, and returns the next one whose path is known.
    fn take_block(
        &mut self,
        stepped: StepStatus,
        block: &mut Block,
        from: WorkPos,
        mut place: BlockPlace,
    ) -> Result<StepStatus, StepStop> {
        if block.is_cycle && !self.is_in_compensation() {
            return Ok(stepped);
        }
        place.location.n = self.block_words.block_number;
        if let Err(wrong) = self.compensation.check_unchanged(&self.modals, place) {
            return self.fail_compensation(wrong);
        }
        if matches!(stepped, StepStatus::Block)
            && let Err(wrong) = self.compensation.accept(block, from, place)
        {
            return self.fail_compensation(wrong);
        }
        if self.ended || matches!(stepped, StepStatus::End) {
            self.warn_at_end(place.at);
            if let Err(wrong) = self.compensation.end_contour(None, place) {
                return self.fail_compensation(wrong);
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
        if self.compensation.is_open()
            && let (Some(on), Some(notes)) = (self.modals.compensation, &mut self.warnings)
        {
            let details = [Arg::from(format_args!("G{}", on.g())), Arg::None];
            notes.push(ErrorAt { at, error: E::CompensationNotEnded, details });
        }
    }

    /// The block that is read next; its number is not known yet.
    fn next_place(&self) -> BlockPlace {
        let location = BlockLocation { program: self.flow.source.number(), line: self.flow.place.line + 1, n: None };
        BlockPlace { location, at: self.flow.place.at }
    }

    /// Ends reading with a mistake of the contour.
    #[cold]
    fn fail_compensation(
        &mut self,
        CompensationRefusal { location, wrong }: CompensationRefusal,
    ) -> Result<StepStatus, StepStop> {
        let here = &self.flow.source;
        let elsewhere = if location.program == here.number() { None } else { self.library.find(location.program) };
        let source = elsewhere.unwrap_or_else(|| Arc::clone(here));
        let fault = source.fault(location.n, wrong).with_calls(self.flow.calls());
        self.compensation.fault = Some(fault.clone());
        Err(StepStop::Fault(fault))
    }
}
