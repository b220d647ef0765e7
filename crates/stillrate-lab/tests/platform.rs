//! The platform against its reference outputs, its linearisation, and what a user may get wrong.

use std::f64::consts::TAU;

use serde_json::Value;
use stillrate::Real;
use stillrate_lab::servo::base::{Base, Recorded};
use stillrate_lab::servo::controller::Controller;
use stillrate_lab::servo::discrete::Discrete;
use stillrate_lab::servo::linear::LinearLoop;
use stillrate_lab::servo::loop_filter::Unfiltered;
use stillrate_lab::servo::measure;
use stillrate_lab::servo::open_loop::open_loop;
use stillrate_lab::servo::plant::{Curves, Plant};
use stillrate_lab::servo::platform::{GyroErrors, Platform};

fn reference() -> Value {
    serde_json::from_str(include_str!("../../../tests/reference/servo/plant.json")).unwrap()
}

fn number(v: &Value) -> f64 {
    v.as_f64().unwrap()
}

fn plant_of(case: &Value) -> Plant {
    let mut plant = Plant { curves: Curves::Transcendental, ..Plant::platform_30kg() };
    for (name, symbol, _) in Plant::FIELDS {
        *plant.number_mut(name).unwrap() = number(&case[*symbol]);
    }
    plant
}

fn table(v: &Value) -> Vec<Vec<f64>> {
    v.as_array().unwrap().iter().map(|row| row.as_array().unwrap().iter().map(number).collect()).collect()
}

/// Largest magnitude of every column.
fn largest<const N: usize>(rows: &[[f64; N]]) -> [f64; N] {
    std::array::from_fn(|c| rows.iter().map(|row| row[c].abs()).fold(0.0, f64::max))
}

/// Largest deviation of a column, relative to its largest magnitude over the run.
fn worst(ours: &[Vec<f64>], theirs: &[Vec<f64>], scale: &[f64]) -> f64 {
    let mut worst = 0.0_f64;
    for (a, b) in ours.iter().zip(theirs) {
        for c in 0..b.len() {
            worst = worst.max((a[c] - b[c]).abs() / scale[c].max(1e-300));
        }
    }
    worst
}

#[test]
fn the_open_loop_plant_follows_its_reference() {
    let all = reference();
    for name in ["open_loop_linear", "open_loop_full"] {
        let case = &all["cases"][name];
        let plant = plant_of(&case["plant"]);
        let base = Base::Sine { amplitude_rad: number(&case["base"]["A_rad"]), frequency_hz: 1.0, ramp_s: 1.0 };
        let voltage: Vec<f64> = (0..200).map(|k| 6.0 * (TAU * 0.7 * f64::from(k) * 0.02).sine_cosine().0).collect();
        let states = open_loop(&plant, &base, &voltage, [0.0; 7], 1e-3, 20).unwrap();
        let ours: Vec<Vec<f64>> = states.iter().skip(10).step_by(10).map(|x| x.to_vec()).collect();
        let scale = largest(&states);
        let off = worst(&ours, &table(&case["states"]), &scale);
        // The issue asks for 1e-9; an independent program measured 1e-13.
        assert!(off < 1e-11, "{name}: {off:e}");
    }
}

#[test]
fn the_closed_loop_follows_its_reference() {
    let all = reference();
    for (name, case) in all["cases"].as_object().unwrap() {
        if !name.starts_with("closed") {
            continue;
        }
        let plant = plant_of(&all["cases"][format!("open_loop_{}", case["plant"].as_str().unwrap())]["plant"]);
        let ctrl = &case["ctrl"];
        let gains = Controller {
            kappa: number(&ctrl["kap"]),
            ko_per_s: number(&ctrl["Ko"]),
            kvi_per_s: number(&ctrl["Kvi"]),
            kd_s: number(&ctrl["kd"]),
            ..Controller::default()
        };
        let parameter = |i: usize| number(&case["filter_params"][i]);
        let mut filter = match number(&case["filter_kind"]) as i32 {
            0 => Discrete::None,
            1 => Discrete::pt1(50.0, parameter(0)).unwrap(),
            2 => Discrete::butterworth(50.0, parameter(0)).unwrap(),
            _ => Discrete::kalman(parameter(0), parameter(1)).unwrap(),
        };
        let (a, ramp) = (number(&case["A_rad"]), number(&case["t_ramp"]));
        let base = match number(&case["base_kind"]) as i32 {
            0 => Base::Tilt { amplitude_rad: a, duration_s: ramp },
            1 => Base::Sine { amplitude_rad: a, frequency_hz: number(&case["f_hz"]), ramp_s: ramp },
            _ => Base::Constant { angle_rad: a },
        };
        let mut gyro = GyroErrors::default();
        if case["noise"] == "lcg" {
            let (mut word, sigma) = (12345_u64, number(&case["noise_sigma_rad_s"]));
            gyro.samples_rad_s = (0..400)
                .map(|_| {
                    word = (1_103_515_245 * word + 12_345) % (1 << 31);
                    sigma * 12.0.root() * (word as f64 / (1_u64 << 31) as f64 - 0.5)
                })
                .collect();
        }
        let axis = Platform::new(plant, gains, 50.0, 1e-3, 5e-3).unwrap();
        let record = axis.run(&mut filter, &base, &gyro, number(&case["theta0"]), 8.0).unwrap();
        let scale = largest(&record.rows);
        let ours: Vec<Vec<f64>> = table(&Value::Array(vec![case["tick"].clone()]))[0]
            .iter()
            .map(|k| record.rows[*k as usize].to_vec())
            .collect();
        let off = worst(&ours, &table(&case["rec"]), &scale);
        println!("{name}: {off:e} of {:e}", number(&case["rel_tol"]));
        assert!(off <= number(&case["rel_tol"]), "{name}: {off:e}");
    }
}

fn default_axis() -> Platform {
    Platform::new(Plant::platform_30kg(), Controller::default(), 50.0, 1e-3, 5e-3).unwrap()
}

fn ten_degrees() -> Base {
    Base::Sine { amplitude_rad: 10.0_f64.to_radians(), frequency_hz: 1.0, ramp_s: 1.0 }
}

#[test]
fn halving_the_step_gains_fourth_order_on_the_linear_plant() {
    let theta = |dt: f64| {
        let axis = Platform::new(Plant::platform_30kg().linear(), Controller::default(), 50.0, dt, 4e-3).unwrap();
        axis.run(&mut Unfiltered, &ten_degrees(), &GyroErrors::default(), 0.0, 3.0).unwrap().last_state[0]
    };
    let finest = theta(0.125e-3);
    let ratio = (theta(1e-3) - finest).abs() / (theta(0.5e-3) - finest).abs();
    assert!((12.0..22.0).contains(&ratio), "{ratio}");
}

#[test]
fn the_algebraic_curves_change_the_residual_little() {
    let run = |curves| {
        let plant = Plant { curves, ..Plant::platform_30kg() };
        let axis = Platform::new(plant, Controller::default(), 50.0, 1e-3, 5e-3).unwrap();
        let record = axis.run(&mut Unfiltered, &ten_degrees(), &GyroErrors::default(), 0.0, 8.0).unwrap();
        measure::residual(&record, 3.0, 0.02).rms_deg
    };
    let (exact, fast) = (run(Curves::Transcendental), run(Curves::Algebraic));
    assert!((fast / exact - 1.0).abs() < 0.03, "{fast} {exact}");
}

#[test]
fn the_linear_loop_knows_the_aliased_mode() {
    // Spec, section 2: radius 1.0149 without a filter, stable with PT1 5.3 Hz.
    for ko in [0.3, 0.5] {
        let gains = Controller { kappa: 0.4, ko_per_s: ko, kvi_per_s: 20.0, kd_s: 2e-3, ..Controller::default() };
        let axis = Platform::new(Plant::platform_30kg(), gains, 50.0, 1e-3, 5e-3).unwrap();
        let raw = LinearLoop::new(&axis, &Discrete::None).spectral_radius();
        assert!((raw - 1.0149).abs() < 2e-4, "{raw}");
        assert!(LinearLoop::new(&axis, &Discrete::pt1(50.0, 5.3).unwrap()).spectral_radius() < 1.0 + 1e-9);
    }
}

#[test]
fn the_exact_covariance_meets_the_monte_carlo() {
    let axis = Platform::new(Plant::platform_30kg().linear(), Controller::default(), 50.0, 1e-3, 5e-3).unwrap();
    let sigma = 0.1074_f64.to_radians();
    let (theta, u) = LinearLoop::new(&axis, &Discrete::None).deviations_after(sigma, 399);
    let (mut theta2, mut u2, runs) = (0.0, 0.0, 200);
    for seed in 0..runs {
        let gyro = GyroErrors { white_sigma_rad_s: sigma, seed, ..GyroErrors::default() };
        let record = axis.run(&mut Unfiltered, &Base::Constant { angle_rad: 0.0 }, &gyro, 0.0, 8.0).unwrap();
        theta2 += record.rows[399][0].powi(2) / runs as f64;
        u2 += record.rows[399][1].powi(2) / runs as f64;
    }
    // Four standard errors of a deviation from 200 runs.
    let allowed = 4.0 / (2.0 * runs as f64).sqrt();
    assert!((theta2.sqrt() / theta - 1.0).abs() < allowed, "{} {theta}", theta2.sqrt());
    assert!((u2.sqrt() / u - 1.0).abs() < allowed, "{} {u}", u2.sqrt());
}

#[test]
fn bad_parameters_are_refused_by_name() {
    let says = |result: Result<Platform, stillrate::ConfigError>, what: &str| {
        let text = result.unwrap_err().to_string();
        assert!(text.contains(what), "{text}");
    };
    let build = |plant, gains, rate, dt, delay| Platform::new(plant, gains, rate, dt, delay);
    let plant = Plant::platform_30kg();
    let gains = Controller::default();
    for name in [
        "inertia_kg_m2",
        "coupling_stiffness_n_m",
        "resistance_ohm",
        "motor_constant_v_s",
        "current_time_s",
        "voltage_max_v",
        "current_max_a",
        "gear_ratio",
        "drive_inertia_kg_m2",
    ] {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let mut broken = plant;
            *broken.number_mut(name).unwrap() = bad;
            says(build(broken, gains, 50.0, 1e-3, 5e-3), name);
        }
    }
    says(build(Plant { stiction_n_m: 1.0, ..plant }, gains, 50.0, 1e-3, 5e-3), "stiction_n_m = 1");
    says(build(Plant { half_backlash_rad: -1.0, ..plant }, gains, 50.0, 1e-3, 5e-3), "half_backlash_rad = -1");
    says(build(plant, gains, 50.0, 4e-3, 8e-3), "dt_s = 0.004");
    says(build(Plant { coulomb_n_m: 0.01, ..plant }, gains, 50.0, 1e-3, 5e-3), "dt_s");
    says(build(plant, gains, 60.0, 1e-3, 5e-3), "dt_s");
    says(build(plant, gains, 50.0, 1e-3, 5.5e-3), "delay_s");
    says(build(plant, gains, 50.0, 1e-3, -1e-3), "delay_s");
    says(build(plant, gains, 50.0, 1e-3, 5.0), "delay_s");
    says(build(plant, Controller { kappa: f64::NAN, ..gains }, 50.0, 1e-3, 5e-3), "kappa");
    assert!(build(plant, gains, 50.0, 2e-3, 4e-3).is_ok());
    assert!(Recorded::new(&[1.0], 50.0, 0.3).is_err());
    for steps in [0, 1_000_000] {
        let error = open_loop(&plant, &ten_degrees(), &[1.0], [0.0; 7], 1e-3, steps).unwrap_err();
        assert!(error.to_string().contains("steps"), "{error}");
    }
}

#[test]
fn an_unstable_loop_ends_at_its_tick_and_nothing_panics() {
    let mut plant = Plant::platform_30kg().linear();
    plant.voltage_max_v = 1e9;
    plant.current_max_a = 1e9;
    let gains = Controller { kappa: 50.0, ..Controller::default() };
    let axis = Platform::new(plant, gains, 50.0, 1e-3, 5e-3).unwrap();
    let record = axis.run(&mut Unfiltered, &ten_degrees(), &GyroErrors::default(), 0.0, 8.0).unwrap();
    let lost = record.lost_at.unwrap();
    assert_eq!(record.rows.len(), lost + 1);
    assert!(measure::residual(&record, 3.0, 0.02).max_deg.is_infinite());
}

#[test]
fn a_recorded_motion_is_its_own_integral() {
    let rate: Vec<f64> = (0..500).map(|k| 0.3 * (TAU * f64::from(k) / 50.0).sine_cosine().0).collect();
    let base = Base::Recorded(Recorded::new(&rate, 50.0, 0.35).unwrap());
    let axis = default_axis();
    let record = axis.run(&mut Unfiltered, &base, &GyroErrors::default(), 0.0, 9.0).unwrap();
    let phi: Vec<f64> = record.rows.iter().map(|row| row[6]).collect();
    let reach = phi.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    assert!((reach - 0.3 / TAU).abs() < 1e-3, "{reach}");
    assert!(measure::residual(&record, 3.0, 0.02).rms_deg > 0.1);
}

#[test]
fn the_same_seed_gives_the_same_bits() {
    let gyro = GyroErrors { white_sigma_rad_s: 2e-3, seed: 4, ..GyroErrors::default() };
    let run = || default_axis().run(&mut Discrete::pt1(50.0, 5.3).unwrap(), &ten_degrees(), &gyro, 0.0, 4.0).unwrap();
    assert_eq!(run(), run());
}
