//! The tuner: equal effort, the same numbers again, and designs that hold where the search did not look.

use stillrate_lab::servo::bench::Bench;
use stillrate_lab::servo::chain::linear_equivalent;
use stillrate_lab::servo::family::{Family, standard};
use stillrate_lab::servo::loop_filter::LoopFilter;
use stillrate_lab::servo::search::Effort;
use stillrate_lab::servo::study::validate;
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
