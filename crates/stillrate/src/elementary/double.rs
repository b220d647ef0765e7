//! Elementary functions in `f64`.
/// Square root, correctly rounded.
#[inline(always)]
pub fn root(x: f64) -> f64 {
    libm::sqrt(x)
}
/// e^x.
pub fn exponential(x: f64) -> f64 {
    libm::exp(x)
}
/// e^x - 1.
pub fn exponential_less_one(x: f64) -> f64 {
    libm::expm1(x)
}
/// ln x.
pub fn logarithm(x: f64) -> f64 {
    libm::log(x)
}
/// (sin x, cos x).
pub fn sine_cosine(x: f64) -> (f64, f64) {
    libm::sincos(x)
}
/// atan2(y, x).
pub fn angle_over(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}
/// tanh x.
pub fn tangent_hyperbolic(x: f64) -> f64 {
    libm::tanh(x)
}
