//! How the base moves under the platform: tilt, sine, constant, or a recorded motion.
//!
//! Angles and rates are handed to the integrator as a table of one control period (start, middle and end of every
//! step), so a sine costs two evaluations of sin a control period and not two a step.

use core::f64::consts::{PI, TAU};

use stillrate::Real;
use stillrate::error::{ConfigError, not_negative, positive};

/// Motion of the base about one axis, radians.
///
/// # Example
/// ```
/// use stillrate_lab::servo::base::Base;
/// let tilt = Base::Tilt { amplitude_rad: 0.2, duration_s: 0.5 };
/// assert_eq!(tilt.at(3.0), (0.2, 0.0));
/// let (halfway, rate) = tilt.at(0.25); // fastest here: pi/2 times the mean rate
/// assert!((halfway - 0.1).abs() < 1e-12 && (rate - 0.4 * core::f64::consts::FRAC_PI_2).abs() < 1e-12);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Base {
    /// Half a cosine from 0 to the amplitude.
    Tilt {
        /// Final angle, rad.
        amplitude_rad: f64,
        /// How long the tilt takes, s.
        duration_s: f64,
    },
    /// amplitude * sin(2 pi f t), faded in by sin^2 over `ramp_s`.
    Sine {
        /// Amplitude, rad.
        amplitude_rad: f64,
        /// Frequency, Hz.
        frequency_hz: f64,
        /// Fade-in time, s (0: none).
        ramp_s: f64,
    },
    /// A tilted base at rest.
    Constant {
        /// The angle, rad.
        angle_rad: f64,
    },
    /// A recorded rate, linear between samples, integrated to the angle.
    Recorded(Recorded),
}

/// A recorded motion: rates at a regular rate and their exact integral.
///
/// # Example
/// ```
/// use stillrate_lab::servo::base::{Base, Recorded};
/// // Half a rad/s on the mean is a gyro's bias and no motion; what is left swings by 0.1 rad to both sides.
/// let base = Base::Recorded(Recorded::new(&[0.5, 0.7, 0.5, 0.3, 0.5], 1.0, 0.3).unwrap());
/// assert!((base.at(0.0).0 + 0.1).abs() < 1e-12 && (base.at(2.0).0 - 0.1).abs() < 1e-12);
/// assert!(Recorded::new(&[0.5], 1.0, 0.3).is_err());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Recorded {
    period_s: f64,
    rate: Vec<f64>,
    angle: Vec<f64>,
}

impl Recorded {
    /// From rate samples in rad/s; non-finite samples are bridged by the last good one. The mean rate is taken out (a gyro
    /// log has a bias, a platform a limited range), and the whole is scaled down, never up, to stay within `range_rad`.
    ///
    /// # Errors
    /// Fewer than two samples, or a sample rate or range that is not positive.
    pub fn new(rate_rad_s: &[f64], sample_rate_hz: f64, range_rad: f64) -> Result<Self, ConfigError> {
        let period_s = 1.0 / positive("sample_rate_hz", sample_rate_hz, "Hz")?;
        positive("range_rad", range_rad, "rad")?;
        if rate_rad_s.len() < 2 {
            let n = rate_rad_s.len() as f64;
            return Err(ConfigError::new("samples", n, "", "at least 2"));
        }
        let mut last = rate_rad_s.iter().copied().find(|v| v.is_finite()).unwrap_or(0.0);
        let mut rate: Vec<f64> = rate_rad_s
            .iter()
            .map(|v| {
                last = if v.is_finite() { *v } else { last };
                last
            })
            .collect();
        let mean = rate.iter().sum::<f64>() / rate.len() as f64;
        for v in &mut rate {
            *v -= mean;
        }
        let mut angle = integrate(&rate, period_s);
        let (low, high) = angle.iter().fold((0.0_f64, 0.0_f64), |(l, h), v| (l.min(*v), h.max(*v)));
        let middle = 0.5 * (low + high);
        let reach = 0.5 * (high - low);
        let scale = if reach > range_rad { range_rad / reach } else { 1.0 };
        for v in &mut rate {
            *v *= scale;
        }
        for v in &mut angle {
            *v = (*v - middle) * scale;
        }
        Ok(Self { period_s, rate, angle })
    }

    fn duration_s(&self) -> f64 {
        self.period_s * (self.rate.len() - 1) as f64
    }

    fn at(&self, t: f64) -> (f64, f64) {
        let last = self.rate.len() - 1;
        let place = (t / self.period_s).limited(0.0, last as f64);
        let k = (place as usize).min(last - 1);
        let h = (place - k as f64) * self.period_s;
        let slope = (self.rate[k + 1] - self.rate[k]) / self.period_s;
        let moving = if t > self.duration_s() { 0.0 } else { self.rate[k] + slope * h };
        (self.angle[k] + h * (self.rate[k] + 0.5 * slope * h), moving)
    }
}

fn integrate(rate: &[f64], period: f64) -> Vec<f64> {
    let mut angle = vec![0.0; rate.len()];
    for k in 1..rate.len() {
        angle[k] = angle[k - 1] + 0.5 * period * (rate[k] + rate[k - 1]);
    }
    angle
}

impl Base {
    /// Checks every number.
    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        let finite = |field, value: f64| {
            if value.is_finite() { Ok(()) } else { Err(ConfigError::new(field, value, "rad", "finite, in")) }
        };
        match self {
            Self::Tilt { amplitude_rad, duration_s } => {
                finite("amplitude_rad", *amplitude_rad)?;
                positive("duration_s", *duration_s, "s")?;
            }
            Self::Sine { amplitude_rad, frequency_hz, ramp_s } => {
                finite("amplitude_rad", *amplitude_rad)?;
                positive("frequency_hz", *frequency_hz, "Hz")?;
                not_negative("ramp_s", *ramp_s, "s")?;
            }
            Self::Constant { angle_rad } => finite("angle_rad", *angle_rad)?,
            Self::Recorded(_) => {}
        }
        Ok(())
    }

    /// Angle (rad) and rate (rad/s) at time `t`, s.
    #[must_use]
    pub fn at(&self, t: f64) -> (f64, f64) {
        match self {
            Self::Tilt { amplitude_rad, duration_s } => {
                if t >= *duration_s {
                    return (*amplitude_rad, 0.0);
                }
                let w = PI / duration_s;
                let (sine, cosine) = (w * t).sine_cosine();
                (0.5 * amplitude_rad * (1.0 - cosine), 0.5 * amplitude_rad * w * sine)
            }
            Self::Sine { amplitude_rad, frequency_hz, ramp_s } => {
                let w = TAU * frequency_hz;
                let (sine, cosine) = (w * t).sine_cosine();
                faded(*amplitude_rad, w, sine, cosine, *ramp_s, t)
            }
            Self::Constant { angle_rad } => (*angle_rad, 0.0),
            Self::Recorded(recorded) => recorded.at(t),
        }
    }

    /// Largest angle and rate, for the warnings about range and reach.
    pub(crate) fn extremes(&self) -> (f64, f64) {
        match self {
            Self::Tilt { amplitude_rad, duration_s } => {
                (amplitude_rad.magnitude(), 0.5 * PI * amplitude_rad.magnitude() / duration_s)
            }
            Self::Sine { amplitude_rad, frequency_hz, .. } => {
                (amplitude_rad.magnitude(), amplitude_rad.magnitude() * TAU * frequency_hz)
            }
            Self::Constant { angle_rad } => (angle_rad.magnitude(), 0.0),
            Self::Recorded(r) => {
                let largest = |v: &[f64]| v.iter().fold(0.0_f64, |m, x| m.max(x.magnitude()));
                (largest(&r.angle), largest(&r.rate))
            }
        }
    }

    /// Fills `table` with (angle, rate) at `start_s`, `start_s + half_s`, `start_s + 2 half_s`, ...
    pub(crate) fn fill(&self, start_s: f64, half_s: f64, table: &mut [(f64, f64)]) {
        match self {
            Self::Sine { amplitude_rad, frequency_hz, ramp_s } if start_s >= *ramp_s => {
                // Turning by one half step at a time; anew every control period, so nothing accumulates.
                let w = TAU * frequency_hz;
                let (mut sine, mut cosine) = (w * start_s).sine_cosine();
                let (step_sine, step_cosine) = (w * half_s).sine_cosine();
                for entry in table.iter_mut() {
                    *entry = (amplitude_rad * sine, amplitude_rad * w * cosine);
                    (sine, cosine) = (sine * step_cosine + cosine * step_sine, cosine * step_cosine - sine * step_sine);
                }
            }
            _ => {
                for (j, entry) in table.iter_mut().enumerate() {
                    *entry = self.at(start_s + half_s * j as f64);
                }
            }
        }
    }
}

fn faded(amplitude: f64, w: f64, sine: f64, cosine: f64, ramp_s: f64, t: f64) -> (f64, f64) {
    if t >= ramp_s {
        return (amplitude * sine, amplitude * w * cosine);
    }
    let v = 0.5 * PI / ramp_s;
    let (s, c) = (v * t).sine_cosine();
    (amplitude * sine * s * s, amplitude * (w * cosine * s * s + sine * 2.0 * v * s * c))
}
