//! From a material and outgoing directions to mixtures.

#[cfg(feature = "simd")]
use super::among_rings::{FillRings, Frame};
use super::between_views::{Place, at_place, views_passed, views_passed_by_each};
use super::outgoing::{Facing, Outgoing, facing};
use super::prepare_anisotropic;
use crate::error::Error;
use crate::material::borrowed::{Material, MaterialRef};
use crate::material::layout::Kind;
use crate::mixture::factors::Factors;
use crate::mixture::leave_out::LeaveOut;
#[cfg(feature = "simd")]
use crate::mixture::row::Group;
use crate::mixture::rows::{AnyMixture, Domain};
use crate::simd::detect::Level;
use crate::simd::lanes::{Lanes, WIDEST, WIDEST_PAIR};
use crate::simd::routine::{One, Routine};
use crate::squeeze::Squeeze;
use glam::Vec3;

impl<B: AsRef<[u8]>> Material<B> {
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
    pub fn prepare<'a>(&'a self, wo: impl Into<Vec3>, mixture: &mut AnyMixture<'a>) -> Result<(), Error> {
        prepare(self.borrowed(), wo.into(), LeaveOut::default(), Level::current(), mixture)
    }

    /// [`prepare`](Self::prepare) with options: the bounds of leaving out, and the level.
    ///
    /// `cargo lab leave-out` prints the error and the time of bounds, for each preset.
    ///
    /// # Errors
    /// [`Error::Level`] if this processor or this build lacks the level; and those of
    /// [`prepare`](Self::prepare). The mixture is empty then.
    #[inline]
    pub fn prepare_with<'a>(
        &'a self,
        wo: impl Into<Vec3>,
        options: PrepareOptions,
        mixture: &mut AnyMixture<'a>,
    ) -> Result<(), Error> {
        let level = match options.level {
            None => Level::current(),
            Some(level) if level.is_available() => level,
            Some(_) => {
                mixture.begin(Level::Scalar, Domain::Hemisphere, Squeeze::NONE);
                return Err(Error::Level);
            }
        };
        prepare(self.borrowed(), wo.into(), options.leave_out, level, mixture)
    }
}

/// How [`Material::prepare_with`] makes a mixture; the default is what [`Material::prepare`] does.
///
/// ```
/// # #[cfg(feature = "std")] {
/// use srbf_core::{LeaveOut, Level, Material, Mixture, PrepareOptions};
///
/// # let bytes = std::fs::read("presets/garnet_red.srbf").or_else(|_| std::fs::read("../presets/garnet_red.srbf")).unwrap();
/// let material = Material::from_bytes(bytes).unwrap();
/// let wo = [-0.6, 0.0, 0.8];
/// let mut mixture = Mixture::<16>::empty();
/// material.prepare(wo, &mut mixture).unwrap();
/// let (exact, lobes) = (mixture.evaluate([0.6, 0.0, 0.8]), mixture.len());
///
/// // Without lobes that carry less than a hundredth, by scalar kernels.
/// let leave_out = LeaveOut::new(0.01, 1e-7).unwrap();
/// let options = PrepareOptions { leave_out, level: Some(Level::Scalar) };
/// material.prepare_with(wo, options, &mut mixture).unwrap();
/// assert!(mixture.len() <= lobes);
/// assert!((mixture.evaluate([0.6, 0.0, 0.8]).x / exact.x - 1.0).abs() < 0.05);
/// # }
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PrepareOptions {
    /// Lobes and folds that matter less than a bound.
    pub leave_out: LeaveOut,
    /// The kernels that prepare, evaluate and draw; `None` for those of [`Level::current`].
    ///
    /// [`Level::Scalar`] is for values that must not depend on the processor.
    pub level: Option<Level>,
}

impl From<LeaveOut> for PrepareOptions {
    fn from(leave_out: LeaveOut) -> Self {
        Self { leave_out, level: None }
    }
}

impl From<Level> for PrepareOptions {
    fn from(level: Level) -> Self {
        Self { leave_out: LeaveOut::default(), level: Some(level) }
    }
}

/// Makes the mixture for an outgoing direction, with the kernels of a level that is available.
#[inline(always)]
pub(crate) fn prepare<'m>(
    material: MaterialRef<'m>,
    wo: Vec3,
    leave_out: LeaveOut,
    level: Level,
    mixture: &mut AnyMixture<'m>,
) -> Result<(), Error> {
    #[cfg(feature = "simd")]
    if !material.header.is_isotropic() && level != Level::Scalar {
        return among_rings(material, wo, leave_out, level, mixture);
    }
    level.run_one::<_, Towards>(Prepare { material, leave_out, level, mixture }, wo.to_array())
}

/// What [`Towards`] is given beside the outgoing direction.
struct Prepare<'a, 'b> {
    material: MaterialRef<'b>,
    leave_out: LeaveOut,
    /// The level that it runs on.
    level: Level,
    mixture: &'a mut AnyMixture<'b>,
}

/// The mixture for one outgoing direction.
struct Towards;

impl One<Prepare<'_, '_>> for Towards {
    type Output = Result<(), Error>;
    const IS_WIDE: bool = true;
    #[inline(always)]
    fn run<L: Lanes>(to: Prepare<'_, '_>, numbers: [f32; 3]) -> Result<(), Error> {
        let Prepare { material, leave_out, level, mixture } = to;
        let wo = Vec3::from_array(numbers);
        mixture.begin(level, Domain::Hemisphere, Squeeze::NONE);
        let needed = material.header.lobe_count();
        if needed > mixture.capacity() {
            return Err(Error::Capacity { needed, available: mixture.capacity() });
        }
        let Some(outgoing) = facing::<L>(wo) else { return Err(Error::Direction) };
        if wo.z < 0.0 {
            return Ok(());
        }
        if L::FUSED && needed <= WIDEST {
            interpolate::<L, true>(material, outgoing, leave_out, mixture);
        } else {
            interpolate::<L, false>(material, outgoing, leave_out, mixture);
        }
        mixture.sum_up();
        Ok(())
    }
}

/// Makes a mixture, which has begun, for an outgoing direction above the horizon; it is to be summed up. `FEW`: of one group of lobes.
#[inline(always)]
fn interpolate<'m, L: Lanes, const FEW: bool>(
    material: MaterialRef<'m>,
    outgoing: Outgoing,
    leave_out: LeaveOut,
    mixture: &mut AnyMixture<'m>,
) {
    match material.header.kind {
        Kind::Line => {
            let passed = views_passed::<L>(material, outgoing.theta);
            between_views::<L, FEW>(material, outgoing, passed, leave_out, mixture);
        }
        // With vectors `among_rings` makes it.
        Kind::Grid(shape) if L::COUNT == 1 => {
            let among = prepare_anisotropic::prepare::<L>(material, shape, &outgoing, leave_out, mixture);
            if material.header.has_factors() {
                mixture.head.factors = Factors::new(material, outgoing.wo, among);
            }
        }
        Kind::Grid(_) => {}
    }
}

/// Makes the mixtures for many outgoing directions, with the kernels of a level that is available: as many as
/// directions, all there; a direction that is none leaves an empty one. They have room for all lobes.
pub(crate) fn prepare_each<'a, 'm>(
    material: MaterialRef<'m>,
    wo: [&'a [f32]; 3],
    level: Level,
    mixtures: &'a mut [Option<&'a mut AnyMixture<'m>>],
) {
    if material.header.is_isotropic() && level != Level::Scalar {
        level.run_vectors(PrepareInto { material, wo, level, mixtures });
        return;
    }
    #[cfg(feature = "simd")]
    if level != Level::Scalar {
        each_among_rings(material, wo, level, mixtures);
        return;
    }
    for (i, mixture) in mixtures.iter_mut().flatten().enumerate() {
        let wo = Vec3::new(wo[0][i], wo[1][i], wo[2][i]);
        // A vector that is no direction leaves the mixture empty.
        let _ = prepare(material, wo, LeaveOut::default(), level, mixture);
    }
}

/// Mixtures for many outgoing directions, of an isotropic material: lanes are directions for their angles and
/// azimuths, lobes for the rest.
struct PrepareInto<'a, 'b> {
    material: MaterialRef<'b>,
    wo: [&'a [f32]; 3],
    /// The level that it runs on.
    level: Level,
    mixtures: &'a mut [Option<&'a mut AnyMixture<'b>>],
}

impl Routine for PrepareInto<'_, '_> {
    type Output = ();
    #[inline(always)]
    #[allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices
    fn run<L: Lanes>(self) {
        let Self { material, wo: [x, y, z], level, mixtures } = self;
        let mut at = 0;
        while at < mixtures.len() {
            let count = L::COUNT.min(mixtures.len() - at);
            let facing = Facing::<L>::new([
                load_some(&x[at..], count),
                load_some(&y[at..], count),
                load_some(&z[at..], count),
            ]);
            let (mut theta, mut azimuth, mut passed) =
                ([0.0; WIDEST_PAIR], [[0.0; WIDEST_PAIR]; 2], [0.0; WIDEST_PAIR]);
            views_passed_by_each(material, facing.theta).store(&mut passed);
            facing.theta.store(&mut theta);
            facing.azimuth[0].store(&mut azimuth[0]);
            facing.azimuth[1].store(&mut azimuth[1]);
            for i in 0..count {
                let Some(mixture) = mixtures[at + i].as_deref_mut() else { continue };
                mixture.begin(level, Domain::Hemisphere, Squeeze::NONE);
                if L::bits(facing.is_there()) >> i & 1 == 1 {
                    let wo = Vec3::new(x[at + i], y[at + i], z[at + i]);
                    let outgoing = Outgoing { wo, theta: theta[i], azimuth: [azimuth[0][i], azimuth[1][i]] };
                    let (passed, leave_out) = (passed[i] as usize, LeaveOut::default());
                    if L::FUSED && material.header.lobe_count() <= WIDEST {
                        between_views::<L, true>(material, outgoing, passed, leave_out, mixture);
                    } else {
                        between_views::<L, false>(material, outgoing, passed, leave_out, mixture);
                    }
                }
            }
            // Apart, so that the chains of additions of many mixtures run side by side.
            for mixture in mixtures[at..at + count].iter_mut().flatten() {
                mixture.sum_up();
            }
            at += L::COUNT;
        }
    }
}

/// Makes a mixture, which has begun, for an outgoing direction above the horizon that has `passed` a number of views of an
/// isotropic material; it is to be summed up.
#[inline(always)]
fn between_views<'m, L: Lanes, const FEW: bool>(
    material: MaterialRef<'m>,
    outgoing: Outgoing,
    passed: usize,
    leave_out: LeaveOut,
    mixture: &mut AnyMixture<'m>,
) {
    let place = Place::after(material, passed, outgoing.theta);
    at_place::<L, FEW>(material, outgoing.azimuth, place, leave_out, mixture);
    if material.header.has_factors() {
        mixture.head.factors = Factors::new(material, outgoing.wo, place.among());
    }
}

/// Makes the mixture for an outgoing direction, of an anisotropic material.
#[cfg(feature = "simd")]
#[inline(never)]
fn among_rings<'m>(
    material: MaterialRef<'m>,
    wo: Vec3,
    leave_out: LeaveOut,
    level: Level,
    mixture: &mut AnyMixture<'m>,
) -> Result<(), Error> {
    mixture.begin(level, Domain::Hemisphere, Squeeze::NONE);
    let needed = material.header.lobe_count();
    if needed > mixture.capacity() {
        return Err(Error::Capacity { needed, available: mixture.capacity() });
    }
    let frame = Frame::of_one(material, wo, level, &mut mixture.groups);
    if !frame.is_unit {
        return Err(Error::Direction);
    }
    if frame.is_there {
        complete(material, &frame, wo, leave_out, mixture);
    }
    Ok(())
}

/// Makes the mixtures for at most [`WIDEST`] outgoing directions, of an anisotropic material.
#[cfg(feature = "simd")]
fn each_among_rings<'a, 'm>(
    material: MaterialRef<'m>,
    wo: [&'a [f32]; 3],
    level: Level,
    mixtures: &'a mut [Option<&'a mut AnyMixture<'m>>],
) {
    let (mut directions, mut frames) = ([[0.5; WIDEST]; 3], [Frame::NONE; WIDEST]);
    let count = mixtures.len().min(WIDEST);
    for (to, from) in directions.iter_mut().zip(wo) {
        to[..count].copy_from_slice(&from[..count]);
    }
    let mut groups = mixtures.iter_mut().flatten().map(|mixture| -> &mut [Group] {
        mixture.begin(level, Domain::Hemisphere, Squeeze::NONE);
        &mut mixture.groups
    });
    let (materials, frames, groups) = (&[material; WIDEST][..count], &mut frames[..count], &mut groups);
    let numbers = directions.each_ref().map(|numbers| &numbers[..]);
    level.run_vectors(FillRings { materials, wo: numbers, frames, groups });
    for (i, (mixture, frame)) in mixtures.iter_mut().flatten().zip(frames).enumerate() {
        if frame.is_there {
            let wo = Vec3::new(wo[0][i], wo[1][i], wo[2][i]);
            complete(material, frame, wo, LeaveOut::default(), mixture);
        }
    }
}

/// Completes a mixture that has begun and has the lobes of a frame.
#[cfg(feature = "simd")]
fn complete<'m>(
    material: MaterialRef<'m>,
    frame: &Frame,
    wo: Vec3,
    leave_out: LeaveOut,
    mixture: &mut AnyMixture<'m>,
) {
    mixture.head.in_plane = false;
    mixture.head.squeeze = Squeeze::new(frame.azimuth, frame.stretch[0], frame.stretch[1]);
    mixture.set_diffuse(frame.diffuse);
    let header = material.header;
    let (count, squeezed) = (header.lobes, header.squeezed);
    mixture.head.level.run_vectors(Finish { count, squeezed, leave_out, mixture });
    mixture.sum_up();
    if header.has_factors() {
        mixture.head.factors = Factors::new(material, wo, frame.among);
    }
}

/// What every lobe needs.
#[cfg(feature = "simd")]
struct Finish<'a, 'm> {
    count: usize,
    squeezed: usize,
    leave_out: LeaveOut,
    mixture: &'a mut AnyMixture<'m>,
}

#[cfg(feature = "simd")]
impl Routine for Finish<'_, '_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        self.mixture.finish_lobes::<L::Lobes, false>(self.count, self.squeezed, self.leave_out);
    }
}

/// The first `count` numbers of a slice, and zeros.
#[inline(always)]
fn load_some<L: Lanes>(from: &[f32], count: usize) -> L {
    if count == L::COUNT {
        return L::load(from);
    }
    let mut padded = [0.0; WIDEST_PAIR];
    padded[..count].copy_from_slice(&from[..count]);
    L::load(&padded)
}
