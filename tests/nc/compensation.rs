//! G40, G41 and G42 in programs: hand-computed points, what is refused, and random contours (row B2).
//!
//! Z is to the right, X up; points are written as (z, x) in radius millimetres. The cutter is that of offset 1.

use std::sync::Arc;

use kt830::defs::kind::Dialect;
use kt830::nc::{
    Block, CommonVariables, CutterShape, CutterSource, EmptyLibrary, Interpreter, NcSettings, NextStatus,
    OfflineMachine, Op, OpEffect, OpMotion, ProgramFault, Source, WorkOffsets, check,
};
use kt830::units::{Axis, WorkPos};
use proptest::prelude::*;

use crate::running::{Move, ROUNDING_MM, assert_moves, moves, run_in};

fn settings() -> NcSettings {
    NcSettings { diameter: false, ..NcSettings::for_dialect(Dialect::LatheA) }
}

fn machine(settings: &NcSettings, cutter: CutterShape) -> OfflineMachine {
    let mut offsets = WorkOffsets::default();
    offsets.cutter[0] = cutter;
    OfflineMachine::new(settings).with_work_offsets(offsets)
}

/// The operations of a text with their lines.
fn operations_with(text: &str, settings: &NcSettings, cutter: CutterShape) -> Result<Vec<(u32, Op)>, ProgramFault> {
    Ok(run_in(&mut machine(settings, cutter), text, settings)?.0)
}

fn operations(text: &str, radius_mm: f64) -> Result<Vec<(u32, Op)>, ProgramFault> {
    operations_with(text, &settings(), CutterShape { radius_mm, tip: 0 })
}

fn assert_near(is: [f64; 2], should: [f64; 2], what: &str) {
    assert!((0..2).all(|axis| (is[axis] - should[axis]).abs() < ROUNDING_MM), "{what}: {is:?}, expected {should:?}");
}

/// Compares the moves of a text with those expected.
fn check_moves(text: &str, radius_mm: f64, expected: &[Move]) {
    assert_moves(&moves(&operations(text, radius_mm).unwrap()), expected, text);
}

fn refused(text: &str, radius_mm: f64) -> (u32, &'static str) {
    let fault = operations(text, radius_mm).unwrap_err();
    (fault.location.line, fault.error.id())
}

#[test]
fn b2_g42_keeps_the_radius_at_an_outer_and_an_inner_corner() {
    // A shaft of radius 10 with a shoulder to radius 20 at Z−30, and its end at Z−50. The cutter of radius 2 runs on X+:
    // lead-in square to the first segment (0, 12); the shoulder is an inner corner: Z−28, X12; its outer corner is rolled
    // around (−30, 20) from Z−28 to X22.
    let text = "G98 G00 X40 Z10\nG42 D1 G01 X10 Z0 F100\nZ-30\nX20\nZ-50\nG40 G00 X40 Z10\nM30\n";
    let expected = [
        (1, [10.0, 40.0], None),
        (2, [0.0, 12.0], None),
        (3, [-28.0, 12.0], None),
        (4, [-28.0, 20.0], None),
        (5, [-30.0, 22.0], Some([-30.0, 20.0])),
        (5, [-50.0, 22.0], None),
        (6, [10.0, 40.0], None),
    ];
    check_moves(text, 2.0, &expected);
}

#[test]
fn b2_g41_and_g42_run_on_both_sides_in_every_quadrant() {
    // A line from the origin in four directions; the cutter leads in square to it and leaves square to its end. The
    // direction (dz, dx) of unit length has (−dx, dz) on its left.
    for (dz, dx) in [(0.6, 0.8), (-0.6, 0.8), (-0.6, -0.8), (0.6, -0.8), (1.0, 0.0), (0.0, -1.0)] {
        for (g, side) in [(41, 1.0), (42, -1.0)] {
            let (nz, nx) = (-dx * side, dz * side);
            // The lead-in comes from 30 mm on the side of the cutter.
            let from = [nz * 30.0, nx * 30.0];
            let end = [dz * 20.0, dx * 20.0];
            let text = format!(
                "G98 G00 Z{} X{}\nG{g} D1 G01 Z0 X0 F100\nZ{} X{}\nG40 G00 Z{} X{}\nM30\n",
                from[0], from[1], end[0], end[1], from[0], from[1]
            );
            let begin = [nz * 1.5, nx * 1.5];
            let expected =
                [(1, from, None), (2, begin, None), (3, [end[0] + begin[0], end[1] + begin[1]], None), (4, from, None)];
            check_moves(&text, 1.5, &expected);
        }
    }
}

#[test]
fn b2_arcs_keep_their_centre_and_change_their_radius() {
    // A quarter of radius 5 around (−5, 15) from (0, 15) … as a round shoulder: outside on the right (G42) it grows to 7.
    // G03 from (0, 15): counter-clockwise with Z to the right, from angle 0 to 90°: (−5, 20).
    let text = "G98 G00 X30 Z20\nG42 D1 G01 X15 Z0 F100\nG03 X20 Z-5 R5\nG01 Z-20\nG40 G00 X40\nM30\n";
    let expected = [
        (1, [20.0, 30.0], None),
        (2, [2.0, 15.0], None),
        (3, [-5.0, 22.0], Some([-5.0, 15.0])),
        (4, [-20.0, 22.0], None),
        // The lead-out goes to the programmed point: Z too.
        (5, [-20.0, 40.0], None),
    ];
    check_moves(text, 2.0, &expected);
    // The same arc as a hollow, followed on its left (G41): its radius shrinks to 3.
    let hollow = "G98 G00 X15 Z-5\nG41 D1 G01 X15 Z0 F100\nG03 X20 Z-5 R5\nG40 G01 X15 Z-5\nM30\n";
    let expected = [
        (1, [-5.0, 15.0], None),
        (2, [-2.0, 15.0], None),
        (3, [-5.0, 18.0], Some([-5.0, 15.0])),
        (4, [-5.0, 15.0], None),
    ];
    check_moves(hollow, 2.0, &expected);
}

#[test]
fn b2_the_programmed_point_is_the_imaginary_tip() {
    // Tip 3 (X−, Z−) of radius 0.8: along Z the X of the tip is that of the contour, along X its Z.
    // Along Z the centre is at X10.8, the tip at X10; it begins at the centre's Z0, the tip's Z−0.8.
    let text = "G98 G00 X40 Z10\nG42 D1 G01 X10 Z0 F100\nZ-30\nX20\nG40 G00 X40 Z10\nM30\n";
    let ops = operations_with(text, &settings(), CutterShape { radius_mm: 0.8, tip: 3 }).unwrap();
    let found = moves(&ops);
    let expected = [[10.0, 40.0], [-0.8, 10.0], [-30.0, 10.0], [-30.0, 19.2], [10.0, 40.0]];
    for (is, should) in found.iter().zip(expected) {
        assert!((is.1[0] - should[0]).abs() < ROUNDING_MM && (is.1[1] - should[1]).abs() < ROUNDING_MM, "{found:?}");
    }
    assert_eq!(found.len(), expected.len());
}

#[test]
fn b2_x_words_are_diameters_and_the_radius_is_not() {
    let diameters = NcSettings { diameter: true, ..settings() };
    let text = "G98 G00 X80 Z10\nG42 D1 G01 X20 Z0 F100\nZ-30\nG40 G00 X80\nM30\n";
    let ops = operations_with(text, &diameters, CutterShape { radius_mm: 2.0, tip: 0 }).unwrap();
    assert_near(moves(&ops)[1].1, [0.0, 12.0], "the end of the lead-in");
}

#[test]
fn b2_what_follows_the_contour_is_chosen_by_parameter() {
    let text = |word: &str| format!("T0101\nG98 G00 X40 Z10\nG42 {word} G01 X10 Z0 F100\nZ-30\nG40 G00 X40\nM30\n");
    let with = |cutter_source, word: &str| {
        let settings = NcSettings { cutter_source, ..settings() };
        let mut offsets = WorkOffsets::default();
        offsets.cutter[0].radius_mm = 2.0;
        offsets.cutter[15].radius_mm = 0.5;
        let mut world = OfflineMachine::new(&settings).with_work_offsets(offsets);
        world.set_system(5801, Some(60.0));
        let source = Arc::new(Source::new(1001, "O1001.NC", text(word), settings.dialect));
        let mut interpreter =
            Interpreter::new(source, Arc::new(EmptyLibrary), settings.clone(), CommonVariables::default());
        let mut block = Block::new(&settings);
        let mut found = Vec::new();
        while interpreter.next(&mut world, &mut block).unwrap() != NextStatus::End {
            block.ops.iter().for_each(|op| world.apply(op));
            found.extend(block.ops.iter().map(|op| (block.location.line, op.clone())));
        }
        moves(&found)[1].1
    };
    assert_near(with(CutterSource::ToolOffset, ""), [0.0, 12.0], "T0101: R of offset 1");
    assert_near(with(CutterSource::Offset(16), ""), [0.0, 10.5], "the dresser");
    assert_near(with(CutterSource::WholeWheel, ""), [0.0, 40.0], "half of #5801");
    assert_near(with(CutterSource::WholeWheel, "D16"), [0.0, 10.5], "D decides");
}

#[test]
fn b2_a_radius_of_zero_changes_nothing_and_is_told() {
    let text = "G98 G00 X40 Z10\nG42 D1 G01 X10 Z0 F100\nZ-30\nX20\nG40 G00 X40 Z10\nM30\n";
    let plain = text.replace("G42 D1 ", "").replace("G40 ", "");
    assert_eq!(operations(text, 0.0).unwrap(), operations(&plain, 0.0).unwrap());
    let source = Arc::new(Source::new(1001, "O1001.NC", text, Dialect::LatheA));
    let report = check(&source, &(Arc::new(EmptyLibrary) as _), &settings());
    let told: Vec<_> = report.warnings.iter().map(|fault| (fault.location.line, fault.error.id())).collect();
    assert_eq!((told, report.faults.len()), (vec![(2, "cutter-without-radius")], 0));
}

#[test]
fn b2_a_contour_that_the_cutter_does_not_fit_is_refused_before_it_begins() {
    // A groove 3 mm wide; the cutter has a radius of 2 mm. Nothing of the contour is returned.
    let groove = "G98 G00 X40 Z10\nG42 D1 G01 X20 Z0 F100\nZ-10\nX15\nZ-13\nX20\nZ-30\nG40 G00 X40\nM30\n";
    let fault = operations(groove, 2.0).unwrap_err();
    assert_eq!((fault.location.line, fault.error.id()), (5, "segment-below-cutter"));
    // 1.4 mm fits.
    assert!(operations(groove, 1.4).is_ok());
    // A hollow of radius 2 for a cutter of 2; on the outside it fits.
    let hollow = "G98 G00 X40 Z10\nG42 D1 G01 X20 Z0 F100\nG02 X22 Z-2 R2\nG01 X30\nG40 G00 X40\nM30\n";
    assert_eq!(refused(hollow, 2.0), (3, "arc-below-cutter"));
    assert!(operations(hollow, 1.9).is_ok());
    // The lead-in starts on the other side of the part's face.
    let beyond = "G98 G00 X5 Z-10\nG42 D1 G01 X20 Z0 F100\nZ-30\nG40 G00 X40\nM30\n";
    assert_eq!(refused(beyond, 2.0), (2, "cutter-gouge"));
}

#[test]
fn b2_what_cannot_stand_between_g41_and_g40_is_refused_by_name() {
    let with =
        |block: &str| format!("G98 G00 X40 Z10\nG42 D1 G01 X10 Z0 F100\nZ-10\n{block}\nZ-30\nG40 G00 X40\nM30\n");
    for block in ["M00", "G28 U0", "G55", "G50 X10", "#1=#5041", "G10 D1 U0.1", "G31 Z-20", "M80", "#3000=1"] {
        assert_eq!(refused(&with(block), 2.0), (4, "not-in-compensation"), "{block}");
    }
    for block in ["G41 D1", "G42 D2", "T0202"] {
        assert_eq!(refused(&with(block), 2.0), (4, "compensation-change"), "{block}");
    }
    for block in ["G04 X1", "M08", "S100", "F50", "#500=3", "G61", "G42 D1"] {
        assert!(operations(&with(block), 2.0).is_ok(), "{block}");
    }
    let arc_in = "G98 G00 X40 Z10\nG42 D1\nG03 X50 Z0 R10 F100\nG01 Z-30\nG40 G00 X80\nM30\n";
    assert_eq!(refused(arc_in, 2.0), (3, "compensation-lead"));
    let arc_out = "G98 G00 X40 Z10\nG42 D1 G01 X10 Z0 F100\nZ-30\nG40 G03 X20 Z-40 R10\nM30\n";
    assert_eq!(refused(arc_out, 2.0), (4, "compensation-lead"));
    assert_eq!(refused("G98 G00 X40 Z10\nG42 D1 G01 X10 Z0 F100\nM30\n", 2.0).1, "compensation-without-contour");
}

#[test]
fn b2_the_order_of_the_other_operations_stays() {
    let text = "G98 G00 X40 Z10\nG42 D1 G01 X10 Z0 F100 M08\n#500=1\nZ-30 M09\n#500=2\nG40 G00 X40\nM30\n";
    let ops = operations(text, 2.0).unwrap();
    let kinds: Vec<_> =
        ops.iter().map(|(line, op)| format!("{line} {}", op.to_string().split(' ').next().unwrap())).collect();
    assert_eq!(kinds, ["1 rapid", "2 m", "2 feed", "3 set", "4 feed", "4 m", "5 set", "6 rapid", "7 m"], "{ops:?}");
}

#[test]
fn b2_a_check_goes_on_behind_a_gouge_and_finds_the_next_mistake() {
    let text = "G98 G00 X40 Z10\nG42 D1 G01 X20 Z0 F100\nZ-10\nX15\nZ-13\nX20\nZ-30\nG40 G00 X40\nG01 X\nM30\n";
    let settings = settings();
    let source = Arc::new(Source::new(1001, "O1001.NC", text, settings.dialect));
    let mut world = machine(&settings, CutterShape { radius_mm: 2.0, tip: 0 });
    let library: kt830::nc::SharedLibrary = Arc::new(EmptyLibrary);
    let checking = kt830::nc::ProgramCheck::new(&source, &library, &settings, CommonVariables::default());
    let report = checking.run(&mut world, &mut |_| {});
    let found: Vec<_> = report.faults.iter().map(|fault| (fault.location.line, fault.error.id())).collect();
    assert_eq!(found, [(5, "segment-below-cutter"), (9, "missing-number")]);
}

/// A contour that goes on in Z and wanders in X: lines, with arcs of 60° between some of them.
fn wavy() -> impl Strategy<Value = Vec<(f64, f64, bool)>> {
    prop::collection::vec((3.0..15.0, -9.0..9.0_f64, any::<bool>()), 2..150)
}

/// A line, or an arc with centre and turn, of points (z, x).
#[derive(Clone, Copy, Debug)]
struct Piece {
    from: [f64; 2],
    to: [f64; 2],
    arc: Option<([f64; 2], f64)>,
}

impl Piece {
    /// Radius, angle of the start and sweep of an arc.
    fn polar(&self, center: [f64; 2], turn: f64) -> (f64, f64, f64) {
        let angle = |p: [f64; 2]| (p[1] - center[1]).atan2(p[0] - center[0]);
        let sweep = (turn * (angle(self.to) - angle(self.from))).rem_euclid(std::f64::consts::TAU);
        ((self.from[0] - center[0]).hypot(self.from[1] - center[1]), angle(self.from), sweep)
    }

    fn at(&self, fraction: f64) -> [f64; 2] {
        let Some((center, turn)) = self.arc else {
            return [0, 1].map(|axis| self.from[axis] + (self.to[axis] - self.from[axis]) * fraction);
        };
        let (radius, start, sweep) = self.polar(center, turn);
        let (sin, cos) = (start + turn * sweep * fraction).sin_cos();
        [center[0] + radius * cos, center[1] + radius * sin]
    }

    fn distance(&self, p: [f64; 2]) -> f64 {
        let to_point = |q: [f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]);
        let Some((center, turn)) = self.arc else {
            let (dz, dx) = (self.to[0] - self.from[0], self.to[1] - self.from[1]);
            let part = ((p[0] - self.from[0]) * dz + (p[1] - self.from[1]) * dx) / (dz * dz + dx * dx).max(1e-12);
            return to_point(self.at(part.clamp(0.0, 1.0)));
        };
        let (radius, start, sweep) = self.polar(center, turn);
        let angle = (p[1] - center[1]).atan2(p[0] - center[0]);
        let is_beside = (turn * (angle - start)).rem_euclid(std::f64::consts::TAU) <= sweep;
        let ends = to_point(self.from).min(to_point(self.to));
        if is_beside { (to_point(center) - radius).abs().min(ends) } else { ends }
    }
}

/// The text of a contour with its pieces; coordinates have three decimals.
fn contour_text(steps: &[(f64, f64, bool)]) -> (String, Vec<Piece>) {
    let round = |value: f64| (value * 1e3).round() / 1e3;
    let (mut text, mut pieces, mut from) = (String::new(), Vec::new(), [0.0, 50.0]);
    for &(dz, x, is_arc) in steps {
        let to = [round(from[0] - dz), round(50.0 + x)];
        let (dz, dx) = (to[0] - from[0], to[1] - from[1]);
        let chord = dz.hypot(dx);
        let radius = (chord * 1e3).ceil() / 1e3;
        let arc = is_arc.then(|| {
            // G03: the centre is on the left of the chord, at the height of the radius over it.
            let height = (radius * radius - chord * chord / 4.0).sqrt() / chord;
            ([f64::midpoint(from[0], to[0]) - height * dx, f64::midpoint(from[1], to[1]) + height * dz], 1.0)
        });
        text.push_str(&match is_arc {
            true => format!("G03 X{} Z{} R{radius}\n", to[1], to[0]),
            false => format!("G01 X{} Z{}\n", to[1], to[0]),
        });
        pieces.push(Piece { from, to, arc });
        from = to;
    }
    (text, pieces)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// The path keeps its distance from the contour, measured here on points of the path; or the contour is refused.
    /// Contours of up to 150 segments are longer than what is read ahead.
    #[test]
    fn b2_random_contours_keep_the_radius_within_a_micrometre(
        steps in wavy(),
        radius in 0.2..4.0_f64,
        right in any::<bool>(),
    ) {
        let (g, x) = if right { (42, 90.0) } else { (41, 10.0) };
        let (text, contour) = contour_text(&steps);
        let end = contour[contour.len() - 1].to;
        let text = format!("G98 G00 X{x} Z20\nG{g} D1 G01 X50 Z0 F100\n{text}G40 G01 X{x} Z{}\nM30\n", end[0]);
        let ops = match operations(&text, radius) {
            Ok(ops) => ops,
            Err(fault) => {
                let ids = ["segment-below-cutter", "arc-below-cutter", "cutter-gouge"];
                prop_assert!(ids.contains(&fault.error.id()), "{}", fault);
                return Ok(());
            }
        };
        let mut at = [20.0, x];
        for (line, op) in &ops {
            let OpEffect::Motion(OpMotion::Work(by)) = op.effect() else { continue };
            let point = |position: WorkPos| [position[Axis::Z], position[Axis::X]];
            let arc = by.arc.map(|arc| (point(arc.center), f64::from(arc.turn)));
            let piece = Piece { from: at, to: point(by.to), arc };
            at = piece.to;
            // The lines to and from the contour only touch its ends.
            if !(3..=steps.len() as u32 + 2).contains(line) {
                continue;
            }
            for p in (0..=16).map(|k| piece.at(f64::from(k) / 16.0)) {
                let near = contour.iter().map(|piece| piece.distance(p)).fold(f64::INFINITY, f64::min);
                prop_assert!(near > radius - 1e-3, "line {line}: {near} < {radius}\n{text}");
            }
        }
        prop_assert!((at[0] - end[0]).abs() < ROUNDING_MM && (at[1] - x).abs() < ROUNDING_MM);
    }
}

#[test]
fn b2_the_contour_of_a_cycle_is_offset_by_the_radius() {
    // A shaft of radius 10 to Z−20, a cone at 45° to radius 20 at Z−30. The cutter of radius 2 on X+ (G42): beside the
    // cylinder at X12; beside the cone at 2·√2 above it in X; they cross where 12 = 10 + (−20 − z) + 2√2.
    let contour = "N10 G00 G42 D1 X10\nN20 G01 Z-20 F50\nN30 X20 Z-30\nN40 G40 X40\n";
    let root = 8.0_f64.sqrt();
    let corner = [-20.0 + root - 2.0, 12.0];
    // Square to the end of the cone: (−30, 20) and 2 mm along (1, 1)/√2.
    let end = [-30.0 + root / 2.0, 20.0 + root / 2.0];
    let finish = moves(&operations(&format!("G98 G00 X40 Z0\nG70 P10 Q40\n{contour}M30\n"), 2.0).unwrap());
    let near = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).abs() < 1e-9 && (a[1] - b[1]).abs() < 1e-9;
    let expected = [[0.0, 12.0], corner, end, [-30.0, 40.0]];
    for (is, should) in finish[1..5].iter().zip(expected) {
        assert!(near(is.1, should), "{finish:?}");
    }
    // Roughing: the strokes of 5 mm end beside the cone, 0.5 mm of allowance in X kept; the last pass follows it.
    let rough = format!("G98 G00 X40 Z0\nG71 U5 R1\nG71 P10 Q40 U0.5 W0 F100\n{contour}M30\n");
    let rough = moves(&operations(&rough, 2.0).unwrap());
    let stroke_end = |x: f64| -20.0 - (x - 10.0 - 0.5 - root);
    let ends: Vec<_> =
        rough.iter().filter(|(_, to, _)| (to[1] - 25.0).abs() < 1e-9 || (to[1] - 15.0).abs() < 1e-9).collect();
    assert!(ends.iter().any(|(_, to, _)| near(*to, [stroke_end(15.0), 15.0])), "{rough:?}");
    assert!(
        rough.iter().any(|(_, to, _)| near(*to, [corner[0], 12.5]))
            || rough.iter().any(|(_, to, _)| near(*to, [corner[0], corner[1] + 0.5])),
        "{rough:?}"
    );
    assert!(rough.iter().any(|(_, to, _)| near(*to, [end[0], end[1] + 0.5])), "{rough:?}");
    // The groove of the contour is too narrow for the cutter.
    let groove = "G98 G00 X40 Z0\nG70 P10 Q60\nN10 G00 G42 D1 X20\nN20 G01 Z-10 F50\nN30 X15\nN40 Z-13\nN50 X20\nN60 Z-30\nM30\n";
    let fault = operations(groove, 2.0).unwrap_err();
    assert_eq!((fault.location.line, fault.error.id()), (2, "segment-below-cutter"));
}

/// What a reader with fresh eyes found: each program with the moves that it must give.
#[test]
fn b2_a_block_without_a_way_in_the_plane_stays_beside_the_contour() {
    let head = "G98 G00 X40 Z10\nG42 D1 G01 X10 Z0 F100\nZ-30\n";
    let tail = "X20\nZ-50\nG40 G00 X40 Z10\nM30\n";
    // Z−30 again: nothing moves; the shoulder's inner corner is at Z−28.
    for again in ["Z-30", "X10", ""] {
        let expected = [
            (1, [10.0, 40.0], None),
            (2, [0.0, 12.0], None),
            (3, [-28.0, 12.0], None),
            (5, [-28.0, 20.0], None),
            (6, [-30.0, 22.0], Some([-30.0, 20.0])),
            (6, [-50.0, 22.0], None),
            (7, [10.0, 40.0], None),
        ];
        check_moves(&format!("{head}{again}\n{tail}"), 2.0, &expected);
    }
}

#[test]
fn b2_a_way_across_the_plane_keeps_the_place_in_it() {
    let settings = NcSettings::for_dialect(Dialect::Mill);
    let text = "G18 G90 G98\nG00 X40 Z10\nG42 D1 G01 X10 Z0 F100\nZ-30\nY4\nZ-40\nG40\nG00 Y9\nG00 X40\nM30\n";
    let ops = operations_with(text, &settings, CutterShape { radius_mm: 2.0, tip: 0 }).unwrap();
    let found: Vec<_> =
        ops.iter().filter(|(line, _)| (5..=9).contains(line)).map(|(line, op)| format!("{line} {op}")).collect();
    assert_eq!(
        found,
        [
            "5 feed x=12 y=4 z=-30 f=100 [Y]",
            "6 feed x=12 y=4 z=-40 f=100 [X+Z]",
            // G40 alone, then Y alone: it does not lead out; X does, with Z.
            "8 rapid x=12 y=9 z=-40 [Y]",
            "9 rapid x=40 y=9 z=-40 [XZ+]",
        ],
        "{ops:?}"
    );
}

#[test]
fn b2_a_return_behind_g40_counts_from_the_end_of_the_path() {
    let head = "G98 G00 X40 Z10\nG42 D1 G01 X10 Z0 F100\nZ-30\n";
    for (behind, via) in
        [("G40 G28 U0 W0", [-30.0, 12.0]), ("G40\nG28 U0", [-30.0, 12.0]), ("G40\nG28 X15", [-30.0, 15.0])]
    {
        let ops = operations(&format!("{head}{behind}\nM30\n"), 2.0).unwrap();
        let found = ops.iter().find_map(|(_, op)| match op {
            Op::ReturnToReference { via, .. } => Some([via[Axis::Z], via[Axis::X]]),
            _ => None,
        });
        assert_near(found.unwrap(), via, behind);
    }
}

#[test]
fn b2_rapid_corners_keep_the_radius_and_end() {
    // Around the corner (−30, 10) along the tangents: (−32, 12) is on both; the same in a finishing cycle.
    let contour = "G42 D1 G01 X10 Z0 F100\nZ-30\nG00 X0\nG40 G00 X0 Z-60\n";
    let corner = [[-30.0, 12.0], [-32.0, 12.0], [-32.0, 10.0], [-32.0, 0.0]];
    let ops = operations(&format!("G98 G00 X40 Z10\n{contour}M30\n"), 2.0).unwrap();
    for (is, should) in moves(&ops)[2..6].iter().zip(corner) {
        assert_near(is.1, should, "rapid corner");
    }
    let cycle =
        "G98 G00 X40 Z10\nG70 P10 Q20\nM30\nN10 G42 D1 G00 X10 Z0\nG01 Z-30 F100\nG00 X0\nZ-50\nN20 G40 G00 X40\n";
    let ops = operations(cycle, 2.0).unwrap();
    assert!(ops.iter().all(|(_, op)| !matches!(op, Op::Arc { .. })), "{ops:?}");
    // A wall 1.4 mm beside the square corner: the arc would pass, the square does not.
    let wall =
        "G98 G00 X30 Z10\nG42 D1 G01 X20 Z0 F100\nZ-30\nG00 X10\nG01 Z-34.2\nX21.8\nX26 Z-30\nG40 G00 X26 Z20\nM30\n";
    assert!(operations(&wall.replace("G00 X10", "G01 X10"), 2.0).is_ok());
    assert_eq!(refused(wall, 2.0).1, "cutter-gouge");
}

#[test]
fn b2_a_side_of_several_segments_meets_an_inner_corner() {
    // The shoulder of the first test with both sides divided next to the corner: the same path.
    for divided in ["Z-29\nZ-30\nX20", "Z-30\nX10.5\nX20", "Z-29.5\nZ-29.9\nZ-30\nX10.1\nX11\nX20"] {
        let text = format!("G98 G00 X40 Z10\nG42 D1 G01 X10 Z0 F100\n{divided}\nZ-50\nG40 G00 X40 Z10\nM30\n");
        let found = moves(&operations(&text, 2.0).unwrap());
        assert!(found.iter().any(|(_, to, _)| (to[0] + 28.0).abs() < 1e-9 && (to[1] - 12.0).abs() < 1e-9), "{found:?}");
        assert!(found.iter().all(|(_, to, _)| to[0] > -28.0 - 1e-9 || to[1] > 20.0 - 1e-9), "{found:?}");
    }
}

#[test]
fn b2_the_usual_ends_of_a_contour_are_accepted() {
    let head = "G98 T0101 G00 X40 Z10\nG42 G01 X10 Z0 F100\nZ-30\n";
    for end in ["G40 G00 X40 Z10 T0100", "G40\n#100=#5041\nG00 X40", "G42 X20\nG40 G00 X40"] {
        let ops = operations(&format!("{head}{end}\nM30\n"), 2.0);
        assert!(ops.is_ok(), "{end}: {ops:?}");
    }
    // Tip 3 in a roughing cycle: the lead-out goes back in Z by the radius.
    let text = "G98 G00 X40 Z2\nG71 U2 R1\nG71 P10 Q20 U0.4 W0.1 F100\nN10 G42 D1 G00 X10\nG01 Z-30 F100\nX20\nZ-50\nN20 G40 X30\nM30\n";
    assert!(operations_with(text, &settings(), CutterShape { radius_mm: 0.8, tip: 3 }).is_ok());
}

#[test]
fn b2_waiting_blocks_have_a_limit_and_cycles_are_refused() {
    let head = "G98 G00 X40 Z10\nG42 D1 G01 X10 Z0 F100\nZ-30\n";
    assert_eq!(refused(&format!("{head}N10 #500=#500+1\nGOTO 10\nM30\n"), 2.0).1, "compensation-waits");
    assert_eq!(refused(&format!("{head}G90 X15 Z-40\nM30\n"), 2.0), (4, "not-in-compensation"));
    assert_eq!(refused(&format!("{head}G75 R1\nM30\n"), 2.0), (4, "not-in-compensation"));
}
