//! Repeatable pseudo-random numbers: SplitMix64. The same seed gives the same sequence (P8, "same seed, same bits").
//! Source: Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014.

/// A SplitMix64 generator.
#[derive(Clone, Debug)]
pub struct SplitMix64(u64);

impl SplitMix64 {
    /// A generator started from a seed.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next 64 bits.
    pub const fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A random bit.
    pub const fn next_bool(&mut self) -> bool {
        self.next() >> 63 == 1
    }

    /// Uniformly distributed from 0 to below 1.
    pub fn next_unit(&mut self) -> f64 {
        // 53 bits fit the mantissa exactly.
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}
