//! Scores variations of the recommended bank's settings on all beds at once, on seeds that no published figure uses.
//!
//! `cargo run --release -p stillrate-lab --example bank_settings [first seed]`: static, waves, calm as ratios to the clairvoyant
//! bound on the same runs, rough waves, steps and chirp as ratios to raw.

use stillrate::filters::MsImmIkfSettings;
use stillrate::{Filter, GyroNoise, Sample, Settings};
use stillrate_lab::bounds::clairvoyant;
use stillrate_lab::metrics::rmse;
use stillrate_lab::simulate::{Bed, BedKind, BedSettings};

const KINDS: [(BedKind, u64); 5] =
    [(BedKind::Static, 12), (BedKind::Waves, 4), (BedKind::RoughWaves, 4), (BedKind::Steps, 2), (BedKind::Chirp, 2)];

struct Run {
    bed: Bed,
    bound: Option<Vec<f64>>,
}

fn runs(rate: f64, seed: u64) -> Vec<Run> {
    let mut runs = Vec::new();
    for (kind, count) in KINDS {
        for k in 0..count {
            let bed = BedSettings::new(kind, rate, seed + k).simulate().expect("a bed");
            let bound = clairvoyant(&bed).map(|found| found.rate_dps);
            runs.push(Run { bed, bound });
        }
    }
    runs
}

fn score(settings: &MsImmIkfSettings, runs: &[Run]) -> [f64; 6] {
    let filter = settings.build::<f64>().expect("settings in range");
    let mut sums = [[0.0_f64; 2]; 6];
    for run in runs {
        let bed = &run.bed;
        let mut state = filter.start();
        let dt = filter.period();
        let ours: Vec<f64> =
            bed.measured_dps.iter().map(|&value| filter.step(&mut state, Sample { value, dt }).rate).collect();
        let mut add = |index: usize, reference: &[f64], range: std::ops::Range<usize>| {
            sums[index][0] += rmse(&ours[range.clone()], &bed.truth_dps[range.clone()]).powi(2);
            sums[index][1] += rmse(&reference[range.clone()], &bed.truth_dps[range]).powi(2);
        };
        let from_4_s = bed.settings.sample_at(4.0)..ours.len();
        match (bed.settings.kind, &run.bound) {
            (BedKind::Static, Some(bound)) => add(0, bound, from_4_s),
            (BedKind::Waves, Some(bound)) => {
                add(1, bound, bed.scored.clone());
                add(2, bound, bed.calm_after(12.0));
            }
            (BedKind::RoughWaves, _) => add(3, &bed.measured_dps, bed.scored.clone()),
            (BedKind::Steps, _) => add(4, &bed.measured_dps, bed.scored.clone()),
            _ => add(5, &bed.measured_dps, bed.scored.clone()),
        }
    }
    sums.map(|[ours, reference]| (ours / reference).sqrt())
}

/// One departure from the default.
type Change = fn(&mut MsImmIkfSettings);

fn main() {
    let seed = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(300);
    let noise = GyroNoise::from_standard_deviation_at_rate(0.1068, 50.0).with_rate_random_walk(0.003_316_62);
    let changes: [(&str, Change); 17] = [
        ("default", |_| {}),
        ("rest dwell 300 s", |s| s.rest_dwell_time_s = 300.0),
        ("rest dwell 1000 s", |s| s.rest_dwell_time_s = 1000.0),
        ("dwell 40 s", |s| s.dwell_time_s = 40.0),
        ("dwell 60 s, rest 300 s", |s| (s.dwell_time_s, s.rest_dwell_time_s) = (60.0, 300.0)),
        ("dwell 10 s", |s| s.dwell_time_s = 10.0),
        ("frequency memory 10 s", |s| s.frequency_memory_s = 10.0),
        ("frequency memory 20 s", |s| s.frequency_memory_s = 20.0),
        ("frequency memory 2.5 s", |s| s.frequency_memory_s = 2.5),
        ("variance memory 0.5 s", |s| s.variance_memory_s = 0.5),
        ("variance memory 2 s", |s| s.variance_memory_s = 2.0),
        ("cap 2", |s| s.derivative_cap = 2.0),
        ("cap 1", |s| s.derivative_cap = 1.0),
        ("cap 16", |s| s.derivative_cap = 16.0),
        ("oscillators .3 1 3 10 30", |s| {
            s.oscillators[..5].copy_from_slice(&[0.3, 1.0, 3.0, 10.0, 30.0]);
            s.oscillator_count = 5;
        }),
        ("oscillators 1 3 10 30 100", |s| {
            s.oscillators[..5].copy_from_slice(&[1.0, 3.0, 10.0, 30.0, 100.0]);
            s.oscillator_count = 5;
        }),
        ("... and rest dwell 300 s", |s| {
            s.oscillators[..5].copy_from_slice(&[1.0, 3.0, 10.0, 30.0, 100.0]);
            (s.oscillator_count, s.rest_dwell_time_s) = (5, 300.0);
        }),
    ];
    println!("{:>28}   rate  static  waves   calm | rough  steps  chirp (of raw)", "");
    for rate in [50.0, 1000.0] {
        let runs = runs(rate, seed);
        for (name, change) in &changes {
            let mut settings = MsImmIkfSettings::defaults(rate, noise);
            change(&mut settings);
            let [rest, waves, calm, rough, steps, chirp] = score(&settings, &runs);
            println!("{name:>28} {rate:>6} {rest:>7.3}{waves:>7.3}{calm:>7.3} |{rough:>6.3}{steps:>7.3}{chirp:>7.3}");
        }
    }
}
