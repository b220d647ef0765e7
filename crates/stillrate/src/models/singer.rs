//! temporary
use crate::real::Real;
/// Singer coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct SingerCoefficients<T> {
    /// (1 - e^-x) / a
    pub r: T,
    /// e^-x
    pub s: T,
    /// q11
    pub q11: T,
    /// q12
    pub q12: T,
    /// q22
    pub q22: T,
}
impl<T: Real> SingerCoefficients<T> {
    /// For alpha and dt.
    pub fn new(alpha: T, dt: T) -> Self {
        let x = alpha * dt;
        let m = -(-x).exponential_less_one();
        let mut sum = T::ZERO;
        let mut n = 23;
        while n >= 3 {
            let mut c = 1.0_f64;
            let mut k = 1;
            while k <= n {
                c /= k as f64;
                k += 1;
            }
            let sign = if n % 2 == 0 { 1.0 } else { -1.0 };
            let two = (1u64 << n) as f64 * sign;
            sum = sum * x + T::of((4.0 * sign - two) * c / 2.0);
            n -= 1;
        }
        let a = T::select(alpha > T::ZERO, alpha, T::ONE);
        let closed = (T::TWO * (x - m) - m * m) / (T::TWO * a * a * a);
        Self {
            r: T::select(alpha > T::ZERO, m / a, dt),
            s: (-x).exponential(),
            q11: T::select(x < T::ONE, dt * dt * dt * sum, closed),
            q12: T::select(alpha > T::ZERO, m * m / (T::TWO * a * a), dt * dt * T::HALF),
            q22: T::select(alpha > T::ZERO, -(-T::TWO * x).exponential_less_one() / (T::TWO * a), dt),
        }
    }
}
