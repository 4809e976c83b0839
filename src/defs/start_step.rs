//! The conditions of a cycle start, in the order in which an operator meets them.
//! Source: spec K2.2, K3.3, K3.7, K3.11, K5.13, K5.17, B5.

use super::text::Text;

/// One condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StartStep {
    /// Emergency stop released, drives on, no alarm, no external hold.
    Machine,
    /// The guard is closed.
    Guard,
    /// The hydraulics are on and have pressure.
    Hydraulics,
    /// Every axis is homed.
    Homing,
    /// The tailstock holds the part.
    Tailstock,
    /// The magnet holds the part.
    Magnet,
    /// A changed wheel is dressed.
    Wheel,
    /// A program is chosen, and has no mistake up to its first action. A lathe program is not read.
    Program,
    /// The program accepts its values.
    Values,
    /// Mode AUTO, and nothing oscillates or is retracted.
    Mode,
}

impl StartStep {
    /// All conditions, in order.
    pub const ALL: [Self; 10] = [
        Self::Machine,
        Self::Guard,
        Self::Hydraulics,
        Self::Homing,
        Self::Tailstock,
        Self::Magnet,
        Self::Wheel,
        Self::Program,
        Self::Values,
        Self::Mode,
    ];

    /// The word in stories and tests.
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            Self::Machine => "machine",
            Self::Guard => "guard",
            Self::Hydraulics => "hydraulics",
            Self::Homing => "homing",
            Self::Tailstock => "tailstock",
            Self::Magnet => "magnet",
            Self::Wheel => "wheel",
            Self::Program => "program",
            Self::Values => "values",
            Self::Mode => "mode",
        }
    }

    /// The name on the screen.
    #[must_use]
    pub const fn name(self) -> Text {
        match self {
            Self::Machine => Text::new("机床", "machine"),
            Self::Guard => Text::new("门", "guard"),
            Self::Hydraulics => Text::new("液压", "hydraul."),
            Self::Homing => Text::new("回零", "homed"),
            Self::Tailstock => Text::new("尾座", "tailstock"),
            Self::Magnet => Text::new("充磁", "magnet"),
            Self::Wheel => Text::new("砂轮", "wheel"),
            Self::Program => Text::new("程序", "program"),
            Self::Values => Text::new("数值", "values"),
            Self::Mode => Text::new("自动", "auto"),
        }
    }
}
