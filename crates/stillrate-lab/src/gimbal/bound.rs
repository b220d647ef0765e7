//! Everything a record can say about the coefficients, linearised: sensitivities, Cramer-Rao bound, singular values, weak directions.
//!
//! J stacks, for every usable epoch and accelerometer, H_psi [Phi_t, B_t] + H_theta, scaled by the prior deviations and
//! whitened. R of its QR factorisation gives bound sqrt(diag((R^T R)^-1)) and, by singular values, the directions a trajectory leaves weak:
//! with twelve mounting angles and three attitudes free, three of them (a common rotation) are zero for any motion.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use stillrate::Real;
use stillrate::gimbal::coefficients::G_INPUT;
use stillrate::gimbal::window::KINK_RAD_S;
use stillrate::gimbal::{COUNT, Coefficients, Geometry, Linearisation, Model, NAMES, Record};

use super::score::KAPPA;
use super::triangle::Triangle;

/// Derivatives of the three outputs at one epoch by attitude at the start and coefficients: SI units, one row an accelerometer.
pub type Sensitivity = [[f64; COUNT]; 3];

/// Walks along the model trajectory and hands out predicted outputs (m/s^2), attitude and sensitivities at epochs 0..=n.
///
/// # Example
/// ```
/// use stillrate::gimbal::{COUNT, Model, coefficients::GYRO_BIAS};
/// use stillrate_lab::gimbal::sensitivities;
/// let model = Model { earth_rate_rad_s: 0.0, ..Model::new(9.8, 0.7)? };
/// let mut seen = Vec::new();
/// sensitivities(&model, &[0.0; COUNT], &[[0.0; 3]; 40], 0.25, |_, _, _, _, rows| seen.push(rows[2][GYRO_BIAS]));
/// // A drift about x tilts the level platform for 10 s, and accelerometer z feels g times the angle.
/// assert!(seen.len() == 41 && (seen[40] + 9.8 * 10.0).abs() < 1e-9);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
pub fn sensitivities(
    model: &Model,
    coefficients: &Coefficients,
    commands: &[[f64; 3]],
    interval_s: f64,
    mut visit: impl FnMut(usize, &Geometry, &Matrix3<f64>, &[f64; 3], &Sensitivity),
) {
    let point = Linearisation::of(coefficients);
    let geometry = Geometry::new(model, coefficients);
    let mut rotation = point.rotation;
    let mut carried = [[0.0; 3]; COUNT];
    for axis in 0..3 {
        carried[axis][axis] = 1.0;
    }
    let mut rate = geometry.rate(
        &geometry.commanded_rate(&Vector3::from(commands.first().copied().unwrap_or_default())),
        &model.force(&rotation),
    );
    for k in 0..=commands.len() {
        let force = model.force(&rotation);
        let force_rate = geometry.force_rate(model, &rotation, &rate);
        let mut value = [0.0; 3];
        let mut rows = [[0.0; COUNT]; 3];
        for axis in 0..3 {
            let (predicted, row) = geometry.output_row(axis, &force, &force_rate);
            value[axis] = predicted;
            for i in 0..COUNT {
                let tilt = row[0] * carried[i][0] + row[1] * carried[i][1] + row[2] * carried[i][2];
                rows[axis][i] = tilt + if i < 3 { 0.0 } else { row[i] };
            }
        }
        visit(k, &geometry, &rotation, &value, &rows);
        if let Some(command) = commands.get(k) {
            let command = Vector3::from(*command);
            let step = geometry.step(model, &rotation, &command, interval_s);
            let turning = geometry.turning(model, &step, &command, interval_s);
            for (column, added) in carried.iter_mut().zip(&turning) {
                let turned = step.transition * Vector3::from(*column) + Vector3::from(*added);
                *column = turned.into();
            }
            rotation = step.rotation;
            rate = step.rate;
        }
    }
}

/// What a trajectory can determine.
///
/// # Example
/// Standing still shows little:
/// ```
/// use stillrate::gimbal::{DEFAULT_SCALE, Model, NAMES};
/// use stillrate_lab::gimbal::{Sampling, Settings, bound};
/// let settings = Settings::new(Model::new(9.8, 0.7)?);
/// let still = [[0.0; 3]; 400];
/// let bound = bound(&settings.model, &[0.0; 41], &DEFAULT_SCALE, &settings.indices()?, &still, &Sampling::default());
/// let lost = bound.unobservable(&DEFAULT_SCALE);
/// assert!(lost.len() > 20 && lost.iter().any(|&i| NAMES[i] == "ka1x")); // no gravity along x, no scale error of x
/// let (singular_value, _) = bound.weakest(1)[0];
/// assert!(singular_value < 1e-6);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    /// Cramer-Rao bound (1 sigma, no prior) of every coefficient, SI; NaN where not among the estimated.
    pub deviation: Coefficients,
    /// Singular values of the scaled, whitened sensitivity, largest first.
    pub singular_values: Vec<f64>,
    /// Right singular vectors of the same order, one row each, over the estimated coefficients.
    pub directions: Vec<Vec<f64>>,
    /// The estimated coefficients.
    pub indices: Vec<usize>,
    /// Bound of kappa, the mean of the three kgI.
    pub kappa_deviation: f64,
    /// Bound of each kgI less their mean.
    pub without_kappa: [f64; 3],
}

/// Bound of the coefficients `indices` from the R of their whitened, scaled rows.
fn from_root(root: &DMatrix<f64>, indices: &[usize], scale: &Coefficients) -> Bound {
    let n = indices.len();
    let mut deviation = [f64::NAN; COUNT];
    let inverse = root.clone().solve_upper_triangular(&DMatrix::identity(n, n));
    let mut kappa_deviation = f64::NAN;
    let mut without_kappa = [f64::NAN; 3];
    if let Some(inverse) = inverse {
        for (at, &index) in indices.iter().enumerate() {
            deviation[index] = inverse.row(at).dot(&inverse.row(at)).root() * scale[index];
        }
        let mut kappa = DVector::zeros(n);
        for (at, &index) in indices.iter().enumerate() {
            if KAPPA.contains(&index) {
                kappa += inverse.row(at).transpose() * (scale[index] / 3.0);
            }
        }
        kappa_deviation = kappa.dot(&kappa).root();
        for (at, &index) in indices.iter().enumerate() {
            if KAPPA.contains(&index) {
                let rest = inverse.row(at).transpose() * scale[index] - &kappa;
                without_kappa[index - G_INPUT] = rest.dot(&rest).root();
            }
        }
    }
    let svd = root.clone().svd(false, true);
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| svd.singular_values[b].total_cmp(&svd.singular_values[a]));
    let singular_values = order.iter().map(|&i| svd.singular_values[i]).collect();
    let directions =
        svd.v_t.map(|v| order.iter().map(|&i| v.row(i).iter().copied().collect()).collect()).unwrap_or_default();
    Bound { deviation, singular_values, directions, indices: indices.to_vec(), kappa_deviation, without_kappa }
}

/// Variance factor of the measurement at an epoch for a full record; nothing where a window is skipped.
fn variance_factor(half: usize, last: bool) -> f64 {
    let range = if last { -(half as i64)..=0 } else { -(half as i64)..=half as i64 };
    let (mut s0, mut s1, mut s2) = (0.0, 0.0, 0.0);
    for j in range {
        s0 += 1.0;
        s1 += j as f64;
        s2 += (j * j) as f64;
    }
    if half == 0 { 1.0 } else { s2 / (s0 * s2 - s1 * s1) }
}

/// How the measurements of a run come about.
///
/// # Example
/// ```
/// use stillrate::gimbal::{DEFAULT_SCALE, Model};
/// use stillrate_lab::gimbal::{Sampling, Settings, Trajectory, bound};
/// let settings = Settings::new(Model::new(9.8, 0.7)?);
/// let commands = Trajectory::default().commands(&settings.model)?;
/// let drift = |sampling: Sampling| -> Result<f64, stillrate::ConfigError> {
///     Ok(bound(&settings.model, &[0.0; 41], &DEFAULT_SCALE, &settings.indices()?, &commands, &sampling).deviation[3])
/// };
/// let lines = drift(Sampling::default())?; // five samples into each line
/// let single = drift(Sampling { half_window: 0, ..Sampling::default() })?;
/// assert!((single / lines - 5_f64.sqrt()).abs() < 0.01);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Time for which a command is held, s.
    pub interval_s: f64,
    /// Samples to either side of an epoch that go into its line (2 at five samples an interval; 0: single samples).
    pub half_window: usize,
    /// White noise of one sample, m/s^2.
    pub sigma_m_s2: f64,
    /// Leave out epochs where the command jumps.
    pub skip_jumps: bool,
    /// Leave out epochs with an input axis nearer to the horizontal than this, rad; 0: none.
    pub cut_off_rad: f64,
}

impl Default for Sampling {
    fn default() -> Self {
        Self { interval_s: 0.25, half_window: 2, sigma_m_s2: 1e-6, skip_jumps: false, cut_off_rad: 0.0 }
    }
}

/// Cramer-Rao bound of a run before it is made.
///
/// # Example
/// ```
/// use stillrate::gimbal::{DEFAULT_SCALE, Gauge, Model, Options, Selection};
/// use stillrate_lab::gimbal::{Sampling, Trajectory, bound};
/// let model = Model::new(9.8, 0.7).unwrap();
/// let commands = Trajectory::default().commands(&model).unwrap();
/// let selection = Selection::<41>::new(Gauge::Accelerometer, Options::default()).unwrap();
/// let bound = bound(&model, &[0.0; 41], &DEFAULT_SCALE, selection.indices(), &commands, &Sampling::default());
/// assert!(bound.deviation[3] < 0.01 * DEFAULT_SCALE[3]);
/// ```
#[must_use]
pub fn bound(
    model: &Model,
    coefficients: &Coefficients,
    scale: &Coefficients,
    indices: &[usize],
    commands: &[[f64; 3]],
    sampling: &Sampling,
) -> Bound {
    let samples = vec![[0.0; 3]; commands.len() + 1];
    let record = Record::new(commands, &samples, sampling.interval_s, sampling.sigma_m_s2).ok();
    let mut triangle = Triangle::new(indices.len());
    let limit = model.gravity_m_s2 * sampling.cut_off_rad.sine_cosine().0;
    sensitivities(model, coefficients, commands, sampling.interval_s, |k, _, rotation, _, rows| {
        let jump = sampling.skip_jumps && record.is_some_and(|r| r.jumps(k, KINK_RAD_S));
        let cut = sampling.cut_off_rad > 0.0 && model.force(rotation).iter().any(|f| f.abs() < limit);
        if k == 0 || jump || cut {
            return;
        }
        let factor = variance_factor(sampling.half_window, k == commands.len());
        let weight = 1.0 / (sampling.sigma_m_s2 * factor.root());
        for row in rows {
            triangle.push(indices.iter().map(|&i| row[i] * scale[i] * weight));
        }
    });
    from_root(&triangle.finish(), indices, scale)
}

impl Bound {
    /// Coefficients whose bound exceeds half their prior deviation: a run would leave them at the prior.
    #[must_use]
    pub fn unobservable(&self, scale: &Coefficients) -> Vec<usize> {
        let weak = |i: &usize| !(self.deviation[*i] <= 0.5 * scale[*i]);
        self.indices.iter().copied().filter(weak).collect()
    }

    /// The `count` weakest directions in words: singular value and the coefficients with a share of at least a tenth.
    #[must_use]
    pub fn weakest(&self, count: usize) -> Vec<(f64, String)> {
        let pairs = self.singular_values.iter().zip(&self.directions).rev().take(count);
        pairs
            .map(|(&value, direction)| {
                let largest = direction.iter().copied().fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
                let sign = if largest < 0.0 { -1.0 } else { 1.0 };
                let mut shares: Vec<(f64, usize)> =
                    direction.iter().copied().zip(self.indices.iter().copied()).collect();
                shares.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
                let words: Vec<String> = shares
                    .iter()
                    .filter(|(share, _)| share.abs() >= 0.1)
                    .map(|(share, i)| format!("{:+.2} {}", sign * share, NAMES[*i]))
                    .collect();
                (value, words.join(" "))
            })
            .collect()
    }
}
