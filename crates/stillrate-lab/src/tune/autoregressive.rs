//! Autoregressive models of a record: Yule-Walker, Burg, and the order by Akaike's criterion.
//!
//! x_k = phi_1 x_(k-1) + ... + phi_p x_(k-p) + w_k after the mean is taken off. Yule-Walker solves the normal equations of
//! the biased autocovariance by the Levinson-Durbin recursion; J. P. Burg ("Maximum entropy spectral analysis", 1975) picks each reflection
//! coefficient to minimise the forward and backward prediction errors together, which is sharper on short records. Both give
//! stationary models. H. Akaike (1974): the order p that minimises n ln(variance of w) + 2 p.

use std::fmt;

use stillrate::Real;

use super::reflection::{autocovariance, burg, levinson};

/// An autoregressive model fitted to a record.
///
/// # Example
/// ```
/// use stillrate_lab::{random::Random, tune::autoregressive::{Estimator, fit}};
/// let white = Random::new(1, 0).normals(4000);
/// let [one, six] = [1, 6].map(|order| fit(&white, order, Estimator::Burg).unwrap());
/// assert!(six.process_variance < one.process_variance); // more terms always explain a little more
/// assert!(six.akaike() > one.akaike()); // but not enough to be worth them
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct AutoregressiveFit {
    /// phi_1 ... phi_p.
    pub coefficients: Vec<f64>,
    /// Variance of the driving noise w, in the square of the record's unit.
    pub process_variance: f64,
    /// Mean of the record.
    pub mean: f64,
    /// Number of samples.
    pub count: usize,
}

impl AutoregressiveFit {
    /// Akaike's criterion up to a constant: n ln(variance) + 2 p; the smaller the better.
    #[must_use]
    pub fn akaike(&self) -> f64 {
        self.count as f64 * self.process_variance.logarithm() + 2.0 * self.coefficients.len() as f64
    }
}

/// Which of the two estimators.
///
/// # Example
/// ```
/// use stillrate_lab::tune::autoregressive::{Estimator, fit};
/// let sine: Vec<f64> = (0..40).map(|k| (0.5 * f64::from(k)).sin()).collect();
/// // x_k = 2 cos(0.5) x_(k-1) - x_(k-2): short records bias the autocovariance, Burg's form hardly.
/// let error = |estimator| (fit(&sine, 2, estimator).unwrap().coefficients[1] + 1.0).abs();
/// assert!(10.0 * error(Estimator::Burg) < error(Estimator::YuleWalker));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Estimator {
    /// Autocovariance and Levinson-Durbin.
    YuleWalker,
    /// Burg's reflection coefficients.
    Burg,
}

/// Why a record cannot be fitted.
///
/// # Example
/// ```
/// use stillrate_lab::tune::autoregressive::{Estimator, FitError, fit};
/// assert_eq!(fit(&[1.0; 100], 2, Estimator::Burg), Err(FitError::NoVariation));
/// let short = fit(&[1.0, 2.0], 2, Estimator::Burg).unwrap_err();
/// assert_eq!(short.to_string(), "2 samples are too few for order 2 (must be at least 6)");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FitError {
    /// Fewer samples than twice the order plus two.
    TooShort {
        /// Samples given.
        count: usize,
        /// Order asked for.
        order: usize,
    },
    /// A sample is NaN or infinite: its index.
    NotFinite(usize),
    /// The record does not vary, or an exact model leaves nothing to fit.
    NoVariation,
    /// The order is zero.
    NoOrder,
}

impl fmt::Display for FitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooShort { count, order } => {
                write!(f, "{count} samples are too few for order {order} (must be at least {})", 2 * order + 2)
            }
            Self::NotFinite(index) => write!(f, "sample {index} is not finite (fill or cut missing samples first)"),
            Self::NoVariation => f.write_str("the record does not vary enough for a model of this order"),
            Self::NoOrder => f.write_str("order = 0 (must be at least 1)"),
        }
    }
}

impl std::error::Error for FitError {}

/// Fits a model of a given order.
///
/// # Errors
/// [`FitError`] if the record is too short, not finite or without variation.
///
/// # Example
/// ```
/// use stillrate_lab::tune::autoregressive::{Estimator, fit};
/// let record: Vec<f64> = (0..200).map(|k| [1.0, 0.9, -1.0, -0.8][k % 4]).collect();
/// let model = fit(&record, 2, Estimator::Burg).unwrap();
/// assert!((model.coefficients[1] + 1.0).abs() < 0.05); // a period of four: x_k = -x_(k-2)
/// ```
pub fn fit(samples: &[f64], order: usize, estimator: Estimator) -> Result<AutoregressiveFit, FitError> {
    let mut fits = fits(samples, order, estimator)?;
    fits.pop().ok_or(FitError::NoOrder)
}

/// Fits all orders from 1 to `highest_order` and returns the one with the smallest Akaike criterion.
///
/// # Errors
/// [`FitError`] as for [`fit`].
///
/// # Example
/// ```
/// use stillrate::{GyroNoise, Settings, filters::ArKfSettings};
/// use stillrate_lab::{random::Random, tune::autoregressive::{Estimator, fit_by_akaike}};
/// let mut random = Random::new(1, 0);
/// let mut x = 0.0;
/// let signal: Vec<f64> = (0..4000).map(|_| { x = 0.9 * x + random.normal(); x }).collect();
/// let model = fit_by_akaike(&signal, 8, Estimator::Burg).unwrap();
/// assert!((model.coefficients[0] - 0.9).abs() < 0.05);
/// let mut settings = ArKfSettings::defaults(50.0, GyroNoise::from_density_two_sided(0.01));
/// (settings.order, settings.process_variance_dps2) = (model.coefficients.len(), model.process_variance);
/// settings.coefficients[..settings.order].copy_from_slice(&model.coefficients);
/// assert!(settings.build::<f64>().is_ok()); // Burg's models are stationary, as the filter demands
/// ```
pub fn fit_by_akaike(
    samples: &[f64],
    highest_order: usize,
    estimator: Estimator,
) -> Result<AutoregressiveFit, FitError> {
    let best = fits(samples, highest_order, estimator)?.into_iter().min_by(|a, b| a.akaike().total_cmp(&b.akaike()));
    best.ok_or(FitError::NoOrder)
}

/// The models of every order up to the highest: both recursions pass through all of them.
fn fits(samples: &[f64], order: usize, estimator: Estimator) -> Result<Vec<AutoregressiveFit>, FitError> {
    let count = samples.len();
    if order == 0 {
        return Err(FitError::NoOrder);
    }
    if count < 2 * order + 2 {
        return Err(FitError::TooShort { count, order });
    }
    if let Some(index) = samples.iter().position(|sample| !sample.is_finite()) {
        return Err(FitError::NotFinite(index));
    }
    let mean = samples.iter().sum::<f64>() / count as f64;
    let deviations: Vec<f64> = samples.iter().map(|sample| sample - mean).collect();
    let models = match estimator {
        Estimator::YuleWalker => levinson(&autocovariance(&deviations, order)),
        Estimator::Burg => burg(&deviations, order),
    };
    let finish = |(coefficients, process_variance)| AutoregressiveFit { coefficients, process_variance, mean, count };
    Ok(models.ok_or(FitError::NoVariation)?.into_iter().map(finish).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    fn second_order(seed: u64, count: usize) -> Vec<f64> {
        let mut random = Random::new(seed, 0);
        let (mut newer, mut older) = (0.0, 0.0);
        let mut next = || {
            (newer, older) = (1.2 * newer - 0.5 * older + 0.3 * random.normal(), newer);
            newer
        };
        (0..count + 100).map(|_| next()).skip(100).collect()
    }

    #[test]
    fn both_estimators_recover_a_known_model() {
        let record = second_order(1, 40_000);
        for estimator in [Estimator::YuleWalker, Estimator::Burg] {
            let model = fit(&record, 2, estimator).unwrap();
            // Standard error of either coefficient: sqrt((1 - phi_2^2) / n) = 0.0043; four of them.
            assert!((model.coefficients[0] - 1.2).abs() < 0.0173, "{model:?}");
            assert!((model.coefficients[1] + 0.5).abs() < 0.0173, "{model:?}");
            // Relative standard error of a variance: sqrt(2 / n) = 0.0071.
            assert!((model.process_variance / 0.09 - 1.0).abs() < 0.0283, "{model:?}");
        }
    }

    #[test]
    fn the_recursion_solves_the_normal_equations() {
        let record = second_order(2, 300);
        let model = fit(&record, 5, Estimator::YuleWalker).unwrap();
        let deviations: Vec<f64> = record.iter().map(|x| x - model.mean).collect();
        let c = autocovariance(&deviations, 5);
        for i in 1..=5_usize {
            let left: f64 = (1..=5_usize).map(|j| model.coefficients[j - 1] * c[i.abs_diff(j)]).sum();
            assert!((left - c[i]).abs() < 1e-13 * c[0], "row {i}");
        }
        let explained: f64 = (1..=5).map(|j| model.coefficients[j - 1] * c[j]).sum();
        assert!((model.process_variance - (c[0] - explained)).abs() < 1e-13 * c[0]);
    }

    #[test]
    fn akaike_picks_the_true_order_or_little_more() {
        for seed in 0..10 {
            let order = fit_by_akaike(&second_order(seed, 2000), 8, Estimator::Burg).unwrap().coefficients.len();
            assert!(order >= 2, "order {order} for seed {seed}");
        }
        // The criterion overfits with a probability of about 0.29 for one true order; most records must get it right.
        let right = (0..40)
            .filter(|&seed| {
                fit_by_akaike(&second_order(seed, 2000), 8, Estimator::Burg).unwrap().coefficients.len() == 2
            })
            .count();
        assert!(right >= 20, "{right} of 40");
    }

    #[test]
    fn white_noise_gets_the_lowest_order_and_a_coefficient_of_nothing() {
        let model = fit_by_akaike(&Random::new(7, 0).normals(3000), 6, Estimator::YuleWalker).unwrap();
        assert_eq!(model.coefficients.len(), 1);
        // Four standard errors of 1 / sqrt(n).
        assert!(model.coefficients[0].abs() < 4.0 / 3000_f64.root());
    }

    #[test]
    fn records_that_cannot_be_fitted_are_refused() {
        assert_eq!(fit(&[1.0; 100], 2, Estimator::Burg), Err(FitError::NoVariation));
        assert_eq!(fit(&[1.0; 100], 2, Estimator::YuleWalker), Err(FitError::NoVariation));
        assert_eq!(fit(&[1.0, f64::NAN, 2.0, 3.0], 1, Estimator::Burg), Err(FitError::NotFinite(1)));
        let short = fit(&[1.0, 2.0], 2, Estimator::Burg).unwrap_err();
        assert_eq!(short.to_string(), "2 samples are too few for order 2 (must be at least 6)");
        assert_eq!(fit(&[1.0; 100], 0, Estimator::Burg), Err(FitError::NoOrder));
    }
}
