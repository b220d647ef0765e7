//! Steady-state variance of a rational transfer function driven by white noise: Astrom's recursion.
//!
//! I = 1/(2 pi j) int B(s) B(-s) / (A(s) A(-s)) ds by successive reduction of the degree
//! (K. J. Astrom, Introduction to Stochastic Control Theory, 1970, section 5.3). The a-rows are the Routh table, so
//! an unstable denominator is noticed on the way; O(n^2), no linear algebra.

use super::{DriftError, TransferFunction};

/// Variance of the output for white noise of two-sided density 1 (per Hz): int |H(j 2 pi f)|^2 df.
///
/// # Errors
/// Improper, unstable (naming the Routh row), or a pole at 0 that is excited.
///
/// # Example
/// ```
/// use stillrate_lab::servo::drift::{TransferFunction, steady_state};
/// // A first-order lag a/(s+a) passes a/2.
/// let lag = TransferFunction::new(&[6.0], &[1.0, 6.0]).unwrap();
/// assert_eq!(steady_state(&lag).unwrap(), 3.0);
/// ```
pub fn steady_state(h: &TransferFunction) -> Result<f64, DriftError> {
    let h = h.without_common_zeros_at_origin();
    h.check_proper()?;
    if h.order() > 0 && h.denominator.last() == Some(&0.0) {
        return Err(DriftError::NeedsTime);
    }
    let mut a = h.denominator.clone();
    let mut b = vec![0.0; h.order() - h.numerator.len()];
    b.extend_from_slice(&h.numerator);
    let mut integral = 0.0;
    let mut row = 1;
    while a.len() > 1 {
        let pivot = a[1];
        if pivot.is_nan() || pivot <= 0.0 {
            return Err(DriftError::Unstable { row, entry: pivot });
        }
        let (alpha, beta) = (a[0] / pivot, b[0] / pivot);
        integral += beta * beta / (2.0 * alpha);
        (a, b) = reduce(&a, &b, alpha, beta);
        row += 1;
    }
    Ok(integral)
}

/// One row of the Routh table, and the numerator that goes with it.
fn reduce(a: &[f64], b: &[f64], alpha: f64, beta: f64) -> (Vec<f64>, Vec<f64>) {
    let n = a.len() - 1;
    let beyond = |i: usize| if i < a.len() { a[i] } else { 0.0 };
    let next_a = (0..n).map(|i| if i % 2 == 0 { a[i + 1] } else { a[i + 1] - alpha * beyond(i + 2) }).collect();
    // b[i] stands at power n-1-i; beta times the odd part of A cancels its first entry.
    let next_b = (0..n - 1).map(|i| if i % 2 == 0 { b[i + 1] } else { b[i + 1] - beta * beyond(i + 2) }).collect();
    (next_a, next_b)
}
