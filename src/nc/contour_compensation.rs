//! The contour of a cycle beside which a cutter runs: G41 or G42 in the blocks that G70 to G73 name. The contour is
//! offset by the radius before the cycle divides it. Lengths are radius millimetres. Source: spec B2 (G40–G42, G70–G73).

use super::compensation::{ActiveCutter, MIN_LENGTH_MM, gouge_error};
use super::contour_segment::ContourSegment;
use super::fault::E;
use crate::defs::text::arg::Arg;
use crate::geometry::{CutterPath, Gouge, OuterCorner, PlaneSegment};
use crate::units::WorkPos;

/// A mistake in a contour, with the details of its message.
pub(super) type ContourMistake = (E, [Arg; 2]);

/// The cutter of a contour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ContourCutter {
    pub active: ActiveCutter,
    /// The index of the operation that leads to the contour: the first move after G41 or G42.
    pub lead_in: usize,
    /// The last move of the contour leads away from it: its block has G40.
    pub leads_out: bool,
}

/// Offsets the segments of a contour by the cutter. `line` is that of a segment's block.
///
/// # Errors
/// The cutter does not fit, or the contour has no segment beside which it could run.
pub(super) fn offset_segments(
    segments: &mut Vec<ContourSegment>,
    ContourCutter { active, lead_in, leads_out }: ContourCutter,
    path: &mut CutterPath,
    line: impl Fn(usize) -> u32,
) -> Result<(), ContourMistake> {
    let begin = segments.iter().position(|segment| segment.source == lead_in).unwrap_or(0);
    let programmed = segments.split_off(begin);
    let code = [Arg::from(format_args!("G{}", active.compensation.g())), Arg::None];
    let [lead_in, contour @ ..] = programmed.as_slice() else { return Err((E::ContourEmpty, Default::default())) };
    let (contour, lead_out) = match (leads_out, contour) {
        (true, [contour @ .., last]) => (contour, Some(last)),
        (_, contour) => (contour, None),
    };
    if contour.is_empty() {
        return Err((E::CompensationWithoutContour, code));
    }
    if lead_in.arc.is_some() || lead_out.is_some_and(|last| last.arc.is_some()) {
        return Err((E::CompensationLead, code));
    }
    let refuse = |gouge: Gouge| {
        let other =
            contour.get(gouge.other).map_or(Arg::None, |other| Arg::from(format_args!("{}", line(other.source))));
        (gouge_error(gouge.cause), [Arg::from(format_args!("{:.3}", active.compensation.cutter.radius_mm)), other])
    };
    let point = |at: WorkPos| active.point(at);
    path.begin(active.compensation.side, active.compensation.cutter.radius_mm, Some(active.center(lead_in.from)));
    for (number, segment) in contour.iter().enumerate() {
        let (from, to) = (point(segment.from), point(segment.to));
        let shape = match segment.arc {
            None => Some(PlaneSegment::line(from, to)),
            Some((center, turn)) => PlaneSegment::arc(from, to, point(center), turn > 0),
        };
        let Some(shape) = shape else { return Err((E::ArcRadius, code)) };
        let corner = if segment.rapid { OuterCorner::Square } else { OuterCorner::Round };
        path.push(number, &shape, corner).map_err(refuse)?;
    }
    path.end(contour.len(), lead_out.map(|last| active.center(last.to))).map_err(refuse)?;
    put_path(segments, (lead_in, contour), active, path);
    segments
        .extend(lead_out.map(|last| ContourSegment { from: segments.last().map_or(last.from, |end| end.to), ..*last }));
    Ok(())
}

/// Appends the lead-in and the moves along the path.
fn put_path(
    segments: &mut Vec<ContourSegment>,
    (lead_in, contour): (&ContourSegment, &[ContourSegment]),
    active: ActiveCutter,
    path: &mut CutterPath,
) {
    let mut from = lead_in.from;
    let mut put = |of: &ContourSegment, to: WorkPos, arc: Option<(WorkPos, i8)>| {
        segments.push(ContourSegment { from: std::mem::replace(&mut from, to), to, arc, ..*of });
    };
    if let Some(lead) = path.take() {
        put(lead_in, active.tip(lead.path.at(1.0), lead_in.to), None);
    }
    while let Some(part) = path.take() {
        // The lead-out comes last.
        let Some(of) = contour.get(part.source) else { break };
        if part.path.length() <= MIN_LENGTH_MM {
            continue;
        }
        let arc = match part.path {
            PlaneSegment::Line { .. } => None,
            PlaneSegment::Arc { center, sweep, .. } => {
                Some((active.tip(center, of.to), if sweep > 0.0 { 1 } else { -1 }))
            }
        };
        put(of, active.tip(part.path.at(1.0), of.to), arc);
    }
}
