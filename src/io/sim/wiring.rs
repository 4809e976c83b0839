//! Assignment of functions to terminals by the parameters (P1, K6.1), and what is forced or faulty in
//! between (P8): stuck and bouncing switches, inputs forced by a story.
//!
//! An input terminal is closed = logical state XOR normally closed; several functions on one port are combined by OR.

use crate::defs::param::Params;
use crate::defs::signal::{Input, InputSet, Output, OutputSet, PORTS, Terminals};

use crate::io::random::SplitMix64;

/// Forcing or fault of one input.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct InputForcing {
    /// By a story's `input` statement; has priority over the fault.
    forced: Option<bool>,
    /// By `stuck-on`, `stuck-off`.
    stuck: Option<bool>,
    /// By `bounce`.
    bounces: bool,
}

/// The wiring of the machine.
#[derive(Clone, Debug)]
pub(super) struct Wiring {
    inputs: Vec<(Input, u8)>,
    outputs: Vec<(Output, u8)>,
    inverted: u64,
    forcings: [InputForcing; Input::COUNT],
    any_forced: bool,
    any_bounces: bool,
    /// Bit masks of the ports forced by number, and their levels.
    port_mask: u64,
    port_level: u64,
    /// Last logical state and the resulting terminals.
    last: Option<(InputSet, Terminals)>,
    last_outputs: (Terminals, OutputSet),
}

impl Wiring {
    /// The wiring that the parameters define.
    pub(super) fn new(params: &Params) -> Self {
        let mut wiring = Self {
            inputs: Vec::new(),
            outputs: Vec::new(),
            inverted: params.inverted_inputs(),
            forcings: [InputForcing::default(); Input::COUNT],
            any_forced: false,
            any_bounces: false,
            port_mask: 0,
            port_level: 0,
            last: None,
            last_outputs: (Terminals::default(), OutputSet::NONE),
        };
        wiring.rewire(params);
        wiring
    }

    /// Moves every function to its present port. The polarity of a port (normally open or closed) does not change.
    pub(super) fn rewire(&mut self, params: &Params) {
        self.inputs.clear();
        self.inputs
            .extend(Input::ALL.iter().map(|input| (*input, params.input_port(*input))).filter(|(_, port)| *port != 0));
        self.outputs.clear();
        let outputs = Output::ALL.iter().map(|output| (*output, params.output_port(*output)));
        self.outputs.extend(outputs.filter(|(_, port)| *port != 0));
        self.last = None;
        self.last_outputs = (Terminals::default(), OutputSet::NONE);
    }

    /// The terminal levels for a logical state.
    pub(super) fn terminals(&mut self, logical: InputSet, chance: &mut SplitMix64) -> Terminals {
        if let Some((before, terminals)) = self.last
            && before == logical
            && !self.any_bounces
        {
            return terminals;
        }
        let shown = if self.any_forced { self.apply_forcings(logical, chance) } else { logical };
        let mut active = Terminals::default();
        for (input, port) in &self.inputs {
            if shown.has(*input) {
                active.set(*port, true);
            }
        }
        let level = active.0 ^ self.inverted;
        let terminals = Terminals((level & !self.port_mask) | (self.port_level & self.port_mask));
        self.last = Some((logical, terminals));
        terminals
    }

    fn apply_forcings(&self, logical: InputSet, chance: &mut SplitMix64) -> InputSet {
        let mut shown = logical;
        for input in Input::ALL {
            let m = self.forcings[*input as usize];
            if m.bounces {
                shown.set(*input, chance.next_bool());
            }
            if let Some(on) = m.forced.or(m.stuck) {
                shown.set(*input, on);
            }
        }
        shown
    }

    /// The outputs that the terminals switch on.
    pub(super) fn outputs(&mut self, terminals: Terminals) -> OutputSet {
        if self.last_outputs.0 != terminals {
            let mut set = OutputSet::NONE;
            self.outputs.iter().for_each(|(output, port)| set.set(*output, terminals.is_closed(*port)));
            self.last_outputs = (terminals, set);
        }
        self.last_outputs.1
    }

    fn update_forcing(&mut self, input: Input, change: impl FnOnce(&mut InputForcing)) {
        change(&mut self.forcings[input as usize]);
        self.any_bounces = self.forcings.iter().any(|m| m.bounces);
        self.any_forced = self.forcings.iter().any(|m| *m != InputForcing::default());
        self.last = None;
    }

    /// Forces an input; `None` ends the forcing.
    pub(super) fn force(&mut self, input: Input, on: Option<bool>) {
        self.update_forcing(input, |m| m.forced = on);
    }

    /// Forces a port, where `on` is logically active; `None` ends the forcing.
    pub(super) fn force_port(&mut self, port: u8, on: Option<bool>) {
        assert!((1..=PORTS).contains(&port), "port {port}");
        let bit = 1_u64 << (port - 1);
        self.port_mask = if on.is_some() { self.port_mask | bit } else { self.port_mask & !bit };
        let level = on.unwrap_or(false) != (self.inverted & bit != 0);
        self.port_level = if level { self.port_level | bit } else { self.port_level & !bit };
        self.last = None;
    }

    /// Makes a switch stick; `None` ends the fault.
    pub(super) fn set_stuck(&mut self, input: Input, on: Option<bool>) {
        self.update_forcing(input, |m| m.stuck = on);
    }

    /// Makes a switch bounce continuously, or ends the fault.
    pub(super) fn set_bouncing(&mut self, input: Input, bounces: bool) {
        self.update_forcing(input, |m| m.bounces = bounces);
    }
}
