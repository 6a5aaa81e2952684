//! A mixture: the lobes that one outgoing direction needs, ready to evaluate and sample.

use crate::color;
use crate::factors::{FactoredOne, Factors};
use crate::lanes::{Lanes, dot3, exp2, splat3};
use crate::leave_out::LeaveOut;
use crate::simd::Level;
use crate::single::{DirectionOne, Drawn, EvaluateOne, PdfOne};
use crate::squeeze::Squeeze;
use crate::{Error, Gaussian, Lobe};
use core::f32::consts::{LOG2_E, PI};
use glam::Vec3;

/// Most lobes that a mixture can hold.
pub const MAX_LOBES: usize = 64;

/// Weights of luminance in linear sRGB (Rec. 709).
pub const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// Luminance of a linear sRGB colour (Rec. 709): what lobes are chosen by and densities are weighted with.
#[inline]
pub fn luminance(rgb: Vec3) -> f32 {
    rgb.dot(Vec3::from_array(LUMINANCE))
}

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
    /// Density of the whole mixture at the direction; 1/sr.
    pub pdf: f32,
    /// `f cos` at the direction, linear sRGB; 1/sr.
    pub value: Vec3,
}

impl Sample {
    /// `f cos / pdf`, linear sRGB: its luminance is that of the mixture's albedo at every sample, times that of a factor if the
    /// material has factors.
    #[inline]
    pub fn weight(&self) -> Vec3 {
        self.value / self.pdf
    }
}

/// A sum of lobes, and a diffuse term, for one outgoing direction; storage for `N` lobes, without allocation.
///
/// One that a material with factors has made reads them from the bytes of the material, which live for `'m`; any other lives for as
/// long as it may. `N` is 16, 32, 48 or 64. The first lobes see the squeezed direction, the others the direction itself. The diffuse term
/// is `albedo cos / pi` on the hemisphere: lobes cannot make the cosine of a diffuse surface, and it keeps `f cos / pdf`
/// bounded where the lobes end.
///
/// # Which lobes are folded
/// A folded lobe is `a (G(d) + G(d mirrored in z = 0))`, whose integral over the hemisphere is that of the lobe over
/// the sphere. A folded lobe does not change if its axis is mirrored, so axes are kept above the horizon. The second
/// term is left out, once per lobe, where the share of the lobe below the horizon is at most 1e-7: below the horizon
/// `cos <= t = sqrt(1 - axis.z^2)`, and a Gaussian has the share
/// `(exp(-s (1 - t)) - exp(-2 s)) / (1 - exp(-2 s)) <= exp(-s (1 - t))` of its integral at `cos <= t`. What is left out
/// is at most `1e-7 a` at any direction.
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
    /// `-2 s axis.z` in base 2: times d.z it is what the fold adds to the exponent. Minus infinity, or a NaN times 0, which both
    /// leave nothing of it, for a lobe that does not need its fold but shares a vector with one that does.
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

/// Largest magnitude of a component that folded lobes can have, if all have their peaks at one place.
fn lobes_at_most(lobes: &[Lobe]) -> f32 {
    2.0 * lobes.iter().map(|lobe| lobe.amplitude.abs().max_element()).sum::<f32>()
}

impl<const N: usize> Default for Mixture<'_, N> {
    fn default() -> Self {
        Self::empty()
    }
}

impl<const N: usize> Mixture<'_, N> {
    /// The mixture without lobes: value, albedo and density are 0, and no sample can be drawn.
    pub const fn empty() -> Self {
        const {
            assert!(
                N > 0 && N.is_multiple_of(16) && N <= MAX_LOBES,
                "a mixture has room for 16, 32, 48 or 64 lobes"
            )
        };
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

    /// Makes a mixture of folded, round lobes on the upper hemisphere.
    ///
    /// # Errors
    /// [`Error::Capacity`]; [`Error::Amplitude`] if integral or value could be infinite; and what [`Lobe::new`] refuses.
    pub fn hemisphere(lobes: &[Lobe]) -> Result<Self, Error> {
        Self::new(Domain::Hemisphere, 1.0, &[], lobes)
    }

    /// Makes a mixture of round lobes on the whole sphere.
    ///
    /// # Errors
    /// [`Error::Capacity`]; [`Error::Amplitude`] if integral or value could be infinite; and what [`Lobe::new`] refuses.
    pub fn sphere(lobes: &[Lobe]) -> Result<Self, Error> {
        Self::new(Domain::Sphere, 1.0, &[], lobes)
    }

    /// Makes a mixture of squeezed and round lobes; the squeeze c narrows (c < 1) or widens along y.
    ///
    /// # Errors
    /// [`Error::Capacity`]; [`Error::Squeeze`] outside [0.01, 2]; [`Error::Amplitude`] if integral or value could be infinite;
    /// and what [`Lobe::new`] refuses.
    pub fn new(domain: Domain, squeeze: f32, squeezed: &[Lobe], round: &[Lobe]) -> Result<Self, Error> {
        let needed = squeezed.len() + round.len();
        if needed > N {
            return Err(Error::Capacity { needed, available: N });
        }
        if !(0.01..=2.0).contains(&squeeze) {
            return Err(Error::Squeeze);
        }
        let mut mixture = Self::empty();
        mixture.begin(Level::current(), domain, Squeeze::new([1.0, 0.0], 1.0, 1.0 / squeeze));
        for (k, lobe) in squeezed.iter().chain(round).enumerate() {
            let Lobe { gaussian, amplitude } =
                Lobe::new(lobe.gaussian.axis, lobe.gaussian.sharpness, lobe.amplitude)?;
            mixture.in_plane &= gaussian.axis.y == 0.0;
            mixture.axis_x[k] = gaussian.axis.x;
            mixture.axis_y[k] = gaussian.axis.y;
            mixture.axis_z[k] = gaussian.axis.z;
            mixture.sharpness[k] = gaussian.sharpness;
            [mixture.red[k], mixture.green[k], mixture.blue[k]] = amplitude.to_array();
        }
        mixture.finish::<f32>(needed, squeezed.len(), LeaveOut::default());
        // The most that a value can be: the fold doubles a lobe, the squeeze changes solid angles.
        let most = lobes_at_most(squeezed) * (1.0 / squeeze).max(squeeze * squeeze) + lobes_at_most(round);
        let is_finite = mixture.albedo().is_finite() && most.is_finite();
        if is_finite { Ok(mixture) } else { Err(Error::Amplitude) }
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

    /// Completes the mixture from axes, sharpness and amplitudes, which the caller has stored and checked; those of
    /// the places up to the next multiple of the lanes must be valid, of amplitude 0. On AVX2 `L` is a pair of vectors, as
    /// it is where one direction is evaluated.
    #[inline(always)]
    pub(crate) fn finish<L: Lanes>(&mut self, count: usize, squeezed: usize, leave_out: LeaveOut) {
        self.finish_lobes::<L>(count, squeezed, leave_out);
        self.sum_up();
    }

    /// The part of [`finish`](Self::finish) that every lobe needs; [`sum_up`](Self::sum_up) is to follow.
    #[inline(always)]
    #[allow(clippy::needless_range_loop)] // see lanes: kernels loop over array indices
    pub(crate) fn finish_lobes<L: Lanes>(&mut self, count: usize, squeezed: usize, leave_out: LeaveOut) {
        (self.count, self.squeezed) = (count, squeezed);
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let mut albedo = [zero; 3];
        let mut folded = 0;
        let mut k = 0;
        while k < count && k + L::COUNT <= N {
            let s = L::load(&self.sharpness[k..]);
            let rate = s * L::splat(-0.5 * LOG2_E);
            rate.store(&mut self.rate[k..]);

            // Normaliser: (1 - exp(-x)) / x at x = 2 s, by its series where the difference would cancel.
            let s = s.max(L::splat(1e-7));
            let x = s + s;
            let inverse = one / s;
            let tail = exp2(s * L::splat(-2.0 * LOG2_E));
            let mut inside = one - tail;
            let small = x.lt(L::splat(0.5));
            if L::bits(small) != 0 {
                let mut series = L::splat(-1.0 / 40_320.0);
                const SERIES: [f32; 7] = [1. / 5040., -1. / 720., 1. / 120., -1. / 24., 1. / 6., -0.5, 1.];
                for i in 0..SERIES.len() {
                    series = series.mul_add(x, L::splat(SERIES[i]));
                }
                inside = L::select(small, series * x, inside);
            }
            let integral = inside * inverse * L::splat(2.0 * PI);
            inverse.store(&mut self.inverse_sharpness[k..]);
            tail.store(&mut self.tail[k..]);
            inside.store(&mut self.inside[k..]);

            if self.domain == Domain::Hemisphere {
                let axis_z = L::load(&self.axis_z[k..]).abs();
                axis_z.store(&mut self.axis_z[k..]);
                // s (1 - t) = s z^2 / (1 + t), without cancellation.
                let zz = axis_z * axis_z;
                let t = (one - zz).max(zero).sqrt();
                let folds = (s * zz).lt((one + t) * L::splat(leave_out.fold_exponent));
                folded |= L::bits(folds) << k;
                let fold_rate = rate * axis_z * L::splat(4.0);
                L::select(folds, fold_rate, L::splat(f32::NEG_INFINITY)).store(&mut self.fold_rate[k..]);
            }

            let rgb = [L::load(&self.red[k..]), L::load(&self.green[k..]), L::load(&self.blue[k..])];
            let luminance = dot3(rgb, splat3(LUMINANCE));
            luminance.store(&mut self.luminance[k..]);
            // The powers first, their running sum below.
            (luminance * integral).store(&mut self.cumulative[k..]);
            for i in 0..3 {
                albedo[i] = rgb[i].mul_add(integral, albedo[i]);
            }
            k += L::COUNT;
        }
        self.folded = folded & lowest_bits(count);
        let mut lobes_albedo = Vec3::new(albedo[0].sum(), albedo[1].sum(), albedo[2].sum());
        if leave_out.lobes > 0.0 {
            // Less what rounding may have taken from the power of a lobe: one that is all there is stays.
            let least = leave_out.lobes * (1.0 - 1e-6) * luminance(lobes_albedo + self.diffuse);
            lobes_albedo = self.drop_lobes::<L>(least).unwrap_or(lobes_albedo);
        }
        self.lobes_albedo = lobes_albedo;
    }

    /// Sums up the powers of the lobes, a chain of as many dependent additions, and of the diffuse term.
    #[inline(always)]
    pub(crate) fn sum_up(&mut self) {
        let mut power = 0.0;
        for running in &mut self.cumulative[..self.count.min(N)] {
            power += *running;
            *running = power;
        }
        self.lobes_power = power;
        self.add_diffuse();
    }

    /// Drops the lobes whose power, which `cumulative` still holds one by one, is below a bound; those that stay keep their
    /// order. Gives their albedo, or `None` if all stay.
    #[inline(always)]
    #[allow(clippy::needless_range_loop)] // see lanes: kernels loop over array indices
    fn drop_lobes<L: Lanes>(&mut self, least: f32) -> Option<Vec3> {
        let count = self.count.min(N);
        let zero = L::splat(0.0);
        let mut albedo = [zero; 3];
        let mut stays = 0;
        let mut k = 0;
        while k < count && k + L::COUNT <= N {
            let stay = L::load(&self.cumulative[k..]).ge(L::splat(least));
            stays |= L::bits(stay) << k;
            let integral = L::load(&self.inside[k..]) * L::load(&self.inverse_sharpness[k..]);
            let integral = L::select(stay, integral, zero);
            let rgb = [L::load(&self.red[k..]), L::load(&self.green[k..]), L::load(&self.blue[k..])];
            for i in 0..3 {
                albedo[i] = rgb[i].mul_add(integral, albedo[i]);
            }
            k += L::COUNT;
        }
        let all = lowest_bits(count);
        stays &= all;
        if stays == all {
            return None;
        }
        // The lobes before the first that goes are in their places.
        let mut to = stays.trailing_ones() as usize;
        let mut left = stays & !lowest_bits(to);
        while left != 0 {
            let k = left.trailing_zeros() as usize;
            left &= left - 1;
            // Never so: the compiler sees that no place below lies outside.
            if k >= N || to >= N {
                break;
            }
            macro_rules! move_rows {
                ($($row:ident)*) => { $(self.$row[to] = self.$row[k];)* };
            }
            move_rows!(axis_x axis_y axis_z sharpness red green blue luminance rate fold_rate);
            move_rows!(inverse_sharpness inside tail cumulative);
            to += 1;
        }
        for k in to..count {
            (self.red[k], self.green[k], self.blue[k], self.luminance[k]) = (0.0, 0.0, 0.0, 0.0);
        }
        self.squeezed = (stays & lowest_bits(self.squeezed)).count_ones() as usize;
        self.count = to;
        // The bits of the folds move down over every one that goes, the highest first.
        let mut goes = all & !stays;
        while goes != 0 {
            let place = 63 - goes.leading_zeros();
            let below = (1 << place) - 1;
            self.folded = self.folded & below | self.folded >> 1 & !below;
            goes &= below;
        }
        let [red, green, blue] = albedo;
        Some(Vec3::new(red.sum(), green.sum(), blue.sum()) * (2.0 * PI))
    }

    /// Adds the power of the diffuse term to that of the lobes.
    #[inline(always)]
    fn add_diffuse(&mut self) {
        self.diffuse_power = luminance(self.diffuse);
        let power = self.lobes_power + self.diffuse_power;
        // A sum so small that its inverse is infinite reflects nothing.
        (self.power, self.inverse_power) =
            if power >= f32::MIN_POSITIVE { (power, 1.0 / power) } else { (0.0, 0.0) };
    }

    /// The same lobes beside a diffuse term of an albedo, linear sRGB: `albedo cos / pi` is added to the value.
    ///
    /// # Errors
    /// [`Error::Amplitude`] for a colour that no [`Lobe`] may have, and for a mixture that lives on the whole sphere or has factors.
    pub fn with_diffuse(mut self, albedo: Vec3) -> Result<Self, Error> {
        if !color::is_admissible(albedo) || self.domain == Domain::Sphere || self.has_factors() {
            return Err(Error::Amplitude);
        }
        if self.count == 0 {
            self.level = Level::current();
        }
        self.diffuse = albedo;
        self.add_diffuse();
        if self.albedo().is_finite() { Ok(self) } else { Err(Error::Amplitude) }
    }

    /// The same, with the kernels of a level, whatever [`Level::set`] chose. [`with_diffuse`](Self::with_diffuse) on a mixture without
    /// lobes chooses anew: call it before.
    ///
    /// # Errors
    /// [`Error::Level`] if this processor or this build lacks it.
    pub fn with_level(mut self, level: Level) -> Result<Self, Error> {
        if !level.is_available() {
            return Err(Error::Level);
        }
        self.level = level;
        Ok(self)
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
    /// Away from the outgoing direction for an isotropic material; for an anisotropic one turned by up to 45 degrees from
    /// there, so that it and +y are what the squeeze acts along.
    #[inline]
    pub fn azimuth(&self) -> [f32; 2] {
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
    /// For a material, the directional albedo towards the outgoing direction. With factors there is no closed form: a material stores
    /// for its views what they change of it, relative to [`power`](Self::power), and that is interpolated linearly between them.
    /// A fit's is 0.04 to 0.5 % of the luminance off in the mean over outgoing directions, and at most 1.5 %.
    #[inline]
    pub fn albedo(&self) -> Vec3 {
        let lobes = self.lobes_albedo + self.diffuse;
        if self.has_factors() { lobes + self.power * self.factors.albedo_difference() } else { lobes }
    }

    /// Luminance of the closed form of the albedo, without factors: what the density is normalised by, and without factors the luminance of
    /// every sample's weight.
    #[inline]
    pub fn power(&self) -> f32 {
        self.power
    }

    /// Whether lobes see directions as they are, neither turned nor squeezed.
    #[inline(always)]
    fn is_plain(&self) -> bool {
        self.squeezed == 0 && !self.squeeze.is_turned
    }

    /// Evaluates `f cos` towards an incident direction, linear sRGB; 1/sr. 0 below the horizon of a hemisphere.
    ///
    /// A lobe is exactly 0 where it is below 2^-100 (8e-31) of its amplitude; above, its relative error is at most 3e-7 times
    /// 2 plus its exponent.
    #[inline]
    pub fn evaluate(&self, direction: Vec3) -> Vec3 {
        if self.has_factors() {
            return self.factored(direction).0;
        }
        self.lobes_value(direction)
    }

    /// The value, and the luminance of what the lobes have, of a mixture with factors.
    #[inline(never)]
    fn factored(&self, direction: Vec3) -> (Vec3, f32) {
        self.level.run_one::<_, FactoredOne>(self, direction.to_array())
    }

    /// What the lobes and the diffuse term have, without factors.
    #[inline(always)]
    fn lobes_value(&self, direction: Vec3) -> Vec3 {
        if self.is_plain() {
            self.level.run_one::<_, EvaluateOne<false>>(self, direction.to_array())
        } else {
            self.level.run_one::<_, EvaluateOne<true>>(self, direction.to_array())
        }
    }

    /// Evaluates the density of [`sample`](Self::sample) at a direction; 1/sr.
    #[inline]
    pub fn pdf(&self, direction: Vec3) -> f32 {
        if self.is_plain() {
            self.level.run_one::<_, PdfOne<false>>(self, direction.to_array())
        } else {
            self.level.run_one::<_, PdfOne<true>>(self, direction.to_array())
        }
    }

    /// Value and density in one pass over the lobes.
    #[inline]
    pub fn evaluate_and_pdf(&self, direction: Vec3) -> (Vec3, f32) {
        let (value, luminance) = if self.has_factors() {
            self.factored(direction)
        } else {
            let value = self.lobes_value(direction);
            (value, luminance(value))
        };
        (value, luminance * self.inverse_power)
    }

    /// Draws an incident direction from the density: lobe by `u[0]`, direction in it by `u[1]` and `u[2]`.
    ///
    /// `None` where the integral is 0: such a mixture reflects nothing; and where the density underflows, far out in a tail. No sample is
    /// wasted below the horizon.
    /// The three numbers are uniform in [0, 1).
    /// Source: Weng and Shih 2006, section 4.2.2, eq. 14; differs: what falls below the horizon is mirrored up.
    #[inline]
    pub fn sample(&self, u: [f32; 3]) -> Option<Sample> {
        if self.has_factors() {
            return self.sample_factored(u);
        }
        if self.is_plain() { self.sample_as::<false>(u) } else { self.sample_as::<true>(u) }
    }

    #[inline(always)]
    fn sample_as<const SEEN: bool>(&self, u: [f32; 3]) -> Option<Sample> {
        if self.power <= 0.0 {
            return None;
        }
        let (direction, value) = self.level.draw_one::<_, Drawn<SEEN>, EvaluateOne<SEEN>>(self, u);
        self.sampled(direction, value, luminance(value))
    }

    #[inline(never)]
    fn sample_factored(&self, u: [f32; 3]) -> Option<Sample> {
        if self.power <= 0.0 {
            return None;
        }
        let (direction, (value, luminance)) = self.level.draw_one::<_, Drawn<true>, FactoredOne>(self, u);
        self.sampled(direction, value, luminance)
    }

    /// A sample of a direction that has been drawn, with the value there and the luminance of what the lobes have.
    #[inline(always)]
    fn sampled(&self, direction: [f32; 3], value: Vec3, luminance: f32) -> Option<Sample> {
        let pdf = luminance * self.inverse_power;
        // A density that f32 rounds to 0 cannot be divided by: far out in a tail, where the value is 0 too.
        (pdf > 0.0).then_some(Sample { direction: Vec3::from_array(direction), pdf, value })
    }

    /// Draws only direction and density of [`sample`](Self::sample), for callers that take the value elsewhere: one colour channel in
    /// place of three.
    #[inline]
    pub fn sample_pdf(&self, u: [f32; 3]) -> Option<(Vec3, f32)> {
        if self.is_plain() { self.sample_pdf_as::<false>(u) } else { self.sample_pdf_as::<true>(u) }
    }

    #[inline(always)]
    fn sample_pdf_as<const SEEN: bool>(&self, u: [f32; 3]) -> Option<(Vec3, f32)> {
        if self.power <= 0.0 {
            return None;
        }
        let (direction, pdf) = self.level.draw_one::<_, Drawn<SEEN>, PdfOne<SEEN>>(self, u);
        (pdf > 0.0).then_some((Vec3::from_array(direction), pdf))
    }

    /// Draws only the direction of [`sample`](Self::sample), for callers that take value and density elsewhere.
    #[inline]
    pub fn sample_direction(&self, u: [f32; 3]) -> Option<Vec3> {
        (self.power > 0.0).then(|| self.level.run_one::<_, DirectionOne>(self, u))
    }
}
