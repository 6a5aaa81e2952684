//! The numbers of a mixture, and what can be read off them.

use super::factors::Factors;
use crate::lobe::gaussian::{Gaussian, Lobe};
use crate::material::layout::MAX_LOBES;
use crate::simd::detect::Level;
use crate::squeeze::Squeeze;
use glam::Vec3;

/// Where a mixture lives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Domain {
    /// The whole sphere: no fold.
    Sphere,
    /// The upper hemisphere, z >= 0: what a lobe has below the horizon is mirrored back up; 0 below.
    #[default]
    Hemisphere,
}

/// A direction drawn from a mixture, with everything that a renderer asks next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Incident direction, unit vector in the caller's shading frame.
    pub direction: Vec3,
    /// Density of the whole mixture at the direction; 1/sr. Far out in a tail f32 may round it to 0.
    pub pdf: f32,
    /// `f cos / pdf`, linear sRGB: its luminance is that of the mixture's albedo at every sample, times that
    /// of a factor if the material has factors. 0 where the density is below the least normal number.
    pub weight: Vec3,
}

/// Least density that is divided by, the least normal number: below, values have lost their digits, and an
/// inverse may be infinite. Only a tail far out is so faint.
pub(crate) const LEAST_DENSITY: f32 = f32::MIN_POSITIVE;

/// A value over its density; 0 where that cannot be divided by.
#[inline(always)]
pub(crate) fn weight_of(value: Vec3, pdf: f32) -> Vec3 {
    if pdf >= LEAST_DENSITY { value / pdf } else { Vec3::ZERO }
}

/// A sum of lobes, and a diffuse term, for one outgoing direction; storage for `N` lobes, without allocation.
///
/// One that a material with factors has made reads them from the bytes of the material, which live for `'m`;
/// any other lives for as long as it may. `N` is any number from 1 to 64; multiples of 16
/// are the fastest. The first lobes see the squeezed
/// direction, the others the direction itself. The diffuse term is `albedo cos / pi` on the hemisphere: lobes
/// cannot make the cosine of a diffuse surface, and it keeps `f cos / pdf` bounded where the lobes end.
///
/// # Which lobes are folded
/// A folded lobe is `a (G(d) + G(d mirrored in z = 0))`, whose integral over the hemisphere is that of the
/// lobe over the sphere. A folded lobe does not change if its axis is mirrored, so axes are kept above the
/// horizon. The second term is left out, once per lobe, where the share of the lobe below the horizon is at
/// most 1e-7: below the horizon `cos <= t = sqrt(1 - axis.z^2)`, and a Gaussian has the share `(exp(-s (1 -
/// t)) - exp(-2 s)) / (1 - exp(-2 s)) <= exp(-s (1 - t))` of its integral at `cos <= t`. What is left out is
/// at most `1e-7 a` at any direction.
#[derive(Clone, Debug)]
pub struct Mixture<'m, const N: usize> {
    pub(crate) count: usize,
    pub(crate) squeezed: usize,
    pub(crate) domain: Domain,
    /// Every axis has y = 0 in the frame of the view.
    pub(crate) in_plane: bool,
    /// What this mixture's kernels run on, chosen when it was made.
    pub(crate) level: Level,
    pub(crate) squeeze: Squeeze,
    /// Bit k: lobe k needs its fold.
    pub(crate) folded: u64,
    /// Albedo of the diffuse term; 0 on the sphere.
    pub(crate) diffuse: Vec3,
    /// Albedo of the lobes.
    pub(crate) lobes_albedo: Vec3,
    /// Luminance of the albedo, the normaliser of the density; 0 if nothing can be sampled.
    pub(crate) power: f32,
    /// `1 / power`, or 0.
    pub(crate) inverse_power: f32,
    /// The part of `power` that lobes have.
    pub(crate) lobes_power: f32,
    /// The part that the diffuse term has: the difference of the two above would have lost its digits.
    pub(crate) diffuse_power: f32,
    /// What values are multiplied by.
    pub(crate) factors: Factors<'m>,
    // Structure of arrays; places from `count` up to the next multiple of what one direction
    // takes at a time (two vectors on AVX2, one elsewhere) hold lobes of amplitude 0.
    pub(crate) axis_x: [f32; N],
    pub(crate) axis_y: [f32; N],
    pub(crate) axis_z: [f32; N],
    pub(crate) sharpness: [f32; N],
    pub(crate) red: [f32; N],
    pub(crate) green: [f32; N],
    pub(crate) blue: [f32; N],
    /// Luminance of the amplitude.
    pub(crate) luminance: [f32; N],
    /// `-s / 2` in base 2: times the squared chord it is the exponent.
    pub(crate) rate: [f32; N],
    /// `-2 s axis.z` in base 2: times d.z it is what the fold adds to the exponent. Minus infinity, or a NaN
    /// times 0, which both leave nothing of it, for a lobe that does not need its fold but shares a vector
    /// with one that does.
    pub(crate) fold_rate: [f32; N],
    /// `1 / s`, of at least 1e-7: below, the lobe is constant to f32.
    pub(crate) inverse_sharpness: [f32; N],
    /// `1 - exp(-2 s)`.
    pub(crate) inside: [f32; N],
    /// `exp(-2 s)`.
    pub(crate) tail: [f32; N],
    /// Running sum of the luminance of the integrals.
    pub(crate) cumulative: [f32; N],
}

/// A number whose lowest `count` bits are set, up to 64.
#[inline(always)]
pub(crate) const fn lowest_bits(count: usize) -> u64 {
    if count == 0 { 0 } else { u64::MAX >> (64 - count) }
}

impl<const N: usize> Default for Mixture<'_, N> {
    fn default() -> Self {
        Self::empty()
    }
}

impl<const N: usize> Mixture<'_, N> {
    /// The mixture without lobes: value, albedo and density are 0, and no sample can be drawn.
    ///
    /// Every mixture begins as one, so that room for more than 64 lobes does not compile:
    ///
    /// ```compile_fail,E0080
    /// let mixture = srbf_core::Mixture::<65>::empty();
    /// ```
    pub const fn empty() -> Self {
        const { assert!(1 <= N && N <= MAX_LOBES, "the N of a Mixture<N>, its room for lobes, is 1 to 64") };
        let zeros = [0.0; N];
        Self {
            count: 0,
            squeezed: 0,
            domain: Domain::Hemisphere,
            in_plane: true,
            level: Level::Scalar,
            squeeze: Squeeze::NONE,
            folded: 0,
            diffuse: Vec3::ZERO,
            lobes_albedo: Vec3::ZERO,
            power: 0.0,
            inverse_power: 0.0,
            lobes_power: 0.0,
            diffuse_power: 0.0,
            factors: Factors::NONE,
            axis_x: zeros,
            axis_y: zeros,
            axis_z: zeros,
            sharpness: zeros,
            red: zeros,
            green: zeros,
            blue: zeros,
            luminance: zeros,
            rate: zeros,
            fold_rate: zeros,
            inverse_sharpness: zeros,
            inside: zeros,
            tail: zeros,
            cumulative: zeros,
        }
    }

    /// Starts over as an empty mixture, keeping the storage.
    #[inline(always)]
    pub(crate) fn begin(&mut self, level: Level, domain: Domain, squeeze: Squeeze) {
        self.count = 0;
        self.squeezed = 0;
        self.domain = domain;
        self.in_plane = true;
        self.level = level;
        self.squeeze = squeeze;
        self.folded = 0;
        self.diffuse = Vec3::ZERO;
        self.lobes_albedo = Vec3::ZERO;
        self.power = 0.0;
        self.inverse_power = 0.0;
        self.lobes_power = 0.0;
        self.diffuse_power = 0.0;
        self.factors.nodes = &[];
    }

    /// Albedo of the diffuse term, linear sRGB.
    #[inline]
    pub fn diffuse(&self) -> Vec3 {
        self.diffuse
    }

    /// Number of lobes.
    #[inline]
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there is no lobe.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Number of lobes that see the squeezed direction; they come first.
    #[inline]
    pub fn squeezed_len(&self) -> usize {
        self.squeezed
    }

    /// The squeeze c, across +x of the frame of the view; 1 for none.
    #[inline]
    pub fn squeeze(&self) -> f32 {
        1.0 / self.squeeze.inverse
    }

    /// The squeeze along +x of the frame of the view; 1 but for anisotropic materials.
    #[inline]
    pub fn squeeze_along(&self) -> f32 {
        1.0 / self.squeeze.along
    }

    /// Azimuth of +x of the frame of the view in the caller's frame, its cosine and sine.
    ///
    /// Away from the outgoing direction for an isotropic material; for an anisotropic one turned by up to 45
    /// degrees from there, so that it and +y are what the squeeze acts along.
    #[inline]
    pub fn azimuth_cos_sin(&self) -> [f32; 2] {
        self.squeeze.azimuth
    }

    /// Where the mixture lives.
    #[inline]
    pub fn domain(&self) -> Domain {
        self.domain
    }

    /// The instruction set that this mixture's kernels run on, chosen when it was made; see [`Level::set`].
    #[inline]
    pub fn level(&self) -> Level {
        self.level
    }

    /// Whether lobe `k` is evaluated with its fold.
    #[inline]
    pub fn is_folded(&self, k: usize) -> bool {
        k < self.count && self.folded >> k & 1 == 1
    }

    /// Lobe `k` in the frame of the view, or `None` past the end.
    pub fn lobe(&self, k: usize) -> Option<Lobe> {
        let amplitude = || Vec3::new(self.red[k], self.green[k], self.blue[k]);
        (k < self.count).then(|| Lobe { gaussian: self.gaussian(k), amplitude: amplitude() })
    }

    pub(crate) fn gaussian(&self, k: usize) -> Gaussian {
        let axis = Vec3::new(self.axis_x[k], self.axis_y[k], self.axis_z[k]);
        Gaussian { axis, sharpness: self.sharpness[k] }
    }

    /// Integral of the value over the domain, in closed form: `diffuse + sum a I(s)`; linear sRGB.
    ///
    /// For a material, the directional albedo towards the outgoing direction. With factors there is no closed
    /// form: a material stores for its views what they change of it, relative to [`power`](Self::power), and
    /// that is interpolated linearly between them. A fit's is 0.04 to 0.5 % of the luminance off in the mean
    /// over outgoing directions, and at most 1.5 %.
    #[inline]
    pub fn albedo(&self) -> Vec3 {
        let lobes = self.lobes_albedo + self.diffuse;
        if self.has_factors() { lobes + self.power * self.factors.albedo_difference() } else { lobes }
    }

    /// Luminance of the closed form of the albedo, without factors: what the density is normalised by, and
    /// without factors the luminance of every sample's weight.
    #[inline]
    pub fn power(&self) -> f32 {
        self.power
    }

    /// Whether lobes see directions as they are, neither turned nor squeezed.
    #[inline(always)]
    pub(crate) fn is_plain(&self) -> bool {
        self.squeezed == 0 && !self.squeeze.is_turned
    }

    /// Whether there is neither a lobe nor a diffuse term: what is prepared for no direction.
    #[inline(always)]
    pub(crate) fn is_nothing(&self) -> bool {
        self.count == 0 && self.diffuse == Vec3::ZERO
    }
}

impl<'m, const N: usize> Mixture<'m, N> {
    /// Bytes of the material that the mixture reads when it is evaluated: its table of factors, empty for
    /// none.
    #[inline]
    pub fn factor_bytes(&self) -> &'m [u8] {
        self.factors.nodes
    }

    /// Whether values are multiplied by factors; see [`Material::factor`](crate::Material::factor).
    #[inline]
    pub fn has_factors(&self) -> bool {
        !self.factors.is_none()
    }
}
