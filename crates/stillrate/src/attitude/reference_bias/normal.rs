//! Normal equations of a chain of intervals whose errors are correlated with their neighbours', in constant memory.
//!
//! Block elimination of V: with S the innovation covariance of an interval given the ones before, a whitened row is
//! a_(i+1) - L a_i, L = V_(i+1,i) S_i^-1, S_(i+1) = V_(i+1,i+1) - L V_(i,i+1).

use nalgebra::{Matrix3, SMatrix, Vector3};

use super::UNKNOWNS;
use crate::attitude::dcm::{cofactors, determinant};
use crate::attitude::so3::dot;
use crate::real::Real;

type Rows<T> = SMatrix<T, 3, UNKNOWNS>;

/// One interval, linearised.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interval<T> {
    /// d(residual)/d(unknowns), with the sign such that a step takes it off.
    pub(super) rows: Rows<T>,
    /// Residual, rad.
    pub(super) residual: Vector3<T>,
    /// X: reference rotation in sensor axes.
    pub(super) turn: Matrix3<T>,
    /// Duration, s.
    pub(super) time_s: T,
}

/// A' V^-1 A, A' V^-1 r and r' V^-1 r, growing interval by interval.
#[derive(Clone, Copy, Debug)]
pub(super) struct Normal<T> {
    pub(super) matrix: SMatrix<T, UNKNOWNS, UNKNOWNS>,
    pub(super) right: SMatrix<T, UNKNOWNS, 1>,
    pub(super) chi_square: T,
    pub(super) intervals: usize,
    walk2: T,
    sigma2: T,
    before: Option<(Matrix3<T>, Rows<T>, Vector3<T>)>,
}

fn inverse<T: Real>(m: &Matrix3<T>) -> Matrix3<T> {
    cofactors(m).transpose() * (T::ONE / determinant(m))
}

impl<T: Real> Normal<T> {
    /// Nothing yet; variances of walk (rad^2/s) and of a fix (rad^2).
    pub(super) fn new(walk2: T, sigma2: T) -> Self {
        Self {
            matrix: SMatrix::zeros(),
            right: SMatrix::zeros(),
            chi_square: T::ZERO,
            intervals: 0,
            walk2,
            sigma2,
            before: None,
        }
    }

    /// Adds the interval that follows the one before.
    pub(super) fn add(&mut self, interval: &Interval<T>) {
        let mut rows = interval.rows;
        let mut residual = interval.residual;
        let own = self.walk2 * interval.time_s + T::TWO * self.sigma2;
        let mut covariance = Matrix3::identity() * own;
        if let Some((inverse_before, rows_before, residual_before)) = self.before {
            // Cov(this, before) = -sigma^2 X'
            let shared = interval.turn.transpose() * (-self.sigma2);
            let from_before = shared * inverse_before;
            rows -= from_before * rows_before;
            residual -= from_before * residual_before;
            covariance -= from_before * shared.transpose();
        }
        let information = inverse(&covariance);
        let weighted = information * rows;
        self.matrix += rows.transpose() * weighted;
        self.right += weighted.transpose() * residual;
        self.chi_square += dot(&residual, &(information * residual));
        self.before = Some((information, rows, residual));
        self.intervals += 1;
    }

    /// The next interval does not touch the last one.
    pub(super) fn cut(&mut self) {
        self.before = None;
    }
}
