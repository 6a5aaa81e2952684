//! Fitting: from a table or a function of the caller to a material, and materials to files.
#![allow(unsafe_code)]

use crate::arguments::Argument;
use crate::convert::direction;
use crate::guard::{Failure, Named, Outcome, guard};
use crate::heap::{own, text};
use crate::material::material;
use crate::material::srbf_material;
use crate::pointers::{Out, check_apart, read};
use crate::status::{
    SRBF_STATUS_ARGUMENT, SRBF_STATUS_FILE, SRBF_STATUS_NULL, SRBF_STATUS_OTHER, SRBF_STATUS_TABLE,
    srbf_status,
};
use crate::streams::{Inputs, srbf_vectors};
use core::ffi::{c_char, c_void};
use srbf_core::Material;
use srbf_fit::judge::reciprocity::reciprocity;
use srbf_fit::judge::verdict::{Spread, Summary, Verdict};
use srbf_fit::read::Content;
use srbf_fit::table::Brdf;
use srbf_fit::table::{Scattered, Table};
use srbf_fit::{
    FactorNodes, Fit, FitError, Settings, fit_content, in_threads, with_reasons, write_atomically,
};
use std::boxed::Box;
use std::path::Path;
use std::vec::Vec;

/// In place of a number of a fit: it is chosen by what turns out best.
pub const SRBF_FIT_AUTOMATIC: usize = 65535;

/// How a material is fitted. `srbf_fit_settings_default` fills it in; a caller changes the fields that he cares about.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_fit_settings {
    /// Lobes of every view, 1 to 64; more fit better and cost more at run time. Default: 12.
    pub lobes: usize,
    /// How many of them are squeezed, or `SRBF_FIT_AUTOMATIC`, the default.
    pub squeezed_lobes: usize,
    /// Pairs of lobes that are mirrored in the plane of incidence, or `SRBF_FIT_AUTOMATIC`, the default.
    pub mirrored_pairs: usize,
    /// Views of the material, 2 to 256, or `SRBF_FIT_AUTOMATIC`, the default.
    pub views: usize,
    /// Nodes of the table of factors over half angle, difference angle and azimuth: 2 or more, 2 or more, 1 or more. All three
    /// `SRBF_FIT_AUTOMATIC`, the default, or all three 0 for a material without factors.
    pub factor_nodes: [usize; 3],
    /// Most bytes of the material, 200 to 1000000: they are spent on factors where that shows. Default: 8000.
    pub bytes: usize,
    /// Mean relative L2 error that the fewest lobes are to reach, at most `lobes` of them; 0, the default, for all of them.
    pub error: f64,
    /// Weight of the roughness from view to view, 1e-12 to 1000: smaller fits the samples better, larger the directions between
    /// them. Default: 5e-5.
    pub smoothness: f64,
    /// Starting points that are tried, 1 to 1000. A fit takes about as long as it has starting points. Default: 12.
    pub starts: usize,
    /// Most steps of the solver in the refinement, 1 to 100000. Default: 120.
    pub steps: usize,
    /// Most exchanges of lobes in a stage, 0 to 1000. Default: 15.
    pub exchanges: usize,
    /// 1 for nodes over the azimuth from -1 to 1, see `srbf_material_info`, where `factor_nodes` are given; else 0, the default.
    pub has_signed_factors: u32,
}

/// Bytes of the verdict of a fit, the zero at its end among them.
pub const SRBF_FIT_VERDICT_SIZE: usize = 4096;

/// How near a fitted material is to its data: numbers, and the verdict in words. Errors are relative: 0.05 is 5 %.
///
/// They are of views between the fitted ones where the BRDF can be evaluated there, and else of the fitted views. NaN stands for a
/// number that no view has: data that are black everywhere have no relative error.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_fit_report {
    /// Relative L2 error of `f cos`, the median of the views.
    pub error: f64,
    /// The largest of the views.
    pub worst_error: f64,
    /// Outgoing direction of the largest: its angle from the normal, radians.
    pub worst_error_theta: f64,
    /// Median relative error of the luminance farther than 15 degrees from the mirror direction, the median of the views.
    pub luminance_error: f64,
    /// Largest relative error of an albedo.
    pub energy_error: f64,
    /// Largest `f cos / pdf` over its mean: how much brighter than its surroundings a dot of noise may be.
    pub largest_weight: f64,
    /// Seconds that the fit took.
    pub seconds: f64,
    /// Criteria that are off, each with a line of the verdict that begins with `off`.
    pub faults: usize,
    /// The verdict, UTF-8 lines with a zero at the end. The first says whether to use the material, if that could be judged. The others
    /// begin with `good`, `fair`, `off`, or `try` for advice.
    pub verdict: [c_char; SRBF_FIT_VERDICT_SIZE],
}

/// A BRDF of the caller: writes f (not times the cosine; linear sRGB, 1/sr) for two unit vectors with z > 0.
///
/// `wi`, `wo` and `f` are [3]; `user` is the pointer of the caller. It is called from threads of the library, several at once. It
/// must return: neither throw nor `longjmp` out. A value that is negative or not finite counts as 0.
pub type srbf_brdf =
    Option<unsafe extern "C" fn(user: *mut c_void, wi: *const f32, wo: *const f32, f: *mut f32)>;

/// Gives the settings that NULL stands for.
#[cfg(feature = "fit")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_fit_settings_default(settings: *mut srbf_fit_settings) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let out = unsafe { Out::new(settings).of(Argument::Settings)? };
        let Settings { lobes, bytes, smoothness, starts, steps, exchanges, .. } = Settings::default();
        out.set(srbf_fit_settings {
            lobes,
            squeezed_lobes: SRBF_FIT_AUTOMATIC,
            mirrored_pairs: SRBF_FIT_AUTOMATIC,
            views: SRBF_FIT_AUTOMATIC,
            factor_nodes: [SRBF_FIT_AUTOMATIC; 3],
            bytes,
            error: 0.0,
            smoothness,
            starts,
            steps,
            exchanges,
            has_signed_factors: 0,
        });
        Ok(())
    })
}

/// Fits a material to n samples of an isotropic BRDF. Release it with `srbf_material_free`. Takes seconds, on all processors.
///
/// Outgoing directions whose angles from the normal agree within 1e-3 are one view. Any number of samples is taken; with fewer
/// than a few hundred a view, values between them are badly known. No surface reflects more than it receives: where the albedo of
/// the samples of a view is above 0.95, the fit is held to 0.95, and is darker than the samples. Shapes: `wo` and `wi` n unit
/// vectors, `wo` above the horizon; samples whose `wi` is not are left out; `f` n colours, linear sRGB, of which negative channels
/// count as 0; `settings` one, or NULL; `material` one pointer, overwritten; `report` one, overwritten, or NULL.
/// Status, with the reason in `srbf_last_message`:
/// `SRBF_STATUS_DIRECTION` for a vector that is no unit vector; `SRBF_STATUS_TABLE`; `SRBF_STATUS_ARGUMENT` for a setting;
/// `SRBF_STATUS_OTHER` if the system gives no threads to fit on, or there is no memory for the samples.
///
/// A child that was forked may fit, whether or not its parent has fitted or is fitting: it starts threads of its own. But a child
/// that was forked within a `srbf_brdf` gets `SRBF_STATUS_OTHER`.
#[cfg(feature = "fit")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_fit_table(
    settings: *const srbf_fit_settings,
    n: usize,
    wo: *const srbf_vectors,
    wi: *const srbf_vectors,
    f: *const srbf_vectors,
    material: *mut *mut srbf_material,
    report: *mut srbf_fit_report,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (settings, out) = unsafe { (self::settings(settings)?, Places::new(material, report)?) };
        if n == 0 {
            return Err(SRBF_STATUS_TABLE.into());
        }
        // SAFETY: the header's contract.
        let (wo, wi, f) = unsafe {
            (
                read(wo).of(Argument::Wo)?.streams(),
                read(wi).of(Argument::Wi)?.streams(),
                read(f).of(Argument::F)?.streams(),
            )
        };
        let [[a, b, c], [d, e, g], [h, i, j]] = [wo, wi, f];
        // SAFETY: the header's contract.
        let batch = unsafe { Inputs::new(n, [a, b, c, d, e, g, h, i, j])? };
        srbf_fit::check_memory((n as u64).saturating_mul(SAMPLE_BYTES))
            .map_err(|error| Failure::new(SRBF_STATUS_OTHER, error))?;
        let table = Table::from_scattered(scattered(&batch)?)?;
        fit(&Content::Samples(table), &settings, &out)
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
    report: *mut srbf_fit_report,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (settings, out) = unsafe { (self::settings(settings)?, Places::new(material, report)?) };
        let function = brdf.ok_or(SRBF_STATUS_NULL).of(Argument::Brdf)?;
        fit(&Content::Evaluable(Box::new(Callback { function, user })), &settings, &out)
    })
}

/// Writes a material to a `.srbf` file, whole or not at all; folders that are missing are made.
///
/// The bytes are written under another name in the same folder, which is then renamed. A symbolic link stays, and its target is
/// replaced; a file that is there gives its mode to the new one. Where a folder, a device, a pipe or a socket is there, nothing is
/// written. `path` is UTF-8 with a zero at the end. Status: `SRBF_STATUS_FILE`, with the reason in `srbf_last_message`.
#[cfg(feature = "fit")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_material_save(
    material: *const srbf_material,
    path: *const c_char,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (material, path) = unsafe { (self::material(material)?, text(path).of(Argument::Path)?) };
        write_atomically(Path::new(path), material.material.bytes())?;
        Ok(())
    })
}

/// Groups samples, nine columns `wo`, `wi` and f, by the angle of `wo`; in the frame of the view.
fn scattered(batch: &Inputs<9>) -> Result<Vec<(f64, Scattered)>, Failure> {
    let mut views: Vec<(f64, Scattered)> = Vec::new();
    let mut number = 0;
    batch.run(|columns| {
        for i in 0..columns[0].len() {
            let sample = columns.map(|column| column[i]);
            add(&mut views, sample).map_err(|failure| failure.about(&std::format!("sample {number}")))?;
            number += 1;
        }
        Ok::<(), Failure>(())
    })?;
    Ok(views)
}

fn add(views: &mut Vec<(f64, Scattered)>, sample: [f32; 9]) -> Outcome {
    direction([sample[0], sample[1], sample[2]]).of(Argument::Wo)?;
    direction([sample[3], sample[4], sample[5]]).of(Argument::Wi)?;
    let [ox, oy, oz, ix, iy, iz, r, g, b] = sample.map(f64::from);
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
    Ok(())
}

/// Memory that a sample takes as it is given and in its table.
const SAMPLE_BYTES: u64 = 128;

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
/// The header's contract: a pointer that is not NULL points to settings.
unsafe fn settings(given: *const srbf_fit_settings) -> Result<Settings, Failure> {
    let provenance = "fitted by srbf through its C interface\n".into();
    if given.is_null() {
        return Ok(Settings { provenance, ..Settings::default() });
    }
    // SAFETY: the header's contract.
    let given = unsafe { read(given).of(Argument::Settings)? };
    let number = |value: usize| (value != SRBF_FIT_AUTOMATIC).then_some(value);
    let factors = match given.factor_nodes {
        [SRBF_FIT_AUTOMATIC, SRBF_FIT_AUTOMATIC, SRBF_FIT_AUTOMATIC] => FactorNodes::Chosen,
        [0, 0, 0] => FactorNodes::None,
        nodes if given.has_signed_factors != 0 => FactorNodes::Signed(nodes),
        nodes => FactorNodes::Given(nodes),
    };
    Ok(Settings {
        lobes: given.lobes,
        bytes: given.bytes,
        error: (given.error != 0.0).then_some(given.error),
        squeezed: number(given.squeezed_lobes),
        mirrored: number(given.mirrored_pairs),
        smoothness: given.smoothness,
        starts: given.starts,
        steps: given.steps,
        exchanges: given.exchanges,
        views: number(given.views),
        factors,
        provenance,
        ..Settings::default()
    })
}

/// Where a material and, if it is wanted, its report go.
struct Places {
    material: Out<*mut srbf_material>,
    report: Option<Out<srbf_fit_report>>,
}

impl Places {
    /// # Safety
    /// The header's contract.
    unsafe fn new(material: *mut *mut srbf_material, report: *mut srbf_fit_report) -> Result<Self, Failure> {
        // SAFETY: the header's contract.
        let material = unsafe { Out::new(material) }.of(Argument::Material)?;
        // SAFETY: the header's contract.
        let report =
            (!report.is_null()).then(|| unsafe { Out::new(report) }).transpose().of(Argument::Report)?;
        if let Some(report) = &report {
            check_apart(&material.extent(), &report.extent()).of(Argument::Report)?;
        }
        Ok(Self { material, report })
    }
}

fn fit(content: &Content, settings: &Settings, out: &Places) -> Outcome {
    let fit = in_threads(|| fit_content(content, settings, |_| ()))??;
    let report = out.report.as_ref().map(|_| report(&fit)).transpose()?;
    own(fit.bytes, &out.material)?;
    if let Some((place, report)) = out.report.as_ref().zip(report) {
        place.set(report);
    }
    Ok(())
}

/// The report of a fit in the words and numbers of the header.
fn report(fit: &Fit) -> Result<srbf_fit_report, FitError> {
    let reciprocity = reciprocity(&Material::from_bytes(fit.bytes.as_slice())?)?;
    let found = Verdict::of_material(&fit.report, &reciprocity);
    let summary = Summary::new(&fit.report);
    let median = |spread: Option<Spread>| spread.map_or(f64::NAN, |spread| spread.median);
    let worst = |spread: Option<Spread>| spread.map_or(f64::NAN, |spread| spread.worst);
    let mut verdict = [0; SRBF_FIT_VERDICT_SIZE];
    let mut len = 0;
    for line in found.lines() {
        // A line that has no room whole is left out; the last byte stays 0.
        if len + line.len() + 1 >= verdict.len() {
            break;
        }
        for (to, byte) in verdict[len..].iter_mut().zip(line.bytes().chain([b'\n'])) {
            *to = byte as c_char;
        }
        len += line.len() + 1;
    }
    Ok(srbf_fit_report {
        error: median(summary.error),
        worst_error: worst(summary.error),
        worst_error_theta: summary.error.map_or(f64::NAN, |spread| spread.worst_at),
        luminance_error: median(summary.luminance),
        energy_error: worst(summary.energy),
        largest_weight: worst(summary.weight),
        seconds: fit.report.seconds,
        faults: found.off.len(),
        verdict,
    })
}

impl From<FitError> for Failure {
    fn from(error: FitError) -> Self {
        let status = match error {
            FitError::Io { .. } => SRBF_STATUS_FILE,
            FitError::Table(_) => SRBF_STATUS_TABLE,
            FitError::Setting { .. } => SRBF_STATUS_ARGUMENT,
            _ => SRBF_STATUS_OTHER,
        };
        match error {
            FitError::Table(reason) => Self::new(status, reason),
            error => Self::new(status, with_reasons(&error)),
        }
    }
}
