//! The homing of one axis on its switch.

use kt830::controller::axes::homing::{AxisHoming, HomingFailure, HomingPlan, HomingProgress};
use kt830::motion::{AxisLimits, AxisMover};
use kt830::units::Axis;

/// Homes an axis whose switch closes at `switch_mm`, for at most `ticks`: the position of zero, or the failure.
fn home(switch_mm: f64, ticks: u32) -> Result<f64, HomingFailure> {
    let limits = AxisLimits { velocity_mm_s: 100.0, acceleration_mm_s2: 800.0, jerk_mm_s3: 20_000.0 };
    let mut mover = AxisMover::new(limits, 0.0, 0.001);
    let (direction, travel_mm, width_mm) = (1.0, 50.0, 0.01);
    let (fast_mm_s, slow_mm_s, coordinate, over_switch) = (20.0, 1.0, 5.0, false);
    let plan = HomingPlan {
        direction,
        fast_mm_s,
        slow_mm_s,
        travel_mm,
        coordinate,
        over_switch,
        width_mm,
        is_absolute: false,
    };
    let mut homing = AxisHoming::new(Axis::X, plan);
    let mut zero = None;
    for _ in 0..ticks {
        let at = mover.position();
        // After the zero is set the switch is at its coordinate.
        let on = at >= zero.map_or(switch_mm, |_| coordinate);
        match homing.tick(&mut mover, on, on, at) {
            HomingProgress::Running => {}
            HomingProgress::SetZero { edge } => {
                zero = Some(edge);
                mover.set_position(at + coordinate - edge);
            }
            HomingProgress::Done => return Ok(zero.unwrap_or(f64::NAN)),
            HomingProgress::Failed(why) => return Err(why),
        }
        mover.tick();
    }
    panic!("still homing");
}

#[test]
fn b5_an_axis_homes_on_the_slow_edge_of_its_switch_or_says_that_there_is_none() {
    let edge = home(10.0, 40_000).unwrap();
    assert!((edge - 10.0).abs() < 0.002, "1 mm/s are 1 µm a tick: {edge}");
    assert_eq!(home(500.0, 40_000), Err(HomingFailure::NoSwitch), "further than the travel of 50 mm");
}
