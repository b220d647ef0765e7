//! One interface to the optimisers: an objective, a box, a method, a progress callback.

use crate::tune::brent::Brent;
use crate::tune::objective::{MinimiseError, Minimum, Objective, Progress};
use crate::tune::qpso::Qpso;

/// Which optimiser.
///
/// Differential evolution is scipy's, on the Python side, through the same batches.
///
/// # Example
/// ```
/// use stillrate_lab::tune::{minimise::{Method, minimise}, qpso::Qpso};
/// let searched = |method: &Method| minimise(&mut |p: &[f64]| (p[0] + 2.0).abs(), &[-12.0], &[4.0], method, &mut |_| true);
/// let [brent, swarm] = [Method::default(), Method::Qpso(Qpso::default())].map(|m| searched(&m).unwrap());
/// assert!((brent.point[0] - swarm.point[0]).abs() < 1e-3);
/// assert!(20 * brent.evaluations < swarm.evaluations); // in one dimension a swarm is waste
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Method {
    /// A grid, then Brent's parabolic search: one dimension. The default for noise tuning.
    Brent(Brent),
    /// Quantum-behaved particle swarm.
    Qpso(Qpso),
}

impl Default for Method {
    /// Brent's search with its own defaults.
    fn default() -> Self {
        Self::Brent(Brent::default())
    }
}

/// Finds a point of the box `lower..=upper` where the objective is small.
///
/// # Errors
/// [`MinimiseError`].
///
/// # Example
/// ```
/// use stillrate_lab::tune::minimise::{Method, minimise};
/// use stillrate_lab::tune::qpso::Qpso;
/// let mut bowl = |p: &[f64]| (p[0] - 0.7) * (p[0] - 0.7) + 2.0 * (p[1] + 0.3) * (p[1] + 0.3);
/// let method = Method::Qpso(Qpso { particles: 40, iterations: 60, ..Qpso::default() });
/// let best = minimise(&mut bowl, &[-10.0; 2], &[10.0; 2], &method, &mut |_| true)?;
/// assert!((best.point[0] - 0.7).abs() < 1e-2);
/// # Ok::<(), stillrate_lab::tune::objective::MinimiseError>(())
/// ```
pub fn minimise(
    objective: &mut dyn Objective,
    lower: &[f64],
    upper: &[f64],
    method: &Method,
    progress: &mut dyn FnMut(&Progress) -> bool,
) -> Result<Minimum, MinimiseError> {
    match method {
        Method::Brent(brent) => brent.minimise(objective, lower, upper, progress),
        Method::Qpso(qpso) => qpso.minimise(objective, lower, upper, progress),
    }
}
