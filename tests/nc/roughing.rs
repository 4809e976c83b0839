//! G71 and G72 with pockets, FANUC's type II: hand-computed strokes, and random contours (row B2).
//!
//! Points are written as (z, x) in radius millimetres.

use std::fmt::Write;
use std::sync::Arc;

use kt830::defs::kind::Dialect;
use kt830::nc::{EmptyLibrary, NcSettings, OfflineMachine, Op, OpEffect, OpMotion, ProgramFault, Source};
use kt830::units::{Axis, WorkPos};
use proptest::prelude::*;

use crate::running::run_in;

/// A move of the cycle: rapid or at feed, and its end.
type Move = (bool, [f64; 2]);

/// The moves of the block on a line.
fn moves_of_line(text: &str, line: u32) -> Result<Vec<Move>, ProgramFault> {
    let settings = NcSettings { diameter: false, ..NcSettings::for_dialect(Dialect::LatheA) };
    let (ops, _) = run_in(&mut OfflineMachine::new(&settings), text, &settings)?;
    let at = |position: WorkPos| [position[Axis::Z], position[Axis::X]];
    let one = |op: &Op| match op.effect() {
        OpEffect::Motion(OpMotion::Work(by)) => Some((by.rapid, at(by.to))),
        _ => None,
    };
    Ok(ops.iter().filter(|(of, _)| *of == line).filter_map(|(_, op)| one(op)).collect())
}

/// `+` in front of rapid moves, then z and x.
fn shown(moves: &[Move]) -> Vec<String> {
    let round = |value: f64| (value * 1e6).round() / 1e6 + 0.0;
    moves
        .iter()
        .map(|(rapid, [z, x])| format!("{}{} {}", if *rapid { "+" } else { "" }, round(*z), round(*x)))
        .collect()
}

/// A groove from X20 to X10 between Z-10 and Z-30 with sides of 5 mm along Z.
const GROOVE: &str = "G00 X30. Z2.\nG71 U5. R1.\nG71 P10 Q20 U0 W0 F100\nN10 G00 X20. W0\nG01 Z-10. F50\nX10. Z-15.\nZ-25.\n\
                      X20. Z-30.\nN20 Z-40.\nM30\n";

#[test]
fn b2_a_groove_is_emptied_level_by_level() {
    assert_eq!(
        shown(&moves_of_line(GROOVE, 3).unwrap()),
        [
            // X25 and X20 are open all along.
            "+2 25",
            "-40 25",
            "-39 26",
            "+2 26",
            "+2 20",
            "-40 20",
            "-39 21",
            "+2 21",
            // X15 meets the sides half way, at Z-12.5 and Z-27.5; at X20 it is cut already, 1 mm above that it is rapid.
            "+2 30",
            "+-12.5 30",
            "+-12.5 21",
            "-12.5 15",
            "-27.5 15",
            "-26.5 16",
            "+-26.5 30",
            // X10 is the bottom: the pass along the contour.
            "+2 30",
            "+2 20",
            "-10 20",
            "-15 10",
            "-25 10",
            "-30 20",
            "-40 20",
            "+-40 30",
            "+2 30",
        ]
    );
}

#[test]
fn b2_two_pockets_are_emptied_one_after_the_other() {
    // Pockets of depth 10 below X20, square, Z-10 to -20 and Z-30 to -40; strokes of 4: X26, X22 open; X18, X14 in each.
    let text = "G00 X30. Z2.\nG71 U4. R1.\nG71 P10 Q20 U0 W0 F100\nN10 G00 X20. W0\nG01 Z-10. F50\nX10.\nZ-20.\nX20.\nZ-30.\n\
                X10.\nZ-40.\nX20.\nN20 Z-50.\nM30\n";
    let found = shown(&moves_of_line(text, 3).unwrap());
    assert_eq!(
        found[..36],
        [
            "+2 26", "-50 26", "-49 27", "+2 27", "+2 22", "-50 22", "-49 23", "+2 23", "+2 30", "+-10 30", "+-10 23",
            "-10 18", "-20 18", "-19 19", "+-19 30", "+-19 30", "+-10 30", "+-10 19", "-10 14", "-20 14", "-19 15",
            "+-19 30", "+-19 30", "+-30 30", "+-30 23", "-30 18", "-40 18", "-39 19", "+-39 30", "+-39 30", "+-30 30",
            "+-30 19", "-30 14", "-40 14", "-39 15", "+-39 30",
        ]
    );
}

#[test]
fn b2_an_arc_may_fall_and_rise() {
    // A hollow arc around (-20, 30) of radius 15 from (-8 …): from X20 at Z −20 ± √125 down to X15 at Z-20.
    let half = 125_f64.sqrt();
    let text = format!(
        "G00 X30. Z2.\nG71 U12. R0.5\nG71 P10 Q20 U0 W0 F100\nN10 G00 X20. W0\nG01 Z{:.9} F50\nG02 Z{:.9} I10. K-{half:.9}\n\
         N20 G01 Z-40.\nM30\n",
        -20.0 + half,
        -20.0 - half
    );
    let found = shown(&moves_of_line(&text, 3).unwrap());
    // The level X18 is 12 below the centre: at Z −20 ± √(225 − 144) = −11 and −29.
    assert_eq!(found[..7], ["+2 30", "+-11 30", "+-11 30", "-11 18", "-29 18", "-28.5 18.5", "+-28.5 30"]);
}

/// Two contours whose blocks have the same numbers, each roughed and finished.
const REUSED_NUMBERS: &str = "G00 X30. Z2.\nG71 U5. R1.\nG71 P10 Q20 U0 W0 F100\nN10 G00 X20.\nG01 Z-10. F50\nN20 X30.\n\
                              G70 P10 Q20\nG00 X30. Z2.\nG71 P10 Q20 U0 W0 F100\nN10 G00 X25.\nG01 Z-5. F50\nN20 X30.\n\
                              G70 P10 Q20\nM30\n";

#[test]
fn b2_a_contour_with_reused_block_numbers_is_the_one_beside_its_cycle() {
    let passes_by = |line: u32, point: &str| {
        let found = shown(&moves_of_line(REUSED_NUMBERS, line).unwrap());
        assert!(found.iter().any(|shown| shown == point), "line {line}: {found:?}");
    };
    // The corner at the root of each contour.
    passes_by(3, "-10 20");
    passes_by(9, "-5 25");
    for (line, contour) in [(7, ["+2 20", "-10 20", "-10 30"]), (13, ["+2 25", "-5 25", "-5 30"])] {
        assert_eq!(shown(&moves_of_line(REUSED_NUMBERS, line).unwrap())[..3], contour, "line {line}");
    }
}

#[test]
fn b2_a_contour_that_its_allowance_puts_above_the_start_is_refused() {
    // 40 + 20 > 30; −22 + … the face allowance is longer than the contour.
    for (allowance, name) in [("U40. W0.1", "contour-above-start"), ("U0.4 W50.", "contour-allowance")] {
        let text = format!(
            "G00 X30. Z2.\nG71 U5. R1.\nG71 P10 Q20 {allowance} F100\nN10 G00 X10.\nG01 Z-20. F50\nN20 X28.\nM30\n"
        );
        assert_eq!(moves_of_line(&text, 3).unwrap_err().error.id(), name, "{allowance}");
    }
}

#[test]
fn b2_an_arc_with_a_rounded_end_is_no_turn() {
    // The fillet of a real program, in millimetres: its end lies 0.0001 in beyond the tangent point.
    let text = "G00 X270.891 Z1.27\nG71 U1.57 R1.27\nG71 P100 Q106 U.25 W.06 F100\nN100 G00 X246.2428\nN101 G01 Z0.0 F50\n\
                N102 G03 X247.9319 Z-.5639 R.9144\nN103 G01 X249.8827 Z-2.667\nN106 X270.891\nM30\n";
    let settings = NcSettings::for_dialect(Dialect::LatheA);
    let source = Arc::new(Source::new(1001, "O1001.NC", text, Dialect::LatheA));
    let report = kt830::nc::check(&source, &(Arc::new(EmptyLibrary) as _), &settings);
    assert_eq!(report.faults, [], "{:?}", report.faults.first().map(ToString::to_string));
}

#[test]
fn b2_what_type_2_refuses() {
    for (contour, name, line) in [
        // Back along Z.
        ("N10 G00 X20. W0\nG01 Z-10. F50\nX10. Z-5.\nN20 Z-40.\n", "contour-not-monotone", 6),
        // Above the start.
        ("N10 G00 X20. W0\nG01 Z-10. F50\nX35. Z-20.\nX20. Z-30.\nN20 Z-40.\n", "contour-above-start", 6),
        // Type I, with X alone in its first block, does not rise and fall.
        ("N10 G00 X20.\nG01 Z-10. F50\nX10. Z-15.\nN20 Z-40.\n", "contour-pocket", 6),
        ("N10 G00 X20.\nG01 Z-10. F50\nX25. Z-5.\nN20 Z-40.\n", "contour-not-monotone", 6),
    ] {
        let text = format!("G00 X30. Z2.\nG71 U5. R1.\nG71 P10 Q20 U0 W0 F100\n{contour}M30\n");
        let fault = moves_of_line(&text, 3).unwrap_err();
        assert_eq!(fault.error.id(), name, "{contour}");
        // The message names the block of the contour.
        assert!(fault.to_string().contains(&format!("of line {line} ")), "{fault}");
    }
}

/// The contour's X at a Z, from its corners.
fn contour_at(corners: &[[f64; 2]], z: f64) -> f64 {
    let pair = corners.windows(2).find(|pair| (pair[1][0]..=pair[0][0]).contains(&z));
    pair.map_or(f64::NEG_INFINITY, |pair| {
        let part = (z - pair[0][0]) / (pair[1][0] - pair[0][0]);
        pair[0][1] + part * (pair[1][1] - pair[0][1])
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    /// No move of a random contour cuts below it; rapid moves stay above what is cut already; what is left is at most one
    /// depth, before the pass along the contour.
    #[test]
    fn b2_strokes_of_random_contours_keep_off_the_contour(
        points in prop::collection::vec((0.5..15.0_f64, 3.0..29.0_f64), 2..25),
        depth in 0.5..6.0_f64,
        across in prop_oneof![Just(0.0), 0.0..0.9_f64],
        along in prop_oneof![Just(0.0), -0.4..0.4_f64],
    ) {
        let mut corners = vec![[0.0, points[0].1]];
        let mut text = format!(
            "G00 X30. Z0\nG71 U{depth:.9} R0.3\nG71 P10 Q20 U{across:.9} W{along:.9} F100\nN10 G00 X{:.9} W0\n",
            points[0].1
        );
        for (index, (length, x)) in points.iter().enumerate() {
            let z = corners[corners.len() - 1][0] - length;
            corners.push([z, *x]);
            let n = if index + 1 == points.len() { "N20 " } else { "" };
            let _ = writeln!(text, "{n}G01 X{x:.9} Z{z:.9} F50");
        }
        text.push_str("M30\n");
        let moves = moves_of_line(&text, 3).unwrap();
        let strokes = &moves[..moves.len() - corners.len() - 3];
        corners.iter_mut().for_each(|corner| *corner = [corner[0] + along, corner[1] + across]);
        // From where both the stock and the contour are to where they are no more.
        let (begin, end) = (along.min(0.0), corners[corners.len() - 1][0]);
        // What stands at each place along Z: at first all up to the start.
        const STEPS: usize = 2_000;
        let place = |step: usize| begin + (end - begin) * (step as f64 + 0.5) / STEPS as f64;
        let mut stock = vec![30.0_f64; STEPS];
        let mut from = [0.0_f64, 30.0];
        for (rapid, to) in strokes {
            let (low, high) = (from[0].min(to[0]), from[0].max(to[0]));
            for (step, left) in stock.iter_mut().enumerate() {
                let z = place(step);
                if z < low || z > high {
                    continue;
                }
                let x = if (to[0] - from[0]).abs() < 1e-9 { from[1].min(to[1]) } else { from[1] + (z - from[0]) / (to[0] - from[0]) * (to[1] - from[1]) };
                prop_assert!(x >= contour_at(&corners, z) - 1e-6, "{z} {x}");
                prop_assert!(!rapid || x >= *left - 1e-6, "rapid through the stock at {z} {x}");
                *left = left.min(x);
            }
            from = *to;
        }
        for (step, left) in stock.iter().enumerate() {
            prop_assert!(*left - contour_at(&corners, place(step)) <= depth + 1e-6, "{} left at {}", left, place(step));
        }
    }
}
