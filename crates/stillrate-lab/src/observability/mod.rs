//! What a motion lets a filter see: observability of a piecewise constant linear system.
//!
//! In segment j the state follows x' = A_j x and is measured as z = H_j x every `interval_s`. Four answers, from the crudest to the one that counts:
//!
//! * local matrices O_j = [H; HA; ...; HA^(n-1)], their stack (SOM) and the stack propagated through the segments
//!   (TOM): ranks and singular values (Goshen-Meskin and Bar-Itzhack, IEEE T-AES 28, 1992);
//! * the Gramian W = sum F' H' R^-1 H F, scaled by the prior: which directions gain;
//! * the posterior (P0^-1 + W)^-1, without process noise;
//! * the Riccati covariance with process noise, over the prior, state by state.
//!
//! Three lessons are built in. Raw singular values depend on the units: use the prior-scaled ones. Full rank is not usefulness: a
//! heading bias can be "observable" and keep 99 % of its prior. A Gramian without process noise is over-optimistic.

mod bench;
mod matrix;
mod riccati;
mod stacked;

pub use bench::{BENCH_STATES, bench_imu, bench_measurement};
pub use matrix::exponential;

use nalgebra::DMatrix;
use stillrate::ConfigError;

/// One stretch of constant A and H.
///
/// # Example
/// ```
/// use stillrate_lab::observability::{Segment, bench_imu, bench_measurement};
/// // A minute level, a minute on the right side.
/// let minute = |roll| Segment { dynamics: bench_imu([roll, 0.0, 0.0], 0.8, 9.81), measurement: bench_measurement(), duration_s: 60.0 };
/// let turned = [minute(0.0), minute(core::f64::consts::FRAC_PI_2)];
/// // Level, accelerometer z feels what points down; on the side, y does.
/// assert_eq!(turned[0].dynamics[(2, 11)], 1.0);
/// assert_eq!(turned[1].dynamics[(2, 10)], 1.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// A, n by n, 1/s.
    pub dynamics: DMatrix<f64>,
    /// H, m by n.
    pub measurement: DMatrix<f64>,
    /// How long it lasts, s.
    pub duration_s: f64,
}

/// A system, its measurements and what is known beforehand.
///
/// # Example
/// ```
/// use nalgebra::DMatrix;
/// use stillrate_lab::observability::{Problem, Segment, observability};
/// let mut constant = Problem {
///     segments: vec![Segment { dynamics: DMatrix::zeros(1, 1), measurement: DMatrix::identity(1, 1), duration_s: 9.9 }],
///     interval_s: 0.1,
///     measurement_sigma: vec![1.0],
///     prior_sigma: vec![1.0],
///     process_density: vec![0.0],
/// };
/// // 99 measurements and the prior, each of variance 1: a hundredth of it is left.
/// assert!((observability(&constant)?.riccati_over_prior[0] - 0.1).abs() < 1e-12);
/// constant.process_density[0] = 1.0;
/// assert!(observability(&constant)?.riccati_over_prior[0] > 0.3); // what walks is never known that well
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// The stretches, in order.
    pub segments: Vec<Segment>,
    /// Time between measurements, s; the first comes one interval after the start.
    pub interval_s: f64,
    /// Standard deviation of each row of the measurement.
    pub measurement_sigma: Vec<f64>,
    /// Standard deviation of each state beforehand.
    pub prior_sigma: Vec<f64>,
    /// Process noise density of each state, unit of the state per sqrt(s).
    pub process_density: Vec<f64>,
}

/// A direction in state space that the measurements leave uncertain.
///
/// # Example
/// Only the sum of two biases is measured:
/// ```
/// use nalgebra::DMatrix;
/// use stillrate_lab::observability::{Problem, Segment, observability};
/// let sum = DMatrix::from_row_slice(1, 2, &[1.0, 1.0]);
/// let report = observability(&Problem {
///     segments: vec![Segment { dynamics: DMatrix::zeros(2, 2), measurement: sum, duration_s: 10.0 }],
///     interval_s: 0.1,
///     measurement_sigma: vec![0.01],
///     prior_sigma: vec![1.0; 2],
///     process_density: vec![0.0; 2],
/// })?;
/// let weak = &report.weak_directions[0];
/// assert!((weak.over_prior - 1.0).abs() < 1e-12); // their difference keeps all of its prior
/// assert!((weak.components[0] + weak.components[1]).abs() < 1e-12);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct WeakDirection {
    /// Standard deviation after over before, along it.
    pub over_prior: f64,
    /// Its components in units of the prior standard deviations.
    pub components: Vec<f64>,
}

/// What [`observability`] found. `riccati_over_prior` is the answer, ranks are a side note.
///
/// # Example
/// ```
/// use stillrate_lab::observability::{Problem, Segment, bench_imu, bench_measurement, observability};
/// let level = Segment { dynamics: bench_imu([0.0; 3], 0.8, 9.81), measurement: bench_measurement(), duration_s: 60.0 };
/// let report = observability(&Problem {
///     segments: vec![level],
///     interval_s: 0.5,
///     measurement_sigma: vec![0.01; 3],
///     prior_sigma: [[0.1; 3], [0.02; 3], [5e-4; 3], [0.05; 3]].concat(),
///     process_density: vec![0.0; 12],
/// })?;
/// // At rest in one attitude nine of twelve are "observable", but a tilt and the accelerometer bias that looks like it stay.
/// assert_eq!((report.total_rank, report.weak_directions.len() > 2), (9, true));
/// assert!(report.riccati_over_prior[9] > 0.3);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Rank of each O_j, prior-scaled.
    pub local_ranks: Vec<usize>,
    /// Rank of the SOM after each segment, prior-scaled.
    pub stacked_ranks: Vec<usize>,
    /// Singular values of the SOM in the units of the states, descending.
    pub stacked_singular_values: Vec<f64>,
    /// The same, prior-scaled.
    pub stacked_singular_values_scaled: Vec<f64>,
    /// Singular values of the TOM, prior-scaled, descending.
    pub total_singular_values_scaled: Vec<f64>,
    /// Rank of the TOM, prior-scaled.
    pub total_rank: usize,
    /// W, referred to the start.
    pub gramian: DMatrix<f64>,
    /// Eigenvalues of P0^1/2 W P0^1/2, ascending: above 1 the data says more than the prior.
    pub gramian_eigenvalues: Vec<f64>,
    /// Standard deviations of the start state from prior and Gramian, no process noise.
    pub posterior_sigma: Vec<f64>,
    /// The same over the prior.
    pub posterior_over_prior: Vec<f64>,
    /// Standard deviations at the end from the Riccati recursion with process noise, over the prior.
    pub riccati_over_prior: Vec<f64>,
    /// When each state first fell to a tenth of its prior, s; NaN for never.
    pub tenth_of_prior_s: Vec<f64>,
    /// Directions that keep more than half their prior at the end, weakest first.
    pub weak_directions: Vec<WeakDirection>,
}

/// Singular values below this share of the largest count as zero.
pub const RANK_TOLERANCE: f64 = 1e-12;

/// Ranks, Gramian and Riccati covariance of a piecewise constant system.
///
/// # Errors
/// [`ConfigError`] where shapes do not fit, or a number is not finite or has the wrong sign.
///
/// # Example
/// A rate that is the derivative of a measured angle, and a second one that nothing shows:
/// ```
/// use nalgebra::DMatrix;
/// use stillrate_lab::observability::{Problem, Segment, observability};
/// let dynamics = DMatrix::from_row_slice(3, 3, &[0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
/// let measurement = DMatrix::from_row_slice(1, 3, &[1.0, 0.0, 0.0]);
/// let report = observability(&Problem {
///     segments: vec![Segment { dynamics, measurement, duration_s: 10.0 }],
///     interval_s: 0.1,
///     measurement_sigma: vec![0.01],
///     prior_sigma: vec![1.0; 3],
///     process_density: vec![0.0; 3],
/// })?;
/// assert_eq!(report.stacked_ranks, [2]);
/// assert_eq!(report.weak_directions.len(), 1);
/// assert!((report.riccati_over_prior[2] - 1.0).abs() < 1e-12);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
pub fn observability(problem: &Problem) -> Result<Report, ConfigError> {
    check(problem)?;
    let stacked = stacked::stacked(problem);
    let gramian = stacked::gramian(problem);
    let prior = &problem.prior_sigma;
    let information = matrix::scaled(&gramian, prior);
    let (values, vectors) = matrix::eigen(&information);
    let posterior_over_prior = matrix::diagonal_of(&vectors, &values, |value| 1.0 / (1.0 + value.max(0.0)));
    let riccati = riccati::run(problem);
    Ok(Report {
        local_ranks: stacked.local_ranks,
        stacked_ranks: stacked.ranks,
        stacked_singular_values: stacked.raw,
        stacked_singular_values_scaled: stacked.scaled,
        total_rank: matrix::rank(&stacked.total, RANK_TOLERANCE),
        total_singular_values_scaled: stacked.total,
        gramian,
        gramian_eigenvalues: values,
        posterior_sigma: posterior_over_prior.iter().zip(prior).map(|(ratio, sigma)| ratio * sigma).collect(),
        posterior_over_prior,
        riccati_over_prior: riccati.over_prior,
        tenth_of_prior_s: riccati.tenth_of_prior_s,
        weak_directions: riccati.weak_directions,
    })
}

fn check(problem: &Problem) -> Result<(), ConfigError> {
    let n = problem.prior_sigma.len();
    if n == 0 || n > 200 {
        return Err(ConfigError::new("prior_sigma length", n as f64, "", "one entry a state, 1 to 200 states"));
    }
    if problem.segments.is_empty() {
        return Err(ConfigError::new("segments", 0.0, "", "at least 1"));
    }
    let fits = |name, length: usize, expected: usize, range| {
        if length == expected { Ok(()) } else { Err(ConfigError::new(name, length as f64, "", range)) }
    };
    fits("process_density length", problem.process_density.len(), n, "one entry a state")?;
    for &sigma in &problem.prior_sigma {
        stillrate::error::positive("prior_sigma", sigma, "")?;
    }
    for &density in &problem.process_density {
        stillrate::error::not_negative("process_density", density, "per sqrt(s)")?;
    }
    for &sigma in &problem.measurement_sigma {
        stillrate::error::positive("measurement_sigma", sigma, "")?;
    }
    let interval = stillrate::error::positive("interval_s", problem.interval_s, "s")?;
    let mut steps = 0.0;
    for segment in &problem.segments {
        fits("A rows", segment.dynamics.nrows(), n, "the number of states")?;
        fits("A columns", segment.dynamics.ncols(), n, "the number of states")?;
        fits("H columns", segment.measurement.ncols(), n, "the number of states")?;
        let rows = segment.measurement.nrows();
        fits("measurement_sigma length", problem.measurement_sigma.len(), rows, "one entry a row of H")?;
        for &entry in segment.dynamics.iter().chain(segment.measurement.iter()) {
            if !entry.is_finite() {
                return Err(ConfigError::new("A or H", entry, "", "finite"));
            }
        }
        steps += stillrate::error::positive("duration_s", segment.duration_s, "s")? / interval;
    }
    // A bound on the work, not on the mathematics.
    if steps > 1e7 {
        return Err(ConfigError::new("duration_s / interval_s", steps, "", "at most 1e7 in total"));
    }
    Ok(())
}

/// Measurements in a segment: one each interval, the last at its end.
fn steps_of(segment: &Segment, interval_s: f64) -> usize {
    ((segment.duration_s / interval_s).round() as usize).max(1)
}
