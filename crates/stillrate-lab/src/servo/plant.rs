//! The platform itself: one axis of a gyro-stabilised platform with its drive, friction, play and limits.
//!
//! States x = [theta, omega, alpha, nu, current, z, gyro]: the platform's inertial angle and rate, the drive's angle and rate
//! relative to the base, motor current, friction bristle, gyro output. The base turns by phi. SI and radians throughout.
//!
//! psi' = omega - phi', delta = alpha - (theta - phi); the coupling has play hb and twists q beyond it:
//! tau_c = kc q + cc (nu - psi') min(1, |q|/ds);
//! J omega' = tau_c - Bp psi' - Tp tanh(psi'/wp) - kg sin theta - ks psi; alpha' = nu;
//! LuGre friction F = s0 z + s1 z' + s2 nu, z' = nu - s0 |nu| z / g(nu), g = Fc + (Fs - Fc) e^(-(nu/vs)^2)
//! (Canudas de Wit et al., 1995); Jr nu' = n Ke i - F - tau_c; the driver asks for i* = (V - Ke n nu)/R within +-Imax, i' = (i* - i)/te;
//! gyro' = wg (omega - gyro).
//! [`Curves::Algebraic`], the default, replaces tanh x by x/sqrt(1+x^2), e^(-x^2) by 1/(1+x^2) and sin by a polynomial: the
//! same bits everywhere and nearly twice the speed; a slightly different friction law.

use stillrate::Real;
use stillrate::error::{ConfigError, not_negative, positive};

/// Number of states.
pub const STATES: usize = 7;
/// State of one axis: theta, omega, alpha, nu, current, z, gyro.
pub type State = [f64; STATES];
/// RK4 is stable on the real axis up to 2.78; measured on this plant: 2.4 works, 4.8 diverges.
const STEP_LIMIT: f64 = 2.5;

/// Which functions stand in friction and gravity.
///
/// # Example
/// ```
/// use stillrate_lab::servo::base::Base;
/// use stillrate_lab::servo::open_loop::open_loop;
/// use stillrate_lab::servo::plant::{Curves, Plant};
/// let fallen_to = |curves| {
///     let plant = Plant { curves, ..Plant::platform_30kg() };
///     let still = Base::Constant { angle_rad: 0.0 };
///     open_loop(&plant, &still, &[0.0], [0.1, 0.0, 0.1, 0.0, 0.0, 0.0, 0.0], 1e-3, 20).unwrap()[1][0]
/// };
/// let (fast, textbook) = (fallen_to(Curves::Algebraic), fallen_to(Curves::Transcendental));
/// assert!(fast != textbook && (fast - textbook).abs() < 2e-5); // of 6e-4 rad in 20 ms
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Curves {
    /// x/sqrt(1+x^2), 1/(1+x^2), a polynomial: no transcendental function.
    #[default]
    Algebraic,
    /// tanh, exp, sin: the textbook form, which the reference outputs use.
    Transcendental,
}

macro_rules! plant {
    ($($(#[$doc:meta])* $field:ident, $symbol:literal, $unit:literal, $check:ident;)+) => {
        /// Parameters of one axis, SI and radians.
        ///
        /// # Example
        /// ```
        /// use stillrate_lab::servo::plant::Plant;
        /// let mut plant = Plant::platform_30kg();
        /// assert!((plant.inertia_kg_m2 - 0.455625).abs() < 1e-12);
        /// assert!(plant.check(1e-3).is_ok());
        /// assert!(plant.check(4e-3).unwrap_err().to_string().contains("dt_s")); // the current loop is too fast for it
        /// *plant.number_mut("half_backlash_rad").unwrap() = 2e-3;
        /// let place = Plant::FIELDS.iter().position(|(_, symbol, _)| *symbol == "hb").unwrap();
        /// assert_eq!(plant.numbers()[place], 2e-3);
        /// assert_eq!(plant.linear().numbers()[place], 0.0);
        /// // Without a gear a motor of 0.2 V s at 12 V turns the camera at up to 60 rad/s.
        /// assert!((Plant::camera_gimbal().rate_limit_rad_s() - 60.0).abs() < 1e-9);
        /// ```
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Plant { $($(#[$doc])* pub $field: f64,)+
            /// Functions in friction and gravity.
            pub curves: Curves,
        }
        impl Plant {
            /// Name, symbol in the equations, and unit of every number.
            pub const FIELDS: &'static [(&'static str, &'static str, &'static str)] = &[$((stringify!($field), $symbol, $unit)),+];
            /// Every number in the order of [`Plant::FIELDS`].
            #[must_use]
            pub fn numbers(&self) -> Vec<f64> { vec![$(self.$field),+] }
            /// The number of that name, to change it.
            pub fn number_mut(&mut self, name: &str) -> Option<&mut f64> {
                match name { $(stringify!($field) => Some(&mut self.$field),)+ _ => None }
            }
            fn check_signs(&self) -> Result<(), ConfigError> {
                $($check(stringify!($field), self.$field, $unit)?;)+
                Ok(())
            }
        }
    };
}

plant! {
    /// J: inertia of the platform.
    inertia_kg_m2, "J", "kg m^2", positive;
    /// kg: pendulum stiffness at theta = 0.
    pendulum_n_m, "kg", "N m", not_negative;
    /// Bp: viscous friction of the platform bearing.
    bearing_viscous_n_m_s, "Bp", "N m s", not_negative;
    /// Tp: dry friction of the platform bearing.
    bearing_dry_n_m, "Tp", "N m", not_negative;
    /// wp: rate at which the dry friction of the bearing is nearly reached.
    bearing_rate_rad_s, "wp", "rad/s", positive;
    /// kc: stiffness of the coupling.
    coupling_stiffness_n_m, "kc", "N m/rad", positive;
    /// cc: damping of the coupling.
    coupling_damping_n_m_s, "cc", "N m s", not_negative;
    /// hb: half of the play.
    half_backlash_rad, "hb", "rad", not_negative;
    /// ds: twist over which the coupling's damping comes in.
    contact_softness_rad, "ds", "rad", positive;
    /// Jr: inertia of the drive, seen at the platform.
    drive_inertia_kg_m2, "Jr", "kg m^2", positive;
    /// s0: bristle stiffness.
    bristle_stiffness_n_m, "s0", "N m/rad", not_negative;
    /// s1: bristle damping.
    bristle_damping_n_m_s, "s1", "N m s", not_negative;
    /// s2: viscous friction of the drive.
    drive_viscous_n_m_s, "s2", "N m s", not_negative;
    /// Fc: Coulomb friction of the drive.
    coulomb_n_m, "Fc", "N m", positive;
    /// Fs: stiction of the drive.
    stiction_n_m, "Fs", "N m", positive;
    /// vs: Stribeck rate.
    stribeck_rate_rad_s, "vs", "rad/s", positive;
    /// n: gear ratio.
    gear_ratio, "n", "", positive;
    /// Ke: motor constant.
    motor_constant_v_s, "Ke", "V s/rad", positive;
    /// R: winding resistance.
    resistance_ohm, "R", "ohm", positive;
    /// te: time constant of the current loop.
    current_time_s, "te", "s", positive;
    /// Vmax: supply voltage.
    voltage_max_v, "Vmax", "V", positive;
    /// Imax: current limit.
    current_max_a, "Imax", "A", positive;
    /// wg: bandwidth of the gyro.
    gyro_bandwidth_rad_s, "wg", "rad/s", positive;
    /// ks: stiffness of a hose or cable between base and platform.
    hose_stiffness_n_m, "ks", "N m/rad", not_negative;
}

impl Plant {
    /// Checks every number, and the integration step (s) against the fastest mode.
    ///
    /// # Errors
    /// [`ConfigError`] naming the field.
    pub fn check(&self, dt_s: f64) -> Result<(), ConfigError> {
        self.check_signs()?;
        if self.stiction_n_m < self.coulomb_n_m {
            return Err(ConfigError::new("stiction_n_m", self.stiction_n_m, "N m", "at least coulomb_n_m in"));
        }
        positive("dt_s", dt_s, "s")?;
        if dt_s * self.fastest_rate() > STEP_LIMIT {
            return Err(ConfigError::new(
                "dt_s",
                dt_s,
                "s",
                "at most 2.5 over the plant's fastest rate (current loop, bristle, bearing friction, gyro or coupling) in",
            ));
        }
        Ok(())
    }

    /// The fastest rate of the plant, 1/s: bounds the integration step.
    fn fastest_rate(&self) -> f64 {
        let coupling = self.coupling_stiffness_n_m * (1.0 / self.inertia_kg_m2 + 1.0 / self.drive_inertia_kg_m2);
        [
            1.0 / self.current_time_s,
            self.bristle_stiffness_n_m * self.rate_limit_rad_s() / self.coulomb_n_m,
            self.bearing_dry_n_m / (self.bearing_rate_rad_s * self.inertia_kg_m2),
            self.gyro_bandwidth_rad_s,
            coupling.root(),
        ]
        .into_iter()
        .fold(0.0, f64::max)
    }

    /// Largest rate the drive reaches, rad/s: Vmax / (Ke n).
    #[must_use]
    pub fn rate_limit_rad_s(&self) -> f64 {
        self.voltage_max_v / (self.motor_constant_v_s * self.gear_ratio)
    }

    /// The same plant without play, dry friction and bristles: what linear analysis uses.
    #[must_use]
    pub fn linear(self) -> Self {
        Self {
            half_backlash_rad: 0.0,
            contact_softness_rad: 1e-12,
            bearing_dry_n_m: 0.0,
            bristle_stiffness_n_m: 0.0,
            bristle_damping_n_m_s: 0.0,
            coulomb_n_m: 1.0,
            stiction_n_m: 1.0,
            ..self
        }
    }
}
