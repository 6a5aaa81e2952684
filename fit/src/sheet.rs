//! Fits of sheets: a material for each quarter, and how the light of each incident patch is divided.
//!
//! May import: `fit`, `judge`, `settings`.

use crate::fit::fit_source;
use crate::judge::fitted_material::values_towards;
use crate::judge::report::Fit;
use crate::patches::{Basis, PatchMatrix, Ring};
use crate::read::window::words;
use crate::read::{Content, SheetSource};
use crate::table::Symmetry;
use crate::{FitError, Settings};
use serde_json::{Value, json};
use srbf_core::{FormatError, MAX_LOBES, Material, Quarter, Sheet, SheetMixture, Vec3, luminance, printable};

/// Relative L2 distance of two quarters up to which the back is like the front.
const LIKE: f64 = 0.01;

/// Most bytes of an isotropic quarter, unless the settings have another number than their default: four are no more than 24 kB.
const BYTES: usize = 5900;

/// Angles of the light in [`light_of_sheet`], degrees.
const ANGLES: [f64; 9] = [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0];

/// The largest share of the light that samples may reflect and transmit together: rounding, and the noise of a fit.
const MOST: f64 = 1.002;

/// The share of the work that the first fit of samples is; the rest is for a second one, with lower values.
const FIRST: f64 = 0.5;

/// A sheet, and how well its quarters fit.
#[derive(Debug)]
pub struct SheetFit {
    /// The `.srbf` bytes of the sheet.
    pub bytes: Vec<u8>,
    /// The quarters that are fitted.
    pub quarters: Vec<QuarterFit>,
    /// Light that falls on the front, and on the back, by angle.
    pub sides: [Vec<Light>; 2],
    /// Whether the back is like the front.
    pub is_symmetric: bool,
    /// The number that values were multiplied by, so that no more light leaves than falls on the sheet.
    pub scale: f64,
}

/// The fit of a quarter.
#[derive(Debug)]
pub struct QuarterFit {
    /// Which one it is.
    pub quarter: Quarter,
    /// The material and its report.
    pub fit: Fit,
    /// Relative L2 distance of the values of its patches from the data, which have patches.
    pub patches: Option<f64>,
}

/// Where the light goes that falls on one side at an angle; means over the azimuth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// The angle from the normal, radians.
    pub theta: f64,
    /// Shares of the data that are reflected and transmitted, where these are patches.
    pub data: Option<[f64; 2]>,
    /// Those of the fit.
    pub fit: [f64; 2],
}

/// Fits all quarters of a sheet.
///
/// Samples that reflect and transmit more than the light that falls on them are fitted once more, with lower values. `progress` is called
/// with the share of the work that is done, 0 to 1; it never falls.
///
/// # Errors
/// As [`fit_source`].
pub fn fit_sheet(
    sheet: &SheetSource,
    settings: &Settings,
    mut progress: impl FnMut(f64) + Send,
) -> Result<SheetFit, FitError> {
    // Samples alone are fitted once more.
    let first = if sheet.window().is_some() { 1.0 } else { FIRST };
    let fit = fit_once(sheet, settings, |share| progress(first * share))?;
    let most = fit.sides.iter().flatten().map(|light| light.fit[0] + light.fit[1]).fold(0.0, f64::max);
    let scale = 1.0 / most;
    match if most > MOST { sheet.dimmed(scale)? } else { None } {
        Some(dimmed) => {
            let again = |share| progress(first + (1.0 - first) * share);
            Ok(SheetFit { scale, ..fit_once(&dimmed, settings, again)? })
        }
        None => {
            progress(1.0);
            Ok(fit)
        }
    }
}

fn fit_once(
    sheet: &SheetSource,
    settings: &Settings,
    mut progress: impl FnMut(f64) + Send,
) -> Result<SheetFit, FitError> {
    let window = sheet.window();
    let is_symmetric = is_symmetric(sheet);
    let wanted = stored(sheet);
    let mut fits = Vec::new();
    for (n, quarter) in wanted.iter().enumerate() {
        let done = |share: f64| progress((n as f64 + share) / wanted.len() as f64);
        let Some(source) = &sheet.quarters[*quarter as usize] else { continue };
        let is_round =
            matches!(&source.content, Content::Evaluable(brdf) if brdf.symmetry() == Symmetry::Isotropic);
        let is_default = settings.bytes == Settings::default().bytes;
        let bytes = if is_round && is_default { BYTES } else { settings.bytes };
        fits.push((*quarter, fit_source(source, &Settings { bytes, ..settings.clone() }, done)?));
    }
    let mut materials: [Option<Material<&[u8]>>; 4] = [const { None }; 4];
    for (quarter, fit) in &fits {
        materials[*quarter as usize] = Some(Material::from_bytes(fit.bytes.as_slice())?);
    }
    let mut stored = materials.each_ref().map(Option::as_ref);
    if sheet.is_one_way() {
        stored[Quarter::BackTransmission as usize] = stored[Quarter::FrontTransmission as usize];
    }
    let bytes = encoded(stored, is_symmetric, &settings.provenance)?;
    let mut fitted: [Option<PatchMatrix>; 4] = [const { None }; 4];
    let data =
        |place: usize| window.and_then(|window| window.quarters[place].as_ref().map(|own| &own.matrix));
    for (place, fitted) in fitted.iter_mut().enumerate() {
        let material = materials[place & if is_symmetric { 1 } else { 3 }].as_ref();
        let means = data(place).zip(material).map(|(d, m)| means_over(&d.outgoing, &d.incident, m));
        *fitted = means.transpose()?;
    }
    let sides = if window.is_some() {
        // Light is reflected to the side that it comes from, and seen through the sheet from the other.
        [(0, 3), (2, 1)].map(|(reflected, transmitted)| {
            let of = |place: usize| [data(place), fitted[place].as_ref()];
            lights(of(reflected), of(transmitted))
        })
    } else {
        light_of_sheet(&bytes)?
    };
    let of_quarter = |(quarter, fit): (Quarter, Fit)| {
        let both = data(quarter as usize).zip(fitted[quarter as usize].as_ref());
        QuarterFit { quarter, fit, patches: both.map(|(data, own)| own.distance(data)) }
    };
    let quarters = fits.into_iter().map(of_quarter).collect();
    let scale = window.map_or(1.0, |window| window.scale);
    Ok(SheetFit { bytes, quarters, sides, is_symmetric, scale })
}

/// The bytes of a sheet of materials, in the order of [`Quarter::ALL`].
///
/// # Errors
/// As [`Sheet::encode`].
pub fn encoded<B: AsRef<[u8]>>(
    quarters: [Option<&Material<B>>; 4],
    is_symmetric: bool,
    provenance: &str,
) -> Result<Vec<u8>, FormatError> {
    let mut bytes = vec![0; Sheet::encoded_len(quarters, provenance)];
    Sheet::encode(quarters, is_symmetric, provenance, &mut bytes)?;
    Ok(bytes)
}

/// The same with the first line of the provenance of each, which names its source.
///
/// # Errors
/// As [`Sheet::encode`].
pub fn joined<B: AsRef<[u8]>>(
    quarters: [Option<&Material<B>>; 4],
    is_symmetric: bool,
) -> Result<Vec<u8>, FormatError> {
    let sources = quarters.iter().flatten().filter_map(|material| material.provenance().lines().next());
    let provenance = sources.fold(String::new(), |text, line| text + line + "\n");
    encoded(quarters, is_symmetric, &provenance)
}

/// The quarters of a sheet that are fitted and stored: not those of a back that is like the front.
pub fn stored(sheet: &SheetSource) -> Vec<Quarter> {
    let is_symmetric = is_symmetric(sheet);
    let is_there = |q: &Quarter| sheet.quarters[*q as usize].is_some() && !(is_symmetric && q.is_back());
    Quarter::ALL.into_iter().filter(is_there).collect()
}

/// The means of a sheet over the patches of Klems, for each quarter that is not black, in the order of [`Quarter::ALL`]: those of the
/// luminance.
///
/// # Errors
/// [`FitError`] never for a sheet that was read.
pub fn klems_of_sheet(sheet: &Sheet<impl AsRef<[u8]>>) -> Result<[Option<PatchMatrix>; 4], FitError> {
    let mut all = [const { None }; 4];
    for quarter in Quarter::ALL {
        if let Some(material) = sheet.quarter(quarter) {
            all[quarter as usize] = Some(klems_of(&material)?);
        }
    }
    Ok(all)
}

/// The same of a material.
///
/// # Errors
/// As [`klems_of_sheet`].
pub fn klems_of(material: &Material<impl AsRef<[u8]>>) -> Result<PatchMatrix, FitError> {
    let basis = Basis::klems_full();
    means_over(&basis, &basis, material)
}

/// Whether the back is like the front, as far as patches tell.
fn is_symmetric(sheet: &SheetSource) -> bool {
    let Some(window) = sheet.window() else { return false };
    let is_like = |front: usize, back: usize| match [front, back].map(|n| window.quarters[n].as_ref()) {
        [Some(a), Some(b)] => {
            let is_alike = |n: usize| {
                let (a, b) = (a.band(n), b.band(n));
                a.outgoing == b.outgoing && a.incident == b.incident && a.distance(b) <= LIKE
            };
            (0..3).all(is_alike)
        }
        [None, None] => true,
        _ => false,
    };
    is_like(0, 2) && is_like(1, 3)
}

/// The means of a material over patches.
fn means_over(
    outgoing: &Basis,
    incident: &Basis,
    material: &Material<impl AsRef<[u8]>>,
) -> Result<PatchMatrix, FitError> {
    let lights: Vec<[f64; 3]> = (0..incident.len()).map(|c| incident.light(c)).collect();
    let mut values = vec![0.0; outgoing.len() * incident.len()];
    for r in 0..outgoing.len() {
        let points = outgoing.points(r);
        for wo in &points {
            let found = values_towards(material, *wo, &lights)?;
            for (c, (value, wi)) in found.iter().zip(&lights).enumerate() {
                values[r * incident.len() + c] += value / wi[2] / points.len() as f64;
            }
        }
    }
    Ok(PatchMatrix { outgoing: outgoing.clone(), incident: incident.clone(), values })
}

/// Where the light of one side goes, of data and fit.
fn lights(reflected: [Option<&PatchMatrix>; 2], transmitted: [Option<&PatchMatrix>; 2]) -> Vec<Light> {
    let Some(basis) = reflected.iter().chain(&transmitted).flatten().next().map(|m| &m.incident) else {
        return Vec::new();
    };
    let mean = |matrix: Option<&PatchMatrix>, ring: usize| {
        let (first, count) = basis.ring(ring);
        matrix
            .filter(|m| m.incident == *basis)
            .map_or(0.0, |m| (first..first + count).map(|c| m.sum(c)).sum::<f64>() / count as f64)
    };
    let light = |(ring, of): (usize, &Ring)| {
        let [data, fit] = [0, 1].map(|n| [reflected[n], transmitted[n]].map(|m| mean(m, ring)));
        Light { theta: of.theta, data: Some(data), fit }
    };
    basis.rings().iter().enumerate().map(light).collect()
}

/// Where the light goes that falls on the front of a sheet, and on its back. By reciprocity, the albedo towards a viewer is that of light
/// from there.
///
/// # Errors
/// [`FitError::Format`] for bytes that are no sheet.
pub fn light_of_sheet(bytes: &[u8]) -> Result<[Vec<Light>; 2], FitError> {
    let sheet = Sheet::from_bytes(bytes)?;
    let light = |degrees: f64, side: f64| {
        let theta = degrees.to_radians();
        let wo = Vec3::new(libm::sin(theta) as f32, 0.0, (side * libm::cos(theta)) as f32);
        let mut pair = SheetMixture::<MAX_LOBES>::empty();
        sheet.prepare(wo, &mut pair)?;
        let fit = pair.albedos().map(|rgb| f64::from(luminance(rgb)));
        Ok(Light { theta, data: None, fit })
    };
    let side =
        |side: f64| ANGLES.into_iter().map(|degrees| light(degrees, side)).collect::<Result<_, FitError>>();
    Ok([side(1.0)?, side(-1.0)?])
}

impl SheetFit {
    /// The report as JSON, beside those of the quarters.
    pub fn to_json(&self, sheet: &SheetSource) -> Value {
        let light = |l: &Light| {
            let data = |which: usize| l.data.map(|data| data[which]);
            json!({
                "theta_deg": l.theta.to_degrees(),
                "reflected": {"data": data(0), "fit": l.fit[0]},
                "transmitted": {"data": data(1), "fit": l.fit[1]},
            })
        };
        let side = |lights: &[Light]| lights.iter().map(light).collect::<Vec<_>>();
        let patches = self
            .quarters
            .iter()
            .map(|q| json!({"quarter": words(q.quarter), "relative_l2_of_patches": q.patches}));
        json!({
            "name": sheet.window().map_or_else(|| sheet.name.clone(), |w| printable(&w.name).to_string()),
            "bytes": self.bytes.len(),
            "back_is_like_front": self.is_symmetric,
            "transmission_of_both_sides_differs_by": sheet.window().and_then(|w| w.disagreement),
            "transmissions_are_one_measurement": sheet.is_one_way(),
            "values_were_scaled_by": self.scale,
            "light_on_front": side(&self.sides[0]),
            "light_on_back": side(&self.sides[1]),
            "patches": patches.collect::<Vec<_>>(),
        })
    }
}
