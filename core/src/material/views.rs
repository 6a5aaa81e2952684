//! What a material stores at its views, as it is given to a writer: along one angle ([`Line`]), or over the
//! hemisphere ([`Grid`]).

use super::factor_table::FactorTable;

/// One lobe of an isotropic material at one view, as it is stored: its axis in the plane of incidence, or, if
/// it is a mirrored one, off it and standing for a second one on the other side.
///
/// The axis is `(sin angle cos off_plane, sin off_plane, cos angle cos off_plane)` in the frame of the view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneLobe {
    /// Angle of the axis from the normal, within the plane of incidence, radians, positive towards the mirror
    /// direction; [-pi, pi].
    pub angle: f32,
    /// Angle of the axis out of the plane of incidence, radians; [-pi/2, pi/2] for a mirrored lobe, 0 for any
    /// other.
    pub off_plane: f32,
    /// Base-2 logarithm of the sharpness; [-100, 26.5].
    pub log2_sharpness: f32,
    /// Base-2 logarithm of the luminance Y of the amplitude; [-126, 60], -126 for none.
    pub log2_luminance: f32,
    /// Relative colour differences of the amplitude, `(R - Y) / Y` and `(B - Y) / Y`; [-16, 16].
    pub color_differences: [f32; 2],
}

/// One view: the outgoing direction at which a material stores a mixture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View<'a> {
    /// Angle of the outgoing direction from the normal, radians.
    pub theta: f32,
    /// Base-2 logarithm of the squeeze; [-6.64, 1].
    pub log2_squeeze: f32,
    /// Base-2 logarithm of the luminance Y of the albedo of the diffuse term; [-126, 2], -126 for none.
    pub log2_diffuse: f32,
    /// Relative colour differences of that albedo, `(R - Y) / Y` and `(B - Y) / Y`; [-16, 16].
    pub diffuse_color_differences: [f32; 2],
    /// The lobes, squeezed ones first, mirrored ones last; the same number, in the same order, at every view.
    pub lobes: &'a [PlaneLobe],
}

/// The views of an isotropic material.
#[derive(Clone, Copy, Debug)]
pub struct Line<'a> {
    /// By their angle, the normal first.
    pub views: &'a [View<'a>],
    /// Number of lobes that see the squeezed direction; they come first.
    pub squeezed: usize,
    /// Number of lobes that stand for two, one on either side of the plane of incidence; they come last.
    pub mirrored: usize,
    /// What values are multiplied by, if anything.
    pub factors: Option<FactorTable<'a>>,
}

/// One lobe at one view of an anisotropic material, as it is stored: its axis anywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TiltedLobe {
    /// The axis: its angle from the normal, radians, as a vector: first along the plane of incidence,
    /// positive towards the mirror direction, then across it. At the normal, along x and y of the surface. Of
    /// length at most pi.
    pub tilt: [f32; 2],
    /// Base-2 logarithm of the sharpness; [-100, 26.5].
    pub log2_sharpness: f32,
    /// Base-2 logarithm of the luminance Y of the amplitude; [-126, 60], -126 for none.
    pub log2_luminance: f32,
    /// Relative colour differences of the amplitude, `(R - Y) / Y` and `(B - Y) / Y`; [-16, 16].
    pub color_differences: [f32; 2],
}

/// One view of an anisotropic material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridView<'a> {
    /// Base-2 logarithm of the squeeze matrix, a symmetric 2 x 2 one: xx, xy, yy; x along the plane of
    /// incidence, at the normal along x of the surface. Eigenvalues in [-5, 6.64]. `(0, 0, -log2 c)` is the
    /// squeeze c of an isotropic material.
    pub log2_squeeze: [f32; 3],
    /// Base-2 logarithm of the luminance Y of the albedo of the diffuse term; [-126, 2], -126 for none.
    pub log2_diffuse: f32,
    /// Relative colour differences of that albedo, `(R - Y) / Y` and `(B - Y) / Y`; [-16, 16].
    pub diffuse_color_differences: [f32; 2],
    /// The lobes, squeezed ones first; the same number, in the same order, at every view.
    pub lobes: &'a [TiltedLobe],
}

/// The views of an anisotropic material.
#[derive(Clone, Copy, Debug)]
pub struct Grid<'a> {
    /// Angles of the rings from the normal, radians; the first is 0, the normal itself.
    pub thetas: &'a [f32],
    /// Views of a ring, at the azimuths `2 pi j / (turns azimuths)` of the outgoing direction.
    pub azimuths: usize,
    /// How often a ring is repeated over the full turn, 1 or 2.
    pub turns: usize,
    /// The normal, then ring by ring.
    pub views: &'a [GridView<'a>],
    /// Number of lobes that see the squeezed direction; they come first.
    pub squeezed: usize,
    /// What values are multiplied by, if anything.
    pub factors: Option<FactorTable<'a>>,
}
