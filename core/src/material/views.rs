//! The numbers of a material at its views, as input of its writer: along one angle ([`Line`]), or over the
//! hemisphere ([`Grid`]).

use super::factor_table::FactorTable;

/// One lobe of an isotropic material at one view, as it is stored: its axis is in the plane of incidence. A mirrored lobe has an
/// axis off the plane, and stands for a second one on the other side.
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
///
/// A material of one's own, without a fit: a highlight that follows the mirror direction over a dark red.
///
/// ```
/// use srbf_core::{Line, Material, Mixture, PlaneLobe, View, color_differences};
///
/// let thetas = [0.0f32, 0.5, 1.0, 1.5];
/// let lobes = thetas.map(|angle| {
///     let (log2_luminance, color_differences) = color_differences([1.0f32; 3].map(f32::log2));
///     [PlaneLobe { angle, off_plane: 0.0, log2_sharpness: 5.0, log2_luminance, color_differences }]
/// });
/// let (log2_diffuse, diffuse_color_differences) = color_differences([0.2f32, 0.05, 0.05].map(f32::log2));
/// let views: Vec<View> = thetas
///     .iter()
///     .zip(&lobes)
///     .map(|(&theta, lobes)| View { theta, log2_squeeze: 0.0, log2_diffuse, diffuse_color_differences, lobes })
///     .collect();
/// let line = Line { views: &views, squeezed: 0, mirrored: 0, factors: None };
/// let mut bytes = vec![0; line.encoded_len("made by hand")];
/// line.encode("made by hand", &mut bytes)?;
///
/// let material = Material::from_bytes(bytes)?;
/// let mut mixture = Mixture::<16>::empty();
/// material.prepare([-0.6, 0.0, 0.8], &mut mixture)?;
/// let value = mixture.evaluate([0.6, 0.0, 0.8]);
/// assert!((value.x - (1.0 + 0.2 / std::f32::consts::PI * 0.8)).abs() < 0.01, "{value}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
///
/// A brushed surface: the normal and one ring of four views, each with a highlight that is twice as wide one way.
///
/// ```
/// use srbf_core::{Grid, GridView, Material, Mixture, TiltedLobe};
///
/// let lobes = |angle: f32| {
///     [TiltedLobe { tilt: [angle, 0.0], log2_sharpness: 6.0, log2_luminance: 0.0, color_differences: [0.0; 2] }]
/// };
/// let [up, aside] = [lobes(0.0), lobes(1.0)];
/// // Along x of the surface, which for a view at an azimuth of 90 degrees lies across its plane of incidence.
/// let view = |lobes, log2_squeeze| GridView {
///     log2_squeeze,
///     log2_diffuse: -3.0,
///     diffuse_color_differences: [0.0; 2],
///     lobes,
/// };
/// let (along, across) = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
/// let views = [view(&up, along), view(&aside, along), view(&aside, across), view(&aside, along), view(&aside, across)];
/// let grid = Grid { thetas: &[0.0, 1.0], azimuths: 4, turns: 1, axis: 0.0, views: &views, squeezed: 1, factors: None };
/// let mut bytes = vec![0; grid.encoded_len("brushed")];
/// grid.encode("brushed", &mut bytes)?;
///
/// let material = Material::from_bytes(bytes)?;
/// let mut mixture = Mixture::<16>::empty();
/// material.prepare([0.0, 0.0, 1.0], &mut mixture)?;
/// let [along, across] = [[0.3f32, 0.0, 0.954], [0.0, 0.3, 0.954]].map(|wi| mixture.evaluate(wi).x);
/// assert!(!material.is_isotropic() && along != across);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Grid<'a> {
    /// Angles of the rings from the normal, radians; the first is 0, the normal itself.
    pub thetas: &'a [f32],
    /// Views of a ring, at the azimuths `axis + 2 pi j / (turns azimuths)` of the outgoing direction; with mirrors at
    /// `axis + 2 pi j / (4 (azimuths - 1))`, at least 2.
    pub azimuths: usize,
    /// How often a ring is repeated over the full turn, 1 or 2; or 4, where mirrors along the axis and across it leave the surface as it
    /// is. Then the views of a ring stand over a quarter of the turn. The first and the last of them lie in the planes of the mirrors. There
    /// lobes are their own mirror images, or those of each other.
    pub turns: usize,
    /// Azimuth from which those of the views count, radians, in [0, pi): a multiple of pi / 65536, to which it is rounded.
    pub axis: f32,
    /// The normal, then ring by ring.
    pub views: &'a [GridView<'a>],
    /// Number of lobes that see the squeezed direction; they come first.
    pub squeezed: usize,
    /// What values are multiplied by, if anything.
    pub factors: Option<FactorTable<'a>>,
}
