//! The plant's equations, integrated by the classical Runge-Kutta method.
//!
//! The equations stand in [`plant`](super::plant); here their quotients are worked out once, because a division costs as much as the rest
//! of a line.

use stillrate::Real;

use super::plant::{Curves, Plant, State};

/// A [`Plant`] with its quotients worked out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Kernel {
    plant: Plant,
    per_inertia: f64,
    per_drive_inertia: f64,
    per_contact: f64,
    per_bearing_rate: f64,
    per_stribeck_rate: f64,
    per_resistance: f64,
    per_current_time: f64,
    back_emf: f64,
}

impl Kernel {
    pub(crate) fn new(plant: &Plant) -> Self {
        Self {
            plant: *plant,
            per_inertia: 1.0 / plant.inertia_kg_m2,
            per_drive_inertia: 1.0 / plant.drive_inertia_kg_m2,
            per_contact: 1.0 / plant.contact_softness_rad,
            per_bearing_rate: 1.0 / plant.bearing_rate_rad_s,
            per_stribeck_rate: 1.0 / plant.stribeck_rate_rad_s,
            per_resistance: 1.0 / plant.resistance_ohm,
            per_current_time: 1.0 / plant.current_time_s,
            back_emf: plant.motor_constant_v_s * plant.gear_ratio,
        }
    }

    /// A control period of `table.len() / 2` steps, each with the voltage that `voltage(step)` gives. `table` holds the base's (angle, rate) at the
    /// start, middle and end of every step, as [`Base::fill`](super::base::Base::fill) writes it.
    #[inline]
    pub(crate) fn run(&self, x: &mut State, voltage: impl Fn(usize) -> f64, table: &[(f64, f64)], dt: f64) {
        for j in 0..table.len() / 2 {
            self.step(x, voltage(j), &[table[2 * j], table[2 * j + 1], table[2 * j + 2]], dt);
        }
    }

    /// Time derivative of the state for drive voltage `u` and base motion (angle, rate).
    #[inline(always)]
    fn derivative<const EXACT: bool>(&self, x: &State, u: f64, base: (f64, f64)) -> State {
        let p = &self.plant;
        let [theta, omega, alpha, nu, current, z, gyro] = *x;
        let (psi, psi_rate) = (theta - base.0, omega - base.1);
        let delta = alpha - psi;
        // Beyond the play: what a clamp to the play leaves over.
        let q = delta - delta.limited(-p.half_backlash_rad, p.half_backlash_rad);
        let contact = (q.magnitude() * self.per_contact).least(1.0);
        let coupling = p.coupling_stiffness_n_m * q + p.coupling_damping_n_m_s * (nu - psi_rate) * contact;
        let slip = psi_rate * self.per_bearing_rate;
        let stribeck = nu * self.per_stribeck_rate;
        let (sign, sine, bent) = if EXACT {
            let steady = p.coulomb_n_m + (p.stiction_n_m - p.coulomb_n_m) * (-stribeck * stribeck).exponential();
            (slip.tangent_hyperbolic(), theta.sine_cosine().0, z / steady)
        } else {
            // z / (Fc + (Fs - Fc)/(1 + s^2)) with one division.
            let wide = 1.0 + stribeck * stribeck;
            let bent = z * wide / (p.coulomb_n_m * wide + (p.stiction_n_m - p.coulomb_n_m));
            (slip / (1.0 + slip * slip).root(), sine(theta), bent)
        };
        let torque = coupling
            - p.bearing_viscous_n_m_s * psi_rate
            - p.bearing_dry_n_m * sign
            - p.pendulum_n_m * sine
            - p.hose_stiffness_n_m * psi;
        let bristle = nu - p.bristle_stiffness_n_m * nu.magnitude() * bent;
        let friction = p.bristle_stiffness_n_m * z + p.bristle_damping_n_m_s * bristle + p.drive_viscous_n_m_s * nu;
        let wanted = ((u - self.back_emf * nu) * self.per_resistance).limited(-p.current_max_a, p.current_max_a);
        [
            omega,
            torque * self.per_inertia,
            nu,
            (self.back_emf * current - friction - coupling) * self.per_drive_inertia,
            (wanted - current) * self.per_current_time,
            bristle,
            p.gyro_bandwidth_rad_s * (omega - gyro),
        ]
    }

    /// One step of the classical Runge-Kutta method; `base` holds (angle, rate) at the step's start, middle and end.
    #[inline]
    fn step(&self, x: &mut State, voltage: f64, base: &[(f64, f64); 3], dt: f64) {
        let u = voltage.limited(-self.plant.voltage_max_v, self.plant.voltage_max_v);
        match self.plant.curves {
            Curves::Algebraic => self.runge_kutta::<false>(x, u, base, dt),
            Curves::Transcendental => self.runge_kutta::<true>(x, u, base, dt),
        }
    }

    #[inline(always)]
    fn runge_kutta<const EXACT: bool>(&self, x: &mut State, u: f64, base: &[(f64, f64); 3], dt: f64) {
        let ahead = |k: &State, h: f64| -> State { core::array::from_fn(|i| x[i] + h * k[i]) };
        let k1 = self.derivative::<EXACT>(x, u, base[0]);
        let k2 = self.derivative::<EXACT>(&ahead(&k1, 0.5 * dt), u, base[1]);
        let k3 = self.derivative::<EXACT>(&ahead(&k2, 0.5 * dt), u, base[1]);
        let k4 = self.derivative::<EXACT>(&ahead(&k3, dt), u, base[2]);
        let sixth = dt / 6.0;
        *x = core::array::from_fn(|i| x[i] + sixth * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
    }
}

/// sin x for |x| <= pi/2 by its series to x^13 (error below 7e-10), +-1 beyond: a platform on its side has no more torque.
#[inline(always)]
fn sine(x: f64) -> f64 {
    let x = x.limited(-core::f64::consts::FRAC_PI_2, core::f64::consts::FRAC_PI_2);
    let y = x * x;
    let tail = 1.0 / 362_880.0 - y * (1.0 / 39_916_800.0 - y * (1.0 / 6_227_020_800.0));
    x * (1.0 - y * (1.0 / 6.0 - y * (1.0 / 120.0 - y * (1.0 / 5040.0 - y * tail))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pendulum_swings_back() {
        // The drive stands along, so that nothing pulls but the weight.
        let mut state = [0.1, 0.0, 0.1, 0.0, 0.0, 0.0, 0.0];
        Kernel::new(&Plant::platform_30kg()).run(&mut state, |_| 0.0, &[(0.0, 0.0); 3], 1e-3);
        assert!(state[0] < 0.1 && state[1] < 0.0, "{state:?}");
    }
}
