//! G70 to G75 around their contours: what a contour may hold, where the program goes on, the way back (row B2).
//!
//! Points are written as (z, x) in radius millimetres.

use kt830::defs::kind::Dialect;
use kt830::nc::{NcSettings, OfflineMachine, Op, OpEffect, OpMotion};
use kt830::units::Axis;

use crate::running::run_in;
use crate::unexecuted::{check_with, faults};

/// The moves of a text: line, rapid or not, and end; and the operations with their lines.
struct Course {
    moves: Vec<(u32, bool, [f64; 2])>,
    ops: Vec<(u32, Op)>,
}

/// Runs a text in which X is a radius.
fn run(text: &str) -> Course {
    let settings = NcSettings { diameter: false, ..NcSettings::for_dialect(Dialect::LatheA) };
    let (ops, _) =
        run_in(&mut OfflineMachine::new(&settings), text, &settings).unwrap_or_else(|fault| panic!("{text}\n{fault}"));
    let one = |(line, op): &(u32, Op)| match op.effect() {
        OpEffect::Motion(OpMotion::Work(by)) => Some((*line, by.rapid, [by.to[Axis::Z], by.to[Axis::X]])),
        _ => None,
    };
    Course { moves: ops.iter().filter_map(one).collect(), ops }
}

/// Line and name of the first mistake.
fn refused(text: &str) -> (u32, &'static str) {
    let report = check_with(text, &[]);
    let (_, line, name) = *faults(&report).first().unwrap_or_else(|| panic!("accepted: {text}"));
    (line, name)
}

/// A shaft, roughed; `inside` stands in its contour.
fn contour_with(inside: &str) -> String {
    format!(
        "G00 X50. Z2.\nG71 U5. R1.\nG71 P10 Q20 U0 W0 F100\nN10 G00 X20.\nG01 Z-10.\n{inside}\nN20 X52.\nG00 X60.\nM30\n"
    )
}

/// `N10 G00 X_ W0` with an allowance in W puts the contour's beginning before the start: its strokes were left out, and
/// the pass along the contour cut all at once.
#[test]
fn b2_an_allowance_towards_the_start_leaves_out_no_stroke() {
    let course = run(
        "G00 X25. Z2.\nG71 U5.01 R1.\nG71 P10 Q20 U0 W0.1 F100\nN10 G00 X15. W0\nG01 X3. Z-20.\nZ-30.\nN20 X26.\nM30\n",
    );
    // Levels of 5.01 from X25 on; below X15 the contour begins at the start, and the infeed is no longer through air.
    for (level, rapid) in [(19.99, true), (14.98, false), (9.97, false), (4.96, false)] {
        let found = course.moves.iter().find(|(line, _, [_, x])| *line == 3 && (x - level).abs() < 1e-9);
        assert_eq!(found.map(|(_, rapid, _)| *rapid), Some(rapid), "{level}: {:?}", course.moves);
    }
    // A groove whose wall stands at the start: no stroke at all before.
    let groove = run(
        "G00 X25. Z-10.\nG71 U2. R0.5\nG71 P10 Q20 U0 W0.1 F100\nN10 G00 X25. W0\nG01 X15.\nZ-30.\nN20 X25.\nM30\n",
    );
    let infeeds: Vec<_> =
        groove.moves.iter().filter(|(line, _, [z, _])| *line == 3 && (z + 10.0).abs() < 1e-9).collect();
    for level in [23.0, 21.0, 19.0, 17.0] {
        let found = infeeds.iter().find(|(_, _, [_, x])| (x - level).abs() < 1e-9);
        assert_eq!(found.map(|(_, rapid, _)| *rapid), Some(false), "at feed along the wall to {level}: {infeeds:?}");
    }
}

/// G70 came back along Z at the height of the last block, through the shoulder; on a face along X, through the rib.
#[test]
fn b2_finishing_comes_back_across_the_contour_first() {
    let shoulder = "G00 X25. Z2.\nG71 U4. R1.\nG71 P10 Q20 U0 W0 F100\nN10 G00 X25. W-2.\nG01 X15. Z-10.\nZ-20.\nX24. Z-30.\nZ-40.\nN20 X15. Z-50.\nG70 P10 Q20\nM30\n";
    let rib = "G00 X30. Z2.\nG72 W4. R1.\nG72 P10 Q20 U0 W0 F100\nN10 G00 X28. Z-10.\nG01 X20.\nX15. Z-1.\nX10.\nX5. Z-8.\nN20 X0\nG70 P10 Q20\nM30\n";
    let cone =
        "G00 X30. Z2.\nG72 W4. R1.\nG72 P10 Q20 U0 W0 F100\nN10 G00 X25. Z0\nN20 G01 X10. Z-30.\nG70 P10 Q20\nM30\n";
    for (text, line, back) in [
        (shoulder, 10, [[-50.0, 25.0], [2.0, 25.0]]),
        (rib, 10, [[2.0, 0.0], [2.0, 30.0]]),
        // Both axes run one way: the infeed axis of its roughing decides.
        (cone, 6, [[2.0, 10.0], [2.0, 30.0]]),
    ] {
        let moves = run(text).moves;
        let of_cycle: Vec<_> = moves.iter().filter(|(of, ..)| *of == line).collect();
        let found: Vec<_> = of_cycle[of_cycle.len() - 2..].iter().map(|(_, rapid, to)| (*rapid, *to)).collect();
        assert_eq!(found, back.map(|to| (true, to)), "{text}");
    }
    // From a start below a part of the contour there is no way back.
    let below = "G00 X22. Z2.\nN10 G00 X15.\nG01 Z-10. F100\nX24. Z-15.\nX20. Z-30.\nN20 Z-40.\nG00 X30.\nZ2.\nX22.\nG70 P10 Q20\nM30\n";
    assert_eq!(refused(below), (10, "contour-return"));
}

/// A call was read as if its blocks were the contour's; an N20 in the program that it called ended the contour, and the
/// program went on in that program's line.
#[test]
fn b2_a_contour_has_no_calls_no_jumps_and_no_other_cycles() {
    let called = [(7007, "G01 X30.\nN20 Z-30.\nM99\n".to_owned())];
    for inside in ["M98 P7007", "G65 P7007 A1.", "G66 P7007 A1."] {
        let report = check_with(&contour_with(inside), &called);
        assert_eq!(faults(&report).first(), Some(&(1001, 6, "contour-left")), "{inside}");
    }
    let modal = contour_with("Z-15.").replacen("G71 U5. R1.", "G66 P7007 A1.\nG71 U5. R1.", 1);
    let report = check_with(&modal, &called);
    assert!(faults(&report).iter().any(|(_, _, name)| *name == "contour-left"), "{:?}", faults(&report));
    assert_eq!(refused(&contour_with("M99")), (6, "contour-left"));
    assert_eq!(refused(&contour_with("IF[1 EQ 1]GOTO 30").replace("G00 X60.", "N30 G00 X60.")), (6, "contour-left"));
    for inside in ["G75 X10. Z-15. P3000 Q1000 F50", "G90 X45. Z-15.", "G94 X45. Z-15.", "G20", "G71 U3. R1.", "G28 U0"]
    {
        assert_eq!(refused(&contour_with(inside)), (6, "contour-code"), "{inside}");
    }
    let modal = contour_with("Z-15.").replacen("N10 G00 X20.", "N10 X20.", 1).replacen(
        "G00 X50. Z2.",
        "G00 X50. Z2.\nG90 X45. Z-10. F100",
        1,
    );
    assert_eq!(
        refused(&modal.replace("G01 Z-10.", "Z-10.")),
        (5, "turning-cycle-word"),
        "G71 has ended the words of G90"
    );
    // Feed, speed and jumps within it are the contour's own.
    for inside in ["G96 S30", "G01 X25. F50", "IF[1 EQ 1]GOTO 15\nX99.\nN15 X25.", "#1=5.\nX[20.+#1]"] {
        assert_eq!(faults(&check_with(&contour_with(inside), &[])), [], "{inside}");
    }
}

/// 1, and 20 in each reading of the contour, by G71 and by G70: 41; then X is 61.
#[test]
fn b2_what_a_contour_assigns_to_a_local_variable_holds_behind_it() {
    let course = run(
        "#2=1.\nG00 X50. Z2.\nG71 U20. R1.\nG71 P10 Q20 U0 W0 F100\nN10 G00 X20.\n#2=#2+20.\nN20 G01 Z-10.\nG70 P10 Q20\nG00 X[#2+20.]\nM30\n",
    );
    assert_eq!(course.moves.last().map(|(.., to)| *to), Some([2.0, 61.0]));
}

#[test]
fn b2_the_program_goes_on_behind_the_block_q() {
    // Q's block and another one in a line: Q is not run again.
    let course = run(
        "G00 X50. Z2.\nG71 U20. R1.\nG71 P10 Q20 U0 W0 F100\nN10 G00 X20.\nN15 G01 Z-10.\nN20 X52.; G00 X60.\nM30\n",
    );
    let behind: Vec<_> = course.moves.iter().filter(|(line, ..)| *line == 6).map(|(.., to)| *to).collect();
    assert_eq!(behind, [[2.0, 60.0]]);
    // Within a loop each pass roughs.
    let twice = run(
        "G00 X50. Z2.\n#1=1\nWHILE[#1 LE 2]DO1\nG71 U20. R1.\nG71 P10 Q20 U0 W0 F100\nN10 G00 X20.\nN20 G01 Z-10.\n#1=#1+1\nEND1\n#1=1\nWHILE[#1 LE 2]DO1\nG00 X[60.+#1]\n#1=#1+1\nEND1\nM30\n",
    );
    let roughed = twice
        .moves
        .iter()
        .filter(|(line, _, [z, x])| *line == 5 && (z + 10.0).abs().max((x - 20.0).abs()) < 1e-9)
        .count();
    let last = twice.moves.last().map(|(.., to)| *to);
    assert_eq!((roughed, last), (2, Some([2.0, 62.0])));
    // What would be skipped is named.
    let beside = "G00 X50. Z2.\nG71 U20. R1.\nG71 P10 Q20 U0 W0 F100; G00 X55.\nN10 G00 X20.\nN20 G01 Z-10.\nM30\n";
    assert_eq!(refused(beside), (3, "contour-apart"));
    assert_eq!(faults(&check_with(&beside.replace("G00 X55.", "ROUGHING"), &[])), []);
    for between in ["G70 P10 Q20\nM30", "#1=2", "GOTO 20", "M05"] {
        let text = format!(
            "G00 X50. Z2.\nG71 U20. R1.\nG71 P10 Q20 U0 W0 F100\n(ROUGHED)\nN5\n{between}\nN10 G00 X20.\nN20 G01 Z-10.\nM30\n"
        );
        assert_eq!(refused(&text), (6, "contour-apart"), "{between}");
    }
}

#[test]
fn b2_speed_and_path_mode_of_a_contour_act_from_its_finishing_pass_on() {
    let text = contour_with("G96 S30\nG61").replace("G00 X60.\n", "G70 P10 Q20\n#100=#4002\n#101=#4119\n");
    let course = run(&format!("G97 S100\n{text}"));
    let set = |variable: u32| {
        course.ops.iter().rev().find_map(|(_, op)| match op {
            Op::SetVariable { variable: of, value } if *of == variable => *value,
            _ => None,
        })
    };
    assert_eq!([set(100), set(101)], [Some(96.0), Some(30.0)]);
}

#[test]
fn b2_what_a_cycle_reads_is_checked() {
    // The corner is read by the cycle.
    let report = check_with(&contour_with("X30. ,R2.\nZ-20. ,C1."), &[]);
    let told: Vec<_> = report.warnings.iter().map(|fault| fault.error.id()).collect();
    assert_eq!((faults(&report), told.contains(&"contour-unread")), (vec![], false), "{told:?}");
    // 600 blocks: not a missing block N20.
    let points: String = (0..600).map(|step| format!("X{:.3}\n", 20.0 + f64::from(step) * 0.01)).collect();
    assert_eq!(refused(&contour_with(&points)), (3, "contour-too-long"));
    assert_eq!(refused(&contour_with("N15\nGOTO 15")), (3, "contour-too-long"));
}

/// The relief at the bottom is no further than what is cut beside it.
#[test]
fn b2_the_relief_of_a_groove_stays_in_what_is_cut() {
    assert_eq!(refused("G00 X50. Z2.\nG74 R1.\nG74 X40. Z-5. P2000 Q3000 R3. F50\nM30\n"), (3, "out-of-range"));
    assert_eq!(faults(&check_with("G00 X50. Z2.\nG74 R1.\nG74 X40. Z-5. P2000 Q3000 R2. F50\nM30\n", &[])), []);
}
