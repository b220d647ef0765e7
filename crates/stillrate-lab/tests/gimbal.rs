//! The gimbal calibration against its unit vectors, its bound and itself: what the Python suite does not reach or reaches slowly.

use std::path::Path;

use nalgebra::{Matrix3, Vector3};
use serde_json::Value;
use stillrate::gimbal::rotation::exponential;
use stillrate::gimbal::{
    COUNT, Coefficients, DEFAULT_SCALE, Estimator, ForceAxis, Gauge, Geometry, GyroAxes, JointFilter, Model, Options,
    Record, Reference, Relinearised, Selection,
};
use stillrate_lab::gimbal::{
    Disturbance, Draw, Method, Settings, Start, Study, Trajectory, calibrate, disturb, draw, outputs, run_study,
    sensitivities,
};
use stillrate_lab::statistics::median;

fn vectors() -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/reference/self_calibration/unit_vectors.json");
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(items) => items.iter().flat_map(numbers).collect(),
        other => vec![other.as_f64().unwrap()],
    }
}

fn matrix(value: &Value) -> Matrix3<f64> {
    Matrix3::from_row_slice(&numbers(value))
}

fn assert_close(found: &[f64], wanted: &[f64], relative: f64, what: &str) {
    let largest = wanted.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    assert_eq!(found.len(), wanted.len(), "{what}");
    for (a, b) in found.iter().zip(wanted) {
        assert!((a - b).abs() <= relative * largest, "{what}: {a} is not {b}");
    }
}

fn rows(m: &Matrix3<f64>) -> Vec<f64> {
    m.transpose().iter().copied().collect()
}

fn place() -> Model {
    let mut model = Model::new(9.8, 40_f64.to_radians()).unwrap();
    model.refined = false;
    model
}

#[test]
fn single_steps_equal_the_unit_vectors() {
    let document = vectors();
    let model = place();
    let mut x: Coefficients = [0.0; COUNT];
    x[..33].copy_from_slice(&numbers(&document["x"]));
    for case in document["rexp"].as_array().unwrap() {
        let v = Vector3::from_row_slice(&numbers(&case["v"]));
        assert_close(&rows(&exponential(&v)), &numbers(&case["R"]), 1e-12, "rexp");
    }
    for i in 0..3 {
        let axes = GyroAxes::new(&model.triads.gyro[i], x[15 + i], x[18 + i]);
        let found: Vec<f64> = [axes.input, axes.output, axes.spin].iter().flatten().copied().collect();
        assert_close(&found, &numbers(&document["gyro_axes"][i]), 1e-12, "gyro axes");
        let axis = ForceAxis::new(&model.triads.accelerometer[i], x[27 + i], x[30 + i]);
        let wanted = &document["acc_axis"][i];
        assert_close(axis.input.as_slice(), &numbers(&wanted["a"]), 1e-12, "a");
        assert_close(axis.by_pendulous_angle.as_slice(), &numbers(&wanted["da_dthp"]), 1e-12, "da/dthp");
        assert_close(axis.by_output_angle.as_slice(), &numbers(&wanted["da_dtho"]), 1e-12, "da/dtho");
    }
    let geometry = Geometry::new(&model, &x);
    for (case, output) in document["step"].as_array().unwrap().iter().zip(document["h"].as_array().unwrap()) {
        let command = Vector3::from_row_slice(&numbers(&case["w_cmd"]));
        let step = geometry.step(&model, &matrix(&case["R_in"]), &command, 0.25);
        assert_close(&rows(&step.rotation), &numbers(&case["R_out"]), 1e-12, "R_out");
        assert_close(step.rate.as_slice(), &numbers(&case["omega_p"]), 1e-12, "omega_p");
        assert_close(step.force.as_slice(), &numbers(&case["f_mid"]), 1e-12, "f_mid");
        assert_close(&geometry.output(&model, &step.rotation), &numbers(&output["z"]), 1e-12, "z");
        let force = model.force(&step.rotation);
        let jacobian: Vec<f64> =
            (0..3).flat_map(|i| geometry.output_row(i, &force, &Vector3::zeros()).1[..33].to_vec()).collect();
        assert_close(&jacobian, &numbers(&output["H"]), 1e-12, "H");
    }
}

#[test]
fn sensitivities_equal_the_unit_vectors_over_the_whole_run() {
    let document = vectors();
    let model = place();
    let mut x: Coefficients = [0.0; COUNT];
    x[..33].copy_from_slice(&numbers(&document["x"]));
    let commands = Trajectory::default().commands(&model).unwrap();
    let mut seen = 0;
    sensitivities(&model, &x, &commands, 0.25, |k, _, _, value, jacobian| {
        let wanted = &document["sens"][k.to_string()];
        if wanted.is_null() {
            return;
        }
        seen += 1;
        assert_close(value, &numbers(&wanted["z"]), 1e-10, "z");
        let all = numbers(&wanted["J"]);
        for i in 0..33 {
            let column: Vec<f64> = (0..3).map(|axis| jacobian[axis][i]).collect();
            let expected: Vec<f64> = (0..3).map(|axis| all[33 * axis + i]).collect();
            assert_close(&column, &expected, 1e-9, "J");
        }
    });
    assert!(seen >= 4);
}

struct Run {
    commands: Vec<[f64; 3]>,
    samples: Vec<[f64; 3]>,
}

fn run(model: &Model, seed: u64) -> Run {
    let commands = Trajectory::default().commands(model).unwrap();
    let clean = outputs(model, &draw(&DEFAULT_SCALE, 1.0, seed), &commands, 0.25, 5, 1, 0.0, seed);
    Run { samples: disturb(&clean, &Disturbance::default(), seed).unwrap(), commands }
}

#[test]
fn recursive_and_batch_solutions_are_the_same_in_both_precisions() {
    let model = Model::new(9.8, 40_f64.to_radians()).unwrap();
    let data = run(&model, 5);
    let record = Record::new(&data.commands, &data.samples, 0.25, 1e-6).unwrap();
    let settings = Settings { every: usize::MAX, robust: false, ..Settings::new(model) };
    let batch = calibrate(&record, Method::Batch, &settings).unwrap();
    for (single, tolerance) in [(false, 1e-6), (true, 1e-5)] {
        let found = calibrate(&record, Method::Relinearised, &Settings { single, ..settings }).unwrap();
        for i in 0..33 {
            let off = (found.coefficients[i] - batch.coefficients[i]).abs() / DEFAULT_SCALE[i];
            assert!(off < tolerance, "coefficient {i}: {off:e} with single = {single}");
            let spread = (found.deviation[i] - batch.deviation[i]).abs();
            assert!(spread <= 2e-3 * batch.deviation[i] + 1e-12, "deviation {i}");
        }
    }
}

#[test]
fn wide_vectors_change_no_bit() {
    let model = Model::new(9.8, 40_f64.to_radians()).unwrap();
    let data = run(&model, 6);
    let record = Record::new(&data.commands[..600], &data.samples[..3001], 0.25, 1e-6).unwrap();
    let settings = Settings { every: usize::MAX, ..Settings::new(model) };
    // This crate is compiled without AVX2, the library picks it where it can.
    let selection = Selection::<32>::new(Gauge::Accelerometer, Options::default()).unwrap();
    let estimator = Estimator::<f64, 32>::new(model, selection, &DEFAULT_SCALE, 0.0).unwrap();
    let narrow = Relinearised { estimator, reference: Reference::Model }.run(&record, &[0.0; COUNT], |_, _, _| {});
    let wide = calibrate(&record, Method::Relinearised, &settings).unwrap();
    assert_eq!(narrow.coefficients, wide.coefficients);
    assert_eq!(narrow.deviation, wide.deviation);
    let filter = JointFilter::new(estimator, 5.0).unwrap();
    let mut state = filter.start(&[0.0; COUNT]);
    (0..record.epochs()).for_each(|k| {
        filter.epoch(&mut state, &record, k, Reference::Model);
    });
    let wide = calibrate(&record, Method::OnLine, &settings).unwrap();
    assert_eq!(filter.attitude_and_coefficients(&state), wide.coefficients);
}

fn study(seeds: std::ops::Range<u64>, change: impl Fn(&mut Study)) -> Vec<Draw> {
    let mut study = Study::new(Model::new(9.8, 40_f64.to_radians()).unwrap());
    change(&mut study);
    run_study(&study, &seeds.collect::<Vec<_>>()).unwrap()
}

#[test]
fn errors_are_as_large_as_the_bound_says_and_starts_do_not_matter() {
    let zero = study(71..75, |_| {});
    let mean = zero.iter().map(|d| d.error_over_bound).sum::<f64>() / zero.len() as f64;
    // 27 coefficients of four draws: chi-square over its 108 degrees of freedom, four deviations wide.
    assert!((mean - 1.0).abs() < 4.0 * f64::sqrt(2.0 / 108.0), "{mean}");
    let scattered = study(71..75, |s| s.start = Start::Scattered);
    for (a, b) in zero.iter().zip(&scattered) {
        assert!(a.tests.is_some_and(|t| !t.alarm()));
        for i in (3..33).filter(|&i| a.outcome.deviation[i] > 0.0) {
            let apart = (a.outcome.coefficients[i] - b.outcome.coefficients[i]).abs() / a.outcome.deviation[i];
            assert!(apart < 0.02, "coefficient {i}: {apart} sigma");
        }
    }
}

#[test]
fn a_torquer_error_is_noticed_and_estimated_and_costs_much_otherwise() {
    let with_error = |options: Options| {
        study(81..82, |s| {
            s.extra[33..36].copy_from_slice(&[1e-5, -1e-5, 1e-5]);
            s.settings.options = options;
        })
    };
    let blind = with_error(Options::default());
    assert!(blind[0].tests.is_some_and(|t| t.alarm()) && blind[0].score.other > 0.1);
    let knowing = with_error(Options { torquer: true, ..Options::default() });
    assert!(knowing[0].tests.is_some_and(|t| !t.alarm()) && knowing[0].score.other < 3e-3);
    assert!((knowing[0].outcome.coefficients[33] - 1e-5).abs() < 1e-7);
}

/// 20 draws: figures asked of the recommended and of the on-line filter. The largest error of 20 draws is a matter of chance even at the
/// bound: of 20 such studies with other seeds (NEES/n 1.006 over all 400 draws) 16 stay within 0.13 %, the worst reaches 0.158 %.
#[test]
#[ignore = "long"]
fn twenty_draws_meet_the_figures_asked_for() {
    let sorted = |draws: &[Draw]| {
        let mut errors: Vec<f64> = draws.iter().map(|d| 100.0 * d.score.other).collect();
        assert!(errors.iter().all(|error| error.is_finite()), "a draw was lost");
        errors.sort_by(f64::total_cmp);
        errors
    };
    let per_cent = |draws: &[Draw]| median(&mut sorted(draws));
    let worst = |draws: &[Draw]| sorted(draws)[draws.len() - 1];
    let small = study(3001..3021, |_| {});
    let mean = small.iter().map(|d| d.error_over_bound).sum::<f64>() / 20.0;
    assert!((0.85..=1.15).contains(&mean), "NEES/n {mean}");
    assert!(per_cent(&small) <= 0.06 && worst(&small) <= 0.13);
    let large = study(3001..3021, |s| {
        s.gyro_factor = 10.0;
        s.settings = s.settings.with_gyro_scale(10.0);
    });
    assert!(worst(&large) <= 0.02);
    let mut times: Vec<f64> = large.iter().map(|d| d.settling_s[2].unwrap_or(f64::INFINITY)).collect();
    assert!(times.iter().all(|t| *t < 900.0) && median(&mut times) <= 500.0);
    let line = study(3001..3021, |s| s.method = Method::OnLine);
    assert!(per_cent(&line) <= 0.12, "{}", per_cent(&line));
    let noisy = study(3001..3021, |s| {
        s.disturbance.sigma_m_s2 = 1e-4;
        s.sigma_m_s2 = 1e-4;
    });
    assert!(per_cent(&noisy) <= 5.5);
    let single = study(3001..3021, |s| {
        s.method = Method::FirstOrder;
        s.settings.reference = Reference::Commanded;
    });
    assert!(per_cent(&single) >= 40.0 * per_cent(&small));
}
