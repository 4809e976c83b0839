//! Runs a text without a machine, for the tests of this folder.

use std::sync::Arc;

use kt830::nc::{
    Block, CommonVariables, EmptyLibrary, Interpreter, NcSettings, NextStatus, OfflineMachine, Op, OpEffect, OpMotion,
    ProgramFault, Source,
};
use kt830::units::{Axis, WorkPos};

/// The operations of a text, each with the line of its block, and the common variables behind them.
pub fn run_in(
    world: &mut OfflineMachine,
    text: &str,
    settings: &NcSettings,
) -> Result<(Vec<(u32, Op)>, CommonVariables), ProgramFault> {
    let mut block = Block::new(settings);
    let source = Arc::new(Source::new(1001, "O1001.NC", text, settings.dialect));
    let mut interpreter =
        Interpreter::new(source, Arc::new(EmptyLibrary), settings.clone(), CommonVariables::default());
    let mut ops = Vec::new();
    loop {
        match interpreter.next(world, &mut block)? {
            NextStatus::Block => {
                block.ops.iter().for_each(|op| world.apply(op));
                ops.extend(block.ops.iter().map(|op| (block.location.line, op.clone())));
            }
            NextStatus::Drain | NextStatus::Busy | NextStatus::Waiting => {}
            NextStatus::End => return Ok((ops, interpreter.common_variables().clone())),
        }
    }
}

/// A move: its line, its end as (z, x), and the centre of an arc; radius mm.
pub type Move = (u32, [f64; 2], Option<[f64; 2]>);

/// The moves of the operations.
pub fn moves(ops: &[(u32, Op)]) -> Vec<Move> {
    let at = |position: WorkPos| [position[Axis::Z], position[Axis::X]];
    let one = |(line, op): &(u32, Op)| match op.effect() {
        OpEffect::Motion(OpMotion::Work(by)) => Some((*line, at(by.to), by.arc.map(|arc| at(arc.center)))),
        _ => None,
    };
    ops.iter().filter_map(one).collect()
}

/// Rounding of coordinates, mm.
pub const ROUNDING_MM: f64 = 1e-9;

/// Compares the moves of a text with those expected.
pub fn assert_moves(found: &[Move], expected: &[Move], text: &str) {
    let near = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) < ROUNDING_MM;
    let is_same = |(is, should): (&Move, &Move)| {
        let centres = match (is.2, should.2) {
            (Some(a), Some(b)) => near(a, b),
            (None, None) => true,
            _ => false,
        };
        is.0 == should.0 && near(is.1, should.1) && centres
    };
    let equal = found.len() == expected.len() && found.iter().zip(expected).all(is_same);
    assert!(equal, "{text}\nfound    {found:?}\nexpected {expected:?}");
}
