//! Machine files: `assets/machines/*.ron` (P, "all figures are data"). Parses text; the caller reads the files.

use serde::{Deserialize, Serialize};

use super::file_error::{
    SimFileError, refuse_value, require_not_negative, require_positive, require_positive_fields as positive,
};
use super::machine_sections::{
    AxisFile, CuttingFile, DresserFile, DriveFile, GaugesFile, HydraulicsFile, LayoutFile, MagnetFile, MainSpindleFile,
    ScatterFile, SecondSpindleFile, ToolTurretFile, WheelFile,
};
use super::part_heat::PartHeatFile;
use super::thermal::ThermalFile;
use super::vibration::VibrationFile;
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
    /// Thermal growth of the wheel head; none on a machine that is always warm.
    pub thermal: Option<ThermalFile>,
    /// Warming of the part; without it parts stay cold.
    pub part_heat: Option<PartHeatFile>,
    /// Vibration of the wheel against the part.
    pub vibration: Option<VibrationFile>,
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

    pub(super) fn check(&self) -> Result<(), SimFileError> {
        self.thermal.map_or(Ok(()), |thermal| thermal.check("thermal"))?;
        self.gauges.drift.map_or(Ok(()), |drift| drift.check("gauges.drift"))?;
        self.vibration.map_or(Ok(()), |vibration| vibration.check())?;
        self.part_heat.map_or(Ok(()), |heat| heat.check())?;
        for (axis, file) in self.axes(true).iter() {
            file.map_or(Ok(()), |file| file.check(&axis.letter().to_ascii_lowercase().to_string()))?;
        }
        if let Some(spindle) = &self.main_spindle {
            positive!("main_spindle", spindle; run_up_s encoder_steps)?;
        }
        if let Some(turret) = &self.tool_post {
            positive!("tool_post", turret; step_s)?;
        }
        let roll = self.dresser.as_ref().and_then(|dresser| dresser.roll.as_ref());
        let roll_drive = roll.map(|roll| &roll.drive);
        for (name, drive) in
            [("workhead", self.workhead.as_ref()), ("table", self.table.as_ref()), ("dresser.roll.drive", roll_drive)]
        {
            drive.map_or(Ok(()), |drive| drive.check(name))?;
        }
        self.check_layout()?;
        let Self { wheel, hydraulics, cutting, .. } = self;
        positive!("wheel", wheel; diameter_mm width_mm rated_m_s mains_rpm run_up_s coast_down_s)?;
        positive!("wheel", wheel; power_w grinding_ratio)?;
        require_not_negative("wheel.wear_exponent", wheel.wear_exponent)?;
        positive!("wheel", wheel; corner_wear)?;
        require_not_negative("cutting.chip_j_mm3", cutting.chip_j_mm3)?;
        if cutting.chip_j_mm3 > cutting.energy_j_mm3 {
            refuse_value("cutting.chip_j_mm3", cutting.chip_j_mm3, "must not exceed energy_j_mm3")?;
        }
        require_not_negative("cutting.ploughing_n_mm", cutting.ploughing_n_mm)?;
        let GaugesFile { noise_um, coolant_noise, hysteresis_um, .. } = self.gauges;
        require_not_negative("gauges.coolant_noise", coolant_noise)?;
        if coolant_noise > 1.0 && hysteresis_um < 2.0 * noise_um * coolant_noise {
            refuse_value("gauges.hysteresis_um", hysteresis_um, "must be twice the noise under coolant")?;
        }
        self.dresser.as_ref().map_or(Ok(()), |d| require_not_negative("dresser.wear_um_cm3", d.wear_um_cm3))?;
        positive!("second_spindle", self.second_spindle; rpm run_up_s)?;
        positive!("hydraulics", hydraulics; time_constant_s gauge_arm_s oscillation_mm oscillation_mm_s)?;
        positive!("gauges.probe", self.gauges.probe; second_mm travel_mm)?;
        positive!("cutting", cutting; sharp_s dull_s dull_after_mm3 traverse_cylinder_mm traverse_face_mm)?;
        positive!("cutting", cutting; traverse_plane_mm contact_mm energy_j_mm3 force_ratio burn_mm2_s)?;
        cutting.burn_work_mm_s.map_or(Ok(()), |mm_s| require_positive("cutting.burn_work_mm_s", mm_s))?;
        if let Some(quill) = &hydraulics.tailstock {
            positive!("hydraulics.tailstock", quill; travel_s)?;
        }
        if let Some(magnet) = &self.magnet {
            positive!("magnet", magnet; magnetise_s release_s demagnetise_s reversal_s)?;
        }
        Ok(())
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
}
