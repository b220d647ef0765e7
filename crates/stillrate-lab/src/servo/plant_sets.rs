//! Parameter sets: the 30 kg platform of the paper, and a camera gimbal beside it.

use core::f64::consts::{PI, TAU};

use stillrate::Real;
use stillrate::error::{ConfigError, not_negative, positive};

use super::plant::{Curves, Plant};

/// What a designer knows of a spindle-driven platform; [`PlatformDesign::plant`] turns it into equations.
///
/// # Example
/// ```
/// use stillrate_lab::servo::PlatformDesign;
/// let short = PlatformDesign { lead_m: 0.01, ..PlatformDesign::default() };
/// assert!((short.plant().unwrap().rate_limit_rad_s() - 0.6).abs() < 1e-12);
/// assert!(PlatformDesign { arm_m: 0.0, ..short }.plant().unwrap_err().to_string().contains("arm_m = 0"));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlatformDesign {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Diameter, m.
    pub diameter_m: f64,
    /// Arm of the spindle, m.
    pub arm_m: f64,
    /// Lead of the spindle, m a turn.
    pub lead_m: f64,
    /// Motor speed without load at full voltage, rpm.
    pub motor_rpm: f64,
    /// Natural frequency as a pendulum, Hz (0: balanced).
    pub natural_frequency_hz: f64,
    /// Inertia of the motor, kg m^2.
    pub motor_inertia_kg_m2: f64,
    /// Frequency of the coupling, Hz.
    pub coupling_hz: f64,
    /// Half of the play, degrees.
    pub half_backlash_deg: f64,
    /// Supply voltage, V.
    pub voltage_max_v: f64,
    /// Current limit, A.
    pub current_max_a: f64,
}

impl Default for PlatformDesign {
    /// The paper's platform (mass, size, arm, speed, 1 Hz); lead, inertia, coupling, play and electrics are assumed.
    fn default() -> Self {
        Self {
            mass_kg: 30.0,
            diameter_m: 0.45,
            arm_m: 0.2,
            lead_m: 0.02,
            motor_rpm: 720.0,
            natural_frequency_hz: 1.0,
            motor_inertia_kg_m2: 2e-4,
            coupling_hz: 30.0,
            half_backlash_deg: 0.05,
            voltage_max_v: 24.0,
            current_max_a: 3.0,
        }
    }
}

impl PlatformDesign {
    /// The parameters of one axis.
    ///
    /// # Errors
    /// [`ConfigError`] naming a field that is not positive (natural frequency and play may be 0).
    pub fn plant(&self) -> Result<Plant, ConfigError> {
        let mass = positive("mass_kg", self.mass_kg, "kg")?;
        let radius = 0.5 * positive("diameter_m", self.diameter_m, "m")?;
        // A disc and 20 % for what stands on it.
        let inertia = 1.2 * mass * radius * radius / 4.0;
        let gear = TAU * positive("arm_m", self.arm_m, "m")? / positive("lead_m", self.lead_m, "m")?;
        let coupling = TAU * positive("coupling_hz", self.coupling_hz, "Hz")?;
        let stiffness = inertia * coupling * coupling;
        let pendulum = TAU * not_negative("natural_frequency_hz", self.natural_frequency_hz, "Hz")?;
        Ok(Plant {
            inertia_kg_m2: inertia,
            pendulum_n_m: inertia * pendulum * pendulum,
            bearing_viscous_n_m_s: 0.5,
            bearing_dry_n_m: 0.5,
            bearing_rate_rad_s: 0.01,
            coupling_stiffness_n_m: stiffness,
            coupling_damping_n_m_s: 2.0 * 0.05 * (stiffness * inertia).root(),
            half_backlash_rad: not_negative("half_backlash_deg", self.half_backlash_deg, "deg")? * PI / 180.0,
            contact_softness_rad: 1e-4,
            drive_inertia_kg_m2: positive("motor_inertia_kg_m2", self.motor_inertia_kg_m2, "kg m^2")? * gear * gear,
            bristle_stiffness_n_m: 4000.0,
            bristle_damping_n_m_s: 20.0,
            drive_viscous_n_m_s: 2.0,
            coulomb_n_m: 4.0,
            stiction_n_m: 6.0,
            stribeck_rate_rad_s: 0.02,
            gear_ratio: gear,
            motor_constant_v_s: positive("voltage_max_v", self.voltage_max_v, "V")?
                / (positive("motor_rpm", self.motor_rpm, "rpm")? * TAU / 60.0),
            resistance_ohm: 1.0,
            current_time_s: 2e-3,
            voltage_max_v: self.voltage_max_v,
            current_max_a: positive("current_max_a", self.current_max_a, "A")?,
            gyro_bandwidth_rad_s: TAU * 40.0,
            hose_stiffness_n_m: 0.0,
            curves: Curves::Algebraic,
        })
    }
}

impl Plant {
    /// The paper's platform, [`PlatformDesign::default`].
    #[must_use]
    pub fn platform_30kg() -> Self {
        // The default design's numbers are all in range.
        PlatformDesign::default().plant().unwrap_or_else(|_| Self::camera_gimbal())
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
            bristle_stiffness_n_m: 0.1,
            bristle_damping_n_m_s: 2e-4,
            drive_viscous_n_m_s: 2e-4,
            coulomb_n_m: 2e-3,
            stiction_n_m: 3e-3,
            stribeck_rate_rad_s: 0.05,
            gear_ratio: 1.0,
            motor_constant_v_s: 0.2,
            resistance_ohm: 1.0,
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
