//! A histogram of short times, for percentiles and charts of cycles and wake-ups.

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

/// Times from which the classes of a chart begin, µs. They are 1, 2 and 5 of each decade: few classes reach from a usual
/// time to the rare late one.
pub const CHART_CLASSES: [u64; 11] = [0, 10, 20, 50, 100, 200, 500, 1_000, 2_000, 5_000, 10_000];

/// How a number of times is distributed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TimeDistribution {
    /// Median, 99th percentile and maximum.
    pub percentiles: Percentiles,
    /// Times in each class of [`CHART_CLASSES`].
    pub counts: [u64; CHART_CLASSES.len()],
}

/// Counts times in classes of 10 µs up to 20 ms. Its memory is allocated once.
#[derive(Clone, Debug)]
pub struct Histogram {
    counts: Box<[u64]>,
    total: u64,
    max: Micros,
}

impl Default for Histogram {
    fn default() -> Self {
        Self { counts: vec![0; CLASSES].into(), total: 0, max: Micros::ZERO }
    }
}

impl Histogram {
    /// Counts anew.
    pub fn clear(&mut self) {
        self.counts.fill(0);
        (self.total, self.max) = (0, Micros::ZERO);
    }

    /// Counts a time.
    pub fn add(&mut self, time: Micros) {
        let class = usize::try_from(time.0 / CLASS_US).unwrap_or(CLASSES).min(CLASSES - 1);
        self.counts[class] += 1;
        self.total += 1;
        self.max = self.max.max(time);
    }

    /// The time that this share of the times, 0 to 1, does not exceed, at the upper end of its class; 0 of no time.
    #[must_use]
    pub fn percentile(&self, share: f64) -> Micros {
        let mut left = (self.total as f64 * share).ceil() as u64;
        let class = self.counts.iter().position(|count| {
            left = left.saturating_sub(*count);
            left == 0
        });
        let upper = Micros((class.unwrap_or(0) as u64 + 1) * CLASS_US);
        if self.total == 0 { Micros::ZERO } else { upper.min(self.max) }
    }

    /// The percentiles, at the upper end of their class; 0 of no time.
    #[must_use]
    pub fn percentiles(&self) -> Percentiles {
        Percentiles { median: self.percentile(0.5), p99: self.percentile(0.99), max: self.max }
    }

    /// The percentiles and the classes of a chart.
    #[must_use]
    pub fn distribution(&self) -> TimeDistribution {
        let end_of = |class: usize| CHART_CLASSES.get(class + 1).map_or(CLASSES, |end| (end / CLASS_US) as usize);
        let of_class = |class: usize| {
            let begin = (CHART_CLASSES[class] / CLASS_US) as usize;
            self.counts[begin..end_of(class)].iter().sum()
        };
        TimeDistribution { percentiles: self.percentiles(), counts: std::array::from_fn(of_class) }
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

    /// Of the times 0 to 1099 µs a class has as many as it is wide: 10, 10, 30, 50, 100, 300, 500, and 100 from 1 ms on.
    #[test]
    fn the_classes_of_a_chart_hold_every_time_once() {
        let mut times = Histogram::default();
        (0..1_100).for_each(|us| times.add(Micros(us)));
        assert_eq!(times.distribution().counts, [10, 10, 30, 50, 100, 300, 500, 100, 0, 0, 0]);
        times.add(Micros(10_000));
        times.add(Micros(9_999));
        times.add(Micros(u64::MAX));
        assert_eq!(times.distribution().counts[7..], [100, 0, 1, 2]);
        assert_eq!(times.distribution().percentiles, times.percentiles());
        times.clear();
        assert_eq!(times.distribution(), TimeDistribution::default());
    }
}
