//! Factors of a material, which multiply the values of its lobes.
#![allow(unsafe_code)]

use crate::arguments::Argument;
use crate::convert::direction;
use crate::guard::{Named, guard};
use crate::material::material;
use crate::material::srbf_material;
use crate::pointers::{Out, read_array};
use crate::status::{SRBF_STATUS_INDEX, srbf_status};

/// Gives the factor of a node. Status: `SRBF_STATUS_INDEX` past any end, and without a table.
///
/// Nodes are evenly spaced from 0 to 1 in `(1 - h.z)^(1/4)`, in `(1 - h.wo)^(1/2)`, and in the squared cosine of an azimuth. It is
/// that of `wi` round `h = (wi + wo) / |wi + wo|`, and the squared cosine is 1 in the plane of incidence. Signed factors have it with
/// the sign of the cosine, from -1 on. Shapes: `factor` [3], linear sRGB, overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_factor_node(
    material: *const srbf_material,
    half: usize,
    difference: usize,
    azimuth: usize,
    factor: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (material, out) =
            unsafe { (self::material(material)?, Out::<[f32; 3]>::array(factor).of(Argument::Factor)?) };
        out.set(material.material.factor_node(half, difference, azimuth).ok_or(SRBF_STATUS_INDEX)?);
        Ok(())
    })
}

/// Evaluates the factor on the value of the lobes for a pair of directions above the horizon; 1 without a table.
///
/// `srbf_mixture_evaluate` and all that gives values or weights has multiplied already; densities and draws are the lobes' alone.
/// Shapes: `wo` and `wi` [3], unit vectors, which may be exchanged unless factors are signed; `factor` [3], linear sRGB, overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_factor(
    material: *const srbf_material,
    wo: *const f32,
    wi: *const f32,
    factor: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (material, wo, wi, out) = unsafe {
            (
                self::material(material)?,
                read_array(wo).of(Argument::Wo)?,
                read_array(wi).of(Argument::Wi)?,
                Out::<[f32; 3]>::array(factor).of(Argument::Factor)?,
            )
        };
        out.set(
            material
                .material
                .factor(direction(wo).of(Argument::Wo)?, direction(wi).of(Argument::Wi)?)
                .to_array(),
        );
        Ok(())
    })
}

/// Gives the change of the albedo of a view by the factors, relative to the luminance of the lobes' own, as it is stored. Status:
/// `SRBF_STATUS_INDEX` past the end, and without a table.
///
/// `srbf_material_albedo` and the `albedo` of `srbf_mixture_info` have it in them.
/// Shapes: `difference` [3], linear sRGB, overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_view_albedo_difference(
    material: *const srbf_material,
    view: usize,
    difference: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (material, out) = unsafe {
            (self::material(material)?, Out::<[f32; 3]>::array(difference).of(Argument::Difference)?)
        };
        out.set(material.material.view_albedo_difference(view).ok_or(SRBF_STATUS_INDEX)?);
        Ok(())
    })
}
