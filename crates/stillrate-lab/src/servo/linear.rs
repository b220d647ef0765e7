//! The linearised sampled loop: one matrix from tick to tick, its spectral radius and its exact noise covariance.
//!
//! The plant without play, dry friction, bristles and limits is x' = A x + B u; it is carried over a control period exactly (series
//! of [`van_loan`](super::drift::van_loan)), in two parts where the delayed voltage changes. Controller and filter are linear
//! already. State of the loop: theta, omega, alpha, nu, current, gyro; angle estimate, last raw rate, integral, last filtered rate; the
//! voltages still on their way; the filter's state.

use nalgebra::{DMatrix, DVector};
use stillrate::Real;

use super::discrete::Discrete;
use super::drift::propagate;
use super::drift::sampled::{covariance_after, spectral_radius};
use super::plant::Plant;
use super::platform::Platform;

/// Plant states that count here.
const PLANT: usize = 6;
const GYRO: usize = 5;
/// Controller states: angle, last raw, integral, last filtered.
const CONTROL: usize = 4;

/// The loop as x <- F x + g v, u = d x + e v for gyro noise v (rad/s a sample).
///
/// # Example
/// ```
/// use stillrate_lab::servo::{controller::Controller, discrete::Discrete, linear::LinearLoop, plant::Plant, platform::Platform};
/// let gains = Controller { kappa: 0.4, ko_per_s: 0.5, kvi_per_s: 20.0, kd_s: 2e-3, ..Controller::default() };
/// let axis = Platform::new(Plant::platform_30kg(), gains, 50.0, 1e-3, 5e-3).unwrap();
/// assert!(LinearLoop::new(&axis, &Discrete::None).spectral_radius() > 1.0); // a 37 Hz mode, aliased
/// let filter = Discrete::pt1(50.0, 5.3).unwrap();
/// let quiet = LinearLoop::new(&axis, &filter);
/// assert!(quiet.spectral_radius() < 1.0 + 1e-9);
/// // Once settled the angle walks as the gyro's integral does: sigma sqrt(ticks) T.
/// let sigma = 0.1074_f64.to_radians();
/// let (angle, _volts) = quiet.deviations_after(sigma, 3000);
/// assert!((angle / (sigma * 3000_f64.sqrt() * 0.02) - 1.0).abs() < 0.01);
/// ```
#[derive(Clone, Debug)]
pub struct LinearLoop {
    /// F.
    transition: DMatrix<f64>,
    /// g.
    noise_gain: DVector<f64>,
    /// d.
    voltage: DVector<f64>,
    /// e.
    voltage_direct: f64,
}

impl LinearLoop {
    /// Linearises `axis` around rest with a linear filter. An adaptive filter in its open mode is [`Discrete::None`].
    #[must_use]
    pub fn new(axis: &Platform, filter: &Discrete) -> Self {
        let (fa, fb, fc, fd) = filter.matrices();
        let order = fb.len();
        let period = axis.period_s();
        // A voltage of tick k acts from `late` + `whole` periods on; the last period's remains until then.
        let late_ticks = (axis.delay_s() / period + 1e-9) as usize;
        let rest = axis.delay_s() - late_ticks as f64 * period;
        let rest = if rest.abs() < 1e-9 * period { 0.0 } else { rest };
        let pending = late_ticks + 1;
        let (first, filters) = (PLANT + CONTROL, PLANT + CONTROL + pending);
        let size = filters + order;
        let row = |entries: &[(usize, f64)]| {
            let mut v = DVector::zeros(size + 1);
            for (i, x) in entries {
                v[*i] += x;
            }
            v
        };
        // Every quantity is a row over (state, noise).
        let noise = size;
        let raw = row(&[(GYRO, 1.0), (noise, 1.0)]);
        let mut filtered = &raw * fd;
        for i in 0..order {
            filtered[filters + i] += fc[i];
        }
        let c = &axis.controller;
        let angle = row(&[(PLANT, 1.0), (PLANT + 1, 0.5 * period)]) + &raw * (0.5 * period);
        let error = -&angle * c.ko_per_s - &filtered;
        let integral = row(&[(PLANT + 2, 1.0)]);
        let change = &filtered - row(&[(PLANT + 3, 1.0)]);
        let volts = axis.plant.motor_constant_v_s * axis.plant.gear_ratio;
        let voltage = ((&error + &integral) * c.kappa - change * (c.kd_s / period)) * volts;
        let mut next = DMatrix::zeros(size, size + 1);
        let mut set = |i: usize, v: &DVector<f64>| next.row_mut(i).copy_from(&v.transpose());
        set(PLANT, &angle);
        set(PLANT + 1, &raw);
        set(PLANT + 2, &(&integral + &error * (period * c.kvi_per_s)));
        set(PLANT + 3, &filtered);
        for i in (1..pending).rev() {
            set(first + i, &row(&[(first + i - 1, 1.0)]));
        }
        set(first, &voltage);
        for i in 0..order {
            let mut v = &raw * fb[i];
            for j in 0..order {
                v[filters + j] += fa[i * order + j];
            }
            set(filters + i, &v);
        }
        // pending[i] before the tick is the voltage of tick k-1-i; until `rest` the one of k-1-late acts, then k-late.
        let before = row(&[(first + late_ticks, 1.0)]);
        let after = if late_ticks == 0 { voltage.clone() } else { row(&[(first + late_ticks - 1, 1.0)]) };
        let (a, b) = linear_plant(&axis.plant);
        let (phi1, gamma1) = held(&a, &b, rest);
        let (phi2, gamma2) = held(&a, &b, period - rest);
        let mut plant = DMatrix::zeros(PLANT, size + 1);
        plant.view_mut((0, 0), (PLANT, PLANT)).copy_from(&(&phi2 * phi1));
        plant += &phi2 * gamma1 * before.transpose() + gamma2 * after.transpose();
        next.view_mut((0, 0), (PLANT, size + 1)).copy_from(&plant);
        Self {
            transition: next.columns(0, size).into_owned(),
            noise_gain: next.column(noise).into_owned(),
            voltage: voltage.rows(0, size).into_owned(),
            voltage_direct: voltage[noise],
        }
    }

    /// Largest magnitude of an eigenvalue. It is never below 1: the offset between true and estimated angle stays, because a gyro
    /// alone has no absolute reference; the loop is unstable above.
    #[must_use]
    pub fn spectral_radius(&self) -> f64 {
        spectral_radius(&self.transition)
    }

    /// Standard deviations of angle (rad) and voltage `ticks` after a start at rest, for white samples of deviation `sigma` rad/s.
    #[must_use]
    pub fn deviations_after(&self, sigma: f64, ticks: u64) -> (f64, f64) {
        let n = self.transition.nrows();
        let q = &self.noise_gain * self.noise_gain.transpose() * (sigma * sigma);
        let p = covariance_after(&self.transition, &q, &DMatrix::zeros(n, n), ticks);
        let u = (self.voltage.transpose() * &p * &self.voltage)[(0, 0)]
            + self.voltage_direct * self.voltage_direct * sigma * sigma;
        (p[(0, 0)].root(), u.root())
    }
}

/// x' = A x + B u for theta, omega, alpha, nu, current, gyro.
fn linear_plant(p: &Plant) -> (DMatrix<f64>, DVector<f64>) {
    let mut a = DMatrix::zeros(PLANT, PLANT);
    let (j, jr) = (p.inertia_kg_m2, p.drive_inertia_kg_m2);
    let (kc, cc) = (p.coupling_stiffness_n_m, p.coupling_damping_n_m_s);
    let back_emf = p.motor_constant_v_s * p.gear_ratio;
    a[(0, 1)] = 1.0;
    a[(1, 0)] = -(kc + p.pendulum_n_m + p.hose_stiffness_n_m) / j;
    a[(1, 1)] = -(cc + p.bearing_viscous_n_m_s) / j;
    a[(1, 2)] = kc / j;
    a[(1, 3)] = cc / j;
    a[(2, 3)] = 1.0;
    a[(3, 0)] = kc / jr;
    a[(3, 1)] = cc / jr;
    a[(3, 2)] = -kc / jr;
    a[(3, 3)] = -(cc + p.drive_viscous_n_m_s) / jr;
    a[(3, 4)] = back_emf / jr;
    a[(4, 3)] = -back_emf / p.resistance_ohm / p.current_time_s;
    a[(4, 4)] = -1.0 / p.current_time_s;
    a[(5, 1)] = p.gyro_bandwidth_rad_s;
    a[(5, 5)] = -p.gyro_bandwidth_rad_s;
    let mut b = DVector::zeros(PLANT);
    b[4] = 1.0 / p.resistance_ohm / p.current_time_s;
    (a, b)
}

/// Transition and input matrix over a time with the input held.
fn held(a: &DMatrix<f64>, b: &DVector<f64>, time: f64) -> (DMatrix<f64>, DVector<f64>) {
    let mut whole = DMatrix::zeros(PLANT + 1, PLANT + 1);
    whole.view_mut((0, 0), (PLANT, PLANT)).copy_from(a);
    whole.view_mut((0, PLANT), (PLANT, 1)).copy_from(b);
    let (phi, _) = propagate(&whole, &DMatrix::zeros(PLANT + 1, PLANT + 1), time);
    (phi.view((0, 0), (PLANT, PLANT)).into_owned(), phi.view((0, PLANT), (PLANT, 1)).column(0).into_owned())
}

#[cfg(test)]
mod tests {
    use super::super::base::Base;
    use super::super::controller::Controller;
    use super::super::platform::GyroErrors;
    use super::*;

    #[test]
    fn the_linear_loop_steps_like_the_simulation() {
        for (filter, delay) in [
            (Discrete::None, 5e-3),
            (Discrete::butterworth(50.0, 8.0).unwrap(), 23e-3),
            (Discrete::pt1(50.0, 5.3).unwrap(), 40e-3),
        ] {
            let axis =
                Platform::new(Plant::platform_30kg().linear(), Controller::default(), 50.0, 1e-4, delay).unwrap();
            let linear = LinearLoop::new(&axis, &filter);
            // One noise sample at the first tick but one (the first starts the filter), small enough to stay linear.
            let gyro = GyroErrors { samples_rad_s: vec![0.0, 1e-6], ..GyroErrors::default() };
            let still = Base::Constant { angle_rad: 0.0 };
            let record = axis.run(&mut filter.clone(), &still, &gyro, 0.0, 1.0).unwrap();
            let mut x = linear.noise_gain.clone() * 1e-6;
            for row in &record.rows[2..] {
                assert!((x[0] - row[0]).abs() < 2e-9 * 1e-2, "{} {}", x[0], row[0]);
                let u = linear.voltage.dot(&x);
                assert!((u - row[1]).abs() < 1e-9, "{u} {}", row[1]);
                x = &linear.transition * x;
            }
        }
    }
}
