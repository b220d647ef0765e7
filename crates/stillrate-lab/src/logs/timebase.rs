//! What the time stamps of a log say: nominal rate, gaps, repeats, jumps back, and the time steps a filter is given.
//!
//! The nominal period is the mean of the steps within half of the median step, which neither gaps nor quantised or
//! jittered stamps disturb. Where stamps come in bursts (most steps are nearly nothing), it is the time covered without
//! gaps over the number of samples.

/// A step within this part of the nominal period counts as regular and is taken as exactly nominal.
pub const REGULAR_TOLERANCE: f64 = 0.02;

/// A step longer than this many periods is a gap.
const GAP_PERIODS: f64 = 1.5;

/// Fewer steps than this part of all near the median, and the stamps come in bursts.
const BURST_SHARE: f64 = 0.5;

/// So do they if the average step is longer than this many median steps, the few longest left out.
const BURST_RATIO: f64 = 1.5;

/// A step so many times longer than the 99th percentile is a pause of the logger.
const PAUSE_RATIO: f64 = 5.0;

/// What time stamps say.
///
/// # Example
/// ```
/// use stillrate_lab::logs::timebase::{Timebase, analyse};
/// let Timebase { sample_rate_hz, regular, longest_step_s, backward, .. } = analyse(&[0.0, 0.25, 0.5, 0.25, 1.0]);
/// assert_eq!((sample_rate_hz, longest_step_s), (4.0, 0.75));
/// assert_eq!((regular, backward), (false, vec![3]));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Timebase {
    /// Nominal sample rate in Hz; NaN if fewer than two different stamps.
    pub sample_rate_hz: f64,
    /// Median step in s.
    pub median_step_s: f64,
    /// Indices of samples that come after a gap.
    pub gaps: Vec<usize>,
    /// Indices of samples with the stamp of the one before.
    pub repeats: Vec<usize>,
    /// Indices of samples with an earlier stamp than the one before.
    pub backward: Vec<usize>,
    /// Indices of samples whose stamp is no number.
    pub missing: Vec<usize>,
    /// Longest step in s.
    pub longest_step_s: f64,
    /// Every step is within [`REGULAR_TOLERANCE`] of nominal.
    pub regular: bool,
}

/// Reads time stamps in s.
///
/// # Example
/// ```
/// use stillrate_lab::logs::timebase::analyse;
/// let found = analyse(&[0.0, 0.1, 0.2, 0.2, 0.3, 0.9, 1.0]);
/// assert!((found.sample_rate_hz - 10.0).abs() < 1e-9);
/// assert_eq!((found.gaps, found.repeats), (vec![5], vec![3]));
/// ```
#[must_use]
pub fn analyse(t_s: &[f64]) -> Timebase {
    let steps: Vec<f64> = t_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let mut forward: Vec<f64> = steps.iter().copied().filter(|step| *step > 0.0 && step.is_finite()).collect();
    forward.sort_by(f64::total_cmp);
    let median = forward.get(forward.len() / 2).copied().unwrap_or(f64::NAN);
    let period = nominal_period(&forward, median, steps.len());
    let found = |test: &dyn Fn(f64) -> bool| -> Vec<usize> {
        steps.iter().enumerate().filter(|(_, step)| test(**step)).map(|(index, _)| index + 1).collect()
    };
    let regular = period.is_finite() && steps.iter().all(|step| (step - period).abs() <= REGULAR_TOLERANCE * period);
    Timebase {
        sample_rate_hz: 1.0 / period,
        median_step_s: median,
        gaps: found(&|step| step > GAP_PERIODS * period.max(median)),
        repeats: found(&|step| step == 0.0),
        backward: found(&|step| step < 0.0),
        missing: (0..t_s.len()).filter(|index| !t_s[*index].is_finite()).collect(),
        longest_step_s: forward.last().copied().unwrap_or(f64::NAN),
        regular,
    }
}

fn nominal_period(forward: &[f64], median: f64, steps: usize) -> f64 {
    // Without pauses of the logger: steps far longer than all but a hundredth of them.
    let rare = 1 + (forward.len() / 100).max(3);
    let usual_longest = forward.get(forward.len().saturating_sub(rare)).copied().unwrap_or(f64::NAN);
    let pauses = forward.iter().rev().take_while(|step| **step > PAUSE_RATIO * usual_longest).count();
    let spread = forward[..forward.len() - pauses].iter().sum::<f64>() / (steps - pauses).max(1) as f64;
    let near = forward.iter().filter(|step| (0.5 * median..=1.5 * median).contains(*step));
    let (count, sum) = near.fold((0_usize, 0.0), |(count, sum), step| (count + 1, sum + step));
    let bursts = spread > BURST_RATIO * median || (count as f64) < BURST_SHARE * steps as f64;
    if bursts { spread } else { sum / count as f64 }
}

/// Time steps for a filter: nominal where the stamps are within [`REGULAR_TOLERANCE`] of it, else as stamped. The first
/// sample's step is nominal.
///
/// # Example
/// ```
/// use stillrate_lab::logs::timebase::steps;
/// // Jitter below a fiftieth of a period is taken for none; the gap is not.
/// assert_eq!(steps(&[0.0, 0.1001, 0.2, 0.75], 10.0), [0.1, 0.1, 0.1, 0.55]);
/// ```
#[must_use]
pub fn steps(t_s: &[f64], sample_rate_hz: f64) -> Vec<f64> {
    let period = 1.0 / sample_rate_hz;
    let regular = |step: f64| (step - period).abs() <= REGULAR_TOLERANCE * period;
    core::iter::once(period)
        .chain(t_s.windows(2).map(|pair| pair[1] - pair[0]).map(|step| if regular(step) { period } else { step }))
        .take(t_s.len())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stamps(count: usize, period: f64) -> Vec<f64> {
        (0..count).map(|index| index as f64 * period).collect()
    }

    #[test]
    fn quantised_stamps_do_not_bias_the_rate() {
        let t: Vec<f64> = stamps(1000, 1.0 / 285.0).iter().map(|t| (t * 1e3).floor() / 1e3).collect();
        assert!((analyse(&t).sample_rate_hz / 285.0 - 1.0).abs() < 2e-3);
    }

    #[test]
    fn gaps_repeats_and_jumps_back_are_listed_and_do_not_bias_the_rate() {
        let mut t = stamps(1000, 0.01);
        t.iter_mut().skip(500).for_each(|t| *t += 7.0);
        t[200] = t[199];
        t[800] = t[790];
        let found = analyse(&t);
        assert!((found.sample_rate_hz - 100.0).abs() < 0.01);
        assert_eq!((found.repeats, found.backward), (vec![200], vec![800]));
        assert_eq!(found.gaps, vec![201, 500, 801]);
        assert!(!found.regular);
    }

    #[test]
    fn bursts_are_spread_over_their_samples() {
        let t: Vec<f64> = (0..1000).map(|index| f64::from(index / 10) * 0.1 + f64::from(index % 10) * 1e-5).collect();
        assert!((analyse(&t).sample_rate_hz / 100.0 - 1.0).abs() < 0.03, "{}", analyse(&t).sample_rate_hz);
    }

    #[test]
    fn steps_near_nominal_become_nominal() {
        assert_eq!(steps(&[0.0, 0.0101, 0.0201, 0.05], 100.0), vec![0.01, 0.01, 0.01, 0.05 - 0.0201]);
        assert!(steps(&[], 100.0).is_empty());
    }

    #[test]
    fn too_few_stamps_have_no_rate() {
        assert!(!analyse(&[1.0]).sample_rate_hz.is_finite());
        assert!(!analyse(&[]).sample_rate_hz.is_finite());
        assert!(!analyse(&[1.0, 1.0]).sample_rate_hz.is_finite());
    }
}
