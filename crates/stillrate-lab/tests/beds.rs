//! The beds have the size, spectrum, levels and ranges that their description promises.

use stillrate_lab::simulate::{BedKind, BedSettings};

fn rms(x: &[f64]) -> f64 {
    (x.iter().map(|v| v * v).sum::<f64>() / x.len() as f64).sqrt()
}

#[test]
fn raw_errors_are_those_of_the_white_noise() {
    for kind in [BedKind::Static, BedKind::Waves, BedKind::RoughWaves, BedKind::Steps, BedKind::Chirp] {
        let bed = BedSettings::new(kind, 50.0, 5).simulate().unwrap();
        let error: Vec<f64> = bed.measured_dps.iter().zip(&bed.truth_dps).map(|(z, s)| z - s).collect();
        // Four standard errors of an RMS over n normals.
        let tolerance = 4.0 / (2.0 * error.len() as f64).sqrt();
        assert!((rms(&error) / 0.1068 - 1.0).abs() < tolerance, "{kind:?} {}", rms(&error));
    }
}

#[test]
fn waves_reach_their_usual_size_over_many_seeds() {
    let mean_square = |kind| {
        let of = |seed| {
            let bed = BedSettings::new(kind, 50.0, seed).simulate().unwrap();
            let size = rms(&bed.motion_dps[bed.scored]);
            size * size
        };
        ((0..24).map(of).sum::<f64>() / 24.0).sqrt()
    };
    // E g^2 over 4..124.2 s is 20.3^2; a run holds some 60 independent amplitudes.
    for kind in [BedKind::Waves, BedKind::RoughWaves] {
        let size = mean_square(kind);
        assert!((18.5..22.0).contains(&size), "{kind:?} {size}");
    }
}

#[test]
fn the_calm_is_calm_and_ranges_follow_the_sample_rate() {
    for rate in [50.0, 1000.0] {
        let bed = BedSettings::new(BedKind::Waves, rate, 2).simulate().unwrap();
        assert_eq!(bed.scored, (4.0 * rate) as usize..(124.2 * rate).round() as usize);
        let calm = bed.calm.clone().unwrap();
        assert_eq!(calm, (129.2 * rate).round() as usize..(180.0 * rate) as usize);
        assert_eq!(bed.calm_after(12.0).start, (136.2 * rate).round() as usize);
        assert!(rms(&bed.motion_dps[calm.start + (7.0 * rate) as usize..]) < 0.5);
    }
}

#[test]
fn the_wave_is_one_and_the_same_at_every_rate() {
    let at = |rate| BedSettings::new(BedKind::Waves, rate, 3).simulate().unwrap().motion_dps;
    let (slow, fast) = (at(50.0), at(200.0));
    for (k, value) in slow.iter().enumerate() {
        assert!((value - fast[4 * k]).abs() < 1e-9);
    }
}

#[test]
fn waves_have_their_power_at_two_hertz() {
    for kind in [BedKind::Waves, BedKind::RoughWaves] {
        let bed = BedSettings::new(kind, 50.0, 1).simulate().unwrap();
        let x = &bed.motion_dps[1000..6000];
        let power = |f: f64| {
            let (mut c, mut s) = (0.0, 0.0);
            for (k, v) in x.iter().enumerate() {
                let (sine, cosine) = (std::f64::consts::TAU * f * k as f64 / 50.0).sin_cos();
                c += v * cosine;
                s += v * sine;
            }
            c * c + s * s
        };
        let band = |low: usize, high: usize| (low..high).map(|k| power(k as f64 * 0.01)).sum::<f64>();
        // .8 Hz around 2 Hz against the octaves beside it: both processes are some .1 Hz wide.
        assert!(band(160, 240) > 10.0 * (band(80, 160) + band(240, 400)), "{kind:?}");
    }
}

#[test]
fn steps_and_slews_arrive_where_they_should() {
    let bed = BedSettings::new(BedKind::Steps, 100.0, 0).simulate().unwrap();
    let at = |t: f64| bed.motion_dps[(t * 100.0) as usize];
    for (t, level) in [(9.9, 0.0), (15.9, 5.0), (21.9, -10.0), (27.9, 30.0), (39.0, 0.0), (45.9, 1.0), (57.9, 0.3)] {
        assert!((at(t) - level).abs() < 1e-6, "{t} s");
    }
    for (t, rate) in [(71.0, 20.0), (75.0, 60.0), (83.0, 0.0), (97.0, 20.0), (115.0, 0.0)] {
        assert!((at(t) - rate).abs() < 1e-6, "{t} s");
    }
    // Two lags: the first sample of a step of 5 moves by 5 (1 - e)^2.
    let e = (-std::f64::consts::TAU * 0.15).exp();
    assert!((at(10.0) - 5.0 * (1.0 - e) * (1.0 - e)).abs() < 1e-9);
}

#[test]
fn the_chirp_sweeps_two_decades() {
    let bed = BedSettings::new(BedKind::Chirp, 1000.0, 0).simulate().unwrap();
    let crossings =
        |from: usize, to: usize| bed.motion_dps[from..to].windows(2).filter(|w| w[0] < 0.0 && w[1] >= 0.0).count();
    assert!((18..=19).contains(&crossings(58_000, 60_000))); // 8.58 to 10 Hz over 2 s: 18.6 turns
    // Total turns: (10 - .1) 60 / ln 100.
    let turns = 9.9 * 60.0 / 100.0_f64.ln();
    assert!((crossings(0, 60_000) as f64 - turns).abs() < 1.5);
}

#[test]
fn a_seed_gives_its_run_and_another_a_different_one() {
    let run = |seed| BedSettings::new(BedKind::RoughWaves, 50.0, seed).simulate().unwrap().measured_dps;
    assert_eq!(run(1), run(1));
    assert_ne!(run(1), run(2));
}

#[test]
fn settings_out_of_range_are_refused_by_name() {
    let bed = BedSettings { duration_s: -1.0, ..BedSettings::new(BedKind::Static, 50.0, 0) };
    assert_eq!(bed.simulate().unwrap_err().field, "duration_s");
}
