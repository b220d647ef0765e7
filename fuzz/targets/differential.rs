//! The structured Singer filters against the literal matrix form of the textbook: full F P F' + Q, K = P H' / S,
//! P = (I - K H) P (I - K H)' + K R K' (Joseph), mixing by sums over all pairs, likelihoods with their exponentials.
#![no_main]

use libfuzzer_sys::fuzz_target;
use stillrate::filters::{SingerImmKfSettings, SingerKfSettings};
use stillrate::models::SingerCoefficients;
use stillrate::{Filter, GyroNoise, Sample, Settings};
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

/// One Singer model in matrix form.
#[derive(Clone, Copy)]
struct Model {
    alpha: f64,
    intensity: f64,
    variance: f64,
    x: [f64; 2],
    p: Matrix,
}

impl Model {
    fn start(&mut self, value: f64, rate: f64, acceleration: f64) {
        (self.x, self.p) = ([value, 0.0], [[rate, 0.0], [0.0, acceleration]]);
    }

    /// Predicts and updates; the likelihood's exponent and its variance.
    fn cycle(&mut self, value: f64, dt: f64) -> (f64, f64) {
        let c = SingerCoefficients::new(self.alpha, dt);
        let f = [[1.0, c.r], [0.0, c.s]];
        let q = [[c.q11, c.q12], [c.q12, c.q22]].map(|row| row.map(|entry| entry * self.intensity));
        self.x = [self.x[0] + c.r * self.x[1], c.s * self.x[1]];
        self.p = plus(&times(&times(&f, &self.p), &transposed(&f)), &q);
        let innovation = value - self.x[0];
        let s = self.p[0][0] + self.variance;
        let k = [self.p[0][0] / s, self.p[1][0] / s];
        self.x = [self.x[0] + k[0] * innovation, self.x[1] + k[1] * innovation];
        let left = [[1.0 - k[0], 0.0], [-k[1], 1.0]];
        let noise = [[k[0] * k[0], k[0] * k[1]], [k[0] * k[1], k[1] * k[1]]].map(|row| row.map(|e| e * self.variance));
        self.p = plus(&times(&times(&left, &self.p), &transposed(&left)), &noise);
        (-0.5 * innovation * innovation / s, s)
    }
}

/// Two interacting models, by the sums of Blom and Bar-Shalom.
fn interact(models: &mut [Model; 2], mu: &mut [f64; 2], pi: &[[f64; 2]; 2], value: f64, dt: f64) {
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
    let found: [(f64, f64); 2] = core::array::from_fn(|j| models[j].cycle(value, dt));
    let highest = found[0].0.max(found[1].0);
    let weight: [f64; 2] = core::array::from_fn(|j| prior[j] * (found[j].0 - highest).exp() / found[j].1.sqrt());
    *mu = weight.map(|w| w / (weight[0] + weight[1]));
}

/// A number between two bounds, evenly in its logarithm.
fn between(input: &mut Input<'_>, low: f64, high: f64) -> f64 {
    low * (high / low).powf(f64::from(u16::from_le_bytes(input.bytes())) / 65_535.0)
}

fn agree(ours: f64, literal: f64, scale: f64, what: &str) {
    assert!((ours - literal).abs() <= 1e-7 * scale, "{what}: {ours} here, {literal} in matrix form, scale {scale}");
}

fuzz_target!(|bytes: &[u8]| {
    let mut input = Input(bytes);
    let rate_hz = between(&mut input, 10.0, 2000.0);
    let variance = between(&mut input, 1e-4, 1.0);
    let mut imm = SingerImmKfSettings::defaults(rate_hz, GyroNoise::from_density_two_sided(0.015));
    imm.alpha_per_s = [between(&mut input, 1e-3, 50.0), between(&mut input, 1e-3, 50.0)];
    imm.accel_max_dps2 = [between(&mut input, 0.1, 10.0), between(&mut input, 10.0, 1000.0)];
    let leave = [between(&mut input, 1e-3, 0.5), between(&mut input, 1e-3, 0.5)];
    imm.transition = [1.0 - leave[0], leave[0], leave[1], 1.0 - leave[1]];
    imm.measurement_variance = [variance; 2];
    let mut plain = SingerKfSettings::defaults(rate_hz, GyroNoise::from_density_two_sided(0.015));
    plain.alpha_per_s = imm.alpha_per_s[1];
    plain.accel_max_dps2 = imm.accel_max_dps2[1];
    plain.measurement_variance = variance;
    let (bank, single) = (imm.build::<f64>().expect("in range"), plain.build::<f64>().expect("in range"));
    let (mut bank_state, mut single_state) = (bank.start(), single.start());
    let model = |alpha: f64, accel_max: f64| Model {
        alpha,
        intensity: 2.0 * alpha * accel_max * accel_max / 3.0,
        variance,
        x: [0.0; 2],
        p: [[0.0; 2]; 2],
    };
    let mut literal = [0, 1].map(|i| model(imm.alpha_per_s[i], imm.accel_max_dps2[i]));
    let mut alone = literal[1];
    let mut mu = imm.initial_probability;
    let pi = [[imm.transition[0], imm.transition[1]], [imm.transition[2], imm.transition[3]]];
    let mut first = true;
    let mut value = 0.0_f64;
    for _ in 0..400 {
        if !input.any() {
            break;
        }
        // Steps of up to two standard deviations: a bank that is thrown about by far outliers is chaotic, and then the rounding
        // of either form grows from sample to sample.
        value += f64::from(input.byte().cast_signed()) / 64.0 * variance.sqrt();
        let dt = match input.byte() {
            0..=199 => 1.0 / rate_hz,
            tag => f64::from(tag - 199) / 4.0 / rate_hz,
        };
        if first {
            for i in 0..2 {
                literal[i].start(value, imm.initial_rate_variance[i], imm.initial_acceleration_variance[i]);
            }
            alone.start(value, plain.initial_rate_variance, plain.initial_acceleration_variance);
        }
        first = false;
        interact(&mut literal, &mut mu, &pi, value, dt);
        alone.cycle(value, dt);
        let scale = variance.sqrt() + value.abs();
        let sample = Sample { value, dt };
        let (ours, single) = (bank.step(&mut bank_state, sample), single.step(&mut single_state, sample));
        agree(ours.rate, mu[0] * literal[0].x[0] + mu[1] * literal[1].x[0], scale, "rate of the bank");
        agree(bank_state.probability[1], mu[1], 1.0, "probability of motion");
        agree(single.rate, alone.x[0], scale, "rate of the filter");
        agree(single.variance, alone.p[0][0], variance, "variance of the filter");
    }
});
