//! Whatever samples come, every filter in both precisions gives finite numbers and a variance that is not negative.
#![no_main]

use libfuzzer_sys::fuzz_target;
use stillrate::{Filter, Flags, GyroNoise, Real, Sample, Settings};
use stillrate_fuzz::Input;

fn run<S: Settings, T: Real>(mut input: Input<'_>) {
    let rate_hz = [50.0, 0.1, 1.0, 1000.0, 8000.0][input.choice(5)];
    let settings = S::defaults(rate_hz, GyroNoise::from_density_two_sided(0.0151).with_rate_random_walk(0.003));
    let filter = settings.build::<T>().expect("default settings hold");
    let mut state = filter.start();
    while input.any() {
        let sample = Sample { value: T::of(input.number()), dt: T::of(input.time_step(1.0 / rate_hz)) };
        let repeats = if input.byte() < 250 { 1_u16 } else { 1 + u16::from(input.byte()) };
        for _ in 0..repeats {
            let estimate = filter.step(&mut state, sample);
            let finite = estimate.rate.finite() && estimate.acceleration.finite() && estimate.variance.finite();
            assert!(finite && estimate.variance >= T::ZERO, "{} {sample:?}: {estimate:?}\n{state:?}", S::METHOD);
            assert_eq!(estimate.flags.has(Flags::MISSING), !sample.value.finite());
            assert!(!estimate.flags.has(Flags::DIVERGED), "{} diverged", S::METHOD);
        }
    }
}

macro_rules! one_of {
    ($($name:ident),* $(,)?) => {
        fuzz_target!(|bytes: &[u8]| {
            let mut input = Input(bytes);
            let runs: &[fn(Input<'_>)] =
                &[$(run::<stillrate::filters::$name, f32>, run::<stillrate::filters::$name, f64>),*];
            let chosen = runs[input.choice(runs.len())];
            chosen(input);
        });
    };
}
stillrate::methods!(one_of);
