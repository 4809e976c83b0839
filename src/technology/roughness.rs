//! Roughness of a ground surface. With the lead s_d and the depth a_d of the last pass of a single-point diamond, the removal
//! rate Q'w and the wheel speed v_s it is
//!
//!   Ra = R1 · s_d^(1/2) · a_d^(1/4) · (Q'w/v_s)^x,   x from 0.15 to 0.6.
//!
//! In spark-out Q'w decays, and Ra with it to about a half. Source: S. Malkin, C. Guo, Grinding Technology, 2nd ed. 2008,
//! chapter "Surface topography".

use super::dressing::effective_width_mm;

/// x. DECISION: in the middle of its range.
const EXPONENT: f64 = 0.3;
/// R1, for µm, mm and mm/s. DECISION: so that the technology page and the simulated machine agree: finishing at 0.5 mm³/(mm·s)
/// and 34.6 m/s, dressed 0.02 mm deep with the overlap ratio 4, makes Ra 0.4 µm.
const FACTOR_UM: f64 = 113.3;
/// What is left to remove at the end of a spark-out, mm³/(mm·s): from there on Ra stays. A tenth of the finishing rate above
/// makes a half of its Ra: 0.1^0.3.
const LEAST_REMOVAL_MM2_S: f64 = 0.05;
/// Lowest wheel speed for which the law is used, m/s.
const LEAST_WHEEL_M_S: f64 = 1.0;

/// The last pass of a dressing over the rim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DressingPass {
    /// Way of the diamond along the rim for a turn of the wheel, mm.
    pub lead_mm: f64,
    /// Depth of cut on the radius, mm.
    pub depth_mm: f64,
}

impl DressingPass {
    /// A pass of a depth with an overlap ratio.
    #[must_use]
    pub fn of_overlap(depth_mm: f64, overlap: f64) -> Self {
        Self { lead_mm: effective_width_mm(depth_mm) / overlap, depth_mm }
    }
}

/// Ra, µm, of a surface that a wheel dressed so removes at `removal_mm2_s`, mm³/(mm·s).
#[must_use]
pub fn roughness_um(pass: DressingPass, removal_mm2_s: f64, wheel_m_s: f64) -> f64 {
    let chip = removal_mm2_s.max(LEAST_REMOVAL_MM2_S) / (1_000.0 * wheel_m_s.max(LEAST_WHEEL_M_S));
    FACTOR_UM * pass.lead_mm.sqrt() * pass.depth_mm.powf(0.25) * chip.powf(EXPONENT)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: b_d = √(8·0.5·0.02) = 0.28284 mm, s_d = 0.070711 mm; 0.070711^½ = 0.26592, 0.02^¼ = 0.37606,
    /// (0.5/34600)^0.3 = 0.035318: 113.3·0.0035319 = 0.4002 µm.
    #[test]
    fn p6_roughness_follows_lead_depth_and_chip_thickness() {
        let fine = DressingPass::of_overlap(0.02, 4.0);
        let ra = |pass, removal| roughness_um(pass, removal, 34.6);
        assert!((ra(fine, 0.5) - 0.400_2).abs() < 0.000_5, "{}", ra(fine, 0.5));
        // Four times the lead: twice. A sixteenth of the depth: a half. Spark-out: 0.1^0.3 = 0.5012.
        let ratio = |pass, removal| ra(pass, removal) / ra(fine, 0.5);
        assert!((ratio(DressingPass { lead_mm: 4.0 * fine.lead_mm, ..fine }, 0.5) - 2.0).abs() < 1e-9);
        assert!((ratio(DressingPass { depth_mm: 0.02 / 16.0, ..fine }, 0.5) - 0.5).abs() < 1e-9);
        assert!((ratio(fine, 0.0) - 0.501_2).abs() < 1e-4);
        // Roughing at 5 mm³/(mm·s): 10^0.3 = 1.995.
        assert!((ratio(fine, 5.0) - 1.995_3).abs() < 1e-4);
    }
}
