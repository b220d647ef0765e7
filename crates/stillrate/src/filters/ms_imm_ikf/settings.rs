//! Settings of the recommended bank and the numbers that follow from them.

use super::{MsImmIkf, OSCILLATORS, Pace, RUNGS};
use crate::adaptive::manoeuvre_frequency::FrequencyMemory;
use crate::error::ConfigError;
use crate::noise::{GyroNoise, range};
use crate::ranges;
use crate::real::Real;
use crate::settings::{Settings, Visit, visit_noise};

/// Settings of [`MsImmIkf`]. Only the sample rate and the noise must be given.
///
/// # Example
/// ```
/// use stillrate::{Filter, GyroNoise, Settings, filters::MsImmIkfSettings};
/// let settings = MsImmIkfSettings::defaults(100.0, GyroNoise::from_density_two_sided(0.015));
/// assert_eq!(settings.ladder_hz[..settings.ladder_count], [2.0, 8.0, 32.0, 128.0]);
/// let light = MsImmIkfSettings { oscillator_count: 0, bandwidth_hz: 10.0, ..settings.clone() };
/// assert_eq!(settings.build::<f64>()?.models(), 1 + 4 + 4); // a random walk, rungs, oscillators
/// assert_eq!(light.build::<f64>()?.models(), 1 + 3); // the widest rung stays
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct MsImmIkfSettings {
    /// Nominal sample rate, Hz.
    pub sample_rate_hz: f64,
    /// The gyro's noise.
    pub noise: GyroNoise,
    /// Half-widths D of the double oscillators, rad/s; default 1, 3, 10, 30. None at all is the light form.
    pub oscillators: [f64; OSCILLATORS],
    /// How many of them are in use.
    pub oscillator_count: usize,
    /// Bandwidths of the Singer rungs, Hz; default 2, 8, 32, ... up to the first that reaches the sample rate.
    pub ladder_hz: [f64; RUNGS],
    /// How many of them are in use.
    pub ladder_count: usize,
    /// Mean dwell time in a moving model, s; default 20.
    pub dwell_time_s: f64,
    /// Mean dwell time in the random-walk model, s; default 100.
    pub rest_dwell_time_s: f64,
    /// Memory of the manoeuvre frequency, s; default 5.
    pub frequency_memory_s: f64,
    /// Memory of the mean square acceleration behind the prior variances, s; default 1.
    pub variance_memory_s: f64,
    /// Cap on the mean square acceleration that an oscillator takes from other models, in units of the followed one; default 4; infinite: no cap.
    pub derivative_cap: f64,
    /// Rungs above this bandwidth stay out of the moments, Hz; default 33; may be infinite.
    pub moment_limit_hz: f64,
    /// Interval at which the oscillators' coefficients follow the frequency, s; default 0.02; 0: every sample.
    pub refresh_s: f64,
    /// Known bandwidth of the motion, Hz: rungs above it are left out, but never the widest; default infinite.
    pub bandwidth_hz: f64,
    /// Prior probability of an outlier; 0 (default) switches the outlier model off.
    pub outlier_probability: f64,
    /// Full scale of the sensor, deg/s: samples there count as one-sided bounds; default infinite.
    pub saturation_dps: f64,
}

impl Settings for MsImmIkfSettings {
    const METHOD: &'static str = "ms-imm-ikf";
    type Filter<T: Real> = MsImmIkf<T>;

    fn defaults(sample_rate_hz: f64, noise: GyroNoise) -> Self {
        let (ladder_hz, ladder_count) = ladder(sample_rate_hz);
        let mut oscillators = [0.0; OSCILLATORS];
        oscillators[..4].copy_from_slice(&[1.0, 3.0, 10.0, 30.0]);
        Self {
            sample_rate_hz,
            noise,
            oscillators,
            oscillator_count: 4,
            ladder_hz,
            ladder_count,
            dwell_time_s: 20.0,
            rest_dwell_time_s: 100.0,
            frequency_memory_s: 5.0,
            variance_memory_s: 1.0,
            derivative_cap: 4.0,
            moment_limit_hz: 33.0,
            refresh_s: 0.02,
            bandwidth_hz: f64::INFINITY,
            outlier_probability: 0.0,
            saturation_dps: f64::INFINITY,
        }
    }

    fn visit<V: Visit>(&mut self, visitor: &mut V) {
        visitor.number("sample_rate_hz", &mut self.sample_rate_hz);
        visit_noise(visitor, &mut self.noise);
        visitor.list("oscillators", &mut self.oscillators, &mut self.oscillator_count);
        visitor.list("ladder_hz", &mut self.ladder_hz, &mut self.ladder_count);
        visitor.number("dwell_time_s", &mut self.dwell_time_s);
        visitor.number("rest_dwell_time_s", &mut self.rest_dwell_time_s);
        visitor.number("frequency_memory_s", &mut self.frequency_memory_s);
        visitor.number("variance_memory_s", &mut self.variance_memory_s);
        visitor.number("derivative_cap", &mut self.derivative_cap);
        visitor.number("moment_limit_hz", &mut self.moment_limit_hz);
        visitor.number("refresh_s", &mut self.refresh_s);
        visitor.number("bandwidth_hz", &mut self.bandwidth_hz);
        visitor.number("outlier_probability", &mut self.outlier_probability);
        visitor.number("saturation_dps", &mut self.saturation_dps);
    }

    fn build<T: Real>(&self) -> Result<MsImmIkf<T>, ConfigError> {
        ranges::check(self)?;
        let (rate, noise) = (self.sample_rate_hz, self.noise);
        let period = 1.0 / rate;
        let variance = noise.sample_variance(rate);
        let walk = noise.rate_random_walk_dps_sqrt_s;
        let (dwell, rest_dwell) = (self.dwell_time_s * rate, self.rest_dwell_time_s * rate);
        let (saturation, refresh) = (self.saturation_dps, self.refresh_s);
        let outlier = self.outlier_probability;
        let (rung_count, rung_intensity, rung_counts_in) = rungs(self, variance)?;
        let mut oscillator_intensity = [0.0; OSCILLATORS];
        let oscillator_count = self.oscillator_count.min(OSCILLATORS);
        for (intensity, width) in oscillator_intensity.iter_mut().zip(self.oscillators).take(oscillator_count) {
            if width * period > WIDEST_OSCILLATOR {
                let range = "at most 1e5 times sample_rate_hz, in";
                return Err(ConfigError::new("oscillators", width, "rad/s", range));
            }
            let width = width * period;
            *intensity = 16.0 * variance * width * width * width * width;
        }
        let angle_max = 0.5 * core::f64::consts::PI;
        // 1.2 rad/s, but always below the upper limit, also at a few samples an hour.
        let angle_min = (1.2 * period).least(0.5 * angle_max);
        let missing_acceleration = core::f64::consts::SQRT_2 * variance * cube(core::f64::consts::TAU * 16.0 * period);
        let others = (rung_count + oscillator_count) as f64;
        let filter = MsImmIkf {
            period_s: T::of(period),
            measurement_variance: T::of(variance),
            noise_share: T::of(NOISE_SHARE * variance * period),
            limit: range(variance.root()),
            walk_variance: T::of(walk * walk * period),
            missing_acceleration: T::of(missing_acceleration),
            start_variance: [
                T::of(1e3 * missing_acceleration * period * period),
                T::of(1e6 * missing_acceleration * cube(period) * period),
            ],
            rung_count: rung_count as u32,
            oscillator_count: oscillator_count as u32,
            rung_intensity: rung_intensity.map(T::of),
            rung_counts_in: rung_counts_in.map(T::of),
            oscillator_intensity: oscillator_intensity.map(T::of),
            derivative_cap: T::of(self.derivative_cap).least(T::LARGEST),
            memory: FrequencyMemory {
                frequency_periods: T::of(self.frequency_memory_s * rate),
                variance_periods: T::of(self.variance_memory_s * rate),
                angle_min: T::of(angle_min),
                angle_max: T::of(angle_max),
                rate_square_min: T::of(1e-8 * variance),
            },
            start_angle: T::of((START_FREQUENCY_RAD_S * period).limited(angle_min, angle_max)),
            refresh_samples: T::of(f64::from((refresh * rate + 1e-9).least(16_000_000.0).most(1.0) as u32)),
            outlier_probability: T::of(outlier),
            saturation: T::of(saturation).least(T::LARGEST),
            dwell_periods: T::of(dwell),
            rest_dwell_periods: T::of(rest_dwell),
            share: T::of(1.0 / others),
            nominal: Pace::ZERO,
        };
        Ok(MsImmIkf { nominal: filter.pace(T::ONE), ..filter })
    }
}

/// Share of the noise density (a variance times a second) in the variances of lacking derivatives and in the cap, so that they
/// never vanish.
const NOISE_SHARE: f64 = 1e-3;
/// Manoeuvre frequency before anything is known: one hertz, rounded as the reference outputs have it.
#[allow(clippy::approx_constant)]
const START_FREQUENCY_RAD_S: f64 = 6.28;

/// Bandwidths 2, 8, 32, ... Hz up to the first that reaches the sample rate: that rung passes everything and keeps the
/// bank no worse than raw whatever the motion.
fn ladder(sample_rate_hz: f64) -> ([f64; RUNGS], usize) {
    let mut rungs = [0.0; RUNGS];
    let (mut count, mut bandwidth) = (0, 2.0);
    for rung in &mut rungs {
        *rung = bandwidth;
        count += 1;
        if bandwidth >= sample_rate_hz {
            break;
        }
        bandwidth *= 4.0;
    }
    (rungs, count)
}

/// Bandwidth of a rung over the sample rate at most: far beyond half of it every rung passes everything.
const WIDEST_RUNG: f64 = 1e4;
/// Width of an oscillator in radians a sample at most.
const WIDEST_OSCILLATOR: f64 = 1e5;

fn cube(x: f64) -> f64 {
    x * x * x
}

type Rungs = (usize, [f64; RUNGS], [f64; RUNGS]);

/// Number of rungs in use, their process noise R (2 pi f T)^4, and whether each counts in the moments.
fn rungs(settings: &MsImmIkfSettings, variance: f64) -> Result<Rungs, ConfigError> {
    let given = settings.ladder_count.min(RUNGS);
    if given == 0 {
        return Err(ConfigError::new("ladder_hz", 0.0, "entries", "at least 1"));
    }
    let (mut intensity, mut counts_in, mut used) = ([0.0; RUNGS], [0.0; RUNGS], 0);
    for (k, &frequency) in settings.ladder_hz.iter().enumerate().take(given) {
        if frequency > WIDEST_RUNG * settings.sample_rate_hz {
            let range = "at most 1e4 times sample_rate_hz, in";
            return Err(ConfigError::new("ladder_hz", frequency, "Hz", range));
        }
        // The widest rung is the guard that passes everything: a bandwidth never drops it.
        if frequency > settings.bandwidth_hz && k + 1 < given {
            continue;
        }
        let corner = core::f64::consts::TAU * frequency / settings.sample_rate_hz;
        if let (Some(q), Some(c)) = (intensity.get_mut(used), counts_in.get_mut(used)) {
            *q = variance * corner * corner * corner * corner;
            *c = if frequency > settings.moment_limit_hz { 0.0 } else { 1.0 };
        }
        used += 1;
    }
    Ok((used, intensity, counts_in))
}
