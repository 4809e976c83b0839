//! The materials, with what limits their grinding.

use crate::defs::text::Text;

/// A material of the part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundMaterial {
    /// Its name.
    pub name: Text,
    /// Specific energy of roughing, J/mm³.
    pub energy_j_mm3: f64,
    /// Speed ratio q: speed of the wheel over speed of the part.
    pub speed_ratio: f64,
    /// The removal rate up to which the wheel wears economically, mm³/(mm·s).
    pub economical_mm2_s: f64,
    /// Volume per width of contact after which the wheel is dressed, mm³/mm.
    pub dressed_after_mm2: f64,
    /// Whether it burns by the law of steels.
    pub burns: bool,
}

/// The materials, in the order of parameter P470, from 1.
pub const MATERIALS: [GroundMaterial; 5] = [
    GroundMaterial {
        name: Text::new("淬硬钢", "hardened steel"),
        energy_j_mm3: 45.0,
        speed_ratio: 80.0,
        economical_mm2_s: 3.0,
        dressed_after_mm2: 500.0,
        burns: true,
    },
    GroundMaterial {
        name: Text::new("调质钢、软钢", "soft steel"),
        energy_j_mm3: 35.0,
        speed_ratio: 70.0,
        economical_mm2_s: 4.0,
        dressed_after_mm2: 800.0,
        burns: true,
    },
    GroundMaterial {
        name: Text::new("不锈钢", "stainless steel"),
        energy_j_mm3: 50.0,
        speed_ratio: 60.0,
        economical_mm2_s: 1.5,
        dressed_after_mm2: 300.0,
        burns: true,
    },
    GroundMaterial {
        name: Text::new("高速钢", "high-speed steel"),
        energy_j_mm3: 60.0,
        speed_ratio: 80.0,
        economical_mm2_s: 1.5,
        dressed_after_mm2: 200.0,
        burns: true,
    },
    GroundMaterial {
        name: Text::new("铸铁", "cast iron"),
        energy_j_mm3: 25.0,
        speed_ratio: 70.0,
        economical_mm2_s: 4.0,
        dressed_after_mm2: 800.0,
        burns: false,
    },
];
