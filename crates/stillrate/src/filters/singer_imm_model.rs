//! One Singer model of two that interact, as the filter keeps it.

use crate::models::SingerCoefficients;
use crate::plain;
use crate::real::Real;

plain! {
    /// One Singer model of the pair.
    ///
    /// # Example
    /// ```
    /// use stillrate::{GyroNoise, Settings, filters::SingerImmKfSettings, models::SingerCoefficients};
    /// let filter = SingerImmKfSettings::defaults(50.0, GyroNoise::from_density_two_sided(0.015)).build::<f64>()?;
    /// let moving = filter.model[1];
    /// let unit = SingerCoefficients::new(moving.alpha, 0.02);
    /// let intensity = 2.0 * 0.01 * 30.0 * 30.0 / 3.0; // 2 alpha A_max^2 / 3
    /// assert_eq!((moving.step.r, moving.step.s), (unit.r, unit.s));
    /// assert!((moving.step.q22 / (intensity * unit.q22) - 1.0).abs() < 1e-15);
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct SingerImmModel<T> {
        /// Reciprocal time constant, 1/s.
        pub alpha: T,
        /// Coefficients at the nominal period, driving noise included.
        pub step: SingerCoefficients<T>,
        /// Variance of a sample.
        pub measurement_variance: T,
        /// Variances of rate and acceleration at the first sample.
        pub start_variance: [T; 2],
    }
}

impl<T: Real> SingerImmModel<T> {
    /// Coefficients of an unusual time step. Seldom needed, so it stays out of the step's own code.
    #[cfg_attr(not(target_arch = "arm"), inline(never))]
    pub(super) fn over(&self, dt: T) -> SingerCoefficients<T> {
        SingerCoefficients::new(self.alpha, dt).driven_by(self.step.intensity())
    }

    pub(super) const NONE: Self = Self {
        alpha: T::ZERO,
        step: SingerCoefficients { r: T::ZERO, s: T::ZERO, q11: T::ZERO, q12: T::ZERO, q22: T::ZERO },
        measurement_variance: T::ONE,
        start_variance: [T::ONE; 2],
    };
}
