//! Gains of recursive least squares of order 2 (level and slope), which have no short closed form.

use stillrate::filters::{RecursiveLeastSquaresSettings, closed_forms};
use stillrate::{ConfigError, Filter, GyroNoise, Sample, Settings};

/// Gains g1 (level, pure) and g2 (slope, a sample) at samples 1 to `count`, from the response of the filter itself to one sample of 1.
///
/// # Errors
/// [`ConfigError`] if the forgetting factor is not above 0 and at most 1.
///
/// # Example
/// ```
/// use stillrate_lab::recursive::gains::order_2_gains;
/// let (level, slope) = order_2_gains(0.9, 500)?;
/// assert_eq!((level[0], slope[0]), (1.0, 0.0)); // the first sample is the level
/// // They settle at 1 - lambda^2 and (1 - lambda)^2.
/// assert!((level[499] - 0.19).abs() < 1e-12 && (slope[499] - 0.01).abs() < 1e-12);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
pub fn order_2_gains(forgetting_factor: f64, count: usize) -> Result<(Vec<f64>, Vec<f64>), ConfigError> {
    let tau_s = closed_forms::tau_samples(forgetting_factor);
    let defaults = RecursiveLeastSquaresSettings::defaults(1.0, GyroNoise::from_density_two_sided(1.0));
    let filter = RecursiveLeastSquaresSettings { order: 2.0, tau_s, forgetting_factor, ..defaults }.build::<f64>()?;
    let mut state = filter.start();
    let gain = |_| {
        // Everything before was zero: what a sample of 1 does to level and slope is the gain.
        let mut trial = state;
        let estimate = filter.step(&mut trial, Sample { value: 1.0, dt: 1.0 });
        filter.step(&mut state, Sample { value: 0.0, dt: 1.0 });
        (estimate.rate, estimate.acceleration)
    };
    Ok((0..count).map(gain).unzip())
}
