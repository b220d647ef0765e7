//! The tuner: equal effort, the same numbers again, and designs that hold where the search did not look.

use stillrate_lab::servo::controller::Controller;
use stillrate_lab::servo::family::{Family, standard};
use stillrate_lab::servo::loop_filter::{LoopFilter, linear_equivalent};
use stillrate_lab::servo::search::{Effort, Range, Score, minimise};
use stillrate_lab::servo::study::validate;
use stillrate_lab::servo::trial::{Bench, Design, Trial};
use stillrate_lab::servo::tuner::{Task, Tuned, tune};

fn family(name: &str) -> Family {
    let bench = Bench::paper(50.0);
    standard(bench.sample_rate_hz, bench.noise).into_iter().find(|f| f.name == name).unwrap()
}

fn task(budget_percent: f64, evaluations: usize) -> Task {
    let effort = Effort { evaluations, restarts: 2, seed: 5 };
    Task { budget_percent, effort, seeds: vec![1, 2], checks: vec![3, 4, 5], starts: vec![] }
}

fn tuned(name: &str, task: &Task) -> (Tuned, Vec<usize>) {
    let mut seen = Vec::new();
    let found = tune(&Bench::paper(50.0), &family(name), task, &mut |done| {
        seen.push(done);
        true
    });
    (found.unwrap(), seen)
}

#[test]
fn every_filter_gets_as_many_evaluations() {
    let task = task(0.2, 40);
    let (_, without) = tuned("none", &task);
    for name in ["pt1", "one-euro"] {
        assert_eq!(tuned(name, &task).1, without, "{name}");
    }
    assert_eq!(without.last(), Some(&40));
}

#[test]
fn a_kept_design_holds_on_seeds_the_search_did_not_see() {
    let task = task(0.2, 200);
    let (found, _) = tuned("none", &task);
    assert!(found.feasible && found.tried >= 1);
    assert_eq!(found.restarts_deg.len(), 2);
    assert!(found.objective_deg >= found.restarts_deg.iter().copied().fold(f64::INFINITY, f64::min));
    let row = validate(&Bench::paper(50.0), &family("none"), &found.design, &task.checks, 3).unwrap();
    assert!(row.jitter_percent <= 0.2 && row.gain_margin >= 2.0 && row.delay_margin_ms >= 10.0);
    assert!(row.jitter_seeds.high < 2.0 * row.undisturbed_percent);
    assert!(row.levelling_own_deg.mean <= 0.05);
}

#[test]
fn an_impossible_budget_is_called_infeasible() {
    let (found, _) = tuned("none", &task(1e-6, 16));
    assert!(!found.feasible && found.objective_deg.is_infinite());
}

#[test]
fn a_search_gives_the_same_numbers_on_any_number_of_threads() {
    let bowl = |x: &[f64], _: Score| Score { violation: (0.3 - x[0]).max(0.0), value: x[0] * x[0] + x[1] * x[1] };
    let range = Range { low: -2.0, high: 2.0, logarithmic: false };
    let effort = Effort { evaluations: 500, restarts: 2, seed: 9 };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| minimise(&[range; 2], &[], effort, bowl, &mut |_| true))
    };
    assert_eq!(on(1), on(3));
}

#[test]
fn a_search_finds_the_lower_of_two_valleys() {
    // A wide valley at x = -1 and a narrow, deeper one at x = 1.5.
    let valleys = |x: &[f64], _: Score| {
        let wide = (x[0] + 1.0).powi(2);
        let narrow = 20.0 * (x[0] - 1.5).powi(2) - 0.5;
        Score { violation: 0.0, value: wide.min(narrow) + x[1..].iter().map(|v| v * v).sum::<f64>() }
    };
    let range = Range { low: -3.0, high: 3.0, logarithmic: false };
    let found = minimise(&[range; 4], &[], Effort { evaluations: 4800, restarts: 4, seed: 2 }, valleys, &mut |_| true);
    let best = found.restarts.iter().map(|ranked| ranked[0].1.value).fold(f64::INFINITY, f64::min);
    assert!(best < -0.49, "{best}");
}

#[test]
fn what_is_not_a_number_never_wins() {
    let range = Range { low: 0.0, high: 1.0, logarithmic: false };
    let holes = |x: &[f64], _: Score| Score { violation: 0.0, value: if x[0] < 0.5 { f64::NAN } else { x[0] } };
    let effort = Effort { evaluations: 300, restarts: 1, seed: 3 };
    let found = minimise(&[range], &[], effort, holes, &mut |_| true);
    assert!((found.restarts[0][0].0[0] - 0.5).abs() < 1e-2);
}

#[test]
fn levelling_tells_the_loop_from_its_gyro() {
    // A biased gyro tilts the platform by bias times 25 s, less half of the last 2 s; the loop has no part in that.
    let bench = Bench { bias_dps: 0.02, ..Bench::paper(50.0) };
    let design = Design { controller: Controller::default(), parameters: vec![] };
    let none = family("none");
    let mut trial = Trial::new(&bench, &none, &design).unwrap();
    let runs: Vec<_> = (1..9).map(|seed| trial.levelling(seed, 20.0).unwrap()).collect();
    let mean = |f: fn(&stillrate_lab::servo::trial::Levelling) -> f64| runs.iter().map(f).sum::<f64>() / 8.0;
    // Angle random walk: 0.0152 deg/sqrt(s) over 24 s, 0.074 deg a run.
    assert!((mean(|l| l.error_deg) - 0.48).abs() < 4.0 * 0.074 / 8.0_f64.sqrt(), "{}", mean(|l| l.error_deg));
    assert!(mean(|l| l.own_deg) < 0.03, "{}", mean(|l| l.own_deg));
}

#[test]
fn a_second_order_low_pass_counts_as_what_it_is() {
    let biquad = family("biquad");
    let (mut equivalent, whole) = linear_equivalent(&biquad.filled(&[2.0]));
    assert!(whole);
    let mut own = biquad.build(&[2.0]).unwrap();
    for k in 0..200 {
        let rate = f64::from(k % 17) - 8.0;
        assert!((own.step(rate) - equivalent.step(rate)).abs() < 1e-9, "{k}");
    }
}
