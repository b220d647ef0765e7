//! What filters are compared on: one platform with its timing, its gyro and its standard motion, and the designs that are tried on it.
//!
//! Seeds of gyro noise are always explicit, so that tuning and validation use different ones.

use stillrate::{ConfigError, GyroNoise, Real};

use super::RADIANS;
use super::base::Base;
use super::controller::Controller;
use super::loop_filter::LoopFilter;
use super::plant::Plant;
use super::platform::{GyroErrors, Platform, Record};
use crate::random::Random;

/// A platform with its gyro, waiting for a controller and a filter.
///
/// # Example
/// ```
/// use stillrate_lab::servo::{bench::Bench, controller::Controller};
/// let bench = Bench::paper(200.0);
/// let axis = bench.axis(Controller::default(), 0.020).unwrap(); // 20 ms of delay more than the bench has
/// assert!((axis.period_s() - 5e-3).abs() < 1e-15);
/// // The same density at any rate: 0.1074 deg/s a sample at 50 Hz.
/// assert!((bench.noise.density_dps_sqrt_hz * 50_f64.sqrt() - 0.1074).abs() < 1e-15);
/// ```
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
///
/// # Example
/// ```
/// use stillrate_lab::servo::bench::{Bench, Design};
/// use stillrate_lab::servo::{controller::Controller, family::standard, study::tilt_table};
/// let bench = Bench::paper(50.0);
/// let pt1 = &standard(50.0, bench.noise)[1];
/// let slow = Design { controller: Controller::default(), parameters: vec![1.0] }; // cut off at 1 Hz
/// let fast = Design { parameters: vec![10.0], ..slow.clone() };
/// let peak = |design| tilt_table(&bench, pt1, design, &[10.0], 0.4, &[1]).unwrap()[0];
/// assert!(peak(&slow) > peak(&fast)); // lag in the loop lets the base carry the platform along
/// ```
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

    /// The platform with a controller and `more_s` of added delay.
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
    pub(crate) fn run(
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

    /// Control period, s.
    pub(crate) fn period(&self) -> f64 {
        1.0 / self.sample_rate_hz
    }

    /// Where bias and noise of the gyro put the angle, integrated as the controller integrates, at every tick.
    pub(crate) fn drift_rad(&self, seed: u64, ticks: usize) -> Vec<f64> {
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
}
