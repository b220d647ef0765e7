//! What every plain filter of the library promises, and the closed forms of each.

use proptest::prelude::*;
use stillrate::filters::{
    ArKfSettings, BiquadSettings, LinearPredictionSettings, OneEuroSettings, Pt1Settings, SageHusaKfSettings,
};
use stillrate::{Filter, Flags, GyroNoise, Real, Reals, Sample, Settings};

const RATE_HZ: f64 = 50.0;
const DENSITY: f64 = 0.0151;
/// Standard deviation of a raw sample, deg/s.
const SIGMA: f64 = 0.10677;

fn noise() -> GyroNoise {
    GyroNoise::from_density_two_sided(DENSITY)
}

/// Standard normal numbers from a seed (SplitMix64, Box-Muller).
fn normals(seed: u64, count: usize) -> Vec<f64> {
    let mut state = seed;
    let mut uniform = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 * 2.0_f64.powi(-53) + 2.0_f64.powi(-54)
    };
    (0..count)
        .map(|_| (-2.0 * uniform().logarithm()).root() * (core::f64::consts::TAU * uniform()).sine_cosine().1)
        .collect()
}

fn run<T: Real, S: Settings>(settings: &S, samples: &[(f64, f64)]) -> Vec<(f64, Flags)> {
    let filter = settings.build::<T>().unwrap();
    let mut state = filter.start();
    let step = |&(value, dt): &(f64, f64)| {
        let estimate = filter.step(&mut state, Sample { value: T::of(value), dt: T::of(dt) });
        assert!(estimate.rate.finite() && estimate.acceleration.finite() && estimate.variance.finite());
        assert!(estimate.variance >= T::ZERO);
        (estimate.rate.widen(), estimate.flags)
    };
    samples.iter().map(step).collect()
}

fn regular(values: impl IntoIterator<Item = f64>) -> Vec<(f64, f64)> {
    values.into_iter().map(|value| (value, 1.0 / RATE_HZ)).collect()
}

/// A slow swing with noise.
fn swing(seed: u64, count: usize) -> Vec<f64> {
    let swing = |k: usize| 19.0 * (0.1 * k as f64).sine_cosine().0;
    normals(seed, count).into_iter().enumerate().map(|(k, n)| swing(k) + SIGMA * n).collect()
}

fn a_constant_stays_itself<S: Settings>() {
    let settings = S::defaults(RATE_HZ, noise());
    for (rate, _) in run::<f64, S>(&settings, &regular([7.25; 500])) {
        assert!((rate - 7.25).abs() < 1e-13, "{}: {rate}", S::METHOD);
    }
    for (rate, _) in run::<f32, S>(&settings, &regular([7.25; 500])) {
        assert!((rate - 7.25).abs() < 2e-6, "{}: {rate}", S::METHOD);
    }
}

fn coasts_over_missing_samples<S: Settings>() {
    let settings = S::defaults(RATE_HZ, noise());
    let mut values = vec![2.0; 100];
    values.extend([f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::NAN]);
    values.extend([2.0; 100]);
    let answers = run::<f64, S>(&settings, &regular(values));
    for (k, (rate, flags)) in answers.iter().enumerate() {
        assert_eq!(flags.has(Flags::MISSING), (100..104).contains(&k), "{} at {k}", S::METHOD);
        assert!((0.0..2.0 + 1e-9).contains(rate), "{} at {k}: {rate}", S::METHOD);
    }
    assert!((answers[203].0 - answers[99].0).abs() < 1e-6, "{}", S::METHOD);
}

fn the_first_usable_sample_starts_it<S: Settings>() {
    let settings = S::defaults(RATE_HZ, noise());
    let answers = run::<f64, S>(&settings, &regular([f64::NAN, f64::NAN, -3.5]));
    assert_eq!((answers[0].0, answers[1].0), (0.0, 0.0));
    assert!(answers[1].1.has(Flags::NO_DATA_YET) && !answers[2].1.has(Flags::NO_DATA_YET));
    assert!((answers[2].0 + 3.5).abs() < 1e-12, "{}: {}", S::METHOD, answers[2].0);
}

fn recovers_from_a_spike_of_a_million_sigma<S: Settings>() {
    let settings = S::defaults(RATE_HZ, noise());
    let clean: Vec<f64> = normals(3, 6000).into_iter().map(|n| SIGMA * n).collect();
    let mut hit = clean.clone();
    hit[2000] = 1e6 * SIGMA;
    let (clean, hit) = (run::<f64, S>(&settings, &regular(clean)), run::<f64, S>(&settings, &regular(hit)));
    // Two minutes of one pole of 0.2 Hz forget a million-fold; so must everything else.
    let worst = (5500..6000).map(|k| (hit[k].0 - clean[k].0).abs()).fold(0.0, f64::max);
    assert!(worst < SIGMA, "{}: {worst}", S::METHOD);
}

fn single_precision_is_close_to_double<S: Settings>() {
    let settings = S::defaults(RATE_HZ, noise());
    let samples = regular(swing(5, 3000));
    let (single, double) = (run::<f32, S>(&settings, &samples), run::<f64, S>(&settings, &samples));
    let worst = single.iter().zip(&double).map(|(a, b)| (a.0 - b.0).abs()).fold(0.0, f64::max);
    // A hundredth of the noise, as for the recommended bank.
    assert!(worst < 1e-2 * SIGMA, "{}: {worst}", S::METHOD);
}

fn scales_with_the_noise<S: Settings>() {
    let values = swing(8, 1000);
    let plain = run::<f64, S>(&S::defaults(RATE_HZ, noise()), &regular(values.clone()));
    let louder = S::defaults(RATE_HZ, GyroNoise::from_density_two_sided(1024.0 * DENSITY));
    let scaled = run::<f64, S>(&louder, &regular(values.into_iter().map(|value| 1024.0 * value)));
    for (a, b) in plain.iter().zip(&scaled) {
        assert_eq!(1024.0 * a.0, b.0, "{}", S::METHOD);
    }
}

fn a_poisoned_state_is_replaced<S: Settings>() {
    let filter = S::defaults(RATE_HZ, noise()).build::<f64>().unwrap();
    for poison in [f64::NAN, f64::INFINITY, f64::MAX] {
        for value in [4.0, f64::NAN] {
            let mut state = <<S::Filter<f64> as Filter<f64>>::State as Reals<f64>>::gather(&mut || poison);
            let first = filter.step(&mut state, Sample { value, dt: 0.02 });
            let second = filter.step(&mut state, Sample { value: 4.0, dt: 0.02 });
            let third = filter.step(&mut state, Sample { value: 4.0, dt: 0.02 });
            if poison.is_nan() {
                assert!(first.flags.has(Flags::DIVERGED), "{}", S::METHOD);
            }
            assert!(first.rate.is_finite() && third.rate.is_finite(), "{} {poison}", S::METHOD);
            if !poison.is_finite() {
                assert!(second.rate > 0.0 && second.rate <= 4.0 + 1e-12, "{} {poison} {second:?}", S::METHOD);
            }
        }
    }
}

/// Numbers that break things, mixed with ordinary ones.
fn awkward() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -100.0..100.0,
        1 => prop::sample::select(vec![
            f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -0.0, 1e-310, 1e300, -1e300, f64::MAX, 4e9, -4e9, 1e6, 1e-30,
        ]),
    ]
}

fn survives<S: Settings>(samples: &[(f64, f64)]) {
    let settings = S::defaults(RATE_HZ, noise());
    assert_eq!(run::<f64, S>(&settings, samples).len(), samples.len());
    assert_eq!(run::<f32, S>(&settings, samples).len(), samples.len());
}

/// One module of tests a method.
macro_rules! promises {
    ($($module:ident $settings:ident: $($promise:ident)*;)*) => { $(
        mod $module {
            $(#[test]
            fn $promise() {
                super::$promise::<super::$settings>();
            })*
            proptest::proptest! {
                #![proptest_config(proptest::prelude::ProptestConfig::with_cases(64))]
                #[test]
                fn any_input_gives_finite_output(
                    samples in proptest::collection::vec((super::awkward(), proptest::prop_oneof![
                        4 => proptest::strategy::Just(0.02),
                        1 => super::awkward(),
                        1 => 0.0..0.3,
                    ]), 1..120)
                ) {
                    super::survives::<super::$settings>(&samples);
                }
            }
        }
    )* };
}
promises! {
    pt1 Pt1Settings: a_constant_stays_itself coasts_over_missing_samples the_first_usable_sample_starts_it
        recovers_from_a_spike_of_a_million_sigma single_precision_is_close_to_double scales_with_the_noise;
    biquad BiquadSettings: a_constant_stays_itself coasts_over_missing_samples the_first_usable_sample_starts_it
        recovers_from_a_spike_of_a_million_sigma single_precision_is_close_to_double scales_with_the_noise
        a_poisoned_state_is_replaced;
    one_euro OneEuroSettings: a_constant_stays_itself coasts_over_missing_samples the_first_usable_sample_starts_it
        recovers_from_a_spike_of_a_million_sigma single_precision_is_close_to_double scales_with_the_noise
        a_poisoned_state_is_replaced;
    ar_kf ArKfSettings: coasts_over_missing_samples the_first_usable_sample_starts_it
        recovers_from_a_spike_of_a_million_sigma single_precision_is_close_to_double scales_with_the_noise
        a_poisoned_state_is_replaced;
    sage_husa_kf SageHusaKfSettings: a_constant_stays_itself coasts_over_missing_samples
        the_first_usable_sample_starts_it recovers_from_a_spike_of_a_million_sigma single_precision_is_close_to_double
        scales_with_the_noise a_poisoned_state_is_replaced;
    linear_prediction LinearPredictionSettings: a_constant_stays_itself coasts_over_missing_samples
        the_first_usable_sample_starts_it recovers_from_a_spike_of_a_million_sigma single_precision_is_close_to_double
        scales_with_the_noise a_poisoned_state_is_replaced;
}

#[test]
fn the_biquad_is_the_direct_form_of_the_cookbook() {
    let settings = BiquadSettings { cutoff_hz: 8.0, quality: 0.9, ..BiquadSettings::defaults(RATE_HZ, noise()) };
    let (sine, cosine) = (core::f64::consts::TAU * 8.0 / RATE_HZ).sine_cosine();
    let bend = sine / (2.0 * 0.9);
    let scale = 1.0 + bend;
    let (b, a1, a2) = ((1.0 - cosine) / 2.0 / scale, -2.0 * cosine / scale, (1.0 - bend) / scale);
    let values = swing(4, 2000);
    let (mut x, mut y) = ([values[0]; 2], [values[0]; 2]);
    for (value, (rate, _)) in values.iter().zip(run::<f64, _>(&settings, &regular(values.clone()))) {
        let direct = b * (value + 2.0 * x[0] + x[1]) - a1 * y[0] - a2 * y[1];
        (x, y) = ([*value, x[0]], [direct, y[0]]);
        assert!((rate - direct).abs() < 1e-12);
    }
}

#[test]
fn the_biquad_holds_a_constant_in_single_precision_at_a_tiny_cutoff() {
    let settings = BiquadSettings { cutoff_hz: 0.5, ..BiquadSettings::defaults(8000.0, noise()) };
    let samples: Vec<_> = (0..80_000).map(|k| (if k == 0 { 0.0 } else { 1.0 }, 1.0 / 8000.0)).collect();
    let (rate, _) = run::<f32, _>(&settings, &samples)[79_999];
    assert!((rate - 1.0).abs() < 1e-3, "{rate}");
}

#[test]
fn the_one_euro_filter_is_that_of_its_paper() {
    let settings = OneEuroSettings::defaults(RATE_HZ, noise());
    let gain = |cutoff: f64| {
        let time_constant = 1.0 / (core::f64::consts::TAU * cutoff);
        1.0 / (1.0 + time_constant * RATE_HZ)
    };
    let values = swing(6, 1000);
    let (mut before, mut slope, mut level) = (values[0], 0.0, values[0]);
    for (&value, (rate, _)) in values.iter().zip(run::<f64, _>(&settings, &regular(values.clone()))) {
        slope += gain(1.0) * ((value - before) * RATE_HZ - slope);
        level += gain(0.2 + settings.beta * f64::abs(slope)) * (value - level);
        before = value;
        assert!((rate - level).abs() < 1e-11);
    }
}

#[test]
fn the_published_ar_filter_reduces_noise_and_motion_alike() {
    let settings = ArKfSettings::defaults(RATE_HZ, noise());
    let values: Vec<f64> = normals(9, 30_000).into_iter().map(|n| SIGMA * n).collect();
    let power = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>();
    let answers = run::<f64, _>(&settings, &regular(values.clone()));
    let ratio = (power(&mut values.into_iter()) / power(&mut answers.into_iter().map(|a| a.0))).root();
    assert!((ratio - 1.77).abs() < 0.01, "{ratio}");
    let constant = run::<f64, _>(&settings, &regular([1.0; 50]));
    assert!((constant[49].0 - 1.0 / ratio).abs() < 0.01);
}

#[test]
fn an_ar_filter_settles_at_the_variance_of_its_riccati_equation() {
    let mut settings = ArKfSettings::defaults(RATE_HZ, noise());
    settings.coefficients[0] = 0.95;
    (settings.process_variance_dps2, settings.measurement_variance_dps2) = (0.01, 0.04);
    let filter = settings.build::<f64>().unwrap();
    let mut state = filter.start();
    let mut variance = 0.0;
    for _ in 0..500 {
        variance = filter.step(&mut state, Sample { value: 1.0, dt: 0.02 }).variance;
    }
    // P = M R / (M + R) with M = phi^2 P + Q.
    let before = 0.95 * 0.95 * variance + 0.01;
    assert!((variance - before * 0.04 / (before + 0.04)).abs() < 1e-14);
    // Coasting ends at the variance and the mean of the process itself.
    for _ in 0..2000 {
        variance = filter.step(&mut state, Sample { value: f64::NAN, dt: 0.02 }).variance;
    }
    assert!((variance - 0.01 / (1.0 - 0.95 * 0.95)).abs() < 1e-12 && state.lags[0].abs() < 1e-30);
}

#[test]
fn a_gap_of_three_periods_is_two_missing_samples_to_an_ar_filter() {
    let mut settings = ArKfSettings::defaults(RATE_HZ, noise());
    settings.order = 2;
    (settings.coefficients[0], settings.coefficients[1]) = (1.2, -0.5);
    let filled = run::<f64, _>(&settings, &regular([1.0, 2.0, f64::NAN, f64::NAN, 3.0]));
    let gap = run::<f64, _>(&settings, &[(1.0, 0.02), (2.0, 0.02), (3.0, 0.06)]);
    assert!((filled[4].0 - gap[2].0).abs() < 1e-15);
}

#[test]
fn settings_that_cannot_work_are_refused_by_name() {
    let mut unstable = ArKfSettings::defaults(RATE_HZ, noise());
    unstable.coefficients[0] = 1.01;
    assert_eq!(unstable.build::<f64>().unwrap_err().field, "coefficients");
    let none = ArKfSettings { order: 0, ..ArKfSettings::defaults(RATE_HZ, noise()) };
    assert_eq!(none.build::<f64>().unwrap_err().field, "coefficients");
    let high = BiquadSettings { cutoff_hz: 25.0, ..BiquadSettings::defaults(RATE_HZ, noise()) };
    assert_eq!(high.build::<f64>().unwrap_err().field, "cutoff_hz");
    let fast = LinearPredictionSettings { step_size: 2.0, ..LinearPredictionSettings::defaults(RATE_HZ, noise()) };
    assert_eq!(fast.build::<f32>().unwrap_err().field, "step_size");
    let negative = OneEuroSettings { beta: -1.0, ..OneEuroSettings::defaults(RATE_HZ, noise()) };
    assert_eq!(negative.build::<f32>().unwrap_err().field, "beta");
    let timeless = SageHusaKfSettings { memory_s: 0.0, ..SageHusaKfSettings::defaults(RATE_HZ, noise()) };
    assert_eq!(timeless.build::<f32>().unwrap_err().field, "memory_s");
}

#[test]
fn sage_husa_learns_a_measurement_variance_nine_times_the_given_one() {
    let settings = SageHusaKfSettings::defaults(RATE_HZ, noise());
    let filter = settings.build::<f64>().unwrap();
    let mut state = filter.start();
    let mut sum = 0.0;
    for (k, n) in normals(12, 20_000).into_iter().enumerate() {
        filter.step(&mut state, Sample { value: 3.0 * SIGMA * n, dt: 0.02 });
        sum += if k >= 2000 { state.measurement_variance / 18_000.0 } else { 0.0 };
    }
    // A gain that follows the same noise favours small R a little.
    assert!((sum - 9.0).abs() < 0.9, "{sum}");
}

#[test]
fn linear_prediction_learns_a_sine_without_lag() {
    let settings = LinearPredictionSettings { step_size: 0.5, ..LinearPredictionSettings::defaults(RATE_HZ, noise()) };
    let truth: Vec<f64> = (0..4000).map(|k| 20.0 * (0.2 * f64::from(k)).sine_cosine().0).collect();
    let answers = run::<f64, _>(&settings, &regular(truth.clone()));
    let worst = (3000..4000).map(|k| (answers[k].0 - truth[k]).abs()).fold(0.0, f64::max);
    assert!(worst < 0.05, "{worst}");
}

#[test]
fn linear_prediction_quiets_white_noise_more_than_its_mean_of_sixteen_would() {
    let settings = LinearPredictionSettings::defaults(RATE_HZ, noise());
    let answers = run::<f64, _>(&settings, &regular(normals(20, 3000).into_iter().map(|n| SIGMA * n)));
    let rms = (answers.iter().map(|a| a.0 * a.0).sum::<f64>() / 3000.0).root();
    assert!(rms < SIGMA / 4.0, "{rms}");
}
