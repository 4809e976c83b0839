//! Warming of the part by grinding (P5): its lands grow while they are hot, are ground to size hot, and are smaller when they
//! are cold. Power P of the contacts, its share s in the part, heat capacity C of the lands, their surface A and the heat
//! transfer h to the coolant:
//!
//!   C·dT/dt = s·P − h·A·T,   size = cold size · (1 + α·T).
//!
//! Sizes of the report are those of the cold part, the gauge measures the warm one. DECISION: all lands of a part
//! have one temperature, what is between them none; bores do not grow, faces do not move.
//!
//! Sources: S. Malkin, C. Guo, Grinding Technology, 2nd ed. 2008 (share of the heat in the part); steel: α = 11.5·10⁻⁶ 1/K,
//! c·ρ = 3.6 MJ/(m³·K) (Dubbel, Handbook of Mechanical Engineering, section E).

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use super::file_error::{SimFileError, refuse_value, require_positive_fields as positive};
use super::part_file::{PartFile, SurfaceFile};

/// Thermal expansion of steel, 1/K.
const EXPANSION_PER_K: f64 = 11.5e-6;
/// Heat capacity of steel by its volume, J/(mm³·K).
const CAPACITY_J_MM3_K: f64 = 3.6e-3;
/// Heat transfer to air where no coolant flows, W/(m²·K): a turning shaft.
const AIR_W_M2_K: f64 = 50.0;

/// How the part warms; without it parts stay cold.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartHeatFile {
    /// Share of the contact's power that warms the part, 0 to 1.
    pub heat_share: f64,
    /// Heat transfer to the coolant, W/(m²·K).
    pub cooling_w_m2_k: f64,
}

impl PartHeatFile {
    pub(super) fn check(&self) -> Result<(), SimFileError> {
        positive!("part_heat", self; cooling_w_m2_k)?;
        match (0.0..=1.0).contains(&self.heat_share) {
            true => Ok(()),
            false => refuse_value("part_heat.heat_share", self.heat_share, "must be 0 to 1"),
        }
    }
}

/// Temperature of the part in the machine.
#[derive(Clone, Debug, Default)]
pub(super) struct PartHeat {
    file: Option<PartHeatFile>,
    capacity_j_k: f64,
    area_m2: f64,
    /// Above the coolant, K.
    pub(super) kelvin: f64,
}

impl PartHeat {
    /// No part.
    pub(super) fn new(file: Option<PartHeatFile>) -> Self {
        Self { file, ..Self::default() }
    }

    /// A new part, cold.
    pub(super) fn set_part(&mut self, part: Option<&PartFile>) {
        let outside = part.filter(|part| part.internal_spindle.is_none());
        let lands = outside.map_or(&[][..], |part| &part.surfaces).iter().map(volume_and_area);
        let (volume, area) = lands.fold((0.0, 0.0), |sum, land| (sum.0 + land.0, sum.1 + land.1));
        (self.capacity_j_k, self.area_m2, self.kelvin) = (CAPACITY_J_MM3_K * volume, area / 1e6, 0.0);
    }

    /// One tick with a power of the contact.
    pub(super) fn step(&mut self, watts: f64, coolant_flows: bool, dt_s: f64) {
        let Some(file) = self.file.filter(|_| self.capacity_j_k > 0.0) else { return };
        let transfer = if coolant_flows { file.cooling_w_m2_k } else { AIR_W_M2_K };
        let flow = file.heat_share * watts - transfer * self.area_m2 * self.kelvin;
        self.kelvin += flow * dt_s / self.capacity_j_k;
    }

    /// Size of the warm part over that of the cold one.
    pub(super) fn expansion(&self) -> f64 {
        1.0 + EXPANSION_PER_K * self.kelvin
    }
}

/// Volume of the material of a land, mm³, and its surface under the coolant, mm².
fn volume_and_area(surface: &SurfaceFile) -> (f64, f64) {
    let round = |diameter: f64, length: f64| (PI / 4.0 * diameter * diameter * length, PI * diameter * length);
    match *surface {
        SurfaceFile::Diameter { z_from, z_to, stock, .. } => round(stock, (z_to - z_from).abs()),
        SurfaceFile::Cone { z_from, z_to, stock_from, stock_to, .. } => {
            round(f64::midpoint(stock_from, stock_to), (z_to - z_from).abs())
        }
        SurfaceFile::Plane { x_from, x_to, z_from, z_to, stock, .. } => {
            let area = ((x_to - x_from) * (z_to - z_from)).abs();
            (area * stock.abs(), area)
        }
        SurfaceFile::Disc { x_from, x_to, stock, .. } => {
            let area = PI * (x_to * x_to - x_from * x_from).abs();
            (area * stock.abs(), area)
        }
        SurfaceFile::Bore { .. } | SurfaceFile::Face { .. } | SurfaceFile::Wall { .. } => (0.0, 0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The land of O1002, Ø40.3 by 18 mm: V = 22 960 mm³, C = 82.66 J/K, A = 2 279 mm². 30 % of 1000 W at 5000 W/(m²·K):
    /// 300/11.39 = 26.3 K, with the time constant 82.66/11.39 = 7.26 s; Ø40 grows by 40·11.5e-6·26.3 = 12.1 µm.
    #[test]
    fn p5_a_part_warms_to_what_its_coolant_carries_off() {
        let part = PartFile::builtin(1002).unwrap().unwrap();
        let mut heat = PartHeat::new(Some(PartHeatFile { heat_share: 0.3, cooling_w_m2_k: 5_000.0 }));
        heat.set_part(Some(&part));
        let grows_um = |heat: &PartHeat| 40_000.0 * (heat.expansion() - 1.0);
        (0..7_260).for_each(|_| heat.step(1_000.0, true, 0.001));
        assert!((grows_um(&heat) - 12.1 * (1.0 - (-1.0_f64).exp())).abs() < 0.1, "{}", grows_um(&heat));
        (0..60_000).for_each(|_| heat.step(1_000.0, true, 0.001));
        assert!((grows_um(&heat) - 12.1).abs() < 0.1, "{}", grows_um(&heat));
        (0..7_260).for_each(|_| heat.step(0.0, true, 0.001));
        assert!((grows_um(&heat) - 12.1 * (-1.0_f64).exp()).abs() < 0.1, "{}", grows_um(&heat));
        // Dry it keeps its heat: a time constant of 82.66/0.114 = 725 s.
        let warm = grows_um(&heat);
        (0..7_260).for_each(|_| heat.step(0.0, false, 0.001));
        assert!((grows_um(&heat) / warm - 0.99).abs() < 0.001);
    }
}
