//! Specific energy and heat of a contact (P2, P5): power of the wheel motor, forces, burn.
//!
//! The specific energy u has three parts: of the chips, of ploughing, of sliding. With the removal rate per width Q'w, the wheel
//! speed v_s and the factor δ by which the contact of a dull wheel is slower than that of a sharp one:
//!
//!   u = u_ch + F'_pl·v_s/Q'w + (u_0 − u_ch)·δ.
//!
//! Chips take the same energy whatever the wheel is like (13.8 J/mm³ of steel), ploughing the same force per width (about
//! 1 N/mm) until it fades at the end of a spark-out: it is what makes small removal rates costly. Sliding grows with δ,
//! because the time constant is the force per infeed (`bending`): wear flats rub and remove nothing. Sources: S. Malkin,
//! C. Guo, Grinding Technology, 2nd ed. 2008, chapter "Grinding mechanisms"; S. Malkin, N. H. Cook, J. Eng. Ind. 93 (1971)
//! 1120.
//!
//! A sharp wheel burns the part under coolant at the removal rate of the machine file, at its work speed. For another energy
//! and work speed it is the law of Malkin and Lenz (`technology::burn_limit_mm2_s`): a dull wheel burns earlier,
//! and so do a slow part and a dry contact. The equivalent diameter is that for which the machine file's limit holds.

use std::ops::AddAssign;

use super::contact_law::Cut;
use super::machine_sections::CuttingFile;
use crate::technology::burn_limit_mm2_s;

/// Heat in the part without coolant, as a multiple of that with coolant. DECISION: 85 and 65 percent, at the ends of the
/// range that Malkin and Guo give for shallow-cut grinding.
const DRY_FACTOR: f64 = 0.85 / 0.65;
/// Removal rate per width at which ploughing has 63 % of its force, mm³/(mm·s): it fades as grains lose the contact. DECISION.
const PLOUGHING_MM2_S: f64 = 0.05;
/// Lowest work speed used, as a share of that of the burn limit: a table that reverses does not burn.
const LEAST_WORK_SHARE: f64 = 0.1;

/// Power that a contact takes from the wheel motor, W, by what it is spent on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct ContactPower {
    pub chip_w: f64,
    pub ploughing_w: f64,
    pub sliding_w: f64,
}

impl ContactPower {
    /// Of a cut within a tick.
    pub(super) fn of_cut(cutting: &CuttingFile, cut: &Cut, wheel_m_s: f64, dt_s: f64) -> Self {
        if cut.specific_mm2 <= 0.0 {
            return Self::default();
        }
        // J/mm³ · mm³/s = W; N/mm · mm · m/s = W.
        let (rate, width_mm) = (cut.volume_mm3 / dt_s, cut.volume_mm3 / cut.specific_mm2);
        let presses = -(-cut.specific_mm2 / dt_s / PLOUGHING_MM2_S).exp_m1();
        Self {
            chip_w: cutting.chip_j_mm3 * rate,
            ploughing_w: cutting.ploughing_n_mm * width_mm * wheel_m_s * presses,
            sliding_w: (cutting.energy_j_mm3 - cutting.chip_j_mm3) * cut.dullness_factor * rate,
        }
    }

    pub(super) fn whole_w(self) -> f64 {
        self.chip_w + self.ploughing_w + self.sliding_w
    }
}

impl AddAssign for ContactPower {
    fn add_assign(&mut self, more: Self) {
        self.chip_w += more.chip_w;
        self.ploughing_w += more.ploughing_w;
        self.sliding_w += more.sliding_w;
    }
}

/// Whether a cut within a tick, which takes this power, burns the part.
pub(super) fn burns(cutting: &CuttingFile, cut: &Cut, power: ContactPower, dt_s: f64, coolant_flows: bool) -> bool {
    if cut.specific_mm2 <= 0.0 {
        return false;
    }
    let heat_j_mm3 = power.whole_w() * dt_s / cut.volume_mm3 * if coolant_flows { 1.0 } else { DRY_FACTOR };
    cut.specific_mm2 > burn_limit(cutting, heat_j_mm3, cut.work_mm_s) * dt_s
}

/// Removal rate per width from which a contact burns the part, mm³/(mm·s), for the energy that heats it as under coolant.
fn burn_limit(cutting: &CuttingFile, heat_j_mm3: f64, work_mm_s: Option<f64>) -> f64 {
    let reference = cutting.burn_work_mm_s.unwrap_or(1.0);
    let turns = cutting.burn_work_mm_s.and(work_mm_s);
    let work = turns.map_or(reference, |mm_s| mm_s.max(LEAST_WORK_SHARE * reference));
    // The equivalent diameter is that of the machine file's limit.
    let law = |energy: f64, work_mm_s: f64| burn_limit_mm2_s(energy, 1.0, work_mm_s);
    let (sharp, here) = (law(cutting.energy_j_mm3, reference), law(heat_j_mm3, work));
    if sharp.is_finite() { cutting.burn_mm2_s * here / sharp } else { cutting.burn_mm2_s }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::defs::kind::Kind;
    use crate::io::sim::MachineFile;

    fn limit(dullness_factor: f64, work_mm_s: f64, coolant_flows: bool) -> f64 {
        let cutting = MachineFile::builtin(Kind::Gc).unwrap().cutting;
        let heat = cutting.energy_j_mm3 * dullness_factor * if coolant_flows { 1.0 } else { DRY_FACTOR };
        burn_limit(&cutting, heat, Some(work_mm_s))
    }

    /// 8 mm²/s at 420 mm/s; 40 J/mm³. Dull, 2.5 times the energy: 8·(33.8/93.8)^(4/3) = 2.052; an eighth of the work
    /// speed: 4; dry, 52.308 J/mm³ count: 8·(33.8/46.108)^(4/3) = 5.288.
    #[test]
    fn p5_dull_slow_or_dry_burns_earlier() {
        for (found, wanted) in [
            (limit(1.0, 420.0, true), 8.0),
            (limit(2.5, 420.0, true), 2.052),
            (limit(1.0, 52.5, true), 4.0),
            (limit(1.0, 420.0, false), 5.288),
            // A tenth of the work speed is the least: 8·0.1^(1/3).
            (limit(1.0, 0.0, true), 3.713),
        ] {
            assert!((found - wanted).abs() < 0.001, "{found} {wanted}");
        }
    }

    /// Chips 13.8, sliding 26.2 J/mm³, ploughing 1 N/mm. 18 mm wide at 1 mm²/s and 34.6 m/s: 18 mm³/s take 248.4 W, 471.6 W,
    /// 622.8 W: 74.6 J/mm³; at 8 mm²/s 44.3. Dull, 2.5 times the sliding: 113.9.
    #[test]
    fn p2_small_removal_rates_are_costly_by_ploughing_and_only_sliding_grows_with_dullness() {
        let text = "(chip_j_mm3: Some(13.8), ploughing_n_mm: Some(1.0))";
        let cutting = MachineFile::of_text(text, Kind::Gc).unwrap().cutting;
        let power = |removal_mm2_s: f64, dullness_factor: f64| {
            let specific_mm2 = removal_mm2_s * 0.001;
            let cut = Cut { volume_mm3: 18.0 * specific_mm2, specific_mm2, dullness_factor, ..Cut::default() };
            ContactPower::of_cut(&cutting, &cut, 34.6, 0.001)
        };
        let near = |found: f64, wanted: f64| assert!((found - wanted).abs() < 0.05, "{found} {wanted}");
        let sharp = power(1.0, 1.0);
        near(sharp.chip_w, 248.4);
        near(sharp.sliding_w, 471.6);
        near(sharp.ploughing_w, 622.8);
        near(sharp.whole_w() / 18.0, 74.6);
        near(power(8.0, 1.0).whole_w() / 144.0, 44.325);
        near(power(1.0, 2.5).whole_w() / 18.0, 113.9);
    }
}
