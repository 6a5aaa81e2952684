//! Samplers that others published, and tables: what our lobes are compared with.
//!
//! | file | draws by |
//! |---|---|
//! | `analytic` | the lobe of Phong, Ward or GGX, and a cosine |
//! | `lafortune` | Lafortune's generalised cosine lobes |
//! | `half_angles`, `tabulated`, `factored` | a table over the half vector, whole or factored |
//! | `rgl` | the warps of a `.bsdf` file |
//! | `thesis` | round lobes blended by equation 9 of the thesis |

pub mod analytic;
pub mod factored;
pub mod half_angles;
pub mod lafortune;
pub mod rgl;
pub mod tabulated;
pub mod thesis;
pub mod views;
