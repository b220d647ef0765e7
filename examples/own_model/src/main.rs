//! A motion model and a filter of one's own, outside stillrate, by its rules.
//!
//! The model is a rate that wanders but always returns, x' = -x / tau + white noise, with the standard deviation sigma: a hand-held
//! camera. Over a step T: F = e^(-T/tau), Q = sigma^2 (1 - F^2). The filter is the scalar Kalman filter for it. Because it is
//! written once against `Real` and `Filter`, it runs in `f32` and `f64`, sample by sample and over many channels, with the same bits.

use stillrate::{Estimate, Filter, Flags, Observer, Real, Sample, error::positive, plain, reals};

plain! {
    /// Checked configuration of the filter.
    pub struct WanderingKf<T> {
        /// Nominal sample period, s.
        pub period_s: T,
        /// Correlation time tau of the motion, s.
        pub correlation_time_s: T,
        /// Variance sigma^2 of the motion, (deg/s)^2.
        pub rate_variance: T,
        /// Variance R of a sample, (deg/s)^2.
        pub measurement_variance: T,
        /// Values beyond this magnitude count as missing, deg/s.
        pub limit: T,
    }
}

reals! {
    /// All that changes from sample to sample.
    pub struct WanderingState {
        /// Rate, deg/s.
        pub rate: T,
        /// Its variance, (deg/s)^2.
        pub variance: T,
        /// 1 once a sample has been seen.
        pub started: T,
    }
}

impl<T: Real> WanderingKf<T> {
    /// Everything is checked here; after this nothing fails.
    fn new(rate_hz: f64, density: f64, sigma: f64, time_s: f64) -> Result<Self, stillrate::ConfigError> {
        let period = 1.0 / positive("sample_rate_hz", rate_hz, "Hz")?;
        let density = positive("density_dps_sqrt_hz", density, "deg/s/sqrt(Hz)")?;
        let sigma = positive("rate_sigma_dps", sigma, "deg/s")?;
        Ok(Self {
            period_s: T::of(period),
            correlation_time_s: T::of(positive("correlation_time_s", time_s, "s")?),
            rate_variance: T::of(sigma * sigma),
            measurement_variance: T::of(density * density / period),
            limit: T::of(1e6),
        })
    }
}

/// The model: F and Q over a time step.
fn over<T: Real>(filter: &WanderingKf<T>, dt: T) -> (T, T) {
    let ratio = dt / filter.correlation_time_s;
    // 1 - F^2 without its cancellation at short steps.
    ((-ratio).exponential(), -(-(ratio + ratio)).exponential_less_one() * filter.rate_variance)
}

impl<T: Real> Filter<T> for WanderingKf<T> {
    type State = WanderingState<T>;

    fn start(&self) -> WanderingState<T> {
        WanderingState { rate: T::ZERO, variance: self.rate_variance, started: T::ZERO }
    }

    fn period(&self) -> T {
        self.period_s
    }

    fn observe<O: Observer<T>>(&self, state: &mut Self::State, sample: Sample<T>, _observer: &mut O) -> Estimate<T> {
        // Missing, absurd and badly timed samples are sorted out the same way for every filter.
        let checked = sample.check(self.limit, self.period_s);
        let fresh = state.started == T::ZERO || checked.restart;
        let (transition, process_noise) = over(self, checked.dt);
        let rate = T::select(checked.moves, transition * state.rate, state.rate);
        let spread = transition * transition * state.variance + process_noise;
        let variance = T::select(checked.moves, spread, state.variance);
        let gain = variance / (variance + self.measurement_variance);
        let corrected = T::select(fresh, checked.value, rate + gain * (checked.value - rate));
        let certain = T::select(fresh, self.measurement_variance, (T::ONE - gain) * variance);
        // A missing sample leaves the prediction. Selects, not branches: the same path for every sample.
        state.rate = T::select(checked.present, corrected, rate).flushed();
        state.variance = T::select(checked.present, certain, variance);
        state.started = T::select(checked.present, T::ONE, state.started);
        Estimate {
            rate: state.rate,
            acceleration: T::ZERO,
            variance: state.variance,
            flags: checked.flags.with(Flags::NO_DATA_YET.when(state.started == T::ZERO)),
        }
    }
}

/// White noise of unit variance: the sum of twelve uniform numbers of a generator with a seed.
fn noise(seed: &mut u64) -> f64 {
    (0..12).fold(-6.0, |sum, _| {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        sum + (*seed >> 11) as f64 / (1_u64 << 53) as f64
    })
}

/// A minute of a hand-held camera at 200 Hz that the model describes: truth and samples.
fn record() -> Vec<(f64, f64)> {
    let (mut seed, mut rate) = (1_u64, 0.0);
    let transition = (-0.005_f64 / 0.3).exp();
    (0..12_000)
        .map(|_| {
            rate = transition * rate + 3.0 * (1.0 - transition * transition).sqrt() * noise(&mut seed);
            (rate, rate + 1.0 * noise(&mut seed))
        })
        .collect()
}

/// RMS error of the samples and of the filter's estimates, deg/s.
fn errors<T: Real>() -> Result<(f64, f64), stillrate::ConfigError> {
    let filter = WanderingKf::<T>::new(200.0, 1.0 / 200.0_f64.sqrt(), 3.0, 0.3)?;
    let mut state = filter.start();
    let (mut raw, mut clean, count) = (0.0, 0.0, record().len() as f64);
    for (truth, sample) in record() {
        let estimate = filter.step(&mut state, Sample { value: T::of(sample), dt: filter.period() });
        raw += (sample - truth).powi(2);
        clean += (estimate.rate.widen() - truth).powi(2);
    }
    Ok(((raw / count).sqrt(), (clean / count).sqrt()))
}

fn main() -> Result<(), stillrate::ConfigError> {
    let ((raw, clean), (_, single)) = (errors::<f64>()?, errors::<f32>()?);
    println!("raw {raw:.4}, clean {clean:.4} deg/s RMS error; in single precision {single:.4}");
    let filter = WanderingKf::<f32>::new(200.0, 0.07, 3.0, 0.3)?;
    let mut state = filter.start();
    for value in [0.5, f32::NAN, 0.4] {
        let estimate = filter.step(&mut state, Sample { value, dt: 0.005 });
        println!("{value:>5} -> {:.4} flags {}", estimate.rate, estimate.flags.0);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn removes_noise_and_knows_how_much_is_left() {
        let (raw, clean) = errors::<f64>().unwrap();
        let filter = WanderingKf::<f64>::new(200.0, 1.0 / 200.0_f64.sqrt(), 3.0, 0.3).unwrap();
        let mut state = filter.start();
        for (_, sample) in record() {
            filter.step(&mut state, Sample { value: sample, dt: 0.005 });
        }
        assert!(clean < 0.65 * raw, "{clean} {raw}");
        assert!((clean / state.variance.sqrt() - 1.0).abs() < 0.05, "{clean} {}", state.variance.sqrt());
    }

    #[test]
    fn coasts_over_a_missing_sample() {
        let filter = WanderingKf::<f64>::new(200.0, 0.07, 3.0, 0.3).unwrap();
        let mut state = filter.start();
        filter.step(&mut state, Sample { value: 2.0, dt: 0.005 });
        let before = state.variance;
        let estimate = filter.step(&mut state, Sample { value: f64::NAN, dt: 0.005 });
        assert!(estimate.flags.has(Flags::MISSING) && estimate.rate > 1.9 && state.variance > before);
    }

    #[test]
    fn refuses_a_rate_that_is_none() {
        let refused = WanderingKf::<f64>::new(-1.0, 0.07, 3.0, 0.3).unwrap_err();
        assert_eq!(refused.field, "sample_rate_hz");
    }
}
