//! One family of lobes over all views: what an isotropic fit and an anisotropic one have in common.
//!
//! Lobe k of one stored view is lobe k of the next. The room has the unknowns, the lobes of a view, the table of factors, the sum of
//! squares and what starts share. `layout::Views` says where stored views stand: `isotropic` has them on a line, `anisotropic` on a grid.
//!
//! May import: `judge`.

pub(crate) mod balance;
pub(crate) mod factors;
pub(crate) mod layout;
pub(crate) mod lobes;
pub(crate) mod matrix;
pub(crate) mod objective;
pub(crate) mod start;
pub(crate) mod tuning;
pub(crate) mod unit;
