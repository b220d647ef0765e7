//! The experiments that a tuning is judged by, on one platform: 10 deg at 1 Hz, rest after a tilt, margins, levelling.
//!
//! A [`Design`] is a controller and a filter. Every experiment runs it on the [`Bench`]: the plant, its timing and its gyro. Seeds of gyro
//! noise are always explicit, so that tuning and validation use different ones.

use stillrate::{ConfigError, GyroNoise, Real};

use super::base::Base;
use super::controller::Controller;
use super::family::Family;
use super::loop_filter::LoopFilter;
use super::measure::{self, Residual};
use super::plant::Plant;
use super::platform::{GyroErrors, Platform, Record};
use crate::random::Random;
use crate::settings_map::SettingsError;

const RADIANS: f64 = core::f64::consts::PI / 180.0;
/// The excitation before every measurement of rest jitter: 15 deg in 0.5 s.
const TILT_DEG: f64 = 15.0;
const TILT_S: f64 = 0.5;
/// Rest jitter is measured from 6 to 14 s after the tilt's end.
const REST_FROM_S: f64 = TILT_S + 6.0;
const REST_TO_S: f64 = TILT_S + 14.0;
/// The moving mean needs this much beyond the window.
const REST_RUN_S: f64 = REST_TO_S + 0.4;
/// Residual: from 3 s on, when the ramp of 1 s has died out.
pub(crate) const RESIDUAL_FROM_S: f64 = 3.0;
const RESIDUAL_RUN_S: f64 = 9.0;
/// How long levelling may take, and over what time its error is averaged.
const LEVEL_RUN_S: f64 = 25.0;
const LEVEL_MEAN_S: f64 = 2.0;
/// A run is quiet when its rest jitter stays below this many percent of the supply: no limit cycle.
pub const QUIET_PERCENT: f64 = 1.0;
/// Factors on kappa and kd that the gain margin tries.
pub const GAIN_FACTORS: [f64; 8] = [1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0, 8.0];
/// Added delays that the delay margin tries, s.
pub const DELAYS_S: [f64; 8] = [0.002, 0.005, 0.010, 0.015, 0.020, 0.030, 0.040, 0.060];

/// A platform with its gyro, waiting for a controller and a filter.
#[derive(Clone, Debug, PartialEq)]
pub struct Bench {
    /// The plant.
    pub plant: Plant,
    /// Control rate, Hz.
    pub sample_rate_hz: f64,
    /// Integration step, s.
    pub dt_s: f64,
    /// Delay from gyro to voltage, s.
    pub delay_s: f64,
    /// Noise of the gyro; white samples of N sqrt(rate) are simulated.
    pub noise: GyroNoise,
    /// Constant bias of the gyro, deg/s.
    pub bias_dps: f64,
    /// Amplitude of the sine, deg.
    pub amplitude_deg: f64,
    /// Frequency of the sine, Hz.
    pub frequency_hz: f64,
}

/// A controller and the parameters of a filter family.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    /// The controller.
    pub controller: Controller,
    /// Open settings of the family.
    pub parameters: Vec<f64>,
}

impl Bench {
    /// The paper's platform and gyro (0.1074 deg/s at 50 Hz, taken as white) with control at `sample_rate_hz`; K/N = 0.2184 for
    /// filters that ask for it; 18 deg/h of bias.
    #[must_use]
    pub fn paper(sample_rate_hz: f64) -> Self {
        let density = 0.1074 / 50.0.root();
        Self {
            plant: Plant::platform_30kg(),
            sample_rate_hz,
            dt_s: 1e-3,
            delay_s: 5e-3,
            noise: GyroNoise { density_dps_sqrt_hz: density, rate_random_walk_dps_sqrt_s: 0.2184 * density },
            bias_dps: 0.005,
            amplitude_deg: 10.0,
            frequency_hz: 1.0,
        }
    }

    /// The platform with a controller and an added delay.
    ///
    /// # Errors
    /// As [`Platform::new`].
    pub fn axis(&self, controller: Controller, more_s: f64) -> Result<Platform, ConfigError> {
        Platform::new(self.plant, controller, self.sample_rate_hz, self.dt_s, self.delay_s + more_s)
    }

    fn gyro(&self, seed: u64) -> GyroErrors {
        GyroErrors {
            white_sigma_rad_s: self.noise.density_dps_sqrt_hz * self.sample_rate_hz.root() * RADIANS,
            bias_rad_s: self.bias_dps * RADIANS,
            seed,
            ..GyroErrors::default()
        }
    }

    /// One run of `base` from `start_rad`.
    ///
    /// # Errors
    /// As [`Platform::run`].
    pub fn run(
        &self,
        axis: &Platform,
        filter: &mut dyn LoopFilter,
        base: &Base,
        seed: u64,
        start_rad: f64,
        duration_s: f64,
    ) -> Result<Record, ConfigError> {
        axis.run(filter, base, &self.gyro(seed), start_rad, duration_s)
    }

    fn period(&self) -> f64 {
        1.0 / self.sample_rate_hz
    }

    /// Where bias and noise of the gyro put the angle, integrated as the controller integrates, at every tick.
    fn drift_rad(&self, seed: u64, ticks: usize) -> Vec<f64> {
        let gyro = self.gyro(seed);
        let mut random = Random::new(gyro.seed, 0);
        let mut sample = || gyro.bias_rad_s + gyro.white_sigma_rad_s * random.normal();
        let (mut last, mut angle) = (sample(), 0.0);
        let mut angles = vec![0.0];
        for _ in 1..ticks {
            let next = sample();
            angle += 0.5 * self.period() * (last + next);
            last = next;
            angles.push(angle);
        }
        angles
    }

    fn sine(&self) -> Base {
        Base::Sine { amplitude_rad: self.amplitude_deg * RADIANS, frequency_hz: self.frequency_hz, ramp_s: 1.0 }
    }
}

/// A design on its bench, with its filter built.
pub struct Trial<'a> {
    bench: &'a Bench,
    axis: Platform,
    filter: Box<dyn LoopFilter>,
}

impl<'a> Trial<'a> {
    /// Builds the filter and checks the controller.
    ///
    /// # Errors
    /// Settings that cannot be used.
    pub fn new(bench: &'a Bench, family: &Family, design: &Design) -> Result<Self, SettingsError> {
        Ok(Self { bench, axis: bench.axis(design.controller, 0.0)?, filter: family.build(&design.parameters)? })
    }

    /// The sine run: its record.
    ///
    /// # Errors
    /// As [`Platform::run`].
    pub fn sine(&mut self, seed: u64) -> Result<Record, ConfigError> {
        self.bench.run(&self.axis, &mut *self.filter, &self.bench.sine(), seed, 0.0, RESIDUAL_RUN_S)
    }

    /// Residual of the sine run.
    ///
    /// # Errors
    /// As [`Platform::run`].
    pub fn residual(&mut self, seed: u64) -> Result<Residual, ConfigError> {
        Ok(measure::residual(&self.sine(seed)?, RESIDUAL_FROM_S, self.bench.period()))
    }

    /// Jitter in motion: what the gyro's noise adds to the voltage during the sine, percent.
    ///
    /// # Errors
    /// As [`Platform::run`].
    pub fn motion_jitter(&mut self, seed: u64, other: u64) -> Result<f64, ConfigError> {
        let (a, b) = (self.sine(seed)?, self.sine(other)?);
        let volts = self.bench.plant.voltage_max_v;
        Ok(measure::motion_jitter(&a, &b, RESIDUAL_FROM_S, RESIDUAL_RUN_S, self.bench.period(), volts))
    }

    /// Rest jitter 6 to 14 s after the tilt, percent of the supply, with gains times `factor` and `more_s` of delay.
    ///
    /// # Errors
    /// As [`Platform::run`].
    pub fn jitter_after_tilt(&mut self, seed: u64, factor: f64, more_s: f64) -> Result<f64, ConfigError> {
        let base = Base::Tilt { amplitude_rad: TILT_DEG * RADIANS, duration_s: TILT_S };
        self.jitter(&base, seed, factor, more_s)
    }

    /// Rest jitter of a platform that was never disturbed, over the same window.
    ///
    /// # Errors
    /// As [`Platform::run`].
    pub fn jitter_undisturbed(&mut self, seed: u64) -> Result<f64, ConfigError> {
        self.jitter(&Base::Constant { angle_rad: 0.0 }, seed, 1.0, 0.0)
    }

    fn jitter(&mut self, base: &Base, seed: u64, factor: f64, more_s: f64) -> Result<f64, ConfigError> {
        let axis = if factor == 1.0 && more_s == 0.0 {
            self.axis.clone()
        } else {
            self.axis.with(self.axis.controller.scaled(factor), more_s)?
        };
        let record = self.bench.run(&axis, &mut *self.filter, base, seed, 0.0, REST_RUN_S)?;
        let volts = self.bench.plant.voltage_max_v;
        Ok(measure::rest_jitter(&record, REST_FROM_S, REST_TO_S, self.bench.period(), volts))
    }

    /// Largest tested gain factor with a quiet rest after the tilt (1: none of them).
    ///
    /// # Errors
    /// As [`Platform::run`].
    pub fn gain_margin(&mut self, seed: u64) -> Result<f64, ConfigError> {
        let mut margin = 1.0;
        for factor in GAIN_FACTORS {
            if self.jitter_after_tilt(seed, factor, 0.0)? > QUIET_PERCENT {
                break;
            }
            margin = factor;
        }
        Ok(margin)
    }

    /// Largest tested added delay with a quiet rest after the tilt, ms.
    ///
    /// # Errors
    /// As [`Platform::run`].
    pub fn delay_margin_ms(&mut self, seed: u64) -> Result<f64, ConfigError> {
        let mut margin = 0.0;
        for delay in DELAYS_S {
            if self.jitter_after_tilt(seed, 1.0, delay)? > QUIET_PERCENT {
                break;
            }
            margin = 1e3 * delay;
        }
        Ok(margin)
    }

    /// Largest angle while the base tilts by `tilt_deg` in `duration_s`, deg.
    ///
    /// # Errors
    /// As [`Platform::run`].
    pub fn tilt_peak_deg(&mut self, seed: u64, tilt_deg: f64, duration_s: f64) -> Result<f64, ConfigError> {
        let base = Base::Tilt { amplitude_rad: tilt_deg * RADIANS, duration_s };
        let record = self.bench.run(&self.axis, &mut *self.filter, &base, seed, 0.0, duration_s + 3.0)?;
        Ok(measure::residual(&record, 0.0, self.bench.period()).max_deg)
    }

    /// Levelling from `start_deg` for 25 s on a base that stands at that angle.
    ///
    /// # Errors
    /// As [`Platform::run`].
    pub fn levelling(&mut self, seed: u64, start_deg: f64) -> Result<Levelling, ConfigError> {
        let angle = start_deg * RADIANS;
        let base = Base::Constant { angle_rad: angle };
        let record = self.bench.run(&self.axis, &mut *self.filter, &base, seed, angle, LEVEL_RUN_S)?;
        let period = self.bench.period();
        let drift = self.bench.drift_rad(seed, record.rows.len());
        Ok(Levelling {
            error_deg: measure::final_error_deg(&record, LEVEL_MEAN_S, period),
            own_deg: measure::final_error_against(&record, &drift, LEVEL_MEAN_S, period),
        })
    }
}

/// What is left after levelling: mean |angle| of the last 2 s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Levelling {
    /// Against the vertical, deg.
    pub error_deg: f64,
    /// Against where the gyro's bias and noise, integrated, put the vertical, deg: the loop's own share, which no gyro can excuse.
    pub own_deg: f64,
}
