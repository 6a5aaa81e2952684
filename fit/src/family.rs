//! One family of lobes over all views: its unknowns, the lobes of a view, and the sum of squares that a fit makes small.

pub(crate) mod factors;
pub(crate) mod layout;
pub(crate) mod lobes;
pub(crate) mod objective;
