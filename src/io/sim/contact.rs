//! A mechanical switch contact: it bounces for a few milliseconds at every edge (P1).

use crate::io::random::SplitMix64;

/// A switch contact with bounce.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BouncingContact {
    closed: bool,
    bounce_left_s: f64,
}

impl BouncingContact {
    /// A contact at rest.
    pub(super) const fn at_rest(closed: bool) -> Self {
        Self { closed, bounce_left_s: 0.0 }
    }

    /// The state read after `dt_s`, while the actuator holds the contact at `closed`.
    pub(super) fn step(&mut self, closed: bool, dt_s: f64, bounce_s: f64, chance: &mut SplitMix64) -> bool {
        if closed != self.closed {
            self.closed = closed;
            self.bounce_left_s = bounce_s;
            return closed;
        }
        if self.bounce_left_s > 0.0 {
            self.bounce_left_s -= dt_s;
            if self.bounce_left_s > 0.0 {
                return chance.next_bool();
            }
        }
        closed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn p1_a_contact_bounces_five_milliseconds_and_no_longer() {
        let mut chance = SplitMix64::new(3);
        let mut contact = BouncingContact::at_rest(false);
        assert!(!contact.step(false, 0.001, 0.005, &mut chance));
        assert!(contact.step(true, 0.001, 0.005, &mut chance), "the first edge is not late");
        let course: Vec<bool> = (0..20).map(|_| contact.step(true, 0.001, 0.005, &mut chance)).collect();
        assert!(course[..5].contains(&false), "it bounces with this seed");
        assert!(course[5..].iter().all(|closed| *closed));
    }
}
