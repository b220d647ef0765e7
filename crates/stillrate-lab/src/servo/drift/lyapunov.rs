//! Steady-state variance by the Lyapunov equation A P + P A' + b b' = 0: a linear system for the upper triangle of P.
//!
//! The textbook way, kept as an independent check of [`steady_state`](super::steady_state). A is the companion matrix
//! in scaled time, so that its entries stay near 1.

use nalgebra::{DMatrix, DVector};

use super::state_space::StateSpace;
use super::{DriftError, TransferFunction, astrom};

/// Variance of the output for white noise of two-sided density 1, from the Lyapunov equation.
///
/// # Errors
/// As [`steady_state`](super::steady_state).
///
/// # Example
/// ```
/// use stillrate_lab::servo::drift::{TransferFunction, lyapunov};
/// let lag = TransferFunction::new(&[6.0], &[1.0, 6.0]).unwrap();
/// assert!((lyapunov::steady_state(&lag).unwrap() - 3.0).abs() < 1e-14);
/// ```
pub fn steady_state(h: &TransferFunction) -> Result<f64, DriftError> {
    let h = h.without_common_zeros_at_origin();
    astrom::steady_state(&h)?;
    let system = StateSpace::of(&h)?;
    let p = covariance(&system.a, &system.input_noise())
        .ok_or(DriftError::BadPolynomial("the Lyapunov equation is singular: two poles are mirror images"))?;
    Ok(system.output_variance(&p))
}

/// Solves A P + P A' + W = 0 for symmetric P; `None` where the equation is singular.
fn covariance(a: &DMatrix<f64>, w: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let n = a.nrows();
    let slot = |i: usize, j: usize| {
        let (low, high) = (i.min(j), i.max(j));
        low * n - low * (low + 1) / 2 + high
    };
    let unknowns = n * (n + 1) / 2;
    let mut matrix = DMatrix::<f64>::zeros(unknowns, unknowns);
    let mut right = DVector::<f64>::zeros(unknowns);
    for i in 0..n {
        for j in i..n {
            let row = slot(i, j);
            for k in 0..n {
                matrix[(row, slot(k, j))] += a[(i, k)];
                matrix[(row, slot(i, k))] += a[(j, k)];
            }
            right[row] = -w[(i, j)];
        }
    }
    // Full pivoting: the companion form of high order is badly scaled even in scaled time.
    let solution = matrix.full_piv_lu().solve(&right)?;
    Some(DMatrix::from_fn(n, n, |i, j| solution[slot(i, j)]))
}
