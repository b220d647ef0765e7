//! From a log to a record: checks, sampling of commands against accelerometers, noise of one sample.
//!
//! Commands may come at their own interval (n commands, n m + 1 samples) or at the sample rate (as many commands as
//! samples); equal neighbours are then put together again. Long intervals are cut into several so that no window is wasted. The noise is found
//! from the scatter about the line in every window: median of the variances over the median of chi-square / d, (1 - 2/(9d))^3
//! (Wilson and Hilferty 1931), so spikes and kinks do not count.

use core::fmt;

use nalgebra::Matrix3;
use stillrate::gimbal::window::KINK_RAD_S;
use stillrate::gimbal::{COMMAND_MAX_RAD_S, HALF_WINDOW_MAX, Model, Record};
use stillrate::{ConfigError, Real};

/// A record that owns its data.
///
/// # Example
/// ```
/// use stillrate::gimbal::Model;
/// use stillrate_lab::gimbal::prepare;
/// let mut samples = vec![[0.0, 9.8, 0.0]; 21];
/// samples[7][1] = 98.0; // ten times gravity
/// let prepared = prepare(&Model::new(9.8, 0.7)?, &[[0.01, 0.0, 0.0]; 4], &samples, 0.25, Some(1e-6))?;
/// assert!(prepared.missing == 1 && prepared.samples[7][1].is_nan());
/// assert_eq!(prepared.record()?.epochs(), 4);
/// # Ok::<(), stillrate_lab::gimbal::LogError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Prepared {
    /// Commands, rad/s.
    pub commands: Vec<[f64; 3]>,
    /// Samples, m/s^2; NaN where missing or beyond twice gravity.
    pub samples: Vec<[f64; 3]>,
    /// Time for which a command is held, s.
    pub interval_s: f64,
    /// Noise of one sample, m/s^2.
    pub sigma_m_s2: f64,
    /// Samples that were beyond twice gravity, infinite or NaN.
    pub missing: usize,
}

/// Why a log cannot be calibrated from.
///
/// # Example
/// ```
/// use stillrate::gimbal::Model;
/// use stillrate_lab::gimbal::{LogError, prepare};
/// let model = Model::new(9.8, 0.7)?;
/// let in_g = vec![[0.0, 1.0, 0.0]; 22];
/// let error = prepare(&model, &[[0.0; 3]; 4], &in_g, 0.25, Some(1e-6)).unwrap_err();
/// assert!(matches!(&error, LogError::Data(text) if text.contains("22 accelerometer samples do not fit 4 commands")));
/// # Ok::<(), LogError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum LogError {
    /// A setting or a length does not fit.
    Setting(ConfigError),
    /// A sentence about the data.
    Data(String),
}

impl fmt::Display for LogError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Setting(error) => error.fmt(f),
            Self::Data(text) => f.write_str(text),
        }
    }
}

impl core::error::Error for LogError {}

impl From<ConfigError> for LogError {
    fn from(error: ConfigError) -> Self {
        Self::Setting(error)
    }
}

/// More missing samples than this share and the log is refused.
const MISSING_MAX: f64 = 0.5;

/// Checks and arranges a log: commands in rad/s, each held for `dt_s` seconds, and accelerometer samples in m/s^2, whose noise `sigma_m_s2` is found
/// from the data if not given.
///
/// # Errors
/// [`LogError`] saying what is wrong and where.
///
/// # Example
/// ```
/// use stillrate::gimbal::{DEFAULT_SCALE, Model};
/// use stillrate_lab::gimbal::{Disturbance, Trajectory, disturb, draw, outputs, prepare};
/// let model = Model::new(9.8, 0.7)?;
/// let commands = Trajectory::default().commands(&model)?;
/// let clean = outputs(&model, &draw(&DEFAULT_SCALE, 1.0, 1), &commands, 0.25, 5, 1, 0.0, 1);
/// let samples = disturb(&clean, &Disturbance { sigma_m_s2: 3e-6, ..Disturbance::default() }, 2)?;
/// let prepared = prepare(&model, &commands, &samples, 0.25, None)?;
/// assert!((prepared.sigma_m_s2 / 3e-6 - 1.0).abs() < 0.03); // found
/// # Ok::<(), stillrate_lab::gimbal::LogError>(())
/// ```
pub fn prepare(
    model: &Model,
    commands: &[[f64; 3]],
    samples: &[[f64; 3]],
    dt_s: f64,
    sigma_m_s2: Option<f64>,
) -> Result<Prepared, LogError> {
    stillrate::error::positive("dt_s", dt_s, "s")?;
    if let Some(k) = commands.iter().position(|w| !w.iter().all(|x| x.abs() <= COMMAND_MAX_RAD_S)) {
        return Err(LogError::Data(format!(
            "command {k} is {:?} rad/s (must be finite and within {COMMAND_MAX_RAD_S} rad/s)",
            commands[k]
        )));
    }
    let limit = 2.0 * model.gravity_m_s2;
    let mut missing = 0;
    let clean: Vec<[f64; 3]> = samples
        .iter()
        .map(|z| {
            z.map(|x| {
                let good = x.abs() <= limit;
                missing += usize::from(!good);
                if good { x } else { f64::NAN }
            })
        })
        .collect();
    if missing as f64 > MISSING_MAX * 3.0 * samples.len() as f64 {
        return Err(LogError::Data(format!(
            "{missing} of {} accelerometer values are missing or beyond twice gravity (is the unit m/s^2?)",
            3 * samples.len()
        )));
    }
    let (commands, interval_s) = arrange(commands, samples.len(), dt_s)?;
    let mut prepared = Prepared { commands, samples: clean, interval_s, sigma_m_s2: 1.0, missing };
    prepared.split();
    prepared.sigma_m_s2 = match sigma_m_s2 {
        Some(sigma) => stillrate::error::positive("sigma_m_s2", sigma, "m/s^2")?,
        None => prepared.scatter(model)?,
    };
    prepared.record()?;
    Ok(prepared)
}

/// Commands at their own interval.
fn arrange(commands: &[[f64; 3]], samples: usize, dt_s: f64) -> Result<(Vec<[f64; 3]>, f64), LogError> {
    let n = commands.len();
    if n == 0 || samples < 2 {
        return Err(LogError::Data(format!("{n} commands and {samples} accelerometer samples are not a run")));
    }
    if samples != n && samples != n + 1 {
        return if (samples - 1).is_multiple_of(n) {
            Ok((commands.to_vec(), dt_s))
        } else {
            Err(LogError::Data(format!(
                "{samples} accelerometer samples do not fit {n} commands (must be a whole number m a command, and one more: n m + 1)"
            )))
        };
    }
    // One command a sample: the last one acts after the last sample.
    let used = samples - 1;
    let commands = &commands[..used];
    let grouped = |group: usize| {
        used.is_multiple_of(group) && commands.chunks(group).all(|part| part.iter().all(|w| *w == part[0]))
    };
    let group = (2..=50).rev().find(|&g| grouped(g)).unwrap_or(1);
    Ok((commands.iter().step_by(group).copied().collect(), dt_s * group as f64))
}

impl Prepared {
    /// The record, borrowed.
    ///
    /// # Errors
    /// [`ConfigError`] if its lengths do not fit.
    pub fn record(&self) -> Result<Record<'_>, ConfigError> {
        Record::new(&self.commands, &self.samples, self.interval_s, self.sigma_m_s2)
    }

    /// Cuts intervals so that windows use as many of the samples as possible.
    fn split(&mut self) {
        let per_interval = (self.samples.len() - 1) / self.commands.len();
        let used = |parts: usize| {
            let m = per_interval / parts;
            let half = ((m - 1) / 2).min(HALF_WINDOW_MAX);
            (2 * half + 1) as f64 / m as f64
        };
        let divisors =
            (1..=per_interval).filter(|&p| per_interval.is_multiple_of(p) && (per_interval / p >= 3 || p == 1));
        let best = divisors.fold(1, |best, p| if used(p) > used(best) + 1e-9 { p } else { best });
        if best > 1 {
            self.commands = self.commands.iter().flat_map(|w| core::iter::repeat_n(*w, best)).collect();
            self.interval_s /= best as f64;
        }
    }

    /// Noise of one sample from the scatter inside the windows.
    fn scatter(&self, model: &Model) -> Result<f64, LogError> {
        let record = self.record()?;
        let half = record.half_window();
        if half == 0 {
            return Err(LogError::Data(
                "fewer than three accelerometer samples a command: the noise cannot be found, give sigma_m_s2".into(),
            ));
        }
        let points = 2 * half + 1;
        let d = (points - 2) as f64;
        let s2: f64 = (1..=half).map(|j| 2.0 * (j * j) as f64).sum();
        let earth_rate = model.earth_rate();
        let mut frame = Matrix3::identity();
        let mut variances = Vec::new();
        for k in 1..record.epochs() {
            frame = model.commanded_step(&frame, &record.command(k - 1).into(), &earth_rate, record.interval_s());
            if record.jumps(k, KINK_RAD_S) {
                continue;
            }
            let command = record.command(k).into();
            let (mut sum, mut slope, mut square) = ([0.0; 3], [0.0; 3], [0.0; 3]);
            for j in -(half as isize)..=half as isize {
                let force = model.commanded_force(&frame, &command, &earth_rate, record.offset_s(j));
                let sample = record.sample(k, j).copied().unwrap_or([f64::NAN; 3]);
                for axis in 0..3 {
                    // Around the first sample's size the squares keep their digits.
                    let y = sample[axis] - force[axis];
                    sum[axis] += y;
                    slope[axis] += y * j as f64;
                    square[axis] += y * y;
                }
            }
            for axis in 0..3 {
                let mean = sum[axis] / points as f64;
                let rest = square[axis] - mean * sum[axis] - slope[axis] * slope[axis] / s2;
                if rest.is_finite() {
                    variances.push(rest.max(0.0) / d);
                }
            }
        }
        variances.sort_by(f64::total_cmp);
        let middle = variances.get(variances.len() / 2).copied().unwrap_or(0.0);
        let shape = 1.0 - 2.0 / (9.0 * d);
        let sigma = (middle / (shape * shape * shape)).root();
        if sigma > 0.0 {
            Ok(sigma)
        } else {
            Err(LogError::Data("the accelerometer samples show no noise to measure: give sigma_m_s2".into()))
        }
    }
}
