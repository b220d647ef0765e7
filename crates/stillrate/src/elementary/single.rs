//! Elementary functions in `f32`.
/// Square root, correctly rounded.
#[inline(always)]
pub fn root(x: f32) -> f32 {
    libm::sqrtf(x)
}
/// e^x.
pub fn exponential(x: f32) -> f32 {
    libm::expf(x)
}
/// e^x - 1.
pub fn exponential_less_one(x: f32) -> f32 {
    libm::expm1f(x)
}
/// ln x.
pub fn logarithm(x: f32) -> f32 {
    libm::logf(x)
}
/// (sin x, cos x).
pub fn sine_cosine(x: f32) -> (f32, f32) {
    libm::sincosf(x)
}
/// atan2(y, x).
pub fn angle_over(y: f32, x: f32) -> f32 {
    libm::atan2f(y, x)
}
/// tanh x.
pub fn tangent_hyperbolic(x: f32) -> f32 {
    libm::tanhf(x)
}
