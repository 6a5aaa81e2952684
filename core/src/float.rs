//! The one place that chooses the elementary functions: `libm`, with or without `std`, so that results do not depend
//! on the platform's C library.

pub(crate) fn exp(x: f32) -> f32 {
    libm::expf(x)
}
pub(crate) fn exp2(x: f32) -> f32 {
    libm::exp2f(x)
}
pub(crate) fn exp_m1(x: f32) -> f32 {
    libm::expm1f(x)
}
pub(crate) fn ln(x: f32) -> f32 {
    libm::logf(x)
}
pub(crate) fn ln_1p(x: f32) -> f32 {
    libm::log1pf(x)
}
pub(crate) fn sqrt(x: f32) -> f32 {
    libm::sqrtf(x)
}
pub(crate) fn sin_cos(x: f32) -> (f32, f32) {
    libm::sincosf(x)
}
