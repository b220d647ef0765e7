//! Search for a better trajectory within rate and slew limits: hill climbing on the worst relative Cramer-Rao bound.
//!
//! A trajectory is a table of segments whose rates about each axis are -1, -1/2, 0, 1/2 or 1 times the limit. Its figure is the largest bound of a
//! drift or g-sensitive coefficient (kappa taken out), over its typical size of 0.65 scales, with kappa weighed by `kappa_weight`. Moves change one or
//! two entries; a move is kept if the figure falls. Several climbs start from the given table and from random ones; each has its own
//! stream of random numbers, so the result does not depend on the number of threads.

use rayon::prelude::*;
use stillrate::ConfigError;
use stillrate::gimbal::coefficients::{FORCE_BIAS, G_INPUT, G_OUTPUT, GYRO_ABOUT_OUTPUT, GYRO_BIAS, TORQUER};
use stillrate::gimbal::{COUNT, Coefficients, Model};

use super::bound::{Bound, Sampling, bound};
use super::score::KAPPA;
use super::trajectory::Trajectory;
use crate::random::{Generator, Random};

/// Typical size of a coefficient over its scale: the mean of a uniform draw from 0.3 to 1.
const TYPICAL: f64 = 0.65;

/// Relative bounds of one trajectory, per cent of a typical coefficient.
///
/// # Example
/// ```
/// use stillrate::gimbal::{DEFAULT_SCALE, Model};
/// use stillrate_lab::gimbal::{Figures, Sampling, Settings, Trajectory, bound, figures};
/// let settings = Settings::new(Model::new(9.8, 0.7)?);
/// let commands = Trajectory::default().commands(&settings.model)?;
/// let bound = bound(&settings.model, &[0.0; 41], &DEFAULT_SCALE, &settings.indices()?, &commands, &Sampling::default());
/// let Figures { drift, g_sensitive, kappa, .. } = figures(&bound, &DEFAULT_SCALE);
/// assert!(drift < 0.03 && g_sensitive < 0.03 && kappa > 0.2); // kappa shows through the Earth rate only
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Figures {
    /// Worst gyro drift.
    pub drift: f64,
    /// Worst g-sensitive coefficient, kgI less its mean.
    pub g_sensitive: f64,
    /// kappa.
    pub kappa: f64,
    /// Worst gyro mounting angle.
    pub mounting: f64,
    /// Worst accelerometer coefficient.
    pub accelerometer: f64,
}

impl Figures {
    /// The worst of all but kappa.
    fn worst(&self) -> f64 {
        [self.drift, self.g_sensitive, self.mounting, self.accelerometer].into_iter().fold(0.0, f64::max)
    }
}

/// Figures of a bound.
///
/// # Example
/// Five times the noise, five times the bound:
/// ```
/// use stillrate::gimbal::{DEFAULT_SCALE, Model};
/// use stillrate_lab::gimbal::{Sampling, Settings, Trajectory, bound, figures};
/// let settings = Settings::new(Model::new(9.8, 0.7)?);
/// let commands = Trajectory::default().commands(&settings.model)?;
/// let drift = |sigma_m_s2| -> Result<f64, stillrate::ConfigError> {
///     let sampling = Sampling { sigma_m_s2, ..Sampling::default() };
///     let bound = bound(&settings.model, &[0.0; 41], &DEFAULT_SCALE, &settings.indices()?, &commands, &sampling);
///     Ok(figures(&bound, &DEFAULT_SCALE).drift)
/// };
/// assert!((drift(5e-6)? / drift(1e-6)? - 5.0).abs() < 1e-9);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[must_use]
pub fn figures(bound: &Bound, scale: &Coefficients) -> Figures {
    let relative = |i: usize| 100.0 * bound.deviation[i] / (TYPICAL * scale[i]);
    let worst = |range: core::ops::Range<usize>| range.map(relative).filter(|x| !x.is_nan()).fold(0.0_f64, f64::max);
    let deviatoric =
        KAPPA.map(|i| 100.0 * bound.without_kappa[i - G_INPUT] / (TYPICAL * scale[i])).fold(0.0_f64, f64::max);
    Figures {
        drift: worst(GYRO_BIAS..G_INPUT),
        g_sensitive: deviatoric.max(worst(G_OUTPUT..GYRO_ABOUT_OUTPUT)),
        kappa: 100.0 * bound.kappa_deviation / (TYPICAL * scale[G_INPUT]),
        mounting: worst(GYRO_ABOUT_OUTPUT..FORCE_BIAS),
        accelerometer: worst(FORCE_BIAS..TORQUER),
    }
}

/// Settings of the search.
///
/// # Example
/// ```
/// use stillrate_lab::gimbal::{Search, Trajectory};
/// let slow = Search {
///     start: Trajectory { segment_s: 150.0, ..Trajectory::default() }, // half an hour
///     rate_max_deg_s: 0.5,
///     moves: 200,
///     climbs: 4,
///     kappa_weight: 0.1,
///     seed: 1,
/// };
/// assert_eq!(slow.start.segments_deg_s.len() as f64 * slow.start.segment_s, 1800.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Search {
    /// Where to start; its segment length, slew and interval hold throughout.
    pub start: Trajectory,
    /// Rate limit about each axis, deg/s.
    pub rate_max_deg_s: f64,
    /// Moves of each climb.
    pub moves: usize,
    /// Climbs: the first from the given table, the others from random ones.
    pub climbs: usize,
    /// Weight of kappa against the worst other bound (0.1 makes 0.28 % count like 0.028 %).
    pub kappa_weight: f64,
    /// Seed of the moves.
    pub seed: u64,
}

/// Searches; returns the best trajectory and its figures.
///
/// # Errors
/// [`ConfigError`] if the starting trajectory cannot be used.
///
/// # Example
/// ```
/// use stillrate::gimbal::{DEFAULT_SCALE, Model};
/// use stillrate_lab::gimbal::{Sampling, Search, Settings, Trajectory, plan};
/// let settings = Settings::new(Model::new(9.8, 0.7)?);
/// let start = Trajectory { segment_s: 20.0, ..Trajectory::default() };
/// let mut search = Search { start, rate_max_deg_s: 1.0, moves: 0, climbs: 1, kappa_weight: 0.0, seed: 1 };
/// let worst = |search: &Search| -> Result<f64, stillrate::ConfigError> {
///     let (_, f) = plan(&settings.model, &DEFAULT_SCALE, &settings.indices()?, &Sampling::default(), search)?;
///     Ok(f.drift.max(f.g_sensitive).max(f.mounting).max(f.accelerometer))
/// };
/// let before = worst(&search)?;
/// search.moves = 8;
/// assert!(worst(&search)? < before);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
pub fn plan(
    model: &Model,
    scale: &Coefficients,
    indices: &[usize],
    sampling: &Sampling,
    search: &Search,
) -> Result<(Trajectory, Figures), ConfigError> {
    search.start.commands(model)?;
    let zero = [0.0; COUNT];
    let rate = |trajectory: &Trajectory| -> (f64, Figures) {
        let Ok(commands) = trajectory.commands(model) else {
            return (f64::INFINITY, Figures::default());
        };
        let figures = figures(&bound(model, &zero, scale, indices, &commands, sampling), scale);
        let value = figures.worst().max(search.kappa_weight * figures.kappa);
        (if value.is_nan() { f64::INFINITY } else { value }, figures)
    };
    let climb = |number: usize| {
        let mut random = Random::new(search.seed, number as u64);
        let mut best = search.start.clone();
        let levels = [-1.0, -0.5, 0.0, 0.5, 1.0].map(|share| share * search.rate_max_deg_s);
        if number > 0 {
            for entry in best.segments_deg_s.iter_mut().flatten() {
                *entry = levels[random.below(5) as usize];
            }
        }
        let mut value = rate(&best);
        for _ in 0..search.moves {
            let mut next = best.clone();
            for _ in 0..=random.below(2) {
                let segment = random.below(next.segments_deg_s.len() as u64) as usize;
                let axis = random.below(3) as usize;
                next.segments_deg_s[segment][axis] = levels[random.below(5) as usize];
            }
            let there = rate(&next);
            if there.0 < value.0 {
                (best, value) = (next, there);
            }
        }
        (value.0, value.1, best)
    };
    let mut climbs: Vec<_> = (0..search.climbs.max(1)).into_par_iter().map(climb).collect();
    climbs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (_, figures, trajectory) = climbs.swap_remove(0);
    Ok((trajectory, figures))
}
