use proptest::prelude::*;
use stillrate::block::{load, store};
use stillrate::filters::closed_forms as closed;
use stillrate::filters::{
    CusumForgettingSettings, FirLowPassSettings, RandomWalkKfSettings, RecursiveLeastSquaresSettings,
    VariableForgettingSettings,
};
use stillrate::{Filter, Flags, GyroNoise, Real, Reals, Sample, Settings};

use crate::{Noise, run};

fn noise() -> GyroNoise {
    GyroNoise::from_standard_deviation_at_rate(0.05, 200.0)
}

fn rls(order: f64, lambda: f64) -> RecursiveLeastSquaresSettings {
    let defaults = RecursiveLeastSquaresSettings::defaults(1.0, GyroNoise::from_density_two_sided(1.0));
    RecursiveLeastSquaresSettings { order, tau_s: closed::tau_samples(lambda), forgetting_factor: lambda, ..defaults }
}

fn kf(variance_ratio: f64) -> RandomWalkKfSettings {
    let defaults = RandomWalkKfSettings::defaults(1.0, GyroNoise::from_density_two_sided(1.0));
    RandomWalkKfSettings { variance_ratio, ..defaults }
}

#[test]
fn least_squares_has_the_gain_and_noise_of_its_closed_forms() {
    for lambda in [1e-3, 0.5, 0.9512, 0.999, 0.999_99, 1.0] {
        let filter = rls(1.0, lambda).build::<f64>().unwrap();
        let mut state = filter.start();
        for n in 1..3000 {
            filter.step(&mut state, Sample { value: 0.0, dt: 1.0 });
            let gain = 1.0 / state.mean.weight;
            assert!((gain / closed::rls_gain(lambda, n) - 1.0).abs() < 1e-13, "{lambda} {n}");
            assert!((state.mean.noise_gain / closed::rls_noise(lambda, n) - 1.0).abs() < 1e-12, "{lambda} {n}");
        }
    }
}

#[test]
fn kalman_filter_has_the_gain_of_its_closed_form_and_of_the_textbook() {
    for lambda in [0.1, 0.9512, 0.999] {
        let q = closed::variance_ratio(lambda);
        let filter = kf(q).build::<f64>().unwrap();
        let mut state = filter.start();
        let mut textbook = 1.0;
        for n in 1..3000 {
            filter.step(&mut state, Sample { value: 0.0, dt: 1.0 });
            assert!((1.0 / state.weight / closed::kf_gain(lambda, n) - 1.0).abs() < 1e-12);
            assert!((1.0 / state.weight / textbook - 1.0).abs() < 1e-12);
            textbook = (textbook + q) / (1.0 + textbook + q);
        }
    }
}

#[test]
fn the_printed_plus_sign_diverges_as_the_erratum_says() {
    // P <- (P + P^2/(lambda + P))/lambda, as printed: 1, 1.59, 2.72, 4.97 and out of range before sample 500.
    let lambda = 0.9512;
    let mut p = 1.0_f64;
    let mut first = Vec::new();
    let overflow = (1..1000).find(|_| {
        first.push(p);
        p = (p + p * p / (lambda + p)) / lambda;
        !p.is_finite()
    });
    assert!((first[3] - 4.973_427_6).abs() < 1e-6);
    assert!(overflow.is_some_and(|n| n < 500));
}

#[test]
fn gain_in_single_precision_survives_ten_million_samples() {
    gain_after(1_000_000);
}

#[test]
#[ignore = "a hundred million steps"]
fn gain_in_single_precision_survives_a_hundred_million_samples() {
    gain_after(100_000_000);
}

fn gain_after(samples: u64) {
    for lambda in [0.9512, 0.999, 0.999_99, 1.0] {
        let filter = rls(1.0, lambda).build::<f32>().unwrap();
        let mut state = filter.start();
        for _ in 0..samples {
            filter.step(&mut state, Sample { value: 1.0, dt: 1.0 });
        }
        let exact = closed::rls_gain(lambda, samples);
        // The usual form in f32 is off by 17 % for lambda = 1 and by 0.6 % for 0.99999. What remains here is the rounding of
        // 1 - lambda itself: one unit in 2^24.
        assert!((1.0 / f64::from(state.mean.weight) / exact - 1.0).abs() < 5e-7, "{lambda}");
        assert_eq!(state.mean.level, 1.0);
    }
}

#[test]
fn order_two_follows_a_ramp_without_lag_and_equals_the_weighted_line() {
    let lambda = 0.95;
    let filter = rls(2.0, lambda).build::<f64>().unwrap();
    let mut noise = Noise(7);
    let values: Vec<f64> = (0..60).map(|k| 0.3 * f64::from(k) + noise.normal()).collect();
    let estimates = run(&filter, &values);
    for n in [2_usize, 3, 10, 60] {
        // The weighted normal equations, from scratch.
        let (mut s0, mut s1, mut s2, mut y0, mut y1) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for (age, value) in values[..n].iter().rev().enumerate() {
            let (weight, t) = (lambda.powi(age as i32), -(age as f64));
            s0 += weight;
            s1 += weight * t;
            s2 += weight * t * t;
            y0 += weight * value;
            y1 += weight * t * value;
        }
        let level = (s2 * y0 - s1 * y1) / (s0 * s2 - s1 * s1);
        let slope = (s0 * y1 - s1 * y0) / (s0 * s2 - s1 * s1);
        assert!((estimates[n - 1].rate - level).abs() < 1e-11, "{n}");
        assert!((estimates[n - 1].acceleration - slope).abs() < 1e-11, "{n}");
    }
    let ramp: Vec<f64> = (0..2000).map(f64::from).collect();
    let last = run(&filter, &ramp).last().copied().unwrap();
    assert!((last.rate - 1999.0).abs() < 1e-9 && (last.acceleration - 1.0).abs() < 1e-10);
    assert!((last.variance - closed::steady_noise_order_2(lambda)).abs() < 1e-12);
}

#[test]
fn holds_and_forgets_over_missing_samples() {
    // pandas ewm(ignore_na=False): weights age through the gap. Written out for x = 1, gap, gap, 4.
    let lambda = 0.8;
    let filter = rls(1.0, lambda).build::<f64>().unwrap();
    let estimates = run(&filter, &[f64::NAN, 1.0, f64::INFINITY, f64::NAN, 4.0]);
    assert_eq!(estimates[0].rate, 0.0);
    assert!(estimates[0].flags.has(Flags::NO_DATA_YET.with(Flags::MISSING)));
    assert_eq!(estimates[1].rate, 1.0);
    assert_eq!(estimates[3].rate, 1.0);
    assert!(estimates[3].flags.has(Flags::MISSING) && !estimates[3].flags.has(Flags::NO_DATA_YET));
    let weight = lambda * lambda * lambda;
    assert!((estimates[4].rate - (weight + 4.0) / (weight + 1.0)).abs() < 1e-15);
}

#[test]
fn the_walk_goes_on_over_missing_samples() {
    let q = 0.01;
    let estimates = run(&kf(q).build::<f64>().unwrap(), &[1.0, f64::NAN, f64::NAN, 4.0]);
    let before = 1.0 + 3.0 * q;
    assert!((estimates[3].rate - (1.0 + before / (1.0 + before) * 3.0)).abs() < 1e-14);
    assert!((estimates[2].variance - (1.0 + 2.0 * q)).abs() < 1e-14);
}

#[test]
fn a_time_step_of_k_periods_weighs_like_k_periods() {
    let lambda: f64 = 0.9;
    let filter = rls(1.0, lambda).build::<f64>().unwrap();
    let (mut jumped, mut stepped) = (filter.start(), filter.start());
    for (k, value) in [1.0, -2.0, 0.5, 7.0].into_iter().enumerate() {
        let gap = k + 1;
        let a = filter.step(&mut jumped, Sample { value, dt: gap as f64 });
        for _ in 0..k {
            filter.step(&mut stepped, Sample { value: f64::NAN, dt: 1.0 });
        }
        let b = filter.step(&mut stepped, Sample { value, dt: 1.0 });
        assert!((a.rate - b.rate).abs() < 1e-14);
    }
}

#[test]
fn order_two_coasts_for_one_memory_and_starts_anew_after_ten_seconds() {
    let filter =
        RecursiveLeastSquaresSettings { order: 2.0, ..RecursiveLeastSquaresSettings::defaults(100.0, noise()) }
            .build::<f64>()
            .unwrap();
    let mut state = filter.start();
    for k in 0..200 {
        filter.step(&mut state, Sample { value: 0.1 * f64::from(k), dt: 0.01 });
    }
    let mut gap = Vec::new();
    for _ in 0..2000 {
        gap.push(filter.step(&mut state, Sample { value: f64::NAN, dt: 0.01 }).rate);
    }
    assert!((gap[0] - 20.0).abs() < 1e-9 && (gap[9] - 20.9).abs() < 1e-9); // 10 deg/s^2 for 0.1 s, then held
    assert!((gap[1999] - 20.9).abs() < 1e-6);
    let back = filter.step(&mut state, Sample { value: -3.0, dt: 0.01 });
    assert!((back.rate + 3.0).abs() < 1e-12 && back.flags.has(Flags::RESTARTED));
    assert_eq!(back.acceleration, 0.0);
}

#[test]
fn a_moving_mean_starts_at_the_first_sample_or_at_zero() {
    let settings = FirLowPassSettings { length: 4.0, ..FirLowPassSettings::defaults(200.0, noise()) };
    let started = run(&settings.build::<f64>().unwrap(), &[2.0, 2.0, 6.0, f64::NAN, 2.0]);
    let rates: Vec<f64> = started.iter().map(|e| e.rate).collect();
    assert_eq!(rates, [2.0, 2.0, 3.0, 3.25, 3.25]); // the gap is filled with the output before it
    let zero = run(&FirLowPassSettings { start: 1, ..settings }.build::<f64>().unwrap(), &[2.0, 2.0]);
    assert_eq!((zero[0].rate, zero[1].rate), (0.5, 1.0));
}

#[test]
fn settings_out_of_range_are_named() {
    for lambda in [0.0, -0.1, 1.1, f64::NAN, f64::INFINITY] {
        let settings = RecursiveLeastSquaresSettings { forgetting_factor: lambda, ..rls(1.0, 0.9) };
        assert_eq!(settings.build::<f64>().unwrap_err().field, "forgetting_factor", "{lambda}");
    }
    let both = RecursiveLeastSquaresSettings { forgetting_factor: 0.5, ..rls(1.0, 0.9) };
    assert!(both.build::<f64>().unwrap_err().range.contains("give one of the two"));
    assert_eq!(
        RecursiveLeastSquaresSettings { tau_s: -1.0, ..rls(1.0, 0.9) }.build::<f64>().unwrap_err().field,
        "tau_s"
    );
    assert_eq!(rls(3.0, 0.9).build::<f64>().unwrap_err().field, "order");
    assert_eq!(kf(-1.0).build::<f64>().unwrap_err().field, "variance_ratio");
    let fir = FirLowPassSettings::defaults(200.0, noise());
    for length in [0.0, 2.5, 129.0, f64::NAN] {
        assert_eq!(FirLowPassSettings { length, ..fir.clone() }.build::<f64>().unwrap_err().field, "length");
    }
    let above_half = FirLowPassSettings { cutoff_hz: 100.0, ..fir };
    assert_eq!(above_half.build::<f64>().unwrap_err().field, "cutoff_hz");
}

/// Streams `values` with `steps`, and the same through eight lanes side by side.
fn same_bits_in_lanes<T: Real, S: Settings>(settings: &S, values: &[f64]) {
    let filter = settings.build::<T>().unwrap();
    let count = <<S::Filter<T> as Filter<T>>::State as Reals<T>>::COUNT;
    let mut lanes = vec![[T::ZERO; 8]; count];
    (0..8).for_each(|c| store(&filter.start(), &mut lanes, c));
    let mut tile: Vec<[T; 8]> = values.iter().map(|&v| core::array::from_fn(|c| T::of(v * (c as f64 - 3.0)))).collect();
    filter.tile(&mut lanes, &mut tile, filter.period());
    for c in 0..8 {
        let mut state = filter.start();
        for (row, &value) in tile.iter().zip(values) {
            let sample = Sample { value: T::of(value * (c as f64 - 3.0)), dt: filter.period() };
            let rate = filter.step(&mut state, sample).rate;
            assert_eq!(row[c].to_little_endian(), rate.to_little_endian());
            assert!(rate.finite());
        }
        let (left, right) = (load::<T, <S::Filter<T> as Filter<T>>::State, 8>(&lanes, c), state);
        assert_eq!(left, right);
    }
}

fn all_same_bits<T: Real>(values: &[f64]) {
    let order_2 =
        RecursiveLeastSquaresSettings { order: 2.0, ..RecursiveLeastSquaresSettings::defaults(200.0, noise()) };
    same_bits_in_lanes::<T, _>(&RecursiveLeastSquaresSettings::defaults(200.0, noise()), values);
    same_bits_in_lanes::<T, _>(&order_2, values);
    same_bits_in_lanes::<T, _>(&RandomWalkKfSettings::defaults(200.0, noise()), values);
    same_bits_in_lanes::<T, _>(&VariableForgettingSettings::defaults(200.0, noise()), values);
    same_bits_in_lanes::<T, _>(&VariableForgettingSettings::defaults_of_order_2(200.0, noise()), values);
    same_bits_in_lanes::<T, _>(&CusumForgettingSettings::defaults(200.0, noise()), values);
    same_bits_in_lanes::<T, _>(&FirLowPassSettings::defaults(200.0, noise()), values);
}

fn any_value() -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => -300.0..300.0_f64,
        1 => Just(f64::NAN),
        1 => prop_oneof![Just(f64::INFINITY), Just(f64::MAX), Just(-1e30), Just(1e-310), Just(0.0), Just(1e18)],
    ]
}

fn survives<S: Settings>(settings: &S, samples: &[(f64, f64)]) -> Result<(), TestCaseError> {
    let filter = settings.build::<f32>().unwrap();
    let mut state = filter.start();
    for &(value, dt) in samples {
        let estimate = filter.step(&mut state, Sample { value: value as f32, dt: dt as f32 });
        prop_assert!(estimate.rate.is_finite() && estimate.acceleration.is_finite());
    }
    // Whatever came before, ordinary samples bring it back.
    let mut last = filter.step(&mut state, Sample { value: 1.0, dt: 0.005 });
    for _ in 0..20_000 {
        last = filter.step(&mut state, Sample { value: 1.0, dt: 0.005 });
    }
    prop_assert!((last.rate - 1.0).abs() < 1e-3, "{} stays at {}", S::METHOD, last.rate);
    prop_assert!(last.variance.is_finite());
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn many_channels_have_the_bits_of_one(values in prop::collection::vec(any_value(), 1..60)) {
        all_same_bits::<f64>(&values);
        all_same_bits::<f32>(&values);
    }

    #[test]
    fn nothing_poisons_a_state(
        samples in prop::collection::vec(
            (any_value(), prop_oneof![6 => Just(0.005), 1 => 1e-6..30.0_f64, 1 => Just(f64::NAN), 1 => Just(-1.0), 1 => Just(1e30)]),
            1..80,
        )
    ) {
        let quick = RecursiveLeastSquaresSettings::defaults(200.0, noise());
        survives(&quick, &samples)?;
        survives(&RecursiveLeastSquaresSettings { order: 2.0, ..quick }, &samples)?;
        survives(&RandomWalkKfSettings { variance_ratio: 1e-3, ..RandomWalkKfSettings::defaults(200.0, noise()) }, &samples)?;
        survives(&VariableForgettingSettings::defaults(200.0, noise()), &samples)?;
        survives(&VariableForgettingSettings::defaults_of_order_2(200.0, noise()), &samples)?;
        survives(&CusumForgettingSettings::defaults(200.0, noise()), &samples)?;
        survives(&FirLowPassSettings::defaults(200.0, noise()), &samples)?;
    }
}
