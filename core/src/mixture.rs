//! A mixture: the lobes that one outgoing direction needs, as rows of numbers ([`rows`]; [`row`] has the vectors
//! of one); made of given lobes ([`construct`]), completed ([`complete`]), multiplied ([`product`]); and the
//! factors that its values are multiplied by ([`factors`]).
//!
//! Evaluating and drawing are the kernels' part: `kernel` has these methods.
//! May import: `material`, `lobe`, `squeeze`, `color`, `simd`, `error`, `float`.

pub(crate) mod complete;
mod construct;
pub(crate) mod factors;
pub(crate) mod leave_out;
mod product;
pub(crate) mod row;
pub(crate) mod rows;
