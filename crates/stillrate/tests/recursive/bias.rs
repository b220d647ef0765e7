//! Gyro bias from a reference attitude: exactness, consistency, what cannot be seen, what is refused.

use nalgebra::{Matrix3, Vector3};
use stillrate::attitude::reference_bias::{BiasEstimate, BiasSettings, Fix, Record, Steps, Unknowns, solve};
use stillrate::attitude::{Body, Inertial, Navigation, Rotation, earth, shortcuts, so3};
use stillrate::{ConfigError, Real};

use crate::Noise;

const DEG_H: f64 = core::f64::consts::PI / 180.0 / 3600.0;
const BIAS: [f64; 3] = [140.0, 150.0, 160.0];

#[derive(Clone, Copy, Debug, PartialEq)]
enum Motion {
    Static,
    Slow,
    HandHeld,
    Constant,
    OverThePole,
}

/// Roll, pitch, yaw, latitude and longitude at a time.
fn pose(motion: Motion, t: f64) -> [f64; 5] {
    let s = |frequency: f64, phase: f64| (core::f64::consts::TAU * frequency * t + phase).sine_cosine().0;
    match motion {
        Motion::Static => [0.1, -0.2, 0.7, 0.9, 0.1],
        Motion::Slow => [0.05 * s(0.05, 0.0), 0.04 * s(0.04, 1.0), 0.02 * t, 0.9 + 1e-6 * t, 0.1 + 2e-6 * t],
        Motion::HandHeld => [0.4 * s(0.5, 0.2), 0.3 * s(0.7, 1.0), 0.6 * s(0.3, 0.0), 0.9, 0.1],
        Motion::Constant => [0.0, 0.0, 0.0, 0.9, 0.1],
        // Along a meridian over the north pole within the record: latitude comes back down on the other side.
        Motion::OverThePole => {
            let past = 3e-6 * (t - 5.0);
            let pole = core::f64::consts::FRAC_PI_2;
            if past < 0.0 {
                [0.2 * s(0.5, 0.0), 0.1, 0.0, pole + past, 0.4]
            } else {
                let pi = core::f64::consts::PI;
                [0.2 * s(0.5, 0.0), 0.1, pi, pole - past, 0.4 + pi]
            }
        }
    }
}

fn attitude(motion: Motion, t: f64) -> Rotation<f64, Body, Inertial> {
    let [roll, pitch, yaw, latitude, longitude] = pose(motion, t);
    let level: Rotation<f64, Body, Navigation> = Rotation::from_euler(roll, pitch, yaw);
    let start = earth::inertial_attitude(latitude, longitude, level, t);
    if motion == Motion::Constant {
        let turned = Rotation::<f64, Body, Body>::exp(&(Vector3::new(0.3, 0.2, 0.4) * t));
        return earth::inertial_attitude(latitude, longitude, level, 0.0) * turned;
    }
    start
}

struct Case {
    rates: Vec<[f64; 3]>,
    fixes: Vec<Fix<f64>>,
    dt: f64,
}

/// Exact mean rates in sensor axes, bias added; fixes of the reference body.
fn case(motion: Motion, time: f64, dt: f64, fixes: usize, mounting: &Matrix3<f64>) -> Case {
    let samples = (time / dt).round() as usize;
    let at = |k: usize| attitude(motion, k as f64 * dt);
    let rates = (0..samples)
        .map(|k| {
            let body = so3::log(&(at(k).matrix().transpose() * at(k + 1).matrix())) / dt;
            (mounting * body + Vector3::from(BIAS) * DEG_H).into()
        })
        .collect();
    let fixes = (0..fixes)
        .map(|i| {
            let index = i * samples / (fixes - 1);
            Fix { index, attitude: at(index) }
        })
        .collect();
    Case { rates, fixes, dt }
}

impl Case {
    fn solve(&self, settings: &BiasSettings) -> Result<BiasEstimate<f64>, ConfigError> {
        let record = Record { rates: &self.rates, steps: Steps::Uniform(self.dt) };
        solve(record, &self.fixes, settings, Unknowns::default(), |_| ())
    }

    fn add_noise(&mut self, walk: f64, sigma: f64, noise: &mut Noise) {
        for rate in &mut self.rates {
            for x in rate.iter_mut() {
                *x += noise.normal() * walk / self.dt.root();
            }
        }
        for fix in &mut self.fixes {
            let error = Vector3::new(noise.normal(), noise.normal(), noise.normal()) * sigma;
            fix.attitude = fix.attitude * Rotation::<f64, Body, Body>::exp(&error);
        }
    }
}

fn worst_error_deg_h(estimate: &BiasEstimate<f64>) -> f64 {
    (estimate.unknowns.bias / DEG_H - Vector3::from(BIAS)).amax()
}

#[test]
fn is_exact_in_every_motion_without_noise() {
    let motions = [Motion::Static, Motion::Slow, Motion::HandHeld, Motion::Constant, Motion::OverThePole];
    for motion in motions {
        for fixes in [2, 11] {
            let found = case(motion, 10.0, 0.005, fixes, &Matrix3::identity()).solve(&BiasSettings::default()).unwrap();
            let error = worst_error_deg_h(&found);
            println!("{motion:?} {fixes} fixes: {error:.1e} deg/h in {} iterations", found.iterations);
            assert!(error < 1e-9, "{motion:?}: {error}");
            assert!(found.converged && found.observable() && found.iterations <= 6);
        }
    }
}

#[test]
fn shortcuts_cost_what_they_are_known_to_cost() {
    let hand_held = case(Motion::HandHeld, 10.0, 0.005, 2, &Matrix3::identity());
    let samples = || hand_held.rates.iter().map(|&rate| (rate, hand_held.dt));
    let turn = shortcuts::integrate(samples());
    let reference = hand_held.fixes[0].attitude.matrix().transpose() * hand_held.fixes[1].attitude.matrix();
    let error = |bias: Vector3<f64>| (bias / DEG_H - Vector3::from(BIAS)).amax();
    let small = error(shortcuts::small_angle(&turn, &reference));
    let with_jacobian = error(shortcuts::small_angle_with_jacobian(&turn, &reference));
    let mean = error(shortcuts::mean_rate(samples(), &reference));
    println!("small angle {small:.3}, with Jacobian {with_jacobian:.4}, mean rate {mean:.2} deg/h");
    assert!(small > 1.0 && with_jacobian < 0.2 && with_jacobian > 1e-3 && mean > 0.1);
}

#[test]
fn mounting_is_found_in_hand_held_motion() {
    let mounting = so3::exp(&Vector3::new(0.01, -0.015, 0.008));
    let settings = BiasSettings { estimate_mounting: true, ..BiasSettings::default() };
    let found = case(Motion::HandHeld, 10.0, 0.005, 20, &mounting).solve(&settings).unwrap();
    assert!(found.observable() && found.converged);
    assert!(worst_error_deg_h(&found) < 1e-9, "{}", worst_error_deg_h(&found));
    assert!(so3::log(&(found.unknowns.mounting * mounting.transpose())).amax() < 1e-13);
}

#[test]
fn mounting_and_bias_are_not_separated_by_a_constant_rate_or_at_rest() {
    let settings =
        BiasSettings { estimate_mounting: true, reference_sigma_rad: 0.02_f64.to_radians(), ..BiasSettings::default() };
    for motion in [Motion::Constant, Motion::Static] {
        let found = case(motion, 10.0, 0.005, 20, &Matrix3::identity()).solve(&settings).unwrap();
        assert!(!found.observable(), "{motion:?}");
        assert_eq!((found.rank, found.dimension), (3, 6), "{motion:?}: {:?}", found.singular_values);
        println!("{motion:?}: {:.3?} {:.3?}", found.singular_values, found.posterior_over_prior);
        // What is not seen keeps its prior.
        assert!(found.posterior_over_prior.iter().filter(|&&ratio| ratio > 0.7).count() >= 2);
    }
}

#[test]
fn lag_and_scale_factors_are_found() {
    let mut shifted = case(Motion::HandHeld, 20.0, 0.005, 41, &Matrix3::identity());
    // The gyro record is late by 7 ms: 1.4 samples, rebuilt from the motion.
    let at = |t: f64| *attitude(Motion::HandHeld, t).matrix();
    let scale = Vector3::new(1.002, 0.997, 1.001);
    for (k, rate) in shifted.rates.iter_mut().enumerate() {
        let t = k as f64 * 0.005 - 0.007;
        let body = so3::log(&(at(t).transpose() * at(t + 0.005))) / 0.005;
        *rate = (body.component_mul(&scale) + Vector3::from(BIAS) * DEG_H).into();
    }
    let settings = BiasSettings { estimate_lag: true, estimate_scale: true, ..BiasSettings::default() };
    let found = shifted.solve(&settings).unwrap();
    assert!(found.converged && found.observable());
    // Rates that are constant within a sample leave microseconds: the fix falls inside a sample.
    assert!((found.unknowns.lag_s - 0.007).abs() < 1e-5, "{}", found.unknowns.lag_s);
    assert!((found.unknowns.scale.add_scalar(1.0) - scale).amax() < 1e-4);
    assert!(worst_error_deg_h(&found) < 0.5, "{}", worst_error_deg_h(&found));
}

/// NEES of the bias over its three axes, and error over the predicted standard deviation, both as means over runs.
fn consistency(runs: u64, settings: &BiasSettings, clean: &Case, unknowns: usize) -> (f64, f64) {
    let (mut nees, mut squares, mut predicted) = (0.0, 0.0, 0.0);
    for run in 0..runs {
        let mut noise = Noise(1000 + run);
        let mut noisy = Case { rates: clean.rates.clone(), fixes: clean.fixes.clone(), dt: clean.dt };
        noisy.add_noise(settings.angle_random_walk_rad_sqrt_s, settings.reference_sigma_rad, &mut noise);
        let found = noisy.solve(settings).unwrap();
        assert!(found.converged && found.observable());
        let error = found.unknowns.bias - Vector3::from(BIAS) * DEG_H;
        let covariance = Matrix3::from_fn(|i, j| found.covariance[i][j]);
        nees += error.dot(&(covariance.try_inverse().unwrap() * error)) / 3.0;
        squares += error.norm_squared();
        predicted += covariance.trace();
        assert_eq!(found.dimension, unknowns);
    }
    (nees / runs as f64, (squares / predicted).root())
}

#[test]
fn covariance_is_honest_over_five_hundred_runs() {
    let plain = BiasSettings { angle_random_walk_rad_sqrt_s: 0.3_f64.to_radians() / 60.0, ..BiasSettings::default() };
    let noisy_fixes = BiasSettings { reference_sigma_rad: 0.02_f64.to_radians(), ..plain };
    let mounted = BiasSettings { estimate_mounting: true, ..noisy_fixes };
    let hand_held = |fixes| case(Motion::HandHeld, 10.0, 0.02, fixes, &Matrix3::identity());
    for (name, settings, fixes, unknowns) in [
        ("two fixes", plain, 2, 3),
        ("25 noisy fixes", noisy_fixes, 25, 3),
        ("20 noisy fixes with mounting", mounted, 20, 6),
    ] {
        let (nees, ratio) = consistency(500, &settings, &hand_held(fixes), unknowns);
        println!("{name}: NEES/3 {nees:.3}, error over bound {ratio:.3}");
        assert!((0.8..=1.2).contains(&nees), "{name}: {nees}");
        assert!(ratio <= 1.1, "{name}: {ratio}");
    }
}

#[test]
fn what_makes_no_sense_is_refused() {
    let good = || case(Motion::Slow, 1.0, 0.01, 3, &Matrix3::identity());
    let settings = BiasSettings::default();
    let field = |case: &Case| case.solve(&settings).unwrap_err().field;
    let mut one = good();
    one.fixes.truncate(1);
    assert_eq!(field(&one), "fixes");
    let mut backwards = good();
    backwards.fixes[1].index = 0;
    assert_eq!(field(&backwards), "fix_index");
    let mut outside = good();
    outside.fixes[2].index = 101;
    assert_eq!(field(&outside), "fix_index");
    let mut missing = good();
    missing.rates[5][1] = f64::NAN;
    assert_eq!(field(&missing), "rate_rad_s");
    assert_eq!(field(&Case { dt: 0.0, ..good() }), "dt_s");
    let two = [0.01, 0.01];
    let short = Record { rates: &good().rates, steps: Steps::Each(&two) };
    assert!(solve(short, &good().fixes, &settings, Unknowns::default(), |_| ()).is_err());
    let wrong = |settings: BiasSettings| settings.check().unwrap_err().field;
    assert_eq!(wrong(BiasSettings { reference_sigma_rad: f64::NAN, ..settings }), "reference_sigma_rad");
    assert_eq!(wrong(BiasSettings { reference_sigma_rad: 2.0, ..settings }), "reference_sigma_rad");
    assert_eq!(wrong(BiasSettings { angle_random_walk_rad_sqrt_s: 2.0, ..settings }), "angle_random_walk_rad_sqrt_s");
}

#[test]
fn a_bias_beyond_pi_is_not_called_converged() {
    let rates = vec![[0.0, 0.0, 3.3_f64]; 100];
    let record = Record { rates: &rates, steps: Steps::Uniform(0.01) };
    let still = Rotation::identity();
    let fixes = [Fix { index: 0, attitude: still }, Fix { index: 100, attitude: still }];
    let settings = BiasSettings { prior_bias_rad_s: 5.0, ..BiasSettings::default() };
    let found = solve(record, &fixes, &settings, Unknowns::default(), |_| ()).unwrap();
    // 3.3 - 2 pi = -2.98 rad/s explains the fixes as well: close to the limit nothing can be told apart.
    assert!(!found.converged, "{:?}", found.unknowns.bias);
}

#[test]
fn irregular_steps_are_exact_and_single_precision_works() {
    let still = Rotation::<f32, Body, Inertial>::identity();
    let steps: Vec<f32> = (0..200).map(|k| if k % 3 == 0 { 0.007 } else { 0.004 }).collect();
    let rates = vec![[1e-3_f32, -2e-3, 5e-4]; 200];
    let fixes = [Fix { index: 0, attitude: still }, Fix { index: 200, attitude: still }];
    let record = Record { rates: &rates, steps: Steps::Each(&steps) };
    let found = solve(record, &fixes, &BiasSettings::default(), Unknowns::default(), |_| ()).unwrap();
    assert!((found.unknowns.bias - Vector3::new(1e-3, -2e-3, 5e-4)).amax() < 1e-8);
}
