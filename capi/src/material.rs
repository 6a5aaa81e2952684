//! Materials: borrowed in the caller's storage, queried, prepared for an outgoing direction.
#![allow(unsafe_code)]

use crate::arguments::Argument;
use crate::convert::direction;
use crate::guard::{Failure, Named, Outcome, guard};
use crate::pointers::{
    Out, bytes_of, check, check_apart, check_extent, put_in_storage, read, read_array, slice,
};
use crate::status::{
    SRBF_STATUS_DIRECTION, SRBF_STATUS_INDEX, SRBF_STATUS_OBJECT, SRBF_STATUS_SIZE, SRBF_STATUS_STRIDE,
    srbf_status,
};
use crate::storage::{SRBF_MIXTURE_ALIGNMENT, srbf_mixture};
use crate::storage::{check_room, mixture_mut, size_for, write_empty};
use crate::streams::{Inputs, srbf_vectors};
use core::ffi::c_char;
use core::ops::Range;
use srbf_core::{AnyMixture, LeaveOut, Material, Mixture, PlaneLobe, PrepareOptions, Vec3};

/// Bytes of storage for a material that `srbf_material_borrow` makes.
pub const SRBF_MATERIAL_SIZE: usize = 128;
/// Alignment of that storage.
pub const SRBF_MATERIAL_ALIGNMENT: usize = 16;

/// A material: the lobes of every view, read in place from `.srbf` bytes.
///
/// It never changes, so any number of threads may use one at once. Made by `srbf_material_borrow` in the caller's
/// storage, or on the heap by `srbf_material_from_bytes` and `srbf_material_load`, which `srbf_material_free` releases.
pub struct srbf_material {
    tag: u32,
    pub(crate) material: Material<Bytes>,
    /// This library put it on the heap, with its bytes.
    #[cfg(feature = "std")]
    pub(crate) is_owned: bool,
}

/// The bytes of a material.
pub(crate) enum Bytes {
    /// The caller's.
    Borrowed(&'static [u8]),
    /// This library's.
    #[cfg(feature = "std")]
    Owned(std::boxed::Box<[u8]>),
}

impl AsRef<[u8]> for Bytes {
    #[inline(always)]
    fn as_ref(&self) -> &[u8] {
        match self {
            Self::Borrowed(bytes) => bytes,
            #[cfg(feature = "std")]
            Self::Owned(bytes) => bytes,
        }
    }
}

/// What stands at the start of every material that this library made, and nothing that it has released.
const TAG: u32 = 0x6a0d_7c53;

const _: () = assert!(
    size_of::<srbf_material>() <= SRBF_MATERIAL_SIZE
        && align_of::<srbf_material>() <= SRBF_MATERIAL_ALIGNMENT
);

impl srbf_material {
    /// Checks the bytes.
    pub(crate) fn new(bytes: Bytes) -> Result<Self, Failure> {
        Ok(Self {
            tag: TAG,
            #[cfg(feature = "std")]
            is_owned: matches!(bytes, Bytes::Owned(_)),
            material: Material::from_bytes(bytes)?,
        })
    }

    /// The bytes that it lies in, and the `.srbf` bytes that it reads.
    pub(crate) fn extents(&self) -> [Range<usize>; 2] {
        let start = core::ptr::from_ref(self).addr();
        [start..start + size_of::<Self>(), bytes_of(self.material.bytes())]
    }

    /// Makes it no material any more.
    #[cfg(feature = "std")]
    pub(crate) fn forget(&mut self) {
        self.tag = 0;
    }
}

/// Borrows a material of the caller.
///
/// # Safety
/// The header's contract: a pointer that is not NULL points to a material.
#[inline(always)]
pub(crate) unsafe fn material<'a>(material: *const srbf_material) -> Result<&'a srbf_material, Failure> {
    check(material).of(Argument::Material)?;
    // SAFETY: not NULL and aligned; readable by the contract. The tag is looked at through the pointer, before there is a
    // reference to a whole that may not be one.
    if unsafe { (&raw const (*material).tag).read() } != TAG {
        return Err(SRBF_STATUS_OBJECT).of(Argument::Material);
    }
    // SAFETY: the tag says that this library wrote a material here; it never changes.
    Ok(unsafe { &*material })
}

/// Properties of a material.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_material_info {
    /// Number of views: outgoing directions at which lobes are stored.
    pub views: usize,
    /// Number of lobes of a mixture, for which it must have room.
    pub lobes: usize,
    /// Number of lobes that see the squeezed direction; they come first.
    pub squeezed_lobes: usize,
    /// Number of stored lobes that stand for two, one on either side of the plane of incidence; they come last. A view stores
    /// `lobes - mirrored_lobes` lobes.
    pub mirrored_lobes: usize,
    /// The `.srbf` bytes; they live as long as the material.
    pub bytes: *const u8,
    /// Number of bytes.
    pub byte_count: usize,
    /// Where the material comes from, as its maker wrote it: UTF-8 without a zero at the end, part of the bytes.
    pub provenance: *const c_char,
    /// Length of the provenance in bytes.
    pub provenance_length: usize,
    /// Nodes of the table of factors along half angle, difference angle and azimuth, see `srbf_material_factor_node`; 0 without
    /// one.
    ///
    /// A mixture of a material with factors reads them from the material: see `srbf_mixture`.
    pub factor_nodes: [usize; 3],
    /// What no factor exceeds but for rounding, the largest of any node and channel; 1 without a table.
    ///
    /// The luminance of a sample's weight is at most the power of its mixture times this, where no channel of a lobe is negative.
    pub largest_factor: f32,
    /// 1 if nodes along the azimuth are from -1 to 1, so that factors are others where the two directions change places; else 0.
    pub has_signed_factors: u32,
}

/// An outgoing direction at which a material stores lobes.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_view {
    /// Angle from the normal in radians, [0, pi/2].
    pub theta: f32,
    /// Base-2 logarithm of the squeeze c: how many times as wide across the plane of incidence as along it.
    pub log2_squeeze: f32,
    /// Base-2 logarithm of the luminance Y of the albedo of the diffuse term, `albedo cos / pi` beside the lobes; -126 for none.
    pub log2_diffuse: f32,
    /// Relative colour differences of that albedo, `(R - Y) / Y` and `(B - Y) / Y`.
    pub diffuse_color_differences: [f32; 2],
}

/// A lobe as a view stores it: its axis in the plane of incidence, or off it if it is a mirrored one.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_plane_lobe {
    /// Angle of the axis from the normal in radians, within the plane of incidence, positive towards the mirror direction.
    pub angle: f32,
    /// Angle of the axis out of the plane of incidence in radians; 0 but for a mirrored lobe.
    pub off_plane: f32,
    /// Base-2 logarithm of the sharpness.
    pub log2_sharpness: f32,
    /// Base-2 logarithm of the luminance Y of the amplitude; -126 for none.
    pub log2_luminance: f32,
    /// Relative colour differences of the amplitude, `(R - Y) / Y` and `(B - Y) / Y`.
    pub color_differences: [f32; 2],
}

/// Makes a material of `.srbf` bytes where they are, of any alignment: nothing is copied, nothing allocated.
///
/// The bytes must stay as they are for as long as the material is used. It needs no release.
/// Shapes: `bytes` [byte_count]; `storage` [storage_size], at least `SRBF_MATERIAL_SIZE`, aligned to
/// `SRBF_MATERIAL_ALIGNMENT`; `material` one pointer, which is set to the storage. None of the three may overlap another.
/// Status: `SRBF_STATUS_MAGIC` to `SRBF_STATUS_FIELD` if the bytes are not a material.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_borrow(
    bytes: *const u8,
    byte_count: usize,
    storage: *mut core::ffi::c_void,
    storage_size: usize,
    material: *mut *mut srbf_material,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (bytes, out) = unsafe {
            (slice(bytes, byte_count).of(Argument::Bytes)?, Out::new(material).of(Argument::Material)?)
        };
        let room = [SRBF_MATERIAL_SIZE, SRBF_MATERIAL_ALIGNMENT];
        // SAFETY: the header's contract: the storage is writable.
        unsafe {
            put_in_storage(bytes, storage.cast(), storage_size, room, &out, || {
                srbf_material::new(Bytes::Borrowed(bytes))
            })
        }
    })
}

/// Gives the properties of a material.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_query(
    material: *const srbf_material,
    info: *mut srbf_material_info,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (material, out) =
            unsafe { (&self::material(material)?.material, Out::new(info).of(Argument::Info)?) };
        let (bytes, provenance) = (material.bytes(), material.provenance());
        out.set(srbf_material_info {
            views: material.view_count(),
            lobes: material.lobe_count(),
            squeezed_lobes: material.squeezed_count(),
            mirrored_lobes: material.mirrored_count(),
            bytes: bytes.as_ptr(),
            byte_count: bytes.len(),
            provenance: provenance.as_ptr().cast(),
            provenance_length: provenance.len(),
            factor_nodes: material.factor_nodes().unwrap_or([0; 3]),
            largest_factor: material.largest_factor(),
            has_signed_factors: u32::from(material.has_signed_factors()),
        });
        Ok(())
    })
}

/// Says at which outgoing direction a view is. Status: `SRBF_STATUS_INDEX` past the end, and for every view of an anisotropic
/// material, which these numbers do not describe.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_view(
    material: *const srbf_material,
    view: usize,
    out: *mut srbf_view,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (material, out) =
            unsafe { (&self::material(material)?.material, Out::new(out).of(Argument::Out)?) };
        let theta = material.view_theta(view).ok_or(SRBF_STATUS_INDEX)?;
        let log2_squeeze = material.view_log2_squeeze(view).ok_or(SRBF_STATUS_INDEX)?;
        let log2_diffuse = material.view_log2_diffuse(view).ok_or(SRBF_STATUS_INDEX)?;
        let diffuse_color_differences =
            material.view_diffuse_color_differences(view).ok_or(SRBF_STATUS_INDEX)?;
        out.set(srbf_view { theta, log2_squeeze, log2_diffuse, diffuse_color_differences });
        Ok(())
    })
}

/// Gives a lobe as a view stores it. Status: `SRBF_STATUS_INDEX` past either end, and for an anisotropic material.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_view_lobe(
    material: *const srbf_material,
    view: usize,
    index: usize,
    lobe: *mut srbf_plane_lobe,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (material, out) =
            unsafe { (&self::material(material)?.material, Out::new(lobe).of(Argument::Lobe)?) };
        let PlaneLobe { angle, off_plane, log2_sharpness, log2_luminance, color_differences } =
            material.view_lobe(view, index).ok_or(SRBF_STATUS_INDEX)?;
        out.set(srbf_plane_lobe { angle, off_plane, log2_sharpness, log2_luminance, color_differences });
        Ok(())
    })
}

/// Integrates `f cos` over all incident directions: how much of the light that goes back along `wo` is reflected.
///
/// Shapes: `wo` [3], unit vector towards the viewer, below the horizon 0; `albedo` [3], linear sRGB, overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_albedo(
    material: *const srbf_material,
    wo: *const f32,
    albedo: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (material, wo, out) = unsafe {
            (
                self::material(material)?,
                read_array(wo).of(Argument::Wo)?,
                Out::<[f32; 3]>::array(albedo).of(Argument::Albedo)?,
            )
        };
        let mut mixture = Mixture::<64>::empty();
        material.material.prepare(direction(wo).of(Argument::Wo)?, &mut mixture)?;
        out.set(mixture.albedo().to_array());
        Ok(())
    })
}

/// Makes the mixture of lobes for an outgoing direction, in a mixture that the caller has initialised; overwrites it.
///
/// The mixture takes and gives directions in the shading frame that `wo` is given in. Below the horizon (z < 0) nothing
/// is reflected: the mixture is empty. Of a material with factors the mixture reads them from the material, which must outlive it.
/// Shapes: `wo` [3], unit vector towards the viewer, +z the surface normal.
/// Status: `SRBF_STATUS_CAPACITY` if the mixture has room for fewer lobes than the material has. On failure the mixture stays as
/// it was.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_prepare(
    material: *const srbf_material,
    wo: *const f32,
    mixture: *mut srbf_mixture,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (material, wo, mixture) =
            unsafe { (self::material(material)?, read_array(wo).of(Argument::Wo)?, mixture_mut(mixture)?) };
        prepare(&material.material, direction(wo).of(Argument::Wo)?, PrepareOptions::default(), mixture)
    })
}

/// `srbf_material_prepare`, leaving out what matters less than a bound: fewer lobes to evaluate, at an error that is bounded.
///
/// Range: shares within [0, 1]. `lobes`: a lobe is dropped if its share of the luminance of the albedo is below this.
/// `folds`: the part of a lobe below the horizon is not mirrored up if it is at most this share of the lobe.
/// `srbf_material_prepare` takes 0 and 1e-7.
/// Shapes: `wo` [3], unit vector towards the viewer, +z the surface normal.
/// Status: `SRBF_STATUS_ARGUMENT` for a share out of range; otherwise as `srbf_material_prepare`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_prepare_leaving_out(
    material: *const srbf_material,
    wo: *const f32,
    lobes: f32,
    folds: f32,
    mixture: *mut srbf_mixture,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (material, wo, mixture) =
            unsafe { (self::material(material)?, read_array(wo).of(Argument::Wo)?, mixture_mut(mixture)?) };
        let leave_out = LeaveOut::new(lobes, folds)?;
        prepare(&material.material, direction(wo).of(Argument::Wo)?, leave_out.into(), mixture)
    })
}

/// Checks the room first, so that a failure leaves the mixture as it was.
#[inline(always)]
fn prepare(
    material: &'static Material<Bytes>,
    wo: Vec3,
    options: PrepareOptions,
    mixture: &mut AnyMixture<'static>,
) -> Outcome {
    check_room(material.lobe_count(), mixture.capacity())?;
    material.prepare_with(wo, options, mixture)?;
    Ok(())
}

/// Makes the mixtures for n outgoing directions, in raw storage; no `srbf_mixture_init` is needed.
///
/// Mixture i is at `(srbf_mixture *)((char *)storage + i * stride)`.
/// Shapes: `wo` n unit vectors; `storage` [n * stride], aligned to `SRBF_MIXTURE_ALIGNMENT`; `stride` a multiple of
/// that, at least `srbf_mixture_size(lobes of the material)`. The storage may overlap neither `wo` nor the material.
/// Status: `SRBF_STATUS_DIRECTION` if some `wo` is not a unit vector: its mixture is empty, the others are made.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_prepare_into(
    material: *const srbf_material,
    n: usize,
    wo: *const srbf_vectors,
    storage: *mut core::ffi::c_void,
    stride: usize,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let material = unsafe { self::material(material)? };
        if n == 0 {
            return Ok(());
        }
        // SAFETY: the header's contract.
        let wo = unsafe { read(wo).of(Argument::Wo)? };
        let storage = storage.cast::<u8>();
        crate::storage::check_storage(storage)?;
        check_extent(storage.addr(), n, stride)?;
        let needed = size_for(material.material.lobe_count()).ok_or(SRBF_STATUS_SIZE)?;
        if stride < needed || !stride.is_multiple_of(SRBF_MIXTURE_ALIGNMENT) {
            return Err(SRBF_STATUS_STRIDE.into());
        }
        let place = storage.addr()..storage.addr() + n * stride;
        // SAFETY: the header's contract.
        let directions = unsafe { Inputs::new(n, wo.streams())? };
        directions.check_outside(&place)?;
        material.extents().iter().try_for_each(|object| check_apart(&place, object))?;
        let (mut first, mut refused) = (0, false);
        directions.run(|wo| {
            let n = wo[0].len();
            refused |= (0..n).any(|i| direction([wo[0][i], wo[1][i], wo[2][i]]).is_err());
            let places = storage.wrapping_add(first * stride);
            first += n;
            // SAFETY: `needed` is at most the stride, so that n places of it lie within the storage, apart from one
            // another and from all that is read; the contract makes it writable.
            unsafe { prepare_many(&material.material, wo, places, needed, stride) }
        })?;
        if refused { Err(SRBF_STATUS_DIRECTION.into()) } else { Ok(()) }
    })
}

/// Mixtures that are prepared in one call.
const BLOCK: usize = 16;

/// # Safety
/// Every `stride` bytes from `places` on, as many times as directions, `size` bytes can be written, and nobody else uses them.
unsafe fn prepare_many(
    material: &'static Material<Bytes>,
    wo: [&[f32]; 3],
    places: *mut u8,
    size: usize,
    stride: usize,
) -> Outcome {
    let n = wo[0].len();
    for from in (0..n).step_by(BLOCK) {
        let count = BLOCK.min(n - from);
        // SAFETY: the caller's word; there is at least one.
        let first = unsafe { write_empty(places.wrapping_add(from * stride), size) };
        let mut mixtures = [first; BLOCK];
        for (i, mixture) in mixtures[..count].iter_mut().enumerate().skip(1) {
            // SAFETY: as above.
            *mixture = unsafe { write_empty(places.wrapping_add((from + i) * stride), size) };
        }
        // SAFETY: a reference has the layout of a pointer; each of the first `count` points to a mixture that has just been
        // written, no two to the same, and nobody else uses them.
        let mixtures: &mut [&mut AnyMixture<'static>] =
            unsafe { core::slice::from_raw_parts_mut(mixtures.as_mut_ptr().cast(), count) };
        material.prepare_into(wo.map(|s| &s[from..from + count]), mixtures)?;
    }
    Ok(())
}
