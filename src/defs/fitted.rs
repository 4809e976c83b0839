//! What a machine is fitted with: the devices and axes of its kind, and those that its parameters add (P6.6, P16.0).
//! Source: spec K1, K3.11, K5.3.

use super::equipment::{Equipment, Needs};
use super::kind::Kind;
use crate::units::{Axis, PerAxis};

/// The fitted devices and axes. [`super::param::Params::fitted`] has those of a machine; a kind alone stands for a
/// machine as delivered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fitted {
    /// The kind of machine.
    pub kind: Kind,
    /// P6.6: axis Y.
    pub axis_y: bool,
    /// P16.0: the magnet. Surface and rotary-table grinders have one anyway; the bit then enables it.
    pub magnet: bool,
}

impl Fitted {
    /// All that a machine of this kind can have.
    #[must_use]
    pub const fn fully(kind: Kind) -> Self {
        Self { kind, axis_y: true, magnet: true }
    }

    /// The axes.
    #[must_use]
    pub fn axes(self) -> PerAxis<bool> {
        PerAxis::from_fn(|axis| self.kind.row().axes[axis] || axis == Axis::Y && self.axis_y)
    }

    /// Whether it has a device.
    #[must_use]
    pub fn has(self, device: Equipment) -> bool {
        match device {
            Equipment::AxisY => self.axes()[Axis::Y],
            // The codes and keys of the magnet are those of the KT-830.
            Equipment::MagneticChuck if self.magnet && self.kind.dialect().is_kt830() => true,
            device => self.kind.row().has(device),
        }
    }

    /// Whether it has the device that something needs.
    #[must_use]
    pub fn meets(self, needs: Needs) -> bool {
        needs.is_none_or(|device| self.has(device))
    }
}
