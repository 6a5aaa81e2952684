//! A material: lobes at view knots, read in place, and interpolated to any outgoing direction.

use crate::format::{self, Header, f32_at};
use crate::squeeze::Squeeze;
use crate::{Domain, Error, FormatError, Gaussian, Mixture, PlaneLobe, float};
use glam::Vec3;

/// A material in borrowed `.srbf` bytes of any alignment: nothing is copied, nothing allocated.
///
/// Lobe `k` of one view corresponds to lobe `k` of the next; between views the angle of the axis and the logarithms of
/// sharpness, amplitude and squeeze are interpolated linearly in the angle of the outgoing direction. Beyond the last
/// view the last one holds.
#[derive(Clone, Copy, Debug)]
pub struct Material<'a> {
    bytes: &'a [u8],
    header: Header,
}

impl<'a> Material<'a> {
    /// Borrows a material from `.srbf` bytes, after checking every field once.
    ///
    /// # Errors
    /// [`FormatError`], with the place.
    pub fn from_bytes(bytes: &'a [u8]) -> Result<Self, FormatError> {
        Ok(Self { bytes, header: format::validate(bytes)? })
    }

    /// The bytes it was made from.
    pub fn bytes(&self) -> &'a [u8] {
        self.bytes
    }

    /// Number of views.
    pub fn view_count(&self) -> usize {
        self.header.views
    }

    /// Number of lobes at every view.
    pub fn lobe_count(&self) -> usize {
        self.header.lobes
    }

    /// Number of lobes that see the squeezed direction; they come first.
    pub fn squeezed_count(&self) -> usize {
        self.header.squeezed
    }

    /// Where the material comes from, as its maker wrote it.
    pub fn provenance(&self) -> &'a str {
        let end = self.bytes.len() - 4;
        core::str::from_utf8(&self.bytes[end - self.header.provenance..end]).unwrap_or_default()
    }

    #[inline]
    fn number(&self, view: usize, index: usize) -> f32 {
        f32_at(self.bytes, format::HEADER + 4 * (view * self.header.stride() + index))
    }

    /// Angle of the outgoing direction of a view from the normal, radians; `None` past the end.
    pub fn view_theta(&self, view: usize) -> Option<f32> {
        (view < self.header.views).then(|| self.number(view, 0))
    }

    /// Base-2 logarithm of the squeeze of a view; `None` past the end.
    pub fn view_log2_squeeze(&self, view: usize) -> Option<f32> {
        (view < self.header.views).then(|| self.number(view, 1))
    }

    /// A lobe as it is stored at a view; `None` past either end.
    pub fn view_lobe(&self, view: usize, lobe: usize) -> Option<PlaneLobe> {
        let k = self.header.lobes;
        (view < self.header.views && lobe < k).then(|| PlaneLobe {
            angle: self.number(view, 2 + lobe),
            log2_sharpness: self.number(view, 2 + k + lobe),
            log2_amplitude: [2, 3, 4].map(|block| self.number(view, 2 + block * k + lobe)),
        })
    }

    /// Makes the mixture for an outgoing direction, in the caller's storage, which it overwrites.
    ///
    /// `wo` is a unit vector in the shading frame, +z the normal. Below the horizon (z < 0) nothing is reflected and
    /// the mixture is empty. The mixture takes and gives directions in the same shading frame.
    ///
    /// # Errors
    /// [`Error::Capacity`] if the storage has room for fewer lobes than the material has; [`Error::Direction`] if `wo`
    /// is not a finite unit vector. The mixture is empty then.
    pub fn prepare<const N: usize>(&self, wo: Vec3, mixture: &mut Mixture<N>) -> Result<(), Error> {
        mixture.begin(Domain::Hemisphere, Squeeze::NONE, 0);
        let k = self.header.lobes;
        if k > N {
            return Err(Error::Capacity { needed: k, available: N });
        }
        if !wo.is_finite() || (wo.length_squared() - 1.0).abs() > 2e-3 {
            return Err(Error::Direction);
        }
        if wo.z < 0.0 {
            return Ok(());
        }

        // +x of the view points away from wo, towards the mirror direction; at the normal any azimuth serves.
        let across = float::sqrt(wo.x * wo.x + wo.y * wo.y);
        let azimuth = if across > 0.0 { [-wo.x / across, -wo.y / across] } else { [1.0, 0.0] };

        // The two views round wo, and how far between them it lies.
        let theta = float::atan2(across, wo.z);
        let last = self.header.views - 1;
        let after = (1..last).find(|&v| theta < self.number(v, 0)).unwrap_or(last);
        let before = after.saturating_sub(1);
        let (from, to) = (self.number(before, 0), self.number(after, 0));
        let blend = if to > from { ((theta - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
        let at = |index| {
            let (a, b) = (self.number(before, index), self.number(after, index));
            a + blend * (b - a)
        };

        mixture.begin(
            Domain::Hemisphere,
            Squeeze { azimuth, inverse: float::exp2(-at(1)) },
            self.header.squeezed,
        );
        for lobe in 0..k {
            let (sin, cos) = float::sin_cos(at(2 + lobe));
            let sharpness = float::exp2(at(2 + k + lobe));
            let [red, green, blue] = [2, 3, 4].map(|block| float::exp2(at(2 + block * k + lobe)));
            mixture.push(Gaussian { axis: Vec3::new(sin, 0.0, cos), sharpness }, Vec3::new(red, green, blue));
        }
        mixture.finish();
        Ok(())
    }
}
