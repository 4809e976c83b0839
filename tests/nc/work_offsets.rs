//! Work coordinates: G50, tool offsets, wear.

use kt830::nc::WorkOffsets;
use kt830::units::{Axis, MachinePos, PerAxis, WorkPos};

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-12
}

#[test]
fn b2_g50_calls_the_present_position_by_its_new_name() {
    let mut offsets = WorkOffsets::default();
    offsets.work[0] = PerAxis([-100.0, 0.0, -200.0]);
    let machine = MachinePos::new([-75.0, 0.0, -180.0]);
    offsets.set_coordinates(machine, &PerAxis([Some(10.0), None, None]));
    let work = offsets.work_from_machine(machine);
    assert!(close(work[Axis::X], 10.0) && close(work[Axis::Z], 20.0));
}

/// As on FANUC: G50 ends the local zero of the axes that it names, so that `G52 X0` does not move the coordinates again.
#[test]
fn b2_g50_ends_the_local_zero_of_its_axes() {
    let mut offsets = WorkOffsets::default();
    offsets.set_local(&PerAxis([Some(7.0), None, Some(3.0)]));
    let machine = MachinePos::new([-75.0, 0.0, -180.0]);
    offsets.set_coordinates(machine, &PerAxis([Some(10.0), None, None]));
    assert_eq!(offsets.local, PerAxis([0.0, 0.0, 3.0]));
    offsets.set_local(&PerAxis([Some(0.0), None, Some(0.0)]));
    let work = offsets.work_from_machine(machine);
    assert!(close(work[Axis::X], 10.0) && close(work[Axis::Z], -180.0), "{work:?}");
}

#[test]
fn k5_10_g50_clears_the_wear_of_the_tool_in_force() {
    let mut offsets = WorkOffsets { tool_offset: 4, ..WorkOffsets::default() };
    offsets.wear[3] = PerAxis([0.05, 0.0, -0.1]);
    offsets.wear[4] = PerAxis([0.02, 0.0, 0.0]);
    offsets.set_coordinates(MachinePos::default(), &PerAxis([Some(1.0), None, None]));
    assert_eq!(offsets.wear[3], PerAxis::default());
    assert_eq!(offsets.wear[4], PerAxis([0.02, 0.0, 0.0]));
}

#[test]
fn b2_a_tool_offset_moves_the_work_coordinate() {
    let mut offsets = WorkOffsets::default();
    offsets.geometry[1] = PerAxis([0.0, 0.0, -20.0]);
    offsets.wear[1] = PerAxis([0.0, 0.0, 0.5]);
    offsets.tool_offset = 2;
    let work = WorkPos::new([5.0, 0.0, 30.0]);
    let machine = offsets.machine_from_work(work);
    assert!(close(machine[Axis::Z], 10.5));
    assert_eq!(offsets.work_from_machine(machine), work);
}
