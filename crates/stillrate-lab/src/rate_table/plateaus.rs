//! Finds the constant-rate segments of a turntable log by itself, given only the list of rates the table was set to.
//!
//! The log is averaged in blocks of a tenth of a second. A plateau is a stretch of blocks that stay within a fraction of the rates'
//! spacing of one of them and do not drift from block to block by more than their noise; its first and last block (where the table still
//! accelerates) are dropped.

use stillrate::Real;

use crate::tune::white_sigma_with_gaps;

/// Block length, s.
const BLOCK_S: f64 = 0.1;
/// A plateau lasts at least this many blocks.
const SHORTEST: usize = 10;
/// A plateau stays this close to its rate, as a fraction of the distance to the next rate.
const CLOSE: f64 = 0.3;

/// A stretch of constant table rate.
///
/// # Example
/// ```
/// use stillrate_lab::rate_table::plateaus::find;
/// let log: Vec<f64> = (0..900).map(|k| [-2.0, 0.0, 2.0][k / 300] + 0.01 * (k as f64 * 2.4).sin()).collect();
/// let found = find(&log, &[2.0, -2.0, 0.0], 100.0)?;
/// // 3 s each, less the tenth of a second at either end in which the table may still be accelerating.
/// assert_eq!((found[1].first, found[1].end, found[1].rate), (310, 590, 0.0));
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plateau {
    /// First sample.
    pub first: usize,
    /// One past the last sample.
    pub end: usize,
    /// The table's rate, deg/s.
    pub rate: f64,
}

/// The plateaus of a log at the table's `rates` (deg/s, in any order).
///
/// # Errors
/// A sentence if the list of rates or the sample rate is unusable, or a rate has no plateau.
///
/// # Example
/// ```
/// use stillrate_lab::rate_table::plateaus::find;
/// let log: Vec<f64> = (0..600).map(|k| [0.0, 5.0][k / 300] + 0.01 * (k as f64 * 2.4).sin()).collect();
/// assert_eq!(find(&log, &[0.0, 5.0], 100.0)?.len(), 2);
/// let missing = find(&log, &[0.0, 5.0, 10.0], 100.0).unwrap_err();
/// assert!(missing.starts_with("no stretch of at least 1.0 s near the table rate 10 was found"));
/// # Ok::<(), String>(())
/// ```
pub fn find(measured: &[f64], rates: &[f64], sample_rate_hz: f64) -> Result<Vec<Plateau>, String> {
    let mut sorted: Vec<f64> = rates.to_vec();
    if let Some(bad) = sorted.iter().find(|r| !r.is_finite()) {
        return Err(format!("table rate {bad} (must be finite)"));
    }
    if !(sample_rate_hz.is_finite() && sample_rate_hz > 0.0) {
        return Err(format!("sample_rate_hz = {sample_rate_hz} (must be finite and > 0 Hz)"));
    }
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    let spacing = sorted.windows(2).map(|w| w[1] - w[0]).fold(f64::INFINITY, f64::min);
    if !spacing.is_finite() {
        return Err("all table rates are equal: at least two different ones are needed".into());
    }
    let length = ((BLOCK_S * sample_rate_hz) as usize).max(4);
    let means: Vec<f64> = measured.chunks_exact(length).map(mean).collect();
    let noise = white_sigma_with_gaps(measured) / (length as f64).root();
    let runs = runs(&means, &sorted, spacing, noise);
    let plateaus: Vec<Plateau> = runs
        .iter()
        .filter(|run| run.1 - run.0 >= SHORTEST)
        .map(|&(first, end, rate)| Plateau { first: (first + 1) * length, end: (end - 1) * length, rate })
        .collect();
    match sorted.iter().find(|rate| plateaus.iter().all(|p| p.rate != **rate)) {
        Some(rate) => Err(format!(
            "no stretch of at least {:.1} s near the table rate {rate} was found; give the segments instead",
            SHORTEST as f64 * BLOCK_S
        )),
        None => Ok(plateaus),
    }
}

/// Stretches of blocks that stand still at one of the rates: (first block, one past the last, rate).
fn runs(means: &[f64], rates: &[f64], spacing: f64, noise: f64) -> Vec<(usize, usize, f64)> {
    let nearest = |value: f64| {
        rates
            .iter()
            .copied()
            .min_by(|a, b| (a - value).abs().total_cmp(&(b - value).abs()))
            .filter(|rate| (rate - value).abs() < CLOSE * spacing)
    };
    let mut out: Vec<(usize, usize, f64)> = Vec::new();
    let mut open: Option<(usize, f64)> = None;
    for k in 0..=means.len() {
        let here = means.get(k).and_then(|m| nearest(*m));
        // Eight sigma of a difference of two block means: the table moves.
        let still =
            k == 0 || k >= means.len() || (means[k] - means[k - 1]).abs() < (8.0 * 1.5 * noise).max(0.02 * spacing);
        if let Some((first, rate)) = open {
            if here == Some(rate) && still {
                continue;
            }
            out.push((first, k, rate));
        }
        open = here.map(|rate| (k, rate));
    }
    out
}

fn mean(block: &[f64]) -> f64 {
    let (sum, count) = block.iter().filter(|v| v.is_finite()).fold((0.0, 0.0), |(s, n), v| (s + v, n + 1.0));
    sum / count
}
