//! tmp
use std::time::Instant;
use stillrate_lab::servo::{family::standard, search::Effort, seeds, study, trial::*, tuner::*};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let (rate, budget, names): (f64, f64, &str) = (a[1].parse().unwrap(), a[2].parse().unwrap(), &a[3]);
    let (pop, gen_, rs): (usize, usize, usize) = (a[4].parse().unwrap(), a[5].parse().unwrap(), a[6].parse().unwrap());
    let bench = Bench::paper(rate);
    for f in standard(rate, bench.noise) {
        if names != "all" && !names.split(',').any(|n| n == f.name) {
            continue;
        }
        let t = Instant::now();
        let task = Task {
            budget_percent: budget,
            effort: Effort { population: pop, generations: gen_, restarts: rs, seed: seeds::SEARCH },
            seeds: seeds::TUNING.to_vec(),
        };
        let r = tune(&bench, &f, &task, &mut |_| true).unwrap();
        let c = r.design.controller;
        let took = t.elapsed().as_secs_f64();
        let row = study::validate(&bench, &f, &r.design, &seeds::VALIDATION, 6).unwrap();
        println!(
            "{rate} Hz {budget} {} {:.1}s obj {:.3} feas {} restarts {:?}\n   k {:.4} Ko {:.4} Kvi {:.2} kd {:.3}ms par {:?}\n   {row:?}",
            f.name,
            took,
            r.objective_deg,
            r.feasible,
            r.restarts_deg,
            c.kappa,
            c.ko_per_s,
            c.kvi_per_s,
            1e3 * c.kd_s,
            r.design.parameters
        );
        println!(
            "   tilt {:?}",
            study::tilt_table(&bench, &f, &r.design, &[20., 15., 10., 5.], 0.4, &seeds::VALIDATION[..3]).unwrap()
        );
    }
}
