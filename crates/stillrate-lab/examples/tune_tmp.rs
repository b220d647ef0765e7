//! tmp
use std::time::Instant;
use stillrate_lab::servo::{family::standard, search::Effort, trial::*, tuner::*};
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
            effort: Effort { population: pop, generations: gen_, restarts: rs, seed: 11 },
            seeds: (101..113).collect(),
        };
        let r = tune(&bench, &f, &task, &mut |_| true).unwrap();
        let c = r.design.controller;
        println!(
            "{} {:.1}s obj {:.3} feas {} restarts {:?}\n   k {:.3} Ko {:.3} Kvi {:.1} kd {:.2}ms par {:?}",
            f.name,
            t.elapsed().as_secs_f64(),
            r.objective_deg,
            r.feasible,
            r.restarts_deg,
            c.kappa,
            c.ko_per_s,
            c.kvi_per_s,
            1e3 * c.kd_s,
            r.design.parameters
        );
        let mut tr = Trial::new(&bench, &f, &r.design).unwrap();
        for seed in 9001..9009 {
            let x = tr.residual(seed).unwrap();
            println!(
                "   seed {seed}: {:.3} {:.3} jit {:.4} quiet {:.4} lev {:.3}",
                x.rms_deg,
                x.max_deg,
                tr.jitter_after_tilt(seed, 1.0, 0.0).unwrap(),
                tr.jitter_undisturbed(seed).unwrap(),
                tr.levelling_error_deg(seed, 20.0).unwrap()
            );
        }
        println!(
            "   GM {} DM {} mj {:.3} tilt {:?}",
            tr.gain_margin(9001).unwrap(),
            tr.delay_margin_ms(9001).unwrap(),
            tr.motion_jitter(9001, 9002).unwrap(),
            [20., 15., 10., 5.].map(|d| (tr.tilt_peak_deg(9001, d, 0.4).unwrap() * 100.).round() / 100.)
        );
    }
}
