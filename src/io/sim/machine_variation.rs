//! Variations of a machine: what makes it other than the machine of its kind, as files for `--machine` (A7). Parses text.

use serde::{Deserialize, Serialize};

use super::file_error::{SimFileError, require_not_negative, require_positive};
use super::machine_file::MachineFile;
use super::machine_sections::{AxisFile, ScatterFile, TablePoint};
use super::part_heat::PartHeatFile;
use super::thermal::ThermalFile;
use super::vibration::VibrationFile;
use crate::defs::kind::Kind;

macro_rules! variations {
    ($($name:literal)*) => {
        &[$(($name, include_str!(concat!("../../../assets/machines/variations/", $name, ".ron"))),)*]
    };
}

/// Names and texts of the variations that come with the control: what parts are qualified on (`kt830 qualify`).
pub const VARIATIONS: &[(&str, &str)] = variations! {
    "stiff" "slender" "soft_wheel" "hard_wheel" "dulls_fast" "scatter" "backlash" "pitch" "slow_gauge" "burns"
    "soft_servo" "drift" "hot_part" "soft_bond" "soft_corner" "ploughing" "worn_diamond" "unbalance" "gauge_drift" "worn"
};

/// Length over which a pitch error is given, mm.
const PITCH_LENGTH_MM: f64 = 300.0;

/// A variation. What is absent stays as it is on the machine of the kind.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MachineVariation {
    /// Time constant of the contact with a sharp wheel, s; a dull one is slower in proportion.
    pub contact_s: Option<f64>,
    /// Grinding ratio G.
    pub grinding_ratio: Option<f64>,
    /// How much more the wheel wears under load: g of G(Q'w) = G·Q'w^−g.
    pub wear_exponent: Option<f64>,
    /// Removed volume that makes a sharp wheel dull, as a factor.
    pub dulling: Option<f64>,
    /// Specific removal rate above which the part burns, mm³/(mm·s).
    pub burn_mm2_s: Option<f64>,
    /// Backlash of every leadscrew, µm.
    pub backlash_um: Option<f64>,
    /// Position error of every slide, growing evenly along it, µm in 300 mm.
    pub pitch_error_um: Option<f64>,
    /// Natural frequency of every position loop, rad/s.
    pub following_rad_s: Option<f64>,
    /// Noise of the gauges, greatest deviation in either direction, µm.
    pub gauge_noise_um: Option<f64>,
    /// Delay of the gauges, s.
    pub gauge_delay_s: Option<f64>,
    /// Random differences.
    pub scatter: Option<ScatterFile>,
    /// Thermal growth.
    pub thermal: Option<ThermalFile>,
    /// Warming of the part.
    pub part_heat: Option<PartHeatFile>,
    /// Vibration of the wheel.
    pub vibration: Option<VibrationFile>,
    /// How many times as much the rim wears at its corners.
    pub corner_wear: Option<f64>,
    /// Share of the specific energy that forms chips, J/mm³.
    pub chip_j_mm3: Option<f64>,
    /// Tangential force of ploughing per width, N/mm.
    pub ploughing_n_mm: Option<f64>,
    /// Wear of the diamond, µm of its depth for a cm³ of wheel.
    pub diamond_wear_um_cm3: Option<f64>,
    /// Drift of the radial gauge.
    pub gauge_drift: Option<ThermalFile>,
    /// Noise of the radial gauge under coolant, as a factor.
    pub coolant_noise: Option<f64>,
}

impl MachineVariation {
    /// Parses a variation.
    ///
    /// # Errors
    /// The syntax error with line and column.
    pub fn parse(text: &str) -> Result<Self, SimFileError> {
        Ok(ron::from_str(text)?)
    }

    /// The machine of a kind with this variation.
    ///
    /// # Errors
    /// A value is not possible.
    pub fn of_kind(&self, kind: Kind) -> Result<MachineFile, SimFileError> {
        let sizes = [
            ("backlash_um", self.backlash_um),
            ("gauge_noise_um", self.gauge_noise_um),
            ("gauge_delay_s", self.gauge_delay_s),
            ("pitch_error_um", self.pitch_error_um.map(f64::abs)),
        ];
        for (field, value) in sizes.into_iter().filter_map(|(field, value)| Some((field, value?))) {
            require_not_negative(field, value)?;
        }
        for (field, value) in [("dulling", self.dulling), ("burn_mm2_s", self.burn_mm2_s)] {
            value.map_or(Ok(()), |value| require_positive(field, value))?;
        }
        let mut machine = MachineFile::builtin(kind)?;
        self.vary(&mut machine);
        machine.check()?;
        Ok(machine)
    }

    fn vary(&self, machine: &mut MachineFile) {
        let set = |place: &mut f64, value: Option<f64>| *place = value.unwrap_or(*place);
        let cutting = &mut machine.cutting;
        if let Some(sharp_s) = self.contact_s {
            cutting.dull_s *= sharp_s / cutting.sharp_s;
            cutting.sharp_s = sharp_s;
        }
        cutting.dull_after_mm3 *= self.dulling.unwrap_or(1.0);
        set(&mut cutting.burn_mm2_s, self.burn_mm2_s);
        set(&mut cutting.chip_j_mm3, self.chip_j_mm3);
        set(&mut cutting.ploughing_n_mm, self.ploughing_n_mm);
        set(&mut machine.wheel.corner_wear, self.corner_wear);
        if let Some(dresser) = &mut machine.dresser {
            set(&mut dresser.wear_um_cm3, self.diamond_wear_um_cm3);
        }
        set(&mut machine.wheel.grinding_ratio, self.grinding_ratio);
        set(&mut machine.wheel.wear_exponent, self.wear_exponent);
        set(&mut machine.gauges.noise_um, self.gauge_noise_um);
        set(&mut machine.gauges.delay_s, self.gauge_delay_s);
        set(&mut machine.gauges.coolant_noise, self.coolant_noise);
        machine.gauges.drift = self.gauge_drift.or(machine.gauges.drift);
        // A stage must not chatter in the noise.
        let noise_um = machine.gauges.noise_um * machine.gauges.coolant_noise.max(1.0);
        machine.gauges.hysteresis_um = machine.gauges.hysteresis_um.max(2.5 * noise_um);
        let [x, z] = [&mut machine.x, &mut machine.z];
        for axis in [Some(x), machine.y.as_mut(), machine.y_optional.as_mut(), Some(z)].into_iter().flatten() {
            self.vary_axis(axis);
        }
        machine.scatter = self.scatter.or(machine.scatter);
        machine.thermal = self.thermal.or(machine.thermal);
        machine.part_heat = self.part_heat.or(machine.part_heat);
        machine.vibration = self.vibration.or(machine.vibration);
    }

    fn vary_axis(&self, axis: &mut AxisFile) {
        axis.following_rad_s = self.following_rad_s.unwrap_or(axis.following_rad_s);
        if let Some(play_um) = self.backlash_um {
            axis.backlash_mm = vec![TablePoint(axis.stop_minus_mm, play_um / 1_000.0)];
        }
        if let Some(error_um) = self.pitch_error_um {
            // None at the home switch, where the axis is set.
            let at = |place: f64| TablePoint(place, (place - axis.home_edge_mm) / PITCH_LENGTH_MM * error_um / 1_000.0);
            axis.pitch_error_mm = vec![at(axis.stop_minus_mm), at(axis.stop_plus_mm)];
        }
    }
}

impl MachineFile {
    /// The simulated machine of a file: a whole machine, or a variation of the machine of `kind`.
    ///
    /// # Errors
    /// The syntax error with line and column, the first invalid value, or a machine of another kind.
    pub fn of_text(text: &str, kind: Kind) -> Result<Self, SimFileError> {
        let variation = match MachineVariation::parse(text) {
            Ok(variation) => return variation.of_kind(kind),
            Err(error) => error,
        };
        match Self::parse(text) {
            Ok(machine) if machine.kind == kind => Ok(machine),
            Ok(machine) => refuse_kind(machine.kind, kind),
            // Whoever writes a whole machine names its kind.
            Err(error) if text.lines().any(|line| line.trim_start_matches(['(', ' ', '\t']).starts_with("kind:")) => {
                Err(error)
            }
            Err(_) => Err(variation),
        }
    }
}

fn refuse_kind(found: Kind, wanted: Kind) -> Result<MachineFile, SimFileError> {
    let what = format!("kind {} (the control is {})", found.id(), wanted.id());
    Err(SimFileError::Incompatible { what, rule: "the machine must be of the kind of the control" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn p8_a_variation_changes_what_it_names_and_nothing_else() {
        let whole = MachineFile::builtin(Kind::Gc).unwrap();
        assert_eq!(MachineFile::of_text("()", Kind::Gc), Ok(whole.clone()));
        let other = MachineFile::of_text("(contact_s: Some(1.6), backlash_um: Some(10))", Kind::Gc).unwrap();
        // 0.8 s and 2.0 s.
        assert_eq!((other.cutting.sharp_s, other.cutting.dull_s), (1.6, 4.0));
        assert_eq!(other.x.backlash_mm, [TablePoint(-308.0, 0.01)]);
        assert_eq!((other.wheel, other.gauges), (whole.wheel, whole.gauges));
    }

    #[test]
    fn p8_every_variation_that_comes_with_the_control_is_a_machine_of_every_grinder() {
        for (name, text) in VARIATIONS {
            for kind in [Kind::Gc, Kind::Gs, Kind::Ga] {
                let machine = MachineFile::of_text(text, kind).unwrap_or_else(|error| panic!("{name}: {error}"));
                assert_ne!(machine, MachineFile::builtin(kind).unwrap(), "{name}");
            }
        }
    }

    #[test]
    fn p8_a_wrong_variation_is_refused_with_its_place() {
        let of = |text: &str| MachineFile::of_text(text, Kind::Gc).unwrap_err().to_string();
        assert!(of("(contact: Some(1.6))").contains("contact"), "{}", of("(contact: Some(1.6))"));
        assert!(of("(contact_s: Some(-1.0))").contains("sharp_s"));
        assert!(of("(thermal: Some((growth_um: 5, time_constant_s: 0)))").contains("time_constant_s"));
        assert!(of("(thermal: Some((growth_um: inf, time_constant_s: 9)))").contains("growth_um"));
        assert!(of("(backlash_um: Some(-10))").contains("backlash_um"));
        assert!(of("(gauge_noise_um: Some(NaN))").contains("gauge_noise_um"));
        assert!(of("(pitch_error_um: Some(inf))").contains("pitch_error_um"));
        assert!(of("(burn_mm2_s: Some(0))").contains("burn_mm2_s"));
        assert!(of(Kind::Gs.row().machine_file).contains("gs"));
        assert!(of("(kind: Gc, layouts: 1)").contains("layouts"), "a whole machine is told as one");
    }
}
