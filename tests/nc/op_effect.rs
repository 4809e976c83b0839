//! The motion of an operation, and what is known after it.

use kt830::nc::{AxisSet, Feed, Op, OpMotion, REFERENCE_POINTS, WorkOffsets};
use kt830::units::{Axis, MachinePos, PerAxis, WorkPos};

#[test]
fn l6_homing_by_switches_moves_one_axis_after_the_other() {
    let axes = AxisSet::of(Axis::X).with(AxisSet::of(Axis::Z));
    let references = [MachinePos::new([1.0, 0.0, 2.0]); REFERENCE_POINTS];
    let mut path = Vec::new();
    let from = WorkPos::new([5.0, 0.0, 7.0]);
    OpMotion::HomeSwitch(axes).trace(from, &WorkOffsets::default(), &references, |segment| path.push(segment.to));
    assert_eq!(path, [WorkPos::new([1.0, 0.0, 7.0]), WorkPos::new([1.0, 0.0, 2.0])]);
}

#[test]
fn b5_the_position_after_a_skip_a_gauge_and_g50_is_unknown() {
    let to = WorkPos::default();
    let words = AxisSet::of(Axis::Z);
    let skip = Op::Skip { to, feed: Feed::PerMinute(1.0), signal: 1, words, incremental: AxisSet::NONE };
    assert!(!skip.effect().leaves_position_known() && skip.effect().is_motion());
    assert!(!Op::SetCoordinateSystem { values: PerAxis::default() }.effect().leaves_position_known());
    assert!(Op::HomeSwitch { axes: words }.effect().leaves_position_known());
}
