//! Nothing a sensor or a caller can do breaks a filter: every filter x every fault x both precisions, no exceptions.
//!
//! Each run compares a stream with a fault to the same stream without. Promised of every sample: a finite estimate, a variance
//! that is not negative, exactly the flags that the fault calls for. Promised of the stream: back at the clean run within the
//! number of samples that `recovery` states, and bit-equal before the fault.

mod fault;

use fault::{DENSITY, Fault, RATE_HZ, SIGMA, clean};
use stillrate::filter::{LONGEST_GAP_S, SHORTEST_STEP};
use stillrate::{Estimate, Filter, Flags, GyroNoise, Real, Sample, Settings};

/// Samples before the first fault of long streams: filters are settled.
const SETTLED: usize = 300;
/// Recovered means: within this many standard deviations of a raw sample from the clean run, and staying there.
const RECOVERED_SIGMAS: f64 = 0.5;

/// Samples within which a method is back after any fault, at 50 Hz, to [`RECOVERED_SIGMAS`]. The long ones are the long memories:
/// a random walk that trusts its mean, a bank that took a spike of a million standard deviations (by default without outlier
/// model) for a manoeuvre, a predictor whose weights were mistaught.
fn recovery(method: &str) -> usize {
    match method {
        "ar-kf" => 2,
        "fir" | "cusum-forgetting" | "pt1" | "biquad" | "variable-forgetting" => 20,
        "hmm-rls" => 80,
        "singer-kf" => 100,
        "one-euro" => 130,
        "ms-imm-ikf-paper" => 250,
        "singer-imm-kf" => 800,
        "sage-husa-kf" => 1200,
        "hmm-kf" | "linear-prediction" => 3000,
        // A flicker of 2000 deg/s leaves a size of motion in its memory that the third motion after it still meets (in f32; below 5000 in f64).
        "ms-imm-ikf" => 7000,
        other => panic!("state how soon {other} recovers"),
    }
}

fn settings<S: Settings>(rate_hz: f64) -> S {
    S::defaults(rate_hz, GyroNoise::from_density_two_sided(DENSITY).with_rate_random_walk(0.003))
}

/// Runs the filter and checks what holds for every sample of every stream.
fn run<S: Settings, T: Real>(rate_hz: f64, samples: &[(f64, f64)], title: &dyn Fn() -> String) -> Vec<Estimate<T>> {
    let filter = settings::<S>(rate_hz).build::<T>().unwrap();
    let sigma = SIGMA * (rate_hz / RATE_HZ).root();
    let mut state = filter.start();
    let mut seen = false;
    let mut silent_s = 0.0;
    let mut answers = Vec::with_capacity(samples.len());
    for (k, &(value, dt)) in samples.iter().enumerate() {
        let sample = Sample { value: T::of(value), dt: T::of(dt) };
        let estimate = filter.step(&mut state, sample);
        let flags = estimate.flags;
        let sound = estimate.rate.finite() && estimate.acceleration.finite() && estimate.variance.finite();
        assert!(sound && estimate.variance >= T::ZERO, "{}, sample {k}: {estimate:?}", title());
        assert!(k % 16 > 0 || filter.accepts(&state), "{}, sample {k}: would not be restored: {state:?}", title());
        let moves = sample.dt.finite() && sample.dt.widen() > SHORTEST_STEP / rate_hz;
        let finite = sample.value.finite();
        let out_of_range = flags.has(Flags::OUT_OF_RANGE);
        let usable = finite && moves && !out_of_range;
        silent_s += if moves { sample.dt.widen() } else { 0.0 };
        if flags.has(Flags::RESTARTED) {
            // Only after a long silence, and then the sample is all that is known.
            assert!(
                silent_s > LONGEST_GAP_S.max(2.99 / rate_hz),
                "{}, sample {k}: {estimate:?} after {silent_s} s",
                title()
            );
            let off = (estimate.rate - sample.value).widen().magnitude();
            assert!(
                !usable || off < 1e-4 * sigma.max(value.magnitude()),
                "{}, sample {k} {sample:?}: {estimate:?}",
                title()
            );
            seen = false;
        }
        seen |= usable;
        silent_s = if usable { 0.0 } else { silent_s };
        let expected =
            Flags::MISSING.when(!finite).with(Flags::BAD_TIME.when(!moves)).with(Flags::NO_DATA_YET.when(!seen));
        assert!(!flags.has(Flags::DIVERGED), "{}, sample {k} {sample:?}: lost its state", title());
        let common = Flags::MISSING.0 | Flags::BAD_TIME.0 | Flags::NO_DATA_YET.0;
        assert_eq!(flags.0 & common, expected.0, "{}, sample {k} {sample:?}: {estimate:?}", title());
        // Nothing within a million standard deviations is out of range, and nothing beyond 10^10 of them is in it.
        let sigmas = value.magnitude() / sigma;
        assert!(
            out_of_range == (finite && sigmas > 1e12) || (1e6..=1e12).contains(&sigmas),
            "{}, sample {k}: {estimate:?}",
            title()
        );
        answers.push(estimate);
    }
    answers
}

/// Runs the stream with a fault at `position` beside the clean one; gives how many samples after the fault's end they
/// last differ by more than [`RECOVERED_SIGMAS`].
fn recovers_after<S: Settings, T: Real>(fault: &Fault, position: usize, length: usize) -> usize {
    let clean_samples = clean(length);
    let mut samples = clean_samples.clone();
    let end = fault.strike(&mut samples, position);
    let title = || format!("{} {} {fault:?} at {position}", S::METHOD, core::any::type_name::<T>());
    let (good, hit) = (run::<S, T>(RATE_HZ, &clean_samples, &title), run::<S, T>(RATE_HZ, &samples, &title));
    assert_eq!(hit.len(), samples.len());
    assert_eq!(good[..position], hit[..position], "{}: differs before the fault", title());
    let off = |k: &usize| (good[*k].rate.widen() - hit[*k].rate.widen()).magnitude() > RECOVERED_SIGMAS * SIGMA;
    (end..length).rev().find(off).map_or(0, |last| last + 1 - end)
}

fn recovers_from_every_fault<S: Settings, T: Real>() {
    let stated = recovery(S::METHOD);
    for fault in fault::all() {
        let after = recovers_after::<S, T>(&fault, SETTLED, 8000);
        assert!(after <= stated, "{} after {fault:?}: {after} samples", S::METHOD);
    }
}

/// Faults from the first sample on, when nothing is known yet.
fn bears_every_fault_at_every_position<S: Settings, T: Real>() {
    for position in 0..20 {
        for fault in fault::all() {
            let mut samples = clean(position + 30);
            fault.strike(&mut samples, position);
            run::<S, T>(RATE_HZ, &samples, &|| format!("{} {fault:?} at {position}", S::METHOD));
        }
    }
    for position in 0..400 {
        let mut samples = clean(420);
        Fault::Dropout(1 + position % 7).strike(&mut samples, position);
        run::<S, T>(RATE_HZ, &samples, &|| format!("{} dropout at {position}", S::METHOD));
    }
}

/// Fault upon fault in one stream, at rates from one sample in ten seconds to 8 kHz.
fn bears_faults_upon_faults<S: Settings, T: Real>() {
    let faults = fault::all();
    for (seed, rate_hz) in [0.1, 1.0, RATE_HZ, 1000.0, 8000.0].into_iter().enumerate() {
        let mut samples: Vec<_> = clean(6000).into_iter().map(|(value, _)| (value, 1.0 / rate_hz)).collect();
        let mut dice = 17 + seed as u64;
        let mut position = 0;
        while position < samples.len() {
            dice = dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            faults[(dice >> 33) as usize % faults.len()].strike(&mut samples, position);
            position += 1 + (dice >> 20) as usize % 23;
        }
        run::<S, T>(rate_hz, &samples, &|| format!("{} {} at {rate_hz} Hz", S::METHOD, core::any::type_name::<T>()));
    }
}

macro_rules! for_every_method {
    ($($name:ident),* $(,)?) => { $(
        #[allow(non_snake_case)]
        mod $name {
            use stillrate::filters::$name as Method;
            for_both_precisions!(recovers_from_every_fault, bears_every_fault_at_every_position, bears_faults_upon_faults);
        }
    )* };
}
macro_rules! for_both_precisions {
    ($($test:ident),*) => { $(
        mod $test {
            #[test]
            fn in_f32() {
                crate::$test::<super::Method, f32>();
            }
            #[test]
            fn in_f64() {
                crate::$test::<super::Method, f64>();
            }
        }
    )* };
}
stillrate::methods!(for_every_method);
