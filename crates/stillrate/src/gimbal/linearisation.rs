//! Where a linear filter or a batch solution stands: attitude at the start as a rotation, coefficients by addition.

use nalgebra::{Matrix3, Vector3};

use super::coefficients::Coefficients;
use super::rotation::{exponential, logarithm};

/// Point of linearisation: attitude at the start and coefficients.
///
/// # Example
/// ```
/// use stillrate::gimbal::{COUNT, Linearisation};
/// let mut all = [0.0; COUNT];
/// all[1] = 1e-4; // 0.1 mrad about y
/// let point = Linearisation::of(&all);
/// assert!((point.rotation[(2, 0)] - 1e-4).abs() < 1e-12); // exp(-[phi x])
/// assert!((point.coefficients()[1] - 1e-4).abs() < 1e-18);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linearisation {
    /// R at the start.
    pub rotation: Matrix3<f64>,
    /// Coefficients (attitude entries unused).
    pub coefficients: Coefficients,
}

impl Linearisation {
    /// The point that a full set of coefficients names: R = exp(-[phi x]).
    #[must_use]
    pub fn of(coefficients: &Coefficients) -> Self {
        let phi = Vector3::new(-coefficients[0], -coefficients[1], -coefficients[2]);
        Self { rotation: exponential(&phi), coefficients: *coefficients }
    }

    /// The full set of coefficients, attitude at the start included.
    #[must_use]
    pub fn coefficients(&self) -> Coefficients {
        let mut all = self.coefficients;
        let phi = -logarithm(&self.rotation);
        all[..3].copy_from_slice(phi.as_slice());
        all
    }
}
