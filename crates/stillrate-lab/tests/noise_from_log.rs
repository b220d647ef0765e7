//! Noise figures come out of any log, right where they can be known and honest where they cannot.

use stillrate_lab::error::LogError;
use stillrate_lab::simulate::{BedKind, BedSettings, GyroNoiseModel};
use stillrate_lab::tune::{NoiseReason, noise_from_log};

const DENSITY: f64 = 0.015_103_8;

fn measured(kind: BedKind, rate: f64, seed: u64) -> Vec<f64> {
    BedSettings::new(kind, rate, seed).simulate().unwrap().measured_dps
}

#[test]
fn white_noise_is_found_under_any_motion_of_the_beds() {
    for kind in [BedKind::Static, BedKind::Waves, BedKind::RoughWaves, BedKind::Steps, BedKind::Chirp] {
        for rate in [50.0, 200.0, 1000.0] {
            let noise = noise_from_log(&measured(kind, rate, 3), rate).unwrap();
            let ratio = noise.density_dps_sqrt_hz / DENSITY;
            // Short stretches at 50 Hz leave some 10 %; a chirp never rests, and too much is better than too little.
            let most = if kind == BedKind::Chirp { 1.35 } else { 1.2 };
            assert!((0.85..most).contains(&ratio), "{kind:?} {rate} Hz: {ratio}");
        }
    }
}

#[test]
fn figures_at_rest_match_what_was_simulated() {
    let model = GyroNoiseModel { bias_sigma_dps: 0.0, rate_random_walk_dps_sqrt_s: 0.005, ..GyroNoiseModel::bench() };
    let mut sum = 0.0;
    for seed in 0..20 {
        let z = model.record(&vec![0.0; 30_000], 50.0, seed).unwrap().measured_dps;
        let noise = noise_from_log(&z, 50.0).unwrap();
        assert_eq!(noise.reason, NoiseReason::AtRest);
        assert!((noise.density_dps_sqrt_hz / DENSITY - 1.0).abs() < 0.05, "{noise:?}");
        sum += noise.rate_random_walk_dps_sqrt_s.powi(2);
    }
    // 600 s hold some 20 independent clusters of 30 s; over 20 runs about 5 %.
    assert!(((sum / 20.0).sqrt() / 0.005 - 1.0).abs() < 0.15, "{}", (sum / 20.0).sqrt());
}

#[test]
fn a_coarse_converter_sets_the_floor() {
    let model = GyroNoiseModel { lsb_dps: 1.0, ..GyroNoiseModel::bench() };
    for rate in [50.0, 500.0] {
        let z =
            BedSettings { noise: model, ..BedSettings::new(BedKind::Waves, rate, 1) }.simulate().unwrap().measured_dps;
        let noise = noise_from_log(&z, rate).unwrap();
        assert_eq!(noise.lsb_dps, 1.0);
        assert!(noise.density_dps_sqrt_hz >= 1.0 / (12.0 * rate).sqrt());
        assert!(noise.density_dps_sqrt_hz < 0.1, "{noise:?}");
    }
}

#[test]
fn a_fine_converter_adds_its_own_noise_and_no_more() {
    // Half a step of white noise: total variance LSB^2 (1/4 + 1/12).
    let model = GyroNoiseModel { density_dps_sqrt_hz: 0.05, lsb_dps: 1.0, ..GyroNoiseModel::perfect() };
    let z = model.record(&vec![0.3; 20_000], 100.0, 1).unwrap().measured_dps;
    let noise = noise_from_log(&z, 100.0).unwrap();
    assert!((noise.density_dps_sqrt_hz / (0.1 * (1.0_f64 / 3.0).sqrt()) - 1.0).abs() < 0.05, "{noise:?}");
}

#[test]
fn a_log_that_never_rests_says_so() {
    // Tremor: 6 to 11 Hz, ten times the noise.
    let motion: Vec<f64> =
        (0..6000).map(|k| 0.01 * f64::from(k)).map(|t| 0.8 * (40.0 * t).sin() + 0.7 * (67.0 * t + 1.0).sin()).collect();
    let z = GyroNoiseModel::bench().record(&motion, 100.0, 5).unwrap().measured_dps;
    let noise = noise_from_log(&z, 100.0).unwrap();
    assert!(noise.motion_dominated && noise.moving_fraction > 0.9);
    assert_eq!(noise.reason, NoiseReason::NeverAtRest);
    assert!(noise.reason.to_string().contains("motion dominates"));
    assert!((0.5..20.0).contains(&(noise.density_dps_sqrt_hz / DENSITY)), "{noise:?}");
}

#[test]
fn gaps_and_wild_values_do_not_reach_the_figures() {
    let mut z = measured(BedKind::Static, 50.0, 2);
    let whole = noise_from_log(&z, 50.0).unwrap();
    z.iter_mut().step_by(7).for_each(|x| *x = f64::NAN);
    z.iter_mut().skip(3).step_by(501).for_each(|x| *x = f64::INFINITY);
    z[1200] = 1e300;
    z[77] = 1e6;
    let holed = noise_from_log(&z, 50.0).unwrap();
    assert!((holed.density_dps_sqrt_hz / whole.density_dps_sqrt_hz - 1.0).abs() < 0.15, "{holed:?}");
}

#[test]
fn any_log_gives_an_error_or_finite_positive_figures() {
    assert_eq!(noise_from_log(&[], 50.0).unwrap_err(), LogError::TooShort { finite: 0, needed: 8 });
    assert!(matches!(noise_from_log(&[1.0; 20], 0.0), Err(LogError::Setting(_))));
    let ramp: Vec<f64> = (0..200).map(f64::from).collect();
    let alternating: Vec<f64> = (0..9).map(|k| f64::from(k % 2)).collect();
    let huge: Vec<f64> = (0..50).map(|k| if k % 3 == 0 { 1e140 } else { -1e140 }).collect();
    let logs = [vec![0.0; 8], vec![-3.5; 5000], ramp, alternating, huge, vec![1e-300; 20], {
        let mut z = vec![1.0; 100];
        z[50] = 2.0;
        z
    }];
    for z in logs {
        for rate in [1e-3, 50.0, 1e6] {
            let noise = noise_from_log(&z, rate).unwrap();
            let figures = [noise.density_dps_sqrt_hz, noise.rate_random_walk_dps_sqrt_s];
            assert!(figures.iter().all(|x| x.is_finite() && *x > 0.0), "{noise:?}");
            assert!(noise.quiet.end <= z.len() && noise.lsb_dps.is_finite());
        }
    }
}

/// A log of 0.3 deg/s, white noise and motion up to 60 deg/s over a part of it; at rest from `still`.0 for `still`.1 s.
fn partly_moving(kind: &str, rate: f64, length_s: f64, still: (f64, f64), lsb: f64) -> Vec<f64> {
    let moving_s = length_s - still.1;
    let motion: Vec<f64> = (0..(length_s * rate) as usize)
        .map(|k| k as f64 / rate)
        .map(|t| {
            if (still.0..still.0 + still.1).contains(&t) {
                return 0.3;
            }
            // The motion before the rest, then that after it.
            let u = if t < still.0 { t } else { t - still.1 };
            let near = if t < still.0 { still.0 - t } else { t - still.0 - still.1 };
            0.3 + match kind {
                "waves" => 60.0 * (1.6 * u).sin(),
                "rough" => 20.0 * ((2.5 * u).sin() + (10.7 * u + 1.0).sin() + (27.0 * u + 2.0).sin()),
                "steps" => 60.0 * (2.1 * u).sin().signum(),
                // Rises so slowly out of the rest that single samples show it late.
                "swell" => 60.0 * (0.3 * near).sin() * (near / moving_s.min(30.0)).min(1.0).powi(3),
                _ => unreachable!(),
            }
        })
        .collect();
    let model = GyroNoiseModel { density_dps_sqrt_hz: 0.0158, lsb_dps: lsb, ..GyroNoiseModel::perfect() };
    model.record(&motion, rate, 4).unwrap().measured_dps
}

#[test]
fn motion_in_a_part_of_the_log_does_not_reach_the_figures() {
    for rate in [50.0, 200.0, 1000.0, 8000.0] {
        for kind in ["waves", "rough", "steps", "swell"] {
            // Off the whole seconds of any window: first, in the middle, last; 10, 50 and 90 % of the log.
            let length = 63.37;
            for part in [0.1, 0.5, 0.9] {
                let still = part * length;
                for start in [0.0, 0.41 * (length - still), length - still] {
                    let lsb = if part == 0.5 { 0.061 } else { 0.0 };
                    let noise = noise_from_log(&partly_moving(kind, rate, length, (start, still), lsb), rate).unwrap();
                    let ratio = noise.density_dps_sqrt_hz / 0.0158_f64.hypot(lsb / (12.0 * rate).sqrt());
                    let case = format!("{kind}, {rate} Hz, {still:.0} s from {start:.0} s: {ratio:.3} {noise:?}");
                    assert!((0.85..1.15).contains(&ratio), "{case}");
                    assert_eq!(noise.reason, NoiseReason::AtRest, "{case}");
                    assert_eq!(noise.motion_dominated, part < 0.45 || noise.moving_fraction > 0.5, "{case}");
                    assert!(noise.moving_fraction < 1.1 - part, "{case}");
                }
            }
        }
    }
}

#[test]
fn five_seconds_at_rest_are_found_in_ten_minutes_of_motion() {
    for rate in [200.0, 1000.0] {
        for kind in ["waves", "rough", "steps", "swell"] {
            let noise = noise_from_log(&partly_moving(kind, rate, 600.0, (201.3, 5.0), 0.0), rate).unwrap();
            let ratio = noise.density_dps_sqrt_hz / 0.0158;
            assert!((0.85..1.15).contains(&ratio), "{kind}, {rate} Hz: {ratio} {noise:?}");
        }
    }
}

#[test]
fn a_long_rest_with_a_slow_end_is_taken_without_that_end() {
    // A minute at 1 kHz: a piece that moves 0.4 deg/s, less than a sample scatters, made the Allan deviation at 1 s
    // three times the noise.
    let z = partly_moving("swell", 1000.0, 121.37, (0.0, 60.7), 0.0);
    let noise = noise_from_log(&z, 1000.0).unwrap();
    assert!((0.95..1.05).contains(&(noise.density_dps_sqrt_hz / 0.0158)), "{noise:?}");
    assert!(noise.quiet.end < 66_000 && noise.rate_random_walk_dps_sqrt_s < 0.01, "{noise:?}");
}
