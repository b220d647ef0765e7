//! What the recursive filters do, without running them: gain, noise, lag, bandwidth, and the ways to say "memory".
//!
//! All for a constant forgetting factor lambda and regular samples; delays in samples, frequencies as a fraction of the sample
//! rate, noise as a variance over that of one white sample. Nothing here cancels for lambda near 1.
//! Derivations: geometric sums; the Kalman gain from the scalar Riccati equation (DOI 10.7690/bgzdh.2019.03.009 states the steady ones).

use crate::real::Real;

/// 1 - lambda^n
fn one_less_power(forgetting_factor: f64, n: f64) -> f64 {
    -(n * forgetting_factor.logarithm()).exponential_less_one()
}

/// Gain of recursive least squares at sample `n` (1 for the first): (1 - lambda)/(1 - lambda^n), 1/n for lambda = 1.
///
/// # Example
/// ```
/// use stillrate::filters::closed_forms::rls_gain;
/// assert_eq!(rls_gain(0.9512, 1), 1.0);
/// assert_eq!(rls_gain(1.0, 4), 0.25);
/// ```
#[must_use]
pub fn rls_gain(forgetting_factor: f64, n: u64) -> f64 {
    match n {
        0 | 1 => 1.0,
        _ if forgetting_factor == 1.0 => 1.0 / n as f64,
        _ => (1.0 - forgetting_factor) / one_less_power(forgetting_factor, n as f64),
    }
}

/// Gain of the random-walk Kalman filter at sample `n`: (1 - lambda)(1 + lambda^(2n-1))/(1 - lambda^(2n)), with lambda of its Q/R.
///
/// # Example
/// ```
/// use stillrate::filters::closed_forms::{kf_gain, variance_ratio};
/// let second = 1.0 + variance_ratio(0.9512); // K(1) + q
/// assert!((kf_gain(0.9512, 2) - second / (1.0 + second)).abs() < 1e-15);
/// ```
#[must_use]
pub fn kf_gain(forgetting_factor: f64, n: u64) -> f64 {
    match n {
        0 | 1 => 1.0,
        _ if forgetting_factor == 1.0 => 1.0 / n as f64,
        _ => {
            let twice = 2.0 * n as f64;
            let power = ((twice - 1.0) * forgetting_factor.logarithm()).exponential();
            (1.0 - forgetting_factor) * (1.0 + power) / one_less_power(forgetting_factor, twice)
        }
    }
}

/// Noise variance of recursive least squares after `n` samples of a constant rate.
///
/// # Example
/// ```
/// use stillrate::filters::closed_forms::rls_noise;
/// assert!((rls_noise(0.9512, 20) - 0.05409).abs() < 5e-6);
/// ```
#[must_use]
pub fn rls_noise(forgetting_factor: f64, n: u64) -> f64 {
    let n = n.max(1) as f64;
    if forgetting_factor == 1.0 {
        return 1.0 / n;
    }
    let left = one_less_power(forgetting_factor, n);
    (1.0 - forgetting_factor) * (2.0 - left) / ((1.0 + forgetting_factor) * left)
}

/// Noise variance in the steady state, order 1: (1 - lambda)/(1 + lambda).
///
/// # Example
/// ```
/// use stillrate::filters::closed_forms::{rls_noise, steady_noise};
/// assert!((steady_noise(0.9) - 0.1 / 1.9).abs() < 1e-16);
/// assert!((rls_noise(0.9, 1000) - steady_noise(0.9)).abs() < 1e-16); // where it ends
/// ```
#[must_use]
pub fn steady_noise(forgetting_factor: f64) -> f64 {
    (1.0 - forgetting_factor) / (1.0 + forgetting_factor)
}

/// Noise variance in the steady state, order 2: (1 - lambda)(1 + 4 lambda + 5 lambda^2)/(1 + lambda)^3.
///
/// # Example
/// ```
/// use stillrate::filters::closed_forms::{steady_noise, steady_noise_order_2};
/// assert!((steady_noise_order_2(0.99) / steady_noise(0.99) - 2.5).abs() < 0.02); // the price of a slope
/// ```
#[must_use]
pub fn steady_noise_order_2(forgetting_factor: f64) -> f64 {
    let sum = 1.0 + forgetting_factor;
    (1.0 - forgetting_factor) * (1.0 + forgetting_factor * (4.0 + 5.0 * forgetting_factor)) / (sum * sum * sum)
}

/// Gains (g1, g2) of order 2 in the steady state: 1 - lambda^2 and (1 - lambda)^2.
///
/// # Example
/// ```
/// use stillrate::filters::closed_forms::steady_gains_order_2;
/// assert_eq!(steady_gains_order_2(0.5), (0.75, 0.25));
/// ```
#[must_use]
pub fn steady_gains_order_2(forgetting_factor: f64) -> (f64, f64) {
    let rest = 1.0 - forgetting_factor;
    (rest * (1.0 + forgetting_factor), rest * rest)
}

/// Lag on a ramp and delay at zero frequency, in samples: lambda/(1 - lambda). Exactly that of a boxcar of equal noise.
///
/// # Example
/// ```
/// use stillrate::filters::closed_forms::{boxcar_length, lag_samples};
/// assert_eq!(lag_samples(0.5), 1.0);
/// assert!((lag_samples(0.9) - 0.5 * (boxcar_length(0.9) - 1.0)).abs() < 1e-14);
/// ```
#[must_use]
pub fn lag_samples(forgetting_factor: f64) -> f64 {
    forgetting_factor / (1.0 - forgetting_factor)
}

/// Length of the boxcar with the same noise variance: (1 + lambda)/(1 - lambda).
///
/// # Example
/// ```
/// use stillrate::filters::closed_forms::{boxcar_length, steady_noise};
/// assert!((boxcar_length(0.9) * steady_noise(0.9) - 1.0).abs() < 1e-15);
/// ```
#[must_use]
pub fn boxcar_length(forgetting_factor: f64) -> f64 {
    (1.0 + forgetting_factor) / (1.0 - forgetting_factor)
}

/// Phase delay in samples at a frequency (fraction of the sample rate, above 0) in the steady state, order 1.
///
/// # Example
/// ```
/// use stillrate::filters::closed_forms::{lag_samples, phase_delay_samples};
/// assert!((phase_delay_samples(0.9, 1e-6) - lag_samples(0.9)).abs() < 1e-6); // slow motion is late by the lag
/// ```
#[must_use]
pub fn phase_delay_samples(forgetting_factor: f64, frequency: f64) -> f64 {
    let omega = core::f64::consts::TAU * frequency;
    let (sine, cosine) = omega.sine_cosine();
    // H = (1 - lambda)/(1 - lambda e^-i omega)
    (forgetting_factor * sine).angle_over(1.0 - forgetting_factor * cosine) / omega
}

/// Frequency of -3 dB as a fraction of the sample rate, order 1; none below lambda = 3 - 2 sqrt 2, where less is never lost.
///
/// # Example
/// ```
/// use stillrate::filters::closed_forms::half_power_frequency;
/// assert!((half_power_frequency(0.9512).unwrap() - 0.0079643).abs() < 1e-7);
/// assert_eq!(half_power_frequency(0.1), None);
/// ```
#[must_use]
pub fn half_power_frequency(forgetting_factor: f64) -> Option<f64> {
    // cos w = (1 + lambda^2 - 2 (1 - lambda)^2)/(2 lambda), as a half-angle: sin(w/2) = (1 - lambda)/(2 sqrt lambda).
    let sine = (1.0 - forgetting_factor) / (2.0 * forgetting_factor.root());
    let cosine2 = 1.0 - sine * sine;
    (cosine2 >= 0.0).then(|| 2.0 * sine.angle_over(cosine2.root()) / core::f64::consts::TAU)
}

/// Memory in samples: -1/ln lambda; infinite for lambda = 1.
///
/// # Example
/// ```
/// use stillrate::filters::closed_forms::tau_samples;
/// assert_eq!(tau_samples(1.0), f64::INFINITY);
/// ```
#[must_use]
pub fn tau_samples(forgetting_factor: f64) -> f64 {
    if forgetting_factor == 1.0 { f64::INFINITY } else { -1.0 / forgetting_factor.logarithm() }
}

/// lambda of a memory in samples: exp(-1/tau).
///
/// # Example
/// ```
/// use stillrate::filters::closed_forms::{forgetting_factor_of_tau, tau_samples};
/// assert!((tau_samples(forgetting_factor_of_tau(20.0)) - 20.0).abs() < 1e-12);
/// ```
#[must_use]
pub fn forgetting_factor_of_tau(tau_samples: f64) -> f64 {
    (-1.0 / tau_samples).exponential()
}

/// Q/R of the random-walk Kalman filter with the steady gain 1 - lambda: (1 - lambda)^2/lambda.
///
/// # Example
/// ```
/// use stillrate::filters::closed_forms::variance_ratio;
/// assert_eq!(variance_ratio(0.5), 0.5);
/// ```
#[must_use]
pub fn variance_ratio(forgetting_factor: f64) -> f64 {
    let rest = 1.0 - forgetting_factor;
    rest * rest / forgetting_factor
}

/// lambda of a Q/R: 1 + q/2 - sqrt(q + q^2/4), here as its reciprocal with a plus, which never cancels.
///
/// # Example
/// ```
/// use stillrate::filters::closed_forms::{forgetting_factor_of_variance_ratio, variance_ratio};
/// for lambda in [1e-6, 0.1, 0.9512, 0.999_999] {
///     assert!((forgetting_factor_of_variance_ratio(variance_ratio(lambda)) / lambda - 1.0).abs() < 1e-9);
/// }
/// ```
#[must_use]
pub fn forgetting_factor_of_variance_ratio(variance_ratio: f64) -> f64 {
    let half = 0.5 * variance_ratio;
    1.0 / (1.0 + half + (variance_ratio + half * half).root())
}
