//! What a setting may be: one range for each kind of quantity, wide enough for any gyro in any common unit and narrow enough for `f32`.
//!
//! A step squares and multiplies what the settings scale: an innovation reaches [`RANGE_SIGMAS`](crate::noise::RANGE_SIGMAS) standard
//! deviations, a coasting rate what the model lets it drift to. The bounds keep the squares of all of these, over the smallest
//! variance, below 3e38, the largest `f32`:
//!
//! * noise: 1e-9 deg/s/sqrt(Hz) is a thousandth of the best fibre-optic gyro, 1e3 a poor MEMS gyro in counts of 28 bits;
//! * acceleration: 1e-6 deg/s^2 is a drift, 1e8 a hundred times the shock that breaks a MEMS gyro, in deg/s^2 or counts;
//! * time constants: a millionth of a second to eleven days; sample rates: a sample in a quarter of an hour to 1 MHz;
//! * [`LARGEST_JITTER_DPS2`]: an 8 kHz gyro with a thousand times the noise of a poor one has 1e7;
//! * [`LARGEST_SWING_DPS`]: what the acceleration builds up to within its own time constant, 2.8 million turns a second.
//!
//! Where a filter is built, every setting is held against the table [`range_of`], and then what depends on two of them against both.

use crate::error::ConfigError;
use crate::real::Real;
use crate::settings::{Settings, Visit};

/// The values that a setting may have.
///
/// # Example
/// ```
/// use stillrate::ranges::SAMPLE_RATE;
/// assert_eq!(SAMPLE_RATE.check("sample_rate_hz", 50.0), Ok(50.0));
/// let refusal = SAMPLE_RATE.check("sample_rate_hz", 1e30).unwrap_err();
/// assert_eq!(refusal.to_string(), "sample_rate_hz = 1e30 (must be from 1e-3 to 1e6 Hz)");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Smallest value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
    /// Whether the largest value itself is one too many.
    pub open: bool,
    /// A value outside that is allowed as well: zero or infinity, where it switches something off.
    pub also: Option<f64>,
    /// Unit of the values, empty for pure numbers.
    pub unit: &'static str,
    /// The range in words, to be read after "must be".
    pub words: &'static str,
}

impl Range {
    /// Passes a value on if it lies in the range.
    ///
    /// # Errors
    /// [`ConfigError`] that names field, value, unit and range otherwise.
    pub fn check(&self, field: &'static str, value: f64) -> Result<f64, ConfigError> {
        let inside = value >= self.low && if self.open { value < self.high } else { value <= self.high };
        if inside || self.also == Some(value) {
            Ok(value)
        } else {
            Err(ConfigError::new(field, value, self.unit, self.words))
        }
    }
}

/// A range and its words from the same numbers.
macro_rules! range {
    ($low:literal to $high:literal, $unit:literal) => {
        range!(@ $low, $high, false, None, $unit, concat!("from ", stringify!($low), " to ", stringify!($high)))
    };
    ($low:literal to below $high:literal, $unit:literal) => {
        range!(@ $low, $high, true, None, $unit, concat!("from ", stringify!($low), " to below ", stringify!($high)))
    };
    ($low:literal to $high:literal or 0, $unit:literal) => {
        range!(@ $low, $high, false, Some(0.0), $unit, concat!("0 or from ", stringify!($low), " to ", stringify!($high)))
    };
    ($low:literal to $high:literal or inf, $unit:literal) => {
        range!(@ $low, $high, false, Some(f64::INFINITY), $unit,
            concat!("inf or from ", stringify!($low), " to ", stringify!($high)))
    };
    (@ $low:literal, $high:literal, $open:literal, $also:expr, $unit:literal, $words:expr) => {
        Range { low: $low as f64, high: $high as f64, open: $open, also: $also, unit: $unit, words: $words }
    };
}

/// Sample rates.
pub const SAMPLE_RATE: Range = range!(1e-3 to 1e6, "Hz");
/// Sample rates of the recommended bank, whose ladder of bandwidths ends at 32768 Hz.
pub const BANK_SAMPLE_RATE: Range = range!(1e-3 to 32768, "Hz");
/// White noise densities N.
pub const NOISE_DENSITY: Range = range!(1e-9 to 1e3, "deg/s/sqrt(Hz)");
/// Rate random walks K.
pub const RATE_RANDOM_WALK: Range = range!(0 to 1e3, "deg/s/sqrt(s)");
/// Variances of a rate: all that [`NOISE_DENSITY`] gives at a [`SAMPLE_RATE`], with a margin.
pub const RATE_VARIANCE: Range = range!(1e-22 to 1e13, "(deg/s)^2");
/// Largest accelerations.
pub const ACCELERATION: Range = range!(1e-6 to 1e8, "deg/s^2");
/// Variances of an acceleration.
pub const ACCELERATION_VARIANCE: Range = range!(1e-18 to 1e16, "(deg/s^2)^2");
/// Reciprocals of a time constant.
pub const DECAY: Range = range!(1e-6 to 1e6, "1/s");
/// Times that something is remembered or dwelt in.
pub const DURATION: Range = range!(1e-6 to 1e9, "s");
/// Cut-offs and bandwidths.
pub const FREQUENCY: Range = range!(1e-6 to 1e6, "Hz");
/// Forgetting factors.
pub const FORGETTING_FACTOR: Range = range!(1e-6 to 1.0, "");
/// Probabilities.
pub const PROBABILITY: Range = range!(0 to 1, "");
/// Standard deviations, factors and the like that may be nothing.
pub const NUMBER: Range = range!(0 to 1e6, "");
/// The same where nothing makes no sense.
pub const POSITIVE_NUMBER: Range = range!(1e-6 to 1e6, "");

const LENGTH_OF_FIR: Range = range!(1 to 128, "taps");
pub(crate) const TAP: Range = range!(-1e6 to 1e6, "");
const COEFFICIENT: Range = range!(-256 to 256, "");
const QUALITY: Range = range!(0.05 to 100, "");
const BETA: Range = range!(0 to 1e9, "");
const ORDER: Range = range!(1 to 2, "");
const SAMPLES_KEPT: Range = range!(1 to 1e9, "");
const VARIANCE_RATIO: Range = range!(0 to 1e12, "");
const SMOOTHING: Range = range!(1e-6 to 1, "");
const STEP_SIZE: Range = range!(1e-9 to below 2, "");
const OSCILLATOR: Range = range!(1e-4 to 1e4, "rad/s");
const OUTLIER_PROBABILITY: Range = range!(0 to below 0.5, "");
const FADING_MEMORY: Range = range!(0 to below 1, "");
const ALPHA_VARIANCE: Range = range!(0 to 1e6, "");
const ALPHA_DENSITY: Range = range!(0 to 1e6, "1/s");
const REST_ALPHA: Range = range!(0 to 1e6, "1/s");
const REFRESH: Range = range!(0 to 1e9, "s");
pub(crate) const CUTOFF_OR_NONE: Range = range!(1e-6 to 1e6 or 0, "Hz");
const FREQUENCY_OR_NONE: Range = range!(1e-6 to 1e6 or inf, "Hz");
const FULL_SCALE: Range = range!(1e-9 to 1e12 or inf, "deg/s");
const CAP: Range = range!(1e-6 to 1e12 or inf, "");
const MEMORY: Range = range!(1e-9 to 1e12 or inf, "s");

/// The range of a numeric setting of a method (of each number where it is a list); `None` if there is no such setting.
///
/// # Example
/// ```
/// use stillrate::ranges::range_of;
/// assert_eq!(range_of("pt1", "cutoff_hz").unwrap().words, "from 1e-6 to 1e6");
/// ```
#[must_use]
pub fn range_of(method: &str, field: &str) -> Option<&'static Range> {
    Some(match field {
        "sample_rate_hz" if method == "ms-imm-ikf" => &BANK_SAMPLE_RATE,
        "sample_rate_hz" => &SAMPLE_RATE,
        "noise.density_dps_sqrt_hz" => &NOISE_DENSITY,
        "noise.rate_random_walk_dps_sqrt_s" => &RATE_RANDOM_WALK,
        "measurement_variance" | "measurement_variance_dps2" | "process_variance_dps2" | "initial_rate_variance" => {
            &RATE_VARIANCE
        }
        "accel_max_dps2" => &ACCELERATION,
        "initial_acceleration_variance" => &ACCELERATION_VARIANCE,
        "alpha_per_s" => &DECAY,
        "dwell_time_s" | "rest_dwell_time_s" | "frequency_memory_s" | "variance_memory_s" | "memory_s" => &DURATION,
        "cutoff_hz" if method == "fir" => &CUTOFF_OR_NONE,
        "bandwidth_hz" if method == "ms-imm-ikf" => &FREQUENCY_OR_NONE,
        "cutoff_hz" | "minimum_cutoff_hz" | "derivative_cutoff_hz" | "bandwidth_hz" | "ladder_hz" => &FREQUENCY,
        "moment_limit_hz" => &FREQUENCY_OR_NONE,
        "forgetting_factor" | "forgetting_factor_max" | "forgetting_factor_min" => &FORGETTING_FACTOR,
        "transition" | "initial_probability" | "static_stay_probability" => &PROBABILITY,
        "threshold" if method == "cusum-forgetting" => &POSITIVE_NUMBER,
        "threshold" | "drift" | "fading_scale" => &NUMBER,
        "width" | "fading_softening" => &POSITIVE_NUMBER,
        "tau_s" => &MEMORY,
        "length" => &LENGTH_OF_FIR,
        "taps" => &TAP,
        "coefficients" => &COEFFICIENT,
        "quality" => &QUALITY,
        "beta" => &BETA,
        "order" => &ORDER,
        "samples_kept" => &SAMPLES_KEPT,
        "variance_ratio" => &VARIANCE_RATIO,
        "smoothing" => &SMOOTHING,
        "step_size" => &STEP_SIZE,
        "oscillators" => &OSCILLATOR,
        "outlier_probability" => &OUTLIER_PROBABILITY,
        "fading_memory" => &FADING_MEMORY,
        "initial_alpha_variance" => &ALPHA_VARIANCE,
        "alpha_noise_density" => &ALPHA_DENSITY,
        "static_alpha_per_s" => &REST_ALPHA,
        "refresh_s" => &REFRESH,
        "saturation_dps" => &FULL_SCALE,
        "derivative_cap" => &CAP,
        _ => return None,
    })
}

/// The acceleration that white noise looks like from one sample to the next: standard deviation times sample rate, deg/s^2.
pub const LARGEST_JITTER_DPS2: f64 = 1e9;

/// Checks every numeric setting of a method against its range, and the noise of a sample against the sample rate.
///
/// # Errors
/// [`ConfigError`] that names the first one outside its range.
pub(crate) fn check<S: Settings>(settings: &S) -> Result<(), ConfigError> {
    struct Checker {
        method: &'static str,
        rate_hz: f64,
        found: Result<(), ConfigError>,
    }
    impl Checker {
        fn try_number(&mut self, name: &'static str, value: f64) -> Result<(), ConfigError> {
            let Some(range) = range_of(self.method, name) else { return Ok(()) };
            range.check(name, value)?;
            let deviation = match name {
                "sample_rate_hz" => {
                    self.rate_hz = value;
                    return Ok(());
                }
                "noise.density_dps_sqrt_hz" => value * self.rate_hz.root(),
                "measurement_variance" | "measurement_variance_dps2" => value.root(),
                _ => return Ok(()),
            };
            if deviation * self.rate_hz <= LARGEST_JITTER_DPS2 {
                return Ok(());
            }
            let words = "such that the standard deviation of a sample times sample_rate_hz is at most 1e9 deg/s^2, in";
            Err(ConfigError::new(name, value, range.unit, words))
        }
    }
    impl Visit for Checker {
        fn number(&mut self, name: &'static str, value: &mut f64) {
            if self.found.is_ok() {
                self.found = self.try_number(name, *value);
            }
        }
        fn list(&mut self, name: &'static str, values: &mut [f64], count: &mut usize) {
            for value in values.iter_mut().take(*count) {
                self.number(name, value);
            }
        }
        fn choice(&mut self, _: &'static str, _: &'static [&'static str], _: &mut usize) {}
    }
    let mut checker = Checker { method: S::METHOD, rate_hz: 1.0, found: Ok(()) };
    settings.clone().visit(&mut checker);
    checker.found
}

/// The rate that a motion model may build up to within its own time constant: largest acceleration over its decay.
pub const LARGEST_SWING_DPS: f64 = 1e9;

/// Checks the rate that accelerations of a size build up to.
pub(crate) fn check_swing(
    field: &'static str,
    value: f64,
    size_dps2: f64,
    alpha_per_s: f64,
) -> Result<(), ConfigError> {
    if size_dps2 / alpha_per_s <= LARGEST_SWING_DPS {
        Ok(())
    } else {
        let range = "such that the acceleration over alpha_per_s is at most 1e9";
        Err(ConfigError::new(field, value, "deg/s", range))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::GyroNoise;

    /// Counts the numbers that have no range.
    struct Unbounded(&'static str, usize);

    impl Visit for Unbounded {
        fn number(&mut self, name: &'static str, _: &mut f64) {
            assert!(range_of(self.0, name).is_some(), "{}: {name} has no range", self.0);
            self.1 += 1;
        }
        fn list(&mut self, name: &'static str, _: &mut [f64], _: &mut usize) {
            self.number(name, &mut 0.0);
        }
        fn choice(&mut self, _: &'static str, _: &'static [&'static str], _: &mut usize) {}
    }

    fn every_setting_has_a_range_that_holds_its_default<S: Settings>() {
        let mut numbers = Unbounded(S::METHOD, 0);
        for density in [NOISE_DENSITY.low, 0.015, NOISE_DENSITY.high] {
            for rate_hz in [SAMPLE_RATE.low, 0.1, 50.0, 8000.0, 32_768.0, SAMPLE_RATE.high] {
                let mut settings = S::defaults(rate_hz, GyroNoise::from_density_two_sided(density));
                settings.visit(&mut numbers);
                let jitter = density * rate_hz * rate_hz.root();
                if (rate_hz <= 32_768.0 || S::METHOD != "ms-imm-ikf") && jitter <= LARGEST_JITTER_DPS2 {
                    assert_eq!(check(&settings), Ok(()), "{} at {rate_hz} Hz and {density}", S::METHOD);
                    assert!(settings.build::<f32>().is_ok(), "{:?}", settings.build::<f32>().err());
                    assert!(settings.build::<f64>().is_ok());
                }
            }
        }
        assert!(numbers.1 >= 2);
    }

    #[test]
    fn every_setting_of_every_method_has_a_range_that_holds_its_default() {
        macro_rules! all {
            ($($name:ident),* $(,)?) => {
                $(every_setting_has_a_range_that_holds_its_default::<crate::filters::$name>();)*
            };
        }
        crate::methods!(all);
    }
}
