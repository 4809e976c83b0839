//! Injects seeded faults between control and machine: the bus goes silent, input terminals flicker (P8).
//!
//! [`FaultInjector`] wraps any [`Backend`]. The same seed gives the same faults.

use kt830::defs::param::Params;
use kt830::defs::signal::PORTS;
use kt830::io::random::SplitMix64;
use kt830::io::{Backend, InputImage, OutputImage};
use kt830::units::Micros;

/// How often and how long each fault occurs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaultRates {
    /// Probability per tick that the bus goes silent, 0 to 1.
    pub silence: f64,
    /// Longest silence, ticks.
    pub silence_ticks: u32,
    /// Probability per tick that one input terminal starts to read the wrong level, 0 to 1.
    pub flicker: f64,
    /// Longest flicker, ticks.
    pub flicker_ticks: u32,
}

/// Wraps a backend and injects faults.
#[derive(Clone, Debug)]
pub struct FaultInjector<B> {
    inner: B,
    rates: FaultRates,
    rng: SplitMix64,
    silent_left: u32,
    flicker_left: u32,
    /// Bit mask of the input terminals that read the wrong level.
    flipped_mask: u64,
    last: InputImage,
}

impl<B: Backend> FaultInjector<B> {
    /// Wraps a backend.
    pub fn new(inner: B, rates: FaultRates, seed: u64) -> Self {
        Self {
            inner,
            rates,
            rng: SplitMix64::new(seed),
            silent_left: 0,
            flicker_left: 0,
            flipped_mask: 0,
            last: InputImage::default(),
        }
    }

    /// The wrapped backend.
    pub const fn inner(&self) -> &B {
        &self.inner
    }

    fn occurs(&mut self, rate: f64) -> bool {
        self.rng.next_unit() < rate
    }

    fn duration_ticks(&mut self, most: u32) -> u32 {
        1 + (self.rng.next() % u64::from(most.max(1))) as u32
    }

    /// Starts the faults that are due in this tick.
    fn start_faults(&mut self) {
        if self.silent_left == 0 && self.occurs(self.rates.silence) {
            self.silent_left = self.duration_ticks(self.rates.silence_ticks);
        }
        if self.flicker_left == 0 {
            self.flipped_mask = 0;
            if self.occurs(self.rates.flicker) {
                self.flicker_left = self.duration_ticks(self.rates.flicker_ticks);
                self.flipped_mask = 1 << (self.rng.next() % u64::from(PORTS));
            }
        }
    }
}

impl<B: Backend> Backend for FaultInjector<B> {
    fn read(&mut self, now: Micros) -> InputImage {
        let mut image = self.inner.read(now);
        self.start_faults();
        if self.silent_left > 0 {
            // The handwheel detents of a silent tick are lost, as on a real bus.
            self.last.bus_alive = false;
            self.last.handwheel_detents = 0;
            return self.last;
        }
        if self.flicker_left > 0 {
            self.flicker_left -= 1;
            image.terminals.0 ^= self.flipped_mask;
        }
        self.last = image;
        image
    }

    fn rewire(&mut self, params: &Params) {
        self.inner.rewire(params);
    }

    fn write(&mut self, now: Micros, outputs: &OutputImage) {
        if self.silent_left > 0 {
            self.silent_left -= 1;
            return;
        }
        self.inner.write(now, outputs);
    }
}

/// Counts the writes that reach it.
#[derive(Default)]
struct Counter(u32);

impl Backend for Counter {
    fn read(&mut self, _now: Micros) -> InputImage {
        InputImage { bus_alive: true, ..InputImage::default() }
    }
    fn write(&mut self, _now: Micros, _outputs: &OutputImage) {
        self.0 += 1;
    }
    fn rewire(&mut self, _params: &Params) {}
}

fn course(rates: FaultRates, seed: u64) -> (u32, u32, u32) {
    let mut injector = FaultInjector::new(Counter::default(), rates, seed);
    let (mut silent, mut wrong) = (0, 0);
    for tick in 1..=10_000 {
        let image = injector.read(Micros::from_millis(tick));
        silent += u32::from(!image.bus_alive);
        wrong += u32::from(image.terminals.0 != 0);
        injector.write(Micros::from_millis(tick), &OutputImage::default());
    }
    (silent, wrong, injector.inner().0)
}

#[test]
fn p8_a_silent_tick_neither_tells_nor_hears() {
    let (silent, wrong, heard) =
        course(FaultRates { silence: 0.01, silence_ticks: 3, flicker: 0.0, flicker_ticks: 0 }, 7);
    // About 10 000 · 0.01 · 2 ticks.
    assert!((100..=300).contains(&silent), "{silent}");
    assert_eq!((wrong, heard), (0, 10_000 - silent));
}

#[test]
fn p8_flicker_is_short_and_the_same_seed_gives_the_same_course() {
    let rates = FaultRates { silence: 0.0, silence_ticks: 0, flicker: 0.01, flicker_ticks: 5 };
    let (silent, wrong, heard) = course(rates, 7);
    assert!((150..=450).contains(&wrong), "{wrong}");
    assert_eq!((silent, heard), (0, 10_000));
    assert_eq!(course(rates, 7), course(rates, 7));
    assert_ne!(course(rates, 7), course(rates, 8));
}

#[test]
fn p8_the_generator_is_splitmix64() {
    // First output for seed 1234567, from the reference implementation.
    assert_eq!(SplitMix64::new(1_234_567).next(), 6_457_827_717_110_365_317);
}

#[test]
fn p8_units_stay_below_one() {
    let mut chance = SplitMix64::new(1);
    assert!((0..1_000).map(|_| chance.next_unit()).all(|u| (0.0..1.0).contains(&u)));
}
