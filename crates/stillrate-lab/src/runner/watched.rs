//! What a run looks like from inside: traces, last estimates, and what is kept of a channel's last sample.

use stillrate::Real;
use stillrate::filter::{Estimate, Flags, ModelTrace, Observer, Sample};

/// Numbers of a saved estimate besides the probabilities: see [`Watched::scatter`].
pub(super) const ESTIMATE_NUMBERS: usize = 5;

/// No flag has a bit above [`Flags::EDGE_HELD`].
const ALL_FLAGS: u32 = 2 * Flags::EDGE_HELD.0 - 1;

/// What a run looks like from inside: one entry a sample and channel, channels fastest. Rates are in the unit of the samples, deg/s.
///
/// # Example
/// ```
/// use stillrate_lab::runner::{Precision, Source, Table, Timing, build};
/// use stillrate_lab::settings_map::{SettingsMap, Value};
/// let settings = SettingsMap::from([("sample_rate_hz".to_string(), Value::Number(50.0))]);
/// let mut filter = build("singer-imm-kf", &settings, 2, Precision::Double)?;
/// // One axis at rest, one that turns to and fro.
/// let samples: Vec<f64> = (0..200).flat_map(|k| [0.0, if k / 5 % 2 == 0 { 30.0 } else { -30.0 }]).collect();
/// let trace = filter.trace(Source::Double(Table::contiguous(&samples, 2).unwrap()), Timing::Regular);
/// assert_eq!((trace.rate.len(), trace.probability.len()), (200 * 2, 200 * trace.models * 2));
/// // The probability of the quiet model at the last sample.
/// let [at_rest, moving] = trace.probability[199 * trace.models * 2..][..2] else { panic!("two channels") };
/// assert!(at_rest > 0.5 && moving < 0.5);
/// # Ok::<(), stillrate_lab::settings_map::SettingsError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    /// Number of models of the filter.
    pub models: usize,
    /// Filtered rate.
    pub rate: Vec<f64>,
    /// Its time derivative, per second; 0 for methods that do not estimate it.
    pub acceleration: Vec<f64>,
    /// Variance of the rate as the filter believes it; 0 for methods that have no opinion.
    pub variance: Vec<f64>,
    /// Manoeuvre frequency in Hz; NaN for methods without one.
    pub frequency_hz: Vec<f64>,
    /// [`Flags`] as bits.
    pub flags: Vec<u32>,
    /// Posterior probability, `[sample][model][channel]`.
    pub probability: Vec<f64>,
    /// The rest of [`ModelTrace`], `[sample][model][channel]`.
    pub per_model: Vec<ModelTrace<f64>>,
}

/// The last estimate of one channel, in the unit of the samples, deg/s.
///
/// # Example
/// ```
/// use stillrate_lab::runner::{Precision, build};
/// use stillrate_lab::settings_map::{SettingsMap, Value};
/// let settings = SettingsMap::from([("sample_rate_hz".to_string(), Value::Number(50.0))]);
/// let mut filter = build("ms-imm-ikf", &settings, 1, Precision::Double)?;
/// for _ in 0..500 {
///     filter.update(&mut [0.25], None);
/// }
/// let last = filter.estimate(0);
/// assert!((last.rate - 0.25).abs() < 1e-3 && last.variance.sqrt() < 0.05);
/// assert!((last.probability.iter().sum::<f64>() - 1.0).abs() < 1e-12);
/// # Ok::<(), stillrate_lab::settings_map::SettingsError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LastEstimate {
    /// Filtered rate.
    pub rate: f64,
    /// Its time derivative, per second; 0 for methods that do not estimate it.
    pub acceleration: f64,
    /// Variance of the rate as the filter believes it; 0 for methods that have no opinion.
    pub variance: f64,
    /// Manoeuvre frequency in Hz; NaN for methods without one.
    pub frequency_hz: f64,
    /// [`Flags`] as bits.
    pub flags: u32,
    /// Posterior model probabilities.
    pub probability: Vec<f64>,
}

pub(super) fn widened<T: Real>(model: &ModelTrace<T>) -> ModelTrace<f64> {
    ModelTrace {
        probability: model.probability.widen(),
        innovation: model.innovation.widen(),
        innovation_variance: model.innovation_variance.widen(),
        fading: model.fading.widen(),
        alpha: model.alpha.widen(),
        rate: model.rate.widen(),
    }
}

/// What the last sample of a channel left behind.
#[derive(Clone, Debug)]
pub(super) struct Watched<T, U> {
    pub(super) estimate: Estimate<T>,
    pub(super) models: Vec<ModelTrace<T>>,
    pub(super) frequency: T,
    /// State before the last sample and that sample, if it ran unwatched: models and frequency are then behind.
    pub(super) unseen: Option<(U, Sample<T>)>,
}

impl<T: Real, U> Watched<T, U> {
    pub(super) fn blank(models: usize) -> Self {
        let certain = ModelTrace { probability: T::ONE / T::of(models as f64), ..ModelTrace::default() };
        let estimate = Estimate { flags: Flags::NO_DATA_YET, ..Estimate::default() };
        Self { estimate, models: vec![certain; models], frequency: T::of(f64::NAN), unseen: None }
    }

    pub(super) fn frequency_hz(&self) -> f64 {
        self.frequency.widen() / core::f64::consts::TAU
    }

    /// The estimate as numbers: rate, acceleration, variance, frequency in rad/s, flags, probability of each model.
    pub(super) fn scatter(&self, numbers: &mut Vec<T>) {
        let Estimate { rate, acceleration, variance, flags } = self.estimate;
        numbers.extend([rate, acceleration, variance, self.frequency, T::of(f64::from(flags.0))]);
        numbers.extend(self.models.iter().map(|model| model.probability));
    }

    /// Takes what [`Watched::scatter`] gave; false, and nothing has changed, if that can never have been an estimate.
    pub(super) fn gather(&mut self, numbers: &[f64]) -> bool {
        let [rate, acceleration, variance, frequency, flags, probabilities @ ..] = numbers else { return false };
        let finite = rate.is_finite() && acceleration.is_finite() && variance.is_finite() && *variance >= 0.0;
        let known = frequency.is_nan() || (frequency.is_finite() && *frequency >= 0.0);
        let flagged = (0.0..=f64::from(ALL_FLAGS)).contains(flags) && f64::from(*flags as u32) == *flags;
        let likely = probabilities.iter().all(|probability| (0.0..=1.001).contains(probability));
        if !(finite && known && flagged && likely) {
            return false;
        }
        self.estimate = Estimate {
            rate: T::of(*rate),
            acceleration: T::of(*acceleration),
            variance: T::of(*variance),
            flags: Flags(*flags as u32),
        };
        self.frequency = T::of(*frequency);
        for (model, probability) in self.models.iter_mut().zip(probabilities) {
            model.probability = T::of(*probability);
        }
        self.unseen = None;
        true
    }
}

pub(super) struct Watcher<'a, T>(pub(super) &'a mut [ModelTrace<T>], pub(super) &'a mut T);

impl<T: Real> Observer<T> for Watcher<'_, T> {
    fn model(&mut self, index: usize, trace: ModelTrace<T>) {
        if let Some(model) = self.0.get_mut(index) {
            *model = trace;
        }
    }
    fn frequency(&mut self, rad_s: T) {
        *self.1 = rad_s;
    }
}
