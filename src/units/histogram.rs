//! A histogram of short times, for percentiles of cycles and wake-ups.

use super::Micros;

/// Width of a class, µs.
const CLASS_US: u64 = 10;
/// Classes; longer times count in the last one.
const CLASSES: usize = 2_000;

/// Median, 99th percentile and maximum of a number of times.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Percentiles {
    /// Half of the times are shorter.
    pub median: Micros,
    /// 99 of 100 are shorter.
    pub p99: Micros,
    /// The longest.
    pub max: Micros,
}

/// Counts times in classes of 10 µs up to 20 ms. Its memory is allocated once.
#[derive(Clone, Debug)]
pub struct Histogram {
    counts: Box<[u32]>,
    total: u64,
    max: Micros,
}

impl Default for Histogram {
    fn default() -> Self {
        Self { counts: vec![0; CLASSES].into(), total: 0, max: Micros::ZERO }
    }
}

impl Histogram {
    /// Counts a time.
    pub fn add(&mut self, time: Micros) {
        let class = usize::try_from(time.0 / CLASS_US).unwrap_or(CLASSES).min(CLASSES - 1);
        self.counts[class] = self.counts[class].saturating_add(1);
        self.total += 1;
        self.max = self.max.max(time);
    }

    /// The percentiles, at the upper end of their class; 0 of no time.
    #[must_use]
    pub fn percentiles(&self) -> Percentiles {
        let at = |share: f64| {
            let mut left = (self.total as f64 * share).ceil() as u64;
            let class = self.counts.iter().position(|count| {
                left = left.saturating_sub(u64::from(*count));
                left == 0
            });
            let upper = Micros((class.unwrap_or(0) as u64 + 1) * CLASS_US);
            if self.total == 0 { Micros::ZERO } else { upper.min(self.max) }
        };
        Percentiles { median: at(0.5), p99: at(0.99), max: self.max }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1000 times of 1 to 1000 µs: the median is 500, and 990 of them are at most 990.
    #[test]
    fn percentiles_are_those_of_the_times_within_a_class() {
        let mut times = Histogram::default();
        assert_eq!(times.percentiles(), Percentiles::default());
        (1..=1_000).for_each(|us| times.add(Micros(us)));
        let Percentiles { median, p99, max } = times.percentiles();
        assert!((500..=510).contains(&median.0) && (990..=1_000).contains(&p99.0), "{median:?} {p99:?}");
        assert_eq!(max, Micros(1_000));
        times.add(Micros(5_000_000));
        assert_eq!(times.percentiles().max, Micros(5_000_000));
    }
}
