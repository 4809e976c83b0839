//! Chamfers, roundings and angles of lines: `,C` `,R` `,A`, and CHR, CHF, RND, RNDM, ANG of the 802D (rows B2, S1).
//!
//! Z is to the right, X up; points are written as (z, x) in radius millimetres.

use std::fmt::Write;
use std::sync::Arc;

use kt830::defs::kind::Dialect;
use kt830::nc::{
    Block, CommonVariables, CutterShape, EmptyLibrary, Interpreter, NcSettings, NextStatus, OfflineMachine, Op,
    ProgramFault, Source, WorkOffsets, check,
};
use kt830::units::{PerAxis, WorkBudget};
use proptest::prelude::*;

use crate::running::{Move, assert_moves, moves, run_in};

fn settings(dialect: Dialect) -> NcSettings {
    NcSettings { diameter: false, ..NcSettings::for_dialect(dialect) }
}

/// The operations of a text, each with the line of its block.
fn operations(text: &str, dialect: Dialect) -> Result<Vec<(u32, Op)>, ProgramFault> {
    let settings = settings(dialect);
    let mut offsets = WorkOffsets::default();
    offsets.cutter[0] = CutterShape { radius_mm: 1.0, tip: 0 };
    let mut world = OfflineMachine::new(&settings).with_work_offsets(offsets);
    Ok(run_in(&mut world, text, &settings)?.0)
}

fn expect(text: &str, dialect: Dialect, wanted: &[Move]) {
    let ops = operations(text, dialect).unwrap_or_else(|fault| panic!("{text}\n{fault}"));
    assert_moves(&moves(&ops), wanted, text);
}

fn refused(text: &str, dialect: Dialect) -> (&'static str, u32) {
    let fault = operations(text, dialect).err().unwrap_or_else(|| panic!("accepted: {text}"));
    (fault.error.id(), fault.location.line)
}

/// A block along `a`, then one along `b`, both from (20, 20).
fn two_lines(a: [f64; 2], corner: &str, b: [f64; 2]) -> String {
    let [z, x] = [20.0 + a[0], 20.0 + a[1]];
    format!("G00 X20. Z20.\nG01 X{x:.4} Z{z:.4} F100{corner}\nX{:.4} Z{:.4}\nM30\n", x + b[1], z + b[0])
}

#[test]
fn b2_a_right_angle_in_every_quadrant_has_a_chamfer_and_a_rounding() {
    // The legs and the radius are 2: both begin 2 before the corner and end 2 behind it; the centre is beside both.
    for along in [[10.0, 0.0], [0.0, 10.0], [-10.0, 0.0], [0.0, -10.0]] {
        for side in [1.0, -1.0] {
            let behind = [-along[1] * side / 2.0, along[0] * side / 2.0];
            let point = |a: f64, b: f64| [20.0 + along[0] * a + behind[0] * b, 20.0 + along[1] * a + behind[1] * b];
            let (start, end) = ((1, [20.0, 20.0], None), (3, point(1.0, 1.0), None));
            let chamfer = [start, (2, point(0.8, 0.0), None), (2, point(1.0, 0.4), None), end];
            expect(&two_lines(along, ",C2.", behind), Dialect::LatheA, &chamfer);
            let round = [start, (2, point(0.8, 0.0), None), (2, point(1.0, 0.4), Some(point(0.8, 0.4))), end];
            expect(&two_lines(along, " ,R2.", behind), Dialect::LatheA, &round);
        }
    }
}

#[test]
fn b2_corners_beside_arcs_are_rounded() {
    // Up to (20, 30), then a quarter to (25, 35) around (25, 30): the line is tangent, there is no corner.
    expect(
        "G00 X20. Z20.\nG01 X30. F100 ,R1.\nG02 X35. Z25. I0 K5.\nM30\n",
        Dialect::LatheA,
        &[(1, [20.0, 20.0], None), (2, [20.0, 30.0], None), (3, [25.0, 35.0], Some([25.0, 30.0]))],
    );
    // Up to (20, 30), then an arc of 5 around (20, 35), to the right and up: the rounding of 1 lies right of the line and
    // outside of the arc, its centre at (21, 35 − √35).
    let up = 35.0 - 35_f64.sqrt();
    let touch = [20.0 + 5.0 / 6.0, 35.0 - 35_f64.sqrt() * 5.0 / 6.0];
    expect(
        "G00 X20. Z20.\nG01 X30. F100 ,R1.\nG03 X35. Z25. I5. K0\nM30\n",
        Dialect::LatheA,
        &[
            (1, [20.0, 20.0], None),
            (2, [20.0, up], None),
            (2, touch, Some([21.0, up])),
            (3, [25.0, 35.0], Some([20.0, 35.0])),
        ],
    );
    assert_eq!(
        refused("G00 X20. Z20.\nG01 X30. F100 ,C1.\nG03 X35. Z25. I5. K0\nM30\n", Dialect::LatheA),
        ("chamfer-at-arc", 2)
    );
}

#[test]
fn b2_corners_follow_each_other_and_use_up_the_line_between_them() {
    let text = |leg: &str| format!("G00 X0 Z0\nG01 Z10. F100 ,R2.\nX5. ,C{leg}\nZ20.\nM30\n");
    expect(
        &text("3."),
        Dialect::LatheA,
        &[
            (1, [0.0, 0.0], None),
            (2, [8.0, 0.0], None),
            (2, [10.0, 2.0], Some([8.0, 2.0])),
            (3, [10.0, 2.0], None),
            (3, [13.0, 5.0], None),
            (4, [20.0, 5.0], None),
        ],
    );
    // 5 − 2 of the rounding leaves 3.
    assert_eq!(refused(&text("3.1"), Dialect::LatheA), ("corner-does-not-fit", 3));
}

#[test]
fn b2_the_angle_of_a_line_gives_its_other_coordinate() {
    for (text, end) in [
        ("X30. ,A45.", [30.0, 30.0]),
        ("X30. ,A135.", [10.0, 30.0]),
        ("X10. ,A225.", [10.0, 10.0]),
        ("Z10. ,A135.", [10.0, 30.0]),
        ("U10. ,A90.", [20.0, 30.0]),
        // tan 30° = 1/√3
        ("Z30. ,A30.", [30.0, 20.0 + 10.0 / 3_f64.sqrt()]),
    ] {
        let program = format!("G00 X20. Z20.\nG01 {text} F100\nM30\n");
        expect(&program, Dialect::LatheA, &[(1, [20.0, 20.0], None), (2, end, None)]);
    }
    for (text, name) in [
        ("X30. ,A0", "out-of-range"),
        ("Z30. ,A90.", "out-of-range"),
        ("X30. ,A400.", "out-of-range"),
        // The other way along the same line.
        ("Z10. ,A-45.", "angle-away"),
        ("X30. ,A-135.", "angle-away"),
        ("X30. Z30. ,A45.", "angle-with-end"),
    ] {
        let program = format!("G00 X20. Z20.\nG01 {text} F100\nZ0\nM30\n");
        assert_eq!(refused(&program, Dialect::LatheA), (name, 2), "{text}");
    }
}

#[test]
fn b2_two_lines_of_known_angles_meet() {
    // From (0, 0) up at 45°, then level at X4 to Z20: they meet at (4, 4).
    let text = |corner: &str| format!("G00 X0 Z0\nG01 ,A45. F100{corner}\nX4. Z20. ,A0\nM30\n");
    expect(&text(""), Dialect::LatheA, &[(1, [0.0, 0.0], None), (2, [4.0, 4.0], None), (3, [20.0, 4.0], None)]);
    // A rounding of 1 at an angle of 135° between the lines: the tangents are tan 22.5° = √2 − 1 long.
    let tangent = 2_f64.sqrt() - 1.0;
    let start = 4.0 - tangent / 2_f64.sqrt();
    expect(
        &text(" ,R1."),
        Dialect::LatheA,
        &[
            (1, [0.0, 0.0], None),
            (2, [start, start], None),
            (2, [4.0 + tangent, 4.0], Some([4.0 + tangent, 3.0])),
            (3, [20.0, 4.0], None),
        ],
    );
    for (text, name) in [
        ("G01 ,A45. F100\nX4. Z20.\nM30\n", "angle-without-end"),
        ("G01 ,A45. F100\nG00 X4. Z20.\nM30\n", "angle-without-end"),
        ("G01 ,A45. F100\nM30\n", "angle-without-end"),
        ("G01 ,A45. F100\nX4. Z20. ,A225.\nM30\n", "lines-parallel"),
        ("G01 ,A45. F100\nX4. Z20. ,A180.\nM30\n", "angle-away"),
        ("G01 ,A225. F100\nX4. Z20. ,A0\nM30\n", "angle-away"),
        ("G01 ,A45. F100 ,R1.\nG55 X4. Z20. ,A0\nM30\n", "angle-without-end"),
    ] {
        assert_eq!(refused(&format!("G00 X0 Z0\n{text}"), Dialect::LatheA), (name, 2), "{text}");
    }
}

#[test]
fn b2_a_corner_needs_a_move_behind_it() {
    let text = |between: &str| format!("G00 X0 Z0\nG01 Z10. F100 ,R2.\n{between}M30\n");
    for between in [
        "",
        "G00 X5.\n",
        "G28 U0\n",
        "G04 P10\nM08\nM09\nM08\nX5.\n",
        "G31 X5.\n",
        "#100=#5041\nX5.\n",
        "M00\n",
        "G01 Z10.\n",
        // What changes where a coordinate is.
        "G55\nX5.\n",
        "G55 X5.\n",
        "G52 X1.\nX5.\n",
        "G50 Z0\nX5.\n",
        "T0202\nX5.\n",
        "T0202 X5.\n",
        "G10 L2 P1 Z-90.\nX5.\n",
        "#5222=-90.\nX5.\n",
        "#2001=1.\nX5.\n",
        "M00\nX5.\n",
        "G35 Z5. Q10\nX5.\n",
    ] {
        assert_eq!(refused(&text(between), Dialect::LatheA), ("corner-without-move", 2), "{between}");
    }
    // Comments, values and three blocks without a move may stand between.
    for between in ["(CORNER)\n\n#100=5\nM08\nF50\nX#100\n", "G04 P10\nM08\nM09\nX5.\n", "IF[1 EQ 1]GOTO 5\nN5 X5.\n"] {
        let found = moves(&operations(&text(between), Dialect::LatheA).unwrap());
        assert_eq!(found.iter().filter(|(line, ..)| *line == 2).count(), 2, "{between}");
    }
    let before_angle = "G00 X0 Z0\nG01 Z10. F100 ,R2.\n,A90.\nX5. Z20. ,A0\nM30\n";
    assert_eq!(refused(before_angle, Dialect::LatheA), ("corner-before-angle", 2));
    let named = operations("G00 X0 Z0\nG01 Z10. F100 ,R2. ,R1.\nX5.\nM30\n", Dialect::LatheA).unwrap_err();
    assert!(named.to_string().contains("',R' appears twice"), "{named}");
    let named = operations("G00 X0 Z0\nG00 Z10. ,R2.\nM30\n", Dialect::LatheA).unwrap_err();
    assert!(named.to_string().contains("unknown word ',R2.'"), "{named}");
    assert_eq!(refused("G00 X0 Z0\nG01 Z10. F100 ,R2. ,C1.\nX5.\nM30\n", Dialect::LatheA), ("not-together", 2));
    assert_eq!(refused("G00 X0 Z0\nG01 Z10. F100 ,R-2.\nX5.\nM30\n", Dialect::LatheA), ("out-of-range", 2));
    assert_eq!(refused("G00 X0 Z0\nG00 Z10. ,R2.\nG01 X5. F100\nM30\n", Dialect::LatheA), ("unknown-word", 2));
    assert_eq!(refused("G00 X0 Z0\nG01 Z10. F100 ,B2.\nX5.\nM30\n", Dialect::LatheA), ("unexpected-character", 2));
    // The corner before it leaves nothing of the line: it is that line which is too short.
    assert_eq!(
        refused("G00 X0 Z0\nG01 Z10. F100 ,R2.\nX2. ,R2.\nZ20.\nM30\n", Dialect::LatheA),
        ("corner-does-not-fit", 3)
    );
    // Turning back has no corner, 0 none either.
    assert_eq!(refused("G00 X0 Z0\nG01 Z10. F100 ,R2.\nZ0\nM30\n", Dialect::LatheA), ("corner-does-not-fit", 2));
    expect(
        "G00 X0 Z0\nG01 Z10. F100 ,R0\nZ0\nM30\n",
        Dialect::LatheA,
        &[(1, [0.0, 0.0], None), (2, [10.0, 0.0], None), (3, [0.0, 0.0], None)],
    );
}

#[test]
fn b2_the_order_of_the_operations_is_that_of_the_program() {
    let ops = operations("G00 X0 Z0\nG01 Z10. F100 ,C2. M08\nG04 P10\nX5. S500 M09\nM30\n", Dialect::LatheA).unwrap();
    let names: Vec<_> =
        ops.iter().map(|(line, op)| format!("{line} {}", op.to_string().split(' ').next().unwrap())).collect();
    assert_eq!(names, ["1 rapid", "2 m", "2 feed", "2 feed", "3 dwell", "4 s", "4 feed", "4 m", "5 m"]);
}

#[test]
fn b2_corners_of_a_compensated_contour_are_offset() {
    // The centre runs on the inner side of the corner: the rounding of 2 becomes one of 1 around the same centre.
    expect(
        "G00 X5. Z0\nG41 D1 G01 X0 Z0 F100\nZ10. ,R2.\nX5.\nG40 X10. Z5.\nM30\n",
        Dialect::LatheA,
        &[
            (1, [0.0, 5.0], None),
            (2, [0.0, 1.0], None),
            (3, [8.0, 1.0], None),
            (3, [9.0, 2.0], Some([8.0, 2.0])),
            (4, [9.0, 5.0], None),
            (5, [5.0, 10.0], None),
        ],
    );
}

#[test]
fn b2_corners_of_a_roughed_contour_are_in_its_finishing_pass() {
    let text = "G00 X30. Z2.\nG71 U5. R1.\nG71 P10 Q20 U0 W0 F100\nN10 G00 X10.\nG01 Z-10. F50 ,R2.\nN20 X30.\n\
                G70 P10 Q20\nM30\n";
    let found = moves(&operations(text, Dialect::LatheA).unwrap());
    let last: Vec<_> = found.iter().filter(|(line, ..)| *line == 7).map(|(_, to, centre)| (*to, *centre)).collect();
    assert_eq!(
        last,
        [
            ([2.0, 10.0], None),
            ([-8.0, 10.0], None),
            ([-10.0, 12.0], Some([-8.0, 12.0])),
            ([-10.0, 30.0], None),
            ([-10.0, 30.0], None),
            ([2.0, 30.0], None),
        ]
    );
    // A stroke at X15 ends at the face, one at X10.5 in the rounding.
    let strokes =
        "G00 X12. Z2.\nG71 U1. R0.5\nG71 P10 Q20 U0 W0 F100\nN10 G00 X10.\nG01 Z-10. F50 ,R2.\nN20 X12.\nM30\n";
    let found = moves(&operations(strokes, Dialect::LatheA).unwrap());
    // X11 is 1 below the centre at X12: the rounding is at Z −8 − √3.
    assert!((found[2].1[0] - (-8.0 - 3_f64.sqrt())).abs() < 1e-6, "{found:?}");
    let open = "G00 X30. Z2.\nG70 P10 Q20\nN10 G00 X10.\nN20 G01 Z-10. F50 ,R2.\nM30\n";
    assert_eq!(refused(open, Dialect::LatheA).0, "corner-without-move");
}

#[test]
fn s1_the_words_of_the_802d() {
    let head = "G0 X0 Z0\n";
    // CHR: legs; CHF: the chamfer itself, here 2√2 long with legs of 2; RND: a radius.
    for (word, centre) in [("CHR=2", None), ("CHF=2.8284271247461903", None), ("RND=2", Some([8.0, 2.0]))] {
        expect(
            &format!("{head}G1 Z10 F100 {word}\nX5\nM2\n"),
            Dialect::Sinumerik,
            &[(1, [0.0, 0.0], None), (2, [8.0, 0.0], None), (2, [10.0, 2.0], centre), (3, [5.0, 5.0], None)]
                .map(|(line, to, centre): Move| if line == 3 { (3, [10.0, 5.0], centre) } else { (line, to, centre) }),
        );
    }
    // RNDM rounds every corner where it fits until RNDM=0; CHR and RND=0 of a block come before it.
    expect(
        &format!("{head}G1 Z10 F100 RNDM=1\nX5\nZ20 CHR=2\nX9 RND=0\nZ19.5\nX0 RNDM=0\nZ0\nM2\n"),
        Dialect::Sinumerik,
        &[
            (1, [0.0, 0.0], None),
            (2, [9.0, 0.0], None),
            (2, [10.0, 1.0], Some([9.0, 1.0])),
            (3, [10.0, 4.0], None),
            (3, [11.0, 5.0], Some([11.0, 4.0])),
            (4, [18.0, 5.0], None),
            (4, [20.0, 7.0], None),
            (5, [20.0, 9.0], None),
            // 0.5 is too short for a radius of 1: the corner stays.
            (6, [19.5, 9.0], None),
            (7, [19.5, 0.0], None),
            (8, [0.0, 0.0], None),
        ],
    );
    // No move behind, or one at rapid: the corner stays, too.
    for end in [
        "G0 X5\nM2\n",
        "TRANS Z-10\nX5\nM2\n",
        "G55 X5\nM2\n",
        "ANG=45\nX5 Z20 ANG=0\nM2\n",
        "M2\n",
        "STOPRE\nX5\nM2\n",
        "R1=$AA_IW[X]\nX5\nM2\n",
    ] {
        let found = moves(&operations(&format!("{head}G1 Z10 F100 RNDM=1\n{end}"), Dialect::Sinumerik).unwrap());
        assert_eq!(found[1].1.map(f64::to_bits), [10.0_f64, 0.0].map(f64::to_bits), "{end}");
    }
    expect(
        &format!("{head}G1 ANG=45 F100\nX4 Z20 ANG=0\nM2\n"),
        Dialect::Sinumerik,
        &[(1, [0.0, 0.0], None), (2, [4.0, 4.0], None), (3, [20.0, 4.0], None)],
    );
    assert_eq!(refused("G1 Z10 F100 RND=-1\nX5\nM2\n", Dialect::Sinumerik), ("out-of-range", 1));
    assert_eq!(refused("SPOS=0\nM2\n", Dialect::Sinumerik), ("no-spindle-position", 1));
}

#[test]
fn k6_3_a_block_that_waits_at_its_corner_keeps_what_was_moved_by_hand() {
    let settings = settings(Dialect::LatheA);
    let (mut world, mut block) = (OfflineMachine::new(&settings), Block::new(&settings));
    let text = "G01 Z10. F100 ,R2.\nX5.\nZ20.\nM30\n";
    let source = Arc::new(Source::new(1001, "O1001.NC", text, Dialect::LatheA));
    let mut interpreter = Interpreter::new(source, Arc::new(EmptyLibrary), settings, CommonVariables::default());
    let read = interpreter.next_within(&mut world, &mut block, &mut WorkBudget::new(1));
    assert!(matches!(read, Ok(NextStatus::Busy)) && interpreter.is_in_corner());
    // 1 in X, which the block does not name, and 3 in Z, to which it goes: it ends at X1 before the corner.
    interpreter.shift_by_hand(PerAxis([1.0, 0.0, 3.0]));
    let mut ops = Vec::new();
    while interpreter.next(&mut world, &mut block).unwrap() == NextStatus::Block {
        ops.extend(block.ops.iter().map(|op| (block.location.line, op.clone())));
        block.ops.iter().for_each(|op| world.apply(op));
    }
    let ends: Vec<_> = moves(&ops).into_iter().map(|(_, end, _)| end).collect();
    assert_eq!(ends, [[8.0, 1.0], [10.0, 3.0], [10.0, 5.0], [20.0, 5.0]]);
}

#[test]
fn b1_a_check_reads_on_behind_a_corner_that_is_refused() {
    let settings = settings(Dialect::LatheA);
    let text = "G00 X0 Z0\nG01 Z10. F100 ,R2.\nG00 X5.\nG01 Z20. ,R1. Q5\nG77\nG01 X7. ,C1.\nM30\n";
    let source = Arc::new(Source::new(1001, "O1001.NC", text, Dialect::LatheA));
    let report = check(&source, &(Arc::new(EmptyLibrary) as _), &settings);
    let found: Vec<_> = report.faults.iter().map(|fault| (fault.location.line, fault.error.id())).collect();
    assert_eq!(
        found,
        [(2, "corner-without-move"), (4, "unknown-word"), (5, "cycle-by-table"), (6, "corner-without-move")]
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    /// A chain of lines, each corner rounded: every rounding that fits is tangent to both lines and has its radius; the
    /// path goes on without a gap; the lines lie on the programmed ones.
    #[test]
    fn b2_roundings_of_random_contours_are_tangent(
        turns in prop::collection::vec((10.0..60.0_f64, -150.0..150.0_f64, 0.05..8.0_f64), 2..12),
    ) {
        let (mut at, mut direction) = ([100.0, 100.0], 0.0_f64);
        let (mut corners, mut text) = (vec![at], String::from("G00 X100. Z100.\nG64\n"));
        for (length, turn, radius) in &turns {
            direction += turn;
            let (sin, cos) = direction.to_radians().sin_cos();
            at = [at[0] + length * cos, at[1] + length * sin];
            let _ = writeln!(text, "G01 X{:.9} Z{:.9} F100 ,R{radius:.9}", at[1], at[0]);
            corners.push(at);
        }
        let _ = writeln!(text, "G01 X{:.9} Z{:.9}\nM30", at[1] + 70.0, at[0]);
        match operations(&text, Dialect::LatheA) {
            Err(fault) => prop_assert_eq!(fault.error.id(), "corner-does-not-fit"),
            Ok(ops) => {
                let path = moves(&ops);
                for pair in path.windows(3) {
                    let [(_, from, _), (line, to, Some(centre)), (_, next, _)] = pair else { continue };
                    let radius = turns[*line as usize - 3].2;
                    let corner = corners[*line as usize - 2];
                    let length = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
                    prop_assert!((length(*centre, *from) - radius).abs() < 1e-6);
                    prop_assert!((length(*centre, *to) - radius).abs() < 1e-6);
                    // The tangents from the corner are as long, and square to the radii.
                    let (a, b) = (length(corner, *from), length(corner, *to));
                    prop_assert!((a - b).abs() < 1e-6 && (a.hypot(radius) - length(corner, *centre)).abs() < 1e-6);
                    // What follows leaves along the line to the next corner.
                    let cross = (next[0] - to[0]) * (to[1] - corner[1]) - (next[1] - to[1]) * (to[0] - corner[0]);
                    prop_assert!(cross.abs() < 1e-6 * (1.0 + length(*next, *to)));
                }
            }
        }
    }
}
