//! Methods and settings of a calibration on a desk.

use stillrate::ConfigError;
use stillrate::gimbal::coefficients::{GYRO_ABOUT_OUTPUT, GYRO_BIAS};
use stillrate::gimbal::{
    COUNT, Coefficients, DEFAULT_SCALE, Gauge, Model, Options, Reference, SECOND_ORDER, Selection,
};

/// How to calibrate.
///
/// # Example
/// ```
/// use stillrate_lab::gimbal::Method;
/// assert_eq!(Method::named("on-line"), Some(Method::OnLine));
/// assert_eq!(Method::named("online"), None);
/// assert!(Method::NAMED.iter().all(|&(name, method)| Method::named(name) == Some(method)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Recursive Gauss-Newton (recommended).
    Relinearised,
    /// Joint extended filter, one pass.
    OnLine,
    /// Batch Gauss-Newton.
    Batch,
    /// Norm loop over the record, then tilt loop.
    TwoStage,
    /// Norm and tilt loop side by side.
    TwoLoop,
    /// First-order single loop (baseline).
    FirstOrder,
    /// The published two loops taken literally (baseline; diverges).
    Literal,
}

impl Method {
    /// All methods with their names.
    pub const NAMED: [(&'static str, Self); 7] = [
        ("relinearised", Self::Relinearised),
        ("on-line", Self::OnLine),
        ("batch", Self::Batch),
        ("two-stage", Self::TwoStage),
        ("two-loop", Self::TwoLoop),
        ("first-order", Self::FirstOrder),
        ("literal", Self::Literal),
    ];

    /// The method of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::NAMED.iter().find(|(n, _)| *n == name).map(|(_, m)| *m)
    }
}

/// Everything about a calibration but the record.
///
/// # Example
/// ```
/// use stillrate::gimbal::{Model, NAMES, Options};
/// use stillrate_lab::gimbal::Settings;
/// let place = Settings::new(Model::new(9.8, 0.7)?);
/// // A head whose gyros drift by a degree an hour, and whose clock is not to be trusted.
/// let poor = Settings { options: Options { latency: true, ..Options::default() }, ..place.with_gyro_scale(10.0) };
/// assert!((poor.scale[3] / place.scale[3] - 10.0).abs() < 1e-12 && poor.scale[21] == place.scale[21]);
/// assert_eq!(poor.indices()?.last().map(|&i| NAMES[i]), Some("latency"));
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Place and arrangement.
    pub model: Model,
    /// Which mounting angles are held.
    pub gauge: Gauge,
    /// Optional states.
    pub options: Options,
    /// Prior standard deviations.
    pub scale: Coefficients,
    /// Prior mean.
    pub prior: Coefficients,
    /// What is subtracted inside the windows.
    pub reference: Reference,
    /// Robust lines in the windows.
    pub robust: bool,
    /// Weight of the second-order terms (on-line filter).
    pub second_order: f64,
    /// Angle random walk the filter allows for, deg/sqrt(h).
    pub angle_random_walk_deg_sqrt_h: f64,
    /// Cut-off near the horizontal, rad; 0: off.
    pub cut_off_rad: f64,
    /// Square root in single precision.
    pub single: bool,
    /// History every so many epochs.
    pub every: usize,
}

impl Settings {
    /// Defaults at a place.
    #[must_use]
    pub const fn new(model: Model) -> Self {
        Self {
            model,
            gauge: Gauge::Accelerometer,
            options: Options { torquer: false, quadratic: false, latency: false, latitude: false },
            scale: DEFAULT_SCALE,
            prior: [0.0; COUNT],
            reference: Reference::Model,
            robust: true,
            second_order: SECOND_ORDER,
            angle_random_walk_deg_sqrt_h: 0.0,
            cut_off_rad: 0.0,
            single: false,
            every: 1,
        }
    }

    /// Prior deviations of the gyro drifts and their g-sensitive parts times a factor.
    #[must_use]
    pub fn with_gyro_scale(mut self, factor: f64) -> Self {
        self.scale[GYRO_BIAS..GYRO_ABOUT_OUTPUT].iter_mut().for_each(|s| *s *= factor);
        self
    }

    /// The estimated coefficients in the order of a filter state.
    ///
    /// # Errors
    /// [`ConfigError`] if the triads are no permutations.
    pub fn indices(&self) -> Result<Vec<usize>, ConfigError> {
        Ok(Selection::<COUNT>::for_triads(self.gauge, self.options, &self.model.triads)?.indices().to_vec())
    }
}
