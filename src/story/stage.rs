//! What a story is played on.
//! Source: spec tools.md T5.

use super::statement::DiskCondition;
use crate::host::Host;
use crate::host::hosted_machine::HostedMachine;
use crate::host::storage::Storage;
use crate::host::thread::HostThread;

/// Why a disk or a screen does not behave as a story wants.
pub const NOT_TORTURED: &str = "only a tortured control has a simulated disk and a screen that hangs";

/// What a story is played on: a host that is stepped, or one turn of a host on a thread.
pub trait Stage {
    /// Machine of the host.
    type Machine: HostedMachine;
    /// Storage of the host.
    type Storage: Storage;
    /// The host.
    fn host(&mut self) -> &mut Host<Self::Machine, Self::Storage>;
    /// One tick.
    fn step(&mut self);
    /// Cuts the power of the control.
    fn power_cut(&mut self);
    /// Gives the power back.
    fn power_on(&mut self);
    /// Changes how the disk behaves.
    ///
    /// # Errors
    /// The disk is a real one.
    fn set_disk(&mut self, _condition: DiskCondition) -> Result<(), String> {
        Err(NOT_TORTURED.to_owned())
    }
    /// The screen hangs from now on for some seconds.
    ///
    /// # Errors
    /// The stage has no screen that could.
    fn hang_screen(&mut self, _seconds: f64) -> Result<(), String> {
        Err(NOT_TORTURED.to_owned())
    }
    /// Whether the story is to end: the operator has touched the screen (demo), or the time is over.
    fn is_interrupted(&self) -> bool;
}

impl<P: HostedMachine, S: Storage> Stage for Host<P, S> {
    type Machine = P;
    type Storage = S;

    fn host(&mut self) -> &mut Self {
        self
    }

    fn step(&mut self) {
        Self::step(self);
    }

    fn power_cut(&mut self) {
        Self::power_cut(self);
    }

    fn power_on(&mut self) {
        Self::power_on(self);
    }

    fn is_interrupted(&self) -> bool {
        false
    }
}

impl<P: HostedMachine, S: Storage> Stage for HostThread<P, S> {
    type Machine = P;
    type Storage = S;

    fn host(&mut self) -> &mut Host<P, S> {
        Self::host(self)
    }

    fn step(&mut self) {
        self.turn();
    }

    fn power_cut(&mut self) {
        Self::host(self).power_cut();
    }

    fn power_on(&mut self) {
        Self::host(self).power_on();
    }

    fn is_interrupted(&self) -> bool {
        self.is_touched() || self.is_stopped()
    }
}
