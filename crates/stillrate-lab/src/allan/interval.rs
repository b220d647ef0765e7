//! Confidence interval of a fitted strength by inverting its test.
//!
//! The estimate of a strength x has variance a + b x + c x^2 = c (x + b / 2c)^2 + (a - b^2 / 4c): the square is what the
//! few longest clusters scatter by, which all noises fill together, like a chi-square with 2/c degrees of freedom; the
//! rest is nearly normal. The sum is taken as a chi-square with the mean, variance and skewness of both, shifted
//! (Pearson's type III). The interval holds every x >= 0 whose quantiles enclose the estimate.

use stillrate::Real;

use crate::statistics::{chi_square_quantile, normal_score};

/// Interval for a strength estimated (freely, maybe below zero) as `estimate`; `form` gives the variance coefficients
/// [a, b, c] under a true strength.
pub(crate) fn interval(estimate: f64, form: impl Fn(f64) -> [f64; 3], confidence: f64) -> (f64, f64) {
    let tail = 0.5 * (1.0 - confidence);
    let end = |x: f64, p: f64| {
        let [a, b, c] = form(x);
        let shared = if c > 0.0 { (0.5 * b / c).max(0.0) } else { 0.0 };
        let deviation = (a + b * x + c * x * x).max(0.0).root();
        // A chi-square of n degrees about a mean E has the third moment 8 E^3 / n^2 and the skewness sqrt(8 / n).
        let skewness = if deviation > 0.0 { 2.0 * c * c * ((x + shared) / deviation).powi(3) } else { 0.0 };
        x + deviation * score(p, skewness)
    };
    // Both grow with x: the true strength is at least where its upper quantile meets the estimate.
    let lower = first_reaching(estimate, |x| end(x, 1.0 - tail));
    let upper = first_reaching(estimate, |x| end(x, tail));
    (lower, upper)
}

/// Degrees of freedom from which a chi-square is taken as normal.
const NEARLY_NORMAL: f64 = 1e6;

/// Quantile of a shifted chi-square of mean 0, variance 1 and the given skewness, which is none at 0.
fn score(p: f64, skewness: f64) -> f64 {
    let freedom = 8.0 / (skewness * skewness);
    if freedom < NEARLY_NORMAL {
        (chi_square_quantile(p, freedom) / freedom - 1.0) * (0.5 * freedom).root()
    } else {
        normal_score(p, 1.0 - p)
    }
}

/// The smallest x >= 0 with f(x) >= target, for an f that grows without bound.
fn first_reaching(target: f64, f: impl Fn(f64) -> f64) -> f64 {
    if f(0.0) >= target {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, target.magnitude().max(f(0.0).magnitude()).max(f64::MIN_POSITIVE));
    for _ in 0..200 {
        if f(high) >= target {
            break;
        }
        (low, high) = (high, 2.0 * high);
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if f(middle) >= target { high = middle } else { low = middle }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::interval;
    use crate::statistics::chi_square_quantile;

    #[test]
    fn a_strength_alone_has_the_chi_square_interval() {
        let freedom = 7.0;
        let (low, high) = interval(3.0, |_| [0.0, 0.0, 2.0 / freedom], 0.9);
        assert!((low - 3.0 * freedom / chi_square_quantile(0.95, freedom)).abs() < 1e-9);
        assert!((high - 3.0 * freedom / chi_square_quantile(0.05, freedom)).abs() < 1e-9);
    }

    #[test]
    fn a_strength_hidden_in_other_noise_has_the_normal_interval_cut_at_zero() {
        let (low, high) = interval(3.0, |_| [1.0, 0.0, 0.0], 0.9);
        assert!((low - (3.0 - 1.644_853_627)).abs() < 1e-6 && (high - (3.0 + 1.644_853_627)).abs() < 1e-6);
        assert_eq!(interval(-1.0, |_| [1.0, 0.0, 0.0], 0.9).0, 0.0);
        assert!((interval(-1.0, |_| [1.0, 0.0, 0.0], 0.9).1 - 0.644_853_627).abs() < 1e-6);
    }
}
