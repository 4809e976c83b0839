//! Cutter radius compensation as geometry; source: spec B2 (G40 G41 G42). The distance of the cutter from
//! the contour is measured here on points along both, not by the module's own distances.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

use kt830::geometry::{CompensatedSegment, CompensationSide, Gouge, GougeCause, PlanePoint, PlaneSegment, compensate};
use proptest::prelude::*;

/// Points looked at on each segment of the cutter's path.
const LOOKS: u32 = 24;
/// Rounding of coordinates up to 1 m, and the gap that counts as none, mm.
const ROUNDING_MM: f64 = 3e-6;

fn distance(a: PlanePoint, b: PlanePoint) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Distance of a point from a segment: by projection for a line, by search for an arc.
fn distance_to(segment: &PlaneSegment, p: PlanePoint) -> f64 {
    match *segment {
        PlaneSegment::Line { from, to } => {
            let (du, dv) = (to[0] - from[0], to[1] - from[1]);
            let square = du * du + dv * dv;
            let part = if square > 0.0 { ((p[0] - from[0]) * du + (p[1] - from[1]) * dv) / square } else { 0.0 };
            let part = part.clamp(0.0, 1.0);
            distance(p, [from[0] + part * du, from[1] + part * dv])
        }
        PlaneSegment::Arc { center, radius, start, sweep } => {
            let at = |part: f64| {
                let (sin, cos) = (start + part * sweep).sin_cos();
                [center[0] + radius * cos, center[1] + radius * sin]
            };
            let off = |part: f64| distance(p, at(part));
            let best = (0..=64_u32).map(|k| f64::from(k) / 64.0).min_by(|a, b| off(*a).total_cmp(&off(*b)));
            let middle = best.unwrap_or_default();
            let (mut low, mut high) = ((middle - 1.0 / 64.0).max(0.0), (middle + 1.0 / 64.0).min(1.0));
            for _ in 0..60 {
                let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
                if off(a) < off(b) { high = b } else { low = a }
            }
            off(f64::midpoint(low, high)).min(off(0.0)).min(off(1.0))
        }
    }
}

fn compensated(
    contour: &[PlaneSegment],
    side: CompensationSide,
    radius: f64,
) -> Result<Vec<CompensatedSegment>, Gouge> {
    let mut path = Vec::new();
    compensate(contour, side, radius, &mut path).map(|()| path)
}

fn length(path: &[CompensatedSegment]) -> f64 {
    path.iter().map(|part| part.path.length()).sum()
}

fn polyline(points: &[PlanePoint]) -> Vec<PlaneSegment> {
    points.windows(2).map(|pair| PlaneSegment::line(pair[0], pair[1])).collect()
}

/// What must hold for every path: connected, square to the ends, nowhere nearer than the radius, everywhere at it.
fn check(contour: &[PlaneSegment], side: CompensationSide, radius: f64, path: &[CompensatedSegment]) {
    for pair in path.windows(2) {
        let gap = distance(pair[0].path.at(1.0), pair[1].path.at(0.0));
        assert!(gap < ROUNDING_MM, "a gap of {gap} mm after {pair:?}");
        assert!(pair[0].source <= pair[1].source, "out of order: {pair:?}");
    }
    for part in path {
        for look in 0..=LOOKS {
            let p = part.path.at(f64::from(look) / f64::from(LOOKS));
            let nearest = contour.iter().map(|segment| distance_to(segment, p)).fold(f64::INFINITY, f64::min);
            assert!((nearest - radius).abs() < ROUNDING_MM, "{nearest} mm at {p:?} of {part:?}");
        }
    }
    for corner in contour.iter().flat_map(|segment| [segment.at(0.0), segment.at(1.0)]) {
        let nearest = path.iter().map(|part| distance_to(&part.path, corner)).fold(f64::INFINITY, f64::min);
        assert!(nearest > radius - ROUNDING_MM, "{nearest} mm from {corner:?}");
    }
    let ends = [(contour[0].at(0.0), contour[0].direction(0.0), path[0].path.at(0.0)), {
        let (last, end) = (contour[contour.len() - 1], path[path.len() - 1].path);
        (last.at(1.0), last.direction(1.0), end.at(1.0))
    }];
    let left = if side == CompensationSide::Left { radius } else { -radius };
    for (at, direction, found) in ends {
        let wanted = [at[0] - direction[1] * left, at[1] + direction[0] * left];
        assert!(distance(wanted, found) < ROUNDING_MM, "{found:?}, not {wanted:?}");
    }
}

#[test]
fn g41_of_a_line_is_on_its_left_and_g42_on_its_right() {
    let contour = polyline(&[[0.0, 0.0], [10.0, 0.0]]);
    let path = compensated(&contour, CompensationSide::Left, 2.0).unwrap();
    assert_eq!(path[0].path, PlaneSegment::line([0.0, 2.0], [10.0, 2.0]));
    let path = compensated(&contour, CompensationSide::Right, 2.0).unwrap();
    assert_eq!(path[0].path, PlaneSegment::line([0.0, -2.0], [10.0, -2.0]));
}

/// Around a square from outside: its four sides, and three quarters of a circle around the corners.
#[test]
fn g42_rolls_around_outer_corners() {
    let square = polyline(&[[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0], [0.0, 0.0]]);
    let path = compensated(&square, CompensationSide::Right, 2.0).unwrap();
    check(&square, CompensationSide::Right, 2.0, &path);
    assert_eq!(path.len(), 7);
    assert!((length(&path) - (40.0 + 3.0 * FRAC_PI_2 * 2.0)).abs() < 1e-9);
}

/// Inside the square each inner corner takes the radius from both sides; the ends of the open contour take none, so the
/// first and the last side would cut each other: the contour is refused. Without the last side it is 8 + 6 + 8.
#[test]
fn g41_ends_at_the_crossing_in_an_inner_corner() {
    let square = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0], [0.0, 0.0]];
    let refused = compensated(&polyline(&square), CompensationSide::Left, 2.0).unwrap_err();
    assert_eq!(refused, Gouge { segment: 0, other: 3, cause: GougeCause::Interference });
    let open = polyline(&square[..4]);
    let path = compensated(&open, CompensationSide::Left, 2.0).unwrap();
    check(&open, CompensationSide::Left, 2.0, &path);
    assert!((length(&path) - 22.0).abs() < 1e-9);
}

#[test]
fn a_hollow_arc_must_be_greater_than_the_cutter() {
    let hollow = |radius: f64| {
        [
            PlaneSegment::line([-10.0, 0.0], [-radius, 0.0]),
            PlaneSegment::arc([-radius, 0.0], [radius, 0.0], [0.0, 0.0], true).unwrap(),
            PlaneSegment::line([radius, 0.0], [10.0, 0.0]),
        ]
    };
    let path = compensated(&hollow(3.0), CompensationSide::Left, 2.0).unwrap();
    check(&hollow(3.0), CompensationSide::Left, 2.0, &path);
    let refused = compensated(&hollow(2.0), CompensationSide::Left, 2.0).unwrap_err();
    assert_eq!(refused, Gouge { segment: 1, other: 1, cause: GougeCause::ArcTooSmall });
    // From the other side it is a hump, whose corners are hollow and 90°.
    let path = compensated(&hollow(2.0), CompensationSide::Right, 2.0).unwrap();
    check(&hollow(2.0), CompensationSide::Right, 2.0, &path);
}

/// A wall of 1 mm after a hollow corner is too short for a cutter of 2 mm, which stands 2 mm above the floor; so is the
/// bottom of a groove of 3 mm.
#[test]
fn what_the_cutter_cannot_reach_is_refused_with_its_segments() {
    let step = polyline(&[[0.0, 0.0], [10.0, 0.0], [10.0, 1.0], [9.0, 1.0], [9.0, 10.0]]);
    let refused = compensated(&step, CompensationSide::Left, 2.0).unwrap_err();
    assert_eq!(refused, Gouge { segment: 0, other: 1, cause: GougeCause::SegmentTooShort });
    let groove = polyline(&[[0.0, 0.0], [10.0, 0.0], [10.0, -8.0], [13.0, -8.0], [13.0, 0.0], [20.0, 0.0]]);
    let refused = compensated(&groove, CompensationSide::Left, 2.0).unwrap_err();
    assert_eq!(refused, Gouge { segment: 2, other: 3, cause: GougeCause::SegmentTooShort });
    let path = compensated(&groove, CompensationSide::Left, 1.499).unwrap();
    check(&groove, CompensationSide::Left, 1.499, &path);
}

/// The neck of a bottle: no corner is too small, but its walls are nearer to each other than the cutter is wide.
#[test]
fn a_segment_that_is_no_neighbour_is_not_cut() {
    let bottle = polyline(&[
        [-20.0, 20.0],
        [-1.5, 20.0],
        [-1.5, 15.0],
        [-10.0, 15.0],
        [-10.0, 0.0],
        [10.0, 0.0],
        [10.0, 15.0],
        [1.5, 15.0],
        [1.5, 20.0],
        [20.0, 20.0],
    ]);
    let refused = compensated(&bottle, CompensationSide::Left, 2.0).unwrap_err();
    assert_eq!(refused.cause, GougeCause::Interference);
    let path = compensated(&bottle, CompensationSide::Left, 1.4).unwrap();
    check(&bottle, CompensationSide::Left, 1.4, &path);
}

#[test]
fn a_full_circle_stays_a_full_circle() {
    let circle = [PlaneSegment::arc([5.0, 0.0], [5.0, 0.0], [0.0, 0.0], false).unwrap()];
    for (side, radius) in [(CompensationSide::Left, 7.0), (CompensationSide::Right, 3.0)] {
        let path = compensated(&circle, side, 2.0).unwrap();
        check(&circle, side, 2.0, &path);
        assert!((length(&path) - TAU * radius).abs() < 1e-9);
    }
}

/// Back along the same line: the cutter goes around its end.
#[test]
fn a_reversal_is_rounded() {
    let spike = polyline(&[[0.0, 0.0], [10.0, 0.0], [0.0, 0.0]]);
    for side in [CompensationSide::Left, CompensationSide::Right] {
        let path = compensated(&spike, side, 2.0).unwrap();
        check(&spike, side, 2.0, &path);
        assert!((length(&path) - (20.0 + PI * 2.0)).abs() < 1e-9);
    }
}

/// A centre that a program has rounded to 1 µm is moved so that the arc meets both ends.
#[test]
fn an_arc_meets_its_ends_with_a_rounded_centre() {
    let arc = PlaneSegment::arc([10.0, 0.0], [0.0, 10.0], [0.001, -0.002], true).unwrap();
    assert!(distance(arc.at(0.0), [10.0, 0.0]) < 1e-12 && distance(arc.at(1.0), [0.0, 10.0]) < 1e-12);
    assert!(matches!(arc, PlaneSegment::Arc { sweep, .. } if (sweep - FRAC_PI_2).abs() < 1e-3));
}

/// A point that is programmed twice changes nothing.
#[test]
fn a_segment_without_length_is_left_out() {
    let contour = polyline(&[[0.0, 0.0], [10.0, 0.0], [10.0, 0.0], [10.0, 10.0], [10.0, 10.0]]);
    for side in [CompensationSide::Left, CompensationSide::Right] {
        let path = compensated(&contour, side, 2.0).unwrap();
        check(&polyline(&[[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]]), side, 2.0, &path);
    }
}

/// Back along an oblique line, not as far: the directions are opposite up to rounding.
#[test]
fn an_oblique_retrace_is_a_reversal() {
    for k in 1..200 {
        let (sin, cos) = (f64::from(k) * 0.031).sin_cos();
        let spike = polyline(&[[0.0, 0.0], [3.7 * cos, 3.7 * sin], [1.3 * cos, 1.3 * sin]]);
        for side in [CompensationSide::Left, CompensationSide::Right] {
            let path = compensated(&spike, side, 0.5).unwrap();
            assert!((length(&path) - (3.7 + 2.4 + PI * 0.5)).abs() < 1e-6);
        }
    }
}

/// 1 µm of radius on a chord of 0.05 mm would move the centre of this arc of nearly a full turn by 0.2 mm.
#[test]
fn an_arc_whose_centre_would_move_far_is_refused() {
    let angle = 0.005_f64;
    let end = [10.001 * angle.cos(), 10.001 * angle.sin()];
    assert_eq!(PlaneSegment::arc([10.0, 0.0], end, [0.0, 0.0], false), None);
    assert_eq!(PlaneSegment::arc([10.0, 0.0], [0.0, 10.2], [0.0, 0.0], true), None);
}

/// A polyline whose corners are rounded, every coordinate to 1 µm as a program has it.
fn rounded(points: &[PlanePoint], fillet: f64) -> Vec<PlaneSegment> {
    let micrometres = |p: PlanePoint| p.map(|x| (x * 1e3).round() / 1e3);
    let (mut contour, mut at) = (Vec::new(), micrometres(points[0]));
    for corner in points.windows(3) {
        let (into, out_of) = (polyline(&corner[..2])[0].direction(0.0), polyline(&corner[1..])[0].direction(0.0));
        let turn = (into[0] * out_of[1] - into[1] * out_of[0]).atan2(into[0] * out_of[0] + into[1] * out_of[1]);
        let cut = fillet * (turn.abs() / 2.0).tan();
        let [u, v] = corner[1];
        let from = micrometres([u - cut * into[0], v - cut * into[1]]);
        let to = micrometres([u + cut * out_of[0], v + cut * out_of[1]]);
        let side = fillet * turn.signum();
        let center = micrometres([u - cut * into[0] - side * into[1], v - cut * into[1] + side * into[0]]);
        contour.push(PlaneSegment::line(at, from));
        // Between nearly straight lines an arc of a few micrometres is left out.
        let arc = PlaneSegment::arc(from, to, center, turn > 0.0).filter(|_| distance(from, to) > 0.1);
        at = if arc.is_some() { to } else { from };
        contour.extend(arc);
    }
    contour.push(PlaneSegment::line(at, micrometres(points[points.len() - 1])));
    contour
}

/// A connected contour: each step turns by an angle and goes on by a line or an arc of some bend.
fn contour_of(steps: &[(f64, f64, f64)]) -> Vec<PlaneSegment> {
    let (mut at, mut heading) = ([0.0, 0.0], 0.0_f64);
    let segment = |&(turn, length, bend): &(f64, f64, f64)| {
        heading += turn;
        // An arc of this sweep has its chord turned by half of it.
        let (sin, cos) = (heading + bend / 2.0).sin_cos();
        let from = at;
        at = [from[0] + length * cos, from[1] + length * sin];
        if bend.abs() < 0.05 {
            return PlaneSegment::line(from, at);
        }
        let radius = length / (2.0 * (bend.abs() / 2.0).sin());
        let side = bend.signum() * radius;
        let center = [from[0] - side * heading.sin(), from[1] + side * heading.cos()];
        heading += bend;
        PlaneSegment::arc(from, at, center, bend > 0.0).unwrap()
    };
    steps.iter().map(segment).collect()
}

fn reversed(contour: &[PlaneSegment]) -> Vec<PlaneSegment> {
    contour.iter().rev().map(|segment| segment.part(1.0, 0.0)).collect()
}

fn any_side() -> impl Strategy<Value = CompensationSide> {
    prop_oneof![Just(CompensationSide::Left), Just(CompensationSide::Right)]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(200) })]

    /// Any contour, crossing itself or not: a path that is given out never gouges; reversed, the same path is found.
    #[test]
    fn a_path_never_gouges(
        steps in prop::collection::vec((-3.0..3.0_f64, 0.1..20.0_f64, -2.5..2.5_f64), 1..8),
        side in any_side(),
        radius in 0.01..3.0_f64,
    ) {
        let contour = contour_of(&steps);
        let back = if side == CompensationSide::Left { CompensationSide::Right } else { CompensationSide::Left };
        let other_way = compensated(&reversed(&contour), back, radius);
        match compensated(&contour, side, radius) {
            Ok(path) => {
                check(&contour, side, radius, &path);
                let other_way = other_way.expect("refused backwards only");
                prop_assert!((length(&path) - length(&other_way)).abs() < 1e-4);
            }
            Err(_) => prop_assert!(other_way.is_err(), "refused forwards only"),
        }
    }

    /// A contour with room is never refused: no steeper than 45°, and each segment six radii long. An inner corner of
    /// 90° takes one radius from either side.
    #[test]
    fn a_contour_with_room_is_never_refused(
        steps in prop::collection::vec((-FRAC_PI_4..FRAC_PI_4, 6.0..20.0_f64), 1..12),
        side in any_side(),
        radius in 0.1..1.0_f64,
    ) {
        let mut points = vec![[0.0, 0.0]];
        for (heading, length) in steps {
            let [u, v] = points[points.len() - 1];
            points.push([u + length * heading.cos(), v + length * heading.sin()]);
        }
        let contour = polyline(&points);
        for contour in [contour, rounded(&points, 2.5)] {
            match compensated(&contour, side, radius) {
                Ok(path) => check(&contour, side, radius, &path),
                Err(gouge) => prop_assert!(false, "{gouge:?} of {contour:?}"),
            }
        }
    }
}
