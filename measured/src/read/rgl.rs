//! Reader of RGL `.bsdf` tensor files (Dupuy and Jakob 2018, "An Adaptive Parameterization for Efficient Material Acquisition
//! and Rendering"): RGB and spectral, isotropic and anisotropic.
//!
//! The measurement is stored in the unit square that a warp of the visible normals maps to the half vectors: to evaluate, the half
//! vector goes back through the warp. The colour found there is multiplied by `D / (4 sigma)`, unless `jacobian` says that it
//! holds that factor already. The stored values are `f cos`. There is a warp and a picture for every measured outgoing direction;
//! in between they are interpolated linearly in its angles.
//!
//! An isotropic file has one or two `phi_i`, and half vectors are counted from the azimuth of the outgoing direction. An
//! anisotropic one has more: over a whole turn, over half a turn (`phi_i` from -pi to 0; the rest follows by half a turn), or
//! over a quarter (from -pi to -pi / 2; the rest follows by mirrors in x and y).

mod arrays;
pub(crate) mod container;
#[cfg(test)]
mod damage;
mod lookup;
mod real;
#[doc(hidden)]
#[cfg(any(test, feature = "synthetic"))]
pub mod synthetic;
mod tensor;
mod warp;

use super::of_brdf::{self, Pair};
use super::spectra::Spectra;
use super::wavelengths::Wavelengths;
use crate::ReadError;
use crate::table::{Brdf, Draws, Known, Symmetry};
use lookup::Lookup;
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::OnceLock;
pub(crate) use tensor::check_size;
use warp::Grid;

/// One RGL material: in f64 for fits, and in f32 for those who draw from it.
#[derive(Debug)]
pub struct Rgl {
    wide: Lookup,
    /// Whether some of its colours are no numbers: nothing was measured there.
    has_holes: bool,
    spectra: Option<Spectra>,
    /// Made when it is asked for.
    narrow: OnceLock<Lookup<f32>>,
}

/// Parses the bytes of a `.bsdf` file.
///
/// # Errors
/// [`ReadError::Content`], with the field.
pub fn parse(bytes: &[u8]) -> Result<Rgl, ReadError> {
    let file = tensor::parse(bytes)?;
    let arrays = arrays::read(&file)?;
    let symmetry = if arrays.phis.len() == 1 { Symmetry::Isotropic } else { symmetry(&arrays.phis)? };
    let has_holes = arrays.rgb.iter().flatten().any(Grid::has_holes);
    let wide = Lookup { symmetry, arrays };
    let mut rgl = Rgl { wide, has_holes, spectra: None, narrow: OnceLock::new() };
    if has_holes && rgl.samples(1).is_empty() {
        return Err(ReadError::Content("field rgb: no number was measured, all are NaN".into()));
    }
    rgl.spectra = spectra(&file, &mut rgl)?;
    Ok(rgl)
}

/// The spectra of the colours, from values at some pairs of directions; `None` of a file without wavelengths.
fn spectra(file: &tensor::File<'_>, rgl: &mut Rgl) -> Result<Option<Spectra>, ReadError> {
    if file.find("spectra").is_none() {
        return Ok(None);
    }
    let wavelengths = Wavelengths::new(&file.numbers("wavelengths", 1)?.to_vec())?;
    let pairs: Vec<_> = of_brdf::pairs(SPECTRA, rgl.symmetry()).collect();
    // The wavelengths take the place of the colour, and give it back.
    let colours = std::mem::take(&mut rgl.wide.arrays.rgb);
    let found = of_brdf::spectra(&wavelengths, &pairs, |three| {
        rgl.wide.arrays.rgb = arrays::wavelengths(file, colours.len(), three)?;
        Ok(pairs.iter().map(|[wi, wo]| rgl.evaluate(*wi, *wo)).collect())
    });
    rgl.wide.arrays.rgb = colours;
    found
}

/// Pairs of directions whose spectra are looked at.
const SPECTRA: usize = 3000;

/// How far a range of azimuths may be from a whole, half or quarter turn, radians: f32 rounding, and little more.
const RANGE: f64 = 1e-3;

/// The symmetry that completes the range of measured azimuths.
fn symmetry(phis: &[f64]) -> Result<Symmetry, ReadError> {
    let (first, last) = (phis[0], phis[phis.len() - 1]);
    let close = |a: f64, b: f64| (a - b).abs() <= RANGE;
    match last - first {
        range if close(first, -PI) && close(range, 2.0 * PI) => Ok(Symmetry::None),
        range if close(first, -PI) && close(range, PI) => Ok(Symmetry::HalfTurn),
        range if close(first, -PI) && close(range, FRAC_PI_2) => Ok(Symmetry::Quadrant),
        _ => Err(ReadError::Content(format!(
            "phi_i from {first} to {last}; from -pi to pi, to 0 or to -pi / 2 was expected"
        ))),
    }
}

impl Rgl {
    /// `f cos` of the incident direction, and not clamped: the value of the file.
    /// 0 where a direction is on the horizon or below it.
    pub fn f_cos(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        self.wide.f_cos(wi, wo)
    }

    /// The spectra of its colours; `None` of a file of colours alone.
    pub fn spectra(&self) -> Option<&Spectra> {
        self.spectra.as_ref()
    }

    /// Whether something was not measured.
    pub fn has_holes(&self) -> bool {
        self.has_holes
    }

    /// The same with fewer numbers, as a rival of the same size as lobes: warps of `warp` by `warp` numbers, pictures of `picture` by
    /// `picture`. Gives how many numbers values need. `None` if a warp has no mass then.
    pub fn coarser(&self, warp: usize, picture: usize) -> Option<(Self, usize)> {
        let (arrays, count) = self.wide.arrays.coarser(warp.max(2), picture.max(2))?;
        let wide = Lookup { symmetry: self.wide.symmetry, arrays };
        Some((Self { wide, has_holes: self.has_holes, spectra: None, narrow: OnceLock::new() }, count))
    }

    /// Samples where something was measured: incident direction, outgoing direction and f. About `count` of all directions are tried,
    /// the half vectors denser about the normal.
    pub(crate) fn samples(&self, count: usize) -> Vec<([f64; 3], [f64; 3], [f64; 3])> {
        let sample = |[wi, wo]: Pair| {
            let value = self.evaluate(wi, wo);
            value.iter().all(|v| v.is_finite()).then_some((wi, wo, value))
        };
        of_brdf::pairs(count, self.symmetry()).filter_map(sample).collect()
    }

    fn narrow(&self) -> &Lookup<f32> {
        self.narrow.get_or_init(|| Lookup { symmetry: self.wide.symmetry, arrays: self.wide.arrays.to_f32() })
    }
}

/// The warps by brightness and by visible normals, one after the other (section 5 of the paper).
impl Draws for Rgl {
    fn draw(&self, u: [f32; 2], wo: [f32; 3]) -> ([f32; 3], Known) {
        self.narrow().draw(u, wo)
    }

    fn look_up(&self, wi: [f32; 3], wo: [f32; 3]) -> Known {
        self.narrow().look_up(wi, wo)
    }
}

impl Brdf for Rgl {
    fn evaluate(&self, wi: [f64; 3], wo: [f64; 3]) -> [f64; 3] {
        // On the horizon that is 0 over 0.
        let f_cos = self.f_cos(wi, wo);
        if lookup::is_above(wi, wo) { f_cos.map(|v| v / wi[2]) } else { [0.0; 3] }
    }

    fn measured(&self, wi: [f64; 3], wo: [f64; 3]) -> f64 {
        let is_known = !self.has_holes || self.f_cos(wi, wo).iter().all(|v| v.is_finite());
        f64::from(u8::from(is_known))
    }

    fn symmetry(&self) -> Symmetry {
        self.wide.symmetry
    }

    fn draws(&self) -> Option<&dyn Draws> {
        Some(self)
    }
}

#[cfg(test)]
mod tests {
    use super::lookup::dot;
    use super::synthetic::{self, Written};
    use super::*;
    use crate::analytic::ggx::{Facets, Ggx};
    use crate::table::direction;

    fn model(alpha: [f64; 2]) -> Ggx {
        Ggx { diffuse: [0.1; 3], alpha, facets: Facets::Schlick([0.9, 0.6, 0.3]) }
    }

    /// Mean and largest deviation of f cos from the model, over the peak of the view.
    fn deviation(rgl: &Rgl, model: &dyn Brdf) -> (f64, f64) {
        let (mut sum, mut worst, mut count) = (0.0, 0.0f64, 0);
        for v in 0..40 {
            let v = f64::from(v);
            let wo = direction(1.2 * (0.05 + 0.9 * (v * 0.618).fract()), 2.0 * PI * (v * 0.414).fract() - PI);
            let peak = model.evaluate([-wo[0], -wo[1], wo[2]], wo)[0] * wo[2];
            for i in 0..40 {
                let i = f64::from(i);
                // Round the mirror direction, ever farther out.
                let r = 0.02 * (1.0 + i);
                let (s, c) = (2.4 * i).sin_cos();
                let mut wi = [-wo[0] + r * c, -wo[1] + r * s, wo[2]];
                let length = libm::sqrt(wi.iter().map(|x| x * x).sum());
                wi.iter_mut().for_each(|x| *x /= length);
                let (found, expected) = (rgl.f_cos(wi, wo), model.evaluate(wi, wo).map(|f| f * wi[2]));
                for c in 0..3 {
                    let d = (found[c] - expected[c]).abs() / peak;
                    sum += d;
                    worst = worst.max(d);
                    count += 1;
                }
            }
        }
        (sum / f64::from(count), worst)
    }

    #[test]
    fn anisotropic_files_evaluate_to_the_model_they_were_tabulated_from() {
        let model = model([0.25, 0.5]);
        for (range, symmetry, jacobian) in [
            (2.0 * PI, Symmetry::None, true),
            (PI, Symmetry::HalfTurn, true),
            (FRAC_PI_2, Symmetry::Quadrant, true),
            (FRAC_PI_2, Symmetry::Quadrant, false),
        ] {
            let phis = 1 + (4.0 * range / FRAC_PI_2).round() as usize;
            let settings = Written { phis, range, jacobian, ..Written::default() };
            let rgl = parse(&synthetic::write(&model, &settings)).unwrap();
            assert_eq!(rgl.symmetry(), symmetry);
            let (mean, worst) = deviation(&rgl, &model);
            println!("{symmetry:?}, jacobian {jacobian}: mean {mean:.4}, worst {worst:.3} of the peak");
            assert!(mean < 0.005 && worst < 0.03, "{symmetry:?}: mean {mean}, worst {worst}");
        }
    }

    #[test]
    fn a_file_turned_by_a_quarter_is_another_material() {
        // The test above can fail: with the axes swapped, the deviation is of the order of the peak.
        let settings = Written { phis: 7, range: FRAC_PI_2, ..Written::default() };
        let rgl = parse(&synthetic::write(&model([0.25, 0.5]), &settings)).unwrap();
        assert!(deviation(&rgl, &model([0.5, 0.25])).1 > 0.3);
    }

    #[test]
    fn isotropic_files_evaluate_to_the_model_whatever_the_azimuth() {
        let model = model([0.3, 0.3]);
        for phis in [1, 2] {
            let settings = Written { phis, range: 0.0, ..Written::default() };
            let rgl = parse(&synthetic::write(&model, &settings)).unwrap();
            assert_eq!(rgl.symmetry(), Symmetry::Isotropic);
            let (mean, worst) = deviation(&rgl, &model);
            assert!(mean < 0.005 && worst < 0.03, "mean {mean}, worst {worst}");
        }
    }

    /// Directions by the warps have their density: the mean of their weights is the sum over the hemisphere.
    #[test]
    fn directions_by_the_warps_have_their_density() {
        for (phis, range, alpha) in
            [(1, 0.0, [0.3, 0.3]), (7, FRAC_PI_2, [0.25, 0.5]), (9, 2.0 * PI, [0.25, 0.5])]
        {
            let model = model(alpha);
            let rgl =
                parse(&synthetic::write(&model, &Written { phis, range, ..Written::default() })).unwrap();
            for wo in [direction(0.2, 0.7), direction(0.9, -2.5)] {
                let counted = |wi: [f64; 3]| {
                    let near = (0..3).map(|k| (wi[k] - [-wo[0], -wo[1], wo[2]][k]).powi(2)).sum::<f64>();
                    [1.0, libm::exp(-8.0 * near), wi[0], wi[1]]
                };
                let (n, m) = (600, 400);
                let at = |i: usize, of: usize| (i as f64 + 0.5) / of as f64;
                let (mut drawn, mut summed, mut estimate, mut albedo) = ([0.0; 4], [0.0; 4], 0.0, 0.0);
                let mut off = Vec::new();
                for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                    let (wi, known) = rgl.draw([at(i, n), at(j, n)].map(|v| v as f32), wo.map(|v| v as f32));
                    let wi = wi.map(f64::from);
                    if wi[2] > 0.0 {
                        let share = 1.0 / (n * n) as f64;
                        counted(wi).iter().zip(&mut drawn).for_each(|(c, sum)| *sum += share * c);
                        estimate += share * f64::from(known.value[0] / known.density);
                        // A draw brings along the numbers that a look-up finds.
                        let found = rgl.look_up(wi.map(|v| v as f32), wo.map(|v| v as f32));
                        off.push((found.density / known.density - 1.0).abs());
                        off.push((found.value[0] / known.value[0] - 1.0).abs());
                    }
                }
                // Over the square of the half vectors: at the normal the density rises without bound.
                for (i, j) in (0..m).flat_map(|i| (0..m).map(move |j| (i, j))) {
                    let (theta, turn) = (FRAC_PI_2 * at(i, m) * at(i, m), at(j, m));
                    let h = direction(theta, 2.0 * PI * turn);
                    let cosine = dot(h, wo);
                    let wi = [0, 1, 2].map(|k| 2.0 * cosine * h[k] - wo[k]);
                    if cosine > 0.0 && wi[2] > 0.0 {
                        let area = 2.0 * PI * PI * at(i, m) * libm::sin(theta) / (m * m) as f64;
                        let share = 4.0 * cosine * area;
                        let density = rgl.wide.density(wi, wo);
                        counted(wi).iter().zip(&mut summed).for_each(|(c, sum)| *sum += share * density * c);
                        albedo += share * rgl.f_cos(wi, wo)[0];
                    }
                }
                for (a, b) in drawn.iter().zip(&summed) {
                    assert!((a - b).abs() < 5e-3, "{phis} {wo:?}: {drawn:?} {summed:?}");
                }
                assert!(summed[0] < 1.001, "{summed:?}");
                assert!((estimate / albedo - 1.0).abs() < 5e-3, "{phis} {wo:?}: {estimate} {albedo}");
                off.sort_by(f32::total_cmp);
                let [median, most] = [off[off.len() / 2], off[off.len() * 999 / 1000]];
                println!(
                    "{phis} {wo:?}: a draw beside its lookup, median {median:.1e}, one in a thousand {most:.1e}"
                );
                assert!(median < 1e-5 && most < 1e-2, "{phis} {wo:?}: {median} {most}");
            }
        }
    }

    /// The density of another reader of the same files (mitsuba 3.9.1), in `reference_evals.csv`.
    #[test]
    #[ignore = "needs SRBF_DATA_DIR"]
    fn the_density_is_that_of_another_renderer() {
        let folder = std::path::PathBuf::from(
            std::env::var("SRBF_DATA_DIR").expect("SRBF_DATA_DIR names the folder of the data"),
        );
        let text = std::fs::read_to_string(folder.join("rgl/reference_evals.csv")).unwrap();
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        let header: Vec<&str> = lines.next().unwrap().split(',').collect();
        let column =
            |name: &str| header.iter().position(|h| *h == name).unwrap_or_else(|| panic!("{header:?}"));
        let of = |d: &str| ["x", "y", "z"].map(|k| column(&format!("{d}_{k}")));
        let (material, wi, wo, pdf) = (column("material"), of("wi"), of("wo"), column("pdf"));
        let mut files = std::collections::BTreeMap::new();
        let mut off = Vec::new();
        for line in lines {
            let fields: Vec<&str> = line.split(',').collect();
            let name = fields[material];
            let rgl = files.entry(name.to_owned()).or_insert_with(|| {
                let stem = name.trim_end_matches(".bsdf").trim_end_matches("_rgb");
                parse(&std::fs::read(folder.join(format!("rgl/{stem}_rgb.bsdf"))).unwrap()).unwrap()
            });
            let number = |i: usize| fields[i].parse::<f64>().unwrap();
            // Theirs has the names the other way round: `wi` is towards the viewer.
            let number32 = |i: usize| number(i) as f32;
            let found = f64::from(rgl.look_up(wo.map(number32), wi.map(number32)).density);
            let expected = number(pdf);
            if expected > 1e-3 {
                off.push((found / expected - 1.0).abs());
            }
        }
        off.sort_by(f64::total_cmp);
        let at = |share: f64| off[(share * (off.len() - 1) as f64) as usize];
        println!("{} pairs: median {:.1e}, 95 % {:.1e}, worst {:.1e}", off.len(), at(0.5), at(0.95), at(1.0));
        assert!(off.len() > 500 && at(0.5) < 1e-5 && at(1.0) < 1e-3, "{} {} {}", at(0.5), at(0.95), at(1.0));
    }

    #[test]
    fn spectral_files_have_the_colour_of_their_spectrum() {
        let model = model([0.3, 0.3]);
        let wavelengths: Vec<f64> = (0..66).map(|i| 370.0 + 6.0 * f64::from(i)).collect();
        let shape = |w: f64| 0.2 + 0.8 * libm::exp(-((w - 620.0) / 40.0) * ((w - 620.0) / 40.0));
        let spectrum: Vec<f64> = wavelengths.iter().map(|w| shape(*w)).collect();
        let settings =
            Written { spectrum: Some((wavelengths.clone(), spectrum.clone())), ..Written::default() };
        let rgl = parse(&synthetic::write(&model, &settings)).unwrap();
        // The model's red channel times the spectrum: a colour that does not depend on the directions.
        let expected = super::super::spectrum::ToRgb::new(&wavelengths).unwrap().convert(&spectrum);
        let grey = parse(&synthetic::write(&model, &Written::default())).unwrap();
        for n in 0..30 {
            let n = f64::from(n);
            let (wi, wo) = (direction(0.04 * n, 0.9 * n), direction(0.6, -0.4 * n));
            let (found, red) = (rgl.f_cos(wi, wo), grey.f_cos(wi, wo)[0]);
            for c in 0..3 {
                assert!(
                    (found[c] - red * expected[c]).abs() < 1e-5 * red.abs(),
                    "{found:?} {red} {expected:?}"
                );
            }
        }
        assert!(expected[0] > 2.0 * expected[1], "the test needs a colour: {expected:?}");
        // The map takes the colour to the spectrum, of every second wavelength; of an anisotropic surface too.
        let turned = Written { phis: 7, range: FRAC_PI_2, ..settings };
        let brushed = parse(&synthetic::write(&self::model([0.25, 0.5]), &turned)).unwrap();
        assert_eq!((rgl.symmetry(), brushed.symmetry()), (Symmetry::Isotropic, Symmetry::Quadrant));
        for spectra in [rgl.spectra().unwrap(), brushed.spectra().unwrap()] {
            assert!(spectra.wavelengths.len() == 33 && spectra.errors.error < 1e-3, "{:?}", spectra.errors);
            for (nm, found) in spectra.wavelengths.iter().zip(spectra.of(expected)) {
                assert!((found - shape(*nm)).abs() < 0.01, "{nm}: {found} {}", shape(*nm));
            }
        }
        assert!(grey.spectra().is_none());
    }
}
