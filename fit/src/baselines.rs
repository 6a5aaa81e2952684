//! Other ways of fitting, to compare with: the thesis's, Lafortune's lobes, two GGX lobes, the thesis's blend of views, and samples without lobes.

pub mod blend;
pub mod evaluated;
pub mod lafortune;
pub mod microfacets;
pub mod thesis;
