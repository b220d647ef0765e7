//! The Allan deviation recovers what a record was made of, says how sure it is, and survives odd records.

use stillrate_lab::allan::{AllanSettings, Figure, Taus, allan, allan_with};
use stillrate_lab::error::LogError;
use stillrate_lab::random::Random;
use stillrate_lab::simulate::GyroNoiseModel;

const RATE_HZ: f64 = 20.0;

/// White noise N, flicker B, rate random walk K.
fn record(n: usize, [density, floor, walk_rate]: [f64; 3], seed: u64) -> Vec<f64> {
    let model = GyroNoiseModel {
        density_dps_sqrt_hz: density,
        bias_instability_dps: floor,
        rate_random_walk_dps_sqrt_s: walk_rate,
        ..GyroNoiseModel::perfect()
    };
    model.record(&vec![0.0; n], RATE_HZ, seed).unwrap().measured_dps
}

fn holds(figure: Figure, truth: f64) -> bool {
    figure.lower <= truth && truth <= figure.upper
}

#[test]
fn recovers_white_noise_flicker_and_walk_from_one_record() {
    // Ten hours at 20 Hz with a flicker floor between seconds and minutes.
    let truth = [0.015, 0.01, 0.0012];
    let curve = allan(&record(720_000, truth, 5), RATE_HZ).unwrap();
    let near = |figure: Figure, truth: f64, tolerance: f64| {
        let off = 100.0 * (figure.value / truth - 1.0);
        println!("made with {truth}, found {:.5}: {off:+.1} % (asked for: {:.0} %)", figure.value, 100.0 * tolerance);
        assert!((figure.value / truth - 1.0).abs() < tolerance, "{figure:?} {truth}");
    };
    near(curve.angle_random_walk, truth[0], 0.05);
    near(curve.bias_instability, truth[1], 0.2);
    near(curve.rate_random_walk, truth[2], 0.2);
    assert!(curve.misfit < 0.1, "{}", curve.misfit);
}

#[test]
fn nine_intervals_in_ten_hold_the_truth() {
    let (runs, truth) = (1000, [0.015, 0.008, 0.003]);
    let curves: Vec<_> = (0..runs).map(|seed| allan(&record(16_384, truth, seed), RATE_HZ).unwrap()).collect();
    let part = |hit: usize, of: usize| hit as f64 / of as f64;
    let count = |pick: fn(&stillrate_lab::allan::Allan) -> Figure, t: f64| {
        part(curves.iter().filter(|c| holds(pick(c), t)).count(), runs as usize)
    };
    // 1000 runs: one standard error of a coverage of .9 is .0095.
    let covers = [
        ("N", count(|c| c.angle_random_walk, truth[0])),
        ("B", count(|c| c.bias_instability, truth[1])),
        ("K", count(|c| c.rate_random_walk, truth[2])),
    ];
    for (name, cover) in covers {
        println!("90 % intervals of {name} hold the truth in {:.1} % of {runs} runs", 100.0 * cover);
        assert!((0.85..=0.95).contains(&cover), "{name} {cover}");
    }
    // The curve itself, against its mean over the runs.
    let points = curves[0].tau_s.len();
    let mut inside = 0;
    for i in 0..points {
        let mean = curves.iter().map(|c| c.deviation[i] * c.deviation[i]).sum::<f64>() / runs as f64;
        inside += curves.iter().filter(|c| c.lower[i] <= mean.sqrt() && mean.sqrt() <= c.upper[i]).count();
    }
    let cover = part(inside, points * runs as usize);
    println!("90 % intervals of the curve hold its mean in {:.1} % of {points} points of {runs} runs", 100.0 * cover);
    assert!((0.85..=0.95).contains(&cover), "curve {cover}");
}

#[test]
fn intervals_hold_in_a_long_record_whose_flicker_ends_unseen_beneath_white_noise() {
    // The simulated flicker ends at two samples. A fit that takes it to go on is off by more than its intervals.
    let (runs, truth) = (40, [0.015, 0.02, 0.003]);
    let curves: Vec<_> = (0..runs).map(|seed| allan(&record(100_000, truth, seed), RATE_HZ).unwrap()).collect();
    let picks: [fn(&stillrate_lab::allan::Allan) -> Figure; 3] =
        [|c| c.angle_random_walk, |c| c.bias_instability, |c| c.rate_random_walk];
    for (pick, t) in picks.into_iter().zip(truth) {
        let held = curves.iter().filter(|c| holds(pick(c), t)).count();
        // Of 40 with a chance of .9 each, 31 or fewer have one of 1 %.
        assert!(held >= 32, "{t}: {held} of {runs}");
        let mean = curves.iter().map(|c| pick(c).value).sum::<f64>() / f64::from(runs as u32);
        assert!((mean / t - 1.0).abs() < 0.05, "{t}: {mean}");
    }
}

#[test]
fn white_noise_alone_shows_neither_floor_nor_walk() {
    let mut clear = 0;
    for seed in 0..10 {
        let curve = allan(&record(20_000, [0.3, 0.0, 0.0], seed), RATE_HZ).unwrap();
        assert!((curve.angle_random_walk.value / 0.3 - 1.0).abs() < 0.03);
        // At the longest times white noise itself is 0.3 / sqrt(500 s) = .013, uncertain by its own size.
        assert!(curve.bias_instability.value < 0.06 && curve.rate_random_walk.value < 0.01);
        clear += usize::from(curve.bias_instability.lower > 0.0) + usize::from(curve.rate_random_walk.lower > 0.0);
    }
    // One-sided 5 % each: 1 expected of 20.
    assert!(clear <= 4, "{clear}");
}

#[test]
fn gaps_change_the_figures_little() {
    let truth = [0.015, 0.0, 0.004];
    let mut z = record(100_000, truth, 3);
    let whole = allan(&z, RATE_HZ).unwrap();
    let mut pick = Random::new(9, 0);
    for x in &mut z {
        *x = if pick.normal() > 1.3 { f64::NAN } else { *x };
    }
    z[40_000..48_000].fill(f64::NAN);
    let holed = allan(&z, RATE_HZ).unwrap();
    assert!((holed.angle_random_walk.value / whole.angle_random_walk.value - 1.0).abs() < 0.02);
    assert!((holed.rate_random_walk.value / whole.rate_random_walk.value - 1.0).abs() < 0.15);
}

#[test]
fn dense_times_pass_through_the_octaves() {
    let z = record(5000, [0.1, 0.0, 0.01], 1);
    let octave = allan(&z, RATE_HZ).unwrap();
    let all = allan_with(&z, RATE_HZ, AllanSettings { taus: Taus::All, ..AllanSettings::default() }).unwrap();
    assert_eq!(all.tau_s.len(), 2500);
    for (tau, deviation) in octave.tau_s.iter().zip(&octave.deviation) {
        let k = (tau * RATE_HZ).round() as usize - 1;
        assert_eq!(all.deviation[k], *deviation);
    }
    let dense = allan_with(&z, RATE_HZ, AllanSettings { taus: Taus::PerDecade(20), confidence: 0.5 }).unwrap();
    assert!(dense.tau_s.windows(2).all(|w| w[1] > w[0]) && dense.tau_s.len() > 40);
    assert_eq!(dense.angle_random_walk.value, octave.angle_random_walk.value);
    assert!(dense.angle_random_walk.lower > octave.angle_random_walk.lower);
}

#[test]
fn odd_records_give_an_error_or_finite_figures() {
    assert_eq!(allan(&[], 50.0).unwrap_err(), LogError::TooShort { finite: 0, needed: 8 });
    assert!(matches!(allan(&[1.0; 7], 50.0), Err(LogError::TooShort { finite: 7, .. })));
    assert!(matches!(allan(&[1.0; 70], f64::NAN), Err(LogError::Setting(_))));
    assert!(allan(&[f64::NAN; 100], 50.0).is_err());
    let mut sparse = vec![f64::NAN; 1000];
    sparse.iter_mut().step_by(100).for_each(|x| *x = 1.0);
    let records: [Vec<f64>; 4] =
        [vec![7.0; 100], (0..8).map(f64::from).collect(), (0..1000).map(|k| f64::from(k * k)).collect(), sparse];
    for z in records {
        if let Ok(curve) = allan(&z, 50.0) {
            let figures = [curve.angle_random_walk, curve.bias_instability, curve.rate_random_walk];
            assert!(figures.iter().all(|f| f.value.is_finite() && f.lower <= f.value && f.value <= f.upper));
            assert!(curve.deviation.iter().chain(&curve.lower).chain(&curve.upper).all(|x| x.is_finite()));
        }
    }
}
