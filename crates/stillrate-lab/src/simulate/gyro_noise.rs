//! What a gyro adds to the rate: white noise, a Gauss-Markov bias, rate random walk, then quantisation, saturation
//! and missing samples.
//!
//! Standard single-axis model (IEEE Std 952-2020, annex C). With sample period T: white noise of two-sided density N
//! has variance N^2 / T a sample; the Gauss-Markov bias b' = phi b + sqrt(1 - phi^2) sigma n, phi = exp(-T / tau),
//! starts stationary; the rate random walk grows by K sqrt(T) n from 0; flicker noise B is a sum of Gauss-Markov
//! processes. The drift (bias + walk + flicker) belongs to the truth: no filter can tell it from rate.

use stillrate::Real;
use stillrate::error::{ConfigError, not_negative, positive};

use super::flicker;
use crate::random::{Generator, Random};

/// Noise figures of a simulated gyro, in deg/s and seconds. [`GyroNoiseModel::bench`] is the one of the beds.
///
/// # Example
/// ```
/// use stillrate_lab::simulate::GyroNoiseModel;
/// let model = GyroNoiseModel { lsb_dps: 0.01, ..GyroNoiseModel::bench() };
/// let record = model.record(&vec![0.0; 1000], 50.0, 7).unwrap();
/// assert_eq!(record.measured_dps.len(), 1000);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GyroNoiseModel {
    /// Two-sided density N of the white noise, deg/s/sqrt(Hz) (angle random walk in deg/sqrt(s)).
    pub density_dps_sqrt_hz: f64,
    /// Standard deviation of the Gauss-Markov bias, deg/s.
    pub bias_sigma_dps: f64,
    /// Correlation time of the Gauss-Markov bias, s.
    pub bias_time_s: f64,
    /// Rate random walk K, deg/s/sqrt(s).
    pub rate_random_walk_dps_sqrt_s: f64,
    /// Flicker noise B ("bias instability"), deg/s: the Allan deviation has its floor at 0.664 B.
    pub bias_instability_dps: f64,
    /// Quantisation step, deg/s; 0 for none.
    pub lsb_dps: f64,
    /// Full scale: readings are clipped to plus or minus this, deg/s; infinite for none.
    pub saturation_dps: f64,
    /// Probability that a gap begins at a sample.
    pub missing_probability: f64,
    /// Length of a gap, samples.
    pub gap_samples: usize,
}

/// A simulated reading and the truth behind it.
///
/// # Example
/// ```
/// use stillrate_lab::simulate::{GyroNoiseModel, NoiseRecord};
/// let model = GyroNoiseModel { density_dps_sqrt_hz: 0.0, ..GyroNoiseModel::bench() };
/// let NoiseRecord { drift_dps, truth_dps, measured_dps } = model.record(&[3.0; 100], 50.0, 1).unwrap();
/// assert_eq!(truth_dps[7], 3.0 + drift_dps[7]); // drift belongs to the truth
/// assert_eq!(measured_dps, truth_dps); // without white noise
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseRecord {
    /// Slow drift: Gauss-Markov bias plus rate random walk plus flicker, deg/s.
    pub drift_dps: Vec<f64>,
    /// Motion plus drift: what a filter is to estimate, deg/s.
    pub truth_dps: Vec<f64>,
    /// What the gyro reads, deg/s; NaN where a sample is missing.
    pub measured_dps: Vec<f64>,
}

/// Streams of one seed, so that switching one effect on does not change the numbers of another.
mod stream {
    pub(super) const WHITE: u64 = 0;
    pub(super) const BIAS: u64 = 1;
    pub(super) const WALK: u64 = 2;
    pub(super) const MISSING: u64 = 3;
    /// And upward, one for each process; the motion of a bed uses 16 to 18.
    pub(super) const FLICKER: u64 = 32;
}

impl GyroNoiseModel {
    /// The gyro of the beds: N = .1068 / sqrt(50), Gauss-Markov .01 deg/s over 20 s, K = .001 deg/s/sqrt(s).
    #[must_use]
    pub fn bench() -> Self {
        Self {
            density_dps_sqrt_hz: 0.1068 / 50.0.root(),
            bias_sigma_dps: 0.01,
            bias_time_s: 20.0,
            rate_random_walk_dps_sqrt_s: 0.001,
            ..Self::perfect()
        }
    }

    /// A gyro that reads the truth.
    ///
    /// # Example
    /// ```
    /// use stillrate_lab::simulate::GyroNoiseModel;
    /// let coarse = GyroNoiseModel { lsb_dps: 0.25, saturation_dps: 2.0, ..GyroNoiseModel::perfect() };
    /// let record = coarse.record(&[0.1, 0.2, -5.0], 50.0, 0).unwrap();
    /// assert_eq!(record.measured_dps, [0.0, 0.25, -2.0]);
    /// ```
    #[must_use]
    pub const fn perfect() -> Self {
        Self {
            density_dps_sqrt_hz: 0.0,
            bias_sigma_dps: 0.0,
            bias_time_s: 1.0,
            rate_random_walk_dps_sqrt_s: 0.0,
            bias_instability_dps: 0.0,
            lsb_dps: 0.0,
            saturation_dps: f64::INFINITY,
            missing_probability: 0.0,
            gap_samples: 1,
        }
    }

    /// Checks every figure.
    ///
    /// # Errors
    /// [`ConfigError`] that names the first one out of range.
    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        not_negative("density_dps_sqrt_hz", self.density_dps_sqrt_hz, "deg/s/sqrt(Hz)")?;
        not_negative("bias_sigma_dps", self.bias_sigma_dps, "deg/s")?;
        positive("bias_time_s", self.bias_time_s, "s")?;
        not_negative("rate_random_walk_dps_sqrt_s", self.rate_random_walk_dps_sqrt_s, "deg/s/sqrt(s)")?;
        not_negative("bias_instability_dps", self.bias_instability_dps, "deg/s")?;
        not_negative("lsb_dps", self.lsb_dps, "deg/s")?;
        if self.saturation_dps.is_nan() || self.saturation_dps <= 0.0 {
            return Err(ConfigError::new("saturation_dps", self.saturation_dps, "deg/s", "> 0"));
        }
        if !(0.0..=1.0).contains(&self.missing_probability) {
            return Err(ConfigError::new("missing_probability", self.missing_probability, "", "from 0 to 1"));
        }
        Ok(())
    }

    /// Reads the motion `motion_dps` (deg/s, regular samples) with this gyro.
    ///
    /// # Errors
    /// [`ConfigError`] for a figure or a sample rate out of range.
    pub fn record(&self, motion_dps: &[f64], sample_rate_hz: f64, seed: u64) -> Result<NoiseRecord, ConfigError> {
        self.check()?;
        let period = 1.0 / positive("sample_rate_hz", sample_rate_hz, "Hz")?;
        let drift_dps = self.drift(motion_dps.len(), period, seed);
        let truth_dps: Vec<f64> = motion_dps.iter().zip(&drift_dps).map(|(m, d)| m + d).collect();
        let measured_dps = self.read(&truth_dps, period, seed);
        Ok(NoiseRecord { drift_dps, truth_dps, measured_dps })
    }

    /// Gauss-Markov bias, started stationary, plus rate random walk from 0, plus flicker.
    fn drift(&self, count: usize, period: f64, seed: u64) -> Vec<f64> {
        let mut bias_noise = Random::new(seed, stream::BIAS);
        let mut walk_noise = Random::new(seed, stream::WALK);
        let phi = (-period / self.bias_time_s).exponential();
        // sqrt(1 - phi^2) without cancellation at high rates.
        let innovation = self.bias_sigma_dps * (-(-2.0 * period / self.bias_time_s).exponential_less_one()).root();
        let walk_step = self.rate_random_walk_dps_sqrt_s * period.root();
        let mut bias = self.bias_sigma_dps * bias_noise.normal();
        let mut walk = 0.0;
        let mut drift: Vec<f64> = (0..count)
            .map(|_| {
                let drift = bias + walk;
                bias = phi * bias + innovation * bias_noise.normal();
                walk += walk_step * walk_noise.normal();
                drift
            })
            .collect();
        flicker::add(&mut drift, self.bias_instability_dps, seed, stream::FLICKER);
        drift
    }

    /// White noise, then full scale, then the converter's step, then gaps.
    fn read(&self, truth: &[f64], period: f64, seed: u64) -> Vec<f64> {
        let mut white = Random::new(seed, stream::WHITE);
        let mut missing = Random::new(seed, stream::MISSING);
        let sigma = self.density_dps_sqrt_hz / period.root();
        let mut gap_left = 0;
        truth
            .iter()
            .map(|rate| {
                let reading = self.convert(rate + sigma * white.normal());
                if missing.uniform() < self.missing_probability {
                    gap_left = self.gap_samples.max(1);
                }
                let gone = gap_left > 0;
                gap_left -= usize::from(gone);
                if gone { f64::NAN } else { reading }
            })
            .collect()
    }

    /// Clips to full scale and rounds to the nearest step inside it.
    fn convert(&self, rate: f64) -> f64 {
        let clipped = rate.clamp(-self.saturation_dps, self.saturation_dps);
        if self.lsb_dps > 0.0 { (clipped / self.lsb_dps).round_ties_even() * self.lsb_dps } else { clipped }
    }
}

#[cfg(test)]
mod tests {
    use super::GyroNoiseModel;

    fn variance(z: &[f64]) -> f64 {
        let mean = z.iter().sum::<f64>() / z.len() as f64;
        z.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / z.len() as f64
    }

    #[test]
    fn white_noise_has_its_density_at_any_rate() {
        for rate in [10.0, 50.0, 1000.0, 8000.0] {
            let model =
                GyroNoiseModel { bias_sigma_dps: 0.0, rate_random_walk_dps_sqrt_s: 0.0, ..GyroNoiseModel::bench() };
            let z = model.record(&vec![0.0; 100_000], rate, 11).unwrap().measured_dps;
            let ratio = variance(&z) / (model.density_dps_sqrt_hz * model.density_dps_sqrt_hz * rate);
            // Four standard errors of a variance of 1e5 normals.
            assert!((ratio - 1.0).abs() < 4.0 * (2.0_f64 / 1e5).sqrt(), "{rate} Hz: {ratio}");
        }
    }

    #[test]
    fn the_bias_starts_stationary_and_forgets_over_its_time() {
        let model = GyroNoiseModel { bias_sigma_dps: 2.0, bias_time_s: 0.5, ..GyroNoiseModel::perfect() };
        let runs = 20_000;
        let (mut first, mut last, mut product) = (0.0, 0.0, 0.0);
        for seed in 0..runs {
            let d = model.record(&[0.0; 6], 10.0, seed).unwrap().drift_dps;
            first += d[0] * d[0];
            last += d[5] * d[5];
            product += d[0] * d[5];
        }
        let n = runs as f64;
        // Variance 4 with standard error 4 sqrt(2/n); correlation exp(-1) after 0.5 s.
        assert!((first / n - 4.0).abs() < 16.0 * (2.0 / n).sqrt());
        assert!((last / n - 4.0).abs() < 16.0 * (2.0 / n).sqrt());
        assert!((product / n - 4.0 * (-1.0_f64).exp()).abs() < 16.0 * (2.0 / n).sqrt());
    }

    #[test]
    fn the_walk_spreads_with_the_root_of_time() {
        let model = GyroNoiseModel { rate_random_walk_dps_sqrt_s: 0.3, ..GyroNoiseModel::perfect() };
        let n = 4000;
        let sum: f64 =
            (0..n).map(|seed| model.record(&[0.0; 101], 20.0, seed).unwrap().drift_dps[100]).map(|d| d * d).sum();
        let expected = 0.09 * 5.0;
        assert!((sum / n as f64 / expected - 1.0).abs() < 4.0 * (2.0 / n as f64).sqrt());
    }

    #[test]
    fn readings_are_quantised_clipped_and_lost() {
        let model = GyroNoiseModel {
            lsb_dps: 0.5,
            saturation_dps: 25.0,
            missing_probability: 0.01,
            gap_samples: 3,
            ..GyroNoiseModel::bench()
        };
        let motion: Vec<f64> = (0..20_000).map(|k| f64::from(k % 80) - 40.0).collect();
        let record = model.record(&motion, 50.0, 1).unwrap();
        let present: Vec<f64> = record.measured_dps.iter().copied().filter(|z| z.is_finite()).collect();
        assert!(present.iter().all(|z| z.abs() <= 25.0 && (z * 2.0).fract() == 0.0));
        let lost = 1.0 - present.len() as f64 / 20_000.0;
        assert!((0.02..0.04).contains(&lost), "{lost}");
        assert!(record.truth_dps.iter().all(|x| x.is_finite()));
    }

    #[test]
    fn one_effect_does_not_change_the_numbers_of_another() {
        let motion = vec![0.0; 100];
        let all = GyroNoiseModel::bench().record(&motion, 50.0, 4).unwrap();
        let no_white = GyroNoiseModel { density_dps_sqrt_hz: 0.0, ..GyroNoiseModel::bench() };
        assert_eq!(all.drift_dps, no_white.record(&motion, 50.0, 4).unwrap().drift_dps);
    }

    #[test]
    fn figures_out_of_range_are_refused_by_name() {
        let model = GyroNoiseModel { bias_time_s: 0.0, ..GyroNoiseModel::bench() };
        assert_eq!(model.record(&[0.0], 50.0, 0).unwrap_err().field, "bias_time_s");
        assert_eq!(GyroNoiseModel::bench().record(&[0.0], -1.0, 0).unwrap_err().field, "sample_rate_hz");
    }
}
