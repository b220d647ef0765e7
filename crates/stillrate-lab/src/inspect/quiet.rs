//! The quietest stretch of a log, and what a filter did there and everywhere.
//!
//! A log rarely says where its sensor stood still. The stretch of given length with the least scatter about its mean is
//! the nearest thing to it; motion that goes on throughout makes it an upper bound of the noise.

use core::ops::Range;

use crate::metrics::{rms_about_mean, rmse};

/// Least share of present samples for a stretch to count.
const LEAST_PRESENT: f64 = 0.9;

/// What a filter did to one channel, in the unit of the record; see [`effect`].
///
/// # Example
/// ```
/// use stillrate_lab::inspect::quiet::{Effect, effect};
/// let raw: Vec<f64> = (0..100).map(|k| if k % 2 == 0 { 1.0 } else { -1.0 }).collect();
/// let halved: Vec<f64> = raw.iter().map(|x| 0.5 * x).collect();
/// let Effect { before, after, removed, .. } = effect(&raw, &halved, 20);
/// assert_eq!((before, after, removed), (1.0, 0.5, 0.5));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Effect {
    /// The quietest stretch of the raw record.
    pub quiet: Range<usize>,
    /// Scatter about the mean there, raw.
    pub before: f64,
    /// Scatter about the mean there, filtered.
    pub after: f64,
    /// RMS of filtered minus raw over the whole record.
    pub removed: f64,
}

/// Finds the stretch of `window` samples with the least scatter about its mean, in hops of a quarter window. A record
/// shorter than two windows is taken whole.
fn quietest(samples: &[f64], window: usize) -> Range<usize> {
    let window = window.max(4);
    if samples.len() < 2 * window {
        return 0..samples.len();
    }
    let present = |range: &Range<usize>| samples[range.clone()].iter().filter(|x| x.is_finite()).count();
    (0..=samples.len() - window)
        .step_by(window / 4)
        .map(|start| start..start + window)
        .filter(|range| present(range) as f64 >= LEAST_PRESENT * window as f64)
        .map(|range| (rms_about_mean(&samples[range.clone()]), range))
        // A record that stands still to the last bit is a stuck sensor, not a quiet one.
        .filter(|(scatter, _)| *scatter > 0.0)
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map_or(0..samples.len(), |(_, range)| range)
}

/// Compares a record with its filtered self over the quietest stretch of `window` samples and as a whole.
///
/// # Example
/// ```
/// use stillrate_lab::inspect::quiet::effect;
/// let raw: Vec<f64> = (0..100).map(|k| if k % 2 == 0 { 1.0 } else { -1.0 }).collect();
/// let found = effect(&raw, &[0.0; 100], 20);
/// assert_eq!((found.before, found.after, found.removed), (1.0, 0.0, 1.0));
/// ```
#[must_use]
pub fn effect(raw: &[f64], filtered: &[f64], window: usize) -> Effect {
    let quiet = quietest(raw, window);
    let end = quiet.end.min(filtered.len());
    Effect {
        before: rms_about_mean(&raw[quiet.clone()]),
        after: rms_about_mean(&filtered[quiet.start.min(end)..end]),
        removed: rmse(filtered, raw),
        quiet,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn finds_the_quiet_stretch_between_two_loud_ones() {
        let mut random = Random::new(1, 0);
        let samples: Vec<f64> =
            (0..3000).map(|k| random.normal() * if (1000..2000).contains(&k) { 0.1 } else { 3.0 } + 5.0).collect();
        let found = quietest(&samples, 400);
        assert!(found.start >= 950 && found.end <= 2050, "{found:?}");
    }

    #[test]
    fn a_short_or_missing_record_is_taken_whole() {
        assert_eq!(quietest(&[1.0, 2.0], 100), 0..2);
        assert_eq!(quietest(&[f64::NAN; 50], 10), 0..50);
        assert_eq!(quietest(&[], 10), 0..0);
    }
}
