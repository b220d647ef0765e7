//! What the recursive filters share: which coefficients, their scales, and the passage from SI derivatives to the scaled square root.
//!
//! Inside, every number is divided by its prior standard deviation, so the prior covariance is the identity and `f32` suffices for the
//! square root. Attitude, coefficients and residuals stay in `f64` whatever `T` is: an attitude error of 1e-7 rad matters.

use nalgebra::{Matrix3, Vector3};

use super::coefficients::{
    COUNT, Coefficients, FORCE_ABOUT_OUTPUT, FORCE_ABOUT_PENDULOUS, FORCE_BIAS, FORCE_QUADRATIC, FORCE_SCALE, LATENCY,
    NAMES, Selection,
};
use super::factor::Factor;
use super::model::{Model, Row, Turning};
use crate::error::{ConfigError, not_negative};
use crate::real::Real;

/// Checked settings of the recursive filters; `T` is the number of the square root, `N` its capacity.
///
/// # Example
/// ```
/// use stillrate::gimbal::{DEFAULT_SCALE, Estimator, Gauge, Model, Options, Selection};
/// let selection = Selection::<30>::new(Gauge::Accelerometer, Options::default()).unwrap();
/// let estimator = Estimator::<f64, 30>::new(Model::new(9.8, 0.7).unwrap(), selection, &DEFAULT_SCALE, 0.0).unwrap();
/// assert_eq!(estimator.selection.count(), 30);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimator<T, const N: usize> {
    /// The place and the instruments.
    pub model: Model,
    /// The estimated coefficients.
    pub selection: Selection<N>,
    /// Prior standard deviations.
    pub scale: Coefficients,
    /// Random walk of the attitude, rad/sqrt(s).
    pub attitude_walk: f64,
    /// Fit the windows with the robust line.
    pub robust: bool,
    /// Epochs with an input axis nearer to the horizontal than this are not used, rad; 0: all are.
    pub cut_off_rad: f64,
    scaled: [f64; N],
    number: core::marker::PhantomData<T>,
}

/// Innovation of one scalar measurement, m/s^2.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Innovation {
    /// Measured minus predicted.
    pub value: f64,
    /// Its variance as the filter believes it; 0 where there was no measurement.
    pub variance: f64,
}

impl Innovation {
    /// Squared innovation over its variance; 0 where there was no measurement.
    #[must_use]
    pub fn normalised_squared(&self) -> f64 {
        if self.variance > 0.0 { self.value * self.value / self.variance } else { 0.0 }
    }
}

impl<T: Real, const N: usize> Estimator<T, N> {
    /// Settings with the given prior standard deviations and attitude random walk (deg/sqrt(h), 0 for none).
    ///
    /// # Errors
    /// [`ConfigError`] if a scale of an estimated coefficient is not positive, or the random walk is negative.
    pub fn new(
        model: Model,
        selection: Selection<N>,
        scale: &Coefficients,
        angle_random_walk_deg_sqrt_h: f64,
    ) -> Result<Self, ConfigError> {
        not_negative("angle_random_walk_deg_sqrt_h", angle_random_walk_deg_sqrt_h, "deg/sqrt(h)")?;
        let mut scaled = [1.0; N];
        for (slot, &index) in scaled.iter_mut().zip(selection.indices()) {
            if !(scale[index].finite() && scale[index] > 0.0) {
                return Err(ConfigError::new(NAMES[index], scale[index], "", "a finite positive standard deviation"));
            }
            *slot = scale[index];
        }
        Ok(Self {
            model,
            selection,
            scale: *scale,
            attitude_walk: angle_random_walk_deg_sqrt_h * core::f64::consts::PI / 180.0 / 60.0,
            robust: true,
            cut_off_rad: 0.0,
            scaled,
            number: core::marker::PhantomData,
        })
    }

    /// The same without the robust search for spikes (plain least squares in every window).
    #[must_use]
    pub const fn with_plain_windows(mut self) -> Self {
        self.robust = false;
        self
    }

    /// The same without epochs at which an input axis is nearer to the horizontal than `angle_rad` (the published
    /// cut-off; it throws away the best tilt information and is off by default).
    ///
    /// # Errors
    /// [`ConfigError`] if the angle is negative.
    pub fn with_cut_off(mut self, angle_rad: f64) -> Result<Self, ConfigError> {
        self.cut_off_rad = not_negative("cut_off_rad", angle_rad, "rad")?;
        Ok(self)
    }

    /// The square root of the prior covariance, scaled.
    #[must_use]
    pub fn prior(&self) -> Factor<T, N> {
        Factor::unit(self.selection.count())
    }

    /// Prior standard deviations in the order of the state.
    #[must_use]
    #[inline(always)]
    pub const fn scaled(&self) -> &[f64; N] {
        &self.scaled
    }

    /// Whether the published cut-off would drop an epoch with this specific force.
    #[must_use]
    #[inline]
    pub fn cuts(&self, force: &Vector3<f64>) -> bool {
        if self.cut_off_rad <= 0.0 {
            return false;
        }
        let limit = self.model.gravity_m_s2 * self.cut_off_rad.sine_cosine().0;
        force.iter().any(|f| f.magnitude() < limit)
    }

    /// Derivatives of the motion in scaled numbers, by state position.
    #[inline]
    pub(crate) fn pack_turning(&self, turning: &Turning) -> [[f64; 4]; N] {
        let mut packed = [[0.0; 4]; N];
        let by_attitude = [1.0 / self.scaled[0], 1.0 / self.scaled[1], 1.0 / self.scaled[2]];
        let turns = self.selection.turning();
        for ((slot, &index), scale) in
            packed.iter_mut().zip(self.selection.indices()).zip(&self.scaled).take(turns).skip(3)
        {
            for r in 0..3 {
                slot[r] = turning[index][r] * scale * by_attitude[r];
            }
        }
        packed
    }

    /// Phi in scaled numbers, by columns.
    #[inline]
    pub(crate) fn pack_transition(&self, transition: &Matrix3<f64>) -> [[f64; 3]; 3] {
        let columns = &transition.data.0;
        core::array::from_fn(|c| core::array::from_fn(|r| columns[c][r] * self.scaled[c] / self.scaled[r]))
    }

    /// Carries the square root through one step of `dt_s`.
    #[inline]
    pub(crate) fn carry(
        &self,
        factor: &mut Factor<T, N>,
        transition: &[[f64; 3]; 3],
        turning: &[[f64; 4]; N],
        dt_s: f64,
    ) {
        let transition = transition.map(|column| column.map(T::of));
        let turning = turning.map(|column| column.map(T::of));
        factor.carry(&transition, &turning, self.selection.turning());
        let walk = self.attitude_walk * dt_s.root();
        factor.settle(core::array::from_fn(|axis| T::of(walk / self.scaled[axis])));
    }

    /// Places in the state where the row of accelerometer `i` is not zero.
    #[inline(always)]
    pub(crate) fn support(&self, i: usize) -> [usize; 9] {
        let at = |coefficient| self.selection.position(coefficient);
        [
            0,
            1,
            2,
            at(FORCE_BIAS + i),
            at(FORCE_SCALE + i),
            at(FORCE_ABOUT_PENDULOUS + i),
            at(FORCE_ABOUT_OUTPUT + i),
            at(FORCE_QUADRATIC + i),
            at(LATENCY),
        ]
    }

    /// Takes in one scalar measurement: `residual` against the state before any correction of this epoch, `row` its derivatives
    /// in SI units, non-zero only at `support`. Adds to `correction` (scaled numbers).
    #[inline]
    pub(crate) fn absorb(
        &self,
        factor: &mut Factor<T, N>,
        row: &Row,
        support: &[usize],
        residual: f64,
        variance: f64,
        correction: &mut [f64; N],
    ) -> Innovation {
        if !(variance > 0.0 && variance.finite() && residual.finite()) {
            return Innovation::default();
        }
        let weight = 1.0 / variance.root();
        let mut packed = [T::ZERO; N];
        let mut innovation = residual * weight;
        for &at in support {
            if at < N {
                let index = self.selection.indices().get(at).copied().unwrap_or(0).min(COUNT - 1);
                let h = row[index] * self.scaled[at] * weight;
                packed[at] = T::of(h);
                innovation -= h * correction[at];
            }
        }
        let gain = factor.absorb(&packed, support);
        let spread = gain.variance.widen();
        let factor = innovation / spread;
        for (c, p) in correction.iter_mut().zip(&gain.covariance) {
            *c += p.widen() * factor;
        }
        Innovation { value: innovation / weight, variance: spread * variance }
    }

    /// Standard deviation of every coefficient in SI units; 0 where it is not estimated.
    #[must_use]
    pub fn standard_deviation(&self, factor: &Factor<T, N>) -> Coefficients {
        let mut deviation = [0.0; COUNT];
        for (at, &index) in self.selection.indices().iter().enumerate() {
            deviation[index] = factor.variance(at).widen().root() * self.scaled[at.min(N - 1)];
        }
        deviation
    }
}
