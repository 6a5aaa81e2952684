//! Other ways of fitting and of sampling, which ours are compared with.
//!
//! | module | its model |
//! |---|---|
//! | [`thesis`] | round lobes of f, view by view, as S.-C. Weng's thesis does |
//! | [`blend`] | the mixtures of the nearest views cross-faded, as the thesis does |
//! | [`lafortune`] | generalised cosine lobes, fitted or published |
//! | [`microfacets`] | two GGX lobes and a diffuse term |
//! | [`samplers`] | samplers that others published, fitted to a reflection |
//! | [`evaluated`] | samples without lobes: triangles between them, their completion |

pub mod blend;
pub mod evaluated;
pub mod lafortune;
mod lbfgsb;
pub mod microfacets;
pub mod samplers;
pub mod thesis;
