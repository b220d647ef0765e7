//! Gyro bias from a reference attitude: the bias with which the integrated rates meet the attitude fixes.
//!
//! Between fix i and fix i + 1 the reference turns by D_i = C_i' C_(i+1) (attitudes in the inertial frame, so Earth and transport rate are in
//! it exactly) and the gyro by C(b). With M the mounting (reference body to sensor) X_i = M D_i M' and the residual is
//! delta_i = Log(X_i' C_i(b)). To first order a change of the unknowns takes off
//!
//! * bias: J_i, the preintegration Jacobian; scale factor: its counterpart;
//! * mounting, M <- Exp(-dmu) M: I - X_i' (the AX = XB form);
//! * lag of the gyro behind the reference: C_i' w_start - w_end, with the rates at the two ends.
//!
//! Gauss-Newton with generalised least squares: V is block tridiagonal, N^2 T_i I + 2 sigma^2 I on the diagonal (N angle random
//! walk, sigma white reference noise a fix) and -sigma^2 X_(i+1) beside it, because neighbours share a fix. It is eliminated as the
//! intervals come, in constant memory. Two fixes, bias alone: b <- b + J^-1 delta.
//! Sign: measured = true + bias. The iteration finds the bias as long as |b| T stays below pi between fixes.
//! Sources: DOI 10.7690/bgzdh.2019.03.009 for two fixes; Forster et al. 2017 for J; the joint form is ours.

mod normal;
mod solve;
mod span;

pub use solve::solve;
pub use span::{Record, Steps};

use crate::attitude::rotation::{Body, Inertial, Rotation};
use crate::error::{ConfigError, not_negative, positive};
use crate::real::Real;

/// Unknowns: bias 0..3, mounting 3..6, lag 6, scale factor 7..10.
pub const UNKNOWNS: usize = 10;
/// Names of the unknowns.
pub const NAMES: [&str; UNKNOWNS] =
    ["bias_x", "bias_y", "bias_z", "mounting_x", "mounting_y", "mounting_z", "lag", "scale_x", "scale_y", "scale_z"];

const DEG: f64 = core::f64::consts::PI / 180.0;

/// A reference attitude at the start of gyro sample `index` (so `index` = number of samples is the end of the record).
///
/// # Example
/// ```
/// use stillrate::attitude::reference_bias::Fix;
/// use stillrate::attitude::{Body, Navigation, Rotation, earth};
/// let north = Rotation::<f64, Body, Navigation>::identity();
/// // The same heading ten seconds later is another attitude in the inertial frame: the Earth has turned.
/// let [before, after] = [(0, 0.0), (2000, 10.0)]
///     .map(|(index, elapsed_s)| Fix { index, attitude: earth::inertial_attitude(0.9, 0.1, north, elapsed_s) });
/// let turned = (before.attitude.inverse() * after.attitude).log().norm();
/// assert!((turned - 10.0 * earth::EARTH_RATE_RAD_S).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fix<T> {
    /// Gyro sample that begins at the fix.
    pub index: usize,
    /// Attitude of the reference body in the inertial frame, C_b_i.
    pub attitude: Rotation<T, Body, Inertial>,
}

/// What is estimated, and how well things are known beforehand.
///
/// # Example
/// ```
/// use stillrate::attitude::reference_bias::BiasSettings;
/// let settings = BiasSettings { estimate_mounting: true, ..BiasSettings::default() };
/// assert!(settings.check().is_ok());
/// let priors: [f64; 10] = settings.priors();
/// assert_eq!((priors[3].to_degrees(), priors[6]), (1.0, 0.0)); // a mounting within a degree; the lag is not estimated
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::struct_excessive_bools, reason = "each is a setting of its own")]
pub struct BiasSettings {
    /// Angle random walk N of the gyro, rad/sqrt(s); default 0.3 deg/sqrt(h).
    pub angle_random_walk_rad_sqrt_s: f64,
    /// White error of each fix, rad an axis; default 0.
    pub reference_sigma_rad: f64,
    /// Also estimate the rotation from reference body to sensor.
    pub estimate_mounting: bool,
    /// Also estimate how far the gyro's time lies behind the reference's.
    pub estimate_lag: bool,
    /// Also estimate three scale factor errors.
    pub estimate_scale: bool,
    /// Standard deviation of the bias beforehand, rad/s; default 200 deg/h.
    pub prior_bias_rad_s: f64,
    /// Of the mounting, rad; default 1 deg.
    pub prior_mounting_rad: f64,
    /// Of the lag, s; default 10 ms. Lags beyond five times this are not looked for.
    pub prior_lag_s: f64,
    /// Of the scale factor errors; default 1 %.
    pub prior_scale: f64,
    /// Whether the priors are data (a Bayesian estimate) or only the yardstick for what is observable (default).
    pub use_prior: bool,
    /// Most iterations; default 20 (four are usual).
    pub max_iterations: usize,
    /// Step, relative to the priors, at which the iteration stops; default 1e-12.
    pub tolerance: f64,
}

impl Default for BiasSettings {
    fn default() -> Self {
        Self {
            angle_random_walk_rad_sqrt_s: 0.3 / 60.0 * DEG,
            reference_sigma_rad: 0.0,
            estimate_mounting: false,
            estimate_lag: false,
            estimate_scale: false,
            prior_bias_rad_s: 200.0 / 3600.0 * DEG,
            prior_mounting_rad: DEG,
            prior_lag_s: 0.01,
            prior_scale: 0.01,
            use_prior: false,
            max_iterations: 20,
            tolerance: 1e-12,
        }
    }
}

impl BiasSettings {
    /// Checks every number.
    ///
    /// # Errors
    /// [`ConfigError`] for the first that cannot be used.
    pub fn check(&self) -> Result<(), ConfigError> {
        let walk = positive("angle_random_walk_rad_sqrt_s", self.angle_random_walk_rad_sqrt_s, "rad/sqrt(s)")?;
        let sigma = not_negative("reference_sigma_rad", self.reference_sigma_rad, "rad")?;
        positive("prior_bias_rad_s", self.prior_bias_rad_s, "rad/s")?;
        positive("prior_mounting_rad", self.prior_mounting_rad, "rad")?;
        positive("prior_lag_s", self.prior_lag_s, "s")?;
        positive("prior_scale", self.prior_scale, "")?;
        not_negative("tolerance", self.tolerance, "")?;
        if walk > 1.0 {
            return Err(ConfigError::new("angle_random_walk_rad_sqrt_s", walk, "rad/sqrt(s)", "at most 1"));
        }
        if sigma > 1.0 {
            return Err(ConfigError::new("reference_sigma_rad", sigma, "rad", "at most 1"));
        }
        if self.max_iterations == 0 || self.max_iterations > 1000 {
            let given = self.max_iterations as f64;
            return Err(ConfigError::new("max_iterations", given, "", "a whole number from 1 to 1000"));
        }
        Ok(())
    }

    /// Standard deviations beforehand, 0 for what is not estimated.
    #[must_use]
    pub fn priors<T: Real>(&self) -> [T; UNKNOWNS] {
        let on = |wanted: bool, sigma: f64| T::of(if wanted { sigma } else { 0.0 });
        core::array::from_fn(|k| match k {
            0..3 => on(true, self.prior_bias_rad_s),
            3..6 => on(self.estimate_mounting, self.prior_mounting_rad),
            6 => on(self.estimate_lag, self.prior_lag_s),
            _ => on(self.estimate_scale, self.prior_scale),
        })
    }
}

/// The unknowns at one point of the iteration.
///
/// # Example
/// ```
/// use stillrate::attitude::{reference_bias::Unknowns, so3};
/// // The drawing says that the sensor is turned by 2 degrees about z: where to start, and the centre of the prior.
/// let turned = so3::exp(&nalgebra::Vector3::new(0.0, 0.0, 2_f64.to_radians()));
/// let start = Unknowns { mounting: turned, ..Unknowns::default() };
/// assert_eq!((start.bias.amax(), start.lag_s, start.scale.amax()), (0.0, 0.0, 0.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unknowns<T> {
    /// Gyro bias, rad/s.
    pub bias: nalgebra::Vector3<T>,
    /// Rotation from reference body to sensor.
    pub mounting: nalgebra::Matrix3<T>,
    /// By how much the gyro's time lies behind the reference's, s: what happened at t stands in the gyro record at t + lag.
    pub lag_s: T,
    /// Scale factor errors: measured = (1 + scale) true + bias.
    pub scale: nalgebra::Vector3<T>,
}

impl<T: Real> Default for Unknowns<T> {
    fn default() -> Self {
        Self {
            bias: nalgebra::Vector3::zeros(),
            mounting: nalgebra::Matrix3::identity(),
            lag_s: T::ZERO,
            scale: nalgebra::Vector3::zeros(),
        }
    }
}

/// One iteration, for whoever watches.
///
/// # Example
/// ```
/// # use stillrate::attitude::{Rotation, reference_bias::{BiasSettings, Fix, Record, Steps, Unknowns, solve}};
/// # let rates = [[0.0, 0.0, 1e-3_f64]; 100];
/// # let record = Record { rates: &rates, steps: Steps::Uniform(0.01) };
/// # let fixes = [0, 100].map(|index| Fix { index, attitude: Rotation::identity() });
/// let mut residuals = Vec::new();
/// solve(record, &fixes, &BiasSettings::default(), Unknowns::default(), |iteration| residuals.push(iteration.delta.z))?;
/// assert!((residuals[0] - 1e-3).abs() < 1e-15 && residuals[1].abs() < 1e-15); // 1 s of bias, gone after one step
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Iteration<T> {
    /// Bias before the step, rad/s.
    pub bias: nalgebra::Vector3<T>,
    /// Gyro rotation over the first interval.
    pub rotation: nalgebra::Matrix3<T>,
    /// Its Jacobian, s.
    pub jacobian: nalgebra::Matrix3<T>,
    /// Its residual, rad.
    pub delta: nalgebra::Vector3<T>,
}

/// What was found.
///
/// # Example
/// ```
/// # use stillrate::attitude::{Rotation, reference_bias::{BiasSettings, Fix, Record, Steps, Unknowns, solve}};
/// # let rates = [[0.0, 0.0, 1e-3_f64]; 100];
/// # let record = Record { rates: &rates, steps: Steps::Uniform(0.01) };
/// # let fixes = [0, 100].map(|index| Fix { index, attitude: Rotation::identity() });
/// let settings = BiasSettings { estimate_mounting: true, ..BiasSettings::default() };
/// let found = solve(record, &fixes, &settings, Unknowns::default(), |_| ())?;
/// // At rest the bias shows and the mounting does not: three of six directions.
/// assert!(!found.observable() && (found.rank, found.dimension) == (3, 6));
/// assert!(found.condition() > 1e6 && found.posterior_over_prior[3] > 0.999);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BiasEstimate<T> {
    /// The unknowns.
    pub unknowns: Unknowns<T>,
    /// Their covariance, in the order of [`NAMES`]; zero for what was not estimated. Directions that the data does not
    /// determine keep the prior.
    pub covariance: [[T; UNKNOWNS]; UNKNOWNS],
    /// How much better than the prior the data knows each direction (prior over data standard deviation), in descending
    /// order; below 1 the motion does not show it. The first [`BiasEstimate::dimension`] count.
    pub singular_values: [T; UNKNOWNS],
    /// The directions, in units of the priors: `directions[unknown][k]` belongs to `singular_values[k]`.
    pub directions: [[T; UNKNOWNS]; UNKNOWNS],
    /// Standard deviation after over before, for each unknown; 0 for what was not estimated.
    pub posterior_over_prior: [T; UNKNOWNS],
    /// Number of unknowns estimated.
    pub dimension: usize,
    /// Directions that the data determines.
    pub rank: usize,
    /// Weighted sum of squared residuals.
    pub chi_square: T,
    /// Its degrees of freedom.
    pub degrees_of_freedom: usize,
    /// Iterations made.
    pub iterations: usize,
    /// Whether the iteration settled inside |b| T < pi.
    pub converged: bool,
}

impl<T: Real> BiasEstimate<T> {
    /// Whether the motion separates everything that was asked for.
    #[must_use]
    pub fn observable(&self) -> bool {
        self.rank == self.dimension
    }

    /// Largest over smallest singular value.
    #[must_use]
    pub fn condition(&self) -> T {
        let last = self.singular_values.get(self.dimension.saturating_sub(1)).copied().unwrap_or(T::ZERO);
        self.singular_values[0] / last
    }
}
