//! The devices that some kinds of machine have and others lack. Keys, signals, M codes, pages and factory bits that
//! belong to a device exist where the device exists. Source: spec K1, K2.1, L7–L9.

/// A device of a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Equipment {
    /// The grinding wheel with dressing, oscillation and second spindle.
    Wheel,
    /// A headstock with two speeds.
    Headstock,
    /// A driven dresser roll.
    DresserRoll,
    /// A table that rotates with the part.
    RotaryTable,
    /// A main spindle that turns the part against turning tools: the machine is a lathe.
    MainSpindle,
    /// A tailstock.
    Tailstock,
    /// A magnetic chuck.
    MagneticChuck,
    /// A hydraulic unit.
    Hydraulics,
    /// Two gauge arms.
    Gauges,
    /// A tool turret with four stations.
    ToolTurret,
}

/// The device that a key, a signal or a page needs; `None` if every machine has it.
pub type Needs = Option<Equipment>;

/// Every machine has it.
pub const ANY: Needs = None;
/// See [`Equipment::Wheel`].
pub const WHEEL: Needs = Some(Equipment::Wheel);
/// See [`Equipment::Headstock`].
pub const HEADSTOCK: Needs = Some(Equipment::Headstock);
/// See [`Equipment::DresserRoll`].
pub const ROLL: Needs = Some(Equipment::DresserRoll);
/// See [`Equipment::RotaryTable`].
pub const TABLE: Needs = Some(Equipment::RotaryTable);
/// See [`Equipment::MainSpindle`].
pub const SPINDLE: Needs = Some(Equipment::MainSpindle);
/// See [`Equipment::Tailstock`].
pub const TAILSTOCK: Needs = Some(Equipment::Tailstock);
/// See [`Equipment::MagneticChuck`].
pub const MAGNET: Needs = Some(Equipment::MagneticChuck);
/// See [`Equipment::Hydraulics`].
pub const HYDRAULICS: Needs = Some(Equipment::Hydraulics);
/// See [`Equipment::Gauges`].
pub const GAUGES: Needs = Some(Equipment::Gauges);
/// See [`Equipment::ToolTurret`].
pub const TURRET: Needs = Some(Equipment::ToolTurret);
