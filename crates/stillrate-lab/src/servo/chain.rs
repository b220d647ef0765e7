//! Filters by name: any method of the library, or a textbook filter, one after the other.

use super::discrete::Discrete;
use super::loop_filter::LoopFilter;
use crate::runner::{self, Precision};
use crate::settings_map::{SettingsError, SettingsMap, Value};

/// A method and its settings.
pub type Link = (String, SettingsMap);

/// Filters one after the other.
struct Series(Vec<Box<dyn LoopFilter>>);

impl LoopFilter for Series {
    fn reset(&mut self) {
        self.0.iter_mut().for_each(|f| f.reset());
    }
    fn step(&mut self, rate_dps: f64) -> f64 {
        self.0.iter_mut().fold(rate_dps, |value, f| f.step(value))
    }
}

/// A chain of methods by name, first to last; an empty chain is no filter. Names are the library's, and those of the filters of
/// [`discrete`](super::discrete): "loop-pt1" and "loop-butterworth" (`sample_rate_hz`, `cutoff_hz`), "loop-kalman" (`phi`, `ratio`).
///
/// # Errors
/// [`SettingsError`] of the first one that cannot be built.
///
/// # Example
/// ```
/// use stillrate_lab::servo::chain::by_name;
/// use stillrate_lab::settings_map::{SettingsMap, Value};
/// let kalman = |ratio| SettingsMap::from([("phi".into(), Value::Number(1.0)), ("ratio".into(), Value::Number(ratio))]);
/// let mut twice = by_name(&[("loop-kalman".into(), kalman(0.5)), ("loop-kalman".into(), kalman(0.5))]).unwrap();
/// for _ in 0..100 {
///     twice.step(0.0);
/// }
/// assert!((twice.step(1.0) - 0.25).abs() < 1e-12); // a ratio of 1/2 settles to a gain of 1/2
/// let refused = by_name(&[("loop-kalman".into(), SettingsMap::new())]).err().unwrap();
/// assert_eq!(refused.to_string(), "loop-kalman needs the number phi");
/// ```
pub fn by_name(chain: &[Link]) -> Result<Box<dyn LoopFilter>, SettingsError> {
    let mut filters: Vec<Box<dyn LoopFilter>> = Vec::new();
    for (method, settings) in chain {
        filters.push(match textbook(method, settings)? {
            Some(filter) => Box::new(filter),
            None => Box::new(runner::build(method, settings, 1, Precision::Double)?),
        });
    }
    Ok(Box::new(Series(filters)))
}

/// A chain's linear equivalent for the linearised loop, and whether that is all of it: its last textbook, PT1 or second-order
/// low-pass; every other filter counts as fully open.
///
/// # Example
/// ```
/// use stillrate_lab::servo::chain::linear_equivalent;
/// use stillrate_lab::servo::discrete::Discrete;
/// use stillrate_lab::settings_map::{SettingsMap, Value};
/// let pt1 = [("sample_rate_hz".into(), Value::Number(50.0)), ("cutoff_hz".into(), Value::Number(5.3))];
/// let pt1 = ("loop-pt1".to_string(), SettingsMap::from(pt1));
/// let bank = ("ms-imm-ikf".to_string(), SettingsMap::new());
/// assert_eq!(linear_equivalent(&[pt1.clone()]), (Discrete::pt1(50.0, 5.3).unwrap(), true));
/// assert_eq!(linear_equivalent(&[bank, pt1]), (Discrete::pt1(50.0, 5.3).unwrap(), false));
/// ```
#[must_use]
pub fn linear_equivalent(chain: &[Link]) -> (Discrete, bool) {
    let found: Vec<Discrete> = chain.iter().map(linear_link).filter(|link| *link != Discrete::None).collect();
    (found.last().copied().unwrap_or(Discrete::None), found.len() == chain.len() && chain.len() <= 1)
}

fn textbook(method: &str, settings: &SettingsMap) -> Result<Option<Discrete>, SettingsError> {
    let needed = |name: &str| {
        number(settings, name).ok_or_else(|| SettingsError::Text(format!("{method} needs the number {name}")))
    };
    Ok(Some(match method {
        "loop-pt1" => Discrete::pt1(needed("sample_rate_hz")?, needed("cutoff_hz")?)?,
        "loop-butterworth" => Discrete::butterworth(needed("sample_rate_hz")?, needed("cutoff_hz")?)?,
        "loop-kalman" => Discrete::kalman(needed("phi")?, needed("ratio")?)?,
        _ => return Ok(None),
    }))
}

fn linear_link((method, settings): &Link) -> Discrete {
    if let Ok(Some(filter)) = textbook(method, settings) {
        return filter;
    }
    match (method.as_str(), number(settings, "sample_rate_hz"), number(settings, "cutoff_hz")) {
        // The library's PT1 is the backward Euler form.
        ("pt1", Some(rate), Some(cutoff)) => {
            let x = core::f64::consts::TAU * cutoff / rate;
            Discrete::Pt1 { gain: x / (1.0 + x), level: None }
        }
        // The library's second-order low-pass has the transfer function of the textbook's unless its quality was set.
        ("biquad", Some(rate), Some(cutoff)) if number(settings, "quality").is_none() => {
            Discrete::butterworth(rate, cutoff).unwrap_or(Discrete::None)
        }
        _ => Discrete::None,
    }
}

fn number(settings: &SettingsMap, name: &str) -> Option<f64> {
    match settings.get(name) {
        Some(Value::Number(value)) => Some(*value),
        _ => None,
    }
}
