//! Statistics of measured sizes: capability of the process and its control chart.
//!
//! Sources: ISO 22514-2 (capability Cp, Cpk); ISO 7870-2 and NIST/SEMATECH e-Handbook of Statistical Methods, 6.3.2.2
//! (individuals: σ from the mean moving range, 1.128 = d₂ of two values) and 6.3.2.4 (EWMA).

/// Fewest parts from which a capability is calculated.
pub const MIN_PARTS: usize = 5;
/// Weight of the newest part in the EWMA.
const WEIGHT: f64 = 0.2;
/// Distance of the control limits from the mean, σ of what is plotted.
const LIMIT_SIGMAS: f64 = 3.0;
/// Mean range of two values of a normal distribution with σ = 1.
const D2: f64 = 1.128;
/// A σ below this is rounding: sizes are stored to 0.1 µm.
const LEAST_SIGMA: f64 = 1e-6;

/// Statistics of the sizes of like parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capability {
    /// Number of parts.
    pub count: usize,
    /// Mean size, mm.
    pub mean: f64,
    /// Standard deviation of the sizes, n−1, mm.
    pub deviation: f64,
    /// Least and greatest size, mm.
    pub range: (f64, f64),
    /// Cp and Cpk: width of the tolerance, and distance of its nearer limit from the mean, over six and three deviations.
    /// `None` without limits, and where all sizes are alike.
    pub indices: Option<(f64, f64)>,
}

/// Statistics of some sizes, with least and greatest size of the tolerance; `None` for fewer than [`MIN_PARTS`].
#[must_use]
pub fn capability(sizes: &[f64], limits: Option<(f64, f64)>) -> Option<Capability> {
    if sizes.len() < MIN_PARTS {
        return None;
    }
    let count = sizes.len() as f64;
    let mean = sizes.iter().sum::<f64>() / count;
    let deviation = (sizes.iter().map(|size| (size - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt();
    let range =
        sizes.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), size| (low.min(*size), high.max(*size)));
    let indices = limits.filter(|_| deviation > LEAST_SIGMA).map(|(low, high)| {
        let nearer = (high - mean).min(mean - low);
        ((high - low) / (6.0 * deviation), nearer / (3.0 * deviation))
    });
    Some(Capability { count: sizes.len(), mean, deviation, range, indices })
}

/// A point of the EWMA chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EwmaPoint {
    /// The weighted mean after this part, mm.
    pub mean: f64,
    /// Lower and upper control limit there, mm.
    pub limits: (f64, f64),
}

impl EwmaPoint {
    /// Whether the mean has moved farther than scatter explains.
    #[must_use]
    pub fn is_out(&self) -> bool {
        self.mean < self.limits.0 || self.mean > self.limits.1
    }
}

/// The EWMA of some sizes in their order, around their mean; empty for fewer than [`MIN_PARTS`]. σ is that of neighbouring
/// parts, so that a slow drift does not widen its own limits.
#[must_use]
pub fn ewma(sizes: &[f64]) -> Vec<EwmaPoint> {
    if sizes.len() < MIN_PARTS {
        return Vec::new();
    }
    let centre = sizes.iter().sum::<f64>() / sizes.len() as f64;
    let moving_range = sizes.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum::<f64>() / (sizes.len() - 1) as f64;
    ewma_around(sizes, centre, (moving_range / D2).max(LEAST_SIGMA), WEIGHT)
}

/// The EWMA around a centre, for a standard deviation σ of the sizes and a weight λ of the newest one.
fn ewma_around(sizes: &[f64], centre: f64, sigma: f64, weight: f64) -> Vec<EwmaPoint> {
    let mut mean = centre;
    let point = |(place, size): (usize, &f64)| {
        mean += weight * (size - mean);
        let settled = 1.0 - (1.0 - weight).powi(2 * (place as i32 + 1));
        let reach = LIMIT_SIGMAS * sigma * (weight / (2.0 - weight) * settled).sqrt();
        EwmaPoint { mean, limits: (centre - reach, centre + reach) }
    };
    sizes.iter().enumerate().map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example of NIST/SEMATECH e-Handbook 6.3.2.4: target 50, s = 2.0539, λ = 0.3.
    #[test]
    fn k4_5_the_ewma_of_the_nist_example() {
        let data = [
            52.0, 47.0, 53.0, 49.3, 50.1, 47.0, 51.0, 50.1, 51.2, 50.5, 49.6, 47.6, 49.9, 51.3, 47.8, 51.2, 52.6, 52.4,
            53.6, 52.1,
        ];
        let means = [
            50.60, 49.52, 50.56, 50.18, 50.16, 49.21, 49.75, 49.85, 50.26, 50.33, 50.11, 49.36, 49.52, 50.05, 49.38,
            49.92, 50.73, 51.23, 51.94, 51.99,
        ];
        let points = ewma_around(&data, 50.0, 2.0539, 0.3);
        for (point, mean) in points.iter().zip(means) {
            assert!((point.mean - mean).abs() < 0.006, "{} {mean}", point.mean);
        }
        // Limits 47.4115 and 52.5884 once they have settled.
        let (low, high) = points[19].limits;
        assert!((low - 47.4115).abs() < 1e-3 && (high - 52.5884).abs() < 1e-3, "{low} {high}");
    }

    #[test]
    fn k4_5_the_ewma_is_that_of_its_formula() {
        let sizes = [52.0, 47.0, 53.0, 49.3, 50.1, 47.0];
        let points = ewma(&sizes);
        // Mean 49.7333; 0.2·52 + 0.8·49.7333 = 50.1867; 0.2·47 + 0.8·50.1867 = 49.5493.
        assert!((points[0].mean - 50.186_667).abs() < 1e-6 && (points[1].mean - 49.549_333).abs() < 1e-6);
        // Moving ranges 5, 6, 3.7, 0.8, 3.1: mean 3.72, σ = 3.2979; first limit 3·σ·√(0.2/1.8·0.36) = 3·3.2979·0.2.
        let (low, high) = points[0].limits;
        assert!((high - low - 2.0 * 3.0 * 3.72 / 1.128 * 0.2).abs() < 1e-9);
        assert!(points.iter().all(|point| !point.is_out()));
        // The sixth: 2·3·3.2979·√(0.2/1.8·(1 − 0.8^12)) = 6.36508.
        let last = points[5].limits;
        assert!((last.1 - last.0 - 6.365_08).abs() < 1e-4);
    }

    #[test]
    fn k4_5_a_drift_leaves_the_control_limits_before_a_size_leaves_the_tolerance() {
        // Scatter ±1 µm, then 0.5 µm more with each part: 10 parts later 5 µm off, within ±10 µm.
        let scatter = [0.4, -0.7, 0.2, 0.9, -0.3, -0.8, 0.6, 0.1, -0.5, 0.7];
        let size = |part: usize| {
            let drift = if part < 20 { 0.0 } else { 0.5 * (part - 19) as f64 };
            40.0 + 1e-3 * (scatter[part % 10] + drift)
        };
        let steady: Vec<f64> = (0..20).map(size).collect();
        let drifting: Vec<f64> = (0..30).map(size).collect();
        assert!(ewma(&steady).iter().all(|point| !point.is_out()));
        assert!(ewma(&drifting).iter().any(EwmaPoint::is_out));
        assert!(drifting.iter().all(|size| (size - 40.0).abs() < 0.010));
    }

    #[test]
    fn k4_5_capability_is_that_of_the_standard() {
        // Mean 40.002, deviations −2 −1 0 1 2 µm: s = √(10/4) = 1.5811 µm.
        let sizes = [40.000, 40.001, 40.002, 40.003, 40.004];
        let found = capability(&sizes, Some((39.995, 40.005))).unwrap();
        assert!((found.mean - 40.002).abs() < 1e-9 && (found.deviation - 0.001_581_139).abs() < 1e-9);
        let (cp, cpk) = found.indices.unwrap();
        // 10/(6·1.5811) and 3/(3·1.5811).
        assert!((cp - 1.054_093).abs() < 1e-5 && (cpk - 0.632_456).abs() < 1e-5);
        assert!(capability(&sizes[..4], None).is_none(), "too few");
        assert!(
            capability(&[40.0; 8], Some((39.9, 40.1))).unwrap().indices.is_none(),
            "all alike: no scatter is known"
        );
    }
}
