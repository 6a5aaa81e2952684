//! The numbers of a mixture, and the properties that can be read off them.

use super::factors::{Factors, Nodes};
use super::row::{self, EMPTY_GROUP, Group};
use crate::error::Error;
use crate::lobe::gaussian::{Gaussian, Lobe};
use crate::simd::detect::Level;
use crate::simd::lanes::{Lanes, PARTS, Parts, WIDEST};
use crate::squeeze::Squeeze;
use core::ops::{Deref, DerefMut};
use glam::Vec3;

/// Where a mixture lives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Domain {
    /// The whole sphere: no fold.
    Sphere,
    /// The upper hemisphere, z >= 0: the part of a lobe below the horizon is mirrored back up; 0 below.
    #[default]
    Hemisphere,
}

/// A direction drawn from a mixture, with everything that a renderer asks next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Incident direction, unit vector in the caller's shading frame.
    pub direction: Vec3,
    /// Density of the whole mixture at the direction; 1/sr. Above 0: what f32 rounds to less, far out in a
    /// tail, is told as the least normal number.
    pub pdf: f32,
    /// `f cos / pdf`, linear sRGB: its luminance is that of the mixture's albedo at every sample, times that
    /// of a factor if the material has factors. 0 where the density is below the least normal number.
    pub weight: Vec3,
}

/// Least density that is divided by, the least normal number: below, values have lost their digits, and an
/// inverse may be infinite. Only a tail far out is so faint.
pub(crate) const LEAST_DENSITY: f32 = f32::MIN_POSITIVE;

/// The density towards a direction, of the luminance of the value there. Not below 0, as a luminance may be where f32 rounds its
/// channels to subnormals, of which one may be negative.
#[inline(always)]
pub(crate) fn density_of(luminance: f32, inverse_power: f32) -> f32 {
    let pdf = luminance * inverse_power;
    if pdf > 0.0 { pdf } else { 0.0 }
}

/// The density that is told of a direction that was drawn, of the one that was worked out: at least
/// [`LEAST_DENSITY`], so that it can be divided by.
#[inline(always)]
pub(crate) fn drawn_density(pdf: f32) -> f32 {
    pdf.max(LEAST_DENSITY)
}

/// A value over its density; 0 where that cannot be divided by.
#[inline(always)]
pub(crate) fn weight_of(value: Vec3, pdf: f32) -> Vec3 {
    if pdf >= LEAST_DENSITY { value / pdf } else { Vec3::ZERO }
}

/// A sum of lobes, and a diffuse term, for one outgoing direction; storage for `N` lobes, without allocation.
///
/// `N` is 16, 32, 48 or 64. Every verb is one of [`AnyMixture`], which a mixture dereferences to.
/// One that a material with factors has made reads them from the bytes of the material, which live for `'m`;
/// any other lives for as long as it may.
///
/// The first lobes see the squeezed direction, the others the direction itself. The diffuse term is `albedo cos / pi` on the hemisphere: lobes
/// cannot make the cosine of a diffuse surface, and it keeps `f cos / pdf` bounded where the lobes end.
///
/// # Which lobes are folded
/// A folded lobe is `a (G(d) + G(d mirrored in z = 0))`, whose integral over the hemisphere is that of the
/// lobe over the sphere. A folded lobe does not change if its axis is mirrored, so axes are kept above the
/// horizon. The second term is left out, once per lobe, where the share of the lobe below the horizon is at
/// most 1e-7: below the horizon `cos <= t = sqrt(1 - axis.z^2)`, and a Gaussian has the share
/// `(exp(-s (1 - t)) - exp(-2 s)) / (1 - exp(-2 s)) <= exp(-s (1 - t))` of its integral at `cos <= t`. The part left out is at most `1e-7 a` at
/// any direction.
///
/// # Examples
/// ```
/// use srbf_core::{Lobe, Mixture};
///
/// let lobe = Lobe::new([0.0, 0.0, 1.0], 40.0, [0.5, 0.3, 0.1])?;
/// let mixture = Mixture::<16>::hemisphere(&[lobe])?.with_diffuse([0.2; 3])?;
/// let sample = mixture.sample([0.3, 0.6, 0.9]).expect("it reflects");
/// let value = mixture.evaluate(sample.direction);
/// assert!((sample.weight * sample.pdf - value).abs().max_element() < 1e-4);
/// assert!(mixture.albedo().max_element() < 1.0);
/// # Ok::<(), srbf_core::Error>(())
/// ```
/// Room for no other number of lobes compiles:
///
/// ```compile_fail,E0277
/// let mixture = srbf_core::Mixture::<65>::empty();
/// ```
#[derive(Clone, Debug)]
pub struct Mixture<'m, const N: usize>(pub(crate) AnyMixture<'m, <Room<N> as Groups>::Groups>)
where
    Room<N>: Groups;

/// A mixture with room for any number of lobes: a text that takes a reference to one takes a [`Mixture`] of any `N`.
///
/// `R`: the storage of its groups.
#[derive(Clone, Debug)]
pub struct AnyMixture<'m, R: ?Sized = [Group]> {
    pub(crate) head: Head<'m>,
    pub(crate) groups: R,
}

/// Room for `N` lobes.
#[derive(Debug)]
pub struct Room<const N: usize>;

/// A number of lobes that a [`Mixture`] can have room for.
#[diagnostic::on_unimplemented(message = "a mixture has room for 16, 32, 48 or 64 lobes")]
pub trait Groups {
    /// Its groups of sixteen lobes.
    type Groups: Clone + core::fmt::Debug;
    #[doc(hidden)]
    const EMPTY: Self::Groups;
    #[doc(hidden)]
    fn any<'a, 'm>(mixture: &'a AnyMixture<'m, Self::Groups>) -> &'a AnyMixture<'m>;
    #[doc(hidden)]
    fn any_mut<'a, 'm>(mixture: &'a mut AnyMixture<'m, Self::Groups>) -> &'a mut AnyMixture<'m>;
}

macro_rules! room {
    ($($lobes:literal)*) => {
        $(impl Groups for Room<$lobes> {
            type Groups = [Group; $lobes / WIDEST];
            const EMPTY: Self::Groups = [EMPTY_GROUP; $lobes / WIDEST];
            #[inline(always)]
            fn any<'a, 'm>(mixture: &'a AnyMixture<'m, Self::Groups>) -> &'a AnyMixture<'m> {
                mixture
            }
            #[inline(always)]
            fn any_mut<'a, 'm>(mixture: &'a mut AnyMixture<'m, Self::Groups>) -> &'a mut AnyMixture<'m> {
                mixture
            }
        })*
    };
}
room!(16 32 48 64);

impl<'m, const N: usize> Deref for Mixture<'m, N>
where
    Room<N>: Groups,
{
    type Target = AnyMixture<'m>;
    #[inline(always)]
    fn deref(&self) -> &AnyMixture<'m> {
        Room::<N>::any(&self.0)
    }
}

impl<const N: usize> DerefMut for Mixture<'_, N>
where
    Room<N>: Groups,
{
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut Self::Target {
        Room::<N>::any_mut(&mut self.0)
    }
}

impl<'m, const N: usize> AsRef<AnyMixture<'m>> for Mixture<'m, N>
where
    Room<N>: Groups,
{
    #[inline(always)]
    fn as_ref(&self) -> &AnyMixture<'m> {
        self
    }
}

impl<'m, const N: usize> AsMut<AnyMixture<'m>> for Mixture<'m, N>
where
    Room<N>: Groups,
{
    #[inline(always)]
    fn as_mut(&mut self) -> &mut AnyMixture<'m> {
        self
    }
}

impl<'m> AsRef<Self> for AnyMixture<'m> {
    #[inline(always)]
    fn as_ref(&self) -> &Self {
        self
    }
}

impl<'m> AsMut<Self> for AnyMixture<'m> {
    #[inline(always)]
    fn as_mut(&mut self) -> &mut Self {
        self
    }
}

impl<'m> AnyMixture<'m> {
    /// Room for that many lobes.
    #[inline(always)]
    pub fn capacity(&self) -> usize {
        WIDEST * self.groups.len()
    }

    /// Overwrites the mixture by another one.
    ///
    /// # Errors
    /// [`Error::Capacity`] if there is room for fewer lobes than the other has; the mixture stays as it was.
    pub fn copy_from(&mut self, other: &AnyMixture<'m>) -> Result<(), Error> {
        let (needed, available) = (other.len(), self.capacity());
        if needed > available {
            return Err(Error::Capacity { needed, available });
        }
        self.head = other.head.clone();
        for (to, from) in self.groups.iter_mut().zip(&other.groups) {
            *to = *from;
        }
        Ok(())
    }

    /// A number of lobe `k`.
    #[inline(always)]
    pub(crate) fn number(&self, row: usize, k: usize) -> f32 {
        self.groups[k / WIDEST][row][k % WIDEST]
    }

    /// The same, to store it.
    #[inline(always)]
    pub(crate) fn number_mut(&mut self, row: usize, k: usize) -> &mut f32 {
        &mut self.groups[k / WIDEST][row][k % WIDEST]
    }

    /// A number of each of the lobes from `k` on, of one group.
    #[inline(always)]
    pub(crate) fn load<L: Lanes>(&self, row: usize, k: usize) -> L {
        let within = if L::COUNT >= WIDEST { 0 } else { k % WIDEST };
        L::load(&self.groups[k / WIDEST][row][within..])
    }

    /// Whether there is room for lobe `k`. The compiler sees that its numbers do not lie outside the groups, which it does not see of
    /// `k < self.capacity()`, a product that may overflow.
    #[inline(always)]
    pub(crate) fn has_room(&self, k: usize) -> bool {
        k / WIDEST < self.groups.len()
    }

    /// Whether lobe `k` is one of `count`, and there is room for it.
    #[inline(always)]
    pub(crate) fn has(&self, k: usize, count: usize) -> bool {
        k < count && self.has_room(k)
    }
}

/// A mixture, whatever room it has: a text over it is compiled once.
pub(crate) struct MixtureRef<'a> {
    pub head: &'a Head<'a>,
    /// Sixteen lobes each, as many as the count says; the others are anything.
    pub groups: [&'a Group; PARTS],
}

impl<'a> MixtureRef<'a> {
    /// The parts of a row.
    #[inline(always)]
    pub fn row(&self, row: usize) -> Parts<'a> {
        let [a, b, c, d] = self.groups;
        [&a[row], &b[row], &c[row], &d[row]]
    }
}

/// The numbers that a mixture has once.
#[derive(Clone, Debug)]
pub(crate) struct Head<'m> {
    pub count: usize,
    pub squeezed: usize,
    pub domain: Domain,
    /// Every axis has y = 0 in the frame of the view.
    pub in_plane: bool,
    /// The level of this mixture's kernels, chosen when it was made.
    pub level: Level,
    pub squeeze: Squeeze,
    /// Bit k: lobe k needs its fold.
    pub folded: u64,
    /// Albedo of the diffuse term; 0 on the sphere.
    pub diffuse: Vec3,
    /// Albedo of the lobes.
    pub lobes_albedo: Vec3,
    /// Luminance of the albedo, the normaliser of the density; 0 if nothing can be sampled.
    pub power: f32,
    /// `1 / power`, or 0.
    pub inverse_power: f32,
    /// The part of `power` that lobes have.
    pub lobes_power: f32,
    /// The part that the diffuse term has: the difference of the two above would have lost its digits.
    pub diffuse_power: f32,
    /// What values are multiplied by.
    pub factors: Factors<'m>,
}

impl Head<'_> {
    const EMPTY: Self = Self {
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
    };

    /// Whether values are multiplied by factors.
    #[inline(always)]
    pub fn has_factors(&self) -> bool {
        !self.factors.is_none()
    }
}

/// A number whose lowest `count` bits are set, up to 64.
#[inline(always)]
pub(crate) const fn lowest_bits(count: usize) -> u64 {
    if count == 0 { 0 } else { u64::MAX >> (64 - count) }
}

impl<const N: usize> Default for Mixture<'_, N>
where
    Room<N>: Groups,
{
    fn default() -> Self {
        Self::empty()
    }
}

impl<const N: usize> Mixture<'_, N>
where
    Room<N>: Groups,
{
    /// The mixture without lobes: value, albedo and density are 0, and no sample can be drawn.
    pub const fn empty() -> Self {
        Self(AnyMixture { head: Head::EMPTY, groups: Room::<N>::EMPTY })
    }
}

impl AnyMixture<'_> {
    /// The mixture as batches take it.
    #[inline(always)]
    pub(crate) fn borrowed(&self) -> MixtureRef<'_> {
        let group = |p: usize| self.groups.get(p).unwrap_or(&self.groups[0]);
        MixtureRef { head: &self.head, groups: [group(0), group(1), group(2), group(3)] }
    }

    /// Starts over as an empty mixture, keeping the storage.
    #[inline(always)]
    pub(crate) fn begin(&mut self, level: Level, domain: Domain, squeeze: Squeeze) {
        self.head.count = 0;
        self.head.squeezed = 0;
        self.head.domain = domain;
        self.head.in_plane = true;
        self.head.level = level;
        self.head.squeeze = squeeze;
        self.head.folded = 0;
        self.head.diffuse = Vec3::ZERO;
        self.head.lobes_albedo = Vec3::ZERO;
        self.head.power = 0.0;
        self.head.inverse_power = 0.0;
        self.head.lobes_power = 0.0;
        self.head.diffuse_power = 0.0;
        self.head.factors.nodes = Nodes::NONE;
    }

    /// Albedo of the diffuse term, linear sRGB.
    #[inline]
    pub fn diffuse(&self) -> Vec3 {
        self.head.diffuse
    }

    /// Number of lobes.
    #[inline]
    pub fn len(&self) -> usize {
        self.head.count
    }

    /// Whether there is no lobe.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.head.count == 0
    }

    /// Number of lobes that see the squeezed direction; they come first.
    #[inline]
    pub fn squeezed_len(&self) -> usize {
        self.head.squeezed
    }

    /// The squeeze c, across +x of the frame of the view; 1 for none.
    #[inline]
    pub fn squeeze(&self) -> f32 {
        1.0 / self.head.squeeze.inverse
    }

    /// The squeeze along +x of the frame of the view; 1 but for anisotropic materials.
    #[inline]
    pub fn squeeze_along(&self) -> f32 {
        1.0 / self.head.squeeze.along
    }

    /// Azimuth of +x of the frame of the view in the caller's frame, its cosine and sine.
    ///
    /// Away from the outgoing direction for an isotropic material; for an anisotropic one turned by up to 45
    /// degrees from there, so that the squeeze acts along it and +y.
    #[inline]
    pub fn azimuth_cos_sin(&self) -> [f32; 2] {
        self.head.squeeze.azimuth
    }

    /// Where the mixture lives.
    #[inline]
    pub fn domain(&self) -> Domain {
        self.head.domain
    }

    /// The instruction set that this mixture's kernels run on, chosen when it was made; see [`Level::set`].
    #[inline]
    pub fn level(&self) -> Level {
        self.head.level
    }

    /// Whether lobe `k` is evaluated with its fold.
    #[inline]
    pub fn is_folded(&self, k: usize) -> bool {
        k < self.head.count && self.head.folded >> k & 1 == 1
    }

    /// Lobe `k` in the frame of the view, or `None` past the end.
    pub fn lobe(&self, k: usize) -> Option<Lobe> {
        let amplitude =
            || Vec3::new(self.number(row::RED, k), self.number(row::GREEN, k), self.number(row::BLUE, k));
        (k < self.head.count).then(|| Lobe { gaussian: self.gaussian(k), amplitude: amplitude() })
    }

    pub(crate) fn gaussian(&self, k: usize) -> Gaussian {
        let axis =
            Vec3::new(self.number(row::AXIS_X, k), self.number(row::AXIS_Y, k), self.number(row::AXIS_Z, k));
        Gaussian { axis, sharpness: self.number(row::SHARPNESS, k) }
    }

    /// Integral of the value over the domain, in closed form: `diffuse + sum a I(s)`; linear sRGB.
    ///
    /// For a material, the directional albedo towards the outgoing direction. With factors there is no closed
    /// form: a material stores their change of it for its views, relative to [`power`](Self::power), and
    /// that is interpolated linearly between them. A fit's is 0.04 to 0.5 % of the luminance off in the mean
    /// over outgoing directions, and at most 2.0 %.
    #[inline]
    pub fn albedo(&self) -> Vec3 {
        let lobes = self.head.lobes_albedo + self.head.diffuse;
        if self.has_factors() {
            lobes + self.head.power * self.head.factors.albedo_difference()
        } else {
            lobes
        }
    }

    /// Luminance of the closed form of the albedo, without factors: the norm of the density, and without factors the luminance of
    /// every sample's weight.
    #[inline]
    pub fn power(&self) -> f32 {
        self.head.power
    }

    /// Whether lobes see directions as they are, neither turned nor squeezed.
    #[inline(always)]
    pub(crate) fn is_plain(&self) -> bool {
        self.head.squeezed == 0 && !self.head.squeeze.is_turned
    }

    /// Whether there is neither a lobe nor a diffuse term: the mixture that is prepared for no direction.
    #[inline(always)]
    pub(crate) fn is_nothing(&self) -> bool {
        self.head.count == 0 && self.head.diffuse == Vec3::ZERO
    }
}

impl<'m> AnyMixture<'m> {
    /// Bytes of the material that the mixture reads when it is evaluated: its table of factors, empty for
    /// none.
    #[inline]
    pub fn factor_bytes(&self) -> &'m [u8] {
        self.head.factors.nodes.bytes()
    }

    /// Whether values are multiplied by factors; see [`Material::factor`](crate::Material::factor).
    #[inline]
    pub fn has_factors(&self) -> bool {
        self.head.has_factors()
    }
}
