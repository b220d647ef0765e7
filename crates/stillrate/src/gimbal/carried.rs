//! What became of errors of the start: psi_t = Phi_t psi_0 + B_t theta for an attitude error psi and coefficients' errors theta.
//!
//! The filters estimate (psi_0, theta), which never change: a prediction carries the three rows [Phi, B] and leaves the covariance alone,
//! a measurement row h_psi on the attitude of its epoch becomes h_psi [Phi, B]. It is the Kalman filter of (psi_t, theta) in other
//! coordinates, exactly. A random walk of the attitude is the same one in these coordinates, since Phi is a rotation and the walk has no
//! preferred direction. All in numbers divided by their prior deviations.

use nalgebra::{Matrix3, Vector3};

use super::motion::Turning;
use super::selection::Selection;

/// The rows [Phi, B], scaled.
///
/// # Example
/// ```
/// use stillrate::gimbal::Carried;
/// let mut carried = Carried::<4>::unit();
/// carried.rows[0][3] += 0.25; // a step in which number 3, a drift, turned the platform about x
/// carried.turn(&[[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]); // and a quarter turn about z: x becomes y
/// let now = carried.now(&[0.0, 1.0, 0.0, 2.0]); // errors of the start about y, and of the drift
/// assert_eq!([now.x, now.y, now.z], [-1.0, 0.5, 0.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carried<const N: usize> {
    /// d(attitude error now)/d(number), one row an axis.
    pub rows: [[f64; N]; 3],
}

impl<const N: usize> Carried<N> {
    /// Before the first step: the attitude error is the one of the start.
    #[must_use]
    pub fn unit() -> Self {
        Self { rows: core::array::from_fn(|r| core::array::from_fn(|at| if at == r { 1.0 } else { 0.0 })) }
    }

    /// Turns the attitude errors: rows <- `transition` (scaled, by columns) rows.
    #[inline(always)]
    pub fn turn(&mut self, transition: &[[f64; 3]; 3]) {
        let [x, y, z] = &mut self.rows;
        for ((x, y), z) in x.iter_mut().zip(y).zip(z) {
            let (a, b, c) = (*x, *y, *z);
            *x = transition[0][0] * a + transition[1][0] * b + transition[2][0] * c;
            *y = transition[0][1] * a + transition[1][1] * b + transition[2][1] * c;
            *z = transition[0][2] * a + transition[1][2] * b + transition[2][2] * c;
        }
    }

    /// Adds what the coefficients' errors did in a step: `turning` in SI units times `weight` (scale of coefficient over scale of attitude).
    #[inline(always)]
    pub(super) fn add(&mut self, turning: &Turning, selection: &Selection<N>, weight: &[[f64; N]; 3]) {
        for (at, &index) in selection.indices().iter().enumerate().take(selection.turning()).skip(3) {
            if let Some(column) = turning.get(index) {
                for r in 0..3 {
                    self.rows[r][at] += column[r] * weight[r][at];
                }
            }
        }
    }

    /// Attitude error now (scaled) that errors of the start and of the coefficients make.
    #[must_use]
    #[inline(always)]
    pub fn now(&self, errors: &[f64; N]) -> Vector3<f64> {
        let sum = |row: &[f64; N]| row.iter().zip(errors).fold(0.0, |sum, (r, e)| sum + r * e);
        Vector3::new(sum(&self.rows[0]), sum(&self.rows[1]), sum(&self.rows[2]))
    }
}

/// Phi in scaled numbers, by columns.
#[inline(always)]
pub(super) fn scaled_transition(transition: &Matrix3<f64>, scaled: [f64; 3]) -> [[f64; 3]; 3] {
    let columns = &transition.data.0;
    core::array::from_fn(|c| core::array::from_fn(|r| columns[c][r] * (scaled[c] / scaled[r])))
}
