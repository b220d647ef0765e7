//! Drift propagation against closed forms, and three algorithms against one another.

use nalgebra::DMatrix;
use proptest::prelude::*;
use stillrate_lab::servo::drift::{
    DriftError, DriftLoop, FilterPosition, LoopNoise, TransferFunction, closed_forms, drift, lyapunov, multiply,
    quadrature, sampled, steady_state, van_loan,
};

fn ratio(numerator: &[f64], denominator: &[f64]) -> TransferFunction {
    TransferFunction::new(numerator, denominator).unwrap()
}

fn close(a: f64, b: f64, relative: f64) {
    assert!((a / b - 1.0).abs() <= relative, "{a:e} against {b:e}");
}

fn lag(a: f64) -> TransferFunction {
    ratio(&[a], &[1.0, a])
}

/// A strictly proper transfer function from poles (real, or complex pairs) and numerator coefficients.
fn stable(real: &[f64], pairs: &[(f64, f64)], numerator: &[f64]) -> TransferFunction {
    let mut denominator = vec![1.0];
    for p in real {
        denominator = multiply(&denominator, &[1.0, *p]);
    }
    for (wn, zeta) in pairs {
        denominator = multiply(&denominator, &[1.0, 2.0 * zeta * wn, wn * wn]);
    }
    let n = denominator.len() - 1;
    ratio(&numerator[..n], &denominator)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1600, ..ProptestConfig::default() })]

    // Issue: agreement to 1e-10 over at least 1000 random stable systems of order 1 to 8.
    #[test]
    fn recursion_lyapunov_and_van_loan_agree(
        real in prop::collection::vec(0.3_f64..20.0, 0..=4),
        pairs in prop::collection::vec((0.3_f64..20.0, 0.1_f64..0.98), 0..=2),
        first in 0.3_f64..20.0,
        numerator in prop::collection::vec(-2.0_f64..2.0, 9),
    ) {
        let mut real = real;
        if real.len() % 2 == 0 || pairs.is_empty() { real.push(first); }
        real.truncate(8 - 2 * pairs.len());
        let h = stable(&real, &pairs, &numerator);
        let recursion = steady_state(&h).unwrap();
        let by_lyapunov = lyapunov::steady_state(&h).unwrap();
        let by_doubling = van_loan::steady_state(&h).unwrap();
        prop_assert!((by_lyapunov / recursion - 1.0).abs() < 1e-10, "{by_lyapunov:e} {recursion:e} {h:?}");
        prop_assert!((by_doubling / recursion - 1.0).abs() < 1e-10, "{by_doubling:e} {recursion:e} {h:?}");
    }

    #[test]
    fn an_unstable_pole_is_refused_by_row(real in prop::collection::vec(0.3_f64..20.0, 1..6), bad in 0.01_f64..5.0) {
        let mut denominator = vec![1.0, -bad];
        for p in &real { denominator = multiply(&denominator, &[1.0, *p]); }
        let unstable = matches!(steady_state(&ratio(&[1.0], &denominator)), Err(DriftError::Unstable { .. }));
        prop_assert!(unstable);
    }

    #[test]
    fn nothing_panics_whatever_the_coefficients(
        numerator in prop::collection::vec(prop::num::f64::ANY, 0..6),
        denominator in prop::collection::vec(prop::num::f64::ANY, 0..6),
        t in prop::num::f64::ANY,
    ) {
        if let Ok(h) = TransferFunction::new(&numerator, &denominator) {
            let _ = steady_state(&h);
            let _ = van_loan::variance_after(&h, t);
        }
    }
}

#[test]
fn a_free_rate_loop_follows_its_closed_form() {
    for t in [0.1, 1.0, 10.0, 60.0, 3600.0] {
        let h = DriftLoop::rate_only(lag(20.0)).noise_path().unwrap();
        close(van_loan::variance_after(&h, t).unwrap(), closed_forms::rate_only_first_order(20.0, t), 1e-12);
    }
    let second = ratio(&[225.0], &[1.0, 18.0, 225.0]);
    let h = DriftLoop::rate_only(second).noise_path().unwrap();
    close(
        van_loan::variance_after(&h, 60.0).unwrap(),
        closed_forms::rate_only_second_order_late(15.0, 0.6, 60.0),
        1e-12,
    );
}

#[test]
fn coloured_noise_through_an_integrator_follows_its_closed_form() {
    let integrator = ratio(&[1.0], &[1.0, 0.0]);
    let noise = LoopNoise::from_density_two_sided(0.015)
        .unwrap()
        .with_gauss_markov(0.01, 20.0)
        .unwrap()
        .with_rate_random_walk(1e-3)
        .unwrap();
    for t in [0.1, 1.0, 60.0, 600.0] {
        let d = drift(&integrator, &noise, Some(t)).unwrap();
        close(d.white, 0.015 * 0.015 * t, 1e-13);
        close(d.gauss_markov, 1e-4 * closed_forms::integrator_gauss_markov(t, 20.0), 1e-12);
        close(d.rate_random_walk, 1e-6 * closed_forms::integrator_rate_random_walk(t), 1e-13);
    }
}

#[test]
fn a_tracked_loop_follows_its_closed_form() {
    let second = ratio(&[225.0], &[1.0, 18.0, 225.0]);
    let noise = LoopNoise::from_density_two_sided(1.0).unwrap().with_gauss_markov(1.0, 20.0).unwrap();
    for k in [0.5, 1.0, 2.0, 5.0] {
        let h = DriftLoop::rate_only(lag(20.0)).tracked(&[k], &[1.0]).unwrap().noise_path().unwrap();
        let d = drift(&h, &noise, None).unwrap();
        close(d.white, closed_forms::tracked_first_order(k), 1e-14);
        close(d.gauss_markov, closed_forms::tracked_first_order_gauss_markov(20.0, k, 20.0), 1e-12);
        let h = DriftLoop::rate_only(second.clone()).tracked(&[k], &[1.0]).unwrap().noise_path().unwrap();
        close(steady_state(&h).unwrap(), closed_forms::tracked_second_order(15.0, 0.6, k), 1e-13);
    }
    let too_much = DriftLoop::rate_only(second).tracked(&[19.0], &[1.0]).unwrap();
    assert!(matches!(steady_state(&too_much.noise_path().unwrap()), Err(DriftError::Unstable { row: 2 | 3, .. })));
}

#[test]
fn an_integral_in_the_angle_loop_removes_the_bias_and_bounds_the_random_walk() {
    let noise = LoopNoise::default().with_rate_random_walk(1e-3).unwrap();
    let p = DriftLoop::rate_only(lag(20.0)).tracked(&[2.0], &[1.0]).unwrap();
    assert_eq!(drift(&p.noise_path().unwrap(), &noise, None), Err(DriftError::NeedsTime));
    assert_eq!(p.bias_gain(), -0.5);
    let pi = DriftLoop::rate_only(lag(20.0)).tracked(&[2.0, 2.0 / 3.0], &[1.0, 0.0]).unwrap();
    assert_eq!(pi.bias_gain(), 0.0);
    let bounded = drift(&pi.noise_path().unwrap(), &noise, None).unwrap().total();
    close(drift(&pi.noise_path().unwrap(), &noise, Some(300.0)).unwrap().total(), bounded, 1e-10);
}

#[test]
fn a_filter_stands_in_three_different_places() {
    let f = lag(33.3);
    let k = 2.0;
    let tracked = || DriftLoop::rate_only(lag(20.0)).tracked(&[k], &[1.0]).unwrap();
    let at = |p| steady_state(&tracked().filtered(f.clone(), p).noise_path().unwrap()).unwrap();
    // Forward path: lag inside the loop makes the drift worse, by wc/(wc - k).
    close(at(FilterPosition::ForwardPath), 33.3 / (33.3 - k) / (2.0 * k), 1e-12);
    assert!(at(FilterPosition::BeforeLoop) < 1.0 / (2.0 * k));
    // Rate feedback, written out: C = 20(s+wc)/(s^2+wc s+20 wc), M = 20 wc/(same).
    let by_hand = ratio(&[20.0 * 33.3], &[1.0, 33.3, 20.0 * 33.3 + 20.0 * k, 20.0 * k * 33.3]);
    close(at(FilterPosition::RateFeedback), steady_state(&by_hand).unwrap(), 1e-12);
}

#[test]
fn quadrature_meets_the_recursion_and_sees_dead_time() {
    let tracked = DriftLoop::rate_only(lag(20.0)).tracked(&[2.0], &[1.0]).unwrap();
    let whole = quadrature::band_variance(tracked.power_gain().unwrap(), 1e-9, 1e9, 1e-12).unwrap();
    close(whole, 0.25, 1e-9);
    let late = tracked.delayed(0.3).unwrap();
    assert!(late.noise_path().is_err());
    assert!(quadrature::band_variance(late.power_gain().unwrap(), 1e-6, 1e6, 1e-10).unwrap() > whole);
    // An integrator over T has the variance of a band that starts at 1/(2 pi^2 T).
    let low = core::f64::consts::TAU * closed_forms::equivalent_cutoff_hz(60.0);
    let band = quadrature::band_variance(|w| 1.0 / (w * w), low, 1e7, 1e-12).unwrap();
    close(band, 60.0, 1e-5);
}

#[test]
fn doubling_equals_stepping_in_a_sampled_loop() {
    let f = DMatrix::from_row_slice(2, 2, &[0.9, 0.1, -0.2, 0.95]);
    let q = DMatrix::from_row_slice(2, 2, &[1.0, 0.2, 0.2, 0.5]);
    let mut p = DMatrix::identity(2, 2);
    for _ in 0..77 {
        p = &f * &p * f.transpose() + &q;
    }
    let doubled = sampled::covariance_after(&f, &q, &DMatrix::identity(2, 2), 77);
    assert!((doubled - &p).abs().max() < 1e-12 * p.abs().max());
}

#[test]
fn bad_parameters_are_refused_by_name() {
    let says = |e: DriftError, what: &str| assert!(e.to_string().contains(what), "{e}");
    let integrator = ratio(&[1.0], &[1.0, 0.0]);
    let white = LoopNoise::from_density_two_sided(1.0).unwrap();
    says(LoopNoise::from_density_two_sided(-1.0).unwrap_err(), "density_two_sided = -1");
    says(white.with_gauss_markov(1.0, 0.0).unwrap_err(), "bias_time_s = 0");
    says(drift(&integrator, &white, Some(0.0)).unwrap_err(), "time_s = 0");
    says(drift(&integrator, &white, None).unwrap_err(), "give time_s");
    says(drift(&ratio(&[1.0, 0.0], &[1.0, 1.0]), &white, Some(1.0)).unwrap_err(), "infinite variance");
    says(TransferFunction::new(&[1.0], &[0.0]).unwrap_err(), "denominator");
    says(steady_state(&ratio(&[1.0], &[1.0, 1.0, -1.0])).unwrap_err(), "Routh row 2");
}
