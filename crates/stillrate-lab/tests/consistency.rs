//! Filters believe what is true: on truth drawn from their own model the squared error over the believed covariance is
//! chi-square (Bar-Shalom, Li and Kirubarajan 2001, section 5.4), and the sample's place in its predicted distribution is even.
//! And they keep believing something possible: no covariance ever loses its definiteness, however long and badly scaled the run.

use stillrate::filters::{MsImmIkfSettings, SingerImmKfSettings, SingerKfSettings};
use stillrate::gaussian::{Gaussian2, Gaussian4};
use stillrate::models::SingerCoefficients;
use stillrate::reals::Lanes;
use stillrate::{Filter, GyroNoise, ModelTrace, Observer, Real, Sample, Settings};
use stillrate_lab::random::Random;
use stillrate_lab::statistics::{chi_square_quantile, normal_cdf};

/// Independent runs; every run is looked at once, after so many samples.
const RUNS: u64 = 600;
const SAMPLES: usize = 300;
/// Chance that a right filter fails one of these tests, each side. The seeds are fixed: it happened or it did not.
const RISK: f64 = 5e-4;
const RATE_HZ: f64 = 50.0;
const BINS: usize = 20;

fn noise() -> GyroNoise {
    GyroNoise::from_density_two_sided(0.015)
}

/// Innovation and its variance of each model.
#[derive(Default)]
struct Innovations([ModelTrace<f64>; 2]);

impl Observer<f64> for Innovations {
    fn model(&mut self, index: usize, trace: ModelTrace<f64>) {
        self.0[index] = trace;
    }
}

/// Motion that is exactly a Singer model's.
struct Motion {
    state: [f64; 2],
    random: Random,
}

impl Motion {
    fn step(&mut self, alpha: f64, accel_max: f64) {
        let c = SingerCoefficients::new(alpha, 1.0 / RATE_HZ);
        let density = 2.0 * alpha * accel_max * accel_max / 3.0;
        let (first, second) = (self.random.normal(), self.random.normal());
        let rate = (density * c.q11).root();
        let crossed = density * c.q12 / rate;
        let rest = (density * c.q22 - crossed * crossed).root();
        let [w, a] = self.state;
        self.state = [w + c.r * a + rate * first, c.s * a + crossed * first + rest * second];
    }

    fn measured(&mut self, variance: f64) -> Sample<f64> {
        Sample { value: self.state[0] + variance.root() * self.random.normal(), dt: 1.0 / RATE_HZ }
    }
}

/// Squared error over the believed covariance.
fn normalised_error(truth: [f64; 2], belief: &Gaussian2<f64>) -> f64 {
    let [p00, p01, p11] = belief.covariance;
    let e = [truth[0] - belief.mean[0], truth[1] - belief.mean[1]];
    (e[0] * e[0] * p11 - 2.0 * e[0] * e[1] * p01 + e[1] * e[1] * p00) / (p00 * p11 - p01 * p01)
}

fn within(sum: f64, freedom: f64, what: &str) {
    let (low, high) = (chi_square_quantile(RISK, freedom), chi_square_quantile(1.0 - RISK, freedom));
    assert!((low..=high).contains(&sum), "{what}: {sum}, not in {low}..{high}");
}

/// Places in the predicted distribution fill equal bins evenly.
fn evenly_spread(places: &[f64], what: &str) {
    let mut bins = [0.0; BINS];
    for place in places {
        bins[((place * BINS as f64) as usize).min(BINS - 1)] += 1.0;
    }
    let expected = places.len() as f64 / BINS as f64;
    let sum: f64 = bins.iter().map(|count| (count - expected) * (count - expected) / expected).sum();
    within(sum, (BINS - 1) as f64, what);
}

/// Sum of normalised errors and the places of the last samples, with truth `mismatch` times livelier than the filter believes.
fn singer_runs(mismatch: f64) -> (f64, Vec<f64>) {
    let settings = SingerKfSettings { alpha_per_s: 0.5, ..SingerKfSettings::defaults(RATE_HZ, noise()) };
    let filter = settings.build::<f64>().unwrap();
    let (mut sum, mut places) = (0.0, Vec::new());
    for run in 0..RUNS {
        let mut motion = Motion { state: [0.0; 2], random: Random::new(71, run) };
        let (mut state, mut seen) = (filter.start(), Innovations::default());
        for _ in 0..SAMPLES {
            motion.step(settings.alpha_per_s, mismatch * settings.accel_max_dps2);
            let sample = motion.measured(settings.measurement_variance);
            filter.observe(&mut state, sample, &mut seen);
        }
        sum += normalised_error(motion.state, &state.model);
        places.push(normal_cdf(seen.0[0].innovation / seen.0[0].innovation_variance.root()));
    }
    (sum, places)
}

#[test]
fn singer_filter_believes_its_true_error_on_its_own_motion() {
    let (sum, places) = singer_runs(1.0);
    within(sum, 2.0 * RUNS as f64, "normalised errors");
    evenly_spread(&places, "innovations");
}

#[test]
#[should_panic(expected = "normalised errors")]
fn a_singer_filter_that_believes_too_little_motion_fails_the_same_test() {
    within(singer_runs(2.0).0, 2.0 * RUNS as f64, "normalised errors");
}

#[test]
fn singer_bank_predicts_the_right_distribution_on_its_own_motion() {
    let mut settings = SingerImmKfSettings::defaults(RATE_HZ, noise());
    settings.pair.alpha_per_s = [0.5, 2.0];
    settings.pair.accel_max_dps2 = [2.0, 60.0];
    settings.pair.transition = [0.98, 0.02, 0.04, 0.96];
    let filter = settings.build::<f64>().unwrap();
    let mut places = Vec::new();
    for run in 0..RUNS {
        let mut motion = Motion { state: [0.0; 2], random: Random::new(72, run) };
        let (mut state, mut seen) = (filter.start(), Innovations::default());
        let mut model = usize::from(motion.random.normal() > 0.0);
        let mut prior = [0.5; 2];
        for _ in 0..SAMPLES {
            let leaves = normal_cdf(motion.random.normal()) < [0.02, 0.04][model];
            model = if leaves { 1 - model } else { model };
            motion.step(settings.pair.alpha_per_s[model], settings.pair.accel_max_dps2[model]);
            let sample = motion.measured(settings.pair.measurement_variance[model]);
            let [first, second] = state.weight.map(|weight| weight / (state.weight[0] + state.weight[1]));
            prior = [0.98 * first + 0.04 * second, 0.02 * first + 0.96 * second];
            filter.observe(&mut state, sample, &mut seen);
        }
        let place = |m: usize| prior[m] * normal_cdf(seen.0[m].innovation / seen.0[m].innovation_variance.root());
        places.push(place(0) + place(1));
    }
    evenly_spread(&places, "innovations of the bank");
}

/// Positive variances, and a determinant that rounding of the stored numbers themselves cannot have made.
fn definite2<T: Real>(belief: &Gaussian2<T>) -> bool {
    let [p00, p01, p11] = belief.covariance.map(Real::widen);
    p00 > 0.0 && p11 > 0.0 && p01 * p01 < p00 * p11
}

/// Cholesky in `f64` of what is stored, scaled to unit variances.
fn definite4<T: Real>(belief: &Gaussian4<T>) -> bool {
    let p = belief.covariance.map(Real::widen);
    let at = |r: usize, c: usize| p[[[0, 1, 2, 3], [1, 4, 5, 6], [2, 5, 7, 8], [3, 6, 8, 9]][r][c]];
    if (0..4).any(|k| !(at(k, k) > 0.0)) {
        return false;
    }
    let scale: [f64; 4] = core::array::from_fn(|k| 1.0 / at(k, k).root());
    let mut l = [[0.0_f64; 4]; 4];
    for r in 0..4 {
        for c in 0..=r {
            let sum: f64 = (0..c).map(|k| l[r][k] * l[c][k]).sum();
            let left = at(r, c) * scale[r] * scale[c] - sum;
            if r == c {
                // The stored numbers are rounded: that much of a unit variance may be missing.
                if left <= -8.0 * T::EPSILON.widen() {
                    return false;
                }
                l[r][r] = left.most(1e-30).root();
            } else {
                l[r][c] = left / l[c][c];
            }
        }
    }
    true
}

/// Swings, rest, missing samples and gaps.
fn stream<T: Real>(random: &mut Random, k: u64, period: f64) -> Sample<T> {
    let moving = if (k / 4096) % 2 == 1 { 40.0 * (0.05 * (k % 4096) as f64).sine_cosine().0 } else { 0.0 };
    let value = if k % 977 < 5 { f64::NAN } else { moving + 0.1 * random.normal() };
    let dt = if k.is_multiple_of(1409) { 7.3 * period } else { period };
    Sample { value: T::of(value), dt: T::of(dt) }
}

fn stays_definite<S: Settings, T: Real>(
    settings: &S,
    rate_hz: f64,
    steps: u64,
    definite: impl Fn(&<S::Filter<T> as Filter<T>>::State) -> bool,
) {
    let filter = settings.build::<T>().unwrap();
    let (mut state, mut random) = (filter.start(), Random::new(73, 0));
    for k in 0..steps {
        filter.step(&mut state, stream(&mut random, k, 1.0 / rate_hz));
        assert!(definite(&state), "{} step {k}: {state:?}", S::METHOD);
    }
}

/// Every covariance of the two Singer filters and of the bank, well and badly conditioned.
fn all_stay_definite<T: Real>(steps: u64) {
    let plain = SingerKfSettings::defaults(RATE_HZ, noise());
    stays_definite::<_, T>(&plain, RATE_HZ, steps, |s| definite2(&s.model));
    let two = SingerImmKfSettings::defaults(RATE_HZ, noise());
    stays_definite::<_, T>(&two, RATE_HZ, steps, |s| s.model.iter().all(definite2));
    // 8 kHz with a motion that is far larger than the noise of a sample, and one that is far smaller. A single-precision variance has 24 bits:
    // where a sample takes more than these of it, the little that is left has a variance, but no correlation. In f32 the predicted
    // variance is 5e5 times that of a sample (of 8e6 that 24 bits hold), in f64 5e13 times.
    let precise = if T::BYTES == 4 { 1e-2 } else { 1e-10 };
    for variance in [precise, 1e8] {
        let mut hard = SingerImmKfSettings::defaults(8000.0, noise());
        hard.pair.accel_max_dps2 = [1e-3, 1e6];
        hard.pair.alpha_per_s = [1e-3, 100.0];
        hard.pair.measurement_variance = [variance; 2];
        hard.pair.initial_acceleration_variance = [1e-6, 1e12];
        stays_definite::<_, T>(&hard, 8000.0, steps, |s| s.model.iter().all(definite2));
    }
    let bank = MsImmIkfSettings::defaults(1000.0, noise());
    stays_definite::<_, T>(&bank, 1000.0, steps, |wide| {
        let s = wide.lane(0);
        let walk = s.walk[1] > T::ZERO;
        let rungs = s.rung.iter().zip(s.rung_probability).all(|(model, p)| p == T::ZERO || definite2(model));
        let turning = s.oscillator.iter().zip(s.oscillator_probability);
        s.started == T::ZERO
            || (walk && rungs && turning.into_iter().all(|(model, p)| p == T::ZERO || definite4(model)))
    });
}

#[test]
fn covariances_stay_definite_over_a_hundred_thousand_steps() {
    all_stay_definite::<f32>(100_000);
    all_stay_definite::<f64>(100_000);
}

#[test]
#[ignore = "a minute"]
fn covariances_stay_definite_over_ten_million_steps_in_f32() {
    all_stay_definite::<f32>(10_000_000);
}

#[test]
#[ignore = "minutes"]
fn covariances_stay_definite_over_a_hundred_million_steps_in_f64() {
    all_stay_definite::<f64>(100_000_000);
}
