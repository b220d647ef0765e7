//! The reference outputs of the rate-table family, replayed against the Rust interface.
#![allow(missing_docs)]

use serde_json::Value;
use stillrate_lab::random::{Generator, SplitMix64};
use stillrate_lab::rate_table::candidate::from_network;
use stillrate_lab::rate_table::fit::{STEEPEST_SLOPE, guard};
use stillrate_lab::rate_table::levenberg::Trial;
use stillrate_lab::rate_table::network::{Network, Scaling, Shape};
use stillrate_lab::tune::gain_ratio::{Criterion, GainRatio, Walk};
use stillrate_lab::tune::qpso::{Attractor, Bound, Qpso};
use stillrate_lab::tune::records::Record;

/// What the reference files ask for.
const TOLERANCE: f64 = 1e-12;

fn load(name: &str) -> Value {
    let path = format!("{}/../../tests/reference/rate_table/{name}.json", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(items) => items.iter().flat_map(numbers).collect(),
        number => vec![number.as_f64().unwrap()],
    }
}

fn close(name: &str, got: &[f64], expected: &Value, tolerance: f64) {
    let expected = numbers(expected);
    assert_eq!(got.len(), expected.len(), "{name}");
    for (g, e) in got.iter().zip(&expected) {
        assert!((g - e).abs() <= tolerance, "{name}: {g} instead of {e}");
    }
}

#[test]
fn uniform_numbers_are_those_of_the_reference() {
    let file = load("splitmix64");
    let mut generator = SplitMix64::new(file["seed"].as_u64().unwrap());
    let got: Vec<f64> = (0..10).map(|_| generator.uniform()).collect();
    assert_eq!(got, numbers(&file["first"]));
}

#[test]
fn networks_their_derivatives_and_steps_are_those_of_the_reference() {
    for (name, case) in load("network").as_object().unwrap() {
        let shape = Shape {
            inputs: case["I"].as_u64().unwrap() as usize,
            hidden: case["H"].as_u64().unwrap() as usize,
            linear: case["linear"].as_bool().unwrap(),
        };
        let network = Network::new(shape, numbers(&case["params"])).unwrap();
        let (rows, targets) = (numbers(&case["X"]), numbers(&case["target"]));
        let each = |f: &mut dyn FnMut(&[f64]) -> f64| rows.chunks(shape.inputs).map(f).collect::<Vec<_>>();
        close(name, &each(&mut |x| network.output(x)), &case["forward"], TOLERANCE);
        close(name, &each(&mut |x| network.slope(x)), &case["dydx_first_input"], TOLERANCE);
        let mut gradient = vec![0.0; shape.parameters()];
        let mut jacobian = Vec::new();
        rows.chunks(shape.inputs).for_each(|x| {
            network.gradient(x, &mut gradient);
            jacobian.extend_from_slice(&gradient);
        });
        close(name, &jacobian, &case["jacobian"], TOLERANCE);
        let lm = &case["lm"];
        let (decay, mu) = (lm["lam"].as_f64().unwrap(), lm["mu"].as_f64().unwrap());
        assert_eq!(shape.decay_mask(), numbers(&lm["decay_mask"]));
        let trial = Trial::of(&network, &rows, &targets, decay, None, mu).unwrap();
        close(name, &[trial.mse], &case["mse"], TOLERANCE);
        close(name, &trial.gradient, &case["grad_mse"], TOLERANCE);
        close(name, &[trial.before], &lm["objective_before"], TOLERANCE);
        close(name, &[trial.after], &lm["objective_after"], 1e-9);
        let size = numbers(&lm["step"]).iter().fold(0.0_f64, |a, v| a.max(v.abs()));
        close(name, &trial.step, &lm["step"], 1e-9 * size);
    }
}

#[test]
fn the_random_walk_objectives_are_those_of_the_reference() {
    let file = load("kf");
    let (z, truth) = (numbers(&file["z"]), numbers(&file["truth"]));
    let records = [Record { measured: &z, truth: Some(&truth) }];
    let mut checked = 0;
    for case in file["cases"].as_array().unwrap().iter().filter(|case| case["start"] == "diffuse") {
        let ratio = case["Q"].as_f64().unwrap() / case["R"].as_f64().unwrap();
        let objective = |criterion| GainRatio { records: &records, walk: Walk::RandomWalk, criterion, period_s: 1.0 };
        let blind = objective(Criterion::Innovation).scores(&[ratio])[0];
        close("nll", &[blind.innovation], &case["nll_concentrated"], TOLERANCE);
        close("R", &[blind.measurement_variance], &case["R_hat"], TOLERANCE);
        let seen = objective(Criterion::Truth).scores(&[ratio])[0];
        close("mse", &[seen.mean_square_error], &case["mse"], TOLERANCE);
        checked += 1;
    }
    assert_eq!(checked, 3);
}

#[test]
fn the_swarm_moves_as_in_the_reference() {
    let file = load("qpso");
    let uniforms = numbers(&file["uniforms"]);
    for case in file["cases"].as_array().unwrap() {
        let number = |name: &str| case[name].as_f64().unwrap();
        let settings = Qpso {
            particles: number("n") as usize,
            iterations: number("iters_schedule") as usize,
            last_contraction: number("w1"),
            first_contraction: number("w2"),
            own_weight: number("c1"),
            swarm_weight: number("c2"),
            target: f64::NEG_INFINITY,
            attractor: if case["phi"] == "ratio" { Attractor::Ratio } else { Attractor::Uniform },
            bound: if case["bound"] == "clip" { Bound::Clip } else { Bound::Reflect },
            seed: 0,
        };
        let mut stream = uniforms.iter().copied();
        let mut trace = Vec::new();
        let mut f = |x: &[f64]| (x[0] - 0.7) * (x[0] - 0.7) + 2.0 * (x[1] + 0.3) * (x[1] + 0.3) + 0.5 * x[0] * x[1];
        let (low, high) = (numbers(&case["lo"]), numbers(&case["hi"]));
        let end = settings
            .run(&mut f, &low, &high, &mut || stream.next().unwrap(), &mut |swarm| {
                trace.push(swarm.clone());
                true
            })
            .unwrap();
        for (expected, swarm) in case["trace"].as_array().unwrap().iter().zip(&trace) {
            close("x", &swarm.position, &expected["x"], TOLERANCE);
            close("f", &swarm.value, &expected["f"], TOLERANCE);
            close("gbest", &swarm.swarm_best, &expected["gbest"], TOLERANCE);
            if swarm.iteration > 0 {
                close("beta", &[swarm.contraction], &expected["beta"], TOLERANCE);
                close("mbest", &swarm.mean_best, &expected["mbest"], TOLERANCE);
                close("pbest", &swarm.best, &expected["pbest"], TOLERANCE);
            }
        }
        close("final", &end.swarm_best, &case["final"]["gbest"], TOLERANCE);
        close("final", &[end.swarm_value], &case["final"]["gf"], TOLERANCE);
        assert_eq!(trace.len() * settings.particles, case["final"]["evals"].as_u64().unwrap() as usize);
    }
}

#[test]
fn the_staircase_is_rejected() {
    let file = load("staircase_net");
    let network = Network::new(Shape { inputs: 1, hidden: 10, linear: false }, numbers(&file["params"])).unwrap();
    let one = |name: &str| match &file[name] {
        Value::Array(items) => items[0].as_f64().unwrap(),
        number => number.as_f64().unwrap(),
    };
    let scaling = Scaling { inputs: vec![(one("x_min"), one("x_range"))], output: (one("e_min"), one("e_range")) };
    let curve = from_network(&network, &scaling, 1);
    let at = |f: &dyn Fn([f64; 3]) -> f64| numbers(&file["y"]).iter().map(|y| f([*y, 0.0, 0.0])).collect::<Vec<_>>();
    close("e", &at(&|x| curve.error(x).0), &file["e"], TOLERANCE);
    close("slope", &at(&|x| curve.slope(x)), &file["slope_e"], TOLERANCE);
    assert!(guard(&curve, STEEPEST_SLOPE).unwrap_err().contains("rejected"));
}

#[test]
fn a_candidate_is_worth_the_same_alone_and_in_any_company() {
    let z: Vec<f64> = numbers(&load("kf")["z"]).repeat(60);
    let mut holed = z.clone();
    holed[700..720].fill(f64::NAN);
    let records = [Record { measured: &z, truth: Some(&z) }, Record { measured: &holed, truth: Some(&z) }];
    let ratios: Vec<f64> = (0..45).map(|k| f64::from(k * 7 % 45 + 1) * 0.003).collect();
    for (walk, criterion) in [
        (Walk::RandomWalk, Criterion::Innovation),
        (Walk::RandomWalk, Criterion::Truth),
        (Walk::RateAcceleration, Criterion::Innovation),
        (Walk::RateAcceleration, Criterion::Truth),
    ] {
        let objective = GainRatio { records: &records, walk, criterion, period_s: 0.1 };
        let value = |s: &stillrate_lab::tune::gain_ratio::Score| match criterion {
            Criterion::Innovation => (s.innovation.to_bits(), s.measurement_variance.to_bits()),
            Criterion::Truth => (s.mean_square_error.to_bits(), 0),
        };
        let together: Vec<_> = objective.scores(&ratios).iter().map(value).collect();
        let alone: Vec<_> = ratios.iter().map(|q| value(&objective.scores(&[*q])[0])).collect();
        assert_eq!(together, alone);
    }
}
