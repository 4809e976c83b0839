//! Requests of the offset, variable, MDI and wheel pages, and the answers of the core.
//! Lengths are as displayed: diameters where diameter mode is on.
//! Source: spec B6, K4.1, K5.10, K5.17, K7.6, K7.7.

use crate::defs::text::{LocalizedText, Text};
use crate::units::{Axis, DisplayPos};

/// Number of work offsets on their page: external, G54 to G59, G54.1 P1 to P48.
pub const ORIGIN_COUNT: usize = 55;

/// The name of a work offset by its row on the page.
#[must_use]
pub fn origin_name(row: usize) -> String {
    match row {
        0 => "EXT".to_owned(),
        1..=6 => format!("G{}", 53 + row),
        _ => format!("P{}", row - 6),
    }
}

/// Number of tool offsets; they are numbered 1 to 16 (K4.1).
pub const OFFSET_COUNT: usize = 16;

/// Why a grinding value, an offset or a variable is refused while a run is open (K7.7).
pub const LOCKED_IN_RUN: Text = Text::new("程序运行中不能修改 (P6.3)", "not allowed while a program runs (P6.3)");

/// The two halves of a tool offset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OffsetPart {
    /// Position of the wheel.
    Geometry,
    /// Corrections since then.
    Wear,
}

impl OffsetPart {
    /// The name shown.
    #[must_use]
    pub const fn name(self) -> &'static Text {
        match self {
            Self::Geometry => const { &Text::new("几何", "geometry") },
            Self::Wear => const { &Text::new("磨耗", "wear") },
        }
    }

    /// Maximum absolute value, mm.
    #[must_use]
    pub const fn max_abs(self) -> f64 {
        match self {
            Self::Geometry => 9_999.999,
            Self::Wear => 999.999,
        }
    }
}

/// Maximum increment typed at a page, mm; it catches a missing decimal point.
pub const MAX_INCREMENT: f64 = 9.999;

/// A change of a coordinate of a work offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OriginChange {
    /// The new machine coordinate, mm.
    Set(f64),
    /// An increment, mm.
    Add(f64),
    /// The work coordinate of the place where the axis stands, mm.
    Measure(f64),
}

/// A request of the offset or dressing page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OffsetCommand {
    /// Replaces a value.
    Set {
        /// 1 to 16.
        number: usize,
        /// Geometry or wear.
        part: OffsetPart,
        /// Axis.
        axis: Axis,
        /// mm.
        value: f64,
    },
    /// Sets the radius R of the circle for G41 and G42.
    SetRadius {
        /// 1 to 16.
        number: usize,
        /// mm, 0 to 999.999.
        value: f64,
    },
    /// Sets the place T of the programmed point of that circle.
    SetTip {
        /// 1 to 16.
        number: usize,
        /// 0 to 9.
        value: f64,
    },
    /// Changes a coordinate of a work offset.
    Origin {
        /// Its row on the page, from 0.
        row: usize,
        /// Axis.
        axis: Axis,
        /// The change.
        change: OriginChange,
    },
    /// Adds an increment to the geometry; for the wear see [`super::Command::AddWear`].
    AddGeometry {
        /// 1 to 16.
        number: usize,
        /// Axis.
        axis: Axis,
        /// mm.
        increment: f64,
    },
    /// The axis was measured at this work coordinate: the geometry is set to match it and the wear of the axis is
    /// cleared (K5.10).
    Measure {
        /// 1 to 16.
        number: usize,
        /// Axis.
        axis: Axis,
        /// Work coordinate, mm.
        value: f64,
    },
}

/// The core's answer to a value typed at a page.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EditAnswer {
    /// Number of answers so far; a page recognises a new answer by it.
    pub count: u32,
    /// Why the last value was refused; none if it was accepted.
    pub refused: Option<LocalizedText>,
}

/// One tool offset as displayed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OffsetView {
    /// Geometry.
    pub geometry: DisplayPos,
    /// Wear.
    pub wear: DisplayPos,
    /// R: radius of the circle for G41 and G42, mm.
    pub radius_mm: f64,
    /// T: place of the programmed point of that circle, 0 to 9.
    pub tip: u8,
}

impl OffsetView {
    /// The geometry or the wear.
    #[must_use]
    pub const fn part(&self, part: OffsetPart) -> &DisplayPos {
        match part {
            OffsetPart::Geometry => &self.geometry,
            OffsetPart::Wear => &self.wear,
        }
    }
}

/// Tool offsets and work offsets as displayed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OffsetTables {
    /// Tool offsets 1 to 16.
    pub tools: [OffsetView; OFFSET_COUNT],
    /// The active tool offset, 1 to 16; 0 for none.
    pub active_tool: usize,
    /// Work offsets, machine coordinates, in the order of their page.
    pub origins: [DisplayPos; ORIGIN_COUNT],
    /// Row of the active work offset on its page; none under G500.
    pub active_origin: Option<usize>,
}

impl Default for OffsetTables {
    fn default() -> Self {
        let (tools, origins) = ([OffsetView::default(); OFFSET_COUNT], [DisplayPos::default(); ORIGIN_COUNT]);
        Self { tools, active_tool: 0, origins, active_origin: Some(1) }
    }
}

/// The active modal codes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ModalView {
    /// G codes by group: motion, plane, absolute or incremental, feed mode, unit, work offset (G54.1 P1 to P48 as 101 to
    /// 148), path, speed mode, radius compensation.
    pub g: [u8; 9],
    /// F, mm/min or mm per revolution.
    pub feed: Option<f64>,
    /// S.
    pub speed: Option<f64>,
    /// Tool and offset of the last T word.
    pub tool: (u16, u16),
    /// The last M code.
    pub m: Option<u8>,
}

impl ModalView {
    /// The G codes as programs write them.
    pub fn g_names(&self) -> impl Iterator<Item = String> + '_ {
        self.g.iter().map(|g| match g {
            100 => "G500".to_owned(),
            101.. => format!("G54.1P{}", g - 100),
            _ => format!("G{g:02}"),
        })
    }
}
