//! The machine as data: `assets/machines/*.ron` (P, "all figures are data"). Text in, structure out; files are the
//! caller's business.

use serde::{Deserialize, Serialize};

use crate::defs::kind::Kind;

/// The machine of kind GC as built.
const GC: &str = include_str!("../../../assets/machines/gc.ron");
const GS: &str = include_str!("../../../assets/machines/gs.ron");
const GA: &str = include_str!("../../../assets/machines/ga.ron");

/// Longest error table over position.
const TABLE_LIMIT: usize = 1_000;

/// A point of a table over position: machine position and value there, both mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Along(pub f64, pub f64);

/// Why a machine or part file was not taken.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimFileError {
    /// The text is not of the form; RON says line and column.
    #[error("{0}")]
    Form(#[from] ron::error::SpannedError),
    /// A value makes no sense.
    #[error("{field} is {value}: {rule}")]
    Value {
        /// Field, with the surface's number where there are several.
        field: String,
        /// What was given.
        value: f64,
        /// What is wanted.
        rule: &'static str,
    },
}

/// A whole machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MachineFile {
    /// Kind of machine.
    pub kind: Kind,
    /// Axis X.
    pub x: AxisFile,
    /// Axis Y, where the machine has one.
    #[serde(default)]
    pub y: Option<AxisFile>,
    /// Axis Z.
    pub z: AxisFile,
    /// How long a contact bounces at every edge, s.
    pub bounce_s: f64,
    /// The wheel and its drive.
    pub wheel: WheelFile,
    /// The workhead.
    pub workhead: WorkheadFile,
    /// Pump and what it moves.
    pub hydraulics: HydraulicsFile,
    /// How the wheel cuts.
    pub cutting: CuttingFile,
    /// The dressing diamond, where there is one.
    #[serde(default)]
    pub dresser: Option<DresserFile>,
}

/// One axis. Positions are machine coordinates, slide travel (radius on X).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisFile {
    /// Where it stands when the power comes, mm.
    pub power_on_mm: f64,
    /// Natural frequency of the position loop, rad/s; the lag at constant speed is 2/ω.
    pub following_rad_s: f64,
    /// The drive's greatest acceleration, mm/s².
    pub accel_mm_s2: f64,
    /// The drive's greatest jerk, mm/s³.
    pub jerk_mm_s3: f64,
    /// Deceleration of the brake, mm/s².
    pub brake_mm_s2: f64,
    /// One encoder step, mm.
    pub resolution_mm: f64,
    /// Where the home switch changes, mm.
    pub home_edge_mm: f64,
    /// The home switch is active from its edge to the plus end; otherwise to the minus end.
    pub home_at_plus: bool,
    /// Limit switch towards plus, mm.
    pub limit_plus_mm: f64,
    /// Limit switch towards minus, mm.
    pub limit_minus_mm: f64,
    /// Hard stop towards plus, mm.
    pub stop_plus_mm: f64,
    /// Hard stop towards minus, mm.
    pub stop_minus_mm: f64,
    /// Play of the screw over motor position.
    #[serde(default)]
    pub backlash_mm: Vec<Along>,
    /// What the slide stands off over position.
    #[serde(default)]
    pub pitch_error_mm: Vec<Along>,
}

/// The wheel and its drive.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WheelFile {
    /// Diameter when new, mm.
    pub diameter_mm: f64,
    /// Width, mm.
    pub width_mm: f64,
    /// Speed at 10 V of the first analog output, rpm.
    pub rpm_at_10_v: f64,
    /// Speed without an analog voltage: the motor on the mains, rpm.
    pub mains_rpm: f64,
    /// From rest to `mains_rpm`, s.
    pub run_up_s: f64,
    /// From `mains_rpm` to rest, s.
    pub coast_down_s: f64,
    /// Power of the motor, W.
    pub power_w: f64,
    /// Load of the idling wheel, percent.
    pub idle_load_percent: f64,
    /// Volume of part removed for one volume of wheel.
    pub grinding_ratio: f64,
}

/// The workhead.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WorkheadFile {
    /// Speed of headstock-low without an analog voltage, rpm.
    pub low_rpm: f64,
    /// Speed of headstock-high without an analog voltage, rpm.
    pub high_rpm: f64,
    /// Least speed of the drive, rpm.
    pub least_rpm: f64,
    /// Greatest speed, at 10 V of the second analog output, rpm.
    pub greatest_rpm: f64,
    /// Time to reach a speed from rest, s.
    pub run_up_s: f64,
}

/// Pump, switch, and what the pressure moves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HydraulicsFile {
    /// Pressure of the pump, MPa.
    pub pressure_mpa: f64,
    /// Time constant, s.
    pub time_constant_s: f64,
    /// The pressure switch closes, MPa.
    pub switch_on_mpa: f64,
    /// The pressure switch opens, MPa.
    pub switch_off_mpa: f64,
    /// Least pressure that moves a cylinder, MPa.
    pub moves_from_mpa: f64,
    /// Travel of the tailstock, mm.
    pub tailstock_mm: f64,
    /// Time of that travel, s.
    pub tailstock_s: f64,
    /// Time of a gauge arm out or in, s.
    pub gauge_arm_s: f64,
    /// Stroke of the oscillation cylinder, mm.
    pub oscillation_mm: f64,
    /// Its speed, mm/s.
    pub oscillation_mm_s: f64,
    /// From coolant on to flow, s.
    pub coolant_s: f64,
    /// From gear output to gear in, s.
    pub gear_s: f64,
}

/// How the wheel cuts (P5, P6).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CuttingFile {
    /// Time constant of the contact with a sharp wheel, s.
    pub sharp_s: f64,
    /// The same with a dull wheel, s.
    pub dull_s: f64,
    /// Removed volume that makes a sharp wheel dull, mm³.
    pub dull_after_mm3: f64,
    /// Length of traverse that counts as one time constant, sharp wheel, along a cylinder, mm.
    pub traverse_cylinder_mm: f64,
    /// The same across a face, mm.
    pub traverse_face_mm: f64,
    /// Energy to remove a volume, J/mm³.
    pub energy_j_mm3: f64,
    /// Specific removal rate that burns, mm³/(mm·s).
    pub burn_mm2_s: f64,
    /// Overlap that is a crash, mm.
    pub crash_mm: f64,
    /// Overlap that is a crash when the wheel stands or turns below half its speed, mm.
    pub crash_standing_mm: f64,
    /// Overlap that grinds a flat on a part that stands, mm.
    pub flat_mm: f64,
    /// Below this the workhead counts as standing, rpm.
    pub part_stands_rpm: f64,
    /// Speed from which running onto a hard stop is a crash, mm/s.
    pub stop_crash_mm_s: f64,
}

/// The dressing diamond: a point, machine coordinates.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DresserFile {
    /// Machine X at which a new wheel's front touches it, mm.
    pub x_mm: f64,
    /// Its machine Z, mm; the wheel lies from its reference point towards plus.
    pub z_mm: f64,
    /// Depth that breaks it, mm.
    pub crash_mm: f64,
    /// Depth from which a pass sharpens, mm.
    pub sharpens_mm: f64,
}

impl MachineFile {
    /// The machine of a kind as built.
    ///
    /// # Errors
    /// The built-in text is wrong, which the tests rule out.
    pub fn builtin(kind: Kind) -> Result<Self, SimFileError> {
        match kind {
            Kind::Gc => Self::parse(GC),
            Kind::Gs => Self::parse(GS),
            Kind::Ga => Self::parse(GA),
        }
    }

    /// Reads a machine file.
    ///
    /// # Errors
    /// The form with line and column, or the first value that makes no sense.
    pub fn parse(text: &str) -> Result<Self, SimFileError> {
        let file: Self = ron::from_str(text)?;
        file.check()?;
        Ok(file)
    }

    fn check(&self) -> Result<(), SimFileError> {
        for (letter, axis) in [("x", Some(&self.x)), ("y", self.y.as_ref()), ("z", Some(&self.z))] {
            axis.map_or(Ok(()), |axis| axis.check(letter))?;
        }
        let positive = [
            ("wheel.diameter_mm", self.wheel.diameter_mm),
            ("wheel.width_mm", self.wheel.width_mm),
            ("wheel.mains_rpm", self.wheel.mains_rpm),
            ("wheel.run_up_s", self.wheel.run_up_s),
            ("wheel.coast_down_s", self.wheel.coast_down_s),
            ("wheel.power_w", self.wheel.power_w),
            ("wheel.grinding_ratio", self.wheel.grinding_ratio),
            ("workhead.run_up_s", self.workhead.run_up_s),
            ("hydraulics.time_constant_s", self.hydraulics.time_constant_s),
            ("hydraulics.tailstock_s", self.hydraulics.tailstock_s),
            ("hydraulics.gauge_arm_s", self.hydraulics.gauge_arm_s),
            ("hydraulics.oscillation_mm", self.hydraulics.oscillation_mm),
            ("cutting.sharp_s", self.cutting.sharp_s),
            ("cutting.dull_s", self.cutting.dull_s),
            ("cutting.dull_after_mm3", self.cutting.dull_after_mm3),
            ("cutting.traverse_cylinder_mm", self.cutting.traverse_cylinder_mm),
            ("cutting.traverse_face_mm", self.cutting.traverse_face_mm),
        ];
        positive.into_iter().try_for_each(|(field, value)| above_zero(field, value))
    }
}

impl AxisFile {
    fn check(&self, letter: &str) -> Result<(), SimFileError> {
        let wrong = |field: &str, value: f64, rule: &'static str| {
            Err(SimFileError::Value { field: format!("{letter}.{field}"), value, rule })
        };
        for (field, value) in [
            ("following_rad_s", self.following_rad_s),
            ("accel_mm_s2", self.accel_mm_s2),
            ("jerk_mm_s3", self.jerk_mm_s3),
            ("brake_mm_s2", self.brake_mm_s2),
            ("resolution_mm", self.resolution_mm),
        ] {
            above_zero(&format!("{letter}.{field}"), value)?;
        }
        if !(self.stop_minus_mm..=self.stop_plus_mm).contains(&self.power_on_mm) {
            return wrong("power_on_mm", self.power_on_mm, "must lie between the stops");
        }
        for (field, table) in [("backlash_mm", &self.backlash_mm), ("pitch_error_mm", &self.pitch_error_mm)] {
            if table.len() > TABLE_LIMIT {
                return wrong(field, table.len() as f64, "takes at most 1000 rows");
            }
            if let Some(pair) = table.windows(2).find(|pair| pair[0].0 >= pair[1].0) {
                return wrong(field, pair[1].0, "positions must rise");
            }
        }
        Ok(())
    }
}

/// Refuses what is not a positive, finite number.
pub(super) fn above_zero(field: &str, value: f64) -> Result<(), SimFileError> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(SimFileError::Value { field: field.to_owned(), value, rule: "must be above zero" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn p1_the_built_in_machine_has_the_figures_of_the_specification() {
        let gc = MachineFile::builtin(Kind::Gc).unwrap();
        assert_eq!(gc.kind, Kind::Gc);
        assert!(gc.y.is_none());
        let figures = [
            (2.0 / gc.x.following_rad_s, 0.020),
            (gc.x.resolution_mm, 0.001),
            (gc.bounce_s, 0.005),
            (gc.wheel.run_up_s, 8.0),
            (gc.wheel.coast_down_s, 60.0),
            (gc.wheel.grinding_ratio, 40.0),
            (gc.hydraulics.pressure_mpa, 3.0),
            (gc.hydraulics.switch_on_mpa, 2.5),
            (gc.hydraulics.switch_off_mpa, 2.2),
            (gc.cutting.sharp_s, 0.8),
            (gc.cutting.dull_s, 2.0),
        ];
        for (is, wanted) in figures {
            assert!((is - wanted).abs() < 1e-12, "{is} {wanted}");
        }
        assert!(gc.x.accel_mm_s2 > 800.0 && gc.x.jerk_mm_s3 > 20_000.0);
    }

    #[test]
    fn p1_a_wrong_machine_file_is_refused_with_its_place() {
        let unknown = GC.replacen("bounce_s", "bounce", 1);
        assert!(matches!(MachineFile::parse(&unknown), Err(SimFileError::Form(_))));
        let zero = GC.replacen("grinding_ratio: 40.0", "grinding_ratio: 0.0", 1);
        let said = MachineFile::parse(&zero).unwrap_err().to_string();
        assert_eq!(said, "wheel.grinding_ratio is 0: must be above zero");
        for kind in Kind::ALL {
            assert_eq!(MachineFile::builtin(kind).map(|file| file.kind), Ok(kind));
        }
    }
}
