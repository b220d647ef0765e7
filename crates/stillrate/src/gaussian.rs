//! Means and symmetric covariances of small states, the covariance as its packed upper triangle.

use crate::real::Real;
use crate::reals;

reals! {
    /// Rate and acceleration.
    pub struct Gaussian2 {
        /// Mean.
        pub mean: [T; 2],
        /// Covariance 00, 01, 11.
        pub covariance: [T; 3],
    }
}

reals! {
    /// Rate, acceleration and the model's own parameter.
    pub struct Gaussian3 {
        /// Mean.
        pub mean: [T; 3],
        /// Covariance 00, 01, 02, 11, 12, 22.
        pub covariance: [T; 6],
    }
}

reals! {
    /// Rate and its first three derivatives.
    pub struct Gaussian4 {
        /// Mean.
        pub mean: [T; 4],
        /// Covariance 00, 01, 02, 03, 11, 12, 13, 22, 23, 33.
        pub covariance: [T; 10],
    }
}

/// Upper triangle of a b', packed.
#[inline(always)]
pub(crate) fn outer<T: Real>(a: [T; 4], b: [T; 4]) -> [T; 10] {
    [
        a[0] * b[0],
        a[0] * b[1],
        a[0] * b[2],
        a[0] * b[3],
        a[1] * b[1],
        a[1] * b[2],
        a[1] * b[3],
        a[2] * b[2],
        a[2] * b[3],
        a[3] * b[3],
    ]
}
