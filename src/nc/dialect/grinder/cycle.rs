//! The canned cycles of GC: G90 along Z, G94 along X. Each has four moves and returns to the starting point.
//! Source: spec B2, K1.

use super::coordinates::{modal_feed, target};
use super::length_mm;
use crate::defs::program_error::ProgramError as E;
use crate::nc::dialect::motion::MoveTarget;
use crate::nc::dialect::rules::BlockContext;
use crate::nc::fault::{ReadResult, fail2};
use crate::nc::op::{AxisSet, Op};
use crate::units::{Axis, PerAxis};

/// G90: X in at rapid, Z at feed (taper R: start radius minus end radius), X out at feed, Z back at rapid.
pub(super) fn longitudinal(running: &mut BlockContext<'_, '_>) -> ReadResult<()> {
    push_cycle(running, Axis::X, Axis::Z)
}

/// G94: Z in at rapid, X at feed (taper R in Z), Z out at feed, X back at rapid.
pub(super) fn face(running: &mut BlockContext<'_, '_>) -> ReadResult<()> {
    push_cycle(running, Axis::Z, Axis::X)
}

fn push_cycle(running: &mut BlockContext<'_, '_>, infeed: Axis, stroke: Axis) -> ReadResult<()> {
    let MoveTarget { from, to, words, incremental } = target(running)?;
    let mut kept = running.modals.cycle;
    if words.contains(Axis::X) {
        kept.x = Some(to[Axis::X]);
    }
    if words.contains(Axis::Z) {
        kept.z = Some(to[Axis::Z]);
    }
    if let Some(taper) = running.words.take(b'R') {
        kept.taper = length_mm(running, taper)?;
    }
    let name = format_args!("G{:02}", running.modals.motion.g()).to_string();
    let (Some(x), Some(z)) = (kept.x, kept.z) else {
        return fail2(running.at, E::MissingWord, name, if kept.x.is_none() { "X / U" } else { "Z / W" });
    };
    let feed = modal_feed(running)?;
    running.modals.cycle = kept;
    let with = |base: PerAxis<f64>, axis: Axis, value: f64| {
        let mut point = base;
        point[axis] = value;
        point
    };
    let end = with(with(from, Axis::X, x), Axis::Z, z);
    let start = with(from, infeed, end[infeed] + kept.taper);
    let out = with(end, infeed, from[infeed]);
    let by = |axes: AxisSet| axes.intersection(incremental);
    let (one, other) = (AxisSet::of(infeed), AxisSet::of(stroke));
    running.ops.push(Op::Rapid { to: start, feed: None, words: one, incremental: by(one) });
    running.ops.push(Op::Feed { to: end, feed, words: one.with(other), incremental: by(one.with(other)) });
    running.ops.push(Op::Feed { to: out, feed, words: one, incremental: by(one) });
    running.ops.push(Op::Rapid { to: from, feed: None, words: other, incremental: by(other) });
    Ok(())
}
