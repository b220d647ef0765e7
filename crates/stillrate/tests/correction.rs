//! The run-time error curve: edges, fixed point, slopes, both number types.
#![allow(missing_docs)]

use proptest::prelude::*;
use stillrate::correction::{Compensated, ErrorCurve, HIDDEN, INPUTS, TERMS, term_powers};
use stillrate::filters::Pt1;
use stillrate::{Filter, Flags, Real, Sample};

/// A curve with every part in use and numbers derived from `seed`.
fn busy<T: Real>(seed: f64) -> ErrorCurve<T> {
    let mut k = seed;
    let mut next = || {
        k = (k * 37.0 + 0.317).rem_euclid(1.0);
        T::of(0.2 * (k - 0.5))
    };
    let mut curve = ErrorCurve::line(0.0, 0.0, -6.0, 6.0).unwrap();
    curve.inputs = 3;
    curve.hidden = HIDDEN as u32;
    curve.cubic = 1;
    curve.low = [T::of(-6.0), T::of(-10.0), T::of(1.0)];
    curve.high = [T::of(6.0), T::of(50.0), T::of(3.0)];
    curve.centre = [T::ZERO, T::of(20.0), T::TWO];
    curve.scale = [T::of(1.0 / 6.0), T::of(1.0 / 30.0), T::ONE];
    curve.terms = [(); TERMS].map(|()| next());
    curve.input_weights = [(); HIDDEN].map(|()| [(); INPUTS].map(|()| next() * T::of(20.0)));
    curve.hidden_bias = [(); HIDDEN].map(|()| next() * T::of(10.0));
    curve.output_weights = [(); HIDDEN].map(|()| next());
    curve.checked().unwrap()
}

#[test]
fn holds_the_edge_value_outside_the_range_and_flags_it() {
    let curve = busy::<f64>(0.1);
    let (edge, inside) = curve.error([6.0, 20.0, 2.0]);
    let (held, outside) = curve.error([600.0, 20.0, 2.0]);
    assert_eq!(edge, held);
    assert_eq!(inside, Flags::NONE);
    assert_eq!(outside, Flags::EDGE_HELD);
    assert!(curve.error([0.0, 51.0, 2.0]).1.has(Flags::EDGE_HELD));
    assert!(curve.error([0.0, f64::NAN, 2.0]).1.has(Flags::EDGE_HELD));
}

#[test]
fn the_polynomial_is_the_sum_of_its_listed_terms() {
    let mut curve = busy::<f64>(0.2);
    curve.hidden = 0;
    let [x, y, z] = [0.4_f64, -0.7, 0.2];
    let power = |base: f64, p: u8| (0..p).fold(1.0, |a, _| a * base);
    let sum: f64 =
        term_powers().iter().zip(&curve.terms).map(|(p, c)| c * power(x, p[0]) * power(y, p[1]) * power(z, p[2])).sum();
    let (e, _) = curve.error([x * 6.0, 20.0 + 30.0 * y, 2.0 + z]);
    assert!((e - sum).abs() < 1e-14);
}

#[test]
fn an_impossible_curve_is_refused_by_name() {
    let mut curve = busy::<f32>(0.3);
    curve.hidden = 17;
    assert!(curve.checked().unwrap_err().to_string().starts_with("hidden = 17"));
    let mut curve = busy::<f32>(0.3);
    curve.high[1] = -10.0;
    assert_eq!(curve.checked().unwrap_err().field, "high");
    let mut curve = busy::<f32>(0.3);
    curve.output_weights[3] = f32::NAN;
    assert_eq!(curve.checked().unwrap_err().field, "output_weights");
    assert!(ErrorCurve::<f32>::line(0.0, 0.7, -1.0, 1.0).is_err());
    assert!(ErrorCurve::<f32>::line(0.0, 0.1, 1.0, 1.0).is_err());
}

#[test]
fn a_missing_measurement_stays_missing_and_a_filter_coasts_over_it() {
    let curve = busy::<f64>(0.4);
    let out = curve.correct(f64::INFINITY, [20.0, 2.0]);
    assert!(out.rate.is_nan() && out.flags == Flags::MISSING);
    let filter = Compensated { filter: Pt1::new(50.0, 5.0).unwrap(), curve };
    let mut state = filter.start();
    let nothing = filter.step(&mut state, Sample { value: f64::NAN, dt: 0.02 });
    assert_eq!(nothing.rate, 0.0);
    let first = filter.step(&mut state, Sample { value: 2.0, dt: 0.02 });
    let second = filter.step(&mut state, Sample { value: f64::NAN, dt: 0.02 });
    assert_eq!(first.rate, second.rate);
    assert!(second.flags.has(Flags::MISSING));
}

proptest! {
    #[test]
    fn the_slope_is_the_derivative(rate in -5.9_f64..5.9, t in -9.0_f64..49.0, seed in 0.0_f64..1.0) {
        let curve = busy::<f64>(seed);
        let e = |w| curve.error([w, t, 2.2]).0;
        let difference = (e(rate + 1e-5) - e(rate - 1e-5)) / 2e-5;
        // Central difference: truncation 1e-10, rounding 1e-16 / 1e-5.
        prop_assert!((difference - curve.slope([rate, t, 2.2])).abs() < 1e-8);
    }

    #[test]
    fn more_steps_solve_for_the_true_rate(rate in -5.0_f64..5.0, t in -9.0_f64..49.0) {
        let mut curve = ErrorCurve::line(0.03, 0.05, -6.0, 6.0).unwrap();
        curve.steps = 12;
        let measured = rate + curve.error([rate, t, 0.0]).0;
        // Contraction 0.05 to the power of 12.
        prop_assert!((curve.correct(measured, [t, 0.0]).rate - rate).abs() < 1e-14);
    }

    #[test]
    fn single_precision_follows_double(rate in -6.0_f64..6.0, seed in 0.0_f64..1.0) {
        let single = busy::<f32>(seed).correct(rate as f32, [25.0, 1.5]).rate;
        let double = busy::<f64>(seed).correct(rate, [25.0, 1.5]).rate;
        // Forty terms of magnitude below 0.1 and three steps, each rounded to 6e-8 of at most 6.
        prop_assert!((f64::from(single) - double).abs() < 3e-6);
    }

    #[test]
    fn any_input_gives_finite_output_or_a_missing_flag(rate in any::<f64>(), t in any::<f64>()) {
        let out = busy::<f64>(0.7).correct(rate, [t, 1.0]);
        prop_assert!(out.error.is_finite() && (out.rate.is_finite() || out.flags.has(Flags::MISSING)));
    }
}
