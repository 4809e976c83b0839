//! The units of the machine on the operator panel: captions and keys. `hmi::panel` places those that are fitted.
//! Source: spec H2, K1, K2.1.

use crate::defs::key::Key;
use crate::defs::text::Text;

/// One unit of the machine.
#[derive(Clone, Copy, Debug)]
pub struct MachineUnit {
    /// Its caption.
    pub caption: Text,
    /// Its keys.
    pub keys: &'static [Key],
    /// Its width in key columns.
    pub columns: usize,
}

/// The units of one panel.
#[derive(Clone, Copy, Debug)]
pub struct MachineUnits {
    /// Units side by side, three keys high.
    pub beside: &'static [MachineUnit],
    /// Units in the row below them.
    pub below: &'static [MachineUnit],
}

impl MachineUnits {
    pub(super) const fn new(beside: &'static [MachineUnit], below: &'static [MachineUnit]) -> Self {
        Self { beside, below }
    }
}

impl MachineUnit {
    pub(super) const fn new(caption: Text, keys: &'static [Key], columns: usize) -> Self {
        Self { caption, keys, columns }
    }

    /// The same unit with another width.
    pub(super) const fn across(self, columns: usize) -> Self {
        Self { columns, ..self }
    }
}

/// The wheel with the second spindle; on the wide panel the second spindle is a unit.
pub(super) const WHEEL: MachineUnit =
    MachineUnit::new(Text::new("砂轮", "WHEEL"), &[Key::WheelStart, Key::WheelStop, Key::SecondSpindle], 1);
pub(super) const WHEEL_ALONE: MachineUnit =
    MachineUnit::new(Text::new("砂轮", "WHEEL"), &[Key::WheelStart, Key::WheelStop], 1);
pub(super) const SECOND_SPINDLE: MachineUnit = MachineUnit::new(Text::new("主轴", "SPDL"), &[Key::SecondSpindle], 1);
pub(super) const FLUIDS: MachineUnit =
    MachineUnit::new(Text::new("液体", "FLUIDS"), &[Key::Coolant, Key::Lubrication, Key::Hydraulic], 1);
pub(super) const DRESSING: MachineUnit =
    MachineUnit::new(Text::new("修整", "DRESS"), &[Key::Oscillation, Key::DressReturn, Key::WheelRetract], 1);
/// The trial-run switches, on the wide panel.
pub(super) const TRIAL: MachineUnit =
    MachineUnit::new(Text::new("试运行", "TRIAL"), &[Key::MachineLock, Key::AuxFunctionLock, Key::DryRun], 1);
pub(super) const MAGNET: MachineUnit =
    MachineUnit::new(Text::new("磁力", "MAGNET"), &[Key::Magnetise, Key::Demagnetise], 1);
pub(super) const TABLE: MachineUnit = MachineUnit::new(Text::new("台面", "TABLE"), &[Key::TableRotation], 2);
pub(super) const GAUGES: MachineUnit =
    MachineUnit::new(Text::new("量仪", "GAUGES"), &[Key::RadialGauge, Key::AxialGauge], 2);
