//! A filter of one method and precision behind [`Runner`]: groups of channels over tables, single samples, watched ones, and its
//! state as numbers.

use rayon::prelude::*;
use stillrate::filter::{Filter, Sample};
use stillrate::{ConfigError, Real, Reals, Settings};

use super::face::{Restorable, Runner};
use super::watched::{ESTIMATE_NUMBERS, LastEstimate, Trace, Watched, Watcher, widened};
use super::wide::{Columns, Group, Wide, run_group};
use crate::samples::{Precision, Sink, Source, Timing};
use crate::saved;
use crate::settings_map::{SettingsMap, to_map};

/// From this many samples on, groups of channels run on several threads; which thread never changes a bit.
const PARALLEL_FROM: usize = 1 << 15;

type StateOf<S, T> = <<S as Settings>::Filter<T> as Filter<T>>::State;

/// A filter of one method and precision, with the state of each channel.
pub(super) struct Running<S: Settings, T: Real> {
    settings: S,
    filter: S::Filter<T>,
    states: Vec<StateOf<S, T>>,
    last: Vec<Watched<T, StateOf<S, T>>>,
}

impl<S: Settings, T: Wide> Running<S, T> {
    pub(super) fn new(settings: S, channels: usize) -> Result<Self, ConfigError> {
        let filter = settings.build::<T>()?;
        let blank = Watched::blank(filter.models());
        Ok(Self { states: vec![filter.start(); channels], last: vec![blank; channels], settings, filter })
    }

    /// Runs every channel over the source, the widest group of channels that fits at a time.
    fn run_source(&mut self, source: Source<'_>, timing: Timing<'_>, output: &mut [T]) {
        let (rows, channels) = source.shape();
        let filter = &self.filter;
        let output = Columns::new(output, channels);
        let run = |first: usize, states: &mut [StateOf<S, T>]| {
            let group = Group { first, source, timing, output: &output };
            match states.len() {
                1 => run_group::<T, _, 1>(filter, states, &group),
                few if few <= 4 => run_group::<T, _, 4>(filter, states, &group),
                _ => T::run_widest(filter, states, &group),
            }
        };
        // Full groups first, then what is left: by fours if that fills half a group at most; or one channel after the other.
        let full = if S::Filter::<T>::SIDE_BY_SIDE { channels - channels % T::WIDTH } else { 0 };
        let rest = channels - full;
        let narrow = match rest {
            _ if !S::Filter::<T>::SIDE_BY_SIDE => 1,
            many if many > T::WIDTH / 2 => T::WIDTH,
            _ => 4,
        };
        let (wide_states, rest_states) = self.states.split_at_mut(full);
        let mut groups: Vec<(usize, &mut [StateOf<S, T>])> =
            wide_states.chunks_mut(T::WIDTH).enumerate().map(|(k, group)| (k * T::WIDTH, group)).collect();
        groups.extend(rest_states.chunks_mut(narrow).enumerate().map(|(k, group)| (full + k * narrow, group)));
        if groups.len() > 1 && rows * channels >= PARALLEL_FROM {
            groups.into_par_iter().for_each(|(first, group)| run(first, group));
        } else {
            for (first, group) in groups {
                run(first, group);
            }
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

impl<S: Settings, T: Wide> Runner for Running<S, T> {
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
        for last in &self.last {
            self.seen(last).scatter(&mut numbers);
        }
        saved::write(S::METHOD, &self.settings(), self.states.len(), &numbers)
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

impl<S: Settings, T: Wide> Restorable for Running<S, T> {
    fn fits(&self, numbers: usize, channels: usize) -> bool {
        let count = <StateOf<S, T> as Reals<T>>::COUNT;
        let watched = ESTIMATE_NUMBERS + self.filter.models();
        // The first files of this version ended with the states.
        [count, count + watched].iter().any(|each| each.checked_mul(channels) == Some(numbers))
    }

    fn load(&mut self, numbers: &[f64]) -> Result<(), String> {
        let count = <StateOf<S, T> as Reals<T>>::COUNT;
        let watched = ESTIMATE_NUMBERS + self.filter.models();
        if !self.fits(numbers.len(), self.states.len()) {
            return Err("saved state does not fit its configuration".into());
        }
        let (states, estimates) = numbers.split_at(count * self.states.len());
        let refused = |channel: usize, what: &str| {
            format!(
                "saved {what} of channel {channel} is none that a {} filter can have (damaged or made up)",
                S::METHOD
            )
        };
        let mut restored = self.states.clone();
        for (channel, (state, part)) in restored.iter_mut().zip(states.chunks_exact(count)).enumerate() {
            let mut next = part.iter();
            *state = Reals::gather(&mut || T::of(next.next().copied().unwrap_or(0.0)));
            if !self.filter.accepts(state) {
                return Err(refused(channel, "state"));
            }
        }
        let mut last = vec![Watched::blank(self.filter.models()); self.states.len()];
        for (channel, (last, part)) in last.iter_mut().zip(estimates.chunks_exact(watched)).enumerate() {
            if !last.gather(part) {
                return Err(refused(channel, "estimate"));
            }
        }
        (self.states, self.last) = (restored, last);
        Ok(())
    }
}
