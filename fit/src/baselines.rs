//! Other ways of fitting, to compare with: the thesis's, Lafortune's lobes, and the thesis's blend of views.

pub mod blend;
pub mod lafortune;
pub mod thesis;
