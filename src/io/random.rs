//! Repeatable pseudo-random numbers: SplitMix64. The same seed gives the same sequence (P8, "same seed, same bits").
//! Source: Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014.

/// A SplitMix64 generator.
#[derive(Clone, Debug)]
pub(in crate::io) struct SplitMix64(u64);

impl SplitMix64 {
    /// A generator started from a seed.
    pub(in crate::io) const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next 64 bits.
    pub(in crate::io) const fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A random bit.
    pub(in crate::io) const fn next_bool(&mut self) -> bool {
        self.next() >> 63 == 1
    }

    /// Uniformly distributed from 0 to below 1.
    pub(in crate::io) fn next_unit(&mut self) -> f64 {
        // 53 bits fit the mantissa exactly.
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
