//! Machine files: `assets/machines/*.ron` (P, "all figures are data"). Parses text; the caller reads the
//! files.

use serde::{Deserialize, Serialize};

use super::file_error::{SimFileError, require_positive};
use super::machine_sections::{
    AxisFile, CuttingFile, DresserFile, DriveFile, GaugesFile, HydraulicsFile, LayoutFile, MagnetFile, MainSpindleFile,
    ScatterFile, SecondSpindleFile, ToolTurretFile, WheelFile,
};
use crate::defs::kind::Kind;
use crate::units::PerAxis;

/// A whole machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MachineFile {
    /// Kind of machine.
    pub kind: Kind,
    /// Assignment of the axes to the wheel's directions.
    pub layout: LayoutFile,
    /// Axis X.
    pub x: AxisFile,
    /// Axis Y, if the machine always has one.
    #[serde(default)]
    pub y: Option<AxisFile>,
    /// Axis Y, if it is an option (P6.6).
    #[serde(default)]
    pub y_optional: Option<AxisFile>,
    /// Axis Z.
    pub z: AxisFile,
    /// Bounce time of a contact at every edge, s.
    pub bounce_s: f64,
    /// The wheel and its drive.
    pub wheel: WheelFile,
    /// The workhead, if the part rotates between centres or in a chuck.
    #[serde(default)]
    pub workhead: Option<DriveFile>,
    /// The drive of a rotary table.
    #[serde(default)]
    pub table: Option<DriveFile>,
    /// The main spindle of a lathe.
    #[serde(default)]
    pub main_spindle: Option<MainSpindleFile>,
    /// The tool turret of a lathe.
    #[serde(default)]
    pub tool_post: Option<ToolTurretFile>,
    /// The second spindle.
    pub second_spindle: SecondSpindleFile,
    /// Pump and the actuators that it moves.
    pub hydraulics: HydraulicsFile,
    /// The magnetic chuck, if there is one.
    #[serde(default)]
    pub magnet: Option<MagnetFile>,
    /// The gauges.
    pub gauges: GaugesFile,
    /// How the wheel cuts.
    pub cutting: CuttingFile,
    /// The dresser, if there is one.
    #[serde(default)]
    pub dresser: Option<DresserFile>,
    /// Seeded variation of the machine. Without it only contacts, gauges and parts depend on the seed.
    #[serde(default)]
    pub scatter: Option<ScatterFile>,
}

impl MachineFile {
    /// The built-in machine of a kind.
    ///
    /// # Errors
    /// The built-in file is wrong, which a test excludes.
    pub fn builtin(kind: Kind) -> Result<Self, SimFileError> {
        Self::parse(kind.row().machine_file)
    }

    /// Parses a machine file.
    ///
    /// # Errors
    /// The syntax error with line and column, or the first invalid value.
    pub fn parse(text: &str) -> Result<Self, SimFileError> {
        let file: Self = ron::from_str(text)?;
        file.check()?;
        Ok(file)
    }

    /// The axes of this machine, with Y if it is standard or fitted as an option.
    pub(super) fn axes(&self, y_fitted: bool) -> PerAxis<Option<&AxisFile>> {
        let fitted = if y_fitted { self.y_optional.as_ref() } else { None };
        PerAxis([Some(&self.x), self.y.as_ref().or(fitted), Some(&self.z)])
    }

    fn check(&self) -> Result<(), SimFileError> {
        for (axis, file) in self.axes(true).iter() {
            file.map_or(Ok(()), |file| file.check(&axis.letter().to_ascii_lowercase().to_string()))?;
        }
        if let Some(spindle) = &self.main_spindle {
            require_positive("main_spindle.run_up_s", spindle.run_up_s)?;
            require_positive("main_spindle.encoder_steps", spindle.encoder_steps)?;
        }
        if let Some(post) = &self.tool_post {
            require_positive("tool_post.step_s", post.step_s)?;
        }
        let roll = self.dresser.as_ref().and_then(|dresser| dresser.roll.as_ref());
        let roll_drive = roll.map(|roll| &roll.drive);
        for (name, drive) in
            [("workhead", self.workhead.as_ref()), ("table", self.table.as_ref()), ("dresser.roll.drive", roll_drive)]
        {
            drive.map_or(Ok(()), |drive| drive.check(name))?;
        }
        self.check_layout()?;
        self.positive_fields().into_iter().try_for_each(|(field, value)| require_positive(field, value))?;
        if let Some(quill) = &self.hydraulics.tailstock {
            require_positive("hydraulics.tailstock.travel_s", quill.travel_s)?;
        }
        self.magnet
            .iter()
            .flat_map(MagnetFile::positive_fields)
            .try_for_each(|(field, value)| require_positive(field, value))
    }

    /// Checks that the axes of the layout exist and differ.
    fn check_layout(&self) -> Result<(), SimFileError> {
        let LayoutFile { infeed, across, stroke, centre: _ } = self.layout;
        for axis in [Some(infeed), Some(across), stroke].into_iter().flatten() {
            if self.axes(false)[axis].is_none() {
                let what = format!("layout: axis {axis}");
                return Err(SimFileError::Incompatible { what, rule: "the machine has no such axis" });
            }
        }
        if infeed == across || stroke == Some(infeed) || stroke == Some(across) {
            let rule = "infeed, across and stroke are three different axes";
            return Err(SimFileError::Incompatible { what: "layout".to_owned(), rule });
        }
        Ok(())
    }

    fn positive_fields(&self) -> [(&'static str, f64); 23] {
        [
            ("wheel.diameter_mm", self.wheel.diameter_mm),
            ("wheel.width_mm", self.wheel.width_mm),
            ("wheel.rated_m_s", self.wheel.rated_m_s),
            ("wheel.mains_rpm", self.wheel.mains_rpm),
            ("wheel.run_up_s", self.wheel.run_up_s),
            ("wheel.coast_down_s", self.wheel.coast_down_s),
            ("wheel.power_w", self.wheel.power_w),
            ("wheel.grinding_ratio", self.wheel.grinding_ratio),
            ("second_spindle.rpm", self.second_spindle.rpm),
            ("second_spindle.run_up_s", self.second_spindle.run_up_s),
            ("hydraulics.time_constant_s", self.hydraulics.time_constant_s),
            ("hydraulics.gauge_arm_s", self.hydraulics.gauge_arm_s),
            ("hydraulics.oscillation_mm", self.hydraulics.oscillation_mm),
            ("hydraulics.oscillation_mm_s", self.hydraulics.oscillation_mm_s),
            ("gauges.probe.second_mm", self.gauges.probe.second_mm),
            ("gauges.probe.travel_mm", self.gauges.probe.travel_mm),
            ("cutting.sharp_s", self.cutting.sharp_s),
            ("cutting.dull_s", self.cutting.dull_s),
            ("cutting.dull_after_mm3", self.cutting.dull_after_mm3),
            ("cutting.traverse_cylinder_mm", self.cutting.traverse_cylinder_mm),
            ("cutting.traverse_face_mm", self.cutting.traverse_face_mm),
            ("cutting.traverse_plane_mm", self.cutting.traverse_plane_mm),
            ("cutting.contact_mm", self.cutting.contact_mm),
        ]
    }
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
    fn p1_every_kind_has_its_own_axes_and_gear() {
        let [gc, gs, ga] = [Kind::Gc, Kind::Gs, Kind::Ga].map(|kind| MachineFile::builtin(kind).unwrap());
        let there = |file: &MachineFile, fitted| file.axes(fitted).map(|axis| axis.is_some()).0;
        assert_eq!((there(&gc, false), there(&gc, true)), ([true, false, true], [true; 3]));
        assert_eq!((there(&gs, false), there(&gs, true)), ([true; 3], [true; 3]));
        assert_eq!((there(&ga, false), there(&ga, true)), ([true, false, true], [true; 3]));
        assert!(
            gc.workhead.is_some() && gc.table.is_none() && gc.magnet.is_none() && gc.hydraulics.tailstock.is_some()
        );
        assert!(
            gs.workhead.is_none() && gs.table.is_none() && gs.magnet.is_some() && gs.hydraulics.tailstock.is_none()
        );
        assert!(
            ga.workhead.is_none() && ga.table.is_some() && ga.magnet.is_some() && ga.hydraulics.tailstock.is_none()
        );
        assert!(gs.dresser.unwrap().roll.is_some());
    }

    #[test]
    fn p3_p7_every_kind_has_the_figures_of_the_specification() {
        for file in Kind::ALL.map(|kind| MachineFile::builtin(kind).unwrap()) {
            let (w, h, g) = (&file.wheel, &file.hydraulics, &file.gauges);
            assert_eq!((w.run_up_s, w.coast_down_s, w.grinding_ratio), (8.0, 60.0, 40.0));
            assert_eq!((h.gauge_arm_s, h.oscillation_mm_s), (1.0, 200.0));
            assert_eq!((g.stages_um, g.noise_um, g.delay_s), ([100.0, 20.0, 5.0, 0.0], 0.5, 0.01));
            if let Some(quill) = &h.tailstock {
                assert_eq!((quill.travel_mm, quill.travel_s), (30.0, 1.0));
            }
            if let Some(magnet) = &file.magnet {
                assert_eq!((magnet.magnetise_s, magnet.demagnetise_s), (1.0, 6.0));
            }
        }
    }

    #[test]
    fn p1_a_layout_without_its_axis_is_refused() {
        let wrong = Kind::Gc.row().machine_file.replacen("infeed: X", "infeed: Y", 1);
        let said = MachineFile::parse(&wrong).unwrap_err().to_string();
        assert_eq!(said, "layout: axis Y: the machine has no such axis");
        let twice = Kind::Gc.row().machine_file.replacen("infeed: X", "infeed: Z", 1);
        let said = MachineFile::parse(&twice).unwrap_err().to_string();
        assert_eq!(said, "layout: infeed, across and stroke are three different axes");
    }

    #[test]
    fn p1_a_wrong_machine_file_is_refused_with_its_place() {
        let unknown = Kind::Gc.row().machine_file.replacen("bounce_s", "bounce", 1);
        assert!(matches!(MachineFile::parse(&unknown), Err(SimFileError::Syntax(_))));
        let zero = Kind::Gc.row().machine_file.replacen("grinding_ratio: 40.0", "grinding_ratio: 0.0", 1);
        let said = MachineFile::parse(&zero).unwrap_err().to_string();
        assert_eq!(said, "wheel.grinding_ratio is 0: must be above zero");
        for kind in Kind::ALL {
            assert_eq!(MachineFile::builtin(kind).map(|file| file.kind), Ok(kind));
        }
    }
}
