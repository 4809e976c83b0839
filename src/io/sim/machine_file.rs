//! Machine files: `assets/machines/*.ron` (P, "all figures are data"). Parses text; the caller reads the files.

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
    pub y: Option<AxisFile>,
    /// Axis Y, if it is an option (P6.6).
    pub y_optional: Option<AxisFile>,
    /// Axis Z.
    pub z: AxisFile,
    /// Bounce time of a contact at every edge, s.
    pub bounce_s: f64,
    /// The wheel and its drive.
    pub wheel: WheelFile,
    /// The workhead, if the part rotates between centres or in a chuck.
    pub workhead: Option<DriveFile>,
    /// The drive of a rotary table.
    pub table: Option<DriveFile>,
    /// The main spindle of a lathe.
    pub main_spindle: Option<MainSpindleFile>,
    /// The tool turret of a lathe.
    pub tool_post: Option<ToolTurretFile>,
    /// The second spindle.
    pub second_spindle: SecondSpindleFile,
    /// Pump and the actuators that it moves.
    pub hydraulics: HydraulicsFile,
    /// The magnetic chuck, if there is one.
    pub magnet: Option<MagnetFile>,
    /// The gauges.
    pub gauges: GaugesFile,
    /// How the wheel cuts.
    pub cutting: CuttingFile,
    /// The dresser, if there is one.
    pub dresser: Option<DresserFile>,
    /// Seeded variation of the machine. Without it only contacts, gauges and parts depend on the seed.
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
        if let Some(turret) = &self.tool_post {
            require_positive("tool_post.step_s", turret.step_s)?;
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
            let rule = "infeed, across and stroke must be three different axes";
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
