//! The scalar back end: one f32 at a time, as `libm` and the language have it.

super::entries!(f32, #[inline(never)]);
