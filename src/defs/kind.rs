//! The kinds of machine and the dialects of their programs. The configuration of each kind is in `machine::kind`.
//! Source: spec K1, S1.

use serde::{Deserialize, Serialize};

use super::text::Text;

/// A kind of machine, selected at start and stored in the settings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Kind {
    /// KT-830GC, cylindrical grinder; the default.
    #[default]
    Gc,
    /// KT-830GS, surface grinder.
    Gs,
    /// KT-830GA, rotary-table grinder.
    Ga,
    /// Vertical lathe-grinder with SINUMERIK 802D programs.
    Vertical,
    /// Lathe with a four-station tool turret and 超人 (SuperMan) CNC programs; also used as a training simulator.
    Lathe,
}

/// The dialect of the programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dialect {
    /// GC: U, V, W are incremental; G90 and G94 are cycles.
    LatheA,
    /// GS and GA: G90 and G91 are modal; U, V, W are incremental as well.
    Mill,
    /// SINUMERIK 802D: R parameters, `X=R20`, labels, G90 and G91 modal (S1).
    Sinumerik,
    /// 超人 (SuperMan) lathe: X, Z absolute, U, W incremental, all X words diameters, arc direction reversed (L1–L8).
    SuperMan,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 5] = [Self::Gc, Self::Gs, Self::Ga, Self::Vertical, Self::Lathe];
    /// The KT-830 kinds, with the customer's codes, keys and pages (K1).
    pub const KT830: [Self; 3] = [Self::Gc, Self::Gs, Self::Ga];

    /// The word used on the command line and in stories.
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            Self::Gc => "gc",
            Self::Gs => "gs",
            Self::Ga => "ga",
            Self::Vertical => "vertical",
            Self::Lathe => "lathe",
        }
    }

    /// The subfolder of its programs below the programs folder; empty for the programs folder itself.
    #[must_use]
    pub const fn program_folder(self) -> &'static str {
        match self {
            Self::Gc | Self::Gs | Self::Ga | Self::Lathe => "",
            Self::Vertical => "802d",
        }
    }

    /// The dialect of its programs.
    #[must_use]
    pub const fn dialect(self) -> Dialect {
        match self {
            Self::Gc => Dialect::LatheA,
            Self::Gs | Self::Ga => Dialect::Mill,
            Self::Vertical => Dialect::Sinumerik,
            Self::Lathe => Dialect::SuperMan,
        }
    }

    /// The name on a key.
    #[must_use]
    pub const fn short_name(self) -> &'static str {
        match self {
            Self::Gc => "GC",
            Self::Gs => "GS",
            Self::Ga => "GA",
            Self::Vertical => "802D",
            Self::Lathe => "LATHE",
        }
    }

    /// The kind of an id, in either case.
    #[must_use]
    pub fn from_id(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.id().eq_ignore_ascii_case(id))
    }

    /// The name in the header.
    #[must_use]
    pub const fn name(self) -> Text {
        match self {
            Self::Gc => Text::new("KT-830GC 外圆磨床", "KT-830GC cylindrical grinder"),
            Self::Gs => Text::new("KT-830GS 平面磨床", "KT-830GS surface grinder"),
            Self::Ga => Text::new("KT-830GA 圆台磨床", "KT-830GA rotary table grinder"),
            Self::Vertical => Text::new("立式车磨床 802D", "vertical lathe-grinder 802D"),
            Self::Lathe => Text::new("超人车床", "SuperMan lathe"),
        }
    }
}

impl Dialect {
    /// The milling dialect: G90 and G91 are modal (GS, GA).
    #[must_use]
    pub const fn is_mill(self) -> bool {
        matches!(self, Self::Mill)
    }

    /// It uses the G codes of the `gcode` table; the other dialects have their own words.
    #[must_use]
    pub const fn is_kt830(self) -> bool {
        matches!(self, Self::LatheA | Self::Mill)
    }

    /// Round brackets enclose comments. With R parameters they belong to expressions (S1).
    #[must_use]
    pub const fn has_bracket_comments(self) -> bool {
        !self.has_r_parameters()
    }

    /// R parameters exist, and round brackets belong to expressions (S1).
    #[must_use]
    pub const fn has_r_parameters(self) -> bool {
        matches!(self, Self::Sinumerik)
    }
}
