//! The spectra of a material's colours.
#![allow(unsafe_code)]

use crate::arguments::Argument;
use crate::guard::{Named, guard};
use crate::material::{material, srbf_material};
use crate::pointers::{Out, check, check_apart, check_extent, read_array, slice};
use crate::status::srbf_status;
use core::ops::Range;
use srbf_core::{Primaries, Vec3};

/// The map of a material from its colours to spectra.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_spectrum {
    /// Number of wavelengths that it has; 0 for a material without one, whose spectra are fixed smooth ones.
    pub wavelengths: usize,
    /// The first wavelength in nm; 0 without a map.
    pub first: f32,
    /// The last wavelength in nm; 0 without a map.
    pub last: f32,
    /// Relative L2 distance of the measured spectra from those of their colours; 0 without a map.
    pub error: f32,
    /// 1 if the spectrum is that of a luminance, as of one wavelength; else 0.
    pub is_grey: u32,
}

/// The bytes of `count` elements at an address.
fn extent<T>(pointer: *const T, count: usize) -> Range<usize> {
    pointer.addr()..pointer.addr() + count * size_of::<T>()
}

/// Says which spectra the colours of a material have.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_spectrum(
    material: *const srbf_material,
    spectrum: *mut srbf_spectrum,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (material, out) =
            unsafe { (&self::material(material)?.material, Out::new(spectrum).of(Argument::Spectrum)?) };
        let map = material.spectral_map();
        let nm = |n: usize| map.and_then(|map| map.wavelength(n)).unwrap_or(0.0);
        let count = map.map_or(0, |map| map.len());
        out.set(srbf_spectrum {
            wavelengths: count,
            first: nm(0),
            last: nm(count.saturating_sub(1)),
            error: map.map_or(0.0, |map| map.error()),
            is_grey: u32::from(map.is_some_and(|map| map.is_grey())),
        });
        Ok(())
    })
}

/// Gives the columns of a material at some wavelengths, once for a path; `srbf_primaries_of` takes a colour to values by them.
///
/// Between the material's wavelengths columns are linear, beyond them constant. A material without a map has the smooth primaries of
/// sRGB, which are 1 together. Densities and draws are those of the colours.
/// Shapes: `wavelengths` [count], nm; `primaries` [count][3], overwritten, not where the wavelengths are.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_primaries(
    material: *const srbf_material,
    wavelengths: *const f32,
    count: usize,
    primaries: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (material, wavelengths) =
            unsafe { (self::material(material)?, slice(wavelengths, count).of(Argument::Wavelengths)?) };
        if count == 0 {
            return Ok(());
        }
        check(primaries).of(Argument::Primaries)?;
        check_extent(primaries.addr(), count, size_of::<[f32; 3]>())?;
        check_apart(&extent(primaries.cast::<[f32; 3]>(), count), &extent(wavelengths.as_ptr(), count))?;
        for (n, nm) in wavelengths.iter().enumerate() {
            // SAFETY: within the array, which is writable by the header's contract.
            let out = unsafe { Out::<[f32; 3]>::array(primaries.add(3 * n))? };
            let [column] = *material.material.primaries(&[*nm]).columns();
            out.set(column);
        }
        Ok(())
    })
}

/// Gives the values of a colour at the wavelengths of primaries: of a value, a weight or an albedo. None is below 0.
///
/// Shapes: `primaries` [count][3]; `rgb` [3]; `values` [count], overwritten, not where the primaries are.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_primaries_of(
    primaries: *const f32,
    count: usize,
    rgb: *const f32,
    values: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (columns, rgb) = unsafe {
            (
                slice(primaries.cast::<[f32; 3]>(), count).of(Argument::Primaries)?,
                Vec3::from_array(read_array(rgb).of(Argument::Rgb)?),
            )
        };
        if count == 0 {
            return Ok(());
        }
        check(values).of(Argument::Values)?;
        check_extent(values.addr(), count, size_of::<f32>())?;
        check_apart(&extent(values, count), &extent(columns.as_ptr(), count))?;
        for (n, column) in columns.iter().enumerate() {
            // SAFETY: within the array, which is writable by the header's contract.
            let out = unsafe { Out::new(values.add(n))? };
            out.set(Primaries::from_columns([*column]).of(rgb)[0]);
        }
        Ok(())
    })
}
