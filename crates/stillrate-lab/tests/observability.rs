//! The bench IMU in four attitudes: rank says little, the Riccati covariance says it all.

use stillrate_lab::observability::{Problem, Report, Segment, bench_imu, bench_measurement, observability};

const DEG: f64 = core::f64::consts::PI / 180.0;

fn bench(attitudes: usize) -> Report {
    let euler = [[0.0; 3], [0.0, 0.0, 180.0 * DEG], [90.0 * DEG, 0.0, 0.0], [0.0, 89.9 * DEG, 0.0]];
    let segment = |&angles: &[f64; 3]| Segment {
        dynamics: bench_imu(angles, 52.0 * DEG, 9.81),
        measurement: bench_measurement(),
        duration_s: 60.0,
    };
    let mut prior = vec![0.1; 3];
    prior.extend([1.0 * DEG, 1.0 * DEG, 5.0 * DEG]);
    prior.extend([100.0 * DEG / 3600.0; 3]);
    prior.extend([5e-3 * 9.81; 3]);
    // A good MEMS unit: 0.3 deg/sqrt(h), 0.06 m/s/sqrt(h).
    let mut density = vec![0.06 / 60.0; 3];
    density.extend([0.3 * DEG / 60.0; 3]);
    density.extend([0.0; 6]);
    observability(&Problem {
        segments: euler[..attitudes].iter().map(segment).collect(),
        interval_s: 0.1,
        measurement_sigma: vec![0.01; 3],
        prior_sigma: prior,
        process_density: density,
    })
    .unwrap()
}

#[test]
fn full_rank_is_not_usefulness() {
    let one = bench(1);
    assert_eq!((one.local_ranks.as_slice(), one.stacked_ranks.as_slice()), ([9].as_slice(), [9].as_slice()));
    let two = bench(2);
    assert_eq!(two.stacked_ranks, [9, 12]);
    assert_eq!(two.gramian_eigenvalues.iter().filter(|&&gain| gain > 1.0).count(), 11);
    // The vertical gyro bias is "observable" after the yaw turn, and has kept nearly all its prior.
    assert!(two.riccati_over_prior[8] > 0.9, "{:?}", two.riccati_over_prior);
    assert!(two.weak_directions.iter().any(|weak| weak.components[8].abs() > 0.5));
}

#[test]
fn a_roll_shows_the_vertical_bias_and_process_noise_is_not_optional() {
    let three = bench(3);
    assert!(three.riccati_over_prior[8] < 0.1 && three.tenth_of_prior_s[8] > 120.0);
    // Without process noise heading seems known a hundred times better than it is.
    assert!(three.posterior_over_prior[5] < 0.1 * three.riccati_over_prior[5]);
}

#[test]
fn raw_singular_values_depend_on_units_and_scaled_ones_do_not() {
    let mut problem = Problem {
        segments: vec![Segment {
            dynamics: bench_imu([0.0; 3], 0.9, 9.81),
            measurement: bench_measurement(),
            duration_s: 10.0,
        }],
        interval_s: 0.1,
        measurement_sigma: vec![0.01; 3],
        prior_sigma: vec![0.1; 12],
        process_density: vec![1e-3; 12],
    };
    let si = observability(&problem).unwrap();
    // The same system with the gyro biases in deg/h.
    let unit = DEG / 3600.0;
    for k in 6..9 {
        problem.segments[0].dynamics.column_mut(k).scale_mut(unit);
        problem.segments[0].measurement.column_mut(k).scale_mut(unit);
        problem.prior_sigma[k] /= unit;
        problem.process_density[k] /= unit;
    }
    let degrees = observability(&problem).unwrap();
    let close = |a: &[f64], b: &[f64], tolerance: f64| {
        a.iter().zip(b).all(|(x, y)| (x - y).abs() <= tolerance * a[0].abs().max(a[a.len() - 1].abs()))
    };
    let scaled = (&si.stacked_singular_values_scaled, &degrees.stacked_singular_values_scaled);
    assert!(close(scaled.0, scaled.1, 1e-12));
    assert!(close(&si.riccati_over_prior, &degrees.riccati_over_prior, 1e-9));
    assert!(!close(&si.stacked_singular_values, &degrees.stacked_singular_values, 1e-3));
}

#[test]
fn shapes_and_signs_that_do_not_fit_are_named() {
    let good = Problem {
        segments: vec![Segment {
            dynamics: bench_imu([0.0; 3], 0.9, 9.81),
            measurement: bench_measurement(),
            duration_s: 1.0,
        }],
        interval_s: 0.1,
        measurement_sigma: vec![0.01; 3],
        prior_sigma: vec![0.1; 12],
        process_density: vec![0.0; 12],
    };
    let field = |problem: Problem| observability(&problem).unwrap_err().field;
    assert_eq!(field(Problem { prior_sigma: vec![0.1; 11], ..good.clone() }), "process_density length");
    assert_eq!(field(Problem { interval_s: 0.0, ..good.clone() }), "interval_s");
    assert_eq!(field(Problem { measurement_sigma: vec![0.1], ..good.clone() }), "measurement_sigma length");
    assert_eq!(field(Problem { segments: vec![], ..good.clone() }), "segments");
    let mut broken = good;
    broken.segments[0].dynamics[(0, 0)] = f64::NAN;
    assert_eq!(field(broken), "A or H");
}
