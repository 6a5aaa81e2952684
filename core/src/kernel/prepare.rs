//! From a material and outgoing directions to mixtures.

use super::between_views::{Place, WIDEST, at_place, views_passed};
use super::prepare_anisotropic;
use crate::error::Error;
use crate::material::borrowed::Material;
use crate::material::layout::{Kind, f32_at};
use crate::mixture::factors::{Among, Factors};
use crate::mixture::leave_out::LeaveOut;
use crate::mixture::rows::{Domain, Mixture};
use crate::simd::detect::Level;
use crate::simd::elementary::atan2_positive;
use crate::simd::lane_pair::LanePair;
use crate::simd::lanes::{Lanes, splat3};
use crate::simd::routine::Routine;
use crate::squeeze::Squeeze;
use glam::Vec3;

impl<'a> Material<'a> {
    /// Makes the mixture for an outgoing direction, in the caller's storage, which it overwrites.
    ///
    /// `wo` is a unit vector in the shading frame, +z the normal. Below the horizon (z < 0) nothing is
    /// reflected and the mixture is empty. The mixture takes and gives directions in the same shading frame.
    /// It borrows the table of factors from the bytes of the material, if there is one.
    ///
    /// # Errors
    /// [`Error::Capacity`] if the storage has room for fewer lobes than
    /// [`lobe_count`](Self::lobe_count); [`Error::Direction`] if `wo`
    /// is not a finite unit vector. The mixture is empty then.
    #[inline]
    pub fn prepare<const N: usize>(&self, wo: Vec3, mixture: &mut Mixture<'a, N>) -> Result<(), Error> {
        self.prepare_leaving_out(wo, LeaveOut::default(), mixture)
    }

    /// [`prepare`](Self::prepare), leaving out lobes and folds that matter less than a bound.
    ///
    /// `srbf leave-out` prints the error and the time of bounds, for each preset.
    ///
    /// # Errors
    /// Those of [`prepare`](Self::prepare).
    #[inline]
    pub fn prepare_leaving_out<const N: usize>(
        &self,
        wo: Vec3,
        leave_out: LeaveOut,
        mixture: &mut Mixture<'a, N>,
    ) -> Result<(), Error> {
        let level = Level::current();
        level.run(Prepare { material: self, wo, leave_out, level, mixture })
    }

    /// [`prepare_leaving_out`](Self::prepare_leaving_out) for the kernels of one level, whatever
    /// [`Level::set`] chose: for values that must not depend on the processor, [`Level::Scalar`].
    ///
    /// # Errors
    /// [`Error::Level`] if this processor or this build lacks it; and those of [`prepare`](Self::prepare).
    pub fn prepare_at<const N: usize>(
        &self,
        level: Level,
        wo: Vec3,
        leave_out: LeaveOut,
        mixture: &mut Mixture<'a, N>,
    ) -> Result<(), Error> {
        if !level.is_available() {
            mixture.begin(Level::Scalar, Domain::Hemisphere, Squeeze::NONE);
            return Err(Error::Level);
        }
        level.run(Prepare { material: self, wo, leave_out, level, mixture })
    }
}

struct Prepare<'a, 'b, const N: usize> {
    pub material: &'a Material<'b>,
    pub wo: Vec3,
    pub leave_out: LeaveOut,
    /// What it runs on.
    pub level: Level,
    pub mixture: &'a mut Mixture<'b, N>,
}

impl<const N: usize> Routine for Prepare<'_, '_, N> {
    type Output = Result<(), Error>;
    #[inline(always)]
    fn run<L: Lanes>(self) -> Result<(), Error> {
        prepare::<L, N>(self.material, self.wo, self.leave_out, self.level, self.mixture)
    }
}

#[inline(always)]
fn prepare<'m, L: Lanes, const N: usize>(
    material: &Material<'m>,
    wo: Vec3,
    leave_out: LeaveOut,
    level: Level,
    mixture: &mut Mixture<'m, N>,
) -> Result<(), Error> {
    mixture.begin(level, Domain::Hemisphere, Squeeze::NONE);
    let count = material.lobe_count();
    if count > N {
        return Err(Error::Capacity { needed: count, available: N });
    }
    // False for a NaN too.
    let across_squared = wo.x * wo.x + wo.y * wo.y;
    let is_unit = (across_squared + wo.z * wo.z - 1.0).abs() <= 2e-3;
    if !is_unit {
        return Err(Error::Direction);
    }
    if wo.z < 0.0 {
        return Ok(());
    }
    if let Kind::Grid(shape) = material.header.kind {
        if L::LOBES_PAIRED {
            prepare_anisotropic::prepare::<LanePair<L>, N>(material, shape, wo, leave_out, mixture);
        } else {
            prepare_anisotropic::prepare::<L, N>(material, shape, wo, leave_out, mixture);
        }
        return Ok(());
    }
    // Where one number has no fused operations but a vector has, in a vector: the same bits as in
    // `PrepareInto`.
    let (azimuth, theta) = if L::FUSED && !L::One::FUSED {
        Facing::<L>::of(wo, across_squared)
    } else {
        Facing::<L::One>::of(wo, across_squared)
    };
    let place = Place::after(material, views_passed::<L>(material, theta), theta);
    at_place::<L, N>(material, azimuth, place, leave_out, mixture);
    mixture.sum_up();
    take_factors(material, place, wo, mixture);
    Ok(())
}

/// Gives a mixture the factors of its material, if there are some.
#[inline(always)]
fn take_factors<'m, const N: usize>(
    material: &Material<'m>,
    place: Place,
    wo: Vec3,
    mixture: &mut Mixture<'m, N>,
) {
    if material.header.factors[0] > 0 {
        let views = [[place.before as u16, place.after as u16]; 2];
        mixture.factors = Factors::new(material, wo, Among { views, onward: place.blend, outward: 0.0 });
    }
}

/// Mixtures for many outgoing directions: lanes are directions for their angles and azimuths, lobes for the
/// rest.
pub(crate) struct PrepareInto<'a, 'b, const N: usize> {
    pub material: &'a Material<'b>,
    pub wo: [&'a [f32]; 3],
    /// What it runs on.
    pub level: Level,
    /// As many as directions; a direction that is none leaves an empty one. They have room for all lobes.
    pub mixtures: &'a mut [Mixture<'b, N>],
}

impl<const N: usize> Routine for PrepareInto<'_, '_, N> {
    type Output = ();
    #[inline(always)]
    #[allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices
    fn run<L: Lanes>(self) {
        let Self { material, wo, level, mixtures } = self;
        let [x, y, z] = wo;
        if L::COUNT == 1 || matches!(material.header.kind, Kind::Grid(_)) {
            for i in 0..mixtures.len() {
                let wo = Vec3::new(x[i], y[i], z[i]);
                let _ = prepare::<L, N>(material, wo, LeaveOut::default(), level, &mut mixtures[i]);
            }
            return;
        }
        let mut at = 0;
        while at < mixtures.len() {
            let count = L::COUNT.min(mixtures.len() - at);
            let [x, y, z] =
                [load_some::<L>(&x[at..], count), load_some(&y[at..], count), load_some(&z[at..], count)];
            let across_squared = x * x + y * y;
            let off = (across_squared + z * z - L::splat(1.0)).abs();
            let seen = L::bits(L::splat(2e-3).ge(off)) & L::bits(z.ge(L::splat(0.0)));
            let facing = Facing::new([x, y, z], across_squared);
            let mut passed = L::splat(0.0);
            for view in 0..material.header.views - 1 {
                let theta = L::splat(f32_at(material.bytes, material.header.theta(view)));
                passed = passed + L::select(facing.theta.ge(theta), L::splat(1.0), L::splat(0.0));
            }
            let (mut thetas, mut passed_by, mut azimuths) =
                ([0.0; WIDEST], [0.0; WIDEST], [[0.0; WIDEST]; 2]);
            facing.theta.store(&mut thetas);
            passed.store(&mut passed_by);
            facing.azimuth[0].store(&mut azimuths[0]);
            facing.azimuth[1].store(&mut azimuths[1]);
            for i in 0..count {
                let mixture = &mut mixtures[at + i];
                mixture.begin(level, Domain::Hemisphere, Squeeze::NONE);
                if seen >> i & 1 == 1 {
                    let place = Place::after(material, passed_by[i] as usize, thetas[i]);
                    let azimuth = [azimuths[0][i], azimuths[1][i]];
                    at_place::<L, N>(material, azimuth, place, LeaveOut::default(), mixture);
                    let wo = Vec3::new(wo[0][at + i], wo[1][at + i], wo[2][at + i]);
                    take_factors(material, place, wo, mixture);
                }
            }
            // Apart, so that the chains of additions of many mixtures run side by side.
            for mixture in &mut mixtures[at..at + count] {
                mixture.sum_up();
            }
            at += L::COUNT;
        }
    }
}

/// The first `count` numbers of a slice, and zeros.
#[inline(always)]
fn load_some<L: Lanes>(from: &[f32], count: usize) -> L {
    if count == L::COUNT {
        return L::load(from);
    }
    let mut padded = [0.0; WIDEST];
    padded[..count].copy_from_slice(&from[..count]);
    L::load(&padded)
}

/// Outgoing directions as angle from the normal and azimuth.
struct Facing<L> {
    theta: L,
    /// Cosine and sine, in the caller's frame, of the azimuth of +x of the view.
    azimuth: [L; 2],
}

impl<L: Lanes> Facing<L> {
    /// Azimuth and angle of one direction.
    #[inline(always)]
    fn of(wo: Vec3, across_squared: f32) -> ([f32; 2], f32) {
        let facing = Self::new(splat3(wo.to_array()), L::splat(across_squared));
        ([facing.azimuth[0].first(), facing.azimuth[1].first()], facing.theta.first())
    }

    /// Of unit vectors above the horizon; anything for others.
    #[inline(always)]
    fn new([x, y, z]: [L; 3], across_squared: L) -> Self {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let across = across_squared.sqrt();
        // +x of the view points away from wo, towards the mirror direction; at the normal any azimuth serves,
        // and the square of what is nearer to it than 1e-19 has lost its digits.
        let inverse = one / across;
        let is_tilted = across_squared.ge(L::splat(f32::MIN_POSITIVE));
        let azimuth = [
            L::select(is_tilted, (zero - x) * inverse, one),
            L::select(is_tilted, (zero - y) * inverse, zero),
        ];
        Self { theta: atan2_positive(across, z), azimuth }
    }
}
