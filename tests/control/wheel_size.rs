//! What a program reads and writes of the machine: the wheel's diameter through its dressings, offsets, timers, ports
//! (K4.2, K5.17, B2, B3).

use crate::stories::{ready_with, tell};
use kt830::controller::stored_system_variables;
use kt830::defs::date::DateTime;
use kt830::defs::param;
use kt830::host::headless::HeadlessHost;
use kt830::link::command::Command;
use kt830::units::{Axis, PerAxis};

/// Runs a text to its end, in automatic mode.
fn ran(text: &str) -> HeadlessHost {
    let mut rig = ready_with(text);
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until idle max 60 s\nexpect no alarm");
    rig
}

/// Runs a text into an alarm.
fn alarmed(text: &str, number: u16) -> HeadlessHost {
    let mut rig = ready_with(text);
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until alarm max 60 s");
    tell(&mut rig, &format!("expect alarm {number}"));
    rig
}

fn value(rig: &mut HeadlessHost, row: param::NumberParam) -> f64 {
    rig.snapshot().params.get(row)
}

#[test]
fn b3_wear_written_by_a_program_moves_the_blocks_after_it() {
    // Wear of 1.5 mm of diameter: the machine goes 0.75 mm further out for the same X.
    let mut plain = ran("T0101\nG00 X-70\nM30");
    let at = plain.snapshot().axes[Axis::X].machine;
    let mut worn = ran("T0101\n#2001=#2001+1.5\nG00 X-70\nM30");
    let moved = worn.snapshot().axes[Axis::X].machine - at;
    assert!((moved - 1.5).abs() < 0.001, "machine X is shown as a diameter: {moved}");
    tell(&mut worn, "expect X -70 ±0.001\nexpect wear 1 X 1.5 ±0.0001");
}

#[test]
fn k4_2_a_dressing_makes_the_wheel_smaller_and_everything_follows() {
    // 0.04 mm of diameter: 0.02 mm of radius into the wear, towards the part, and off the dressing point.
    let mut rig = ready_with("T0101\n#5801=#5801-0.04\nG00 X-70\n#100=#5801\n#101=#5805\nM30");
    tell(&mut rig, "param P96 7\nmode jog\npage position\nkey f1\nkey address-x\nkey input\nexpect message \"成功\"");
    let (point, before) = (rig.snapshot().dressing_point[Axis::X].unwrap(), value(&mut rig, param::WHEEL_DIAMETER));
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until idle max 60 s\nexpect no alarm\nexpect X -70 ±0.001");
    tell(&mut rig, "expect wear 1 X -0.04 ±0.00001");
    assert!((value(&mut rig, param::WHEEL_DIAMETER) - (before - 0.04)).abs() < 1e-9);
    assert!((rig.snapshot().dressing_point[Axis::X].unwrap() - (point - 0.04)).abs() < 1e-9, "shown as a diameter");
    assert_eq!((value(&mut rig, param::DRESSING_COUNT), value(&mut rig, param::PARTS_SINCE_DRESSING)), (1.0, 0.0));
    let variable = |rig: &mut HeadlessHost, number: usize| rig.snapshot().variables[number];
    assert!((variable(&mut rig, 100).unwrap() - (before - 0.04)).abs() < 1e-9);
    assert_eq!(variable(&mut rig, 101), Some(1.0));
}

#[test]
fn k4_2_a_program_reads_the_dressing_points_and_null_where_none_is_set() {
    let text =
        "T0101\n#200=7\n#201=#5811\nIF[[#5812 EQ #0]AND[#5813 EQ #0]]THEN #200=1\n#5801=#5801-0.04\n#202=#5811\nM30";
    let mut rig = ready_with(text);
    tell(&mut rig, "mode jog\npage position\nkey f1\nkey address-x\nkey input\nexpect message \"成功\"");
    let point = rig.snapshot().dressing_point[Axis::X].unwrap();
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until idle max 60 s\nexpect no alarm\nexpect #200 1");
    let variable = |rig: &mut HeadlessHost, number: usize| rig.snapshot().variables[number].unwrap();
    assert!((variable(&mut rig, 201) - point).abs() < 1e-9, "as displayed: a diameter");
    assert!((variable(&mut rig, 202) - (point - 0.04)).abs() < 1e-9, "it follows a dressing");
    // A program cannot write it.
    alarmed("#5811=5\nM30", 25);
}

/// #5811 to #5813 are X, Y and Z on every machine: an axis that is fitted later does not move them.
#[test]
fn k4_2_the_dressing_point_of_z_is_5813_with_and_without_y() {
    for fitted in [0, 1] {
        let mut rig = ready_with("#200=7\nIF[#5812 EQ #0]THEN #200=1\n#201=#5813\nM30");
        tell(&mut rig, &format!("param P6.6 {fitted}\nmode jog\npage position\nkey f1\nkey address-z\nkey input"));
        let point = rig.snapshot().dressing_point[Axis::Z].unwrap();
        tell(&mut rig, "mode auto\nkey cycle-start\nwait until idle max 60 s\nexpect no alarm\nexpect #200 1");
        assert!((rig.snapshot().variables[201].unwrap() - point).abs() < 1e-9, "P6.6={fitted}");
        // A check, which has no machine, reads the same.
        let (params, points) = (&rig.snapshot().params, PerAxis::from_fn(|axis| (axis == Axis::Z).then_some(-60.0)));
        let stored: Vec<_> = stored_system_variables(params, points).filter(|(number, _)| *number > 5_810).collect();
        assert_eq!(stored, [(5_811, None), (5_812, None), (5_813, Some(-60.0))]);
    }
}

#[test]
fn k4_2_the_dressing_point_stays_or_goes_the_other_way_by_p98() {
    for (side, factor) in [(0, 0.0), (1, 1.0)] {
        let mut rig = ready_with("T0101\n#5801=#5801-0.04\nM30");
        tell(&mut rig, &format!("param P98 {side}\nmode jog\npage position\nkey f1\nkey address-x\nkey input"));
        let point = rig.snapshot().dressing_point[Axis::X].unwrap();
        tell(&mut rig, "mode auto\nkey cycle-start\nwait until idle max 60 s");
        assert!((rig.snapshot().dressing_point[Axis::X].unwrap() - (point + 0.04 * factor)).abs() < 1e-9);
    }
}

#[test]
fn k4_2_a_wheel_does_not_grow_and_needs_its_offset() {
    for text in
        ["T0101\n#5801=#5801+0.01\nG00 X-70\nM30", "T0101\n#5801=5\nG00 X-70\nM30", "#5801=#5801-0.04\nG00 X-70\nM30"]
    {
        let mut rig = alarmed(text, 203);
        tell(&mut rig, "expect X -80 ±0.001\nexpect wear 1 X 0 ±0");
        assert!((value(&mut rig, param::WHEEL_DIAMETER) - 600.0).abs() < 1e-9);
    }
}

#[test]
fn b2_constant_surface_speed_follows_the_wheel_through_its_dressings() {
    // 1 500 m/min on 600 mm: 1500 / (π·0.6) = 795.77 rpm; on 500 mm 954.93 rpm.
    let mut rig = ready_with("T0101\nG96 S1500 M03\nM00\n#5801=500\nM00\nG97 S600\nM00\nG50 S700\nG96 S1500\nM00\nM30");
    let rpm = |rig: &mut HeadlessHost, expected: f64| {
        tell(rig, "key cycle-start\nwait until stopped max 60 s");
        let rpm = rig.snapshot().wheel_rpm;
        assert!((rpm - expected).abs() < 0.01, "{rpm} rpm");
    };
    tell(&mut rig, "mode auto");
    for expected in [795.77, 954.93, 600.0, 700.0] {
        rpm(&mut rig, expected);
    }
}

#[test]
fn k5_17_parts_since_the_last_dressing_are_counted_and_its_time_is_said() {
    let mut rig = ready_with("M31\n#100=#5803\n#101=#5804\nM30");
    tell(&mut rig, "param P95 2\nmode auto\nkey cycle-start\nwait until idle\nexpect #100 1 ±0\nexpect #101 2 ±0");
    tell(&mut rig, "key cycle-start\nwait until idle\nexpect message \"应修整\"\nexpect #100 2 ±0");
}

#[test]
fn b3_an_output_by_its_number_obeys_the_rule_of_m21() {
    let mut rig = ran("#1139=1\nG04 X0.1\n#100=#1139\n#1139=0\nG04 X0.1\n#101=#1139\nM30");
    tell(&mut rig, "expect #100 1 ±0\nexpect #101 0 ±0");
    // Port 1 is the wheel's (P300).
    let mut owned = alarmed("#1100=1\nG00 X-70\nM30", 195);
    tell(&mut owned, "expect output wheel off\nexpect X -80 ±0.001");
}

#[test]
fn b3_timers_are_set_and_the_wanted_parts_written() {
    let mut rig = ran("#3001=0\n#3902=12\nG04 X2\n#100=#3001\n#101=#3902\nM30");
    tell(&mut rig, "expect #101 12 ±0");
    let waited = rig.snapshot().variables[100].unwrap();
    assert!((2_000.0..2_100.0).contains(&waited), "2 s and the ticks around it: {waited} ms");
}

#[test]
fn b3_date_and_time_of_day_are_read_by_a_program() {
    // 2026-11-24 09:05:07
    let date = DateTime::from_parts([2026, 11, 24, 9, 5, 7]).unwrap();
    let mut rig = ready_with("G04 P100\n#100=#3011\n#101=#3012\nM30");
    rig.send(Command::WallClock(date));
    tell(
        &mut rig,
        "mode auto\nkey cycle-start\nwait until idle max 2 s\nexpect #100 20261124 ±0\nexpect #101 90507 ±0",
    );
}

#[test]
fn b3_a_program_runs_through_single_blocks_with_3003_but_no_further_than_its_end() {
    let mut rig = ready_with("#3003=1\n#100=1\nG04 P50\n#100=2\n#3003=0\n#100=3\n#100=4\nM30");
    tell(&mut rig, "key single-block\nmode auto\nkey cycle-start\nwait until stopped max 2 s\nexpect #100 2");
    tell(&mut rig, "key cycle-start\nwait until stopped max 2 s\nexpect #100 3");
    // RESET ends it too.
    let mut rig = ready_with("#100=0\n#3003=1\n#100=1\nG04 X60\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.5 s\nkey reset\nwait until idle\nkey single-block");
    tell(&mut rig, "key cycle-start\nwait until stopped max 2 s\nexpect #100 0");
}

#[test]
fn b3_feed_hold_and_override_act_whatever_3004_says() {
    let mut rig = ready_with("#3004=7\nG98 G01 U-20 F100\n#100=#3004\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 1 s\nkey feed-hold\nwait until held max 1 s\nkey cycle-start");
    tell(&mut rig, "wait until idle max 20 s\nexpect #100 7");
}

#[test]
fn b3_printed_lines_are_added_to_the_file_of_the_day() {
    let folder = tempfile::tempdir().unwrap();
    let text = "#100=25.0123\nPOPEN\nDPRNT[SIZE*#100[33]]\n#100=-3.5\nDPRNT[Z#100[53]]\nPCLOS\nM30";
    let mut rig = ready_with(text);
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until idle max 5 s\nexpect no alarm");
    assert_eq!(rig.take_printed(), ["SIZE   25.012", "Z-    3.500"], "and the report names them");
    let mut rig = ready_with(text);
    rig.set_drives(Some(folder.path().join("prints")), None);
    for (day, lines) in [(24, 2), (24, 4), (25, 2)] {
        rig.send(Command::WallClock(DateTime::from_parts([2026, 11, day, 9, 5, 7]).unwrap()));
        tell(&mut rig, "mode auto\nkey cycle-start\nwait until idle max 5 s\nexpect no alarm");
        let printed = std::fs::read_to_string(folder.path().join(format!("prints/DPRNT-202611{day}.TXT"))).unwrap();
        assert_eq!(printed, "SIZE   25.012\r\nZ-    3.500\r\n".repeat(lines / 2));
    }
    // A file in place of the folder: nothing is lost without a word.
    let mut rig = ready_with(text);
    std::fs::write(folder.path().join("taken"), "").unwrap();
    rig.set_drives(Some(folder.path().join("taken")), None);
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 1 s\nexpect alarm any");
}

#[test]
fn b3_what_is_no_variable_is_named() {
    for text in ["#3003=9", "#4001=1", "#5041=1", "#2017=1", "#1000=1"] {
        let mut rig = ready_with(&format!("{text}\nM30"));
        tell(&mut rig, "mode auto\nkey cycle-start\nwait until alarm max 2 s\nexpect alarm any");
    }
}

#[test]
fn k4_1_a_wear_beyond_the_range_of_the_offset_page_is_refused_from_a_program_too() {
    for text in ["G10 D1 U1000\nG00 X-70\nM30", "#2001=-1000\nG00 X-70\nM30"] {
        let mut rig = alarmed(text, 204);
        tell(&mut rig, "expect X -80 ±0.001\nexpect wear 1 X 0 ±0");
    }
    tell(&mut ran("G10 D1 U999.999\nM30"), "expect wear 1 X 999.999 ±0.0001");
}
