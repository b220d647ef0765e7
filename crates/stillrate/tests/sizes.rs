//! Whatever the size of the samples, no filter states a variance below zero or anything that is not finite.

use stillrate::{Filter, GyroNoise, Real, Sample, Settings};

/// Bursts of samples of very different sizes, one in five of them missing.
fn check<S: Settings, T: Real>(rate_hz: f64) {
    let noise = GyroNoise::from_density_two_sided(0.0151).with_rate_random_walk(0.003);
    let filter = S::defaults(rate_hz, noise).build::<T>().unwrap();
    let (mut state, mut seed) = (filter.start(), 7_u64);
    for k in 0..20_000_usize {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let uniform = (seed >> 33) as f64 / f64::from(1_u32 << 31);
        let size = [1.0, 100.0, 5e4, 1e6, 1e7][k / 37 % 5];
        let value = if uniform < 0.2 { f64::NAN } else { (uniform - 0.6) * size };
        let estimate = filter.step(&mut state, Sample { value: T::of(value), dt: filter.period() });
        let finite = estimate.rate.finite() && estimate.acceleration.finite();
        assert!(finite && estimate.variance >= T::ZERO, "{} at {rate_hz} Hz, sample {k}: {estimate:?}", S::METHOD);
    }
}

#[test]
fn no_size_of_samples_makes_a_variance_negative() {
    macro_rules! all {
        ($($name:ident),* $(,)?) => {
            $(for rate_hz in [50.0, 1000.0, 8000.0] {
                check::<stillrate::filters::$name, f32>(rate_hz);
                check::<stillrate::filters::$name, f64>(rate_hz);
            })*
        };
    }
    stillrate::methods!(all);
}
