//! Work coordinates: G50, tool offsets, wear.

use kt830::nc::WorkOffsets;
use kt830::units::{Axis, MachinePos, PerAxis, WorkPos};

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-12
}

#[test]
fn b2_g50_calls_the_present_position_by_its_new_name() {
    let mut frames = WorkOffsets::default();
    frames.work[0] = PerAxis([-100.0, 0.0, -200.0]);
    let machine = MachinePos::new([-75.0, 0.0, -180.0]);
    frames.set_coordinates(machine, &PerAxis([Some(10.0), None, None]));
    let work = frames.work_from_machine(machine);
    assert!(close(work[Axis::X], 10.0) && close(work[Axis::Z], 20.0));
}

#[test]
fn k5_10_g50_clears_the_wear_of_the_tool_in_force() {
    let mut frames = WorkOffsets { tool_offset: 4, ..WorkOffsets::default() };
    frames.wear[3] = PerAxis([0.05, 0.0, -0.1]);
    frames.wear[4] = PerAxis([0.02, 0.0, 0.0]);
    frames.set_coordinates(MachinePos::default(), &PerAxis([Some(1.0), None, None]));
    assert_eq!(frames.wear[3], PerAxis::default());
    assert_eq!(frames.wear[4], PerAxis([0.02, 0.0, 0.0]));
}

#[test]
fn b2_a_tool_offset_moves_the_work_coordinate() {
    let mut frames = WorkOffsets::default();
    frames.geometry[1] = PerAxis([0.0, 0.0, -20.0]);
    frames.wear[1] = PerAxis([0.0, 0.0, 0.5]);
    frames.tool_offset = 2;
    let work = WorkPos::new([5.0, 0.0, 30.0]);
    let machine = frames.machine_from_work(work);
    assert!(close(machine[Axis::Z], 10.5));
    assert_eq!(frames.work_from_machine(machine), work);
}
