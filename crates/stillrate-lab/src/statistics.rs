//! The few distribution functions that metrics and intervals need, the same bits everywhere: normal distribution and
//! its inverse, chi-square quantiles for a real number of degrees of freedom, medians.
//!
//! Normal: Phi(x) = erfc(-x / sqrt 2) / 2. Chi-square: regularised incomplete gamma functions by their power series
//! and Legendre's continued fraction (Abramowitz and Stegun 6.5.29, 6.5.31). Quantiles: Newton's iteration held inside
//! a shrinking bracket.

use core::f64::consts::SQRT_2;

use stillrate::Real;

/// Phi(x), the standard normal distribution function.
///
/// # Example
/// ```
/// use stillrate_lab::statistics::normal_cdf;
/// assert!((normal_cdf(1.6448536269514722) - 0.95).abs() < 1e-15);
/// ```
#[must_use]
pub fn normal_cdf(x: f64) -> f64 {
    0.5 * libm::erfc(-x / SQRT_2)
}

/// The x with Phi(x) = `lower` and 1 - Phi(x) = `upper`; the smaller tail decides, so that neither side loses digits.
#[must_use]
pub(crate) fn normal_score(lower: f64, upper: f64) -> f64 {
    let tail = lower.min(upper);
    if lower.is_nan() || upper.is_nan() {
        return f64::NAN;
    }
    // Beyond 37 standard deviations the tail underflows.
    let distance = if tail <= 0.0 { 37.0 } else { solve(0.0, 38.0, |x| normal_tail(x) / tail - 1.0) };
    if lower < upper { -distance } else { distance }
}

fn normal_tail(x: f64) -> f64 {
    0.5 * libm::erfc(x / SQRT_2)
}

/// Root of a function that changes sign once between `low` and `high`: regula falsi (Illinois) with bisection.
fn solve(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (mut f_low, mut f_high) = (f(low), f(high));
    if f_low == 0.0 {
        return low;
    }
    for turn in 0..200 {
        let secant = (low * f_high - high * f_low) / (f_high - f_low);
        let inside = secant > low && secant < high && turn % 3 != 2;
        let middle = if inside { secant } else { 0.5 * (low + high) };
        let value = f(middle);
        if value == 0.0 || high - low <= 4.0 * f64::EPSILON * middle.abs() {
            return middle;
        }
        if (value > 0.0) == (f_low > 0.0) {
            (low, f_low) = (middle, value);
            f_high *= 0.5;
        } else {
            (high, f_high) = (middle, value);
            f_low *= 0.5;
        }
    }
    0.5 * (low + high)
}

/// P(a, x), the regularised lower incomplete gamma function.
fn gamma_p(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    let front = (a * x.logarithm() - x - libm::lgamma(a)).exponential();
    if x < a + 1.0 {
        let (mut term, mut sum, mut k) = (1.0 / a, 1.0 / a, a);
        while term > sum * f64::EPSILON {
            k += 1.0;
            term *= x / k;
            sum += term;
        }
        return front * sum;
    }
    // Modified Lentz evaluation of 1/(x+1-a- 1(1-a)/(x+3-a- ...)).
    let mut b = x + 1.0 - a;
    let (mut c, mut d) = (1e300, 1.0 / b);
    let mut fraction = d;
    for i in 1..100_000 {
        let i = f64::from(i);
        let numerator = -i * (i - a);
        b += 2.0;
        d = 1.0 / (numerator * d + b);
        c = b + numerator / c;
        fraction *= d * c;
        if (d * c - 1.0).magnitude() < f64::EPSILON {
            break;
        }
    }
    1.0 - front * fraction
}

/// Quantile of the chi-square distribution with `freedom` degrees of freedom (any real > 0); `probability` in 0..1.
///
/// # Example
/// ```
/// use stillrate_lab::statistics::chi_square_quantile;
/// assert!((chi_square_quantile(0.95, 10.0) - 18.307038).abs() < 1e-6);
/// ```
#[must_use]
pub fn chi_square_quantile(probability: f64, freedom: f64) -> f64 {
    // Wilson and Hilferty's cube is within a part in 1e8 from here on, and the bracket's tails get expensive.
    let spread = 2.0 / (9.0 * freedom);
    let cube = 1.0 - spread + normal_score(probability, 1.0 - probability) * spread.root();
    if freedom > 1e5 {
        return freedom * cube * cube * cube;
    }
    let a = 0.5 * freedom;
    let mut high = a + 10.0;
    while gamma_p(a, high) < probability {
        high *= 2.0;
    }
    2.0 * solve(0.0, high, |x| gamma_p(a, x) - probability)
}

/// Median of the finite values (mean of the middle two); NaN if there are none. Reorders the slice.
///
/// # Example
/// ```
/// use stillrate_lab::statistics::median;
/// assert_eq!(median(&mut [3.0, f64::NAN, 1.0, 2.0, 10.0]), 2.5);
/// ```
#[must_use]
pub fn median(values: &mut [f64]) -> f64 {
    quantile(values, 0.5)
}

/// Quantile of the finite values, linear between neighbours; NaN if there are none. Reorders the slice.
#[must_use]
pub(crate) fn quantile(values: &mut [f64], fraction: f64) -> f64 {
    // Finite values first: NaN and the infinities sort behind them.
    let mut count = 0;
    for k in 0..values.len() {
        if values[k].is_finite() {
            values.swap(count, k);
            count += 1;
        }
    }
    let finite = &mut values[..count];
    if finite.is_empty() {
        return f64::NAN;
    }
    let position = fraction.clamp(0.0, 1.0) * (count - 1) as f64;
    let index = (position as usize).min(count - 1);
    let (_, &mut low, above) = finite.select_nth_unstable_by(index, f64::total_cmp);
    let high = above.iter().copied().fold(f64::INFINITY, f64::min);
    let part = position - index as f64;
    if part > 0.0 { low + part * (high - low) } else { low }
}

#[cfg(test)]
mod tests {
    use super::{chi_square_quantile, median, normal_cdf, normal_score, quantile};

    #[test]
    fn chi_square_quantiles_match_printed_tables() {
        // Abramowitz and Stegun table 26.8, and closed forms: two degrees -2 ln(1 - p), one degree a squared normal.
        for (p, freedom, expected) in [(0.05, 10.0, 3.940_299), (0.95, 100.0, 124.342_113), (0.95, 1.0, 3.841_459)] {
            assert!((chi_square_quantile(p, freedom) - expected).abs() < 1e-5, "{p} {freedom}");
        }
        for p in [1e-6, 0.05, 0.5, 0.95, 0.999] {
            assert!((chi_square_quantile(p, 2.0) + 2.0 * (-p).ln_1p()).abs() < 1e-9);
            let z = normal_score(0.5 + 0.5 * p, 0.5 - 0.5 * p);
            assert!((chi_square_quantile(p, 1.0) - z * z).abs() < 1e-9);
        }
    }

    #[test]
    fn chi_square_quantiles_join_smoothly_where_the_method_changes() {
        for p in [0.05, 0.95] {
            let below = chi_square_quantile(p, 99_999.0);
            let above = chi_square_quantile(p, 100_001.0);
            assert!((above - below - 2.0).abs() < 0.05);
        }
    }

    #[test]
    fn scores_invert_the_distribution_far_into_both_tails() {
        for x in [-30.0, -8.0, -1.0, -1e-3, 0.0, 0.3, 5.0, 20.0] {
            let score = normal_score(normal_cdf(x), normal_cdf(-x));
            assert!((score - x).abs() < 1e-12 * (1.0 + x.abs()), "{x} {score}");
        }
        assert!((normal_score(0.95, 0.05) - 1.6448536269514722).abs() < 1e-12);
        assert_eq!(normal_score(1.0, 0.0), 37.0);
        assert!(normal_score(f64::NAN, 0.5).is_nan());
    }

    #[test]
    fn medians_ignore_what_is_not_finite() {
        assert!(median(&mut [f64::NAN, f64::INFINITY]).is_nan());
        assert_eq!(median(&mut [f64::INFINITY, 1.0, 5.0, f64::NAN, 2.0]), 2.0);
    }

    #[test]
    fn quantiles_lie_on_the_line_between_their_neighbours() {
        assert_eq!(quantile(&mut [4.0, 1.0, 2.0, 3.0, 5.0], 0.25), 2.0);
        assert_eq!(quantile(&mut [4.0, 1.0, f64::NAN, 2.0, 3.0, 5.0], 0.3), 1.0 + 0.3 * 4.0);
        assert_eq!(quantile(&mut [4.0, 1.0], 1.0), 4.0);
    }
}
