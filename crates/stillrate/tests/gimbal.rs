//! The gimbal's parts on their own: what is refused by name, commands and samples that cannot be used, other arrangements of axes.

use nalgebra::{Matrix3, Vector3};
use stillrate::Flags;
use stillrate::gimbal::coefficients::GYRO_BIAS;
use stillrate::gimbal::{
    COUNT, Coefficients, DEFAULT_SCALE, Estimator, FirstOrder, Gauge, Geometry, Innovation, JointFilter, Measurement,
    Model, Options, Record, Reference, Selection, Triads, TwoLoop,
};

const T_S: f64 = 0.25;
const RATE_RAD_S: f64 = 0.02;
/// The drift that a quarter of an hour shows best: that of gyro z.
const BIAS: usize = GYRO_BIAS + 2;

fn model() -> Model {
    Model::new(9.8, 0.7).unwrap()
}

fn selection() -> Selection<32> {
    Selection::new(Gauge::Accelerometer, Options::default()).unwrap()
}

fn estimator(walk: f64) -> Estimator<f64, 32> {
    Estimator::new(model(), selection(), &DEFAULT_SCALE, walk).unwrap()
}

fn joint(walk: f64) -> JointFilter<f64, 32> {
    JointFilter::new(estimator(walk), 5.0).unwrap()
}

/// Commands of a slow tumble and the samples of a head with a drift of gyro z, without noise.
fn tumble(epochs: usize, bias_rad_s: f64) -> (Vec<[f64; 3]>, Vec<[f64; 3]>, Coefficients) {
    let model = model();
    let mut truth = [0.0; COUNT];
    truth[BIAS] = bias_rad_s;
    let geometry = Geometry::new(&model, &truth);
    let mut rotation = Matrix3::identity();
    let (mut commands, mut samples) = (Vec::new(), vec![geometry.output(&model, &rotation)]);
    for k in 0..epochs {
        // Ten seconds at a time: where the command jumps, no window stands.
        let phase = 0.4 * (k / 40) as f64;
        let command = Vector3::new(RATE_RAD_S * phase.sin(), RATE_RAD_S * phase.cos(), 0.5 * RATE_RAD_S);
        commands.push(command.into());
        for part in 1..=5 {
            let turned = geometry.step(&model, &rotation, &command, T_S * f64::from(part) / 5.0).rotation;
            samples.push(geometry.output(&model, &turned));
        }
        rotation = geometry.step(&model, &rotation, &command, T_S).rotation;
    }
    (commands, samples, truth)
}

#[test]
fn a_command_that_cannot_be_used_is_replaced_by_the_last_good_one() {
    let filter = joint(0.0).with_command_max(0.1).unwrap();
    assert!(joint(0.0).with_command_max(0.0).is_err());
    let mut state = filter.start(&[0.0; COUNT]);
    assert_eq!(filter.advance(&mut state, [0.01, 0.0, 0.0], T_S), Flags::NONE);
    let known = state.command;
    let before = filter.standard_deviation(&state)[0];
    assert_eq!(filter.advance(&mut state, [f64::NAN, 0.0, 0.0], T_S), Flags::MISSING);
    assert_eq!(filter.advance(&mut state, [5.0, 0.0, 0.0], T_S), Flags::OUT_OF_RANGE);
    assert_eq!(state.command, known);
    assert!(filter.standard_deviation(&state)[0] > before, "the attitude is believed less");
    let here = state;
    for dt_s in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(filter.advance(&mut state, [0.01, 0.0, 0.0], dt_s), Flags::BAD_TIME);
    }
    assert_eq!(state, here, "no time passed");
    assert_eq!(state.time_s, 3.0 * T_S);
}

#[test]
fn a_measurement_is_taken_axis_by_axis() {
    let filter = joint(0.0);
    let mut state = filter.start(&[0.0; COUNT]);
    filter.advance(&mut state, [0.01, 0.0, 0.0], T_S);
    let variance = [1e-12; 3];
    let force = model().force(&state.rotation);
    let absurd = Measurement { value: [f64::NAN, 1e3, force[2]], variance };
    let innovations = filter.correct(&mut state, &absurd);
    assert_eq!((innovations[0], innovations[1]), (Innovation::default(), Innovation::default()));
    assert!(innovations[2].variance > 0.0 && innovations[2].normalised().abs() < 1.0, "{innovations:?}");
    assert!(Innovation::default().normalised().is_nan());
    let before = filter.standard_deviation(&state);
    filter.correct(&mut state, &Measurement { value: force.into(), variance });
    assert!(filter.standard_deviation(&state)[0] < before[0]);
}

#[test]
fn a_gyro_bias_is_found_with_either_reference_and_with_plain_windows() {
    let bias = 4e-7;
    let (commands, samples, truth) = tumble(1200, bias);
    let record = Record::new(&commands, &samples, T_S, 1e-6).unwrap();
    for (reference, plain) in [(Reference::Model, false), (Reference::Commanded, false), (Reference::Model, true)] {
        let mut filter = joint(0.0);
        if plain {
            filter.estimator = filter.estimator.with_plain_windows();
        }
        let mut state = filter.start(&[0.0; COUNT]);
        for k in 0..record.epochs() - 1 {
            filter.epoch(&mut state, &record, k, reference);
        }
        let (found, sigma) = (filter.attitude_and_coefficients(&state), filter.standard_deviation(&state));
        let off = (found[BIAS] - truth[BIAS]).abs();
        assert!(off < 3.0 * sigma[BIAS] && sigma[BIAS] < 0.5 * DEFAULT_SCALE[BIAS], "{reference:?}: {off}, {sigma:?}");
    }
}

#[test]
fn a_random_walk_of_the_attitude_leaves_less_certain_coefficients() {
    let (commands, samples, _) = tumble(100, 0.0);
    let record = Record::new(&commands, &samples, T_S, 1e-6).unwrap();
    let after = |walk: f64| {
        let filter = joint(walk);
        let mut state = filter.start(&[0.0; COUNT]);
        for k in 0..record.epochs() - 1 {
            filter.epoch(&mut state, &record, k, Reference::Model);
        }
        filter.standard_deviation(&state)
    };
    let (still, walking) = (after(0.0), after(1e-3));
    assert!(walking[0] > still[0] && walking[GYRO_BIAS] > still[GYRO_BIAS]);
    assert!(Estimator::<f64, 32>::new(model(), selection(), &DEFAULT_SCALE, -1.0).is_err());
}

#[test]
fn the_published_cut_off_drops_epochs_near_the_horizontal() {
    let (commands, samples, _) = tumble(4, 0.0);
    let record = Record::new(&commands, &samples, T_S, 1e-6).unwrap();
    let cutting = estimator(0.0).with_cut_off(0.1).unwrap();
    assert!(estimator(0.0).with_cut_off(-0.1).is_err());
    let none = [Innovation::default(); 3];
    let filter = JointFilter::new(cutting, 0.0).unwrap();
    assert_eq!(filter.epoch(&mut filter.start(&[0.0; COUNT]), &record, 0, Reference::Model), none);
    let single = FirstOrder { estimator: cutting };
    assert_eq!(single.epoch(&mut single.start(&[0.0; COUNT]), &record, 0), none);
    let whole = FirstOrder { estimator: estimator(0.0) };
    let mut state = whole.start(&[0.0; COUNT]);
    let before = whole.standard_deviation(&state);
    assert_ne!(whole.epoch(&mut state, &record, 0), none);
    assert!(whole.standard_deviation(&state)[0] < before[0]);
}

#[test]
fn a_correction_that_is_no_number_is_refused_and_the_doubt_begins_anew() {
    let filter = joint(0.0);
    let mut state = filter.start(&[0.0; COUNT]);
    let start = filter.standard_deviation(&state);
    filter.advance(&mut state, [0.01, 0.0, 0.0], T_S);
    // No sensor has a variance this small: the weight of the row overflows.
    let absurd = Measurement { value: [1.0, 9.0, 2.0], variance: [1e-320; 3] };
    filter.correct(&mut state, &absurd);
    assert!(state.coefficients.iter().all(|x| x.is_finite()) && state.rotation.iter().all(|x| x.is_finite()));
    assert!(
        filter
            .standard_deviation(&state)
            .iter()
            .zip(start)
            .all(|(now, before)| now.is_finite() && *now <= before * 1.001)
    );
}

#[test]
fn the_two_loops_run_with_plain_windows_too() {
    let (commands, samples, truth) = tumble(400, 1e-7);
    let record = Record::new(&commands, &samples, T_S, 1e-6).unwrap();
    let robust = TwoLoop::<f64>::new(model(), &DEFAULT_SCALE).unwrap();
    let plain = robust.with_plain_windows();
    let mut told = 0;
    let (found, deviation) = plain.two_stage(&record, &[0.0; COUNT], |_, _| told += 1);
    assert!(told > 0 && (found[BIAS] - truth[BIAS]).abs() < 3.0 * deviation[BIAS].max(1e-12));
    // Without a spike both kinds of window see the same line.
    let (other, _) = robust.two_stage(&record, &[0.0; COUNT], |_, _| {});
    assert!((other[BIAS] - found[BIAS]).abs() < 1e-9);
    let mut none = DEFAULT_SCALE;
    none[GYRO_BIAS] = 0.0;
    assert!(TwoLoop::<f64>::new(model(), &none).is_err());
}

#[test]
fn records_and_windows_fit_or_are_refused() {
    let (commands, samples, _) = tumble(4, 0.0);
    let record = Record::new(&commands, &samples, T_S, 1e-6).unwrap();
    assert_eq!((record.per_interval(), record.half_window(), record.sigma_m_s2()), (5, 2, 1e-6));
    assert_eq!(record.with_half_window(9).half_window(), 2, "no further than half way to the next epoch");
    for (commands, samples, dt_s, sigma, name) in [
        (&commands[..], &samples[..samples.len() - 1], T_S, 1e-6, "samples"),
        (&commands[..0], &samples[..], T_S, 1e-6, "samples"),
        (&commands[..], &samples[..], 0.0, 1e-6, "dt_s"),
        (&commands[..], &samples[..], T_S, f64::NAN, "sigma_m_s2"),
    ] {
        assert_eq!(Record::new(commands, samples, dt_s, sigma).unwrap_err().field, name);
    }
}

#[test]
fn places_scales_triads_and_capacities_out_of_range_are_refused_by_name() {
    assert_eq!(Model::new(9.8, 2.0).unwrap_err().field, "latitude_rad");
    assert_eq!(Model::new(0.0, 0.7).unwrap_err().field, "gravity_m_s2");
    let crossed = Triads { gyro: [[0, 1, 1], [1, 2, 0], [2, 0, 1]], ..Triads::default() };
    assert_eq!(crossed.check().unwrap_err().field, "gyro triads");
    let twice = Triads { accelerometer: [[0, 1, 2], [0, 2, 1], [2, 0, 1]], ..Triads::default() };
    assert_eq!(twice.check().unwrap_err().field, "accelerometer triads");
    assert_eq!(Selection::<8>::new(Gauge::None, Options::default()).unwrap_err().field, "coefficients");
    let mut scale = DEFAULT_SCALE;
    scale[GYRO_BIAS] = -1.0;
    let refused = Estimator::<f64, 32>::new(model(), selection(), &scale, 0.0).unwrap_err();
    assert_eq!(refused.field, stillrate::gimbal::NAMES[GYRO_BIAS]);
    assert!(JointFilter::new(estimator(0.0), -1.0).is_err());
}

#[test]
fn each_gauge_holds_three_angles_that_no_motion_separates() {
    let other = Triads { gyro: [[0, 2, 1], [1, 0, 2], [2, 1, 0]], accelerometer: [[0, 2, 1], [1, 0, 2], [2, 1, 0]] };
    for triads in [Triads::default(), other] {
        assert!(triads.check().is_ok());
        for gauge in [Gauge::Accelerometer, Gauge::Gyro] {
            let [a, b, c] = gauge.fixed(&triads).unwrap();
            assert!(a != b && b != c && a != c);
            let free = Selection::<32>::for_triads(gauge, Options::default(), &triads).unwrap();
            assert!([a, b, c].iter().all(|fixed| !free.indices().contains(fixed)));
        }
        assert_eq!(Gauge::None.fixed(&triads), None);
    }
    // The other order of the axes holds the other angle of instrument y.
    assert_ne!(Gauge::Gyro.fixed(&Triads::default()), Gauge::Gyro.fixed(&other));
}
