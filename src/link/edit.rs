//! What the pages of offsets, variables, MDI and the wheel ask of the core, and how it answers.
//! Lengths are as displayed: diameters where diameter mode is on.
//! Source: spec B6, K4.1, K5.10, K5.17, K7.6, K7.7.

use crate::defs::text::{Said, Text};
use crate::units::{Axis, PerAxis};

/// Tool offsets: 1 to 16 (K4.1).
pub const OFFSETS: usize = 16;

/// The two halves of a tool offset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Part {
    /// Where the wheel is.
    Geometry,
    /// What has been corrected since.
    Wear,
}

impl Part {
    /// The name shown.
    #[must_use]
    pub const fn name(self) -> Text {
        match self {
            Self::Geometry => Text::new("几何", "geometry"),
            Self::Wear => Text::new("磨耗", "wear"),
        }
    }

    /// Greatest absolute value, mm.
    #[must_use]
    pub const fn most(self) -> f64 {
        match self {
            Self::Geometry => 9_999.999,
            Self::Wear => 999.999,
        }
    }
}

/// Greatest increment typed at a page, mm: a lost decimal point is not let through.
pub const MOST_INCREMENT: f64 = 9.999;

/// What the offset and the dressing page ask.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OffsetCommand {
    /// A value in place of the old one.
    Set {
        /// 1 to 16.
        number: usize,
        /// Geometry or wear.
        part: Part,
        /// Axis.
        axis: Axis,
        /// mm.
        value: f64,
    },
    /// An increment to the geometry; the wear has [`super::Command::AddWear`].
    AddGeometry {
        /// 1 to 16.
        number: usize,
        /// Axis.
        axis: Axis,
        /// mm.
        by: f64,
    },
    /// The axis stands at this work coordinate, as measured: the geometry becomes what makes it so, the wear of the
    /// axis is cleared (K5.10).
    Measure {
        /// 1 to 16.
        number: usize,
        /// Axis.
        axis: Axis,
        /// Work coordinate, mm.
        value: f64,
    },
}

/// How the core answered what was typed at a page.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EditAnswer {
    /// Counts the answers, so that a page sees a new one.
    pub count: u32,
    /// Why the last one was refused; none: it was taken.
    pub refused: Option<Said>,
}

/// One tool offset as displayed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OffsetView {
    /// Geometry.
    pub geometry: PerAxis<f64>,
    /// Wear.
    pub wear: PerAxis<f64>,
}

impl OffsetView {
    /// One of its halves.
    #[must_use]
    pub const fn part(&self, part: Part) -> &PerAxis<f64> {
        match part {
            Part::Geometry => &self.geometry,
            Part::Wear => &self.wear,
        }
    }
}

/// The codes in force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ModalView {
    /// G codes by group: motion, plane, absolute or incremental, feed mode, unit, frame, path, speed mode.
    pub g: [u8; 8],
    /// F, mm/min or mm per revolution.
    pub feed: Option<f64>,
    /// S.
    pub speed: Option<f64>,
    /// Tool and offset of the last T.
    pub tool: (u16, u16),
    /// The last M code.
    pub m: Option<u8>,
}
