//! Bias from two fixes over 2.5 s at 5 ms: the exact method and the classical shortcuts, in slow and fast motion, without noise.

use nalgebra::{Matrix3, Vector3};
use stillrate::Real;
use stillrate::attitude::reference_bias::{BiasSettings, Unknowns};
use stillrate::attitude::{Body, Navigation, Rotation, earth, so3};

use crate::reference_bias::{METHODS, Reading, ReferenceLog, reference_bias};
use crate::settings_map::SettingsError;

/// Bias of the table, deg/h.
const BIAS_DEG_H: [f64; 3] = [140.0, 150.0, 160.0];
const DEG_H: f64 = core::f64::consts::PI / 180.0 / 3600.0;

/// One row: a motion and a method with its error an axis.
///
/// # Example
/// ```
/// let rows = stillrate_lab::recursive::two_fixes::table(2.5, 0.005)?;
/// let blind = rows.iter().find(|row| row.motion == "slow" && row.method == "exact, Earth rate ignored").unwrap();
/// let missed = blind.error_deg_h.iter().map(|error| error * error).sum::<f64>().sqrt();
/// assert!((missed - 15.04).abs() < 0.1); // what is ignored comes out as bias: the Earth's 15.04 deg/h
/// # Ok::<(), stillrate_lab::settings_map::SettingsError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Name of the motion.
    pub motion: &'static str,
    /// Name of the method.
    pub method: &'static str,
    /// Estimate less truth, deg/h.
    pub error_deg_h: [f64; 3],
}

/// A motion without noise: exact mean rates with the bias of the table, a fix at either end.
fn simulate(fast: bool, time_s: f64, dt_s: f64) -> ReferenceLog {
    let (latitude, longitude) = (0.91, 0.09);
    let attitude = |t: f64| -> Rotation<f64, Body, Navigation> {
        let sine =
            |amplitude: f64, hz: f64, phase: f64| amplitude * (core::f64::consts::TAU * hz * t + phase).sine_cosine().0;
        if fast {
            Rotation::from_euler(sine(0.4, 0.5, 0.2), sine(0.3, 0.7, 1.0), sine(0.6, 0.3, 0.0))
        } else {
            Rotation::from_euler(sine(0.05, 0.05, 0.0), sine(0.04, 0.04, 1.0), 0.02 * t)
        }
    };
    let samples = (time_s / dt_s).round() as usize;
    let at = |k: usize| {
        let t = k as f64 * dt_s;
        *earth::inertial_attitude(latitude, longitude, attitude(t), t).matrix()
    };
    let rate_rad_s = (0..samples)
        .map(|k| (so3::log(&(at(k).transpose() * at(k + 1))) / dt_s + Vector3::from(BIAS_DEG_H) * DEG_H).into())
        .collect();
    let ends: Vec<Matrix3<f64>> = [0.0, samples as f64 * dt_s].map(|t| *attitude(t).matrix()).to_vec();
    ReferenceLog {
        rate_rad_s,
        dt_s: vec![dt_s; samples],
        fix_index: vec![0, samples],
        c_b_n: ends,
        latitude_rad: vec![latitude; 2],
        longitude_rad: vec![longitude; 2],
    }
}

/// Every method in slow and fast motion, and the exact one with the Earth standing still, from fixes `time_s` apart and rates every
/// `dt_s` seconds.
///
/// # Errors
/// [`SettingsError`] if `time_s` or `dt_s` is unusable.
///
/// # Example
/// ```
/// let rows = stillrate_lab::recursive::two_fixes::table(2.5, 0.005)?;
/// let worst = |method: &str| {
///     let errors = rows.iter().filter(|row| row.method == method).flat_map(|row| row.error_deg_h);
///     errors.fold(0.0_f64, |worst, error| worst.max(error.abs()))
/// };
/// assert!(worst("exact") < 1e-9 && worst("small-angle") > 1.0); // deg/h
/// # Ok::<(), stillrate_lab::settings_map::SettingsError>(())
/// ```
pub fn table(time_s: f64, dt_s: f64) -> Result<Vec<Row>, SettingsError> {
    let mut rows = Vec::new();
    for (motion, fast) in [("slow", false), ("fast", true)] {
        let log = simulate(fast, time_s, dt_s);
        let mut add = |name, earth_rate, method| -> Result<(), SettingsError> {
            let reading = Reading { earth_rate, instantaneous: false, project: false };
            let found = reference_bias(&log, reading, &BiasSettings::default(), Unknowns::default(), method)?;
            let error = found.bias_rad_s / DEG_H - Vector3::from(BIAS_DEG_H);
            rows.push(Row { motion, method: name, error_deg_h: error.into() });
            Ok(())
        };
        for (name, method) in METHODS {
            add(name, true, method)?;
        }
        add("exact, Earth rate ignored", false, METHODS[0].1)?;
    }
    Ok(rows)
}
