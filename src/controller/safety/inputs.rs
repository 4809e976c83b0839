//! The inputs of a tick: filtered, unfiltered, and those of the tick before.
//! Source: spec B5, K3.7, K6.1.

use super::filter::Filter;
use crate::defs::key::Key;
use crate::defs::param::Params;
use crate::defs::signal::{Input, InputSet, Terminals};
use crate::io::InputImage;

/// The inputs.
#[derive(Clone, Debug)]
pub struct Inputs {
    /// Terminals, encoders and handwheel as read.
    pub image: InputImage,
    filter: Filter,
    /// The active inputs, debounced.
    pub filtered: InputSet,
    /// The active inputs before the filter.
    pub raw: InputSet,
    /// The filtered inputs of the tick before.
    previous: InputSet,
    /// Pressed limit switches: two bits per axis, plus then minus.
    pub limit_switches: u8,
    /// The emergency stop on the screen is latched.
    screen_e_stop: bool,
}

impl Inputs {
    /// Inputs at power-on: the first levels count as stable. Without a bus no input is active.
    #[must_use]
    pub fn new(params: &Params, mut image: InputImage) -> Self {
        if !image.bus_alive {
            image.terminals = Terminals(params.inverted_inputs());
        }
        Self {
            image,
            filter: Filter::new(params, image.terminals),
            filtered: InputSet::NONE,
            raw: InputSet::NONE,
            previous: InputSet::NONE,
            limit_switches: 0,
            screen_e_stop: false,
        }
    }

    /// Applies changed ports and filter times.
    pub fn configure(&mut self, params: &Params) {
        self.filter.configure(params);
    }

    /// Reads the inputs of a tick. Without the bus the last levels hold: the alarm of the bus stops everything.
    pub fn read(&mut self, image: &InputImage) {
        let terminals = if image.bus_alive { image.terminals } else { self.image.terminals };
        self.image = InputImage { terminals, ..*image };
        self.raw = self.filter.unfiltered(terminals);
        self.filtered = self.filter.tick(terminals);
        // The emergency stop acts at its first edge; only its release is debounced.
        if self.screen_e_stop || self.raw.has(Input::EmergencyStop) {
            self.filtered.set(Input::EmergencyStop, true);
        }
    }

    /// Latches the emergency stop on the screen, in this very tick, or releases it from the next tick on.
    pub fn set_screen_e_stop(&mut self, pressed: bool) {
        self.screen_e_stop = pressed;
        if pressed {
            self.filtered.set(Input::EmergencyStop, true);
        }
    }

    /// Whether the emergency stop on the screen is latched.
    #[must_use]
    pub const fn screen_e_stop(&self) -> bool {
        self.screen_e_stop
    }

    /// The keys of external cycle start and hold whose inputs have just come on (P335, P336).
    pub fn external_keys(&mut self) -> impl Iterator<Item = Key> + use<> {
        let before = std::mem::replace(&mut self.previous, self.filtered);
        let now = self.filtered;
        [(Input::ExternalHold, Key::FeedHold), (Input::ExternalStart, Key::CycleStart)]
            .into_iter()
            .filter(move |(input, _)| now.has(*input) && !before.has(*input))
            .map(|(_, key)| key)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::defs::kind::Kind;

    #[test]
    fn b5_the_emergency_stop_on_the_screen_acts_at_once_and_lasts_until_it_is_released() {
        let params = Params::factory(Kind::Gc);
        let terminals = Terminals(params.inverted_inputs());
        let image = InputImage { terminals, bus_alive: true, ..InputImage::default() };
        let mut inputs = Inputs::new(&params, image);
        inputs.set_screen_e_stop(true);
        inputs.set_screen_e_stop(true);
        assert!(inputs.filtered.has(Input::EmergencyStop));
        inputs.read(&image);
        assert!(inputs.filtered.has(Input::EmergencyStop), "it is latched");
        inputs.set_screen_e_stop(false);
        inputs.read(&image);
        assert!(!inputs.filtered.has(Input::EmergencyStop));
    }
}
