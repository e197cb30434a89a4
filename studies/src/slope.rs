//! How fast something grows: slopes of lines through measured points, with what is left open.

/// Quantile of Student's distribution for a 95 % interval of a slope through five points: 3 degrees of
/// freedom.
const STUDENT: f64 = 3.182;

/// A slope and half of its 95 % interval.
#[derive(Clone, Copy, Debug)]
pub struct Slope {
    /// By least squares.
    pub value: f64,
    /// Half of the interval.
    pub half: f64,
}

impl Slope {
    /// By least squares, through five points.
    pub fn through(points: &[(f64, f64)]) -> Self {
        let count = points.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
        let [x, y] = [mean(|point| point.0), mean(|point| point.1)];
        let spread: f64 = points.iter().map(|point| (point.0 - x).powi(2)).sum();
        let value = points.iter().map(|point| (point.0 - x) * (point.1 - y)).sum::<f64>() / spread;
        let left: f64 = points.iter().map(|point| (point.1 - y - value * (point.0 - x)).powi(2)).sum();
        Self { value, half: STUDENT * (left / (count - 2.0) / spread).sqrt() }
    }
}

impl std::fmt::Display for Slope {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:.2} +- {:.2}", self.value, self.half)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_is_found_with_its_interval() {
        let line = [(0.0, 1.0), (1.0, 3.0), (2.0, 5.0), (3.0, 7.0), (4.0, 9.0)];
        let exact = Slope::through(&line);
        assert!((exact.value - 2.0).abs() < 1e-12 && exact.half < 1e-9);
        // Residuals 0.1, -0.2, 0, 0.2, -0.1 take (-0.1 * 2 * 2 + 0.2 * 2) / 10 off; hand-calculated.
        let noisy = Slope::through(&[(0.0, 1.1), (1.0, 2.8), (2.0, 5.0), (3.0, 7.2), (4.0, 8.9)]);
        assert!((noisy.value - 2.0).abs() < 1e-9, "{noisy:?}");
        assert!((noisy.half - STUDENT * (0.1f64 / 3.0 / 10.0).sqrt()).abs() < 1e-9, "{noisy:?}");
    }
}
