//! Means and symmetric covariances of small states, the covariance as its packed upper triangle.

use crate::real::Real;
use crate::reals;

reals! {
    /// Rate and acceleration.
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Sample, Settings, filters::SingerKfSettings, gaussian::Gaussian2};
    /// let filter = SingerKfSettings::defaults(50.0, GyroNoise::from_density_two_sided(0.015)).build::<f64>()?;
    /// let mut state = filter.start();
    /// for value in [1.0, 1.2, 1.4] {
    ///     filter.step(&mut state, Sample { value, dt: 0.02 });
    /// }
    /// let Gaussian2 { mean, covariance: [p00, p01, p11] } = state.model;
    /// assert!(mean[1] > 0.0 && p01 > 0.0); // a rate that rises means an acceleration
    /// assert!(p00 * p11 > p01 * p01);
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct Gaussian2 {
        /// Mean.
        pub mean: [T; 2],
        /// Covariance 00, 01, 11.
        pub covariance: [T; 3],
    }
}

reals! {
    /// Rate, acceleration and the model's own parameter.
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Settings, filters::MsImmIkfPaperSettings};
    /// let settings = MsImmIkfPaperSettings::defaults(50.0, GyroNoise::from_density_two_sided(0.015));
    /// let filter = settings.build::<f64>()?;
    /// let [_, moving] = filter.start().model;
    /// assert_eq!(moving.mean, [0.0, 0.0, 0.01]); // rate, acceleration, alpha
    /// let diagonal = [0, 3, 5].map(|k| moving.covariance[k]);
    /// assert_eq!(diagonal[1..], [100.0, 1e-6]);
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct Gaussian3 {
        /// Mean.
        pub mean: [T; 3],
        /// Covariance 00, 01, 02, 11, 12, 22.
        pub covariance: [T; 6],
    }
}

reals! {
    /// Rate and its first three derivatives.
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Settings, filters::MsImmIkfSettings, reals::Lanes};
    /// let filter = MsImmIkfSettings::defaults(50.0, GyroNoise::from_density_two_sided(0.015)).build::<f64>()?;
    /// let oscillator = filter.start().oscillator[0].lane(0);
    /// assert!([0, 4, 7, 9].iter().all(|&k| oscillator.covariance[k] > 0.0)); // the diagonal
    /// assert!([1, 2, 3, 5, 6, 8].iter().all(|&k| oscillator.covariance[k] == 0.0)); // nothing is correlated at the start
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
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
