//! Fitting: from a table or a function of the caller to a material, and materials to files.
#![allow(unsafe_code)]

use crate::guard::{Failure, Outcome, guard};
use crate::heap::{own, text};
use crate::material::material;
use crate::pointers::{Out, read};
use crate::streams::{Batch, srbf_vectors};
use crate::{
    SRBF_STATUS_ARGUMENT, SRBF_STATUS_FILE, SRBF_STATUS_NULL, SRBF_STATUS_OTHER, SRBF_STATUS_TABLE,
    srbf_material, srbf_status,
};
use core::ffi::{c_char, c_void};
use srbf_fit::table::evaluable::Brdf;
use srbf_fit::table::{Content, Scattered, Table};
use srbf_fit::{FitError, Settings, fit_content, write_atomically};
use std::boxed::Box;
use std::path::Path;
use std::vec::Vec;

/// The number of squeezed lobes is chosen by what turns out best.
pub const SRBF_FIT_AUTOMATIC: usize = 65;

/// How a material is fitted.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_fit_settings {
    /// Lobes of every view, 1 to 64; more fit better and cost more at run time. Default: 12.
    pub lobes: usize,
    /// How many of them are squeezed, or `SRBF_FIT_AUTOMATIC`, the default.
    pub squeezed_lobes: usize,
    /// Weight of the roughness from view to view: smaller fits the samples better, larger what lies between. Default: 1e-5.
    pub smoothness: f64,
}

/// A BRDF of the caller: writes f (not times the cosine; linear sRGB, 1/sr) for two unit vectors with z > 0.
///
/// `wi`, `wo` and `f` are [3]; `user` is what the caller gave along. It may be called from several threads at once, must
/// return, and what is negative or not finite counts as 0.
pub type srbf_brdf =
    Option<unsafe extern "C" fn(user: *mut c_void, wi: *const f32, wo: *const f32, f: *mut f32)>;

/// Gives the settings that NULL stands for.
#[cfg(feature = "fit")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_fit_settings_default(settings: *mut srbf_fit_settings) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let out = unsafe { Out::new(settings)? };
        let Settings { lobes, smoothness, .. } = Settings::default();
        out.set(srbf_fit_settings { lobes, squeezed_lobes: SRBF_FIT_AUTOMATIC, smoothness });
        Ok(())
    })
}

/// Fits a material to n samples of an isotropic BRDF. Release it with `srbf_material_free`. Takes seconds, on all processors.
///
/// Outgoing directions whose angles from the normal agree within 1e-3 are one view; each needs a few hundred samples.
/// Shapes: `wo` and `wi` n directions above the horizon; `f` n colours, linear sRGB; `settings` one, or NULL;
/// `material` one pointer, overwritten. Status: `SRBF_STATUS_TABLE`, `SRBF_STATUS_ARGUMENT` for a setting, with the reason
/// in `srbf_last_message`.
#[cfg(feature = "fit")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_fit_table(
    settings: *const srbf_fit_settings,
    n: usize,
    wo: *const srbf_vectors,
    wi: *const srbf_vectors,
    f: *const srbf_vectors,
    material: *mut *mut srbf_material,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (settings, out) = unsafe { (self::settings(settings)?, Out::new(material)?) };
        if n == 0 {
            return Err(SRBF_STATUS_TABLE.into());
        }
        // SAFETY: the header's contract.
        let (wo, wi, f) = unsafe { (read(wo)?.streams(), read(wi)?.streams(), read(f)?.streams()) };
        let [[a, b, c], [d, e, g], [h, i, j]] = [wo, wi, f];
        // SAFETY: the header's contract.
        let batch = unsafe { Batch::<9, 0>::new(n, [a, b, c, d, e, g, h, i, j], [], 0..0)? };
        let mut views: Vec<(f64, Scattered)> = Vec::new();
        batch.run(|columns, []| {
            for i in 0..columns[0].len() {
                let [ox, oy, oz, ix, iy, iz, r, g, b] = columns.map(|column| f64::from(column[i]));
                let across = libm::hypot(ox, oy);
                let theta = libm::atan2(across, oz);
                // Into the frame of the view, where wo is (-sin theta, 0, cos theta).
                let [cos, sin] = if across > 0.0 { [-ox / across, -oy / across] } else { [1.0, 0.0] };
                let sample = ([ix * cos + iy * sin, iy * cos - ix * sin, iz], [r, g, b]);
                match views.iter().position(|(other, _)| (*other - theta).abs() < 1e-3) {
                    Some(view) => views[view].1.push(sample),
                    None if views.len() == srbf_fit::table::MAX_VIEWS => {
                        return Err(Failure::new(SRBF_STATUS_TABLE, "too many views"));
                    }
                    None => views.push((theta, [sample].into())),
                }
            }
            Ok(())
        })?;
        fit(&Content::Samples(Table::from_scattered(views)?), &settings, &out)
    })
}

/// Fits a material to an isotropic BRDF that can be evaluated. Release it with `srbf_material_free`.
///
/// Shapes, status and time as in `srbf_fit_table`.
#[cfg(feature = "fit")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_fit_brdf(
    settings: *const srbf_fit_settings,
    brdf: srbf_brdf,
    user: *mut c_void,
    material: *mut *mut srbf_material,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (settings, out) = unsafe { (self::settings(settings)?, Out::new(material)?) };
        let function = brdf.ok_or(SRBF_STATUS_NULL)?;
        fit(&Content::Evaluable(Box::new(Callback { function, user })), &settings, &out)
    })
}

/// Writes a material to a `.srbf` file, whole or not at all.
///
/// `path` is UTF-8 with a zero at the end. Status: `SRBF_STATUS_FILE`, with the reason in `srbf_last_message`.
#[cfg(feature = "fit")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_save(
    material: *const srbf_material,
    path: *const c_char,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (material, path) = unsafe { (self::material(material)?, text(path)?) };
        write_atomically(Path::new(path), material.material.bytes())?;
        Ok(())
    })
}

struct Callback {
    function: unsafe extern "C" fn(*mut c_void, *const f32, *const f32, *mut f32),
    user: *mut c_void,
}

// SAFETY: the header says that the function is called from several threads at once, with `user`.
unsafe impl Send for Callback {}
// SAFETY: as above.
unsafe impl Sync for Callback {}

impl Brdf for Callback {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        let (wi, wo) = (wi.map(|v| v as f32), wo.map(|v| v as f32));
        let mut f = [0f32; 3];
        // SAFETY: a function of the caller, by the contract of `srbf_brdf`.
        unsafe { (self.function)(self.user, wi.as_ptr(), wo.as_ptr(), f.as_mut_ptr()) };
        f.map(f64::from)
    }
}

/// # Safety
/// The header's contract: what is not NULL points to settings.
unsafe fn settings(given: *const srbf_fit_settings) -> Result<Settings, Failure> {
    let mut settings = Settings::default();
    if !given.is_null() {
        // SAFETY: the header's contract.
        let given = unsafe { read(given)? };
        settings.lobes = given.lobes;
        settings.squeezed = (given.squeezed_lobes != SRBF_FIT_AUTOMATIC).then_some(given.squeezed_lobes);
        settings.smoothness = given.smoothness;
    }
    settings.provenance = "fitted by srbf through its C interface".into();
    Ok(settings)
}

fn fit(content: &Content, settings: &Settings, out: &Out<*mut srbf_material>) -> Outcome {
    own(fit_content(content, settings, |_| ())?.bytes, out)
}

impl From<FitError> for Failure {
    fn from(error: FitError) -> Self {
        let status = match error {
            FitError::Io { .. } => SRBF_STATUS_FILE,
            FitError::Table(_) => SRBF_STATUS_TABLE,
            FitError::Setting { .. } => SRBF_STATUS_ARGUMENT,
            _ => SRBF_STATUS_OTHER,
        };
        Self::new(status, error)
    }
}
