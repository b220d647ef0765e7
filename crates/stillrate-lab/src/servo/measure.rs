//! What a run of the platform is judged by.
//!
//! Residual: |theta| once the base moves regularly. Rest jitter: rms of the voltage less its moving mean over 0.4 s, in percent of the supply
//! (slow hunting by the integrator is left out, limit cycles are in), always measured AFTER a tilt: an adaptive filter that
//! is quiet at undisturbed rest can hide an unstable loop. Motion jitter: the same of the difference of two noise seeds, over sqrt 2.

use stillrate::Real;

use super::platform::Record;

const DEGREES: f64 = 180.0 / core::f64::consts::PI;
/// Length of the moving mean that is taken off the voltage.
const MEAN_S: f64 = 0.4;

/// A root mean square and a largest magnitude, degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Residual {
    /// Root mean square, deg.
    pub rms_deg: f64,
    /// Largest magnitude, deg.
    pub max_deg: f64,
}

/// Angle error of the ticks from `from_s` on; infinite for a platform that was lost.
#[must_use]
pub fn residual(record: &Record, from_s: f64, period_s: f64) -> Residual {
    if record.lost_at.is_some() {
        return Residual { rms_deg: f64::INFINITY, max_deg: f64::INFINITY };
    }
    let angles = || record.rows.iter().skip((from_s / period_s + 0.5) as usize).map(|row| row[0] * DEGREES);
    let count = angles().count().max(1) as f64;
    Residual {
        rms_deg: (angles().map(|a| a * a).sum::<f64>() / count).root(),
        max_deg: angles().fold(0.0, |m, a| m.max(a.magnitude())),
    }
}

/// Rest jitter between two times, percent of the supply voltage; infinite for a platform that was lost.
#[must_use]
pub fn rest_jitter(record: &Record, from_s: f64, to_s: f64, period_s: f64, voltage_max_v: f64) -> f64 {
    if record.lost_at.is_some() {
        return f64::INFINITY;
    }
    let voltage: Vec<f64> = record.rows.iter().map(|row| row[1]).collect();
    100.0 / voltage_max_v * without_mean(&voltage, from_s, to_s, period_s)
}

/// Motion jitter from two records that differ in their noise only, percent of the supply voltage.
#[must_use]
pub fn motion_jitter(a: &Record, b: &Record, from_s: f64, to_s: f64, period_s: f64, voltage_max_v: f64) -> f64 {
    if a.lost_at.is_some() || b.lost_at.is_some() {
        return f64::INFINITY;
    }
    let difference: Vec<f64> = a.rows.iter().zip(&b.rows).map(|(x, y)| x[1] - y[1]).collect();
    100.0 / voltage_max_v * without_mean(&difference, from_s, to_s, period_s) / 2.0.root()
}

/// Root mean square of the voltage between two times, percent of the supply.
#[must_use]
pub fn voltage_rms(record: &Record, from_s: f64, period_s: f64, voltage_max_v: f64) -> f64 {
    let rows = record.rows.iter().skip((from_s / period_s + 0.5) as usize);
    let (sum, count) = rows.fold((0.0, 0.0), |(s, n), row| (s + row[1] * row[1], n + 1.0));
    100.0 / voltage_max_v * (sum / f64::max(count, 1.0)).root()
}

/// Mean |theta| over the last `window_s`, deg.
#[must_use]
pub fn final_error_deg(record: &Record, window_s: f64, period_s: f64) -> f64 {
    final_error_against(record, &[], window_s, period_s)
}

/// Mean |theta + drift| over the last `window_s`, deg, for the angle that a gyro's errors add up to at every tick (0 where the list ends).
#[must_use]
pub fn final_error_against(record: &Record, drift_rad: &[f64], window_s: f64, period_s: f64) -> f64 {
    if record.lost_at.is_some() {
        return f64::INFINITY;
    }
    let keep = ((window_s / period_s + 0.5) as usize).max(1);
    let from = record.rows.len().saturating_sub(keep);
    let drift = drift_rad.iter().skip(from).chain(core::iter::repeat(&0.0));
    let tail = &record.rows[from..];
    DEGREES * tail.iter().zip(drift).map(|(row, d)| (row[0] + d).magnitude()).sum::<f64>() / tail.len().max(1) as f64
}

/// Root mean square of a signal less its centred moving mean, over the ticks of a window for which the mean is whole.
fn without_mean(signal: &[f64], from_s: f64, to_s: f64, period_s: f64) -> f64 {
    let half = (0.5 * MEAN_S / period_s + 0.5) as usize;
    let first = ((from_s / period_s + 0.5) as usize).max(half);
    let last = ((to_s / period_s + 0.5) as usize).min(signal.len().saturating_sub(half));
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
