//! The Kalman filter of the `kfilter` crate behind a C function.

use kfilter::kalman::{Kalman, KalmanFilter, KalmanPredict, KalmanUpdate};
use kfilter::measurement::{LinearMeasurement, Measurement};
use nalgebra::{Matrix1, Matrix1x2, Matrix2, Vector2};

/// Filters `n` samples with a state of two numbers that starts at the first sample; `f`, `q` and `p` are 2 x 2, row by row.
///
/// # Safety
/// `z` and `out` must hold `n` numbers, the matrices four.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kalman(
    n: usize,
    z: *const f64,
    out: *mut f64,
    f: *const f64,
    q: *const f64,
    r: f64,
    p: *const f64,
) {
    // SAFETY: promised by the caller.
    let (z, out, f, q, p) = unsafe {
        (
            core::slice::from_raw_parts(z, n),
            core::slice::from_raw_parts_mut(out, n),
            core::slice::from_raw_parts(f, 4),
            core::slice::from_raw_parts(q, 4),
            core::slice::from_raw_parts(p, 4),
        )
    };
    let matrix = |m: &[f64]| Matrix2::new(m[0], m[1], m[2], m[3]);
    let start = Vector2::new(z.first().copied().unwrap_or(0.0), 0.0);
    let mut filter = Kalman::new(matrix(f), matrix(q), start, matrix(p));
    let mut measurement = LinearMeasurement::new(Matrix1x2::new(1.0, 0.0), Matrix1::new(r), Matrix1::new(0.0));
    for (value, out) in z.iter().zip(out) {
        let _ = filter.predict();
        measurement.set_measurement(Matrix1::new(*value));
        let _ = filter.update(&measurement);
        *out = filter.state()[0];
    }
}
