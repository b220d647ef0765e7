//! What the options of the banks do: outliers, the rail, and every choice that the published filter leaves open.

use stillrate::filters::{FirLowPassSettings, MsImmIkfPaperSettings, MsImmIkfSettings, closed_forms};
use stillrate::{Filter, Flags, GyroNoise, ModelTrace, Observer, Sample, Settings};

const RATE_HZ: f64 = 100.0;

fn noise() -> GyroNoise {
    GyroNoise::from_standard_deviation_at_rate(0.1, RATE_HZ).with_rate_random_walk(0.003)
}

/// Numbers of standard deviation 0.1 about zero, the same every time.
fn jitter(k: usize) -> f64 {
    let mixed = (k as u64).wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    let uniform = ((mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 11) as f64 / (1_u64 << 53) as f64;
    (uniform - 0.5) * 0.1 * 12.0_f64.sqrt()
}

#[test]
fn one_wild_sample_is_taken_for_an_outlier_where_outliers_are_expected() {
    let plain = MsImmIkfSettings::defaults(RATE_HZ, noise());
    let wary = MsImmIkfSettings { outlier_probability: 0.01, ..plain.clone() };
    let mut moved = Vec::new();
    for settings in [&plain, &wary] {
        let filter = settings.build::<f64>().unwrap();
        let mut state = filter.start();
        let mut flags = Flags::NONE;
        for k in 0..500 {
            flags = flags.with(filter.step(&mut state, Sample { value: jitter(k), dt: 0.01 }).flags);
        }
        assert!(!flags.has(Flags::OUTLIER), "noise alone is no outlier");
        let hit = filter.step(&mut state, Sample { value: 20.0, dt: 0.01 });
        assert_eq!(hit.flags.has(Flags::OUTLIER), settings.outlier_probability > 0.0);
        moved.push(hit.rate.abs());
    }
    assert!(moved[1] < 0.1 * moved[0], "{moved:?}");
}

#[test]
fn a_turn_that_goes_on_is_no_outlier_for_long() {
    let settings = MsImmIkfSettings { outlier_probability: 0.01, ..MsImmIkfSettings::defaults(RATE_HZ, noise()) };
    let filter = settings.build::<f64>().unwrap();
    let mut state = filter.start();
    for k in 0..700 {
        let value = if k < 500 { 0.0 } else { 20.0 } + jitter(k);
        let estimate = filter.step(&mut state, Sample { value, dt: 0.01 });
        assert!(k != 699 || (estimate.rate - 20.0).abs() < 0.5, "{estimate:?}");
    }
}

#[test]
fn the_rail_says_at_least_this_much_and_no_more() {
    let full_scale = 50.0;
    let settings = MsImmIkfSettings { saturation_dps: full_scale, ..MsImmIkfSettings::defaults(RATE_HZ, noise()) };
    let filter = settings.build::<f64>().unwrap();
    let blind = MsImmIkfSettings::defaults(RATE_HZ, noise()).build::<f64>().unwrap();
    let (mut state, mut other) = (filter.start(), blind.start());
    let (mut worst, mut worst_blind, mut railed) = (0.0_f64, 0.0_f64, 0);
    for k in 0..1000 {
        let truth = 55.0 * (0.02 * k as f64).sin();
        let value = (truth + jitter(k)).clamp(-full_scale, full_scale);
        let estimate = filter.step(&mut state, Sample { value, dt: 0.01 });
        let seen = blind.step(&mut other, Sample { value, dt: 0.01 });
        assert_eq!(estimate.flags.has(Flags::SATURATED), value.abs() == full_scale, "sample {k}");
        if value.abs() == full_scale && k > 300 {
            railed += 1;
            worst = worst.max((estimate.rate - truth).abs());
            worst_blind = worst_blind.max((seen.rate - truth).abs());
        }
    }
    assert!(railed > 100 && worst < 0.7 * worst_blind, "{railed}: {worst} with the rail known, {worst_blind} without");
}

#[derive(Default)]
struct Fading {
    largest: [f64; 2],
    alpha: [f64; 2],
}

impl Observer<f64> for Fading {
    fn model(&mut self, index: usize, trace: ModelTrace<f64>) {
        self.largest[index] = self.largest[index].max(trace.fading);
        self.alpha[index] = trace.alpha;
    }
}

/// Fading factors and last alphas of a run: at rest for ten seconds, then a turn that swells.
fn faded(settings: &MsImmIkfPaperSettings) -> (Fading, Fading) {
    let filter = settings.build::<f64>().unwrap();
    assert_eq!(filter.models(), 2);
    let mut state = filter.start();
    let (mut rest, mut motion) = (Fading::default(), Fading::default());
    for k in 0..1500 {
        let moving = k >= 1000;
        let value = jitter(k) + if moving { 30.0 * (0.1 * (k - 1000) as f64).sin() } else { 0.0 };
        let seen = if moving { &mut motion } else { &mut rest };
        let estimate = filter.observe(&mut state, Sample { value, dt: 0.01 }, seen);
        assert!(estimate.rate.is_finite() && estimate.variance >= 0.0, "sample {k}: {estimate:?}");
    }
    (rest, motion)
}

#[test]
fn fading_acts_where_its_form_source_and_gate_let_it() {
    let mut settings = MsImmIkfPaperSettings { fading: 0, ..MsImmIkfPaperSettings::defaults(RATE_HZ, noise()) };
    let (rest, motion) = faded(&settings);
    assert_eq!((rest.largest, motion.largest), ([1.0; 2], [1.0; 2]), "none");
    for source in 0..3 {
        settings.fading = 2;
        settings.fading_source = source;
        settings.fading_scale = 1.0;
        settings.fading_gate = 0;
        let (_, always) = faded(&settings);
        assert!(always.largest.iter().all(|&lambda| lambda > 1.0), "source {source}: {:?}", always.largest);
        // Where rest is declared whatever alpha is, neither gate lets anything through.
        settings.static_alpha_per_s = 1.0;
        for gate in [1, 2] {
            settings.fading_gate = gate;
            assert_eq!(faded(&settings).1.largest, [1.0; 2], "source {source}, gate {gate}");
        }
        // With rest never declared, one gate lets both models fade and the other the second only.
        settings.static_alpha_per_s = 0.0;
        settings.fading_gate = 1;
        assert!(faded(&settings).1.largest.iter().all(|&lambda| lambda > 1.0), "source {source}");
        settings.fading_gate = 2;
        let second = faded(&settings).1.largest;
        assert!(second[0] == 1.0 && second[1] > 1.0, "source {source}: {second:?}");
    }
}

#[test]
fn a_missing_sample_has_no_innovation_to_fade_by() {
    let defaults = MsImmIkfPaperSettings::defaults(RATE_HZ, noise());
    let settings = MsImmIkfPaperSettings { fading: 2, fading_source: 2, fading_scale: 1.0, ..defaults };
    let filter = settings.build::<f64>().unwrap();
    let mut state = filter.start();
    for k in 0..200 {
        filter.step(&mut state, Sample { value: 40.0 + jitter(k), dt: 0.01 });
    }
    let before = state.window;
    for _ in 0..20 {
        filter.step(&mut state, Sample { value: f64::NAN, dt: 0.01 });
    }
    assert_eq!(state.window, before);
}

#[test]
fn alpha_is_estimated_only_with_the_exact_derivative() {
    let start = [0.001, 0.01];
    let (_, printed) = faded(&MsImmIkfPaperSettings { fading: 0, ..MsImmIkfPaperSettings::defaults(RATE_HZ, noise()) });
    assert_eq!(printed.alpha, start);
    for logarithmic in [false, true] {
        let mut settings = MsImmIkfPaperSettings::defaults(RATE_HZ, noise());
        settings.mode = if logarithmic { 3 } else { 2 };
        (settings.alpha_mixing, settings.jacobian, settings.fading) = (1, 1, 0);
        settings.initial_alpha_variance = if logarithmic { [1.0; 2] } else { [1e-4; 2] };
        settings.alpha_noise_density = if logarithmic { [0.01; 2] } else { [1e-4; 2] };
        let (_, exact) = faded(&settings);
        assert!(
            exact.alpha.iter().zip(start).any(|(alpha, start)| (alpha / start - 1.0).abs() > 0.01),
            "{:?}",
            exact.alpha
        );
    }
}

#[test]
fn the_printed_equations_diverge_and_start_anew_at_the_sample() {
    let mut settings = MsImmIkfPaperSettings::defaults(RATE_HZ, noise());
    (settings.mode, settings.alpha_mixing, settings.fading, settings.fading_scope) = (1, 1, 1, 1);
    (settings.fading_gate, settings.static_stay_probability) = (0, 0.0);
    settings.alpha_noise_density = [1e-8, 1e-6];
    let filter = settings.build::<f64>().unwrap();
    let mut state = filter.start();
    let mut lost = 0;
    for k in 0..20_000 {
        let value = jitter(k);
        let estimate = filter.step(&mut state, Sample { value, dt: 0.01 });
        assert!(estimate.rate.is_finite());
        if estimate.flags.has(Flags::DIVERGED) {
            lost += 1;
            assert_eq!(estimate.rate, value);
        }
    }
    assert!(lost > 0, "the printed filter overflows by itself");
}

#[test]
fn the_closed_forms_belong_together() {
    use closed_forms::*;
    for lambda in [0.5, 0.9, 0.9512, 0.999] {
        assert!((boxcar_length(lambda) * steady_noise(lambda) - 1.0).abs() < 1e-14);
        assert!((lag_samples(lambda) - 0.5 * (boxcar_length(lambda) - 1.0)).abs() < 1e-11);
        assert!((phase_delay_samples(lambda, 1e-7) / lag_samples(lambda) - 1.0).abs() < 1e-6);
        assert!((forgetting_factor_of_tau(tau_samples(lambda)) - lambda).abs() < 1e-15);
        assert!((forgetting_factor_of_variance_ratio(variance_ratio(lambda)) / lambda - 1.0).abs() < 1e-12);
        let (level, slope) = steady_gains_order_2(lambda);
        assert!((level - (1.0 - lambda * lambda)).abs() < 1e-15 && (slope - (1.0 - lambda).powi(2)).abs() < 1e-15);
        assert!(steady_noise_order_2(lambda) > steady_noise(lambda));
        let corner = half_power_frequency(lambda).unwrap();
        let omega = core::f64::consts::TAU * corner;
        let gain2 = (1.0 - lambda).powi(2) / (1.0 - 2.0 * lambda * omega.cos() + lambda * lambda);
        // The denominator cancels to (1 - lambda)^2.
        assert!((gain2 - 0.5).abs() < 1e-9, "{lambda}: {gain2}");
    }
    assert_eq!((tau_samples(1.0), half_power_frequency(0.1)), (f64::INFINITY, None));
}

#[test]
fn noise_figures_in_every_unit_mean_the_same_gyro() {
    let two_sided = GyroNoise::from_density_two_sided(0.015);
    let one_sided = GyroNoise::from_density_one_sided(0.015 * 2.0_f64.sqrt());
    assert!((one_sided.density_dps_sqrt_hz / two_sided.density_dps_sqrt_hz - 1.0).abs() < 1e-15);
    let walk = GyroNoise::from_angle_random_walk_deg_sqrt_h(0.9);
    assert!((walk.density_dps_sqrt_hz / two_sided.density_dps_sqrt_hz - 1.0).abs() < 1e-15);
    // Rounding to a step scatters by the step over the root of twelve.
    let quantised = GyroNoise::from_resolution(0.12_f64.sqrt(), 100.0);
    assert!((quantised.sample_variance(100.0) - 0.01).abs() < 1e-17);
    // A Gauss-Markov bias drifts at first like a walk of 2 sigma^2 / tau.
    let drifting = two_sided.with_rate_random_walk(0.003).with_bias(0.01, 20.0);
    assert!((drifting.rate_random_walk_dps_sqrt_s - (9e-6_f64 + 1e-5).sqrt()).abs() < 1e-15);
}

#[test]
fn taps_of_every_window_are_symmetric_pass_a_constant_and_stop_what_is_fast() {
    for window in 0..4 {
        for cutoff_hz in [0.0, 8.0] {
            let settings = FirLowPassSettings {
                window,
                length: 31.0,
                cutoff_hz,
                ..FirLowPassSettings::defaults(RATE_HZ, noise())
            };
            let (taps, count) = settings.designed().unwrap();
            assert_eq!(count, 31);
            assert!((taps.iter().sum::<f64>() - 1.0).abs() < 1e-14);
            assert!((0..31).all(|k| (taps[k] - taps[30 - k]).abs() < 1e-15), "window {window}");
            let gain = |frequency: f64| {
                let turn = |k: usize| core::f64::consts::TAU * frequency * k as f64 / RATE_HZ;
                let sum = |f: fn(f64) -> f64| (0..31).map(|k| taps[k] * f(turn(k))).sum::<f64>();
                sum(f64::cos).hypot(sum(f64::sin))
            };
            assert!(
                gain(1.0) > 0.6 && gain(30.0) < 0.12,
                "window {window}, {cutoff_hz} Hz: {} {}",
                gain(1.0),
                gain(30.0)
            );
            // Half the amplitude at the cut-off of a windowed sinc, but for the boxcar's ripple.
            assert!(cutoff_hz == 0.0 || window == 0 || (gain(cutoff_hz) - 0.5).abs() < 0.05, "window {window}");
        }
    }
    let mut own = FirLowPassSettings { tap_count: 2, ..FirLowPassSettings::defaults(RATE_HZ, noise()) };
    (own.taps[0], own.taps[1]) = (2.0, -1.0); // a straight line carried on
    let filter = own.build::<f64>().unwrap();
    let mut state = filter.start();
    let line: Vec<f64> =
        (0..4).map(|k| filter.step(&mut state, Sample { value: f64::from(k), dt: 0.01 }).rate).collect();
    assert_eq!(line[1..], [2.0, 3.0, 4.0]);
}
