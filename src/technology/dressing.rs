//! Dressing with a single-point diamond: what its lead means for the wheel. Source: F. Klocke, Manufacturing Processes 2,
//! 2009, section "dressing": overlap ratio U_d = b_d / f_d.

/// Radius of the tip of a single-point diamond, mm.
const DIAMOND_RADIUS_MM: f64 = 0.5;
/// Below this overlap ratio the wheel gets a thread that the part shows.
const LEAST_OVERLAP: f64 = 2.0;
/// Up to this overlap ratio the wheel is open and cuts freely; above it is fine.
const OPEN_OVERLAP: f64 = 4.0;
/// Above this overlap ratio the wheel is dull and burns.
const MOST_OVERLAP: f64 = 10.0;

/// What a wheel is like behind a dressing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DressedWheel {
    /// The lead is wider than the diamond allows: marks on the part.
    Threaded,
    /// Open: for roughing.
    Open,
    /// Fine: for finishing.
    Fine,
    /// Closed: it rubs and burns.
    Dull,
}

impl DressedWheel {
    /// By the overlap ratio of the dressing.
    #[must_use]
    pub fn of_overlap(overlap: f64) -> Self {
        match overlap {
            overlap if overlap < LEAST_OVERLAP => Self::Threaded,
            overlap if overlap < OPEN_OVERLAP => Self::Open,
            overlap if overlap <= MOST_OVERLAP => Self::Fine,
            _ => Self::Dull,
        }
    }
}

/// The effective width b_d of the diamond at a depth of pass, mm: the chord of its tip.
#[must_use]
pub fn effective_width_mm(depth_mm: f64) -> f64 {
    (8.0 * DIAMOND_RADIUS_MM * depth_mm).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// √(8·0.5·0.01) = 0.2 mm; a lead of 0.05 mm overlaps four times.
    #[test]
    fn p6_the_overlap_of_a_dressing_tells_what_the_wheel_is_like() {
        let width = effective_width_mm(0.01);
        assert!((width - 0.2).abs() < 1e-12, "{width}");
        let of_lead = |lead_mm: f64| DressedWheel::of_overlap(width / lead_mm);
        let told = [0.2, 0.08, 0.05, 0.03, 0.01].map(of_lead);
        use DressedWheel::{Dull, Fine, Open, Threaded};
        assert_eq!(told, [Threaded, Open, Fine, Fine, Dull]);
    }
}
