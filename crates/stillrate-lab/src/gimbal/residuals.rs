//! Tests of a filter's innovations: are they as large as it believes, and is each independent of the one before?
//!
//! Under a right model the normalised squares have mean 1 with deviation sqrt(2/n), and the correlation of neighbours is 0 with deviation
//! 1/sqrt(n); both are given in those deviations. A model error that the coefficients cannot absorb shows in one or both; one
//! they can absorb shows in neither, which is why the optional states exist. Divergence: a running mean of the normalised squares above 3
//! for more than 60 s.

use nalgebra::Vector3;
use stillrate::Real;
use stillrate::gimbal::window::against_model;
use stillrate::gimbal::{Coefficients, Geometry, Innovation, Linearisation, Model, Record, SPOILT_SIGMA};

/// Normalised innovations in time order.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Residuals {
    normalised: Vec<[f64; 3]>,
}

/// Result of the tests.
///
/// # Example
/// ```
/// use stillrate_lab::gimbal::ResidualTests;
/// let white = ResidualTests {
///     mean_square: 1.01,
///     mean_square_sigma: 0.7,
///     correlation: [0.01, -0.02, 0.0],
///     correlation_sigma: 1.2,
///     skipped: 0.0,
///     outliers: 0.001,
///     diverged: false,
/// };
/// assert!(!white.alarm());
/// assert!(ResidualTests { correlation_sigma: 8.0, ..white }.alarm()); // each residual knows the one before: something is not modelled
/// assert!(!ResidualTests { mean_square: 0.5, mean_square_sigma: -30.0, ..white }.alarm()); // too small is no harm
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResidualTests {
    /// Mean of the normalised squared innovations; 1 is right.
    pub mean_square: f64,
    /// How far it is from 1, in standard deviations.
    pub mean_square_sigma: f64,
    /// Correlation of neighbours, axis x, y, z.
    pub correlation: [f64; 3],
    /// The largest of the three in standard deviations.
    pub correlation_sigma: f64,
    /// Share of measurements that were not used.
    pub skipped: f64,
    /// Share of measurements beyond six deviations; they do not count in the tests above.
    pub outliers: f64,
    /// Whether the divergence rule fired.
    pub diverged: bool,
}

/// Window of the divergence rule, s.
const WINDOW_S: f64 = 10.0;
/// The running mean may stay above [`LIMIT`] this long, s.
const PATIENCE_S: f64 = 60.0;
const LIMIT: f64 = 3.0;
/// More outliers than this are not a matter of spikes: five per cent of spiked samples spoil about one window in a hundred.
const OUTLIERS_MAX: f64 = 0.02;
/// Deviations beyond which a test counts as failed: one false alarm in 3.5 million runs.
const ALARM_SIGMA: f64 = 5.0;

impl Residuals {
    /// Adds one epoch.
    pub(super) fn push(&mut self, innovations: &[Innovation; 3]) {
        self.normalised.push(innovations.map(|innovation| innovation.normalised()));
    }

    /// Residuals of a whole record against a solution (attitude at the start): unlike innovations they do not depend on the prior.
    pub(super) fn of_solution(model: &Model, record: &Record<'_>, solution: &Coefficients, robust: bool) -> Self {
        let geometry = Geometry::new(model, solution);
        let mut rotation = Linearisation::of(solution).rotation;
        let mut residuals = Self::default();
        for k in 0..record.epochs() {
            rotation = geometry.step(model, &rotation, &Vector3::from(record.command(k)), record.interval_s()).rotation;
            let measured = against_model(&geometry, model, record, k + 1, &rotation, robust);
            residuals.push(&core::array::from_fn(|axis| Innovation {
                value: measured.value[axis],
                variance: if measured.variance[axis].is_finite() { measured.variance[axis] } else { 0.0 },
            }));
        }
        residuals
    }

    /// Whether there is nothing to test.
    pub(super) fn is_empty(&self) -> bool {
        self.normalised.is_empty()
    }

    /// Runs the tests; `fitted` coefficients were taken out of the residuals (0 for innovations).
    pub(super) fn test(&self, interval_s: f64, fitted: usize) -> ResidualTests {
        let all = (self.normalised.len() * 3) as f64;
        // A few windows spoilt by spikes are not a wrong model; many are, and the share below says so.
        let calm = |x: &f64| x.abs() <= SPOILT_SIGMA;
        let present = self.normalised.iter().flatten().filter(|x| !x.is_nan()).count() as f64;
        let squares: Vec<f64> = self.normalised.iter().flatten().copied().filter(calm).map(|x| x * x).collect();
        let n = squares.len() as f64;
        let mean_square = squares.iter().sum::<f64>() / (n - fitted as f64).max(1.0);
        let mut correlation = [0.0; 3];
        let mut correlation_sigma = 0.0_f64;
        for axis in 0..3 {
            let (mut product, mut power, mut count) = (0.0, 0.0, 0.0);
            for pair in self.normalised.windows(2) {
                let (a, b) = (pair[0][axis], pair[1][axis]);
                if calm(&a) && calm(&b) {
                    product += a * b;
                    power += 0.5 * (a * a + b * b);
                    count += 1.0;
                }
            }
            correlation[axis] = if power > 0.0 { product / power } else { 0.0 };
            correlation_sigma = correlation_sigma.max(correlation[axis].abs() * f64::root(count));
        }
        ResidualTests {
            mean_square,
            mean_square_sigma: (mean_square - 1.0) * (n / 2.0).root(),
            correlation,
            correlation_sigma,
            skipped: 1.0 - present / all,
            outliers: 1.0 - n / present.max(1.0),
            diverged: self.diverges(interval_s),
        }
    }

    fn diverges(&self, interval_s: f64) -> bool {
        let window = ((WINDOW_S / interval_s) as usize).max(1);
        let patience = ((PATIENCE_S / interval_s) as usize).max(1);
        let epoch = |e: &[f64; 3]| e.iter().filter(|x| !x.is_nan()).fold((0.0, 0.0), |(s, c), x| (s + x * x, c + 1.0));
        let sums: Vec<(f64, f64)> = self.normalised.iter().map(epoch).collect();
        let mut above = 0;
        for part in sums.windows(window) {
            let (s, c) = part.iter().fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
            above = if s > LIMIT * c { above + 1 } else { 0 };
            if above > patience {
                return true;
            }
        }
        false
    }
}

impl ResidualTests {
    /// Whether a test failed: the model does not explain the record. Innovations that are too small raise no alarm: the on-line filter
    /// inflates its noise by design, and a noise figure that is too large only makes the deviations too large.
    #[must_use]
    pub fn alarm(&self) -> bool {
        self.diverged
            || self.outliers > OUTLIERS_MAX
            || !self.mean_square.is_finite()
            || self.mean_square_sigma > ALARM_SIGMA
            || self.correlation_sigma > ALARM_SIGMA
    }
}
