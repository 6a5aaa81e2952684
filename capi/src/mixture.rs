//! Mixtures: made in the caller's storage, of lobes or by a material, and queried.
#![allow(unsafe_code)]

use crate::arguments::Argument;
use crate::guard::{Named, guard};
use crate::lobe::srbf_lobe;
use crate::pointers::{Out, check_apart, read_array, slice};
use crate::status::{SRBF_STATUS_ARGUMENT, SRBF_STATUS_INDEX, srbf_status};
use crate::storage::{SRBF_MIXTURE_SIZE_64, srbf_mixture};
use crate::storage::{check_room, check_storage, init_at, mixture, mixture_mut, size_for};
use srbf_core::{AnyMixture, Domain, Lobe, MAX_LOBES, Mixture, Vec3};

/// The whole sphere: no fold.
pub const SRBF_DOMAIN_SPHERE: u32 = 0;
/// The upper hemisphere: the part of a lobe below the horizon is mirrored back up.
pub const SRBF_DOMAIN_HEMISPHERE: u32 = 1;

/// Properties of a mixture.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_mixture_info {
    /// Number of lobes.
    pub lobes: usize,
    /// Number of lobes that see the squeezed direction; they come first.
    pub squeezed_lobes: usize,
    /// Most lobes that the storage has room for.
    pub capacity: usize,
    /// `SRBF_DOMAIN_SPHERE` or `SRBF_DOMAIN_HEMISPHERE`.
    pub domain: u32,
    /// The SIMD level that the mixture was made at.
    pub simd_level: u32,
    /// The squeeze c; 1 is no squeeze.
    pub squeeze: f32,
    /// Albedo of the diffuse term, `diffuse cos / pi` beside the lobes, linear sRGB.
    pub diffuse: [f32; 3],
    /// Integral of `f cos` over the domain, linear sRGB: for a material's mixture, the albedo. With factors, which
    /// leave it no closed form, a material stores for its views by how much they change it, and that is interpolated.
    pub albedo: [f32; 3],
    /// Luminance of the integral of lobes and diffuse term: what densities are normalised by, and the luminance of the weight of
    /// every sample. In a material with factors the latter is multiplied by its factor.
    pub power: f32,
}

/// Returns the bytes of storage that a mixture of this number of lobes needs; 0 if there is no such mixture (more than 64).
#[unsafe(no_mangle)]
pub extern "C" fn srbf_mixture_size(lobes: usize) -> usize {
    size_for(lobes).unwrap_or(0)
}

/// Makes an empty mixture in the caller's storage, with room for as many lobes as fit: 16, 32 or 64.
///
/// Shapes: `storage` [storage_size], at least `SRBF_MIXTURE_SIZE_16`, aligned to `SRBF_MIXTURE_ALIGNMENT`; `mixture`
/// one pointer outside the storage, which is set to the same address. It needs no release.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_init(
    storage: *mut core::ffi::c_void,
    storage_size: usize,
    mixture: *mut *mut srbf_mixture,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let out = unsafe { Out::new(mixture).of(Argument::Mixture)? };
        check_storage(storage.cast())?;
        let start = storage.addr();
        check_apart(&out.extent(), &(start..start.saturating_add(storage_size.min(SRBF_MIXTURE_SIZE_64))))?;
        // SAFETY: the header's contract.
        out.set(unsafe { init_at(storage.cast(), storage_size)? });
        Ok(())
    })
}

/// Makes a mixture of the caller's lobes, in a mixture that has been initialised; overwrites it.
///
/// The first `squeezed_lobes` see the direction squeezed along y by c = `squeeze` in [0.01, 2]; give 0 and 1 for round
/// lobes alone.
/// Shapes: `lobes` [lobe_count]; `diffuse` [3], the albedo of a diffuse term on the hemisphere, or NULL.
/// Status: `SRBF_STATUS_CAPACITY`; the status of a lobe that is refused; `SRBF_STATUS_AMPLITUDE` also if integral or value could
/// be infinite, and for a diffuse term on `SRBF_DOMAIN_SPHERE`. On failure the mixture stays as it was.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_from_lobes(
    domain: u32,
    squeeze: f32,
    squeezed_lobes: usize,
    lobe_count: usize,
    lobes: *const srbf_lobe,
    diffuse: *const f32,
    mixture: *mut srbf_mixture,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let mixture = unsafe { mixture_mut(mixture)? };
        let domain = match domain {
            SRBF_DOMAIN_SPHERE => Domain::Sphere,
            SRBF_DOMAIN_HEMISPHERE => Domain::Hemisphere,
            _ => return Err(SRBF_STATUS_ARGUMENT.into()),
        };
        check_room(lobe_count, MAX_LOBES)?;
        if squeezed_lobes > lobe_count {
            return Err(SRBF_STATUS_ARGUMENT.into());
        }
        // SAFETY: the header's contract.
        let given = unsafe { slice(lobes, lobe_count).of(Argument::Lobes)? };
        let mut lobes = [Lobe::new(Vec3::Z, 0.0, Vec3::ZERO)?; MAX_LOBES];
        for (lobe, given) in lobes.iter_mut().zip(given) {
            *lobe = given.to_core()?;
        }
        let (squeezed, round) = lobes[..lobe_count].split_at(squeezed_lobes);
        // SAFETY: the header's contract.
        let diffuse = if diffuse.is_null() {
            None
        } else {
            // SAFETY: the header's contract.
            Some(unsafe { read_array(diffuse).of(Argument::Diffuse)? })
        };
        check_room(lobe_count, mixture.capacity())?;
        let mut made = Mixture::<MAX_LOBES>::new(domain, squeeze, squeezed, round)?;
        if let Some(albedo) = diffuse {
            made = made.with_diffuse(Vec3::from_array(albedo))?;
        }
        mixture.copy_from(&made)?;
        Ok(())
    })
}

/// Gives the properties of a mixture, its closed-form integral included.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_query(
    mixture: *const srbf_mixture,
    info: *mut srbf_mixture_info,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (mixture, out) = unsafe { (self::mixture(mixture)?, Out::new(info).of(Argument::Info)?) };
        out.set(describe(mixture));
        Ok(())
    })
}

fn describe(mixture: &AnyMixture<'_>) -> srbf_mixture_info {
    srbf_mixture_info {
        lobes: mixture.len(),
        squeezed_lobes: mixture.squeezed_len(),
        capacity: mixture.capacity(),
        domain: match mixture.domain() {
            Domain::Sphere => SRBF_DOMAIN_SPHERE,
            Domain::Hemisphere => SRBF_DOMAIN_HEMISPHERE,
        },
        simd_level: mixture.level() as u32,
        squeeze: mixture.squeeze(),
        diffuse: mixture.diffuse().to_array(),
        albedo: mixture.albedo().to_array(),
        power: mixture.power(),
    }
}

/// Gives lobe `index` of a mixture, in the frame of its view. Status: `SRBF_STATUS_INDEX` past the end.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_lobe(
    mixture: *const srbf_mixture,
    index: usize,
    lobe: *mut srbf_lobe,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (mixture, out) = unsafe { (self::mixture(mixture)?, Out::new(lobe).of(Argument::Lobe)?) };
        out.set(srbf_lobe::from_core(mixture.lobe(index).ok_or(SRBF_STATUS_INDEX)?));
        Ok(())
    })
}
