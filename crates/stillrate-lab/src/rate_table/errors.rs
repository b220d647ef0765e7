//! Mean squared and mean absolute error: the two figures of the published table.

/// Errors of an estimate.
///
/// # Example
/// ```
/// use stillrate_lab::rate_table::errors::Errors;
/// let offset = Errors::of(&[1.5, 2.5], &[1.0, 2.0]);
/// assert_eq!((offset.mse, offset.mae), (0.25, 0.5)); // of a constant offset the one is the square of the other
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Mean squared error, (deg/s)^2.
    pub mse: f64,
    /// Mean absolute error, deg/s.
    pub mae: f64,
}

impl Errors {
    /// Errors of an estimate, sample by sample; NaN anywhere makes them NaN.
    #[must_use]
    pub fn of(estimate: &[f64], truth: &[f64]) -> Self {
        let n = truth.len() as f64;
        let errors = || estimate.iter().zip(truth).map(|(x, w)| x - w);
        Self { mse: errors().map(|e| e * e).sum::<f64>() / n, mae: errors().map(f64::abs).sum::<f64>() / n }
    }
}
