//! A filter that stands in the loop: any method of the library by name, any filter value, or several in a row.
//!
//! Loops run at 50 to 1000 Hz and spend their time in the plant, so one indirect call a tick costs nothing; the step
//! behind it is the library's own [`Filter::step`](stillrate::Filter::step). Rates are deg/s at a filter's edge, as everywhere in the
//! library.

use stillrate::{Filter, Sample};

use super::discrete::Discrete;
use crate::runner::{self, Precision, Runner};
use crate::settings_map::{SettingsError, SettingsMap, Value};

/// A rate filter with its state.
pub trait LoopFilter: Send {
    /// Back to the state before the first sample.
    fn reset(&mut self);
    /// One sample, deg/s in and out, one control period after the last.
    fn step(&mut self, rate_dps: f64) -> f64;
}

/// No filter.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unfiltered;

impl LoopFilter for Unfiltered {
    fn reset(&mut self) {}
    fn step(&mut self, rate_dps: f64) -> f64 {
        rate_dps
    }
}

/// A filter value with its state.
///
/// # Example
/// ```
/// use stillrate::filters::Pt1;
/// use stillrate_lab::servo::loop_filter::{InLoop, LoopFilter};
/// let mut filter = InLoop::new(Pt1::new(50.0, 5.3).unwrap());
/// assert_eq!(filter.step(1.0), 1.0);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct InLoop<F: Filter<f64>> {
    filter: F,
    state: F::State,
}

impl<F: Filter<f64>> InLoop<F> {
    /// The filter at its start.
    pub fn new(filter: F) -> Self {
        Self { state: filter.start(), filter }
    }
}

impl<F: Filter<f64>> LoopFilter for InLoop<F> {
    fn reset(&mut self) {
        self.state = self.filter.start();
    }
    fn step(&mut self, rate_dps: f64) -> f64 {
        self.filter.step(&mut self.state, Sample { value: rate_dps, dt: self.filter.period() }).rate
    }
}

impl LoopFilter for Box<dyn Runner> {
    fn reset(&mut self) {
        (**self).reset();
    }
    fn step(&mut self, rate_dps: f64) -> f64 {
        let mut value = [rate_dps];
        self.update(&mut value, None);
        value[0]
    }
}

/// Filters one after the other.
pub struct Series(pub Vec<Box<dyn LoopFilter>>);

impl LoopFilter for Series {
    fn reset(&mut self) {
        self.0.iter_mut().for_each(|f| f.reset());
    }
    fn step(&mut self, rate_dps: f64) -> f64 {
        self.0.iter_mut().fold(rate_dps, |value, f| f.step(value))
    }
}

/// The filters of [`discrete`](super::discrete) by name: "loop-pt1" and "loop-butterworth" (`sample_rate_hz`, `cutoff_hz`), "loop-kalman"
/// (`phi`, `ratio`).
fn textbook(method: &str, settings: &SettingsMap) -> Result<Option<Discrete>, SettingsError> {
    let number = |name: &str| match settings.get(name) {
        Some(Value::Number(value)) => Ok(*value),
        _ => Err(SettingsError::Text(format!("{method} needs the number {name}"))),
    };
    Ok(Some(match method {
        "loop-pt1" => Discrete::pt1(number("sample_rate_hz")?, number("cutoff_hz")?)?,
        "loop-butterworth" => Discrete::butterworth(number("sample_rate_hz")?, number("cutoff_hz")?)?,
        "loop-kalman" => Discrete::kalman(number("phi")?, number("ratio")?)?,
        _ => return Ok(None),
    }))
}

/// A chain's linear equivalent for the linearised loop, and whether that is all of it: its last textbook, PT1 or second-order
/// low-pass; every other filter counts as fully open.
#[must_use]
pub fn linear_equivalent(chain: &[(String, SettingsMap)]) -> (Discrete, bool) {
    let found: Vec<Discrete> = chain.iter().map(linear_link).filter(|link| *link != Discrete::None).collect();
    (found.last().copied().unwrap_or(Discrete::None), found.len() == chain.len() && chain.len() <= 1)
}

fn linear_link((method, settings): &(String, SettingsMap)) -> Discrete {
    if let Ok(Some(filter)) = textbook(method, settings) {
        return filter;
    }
    let number = |name: &str| match settings.get(name) {
        Some(Value::Number(value)) => Some(*value),
        _ => None,
    };
    match (method.as_str(), number("sample_rate_hz"), number("cutoff_hz")) {
        // The library's PT1 is the backward Euler form.
        ("pt1", Some(rate), Some(cutoff)) => {
            let x = core::f64::consts::TAU * cutoff / rate;
            Discrete::Pt1 { gain: x / (1.0 + x), level: None }
        }
        // The library's second-order low-pass has the transfer function of the textbook's unless its quality was set.
        ("biquad", Some(rate), Some(cutoff)) if number("quality").is_none() => {
            Discrete::butterworth(rate, cutoff).unwrap_or(Discrete::None)
        }
        _ => Discrete::None,
    }
}

/// A chain of methods by name, first to last; an empty chain is no filter. Names are the library's, and those of the textbook filters:
/// "loop-pt1", "loop-butterworth", "loop-kalman".
///
/// # Errors
/// [`SettingsError`] of the first one that cannot be built.
pub fn by_name(chain: &[(String, SettingsMap)]) -> Result<Box<dyn LoopFilter>, SettingsError> {
    let mut filters: Vec<Box<dyn LoopFilter>> = Vec::new();
    for (method, settings) in chain {
        filters.push(match textbook(method, settings)? {
            Some(filter) => Box::new(filter),
            None => Box::new(runner::build(method, settings, 1, Precision::Double)?),
        });
    }
    Ok(Box::new(Series(filters)))
}
