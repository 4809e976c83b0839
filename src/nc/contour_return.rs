//! The way from the end of a contour back to the start: along one axis, then along the other one, both at rapid.
//!
//! A way that crosses the contour leads through the part. Lengths are radius millimetres in work coordinates.
//! Source: spec B2 (G70, G73).

use super::contour_segment::{ContourSegment, other_axis};
use crate::geometry::{PlanePoint, PlaneSegment};
use crate::units::{Axis, WorkPos};

/// What a way may come near without crossing it, mm: it may end on the contour, or slide along it.
const TOUCH_MM: f64 = 1e-6;
/// Longest step of an arc that counts as a line, radian: 4 µm of sagitta at a radius of 100 mm.
const ARC_STEP: f64 = 0.018;

/// The axis with which the way back begins: across the direction in which the contour runs. `first_axis`, that of the move to
/// the contour, where it runs in both directions or in neither. The first segment leads to the contour and is no part of it.
pub(super) fn return_axis(segments: &[ContourSegment], first_axis: Axis) -> Axis {
    let contour = segments.get(1..).unwrap_or_default();
    let runs = |axis: Axis| [1.0, -1.0].iter().any(|way| contour.iter().all(|segment| segment.goes_along(axis, *way)));
    match (runs(Axis::Z), runs(Axis::X)) {
        (true, false) => Axis::X,
        (false, true) => Axis::Z,
        (true, true) | (false, false) => first_axis,
    }
}

/// Whether the way back from the end of the contour, along an axis first, keeps to one side of the contour.
pub(super) fn is_return_free(segments: &[ContourSegment], start: WorkPos, first: Axis) -> bool {
    let contour = segments.get(1..).unwrap_or_default();
    let Some((last, rest)) = contour.split_last() else { return true };
    let mut corner = last.to;
    corner[first] = start[first];
    // The end of the contour may rise above the start, which lies outside of the stock.
    !crosses(contour, (last.to, corner), first) && !crosses(rest, (corner, start), other_axis(first))
}

/// Whether a way along an axis goes from one side of the contour to the other one, between its ends.
fn crosses(contour: &[ContourSegment], (from, to): (WorkPos, WorkPos), along: Axis) -> bool {
    let (low, high) = (from[along].min(to[along]), from[along].max(to[along]));
    let is_between = |place: f64| place > low + TOUCH_MM && place < high - TOUCH_MM;
    let level = from[other_axis(along)];
    let [place_of, height_of] = if along == Axis::Z { [0, 1] } else { [1, 0] };
    // On which side the contour was last, and where it lies on the way since.
    let (mut side, mut on_way) = (0.0, None::<[f64; 2]>);
    let mut before: Option<PlanePoint> = None;
    for point in contour.iter().flat_map(points) {
        let (place, height) = (point[place_of], point[height_of] - level);
        let now = if height.abs() <= TOUCH_MM { 0.0 } else { height.signum() };
        if now == 0.0 {
            on_way = Some(on_way.map_or([place, place], |[least, most]| [least.min(place), most.max(place)]));
        } else {
            if now * side < 0.0 {
                let last = before.unwrap_or(point);
                let part = height / (point[height_of] - last[height_of]);
                let crossing = place - part * (place - last[place_of]);
                let [least, most] = on_way.unwrap_or([crossing, crossing]);
                if is_between(least) || is_between(most) || (least <= low && most >= high && high > low) {
                    return true;
                }
            }
            (side, on_way) = (now, None);
        }
        before = Some(point);
    }
    false
}

/// Points along a segment as (z, x), its ends included.
fn points(segment: &ContourSegment) -> impl Iterator<Item = PlanePoint> {
    let of = |at: WorkPos| [at[Axis::Z], at[Axis::X]];
    let (from, to) = (of(segment.from), of(segment.to));
    let arc = segment.arc.and_then(|(center, turn)| PlaneSegment::arc(from, to, of(center), turn > 0));
    let path = arc.unwrap_or(PlaneSegment::line(from, to));
    let steps = match path {
        PlaneSegment::Line { .. } => 1,
        PlaneSegment::Arc { sweep, .. } => (sweep.abs() / ARC_STEP).ceil().max(1.0) as usize,
    };
    (0..=steps).map(move |step| path.at(step as f64 / steps as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A contour of lines through points (z, x), and its start, which is the first one.
    fn contour(points: &[[f64; 2]]) -> (Vec<ContourSegment>, WorkPos) {
        let at = |[z, x]: [f64; 2]| WorkPos::from_fn(|axis| if axis == Axis::X { x } else { z });
        let segment = |pair: &[[f64; 2]]| ContourSegment {
            from: at(pair[0]),
            to: at(pair[1]),
            arc: None,
            rapid: false,
            source: 0,
        };
        (points.windows(2).map(segment).collect(), at(points[0]))
    }

    #[test]
    fn the_way_back_begins_across_the_contour() {
        // A shoulder: Z runs one way, X does not.
        let (segments, start) = contour(&[
            [2.0, 25.0],
            [0.0, 25.0],
            [-10.0, 15.0],
            [-20.0, 15.0],
            [-30.0, 24.0],
            [-40.0, 24.0],
            [-50.0, 15.0],
        ]);
        assert_eq!(return_axis(&segments, Axis::Z), Axis::X);
        assert!(is_return_free(&segments, start, Axis::X));
        // A rib on a face: X runs one way.
        let (segments, start) =
            contour(&[[2.0, 30.0], [-10.0, 28.0], [-10.0, 20.0], [-1.0, 15.0], [-1.0, 10.0], [-8.0, 5.0], [-8.0, 0.0]]);
        assert_eq!(return_axis(&segments, Axis::X), Axis::Z);
        assert!(is_return_free(&segments, start, Axis::Z) && !is_return_free(&segments, start, Axis::X));
        // A cone runs both ways.
        let (segments, _) = contour(&[[2.0, 25.0], [0.0, 25.0], [-30.0, 10.0]]);
        assert_eq!([Axis::X, Axis::Z].map(|axis| return_axis(&segments, axis)), [Axis::X, Axis::Z]);
    }

    #[test]
    fn a_corner_on_the_way_is_crossed_only_if_the_contour_goes_through() {
        // Along X at Z-20: the contour touches that line at X20 from one side, or goes through it there.
        let (touching, start) = contour(&[[2.0, 30.0], [0.0, 20.0], [-20.0, 20.0], [-10.0, 10.0], [-20.0, 5.0]]);
        assert!(is_return_free(&touching, start, Axis::X));
        let (through, start) = contour(&[[2.0, 30.0], [-25.0, 22.0], [-20.0, 20.0], [-10.0, 10.0], [-20.0, 5.0]]);
        assert!(!is_return_free(&through, start, Axis::X));
        // It lies on the line for a stretch.
        let (along, start) =
            contour(&[[2.0, 30.0], [-25.0, 22.0], [-20.0, 20.0], [-20.0, 12.0], [-10.0, 10.0], [-20.0, 5.0]]);
        assert!(!is_return_free(&along, start, Axis::X));
    }
}
