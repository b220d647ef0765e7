//! Whether a given matrix is a rotation, and the nearest rotation to one that nearly is.
//!
//! A direction cosine matrix printed with four digits is off by .001 deg, which costs .4 deg/h of bias over ten
//! seconds: rounded input is projected first, anything worse is refused. The projection is the polar factor, by Newton's
//! iteration C <- (C + C^-T)/2 (Higham, SIAM J. Sci. Stat. Comput. 7, 1986): the same matrix as U V' of the
//! singular value decomposition, with quadratic convergence and fixed size.

use nalgebra::Matrix3;

use crate::error::ConfigError;
use crate::real::Real;

/// Largest entry of |C'C - I| that passes for a rotation without projection.
pub const ORTHONORMALITY_TOLERANCE: f64 = 1e-6;

/// Determinant of a 3x3 matrix.
///
/// # Example
/// ```
/// use nalgebra::Matrix3;
/// use stillrate::attitude::dcm::determinant;
/// assert_eq!(determinant(&(Matrix3::<f64>::identity() * 2.0)), 8.0);
/// ```
#[inline]
pub fn determinant<T: Real>(c: &Matrix3<T>) -> T {
    c[(0, 0)] * (c[(1, 1)] * c[(2, 2)] - c[(1, 2)] * c[(2, 1)])
        - c[(0, 1)] * (c[(1, 0)] * c[(2, 2)] - c[(1, 2)] * c[(2, 0)])
        + c[(0, 2)] * (c[(1, 0)] * c[(2, 1)] - c[(1, 1)] * c[(2, 0)])
}

/// Matrix of cofactors: the determinant times the inverse transposed.
///
/// # Example
/// ```
/// use nalgebra::Matrix3;
/// use stillrate::attitude::dcm::{cofactors, determinant};
/// let c = Matrix3::new(2.0, 1.0, 0.0, 0.0, 3.0, 1.0, 1.0, 0.0, 1.0_f64);
/// let inverse = cofactors(&c).transpose() / determinant(&c);
/// assert!((c * inverse - Matrix3::identity()).amax() < 1e-15);
/// ```
#[inline]
pub fn cofactors<T: Real>(c: &Matrix3<T>) -> Matrix3<T> {
    let m = |i: usize, j: usize| c[(i, j)];
    Matrix3::new(
        m(1, 1) * m(2, 2) - m(1, 2) * m(2, 1),
        m(1, 2) * m(2, 0) - m(1, 0) * m(2, 2),
        m(1, 0) * m(2, 1) - m(1, 1) * m(2, 0),
        m(0, 2) * m(2, 1) - m(0, 1) * m(2, 2),
        m(0, 0) * m(2, 2) - m(0, 2) * m(2, 0),
        m(0, 1) * m(2, 0) - m(0, 0) * m(2, 1),
        m(0, 1) * m(1, 2) - m(0, 2) * m(1, 1),
        m(0, 2) * m(1, 0) - m(0, 0) * m(1, 2),
        m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0),
    )
}

/// Largest entry of |C'C - I|; NaN where an entry is not finite.
///
/// # Example
/// ```
/// use nalgebra::Matrix3;
/// use stillrate::attitude::dcm::orthonormality_error;
/// assert_eq!(orthonormality_error(&Matrix3::<f64>::identity()), 0.0);
/// assert_eq!(orthonormality_error(&(Matrix3::<f64>::identity() * 2.0)), 3.0);
/// ```
pub fn orthonormality_error<T: Real>(c: &Matrix3<T>) -> T {
    let excess = c.transpose() * c - Matrix3::identity();
    let mut worst = T::ZERO;
    for &entry in excess.iter() {
        if !entry.finite() {
            return T::of(f64::NAN);
        }
        worst = worst.most(entry.magnitude());
    }
    worst
}

/// Passes a matrix on if it is a proper rotation: finite, |C'C - I| <= 1e-6 (in `f32` 1e-5), determinant above 0.
///
/// # Errors
/// [`ConfigError`] with the orthonormality error or the determinant otherwise.
///
/// # Example
/// ```
/// use nalgebra::Matrix3;
/// use stillrate::attitude::check_dcm;
/// assert!(check_dcm(&Matrix3::<f64>::identity()).is_ok());
/// assert!(check_dcm(&(-Matrix3::<f64>::identity())).is_err()); // a reflection
/// ```
pub fn check_dcm<T: Real>(c: &Matrix3<T>) -> Result<Matrix3<T>, ConfigError> {
    let tolerance = T::of(ORTHONORMALITY_TOLERANCE).most(T::of(64.0) * T::EPSILON);
    within(c, tolerance, "finite and <= 1e-6 (project a rounded matrix first)")
}

fn within<T: Real>(c: &Matrix3<T>, tolerance: T, range: &'static str) -> Result<Matrix3<T>, ConfigError> {
    let error = orthonormality_error(c);
    if error > tolerance || !error.finite() {
        return Err(ConfigError::new("orthonormality error |C'C - I| of a rotation matrix", error.widen(), "", range));
    }
    let determinant = determinant(c);
    if determinant > T::ZERO {
        Ok(*c)
    } else {
        Err(ConfigError::new("determinant of a rotation matrix", determinant.widen(), "", "above 0 (a reflection)"))
    }
}

/// Largest orthonormality error that [`project_to_rotation`] takes for rounding rather than for a mistake.
pub const PROJECTION_TOLERANCE: f64 = 1e-2;

/// The rotation nearest to a rounded rotation matrix (Frobenius norm).
///
/// # Errors
/// [`ConfigError`] where the matrix is not finite, further than [`PROJECTION_TOLERANCE`] from orthonormal, or a reflection.
///
/// # Example
/// ```
/// use nalgebra::Matrix3;
/// use stillrate::attitude::{check_dcm, project_to_rotation};
/// let rounded = Matrix3::new(0.94, -0.342, 0.0, 0.342, 0.94, 0.0, 0.0, 0.0, 1.0);
/// assert!(check_dcm(&rounded).is_err());
/// assert!(check_dcm(&project_to_rotation(&rounded).unwrap()).is_ok());
/// ```
pub fn project_to_rotation<T: Real>(c: &Matrix3<T>) -> Result<Matrix3<T>, ConfigError> {
    let mut nearest = within(c, T::of(PROJECTION_TOLERANCE), "finite and <= 0.01 to be projected")?;
    // From an error of .01 quadratic convergence needs 2e-5, 6e-11, 1e-21.
    for _ in 0..4 {
        let inverse_transposed = cofactors(&nearest) * (T::ONE / determinant(&nearest));
        nearest = (nearest + inverse_transposed) * T::HALF;
    }
    Ok(nearest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::attitude::so3;
    use nalgebra::Vector3;

    #[test]
    fn refuses_what_is_not_a_rotation() {
        let mut c = so3::exp(&Vector3::new(0.1, 0.2, 0.3));
        c[(0, 0)] += 1e-5;
        assert!(check_dcm(&c).is_err());
        c[(1, 2)] = f64::NAN;
        let error = check_dcm(&c).unwrap_err();
        assert!(error.value.is_nan());
        assert!(project_to_rotation(&c).is_err());
        assert!(project_to_rotation(&(so3::exp(&Vector3::new(0.1, 0.2, 0.3)) * 1.1)).is_err());
    }

    #[test]
    fn projection_matches_the_singular_value_decomposition() {
        let exact = so3::exp(&Vector3::new(0.4, -1.2, 2.0));
        let rounded = exact.map(|entry: f64| (entry * 1e4).round() / 1e4);
        let svd = rounded.svd(true, true);
        let best = svd.u.unwrap() * svd.v_t.unwrap();
        let ours = project_to_rotation(&rounded).unwrap();
        assert!((ours - best).amax() < 1e-14);
        // Rounding to four digits turns by about a thousandth of a degree.
        let turn = so3::log(&(exact.transpose() * ours));
        assert!(so3::squared(&turn).root().to_degrees() < 0.005);
    }
}
