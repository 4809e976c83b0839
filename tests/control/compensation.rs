//! G41 and G42 in a run: the slides follow the centre of the cutter, stops and resumes included (row B2).

use kt830::host::headless::HeadlessHost;

use crate::stories::{ready, ready_with, tell};

/// A shaft of Ø40 with a shoulder to Ø60 at Z−30, in work coordinates of the program; the wheel's corner has a radius of
/// 2 mm and its centre is programmed (T0). Beside the shaft the centre is at Ø44, the inner corner at Z−28.
const SHAFT: &str = "G98 G50 X100 Z10
G42 D5 G01 X40 Z0 F2000
Z-30
X60
G40 G00 X100
Z10
M30
";

fn with_cutter(text: &str) -> HeadlessHost {
    let mut rig = ready_with(text);
    tell(
        &mut rig,
        "mdi #2905=2
mdi #2305=0",
    );
    rig
}

#[test]
fn b2_single_blocks_stop_beside_the_contour_and_the_program_ends_where_it_is_written() {
    let mut rig = with_cutter(SHAFT);
    tell(
        &mut rig,
        "mode auto
key single-block
key cycle-start
wait until stopped
key cycle-start
wait until stopped
         expect X 44.000 ±0.001
expect Z 0.000 ±0.001
         key cycle-start
wait until stopped
expect X 44.000 ±0.001
expect Z -28.000 ±0.001
         key cycle-start
wait until stopped
expect X 60.000 ±0.001
expect Z -28.000 ±0.001
         key single-block
key cycle-start
wait until idle
expect X 100.000 ±0.001
expect Z 10.000 ±0.001",
    );
}

#[test]
fn b2_a_hold_beside_the_contour_resumes_on_it() {
    let mut rig = with_cutter(SHAFT);
    tell(
        &mut rig,
        "mode auto
key cycle-start
wait until Z<-10 max 30 s
key feed-hold
wait until held
expect X 44.000 ±0.001
         key cycle-start
wait until Z<-27.9 max 30 s
wait until idle
expect X 100.000 ±0.001
expect no alarm",
    );
}

#[test]
fn b2_a_contour_that_the_wheel_does_not_fit_stops_before_it_moves() {
    // The groove of 3 mm is narrower than the wheel's corner; the line is named.
    let groove = "G98 G50 X100 Z10
G42 D5 G01 X40 Z0 F2000
Z-10
X36
Z-13
X40
Z-30
G40 G00 X100
M30
";
    let mut rig = with_cutter(groove);
    tell(
        &mut rig,
        "mode auto
key cycle-start
wait until alarm
expect alarm 506
expect X 100.000 ±0.001
expect Z 10.000 ±0.001",
    );
}

#[test]
fn b2_a_radius_out_of_range_is_refused_and_changes_nothing() {
    let mut rig = ready();
    tell(
        &mut rig,
        "mdi #2905=2
mdi #2905=-1
expect alarm 204
key reset
expect #2905 2
mdi #2305=10
expect alarm 204",
    );
}

#[test]
fn b2_radius_and_tip_outlive_a_power_cut() {
    let mut rig = ready();
    tell(
        &mut rig,
        "mdi #2905=0.4
mdi #2305=3
power cut
power on
expect #2905 0.4
expect #2305 3",
    );
}

/// K6.3: what the operator cranks in a hold stays for every block that does not send the axis to its place, however far
/// the contour was read ahead.
#[test]
fn k6_3_a_handwheel_shift_beside_a_long_contour_stays() {
    let mut text = "G98 G00 X-80 Z-150\nG42 D5 G01 X-100 Z-155 F600\n".to_owned();
    (1..=600).for_each(|k| text.push_str(&format!("Z{:.1}\n", -155.0 - 0.1 * f64::from(k))));
    text.push_str("G40 G00 X-80\nM30\n");
    let mut rig = with_cutter(&text);
    // Beside Ø−100 the centre is at −100 + 2 · 2; 100 detents of 0.01 mm towards minus.
    tell(
        &mut rig,
        "mode auto\nkey cycle-start\nwait until Z<-157 max 30 s\nexpect X -96.000 ±0.001\nkey feed-hold\nwait until held
         handwheel X -100 x0.01\nwait 1 s\nexpect X -97.000 ±0.001\nkey cycle-start
         wait until Z<-180 max 30 s\nexpect X -97.000 ±0.001\nwait until Z<-205 max 30 s\nexpect X -97.000 ±0.001
         wait until idle max 30 s\nexpect X -80.000 ±0.001\nexpect no alarm",
    );
}

/// A shaft of Ø40 with a rounding of 2 mm to the shoulder at Z−30: it begins at Z−28 and ends at Ø44.
const ROUNDED: &str = "G98 G50 X100 Z10
G01 X40 Z0 F2000
Z-30 ,R2
X60
G00 X100
Z10
M30
";

#[test]
fn b2_a_single_block_stops_behind_its_corner() {
    let mut rig = ready_with(ROUNDED);
    let step = "key cycle-start\nwait until stopped max 20 s\n";
    tell(&mut rig, &format!("mode auto\nkey single-block\n{step}{step}expect X 40 ±0.001\nexpect Z 0 ±0.001"));
    tell(
        &mut rig,
        &format!("{step}expect X 44 ±0.001\nexpect Z -30 ±0.001\n{step}expect X 60 ±0.001\nexpect Z -30 ±0.001"),
    );
    tell(
        &mut rig,
        "key single-block\nkey cycle-start\nwait until idle max 20 s\nexpect X 100 ±0.001\nexpect Z 10 ±0.001",
    );
}
