//! The shading frame of a surface, on the side from where it is seen; that of a sheet is in front.

use crate::shade::shader::Scattering;
use crate::trace::scene::Surface;
use crate::world::ray::Ray;
use glam::Vec3;

/// Smallest cosine that an outgoing direction has with the shading normal: the normal is bent until it has it.
const LEAST_COSINE: f32 = 1e-3;

/// Distance by which rays start above a surface, relative to the size of the coordinates.
const RAY_OFFSET: f32 = 1e-4;

/// Makes the frame of a surface and gets its material ready; `None` is impossible, as the storage holds every material, and the outgoing
/// direction is a unit vector. A NaN is found in the picture.
pub fn look<'a>(surface: &Surface<'_, 'a>, ray: &Ray, scattering: &mut Scattering<'a>) -> Option<Frame> {
    let wo = -ray.direction;
    let frame = Frame::new(surface, wo);
    surface.material.prepare(frame.to_local(wo), scattering).ok().map(|()| frame)
}

/// The shading frame at a point.
pub struct Frame {
    pub point: Vec3,
    pub flat: Vec3,
    pub tangent: Vec3,
    pub bitangent: Vec3,
    pub normal: Vec3,
    /// Whether light comes through.
    is_sheet: bool,
}

impl Frame {
    /// Makes the frame at a surface seen from a direction.
    ///
    /// The tangent is horizontal, as the grooves of an object are that was turned on a lathe about the vertical: along the parallels of
    /// the sphere and round the teapot's body. A sample that is turned has it turned along: by a quarter, grooves go along the meridians. It
    /// matters to anisotropic materials only.
    ///
    /// Its normal is on the side of the viewer. A sheet has two sides that are told apart: its normal is in front, and the viewer may be behind.
    pub fn new(surface: &Surface<'_, '_>, wo: Vec3) -> Self {
        let flat = if surface.flat.dot(wo) < 0.0 { -surface.flat } else { surface.flat };
        let mut normal = if surface.smooth.dot(flat) < 0.0 { -surface.smooth } else { surface.smooth };
        // Near the outline an interpolated normal may look away from the viewer, who would see black.
        let cosine = normal.dot(wo);
        if cosine < LEAST_COSINE {
            normal = (normal + wo * (LEAST_COSINE - cosine)).normalize();
        }
        let is_sheet = surface.material.is_sheet();
        let is_behind = is_sheet && surface.flat.dot(wo) < 0.0;
        let (flat, normal) = if is_behind { (-flat, -normal) } else { (flat, normal) };
        let (tangent, bitangent) = match Vec3::Z.cross(normal).try_normalize() {
            Some(along) if !surface.material.is_isotropic() => {
                let across = normal.cross(along);
                let [cos, sin] = surface.turn.to_array();
                (along * cos + across * sin, across * cos - along * sin)
            }
            _ => normal.any_orthonormal_pair(),
        };
        Self { point: surface.point, flat, tangent, bitangent, normal, is_sheet }
    }

    /// Into the shading frame.
    #[inline]
    pub fn to_local(&self, d: Vec3) -> Vec3 {
        Vec3::new(d.dot(self.tangent), d.dot(self.bitangent), d.dot(self.normal))
    }

    /// Out of the shading frame.
    #[inline]
    pub fn to_world(&self, d: Vec3) -> Vec3 {
        (self.tangent * d.x + self.bitangent * d.y + self.normal * d.z).normalize()
    }

    /// Whether a direction leaves the surface itself: one that does not would leak light through it. From a sheet, directions leave on either
    /// side, if it is that of the shading too.
    #[inline]
    pub fn leaves(&self, direction: Vec3) -> bool {
        let height = direction.dot(self.flat);
        if self.is_sheet { height * direction.dot(self.normal) > 0.0 } else { height > 0.0 }
    }

    /// A ray from just beside the surface, on the side that it goes to.
    #[inline]
    pub fn ray(&self, direction: Vec3) -> Ray {
        let offset = RAY_OFFSET * self.point.abs().max_element().max(1.0);
        let offset = offset.copysign(direction.dot(self.flat));
        Ray { origin: self.point + self.flat * offset, direction }
    }
}
