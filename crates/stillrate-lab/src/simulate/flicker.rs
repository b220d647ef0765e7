//! Flicker noise, the floor of an Allan deviation ("bias instability"), as a sum of Gauss-Markov processes.
//!
//! A Gauss-Markov process of variance s^2 and correlation time T has the two-sided density 2 s^2 T / (1 + (w T)^2).
//! Such processes whose times stand an octave apart sum to s^2 pi / (w ln 2) between the first and the last corner, within
//! 1.3 %; set equal to B^2 / w, the flicker noise of IEEE Std 952-2020, annex C, each has the deviation
//! s = B sqrt(ln 2 / pi). The floor of the Allan deviation is then B sqrt(2 ln 2 / pi) = 0.664 B. The times run from two
//! samples to twenty records.

use stillrate::Real;

use crate::random::Random;

/// Adds flicker of floor `floor_dps` (B, deg/s) to a record, with random numbers of the streams from `stream` on.
pub(super) fn add(record: &mut [f64], floor_dps: f64, seed: u64, stream: u64) {
    if floor_dps <= 0.0 {
        return;
    }
    let sigma = floor_dps * (core::f64::consts::LN_2 / core::f64::consts::PI).root();
    let (longest, mut time) = (20.0 * record.len() as f64, 2.0);
    for stream in stream.. {
        if time > longest {
            break;
        }
        let mut random = Random::new(seed, stream);
        let keep = (-1.0 / time).exponential();
        let drive = sigma * (-(-2.0 / time).exponential_less_one()).root();
        let mut state = sigma * random.normal();
        for value in &mut *record {
            *value += state;
            state = keep * state + drive * random.normal();
        }
        time *= 2.0;
    }
}
