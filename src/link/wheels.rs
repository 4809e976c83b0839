//! Requests of the wheel change page about the list of wheels.
//! Source: spec K5.17; issue "the face", part 6.

/// What happens to a wheel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WheelCommand {
    /// The wheel on the machine is kept under this number.
    Keep(u16),
    /// The wheel of this number was mounted; it must be dressed before a cycle start.
    Mount(u16),
    /// The wheel of this number leaves the list.
    Remove(u16),
    /// The wheel on the machine was balanced.
    Balanced,
    /// The wheel on the machine has hit something.
    Crashed,
}
