//! What the recursive filters share: which coefficients, their scales, and the passage from SI derivatives to the scaled square root.
//!
//! Inside, every number is divided by its prior standard deviation, so the prior covariance is the identity and `f32` suffices for the
//! square root. Attitude, coefficients and residuals stay in `f64` whatever `T` is: an attitude error of 1e-7 rad matters.

use nalgebra::{Matrix3, Vector3};

use super::carried::{Carried, scaled_transition};
use super::coefficients::{
    COUNT, Coefficients, FORCE_ABOUT_OUTPUT, FORCE_ABOUT_PENDULOUS, FORCE_BIAS, FORCE_QUADRATIC, FORCE_SCALE, LATENCY,
    NAMES,
};
use super::factor::Factor;
use super::model::Model;
use super::motion::Turning;
use super::output::Row;
use super::selection::Selection;
use crate::error::{ConfigError, not_negative};
use crate::real::Real;

/// Checked settings of the recursive filters; `T` is the number of the square root, `N` its capacity.
///
/// # Example
/// ```
/// use stillrate::gimbal::{COUNT, DEFAULT_SCALE, Estimator, Gauge, Innovation, JointFilter, Measurement, Model, Options, Selection};
/// let selection = Selection::<30>::new(Gauge::Accelerometer, Options::default())?;
/// let estimator = Estimator::<f64, 30>::new(Model::new(9.8, 0.7)?, selection, &DEFAULT_SCALE, 0.0)?;
/// // Level at the start, two input axes are horizontal: the published cut-off drops what they say.
/// let cutting = JointFilter::new(estimator.with_plain_windows().with_cut_off(0.1)?, 5.0)?;
/// let innovations = cutting.correct(&mut cutting.start(&[0.0; COUNT]), &Measurement { value: [0.0, 9.8, 0.0], variance: [2e-13; 3] });
/// assert_eq!(innovations, [Innovation::default(); 3]);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimator<T, const N: usize> {
    /// The place and the instruments.
    pub(super) model: Model,
    /// The estimated coefficients.
    pub(super) selection: Selection<N>,
    /// Random walk of the attitude, rad/sqrt(s).
    pub(super) attitude_walk: f64,
    /// Fit the windows with the robust line.
    pub(super) robust: bool,
    /// Epochs with an input axis nearer to the horizontal than this are not used, rad; 0: all are.
    cut_off_rad: f64,
    scaled: [f64; N],
    weight: [[f64; N]; 3],
    number: core::marker::PhantomData<T>,
}

/// Innovation of one scalar measurement, m/s^2.
///
/// # Example
/// ```
/// use stillrate::gimbal::Innovation;
/// let two_deviations_low = Innovation { value: -2e-6, variance: 1e-12 };
/// assert_eq!(two_deviations_low.normalised(), -2.0);
/// assert!(Innovation::default().normalised().is_nan()); // no measurement
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Innovation {
    /// Measured minus predicted.
    pub value: f64,
    /// Its variance as the filter believes it; 0 where there was no measurement.
    pub variance: f64,
}

impl Innovation {
    /// Innovation over its standard deviation, N(0, 1) under a right model; NaN where there was no measurement.
    #[must_use]
    pub fn normalised(&self) -> f64 {
        if self.variance > 0.0 { self.value / self.variance.root() } else { f64::NAN }
    }
}

impl<T: Real, const N: usize> Estimator<T, N> {
    /// Settings with the given prior standard deviations (SI, in the order of [`NAMES`]) and attitude random walk (deg/sqrt(h), 0 for none).
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
            attitude_walk: angle_random_walk_deg_sqrt_h * core::f64::consts::PI / 180.0 / 60.0,
            robust: true,
            cut_off_rad: 0.0,
            scaled,
            weight: core::array::from_fn(|r| scaled.map(|s| s / scaled[r])),
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
    pub(super) fn prior(&self) -> Factor<T, N> {
        Factor::unit(self.selection.count())
    }

    /// Prior standard deviations in the order of the state.
    #[inline(always)]
    pub(super) const fn scaled(&self) -> &[f64; N] {
        &self.scaled
    }

    /// Whether the published cut-off would drop an epoch with this specific force.
    #[inline]
    pub(super) fn cuts(&self, force: &Vector3<f64>) -> bool {
        if self.cut_off_rad <= 0.0 {
            return false;
        }
        let limit = self.model.gravity_m_s2 * self.cut_off_rad.sine_cosine().0;
        force.iter().any(|f| f.magnitude() < limit)
    }

    /// Carries the errors of the start through one step of `dt_s`, and adds the random walk of the attitude.
    #[inline(always)]
    pub(super) fn carry(
        &self,
        factor: &mut Factor<T, N>,
        carried: &mut Carried<N>,
        transition: &Matrix3<f64>,
        turning: &Turning,
        dt_s: f64,
    ) {
        let transition = scaled_transition(transition, [self.scaled[0], self.scaled[1], self.scaled[2]]);
        carried.turn(&transition);
        carried.add(turning, &self.selection, &self.weight);
        if self.attitude_walk > 0.0 {
            self.spread(factor, self.attitude_walk * dt_s.root());
        }
    }

    /// Makes the attitude less certain by `walk_rad` about each axis.
    #[inline(always)]
    pub(super) fn spread(&self, factor: &mut Factor<T, N>, walk_rad: f64) {
        factor.spread(core::array::from_fn(|axis| T::of(walk_rad / self.scaled[axis])));
    }

    /// Attitude error now (rad) that an error in scaled numbers makes.
    #[inline(always)]
    pub(super) fn attitude(&self, carried: &Carried<N>, errors: &[f64; N]) -> Vector3<f64> {
        let psi = carried.now(errors);
        Vector3::new(psi[0] * self.scaled[0], psi[1] * self.scaled[1], psi[2] * self.scaled[2])
    }

    /// Variances of the attitude now, rad^2.
    #[inline(always)]
    pub(super) fn attitude_variance(&self, factor: &Factor<T, N>, carried: &Carried<N>) -> [f64; 3] {
        let mut rows = [[T::ZERO; N]; 3];
        for (row, exact) in rows.iter_mut().zip(&carried.rows) {
            for (slot, x) in row.iter_mut().zip(exact) {
                *slot = T::of(*x);
            }
        }
        let [x, y, z] = factor.variances_along(&rows);
        let [a, b, c] = [self.scaled[0], self.scaled[1], self.scaled[2]];
        [x.widen() * a * a, y.widen() * b * b, z.widen() * c * c]
    }

    /// A row of derivatives (SI units, by the attitude now and the coefficients) in scaled numbers, times `weight`. Besides the
    /// attitude only the coefficients of accelerometer `axis` may be other than 0.
    #[inline(always)]
    pub(super) fn row(&self, carried: &Carried<N>, row: &Row, axis: usize, weight: f64) -> [f64; N] {
        let [x, y, z] =
            [row[0] * self.scaled[0] * weight, row[1] * self.scaled[1] * weight, row[2] * self.scaled[2] * weight];
        let mut packed = [0.0; N];
        for (slot, ((a, b), c)) in
            packed.iter_mut().zip(carried.rows[0].iter().zip(&carried.rows[1]).zip(&carried.rows[2]))
        {
            *slot = x * a + y * b + z * c;
        }
        for index in [
            FORCE_BIAS + axis,
            FORCE_SCALE + axis,
            FORCE_ABOUT_PENDULOUS + axis,
            FORCE_ABOUT_OUTPUT + axis,
            FORCE_QUADRATIC + axis,
            LATENCY,
        ] {
            let at = self.selection.position(index);
            if let (Some(slot), Some(scale), Some(h)) = (packed.get_mut(at), self.scaled.get(at), row.get(index)) {
                *slot += h * scale * weight;
            }
        }
        packed
    }

    /// Takes in one scalar measurement of unit variance: `residual` against the state before any correction of this epoch, both
    /// it and its derivatives `row` over the deviation of the noise. Adds to `correction` (scaled numbers); returns the innovation
    /// variance.
    #[inline(always)]
    pub(super) fn absorb(
        factor: &mut Factor<T, N>,
        row: &[f64; N],
        residual: f64,
        correction: &mut [f64; N],
    ) -> (f64, f64) {
        let innovation = residual - product(row, correction);
        let mut rounded = [T::ZERO; N];
        for (slot, h) in rounded.iter_mut().zip(row) {
            *slot = T::of(*h);
        }
        let gain = factor.absorb(&rounded);
        let variance = gain.variance.widen();
        let factor = innovation / variance;
        for (c, p) in correction.iter_mut().zip(&gain.covariance) {
            *c += p.widen() * factor;
        }
        (innovation, variance)
    }

    /// Adds a correction (scaled numbers) to the coefficients; the attitude is corrected by rotation, elsewhere.
    #[inline(always)]
    pub(super) fn add_to(&self, coefficients: &mut Coefficients, correction: &[f64; N]) {
        for ((&index, c), s) in self.selection.indices().iter().zip(correction).zip(&self.scaled).skip(3) {
            coefficients[index] += c * s;
        }
    }

    /// Standard deviation of every coefficient in SI units, the attitude's at the start; 0 where it is not estimated.
    pub(super) fn standard_deviation(&self, factor: &Factor<T, N>) -> Coefficients {
        let mut deviation = [0.0; COUNT];
        for ((variance, scale), &index) in factor.variances().iter().zip(&self.scaled).zip(self.selection.indices()) {
            deviation[index] = variance.widen().root() * scale;
        }
        deviation
    }

    /// The same with the deviation of the attitude now.
    pub(super) fn standard_deviation_now(&self, factor: &Factor<T, N>, carried: &Carried<N>) -> Coefficients {
        let mut deviation = self.standard_deviation(factor);
        for (slot, variance) in deviation.iter_mut().zip(self.attitude_variance(factor, carried)) {
            *slot = variance.root();
        }
        deviation
    }
}

/// Sum of products in four interleaved parts, so that it runs side by side.
#[inline(always)]
fn product<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    let (a, last_a) = a.as_chunks::<4>();
    let (b, last_b) = b.as_chunks::<4>();
    let mut sums = [0.0; 4];
    for (a, b) in a.iter().zip(b) {
        for l in 0..4 {
            sums[l] += a[l] * b[l];
        }
    }
    let rest = last_a.iter().zip(last_b).fold(0.0, |sum, (a, b)| sum + a * b);
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + rest
}
