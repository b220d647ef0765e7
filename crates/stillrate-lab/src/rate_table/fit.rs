//! The honest fit: every candidate curve scored on rates it has not seen, the best one kept, guards before it is handed out.
//!
//! Leave one rate out: all points of one true rate (duplicates merged into one group) are predicted from the others; the score is the root
//! mean square over all points. The minimum is taken; preferring the simplest within one standard error underfits with six rates.
//! Guards: fewer than five distinct rates allow nothing above a line; a slope |de/dw| above 0.1 anywhere in range means that a curve
//! draws the calibration rates instead of the sensor (the published network reaches 1 to 13).

use rayon::prelude::*;
use stillrate::Real;
use stillrate::correction::{ErrorCurve, INPUTS};

use crate::rate_table::candidate::{self, Candidate};
use crate::rate_table::points::{Point, check_units};

/// Steepest slope of an error curve that is believed.
pub const STEEPEST_SLOPE: f64 = 0.1;
/// Places along the rate where the slope is looked at; along each further input only the edges and the middle.
const SLOPE_GRID: usize = 2001;
/// True rates closer than this fraction of the range are one rate.
const SAME_RATE: f64 = 1e-6;

/// How to fit.
///
/// # Example
/// ```
/// use stillrate_lab::rate_table::{candidate::Candidate, fit::{Options, fit}, points::Point};
/// let points = Point::means(&[-4.0, -2.0, 0.0, 2.0, 4.0], &[0.05, 0.01, 0.0, 0.01, 0.05], &[1e-3; 5], None)?;
/// let lines = Options { candidates: vec![Candidate::Polynomial(0), Candidate::Polynomial(1)], ..Options::default() };
/// assert_ne!(fit(points.clone(), &lines)?.chosen, Candidate::Polynomial(2)); // only what is asked for
/// let flat = Options { steepest_slope: 1e-6, candidates: vec![Candidate::Polynomial(2)], ..lines };
/// assert!(fit(points, &flat).unwrap_err().contains("quadratic: slope 0.0"));
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The candidates to choose from.
    pub candidates: Vec<Candidate>,
    /// Steepest slope allowed.
    pub steepest_slope: f64,
    /// Seed of the networks' starts.
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self { candidates: Candidate::ALL.to_vec(), steepest_slope: STEEPEST_SLOPE, seed: 1 }
    }
}

/// How a candidate did.
///
/// # Example
/// ```
/// use stillrate_lab::rate_table::{candidate::Candidate, fit::{Options, fit}, points::Point};
/// let points = Point::means(&[-3.0, 0.0, 3.0], &[0.01, 0.02, 0.03], &[1e-3; 3], None)?;
/// let fitted = fit(points, &Options::default())?;
/// let cubic = fitted.scores.iter().find(|score| score.candidate == Candidate::Polynomial(3)).unwrap();
/// assert!(cubic.held_out.is_nan()); // three rates carry no cubic
/// assert_eq!(cubic.refused.as_deref(), Some("3 distinct rates (must be at least 5)"));
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Scored {
    /// The candidate.
    pub candidate: Candidate,
    /// Root mean square of its predictions of left-out rates, deg/s; NaN if it could not be fitted.
    pub held_out: f64,
    /// Root mean square on the points it was fitted to, deg/s.
    pub residual: f64,
    /// Largest |de/dw| in range.
    pub slope: f64,
    /// Why it was not allowed to win, if so.
    pub refused: Option<String>,
}

/// A calibration: the chosen curve and everything that led to it.
///
/// # Example
/// ```
/// use stillrate_lab::rate_table::{fit::{Options, fit}, points::Point};
/// let rates = [-6.0, -3.0, 0.0, 3.0, 6.0];
/// let points = Point::means(&rates, &rates.map(|w| 0.03 + 0.002 * w), &[1e-3; 5], None)?;
/// let fitted = fit(points, &Options::default())?;
/// assert!(fitted.held_out < 1e-3 * fitted.uncorrected); // a straight line foretells rates left out of it
/// assert_eq!((fitted.rates, fitted.scores.len()), (5, 9));
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The chosen curve.
    pub curve: ErrorCurve<f64>,
    /// Which candidate it is.
    pub chosen: Candidate,
    /// Its held-out score, deg/s.
    pub held_out: f64,
    /// Root mean square of the errors themselves, deg/s: what subtracting nothing leaves.
    pub uncorrected: f64,
    /// All candidates.
    pub scores: Vec<Scored>,
    /// The points.
    pub points: Vec<Point>,
    /// Number of distinct rates.
    pub rates: usize,
}

/// Fits points: every candidate is scored on the rates left out of its fit, the best one is kept.
///
/// # Errors
/// A sentence if the points do not support any candidate.
///
/// # Example
/// ```
/// use stillrate_lab::rate_table::{candidate::Candidate, fit::{Options, fit}, points::Point};
/// let rates = [-6.0, -4.0, -2.0, 0.0, 2.0, 4.0, 6.0];
/// let points = Point::means(&rates, &rates.map(|w| 1e-3 * w * w), &[1e-4; 7], None)?;
/// let candidates = (0..4).map(Candidate::Polynomial).collect();
/// let fitted = fit(points, &Options { candidates, ..Options::default() })?;
/// assert!((fitted.curve.error([5.0, 0.0, 0.0]).0 - 0.025).abs() < 1e-9); // deg/s at 5 deg/s
/// # Ok::<(), String>(())
/// ```
pub fn fit(points: Vec<Point>, options: &Options) -> Result<Fit, String> {
    if points.is_empty() {
        return Err("no calibration points".into());
    }
    check_units(&points)?;
    let groups = groups(&points);
    let scores: Vec<Scored> =
        options.candidates.par_iter().map(|&candidate| score(candidate, &points, &groups, options)).collect();
    let best = scores
        .iter()
        .filter(|s| s.refused.is_none() && s.held_out.is_finite())
        .min_by(|a, b| a.held_out.total_cmp(&b.held_out))
        .ok_or_else(|| nothing_left(&scores))?;
    let (chosen, held_out) = (best.candidate, best.held_out);
    let curve = candidate::fit(chosen, &points, options.seed).ok_or("the chosen curve could not be fitted")?;
    let curve = curve.checked().map_err(|error| error.to_string())?;
    let uncorrected = root_mean_square(points.iter().map(|p| p.error));
    Ok(Fit { curve, chosen, held_out, uncorrected, scores, rates: groups.len(), points })
}

fn nothing_left(scores: &[Scored]) -> String {
    let reasons: Vec<String> = scores
        .iter()
        .map(|s| {
            format!("{}: {}", s.candidate.name(), s.refused.as_deref().unwrap_or("the points do not determine it"))
        })
        .collect();
    format!("no candidate can be used ({})", reasons.join("; "))
}

/// Indices of the points of each distinct rate.
fn groups(points: &[Point]) -> Vec<Vec<usize>> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| points[a].rate.total_cmp(&points[b].rate));
    let range = points[order[order.len() - 1]].rate - points[order[0]].rate;
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for k in order {
        match groups.last_mut() {
            Some(group) if points[k].rate - points[group[0]].rate <= SAME_RATE * range => group.push(k),
            _ => groups.push(vec![k]),
        }
    }
    groups
}

fn score(candidate: Candidate, points: &[Point], groups: &[Vec<usize>], options: &Options) -> Scored {
    let refuse =
        |why: String| Scored { candidate, held_out: f64::NAN, residual: f64::NAN, slope: f64::NAN, refused: Some(why) };
    if groups.len() < candidate.fewest_rates() {
        return refuse(format!("{} distinct rates (must be at least {})", groups.len(), candidate.fewest_rates()));
    }
    let Some(curve) = candidate::fit(candidate, points, options.seed) else {
        return refuse("the points do not determine it".into());
    };
    let residual = root_mean_square(points.iter().map(|p| p.error - predict(&curve, p)));
    let held_out: Option<Vec<f64>> = groups
        .par_iter()
        .map(|group| leave_out(candidate, points, group, options.seed))
        .collect::<Option<Vec<Vec<f64>>>>()
        .map(|parts| parts.concat());
    let slope = steepest(&curve);
    let refused = if !(slope <= options.steepest_slope) {
        Some(format!("slope {slope:.3} (must be at most {})", options.steepest_slope))
    } else if held_out.is_none() {
        Some("without one of the rates it is not determined".into())
    } else {
        None
    };
    let held_out = held_out.map_or(f64::NAN, |errors| root_mean_square(errors.into_iter()));
    Scored { candidate, held_out, residual, slope, refused }
}

/// Errors of the predictions of one group from all others.
fn leave_out(candidate: Candidate, points: &[Point], group: &[usize], seed: u64) -> Option<Vec<f64>> {
    let rest: Vec<Point> =
        points.iter().enumerate().filter(|(k, _)| !group.contains(k)).map(|(_, p)| p.clone()).collect();
    let mut curve = candidate::fit(candidate, &rest, seed)?;
    // At the outermost rates the curve is asked beyond what it saw: no holding there, so that complexity pays for itself.
    curve.low = [f64::MIN; INPUTS];
    curve.high = [f64::MAX; INPUTS];
    Some(group.iter().map(|&k| points[k].error - predict(&curve, &points[k])).collect())
}

fn predict(curve: &ErrorCurve<f64>, point: &Point) -> f64 {
    curve.error([point.rate, point.temperature.unwrap_or(0.0), 0.0]).0
}

fn root_mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(s, n), v| (s + v * v, n + 1.0));
    (sum / count).root()
}

/// Largest |de/dw| inside the calibrated range, deg/s per deg/s.
///
/// # Example
/// ```
/// use stillrate::correction::ErrorCurve;
/// use stillrate_lab::rate_table::fit::steepest;
/// let line = ErrorCurve::line(0.03, -0.002, -6.0, 6.0).unwrap();
/// assert!((steepest(&line) - 0.002).abs() < 1e-15);
/// ```
#[must_use]
pub fn steepest(curve: &ErrorCurve<f64>) -> f64 {
    let inputs = curve.inputs as usize;
    let place = |i: usize, share: f64| curve.low[i] + share * (curve.high[i] - curve.low[i]);
    let shares = |i: usize| if i < inputs { vec![0.0, 0.5, 1.0] } else { vec![0.0] };
    let mut largest = 0.0_f64;
    for second in shares(1) {
        for third in shares(2) {
            for k in 0..SLOPE_GRID {
                let rate = place(0, k as f64 / (SLOPE_GRID - 1) as f64).limited(curve.low[0], curve.high[0]);
                let slope = curve.slope([rate, place(1, second), place(2, third)]).abs();
                // A slope that is not a number is as steep as can be.
                largest = if slope <= largest { largest } else { slope };
            }
        }
    }
    largest
}

/// Whether a curve may be used as it is: every number finite, slope within the guard.
///
/// # Errors
/// A sentence that says why it is rejected.
///
/// # Example
/// ```
/// use stillrate::correction::ErrorCurve;
/// use stillrate_lab::rate_table::fit::{STEEPEST_SLOPE, guard};
/// let [sensor, staircase] = [0.002, 0.2].map(|slope| ErrorCurve::line(0.03, slope, -6.0, 6.0).unwrap());
/// assert!(guard(&sensor, STEEPEST_SLOPE).is_ok());
/// assert!(guard(&staircase, STEEPEST_SLOPE).unwrap_err().contains("as steep as 0.200"));
/// ```
pub fn guard(curve: &ErrorCurve<f64>, steepest_slope: f64) -> Result<(), String> {
    curve.checked().map_err(|error| error.to_string())?;
    let slope = steepest(curve);
    if slope <= steepest_slope {
        return Ok(());
    }
    Err(format!(
        "rejected: the error curve is as steep as {slope:.3} deg/s per deg/s (must be at most {steepest_slope}); \
         it draws the rates it was trained at and not the sensor"
    ))
}
