//! Variances known in closed form: the reference that the general algorithms are tested against, and the
//! formulas an engineer keeps in mind. All for white noise of density N = 1 unless a parameter says otherwise;
//! multiply by N^2.

use stillrate::Real;

/// Integrator, Gauss-Markov bias of unit variance and time constant `tau` after `t`: 2 tau (t - tau (1 - e^(-t/tau))).
///
/// # Example
/// ```
/// use stillrate_lab::servo::drift::closed_forms::integrator_gauss_markov;
/// assert!((integrator_gauss_markov(60.0, 20.0) - 1639.8296546942914).abs() < 1e-9);
/// ```
#[must_use]
pub fn integrator_gauss_markov(t: f64, tau: f64) -> f64 {
    2.0 * tau * (t + tau * (-t / tau).exponential_less_one())
}

/// Integrator, random walk of rate with K = 1 after `t`: t^3 / 3.
#[must_use]
pub fn integrator_rate_random_walk(t: f64) -> f64 {
    t * t * t / 3.0
}

/// Rate loop a/(s+a) alone after `t`: t - 2(1 - e^(-at))/a + (1 - e^(-2at))/(2a).
#[must_use]
pub fn rate_only_first_order(a: f64, t: f64) -> f64 {
    t + 2.0 * (-a * t).exponential_less_one() / a - (-2.0 * a * t).exponential_less_one() / (2.0 * a)
}

/// Rate loop of second order alone, for large `t`: t - 4 zeta/wn + (1 + 4 zeta^2)/(4 zeta wn).
#[must_use]
pub fn rate_only_second_order_late(wn: f64, zeta: f64, t: f64) -> f64 {
    t - 4.0 * zeta / wn + (1.0 + 4.0 * zeta * zeta) / (4.0 * zeta * wn)
}

/// Tracked loop with gain `k` around a first-order rate loop: 1/(2k), whatever the rate loop's bandwidth.
#[must_use]
pub fn tracked_first_order(k: f64) -> f64 {
    1.0 / (2.0 * k)
}

/// The same under a Gauss-Markov bias of unit variance.
#[must_use]
pub fn tracked_first_order_gauss_markov(a: f64, k: f64, tau: f64) -> f64 {
    let p = 1.0 / tau;
    let (b0, a2, a1, a0) = (a * (2.0 * p).root(), a + p, a * k + a * p, a * k * p);
    b0 * b0 * a2 / (2.0 * a0 * (a1 * a2 - a0))
}

/// Tracked loop around a second-order rate loop: 1/(2k) / (1 - k/(2 zeta wn)); infinite from k = 2 zeta wn on.
#[must_use]
pub fn tracked_second_order(wn: f64, zeta: f64, k: f64) -> f64 {
    let left = 1.0 - k / (2.0 * zeta * wn);
    if left > 0.0 { 1.0 / (2.0 * k * left) } else { f64::INFINITY }
}

/// Lower cut-off (Hz) of a band-limited integral that equals an integrator's variance after `t`: 1/(2 pi^2 t).
#[must_use]
pub fn equivalent_cutoff_hz(t: f64) -> f64 {
    1.0 / (2.0 * core::f64::consts::PI * core::f64::consts::PI * t)
}
