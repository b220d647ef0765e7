//! Parts on their own: states as numbers, an on-line autoregressive fit, a filter with an error curve, rotations between frames.

use nalgebra::{Matrix3, Vector3};
use stillrate::attitude::reference_bias::BiasSettings;
use stillrate::attitude::{Body, Navigation, Quaternion, Rotation, dcm, preintegration::Preintegration, so3};
use stillrate::correction::{Compensated, CompensatedState, ErrorCurve};
use stillrate::filters::{
    MsImmIkfSettings, OnlineAr, Pt1, Pt1State, SingerImmKfSettings, VectorRls, VectorRlsSettings, VectorRlsState,
};
use stillrate::{Filter, Flags, GyroNoise, Lane, Real, Reals, Sample, Settings, block};

/// What a state is as numbers, and the same state from them.
fn through_numbers<T: Real, S: Reals<T>>(state: &S) -> (Vec<T>, S) {
    let mut numbers = Vec::new();
    state.scatter(&mut |number: T| numbers.push(number));
    assert_eq!(numbers.len(), S::COUNT);
    let mut next = numbers.clone().into_iter();
    let again = S::gather(&mut || next.next().unwrap());
    (numbers, again)
}

#[test]
fn every_state_is_its_numbers_and_nothing_else() {
    let lanes = [Lane([1.0_f64]), Lane([2.0])];
    assert_eq!(through_numbers::<f64, _>(&lanes), (vec![1.0, 2.0], lanes));
    let state = CompensatedState { filter: Pt1State { level: 1.0_f32, started: 1.0 }, others: [20.0, 0.5] };
    assert_eq!(through_numbers(&state), (vec![1.0, 1.0, 20.0, 0.5], state));
    let rls = VectorRls::<f64, 2>::new(VectorRlsSettings::default()).unwrap();
    let mut state = rls.start();
    rls.step(&mut state, [1.0, 0.5], 3.0);
    let (numbers, again): (_, VectorRlsState<f64, 2>) = through_numbers(&state);
    assert_eq!((numbers.len(), again), (8, state));
}

#[test]
fn numbers_survive_as_little_endian_bytes() {
    for value in [0.0, -0.0, 1.5, -1e-300, f64::INFINITY] {
        let back = <f64 as Real>::from_little_endian(value.to_little_endian());
        assert_eq!(back.to_bits(), value.to_bits());
        let narrow = value as f32;
        assert_eq!(<f32 as Real>::from_little_endian(narrow.to_little_endian()).to_bits(), narrow.to_bits());
    }
    assert_eq!((1.0_f32.to_little_endian(), <f32 as Real>::BYTES), ([0, 0, 0x80, 0x3f, 0, 0, 0, 0], 4));
}

#[test]
fn a_block_without_room_for_the_state_leaves_everything_alone() {
    const UNTOUCHED: ([[f64; 4]; 1], [[f64; 4]; 1]) = ([[7.0; 4]; 1], [[1.0; 4]]);
    let (mut lanes, mut tile) = UNTOUCHED;
    block::step_rows(&Pt1::<f64>::new(50.0, 8.0).unwrap(), &mut lanes, &mut tile, 0.02);
    assert_eq!((lanes, tile), UNTOUCHED);
    let noise = GyroNoise::from_density_two_sided(0.015);
    macro_rules! every {
        ($($name:ident),* $(,)?) => { $(
            let filter = stillrate::filters::$name::defaults(50.0, noise).build::<f64>().unwrap();
            filter.tile(&mut lanes, &mut tile, 0.02);
            assert_eq!((lanes, tile), UNTOUCHED, stringify!($name));
        )* };
    }
    stillrate::methods!(every);
    // A channel beyond the width reads as nothing seen yet.
    assert_eq!(block::load::<f64, [f64; 1], 4>(&lanes, 9), [0.0]);
}

#[test]
fn an_on_line_autoregressive_fit_waits_for_samples_in_a_row() {
    let fit = OnlineAr::<f64, 2>::new(VectorRlsSettings::default()).unwrap();
    let mut state = fit.start();
    let (mut newer, mut older) = (1.0, 0.0);
    for k in 0..400 {
        let estimate = fit.step(&mut state, newer);
        assert_eq!(estimate.flags.has(Flags::NO_DATA_YET), k < 2, "sample {k}");
        assert!(k < 300 || estimate.innovation.abs() < 1e-3, "sample {k}: {estimate:?}");
        (newer, older) = (1.6 * newer - 0.99 * older, newer);
    }
    let known = state.rls.weights;
    assert!((known[0] - 1.6).abs() < 1e-3 && (known[1] + 0.99).abs() < 1e-3, "{known:?}");
    assert_eq!(fit.step(&mut state, f64::NAN).flags, Flags::MISSING);
    for _ in 0..2 {
        assert_eq!(fit.step(&mut state, 1.0).flags, Flags::NO_DATA_YET);
    }
    assert_eq!(state.rls.weights, known, "nothing is learnt across a gap");
    assert!(OnlineAr::<f64, 2>::new(VectorRlsSettings { forgetting_factor: 0.0, ..Default::default() }).is_err());
}

#[test]
fn a_fit_of_order_nought_predicts_nothing_and_does_not_panic() {
    let fit = OnlineAr::<f64, 0>::new(VectorRlsSettings::default()).unwrap();
    let mut state = fit.start();
    for value in [1.0, 2.0] {
        assert_eq!(fit.step(&mut state, value).innovation, value);
    }
}

#[test]
fn least_squares_keeps_its_state_when_a_sample_is_absurd() {
    let rls = VectorRls::<f32, 2>::new(VectorRlsSettings::default()).unwrap();
    let mut state = rls.start();
    rls.step(&mut state, [1.0, 0.5], 3.0);
    let before = state;
    let estimate = rls.step(&mut state, [1e19, -1e19], 1.0); // phi' P phi is beyond f32
    assert_eq!(estimate.flags, Flags::OUT_OF_RANGE, "{estimate:?}");
    assert_eq!(state, before);
}

#[test]
fn a_compensated_filter_is_that_filter_less_its_error() {
    let filter = SingerImmKfSettings::defaults(50.0, GyroNoise::from_density_two_sided(0.015)).build::<f64>().unwrap();
    let curve = ErrorCurve::line(0.03, 0.01, -6.0, 6.0).unwrap();
    let compensated = Compensated { filter, curve };
    assert_eq!((compensated.period(), compensated.models()), (0.02, 2));
    let (mut plain, mut state) = (filter.start(), compensated.start());
    assert_eq!(compensated.step(&mut state, Sample { value: f64::NAN, dt: 0.02 }).rate, 0.0, "no data, no correction");
    for k in 0..100 {
        let sample = Sample { value: 5.0 * (0.1 * f64::from(k)).sine_cosine().0, dt: 0.02 };
        let (raw, corrected) = (filter.step(&mut plain, sample), compensated.step(&mut state, sample));
        // w = y - e(w) with e = 0.03 + 0.01 w.
        assert!((corrected.rate - (raw.rate - 0.03) / 1.01).abs() < 1e-5, "sample {k}");
        assert_eq!(corrected.variance, raw.variance);
    }
}

#[test]
fn a_filter_says_how_many_models_it_has() {
    let noise = GyroNoise::from_density_two_sided(0.015);
    let bank = MsImmIkfSettings::defaults(50.0, noise);
    assert_eq!(bank.build::<f64>().unwrap().models(), 1 + 4 + 4);
    let light = MsImmIkfSettings { oscillator_count: 0, bandwidth_hz: 10.0, ..bank };
    // Rungs at 32 Hz lie above the bandwidth; the widest stays.
    assert_eq!(light.build::<f64>().unwrap().models(), 1 + 3);
    assert_eq!(Pt1::<f64>::new(50.0, 8.0).unwrap().models(), 1);
}

#[test]
fn a_rotation_is_the_same_in_every_form() {
    let turn = Rotation::<f64, Body, Navigation>::from_euler(0.3, -0.4, 2.0);
    let back = Rotation::<f64, Body, Navigation>::from_quaternion(&turn.quaternion());
    assert!((turn.matrix() - back.matrix()).amax() < 1e-15);
    let [w, x, y, z] = {
        let q = turn.quaternion();
        [q.w, q.x, q.y, q.z]
    };
    assert_eq!(Quaternion::checked([w, x, y, z]).unwrap().matrix(), turn.quaternion().matrix());
    assert_eq!(Rotation::<f64, Body, Navigation>::checked(*turn.matrix()).unwrap(), turn);
    let rounded = turn.matrix().map(|entry| (entry * 1e4).round() / 1e4);
    assert!(Rotation::<f64, Body, Navigation>::checked(rounded).is_err());
    let projected = Rotation::<f64, Body, Navigation>::projected(rounded).unwrap();
    assert!((projected.inverse() * turn).log().amax() < 1e-4);
    let mirrored = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -1.0));
    assert!(dcm::check_dcm(&mirrored).unwrap_err().to_string().contains("reflection"));
}

#[test]
fn the_right_jacobian_and_its_inverse_undo_each_other_at_any_angle() {
    for angle in [0.0, 1e-9, 1e-3, 0.0999, 0.1001, 1.0, 3.0, 6.0] {
        let v = Vector3::new(0.6, -0.64, 0.48) * angle;
        let product = so3::right_jacobian(&v) * so3::right_jacobian_inverse(&v);
        assert!((product - Matrix3::identity()).amax() < 1e-13, "{angle}");
        let (turn, jacobian) = so3::exp_with_jacobian(&v);
        assert_eq!((turn, jacobian), (so3::exp(&v), so3::right_jacobian(&v)));
        let u = Vector3::new(0.2, 1.0, -0.3);
        assert_eq!(so3::cross_matrix(&v) * u, v.cross(&u));
    }
}

#[test]
fn an_empty_stretch_of_rates_turns_nothing() {
    let nothing = Preintegration::<f64>::default();
    assert_eq!((nothing.rotation, nothing.time_s), (Matrix3::identity(), 0.0));
    assert_eq!(nothing.bias_jacobian, Matrix3::zeros());
}

#[test]
fn settings_of_a_reference_bias_out_of_range_are_refused_by_name() {
    let good = BiasSettings::default();
    assert!(good.check().is_ok());
    for (bad, name) in [
        (BiasSettings { reference_sigma_rad: 1.5, ..good }, "reference_sigma_rad"),
        (BiasSettings { angle_random_walk_rad_sqrt_s: 0.0, ..good }, "angle_random_walk_rad_sqrt_s"),
        (BiasSettings { prior_lag_s: f64::NAN, ..good }, "prior_lag_s"),
        (BiasSettings { tolerance: -1.0, ..good }, "tolerance"),
        (BiasSettings { max_iterations: 0, ..good }, "max_iterations"),
        (BiasSettings { max_iterations: 1001, ..good }, "max_iterations"),
    ] {
        assert_eq!(bad.check().unwrap_err().field, name);
    }
}
