//! Light from a map, and light and material sampled together.
#![allow(unsafe_code)]

use crate::arguments::Argument;
use crate::convert::{direction, uniform};
use crate::guard::{Failure, Named, Outcome, guard};
use crate::pointers::{Out, check, check_apart, check_extent, read, read_array, slice};
use crate::status::{
    SRBF_STATUS_ARGUMENT, SRBF_STATUS_DIRECTION, SRBF_STATUS_MISALIGNED, SRBF_STATUS_OBJECT,
    SRBF_STATUS_SIZE, SRBF_STATUS_UNIFORM, srbf_status,
};
use crate::storage::mixture;
use crate::storage::srbf_mixture;
use core::ops::Range;
use core::ptr::NonNull;
use srbf_core::{Environment, LightRows, LightSource, ProductSample, ProductSampling, Vec3, environment_len};

/// Alignment of the storage for an environment: that of a cache line.
pub const SRBF_ENVIRONMENT_ALIGNMENT: usize = 64;
/// Bytes of storage for an environment whose table lies elsewhere, see `srbf_environment_read`.
pub const SRBF_ENVIRONMENT_HEAD_SIZE: usize = 64;
/// Most candidates of `srbf_mixture_sample_product`.
pub const SRBF_PRODUCT_MAX_CANDIDATES: usize = 32;

/// Light from infinitely far away, a latitude-longitude map, in the caller's storage.
///
/// Row 0 of the map looks up, along +z. The centre of the map looks along +x. To the right in the map is to the right for an
/// observer inside, towards -y. Between the centres of pixels the radiance is interpolated; directions are drawn by its luminance.
///
/// It never changes, so any number of threads may use one at once. It needs no release. Its bytes may not be moved.
pub struct srbf_environment {
    tag: u32,
    pub(crate) environment: Environment<Words>,
}

/// Where the table of an environment lies: memory of the caller, which lives as long as the header says.
pub(crate) struct Words {
    first: NonNull<u32>,
    count: usize,
}

impl AsRef<[u32]> for Words {
    #[inline(always)]
    fn as_ref(&self) -> &[u32] {
        // SAFETY: the numbers were initialised when this was made; the caller keeps them, by the header's contract.
        unsafe { core::slice::from_raw_parts(self.first.as_ptr(), self.count) }
    }
}

impl AsMut<[u32]> for Words {
    fn as_mut(&mut self) -> &mut [u32] {
        // SAFETY: only called while the environment is made, in storage that is nobody else's then, by the header's contract.
        unsafe { core::slice::from_raw_parts_mut(self.first.as_ptr(), self.count) }
    }
}

/// An environment as a light, which is looked up and drawn from as the map that it is, and never by the two verbs.
pub(crate) struct Map<'a>(pub(crate) &'a srbf_environment);

impl LightSource for Map<'_> {
    fn sample_into(&self, _: [&[f32]; 3], _: &mut LightRows) {}

    fn evaluate_into(&self, _: usize, _: &mut LightRows) {}

    fn environment(&self) -> Option<Environment<&[u32]>> {
        self.0.environment.environment()
    }
}

/// What stands at the start of every environment that this library made.
const TAG: u32 = 0x4d1b_90e7;

const _: () = assert!(size_of::<srbf_environment>() <= SRBF_ENVIRONMENT_HEAD_SIZE);

/// What an environment holds.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_environment_info {
    /// The bytes that `srbf_environment_read` reads, for the caller to store: within the environment's storage, at a multiple of
    /// 64.
    pub table: *const core::ffi::c_void,
    /// How many there are.
    pub table_size: usize,
    /// The integral of the luminance over the sphere: the luminance of every sample's radiance over its density.
    pub power: f32,
}

/// A direction drawn from an environment.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_light_sample {
    /// Unit vector in the world, towards the light.
    pub direction: [f32; 3],
    /// Density at the direction; 1/sr.
    pub pdf: f32,
    /// Radiance from there, linear sRGB.
    pub radiance: [f32; 3],
}

/// How light and material are sampled together.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_product_sampling {
    /// Candidates of a draw, 2 to 32. Variance falls with them where nothing is occluded, and time grows: 32 take about twice the
    /// time of 8.
    pub candidates: u32,
    /// The share of them that is drawn from the lobes, in [0, 1], rounded to whole candidates; 0.5 serves well. Where it rounds to
    /// none or to all, one of the two is never drawn from, and a weight has no bound. A sharp highlight may lie away from the
    /// light, or a small sun away from the highlight. The mean of tens of thousands of draws may then be half of the integral.
    pub lobe_share: f32,
    /// At least 1e-3: infinite where the candidates are to give all of the light; 4 serves well where the light along the path's
    /// own ray counts too, weighed by `srbf_product_ray_weight`.
    pub kappa: f32,
}

/// A direction drawn for light and material together.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_product_sample {
    /// Unit vector in the world, towards the light: where the shadow ray goes.
    pub direction: [f32; 3],
    /// The light that is reflected to the viewer if nothing is in the way, linear sRGB; all 0: nothing was drawn.
    pub weight: [f32; 3],
    /// `f cos` over the density of such a draw: the factor on the true radiance from there, where the light's is an estimate.
    pub factor: [f32; 3],
}

impl srbf_product_sampling {
    fn to_core(self) -> Result<ProductSampling, Failure> {
        let candidates = usize::try_from(self.candidates).unwrap_or(usize::MAX);
        Ok(ProductSampling::new(candidates, self.lobe_share, self.kappa)?)
    }
}

/// Borrows an environment of the caller.
///
/// # Safety
/// The header's contract: a pointer that is not NULL points to an environment.
#[inline(always)]
pub(crate) unsafe fn object<'a>(
    environment: *const srbf_environment,
) -> Result<&'a srbf_environment, Failure> {
    check(environment).of(Argument::Environment)?;
    // SAFETY: not NULL and aligned; readable by the contract. The tag is looked at through the pointer, before there is a
    // reference to a whole that may not be one.
    if unsafe { (&raw const (*environment).tag).read() } != TAG {
        return Err(SRBF_STATUS_OBJECT).of(Argument::Environment);
    }
    // SAFETY: the tag says that this library wrote one here; it never changes.
    Ok(unsafe { &*environment })
}

/// The bytes of an environment; `None` if there are more than an object may have.
fn size_of_map(width: usize, height: usize) -> Result<usize, Failure> {
    let words = environment_len(width, height)?;
    let bytes = words.checked_mul(4).and_then(|bytes| bytes.checked_add(SRBF_ENVIRONMENT_HEAD_SIZE));
    bytes.filter(|&bytes| isize::try_from(bytes).is_ok()).ok_or(SRBF_STATUS_SIZE.into())
}

/// Checks the storage of an environment before anything is written; the place and its bytes.
fn place(
    storage: *mut core::ffi::c_void,
    storage_size: usize,
    size: usize,
) -> Result<(*mut srbf_environment, Range<usize>), Failure> {
    let place = storage.cast::<srbf_environment>();
    check(place).of(Argument::Storage)?;
    if !place.addr().is_multiple_of(SRBF_ENVIRONMENT_ALIGNMENT) {
        return Err(SRBF_STATUS_MISALIGNED).of(Argument::Storage);
    }
    check_extent(place.addr(), storage_size, 1).of(Argument::StorageSize)?;
    if storage_size < size {
        return Err(SRBF_STATUS_SIZE).of(Argument::StorageSize);
    }
    Ok((place, place.addr()..place.addr() + size))
}

/// Says how many bytes of storage the environment of a map needs: 64 a pixel, those of one row more, and a little.
///
/// Status: `SRBF_STATUS_ARGUMENT` for a size that no map may have: width or height 0 or above 65535, or more than 2^25 pixels;
/// `SRBF_STATUS_SIZE` if the bytes are more than the address space has.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_environment_size(width: usize, height: usize, size: *mut usize) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let out = unsafe { Out::new(size).of(Argument::Size)? };
        out.set(size_of_map(width, height)?);
        Ok(())
    })
}

/// Makes an environment of a map of radiance in the caller's storage; takes about 0.1 us a pixel.
///
/// Shapes: `radiance` [height][width][3], linear sRGB, the top row first, each number in [0, 1e30]; `turn` the angle that the map
/// is turned by round +z, anticlockwise seen from above, radians; `storage` [storage_size], at least what `srbf_environment_size`
/// says, aligned to `SRBF_ENVIRONMENT_ALIGNMENT`; `environment` one pointer, which is set to the storage. None may overlap another.
/// Status: `SRBF_STATUS_ARGUMENT` for a size that no map may have, a number out of range, NaN too, or a map that is black all over.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_environment_make(
    width: usize,
    height: usize,
    radiance: *const f32,
    turn: f32,
    storage: *mut core::ffi::c_void,
    storage_size: usize,
    environment: *mut *mut srbf_environment,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let out = unsafe { Out::new(environment).of(Argument::Environment)? };
        let size = size_of_map(width, height)?;
        let turn = angle(turn)?;
        let (place, written) = place(storage, storage_size, size)?;
        // SAFETY: the header's contract; three numbers are aligned as one is.
        let map: &[[f32; 3]] = unsafe { slice(radiance.cast(), width * height).of(Argument::Radiance)? };
        let from = map.as_ptr().addr();
        for other in [from..from + size_of_val(map), out.extent()] {
            check_apart(&written, &other)?;
        }
        let count = environment_len(width, height)?;
        let first = place.wrapping_byte_add(SRBF_ENVIRONMENT_HEAD_SIZE).cast::<u32>();
        let first = NonNull::new(first).ok_or(SRBF_STATUS_SIZE)?;
        // SAFETY: within the storage, aligned as it is; writable by the header's contract.
        unsafe { first.write_bytes(0, count) };
        let environment = Environment::new(width, map, Words { first, count })?.turned(turn);
        // SAFETY: not NULL, aligned and large enough; writable by the header's contract.
        unsafe { place.write(srbf_environment { tag: TAG, environment }) };
        out.set(place);
        Ok(())
    })
}

/// Refuses a number that is no angle.
fn angle(radians: f32) -> Result<f32, Failure> {
    if radians.is_finite() { Ok(radians) } else { Err(SRBF_STATUS_ARGUMENT.into()) }
}

/// Says what an environment holds.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_environment_query(
    environment: *const srbf_environment,
    info: *mut srbf_environment_info,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (object, out) = unsafe { (object(environment)?, Out::new(info).of(Argument::Info)?) };
        let words = object.environment.table();
        out.set(srbf_environment_info {
            table: words.as_ptr().cast(),
            table_size: size_of_val(words),
            power: object.environment.power(),
        });
        Ok(())
    })
}

/// Takes a table that `srbf_environment_query` gave, on a processor of the same byte order, after checking it once. Nothing is
/// copied: the table must live, and stay as it is, for as long as the environment is used.
///
/// Shapes: `table` [table_size] bytes, aligned to 4; 64 is the fastest; `turn` as in `srbf_environment_make`; `storage`
/// [storage_size], at least `SRBF_ENVIRONMENT_HEAD_SIZE`, aligned to `SRBF_ENVIRONMENT_ALIGNMENT`; `environment` one pointer,
/// which is set to the storage. Status: `SRBF_STATUS_OBJECT` for a table that is none, or damaged.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_environment_read(
    table: *const core::ffi::c_void,
    table_size: usize,
    turn: f32,
    storage: *mut core::ffi::c_void,
    storage_size: usize,
    environment: *mut *mut srbf_environment,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let out = unsafe { Out::new(environment).of(Argument::Environment)? };
        let turn = angle(turn)?;
        let (place, written) = place(storage, storage_size, SRBF_ENVIRONMENT_HEAD_SIZE)?;
        if !table_size.is_multiple_of(4) {
            return Err(SRBF_STATUS_OBJECT).of(Argument::Environment);
        }
        // SAFETY: the header's contract.
        let words: &[u32] = unsafe { slice(table.cast(), table_size / 4).of(Argument::Table)? };
        for other in [words.as_ptr().addr()..words.as_ptr().addr() + table_size, out.extent()] {
            check_apart(&written, &other)?;
        }
        let words = Words { first: NonNull::from(words).cast(), count: words.len() };
        let environment = Environment::from_table(words)?.turned(turn);
        // SAFETY: not NULL, aligned and large enough; writable by the header's contract.
        unsafe { place.write(srbf_environment { tag: TAG, environment }) };
        out.set(place);
        Ok(())
    })
}

/// Looks up the radiance from a direction, and the density of `srbf_environment_sample` towards it; 1/sr.
///
/// Shapes: `direction` [3], unit vector in the world; `radiance` [3], linear sRGB, and `pdf`, one number, overwritten; NULL for
/// one that is not wanted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_environment_evaluate(
    environment: *const srbf_environment,
    direction: *const f32,
    radiance: *mut f32,
    pdf: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (object, d) = unsafe { (object(environment)?, read_array(direction).of(Argument::Direction)?) };
        // SAFETY: the header's contract.
        let to_radiance =
            (!radiance.is_null()).then(|| unsafe { Out::<[f32; 3]>::array(radiance) }).transpose()?;
        // SAFETY: the header's contract.
        let to_pdf = (!pdf.is_null()).then(|| unsafe { Out::new(pdf) }).transpose()?;
        let direction = self::direction(d).of(Argument::Direction)?;
        match (to_radiance, to_pdf) {
            (Some(radiance), Some(pdf)) => {
                check_apart(&radiance.extent(), &pdf.extent())?;
                let (color, density) = object.environment.radiance_and_pdf(direction);
                radiance.set(color.to_array());
                pdf.set(density);
            }
            (Some(radiance), None) => radiance.set(object.environment.radiance(direction).to_array()),
            (None, Some(pdf)) => pdf.set(object.environment.pdf(direction)),
            (None, None) => {}
        }
        Ok(())
    })
}

/// Draws a direction by the luminance of its radiance.
///
/// Shapes: `u` [3], uniform numbers in [0, 1), of which all digits count; `sample` one, overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_environment_sample(
    environment: *const srbf_environment,
    u: *const f32,
    sample: *mut srbf_light_sample,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (object, u, out) = unsafe {
            (object(environment)?, read_array(u).of(Argument::U)?, Out::new(sample).of(Argument::Sample)?)
        };
        let drawn = object.environment.sample(uniform(u).of(Argument::U)?);
        out.set(srbf_light_sample {
            direction: drawn.direction.to_array(),
            pdf: drawn.pdf,
            radiance: drawn.radiance.to_array(),
        });
        Ok(())
    })
}

/// Draws a direction for the light of an environment and a mixture together: direct light by one shadow ray.
///
/// The mean of `weight` over all draws is the integral of radiance times `f cos`, times one minus `srbf_product_ray_weight`.
/// Without occlusion its variance is that of multiple importance sampling with as many directions as there are candidates.
/// Shapes: `frame` [9], tangent, bitangent and normal of the shading frame in the world, unit vectors at right angles; `u`
/// [3][candidates], uniform numbers in [0, 1): the first of all candidates, then the second, then the third; `choice` one more;
/// `sample` one, overwritten, with the normal, weight and factor 0 where no candidate brings light.
/// Status: `SRBF_STATUS_ARGUMENT` for a `sampling` out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_sample_product(
    mixture: *const srbf_mixture,
    environment: *const srbf_environment,
    frame: *const f32,
    sampling: *const srbf_product_sampling,
    u: *const f32,
    choice: f32,
    sample: *mut srbf_product_sample,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        unsafe {
            let light = Map(object(environment)?);
            sample_product(mixture, &light, frame, sampling, u, choice, sample)
        }
    })
}

/// Draws for light and a mixture together.
///
/// # Safety
/// The header's contract of [`srbf_mixture_sample_product`].
pub(crate) unsafe fn sample_product(
    mixture: *const srbf_mixture,
    light: &dyn LightSource,
    frame: *const f32,
    sampling: *const srbf_product_sampling,
    u: *const f32,
    choice: f32,
    sample: *mut srbf_product_sample,
) -> Outcome {
    // SAFETY: the header's contract.
    let (mixture, frame, sampling, out) = unsafe {
        (
            self::mixture(mixture)?,
            read_array::<9>(frame).of(Argument::Frame)?,
            read(sampling).of(Argument::Sampling)?,
            Out::new(sample).of(Argument::Sample)?,
        )
    };
    let sampling = sampling.to_core()?;
    let frame = axes(frame)?;
    let [choice] = uniform([choice]).of(Argument::Choice)?;
    let n = sampling.candidates();
    // SAFETY: the header's contract.
    let u = unsafe { slice(u, 3 * n).of(Argument::U)? };
    if !u.iter().all(|u| (0.0..1.0).contains(u)) {
        return Err(SRBF_STATUS_UNIFORM.into());
    }
    let (first, rest) = u.split_at(n);
    let (second, third) = rest.split_at(n);
    let drawn = mixture.sample_product(&light, &frame, &sampling, [first, second, third], choice)?;
    let none = ProductSample { direction: frame[2], weight: Vec3::ZERO, factor: Vec3::ZERO };
    let ProductSample { direction, weight, factor } = drawn.unwrap_or(none);
    let [direction, weight, factor] = [direction, weight, factor].map(|v| v.to_array());
    out.set(srbf_product_sample { direction, weight, factor });
    Ok(())
}

/// Refuses vectors that are not three unit vectors at right angles, to 1e-3.
pub(crate) fn axes([a, b, c, d, e, f, g, h, i]: [f32; 9]) -> Result<[Vec3; 3], Failure> {
    let [x, y, z] = [direction([a, b, c])?, direction([d, e, f])?, direction([g, h, i])?];
    if [x.dot(y), y.dot(z), z.dot(x)].into_iter().all(|cosine| cosine.abs() <= 1e-3) {
        Ok([x, y, z])
    } else {
        Err(SRBF_STATUS_DIRECTION.into())
    }
}

/// Gives the factor on the light that a path meets along its own ray. The path drew the ray from its mixture with density `pdf`;
/// the environment has the density `environment_pdf` there.
///
/// Shapes: `weight` one number in [0, 1], overwritten, whatever the densities are: 0 for an infinite kappa; a density that is
/// negative or NaN counts as 0, an infinite one as the largest number. Status: `SRBF_STATUS_ARGUMENT` for a `sampling` out of
/// range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_product_ray_weight(
    sampling: *const srbf_product_sampling,
    pdf: f32,
    environment_pdf: f32,
    weight: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (sampling, out) =
            unsafe { (read(sampling).of(Argument::Sampling)?, Out::new(weight).of(Argument::Weight)?) };
        out.set(sampling.to_core()?.ray_weight(pdf, environment_pdf));
        Ok(())
    })
}
