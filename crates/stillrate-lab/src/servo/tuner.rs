//! Tunes controller and filter together at a budget of rest jitter, with the same effort for every filter.
//!
//! Minimise the residual (rms, 10 deg at 1 Hz) subject to what is demanded: rest jitter after a tilt within the
//! budget and not twice the undisturbed one, margins, levelling. Jitter counts after an excitation and margins are demanded because an
//! adaptive filter tuned at undisturbed rest hides an unstable loop; levelling is demanded because a search trades it for residual.
//! The search (see [`search`](super::search)) sees few seeds and aims a little beyond the demands. What each restart kept is then gone through, best first, on
//! other seeds, to the first design on which every demand holds; the best of these is the answer. Effort, seeds, gains'
//! ranges and demands are the same for every filter, and no filter begins with designs unless the caller gives some.

use rayon::prelude::*;

use super::bench::{Bench, Design};
use super::controller::Controller;
use super::demands::{Demands, searched};
use super::family::Family;
use super::score::{Score, Scored};
use super::search::{Effort, Found, Range, minimise};
use super::trial::Trial;
use crate::settings_map::SettingsError;

/// Search ranges of kappa, Ko, Kvi, kd. Ko stays above 0.3/s: below, 20 deg take longer than 20 s to level.
const GAINS: [Range; 4] = [
    Range { low: 0.02, high: 12.0, logarithmic: true },
    Range { low: 0.3, high: 5.0, logarithmic: true },
    Range { low: 0.1, high: 400.0, logarithmic: true },
    Range { low: 1e-4, high: 0.2, logarithmic: true },
];
/// Designs of a restart that are tried on the check seeds, at most.
const TRIED: usize = 80;
/// Check seeds that are run at once.
const GROUP: usize = 8;
/// A design tried after another failed has at least this much more residual: neighbours of a failure fail as well.
const STRIDE: f64 = 1.002;

/// What a tuning is asked for.
///
/// # Example
/// ```
/// use stillrate_lab::servo::bench::{Bench, Design};
/// use stillrate_lab::servo::search::Effort;
/// use stillrate_lab::servo::tuner::{Task, tune};
/// use stillrate_lab::servo::{controller::Controller, family::standard};
/// let bench = Bench::paper(50.0);
/// let pt1 = &standard(50.0, bench.noise)[1];
/// // A start must set whatever the family leaves open: here a cut-off.
/// let start = Design { controller: Controller::default(), parameters: vec![] };
/// let effort = Effort { evaluations: 8, restarts: 1, seed: 5 };
/// let task = Task { budget_percent: 0.2, effort, seeds: vec![1], checks: vec![], starts: vec![start] };
/// assert!(tune(&bench, pt1, &task, &mut |_| true).unwrap_err().to_string().contains("starts"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Task {
    /// Rest jitter allowed, percent of the supply voltage.
    pub budget_percent: f64,
    /// Search effort.
    pub effort: Effort,
    /// Seeds of the gyro's noise while searching.
    pub seeds: Vec<u64>,
    /// Seeds on which the answer must hold; none: the search's best is the answer.
    pub checks: Vec<u64>,
    /// Designs that every restart begins with.
    pub starts: Vec<Design>,
}

/// A tuned controller and filter.
///
/// # Example
/// ```
/// use stillrate_lab::servo::search::Effort;
/// use stillrate_lab::servo::tuner::{Task, tune};
/// use stillrate_lab::servo::{bench::Bench, family::standard};
/// let bench = Bench::paper(50.0);
/// let effort = Effort { evaluations: 8, restarts: 2, seed: 5 };
/// let task = Task { budget_percent: 1e-6, effort, seeds: vec![1], checks: vec![], starts: vec![] };
/// let found = tune(&bench, &standard(50.0, bench.noise)[0], &task, &mut |_| true).unwrap();
/// // Nothing rests so quietly: the least bad design comes back, marked as such.
/// assert!(!found.feasible && found.objective_deg.is_infinite());
/// assert_eq!(found.restarts_deg, [f64::INFINITY; 2]);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Tuned {
    /// The design.
    pub design: Design,
    /// Residual (rms, deg) seen by the search; not a result, only its objective.
    pub objective_deg: f64,
    /// Whether every demand is met, on the search's seeds and on those of the check.
    pub feasible: bool,
    /// Objective of each restart (infinite where it found nothing feasible).
    pub restarts_deg: Vec<f64>,
    /// How many of the search's designs were tried on the check seeds until one held.
    pub tried: usize,
}

/// Tunes one family. `progress(evaluations so far)` may stop the search by returning false.
///
/// # Errors
/// Settings of the family or the bench that cannot be used at all.
///
/// # Example
/// ```
/// use stillrate_lab::servo::bench::{Bench, Design};
/// use stillrate_lab::servo::search::Effort;
/// use stillrate_lab::servo::tuner::{Task, tune};
/// use stillrate_lab::servo::{controller::Controller, family::standard};
/// let bench = Bench::paper(50.0);
/// let start = Design { controller: Controller::default(), parameters: vec![] };
/// let effort = Effort { evaluations: 20, restarts: 1, seed: 5 };
/// let task = Task { budget_percent: 0.2, effort, seeds: vec![1], checks: vec![2], starts: vec![start] };
/// let found = tune(&bench, &standard(50.0, bench.noise)[0], &task, &mut |_| true).unwrap();
/// assert!(found.feasible && found.objective_deg < 3.6); // deg: no worse than the start, which holds the budget
/// ```
pub fn tune(
    bench: &Bench,
    family: &Family,
    task: &Task,
    progress: &mut dyn FnMut(usize) -> bool,
) -> Result<Tuned, SettingsError> {
    stillrate::error::positive("budget_percent", task.budget_percent, "%")?;
    stillrate::error::positive("seeds", task.seeds.len() as f64, "of them")?;
    let ranges: Vec<Range> = GAINS.iter().copied().chain(family.open.iter().map(|t| t.range)).collect();
    // Errors that do not depend on the point are reported once, here; so is a start that cannot be used.
    let middle: Vec<f64> = ranges.iter().map(|range| range.value(0.5)).collect();
    Trial::new(bench, family, &design_at(&middle))?;
    for design in &task.starts {
        let complete = f64::from(design.parameters.len() == family.open.len());
        stillrate::error::positive("starts", complete, "settings of the family")?;
        Trial::new(bench, family, design)?;
    }
    let starts: Vec<Vec<f64>> = task.starts.iter().map(point_of).collect();
    let mut going = true;
    let found =
        minimise(&ranges, &starts, task.effort, |point, best| score(bench, family, task, point, best), &mut |done| {
            going = progress(done);
            going
        });
    Ok(answer(&found, &|design| going && holds(bench, family, task, design)))
}

/// The best of the restarts' designs that hold, or else the best of all, called infeasible.
fn answer(found: &Found, holds: &dyn Fn(&Design) -> bool) -> Tuned {
    let mut tried = 0;
    let mut kept: Option<&Scored> = None;
    for ranked in &found.restarts {
        if let Some(candidate) = first_that_holds(ranked, &mut tried, holds)
            && kept.is_none_or(|held| candidate.1.beats(held.1))
        {
            kept = Some(candidate);
        }
    }
    let leaders: Vec<&Scored> = found.restarts.iter().map(|ranked| &ranked[0]).collect();
    let best = leaders.iter().fold(leaders[0], |best, other| if other.1.beats(best.1) { other } else { best });
    let (point, score) = kept.unwrap_or(best);
    let value = |s: &Score| if s.violation == 0.0 { s.value } else { f64::INFINITY };
    Tuned {
        design: design_at(point),
        objective_deg: value(score),
        feasible: kept.is_some(),
        restarts_deg: leaders.iter().map(|(_, score)| value(score)).collect(),
        tried,
    }
}

fn first_that_holds<'a>(
    ranked: &'a [Scored],
    tried: &mut usize,
    holds: &dyn Fn(&Design) -> bool,
) -> Option<&'a Scored> {
    let last = *tried + TRIED;
    let mut least = 0.0;
    for candidate in ranked.iter().take_while(|(_, score)| score.violation == 0.0) {
        if candidate.1.value < least {
            continue;
        }
        if *tried == last {
            break;
        }
        *tried += 1;
        if holds(&design_at(&candidate.0)) {
            return Some(candidate);
        }
        least = STRIDE * candidate.1.value;
    }
    None
}

/// Whether every demand holds on the check seeds; given up at the first group of seeds on which one does not.
fn holds(bench: &Bench, family: &Family, task: &Task, design: &Design) -> bool {
    let mut all = Vec::with_capacity(task.checks.len());
    for group in task.checks.chunks(GROUP) {
        let measured: Option<Vec<Demands>> = group
            .par_iter()
            .map(|seed| Demands::measured(&mut Trial::new(bench, family, design).ok()?, *seed).ok())
            .collect();
        match measured {
            Some(found) if Demands::hold_singly(&found) => all.extend(found),
            _ => return false,
        }
    }
    // Without check seeds there is nothing that could fail.
    all.is_empty() || Demands::hold(&all, task.budget_percent)
}

fn point_of(design: &Design) -> Vec<f64> {
    let c = &design.controller;
    [&[c.kappa, c.ko_per_s, c.kvi_per_s, c.kd_s][..], &design.parameters[..]].concat()
}

fn design_at(point: &[f64]) -> Design {
    let (gains, parameters) = point.split_at(GAINS.len());
    Design {
        controller: Controller {
            kappa: gains[0],
            ko_per_s: gains[1],
            kvi_per_s: gains[2],
            kd_s: gains[3],
            ..Controller::default()
        },
        parameters: parameters.to_vec(),
    }
}

fn score(bench: &Bench, family: &Family, task: &Task, point: &[f64], best: Score) -> Score {
    let Ok(mut trial) = Trial::new(bench, family, &design_at(point)) else { return Score::WORST };
    searched(&mut trial, &task.seeds, task.budget_percent, best).unwrap_or(Score::WORST)
}
