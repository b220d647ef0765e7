//! Double oscillator: a narrow-band motion of unknown, slowly varying amplitude and phase.
//!
//! (d^2/dt^2 + omega^2)^2 w = white noise, state (w, w', w'', w'''). The impulse responses of the four derivatives are
//! h0 = (sin x - x cos x) / (2 omega^3), h1 = t sin x / (2 omega), h2 = (sin x + x cos x) / (2 omega),
//! h3 = cos x - x sin x / 2 with x = omega t, and h_k = -2 omega^2 h_(k-2) - omega^4 h_(k-4) from there on. They give the transition
//! whose row r is [h_(r+3) + 2 omega^2 h_(r+1), h_(r+2) + 2 omega^2 h_r, h_(r+1), h_r], and the process noise is the integral of
//! h h' over the step, by four-point Gauss-Legendre quadrature (positive semidefinite by construction).

use crate::gaussian::outer;
use crate::real::Real;
use crate::reals;

reals! {
    /// Transition and unit process noise of a double oscillator for one step.
    pub struct OscillatorStep {
        /// First column of F: what the rate does to each derivative.
        pub from_rate: [T; 4],
        /// Second column of F: what the acceleration does.
        pub from_acceleration: [T; 4],
        /// h0 ... h4; the third column of F is h1 ... h4, the fourth h0 ... h3.
        pub response: [T; 5],
        /// Integral of h h' over the step, packed (00 01 02 03 11 12 13 22 23 33).
        pub noise: [T; 10],
    }
}

/// Nodes and weights of four-point Gauss-Legendre quadrature on 0..1 (Abramowitz and Stegun, table 25.4).
const NODES: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_13, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_29, 0.173_927_422_568_726_93),
];

/// h0 ... h3 at time `t`.
#[inline(always)]
fn responses<T: Real>(omega: T, t: T) -> [T; 4] {
    let x = omega * t;
    let (sine, cosine) = x.sine_cosine();
    // sin x - x cos x cancels for small x.
    let square = x * x;
    let series = T::of(-1.0 / 90_720.0) + square * T::of(1.0 / 7_983_360.0);
    let series = T::of(1.0 / 1680.0) + square * series;
    let series = T::of(-1.0 / 60.0) + square * series;
    let series = t * t * t * (T::of(1.0 / 6.0) + square * series);
    let closed = (sine - x * cosine) / (T::TWO * omega * omega * omega);
    let half = T::HALF / omega;
    [
        T::select(x < T::of(0.3), series, closed),
        t * sine * half,
        (sine + x * cosine) * half,
        cosine - x * sine * T::HALF,
    ]
}

impl<T: Real> OscillatorStep<T> {
    /// For angular frequency `omega` > 0 and step `dt` in matching units.
    ///
    /// # Example
    /// ```
    /// use stillrate::models::oscillator::OscillatorStep;
    /// let step = OscillatorStep::new(2.0_f64, 0.1);
    /// // A pure sine at omega obeys the model: w = sin, w' = omega cos, w'' = -omega^2 sin, w''' = -omega^3 cos.
    /// let next = step.from_acceleration[0] * 2.0 - step.response[0] * 8.0;
    /// assert!((next - 0.2_f64.sin()).abs() < 1e-15);
    /// ```
    #[must_use]
    #[inline(always)]
    pub fn new(omega: T, dt: T) -> Self {
        let twice_square = T::TWO * omega * omega;
        let fourth = omega * omega * omega * omega;
        let [h0, h1, h2, h3] = responses(omega, dt);
        let h4 = -twice_square * h2 - fourth * h0;
        let h5 = -twice_square * h3 - fourth * h1;
        let h6 = -twice_square * h4 - fourth * h2;
        let mut noise = [T::ZERO; 10];
        for (node, weight) in NODES {
            let h = responses(omega, dt * T::of(node));
            let weighted = h.map(|value| value * (T::of(weight) * dt));
            for (sum, product) in noise.iter_mut().zip(outer(weighted, h)) {
                *sum += product;
            }
        }
        Self {
            from_rate: [h3 + twice_square * h1, h4 + twice_square * h2, h5 + twice_square * h3, h6 + twice_square * h4],
            from_acceleration: [
                h2 + twice_square * h0,
                h3 + twice_square * h1,
                h4 + twice_square * h2,
                h5 + twice_square * h3,
            ],
            response: [h0, h1, h2, h3, h4],
            noise,
        }
    }

    /// This step where the phase is known. After a gap that says nothing about the phase: the rate stays, the derivatives are
    /// forgotten, no noise.
    #[must_use]
    #[inline(always)]
    pub(crate) fn unless_forgotten(self, phase_known: bool) -> Self {
        let zero = T::ZERO;
        let forgetful = Self {
            from_rate: [T::ONE, zero, zero, zero],
            from_acceleration: [zero; 4],
            response: [zero; 5],
            noise: [zero; 10],
        };
        self.or_else(phase_known, &forgetful)
    }

    /// This step where `condition` holds, the other one elsewhere.
    #[must_use]
    #[inline(always)]
    pub(crate) fn or_else(mut self, condition: bool, other: &Self) -> Self {
        for k in 0..4 {
            self.from_rate[k] = T::select(condition, self.from_rate[k], other.from_rate[k]);
            self.from_acceleration[k] = T::select(condition, self.from_acceleration[k], other.from_acceleration[k]);
        }
        for k in 0..5 {
            self.response[k] = T::select(condition, self.response[k], other.response[k]);
        }
        for k in 0..10 {
            self.noise[k] = T::select(condition, self.noise[k], other.noise[k]);
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn transition(step: &OscillatorStep<f64>) -> nalgebra::Matrix4<f64> {
        nalgebra::Matrix4::from_fn(|row, column| match column {
            0 => step.from_rate[row],
            1 => step.from_acceleration[row],
            2 => step.response[row + 1],
            _ => step.response[row],
        })
    }

    #[test]
    fn two_half_steps_make_a_whole_one() {
        for omega in [1.2, 6.3, 30.0] {
            let half = transition(&OscillatorStep::new(omega, 0.01));
            let whole = transition(&OscillatorStep::new(omega, 0.02));
            let scale = whole.abs().max();
            assert!((half * half - whole).abs().max() < 4e-15 * scale, "omega {omega}");
        }
    }

    #[test]
    fn process_noise_grows_like_the_integral() {
        // Q(2T) = F(T) Q(T) F(T)' + Q(T) holds for the exact integral. Four nodes are exact to degree 7; h0^2 starts with
        // t^6, so that its t^8 term is missed by about (omega T)^2 of a 3e-5th.
        let unpack = |step: &OscillatorStep<f64>| {
            let n = step.noise;
            nalgebra::Matrix4::new(
                n[0], n[1], n[2], n[3], n[1], n[4], n[5], n[6], n[2], n[5], n[7], n[8], n[3], n[6], n[8], n[9],
            )
        };
        let step = OscillatorStep::new(6.3, 0.01);
        let whole = unpack(&OscillatorStep::new(6.3, 0.02));
        let forward = transition(&step);
        let sum = forward * unpack(&step) * forward.transpose() + unpack(&step);
        for (a, b) in sum.iter().zip(whole.iter()) {
            assert!((a - b).abs() < 3e-5 * 0.016 * 2.0 * b.abs(), "{a} {b}");
        }
    }
}
