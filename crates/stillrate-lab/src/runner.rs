//! One face for every method: a filter built by name, with its channels, run over arrays or sample by sample.
//!
//! The numerics stay in the core; this module moves samples between arrays of any stride and the small tiles of
//! rows that [`stillrate::Filter::tile`] works on, chooses the widest vector instructions of the machine once a tile, and
//! keeps the state between calls. Batch, chunked and streamed runs therefore give the same bits.

use rayon::prelude::*;
use stillrate::filter::{Estimate, Filter, Flags, ModelTrace, Observer, Sample};
use stillrate::{ConfigError, Real, Reals, Settings};

use crate::saved;
use crate::settings_map::{SettingsError, SettingsMap, from_map, nearest, to_map};
use crate::wide;

/// From this many samples on, groups of channels run on several threads; which thread never changes a bit.
const PARALLEL_FROM: usize = 1 << 15;

/// Numbers of a saved estimate besides the probabilities: see [`Watched::scatter`].
const ESTIMATE_NUMBERS: usize = 5;

/// Number type that a filter computes in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// `f32`
    Single,
    /// `f64`
    Double,
}

/// A read-only table of samples with any non-negative strides (in items).
#[derive(Clone, Copy, Debug)]
pub struct Table<'a, T> {
    /// The items; `rows` and `channels` never reach beyond them.
    pub items: &'a [T],
    /// Number of samples.
    pub rows: usize,
    /// Number of channels.
    pub channels: usize,
    /// Items from one sample to the next.
    pub row_stride: usize,
    /// Items from one channel to the next.
    pub channel_stride: usize,
}

/// Samples in either precision.
#[derive(Clone, Copy, Debug)]
pub enum Source<'a> {
    /// `f32` samples.
    Single(Table<'a, f32>),
    /// `f64` samples.
    Double(Table<'a, f64>),
}

/// Where filtered samples go: contiguous, sample-major, in the filter's own precision.
#[derive(Debug)]
pub enum Sink<'a> {
    /// For a filter in `f32`.
    Single(&'a mut [f32]),
    /// For a filter in `f64`.
    Double(&'a mut [f64]),
}

/// Time between samples.
#[derive(Clone, Copy, Debug)]
pub enum Timing<'a> {
    /// Every sample is one nominal period after the one before.
    Regular,
    /// The time step of each sample in seconds.
    Steps(&'a [f64]),
}

/// What a run looks like from inside: one entry a sample and channel, channels fastest.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    /// Number of models of the filter.
    pub models: usize,
    /// Filtered rate.
    pub rate: Vec<f64>,
    /// Its derivative.
    pub acceleration: Vec<f64>,
    /// Variance of the rate.
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

/// The last estimate of one channel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LastEstimate {
    /// Filtered rate.
    pub rate: f64,
    /// Its derivative.
    pub acceleration: f64,
    /// Variance of the rate.
    pub variance: f64,
    /// Manoeuvre frequency in Hz; NaN for methods without one.
    pub frequency_hz: f64,
    /// [`Flags`] as bits.
    pub flags: u32,
    /// Posterior model probabilities.
    pub probability: Vec<f64>,
}

/// A filter with its channels, whatever the method and precision.
pub trait Runner: Send {
    /// Name of the method.
    fn method(&self) -> &'static str;
    /// Every setting, by name.
    fn settings(&self) -> SettingsMap;
    /// Number type it computes in.
    fn precision(&self) -> Precision;
    /// Number of channels.
    fn channels(&self) -> usize;
    /// Number of models in its bank.
    fn models(&self) -> usize;
    /// Back to the state before the first sample.
    fn reset(&mut self);
    /// One sample a channel, in place; `dt_s` is the nominal period if `None`.
    fn update(&mut self, values: &mut [f64], dt_s: Option<f64>);
    /// Filters a table; `sink` holds as many numbers as the table. Returns false if shapes or precision do not fit.
    fn run(&mut self, source: Source<'_>, timing: Timing<'_>, sink: Sink<'_>) -> bool;
    /// Filters a table and keeps what happened inside.
    fn trace(&mut self, source: Source<'_>, timing: Timing<'_>) -> Trace;
    /// The last estimate of a channel from [`Runner::update`] or [`Runner::trace`], of what is known after [`Runner::run`].
    fn estimate(&self, channel: usize) -> LastEstimate;
    /// Configuration and state as versioned, checksummed bytes.
    fn save(&self) -> Vec<u8>;
    /// Takes a state that [`Runner::save`] wrote; false if the numbers do not fit.
    fn load(&mut self, numbers: &[f64]) -> bool;
    /// Another one with the same configuration and state.
    fn duplicate(&self) -> Box<dyn Runner>;
}

/// Builds a filter by the name of its method.
///
/// # Errors
/// [`SettingsError`] with the field, value, unit and range, or the nearest known name.
///
/// # Example
/// ```
/// use stillrate_lab::runner::{Precision, build};
/// use stillrate_lab::settings_map::{SettingsMap, Value};
/// let settings = SettingsMap::from([("sample_rate_hz".to_string(), Value::Number(50.0))]);
/// let mut filter = build("pt1", &settings, 1, Precision::Double)?;
/// let mut sample = [0.12];
/// filter.update(&mut sample, None);
/// assert_eq!(sample, [0.12]);
/// # Ok::<(), stillrate_lab::settings_map::SettingsError>(())
/// ```
pub fn build(
    method: &str,
    settings: &SettingsMap,
    channels: usize,
    precision: Precision,
) -> Result<Box<dyn Runner>, SettingsError> {
    if channels == 0 || channels > 1 << 20 {
        let value = channels as f64;
        return Err(ConfigError::new("channels", value, "", "a whole number from 1 to 1048576").into());
    }
    macro_rules! by_name {
        ($($name:ident),* $(,)?) => {
            match method {
                $(<stillrate::filters::$name as Settings>::METHOD => {
                    start::<stillrate::filters::$name>(settings, channels, precision)
                })*
                other => {
                    let known = [$(<stillrate::filters::$name as Settings>::METHOD),*];
                    let hint = nearest(other, &known).map_or(String::new(), |near| format!(": did you mean '{near}'?"));
                    Err(SettingsError::Text(format!("no method '{other}' (one of {}){hint}", known.join(", "))))
                }
            }
        };
    }
    stillrate::methods!(by_name)
}

/// Names of all methods.
#[must_use]
pub fn method_names() -> Vec<&'static str> {
    macro_rules! names {
        ($($name:ident),* $(,)?) => { vec![$(<stillrate::filters::$name as Settings>::METHOD),*] };
    }
    stillrate::methods!(names)
}

fn start<S: Settings>(
    map: &SettingsMap,
    channels: usize,
    precision: Precision,
) -> Result<Box<dyn Runner>, SettingsError> {
    let settings: S = from_map(map)?;
    Ok(match precision {
        Precision::Single => Box::new(Running::<S, f32>::new(settings, channels)?),
        Precision::Double => Box::new(Running::<S, f64>::new(settings, channels)?),
    })
}

type StateOf<S, T> = <<S as Settings>::Filter<T> as Filter<T>>::State;

struct Running<S: Settings, T: Real> {
    settings: S,
    filter: S::Filter<T>,
    states: Vec<StateOf<S, T>>,
    last: Vec<Watched<T, StateOf<S, T>>>,
}

impl<S: Settings, T: wide::Wide> Running<S, T> {
    fn new(settings: S, channels: usize) -> Result<Self, ConfigError> {
        let filter = settings.build::<T>()?;
        let blank = Watched::blank(filter.models());
        Ok(Self { states: vec![filter.start(); channels], last: vec![blank; channels], settings, filter })
    }

    /// Runs every channel over the source, the widest group of channels that fits at a time.
    fn run_source(&mut self, source: Source<'_>, timing: Timing<'_>, output: &mut [T]) {
        let (rows, channels) = source.shape();
        let filter = &self.filter;
        let run = |first: usize, group: &mut [StateOf<S, T>], output: &wide::Columns<'_, T>| match group.len() {
            1 => wide::run_group::<T, _, 1>(filter, group, first, source, timing, output),
            few if few <= 4 => wide::run_group::<T, _, 4>(filter, group, first, source, timing, output),
            _ => T::run_widest(filter, group, first, source, timing, output),
        };
        let output = wide::Columns::new(output, channels);
        // Full groups first, then what is left: by fours if that fills half a group at most.
        let full = channels - channels % T::WIDTH;
        let rest = channels - full;
        let narrow = if rest > T::WIDTH / 2 { T::WIDTH } else { 4 };
        let (wide_states, rest_states) = self.states.split_at_mut(full);
        let mut groups: Vec<(usize, &mut [StateOf<S, T>])> =
            wide_states.chunks_mut(T::WIDTH).enumerate().map(|(k, group)| (k * T::WIDTH, group)).collect();
        groups.extend(rest_states.chunks_mut(narrow).enumerate().map(|(k, group)| (full + k * narrow, group)));
        if groups.len() > 1 && rows * channels >= PARALLEL_FROM {
            groups.into_par_iter().for_each(|(first, group)| run(first, group, &output));
        } else {
            groups.into_iter().for_each(|(first, group)| run(first, group, &output));
        }
    }

    fn trace_source(&mut self, source: Source<'_>, timing: Timing<'_>) -> Trace {
        let (channels, models) = (self.states.len(), self.filter.models());
        let mut trace = Trace { models, ..Trace::default() };
        for row in 0..source.shape().0 {
            for c in 0..channels {
                let value = T::of(source.at(row, c));
                let dt = match timing {
                    Timing::Regular => self.filter.period(),
                    Timing::Steps(steps) => T::of(steps[row]),
                };
                self.watch(c, Sample { value, dt });
                let last = &self.last[c];
                trace.rate.push(last.estimate.rate.widen());
                trace.acceleration.push(last.estimate.acceleration.widen());
                trace.variance.push(last.estimate.variance.widen());
                trace.frequency_hz.push(last.frequency_hz());
                trace.flags.push(last.estimate.flags.0);
            }
            for m in 0..models {
                for last in &self.last {
                    trace.probability.push(last.models[m].probability.widen());
                    trace.per_model.push(widened(&last.models[m]));
                }
            }
        }
        trace
    }

    fn watch(&mut self, c: usize, sample: Sample<T>) {
        let last = &mut self.last[c];
        let mut state = self.states[c];
        last.estimate = self.filter.observe(&mut state, sample, &mut Watcher(&mut last.models, &mut last.frequency));
        self.states[c] = state;
        last.unseen = None;
    }

    /// What the last sample left behind, with models and frequency up to date.
    fn seen(&self, last: &Watched<T, StateOf<S, T>>) -> Watched<T, StateOf<S, T>> {
        let mut last = last.clone();
        if let Some((mut state, sample)) = last.unseen.take() {
            self.filter.observe(&mut state, sample, &mut Watcher(&mut last.models, &mut last.frequency));
        }
        last
    }

    /// One sample, unwatched; what is needed to watch it afterwards is kept.
    fn step(&mut self, c: usize, sample: Sample<T>) -> T {
        let last = &mut self.last[c];
        last.unseen = Some((self.states[c], sample));
        last.estimate = self.filter.step(&mut self.states[c], sample);
        last.estimate.rate
    }
}

fn widened<T: Real>(model: &ModelTrace<T>) -> ModelTrace<f64> {
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
struct Watched<T, U> {
    estimate: Estimate<T>,
    models: Vec<ModelTrace<T>>,
    frequency: T,
    /// State before the last sample and that sample, if it ran unwatched: models and frequency are then behind.
    unseen: Option<(U, Sample<T>)>,
}

impl<T: Real, U> Watched<T, U> {
    fn blank(models: usize) -> Self {
        let certain = ModelTrace { probability: T::ONE / T::of(models as f64), ..ModelTrace::default() };
        let estimate = Estimate { flags: Flags::NO_DATA_YET, ..Estimate::default() };
        Self { estimate, models: vec![certain; models], frequency: T::of(f64::NAN), unseen: None }
    }

    fn frequency_hz(&self) -> f64 {
        self.frequency.widen() / core::f64::consts::TAU
    }

    /// The estimate as numbers: rate, acceleration, variance, frequency in rad/s, flags, probability of each model.
    fn scatter(&self, numbers: &mut Vec<T>) {
        let Estimate { rate, acceleration, variance, flags } = self.estimate;
        numbers.extend([rate, acceleration, variance, self.frequency, T::of(f64::from(flags.0))]);
        numbers.extend(self.models.iter().map(|model| model.probability));
    }

    /// Takes what [`Watched::scatter`] gave.
    fn gather(&mut self, numbers: &[f64]) {
        let [rate, acceleration, variance, frequency, flags, probabilities @ ..] = numbers else { return };
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
    }
}

struct Watcher<'a, T>(&'a mut [ModelTrace<T>], &'a mut T);

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

impl<S: Settings, T: wide::Wide> Runner for Running<S, T> {
    fn method(&self) -> &'static str {
        S::METHOD
    }
    fn settings(&self) -> SettingsMap {
        to_map(&self.settings)
    }
    fn precision(&self) -> Precision {
        T::PRECISION
    }
    fn channels(&self) -> usize {
        self.states.len()
    }
    fn models(&self) -> usize {
        self.filter.models()
    }
    fn reset(&mut self) {
        self.states.fill(self.filter.start());
        self.last.fill(Watched::blank(self.filter.models()));
    }

    fn update(&mut self, values: &mut [f64], dt_s: Option<f64>) {
        let dt = dt_s.map_or(self.filter.period(), T::of);
        for (c, value) in values.iter_mut().enumerate().take(self.states.len()) {
            *value = self.step(c, Sample { value: T::of(*value), dt }).widen();
        }
    }

    fn run(&mut self, source: Source<'_>, timing: Timing<'_>, sink: Sink<'_>) -> bool {
        let Some(output) = T::sink(sink) else { return false };
        let (rows, channels) = source.shape();
        let timed = match timing {
            Timing::Regular => true,
            Timing::Steps(steps) => steps.len() == rows,
        };
        if channels != self.states.len() || output.len() != rows * channels || !timed {
            return false;
        }
        // All but the last sample at full speed, the last one watched, so that the estimate is complete.
        let ahead = rows.saturating_sub(1);
        let (timing, last_step) = match timing {
            Timing::Regular => (Timing::Regular, None),
            Timing::Steps(steps) => (Timing::Steps(&steps[..ahead]), steps.last().copied()),
        };
        self.run_source(source.first(ahead), timing, &mut output[..ahead * channels]);
        if rows > 0 {
            let mut values: Vec<f64> = (0..channels).map(|c| source.at(ahead, c)).collect();
            self.update(&mut values, last_step);
            for (out, value) in output[ahead * channels..].iter_mut().zip(&values) {
                *out = T::of(*value);
            }
        }
        true
    }

    fn trace(&mut self, source: Source<'_>, timing: Timing<'_>) -> Trace {
        self.trace_source(source, timing)
    }

    fn estimate(&self, channel: usize) -> LastEstimate {
        let Some(last) = self.last.get(channel) else { return LastEstimate::default() };
        let last = self.seen(last);
        LastEstimate {
            rate: last.estimate.rate.widen(),
            acceleration: last.estimate.acceleration.widen(),
            variance: last.estimate.variance.widen(),
            frequency_hz: last.frequency_hz(),
            flags: last.estimate.flags.0,
            probability: last.models.iter().map(|model| model.probability.widen()).collect(),
        }
    }

    fn save(&self) -> Vec<u8> {
        let mut numbers = Vec::new();
        for state in &self.states {
            state.scatter(&mut |number: T| numbers.push(number));
        }
        self.last.iter().for_each(|last| self.seen(last).scatter(&mut numbers));
        saved::write(S::METHOD, &self.settings(), self.states.len(), &numbers)
    }

    fn load(&mut self, numbers: &[f64]) -> bool {
        let count = <StateOf<S, T> as Reals<T>>::COUNT;
        let watched = ESTIMATE_NUMBERS + self.filter.models();
        let Some((states, estimates)) = numbers.split_at_checked(count * self.states.len()) else { return false };
        // The first files of this version ended with the states.
        if !estimates.is_empty() && estimates.len() != watched * self.states.len() {
            return false;
        }
        for (state, part) in self.states.iter_mut().zip(states.chunks_exact(count)) {
            let mut next = part.iter();
            *state = Reals::gather(&mut || T::of(next.next().copied().unwrap_or(0.0)));
        }
        for (last, part) in self.last.iter_mut().zip(estimates.chunks_exact(watched)) {
            last.gather(part);
        }
        true
    }

    fn duplicate(&self) -> Box<dyn Runner> {
        Box::new(Self {
            settings: self.settings.clone(),
            filter: self.filter,
            states: self.states.clone(),
            last: self.last.clone(),
        })
    }
}

impl Source<'_> {
    /// Number of samples and of channels.
    #[must_use]
    pub fn shape(&self) -> (usize, usize) {
        match self {
            Self::Single(table) => (table.rows, table.channels),
            Self::Double(table) => (table.rows, table.channels),
        }
    }
    /// The first `rows` samples.
    #[must_use]
    pub fn first(self, rows: usize) -> Self {
        match self {
            Self::Single(table) => Self::Single(table.first(rows)),
            Self::Double(table) => Self::Double(table.first(rows)),
        }
    }
    /// One sample, widened.
    #[must_use]
    pub fn at(&self, row: usize, channel: usize) -> f64 {
        match self {
            Self::Single(table) => table.at(row, channel).widen(),
            Self::Double(table) => table.at(row, channel),
        }
    }
}

impl<'a, T: Copy> Table<'a, T> {
    /// The table's first `rows` samples.
    #[must_use]
    pub fn first(self, rows: usize) -> Self {
        Self { rows: rows.min(self.rows), ..self }
    }
    /// One item.
    #[must_use]
    pub fn at(&self, row: usize, channel: usize) -> T {
        self.items[row * self.row_stride + channel * self.channel_stride]
    }
    /// A table over contiguous, sample-major items; `None` if they do not divide into `channels`.
    #[must_use]
    pub fn contiguous(items: &'a [T], channels: usize) -> Option<Self> {
        (channels > 0 && items.len().is_multiple_of(channels)).then(|| Self {
            items,
            rows: items.len() / channels,
            channels,
            row_stride: channels,
            channel_stride: 1,
        })
    }
}

/// Reads a state saved by [`Runner::save`] and continues it.
///
/// # Errors
/// A sentence that says why the bytes are refused: truncated, altered, of another version, or out of range.
pub fn restore(bytes: &[u8]) -> Result<Box<dyn Runner>, SettingsError> {
    let saved = saved::read(bytes).map_err(SettingsError::Text)?;
    let mut runner = build(&saved.method, &saved.settings, saved.channels, saved.precision)?;
    if runner.load(&saved.numbers) {
        Ok(runner)
    } else {
        Err(SettingsError::Text("saved state does not fit its configuration".into()))
    }
}
