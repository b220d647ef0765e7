//! Variances known in closed form: the reference that the general algorithms are tested against, and the
//! formulas an engineer keeps in mind. All for white noise of density N = 1 unless a parameter says otherwise;
//! multiply by N^2. Times in s, bandwidths and gains in 1/s or rad/s.

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
///
/// # Example
/// ```
/// use stillrate_lab::servo::drift::closed_forms::integrator_rate_random_walk;
/// // 1e-3 deg/s/sqrt(s) for a minute: 0.27 deg.
/// assert!((1e-3 * integrator_rate_random_walk(60.0).sqrt() - 0.268).abs() < 1e-3);
/// ```
#[must_use]
pub fn integrator_rate_random_walk(t: f64) -> f64 {
    t * t * t / 3.0
}

/// Rate loop a/(s+a) alone after `t`: t - 2(1 - e^(-at))/a + (1 - e^(-2at))/(2a).
///
/// # Example
/// ```
/// use stillrate_lab::servo::drift::closed_forms::rate_only_first_order;
/// // Once it has settled the loop is 1.5 of its time constants behind a plain integrator's t.
/// assert!((rate_only_first_order(20.0, 60.0) - (60.0 - 1.5 / 20.0)).abs() < 1e-12);
/// ```
#[must_use]
pub fn rate_only_first_order(a: f64, t: f64) -> f64 {
    t + 2.0 * (-a * t).exponential_less_one() / a - (-2.0 * a * t).exponential_less_one() / (2.0 * a)
}

/// Rate loop of second order alone, for large `t`: t - 4 zeta/wn + (1 + 4 zeta^2)/(4 zeta wn).
///
/// # Example
/// ```
/// use stillrate_lab::servo::drift::{DriftLoop, TransferFunction, closed_forms::rate_only_second_order_late, van_loan};
/// let rate_loop = TransferFunction::new(&[225.0], &[1.0, 18.0, 225.0]).unwrap(); // wn = 15 rad/s, zeta = 0.6
/// let exact = van_loan::variance_after(&DriftLoop::rate_only(rate_loop).noise_path().unwrap(), 60.0).unwrap();
/// assert!((rate_only_second_order_late(15.0, 0.6, 60.0) - exact).abs() < 1e-9);
/// ```
#[must_use]
pub fn rate_only_second_order_late(wn: f64, zeta: f64, t: f64) -> f64 {
    t - 4.0 * zeta / wn + (1.0 + 4.0 * zeta * zeta) / (4.0 * zeta * wn)
}

/// Tracked loop with gain `k` around a first-order rate loop: 1/(2k), whatever the rate loop's bandwidth.
///
/// # Example
/// ```
/// use stillrate_lab::servo::drift::closed_forms::tracked_first_order;
/// // A gyro of 0.0152 deg/sqrt(s) behind a gain of 2/s: 0.0076 deg, for ever.
/// assert!((0.0152 * tracked_first_order(2.0).sqrt() - 0.0076).abs() < 1e-12);
/// ```
#[must_use]
pub fn tracked_first_order(k: f64) -> f64 {
    1.0 / (2.0 * k)
}

/// The same under a Gauss-Markov bias of unit variance.
///
/// # Example
/// ```
/// use stillrate_lab::servo::drift::closed_forms::tracked_first_order_gauss_markov;
/// // A bias that hardly changes leaves 1/k of itself.
/// assert!((tracked_first_order_gauss_markov(20.0, 2.0, 1e6) - 0.25).abs() < 1e-5);
/// ```
#[must_use]
pub fn tracked_first_order_gauss_markov(a: f64, k: f64, tau: f64) -> f64 {
    let p = 1.0 / tau;
    let (b0, a2, a1, a0) = (a * (2.0 * p).root(), a + p, a * k + a * p, a * k * p);
    b0 * b0 * a2 / (2.0 * a0 * (a1 * a2 - a0))
}

/// Tracked loop around a second-order rate loop: 1/(2k) / (1 - k/(2 zeta wn)); infinite from k = 2 zeta wn on.
///
/// # Example
/// ```
/// use stillrate_lab::servo::drift::closed_forms::{tracked_first_order, tracked_second_order};
/// assert!((tracked_second_order(1e6, 0.6, 2.0) - tracked_first_order(2.0)).abs() < 1e-6); // a fast rate loop is a perfect one
/// assert_eq!(tracked_second_order(15.0, 0.6, 18.0), f64::INFINITY);
/// ```
#[must_use]
pub fn tracked_second_order(wn: f64, zeta: f64, k: f64) -> f64 {
    let left = 1.0 - k / (2.0 * zeta * wn);
    if left > 0.0 { 1.0 / (2.0 * k * left) } else { f64::INFINITY }
}

/// Lower cut-off (Hz) of a band-limited integral that equals an integrator's variance after `t`: 1/(2 pi^2 t).
///
/// # Example
/// ```
/// use stillrate_lab::servo::drift::closed_forms::equivalent_cutoff_hz;
/// // An integral over a minute gathers what lies above 0.84 mHz.
/// assert!((equivalent_cutoff_hz(60.0) - 8.44e-4).abs() < 1e-6);
/// ```
#[must_use]
pub fn equivalent_cutoff_hz(t: f64) -> f64 {
    1.0 / (2.0 * core::f64::consts::PI * core::f64::consts::PI * t)
}
