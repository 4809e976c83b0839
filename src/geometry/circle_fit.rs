//! The circle that points lie on best: least squares of u² + v² + a u + b v + c (Kåsa 1976), and how far they are from it.
//! Source: the circular test of machine tools, ISO 230-4.

use super::PlanePoint;

/// A fitted circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FittedCircle {
    /// Its centre, mm.
    pub center: PlanePoint,
    /// Its radius, mm.
    pub radius: f64,
    /// Distance of the nearest and of the farthest point from the centre, minus the radius, mm.
    pub deviation: (f64, f64),
}

/// Least share of the points' extent that the second extent must have: points on a line have no circle.
const LEAST_DETERMINANT: f64 = 1e-9;

impl FittedCircle {
    /// Fits a circle; none through fewer than three points, or through points on a line.
    #[must_use]
    pub fn through(points: &[PlanePoint]) -> Option<Self> {
        let count = points.len() as f64;
        if points.len() < 3 {
            return None;
        }
        let mean = |value: fn(&PlanePoint) -> f64| points.iter().map(value).sum::<f64>() / count;
        let (mu, mv) = (mean(|p| p[0]), mean(|p| p[1]));
        // About the mean: sums of squares and cubes.
        let (mut uu, mut uv, mut vv, mut cu, mut cv) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for point in points {
            let (u, v) = (point[0] - mu, point[1] - mv);
            let square = u * u + v * v;
            uu += u * u;
            uv += u * v;
            vv += v * v;
            cu += u * square;
            cv += v * square;
        }
        let determinant = uu * vv - uv * uv;
        if determinant <= LEAST_DETERMINANT * (uu + vv).powi(2) {
            return None;
        }
        let (u, v) = ((cu * vv - cv * uv) / (2.0 * determinant), (cv * uu - cu * uv) / (2.0 * determinant));
        let radius = (u * u + v * v + (uu + vv) / count).sqrt();
        let center = [mu + u, mv + v];
        let away = points.iter().map(|point| (point[0] - center[0]).hypot(point[1] - center[1]) - radius);
        let deviation = away.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), by| (low.min(by), high.max(by)));
        Some(Self { center, radius, deviation })
    }

    /// Greatest minus least distance from the centre, mm.
    #[must_use]
    pub fn roundness(&self) -> f64 {
        self.deviation.1 - self.deviation.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on_circle(count: u32, sweep: f64, radius: impl Fn(f64) -> f64) -> Vec<PlanePoint> {
        let at = |k: u32| {
            let angle = sweep * f64::from(k) / f64::from(count);
            [3.0 + radius(angle) * angle.cos(), -40.0 + radius(angle) * angle.sin()]
        };
        (0..count).map(at).collect()
    }

    #[test]
    fn b6_a_circle_is_found_from_a_part_of_it() {
        for sweep in [std::f64::consts::TAU, std::f64::consts::PI, 1.0] {
            let circle = FittedCircle::through(&on_circle(400, sweep, |_| 25.0)).expect("a circle");
            assert!((circle.radius - 25.0).abs() < 1e-9 && circle.roundness() < 1e-9, "{circle:?}");
            assert!((circle.center[0] - 3.0).abs() < 1e-9 && (circle.center[1] + 40.0).abs() < 1e-9);
        }
    }

    /// 25 mm + 5 µm · cos 2φ is an ellipse: roundness 10 µm.
    #[test]
    fn b6_the_roundness_of_an_oval_is_its_range() {
        let circle =
            FittedCircle::through(&on_circle(720, std::f64::consts::TAU, |angle| 25.0 + 0.005 * (2.0 * angle).cos()));
        assert!((circle.expect("a circle").roundness() - 0.010).abs() < 1e-6);
    }

    #[test]
    fn b6_a_line_and_two_points_are_no_circle() {
        let line: Vec<PlanePoint> = (0..50).map(|k| [f64::from(k), 2.0 * f64::from(k)]).collect();
        assert_eq!(FittedCircle::through(&line), None);
        assert_eq!(FittedCircle::through(&line[..2]), None);
        assert_eq!(FittedCircle::through(&[[1.0, 1.0]; 9]), None);
    }
}
