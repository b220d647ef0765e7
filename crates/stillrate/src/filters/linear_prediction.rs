//! Forward linear prediction: each sample is replaced by its prediction from the ones before it.
//!
//! y_k = w_1 z_(k-1) + ... + w_16 z_(k-16), with weights learnt by the normalised least-mean-square rule (Nagumo and Noda 1967;
//! Haykin, "Adaptive Filter Theory", chapter on normalised LMS), w <- w + mu e z / (delta + |z|^2), e = z_k - y_k: the scheme
//! used to denoise fibre-optic gyros, whose noise is unpredictable and whose signal is not. Tuning is ours: order 16, mu = 0.05,
//! delta = 16 variances of the raw noise, weights start as the mean of the last 16 samples.
//!
//! What bounds it for any input: the error counts at most four times sqrt(delta + |z|^2) in learning, a weight stays within -2..2, and
//! the output within twice the largest of the last 16 samples (within the largest while samples are missing).

use crate::error::ConfigError;
use crate::filter::{Estimate, Filter, Observer, Sample};
use crate::noise::{GyroNoise, range};
use crate::plain;
use crate::ranges;
use crate::real::Real;
use crate::reals;
use crate::settings::{Settings, Visit, visit_noise};
use crate::sound;

/// Order of the prediction.
const ORDER: usize = 16;
/// Largest weight: no signal of one frequency needs more.
const LARGEST_WEIGHT: f64 = 2.0;
/// Error over sqrt(delta + |z|^2) that one sample may teach at most.
const LARGEST_LESSON: f64 = 4.0;
/// Output over the largest sample in memory at most.
const LARGEST_REACH: f64 = 2.0;

/// Settings of [`LinearPrediction`].
///
/// # Example
/// ```
/// use stillrate::{GyroNoise, Settings, filters::LinearPredictionSettings};
/// let settings = LinearPredictionSettings::defaults(50.0, GyroNoise::from_density_two_sided(0.015));
/// assert_eq!(settings.step_size, 0.05);
/// let hasty = LinearPredictionSettings { step_size: 2.0, ..settings }; // from here on learning diverges
/// assert_eq!(hasty.build::<f64>().unwrap_err().field, "step_size");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LinearPredictionSettings {
    /// Nominal sample rate, Hz.
    pub sample_rate_hz: f64,
    /// Noise of the gyro; its density gives the regularisation.
    pub noise: GyroNoise,
    /// Step size mu of the learning rule, above 0 and below 2; default 0.05.
    pub step_size: f64,
}

impl Settings for LinearPredictionSettings {
    const METHOD: &'static str = "linear-prediction";
    type Filter<T: Real> = LinearPrediction<T>;

    fn defaults(sample_rate_hz: f64, noise: GyroNoise) -> Self {
        Self { sample_rate_hz, noise, step_size: 0.05 }
    }

    fn visit<V: Visit>(&mut self, visitor: &mut V) {
        visitor.number("sample_rate_hz", &mut self.sample_rate_hz);
        visit_noise(visitor, &mut self.noise);
        visitor.number("step_size", &mut self.step_size);
    }

    fn build<T: Real>(&self) -> Result<LinearPrediction<T>, ConfigError> {
        ranges::check(self)?;
        let rate = self.sample_rate_hz;
        let unit = self.noise.density_dps_sqrt_hz * rate.root();
        Ok(LinearPrediction {
            period_s: T::of(1.0 / rate),
            step_size: T::of(self.step_size),
            unit: T::of(unit),
            limit: range(unit),
        })
    }
}

plain! {
    /// Forward linear prediction of order 16; the first sample starts it.
    ///
    /// A missing sample is replaced by its prediction, from which nothing is learnt. An irregular time step counts as the nearest whole
    /// number of sample periods; those in between are predicted, 16 at most.
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Sample, Settings, filters::LinearPredictionSettings};
    /// let settings = LinearPredictionSettings::defaults(50.0, GyroNoise::from_density_two_sided(0.015));
    /// let filter = settings.build::<f64>()?;
    /// let mut state = filter.start();
    /// for _ in 0..20 {
    ///     assert_eq!(filter.step(&mut state, Sample { value: 3.0, dt: 0.02 }).rate, 3.0);
    /// }
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct LinearPrediction<T> {
        /// Nominal sample period, s.
        pub period_s: T,
        /// Step size mu.
        pub step_size: T,
        /// Standard deviation of the raw noise, deg/s: the unit that the state is kept in.
        pub unit: T,
        /// Values beyond this magnitude count as missing.
        pub limit: T,
    }
}

reals! {
    /// State of [`LinearPrediction`], in units of the noise's standard deviation.
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Sample, Settings, filters::LinearPredictionSettings};
    /// let noise = GyroNoise::from_standard_deviation_at_rate(0.1, 50.0);
    /// let filter = LinearPredictionSettings::defaults(50.0, noise).build::<f64>()?;
    /// let mut state = filter.start();
    /// assert_eq!(state.weights, [1.0 / 16.0; 16]); // a mean, before anything is learnt
    /// for value in [0.1, 0.2] {
    ///     filter.step(&mut state, Sample { value, dt: 0.02 });
    /// }
    /// assert!((state.history[0] - 2.0).abs() < 1e-12 && (state.history[1] - 1.0).abs() < 1e-12); // newest first, in sigmas
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct LinearPredictionState {
        /// The last samples, the newest first.
        pub history: [T; ORDER],
        /// Weight of each.
        pub weights: [T; ORDER],
        /// Last output.
        pub output: T,
        /// 1 once a sample has been seen.
        pub started: T,
    }
}

/// The prediction of the next sample, at most `reach` times the largest of those in memory.
#[inline(always)]
fn predict<T: Real>(history: &[T; ORDER], weights: &[T; ORDER], reach: T) -> T {
    let (mut sum, mut largest) = (T::ZERO, T::ZERO);
    for (&number, &weight) in history.iter().zip(weights) {
        sum += weight * number;
        largest = largest.most(number.magnitude());
    }
    sum.limited(-reach * largest, reach * largest)
}

/// The history with one more sample in front.
#[inline(always)]
fn pushed<T: Real>(history: &[T; ORDER], newest: T) -> [T; ORDER] {
    core::array::from_fn(|i| if i == 0 { newest } else { history[i - 1] })
}

/// Weights after the lesson of one error.
#[inline(always)]
fn learnt<T: Real>(history: &[T; ORDER], weights: &[T; ORDER], error: T, step_size: T) -> [T; ORDER] {
    let mut power = T::of(ORDER as f64);
    for &number in history {
        power += number * number;
    }
    let bound = T::of(LARGEST_LESSON) * power.root();
    let lesson = step_size * error.limited(-bound, bound) / power;
    let largest = T::of(LARGEST_WEIGHT);
    core::array::from_fn(|i| (weights[i] + lesson * history[i]).limited(-largest, largest).flushed())
}

impl<T: Real> Filter<T> for LinearPrediction<T> {
    type State = LinearPredictionState<T>;
    const SIDE_BY_SIDE: bool = false;

    fn start(&self) -> LinearPredictionState<T> {
        let weights = [T::ONE / T::of(ORDER as f64); ORDER];
        LinearPredictionState { history: [T::ZERO; ORDER], weights, output: T::ZERO, started: T::ZERO }
    }

    fn accepts(&self, state: &LinearPredictionState<T>) -> bool {
        let limit = self.limit / self.unit;
        let history = state.history.iter().all(|&sample| sound::at_most(sample, limit));
        let weights = state.weights.iter().all(|&weight| sound::at_most(weight, T::of(LARGEST_WEIGHT)));
        history && weights && sound::at_most(state.output, T::of(LARGEST_REACH) * limit) && sound::flag(state.started)
    }

    fn period(&self) -> T {
        self.period_s
    }

    #[inline(always)]
    fn observe<O: Observer<T>>(
        &self,
        state: &mut LinearPredictionState<T>,
        sample: Sample<T>,
        _observer: &mut O,
    ) -> Estimate<T> {
        let checked = sample.check(self.limit, self.period_s);
        state.started = checked.known(state.started);
        let value = checked.value / self.unit;
        let mut sound = state.output.finite();
        for (&number, &weight) in state.history.iter().zip(&state.weights) {
            sound =
                sound && number.magnitude() <= self.limit / self.unit && weight.magnitude() <= T::of(LARGEST_WEIGHT);
        }
        // The time step is the same for every channel, so this loop does not part them.
        let mut history = state.history;
        let mut covered = self.period_s * T::of(1.5);
        for _ in 0..ORDER {
            if checked.dt < covered {
                break;
            }
            let between = predict(&history, &state.weights, T::ONE);
            history = pushed(&history, between);
            covered += self.period_s;
        }
        // What stands in for a sample must not outgrow the others, or a long gap would run away.
        let reach = T::select(checked.present, T::of(LARGEST_REACH), T::ONE);
        let prediction = predict(&history, &state.weights, reach);
        let weights = learnt(&history, &state.weights, value - prediction, self.step_size);

        let fresh = state.started == T::ZERO || checked.restart || !sound;
        // Over a missing sample the prediction stands in for it, unless there was nothing to predict from or no time passed.
        let coasts = !checked.present && checked.moves && !fresh;
        let renewed = (checked.present && fresh) || !sound;
        let start = self.start();
        let with_value = pushed(&history, value);
        let with_prediction = pushed(&history, prediction);
        for i in 0..ORDER {
            let moved = T::select(checked.present, with_value[i], with_prediction[i]).flushed();
            let moved = T::select(checked.present || coasts, moved, state.history[i]);
            state.history[i] = T::select(renewed, value, moved);
            let taught = T::select(checked.present, weights[i], state.weights[i]);
            state.weights[i] = T::select(renewed, start.weights[i], taught);
        }
        let moved = T::select(checked.present || coasts, prediction, state.output);
        state.output = T::select(renewed, value, moved);
        let renewed_start = T::select(checked.present, T::ONE, T::ZERO);
        state.started = T::select(renewed, renewed_start, state.started);
        Estimate {
            rate: state.output * self.unit,
            acceleration: T::ZERO,
            variance: T::ZERO,
            flags: checked.flags_after(state.started, sound),
        }
    }
}
