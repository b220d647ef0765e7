//! Search for a better trajectory within rate and slew limits: hill climbing on the worst relative Cramer-Rao bound.
//!
//! A trajectory is a table of segments whose rates about each axis are -1, -1/2, 0, 1/2 or 1 times the limit. Its figure is the largest bound of a
//! drift or g-sensitive coefficient (kappa taken out), over its typical size of 0.65 scales, with kappa weighed by `kappa_weight`. Moves change one or
//! two entries; a move is kept if the figure falls. Several climbs start from the given table and from random ones; each has its own
//! stream of random numbers, so the result does not depend on the number of threads.

use rayon::prelude::*;
use stillrate::ConfigError;
use stillrate::gimbal::{Coefficients, Model};

use super::bound::{Bound, Sampling, bound};
use super::trajectory::Trajectory;
use crate::random::{Generator, Random};

/// Typical size of a coefficient over its scale: the mean of a uniform draw from 0.3 to 1.
pub const TYPICAL: f64 = 0.65;

/// Relative bounds of one trajectory, per cent of a typical coefficient.
#[derive(Clone, Copy, Debug, PartialEq)]
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
    #[must_use]
    pub fn worst(&self) -> f64 {
        [self.drift, self.g_sensitive, self.mounting, self.accelerometer].into_iter().fold(0.0, f64::max)
    }
}

/// Figures of a bound.
#[must_use]
pub fn figures(bound: &Bound, scale: &Coefficients) -> Figures {
    let relative = |i: usize| 100.0 * bound.deviation[i] / (TYPICAL * scale[i]);
    let worst = |range: core::ops::Range<usize>| range.map(relative).filter(|x| !x.is_nan()).fold(0.0_f64, f64::max);
    let deviatoric = (6..9).map(|i| 100.0 * bound.without_kappa[i - 6] / (TYPICAL * scale[i])).fold(0.0_f64, f64::max);
    Figures {
        drift: worst(3..6),
        g_sensitive: deviatoric.max(worst(9..15)),
        kappa: 100.0 * bound.kappa_deviation / (TYPICAL * scale[6]),
        mounting: worst(15..21),
        accelerometer: worst(21..33),
    }
}

/// Settings of the search.
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
pub fn plan(
    model: &Model,
    scale: &Coefficients,
    indices: &[usize],
    sampling: &Sampling,
    search: &Search,
) -> Result<(Trajectory, Figures), ConfigError> {
    search.start.commands(model)?;
    let zero = [0.0; stillrate::gimbal::COUNT];
    let rate = |trajectory: &Trajectory| -> (f64, Figures) {
        let Ok(commands) = trajectory.commands(model) else {
            return (
                f64::INFINITY,
                Figures { drift: 0.0, g_sensitive: 0.0, kappa: 0.0, mounting: 0.0, accelerometer: 0.0 },
            );
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
