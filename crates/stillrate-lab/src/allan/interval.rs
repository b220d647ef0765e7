//! Confidence interval of a fitted strength by inverting its test.
//!
//! The estimate of a strength x has variance a + b x + c x^2: what the other noises contribute, and its own. Its own part
//! is spread like a chi-square with 2/c degrees of freedom, the rest nearly normally; their quantiles are added as
//! roots of squares. The interval holds every x >= 0 whose quantiles enclose the estimate.

use stillrate::Real;

use crate::statistics::{chi_square_quantile, normal_score};

/// Interval for a strength estimated (freely, maybe below zero) as `estimate`, with variance coefficients [a, b, c].
pub(crate) fn interval(estimate: f64, [a, b, c]: [f64; 3], confidence: f64) -> (f64, f64) {
    let tail = 0.5 * (1.0 - confidence);
    let score = normal_score(1.0 - tail, tail);
    let freedom = if c > 0.0 { 2.0 / c } else { 1e12 };
    let reach = |x: f64, own: f64| {
        let other = score * score * (a + b * x).max(0.0);
        (own * own * x * x + other).root()
    };
    let own_above = chi_square_quantile(1.0 - tail, freedom) / freedom - 1.0;
    let own_below = 1.0 - chi_square_quantile(tail, freedom) / freedom;
    // Both grow with x: the true strength is at least where its upper quantile meets the estimate.
    let lower = first_reaching(estimate, |x| x + reach(x, own_above));
    let upper = first_reaching(estimate, |x| x - reach(x, own_below));
    (lower, upper)
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
        let (low, high) = interval(3.0, [0.0, 0.0, 2.0 / freedom], 0.9);
        assert!((low - 3.0 * freedom / chi_square_quantile(0.95, freedom)).abs() < 1e-9);
        assert!((high - 3.0 * freedom / chi_square_quantile(0.05, freedom)).abs() < 1e-9);
    }

    #[test]
    fn a_strength_hidden_in_other_noise_has_the_normal_interval_cut_at_zero() {
        let (low, high) = interval(3.0, [1.0, 0.0, 0.0], 0.9);
        assert!((low - (3.0 - 1.644_853_627)).abs() < 1e-6 && (high - (3.0 + 1.644_853_627)).abs() < 1e-6);
        assert_eq!(interval(-1.0, [1.0, 0.0, 0.0], 0.9).0, 0.0);
        assert!((interval(-1.0, [1.0, 0.0, 0.0], 0.9).1 - 0.644_853_627).abs() < 1e-6);
    }
}
