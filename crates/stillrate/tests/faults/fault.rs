//! The faults, and the stream that they strike.

use stillrate::Real;

pub(crate) const RATE_HZ: f64 = 50.0;
pub(crate) const PERIOD_S: f64 = 1.0 / RATE_HZ;
pub(crate) const DENSITY: f64 = 0.0151;
/// Standard deviation of a raw sample, deg/s.
pub(crate) const SIGMA: f64 = 0.106_773_124;

/// Amplitude of the motion, deg/s: 25 deg/s^2, inside the 30 deg/s^2 that the default models are made for. Far beyond it (at 95 deg/s^2)
/// the choice between models is chaotic: 1e-12 deg/s added to one sample moved the output of two interacting Singer models by 3 to 11 standard
/// deviations 650 samples later, with no fault at all, so that nothing could be said about recovery.
const MOTION: f64 = 5.0;

/// What happens to a stream of (value, dt).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Fault {
    /// One value is replaced.
    Value(f64),
    /// One time step is replaced.
    Step(f64),
    /// Value and time step of one sample are replaced.
    Both(f64, f64),
    /// So many values are missing.
    Dropout(usize),
    /// So many values repeat the last one before.
    Stuck(usize),
    /// So many values stand at plus or minus a rail.
    Rail(f64, usize),
    /// Every second of so many values is replaced.
    Flicker(f64, usize),
    /// The motion is not sampled for so many seconds, then goes on.
    Gap(f64),
    /// One value is so many standard deviations off.
    Spike(f64),
}

impl Fault {
    /// Strikes at a position; gives the first sample after the fault.
    pub(crate) fn strike(&self, samples: &mut [(f64, f64)], position: usize) -> usize {
        let held = samples[position.saturating_sub(1)].0;
        let end = |count: usize| (position + count).min(samples.len());
        let (from, to) = match *self {
            Self::Dropout(count) | Self::Stuck(count) | Self::Rail(_, count) | Self::Flicker(_, count) => {
                (position, end(count))
            }
            _ => (position, end(1)),
        };
        for (k, sample) in samples[from..to].iter_mut().enumerate() {
            match *self {
                Self::Value(value) => sample.0 = value,
                Self::Step(dt) => sample.1 = dt,
                Self::Both(value, dt) => *sample = (value, dt),
                Self::Dropout(_) => sample.0 = f64::NAN,
                Self::Stuck(_) => sample.0 = held,
                Self::Rail(rail, _) => sample.0 = rail,
                Self::Flicker(value, _) if k % 2 == 0 => sample.0 = value,
                Self::Flicker(..) => {}
                Self::Gap(seconds) => sample.1 = seconds,
                Self::Spike(sigmas) => sample.0 += sigmas * SIGMA,
            }
        }
        to
    }
}

/// Every kind of fault.
pub(crate) fn all() -> Vec<Fault> {
    let mut faults = Vec::new();
    let bad_values = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, -f64::MAX, 1e30, -1e30, 3e38, 1e18];
    let denormals = [5e-324, -5e-324, 1e-310, 1e-45, -1e-40, 1e-39, f64::MIN_POSITIVE, -0.0];
    faults.extend(bad_values.into_iter().chain(denormals).map(Fault::Value));
    let bad_steps = [0.0, -0.0, -PERIOD_S, -1e9, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
    let odd_steps = [5e-324, 1e-300, 1e-40, 1e-12, 1e-6, 0.5 * PERIOD_S, 1.02 * PERIOD_S, 1.5 * PERIOD_S];
    faults.extend(bad_steps.into_iter().chain(odd_steps).map(Fault::Step));
    faults.extend([0.06, 0.5, 2.0, 9.99, 10.01, 3600.0, 1e9, 1e30, 3e38, f64::MAX].map(Fault::Gap));
    faults.extend(
        [(f64::NAN, 0.0), (f64::INFINITY, 1e9), (f64::NAN, 1e-300), (1e30, -1.0)].map(|(v, t)| Fault::Both(v, t)),
    );
    faults.extend([2, 10, 100, 1000].map(Fault::Dropout));
    faults.extend([2, 50, 500].map(Fault::Stuck));
    faults
        .extend([(2000.0, 50), (-2000.0, 50), (2000.0, 1), (250.0, 200)].map(|(rail, count)| Fault::Rail(rail, count)));
    faults.extend(
        [(f64::NAN, 100), (f64::INFINITY, 101), (5e-324, 100), (2000.0, 40)].map(|(v, n)| Fault::Flicker(v, n)),
    );
    faults.extend([1e1, 1e2, 1e3, 1e4, 1e5, 1e6].into_iter().flat_map(|s| [Fault::Spike(s), Fault::Spike(-s)]));
    faults
}

/// A slow swing that starts and ends, with noise.
pub(crate) fn clean(length: usize) -> Vec<(f64, f64)> {
    let mut state = 0x5eed_u64;
    let mut uniform = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 * 2.0_f64.powi(-53) + 2.0_f64.powi(-54)
    };
    (0..length)
        .map(|k| {
            let moving = if (200..900).contains(&(k % 2000)) { MOTION } else { 0.0 };
            let swing = moving * (0.1 * k as f64).sine_cosine().0;
            let normal = (-2.0 * uniform().logarithm()).root() * (core::f64::consts::TAU * uniform()).sine_cosine().1;
            (swing + SIGMA * normal, PERIOD_S)
        })
        .collect()
}
