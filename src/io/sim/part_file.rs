//! The workpiece and its set-up as data: `assets/parts/O1001.ron` and so on (P4, T3). Text in, structure out.
//!
//! Part coordinates are those of the work frame G54 with a new wheel. GC: X as a diameter (people read diameters), Z
//! along the part. GS: X along the stroke, Y up, Z across. GA: X from the table's middle as a radius, Z up. The wheel's
//! reference point is its front (lowest) point at its side towards minus.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::machine_file::{SimFileError, above_zero};
use crate::defs::face::Form;
use crate::defs::kind::Kind;
use crate::defs::program;

/// The parts that come with the control.
const BUILTIN: &[(&str, &str)] = &[
    ("O1001", include_str!("../../../assets/parts/O1001.ron")),
    ("O1002", include_str!("../../../assets/parts/O1002.ron")),
    ("O1003", include_str!("../../../assets/parts/O1003.ron")),
    ("O1004", include_str!("../../../assets/parts/O1004.ron")),
    ("O1005", include_str!("../../../assets/parts/O1005.ron")),
    ("O1006", include_str!("../../../assets/parts/O1006.ron")),
    ("O1007", include_str!("../../../assets/parts/O1007.ron")),
    ("O1008", include_str!("../../../assets/parts/O1008.ron")),
    ("O1009", include_str!("../../../assets/parts/O1009.ron")),
    ("O1010", include_str!("../../../assets/parts/O1010.ron")),
    ("O1011", include_str!("../../../assets/parts/O1011.ron")),
    ("O1012", include_str!("../../../assets/parts/O1012.ron")),
    ("O1013", include_str!("../../../assets/parts/O1013.ron")),
    ("O1014", include_str!("../../../assets/parts/O1014.ron")),
    ("VGRIND", include_str!("../../../assets/parts/VGRIND.ron")),
    ("VBORE", include_str!("../../../assets/parts/VBORE.ron")),
    ("PRINTED", include_str!("../../../assets/parts/VGRIND.ron")),
];

/// The parts of programs that have names.
const NAMED: &[(&str, &str)] = &[("SHAFT", include_str!("../../../assets/parts/SHAFT.ron"))];

/// Most cells of one surface.
const CELL_LIMIT: f64 = 100_000.0;

/// A part in the machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartFile {
    /// What it is, for people.
    pub name: String,
    /// The kind of machine it goes into.
    #[serde(default)]
    pub kind: Kind,
    /// Machine coordinates of the work zero, to preset in G54; X slide travel (radius).
    pub g54_mm: Place,
    /// Where the axes stand at the start of a run, machine coordinates; X slide travel (radius).
    pub start_mm: Place,
    /// Tool geometry to preset.
    #[serde(default)]
    pub offsets: Vec<OffsetPreset>,
    /// Macro variables to preset.
    #[serde(default)]
    pub variables: BTreeMap<u16, f64>,
    /// Whether the tailstock holds the part at the start; nothing where there is none.
    #[serde(default)]
    pub tailstock_advanced: bool,
    /// Where the tailstock stands when advanced.
    #[serde(default)]
    pub tailstock: Option<TailstockFile>,
    /// Bodies that the wheel must not touch: chuck, fixture.
    #[serde(default)]
    pub bodies: Vec<BodyFile>,
    /// The same on a table: blocks, which are rings on a table that turns.
    #[serde(default)]
    pub blocks: Vec<BlockFile>,
    /// What the radial (thickness) gauge is set to, and where it measures.
    #[serde(default)]
    pub gauge: Option<GaugeFile>,
    /// The bar of a lathe.
    #[serde(default)]
    pub bar: Option<BarFile>,
    /// What is ground.
    #[serde(default)]
    pub surfaces: Vec<SurfaceFile>,
    /// How far the wheel's head is swivelled, degrees: its rim lies along a cone whose diameter grows so much downwards.
    #[serde(default)]
    pub head_deg: f64,
    /// How far it may be ground, where the program's own variables say so.
    #[serde(default)]
    pub finished: Option<FinishedFile>,
}

/// The finished diameter, as variables of the program name it. X programs the wheel's centre: the wheel's rim stands at
/// X − wheel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FinishedFile {
    /// The variable of the finished diameter.
    pub size: u16,
    /// The variable of the wheel's diameter.
    pub wheel: u16,
    /// From Z.
    pub z_from: f64,
    /// To Z.
    pub z_to: f64,
    /// A bore: the rim stands at X + wheel, and grows it.
    #[serde(default)]
    pub inside: bool,
    /// A cone: the variables of its angle, degrees, growing downwards, and of the Z where the size holds.
    #[serde(default)]
    pub cone: Option<(u16, u16)>,
}

/// A bar to be turned, part coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BarFile {
    /// Its diameter.
    pub diameter: f64,
    /// Where it leaves the chuck.
    pub z_from: f64,
    /// Its face.
    pub z_to: f64,
    /// Cell size along Z.
    pub cell: f64,
}

/// A place in the machine, mm of slide travel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Place {
    /// X, radius.
    pub x: f64,
    /// Y, for machines that have it.
    #[serde(default)]
    pub y: f64,
    /// Z.
    pub z: f64,
}

/// One tool offset to preset.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OffsetPreset {
    /// Offset number, 1–16.
    pub number: u8,
    /// Geometry X, diameter.
    pub x: f64,
    /// Geometry Z. Minus the wheel's width programs the wheel's right corner.
    pub z: f64,
}

/// The tailstock's body: a cylinder from its point towards +Z, part coordinates when advanced.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TailstockFile {
    /// Where its body begins when advanced.
    pub z: f64,
    /// Its length.
    pub length: f64,
    /// Its diameter.
    pub diameter: f64,
}

/// A body that the wheel must not touch: a cylinder, part coordinates.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyFile {
    /// What it is.
    pub what: Body,
    /// From Z.
    pub z_from: f64,
    /// To Z.
    pub z_to: f64,
    /// Diameter.
    pub diameter: f64,
}

/// A block that the wheel must not touch, part coordinates.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BlockFile {
    /// What it is.
    pub what: Body,
    /// From and to along X; on a table that turns, radii.
    pub x: (f64, f64),
    /// From and to along Z; nothing on a table that turns.
    #[serde(default)]
    pub z: Option<(f64, f64)>,
    /// Its height.
    pub top: f64,
}

/// The set size of the radial (thickness) gauge.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GaugeFile {
    /// Diameter, or height on a table.
    pub set: f64,
    /// Where: X of a height (the radius on a table that turns).
    #[serde(default)]
    pub x: f64,
    /// Where: Z of a diameter or of a height.
    #[serde(default)]
    pub z: f64,
}

/// What stands in the way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Body {
    /// The chuck.
    Chuck,
    /// A fixture or the part's own unground body.
    Fixture,
}

/// Which way a face looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Looks {
    /// To +Z: touched by the wheel's left (−Z) side.
    PlusZ,
    /// To −Z: touched by the wheel's right (+Z) side.
    MinusZ,
}

/// One surface of the part before grinding.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum SurfaceFile {
    /// An outer diameter r(z) of a part that turns.
    Diameter {
        /// From Z.
        z_from: f64,
        /// To Z.
        z_to: f64,
        /// Stock diameter, mean.
        stock: f64,
        /// Cell size along Z.
        cell: f64,
        /// Runout, peak to valley of the radius over one turn.
        #[serde(default)]
        runout: f64,
        /// Waviness along Z, amplitude of the radius.
        #[serde(default)]
        waviness: f64,
    },
    /// A cone on a part that turns: a diameter r(z) that rises or falls evenly along Z.
    Cone {
        /// From Z.
        z_from: f64,
        /// To Z.
        z_to: f64,
        /// Stock diameter at the first end, mean.
        stock_from: f64,
        /// Stock diameter at the other end, mean.
        stock_to: f64,
        /// Cell size along Z.
        cell: f64,
        /// Runout, peak to valley of the radius over one turn.
        #[serde(default)]
        runout: f64,
        /// Waviness along Z, amplitude of the radius.
        #[serde(default)]
        waviness: f64,
    },
    /// A bore r(z) of a part that turns, a cylinder or a cone, ground from inside by the side of the rim that lies away from
    /// the part's axis.
    Bore {
        /// From Z.
        z_from: f64,
        /// To Z.
        z_to: f64,
        /// Stock diameter at the first end, mean.
        stock_from: f64,
        /// Stock diameter at the other end, mean.
        stock_to: f64,
        /// How thick the material around it is, radius.
        thickness: f64,
        /// Cell size along Z.
        cell: f64,
        /// Runout, peak to valley of the radius over one turn.
        #[serde(default)]
        runout: f64,
        /// Waviness along Z, amplitude of the radius.
        #[serde(default)]
        waviness: f64,
    },
    /// A face z(x), ground by the side of the wheel.
    Face {
        /// Which way it looks.
        looks: Looks,
        /// From diameter (the smaller).
        x_from: f64,
        /// To diameter.
        x_to: f64,
        /// Stock face at Z, mean.
        stock: f64,
        /// Cell size along the radius.
        cell: f64,
        /// Size across the wheel's way, of a face that does not turn; volume and load follow from it.
        width: f64,
        /// How thick the material behind the face is.
        thickness: f64,
        /// The face belongs to a part that must turn to be ground.
        #[serde(default)]
        turns: bool,
        /// Waviness along X, amplitude.
        #[serde(default)]
        waviness: f64,
    },
    /// GS: a plane y(x, z), ground by the rim.
    Plane {
        /// From X.
        x_from: f64,
        /// To X.
        x_to: f64,
        /// From Z.
        z_from: f64,
        /// To Z.
        z_to: f64,
        /// Stock height, mean.
        stock: f64,
        /// Cell size along X and Z.
        cell: f64,
        /// Waviness, amplitude.
        #[serde(default)]
        waviness: f64,
    },
    /// GS: a wall z(y) of a slot or step along X, ground by the side of the wheel.
    Wall {
        /// Which way it looks.
        looks: Looks,
        /// From X.
        x_from: f64,
        /// To X.
        x_to: f64,
        /// From Y, its foot.
        y_from: f64,
        /// To Y, its edge.
        y_to: f64,
        /// Stock at Z, mean.
        stock: f64,
        /// Cell size along Y.
        cell: f64,
        /// How thick the material behind the wall is.
        thickness: f64,
        /// Waviness along Y, amplitude.
        #[serde(default)]
        waviness: f64,
    },
    /// GA: a face z(r) on the table that turns, ground by the rim.
    Disc {
        /// From radius.
        x_from: f64,
        /// To radius.
        x_to: f64,
        /// Stock height, mean.
        stock: f64,
        /// Cell size along the radius.
        cell: f64,
        /// Runout, peak to valley of the height over one turn.
        #[serde(default)]
        runout: f64,
        /// Waviness along the radius, amplitude.
        #[serde(default)]
        waviness: f64,
    },
}

impl PartFile {
    /// The part that comes with a program.
    ///
    /// # Errors
    /// The file built in is wrong, which a test excludes.
    pub fn builtin(number: u32) -> Result<Option<Self>, SimFileError> {
        BUILTIN.iter().find(|(name, _)| program::number(name) == number).map(|(_, text)| Self::parse(text)).transpose()
    }

    /// The part that comes with a program of a name, without its extension, in either case.
    ///
    /// # Errors
    /// The file built in is wrong, which a test excludes.
    pub fn builtin_named(name: &str) -> Result<Option<Self>, SimFileError> {
        let found = NAMED.iter().find(|(known, _)| known.eq_ignore_ascii_case(name));
        found.map(|(_, text)| Self::parse(text)).transpose()
    }

    /// Reads a part file.
    ///
    /// # Errors
    /// The form with line and column, or the first value that makes no sense.
    pub fn parse(text: &str) -> Result<Self, SimFileError> {
        let file: Self = ron::from_str(text)?;
        for (i, surface) in file.surfaces.iter().enumerate() {
            surface.check(i + 1)?;
            if !file.kind.grinds().contains(&surface.form()) {
                let what = format!("surface {}", i + 1);
                return Err(SimFileError::Unfit { what, rule: "the part's kind of machine cannot grind it" });
            }
        }
        if let Some(bar) = file.bar {
            above_zero("bar.diameter", bar.diameter)?;
            above_zero("bar.cell", bar.cell)?;
            let cells = (bar.z_to - bar.z_from) / bar.cell;
            if !(1.0..=CELL_LIMIT).contains(&cells) {
                let rule = "there must be 1 to 100000 cells from the one end to the other";
                return Err(SimFileError::Value { field: "bar: cells".to_owned(), value: cells, rule });
            }
        }
        if let Some(offset) = file.offsets.iter().find(|offset| !(1..=16).contains(&offset.number)) {
            let (field, value) = ("offsets.number".to_owned(), f64::from(offset.number));
            return Err(SimFileError::Value { field, value, rule: "takes 1 to 16" });
        }
        Ok(file)
    }
}

impl SurfaceFile {
    /// What a machine must be able to grind for it.
    const fn form(&self) -> Form {
        match self {
            Self::Diameter { .. } | Self::Cone { .. } | Self::Face { .. } => Form::Outside,
            Self::Bore { .. } => Form::Bore,
            Self::Plane { .. } | Self::Wall { .. } => Form::Flat,
            Self::Disc { .. } => Form::Ring,
        }
    }

    fn check(&self, number: usize) -> Result<(), SimFileError> {
        // How many cells go from the one end to the other, in each direction.
        let (cell, stock, lengths) = match *self {
            Self::Diameter { z_from, z_to, cell, stock, .. } => (cell, stock, [z_to - z_from, cell]),
            Self::Cone { z_from, z_to, cell, stock_from, stock_to, .. } => {
                (cell, stock_from + stock_to, [z_to - z_from, cell])
            }
            Self::Bore { z_from, z_to, cell, stock_from, stock_to, .. } => {
                (cell, stock_from + stock_to, [z_to - z_from, cell])
            }
            Self::Face { x_from, x_to, cell, stock, .. } => (cell, stock, [(x_to - x_from) / 2.0, cell]),
            Self::Plane { x_from, x_to, z_from, z_to, cell, stock, .. } => {
                (cell, stock, [x_to - x_from, z_to - z_from])
            }
            Self::Wall { y_from, y_to, cell, stock, .. } => (cell, stock, [y_to - y_from, cell]),
            Self::Disc { x_from, x_to, cell, stock, .. } => (cell, stock, [x_to - x_from, cell]),
        };
        let name = |field: &str| format!("surface {number}: {field}");
        above_zero(&name("cell"), cell)?;
        if !stock.is_finite() {
            return Err(SimFileError::Value { field: name("stock"), value: stock, rule: "must be a number" });
        }
        let cells = lengths.map(|length| length / cell);
        let many = cells[0].max(0.0) * cells[1].max(0.0);
        if cells.iter().any(|cells| !(1.0..=CELL_LIMIT).contains(cells)) || many > CELL_LIMIT {
            let rule = "there must be 1 to 100000 cells from the one end to the other";
            return Err(SimFileError::Value { field: name("cells"), value: many, rule });
        }
        match *self {
            Self::Face { width, thickness, .. } => {
                above_zero(&name("width"), width)?;
                above_zero(&name("thickness"), thickness)
            }
            Self::Bore { thickness, .. } => above_zero(&name("thickness"), thickness),
            Self::Wall { x_from, x_to, thickness, .. } => {
                above_zero(&name("length"), x_to - x_from)?;
                above_zero(&name("thickness"), thickness)
            }
            Self::Disc { x_from, .. } if x_from < 0.0 => {
                Err(SimFileError::Value { field: name("x_from"), value: x_from, rule: "a radius is not below zero" })
            }
            Self::Diameter { .. } | Self::Cone { .. } | Self::Plane { .. } | Self::Disc { .. } => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text_of(program: u32) -> &'static str {
        BUILTIN.iter().find(|(name, _)| *name == format!("O{program}")).unwrap().1
    }

    #[test]
    fn p4_the_parts_built_in_can_be_read() {
        for (program, _) in BUILTIN {
            let part = PartFile::builtin(program::number(program)).unwrap().unwrap();
            assert!(!part.surfaces.is_empty(), "{program}");
        }
        for (name, _) in NAMED {
            assert!(PartFile::builtin_named(name).unwrap().unwrap().bar.is_some(), "{name}");
        }
        assert_eq!(PartFile::builtin(1020), Ok(None));
    }

    #[test]
    fn p4_a_surface_that_the_kind_of_machine_cannot_grind_is_refused() {
        let part = text_of(1007).replacen("kind: Gs", "kind: Ga", 1);
        let said = PartFile::parse(&part).unwrap_err().to_string();
        assert_eq!(said, "surface 1: the part's kind of machine cannot grind it");
    }

    #[test]
    fn p4_a_plane_has_no_more_cells_than_are_allowed() {
        let part = text_of(1007).replacen("cell: 1.0", "cell: 0.01", 1);
        let said = PartFile::parse(&part).unwrap_err().to_string();
        // 200 · 60 mm at 0.01 mm.
        assert!(said.starts_with("surface 1: cells is 120000000"), "{said}");
    }

    #[test]
    fn p4_a_part_without_length_is_refused_with_its_surface() {
        let part = text_of(1002).replacen("z_to: 48.0", "z_to: 30.0", 1);
        let said = PartFile::parse(&part).unwrap_err().to_string();
        assert!(said.starts_with("surface 1: cells is 0"), "{said}");
    }
}
