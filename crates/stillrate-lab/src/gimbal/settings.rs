//! Methods and settings of a calibration on a desk.

use stillrate::ConfigError;
use stillrate::gimbal::{COUNT, Coefficients, DEFAULT_SCALE, Gauge, Model, Options, Reference, Selection};

/// How to calibrate.
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
            second_order: stillrate::gimbal::joint::SECOND_ORDER,
            angle_random_walk_deg_sqrt_h: 0.0,
            cut_off_rad: 0.0,
            single: false,
            every: 1,
        }
    }

    /// Prior deviations of the gyro drifts and their g-sensitive parts times a factor.
    #[must_use]
    pub fn with_gyro_scale(mut self, factor: f64) -> Self {
        self.scale[3..15].iter_mut().for_each(|s| *s *= factor);
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
