//! One axis of the platform under control: plant, sampled controller, delay, gyro errors and base motion together.
//!
//! The control period is a whole number of integration steps, the delay too (it may exceed a period). A tick samples the gyro,
//! filters, computes a voltage; the voltage takes effect `delay` later. Noise-free runs are reproducible to the last bit
//! on every machine; a full plant with noise is chaotic (play and stiction), so compare only its statistics across versions.

use stillrate::error::{ConfigError, not_negative, positive};

use super::DEGREES;
use super::base::Base;
use super::controller::{Controller, ControllerState, Drive};
use super::kernel::Kernel;
use super::loop_filter::LoopFilter;
use super::plant::{Plant, STATES, State};
use crate::random::Random;

/// A platform that has turned this far is lost.
const LOST_RAD: f64 = 10.0;
/// Control periods that the delay line holds.
const PENDING: usize = 64;
/// Steps a control period may have.
const MOST_STEPS: f64 = 10_000.0;

/// Names of the columns of a [`Record`].
pub const COLUMNS: [&str; 8] = ["theta", "u", "w", "y", "theta_hat", "alpha", "phi", "nu"];

/// What the gyro adds: y = (1 + scale_error) gyro + bias + noise, rounded to `lsb`.
///
/// # Example
/// ```
/// use stillrate_lab::servo::{base::Base, controller::Controller, loop_filter::Unfiltered, plant::Plant};
/// use stillrate_lab::servo::platform::{GyroErrors, Platform};
/// let axis = Platform::new(Plant::platform_30kg(), Controller::default(), 50.0, 1e-3, 5e-3)?;
/// let biased = GyroErrors { bias_rad_s: 2e-3, ..GyroErrors::default() };
/// let record = axis.run(&mut Unfiltered, &Base::Constant { angle_rad: 0.0 }, &biased, 0.0, 30.0)?;
/// // The loop keeps the gyro's output at zero, so the platform turns away by the bias.
/// assert!((record.last_state[0] + 30.0 * biased.bias_rad_s).abs() < 2e-3);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GyroErrors {
    /// Standard deviation of a white sample, rad/s.
    pub white_sigma_rad_s: f64,
    /// Constant bias, rad/s.
    pub bias_rad_s: f64,
    /// Scale error, 1.
    pub scale_error: f64,
    /// Resolution, rad/s (0: continuous).
    pub lsb_rad_s: f64,
    /// Seed of the white noise.
    pub seed: u64,
    /// Noise samples in rad/s, one a tick, added as they are (missing ones count as 0).
    pub samples_rad_s: Vec<f64>,
}

/// One axis, checked.
///
/// # Example
/// ```
/// use stillrate_lab::servo::{base::Base, controller::Controller, loop_filter::Unfiltered, plant::Plant};
/// use stillrate_lab::servo::platform::{GyroErrors, Platform};
/// let axis = Platform::new(Plant::platform_30kg(), Controller::default(), 50.0, 1e-3, 5e-3)?;
/// let base = Base::Sine { amplitude_rad: 0.1745, frequency_hz: 1.0, ramp_s: 1.0 };
/// let record = axis.run(&mut Unfiltered, &base, &GyroErrors::default(), 0.0, 8.0)?;
/// assert!(record.lost_at.is_none());
/// assert_eq!(record.rows.len() as f64 * axis.period_s(), 8.0);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Platform {
    /// The plant.
    pub plant: Plant,
    /// The controller.
    pub controller: Controller,
    /// Angle to hold, rad.
    pub angle_reference_rad: f64,
    /// Drive angle beyond which the spindle is at its end, rad.
    pub drive_range_rad: f64,
    sample_rate_hz: f64,
    dt_s: f64,
    steps: usize,
    delay_steps: usize,
}

/// What happened, one row of [`COLUMNS`] a tick (SI, rad), taken before the tick's voltage takes effect.
///
/// # Example
/// ```
/// use stillrate_lab::servo::{base::Base, controller::Controller, loop_filter::Unfiltered, plant::Plant};
/// use stillrate_lab::servo::platform::{COLUMNS, GyroErrors, Platform};
/// let axis = Platform::new(Plant::platform_30kg(), Controller::default(), 50.0, 1e-3, 5e-3)?;
/// let tilt = Base::Tilt { amplitude_rad: 0.2, duration_s: 0.5 };
/// let record = axis.run(&mut Unfiltered, &tilt, &GyroErrors::default(), 0.0, 8.0)?;
/// let last = |name: &str| record.rows[399][COLUMNS.iter().position(|column| *column == name).unwrap()];
/// // The drive has turned back what the base tilted, and the platform stands upright.
/// assert_eq!(last("phi"), 0.2);
/// assert!(last("theta").abs() < 5e-3 && (last("alpha") + 0.2).abs() < 1e-2);
/// assert_eq!((record.lost_at, record.out_of_stroke_at), (None, None));
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// The rows.
    pub rows: Vec<[f64; 8]>,
    /// Tick at which the platform was lost (turned beyond 10 rad or not finite).
    pub lost_at: Option<usize>,
    /// First tick at which the drive stood beyond its range.
    pub out_of_stroke_at: Option<usize>,
    /// Plant state at the end.
    pub last_state: State,
}

impl Platform {
    /// An axis with control at `sample_rate_hz`, integration step `dt_s` and a delay of `delay_s` from gyro to voltage.
    ///
    /// # Errors
    /// [`ConfigError`] naming the field: plant or controller out of range, a control period or delay that is not a whole
    /// number of steps, a delay beyond 60 control periods.
    pub fn new(
        plant: Plant,
        controller: Controller,
        sample_rate_hz: f64,
        dt_s: f64,
        delay_s: f64,
    ) -> Result<Self, ConfigError> {
        plant.check(dt_s)?;
        controller.check()?;
        let period = 1.0 / positive("sample_rate_hz", sample_rate_hz, "Hz")?;
        let steps = whole(period / dt_s).filter(|n| *n >= 1.0 && *n <= MOST_STEPS).ok_or(ConfigError::new(
            "dt_s",
            dt_s,
            "s",
            "a whole fraction of the control period (at most 10000 steps), in",
        ))?;
        let delay =
            whole(not_negative("delay_s", delay_s, "s")? / dt_s).filter(|n| *n <= steps * (PENDING - 4) as f64).ok_or(
                ConfigError::new("delay_s", delay_s, "s", "a whole number of dt_s and at most 60 control periods, in"),
            )?;
        Ok(Self {
            plant,
            controller,
            angle_reference_rad: 0.0,
            drive_range_rad: 0.5,
            sample_rate_hz,
            dt_s,
            steps: steps as usize,
            delay_steps: delay as usize,
        })
    }

    /// Control period, s.
    #[must_use]
    pub fn period_s(&self) -> f64 {
        self.steps as f64 * self.dt_s
    }

    /// Delay from gyro to voltage, s.
    pub(crate) fn delay_s(&self) -> f64 {
        self.delay_steps as f64 * self.dt_s
    }

    /// The same with another controller and `more_s` of delay added: what a margin is measured with.
    pub(crate) fn with(&self, controller: Controller, more_s: f64) -> Result<Self, ConfigError> {
        let changed = Self::new(self.plant, controller, self.sample_rate_hz, self.dt_s, self.delay_s() + more_s)?;
        Ok(Self { angle_reference_rad: self.angle_reference_rad, drive_range_rad: self.drive_range_rad, ..changed })
    }

    /// Runs the loop for `duration_s` from angle `start_rad` (everything else at rest, the angle known).
    ///
    /// # Errors
    /// A base motion or duration that cannot be used.
    pub fn run(
        &self,
        filter: &mut dyn LoopFilter,
        base: &Base,
        gyro: &GyroErrors,
        start_rad: f64,
        duration_s: f64,
    ) -> Result<Record, ConfigError> {
        base.check()?;
        let ticks = (positive("duration_s", duration_s, "s")? * self.sample_rate_hz + 0.5).min(1e9) as usize;
        not_negative("white_sigma_rad_s", gyro.white_sigma_rad_s, "rad/s")?;
        let drive = Drive {
            volts_per_rate: self.plant.motor_constant_v_s * self.plant.gear_ratio,
            voltage_max_v: self.plant.voltage_max_v,
            angle_reference_rad: self.angle_reference_rad,
        };
        let kernel = Kernel::new(&self.plant);
        filter.reset();
        let mut random = Random::new(gyro.seed, 0);
        let mut state: State = [0.0; STATES];
        state[0] = start_rad;
        // The drive stands where the coupling is at rest.
        state[2] = start_rad - base.at(0.0).0;
        let mut controller = ControllerState::at_angle(start_rad);
        let mut pending = [0.0; PENDING];
        let mut table = vec![(0.0, 0.0); 2 * self.steps + 1];
        let mut record = Record { rows: Vec::with_capacity(ticks), ..Record::default() };
        for k in 0..ticks {
            let start = (k * self.steps) as f64 * self.dt_s;
            base.fill(start, 0.5 * self.dt_s, &mut table);
            let raw = gyro.sample(state[6], k, &mut random);
            let filtered = filter.step(raw * DEGREES) / DEGREES;
            let voltage = self.controller.tick(&mut controller, raw, filtered, state[0], drive, self.period_s());
            pending[k % PENDING] = voltage;
            record.rows.push([state[0], voltage, filtered, raw, controller.angle, state[2], table[0].0, state[3]]);
            if !(state[0].abs() <= LOST_RAD && voltage.is_finite()) {
                record.lost_at = Some(k);
                break;
            }
            if record.out_of_stroke_at.is_none() && state[2].abs() > self.drive_range_rad {
                record.out_of_stroke_at = Some(k);
            }
            let delayed = |j: usize| {
                let now = k * self.steps + j;
                if now < self.delay_steps { 0.0 } else { pending[(now - self.delay_steps) / self.steps % PENDING] }
            };
            kernel.run(&mut state, delayed, &table, self.dt_s);
        }
        record.last_state = state;
        Ok(record)
    }
}

impl GyroErrors {
    fn sample(&self, rate: f64, tick: usize, random: &mut Random) -> f64 {
        let mut y = (1.0 + self.scale_error) * rate + self.bias_rad_s;
        if self.white_sigma_rad_s > 0.0 {
            y += self.white_sigma_rad_s * random.normal();
        }
        if let Some(v) = self.samples_rad_s.get(tick) {
            y += v;
        }
        if self.lsb_rad_s > 0.0 {
            // Ties away from zero, as a converter's firmware does it; `round` is exact and needs no libm.
            y = (y / self.lsb_rad_s).round() * self.lsb_rad_s;
        }
        y
    }
}

/// The nearest whole number, where `value` is one to within rounding.
fn whole(value: f64) -> Option<f64> {
    let nearest = value.round();
    ((value - nearest).abs() <= 1e-6 * nearest.max(1.0)).then_some(nearest)
}
