//! The magnetic chuck that holds the part on GS and GA (P3).
//!
//! With magnetise on, the force rises to its full value in `magnetise_s`. With both outputs off it falls to the
//! remanence within `release_s`. Demagnetise drives reversals through the coil that decay to zero in
//! `demagnetise_s` and remove the remanence; an interrupted demagnetising leaves a share of it.
//! DECISION: with both outputs on the coil has no current, as with interlocked contactors; the part is not held
//! during reversals, because the force passes through zero twice in each.

use std::f64::consts::PI;

use super::machine_sections::MagnetFile;

/// Command to the coil.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CoilCommand {
    Magnetise,
    Demagnetise,
    Off,
}

impl CoilCommand {
    /// From the two outputs.
    pub(super) const fn from_outputs(magnetise: bool, demagnetise: bool) -> Self {
        match (magnetise, demagnetise) {
            (true, false) => Self::Magnetise,
            (false, true) => Self::Demagnetise,
            (true, true) | (false, false) => Self::Off,
        }
    }
}

/// Coil and iron core.
#[derive(Clone, Debug)]
pub(super) struct SimMagnet {
    file: MagnetFile,
    /// Force of the coil, −1 to 1 of the full force; negative in every other reversal.
    coil: f64,
    /// Remanence: force without current, 0 to 1 of the full force.
    remanence: f64,
    /// Time of uninterrupted demagnetising so far, s.
    reversing_s: f64,
}

impl SimMagnet {
    /// A magnet without current or remanence.
    pub(super) const fn new(file: MagnetFile) -> Self {
        Self { file, coil: 0.0, remanence: 0.0, reversing_s: 0.0 }
    }

    /// Sets full force at once.
    pub(super) const fn make_ready(&mut self) {
        self.coil = 1.0;
        self.remanence = self.file.remanence;
        self.reversing_s = 0.0;
    }

    /// One tick.
    pub(super) fn step(&mut self, current: CoilCommand, dt_s: f64) {
        if current != CoilCommand::Demagnetise {
            self.reversing_s = 0.0;
        }
        match current {
            CoilCommand::Magnetise => {
                self.coil = (self.coil.max(0.0) + dt_s / self.file.magnetise_s).min(1.0);
                self.remanence = self.remanence.max(self.coil * self.file.remanence);
            }
            CoilCommand::Off => {
                let drop = dt_s / self.file.release_s;
                self.coil = if self.coil > 0.0 { (self.coil - drop).max(0.0) } else { (self.coil + drop).min(0.0) };
            }
            CoilCommand::Demagnetise => {
                self.reversing_s += dt_s;
                let amplitude = (1.0 - self.reversing_s / self.file.demagnetise_s).max(0.0);
                self.coil = -amplitude * (PI * self.reversing_s / self.file.reversal_s).sin();
                self.remanence = self.remanence.min(amplitude * self.file.remanence);
            }
        }
    }

    /// Holding force, 0 to 1 of the full force.
    pub(super) fn force(&self) -> f64 {
        self.coil.abs().max(self.remanence)
    }

    /// Whether the part is held while it is ground or rotated.
    pub(super) fn holds(&self) -> bool {
        self.reversing_s <= 0.0 && self.force() >= self.file.holds_from
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::defs::kind::Kind;
    use crate::io::sim::MachineFile;

    fn magnet() -> SimMagnet {
        SimMagnet::new(MachineFile::builtin(Kind::Gs).unwrap().magnet.unwrap())
    }

    fn run(magnet: &mut SimMagnet, current: CoilCommand, ticks: u32) {
        (0..ticks).for_each(|_| magnet.step(current, 0.001));
    }

    #[test]
    fn p3_the_magnet_has_its_full_force_after_a_second() {
        let mut m = magnet();
        assert!(!m.holds() && m.force() <= 0.0);
        run(&mut m, CoilCommand::Magnetise, 990);
        assert!(m.force() < 1.0);
        run(&mut m, CoilCommand::Magnetise, 11);
        assert!(m.holds() && m.force() >= 1.0);
    }

    #[test]
    fn p3_without_current_only_the_remanence_is_left_and_does_not_hold() {
        let mut m = magnet();
        run(&mut m, CoilCommand::Magnetise, 1_001);
        // Release 0.2 s.
        run(&mut m, CoilCommand::Off, 201);
        assert!(!m.holds() && (m.force() - 0.15).abs() < 1e-9, "{}", m.force());
        run(&mut m, CoilCommand::Off, 60_000);
        assert!((m.force() - 0.15).abs() < 1e-9, "it stays");
    }

    #[test]
    fn p3_six_seconds_of_decaying_reversals_take_the_remanence_away() {
        let mut m = magnet();
        run(&mut m, CoilCommand::Magnetise, 1_001);
        let (mut reversals, mut before, mut crest) = (0, 0.0_f64, Vec::new());
        for _ in 0..6_000 {
            m.step(CoilCommand::Demagnetise, 0.001);
            if m.coil * before < 0.0 {
                reversals += 1;
                crest.push(0.0_f64);
            }
            before = m.coil;
            if let Some(last) = crest.last_mut() {
                *last = last.max(m.coil.abs());
            }
            assert!(!m.holds());
        }
        // One reversal every 0.5 s.
        assert!((10..=12).contains(&reversals), "{reversals}");
        assert!(crest.windows(2).all(|pair| pair[1] < pair[0]), "each weaker than the one before: {crest:?}");
        assert!(m.force() < 1e-6, "{}", m.force());
    }
}
