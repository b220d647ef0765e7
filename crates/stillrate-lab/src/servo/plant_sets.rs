//! Parameter sets: the 30 kg platform of the paper, and a camera gimbal beside it.

use core::f64::consts::{PI, TAU};

use stillrate::Real;

use super::plant::{Curves, Plant};

impl Plant {
    /// The paper's platform: 30 kg, 0.45 m across, spindle drive with 20 mm lead at 0.2 m, 720 rpm, natural frequency 1 Hz.
    ///
    /// Mass, size, arm, motor speed, range and 1 Hz are the paper's; the rest is assumed (a stiff coupling at 30 Hz
    /// with 0.05 deg of half play, a 24 V drive limited to 3 A, LuGre friction, a 40 Hz gyro).
    #[must_use]
    pub fn platform_30kg() -> Self {
        Self::platform_with_lead(0.02)
    }

    /// The same with another spindle lead in metres (`10e-3` cannot follow 10 deg at 1 Hz).
    #[must_use]
    pub fn platform_with_lead(lead_m: f64) -> Self {
        // A disc and 20 % for what stands on it.
        let inertia = 1.2 * 30.0 * (0.45 / 2.0) * (0.45 / 2.0) / 4.0;
        let gear = TAU * 0.2 / lead_m;
        let stiffness = inertia * (TAU * 30.0) * (TAU * 30.0);
        Self {
            inertia_kg_m2: inertia,
            pendulum_n_m: inertia * TAU * TAU,
            bearing_viscous_n_m_s: 0.5,
            bearing_dry_n_m: 0.5,
            bearing_rate_rad_s: 0.01,
            coupling_stiffness_n_m: stiffness,
            coupling_damping_n_m_s: 2.0 * 0.05 * (stiffness * inertia).root(),
            half_backlash_rad: 0.05 * PI / 180.0,
            contact_softness_rad: 1e-4,
            drive_inertia_kg_m2: 2e-4 * gear * gear,
            bristle_stiffness_n_m: 4000.0,
            bristle_damping_n_m_s: 20.0,
            drive_viscous_n_m_s: 2.0,
            coulomb_n_m: 4.0,
            stiction_n_m: 6.0,
            stribeck_rate_rad_s: 0.02,
            gear_ratio: gear,
            motor_constant_v_s: 24.0 / (720.0 * TAU / 60.0),
            resistance_ohm: 1.0,
            current_time_s: 2e-3,
            voltage_max_v: 24.0,
            current_max_a: 3.0,
            gyro_bandwidth_rad_s: TAU * 40.0,
            hose_stiffness_n_m: 0.0,
            curves: Curves::Algebraic,
        }
    }

    /// A camera gimbal: 0.4 kg camera on a direct-drive brushless motor (no gear, no play), 60 Hz arm, 12 V, 1 A, 150 Hz gyro.
    ///
    /// Typical of a small drone gimbal; no particular product.
    #[must_use]
    pub fn camera_gimbal() -> Self {
        let inertia = 6e-4;
        let stiffness = inertia * (TAU * 60.0) * (TAU * 60.0);
        Self {
            inertia_kg_m2: inertia,
            // 1 mm between the axis and the centre of mass.
            pendulum_n_m: 0.4 * 9.81 * 1e-3,
            bearing_viscous_n_m_s: 1e-4,
            bearing_dry_n_m: 5e-4,
            bearing_rate_rad_s: 0.02,
            coupling_stiffness_n_m: stiffness,
            coupling_damping_n_m_s: 2.0 * 0.03 * (stiffness * inertia).root(),
            half_backlash_rad: 0.0,
            contact_softness_rad: 1e-6,
            drive_inertia_kg_m2: 1e-4,
            bristle_stiffness_n_m: 0.5,
            bristle_damping_n_m_s: 1e-3,
            drive_viscous_n_m_s: 2e-4,
            coulomb_n_m: 2e-3,
            stiction_n_m: 3e-3,
            stribeck_rate_rad_s: 0.05,
            gear_ratio: 1.0,
            motor_constant_v_s: 0.12,
            resistance_ohm: 8.0,
            current_time_s: 1e-3,
            voltage_max_v: 12.0,
            current_max_a: 1.0,
            gyro_bandwidth_rad_s: TAU * 150.0,
            // The camera's cable.
            hose_stiffness_n_m: 2e-3,
            curves: Curves::Algebraic,
        }
    }
}
