//! Truth for calibration runs: a Runge-Kutta integration of the platform, independent of the estimator's own step, and every
//! disturbance a real head adds to it.
//!
//! dR/dt = -[w_p x] R + R [w_ie x] for the nine numbers of R, fourth order, `substeps` per accelerometer sample. Angle random walk is
//! a rate that is constant over a substep. The disturbances of the outputs are added in the order of a signal chain: noise,
//! spikes, quantisation, loss.

use nalgebra::{Matrix3, Vector3};
use stillrate::error::not_negative;
use stillrate::gimbal::coefficients::{GYRO_ABOUT_OUTPUT, GYRO_BIAS, LATENCY, TORQUER};
use stillrate::gimbal::{COUNT, Coefficients, Gauge, Geometry, Linearisation, Model, Triads};
use stillrate::{ConfigError, Real};

use crate::random::{Generator, Random};

/// What happens besides the coefficients.
///
/// # Example
/// ```
/// use stillrate_lab::gimbal::{Disturbance, disturb};
/// let coarse = Disturbance { quantisation_m_s2: 0.5, ..Disturbance::default() };
/// assert_eq!(disturb(&[[0.1, 9.8, -0.3]], &coarse, 1)?, [[0.0, 10.0, -0.5]]);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disturbance {
    /// White noise of one accelerometer sample, m/s^2.
    pub sigma_m_s2: f64,
    /// Angle random walk of each gyro, deg/sqrt(h).
    pub angle_random_walk_deg_sqrt_h: f64,
    /// Step of the converter, m/s^2; 0: none.
    pub quantisation_m_s2: f64,
    /// Share of samples with a spike.
    pub spike_probability: f64,
    /// Standard deviation of a spike, m/s^2.
    pub spike_m_s2: f64,
    /// Share of samples that are lost (NaN).
    pub loss_probability: f64,
}

impl Default for Disturbance {
    fn default() -> Self {
        Self {
            sigma_m_s2: 1e-6,
            angle_random_walk_deg_sqrt_h: 0.0,
            quantisation_m_s2: 0.0,
            spike_probability: 0.0,
            spike_m_s2: 1e-3,
            loss_probability: 0.0,
        }
    }
}

/// Rate of change of R.
fn turn(
    model: &Model,
    geometry: &Geometry,
    commanded: &Vector3<f64>,
    extra: &Vector3<f64>,
    r: &Matrix3<f64>,
) -> Matrix3<f64> {
    let rate = geometry.rate(commanded, &model.force(r)) + extra;
    -(rate.cross_matrix() * r) + r * geometry.earth_rate.cross_matrix()
}

/// One Runge-Kutta step of `h` seconds.
fn runge_kutta(
    model: &Model,
    geometry: &Geometry,
    commanded: &Vector3<f64>,
    extra: &Vector3<f64>,
    r: &Matrix3<f64>,
    h: f64,
) -> Matrix3<f64> {
    let k1 = turn(model, geometry, commanded, extra, r);
    let k2 = turn(model, geometry, commanded, extra, &(r + k1 * (h / 2.0)));
    let k3 = turn(model, geometry, commanded, extra, &(r + k2 * (h / 2.0)));
    let k4 = turn(model, geometry, commanded, extra, &(r + k3 * h));
    r + (k1 + (k2 + k3) * 2.0 + k4) * (h / 6.0)
}

/// Accelerometer outputs (m/s^2) of a run without measurement noise: n commands (rad/s) give n `per_interval` + 1 samples. The latency
/// among the coefficients makes every sample older than it claims.
///
/// # Example
/// ```
/// use stillrate::gimbal::Model;
/// use stillrate_lab::gimbal::outputs;
/// let model = Model::new(9.8, 0.7).unwrap();
/// let z = outputs(&model, &[0.0; 41], &[[0.01, 0.0, 0.0]; 4], 0.25, 5, 2, 0.0, 1);
/// assert_eq!(z.len(), 21);
/// ```
#[must_use]
pub fn outputs(
    model: &Model,
    coefficients: &Coefficients,
    commands: &[[f64; 3]],
    interval_s: f64,
    per_interval: usize,
    substeps: usize,
    angle_random_walk_deg_sqrt_h: f64,
    seed: u64,
) -> Vec<[f64; 3]> {
    let geometry = Geometry::new(model, coefficients);
    let mut random = Random::new(seed, 1);
    let substeps = substeps.max(1);
    let sample_s = interval_s / per_interval as f64;
    let h = sample_s / substeps as f64;
    let walk = angle_random_walk_deg_sqrt_h * core::f64::consts::PI / 180.0 / 60.0 / h.root();
    let latency = coefficients[LATENCY];
    let mut rotation = Linearisation::of(coefficients).rotation;
    let mut before = Vector3::from(commands.first().copied().unwrap_or_default());
    let mut samples = Vec::with_capacity(commands.len() * per_interval + 1);
    let mut read = |rotation: &Matrix3<f64>, command: &Vector3<f64>| {
        let then = if latency == 0.0 {
            *rotation
        } else {
            let commanded = geometry.commanded_rate(command);
            runge_kutta(model, &geometry, &commanded, &Vector3::zeros(), rotation, -latency)
        };
        samples.push(geometry.output(model, &then));
    };
    read(&rotation, &before);
    for command in commands {
        let command = Vector3::from(*command);
        let commanded = geometry.commanded_rate(&command);
        for m in 0..per_interval {
            for _ in 0..substeps {
                let extra = if walk > 0.0 { Vector3::from_fn(|_, _| random.normal() * walk) } else { Vector3::zeros() };
                rotation = runge_kutta(model, &geometry, &commanded, &extra, &rotation, h);
            }
            // A sample that is older than the start of this interval belongs to the command before it.
            let in_force = if (m + 1) as f64 * sample_s <= latency { &before } else { &command };
            read(&rotation, in_force);
        }
        before = command;
    }
    samples
}

/// Adds noise, spikes, quantisation and loss to clean outputs (m/s^2); the same seed gives the same disturbance.
///
/// # Errors
/// [`ConfigError`] if a setting is negative.
///
/// # Example
/// ```
/// use stillrate_lab::gimbal::{Disturbance, disturb};
/// let clean = vec![[0.0, 9.8, 0.0]; 1000];
/// let noisy = disturb(&clean, &Disturbance::default(), 1)?;
/// let lossy = disturb(&clean, &Disturbance { loss_probability: 0.1, ..Disturbance::default() }, 1)?;
/// let lost = lossy.iter().flatten().filter(|x| x.is_nan()).count();
/// assert!((250..350).contains(&lost));
/// // What is not lost is as noisy as before.
/// assert!(lossy.iter().flatten().zip(noisy.iter().flatten()).all(|(a, b)| a.is_nan() || a == b));
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
pub fn disturb(clean: &[[f64; 3]], disturbance: &Disturbance, seed: u64) -> Result<Vec<[f64; 3]>, ConfigError> {
    let d = disturbance;
    not_negative("sigma_m_s2", d.sigma_m_s2, "m/s^2")?;
    not_negative("quantisation_m_s2", d.quantisation_m_s2, "m/s^2")?;
    not_negative("spike_probability", d.spike_probability, "")?;
    not_negative("loss_probability", d.loss_probability, "")?;
    // Separate streams: switching one disturbance on leaves the numbers of the others as they were.
    let mut noise = Random::new(seed, 2);
    let mut spikes = Random::new(seed, 3);
    let mut loss = Random::new(seed, 4);
    let disturbed = clean.iter().map(|sample| {
        sample.map(|value| {
            let mut z = value + d.sigma_m_s2 * noise.normal();
            let (hit, size) = (spikes.uniform() < d.spike_probability, spikes.normal());
            if hit {
                z += d.spike_m_s2 * size;
            }
            if d.quantisation_m_s2 > 0.0 {
                z = (z / d.quantisation_m_s2).round() * d.quantisation_m_s2;
            }
            if loss.uniform() < d.loss_probability { f64::NAN } else { z }
        })
    });
    Ok(disturbed.collect())
}

/// A draw of true coefficients: uniform 0.3..1 times the scale with random sign, in the accelerometer gauge; the drifts and g-sensitive
/// terms times `gyro_factor` (1: 0.03 to 0.1 deg/h). Optional coefficients are 0.
///
/// # Example
/// ```
/// use stillrate::gimbal::{DEFAULT_SCALE, coefficients::TORQUER};
/// use stillrate_lab::gimbal::draw;
/// let truth = draw(&DEFAULT_SCALE, 1.0, 7);
/// let drift_deg_h = truth[3].abs().to_degrees() * 3600.0;
/// assert!((0.03..0.1).contains(&drift_deg_h) && truth[TORQUER] == 0.0);
/// assert_eq!(draw(&DEFAULT_SCALE, 10.0, 7)[3], 10.0 * truth[3]); // the same head, drifting ten times as much
/// ```
#[must_use]
pub fn draw(scale: &Coefficients, gyro_factor: f64, seed: u64) -> Coefficients {
    let mut random = Random::new(seed, 5);
    let held = Gauge::Accelerometer.fixed(&Triads::default()).unwrap_or_default();
    let mut x = [0.0; COUNT];
    for i in 0..TORQUER {
        let size = scale[i] * (0.3 + 0.7 * random.uniform());
        let sign = if random.uniform() < 0.5 { -1.0 } else { 1.0 };
        let factor = if (GYRO_BIAS..GYRO_ABOUT_OUTPUT).contains(&i) { gyro_factor } else { 1.0 };
        x[i] = if held.contains(&i) { 0.0 } else { sign * size * factor };
    }
    x
}
