//! Part files: the workpiece and its set-up, `assets/parts/O1001.ron` and so on (P4, T3). Parses text; reads no files.
//!
//! Part coordinates are work coordinates (G54) with a new wheel. GC: X as a diameter, Z along the part. GS: X along the
//! stroke, Y up, Z across. GA: X from the table's centre as a radius, Z up. The wheel's reference point is its front
//! (lowest) point on its minus side. Lengths are in mm.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::bending::{InternalSpindleFile, ShaftFile};
use super::drawing::DrawingSize;
use super::file_error::{SimFileError, refuse_value, require_positive, require_positive_fields};
use crate::defs::kind::{GrindingForm, Kind};
use crate::defs::program_number;
use crate::units::{MachinePos, PerAxis};

macro_rules! parts {
    ($($program:literal = $file:literal;)*) => {
        &[$(($program, include_str!(concat!("../../../assets/parts/", $file, ".ron"))),)*]
    };
}

/// Built-in parts of numbered programs.
#[rustfmt::skip]
const BUILTIN: &[(&str, &str)] = parts! {
    "O1001" = "O1001"; "O1002" = "O1002"; "O1003" = "O1003"; "O1004" = "O1004"; "O1005" = "O1005"; "O1006" = "O1006";
    "O1007" = "O1007"; "O1008" = "O1008"; "O1009" = "O1009"; "O1010" = "O1010"; "O1011" = "O1011"; "O1012" = "O1012";
    "O1013" = "O1013"; "O1014" = "O1014"; "O1015" = "O1015"; "O1016" = "O1016"; "O1017" = "O1017"; "O1018" = "O1018";
    "O1019" = "O1019"; "O1020" = "O1020"; "VGRIND" = "VGRIND"; "VBORE" = "VBORE"; "PRINTED" = "VGRIND";
};

/// Built-in parts of named programs.
const NAMED: &[(&str, &str)] = parts! { "SHAFT" = "SHAFT"; };

/// Greatest number of cells of one surface.
const CELL_LIMIT: f64 = 100_000.0;
const CELL_RULE: &str = "there must be 1 to 100000 cells from end to end";

/// A part in the machine.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartFile {
    /// Display name.
    pub name: String,
    /// The kind of machine that it is for.
    #[serde(default)]
    pub kind: Kind,
    /// Machine coordinates of the work zero, preset in G54; X as slide travel (radius).
    pub g54_mm: SlidePosition,
    /// Position of the axes at the start of a run, machine coordinates; X as slide travel (radius).
    pub start_mm: SlidePosition,
    /// Tool geometry to preset.
    #[serde(default)]
    pub offsets: Vec<OffsetPreset>,
    /// Macro variables to preset.
    #[serde(default)]
    pub variables: BTreeMap<u16, f64>,
    /// Whether the tailstock is advanced at the start; ignored on machines without tailstock.
    #[serde(default)]
    pub tailstock_advanced: bool,
    /// The tailstock when advanced.
    pub tailstock: Option<TailstockFile>,
    /// Round bodies that the wheel must not touch: chuck, fixture.
    #[serde(default)]
    pub bodies: Vec<BodyFile>,
    /// Blocks on a table that the wheel must not touch; on a rotary table they are rings.
    #[serde(default)]
    pub blocks: Vec<BlockFile>,
    /// Set size and measuring point of the radial (thickness) gauge.
    pub gauge: Option<GaugeSetupFile>,
    /// Set sizes of a gauge at the wheel head that measures several seats: the one within the wheel's width is in force.
    #[serde(default)]
    pub seat_gauges: Vec<GaugeSetupFile>,
    /// Radius of the fitted diamond's tip, mm; 0: a sharp point.
    #[serde(default)]
    pub diamond_radius_mm: f64,
    /// The bar of a lathe.
    pub bar: Option<BarFile>,
    /// The surfaces to be ground.
    #[serde(default)]
    pub surfaces: Vec<SurfaceFile>,
    /// Swivel angle of the wheel head, degrees. The rim then lies along a cone whose diameter grows downwards.
    #[serde(default)]
    pub head_deg: f64,
    /// The part bends under the wheel; without this it is stiff.
    #[serde(default)]
    pub shaft: Option<ShaftFile>,
    /// It is ground with the internal grinding spindle.
    #[serde(default)]
    pub internal_spindle: Option<InternalSpindleFile>,
    /// The finished size, if variables of the program define it.
    pub finished: Option<FinishedSizeFile>,
    /// Number of the variable into which the operator types the distance between the two faces of the drawing.
    #[serde(default)]
    pub typed_length: Option<u16>,
    /// The sizes that the part has once its program has ground it with the values of this file.
    #[serde(default)]
    pub drawing: Vec<DrawingSize>,
}

/// The finished diameter, defined by variables of the program. X programs the wheel's centre: the rim is at
/// X − wheel diameter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FinishedSizeFile {
    /// Number of the variable with the finished diameter.
    pub size: u16,
    /// Number of the variable with the wheel's diameter.
    pub wheel: u16,
    /// From Z.
    pub z_from: f64,
    /// To Z.
    pub z_to: f64,
    /// A bore: the rim is at X + wheel diameter, and grinding enlarges the diameter.
    #[serde(default)]
    pub inside: bool,
    /// A cone: numbers of the variables with its angle (degrees, growing downwards) and the Z of the finished size.
    pub cone: Option<(u16, u16)>,
}

/// The bar of a lathe, part coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BarFile {
    /// Its diameter.
    pub diameter: f64,
    /// Z at which it leaves the chuck.
    pub z_from: f64,
    /// Z of its face.
    pub z_to: f64,
    /// Cell size along Z.
    pub cell: f64,
}

/// A machine position, mm of slide travel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SlidePosition {
    /// X, radius.
    pub x: f64,
    /// Y, on machines that have it.
    #[serde(default)]
    pub y: f64,
    /// Z.
    pub z: f64,
}

impl SlidePosition {
    /// The position in machine coordinates.
    #[must_use]
    pub const fn machine(self) -> MachinePos {
        MachinePos::new([self.x, self.y, self.z])
    }

    /// The displacement of a work zero from the machine zero.
    #[must_use]
    pub const fn displacement(self) -> PerAxis<f64> {
        PerAxis([self.x, self.y, self.z])
    }
}

/// One tool offset to preset.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OffsetPreset {
    /// Offset number, 1–16.
    pub number: u8,
    /// Geometry X, diameter.
    pub x: f64,
    /// Geometry Z. With minus the wheel width, Z programs the wheel's right corner.
    pub z: f64,
    /// Radius R of the circle for G41 and G42, mm.
    #[serde(default)]
    pub r: f64,
    /// Place T of the programmed point of that circle, 0 to 9.
    #[serde(default)]
    pub t: u8,
}

/// The body of the tailstock: a cylinder from `z` towards +Z, part coordinates when advanced.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TailstockFile {
    /// Start of its body when advanced.
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
    pub what: BodyKind,
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
    pub what: BodyKind,
    /// From and to along X; on a rotary table radii.
    pub x: (f64, f64),
    /// From and to along Z; none on a rotary table.
    pub z: Option<(f64, f64)>,
    /// Its height.
    pub top: f64,
}

/// The set size of the radial (thickness) gauge.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GaugeSetupFile {
    /// Set diameter, or height on a table.
    pub set: f64,
    /// Measuring point: X of a height (the radius on a rotary table).
    #[serde(default)]
    pub x: f64,
    /// Measuring point: Z of a diameter or of a height.
    #[serde(default)]
    pub z: f64,
}

/// Type of an obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum BodyKind {
    /// The chuck.
    Chuck,
    /// A fixture or the part's own unground body.
    Fixture,
}

/// Direction that a face points to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum FaceDirection {
    /// Towards +Z: ground by the wheel's left (−Z) side.
    PlusZ,
    /// Towards −Z: ground by the wheel's right (+Z) side.
    MinusZ,
}

/// One surface of the part before grinding.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum SurfaceFile {
    /// An outer diameter r(z) of a rotating part.
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
    /// A cone on a rotating part: a diameter r(z) that changes linearly along Z.
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
    /// A bore r(z) of a rotating part, a cylinder or a cone, ground from inside by the side of the rim that is away
    /// from the part's axis.
    Bore {
        /// From Z.
        z_from: f64,
        /// To Z.
        z_to: f64,
        /// Stock diameter at the first end, mean.
        stock_from: f64,
        /// Stock diameter at the other end, mean.
        stock_to: f64,
        /// Radial thickness of the material around it.
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
    /// A face z(x) ground by the side of the wheel.
    Face {
        /// Direction that it points to.
        looks: FaceDirection,
        /// From diameter (the smaller).
        x_from: f64,
        /// To diameter.
        x_to: f64,
        /// Stock face at Z, mean.
        stock: f64,
        /// Cell size along the radius.
        cell: f64,
        /// Width across the wheel's path of a face that does not rotate; used for volume and load.
        width: f64,
        /// Thickness of the material behind the face.
        thickness: f64,
        /// The part must rotate for the face to be ground.
        #[serde(default)]
        turns: bool,
        /// Waviness along X, amplitude.
        #[serde(default)]
        waviness: f64,
    },
    /// GS: a plane y(x, z) ground by the rim.
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
    /// GS: a wall z(y) of a slot or step along X ground by the side of the wheel.
    Wall {
        /// Direction that it points to.
        looks: FaceDirection,
        /// From X.
        x_from: f64,
        /// To X.
        x_to: f64,
        /// From Y, the lower edge.
        y_from: f64,
        /// To Y, the upper edge.
        y_to: f64,
        /// Stock at Z, mean.
        stock: f64,
        /// Cell size along Y.
        cell: f64,
        /// Thickness of the material behind the wall.
        thickness: f64,
        /// Waviness along Y, amplitude.
        #[serde(default)]
        waviness: f64,
    },
    /// GA: a face z(r) on the rotary table ground by the rim.
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
    /// Whether the operator measures each part and types its size.
    #[must_use]
    pub fn has_typed_size(&self) -> bool {
        self.typed_length.is_some() || self.drawing.iter().any(|size| size.typed.is_some())
    }

    /// The built-in part of a program number.
    ///
    /// # Errors
    /// The built-in file is wrong, which a test excludes.
    pub fn builtin(number: u32) -> Result<Option<Self>, SimFileError> {
        let found = BUILTIN.iter().find(|(name, _)| program_number::from_name(name) == number);
        found.map(|(_, text)| Self::parse(text)).transpose()
    }

    /// The gauge that decides a size of the drawing, to be set; none if no gauge does.
    pub fn gauge_of_mut(&mut self, size: &DrawingSize) -> Option<&mut GaugeSetupFile> {
        if !size.is_gauged() {
            return None;
        }
        self.seat_gauges.iter_mut().find(|seat| size.covers(seat.z)).or(self.gauge.as_mut())
    }

    /// The names of the programs that have a built-in part.
    pub fn builtin_names() -> impl Iterator<Item = &'static str> {
        BUILTIN.iter().map(|(name, _)| *name)
    }

    /// The built-in part of a program name (without extension, upper or lower case).
    ///
    /// # Errors
    /// The built-in file is wrong, which a test excludes.
    pub fn builtin_named(name: &str) -> Result<Option<Self>, SimFileError> {
        let found = NAMED.iter().find(|(known, _)| known.eq_ignore_ascii_case(name));
        found.map(|(_, text)| Self::parse(text)).transpose()
    }

    /// Parses a part file.
    ///
    /// # Errors
    /// The syntax error with line and column, or the first invalid value.
    pub fn parse(text: &str) -> Result<Self, SimFileError> {
        let file: Self = ron::from_str(text)?;
        for (i, surface) in file.surfaces.iter().enumerate() {
            surface.check(i + 1)?;
            if !file.kind.ui().grinding_forms.contains(&surface.form()) {
                let what = format!("surface {}", i + 1);
                return Err(SimFileError::Incompatible { what, rule: "the part's kind of machine cannot grind it" });
            }
        }
        file.shaft.as_ref().map_or(Ok(()), ShaftFile::check)?;
        file.internal_spindle.as_ref().map_or(Ok(()), InternalSpindleFile::check)?;
        if let Some(bar) = file.bar {
            require_positive_fields!("bar", bar; diameter cell)?;
            let cells = (bar.z_to - bar.z_from) / bar.cell;
            if !(1.0..=CELL_LIMIT).contains(&cells) {
                refuse_value("bar: cells", cells, CELL_RULE)?;
            }
        }
        if let Some(offset) = file.offsets.iter().find(|offset| !(1..=16).contains(&offset.number)) {
            refuse_value("offsets.number", f64::from(offset.number), "must have 1 to 16")?;
        }
        Ok(file)
    }
}

impl SurfaceFile {
    /// The form that the machine must be able to grind.
    const fn form(&self) -> GrindingForm {
        match self {
            Self::Diameter { .. } | Self::Cone { .. } | Self::Face { .. } => GrindingForm::Outside,
            Self::Bore { .. } => GrindingForm::Bore,
            Self::Plane { .. } | Self::Wall { .. } => GrindingForm::Flat,
            Self::Disc { .. } => GrindingForm::RotaryFlat,
        }
    }

    fn check(&self, number: usize) -> Result<(), SimFileError> {
        // The lengths give the number of cells in each direction.
        let (cell, stock, lengths) = match *self {
            Self::Diameter { z_from, z_to, cell, stock, .. } => (cell, stock, [z_to - z_from, cell]),
            Self::Cone { z_from, z_to, cell, stock_from, stock_to, .. }
            | Self::Bore { z_from, z_to, cell, stock_from, stock_to, .. } => {
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
        require_positive(&name("cell"), cell)?;
        if !stock.is_finite() {
            return refuse_value(name("stock"), stock, "must be a number");
        }
        let cells = lengths.map(|length| length / cell);
        let many = cells[0].max(0.0) * cells[1].max(0.0);
        if cells.iter().any(|cells| !(1.0..=CELL_LIMIT).contains(cells)) || many > CELL_LIMIT {
            return refuse_value(name("cells"), many, CELL_RULE);
        }
        match *self {
            Self::Face { width, thickness, .. } => {
                require_positive(&name("width"), width)?;
                require_positive(&name("thickness"), thickness)
            }
            Self::Bore { thickness, .. } => require_positive(&name("thickness"), thickness),
            Self::Wall { x_from, x_to, thickness, .. } => {
                require_positive(&name("length"), x_to - x_from)?;
                require_positive(&name("thickness"), thickness)
            }
            Self::Disc { x_from, .. } if x_from < 0.0 => {
                refuse_value(name("x_from"), x_from, "a radius must not be negative")
            }
            Self::Diameter { .. } | Self::Cone { .. } | Self::Plane { .. } | Self::Disc { .. } => Ok(()),
        }
    }
}
