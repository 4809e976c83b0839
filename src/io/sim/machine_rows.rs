//! The rows of a machine file: axes, drives, hydraulics, magnet, gauges, cutting, dresser (P1–P7). Figures only.

use serde::{Deserialize, Serialize};

use super::machine_file::{SimFileError, above_zero};
use crate::units::Axis;

/// Longest error table over position.
const TABLE_LIMIT: usize = 1_000;

/// A point of a table over position: machine position and value there, both mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Along(pub f64, pub f64);

/// Which axis goes which way as the wheel sees it. The wheel's reference point is its lowest (front) point, on its
/// minus side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LayoutFile {
    /// Takes the wheel's rim to the part; minus is towards the part.
    pub infeed: Axis,
    /// Lies along the wheel's own axis, across its width; the wheel goes from its reference point towards plus.
    pub across: Axis,
    /// Draws the part past the wheel, where the part does not turn.
    #[serde(default)]
    pub stroke: Option<Axis>,
    /// Work coordinates of the infeed name the wheel's centre; otherwise its reference point.
    #[serde(default)]
    pub centre: bool,
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
    /// The home switch is a bump of this length from its edge on; without it it stays active to the end, mm.
    #[serde(default)]
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
    /// Greatest peripheral speed that the wheel is made for, m/s.
    pub rated_m_s: f64,
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

/// A drive that turns the part or a dressing roll: workhead, table, roll.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriveFile {
    /// Speed of the low output (M64) without an analog voltage, rpm; where there is one output, both are the same.
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

/// The spindle of a lathe, which turns the part, and its encoder (L5, L7).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MainSpindleFile {
    /// Speed at 10 V of the first analog output, rpm.
    pub rpm_at_10_v: f64,
    /// Speed without an analog voltage, rpm.
    pub mains_rpm: f64,
    /// From rest to `mains_rpm`, s; braked as fast.
    pub run_up_s: f64,
    /// Encoder steps a turn.
    pub encoder_steps: f64,
    /// How much its speed sways, once a turn, of the speed.
    pub unevenness: f64,
}

/// The tool post of a lathe (L8).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ToolPostFile {
    /// From one station to the next, s.
    pub step_s: f64,
    /// The tools of stations 1 to 4.
    pub tools: [ToolFile; 4],
    /// Overlap of tool and part in rapid traverse, or with the spindle standing, that is a crash, mm.
    pub crash_mm: f64,
}

/// One tool.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ToolFile {
    /// Where its tip stands off the post's reference point: X as slide travel, Z.
    pub tip_mm: (f64, f64),
    /// The outline cuts up to this height over the tip; above it is the shank, mm.
    pub edge_mm: f64,
    /// Height of the outline over the tip along X, at places along Z from the tip, in rising order.
    pub outline_mm: Vec<Along>,
}

/// The second spindle: one speed, two ways.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SecondSpindleFile {
    /// Speed, rpm.
    pub rpm: f64,
    /// Time to reach it from rest, and to stop, s.
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
    /// The tailstock, where there is one.
    #[serde(default)]
    pub tailstock: Option<QuillFile>,
    /// Time of a gauge arm out or in, s.
    pub gauge_arm_s: f64,
    /// Stroke of the oscillation cylinder, mm.
    pub oscillation_mm: f64,
    /// Its speed, mm/s.
    pub oscillation_mm_s: f64,
    /// From coolant on to flow, s.
    pub coolant_s: f64,
    /// From a gear's output to its in-position switch, s.
    pub gear_s: f64,
}

/// The quill of the tailstock.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct QuillFile {
    /// Its travel, mm.
    pub travel_mm: f64,
    /// The time of that travel, s.
    pub travel_s: f64,
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
    /// Length of traverse that counts as one time constant, sharp wheel, along the wheel's own axis, mm.
    pub traverse_cylinder_mm: f64,
    /// The same across a face that the wheel's side grinds, mm.
    pub traverse_face_mm: f64,
    /// The same of a plane that is drawn past under the wheel, mm.
    pub traverse_plane_mm: f64,
    /// How long the rim lies flat on a plane, mm: wheel and part give way to each other by that much.
    pub contact_mm: f64,
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
    /// Below this workhead, table or roll count as standing, rpm.
    pub part_stands_rpm: f64,
    /// Speed from which running onto a hard stop is a crash, mm/s.
    pub stop_crash_mm_s: f64,
}

/// What differs from one machine, wheel and stroke to the next: drawn from the seed, evenly to both sides of the
/// figures of the file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScatterFile {
    /// Of the wheel's grinding ratio and of the volume that makes it dull, a share of them.
    pub wheel: f64,
    /// Where the diamond cuts, anew in every stroke over the rim, µm of radius.
    pub dressing_um: f64,
    /// What each screw stands off along its way, a wave, µm.
    pub screw_um: f64,
    /// What each slide trembles about its place, µm.
    pub servo_um: f64,
}

/// The dresser: a diamond, which is a point, or a roll under the whole wheel. Machine coordinates.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DresserFile {
    /// Where the infeed axis stands when a new wheel's rim touches it, mm.
    pub infeed_mm: f64,
    /// Where it lies along the wheel's axis, mm; of a roll its minus side.
    pub across_mm: f64,
    /// Where the stroke axis stands when the wheel is right over it, mm; on machines with such an axis.
    #[serde(default)]
    pub stroke_mm: f64,
    /// It lies beyond the wheel: the infeed's plus direction brings the wheel's far rim to it.
    #[serde(default)]
    pub behind: bool,
    /// Depth that breaks it, mm.
    pub crash_mm: f64,
    /// Depth from which a pass sharpens, mm.
    pub sharpens_mm: f64,
    /// It is a roll with a drive of its own.
    #[serde(default)]
    pub roll: Option<RollFile>,
}

/// A dressing roll, its axis along the wheel's.
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

/// The magnet chuck (P3).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MagnetFile {
    /// From magnetise-on to full holding force, s.
    pub magnetise_s: f64,
    /// From magnetise-off until only the remanence holds, s.
    pub release_s: f64,
    /// What stays of the force when the current goes, of the full force.
    pub remanence: f64,
    /// How long the reversals take to come down to nothing, s.
    pub demagnetise_s: f64,
    /// Length of one reversal, s.
    pub reversal_s: f64,
    /// Least force that holds the part while it is ground or turned, of the full force.
    pub holds_from: f64,
    /// The plate itself, which the wheel must not touch.
    pub plate: PlateFile,
}

/// The magnet's plate, machine coordinates.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlateFile {
    /// Where the infeed axis stands when a new wheel touches the plate, mm.
    pub top_mm: f64,
    /// From and to along the wheel's axis, mm.
    pub across_mm: (f64, f64),
    /// From and to along the stroke, mm; of a table that turns nothing.
    #[serde(default)]
    pub stroke_mm: Option<(f64, f64)>,
}

/// The gauges (P7).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GaugesFile {
    /// Stages of the radial (thickness) gauge above the set size, signals 1 to 4, µm.
    pub stages_um: [f64; 4],
    /// Noise of a measurement, greatest deviation either way, µm.
    pub noise_um: f64,
    /// From a size or a touch to its signal, s.
    pub delay_s: f64,
    /// A stage that was given is taken back only so far above it, µm; more than the noise, or signals chatter.
    pub hysteresis_um: f64,
    /// The axial (plane) gauge.
    pub probe: ProbeFile,
}

/// The tip of the axial (plane) gauge with its arm out, from the wheel's reference point.
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
    /// From the touch (signal 4) to the second stage (signal 6), mm.
    pub second_mm: f64,
    /// How far the tip gives way before it breaks, mm.
    pub travel_mm: f64,
}

impl AxisFile {
    pub(super) fn check(&self, letter: &str) -> Result<(), SimFileError> {
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

impl DriveFile {
    pub(super) fn check(&self, name: &str) -> Result<(), SimFileError> {
        above_zero(&format!("{name}.high_rpm"), self.high_rpm)?;
        above_zero(&format!("{name}.low_rpm"), self.low_rpm)?;
        above_zero(&format!("{name}.run_up_s"), self.run_up_s)?;
        if self.least_rpm > self.greatest_rpm {
            let (field, value) = (format!("{name}.least_rpm"), self.least_rpm);
            return Err(SimFileError::Value { field, value, rule: "must not exceed greatest_rpm" });
        }
        Ok(())
    }
}

impl MagnetFile {
    pub(super) const fn positive(&self) -> [(&'static str, f64); 4] {
        [
            ("magnet.magnetise_s", self.magnetise_s),
            ("magnet.release_s", self.release_s),
            ("magnet.demagnetise_s", self.demagnetise_s),
            ("magnet.reversal_s", self.reversal_s),
        ]
    }
}
