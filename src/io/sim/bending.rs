//! What bends under the normal force of grinding (P5): a slender part, the quill of an internal grinding spindle.
//!
//! The wheel removes the volume Q_w with the specific energy u at the speed v_s, so that it presses with
//!
//!   F_t = u·Q_w/v_s,   F_n = F_t/µ,   Q_w = b·π·d·v_f   (width b, diameter d, infeed v_f of the surface),
//!
//! and the contact is a spring in series with what bends: F_n = K·v_f with K = u·b·π·d/(µ·v_s). A compliance c delays the
//! size by c·K more than the machine's own time constant τ does:
//!
//!   τ(z) = τ·(1 + c(z)·K/τ).
//!
//! Both K and τ grow with the dullness of the wheel in proportion, so that the factor is that of a sharp one. DECISION: so they do
//! where the chips have an energy of their own; the force of ploughing bends nothing. The
//! compliances are those of Euler beams under a load at z. A part between centres becomes a barrel, the bore of a quill
//! narrower at its far end; both spark out. The width b is that of an even contact with the same force: the sum of the
//! overlaps over the greatest, so that a stroke loads its leading edge. Along a stroke the factor stretches the traverse
//! length, too (`contact_law`).
//!
//! Sources: S. Malkin, C. Guo, Grinding Technology, 2nd ed. 2008 (force and energy, time constant of plunge grinding); beam
//! deflections: Dubbel, Handbook of Mechanical Engineering, section C2.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use super::file_error::{SimFileError, refuse_value, require_not_negative, require_positive_fields as positive};
use super::machine_sections::{CuttingFile, DresserFile, WheelFile};

/// Young's modulus of steel, N/mm².
const STEEL_N_MM2: f64 = 210_000.0;
/// Lowest wheel speed used for the force, m/s; below it the force would grow without limit.
pub(super) const LOWEST_FORCE_SPEED_M_S: f64 = 1.0;

/// A part that bends: a round shaft of one diameter, part coordinates, mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShaftFile {
    /// Its diameter.
    pub diameter: f64,
    /// Z at which the chuck holds it, or the left centre.
    pub z_from: f64,
    /// Z of the right centre, or of the free end.
    pub z_to: f64,
    /// Held between two centres; else clamped at `z_from` and free at `z_to`.
    pub centred: bool,
}

/// An internal grinding spindle that is swung in for the part: a small wheel at the end of a quill from +Z.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InternalSpindleFile {
    /// Diameter of its new wheel, mm.
    pub wheel_diameter_mm: f64,
    /// Width of its wheel, mm.
    pub wheel_width_mm: f64,
    /// Grinding ratio of its wheel, as a multiple of that of the outer wheel.
    pub grinding_ratio_factor: f64,
    /// Turns for a turn of the wheel's own spindle.
    pub speed_ratio: f64,
    /// Diameter of the quill, mm.
    pub quill_diameter_mm: f64,
    /// Length of the quill, from the spindle to the middle of the wheel, mm.
    pub quill_length_mm: f64,
    /// Position of the infeed axis when the far rim of the new wheel touches the diamond, mm.
    pub dresser_infeed_mm: f64,
    /// Position of the diamond along the wheel's axis, mm.
    pub dresser_across_mm: f64,
}

impl ShaftFile {
    pub(super) fn check(&self) -> Result<(), SimFileError> {
        positive!("shaft", self; diameter)?;
        match self.z_to - self.z_from {
            length if length.is_finite() && length > 0.0 => Ok(()),
            length => refuse_value("shaft: length", length, "z_to must be above z_from"),
        }
    }
}

impl InternalSpindleFile {
    pub(super) fn check(&self) -> Result<(), SimFileError> {
        let name = "internal_spindle";
        positive!(name, self; wheel_diameter_mm wheel_width_mm grinding_ratio_factor speed_ratio quill_diameter_mm)?;
        require_not_negative("internal_spindle.quill_length_mm", self.quill_length_mm - self.wheel_width_mm)
    }

    /// The wheel of this spindle; its drive is that of the outer wheel.
    pub(super) fn wheel(&self, outer: &WheelFile) -> WheelFile {
        let (diameter_mm, width_mm) = (self.wheel_diameter_mm, self.wheel_width_mm);
        let grinding_ratio = outer.grinding_ratio * self.grinding_ratio_factor;
        WheelFile { diameter_mm, width_mm, grinding_ratio, ..outer.clone() }
    }

    /// The diamond of this spindle, at the far rim of its wheel.
    pub(super) fn dresser(&self, outer: &DresserFile) -> DresserFile {
        let (infeed_mm, across_mm) = (self.dresser_infeed_mm, self.dresser_across_mm);
        DresserFile { infeed_mm, across_mm, behind: true, roll: None, ..outer.clone() }
    }
}

/// A beam with a load on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Beam {
    /// Between two centres.
    Centred { from_mm: f64, to_mm: f64, stiffness_n_mm2: f64 },
    /// Clamped at a place, free towards +Z.
    Overhung { from_mm: f64, stiffness_n_mm2: f64 },
    /// The quill behind the wheel, clamped at its +Z end.
    Quill { length_mm: f64, stiffness_n_mm2: f64 },
}

/// E·I of a round beam, N·mm².
fn bending_stiffness_n_mm2(diameter_mm: f64) -> f64 {
    STEEL_N_MM2 * PI * diameter_mm.powi(4) / 64.0
}

impl Beam {
    pub(super) fn of_shaft(file: &ShaftFile) -> Self {
        let (from_mm, to_mm, stiffness_n_mm2) = (file.z_from, file.z_to, bending_stiffness_n_mm2(file.diameter));
        match file.centred {
            true => Self::Centred { from_mm, to_mm, stiffness_n_mm2 },
            false => Self::Overhung { from_mm, stiffness_n_mm2 },
        }
    }

    pub(super) fn of_quill(file: &InternalSpindleFile) -> Self {
        let stiffness_n_mm2 = bending_stiffness_n_mm2(file.quill_diameter_mm);
        Self::Quill { length_mm: file.quill_length_mm, stiffness_n_mm2 }
    }

    /// Deflection at z for a force there, mm/N; of a quill for a force at the middle of the wheel.
    fn compliance_mm_n(self, z_mm: f64, wheel_middle_mm: f64) -> f64 {
        match self {
            Self::Centred { from_mm, to_mm, stiffness_n_mm2 } => {
                let (left, right) = ((z_mm - from_mm).max(0.0), (to_mm - z_mm).max(0.0));
                (left * right).powi(2) / (3.0 * stiffness_n_mm2 * (to_mm - from_mm))
            }
            Self::Overhung { from_mm, stiffness_n_mm2 } => (z_mm - from_mm).max(0.0).powi(3) / (3.0 * stiffness_n_mm2),
            Self::Quill { length_mm, stiffness_n_mm2 } => {
                // Deflection L³/3 and slope L²/2 at its end, over E·I.
                let beyond = wheel_middle_mm - z_mm;
                length_mm * length_mm * (length_mm / 3.0 + beyond / 2.0) / stiffness_n_mm2
            }
        }
    }
}

/// What bends under the wheel in this tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bending {
    beam: Beam,
    /// K/τ for a contact area of one square millimetre, N/mm³.
    contact_n_mm3: f64,
}

impl Bending {
    /// A beam under a wheel of this speed, m/s.
    pub(super) fn new(beam: Beam, cutting: &CuttingFile, wheel_m_s: f64) -> Self {
        let wheel_mm_s = wheel_m_s.max(LOWEST_FORCE_SPEED_M_S) * 1_000.0;
        // J/mm³ = 1000 N/mm².
        let force_n_s_mm3 = cutting.energy_j_mm3 * 1_000.0 / (cutting.force_ratio * wheel_mm_s);
        Self { beam, contact_n_mm3: force_n_s_mm3 / cutting.sharp_s }
    }

    /// Factor of the time constant at z, for a contact of this width and radius, with the middle of the wheel there; all mm.
    pub(super) fn lag_factor(&self, z_mm: f64, width_mm: f64, radius_mm: f64, middle_mm: f64) -> f64 {
        let stiffness_n_mm = self.contact_n_mm3 * width_mm * 2.0 * PI * radius_mm;
        1.0 + (self.beam.compliance_mm_n(z_mm, middle_mm) * stiffness_n_mm).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::defs::kind::Kind;
    use crate::io::sim::MachineFile;

    /// Ø5 by 60 mm: I = π·625/64 = 30.68 mm⁴, E·I = 6.4427·10⁶ N·mm². In the middle L³/(48·E·I) = 216000/309.25·10⁶ =
    /// 0.00069847 mm/N; clamped at one end L³/(3·E·I) = 0.011175 mm/N at the other.
    #[test]
    fn p5_a_shaft_bends_as_a_beam() {
        let shaft = |centred| Beam::of_shaft(&ShaftFile { diameter: 5.0, z_from: 10.0, z_to: 70.0, centred });
        let at = |beam: Beam, z| beam.compliance_mm_n(z, 0.0);
        assert!((at(shaft(true), 40.0) - 0.000_698_47).abs() < 1e-7, "{}", at(shaft(true), 40.0));
        assert!([10.0, 70.0, 80.0].iter().all(|z| at(shaft(true), *z).abs() < 1e-12));
        assert!((at(shaft(false), 70.0) - 0.011_175).abs() < 1e-5, "{}", at(shaft(false), 70.0));
    }

    /// Ø16 by 70 mm: E·I = 210000·3216.99 = 6.7557·10⁸; L³/3 = 114333: 0.00016924 mm/N in the middle of the wheel;
    /// 10 mm farther L²·10/2/(E·I) = 0.00003627 more.
    #[test]
    fn p5_a_quill_bends_and_tilts() {
        let beam = Beam::Quill { length_mm: 70.0, stiffness_n_mm2: bending_stiffness_n_mm2(16.0) };
        assert!((beam.compliance_mm_n(30.0, 30.0) - 0.000_169_24).abs() < 1e-7);
        assert!((beam.compliance_mm_n(20.0, 30.0) - 0.000_205_51).abs() < 1e-7);
    }

    /// u = 40 J/mm³, µ = 0.4, v_s = 34.6 m/s, τ = 0.8 s: 40000/(0.4·34600·0.8) = 3.6127 N/mm³. On 18 mm of Ø40 the contact
    /// is as stiff as 3.6127·18·π·40 = 8172 N/mm; 0.0001 mm/N make 1 + 0.817.
    #[test]
    fn p5_the_lag_grows_with_width_diameter_and_compliance() {
        let cutting = MachineFile::builtin(Kind::Gc).unwrap().cutting;
        // 0.0001 mm/N at 100 mm from its clamping: 100³/3/0.0001.
        let beam = Beam::Overhung { from_mm: 0.0, stiffness_n_mm2: 1e6 / 3.0 / 0.000_1 };
        let bending = Bending::new(beam, &cutting, 34.6);
        let factor = bending.lag_factor(100.0, 18.0, 20.0, 100.0);
        assert!((factor - 1.817_2).abs() < 0.000_2, "{factor}");
    }
}
