//! Variance over a hard band by adaptive Gauss-Legendre quadrature in ln omega.
//!
//! Needed only where no rational transfer function describes the loop: a band cut hard, a dead time. A panel is halved until
//! two halves agree with the whole.

use stillrate::Real;

use super::DriftError;

/// Points of a panel's rule.
const POINTS: usize = 12;
/// Panels are halved at most this often.
const DEEPEST: u32 = 30;

/// Variance for white noise of two-sided density 1 in the band `low..high` rad/s: (1/pi) int |H|^2 d omega.
///
/// `relative` is the accuracy asked for.
///
/// # Errors
/// Unless `0 < low < high`, both finite.
///
/// # Example
/// ```
/// use stillrate_lab::servo::drift::quadrature::band_variance;
/// let lag = |w: f64| 4.0 / (w * w + 4.0);
/// let all = band_variance(lag, 1e-9, 1e9, 1e-12).unwrap();
/// assert!((all - 1.0).abs() < 1e-8);
/// ```
pub fn band_variance(
    power_gain: impl Fn(f64) -> f64,
    low_rad_s: f64,
    high_rad_s: f64,
    relative: f64,
) -> Result<f64, DriftError> {
    let low = stillrate::error::positive("low_rad_s", low_rad_s, "rad/s")?;
    let high = stillrate::error::between(
        "high_rad_s",
        high_rad_s,
        low,
        f64::INFINITY,
        "rad/s",
        "finite and above the lower limit in",
    )?;
    let rule = legendre();
    let f = |x: f64| {
        let omega = x.exponential();
        power_gain(omega) * omega
    };
    let (from, to) = (low.logarithm(), high.logarithm());
    let panels = ((to - from) / 0.5).ceil().max(1.0);
    let width = (to - from) / panels;
    let rough: f64 = (0..panels as usize)
        .map(|i| panel(&f, from + width * i as f64, from + width * (i + 1) as f64, &rule).abs())
        .sum();
    let allowed = rough * relative / panels;
    let sum: f64 = (0..panels as usize)
        .map(|i| {
            let (a, b) = (from + width * i as f64, from + width * (i + 1) as f64);
            refine(&f, a, b, panel(&f, a, b, &rule), allowed, &rule, DEEPEST)
        })
        .sum();
    Ok(sum / core::f64::consts::PI)
}

fn refine(f: &impl Fn(f64) -> f64, a: f64, b: f64, whole: f64, allowed: f64, rule: &[(f64, f64)], depth: u32) -> f64 {
    let middle = 0.5 * (a + b);
    let (left, right) = (panel(f, a, middle, rule), panel(f, middle, b, rule));
    if depth == 0 || (left + right - whole).abs() <= allowed {
        return left + right;
    }
    refine(f, a, middle, left, 0.5 * allowed, rule, depth - 1)
        + refine(f, middle, b, right, 0.5 * allowed, rule, depth - 1)
}

fn panel(f: &impl Fn(f64) -> f64, a: f64, b: f64, rule: &[(f64, f64)]) -> f64 {
    let (centre, half) = (0.5 * (a + b), 0.5 * (b - a));
    half * rule.iter().map(|(x, w)| w * f(centre + half * x)).sum::<f64>()
}

/// Nodes and weights on -1..1: zeros of the Legendre polynomial by Newton's method.
fn legendre() -> Vec<(f64, f64)> {
    let n = POINTS as f64;
    (0..POINTS)
        .map(|i| {
            let (_, mut x) = (core::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).sine_cosine();
            let mut slope = 1.0;
            for _ in 0..8 {
                let (mut p, mut before) = (x, 1.0);
                for k in 2..=POINTS {
                    let k = k as f64;
                    (p, before) = (((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k, p);
                }
                slope = n * (x * p - before) / (x * x - 1.0);
                x -= p / slope;
            }
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}
