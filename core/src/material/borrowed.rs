//! A material in its bytes, owned or borrowed: lobes at view knots, read in place.

use super::factor_table::{decoded, node_at};
use super::format_error::FormatError;
use super::layout::{AXIS_UNIT, Header, Kind, f32_at};
use super::validate::validate;
use super::views::{PlaneLobe, TiltedLobe};
use crate::color::color_differences;
use core::f32::consts::PI;

/// A material in `.srbf` bytes of any alignment, which are checked once: nothing is copied, nothing allocated.
///
/// It borrows the bytes (`B` = `&[u8]`) or owns them: a `Vec<u8>`, an `Arc<[u8]>`, an array, a mapped file.
///
/// Lobe `k` of one view corresponds to lobe `k` of the next; between views its numbers are interpolated linearly in the angle of
/// the outgoing direction. These are the angle of the axis, the logarithms of sharpness, luminance and squeeze, and the colour
/// differences (in files of version 1 the logarithms of red, green and blue). Beyond the last view the last one holds. The views
/// of an anisotropic material lie over the hemisphere, see [`Grid`](crate::Grid).
#[derive(Clone, Copy, Debug)]
pub struct Material<B = &'static [u8]> {
    bytes: B,
    header: Header,
}

/// What kernels read of a material, whoever owns its bytes.
#[derive(Clone, Copy)]
pub(crate) struct MaterialRef<'a> {
    pub bytes: &'a [u8],
    pub header: &'a Header,
}

impl<B: AsRef<[u8]>> Material<B> {
    /// Makes a material of `.srbf` bytes, after checking every field once.
    ///
    /// # Errors
    /// [`FormatError`], with the place.
    pub fn from_bytes(bytes: B) -> Result<Self, FormatError> {
        let header = validate(bytes.as_ref())?;
        Ok(Self { bytes, header })
    }

    /// The bytes it was made from.
    #[inline]
    pub fn bytes(&self) -> &[u8] {
        self.bytes.as_ref()
    }

    pub(super) fn header(&self) -> &Header {
        &self.header
    }

    /// What kernels read.
    #[inline(always)]
    pub(crate) fn borrowed(&self) -> MaterialRef<'_> {
        MaterialRef { bytes: self.bytes.as_ref(), header: &self.header }
    }

    /// Number of views.
    pub fn view_count(&self) -> usize {
        self.header.views
    }

    /// Number of lobes of a mixture that it makes, which the storage must have room for.
    pub fn lobe_count(&self) -> usize {
        self.header.lobe_count()
    }

    /// Number of lobes that are stored at every view: fewer than [`lobe_count`](Self::lobe_count) if some
    /// stand for two.
    pub fn view_lobe_count(&self) -> usize {
        self.header.lobes
    }

    /// Number of lobes that see the squeezed direction; they come first.
    pub fn squeezed_count(&self) -> usize {
        self.header.squeezed
    }

    /// Number of lobes that stand for two, one on either side of the plane of incidence; they come last. 0 in
    /// an anisotropic material.
    pub fn mirrored_count(&self) -> usize {
        self.header.mirrored
    }

    /// Where the material comes from, as its maker wrote it.
    pub fn provenance(&self) -> &str {
        let start = self.header.text;
        core::str::from_utf8(&self.bytes()[start..start + self.header.provenance as usize])
            .unwrap_or_default()
    }

    /// Whether the mixture depends only on the angle of the outgoing direction from the normal, but for a
    /// turn.
    pub fn is_isotropic(&self) -> bool {
        self.header.is_isotropic()
    }

    /// Angle of the outgoing direction of a view from the normal, radians; `None` past the end.
    pub fn view_theta(&self, view: usize) -> Option<f32> {
        let index = match self.header.kind {
            Kind::Grid(shape) if view > 0 => 1 + (view - 1) / shape.azimuths,
            _ => view,
        };
        (view < self.header.views).then(|| self.header.angle(self.bytes(), index))
    }

    /// Azimuth of the outgoing direction of a view, radians; 0 in an isotropic material; `None` past the end.
    pub fn view_azimuth(&self, view: usize) -> Option<f32> {
        let azimuth = match self.header.kind {
            Kind::Grid(shape) if view > 0 => {
                let step = 2.0 * PI / shape.steps() as f32;
                f32::from(shape.axis) * AXIS_UNIT + ((view - 1) % shape.azimuths) as f32 * step
            }
            _ => 0.0,
        };
        (view < self.header.views).then_some(azimuth)
    }

    /// How often a ring of views is repeated over the full turn, and the azimuth from which views count, radians, as in
    /// [`Grid`](crate::Grid); `None` of an isotropic material.
    pub fn grid_turns(&self) -> Option<(usize, f32)> {
        let Kind::Grid(shape) = self.header.kind else { return None };
        Some((shape.turns.into(), f32::from(shape.axis) * AXIS_UNIT))
    }

    /// Base-2 logarithm of the squeeze of a view; `None` past the end, and in an anisotropic material.
    pub fn view_log2_squeeze(&self, view: usize) -> Option<f32> {
        let is_there = self.is_isotropic() && view < self.header.views;
        is_there.then(|| self.header.head_number(self.bytes(), view, 0))
    }

    /// Base-2 logarithm of the squeeze matrix of a view, xx, xy, yy; `None` past the end, and in an isotropic
    /// material.
    pub fn view_log2_squeeze_matrix(&self, view: usize) -> Option<[f32; 3]> {
        let Kind::Grid(shape) = self.header.kind else { return None };
        let number = |i| self.header.grid_head(shape, self.bytes(), view, i).0;
        (view < self.header.views).then(|| [0, 1, 2].map(number))
    }

    /// Base-2 logarithm of the luminance of the albedo of the diffuse term of a view, -126 for none; `None`
    /// past the end.
    pub fn view_log2_diffuse(&self, view: usize) -> Option<f32> {
        self.view_diffuse(view).map(|(log2, _)| log2)
    }

    /// Relative colour differences of the albedo of the diffuse term of a view, `(R - Y) / Y` and `(B - Y) /
    /// Y`; `None` past the end.
    pub fn view_diffuse_color_differences(&self, view: usize) -> Option<[f32; 2]> {
        self.view_diffuse(view).map(|(_, differences)| differences)
    }

    fn view_diffuse(&self, view: usize) -> Option<(f32, [f32; 2])> {
        let number = |i: usize| match self.header.kind {
            Kind::Line => self.header.head_number(self.bytes(), view, 1 + i),
            Kind::Grid(shape) => self.header.grid_head(shape, self.bytes(), view, 3 + i).0,
        };
        (view < self.header.views).then(|| self.color([0, 1, 2].map(number)))
    }

    /// Logarithm of the luminance and colour differences, of the three numbers that are stored.
    fn color(&self, stored: [f32; 3]) -> (f32, [f32; 2]) {
        if self.header.has_luminance {
            (stored[0], [stored[1], stored[2]])
        } else {
            color_differences(stored)
        }
    }

    /// A lobe as it is stored at a view, its colour as luminance and differences whatever the version of the
    /// bytes; `None` past either end, and in an anisotropic material.
    pub fn view_lobe(&self, view: usize, lobe: usize) -> Option<PlaneLobe> {
        if !self.is_isotropic() || view >= self.header.views || lobe >= self.header.lobes {
            return None;
        }
        let number = |row| self.header.number(self.bytes(), view, row, lobe);
        let (log2_luminance, color_differences) = self.color([2, 3, 4].map(number));
        let off_plane = lobe.checked_sub(self.header.lobes - self.header.mirrored);
        Some(PlaneLobe {
            angle: number(0),
            off_plane: off_plane.map_or(0.0, |m| self.header.number(self.bytes(), view, 5, m)),
            log2_sharpness: number(1),
            log2_luminance,
            color_differences,
        })
    }

    /// A lobe as it is stored at a view, as [`view_lobe`](Self::view_lobe); `None` past either end, and in an
    /// isotropic material.
    pub fn view_tilted_lobe(&self, view: usize, lobe: usize) -> Option<TiltedLobe> {
        let Kind::Grid(shape) = self.header.kind else { return None };
        if view >= self.header.views || lobe >= self.header.lobes {
            return None;
        }
        let number = |row| self.header.grid_number(shape, self.bytes(), view, row, lobe).0;
        let (log2_luminance, color_differences) = self.color([3, 4, 5].map(number));
        let tilt = [number(0), number(1)];
        Some(TiltedLobe { tilt, log2_sharpness: number(2), log2_luminance, color_differences })
    }
}

impl<B: AsRef<[u8]>> Material<B> {
    /// Nodes of the table of factors along half angle, difference angle and azimuth; `None` without one.
    pub fn factor_nodes(&self) -> Option<[usize; 3]> {
        self.header.has_factors().then(|| self.header.factors.map(usize::from))
    }

    /// Whether factors depend on which of the two directions is the higher one: whether the table's nodes along the azimuth know its sign.
    pub fn has_signed_factors(&self) -> bool {
        self.header.has_signed_factors
    }

    /// What no factor exceeds but for rounding: the largest of any node and channel; 1 without a table.
    ///
    /// The luminance of a sample's weight is at most the power of its mixture times this, where no channel of
    /// a lobe is negative.
    pub fn largest_factor(&self) -> f32 {
        if self.factor_nodes().is_none() { 1.0 } else { f32_at(self.bytes(), self.header.nodes() - 4) }
    }

    /// Bytes of the table of factors with what stands beside it; 0 without one.
    pub fn factor_len(&self) -> usize {
        if self.factor_nodes().is_none() { 0 } else { self.header.nodes_end() - self.header.table }
    }

    /// The factor of a node, linear sRGB; `None` past any end, and without a table.
    pub fn factor_node(&self, half: usize, difference: usize, azimuth: usize) -> Option<[f32; 3]> {
        let [halves, differences, azimuths] = self.factor_nodes()?;
        if half >= halves || difference >= differences || azimuth >= azimuths {
            return None;
        }
        let place = (azimuth * halves + half) * differences + difference;
        let header = &self.header;
        let node = node_at(self.bytes(), header, header.nodes() + header.node_len() * place);
        Some([0, 1, 2].map(|channel| decoded(node, channel, header.bits, self.largest_factor())))
    }

    /// The change of the albedo of a view by the factors, relative to the luminance of the lobes' own, linear sRGB, as
    /// it is stored; `None` past the end, and without a table. [`AnyMixture::albedo`](crate::AnyMixture::albedo) has it in it.
    pub fn view_albedo_difference(&self, view: usize) -> Option<[f32; 3]> {
        let number = |i: usize| f32_at(self.bytes(), self.header.albedo_difference(view) + 4 * i);
        (self.factor_nodes().is_some() && view < self.header.views).then(|| [0, 1, 2].map(number))
    }
}

impl<'a> MaterialRef<'a> {
    /// Itself as a material.
    pub fn to_material(self) -> Material<&'a [u8]> {
        Material { bytes: self.bytes, header: *self.header }
    }
}
