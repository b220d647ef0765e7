//! The experiments that a tuning is judged by, on one platform: 10 deg at 1 Hz, rest after a tilt, margins, levelling.
//!
//! A [`Design`] is a controller and a filter. Every experiment runs it on the [`Bench`] with a seed of gyro noise.

use stillrate::ConfigError;

use super::RADIANS;
use super::base::Base;
use super::bench::{Bench, Design};
use super::family::Family;
use super::loop_filter::LoopFilter;
use super::measure::{self, Residual};
use super::platform::{Platform, Record};
use crate::settings_map::SettingsError;

/// The excitation before every measurement of rest jitter: 15 deg in 0.5 s.
const TILT_DEG: f64 = 15.0;
const TILT_S: f64 = 0.5;
/// Rest jitter is measured from 6 to 14 s after the tilt's end.
const REST_FROM_S: f64 = TILT_S + 6.0;
const REST_TO_S: f64 = TILT_S + 14.0;
/// The moving mean needs this much beyond the window.
const REST_RUN_S: f64 = REST_TO_S + 0.4;
/// Residual: from 3 s on, when the ramp of 1 s has died out.
pub(super) const RESIDUAL_FROM_S: f64 = 3.0;
const RESIDUAL_RUN_S: f64 = 9.0;
/// Where levelling starts, deg, how long it may take, and over what time its error is averaged.
const LEVEL_FROM_DEG: f64 = 20.0;
const LEVEL_RUN_S: f64 = 25.0;
const LEVEL_MEAN_S: f64 = 2.0;
/// A run is quiet when its rest jitter stays below this many percent of the supply: no limit cycle.
pub(super) const QUIET_PERCENT: f64 = 1.0;
/// Factors on kappa and kd that the gain margin tries.
const GAIN_FACTORS: [f64; 8] = [1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0, 8.0];
/// Added delays that the delay margin tries, s.
const DELAYS_S: [f64; 8] = [0.002, 0.005, 0.010, 0.015, 0.020, 0.030, 0.040, 0.060];

/// A design on its bench, with its filter built.
pub(crate) struct Trial<'a> {
    bench: &'a Bench,
    axis: Platform,
    filter: Box<dyn LoopFilter>,
}

impl<'a> Trial<'a> {
    /// Builds the filter and checks the controller.
    pub(crate) fn new(bench: &'a Bench, family: &Family, design: &Design) -> Result<Self, SettingsError> {
        Ok(Self { bench, axis: bench.axis(design.controller, 0.0)?, filter: family.build(&design.parameters)? })
    }

    /// The sine run: its record.
    pub(crate) fn sine(&mut self, seed: u64) -> Result<Record, ConfigError> {
        let base = Base::Sine {
            amplitude_rad: self.bench.amplitude_deg * RADIANS,
            frequency_hz: self.bench.frequency_hz,
            ramp_s: 1.0,
        };
        self.bench.run(&self.axis, &mut *self.filter, &base, seed, 0.0, RESIDUAL_RUN_S)
    }

    /// Residual of the sine run.
    pub(crate) fn residual(&mut self, seed: u64) -> Result<Residual, ConfigError> {
        Ok(measure::residual(&self.sine(seed)?, RESIDUAL_FROM_S, self.bench.period()))
    }

    /// Jitter in motion: what the gyro's noise adds to the voltage during the sine, percent.
    pub(crate) fn motion_jitter(&mut self, seed: u64, other: u64) -> Result<f64, ConfigError> {
        let (a, b) = (self.sine(seed)?, self.sine(other)?);
        let volts = self.bench.plant.voltage_max_v;
        Ok(measure::motion_jitter(&a, &b, RESIDUAL_FROM_S, RESIDUAL_RUN_S, self.bench.period(), volts))
    }

    /// Rest jitter 6 to 14 s after the tilt, percent of the supply, with gains times `factor` and `more_s` of delay.
    pub(crate) fn jitter_after_tilt(&mut self, seed: u64, factor: f64, more_s: f64) -> Result<f64, ConfigError> {
        let base = Base::Tilt { amplitude_rad: TILT_DEG * RADIANS, duration_s: TILT_S };
        self.jitter(&base, seed, factor, more_s)
    }

    /// Rest jitter of a platform that was never disturbed, over the same window.
    pub(crate) fn jitter_undisturbed(&mut self, seed: u64) -> Result<f64, ConfigError> {
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
    pub(crate) fn gain_margin(&mut self, seed: u64) -> Result<f64, ConfigError> {
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
    pub(crate) fn delay_margin_ms(&mut self, seed: u64) -> Result<f64, ConfigError> {
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
    pub(crate) fn tilt_peak_deg(&mut self, seed: u64, tilt_deg: f64, duration_s: f64) -> Result<f64, ConfigError> {
        let base = Base::Tilt { amplitude_rad: tilt_deg * RADIANS, duration_s };
        let record = self.bench.run(&self.axis, &mut *self.filter, &base, seed, 0.0, duration_s + 3.0)?;
        Ok(measure::residual(&record, 0.0, self.bench.period()).max_deg)
    }

    /// Levelling from 20 deg for 25 s on a base that stands at that angle.
    pub(crate) fn levelling(&mut self, seed: u64) -> Result<Levelling, ConfigError> {
        let angle = LEVEL_FROM_DEG * RADIANS;
        let base = Base::Constant { angle_rad: angle };
        let record = self.bench.run(&self.axis, &mut *self.filter, &base, seed, angle, LEVEL_RUN_S)?;
        let period = self.bench.period();
        let drift = self.bench.drift_rad(seed, record.rows.len());
        Ok(Levelling {
            error_deg: measure::final_error_deg(&record, &[], LEVEL_MEAN_S, period),
            own_deg: measure::final_error_deg(&record, &drift, LEVEL_MEAN_S, period),
        })
    }
}

/// What is left after levelling: mean |angle| of the last 2 s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Levelling {
    /// Against the vertical, deg.
    pub(crate) error_deg: f64,
    /// Against where the gyro's bias and noise, integrated, put the vertical, deg: the loop's own share, which no gyro can excuse.
    pub(crate) own_deg: f64,
}

#[cfg(test)]
mod tests {
    use super::super::controller::Controller;
    use super::super::family::standard;
    use super::*;

    #[test]
    fn levelling_tells_the_loop_from_its_gyro() {
        // A biased gyro tilts the platform by bias times 25 s, less half of the last 2 s; the loop has no part in that.
        let bench = Bench { bias_dps: 0.02, ..Bench::paper(50.0) };
        let design = Design { controller: Controller::default(), parameters: vec![] };
        let none = &standard(bench.sample_rate_hz, bench.noise)[0];
        let mut trial = Trial::new(&bench, none, &design).unwrap();
        let runs: Vec<_> = (1..9).map(|seed| trial.levelling(seed).unwrap()).collect();
        let mean = |f: fn(&Levelling) -> f64| runs.iter().map(f).sum::<f64>() / 8.0;
        // Angle random walk: 0.0152 deg/sqrt(s) over 24 s, 0.074 deg a run.
        assert!((mean(|l| l.error_deg) - 0.48).abs() < 4.0 * 0.074 / 8.0_f64.sqrt(), "{}", mean(|l| l.error_deg));
        assert!(mean(|l| l.own_deg) < 0.03, "{}", mean(|l| l.own_deg));
    }
}
