//! What the optimisers share: an objective that values many points at once, how a run stands, and how it ends.
//!
//! Points are handed over in batches so that an objective can use threads and vector instructions; a method never depends on
//! the order in which the points of a batch are evaluated. Values that are not finite count as "worst"; if every value of a run is
//! such, the run is an error and not a point.

use core::fmt;

/// What is to be made small: any function of one point, or a type of one's own that values a batch at once.
///
/// # Example
/// ```
/// use stillrate_lab::tune::objective::Objective;
/// let mut bowl = |p: &[f64]| p[0] * p[0] + p[1] * p[1];
/// assert_eq!(bowl.values(&[0.0, 1.0, 3.0, 4.0], 2), [1.0, 25.0]); // two points of two dimensions
/// ```
pub trait Objective {
    /// Values of `points.len() / dimensions` points, given one after the other.
    fn values(&mut self, points: &[f64], dimensions: usize) -> Vec<f64>;
}

impl<F: FnMut(&[f64]) -> f64> Objective for F {
    fn values(&mut self, points: &[f64], dimensions: usize) -> Vec<f64> {
        points.chunks_exact(dimensions.max(1)).map(self).collect()
    }
}

/// How a run stands; given to the progress callback after each batch. A callback that returns false stops the run.
///
/// # Example
/// ```
/// use stillrate_lab::tune::{minimise::{Method, minimise}, objective::{MinimiseError, Progress}, qpso::Qpso};
/// let mut patience = |progress: &Progress| progress.evaluations < 300;
/// let swarm = Method::Qpso(Qpso { target: f64::NEG_INFINITY, ..Qpso::default() }); // 100 particles
/// let found = minimise(&mut |p: &[f64]| p[0] * p[0], &[-1.0], &[1.0], &swarm, &mut patience);
/// assert_eq!(found, Err(MinimiseError::Stopped));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// Batches so far (iterations of a swarm).
    pub iteration: usize,
    /// Points valued so far.
    pub evaluations: usize,
    /// Best value so far.
    pub value: f64,
}

/// The best point found.
///
/// # Example
/// ```
/// use stillrate_lab::tune::minimise::{Method, minimise};
/// let best = minimise(&mut |p: &[f64]| p[0], &[-12.0], &[4.0], &Method::default(), &mut |_| true)?;
/// assert!(best.point[0] < -11.99); // no valley: the end of the box
/// assert_eq!(best.value, best.point[0]);
/// # Ok::<(), stillrate_lab::tune::objective::MinimiseError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Minimum {
    /// Where it is.
    pub point: Vec<f64>,
    /// Value there.
    pub value: f64,
    /// Points valued on the way.
    pub evaluations: usize,
}

/// Why there is no minimum to report.
///
/// # Example
/// ```
/// use stillrate_lab::tune::{minimise::{Method, minimise}, objective::MinimiseError};
/// let method = Method::default();
/// let nothing = minimise(&mut |_: &[f64]| f64::NAN, &[0.0], &[1.0], &method, &mut |_| true);
/// assert_eq!(nothing, Err(MinimiseError::NothingFinite { evaluations: 13 })); // the grid
/// let crossed = minimise(&mut |p: &[f64]| p[0], &[1.0], &[0.0], &method, &mut |_| true);
/// assert_eq!(crossed.unwrap_err().to_string(), "bounds[0] = 1..0 (must be finite, lower <= upper)");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum MinimiseError {
    /// A bound is not finite, the lower one is above the upper one, or the two lists differ in length.
    Bounds(String),
    /// A setting of the method is out of range.
    Setting(String),
    /// Every value was NaN or infinite.
    NothingFinite {
        /// Points tried.
        evaluations: usize,
    },
    /// The objective gave a wrong number of values.
    Count {
        /// Values asked for.
        asked: usize,
        /// Values given.
        given: usize,
    },
    /// The progress callback asked to stop.
    Stopped,
}

impl fmt::Display for MinimiseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bounds(why) | Self::Setting(why) => f.write_str(why),
            Self::NothingFinite { evaluations } => {
                write!(f, "the objective gave no finite value at any of {evaluations} points")
            }
            Self::Count { asked, given } => write!(f, "the objective gave {given} values for {asked} points"),
            Self::Stopped => f.write_str("stopped by the caller"),
        }
    }
}

impl std::error::Error for MinimiseError {}

/// Refuses what is no box.
pub(crate) fn check_bounds(lower: &[f64], upper: &[f64]) -> Result<(), MinimiseError> {
    if lower.len() != upper.len() || lower.is_empty() {
        let text =
            format!("{} lower and {} upper bounds (must be equally many, at least one)", lower.len(), upper.len());
        return Err(MinimiseError::Bounds(text));
    }
    for (i, (lo, hi)) in lower.iter().zip(upper).enumerate() {
        if !(lo.is_finite() && hi.is_finite() && lo <= hi) {
            return Err(MinimiseError::Bounds(format!("bounds[{i}] = {lo}..{hi} (must be finite, lower <= upper)")));
        }
    }
    Ok(())
}

/// Values a batch; anything that is not a number becomes +infinity.
pub(crate) fn value_all(
    objective: &mut dyn Objective,
    points: &[f64],
    dimensions: usize,
) -> Result<Vec<f64>, MinimiseError> {
    let asked = points.len() / dimensions;
    let mut values = objective.values(points, dimensions);
    if values.len() != asked {
        return Err(MinimiseError::Count { asked, given: values.len() });
    }
    values.iter_mut().filter(|v| v.is_nan()).for_each(|v| *v = f64::INFINITY);
    Ok(values)
}

/// Index and value of the smallest finite entry, the first one on ties.
pub(crate) fn lowest(values: &[f64]) -> Option<(usize, f64)> {
    let mut best: Option<(usize, f64)> = None;
    for (i, &value) in values.iter().enumerate() {
        if value.is_finite() && best.is_none_or(|(_, b)| value < b) {
            best = Some((i, value));
        }
    }
    best
}
