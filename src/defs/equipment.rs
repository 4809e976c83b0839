//! The devices that some machines have and others lack. Keys, signals, M codes, pages, parameters and faults that belong
//! to a device exist where it is fitted (`defs::fitted`). Source: spec K1, K2.1, L7–L9.

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
    /// The axis Y.
    AxisY,
}

/// The device that a key, a signal or a page needs; `None` if every machine has it.
pub type Needs = Option<Equipment>;

/// What a row of a table needs: a device; `ANY` or nothing if every machine has it.
macro_rules! needs {
    () => {
        None
    };
    (ANY) => {
        None
    };
    ($device:ident) => {
        Some($crate::defs::equipment::Equipment::$device)
    };
}
pub(super) use needs;
