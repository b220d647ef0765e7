//! The structured Singer filters against the literal matrix form of the textbook: full F P F' + Q, K = P H' / S,
//! P = (I - K H) P (I - K H)' + K R K' (Joseph), mixing by sums over all pairs, likelihoods with their exponentials.
//!
//! Both take each step from the same state, ours. Far outliers make the choice between two models chaotic, so that of two forms run side
//! by side each would follow its own rounding errors; step by step the input can be anything. The tolerance is what rounding can do in one
//! step: [`CLOSE`] of the terms that are added, and what [`ROUNDING`] of the two means, whose difference mixing squares, becomes on the way to
//! the gain, the exponent and the probability.
#![no_main]

use libfuzzer_sys::fuzz_target;
use stillrate::filters::{SingerImmKfSettings, SingerKfSettings};
use stillrate::gaussian::Gaussian2;
use stillrate::models::SingerCoefficients;
use stillrate::{Filter, GyroNoise, Real, Sample, Settings};
use stillrate_fuzz::Input;

type Matrix = [[f64; 2]; 2];

fn times(a: &Matrix, b: &Matrix) -> Matrix {
    core::array::from_fn(|r| core::array::from_fn(|c| a[r][0] * b[0][c] + a[r][1] * b[1][c]))
}

fn plus(a: &Matrix, b: &Matrix) -> Matrix {
    core::array::from_fn(|r| core::array::from_fn(|c| a[r][c] + b[r][c]))
}

fn transposed(a: &Matrix) -> Matrix {
    [[a[0][0], a[1][0]], [a[0][1], a[1][1]]]
}

/// Rounding errors of one step over the largest term of each sum: forty operations of 2e-16, and a margin.
const CLOSE: f64 = 1e-12;
/// Rounding error of a difference over its terms.
const ROUNDING: f64 = 2e-15;

/// One Singer model in matrix form.
#[derive(Clone, Copy)]
struct Model {
    alpha: f64,
    intensity: f64,
    variance: f64,
    /// Coefficients of the nominal step: most steps are.
    nominal: SingerCoefficients<f64>,
    x: [f64; 2],
    p: Matrix,
}

/// What a step found, and what rounding may have made of each number.
#[derive(Clone, Copy, Default)]
struct Found {
    exponent: f64,
    factor: f64,
    exponent_error: f64,
    mean_error: [f64; 2],
    /// Of the covariance 00, 01, 11.
    covariance_error: [f64; 3],
}

impl Model {
    fn predict(&mut self, dt: f64, period: f64) {
        let c = if dt == period { self.nominal } else { SingerCoefficients::new(self.alpha, dt) };
        let f = [[1.0, c.r], [0.0, c.s]];
        let q = [[c.q11, c.q12], [c.q12, c.q22]].map(|row| row.map(|entry| entry * self.intensity));
        self.x = [self.x[0] + c.r * self.x[1], c.s * self.x[1]];
        self.p = plus(&times(&times(&f, &self.p), &transposed(&f)), &q);
    }

    /// Predicts, and updates with a value that is there; `size` is that of the means that were mixed, `pool` that of the variances.
    fn cycle(&mut self, value: f64, dt: f64, period: f64, size: [f64; 2], pool: [f64; 2]) -> Found {
        self.predict(dt, period);
        let (reached, carried) = (size[0] + dt * size[1], size[1]);
        let [p00, p01, p11] = [self.p[0][0], self.p[0][1], self.p[1][1]];
        let (e0, e1) = (ROUNDING * reached, ROUNDING * carried);
        let (d0, d1) = (p00.sqrt(), p11.sqrt());
        // A share that is nearly one leaves the other, one minus it, with few digits: these of the larger variance.
        let (w0, w1) = (pool[0].sqrt() + dt * pool[1].sqrt(), pool[1].sqrt());
        let rate = CLOSE * p00 + 4.0 * d0 * e0 + ROUNDING * w0 * w0;
        let crossed = CLOSE * d0 * d1 + 4.0 * (d0 * e1 + d1 * e0) + ROUNDING * w0 * w1;
        let acceleration = CLOSE * p11 + 4.0 * d1 * e1 + ROUNDING * w1 * w1;
        let mut found = Found { factor: 1.0, ..Found::default() };
        found.mean_error = [CLOSE * reached, CLOSE * carried];
        found.covariance_error = [rate, crossed, acceleration];
        if !value.is_finite() {
            return found;
        }
        let innovation = value - self.x[0];
        let s = p00 + self.variance;
        let k = [p00 / s, p01 / s];
        self.x = [self.x[0] + k[0] * innovation, self.x[1] + k[1] * innovation];
        let left = [[1.0 - k[0], 0.0], [-k[1], 1.0]];
        let noise = [[k[0] * k[0], k[0] * k[1]], [k[0] * k[1], k[1] * k[1]]].map(|row| row.map(|e| e * self.variance));
        self.p = plus(&times(&times(&left, &self.p), &transposed(&left)), &noise);
        let reached = reached + value.abs();
        let across = d0 * d1 / s;
        let turned = crossed + across * rate;
        found.mean_error =
            [(CLOSE + 2.0 * rate / s) * reached, CLOSE * (carried + across * reached) + 2.0 * turned / s * reached];
        found.covariance_error = [rate, turned, acceleration + 2.0 * across * turned];
        found.exponent = -0.5 * innovation * innovation / s;
        found.exponent_error =
            CLOSE * reached * innovation.abs() / s + (CLOSE + 2.0 * rate / s) * found.exponent.abs() + rate / s;
        found.factor = 1.0 / s.sqrt();
        found
    }
}

/// Two interacting models, by the sums of Blom and Bar-Shalom.
fn interact(models: &mut [Model; 2], mu: &mut [f64; 2], pi: &Matrix, value: f64, dt: f64, period: f64) -> [Found; 2] {
    let old = *models;
    let mut prior = [0.0; 2];
    for j in 0..2 {
        prior[j] = pi[0][j] * mu[0] + pi[1][j] * mu[1];
        let w = [pi[0][j] * mu[0] / prior[j], pi[1][j] * mu[1] / prior[j]];
        let x: [f64; 2] = core::array::from_fn(|a| w[0] * old[0].x[a] + w[1] * old[1].x[a]);
        models[j].x = x;
        models[j].p = core::array::from_fn(|a| {
            core::array::from_fn(|b| {
                (0..2).map(|i| w[i] * (old[i].p[a][b] + (old[i].x[a] - x[a]) * (old[i].x[b] - x[b]))).sum()
            })
        });
    }
    let size = core::array::from_fn(|a| old[0].x[a].abs() + old[1].x[a].abs());
    let pool = core::array::from_fn(|a| {
        let apart = old[0].x[a] - old[1].x[a];
        old[0].p[a][a] + old[1].p[a][a] + apart * apart
    });
    let found: [Found; 2] = core::array::from_fn(|j| models[j].cycle(value, dt, period, size, pool));
    let highest = found[0].exponent.max(found[1].exponent);
    let weight: [f64; 2] = core::array::from_fn(|j| prior[j] * (found[j].exponent - highest).exp() * found[j].factor);
    *mu = weight.map(|w| w / (weight[0] + weight[1]));
    found
}

/// A number between two bounds, evenly in its logarithm.
fn between(input: &mut Input<'_>, low: f64, high: f64) -> f64 {
    low * (high / low).powf(f64::from(u16::from_le_bytes(input.bytes())) / 65_535.0)
}

fn agree(ours: f64, literal: f64, tolerance: f64, what: &str) {
    // Ours flushes what is smaller than any signal.
    let close = (ours - literal).abs() <= tolerance + f64::TINY;
    assert!(close, "{what}: {ours} here, {literal} in matrix form, {:e} apart, {tolerance:e} allowed", ours - literal);
}

/// Mean and covariance of one model.
fn agree_on(ours: &Gaussian2<f64>, literal: &Model, found: &Found) {
    agree(ours.mean[0], literal.x[0], found.mean_error[0], "rate");
    agree(ours.mean[1], literal.x[1], found.mean_error[1], "acceleration");
    let literal = [literal.p[0][0], literal.p[0][1], literal.p[1][1]];
    for k in 0..3 {
        agree(
            ours.covariance[k],
            literal[k],
            found.covariance_error[k],
            ["variance", "covariance", "acceleration's"][k],
        );
    }
}

fn take(literal: &mut Model, ours: &Gaussian2<f64>) {
    let [p00, p01, p11] = ours.covariance;
    (literal.x, literal.p) = (ours.mean, [[p00, p01], [p01, p11]]);
}

/// The next sample: a small step, a jump of up to a million standard deviations, or nothing; and the time before it.
fn next(input: &mut Input<'_>, last: f64, sigma: f64, period: f64) -> (f64, f64) {
    let value = match input.byte() {
        0..=150 => last + f64::from(input.byte().cast_signed()) / 32.0 * sigma,
        151..=180 => last + f64::from(input.byte().cast_signed()) * sigma,
        181..=210 => f64::from(i16::from_le_bytes(input.bytes())) * 32.0 * sigma,
        211..=225 => -last,
        226..=235 => 0.0,
        _ => f64::NAN,
    };
    let dt = match input.byte() {
        0..=219 => period,
        tag @ 220..=245 => f64::from(tag - 219) / 4.0 * period,
        246..=250 => 9.9_f64.max(2.9 * period),
        _ => 1e-4 * period,
    };
    (value, dt)
}

fuzz_target!(|bytes: &[u8]| {
    let mut input = Input(bytes);
    let rate_hz = between(&mut input, 1.0, 10_000.0);
    let (variance, period) = (between(&mut input, 1e-8, 1e4), 1.0 / rate_hz);
    let mut imm = SingerImmKfSettings::defaults(rate_hz, GyroNoise::from_density_two_sided(0.015));
    imm.pair.alpha_per_s = [between(&mut input, 1e-4, 100.0), between(&mut input, 1e-4, 100.0)];
    imm.pair.accel_max_dps2 = [between(&mut input, 1e-3, 100.0), between(&mut input, 1.0, 1e5)];
    let leave = [between(&mut input, 1e-6, 0.9), between(&mut input, 1e-6, 0.9)];
    imm.pair.transition = [1.0 - leave[0], leave[0], leave[1], 1.0 - leave[1]];
    imm.pair.measurement_variance = [variance; 2];
    let mut plain = SingerKfSettings::defaults(rate_hz, GyroNoise::from_density_two_sided(0.015));
    plain.alpha_per_s = imm.pair.alpha_per_s[1];
    plain.accel_max_dps2 = imm.pair.accel_max_dps2[1];
    plain.measurement_variance = variance;
    let (bank, single) = (imm.build::<f64>().expect("in range"), plain.build::<f64>().expect("in range"));
    let (mut bank_state, mut single_state) = (bank.start(), single.start());
    let model = |alpha: f64, accel_max: f64| Model {
        alpha,
        intensity: 2.0 * alpha * accel_max * accel_max / 3.0,
        variance,
        nominal: SingerCoefficients::new(alpha, period),
        x: [0.0; 2],
        p: [[0.0; 2]; 2],
    };
    let mut literal = [0, 1].map(|i| model(imm.pair.alpha_per_s[i], imm.pair.accel_max_dps2[i]));
    let mut alone = literal[1];
    let pi = [[imm.pair.transition[0], imm.pair.transition[1]], [imm.pair.transition[2], imm.pair.transition[3]]];
    // The first sample starts both.
    let start = Sample { value: f64::from(input.byte().cast_signed()) * variance.sqrt(), dt: period };
    bank.step(&mut bank_state, start);
    single.step(&mut single_state, start);
    let mut last = start.value;
    for _ in 0..200 {
        if !input.any() {
            break;
        }
        let (value, dt) = next(&mut input, last, variance.sqrt(), period);
        last = if value.is_finite() { value } else { last };
        for i in 0..2 {
            take(&mut literal[i], &bank_state.model[i]);
        }
        take(&mut alone, &single_state.model);
        let sum = bank_state.weight[0] + bank_state.weight[1];
        let mut mu = bank_state.weight.map(|weight| weight / sum);
        let size = alone.x.map(f64::abs);
        // What lies beyond a filter's range is missing to it.
        let heard = |limit: f64| if value.abs() <= limit { value } else { f64::NAN };
        let found = interact(&mut literal, &mut mu, &pi, heard(bank.limit), dt, period);
        let found_alone = alone.cycle(heard(single.limit), dt, period, size, [0.0; 2]);
        let sample = Sample { value, dt };
        let (ours, single) = (bank.step(&mut bank_state, sample), single.step(&mut single_state, sample));
        agree_on(&single_state.model, &alone, &found_alone);
        agree(single.rate, alone.x[0], found_alone.mean_error[0], "rate of the filter");
        for i in 0..2 {
            agree_on(&bank_state.model[i], &literal[i], &found[i]);
        }
        let sum = bank_state.weight[0] + bank_state.weight[1];
        let probability = (CLOSE + found[0].exponent_error + found[1].exponent_error).min(1.0);
        agree(bank_state.weight[1] / sum, mu[1], probability, "probability of motion");
        let apart = (literal[0].x[0] - literal[1].x[0]).abs();
        let tolerance = found[0].mean_error[0] + found[1].mean_error[0] + probability * apart;
        agree(ours.rate, mu[0] * literal[0].x[0] + mu[1] * literal[1].x[0], tolerance, "rate of the bank");
    }
});
