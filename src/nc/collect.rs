//! Reads the contour blocks that a cycle names, without motion. Source: spec B2 (G70–G73).

use super::contour::{ContourCycle, Form, expand};
use super::fault::{Outcome, wrong, wrong1};
use super::interpreter::{Block, Interpreter, Pending, Stepped};
use super::op::Op;
use super::world::{Live, World};
use crate::defs::program_error::ProgramError as E;
use crate::units::PerAxis;

/// Most blocks of a contour.
const BLOCKS: usize = 500;

/// The state while a contour is read: the position is the end of its last block.
struct Ahead<'w> {
    world: &'w mut dyn World,
    position: PerAxis<f64>,
}

impl World for Ahead<'_> {
    fn position(&self) -> PerAxis<f64> {
        self.position
    }

    fn system(&mut self, number: u32) -> Live {
        self.world.system(number)
    }

    fn block_skip(&self) -> bool {
        self.world.block_skip()
    }
}

impl Interpreter {
    /// Expands a cycle into operations. The program continues after the contour, or after the cycle if that is later.
    pub(super) fn contour(
        &mut self,
        Pending { cycle, begin }: &Pending,
        world: &mut dyn World,
        block: &mut Block,
    ) -> Outcome<Stepped> {
        let start = world.position();
        let (flow, modals, last_n, n) = (self.flow.clone(), self.modals, self.last_n, self.words.n);
        let read = self.read_contour(cycle, world, start);
        let end_line = self.flow.line;
        self.flow = flow;
        (self.modals, self.last_n, self.words.n, self.second_half) = (modals, last_n, n, false);
        let ops = match read.and_then(|ops| expand(cycle, start, &ops).or_else(|error| wrong(cycle.at, error))) {
            Ok(ops) => ops,
            Err(stop) => {
                // The flow goes back to the block: it is read again, or its mistake is reported.
                (self.flow.at, self.flow.line, self.flow.mid_line) = *begin;
                return Err(stop);
            }
        };
        block.ops.extend(ops);
        block.modals = self.modals;
        if !matches!(cycle.form, Form::Finish) && end_line > self.flow.line {
            self.flow.go_to_line(end_line);
        }
        Ok(Stepped::Block)
    }

    /// The operations of the contour's blocks. Afterwards the flow is past the last one.
    fn read_contour(&mut self, cycle: &ContourCycle, world: &mut dyn World, start: PerAxis<f64>) -> Outcome<Vec<Op>> {
        if self.flow.source.find_block(cycle.last, self.flow.at).is_none() {
            return wrong1(cycle.at, E::MissingTarget, format!("N{}", cycle.last));
        }
        self.flow.go_to_block(cycle.first, cycle.at)?;
        let mut ahead = Ahead { world, position: start };
        let (mut inner, mut ops) = (Block::new(&self.settings), Vec::new());
        for _ in 0..BLOCKS {
            inner.clear();
            let at = self.flow.at;
            match self.read_block(&mut ahead, &mut inner)? {
                Stepped::End => break,
                Stepped::Nothing | Stepped::Block => {}
            }
            if self.pending.take().is_some() {
                return wrong(at, E::ContourCode);
            }
            for op in inner.ops.drain(..) {
                match &op {
                    Op::Rapid { to, .. } | Op::Feed { to, .. } | Op::Arc { to, .. } => ahead.position = *to,
                    Op::S { .. } | Op::Path(_) => {}
                    _ => return wrong(at, E::ContourCode),
                }
                ops.push(op);
            }
            if self.words.n == Some(cycle.last) && !self.second_half {
                return Ok(ops);
            }
        }
        wrong1(cycle.at, E::MissingTarget, format!("N{}", cycle.last))
    }
}
