//! Specific energy and heat of a contact (P2, P5): power of the wheel motor, forces, burn.
//!
//! The specific energy of a dull wheel is that of a sharp one times the factor by which its contact is slower, because the
//! time constant is the force per infeed (`bending`): wear flats rub and remove nothing (S. Malkin, N. H. Cook, J. Eng. Ind.
//! 93 (1971) 1120: both forces grow in proportion to the wear flats).
//!
//! A sharp wheel burns the part under coolant at the removal rate of the machine file, at its work speed. For another energy
//! and work speed it is the law of Malkin and Lenz (`technology::burn_limit_mm2_s`): a dull wheel burns earlier, and so do a slow part and a dry contact. The equivalent diameter is
//! that for which the machine file's limit holds.

use super::contact_law::Cut;
use super::machine_sections::CuttingFile;
use crate::technology::burn_limit_mm2_s;

/// Heat in the part without coolant, as a multiple of that with coolant. DECISION: 85 and 65 percent, at the ends of the
/// range that Malkin and Guo give for shallow-cut grinding.
const DRY_FACTOR: f64 = 0.85 / 0.65;
/// Lowest work speed used, as a share of that of the burn limit: a table that reverses does not burn.
const LEAST_WORK_SHARE: f64 = 0.1;

/// Specific energy of a contact, J/mm³.
fn specific_energy_j_mm3(cutting: &CuttingFile, cut: &Cut) -> f64 {
    cutting.energy_j_mm3 * cut.dullness_factor
}

/// Power that a contact takes from the wheel motor, W.
pub(super) fn power_w(cutting: &CuttingFile, cut: &Cut, dt_s: f64) -> f64 {
    // J/mm³ · mm³/s = W.
    specific_energy_j_mm3(cutting, cut) * cut.volume_mm3 / dt_s
}

/// Removal rate per width from which a contact burns the part, mm³/(mm·s).
pub(super) fn burn_limit(cutting: &CuttingFile, cut: &Cut, coolant_flows: bool) -> f64 {
    let reference = cutting.burn_work_mm_s.unwrap_or(1.0);
    let turns = cutting.burn_work_mm_s.and(cut.work_mm_s);
    let work = turns.map_or(reference, |mm_s| mm_s.max(LEAST_WORK_SHARE * reference));
    let heat = specific_energy_j_mm3(cutting, cut) * if coolant_flows { 1.0 } else { DRY_FACTOR };
    // The equivalent diameter is that of the machine file's limit.
    let law = |energy: f64, work_mm_s: f64| burn_limit_mm2_s(energy, 1.0, work_mm_s);
    let (sharp, here) = (law(cutting.energy_j_mm3, reference), law(heat, work));
    if sharp.is_finite() { cutting.burn_mm2_s * here / sharp } else { cutting.burn_mm2_s }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::defs::kind::Kind;
    use crate::io::sim::MachineFile;

    fn limit(dullness_factor: f64, work_mm_s: f64, coolant_flows: bool) -> f64 {
        let work_mm_s = Some(work_mm_s);
        let cutting = MachineFile::builtin(Kind::Gc).unwrap().cutting;
        burn_limit(&cutting, &Cut { dullness_factor, work_mm_s, ..Cut::default() }, coolant_flows)
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
}
