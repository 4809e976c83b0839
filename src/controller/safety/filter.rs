//! Converts terminals to input functions: polarity, debounce, port assignment. All 64 ports are filtered in parallel.
//! Source: spec K3.7 (input filter 10 ms), K6.1 (ports by parameter).

use crate::defs::param::{self, Params};
use crate::defs::signal::{Input, InputSet, Terminals};

/// Bit planes of the parallel counters: delays up to 127 ticks.
const PLANES: usize = 7;

/// Debounces the terminals: a level counts after it has been stable for the filter time.
#[derive(Clone, Debug)]
pub struct Filter {
    stable: u64,
    planes: [u64; PLANES],
    /// Port of each input, 0 none; by `Input as usize`.
    ports: [u8; Input::COUNT],
    inverted: u64,
    ticks: u64,
    /// Tick time, µs, as read at power-on (P58).
    tick_us: f64,
    /// The inputs of the last stable levels, and of the last levels before the filter.
    seen: [SeenInputs; 2],
}

/// Levels and the inputs that they mean. Most ticks repeat those of the tick before.
#[derive(Clone, Copy, Debug, Default)]
struct SeenInputs {
    levels: u64,
    inputs: InputSet,
}

impl Filter {
    /// A filter for the ports and times of these parameters; `first` counts as stable.
    #[must_use]
    pub fn new(params: &Params, first: Terminals) -> Self {
        let mut filter = Self {
            stable: 0,
            planes: [0; PLANES],
            ports: [0; Input::COUNT],
            inverted: 0,
            ticks: 0,
            tick_us: params.get(param::TICK_TIME),
            seen: [SeenInputs::default(); 2],
        };
        filter.configure(params);
        filter.stable = first.0 ^ filter.inverted;
        filter
    }

    /// Applies changed parameters.
    pub fn configure(&mut self, params: &Params) {
        for input in Input::ALL {
            self.ports[*input as usize] = params.input_port(*input);
        }
        self.inverted = params.inverted_inputs();
        self.seen =
            self.seen.map(|SeenInputs { levels, .. }| SeenInputs { levels, inputs: self.active_inputs(levels) });
        let ticks = params.get(param::INPUT_FILTER) * 1_000.0 / self.tick_us;
        self.ticks = (ticks.round() as u64).min((1 << PLANES) - 1);
    }

    /// One tick: returns the active inputs, debounced.
    pub fn tick(&mut self, terminals: Terminals) -> InputSet {
        let raw = terminals.0 ^ self.inverted;
        let differs = raw ^ self.stable;
        let mut carry = differs;
        for plane in &mut self.planes {
            let sum = *plane ^ carry;
            carry &= *plane;
            *plane = sum & differs; // a port back at its stable level restarts from 0
        }
        let mut settled = differs;
        for (bit, plane) in self.planes.iter().enumerate() {
            settled &= if self.ticks >> bit & 1 == 1 { *plane } else { !*plane };
        }
        if self.ticks == 0 {
            settled = differs;
        }
        self.stable ^= settled;
        for plane in &mut self.planes {
            *plane &= !settled;
        }
        self.look_up(0, self.stable)
    }

    /// The active inputs before the filter, for latching a position in the tick of the edge.
    #[must_use]
    pub fn unfiltered(&mut self, terminals: Terminals) -> InputSet {
        self.look_up(1, terminals.0 ^ self.inverted)
    }

    fn look_up(&mut self, row: usize, levels: u64) -> InputSet {
        if self.seen[row].levels != levels {
            self.seen[row] = SeenInputs { levels, inputs: self.active_inputs(levels) };
        }
        self.seen[row].inputs
    }

    fn active_inputs(&self, active: u64) -> InputSet {
        let mut set = InputSet::NONE;
        for input in Input::ALL {
            set.set(*input, Terminals(active).is_closed(self.ports[*input as usize]));
        }
        set
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::defs::kind::Kind;

    const PRESSURE: u64 = 1 << 2; // port 3

    fn resting() -> u64 {
        Params::factory(Kind::Gc).inverted_inputs()
    }

    fn filter() -> Filter {
        Filter::new(&Params::factory(Kind::Gc), Terminals(resting()))
    }

    #[test]
    fn k3_7_an_edge_counts_after_ten_ticks() {
        let mut filter = filter();
        let seen: Vec<bool> =
            (0..12).map(|_| filter.tick(Terminals(resting() | PRESSURE)).has(Input::HydraulicPressure)).collect();
        // P59 = 10 ms at a tick of 1 ms: nine ticks are not enough, the tenth is.
        assert_eq!(seen.iter().position(|on| *on), Some(9));
        assert!(seen[9..].iter().all(|on| *on));
    }

    #[test]
    fn p1_bounce_shorter_than_the_filter_is_not_seen() {
        let mut filter = filter();
        for tick in 0..200 {
            let level = if tick % 10 < 9 { PRESSURE } else { 0 };
            assert!(!filter.tick(Terminals(resting() | level)).has(Input::HydraulicPressure), "tick {tick}");
        }
    }

    #[test]
    fn b5_an_open_emergency_stop_circuit_is_an_emergency_stop() {
        let mut filter = filter();
        assert!(!filter.tick(Terminals(resting())).has(Input::EmergencyStop));
        let stopped = (0..10).map(|_| filter.tick(Terminals(0)).has(Input::EmergencyStop)).last();
        assert_eq!(stopped, Some(true));
    }
}
