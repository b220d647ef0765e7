//! A transfer function as a system of first order, in a time in which its coefficients are near 1.

use nalgebra::{DMatrix, DVector};
use stillrate::Real;

use super::{DriftError, TransferFunction};

/// A transfer function as x' = A x + b u, y = c x, in scaled time t' = t `time_scale`.
#[derive(Clone, Debug)]
pub(crate) struct StateSpace {
    /// Companion matrix.
    pub(crate) a: DMatrix<f64>,
    /// Input column.
    pub(crate) b: DVector<f64>,
    /// Output row.
    pub(crate) c: DVector<f64>,
    /// Scaled seconds in a second (a power of two): brings the coefficients near 1.
    pub(crate) time_scale: f64,
}

impl StateSpace {
    /// Companion form; refuses a transfer function that is not strictly proper.
    pub(crate) fn of(h: &TransferFunction) -> Result<Self, DriftError> {
        h.check_proper()?;
        let n = h.order();
        let scale = time_scale(&h.denominator);
        let lead = h.denominator[0];
        let mut a = DMatrix::zeros(n, n);
        let mut power = 1.0;
        for i in 0..n {
            power *= scale;
            a[(0, i)] = -h.denominator[i + 1] / lead / power;
            if i > 0 {
                a[(i, i - 1)] = 1.0;
            }
        }
        let mut c = DVector::zeros(n);
        let offset = n - h.numerator.len();
        let mut power = 1.0;
        for i in 0..n {
            // H(s) = H(scale s'): a numerator entry at power n-1-i has lost i+1 powers against the leading s'^n.
            power *= scale;
            if i >= offset {
                c[i] = h.numerator[i - offset] / lead / power;
            }
        }
        let mut b = DVector::zeros(n);
        if n > 0 {
            b[0] = 1.0;
        }
        Ok(Self { a, b, c, time_scale: scale })
    }

    /// b b': what white noise of density 1 at the input does to the state.
    pub(crate) fn input_noise(&self) -> DMatrix<f64> {
        &self.b * self.b.transpose()
    }

    /// Variance of y for a state covariance that was driven by white noise of density 1 per second of scaled time.
    pub(crate) fn output_variance(&self, p: &DMatrix<f64>) -> f64 {
        // Unit density in real time is density `time_scale` in scaled time.
        (self.c.transpose() * p * &self.c)[(0, 0)] * self.time_scale
    }
}

/// Largest |a_i / a_0|^(1/i), rounded down to a power of two so that scaling is exact.
fn time_scale(denominator: &[f64]) -> f64 {
    let mut largest = 0.0_f64;
    for (i, c) in denominator.iter().enumerate().skip(1) {
        if *c != 0.0 {
            largest = largest.max(((c / denominator[0]).abs().logarithm() / i as f64).exponential());
        }
    }
    let mut scale = 1.0;
    while scale * 2.0 <= largest && scale < 1e30 {
        scale *= 2.0;
    }
    while scale > largest && largest > 0.0 && scale > 1e-30 {
        scale *= 0.5;
    }
    scale
}
