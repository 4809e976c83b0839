//! A chamfer or a rounding between two segments of a contour.

use super::plane_segment::{MIN_LENGTH_MM, PlaneSegment, along, cross, dot};

/// What lies between two segments in place of their corner. Lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Corner {
    /// A chamfer that begins and ends at this distance from the corner.
    ChamferLeg(f64),
    /// A chamfer of this length.
    ChamferLength(f64),
    /// An arc of this radius, tangent to both segments.
    Radius(f64),
}

/// Why two segments cannot have a corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CornerMistake {
    /// It needs more of a segment than there is, or the segments turn back.
    DoesNotFit,
    /// A chamfer beside an arc.
    ChamferAtArc,
}

/// Sine of the angle between two segments below which there is no corner: one degree, as FANUC has it.
const STRAIGHT_SINE: f64 = 0.017_452_406;

impl Corner {
    /// Leg, length or radius, mm.
    #[must_use]
    pub const fn size_mm(self) -> f64 {
        match self {
            Self::ChamferLeg(mm) | Self::ChamferLength(mm) | Self::Radius(mm) => mm,
        }
    }

    /// The line or arc between two segments, of which the second begins where the first ends. Its ends are where the
    /// first segment ends and the second begins with it. None if the segments go on straight.
    ///
    /// # Errors
    /// The corner does not fit.
    pub fn between(self, first: &PlaneSegment, second: &PlaneSegment) -> Result<Option<PlaneSegment>, CornerMistake> {
        let (before, behind) = (first.direction(1.0), second.direction(0.0));
        let sine = cross(before, behind);
        if sine.abs() < STRAIGHT_SINE {
            return if dot(before, behind) > 0.0 { Ok(None) } else { Err(CornerMistake::DoesNotFit) };
        }
        match self {
            Self::Radius(radius) => fillet(first, second, radius * sine.signum()).map(Some),
            Self::ChamferLeg(leg) => chamfer(first, second, leg).map(Some),
            Self::ChamferLength(length) => {
                // The half of the angle between the segments, seen from the corner: cos 2a = −before·behind.
                let half_sine = ((1.0 + dot(before, behind)) / 2.0).max(0.0).sqrt();
                chamfer(first, second, length / (2.0 * half_sine)).map(Some)
            }
        }
    }
}

fn chamfer(first: &PlaneSegment, second: &PlaneSegment, leg: f64) -> Result<PlaneSegment, CornerMistake> {
    let (PlaneSegment::Line { to: corner, .. }, PlaneSegment::Line { .. }) = (*first, *second) else {
        return Err(CornerMistake::ChamferAtArc);
    };
    if leg > first.length().min(second.length()) + MIN_LENGTH_MM {
        return Err(CornerMistake::DoesNotFit);
    }
    Ok(PlaneSegment::line(along(corner, first.direction(1.0), -leg), along(corner, second.direction(0.0), leg)))
}

/// The arc with a radius, tangent to both: positive to the left of the travel. Its centre is where the parallels of the
/// segments at that distance cross.
fn fillet(first: &PlaneSegment, second: &PlaneSegment, radius: f64) -> Result<PlaneSegment, CornerMistake> {
    let parallels = first.parallel(radius).zip(second.parallel(radius));
    let (one, other) = parallels.ok_or(CornerMistake::DoesNotFit)?;
    // The crossing next to the corner.
    let crossings = one.crossings(&other).into_iter().flatten();
    let (end, start) = crossings.max_by(|a, b| a.0.total_cmp(&b.0)).ok_or(CornerMistake::DoesNotFit)?;
    PlaneSegment::arc(first.at(end), second.at(start), one.at(end), radius > 0.0).ok_or(CornerMistake::DoesNotFit)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: [f64; 2], b: [f64; 2]) -> bool {
        (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-9
    }

    #[test]
    fn a_right_angle_has_legs_and_radii_of_the_same_length() {
        let first = PlaneSegment::line([0.0, 0.0], [10.0, 0.0]);
        for (side, second) in [(1.0, [10.0, 5.0]), (-1.0, [10.0, -5.0])] {
            let second = PlaneSegment::line([10.0, 0.0], second);
            for corner in [Corner::ChamferLeg(2.0), Corner::ChamferLength(8_f64.sqrt()), Corner::Radius(2.0)] {
                let joint = corner.between(&first, &second).unwrap().unwrap();
                assert!(close(joint.at(0.0), [8.0, 0.0]) && close(joint.at(1.0), [10.0, 2.0 * side]), "{corner:?}");
            }
            assert_eq!(Corner::Radius(5.1).between(&first, &second), Err(CornerMistake::DoesNotFit));
            assert_eq!(Corner::ChamferLeg(5.1).between(&first, &second), Err(CornerMistake::DoesNotFit));
        }
    }

    #[test]
    fn an_acute_corner_of_60_degrees() {
        // Tangents of a circle of radius 1 from a corner of 60° are 1/tan 30° = √3 long, a chamfer of length c has legs c.
        let first = PlaneSegment::line([0.0, 0.0], [10.0, 0.0]);
        let second = PlaneSegment::line([10.0, 0.0], [10.0 - 5.0, 5.0 * 3_f64.sqrt()]);
        let round = Corner::Radius(1.0).between(&first, &second).unwrap().unwrap();
        assert!(close(round.at(0.0), [10.0 - 3_f64.sqrt(), 0.0]));
        let chamfer = Corner::ChamferLength(2.0).between(&first, &second).unwrap().unwrap();
        assert!(close(chamfer.at(0.0), [8.0, 0.0]) && close(chamfer.at(1.0), [9.0, 3_f64.sqrt()]));
    }

    #[test]
    fn a_line_into_an_arc_is_rounded_inside_and_outside() {
        // A quarter around (10, 5) from (10, 0)... the line comes up from below into it.
        let first = PlaneSegment::line([10.0, -8.0], [10.0, 0.0]);
        let arc = PlaneSegment::arc([10.0, 0.0], [15.0, 5.0], [10.0, 5.0], true).unwrap();
        let joint = Corner::Radius(1.0).between(&first, &arc).unwrap().unwrap();
        let PlaneSegment::Arc { center, radius, .. } = joint else { panic!("no arc") };
        // Right of the line by 1, and outside of the arc of 5 by 1: (11, 5 − √35).
        assert!(close(center, [11.0, 5.0 - 35_f64.sqrt()]) && (radius - 1.0).abs() < 1e-9);
        assert_eq!(Corner::ChamferLeg(1.0).between(&first, &arc), Err(CornerMistake::ChamferAtArc));
    }

    #[test]
    fn straight_on_has_no_corner_and_turning_back_none_that_fits() {
        let first = PlaneSegment::line([0.0, 0.0], [10.0, 0.0]);
        let on = PlaneSegment::line([10.0, 0.0], [20.0, 0.1]);
        let back = PlaneSegment::line([10.0, 0.0], [0.0, 0.1]);
        assert_eq!(Corner::Radius(1.0).between(&first, &on), Ok(None));
        assert_eq!(Corner::Radius(1.0).between(&first, &back), Err(CornerMistake::DoesNotFit));
    }
}
