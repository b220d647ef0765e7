//! The coefficients of a gimballed sensor head: order, names, scales, and the axes they belong to.
//!
//! One vector of 41 numbers holds everything in SI units (source of the first 33: reconstruction of DOI
//! 10.3873/j.issn.1000-1328.2017.06.009; the rest are the optional states a user may switch on). Symbols: phi attitude of the true
//! platform against the commanded one; kg0, kgI, kgO, kgS gyro drift and its g-sensitive parts along input, output and spin axis;
//! do, ds gyro mounting; ka0, ka1 accelerometer bias and scale error; thp, tho accelerometer mounting; tq torquer scale error;
//! ka2 quadratic accelerometer coefficient; latency of the accelerometers against the command; error of the given latitude.

use crate::error::ConfigError;

/// How many coefficients there are.
pub const COUNT: usize = 41;
/// A full set of coefficients in SI units, in the order of the constants of this module.
pub type Coefficients = [f64; COUNT];

/// First of three attitude errors, rad.
pub const ATTITUDE: usize = 0;
/// First of three gyro drifts kg0, rad/s.
pub const GYRO_BIAS: usize = 3;
/// First of three g-sensitive drifts along the input axis kgI, rad/s per g.
pub const G_INPUT: usize = 6;
/// First of three g-sensitive drifts along the output axis kgO, rad/s per g.
pub const G_OUTPUT: usize = 9;
/// First of three g-sensitive drifts along the spin axis kgS, rad/s per g.
pub const G_SPIN: usize = 12;
/// First of three gyro mounting angles about the output axis do, rad.
pub const GYRO_ABOUT_OUTPUT: usize = 15;
/// First of three gyro mounting angles about the spin axis ds, rad.
pub const GYRO_ABOUT_SPIN: usize = 18;
/// First of three accelerometer biases ka0, m/s^2.
pub const FORCE_BIAS: usize = 21;
/// First of three accelerometer scale errors ka1.
pub const FORCE_SCALE: usize = 24;
/// First of three accelerometer mounting angles about the pendulous axis thp, rad.
pub const FORCE_ABOUT_PENDULOUS: usize = 27;
/// First of three accelerometer mounting angles about the output axis tho, rad.
pub const FORCE_ABOUT_OUTPUT: usize = 30;
/// First of three torquer scale errors tq.
pub const TORQUER: usize = 33;
/// First of three quadratic accelerometer coefficients ka2, 1/(m/s^2).
pub const FORCE_QUADRATIC: usize = 36;
/// Time by which the accelerometer samples are older than they claim, s.
pub const LATENCY: usize = 39;
/// Error of the given latitude, rad.
pub const LATITUDE: usize = 40;

/// Names of the coefficients, in order.
pub const NAMES: [&str; COUNT] = [
    "phi_x", "phi_y", "phi_z", "kg0x", "kg0y", "kg0z", "kgIx", "kgIy", "kgIz", "kgOx", "kgOy", "kgOz", "kgSx", "kgSy",
    "kgSz", "do_x", "do_y", "do_z", "ds_x", "ds_y", "ds_z", "ka0x", "ka0y", "ka0z", "ka1x", "ka1y", "ka1z", "thp_x",
    "thp_y", "thp_z", "tho_x", "tho_y", "tho_z", "tq_x", "tq_y", "tq_z", "ka2x", "ka2y", "ka2z", "latency", "latitude",
];

/// 0.1 deg/h in rad/s.
const TENTH_DEG_H: f64 = 0.1 * core::f64::consts::PI / 180.0 / 3600.0;
/// Standard gravity of the scales, m/s^2.
const SCALE_GRAVITY: f64 = 9.8;

/// Default prior standard deviations, which also condition the numbers inside every filter.
pub const DEFAULT_SCALE: Coefficients = {
    let mut s = [5e-4; COUNT];
    let mut i = GYRO_BIAS;
    while i < GYRO_ABOUT_OUTPUT {
        s[i] = TENTH_DEG_H;
        i += 1;
    }
    let mut axis = 0;
    while axis < 3 {
        s[FORCE_BIAS + axis] = 1e-4 * SCALE_GRAVITY;
        s[FORCE_SCALE + axis] = 1e-3;
        s[TORQUER + axis] = 2e-4;
        s[FORCE_QUADRATIC + axis] = 1e-5 / SCALE_GRAVITY;
        axis += 1;
    }
    s[LATENCY] = 2e-3;
    s[LATITUDE] = 1e-3;
    s
};

/// Which platform axis (0, 1, 2) each instrument axis points along: rows are instruments x, y, z; columns are input, output,
/// spin axis of a gyro and input, pendulous, output axis of an accelerometer. The default is cyclic.
///
/// # Example
/// ```
/// use stillrate::gimbal::Triads;
/// assert_eq!(Triads::default().gyro[1], [1, 2, 0]); // gyro y: input along y, output along z, spin along x
/// let crossed = Triads { gyro: [[0, 1, 1], [1, 2, 0], [2, 0, 1]], ..Triads::default() };
/// assert_eq!(crossed.check().unwrap_err().field, "gyro triads");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Triads {
    /// Gyros: input, output, spin axis.
    pub gyro: [[usize; 3]; 3],
    /// Accelerometers: input, pendulous, output axis.
    pub accelerometer: [[usize; 3]; 3],
}

impl Default for Triads {
    fn default() -> Self {
        let cyclic = [[0, 1, 2], [1, 2, 0], [2, 0, 1]];
        Self { gyro: cyclic, accelerometer: cyclic }
    }
}

impl Triads {
    /// Checks that every row and the input axes of both triads are permutations of 0, 1, 2.
    ///
    /// # Errors
    /// [`ConfigError`] with the first axis that is wrong.
    pub fn check(&self) -> Result<(), ConfigError> {
        let permutation = |axes: &[usize; 3]| {
            axes.iter().all(|&a| a < 3) && axes[0] != axes[1] && axes[1] != axes[2] && axes[0] != axes[2]
        };
        for (field, triad) in [("gyro triads", &self.gyro), ("accelerometer triads", &self.accelerometer)] {
            let inputs = [triad[0][0], triad[1][0], triad[2][0]];
            for axes in triad.iter().chain([&inputs]) {
                if !permutation(axes) {
                    return Err(ConfigError::new(field, axes[0] as f64, "", "permutations of 0, 1, 2"));
                }
            }
        }
        Ok(())
    }
}
