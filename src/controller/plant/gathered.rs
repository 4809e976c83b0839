//! Values that programs write are stored together: a loop that counts commits a few times a second, not with each pass.
//!
//! They are stored with the next request of any other kind, when the program does not run any more (M00, M01, end, hold,
//! reset, alarm), and when one has waited 250 ms; in one commit, so that no value is kept without those written before
//! it. What the operator enters does not wait. Source: spec B3, B6.

use super::Plant;
use crate::controller::plant::execution::ControlPhase;
use crate::controller::storage_request::StorageRequest;
use crate::nc::{CommonVariables, OriginPlace, VariableError};
use crate::units::Micros;

/// Longest time that a value waits for its commit.
const LONGEST_WAIT: Micros = Micros::from_millis(250);
/// Variables in a word of the mask.
const WORD: u32 = u64::BITS;

/// What waits for its commit; the values are those in force then.
#[derive(Debug, Default)]
pub struct GatheredWrites {
    /// A bit for each variable #0 to #1023.
    variables: [u64; 16],
    /// A bit for each offset, from 0.
    offsets: u64,
    /// A bit for each origin, by [`OriginPlace::index`].
    origins: u64,
    /// When the first of them was written.
    since: Option<Micros>,
}

impl Plant {
    /// Sets a common variable for a program.
    pub fn write_variable(&mut self, variable: u32, value: Option<f64>) -> Result<(), VariableError> {
        self.work.variables.set(variable, value)?;
        if CommonVariables::is_retained(variable) {
            let now = self.now;
            let gathered = &mut self.outbox.gathered;
            gathered.variables[(variable / WORD) as usize] |= 1 << (variable % WORD);
            gathered.since.get_or_insert(now);
        }
        Ok(())
    }

    /// Notes that a program has changed an offset (index from 0).
    pub fn note_offset(&mut self, index: usize) {
        let now = self.now;
        self.outbox.gathered.offsets |= 1 << index;
        self.outbox.gathered.since.get_or_insert(now);
    }

    /// Notes that a program has changed an origin.
    pub fn note_origin(&mut self, place: OriginPlace) {
        let now = self.now;
        self.outbox.gathered.origins |= 1 << place.index();
        self.outbox.gathered.since.get_or_insert(now);
    }

    /// Stores what programs have written, if it is time.
    pub fn store_gathered_when_due(&mut self) {
        let Some(since) = self.outbox.gathered.since else { return };
        let runs = matches!(self.execution.phase, ControlPhase::Running);
        if !runs || !self.outbox.requests.is_empty() || self.now.since(since) >= LONGEST_WAIT {
            self.store_gathered();
        }
    }

    /// Stores what programs have written: behind the requests that came before it, and before every later one.
    pub fn store_gathered(&mut self) {
        if self.outbox.gathered.since.is_none() {
            return;
        }
        let GatheredWrites { variables, offsets, origins, .. } = std::mem::take(&mut self.outbox.gathered);
        for (word, bits) in (0_u32..).zip(variables) {
            for variable in bits_of(bits).map(|bit| word * WORD + bit) {
                let value = self.work.variables.get(variable).ok().flatten();
                self.store(StorageRequest::Variable(variable, value));
            }
        }
        for index in bits_of(offsets) {
            self.store_offset(index as usize);
            self.store_cutter(index as usize);
        }
        for place in bits_of(origins).filter_map(|bit| OriginPlace::at(bit as usize)) {
            self.store_origin(place);
        }
    }
}

/// The numbers of the bits that are set.
fn bits_of(bits: u64) -> impl Iterator<Item = u32> {
    std::iter::successors(Some(bits), |left| Some(left & left.wrapping_sub(1)))
        .take_while(|left| *left != 0)
        .map(u64::trailing_zeros)
}
