//! Gyro bias from a logged reference: fixes as users have them, turned into inertial attitudes and solved in the core.
//!
//! The core ([`stillrate::attitude::reference_bias`]) wants C_b_i; a log has C_b_n with latitude and longitude. This module checks and projects the
//! matrices, puts Earth and transport rate in exactly, turns instantaneous rate samples into mean rates, and offers
//! the classical shortcuts under the same door.

use nalgebra::{Matrix3, Vector3};
use stillrate::attitude::reference_bias::{BiasEstimate, BiasSettings, Fix, Iteration, Record, Steps, Unknowns, solve};
use stillrate::attitude::{Body, Inertial, Navigation, Rotation, check_dcm, earth, project_to_rotation, shortcuts};

use crate::settings_map::SettingsError;

/// Gyro rates with reference attitudes.
///
/// # Example
/// ```
/// use nalgebra::Matrix3;
/// use stillrate::attitude::earth::EARTH_RATE_RAD_S;
/// use stillrate_lab::reference_bias::{Reading, ReferenceLog};
/// let log = ReferenceLog {
///     rate_rad_s: vec![[0.0, 0.0, 1.0], [0.0, 0.0, 3.0]],
///     dt_s: vec![0.5; 2],
///     fix_index: vec![0, 2],
///     c_b_n: vec![Matrix3::identity(); 2],
///     latitude_rad: vec![0.8; 2],
///     longitude_rad: vec![0.1; 2],
/// };
/// let fixes = log.fixes(Reading { earth_rate: true, instantaneous: true, project: false })?;
/// let turned = (fixes[0].attitude.inverse() * fixes[1].attitude).log().norm();
/// assert!((turned - EARTH_RATE_RAD_S).abs() < 1e-15); // level and pointing north, it turned with the Earth for a second
/// assert_eq!(log.mean_rates(true)[0], [0.0, 0.0, 2.0]); // between two instants
/// # Ok::<(), stillrate_lab::settings_map::SettingsError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReferenceLog {
    /// Body rates, rad/s.
    pub rate_rad_s: Vec<[f64; 3]>,
    /// Duration of each sample, s.
    pub dt_s: Vec<f64>,
    /// Sample at whose start each fix was taken.
    pub fix_index: Vec<usize>,
    /// Attitude C_b_n of each fix.
    pub c_b_n: Vec<Matrix3<f64>>,
    /// Latitude of each fix, rad.
    pub latitude_rad: Vec<f64>,
    /// Longitude of each fix, rad.
    pub longitude_rad: Vec<f64>,
}

/// How a log is to be read.
///
/// # Example
/// ```
/// use nalgebra::Matrix3;
/// use stillrate_lab::reference_bias::{Reading, ReferenceLog};
/// let rounded = Matrix3::new(0.94, -0.342, 0.0, 0.342, 0.94, 0.0, 0.0, 0.0, 1.0); // 20 degrees, three digits
/// let log = ReferenceLog {
///     rate_rad_s: vec![[0.0; 3]],
///     dt_s: vec![1.0],
///     fix_index: vec![0, 1],
///     c_b_n: vec![rounded; 2],
///     latitude_rad: vec![0.0; 2],
///     longitude_rad: vec![0.0; 2],
/// };
/// let strict = Reading { earth_rate: false, instantaneous: false, project: false };
/// assert!(log.fixes(strict).unwrap_err().to_string().starts_with("c_b_n[0]"));
/// assert!(log.fixes(Reading { project: true, ..strict }).is_ok());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Whether the Earth turns; false for a reference frame that does not (or an experiment that ignores it).
    pub earth_rate: bool,
    /// Whether rates are instantaneous at the start of their sample (means of neighbours are then used) instead of means over it.
    pub instantaneous: bool,
    /// Whether rounded matrices are projected onto the nearest rotation instead of refused.
    pub project: bool,
}

/// How the bias is found.
///
/// # Example
/// ```
/// use stillrate_lab::reference_bias::{METHODS, Method};
/// assert_eq!(METHODS[0], ("exact", Method::Exact));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Gauss-Newton, all fixes.
    Exact,
    /// First and last fix: small angle over time.
    SmallAngle,
    /// First and last fix: small angle through the Jacobian.
    SmallAngleJacobian,
    /// First and last fix: mean rate less mean reference rate.
    MeanRate,
}

/// Names of the methods, in the order of [`Method`].
pub const METHODS: [(&str, Method); 4] = [
    ("exact", Method::Exact),
    ("small-angle", Method::SmallAngle),
    ("small-angle-jacobian", Method::SmallAngleJacobian),
    ("mean-rate", Method::MeanRate),
];

impl ReferenceLog {
    /// Inertial attitudes of all fixes, C_b_i.
    ///
    /// # Errors
    /// A sentence that names the fix or sample that cannot be used.
    pub fn fixes(&self, reading: Reading) -> Result<Vec<Fix<f64>>, SettingsError> {
        let text = |text: String| Err(SettingsError::Text(text));
        let count = self.fix_index.len();
        if self.c_b_n.len() != count || self.latitude_rad.len() != count || self.longitude_rad.len() != count {
            return text(format!("{count} fix indices need as many attitudes, latitudes and longitudes"));
        }
        if self.rate_rad_s.is_empty() || self.dt_s.len() != self.rate_rad_s.len() {
            return text(format!("{} rate samples need as many time steps (at least 1)", self.rate_rad_s.len()));
        }
        if let Some(k) = self.rate_rad_s.iter().position(|rate| rate.iter().any(|x| !x.is_finite())) {
            return text(format!("rate_rad_s[{k}] is not finite (a rotation cannot be integrated over a gap)"));
        }
        if let Some(k) = self.dt_s.iter().position(|dt| !(dt.is_finite() && *dt > 0.0)) {
            return text(format!("dt_s[{k}] = {} (must be finite and > 0 s)", self.dt_s[k]));
        }
        let mut times = Vec::with_capacity(self.dt_s.len() + 1);
        times.push(0.0);
        for dt in &self.dt_s {
            times.push(times[times.len() - 1] + dt);
        }
        let first = self.fix_index.first().and_then(|&index| times.get(index)).copied().unwrap_or(0.0);
        (0..count).map(|i| self.fix(i, reading, &times, first)).collect()
    }

    fn fix(&self, i: usize, reading: Reading, times: &[f64], first: f64) -> Result<Fix<f64>, SettingsError> {
        let index = self.fix_index[i];
        let Some(time) = times.get(index) else {
            let samples = self.rate_rad_s.len();
            return Err(SettingsError::Text(format!(
                "fix_index[{i}] = {index} (must be at most {samples}, the samples)"
            )));
        };
        let checked = if reading.project { project_to_rotation(&self.c_b_n[i]) } else { check_dcm(&self.c_b_n[i]) };
        let matrix = checked.map_err(|error| SettingsError::Text(format!("c_b_n[{i}]: {error}")))?;
        let c_b_n = Rotation::<f64, Body, Navigation>::projected(matrix)?;
        if !reading.earth_rate {
            return Ok(Fix { index, attitude: Rotation::<f64, Body, Inertial>::projected(*c_b_n.matrix())? });
        }
        let (latitude, longitude) = (self.latitude_rad[i], self.longitude_rad[i]);
        if !(latitude.abs() <= core::f64::consts::FRAC_PI_2 && longitude.is_finite()) {
            let place = format!("latitude_rad[{i}] = {latitude}, longitude_rad[{i}] = {longitude}");
            return Err(SettingsError::Text(format!("{place} (must be finite, latitude within -pi/2..pi/2)")));
        }
        Ok(Fix { index, attitude: earth::inertial_attitude(latitude, longitude, c_b_n, time - first) })
    }

    /// Rates (rad/s) as means over their samples; instantaneous ones become the means of neighbours.
    #[must_use]
    pub fn mean_rates(&self, instantaneous: bool) -> Vec<[f64; 3]> {
        if !instantaneous {
            return self.rate_rad_s.clone();
        }
        let next = |k: usize| self.rate_rad_s[(k + 1).min(self.rate_rad_s.len() - 1)];
        (0..self.rate_rad_s.len())
            .map(|k| core::array::from_fn(|axis| 0.5 * (self.rate_rad_s[k][axis] + next(k)[axis])))
            .collect()
    }
}

/// An estimate with its iterations; the shortcuts have no covariance and no iterations.
///
/// # Example
/// ```
/// # use nalgebra::Matrix3;
/// # use stillrate::attitude::reference_bias::{BiasSettings, Unknowns};
/// # use stillrate_lab::reference_bias::{Method, Reading, ReferenceLog, reference_bias};
/// # let log = ReferenceLog {
/// #     rate_rad_s: vec![[0.0, 0.0, 1e-3]; 100],
/// #     dt_s: vec![0.01; 100],
/// #     fix_index: vec![0, 100],
/// #     c_b_n: vec![Matrix3::identity(); 2],
/// #     latitude_rad: vec![0.0; 2],
/// #     longitude_rad: vec![0.0; 2],
/// # };
/// # let still = Reading { earth_rate: false, instantaneous: false, project: false };
/// let by = |method| reference_bias(&log, still, &BiasSettings::default(), Unknowns::default(), method);
/// let (exact, quick) = (by(Method::Exact)?, by(Method::MeanRate)?);
/// assert!((exact.bias_rad_s - quick.bias_rad_s).amax() < 1e-15); // at rest there is nothing to choose
/// assert!(exact.exact.is_some_and(|estimate| estimate.observable()) && quick.exact.is_none() && quick.history.is_empty());
/// # Ok::<(), stillrate_lab::settings_map::SettingsError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Bias, rad/s.
    pub bias_rad_s: Vector3<f64>,
    /// The rest of an exact estimate.
    pub exact: Option<BiasEstimate<f64>>,
    /// Every iteration of an exact estimate.
    pub history: Vec<Iteration<f64>>,
}

/// Finds the bias in a log.
///
/// # Errors
/// A sentence that names what cannot be used.
///
/// # Example
/// ```
/// use nalgebra::Matrix3;
/// use stillrate::attitude::reference_bias::{BiasSettings, Unknowns};
/// use stillrate_lab::reference_bias::{Method, Reading, ReferenceLog, reference_bias};
/// let log = ReferenceLog {
///     rate_rad_s: vec![[0.0, 0.0, 1e-3]; 100],
///     dt_s: vec![0.01; 100],
///     fix_index: vec![0, 100],
///     c_b_n: vec![Matrix3::identity(); 2],
///     latitude_rad: vec![0.0; 2],
///     longitude_rad: vec![0.0; 2],
/// };
/// let still = Reading { earth_rate: false, instantaneous: false, project: false };
/// let found = reference_bias(&log, still, &BiasSettings::default(), Unknowns::default(), Method::Exact)?;
/// assert!((found.bias_rad_s.z - 1e-3).abs() < 1e-15);
/// # Ok::<(), stillrate_lab::settings_map::SettingsError>(())
/// ```
pub fn reference_bias(
    log: &ReferenceLog,
    reading: Reading,
    settings: &BiasSettings,
    start: Unknowns<f64>,
    method: Method,
) -> Result<Outcome, SettingsError> {
    let fixes = log.fixes(reading)?;
    let rates = log.mean_rates(reading.instantaneous);
    let mut history = Vec::new();
    let record = Record { rates: &rates, steps: Steps::Each(&log.dt_s) };
    if method == Method::Exact {
        let estimate = solve(record, &fixes, settings, start, |iteration| history.push(*iteration))?;
        return Ok(Outcome { bias_rad_s: estimate.unknowns.bias, exact: Some(estimate), history });
    }
    let (Some(first), Some(last)) = (fixes.first(), fixes.last()) else {
        return Err(SettingsError::Text("fixes = 0 (must be at least 2)".into()));
    };
    if last.index <= first.index {
        return Err(SettingsError::Text("the last fix must come after the first (t1 > t0)".into()));
    }
    let samples = || (first.index..last.index).map(|k| (rates[k], log.dt_s[k]));
    let reference = first.attitude.matrix().transpose() * last.attitude.matrix();
    let turn = shortcuts::integrate(samples());
    let bias_rad_s = match method {
        Method::SmallAngle => shortcuts::small_angle(&turn, &reference),
        Method::SmallAngleJacobian => shortcuts::small_angle_with_jacobian(&turn, &reference),
        _ => shortcuts::mean_rate(samples(), &reference),
    };
    Ok(Outcome { bias_rad_s, exact: None, history })
}
