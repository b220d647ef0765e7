//! Singer's motion model in closed form: acceleration as a first-order Gauss-Markov process.
//!
//! R. A. Singer, "Estimating optimal tracking filter performance for manned maneuvering targets", IEEE Trans. AES-6 (1970).
//! State (rate, acceleration), w'' = -alpha w' + white noise of unit density; over a step T, with x = alpha T,
//! F = [1 r; 0 s] and Q = [q11 q12; q12 q22]:
//! r = (1 - e^-x)/alpha, s = e^-x, q11 = (4 e^-x - e^-2x + 2x - 3)/(2 alpha^3), q12 = (1 - e^-x)^2/(2 alpha^2),
//! q22 = (1 - e^-2x)/(2 alpha). q12 = r^2/2 and q22 = r (1 + s)/2 hold exactly and are used.
//!
//! As printed, r and the q lose every digit at small x (q11 is off by 1e20). Below x = 1 their power series in x are
//! summed instead, in which alpha = 0 (constant acceleration) is an ordinary point; between 1 and 2, where the printed form still
//! cancels, two half steps are composed. All forms are computed and one is selected.
//! The rounding error of x = alpha T itself is recovered (Dekker's product) because e^-x multiplies it by x.

use core::hint::black_box;

use crate::plain;
use crate::real::Real;

plain! {
    /// Transition and unit process noise of a Singer model over one step.
    ///
    /// Multiply the `q` by the spectral density of the driving noise, 2 alpha sigma_m^2. Units: alpha in 1/s, r in s,
    /// q11 in s^3, q12 in s^2, q22 in s. Largest relative errors over 40 000 random alpha T in 1e-12..50, against 120 digits:
    /// r 2.4e-16, s 2.1e-16, q11 5.0e-16, q12 5.0e-16, q22 3.4e-16 in `f64`; q11, the worst, 3.0e-7 in `f32`.
    ///
    /// # Example
    /// ```
    /// use stillrate::models::SingerCoefficients;
    /// let constant_acceleration = SingerCoefficients::new(0.0, 0.5);
    /// assert_eq!(constant_acceleration, SingerCoefficients { r: 0.5, s: 1.0, q11: 0.125 / 3.0, q12: 0.125, q22: 0.5 });
    /// ```
    pub struct SingerCoefficients<T> {
        /// Rate gained per unit of acceleration, s.
        pub r: T,
        /// Share of the acceleration that remains.
        pub s: T,
        /// Variance of the rate, s^3.
        pub q11: T,
        /// Covariance of rate and acceleration, s^2.
        pub q12: T,
        /// Variance of the acceleration, s.
        pub q22: T,
    }
}

/// Terms of the power series: enough at x = 1 for the last to vanish beside the first.
const TERMS: usize = 24;
/// The same for `f32`.
const TERMS_SINGLE: usize = 14;

/// The coefficients of a series, rounded once for each type: small processors would convert them anew in every step.
struct Series {
    double: [f64; TERMS],
    single: [f32; TERMS_SINGLE],
}

/// (1 - e^-x)/x = sum of (-1)^n / (n + 1)! x^n.
static GAIN: Series = in_both(series(0));
/// (q11/T^3 - 1/3)/x, where q11/T^3 = sum over n >= 3 of (4 (-1)^n - (-2)^n) / (2 n!) x^(n-3).
static RATE_VARIANCE_REST: Series = in_both(series(1));
/// r'/T^2 = sum over n >= 2 of (-1)^(n-1) (n - 1) / n! x^(n-2).
static GAIN_SLOPE: Series = in_both(series(2));

const fn in_both(double: [f64; TERMS]) -> Series {
    let mut single = [0.0; TERMS_SINGLE];
    let mut n = 0;
    while n < TERMS_SINGLE {
        single[n] = double[n] as f32;
        n += 1;
    }
    Series { double, single }
}

/// The coefficients of one of the three series; numerators and factorials up to 22! are exact in `f64`, beyond it does not matter.
const fn series(which: usize) -> [f64; TERMS] {
    let first = [1, 4, 2][which];
    let mut coefficients = [0.0; TERMS];
    let mut factorial = 1.0;
    let mut sign = -1.0;
    let mut power = 2.0;
    let mut n = 1;
    while n < first + TERMS {
        factorial *= n as f64;
        if n >= first {
            let numerator = match which {
                0 => -sign,
                1 => sign * (4.0 - power) / 2.0,
                _ => -sign * (n as f64 - 1.0),
            };
            coefficients[n - first] = numerator / factorial;
        }
        sign = -sign;
        power *= 2.0;
        n += 1;
    }
    coefficients
}

/// Sum of a series at x, by Horner's rule.
#[inline(always)]
fn sum<T: Real>(series: &'static Series, x: T) -> T {
    let mut sum = T::ZERO;
    if T::BYTES == 4 && cfg!(target_arch = "arm") {
        // Stays a loop: unrolled it would be a fifth of the code of a whole filter in a microcontroller.
        for &coefficient in black_box(&series.single[..]).iter().rev() {
            sum = sum * x + T::of(f64::from(black_box(coefficient)));
        }
    } else if T::BYTES == 4 {
        for &coefficient in series.single.iter().rev() {
            sum = sum * x + T::of(f64::from(coefficient));
        }
    } else {
        for &coefficient in series.double.iter().rev() {
            sum = sum * x + T::of(coefficient);
        }
    }
    sum
}

/// q11/T^3. Its first coefficient, 1/3, is put in with the part that its rounding lost: at x = 1 the sum is half of it.
#[inline(always)]
fn rate_variance<T: Real>(x: T) -> T {
    const THIRD: f64 = 1.0 / 3.0;
    const THIRD_LACKS: f64 = 1.850371707708594e-17;
    let first = T::of(THIRD);
    let lacking = T::of((THIRD - first.widen()) + THIRD_LACKS);
    first + (x * sum(&RATE_VARIANCE_REST, x) + lacking)
}

/// a b and its rounding error (Dekker); the error reads 0 where the factors are too large to be split.
#[inline(always)]
fn product<T: Real>(a: T, b: T) -> (T, T) {
    let splitter = T::of(if T::BYTES == 4 { 4097.0 } else { 134_217_729.0 });
    let halves = |number: T| {
        let scaled = number * splitter;
        let high = scaled - (scaled - number);
        (high, number - high)
    };
    let ((a_high, a_low), (b_high, b_low)) = (halves(a), halves(b));
    let rounded = a * b;
    let error = ((a_high * b_high - rounded) + a_high * b_low + a_low * b_high) + a_low * b_low;
    (rounded, T::select(error.finite(), error, T::ZERO))
}

/// What both functions below need of alpha and T.
struct Step<T> {
    /// x = alpha T.
    x: T,
    /// True product less x.
    error: T,
    /// e^-x of the true product.
    s: T,
    /// x < 1: the series hold for the whole step.
    near: bool,
    /// 1 <= x < 2: the series hold for half the step, two of which make the whole.
    doubled: bool,
    /// The step the series are summed for.
    part: T,
    /// alpha times that step.
    part_x: T,
    /// alpha where x >= 2 (else 1, for a safe division).
    divisor: T,
}

impl<T: Real> Step<T> {
    #[inline(always)]
    fn new(alpha: T, dt: T) -> Self {
        let (x, error) = product(alpha, dt);
        // Far beyond anything that still decays; an infinite x would make NaN of infinity over infinity.
        let x = x.least(T::LARGEST.root());
        let s = (-x).exponential();
        let near = x < T::ONE;
        let doubled = !near && x < T::TWO;
        let share = T::select(near, T::ONE, T::HALF);
        let divisor = T::select(x < T::TWO, T::ONE, alpha);
        Self { x, error, s: s - s * error, near, doubled, part: dt * share, part_x: x * share, divisor }
    }

    /// The value for the whole step where it has a series, else `far`.
    #[inline(always)]
    fn choose(&self, near: T, doubled: T, far: T) -> T {
        T::select(self.near, near, T::select(self.doubled, doubled, far))
    }
}

impl<T: Real> SingerCoefficients<T> {
    /// For alpha >= 0 in 1/s and dt >= 0 in s.
    #[must_use]
    #[inline(always)]
    pub fn new(alpha: T, dt: T) -> Self {
        let step = Step::new(alpha, dt);
        let s = step.s;
        let gain = sum(&GAIN, step.part_x);
        // F Q F' + Q with both of half the step: a sum of positive terms; s of half the step is 1 - x gain.
        let variance = rate_variance(step.part_x);
        let square = gain * gain;
        let composed = T::TWO * variance + square * (T::TWO * gain - T::HALF * (step.part_x * square));
        let cube = step.part * step.part * step.part;
        let numerator = ((step.x + step.x - T::of(3.0)) + T::of(4.0) * s) - s * s + T::TWO * step.error;
        let far = numerator / (T::TWO * step.divisor * step.divisor * step.divisor);
        let far_r = (T::ONE - s) / T::select(step.near, T::ONE, alpha);
        let r = T::select(step.near, step.part * gain, far_r);
        let q11 = T::select(step.near || step.doubled, cube * T::select(step.near, variance, composed), far);
        Self { r, s, q11, q12: r * r * T::HALF, q22: r * ((T::ONE + s) * T::HALF) }
    }

    /// With the process noise of driving noise of spectral density `intensity` instead of 1.
    #[must_use]
    #[inline(always)]
    pub(crate) fn driven_by(self, intensity: T) -> Self {
        Self { q11: intensity * self.q11, q12: intensity * self.q12, q22: intensity * self.q22, ..self }
    }

    /// The density given to [`SingerCoefficients::driven_by`].
    #[must_use]
    #[inline(always)]
    pub(crate) fn intensity(&self) -> T {
        self.q22 / (self.r * ((T::ONE + self.s) * T::HALF))
    }
}

/// Derivatives of r and s with respect to alpha, in s^2 and s, for an extended Kalman filter that estimates alpha:
/// r' = (x e^-x - (1 - e^-x))/alpha^2 and s' = -T e^-x.
///
/// # Example
/// ```
/// use stillrate::models::singer_derivatives;
/// assert_eq!(singer_derivatives(0.0, 0.5), (-0.125, -0.5));
/// ```
#[must_use]
#[inline(always)]
pub fn singer_derivatives<T: Real>(alpha: T, dt: T) -> (T, T) {
    let step = Step::new(alpha, dt);
    let near = step.part * step.part * sum(&GAIN_SLOPE, step.part_x);
    // r = r_h (1 + s_h) of half the step, differentiated: no cancellation.
    let gain = sum(&GAIN, step.part_x);
    let part_s = T::ONE - step.part_x * gain;
    let doubled = near * (T::ONE + part_s) - step.part * step.part * (gain * part_s);
    let far = ((step.x + T::ONE) * step.s - T::ONE) / (step.divisor * step.divisor);
    (step.choose(near, doubled, far), -(dt * step.s))
}
