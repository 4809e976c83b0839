//! The gauges (P7): the radial (thickness) gauge signals in four stages how far the part is above its set size; the
//! axial (plane) gauge signals that its tip touches, and that the tip is deflected to its second stage.
//!
//! Every signal follows its cause after a delay. DECISION: a stage switches off only `hysteresis_um` above its level,
//! as in gauge amplifiers, so that noise gives one edge; a cause shorter than the delay gives no signal. The value that the
//! radial gauge shows lags by the delay in the first order; it drifts as the gauge warms, coolant on its tips makes it noisier.

use super::machine_sections::GaugesFile;
use crate::io::random::SplitMix64;

/// A signal that follows its cause after a delay.
#[derive(Clone, Copy, Debug, Default)]
struct DelayedSignal {
    input: bool,
    output: bool,
    remaining_s: f64,
}

impl DelayedSignal {
    fn step(&mut self, cause: bool, delay_s: f64, dt_s: f64) {
        if cause != self.input {
            self.input = cause;
            self.remaining_s = delay_s;
        }
        if self.output != self.input {
            self.remaining_s -= dt_s;
            // Tolerance of half a tick: the sum of many dt does not equal the delay exactly.
            self.output = if self.remaining_s <= 0.5 * dt_s { self.input } else { self.output };
        }
    }

    const fn is_idle(self) -> bool {
        !self.input && !self.output
    }
}

/// What the gauges measure in a tick.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct GaugeContact {
    /// Size of the part above its set size, µm; `None` with the arm retracted or nothing to measure.
    pub oversize_um: Option<f64>,
    /// Deflection of the plane gauge's tip, mm; `None` with the arm retracted or without contact.
    pub probe_deflection_mm: Option<f64>,
}

/// Both gauges.
#[derive(Clone, Debug)]
pub(super) struct Gauges {
    file: GaugesFile,
    stages: [DelayedSignal; 4],
    touch: DelayedSignal,
    second_stage: DelayedSignal,
    /// What the radial gauge shows too much, mm.
    drift_mm: f64,
    /// What it shows, µm above its set size; none with the arm retracted.
    pub(super) shown_um: Option<f64>,
}

impl Gauges {
    /// Gauges without signals.
    pub(super) fn new(file: GaugesFile) -> Self {
        let idle = DelayedSignal::default();
        Self { file, stages: [idle; 4], touch: idle, second_stage: idle, drift_mm: 0.0, shown_um: None }
    }

    /// One tick, with coolant on the tips or without.
    pub(super) fn step(&mut self, found: GaugeContact, dt_s: f64, coolant_flows: bool, chance: &mut SplitMix64) {
        self.drift_mm = self.file.drift.map_or(0.0, |drift| drift.step_mm(self.drift_mm, dt_s));
        let quiet = found.oversize_um.is_none() && found.probe_deflection_mm.is_none();
        if quiet && self.touch.is_idle() && self.second_stage.is_idle() && self.stages[0].is_idle() {
            self.shown_um = None;
            return;
        }
        let delay_s = self.file.delay_s;
        let noise_um = self.file.noise_um * if coolant_flows { self.file.coolant_noise } else { 1.0 };
        let drift_um = 1_000.0 * self.drift_mm;
        let over_um = found.oversize_um.map(|over| over + drift_um + noise_um * (2.0 * chance.next_unit() - 1.0));
        let follows = if delay_s > 0.0 { -(-dt_s / delay_s).exp_m1() } else { 1.0 };
        self.shown_um = over_um.map(|over| self.shown_um.map_or(over, |shown| shown + follows * (over - shown)));
        for (signal, stage_um) in self.stages.iter_mut().zip(self.file.stages_um) {
            let edge = stage_um + if signal.input { self.file.hysteresis_um } else { 0.0 };
            signal.step(over_um.is_some_and(|over| over <= edge), delay_s, dt_s);
        }
        let pressed_mm = found.probe_deflection_mm.unwrap_or(-1.0);
        self.touch.step(pressed_mm >= 0.0, delay_s, dt_s);
        self.second_stage.step(pressed_mm >= self.file.probe.second_mm, delay_s, dt_s);
    }

    /// Signal of a stage; the index 0 to 3 is the stage 1 to 4.
    pub(super) fn stage(&self, index: usize) -> bool {
        self.stages[index].output
    }

    /// Whether the tip of the plane gauge touches.
    pub(super) const fn touching(&self) -> bool {
        self.touch.output
    }

    /// Whether the tip of the plane gauge is deflected to its second stage.
    pub(super) const fn second_stage(&self) -> bool {
        self.second_stage.output
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::defs::kind::Kind;
    use crate::io::sim::MachineFile;

    fn gauges() -> Gauges {
        Gauges::new(MachineFile::builtin(Kind::Gc).unwrap().gauges)
    }

    fn size(over_um: f64) -> GaugeContact {
        GaugeContact { oversize_um: Some(over_um), probe_deflection_mm: None }
    }

    #[test]
    fn p7_each_stage_comes_once_within_its_noise_and_ten_milliseconds_later() {
        let (mut g, mut chance) = (gauges(), SplitMix64::new(5));
        let mut edges = [Vec::new(), Vec::new(), Vec::new(), Vec::new()];
        let mut before = [false; 4];
        for tick in 0..120_000 {
            // 1 µm/s: 0.01 µm in the delay of 10 ms; the size is within the noise of a stage for one second.
            let over = 110.0 - 0.001 * f64::from(tick);
            g.step(size(over), 0.001, false, &mut chance);
            for stage in 0..4 {
                if g.stage(stage) != before[stage] {
                    edges[stage].push(over);
                }
                before[stage] = g.stage(stage);
            }
        }
        for (edges, stage) in edges.iter().zip([100.0, 20.0, 5.0, 0.0]) {
            assert_eq!(edges.len(), 1, "{stage}: {edges:?}");
            // Noise of ±0.5 µm, and 0.01 µm for the delay.
            assert!((edges[0] - stage).abs() <= 0.515, "{stage}: {edges:?}");
        }
    }

    #[test]
    fn p7_a_size_that_stands_at_a_stage_gives_one_edge_and_no_chatter() {
        let (mut g, mut chance) = (gauges(), SplitMix64::new(5));
        let (mut edges, mut before) = (0, false);
        for _ in 0..60_000 {
            // The noise is above the stage half of the time and below it half of the time.
            g.step(size(5.0), 0.001, false, &mut chance);
            edges += u32::from(g.stage(2) != before);
            before = g.stage(2);
        }
        assert_eq!((edges, before), (1, true));
    }

    #[test]
    fn p7_the_signal_comes_ten_milliseconds_after_the_touch() {
        let (mut g, mut chance) = (gauges(), SplitMix64::new(5));
        let pressed = |mm| GaugeContact { oversize_um: None, probe_deflection_mm: Some(mm) };
        for _ in 0..9 {
            g.step(pressed(0.0), 0.001, false, &mut chance);
            assert!(!g.touching());
        }
        g.step(pressed(0.0), 0.001, false, &mut chance);
        assert!(g.touching() && !g.second_stage());
        (0..10).for_each(|_| g.step(pressed(2.1), 0.001, false, &mut chance));
        assert!(g.second_stage());
        (0..10).for_each(|_| g.step(GaugeContact::default(), 0.001, false, &mut chance));
        assert!(!g.touching() && !g.second_stage());
    }

    #[test]
    fn p7_an_arm_that_goes_in_takes_its_signals_with_it() {
        let (mut g, mut chance) = (gauges(), SplitMix64::new(5));
        (0..20).for_each(|_| g.step(size(-1.0), 0.001, false, &mut chance));
        assert!((0..4).all(|stage| g.stage(stage)));
        (0..10).for_each(|_| g.step(GaugeContact::default(), 0.001, false, &mut chance));
        assert!((0..4).all(|stage| !g.stage(stage)));
    }
}
