//! The sections of a machine file: axes, drives, hydraulics, magnet, gauges, cutting, dresser (P1–P7). Data only.

use serde::{Deserialize, Serialize};

use super::file_error::{SimFileError, refuse_value, require_positive_fields as positive};
use super::thermal::ThermalFile;
use crate::units::Axis;

/// Greatest number of rows of an error table over position.
const TABLE_LIMIT: usize = 1_000;

/// A point of a table over position: machine position and value, both mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TablePoint(pub f64, pub f64);

/// Assignment of the axes to the wheel's directions. The wheel's reference point is its lowest (front) point on its
/// minus side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LayoutFile {
    /// Moves the wheel's rim to the part; minus is towards the part.
    pub infeed: Axis,
    /// Runs along the wheel's axis, across its width; the wheel extends from its reference point towards plus.
    pub across: Axis,
    /// Strokes the part under the wheel, if the part does not rotate.
    pub stroke: Option<Axis>,
    /// Work coordinates of the infeed refer to the wheel's centre; otherwise to its reference point.
    #[serde(default)]
    pub centre: bool,
}

/// One axis. Positions are machine coordinates in slide travel (radius on X).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisFile {
    /// Position at power-on, mm.
    pub power_on_mm: f64,
    /// Natural frequency ω of the position loop, rad/s; the servo lag at constant speed is 2/ω.
    pub following_rad_s: f64,
    /// Acceleration limit of the drive, mm/s².
    pub accel_mm_s2: f64,
    /// Jerk limit of the drive, mm/s³.
    pub jerk_mm_s3: f64,
    /// Deceleration of the brake, mm/s².
    pub brake_mm_s2: f64,
    /// One encoder step, mm.
    pub resolution_mm: f64,
    /// The encoder is absolute: it reads the machine position from power-on on.
    #[serde(default)]
    pub absolute: bool,
    /// Edge of the home switch, mm.
    pub home_edge_mm: f64,
    /// Length of the home switch cam from the edge on, mm; without it the switch stays active to the end.
    pub home_width_mm: Option<f64>,
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
    /// Backlash of the leadscrew over motor position.
    #[serde(default)]
    pub backlash_mm: Vec<TablePoint>,
    /// Position error of the slide over position.
    #[serde(default)]
    pub pitch_error_mm: Vec<TablePoint>,
}

/// The wheel and its drive.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WheelFile {
    /// Diameter when new, mm.
    pub diameter_mm: f64,
    /// Width, mm.
    pub width_mm: f64,
    /// Rated peripheral speed, m/s.
    pub rated_m_s: f64,
    /// Speed at 10 V of the first analog output, rpm.
    pub rpm_at_10_v: f64,
    /// Speed without an analog voltage (motor on the mains), rpm.
    pub mains_rpm: f64,
    /// Time from rest to `mains_rpm`, s.
    pub run_up_s: f64,
    /// Time from `mains_rpm` to rest, s.
    pub coast_down_s: f64,
    /// Power of the motor, W.
    pub power_w: f64,
    /// Load of the idling wheel, percent.
    pub idle_load_percent: f64,
    /// Grinding ratio G: removed part volume per worn wheel volume, at a removal rate of 1 mm³/(mm·s).
    pub grinding_ratio: f64,
    /// g of G(Q'w) = G·Q'w^−g: how much more the wheel wears under load; 0: G is the same at every removal rate.
    #[serde(default)]
    pub wear_exponent: f64,
    /// How many times as much the rim wears in the 3 mm next to its sides as between them, for the same removed volume.
    #[serde(default = "even_wear")]
    pub corner_wear: f64,
}

/// A rim that wears at its corners as between them.
const fn even_wear() -> f64 {
    1.0
}

/// Drive of workhead, rotary table or dressing roll.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriveFile {
    /// Speed of the low output (M64) without an analog voltage, rpm. With a single output, low and high are equal.
    pub low_rpm: f64,
    /// Speed of the high output (M63) without an analog voltage, rpm.
    pub high_rpm: f64,
    /// Least speed of the drive, rpm.
    pub least_rpm: f64,
    /// Greatest speed, at 10 V of the second analog output, rpm.
    pub greatest_rpm: f64,
    /// Time to reach `high_rpm` from rest, s.
    pub run_up_s: f64,
}

/// The main spindle of a lathe and its encoder (L5, L7).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MainSpindleFile {
    /// Speed at 10 V of the first analog output, rpm.
    pub rpm_at_10_v: f64,
    /// Speed without an analog voltage, rpm.
    pub mains_rpm: f64,
    /// Time from rest to `mains_rpm`, s; braking takes as long.
    pub run_up_s: f64,
    /// Encoder steps per revolution.
    pub encoder_steps: f64,
    /// Speed variation once per revolution, as a fraction of the speed.
    pub unevenness: f64,
}

/// The tool turret of a lathe (L8).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ToolTurretFile {
    /// Time from one station to the next, s.
    pub step_s: f64,
    /// The tools of stations 1 to 4.
    pub tools: [ToolFile; 4],
    /// Overlap of tool and part that is a crash in rapid traverse or with the spindle stopped, mm.
    pub crash_mm: f64,
}

/// One tool.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ToolFile {
    /// Offset of its tip from the slides' reference point: X as slide travel, Z, mm.
    pub tip_mm: (f64, f64),
    /// Height of the cutting edge above the tip, mm; above it is the shank.
    pub edge_mm: f64,
    /// Outline: Z from the tip in rising order, and its height above the tip along X.
    pub outline_mm: Vec<TablePoint>,
}

/// The second spindle: one speed, two directions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SecondSpindleFile {
    /// Speed, rpm.
    pub rpm: f64,
    /// Time from rest to that speed and back to rest, s each.
    pub run_up_s: f64,
}

/// Pump, pressure switch and actuators.
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
    /// Least pressure that moves the tailstock, MPa.
    pub moves_from_mpa: f64,
    /// The tailstock, where there is one.
    pub tailstock: Option<QuillFile>,
    /// Time of a gauge arm from end to end, s.
    pub gauge_arm_s: f64,
    /// Stroke of the oscillation cylinder, mm.
    pub oscillation_mm: f64,
    /// Its speed, mm/s.
    pub oscillation_mm_s: f64,
    /// Time from coolant on to flow, s.
    pub coolant_s: f64,
    /// Time from a gear's output to its in-position switch, s.
    pub gear_s: f64,
}

/// The quill of the tailstock.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct QuillFile {
    /// Its travel, mm.
    pub travel_mm: f64,
    /// Time for the whole travel, s.
    pub travel_s: f64,
}

/// µ of vitrified wheels on steel lies between 0.3 and 0.5 (Malkin and Guo 2008).
const fn usual_force_ratio() -> f64 {
    0.4
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
    /// Traverse length along the wheel's axis that acts like one time constant, sharp wheel, mm.
    pub traverse_cylinder_mm: f64,
    /// The same across a face ground by the wheel's side, mm.
    pub traverse_face_mm: f64,
    /// The same along the stroke over a plane, mm.
    pub traverse_plane_mm: f64,
    /// Contact length of the rim on a plane, mm: wheel and part deform over this length.
    pub contact_mm: f64,
    /// Energy to remove a volume with a sharp wheel, J/mm³: chips and sliding.
    pub energy_j_mm3: f64,
    /// Share of it that forms chips, J/mm³: it does not grow as the wheel gets dull, the rest does.
    #[serde(default)]
    pub chip_j_mm3: f64,
    /// Tangential force of ploughing per width of contact, N/mm: the same at every removal rate but the smallest.
    #[serde(default)]
    pub ploughing_n_mm: f64,
    /// Ratio µ of tangential to normal force.
    #[serde(default = "usual_force_ratio")]
    pub force_ratio: f64,
    /// Specific removal rate above which a sharp wheel under coolant burns the part, mm³/(mm·s); ploughing lowers it.
    pub burn_mm2_s: f64,
    /// Speed of the part under the wheel for which that rate holds, mm/s; absent: for every speed.
    #[serde(default)]
    pub burn_work_mm_s: Option<f64>,
    /// Overlap that is a crash, mm.
    pub crash_mm: f64,
    /// Overlap that is a crash when the wheel is stopped or below half its speed, mm.
    pub crash_standing_mm: f64,
    /// Overlap that grinds a flat on a stopped part, mm.
    pub flat_mm: f64,
    /// Below this speed workhead, table or roll count as stopped, rpm.
    pub part_stands_rpm: f64,
    /// Speed from which hitting a hard stop is a crash, mm/s.
    pub stop_crash_mm_s: f64,
}

/// Variation between machines, wheels and strokes: drawn from the seed, uniformly distributed to both sides of the
/// values of the file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScatterFile {
    /// Relative variation of the grinding ratio and of the volume that dulls the wheel.
    pub wheel: f64,
    /// Variation of the diamond's depth, new in every stroke over the rim, µm of radius.
    pub dressing_um: f64,
    /// Amplitude limit of each leadscrew's periodic error, µm.
    pub screw_um: f64,
    /// Position noise of each slide, µm.
    pub servo_um: f64,
}

/// The dresser: a diamond (a point) or a roll under the whole wheel. Machine coordinates.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DresserFile {
    /// Position of the infeed axis when the rim of a new wheel touches it, mm.
    pub infeed_mm: f64,
    /// Position along the wheel's axis, mm; of a roll its minus side.
    pub across_mm: f64,
    /// Position of the stroke axis when the wheel is centred over it, mm; on machines with such an axis.
    #[serde(default)]
    pub stroke_mm: f64,
    /// It is behind the wheel: infeed towards plus moves the wheel's far rim to it.
    #[serde(default)]
    pub behind: bool,
    /// Depth that breaks it, mm.
    pub crash_mm: f64,
    /// Depth from which a pass sharpens, mm.
    pub sharpens_mm: f64,
    /// Wear of the diamond for the volume of wheel that it has cut, µm/cm³.
    #[serde(default)]
    pub wear_um_cm3: f64,
    /// The roll, if it is one.
    pub roll: Option<RollFile>,
}

/// A dressing roll, its axis parallel to the wheel's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RollFile {
    /// Diameter, mm.
    pub diameter_mm: f64,
    /// Width, mm.
    pub width_mm: f64,
    /// Its drive.
    pub drive: DriveFile,
}

/// The magnetic chuck (P3).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MagnetFile {
    /// Time from magnetise-on to full holding force, s.
    pub magnetise_s: f64,
    /// Time from magnetise-off until only the remanence is left, s.
    pub release_s: f64,
    /// Remanence: force without current, as a fraction of the full force.
    pub remanence: f64,
    /// Time in which the reversals decay to zero, s.
    pub demagnetise_s: f64,
    /// Duration of one reversal, s.
    pub reversal_s: f64,
    /// Least force that holds the part while it is ground or rotated, as a fraction of the full force.
    pub holds_from: f64,
    /// The plate, which the wheel must not touch.
    pub plate: PlateFile,
}

/// The plate of the magnet, machine coordinates.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlateFile {
    /// Position of the infeed axis when a new wheel touches the plate, mm.
    pub top_mm: f64,
    /// From and to along the wheel's axis, mm.
    pub across_mm: (f64, f64),
    /// From and to along the stroke, mm; none on a rotary table.
    pub stroke_mm: Option<(f64, f64)>,
}

/// The gauges (P7).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GaugesFile {
    /// Levels of the radial (thickness) gauge's stages above the set size, signals 1 to 4, µm.
    pub stages_um: [f64; 4],
    /// Noise of a measurement, greatest deviation in either direction, µm.
    pub noise_um: f64,
    /// Delay from a size or a touch to its signal, s.
    pub delay_s: f64,
    /// Switch-off hysteresis of a stage, µm; must exceed the noise, or signals chatter.
    pub hysteresis_um: f64,
    /// What the radial gauge shows too much as it warms.
    pub drift: Option<ThermalFile>,
    /// Noise while coolant flows over the tips, as a multiple of `noise_um`.
    #[serde(default = "no_more_noise")]
    pub coolant_noise: f64,
    /// The axial (plane) gauge.
    pub probe: ProbeFile,
}

const fn no_more_noise() -> f64 {
    1.0
}

/// The tip of the axial (plane) gauge with its arm out, relative to the wheel's reference point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProbeFile {
    /// Along the infeed, mm; minus is beyond the wheel's rim.
    pub infeed_mm: f64,
    /// Along the wheel's axis, mm.
    pub across_mm: f64,
    /// Along the stroke, mm.
    #[serde(default)]
    pub stroke_mm: f64,
    /// Deflection from the touch (signal 4) to the second stage (signal 6), mm.
    pub second_mm: f64,
    /// Deflection above which the tip breaks, mm.
    pub travel_mm: f64,
}

impl AxisFile {
    pub(super) fn check(&self, letter: &str) -> Result<(), SimFileError> {
        let wrong = |field: &str, value, rule| refuse_value(format!("{letter}.{field}"), value, rule);
        positive!(letter, self; following_rad_s accel_mm_s2 jerk_mm_s3 brake_mm_s2 resolution_mm)?;
        if !(self.stop_minus_mm..=self.stop_plus_mm).contains(&self.power_on_mm) {
            return wrong("power_on_mm", self.power_on_mm, "must lie between the stops");
        }
        for (field, table) in [("backlash_mm", &self.backlash_mm), ("pitch_error_mm", &self.pitch_error_mm)] {
            if table.len() > TABLE_LIMIT {
                return wrong(field, table.len() as f64, "must have at most 1000 rows");
            }
            if let Some(pair) = table.windows(2).find(|pair| pair[0].0 >= pair[1].0) {
                return wrong(field, pair[1].0, "positions must rise");
            }
        }
        Ok(())
    }
}

impl DriveFile {
    pub(super) fn check(&self, name: &str) -> Result<(), SimFileError> {
        positive!(name, self; high_rpm low_rpm run_up_s)?;
        if self.least_rpm > self.greatest_rpm {
            refuse_value(format!("{name}.least_rpm"), self.least_rpm, "must not exceed greatest_rpm")?;
        }
        Ok(())
    }
}
