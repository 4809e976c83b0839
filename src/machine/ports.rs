//! Output ports switched by number: M20 pulse, M21 on, M22 off.
//! Source: spec B4. Ports of interlocked functions are refused; a port of a plain function switches that function.

use crate::defs::fitted::Fitted;
use crate::defs::param::Params;
use crate::defs::signal::{Output, PORTS, Terminals};
use crate::units::Micros;

/// Maximum simultaneous pulses.
const MAX_PULSES: usize = 8;

/// The function that owns a port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PortOwner {
    /// No function uses it.
    Unassigned,
    /// A function without interlocks: coolant, lubrication, a user output.
    Plain(Output),
    /// A function with interlocks or a sequence.
    Interlocked(Output),
}

/// The owner of an output port. The ports of what parameters can add stay reserved: P16.0 finds its magnet's ports free.
pub fn port_owner(port: u8, params: &Params) -> PortOwner {
    let (mut found, machine) = (PortOwner::Unassigned, Fitted::fully(params.fitted().kind));
    for output in Output::ALL {
        if port == 0 || !output.exists_on(machine) || params.output_port(*output) != port {
            continue;
        }
        if !output.is_freely_switchable() {
            return PortOwner::Interlocked(*output);
        }
        found = PortOwner::Plain(*output);
    }
    found
}

/// The ports switched on by programs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ports {
    on: Terminals,
    pulses: [Option<(u8, Micros)>; MAX_PULSES],
}

impl Ports {
    pub fn switch(&mut self, port: u8, on: bool) {
        self.end_pulse(port);
        self.on.set(port, on);
    }

    /// Switches a port on until a moment; false if too many pulses are active.
    pub fn pulse(&mut self, port: u8, until: Micros) -> bool {
        self.end_pulse(port);
        let Some(free) = self.pulses.iter_mut().find(|place| place.is_none()) else { return false };
        *free = Some((port, until));
        self.on.set(port, true);
        true
    }

    fn end_pulse(&mut self, port: u8) {
        for place in &mut self.pulses {
            if place.is_some_and(|(pulsed, _)| pulsed == port) {
                *place = None;
            }
        }
    }

    pub fn is_pulsing(&self, port: u8) -> bool {
        self.pulses.iter().flatten().any(|(pulsed, _)| *pulsed == port)
    }

    /// Ends expired pulses.
    pub fn tick(&mut self, now: Micros) {
        self.end_pulses_if(|until| now >= until);
    }

    /// Reset and e-stop: a pulse does not outlive its program.
    pub fn end_pulses(&mut self) {
        self.end_pulses_if(|_| true);
    }

    fn end_pulses_if(&mut self, over: impl Fn(Micros) -> bool) {
        for (port, _) in self.pulses.into_iter().flatten().filter(|(_, until)| over(*until)) {
            self.switch(port, false);
        }
    }

    /// The ports that are on.
    pub const fn terminals(&self) -> Terminals {
        self.on
    }
}

const _: () = assert!(PORTS == 64);
