//! Overlapping Allan deviation with confidence intervals and the noise figures that explain it.
//!
//! sigma^2(tau) is half the mean squared difference of neighbouring means over tau (IEEE Std 952-2020, annex C). The
//! record may have gaps (non-finite samples). Intervals are chi-square with the equivalent degrees of freedom of the
//! noise that was found in the record itself; figures and their intervals come from a fit of
//! N^2 / tau + (2 ln 2 / pi) B^2 + K^2 tau / 3. Work is one pass over the record a cluster length, lengths in parallel.

mod deviation;
mod fit;
mod freedom;
mod interval;

use rayon::prelude::*;
use stillrate::Real;
use stillrate::error::{between, positive};

use crate::error::LogError;
use crate::statistics::chi_square_quantile;
use deviation::{Phase, Point};
use freedom::{Mixture, covariance, expected, freedom, unit_variances};

/// Which averaging times to evaluate.
///
/// # Example
/// ```
/// use stillrate_lab::allan::{AllanSettings, Taus, allan_with};
/// let z: Vec<f64> = (0..100).map(|k| f64::from(k % 7)).collect();
/// let count = |taus| allan_with(&z, 10.0, AllanSettings { taus, ..AllanSettings::default() }).unwrap().tau_s.len();
/// assert_eq!(count(Taus::Octave), 6); // 1, 2, 4, ..., 32 of 100 samples: two clusters must fit
/// assert_eq!(count(Taus::All), 50);
/// assert_eq!(count(Taus::PerDecade(1000)), 50); // no length twice
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taus {
    /// 1, 2, 4, ... samples.
    Octave,
    /// At most this many a decade, equally spaced in the logarithm, repeats left out; 1000 gives nearly all.
    PerDecade(usize),
    /// Every one. Costs the square of the record's length.
    All,
}

/// How to compute an Allan deviation.
///
/// # Example
/// ```
/// use stillrate_lab::allan::{AllanSettings, Taus};
/// let settings = AllanSettings { taus: Taus::PerDecade(20), ..AllanSettings::default() };
/// assert_eq!(settings.confidence, 0.9);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AllanSettings {
    /// Averaging times.
    pub taus: Taus,
    /// Probability inside each interval, in 0..1.
    pub confidence: f64,
}

impl Default for AllanSettings {
    fn default() -> Self {
        Self { taus: Taus::Octave, confidence: 0.9 }
    }
}

/// A noise figure and its interval, in the unit of the figure.
///
/// # Example
/// ```
/// use stillrate_lab::{allan::{Figure, allan}, random::Random};
/// let white = Random::new(1, 0).normals(10_000);
/// let Figure { value, lower, upper } = allan(&white, 1.0).unwrap().angle_random_walk;
/// assert!(lower < value && value < upper);
/// assert!(lower < 1.0 && 1.0 < upper); // what it was made with
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure {
    /// Best value; 0 where the record shows none.
    pub value: f64,
    /// Lower end of the interval.
    pub lower: f64,
    /// Upper end of the interval.
    pub upper: f64,
}

/// An Allan deviation curve and the noise figures fitted to it. Units follow the record (deg/s in, deg/s out).
///
/// # Example
/// ```
/// use stillrate_lab::{allan::{Allan, allan}, random::Random};
/// let curve: Allan = allan(&Random::new(1, 0).normals(100_000), 100.0).unwrap();
/// assert_eq!(curve.tau_s[10], 10.24); // 2^10 samples
/// // White noise averages down with the root of time.
/// assert!((curve.deviation[10] / (0.1 / 10.24_f64.sqrt()) - 1.0).abs() < 0.1);
/// assert!(curve.lower[10] < curve.fitted[10] && curve.fitted[10] < curve.upper[10] && curve.misfit < 0.3);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Allan {
    /// Averaging times, s.
    pub tau_s: Vec<f64>,
    /// Allan deviation at each.
    pub deviation: Vec<f64>,
    /// Lower end of the interval of each.
    pub lower: Vec<f64>,
    /// Upper end of the interval of each.
    pub upper: Vec<f64>,
    /// Deviation that the fitted figures lead to.
    pub fitted: Vec<f64>,
    /// Equivalent degrees of freedom of each.
    pub freedom: Vec<f64>,
    /// Angle random walk N: two-sided density, unit / sqrt(Hz).
    pub angle_random_walk: Figure,
    /// Bias instability B: the flicker floor is .664 B.
    pub bias_instability: Figure,
    /// Rate random walk K, unit / sqrt(s).
    pub rate_random_walk: Figure,
    /// Largest |ln(deviation / fitted)| that its interval does not explain; above some .3 the record holds something
    /// else than these three noises (motion, vibration, a low-pass filter, coarse steps).
    pub misfit: f64,
}

/// Fewest finite samples that make sense of a curve.
const FEWEST: usize = 8;

/// Allan deviation at octave-spaced averaging times with 90 % intervals.
///
/// Non-finite samples are gaps. `z` in any unit, regular samples.
///
/// # Errors
/// [`LogError`] for fewer than 8 finite samples or a sample rate out of range.
///
/// # Example
/// ```
/// use stillrate_lab::{allan::allan, random::Random};
/// let white: Vec<f64> = Random::new(1, 0).normals(100_000).iter().map(|x| 0.5 * x).collect();
/// let curve = allan(&white, 100.0).unwrap();
/// assert!((curve.angle_random_walk.value - 0.05).abs() < 0.001); // 0.5 / sqrt(100 Hz)
/// ```
pub fn allan(z: &[f64], sample_rate_hz: f64) -> Result<Allan, LogError> {
    allan_with(z, sample_rate_hz, AllanSettings::default())
}

/// Allan deviation with settings of your own.
///
/// # Errors
/// [`LogError`] for fewer than 8 finite samples or a setting out of range.
///
/// # Example
/// ```
/// use stillrate_lab::allan::{AllanSettings, Taus, allan_with};
/// let z: Vec<f64> = (0..1000).map(|k| f64::from(k % 2)).collect();
/// let settings = AllanSettings { taus: Taus::PerDecade(10), confidence: 0.68 };
/// let curve = allan_with(&z, 10.0, settings).unwrap();
/// assert!((curve.deviation[0] - 0.5_f64.sqrt()).abs() < 1e-12);
/// assert!(curve.deviation[1] < 1e-9);
/// ```
pub fn allan_with(z: &[f64], sample_rate_hz: f64, settings: AllanSettings) -> Result<Allan, LogError> {
    let rate = positive("sample_rate_hz", sample_rate_hz, "Hz")?;
    between("confidence", settings.confidence, 0.0, 1.0, "", "above 0 and below 1")?;
    let phase = Phase::new(z);
    if phase.finite() < FEWEST {
        return Err(LogError::TooShort { finite: phase.finite(), needed: FEWEST });
    }
    let evaluate = |clusters: &[usize]| -> Vec<Point> {
        clusters.par_iter().map(|m| phase.point(*m)).collect::<Vec<_>>().into_iter().flatten().collect()
    };
    let octaves = evaluate(&clusters(phase.longest(), Taus::Octave));
    if octaves.is_empty() {
        return Err(LogError::TooShort { finite: 0, needed: FEWEST });
    }
    let fitted = fit::fit(&octaves, settings.confidence);
    let points = match settings.taus {
        Taus::Octave => octaves,
        other => evaluate(&clusters(phase.longest(), other)),
    };
    Ok(describe(&points, &fitted, rate, settings.confidence))
}

/// The overlapping Allan variance at one cluster length, in samples.
///
/// # Errors
/// [`LogError`] if no two clusters of that length fit.
pub(crate) fn variance_at(z: &[f64], cluster_samples: usize) -> Result<f64, LogError> {
    let phase = Phase::new(z);
    let missing = LogError::TooShort { finite: phase.finite(), needed: cluster_samples.saturating_mul(2).max(2) };
    phase.point(cluster_samples).map(|p| p.variance).ok_or(missing)
}

/// Cluster lengths in samples, growing.
fn clusters(longest: usize, taus: Taus) -> Vec<usize> {
    match taus {
        Taus::Octave => (0..usize::BITS).map(|k| 1 << k).take_while(|m| *m <= longest).collect(),
        Taus::All => (1..=longest).collect(),
        Taus::PerDecade(count) => {
            let ratio = (10.0_f64.logarithm() / count.max(1) as f64).exponential();
            let (mut lengths, mut next) = (Vec::new(), 1.0);
            while next <= longest as f64 {
                let m = (next + 0.5) as usize;
                if lengths.last() != Some(&m) && m <= longest {
                    lengths.push(m);
                }
                next *= ratio;
            }
            lengths
        }
    }
}

/// Turns points in samples into a curve in seconds, with intervals from the fitted noise.
fn describe(points: &[Point], fit: &fit::Fit, rate: f64, confidence: f64) -> Allan {
    let tail = 0.5 * (1.0 - confidence);
    let figure = |i: usize, scale: f64| {
        let of = |m: &Mixture| (m[i] * scale).root();
        Figure { value: of(&fit.mixture), lower: of(&fit.low), upper: of(&fit.high) }
    };
    // A white variance s a sample is the density s / rate; a walk variance s a step is s rate a second.
    let mut curve = Allan {
        tau_s: Vec::with_capacity(points.len()),
        deviation: Vec::with_capacity(points.len()),
        lower: Vec::with_capacity(points.len()),
        upper: Vec::with_capacity(points.len()),
        fitted: Vec::with_capacity(points.len()),
        freedom: Vec::with_capacity(points.len()),
        angle_random_walk: figure(0, 1.0 / rate),
        bias_instability: figure(1, 1.0),
        rate_random_walk: figure(2, rate),
        misfit: 0.0,
    };
    for point in points {
        let model = expected(&fit.mixture, point.cluster);
        let white = if model > 0.0 { fit.mixture[0] * unit_variances(point.cluster)[0] / model } else { 1.0 };
        // Missing samples inflate the white part only.
        let variance = point.variance / (1.0 + white * (point.thinning - 1.0));
        let freedom = freedom(&fit.mixture, point, &covariance(point, point));
        let end = |p: f64| (variance * freedom / chi_square_quantile(p, freedom)).root();
        let (low, high, fitted) = (end(1.0 - tail), end(tail), model.root());
        let unexplained = ((low / fitted).logarithm()).max((fitted / high).logarithm());
        if unexplained > curve.misfit {
            curve.misfit = unexplained;
        }
        curve.tau_s.push(point.cluster as f64 / rate);
        curve.deviation.push(variance.root());
        curve.lower.push(low);
        curve.upper.push(high);
        curve.fitted.push(fitted);
        curve.freedom.push(freedom);
    }
    curve
}

#[cfg(test)]
mod tests {
    use super::variance_at;

    #[test]
    fn a_record_that_alternates_has_half_its_squared_step() {
        assert_eq!(variance_at(&[0.0, 1.0, 0.0, 1.0], 1), Ok(0.5));
        assert!(variance_at(&[0.0, 1.0, 0.0], 2).is_err());
    }
}
