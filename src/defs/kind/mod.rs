//! The kinds of machine, one file per kind. Other modules read the row of a kind and do not ask for the kind. A new kind is its file here, its machine file in `assets/machines` and its row in `kinds!`.
//! Source: spec K1, S1.

mod ga;
mod gc;
mod gs;
mod lathe;
mod panel;
mod ui;
mod vertical;

pub use super::dialect::Dialect;
pub use panel::{MachineUnit, MachineUnits};
pub use ui::{GrindingForm, KeyLabel, KindUi, WheelPose};

use serde::{Deserialize, Serialize};

use super::equipment::Equipment;
use super::param::row::{BitParam, NumberParam};
use super::signal::Output;
use super::text::Text;
use crate::units::{Axis, PerAxis};

macro_rules! kinds {
    ($($(#[$doc:meta])* $variant:ident = $file:ident;)*) => {
        /// A kind of machine, selected at start and stored in the settings.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
        pub enum Kind { $($(#[$doc])* $variant,)* }

        impl Kind {
            /// All kinds.
            pub const ALL: [Self; [$(stringify!($variant)),*].len()] = [$(Self::$variant),*];

            /// The description of the kind.
            #[must_use]
            pub const fn row(self) -> &'static KindRow {
                match self { $(Self::$variant => &$file::ROW,)* }
            }
        }
    };
}

kinds! {
    /// KT-830GC, cylindrical grinder; the default.
    #[default]
    Gc = gc;
    /// KT-830GS, surface grinder.
    Gs = gs;
    /// KT-830GA, rotary-table grinder.
    Ga = ga;
    /// Vertical lathe-grinder with SINUMERIK 802D programs.
    Vertical = vertical;
    /// Lathe with a four-station tool turret and 超人 (SuperMan) CNC programs; also used as a training simulator.
    Lathe = lathe;
}

/// The description of one kind.
#[derive(Debug)]
pub struct KindRow {
    /// The word used on the command line and in stories.
    pub id: &'static str,
    /// The name on a key.
    pub short_name: &'static str,
    /// The name in the header.
    pub name: Text,
    /// The kind in a few words, for the help of the command line.
    pub summary: &'static str,
    /// The dialect of its programs.
    pub dialect: Dialect,
    /// Where its programs are.
    pub programs: KindPrograms,
    /// The standard axes; Y can be fitted to any kind (P6.6).
    pub axes: PerAxis<bool>,
    /// The order of homing: the wheel axis first, away from the part (K5.16).
    pub home_order: &'static [Axis],
    /// The axis whose minus direction is slow while the wheel turns (K5.9).
    pub wheel_axis: Axis,
    /// Its devices.
    pub equipment: &'static [Equipment],
    /// File numbers of its grinding pages (C0801 …); empty where each program has its own page (K7.2).
    pub page_files: &'static [u32],
    /// Those of them that tell what part is made: sizes and feeds, not wheel and run values.
    pub part_files: &'static [u32],
    /// Factory values.
    pub factory: KindFactory,
    /// The file of the simulated machine.
    pub machine_file: &'static str,
    /// The shipped program that dresses its wheel.
    pub dressing_program: Option<u32>,
    /// The story that `kt830 demo` plays; it names the kind. `None`: that of the default kind.
    pub demo_story: Option<&'static str>,
    /// What spectators see instead, one story after the other, with captions; empty: the story above.
    pub film_stories: &'static [&'static str],
    /// Labels, drawings and the operator panel.
    pub ui: KindUi,
}

/// Where the programs of a kind are.
#[derive(Debug)]
pub struct KindPrograms {
    /// The subfolder below the programs folder; empty for the programs folder itself, which several kinds share.
    pub folder: &'static str,
    /// Programs have names (`SHAFT.NC`) instead of O numbers (L1).
    pub by_name: bool,
    /// The programs shipped in the subfolder: file name and content.
    pub shipped: &'static [(&'static str, &'static [u8])],
}

impl KindPrograms {
    /// The programs folder with the O numbers.
    const SHARED: Self = Self { folder: "", by_name: false, shipped: &[] };
}

/// Factory values of a kind where they differ from the parameter table.
#[derive(Debug)]
pub struct KindFactory {
    /// Number parameters.
    pub numbers: &'static [(NumberParam, f64)],
    /// Bits.
    pub bits: &'static [(BitParam, bool)],
    /// Narrower ranges: parameter, minimum, maximum.
    pub ranges: &'static [(NumberParam, f64, f64)],
    /// R parameters: number, value.
    pub r_parameters: &'static [(u16, f64)],
}

impl KindFactory {
    /// The values of the parameter table.
    const TABLE: Self = Self { numbers: &[], bits: &[], ranges: &[], r_parameters: &[] };
}

impl Kind {
    /// The KT-830 kinds, with the customer's codes, keys and pages (K1).
    pub fn kt830() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(|kind| kind.dialect().is_kt830())
    }

    /// The word used on the command line and in stories.
    #[must_use]
    pub const fn id(self) -> &'static str {
        self.row().id
    }

    /// The name on a key.
    #[must_use]
    pub const fn short_name(self) -> &'static str {
        self.row().short_name
    }

    /// The name in the header.
    #[must_use]
    pub const fn name(self) -> Text {
        self.row().name
    }

    /// The dialect of its programs.
    #[must_use]
    pub const fn dialect(self) -> Dialect {
        self.row().dialect
    }

    /// Labels, drawings and the operator panel.
    #[must_use]
    pub const fn ui(self) -> &'static KindUi {
        &self.row().ui
    }

    /// Whether it is a lathe: a main spindle turns the part and tools cut it.
    #[must_use]
    pub fn is_lathe(self) -> bool {
        self.row().is_lathe()
    }

    /// The kind of an id, in either case.
    #[must_use]
    pub fn from_id(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.id().eq_ignore_ascii_case(id))
    }
}

impl KindRow {
    /// Whether every machine of the kind has a device; `defs::fitted` knows what parameters add.
    #[must_use]
    pub fn has(&self, device: Equipment) -> bool {
        self.equipment.contains(&device)
    }

    /// Whether it is a lathe: a main spindle turns the part and tools cut it (L7, L8).
    #[must_use]
    pub fn is_lathe(&self) -> bool {
        self.has(Equipment::MainSpindle)
    }

    /// Whether homing passes the switch and returns onto its far edge (L6).
    #[must_use]
    pub fn homes_over_switch(&self) -> bool {
        self.is_lathe()
    }

    /// Whether a program may start before homing: a lathe program homes the axes itself (L6).
    #[must_use]
    pub fn may_start_unhomed(&self) -> bool {
        self.is_lathe()
    }

    /// Whether the M63 drive carries the part on the magnet (K3.11: the table turns only when magnetised).
    #[must_use]
    pub fn drive_needs_magnet(&self) -> bool {
        self.has(Equipment::RotaryTable) && self.has(Equipment::MagneticChuck)
    }

    /// The output of M63 (fast) or M64; the same where there is one speed.
    #[must_use]
    pub fn drive_output(&self, fast: bool) -> Output {
        let drive = self.equipment.iter().find_map(|device| device.work_drive());
        drive.map_or(Output::SpindleForward, |(high, low)| if fast { high } else { low })
    }
}

impl Equipment {
    /// The outputs of M63 and M64, if the device is the workpiece drive.
    #[must_use]
    pub const fn work_drive(self) -> Option<(Output, Output)> {
        match self {
            Self::Headstock => Some((Output::HeadstockHigh, Output::HeadstockLow)),
            Self::DresserRoll => Some((Output::DresserRoll, Output::DresserRoll)),
            Self::RotaryTable => Some((Output::TableRotation, Output::TableRotation)),
            Self::Wheel
            | Self::MainSpindle
            | Self::Tailstock
            | Self::MagneticChuck
            | Self::Hydraulics
            | Self::Gauges
            | Self::ToolTurret
            | Self::AxisY => None,
        }
    }
}
