//! From a rate-table log to calibration points: one mean error a constant-rate segment, with its standard error.
//!
//! The regressor is the true rate. Regressing on the noisy measured rate shrinks every curve towards the rates it was trained at
//! (errors in variables), which is half of what is wrong with the published network. Noise of a segment's mean comes from the spread of
//! its block means, because drift makes neighbouring samples alike.

use stillrate::Real;

use crate::tune::records::FEWEST_SAMPLES;

/// Blocks a segment is cut into for its standard error.
const BLOCKS: usize = 10;
/// Shortest segment, in samples.
const SHORTEST_SEGMENT: usize = 32;
/// Cells of rate and temperature when the truth moves all the time.
const CELLS: [usize; 2] = [13, 5];
/// A slope of measured over true rate outside this range is a wrong unit or sign, not a scale-factor error.
const SLOPES: (f64, f64) = (0.5, 2.0);

/// A calibration point.
///
/// # Example
/// ```
/// use stillrate_lab::rate_table::points::Point;
/// let points = Point::means(&[-3.0, 3.0], &[0.02, 0.04], &[2e-3, 1e-3], None)?;
/// assert_eq!(points[1].samples, 4 * points[0].samples); // half the standard error is four times the samples
/// assert!(Point::means(&[-3.0], &[0.02], &[0.0], None).is_err());
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// True rate, deg/s.
    pub rate: f64,
    /// Temperature in °C, if the calibration has one.
    pub temperature: Option<f64>,
    /// Mean measured rate less the true rate, deg/s.
    pub error: f64,
    /// Standard error of that mean, deg/s.
    pub standard_error: f64,
    /// Samples in the mean.
    pub samples: usize,
}

/// A rate-table log.
///
/// # Example
/// ```
/// use stillrate_lab::rate_table::points::Log;
/// let truth: Vec<f64> = (0..600).map(|k| [-5.0, 0.0, 5.0][k / 200]).collect();
/// let measured: Vec<f64> = truth.iter().zip(0..).map(|(w, k)| 1.01 * w + 0.1 * (f64::from(k) * 2.4).sin()).collect();
/// let log = Log { measured: &measured, truth: &truth, temperature: None };
/// let points = log.points()?;
/// assert_eq!(points.iter().map(|p| p.rate).collect::<Vec<_>>(), [-5.0, 0.0, 5.0]);
/// assert!((points[2].error - 0.05).abs() < 0.01); // a hundredth of 5 deg/s
/// assert_eq!(log.points_of(&[(400, 600)])?[0], points[2]);
/// assert!(log.points_of(&[(590, 600)]).unwrap_err().starts_with("segment 0 has 10 usable samples"));
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Log<'a> {
    /// Measured rate, deg/s; NaN where missing.
    pub measured: &'a [f64],
    /// True rate at the same samples, deg/s.
    pub truth: &'a [f64],
    /// Temperature at the same samples, °C.
    pub temperature: Option<&'a [f64]>,
}

impl Log<'_> {
    /// Points of a log whose true rate is known at each sample: segments where it stands still, or cells of rate (and temperature) if it
    /// never does.
    ///
    /// # Errors
    /// A sentence that says what is wrong with the log.
    pub fn points(self) -> Result<Vec<Point>, String> {
        check(self)?;
        let runs = constant_runs(self.truth);
        let covered: usize = runs.iter().map(|run| run.1 - run.0).sum();
        let points = if 2 * covered >= self.truth.len() { segments(self, &runs)? } else { cells(self) };
        check_units(&points)?;
        Ok(points)
    }

    /// Points of given segments (first sample, one past the last).
    ///
    /// # Errors
    /// A sentence that says what is wrong with the log, or names the segment that cannot be used.
    pub fn points_of(self, given: &[(usize, usize)]) -> Result<Vec<Point>, String> {
        check(self)?;
        segments(self, given)
    }
}

/// One point a segment.
fn segments(log: Log<'_>, segments: &[(usize, usize)]) -> Result<Vec<Point>, String> {
    let mut points = Vec::new();
    for (number, &(first, end)) in segments.iter().enumerate() {
        if first >= end || end > log.measured.len() {
            return Err(format!("segment {number} is {first}..{end} of {} samples", log.measured.len()));
        }
        let samples: Vec<usize> = (first..end).filter(|&k| usable(log, k)).collect();
        if samples.len() < SHORTEST_SEGMENT {
            return Err(format!(
                "segment {number} has {} usable samples (must be at least {SHORTEST_SEGMENT})",
                samples.len()
            ));
        }
        points.push(point(log, &samples));
    }
    Ok(points)
}

/// Refuses what no calibration can be made from.
fn check(log: Log<'_>) -> Result<(), String> {
    let n = log.measured.len();
    if log.truth.len() != n {
        return Err(format!("{} true rates for {n} measured ones (must be as many)", log.truth.len()));
    }
    if let Some(temperature) = log.temperature
        && temperature.len() != n
    {
        return Err(format!("{} temperatures for {n} rates (must be as many)", temperature.len()));
    }
    let usable = (0..n).filter(|&k| usable(log, k)).count();
    if usable < FEWEST_SAMPLES {
        return Err(format!("{usable} usable samples (must be at least {FEWEST_SAMPLES})"));
    }
    if (0..n).all(|k| !usable_pair(log, k) || log.measured[k] == log.truth[k]) {
        return Err("measured and true rate are the same numbers: there is no error to model".into());
    }
    let mut values = log.measured.iter().filter(|v| v.is_finite());
    let first = values.next();
    if values.all(|v| Some(v) == first) {
        return Err("no noise in the record: the measured rate never changes".into());
    }
    Ok(())
}

impl Point {
    /// Points that are means already, with their standard errors; a point's weight is its information, 1/standard_error^2.
    ///
    /// # Errors
    /// A sentence if the lists do not fit or hold what is no number.
    pub fn means(
        rates: &[f64],
        errors: &[f64],
        standard_errors: &[f64],
        temperatures: Option<&[f64]>,
    ) -> Result<Vec<Self>, String> {
        let n = rates.len();
        if errors.len() != n || standard_errors.len() != n || temperatures.is_some_and(|t| t.len() != n) {
            return Err(format!(
                "{n} rates, {} errors, {} standard errors (must be as many)",
                errors.len(),
                standard_errors.len()
            ));
        }
        let all = rates.iter().chain(errors).chain(temperatures.unwrap_or_default());
        if let Some(bad) = all.clone().find(|v| !v.is_finite()) {
            return Err(format!("a calibration point holds {bad} (must be finite)"));
        }
        if let Some(bad) = standard_errors.iter().find(|v| !(v.is_finite() && **v > 0.0)) {
            return Err(format!("standard error {bad} (must be finite and > 0)"));
        }
        let sharpest = standard_errors.iter().copied().fold(f64::INFINITY, f64::min);
        // In units of the least certain point a weight is a whole number of equally uncertain samples.
        let bluntest = standard_errors.iter().copied().fold(sharpest, f64::max);
        let samples = |s: f64| ((bluntest / s) * (bluntest / s) * 1000.0) as usize;
        Ok((0..n)
            .map(|k| Self {
                rate: rates[k],
                temperature: temperatures.map(|t| t[k]),
                error: errors[k],
                standard_error: standard_errors[k],
                samples: samples(standard_errors[k]).max(1),
            })
            .collect())
    }
}

/// Refuses units and signs that do not fit each other.
pub(crate) fn check_units(points: &[Point]) -> Result<(), String> {
    let n = points.len() as f64;
    let mean = points.iter().map(|p| p.rate).sum::<f64>() / n;
    let mean_error = points.iter().map(|p| p.error).sum::<f64>() / n;
    let spread: f64 = points.iter().map(|p| (p.rate - mean) * (p.rate - mean)).sum();
    if spread <= 0.0 {
        let rate = points.first().map_or(0.0, |p| p.rate);
        return Err(format!("all segments have the true rate {rate}: at least two different rates are needed"));
    }
    let slope = 1.0 + points.iter().map(|p| (p.rate - mean) * (p.error - mean_error)).sum::<f64>() / spread;
    // How well the slope is known from the noise of the points: a narrow calibration cannot accuse anyone.
    let noise = points.iter().map(|p| p.standard_error * p.standard_error).sum::<f64>() / n;
    let doubt = 4.0 * (noise / spread).root();
    if slope - doubt > SLOPES.1 || slope + doubt < SLOPES.0 {
        let hint = match slope {
            s if (s * 57.295_779_513 - 1.0).abs() < 0.3 => ": the measured rate seems to be in rad/s",
            s if (s / 57.295_779_513 - 1.0).abs() < 0.3 => ": the true rate seems to be in rad/s",
            s if s < 0.0 => ": one of them has the wrong sign",
            _ => "",
        };
        return Err(format!(
            "the measured rate changes {slope:.4} times as much as the true rate (must be about 1){hint}; both must be in deg/s"
        ));
    }
    Ok(())
}

fn usable_pair(log: Log<'_>, k: usize) -> bool {
    log.measured[k].is_finite() && log.truth[k].is_finite()
}

fn usable(log: Log<'_>, k: usize) -> bool {
    usable_pair(log, k) && log.temperature.is_none_or(|t| t[k].is_finite())
}

/// Runs of at least [`SHORTEST_SEGMENT`] samples over which the true rate is one number.
fn constant_runs(truth: &[f64]) -> Vec<(usize, usize)> {
    let mut runs = Vec::new();
    let mut first = 0;
    for k in 1..=truth.len() {
        if k == truth.len() || truth[k] != truth[first] {
            if k - first >= SHORTEST_SEGMENT && truth[first].is_finite() {
                runs.push((first, k));
            }
            first = k;
        }
    }
    runs
}

/// The point of some samples.
fn point(log: Log<'_>, samples: &[usize]) -> Point {
    let mean =
        |part: &[usize], value: &dyn Fn(usize) -> f64| part.iter().map(|&k| value(k)).sum::<f64>() / part.len() as f64;
    let error = |k: usize| log.measured[k] - log.truth[k];
    let centre = mean(samples, &error);
    let length = samples.len().div_ceil(BLOCKS);
    let blocks: Vec<f64> = samples.chunks_exact(length).map(|block| mean(block, &error)).collect();
    let count = blocks.len() as f64;
    let square = blocks.iter().map(|b| (b - centre) * (b - centre)).sum::<f64>() / (count - 1.0).max(1.0);
    Point {
        rate: mean(samples, &|k| log.truth[k]),
        temperature: log.temperature.map(|t| mean(samples, &|k| t[k])),
        error: centre,
        standard_error: (square / count).root(),
        samples: samples.len(),
    }
}

/// Means over cells of rate and temperature, for logs in which the table never stands still.
fn cells(log: Log<'_>) -> Vec<Point> {
    let indices: Vec<usize> = (0..log.measured.len()).filter(|&k| usable(log, k)).collect();
    let cell_of = |values: &[f64], cells: usize| -> Vec<usize> {
        let low = indices.iter().map(|&k| values[k]).fold(f64::INFINITY, f64::min);
        let high = indices.iter().map(|&k| values[k]).fold(f64::NEG_INFINITY, f64::max);
        let width = ((high - low) / cells as f64).max(f64::MIN_POSITIVE);
        indices.iter().map(|&k| (((values[k] - low) / width) as usize).min(cells - 1)).collect()
    };
    let by_rate = cell_of(log.truth, CELLS[0]);
    let by_temperature = log.temperature.map_or_else(|| vec![0; indices.len()], |t| cell_of(t, CELLS[1]));
    let mut groups = vec![Vec::new(); CELLS[0] * CELLS[1]];
    for (n, &k) in indices.iter().enumerate() {
        groups[by_rate[n] * CELLS[1] + by_temperature[n]].push(k);
    }
    groups.iter().filter(|group| group.len() >= SHORTEST_SEGMENT).map(|group| point(log, group)).collect()
}
