//! What a run of the platform is judged by.
//!
//! Residual: |theta| once the base moves regularly. Rest jitter: rms of the voltage less its moving mean over 0.4 s, in percent of the supply
//! (slow hunting by the integrator is left out, limit cycles are in), always measured AFTER a tilt: an adaptive filter that
//! is quiet at undisturbed rest can hide an unstable loop. Motion jitter: the same of the difference of two noise seeds, over sqrt 2.

use stillrate::Real;

use super::DEGREES;
use super::platform::Record;

/// Length of the moving mean that is taken off the voltage.
const MEAN_S: f64 = 0.4;

/// A root mean square and a largest magnitude, degrees.
///
/// # Example
/// ```
/// use stillrate_lab::servo::{measure::{Residual, residual}, platform::Record};
/// // A platform that was lost has no residual, however quiet it was before.
/// let lost = Record { rows: vec![[0.0; 8]; 400], lost_at: Some(399), ..Record::default() };
/// assert_eq!(residual(&lost, 3.0, 0.02), Residual { rms_deg: f64::INFINITY, max_deg: f64::INFINITY });
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Residual {
    /// Root mean square, deg.
    pub rms_deg: f64,
    /// Largest magnitude, deg.
    pub max_deg: f64,
}

/// Angle error of the ticks (`period_s` apart) from `from_s` on; infinite for a platform that was lost, 0 where there are none.
///
/// # Example
/// ```
/// use stillrate_lab::servo::{measure::residual, platform::Record};
/// let swing = |k: u32| 0.1 * f64::from(k % 50) / 50.0 - 0.05; // a sawtooth of 0.05 rad
/// let record = Record { rows: (0..400).map(|k| [swing(k), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]).collect(), ..Record::default() };
/// let found = residual(&record, 3.0, 0.02);
/// assert!((found.max_deg - 0.05_f64.to_degrees()).abs() < 1e-12);
/// assert!((found.rms_deg / found.max_deg - 3_f64.sqrt().recip()).abs() < 1e-3);
/// ```
#[must_use]
pub fn residual(record: &Record, from_s: f64, period_s: f64) -> Residual {
    if record.lost_at.is_some() {
        return Residual { rms_deg: f64::INFINITY, max_deg: f64::INFINITY };
    }
    let angles = || record.rows.iter().skip(ticks(from_s, period_s)).map(|row| row[0] * DEGREES);
    let count = angles().count().max(1) as f64;
    Residual {
        rms_deg: (angles().map(|a| a * a).sum::<f64>() / count).root(),
        max_deg: angles().fold(0.0, |m, a| m.max(a.magnitude())),
    }
}

/// Rest jitter between two times, percent of the supply voltage; infinite for a platform that was lost.
pub(crate) fn rest_jitter(record: &Record, from_s: f64, to_s: f64, period_s: f64, voltage_max_v: f64) -> f64 {
    if record.lost_at.is_some() {
        return f64::INFINITY;
    }
    let voltage: Vec<f64> = record.rows.iter().map(|row| row[1]).collect();
    100.0 / voltage_max_v * without_mean(&voltage, from_s, to_s, period_s)
}

/// Motion jitter from two records that differ in their noise only, percent of the supply voltage.
pub(crate) fn motion_jitter(a: &Record, b: &Record, from_s: f64, to_s: f64, period_s: f64, voltage_max_v: f64) -> f64 {
    if a.lost_at.is_some() || b.lost_at.is_some() {
        return f64::INFINITY;
    }
    let difference: Vec<f64> = a.rows.iter().zip(&b.rows).map(|(x, y)| x[1] - y[1]).collect();
    100.0 / voltage_max_v * without_mean(&difference, from_s, to_s, period_s) / 2.0.root()
}

/// Root mean square of the voltage between two times, percent of the supply.
pub(crate) fn voltage_rms(record: &Record, from_s: f64, period_s: f64, voltage_max_v: f64) -> f64 {
    let rows = record.rows.iter().skip(ticks(from_s, period_s));
    let (sum, count) = rows.fold((0.0, 0.0), |(s, n), row| (s + row[1] * row[1], n + 1.0));
    100.0 / voltage_max_v * (sum / f64::max(count, 1.0)).root()
}

/// Mean |theta + drift| over the last `window_s`, deg, for the angle that a gyro's errors add up to at every tick (0 where the list ends).
pub(crate) fn final_error_deg(record: &Record, drift_rad: &[f64], window_s: f64, period_s: f64) -> f64 {
    if record.lost_at.is_some() {
        return f64::INFINITY;
    }
    let keep = ticks(window_s, period_s).max(1);
    let from = record.rows.len().saturating_sub(keep);
    let drift = drift_rad.iter().skip(from).chain(core::iter::repeat(&0.0));
    let tail = &record.rows[from..];
    DEGREES * tail.iter().zip(drift).map(|(row, d)| (row[0] + d).magnitude()).sum::<f64>() / tail.len().max(1) as f64
}

/// How many control periods a time is.
fn ticks(time_s: f64, period_s: f64) -> usize {
    (time_s / period_s + 0.5) as usize
}

/// Root mean square of a signal less its centred moving mean, over the ticks of a window for which the mean is whole.
fn without_mean(signal: &[f64], from_s: f64, to_s: f64, period_s: f64) -> f64 {
    let half = ticks(0.5 * MEAN_S, period_s);
    let first = ticks(from_s, period_s).max(half);
    let last = ticks(to_s, period_s).min(signal.len().saturating_sub(half));
    let (mut sum, mut count) = (0.0, 0.0);
    for k in first..last {
        let around = &signal[k - half..=(k + half).min(signal.len() - 1)];
        let mean = around.iter().sum::<f64>() / around.len() as f64;
        sum += (signal[k] - mean) * (signal[k] - mean);
        count += 1.0;
    }
    if count == 0.0 { 0.0 } else { (sum / count).root() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_hunting_is_not_jitter_and_an_alternating_voltage_is() {
        let rows = |f: fn(usize) -> f64| (0..700).map(|k| [0.0, f(k), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]).collect();
        let ramp = Record { rows: rows(|k| k as f64 * 0.01), ..Record::default() };
        assert!(rest_jitter(&ramp, 6.0, 14.0, 0.02, 24.0) < 1e-12);
        let alternating = Record { rows: rows(|k| if k % 2 == 0 { 0.24 } else { -0.24 }), ..Record::default() };
        let jitter = rest_jitter(&alternating, 6.0, 14.0, 0.02, 24.0);
        assert!((jitter - 1.0).abs() < 0.06, "{jitter}");
    }
}
