//! Negative baseline: the published two loops taken literally, each fed with the other's point estimate.
//!
//! Gyro loop: attitude and gyro coefficients on the first-order model from the angle measurement -f x dZ / g^2, dZ = Z - f less what the
//! accelerometer loop believes; it sees phi across f. Accelerometer loop: its nine coefficients from Z with phi from the gyro loop. With the other loop
//! known exactly each works; coupled without cross-covariance they diverge. The paper's equations (19)-(29) are missing from the text we
//! have, so an unstated detail may differ.

use nalgebra::{Matrix3, Vector3};
use stillrate::Real;
use stillrate::gimbal::coefficients::{
    FORCE_ABOUT_OUTPUT, FORCE_ABOUT_PENDULOUS, FORCE_BIAS, FORCE_SCALE, G_INPUT, G_OUTPUT, G_SPIN, GYRO_ABOUT_OUTPUT,
    GYRO_ABOUT_SPIN, GYRO_BIAS,
};
use stillrate::gimbal::rotation::exponential;
use stillrate::gimbal::window::commanded;
use stillrate::gimbal::{Carried, Coefficients, Factor, Model, NORM_COUNT, NORM_INDICES, Record, TILT_COUNT};

use super::settings::Settings;

/// Runs both loops over a record; `observe(epochs, coefficients)` after every epoch.
pub(super) fn literal_angle(
    record: &Record<'_>,
    settings: &Settings,
    mut observe: impl FnMut(usize, &Coefficients),
) -> Coefficients {
    let Settings { model, prior, scale, .. } = settings;
    let earth_rate = model.earth_rate();
    let (g, dt) = (model.gravity_m_s2, record.interval_s());
    let mut x = *prior;
    let mut frame = Matrix3::identity();
    let mut gyro = Factor::<f64, TILT_COUNT>::unit(TILT_COUNT);
    let mut carried = Carried::<TILT_COUNT>::unit();
    let mut force_loop = Factor::<f64, NORM_COUNT>::unit(NORM_COUNT);
    for k in 0..record.epochs() {
        let command = Vector3::from(record.command(k));
        propagate(model, &mut x, &mut carried, scale, &frame, &command, dt);
        frame = model.commanded_step(&frame, &command, &earth_rate, dt);
        let measurement = commanded(model, record, k + 1, &frame, &earth_rate, false);
        if measurement.variance.iter().all(|v| v.is_finite()) {
            let f = model.force(&frame);
            let z = Vector3::from(measurement.value);
            let r = measurement.variance[0];
            let phi = Vector3::new(x[0], x[1], x[2]);
            let angle = -f.cross(&(z - f - accelerometer_error(&x, &f))) / (g * g);
            correct_gyro(&mut x, &mut gyro, &carried, scale, &f, &angle, &phi, g, r);
            correct_accelerometer(&mut x, &mut force_loop, scale, &f, &z, &phi, r);
        }
        observe(k + 1, &x);
    }
    x
}

/// ka0 + ka1.*f + tho_i f_{i+1} - thp_i f_{i+2}.
fn accelerometer_error(x: &Coefficients, f: &Vector3<f64>) -> Vector3<f64> {
    Vector3::from_fn(|i, _| {
        let (p, o) = (f[(i + 1) % 3], f[(i + 2) % 3]);
        x[FORCE_BIAS + i] + x[FORCE_SCALE + i] * f[i] + x[FORCE_ABOUT_OUTPUT + i] * p - x[FORCE_ABOUT_PENDULOUS + i] * o
    })
}

fn propagate(
    model: &Model,
    x: &mut Coefficients,
    carried: &mut Carried<TILT_COUNT>,
    scale: &Coefficients,
    frame: &Matrix3<f64>,
    command: &Vector3<f64>,
    dt: f64,
) {
    let transition = exponential(&(command * -dt));
    let half = exponential(&(command * (-0.5 * dt)));
    let f = half * model.force(frame) / model.gravity_m_s2;
    let packed = core::array::from_fn(|c| core::array::from_fn(|r| transition[(r, c)] * scale[c] / scale[r]));
    carried.turn(&packed);
    let mut phi = transition * Vector3::new(x[0], x[1], x[2]);
    for i in 0..3 {
        let (o, s) = ((i + 1) % 3, (i + 2) % 3);
        let groups = [
            (GYRO_BIAS, 1.0),
            (G_INPUT, f[i]),
            (G_OUTPUT, f[o]),
            (G_SPIN, f[s]),
            (GYRO_ABOUT_OUTPUT, command[s]),
            (GYRO_ABOUT_SPIN, -command[o]),
        ];
        for (first, value) in groups {
            let at = first + i;
            let column = half.column(i) * (dt * value);
            phi += column * x[at];
            for r in 0..3 {
                carried.rows[r][at] += column[r] * scale[at] / scale[r];
            }
        }
    }
    x[..3].copy_from_slice(phi.as_slice());
}

fn correct_gyro(
    x: &mut Coefficients,
    factor: &mut Factor<f64, TILT_COUNT>,
    carried: &Carried<TILT_COUNT>,
    scale: &Coefficients,
    f: &Vector3<f64>,
    angle: &Vector3<f64>,
    phi: &Vector3<f64>,
    g: f64,
    variance: f64,
) {
    let across = Matrix3::identity() - f * f.transpose() / (g * g);
    let predicted = across * phi;
    let weight = g / variance.root();
    let mut correction = [0.0; TILT_COUNT];
    for i in 0..3 {
        let row: [f64; TILT_COUNT] =
            core::array::from_fn(|at| (0..3).map(|c| across[(i, c)] * scale[c] * weight * carried.rows[c][at]).sum());
        let known: f64 = row.iter().zip(&correction).map(|(h, c)| h * c).sum();
        let innovation = (angle[i] - predicted[i]) * weight - known;
        let gain = factor.absorb(&row);
        for (c, p) in correction.iter_mut().zip(gain.covariance) {
            *c += p * innovation / gain.variance;
        }
    }
    let psi = carried.now(&correction);
    for i in 0..TILT_COUNT {
        x[i] += if i < 3 { psi[i] } else { correction[i] } * scale[i];
    }
}

fn correct_accelerometer(
    x: &mut Coefficients,
    factor: &mut Factor<f64, NORM_COUNT>,
    scale: &Coefficients,
    f: &Vector3<f64>,
    z: &Vector3<f64>,
    phi: &Vector3<f64>,
    variance: f64,
) {
    let tilted = f + f.cross(phi);
    let predicted = tilted + accelerometer_error(x, f);
    let weight = 1.0 / variance.root();
    let mut correction = [0.0; NORM_COUNT];
    for i in 0..3 {
        let mut row = [0.0; NORM_COUNT];
        let mut innovation = (z[i] - predicted[i]) * weight;
        for (at, index) in NORM_INDICES.into_iter().enumerate() {
            let derivative = match index {
                _ if index == FORCE_BIAS + i => 1.0,
                _ if index == FORCE_SCALE + i => f[i],
                _ if index == FORCE_ABOUT_PENDULOUS + i => -f[(i + 2) % 3],
                _ if index == FORCE_ABOUT_OUTPUT + i => f[(i + 1) % 3],
                _ => 0.0,
            };
            row[at] = derivative * scale[index] * weight;
            innovation -= row[at] * correction[at];
        }
        let gain = factor.absorb(&row);
        for (c, p) in correction.iter_mut().zip(gain.covariance) {
            *c += p * innovation / gain.variance;
        }
    }
    for (c, index) in correction.into_iter().zip(NORM_INDICES) {
        x[index] += c * scale[index];
    }
}
