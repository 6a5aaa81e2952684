//! Samplers that others published, and tables: what draws from our lobes are compared with.
//!
//! Each is fitted to a [`Reflection`]. For an outgoing direction it becomes a proposal, which draws incident directions and has a density.
//!
//! | module | draws by |
//! |---|---|
//! | [`analytic`] | the lobe of Phong, Ward or GGX, and a cosine |
//! | [`lafortune`] | Lafortune's generalised cosine lobes |
//! | [`half_angles`], [`tabulated`], [`factored`] | a table over the half vector, whole or factored |
//! | [`rgl`] | the warps of a `.bsdf` file |
//! | [`thesis`] | round lobes blended by equation 9 of the thesis |
//! | [`plain`], [`ggx`], [`ggx_parts`], [`probe`] | directions and densities that the others are fitted by |

pub mod analytic;
pub mod factored;
pub mod ggx;
pub mod ggx_parts;
pub mod half_angles;
pub mod lafortune;
pub mod plain;
pub mod probe;
pub mod rgl;
pub mod tabulated;
pub mod thesis;
pub mod views;

use glam::DVec3;
use srbf_fit::table::{Brdf, Symmetry};

/// A reflection that samplers are fitted to: lobes, a table or a model.
pub trait Reflection: Brdf {
    /// `f cos` of a pair of directions above the horizon, incident and outgoing; linear sRGB, 1/sr.
    fn f_cos(&self, wi: DVec3, wo: DVec3) -> DVec3;

    /// Whether the azimuth of the outgoing direction does not matter.
    fn is_isotropic(&self) -> bool {
        self.symmetry() == Symmetry::Isotropic
    }
}
