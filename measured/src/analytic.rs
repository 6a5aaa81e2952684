//! Analytic models as tables, named on the command line: `model:NAME:KEY=VALUE,KEY=VALUE,...`.
//!
//! | name | parameters, with their defaults |
//! |---|---|
//! | `lambert` | `albedo=0.5` |
//! | `phong` | `diffuse=0.3`, `specular=0.3`, `exponent=50` |
//! | `ward` | `diffuse=0.2`, `specular=0.3`, `alpha=0.2` or `alpha_x`, `alpha_y` |
//! | `ggx` | `diffuse=0`, `alpha=0.2` or `alpha_x`, `alpha_y`, and `f0=0.9` (Schlick) or `ior` (dielectric) |
//! | `ross-li` | `iso=0.2`, `vol=0.1`, `geo=0.03`: crops and forests |
//! | `rpv` | `rho0=0.1`, `k=0.7`, `theta=-0.15`: the same |
//! | `hapke` | `w=0.5`, `g=-0.2`, `b0=1`, `h=0.06`: soils and regoliths |
//! | `cox-munk` | `wind=5`, `ior=1.34`: the sea |
//! | `abg` | `a=0.001`, `b=0.0001`, `g=2`: polished surfaces |
//! | `harvey-shack` | `b0=10`, `l=0.01`, `s=-2`: the same |
//! | `oren-nayar` | `albedo=0.5`, `sigma=0.35`: plaster |
//! | `sheen` | `alpha=0.5`: cloth |
//! | `ground-glass` | `alpha=0.3`, `ior=1.5`, `behind=0`: light through a plate that is rough in front, seen from there or from behind |
//! | `sgd`, `abc` | `name` of the material, `file` of the fits; else that in the folder that `SRBF_DATA_DIR` names |
//!
//! A colour is one number or three, `0.6/0.2/0.1`, linear sRGB; or a file of text, with a wavelength and a reflectance on each line. Models from `ross-li` to `ground-glass` are grey, times the colour `tint=1`.
//!
//! May import: `error`, `file`, `table`.

pub mod abc;
pub mod by_hand;
mod fits;
mod fresnel;
pub mod ggx;
pub mod lambert;
mod parameters;
pub mod phong;
pub mod sgd;
pub mod ward;

use crate::file::{MAX_FILE, read_bytes};
use crate::table::Brdf;
use crate::{FitError, ReadError};
use parameters::Parameters;
use std::path::{Path, PathBuf};

/// Prefix that tells the name of a model from that of a file.
pub const PREFIX: &str = "model:";

/// The names of the models.
const NAMES: &str = "lambert, phong, ward, ggx, ross-li, rpv, hapke, cox-munk, abg, harvey-shack, oren-nayar, sheen, ground-glass, sgd, abc";

/// A model that was named, and what identifies it.
pub(super) struct Named {
    pub brdf: Box<dyn Brdf + Send>,
    /// A name that a file can have.
    pub name: String,
    /// The text, and the content of a file of fits.
    pub identity: Vec<u8>,
}

/// A colour as it is given: linear sRGB, or the file of a spectrum.
pub(super) enum Given<'a> {
    Rgb([f64; 3]),
    File(&'a Path),
}

/// Three numbers for a colour that is given: linear sRGB, or values at three wavelengths.
pub(super) type Colours<'a> = &'a mut dyn FnMut(Given<'_>) -> Result<[f64; 3], ReadError>;

/// Makes the model that a text names, the prefix cut off.
pub(super) fn parse(text: &str, colours: Colours<'_>) -> Result<Named, FitError> {
    let fault = |source| FitError::Read { path: PathBuf::from(format!("{PREFIX}{text}")), source };
    let (model, rest) = text.split_once(':').unwrap_or((text, ""));
    let mut parameters = Parameters::parse(rest, colours).map_err(fault)?;
    let mut identity = text.as_bytes().to_vec();
    let mut name = model.to_owned();
    let brdf: Result<Box<dyn Brdf + Send>, ReadError> = match model {
        "lambert" => lambert::Lambert::from_parameters(&mut parameters).map(|m| Box::new(m) as _),
        "phong" => phong::Phong::from_parameters(&mut parameters).map(|m| Box::new(m) as _),
        "ward" => ward::Ward::from_parameters(&mut parameters).map(|m| Box::new(m) as _),
        "ggx" => ggx::Ggx::from_parameters(&mut parameters).map(|m| Box::new(m) as _),
        "sgd" | "abc" => {
            let material = parameters.text("name").map(str::to_owned);
            let path = fits_file(model, &mut parameters).map_err(fault)?;
            let bytes = read_bytes(&path, MAX_FILE, |_| Ok(()))?;
            let found = material
                .ok_or_else(|| ReadError::Content("`name=MATERIAL` is needed".into()))
                .and_then(|material| {
                    name = format!("{model}-{material}");
                    let brdf: Box<dyn Brdf + Send> = match model {
                        "sgd" => Box::new(sgd::parse(&bytes, &material)?),
                        _ => Box::new(abc::parse(&bytes, &material)?),
                    };
                    Ok(brdf)
                });
            identity.extend(bytes);
            found.map_err(|source| FitError::Read { path, source }).map(Ok)?
        }
        _ => match by_hand::ByHand::from_parameters(model, &mut parameters) {
            Some(made) => made.map(|m| Box::new(m) as _),
            None => Err(ReadError::Content(format!("no model `{model}`; there are {NAMES}"))),
        },
    };
    let brdf = brdf.map_err(fault)?;
    parameters.finish().map_err(fault)?;
    Ok(Named { brdf, name, identity })
}

/// The files that a named model may read: the fits of `sgd` and `abc`, and the spectra of colours.
pub fn files_of(text: &str) -> Vec<PathBuf> {
    let Some((model, rest)) = text.strip_prefix(PREFIX).and_then(|text| text.split_once(':')) else {
        return Vec::new();
    };
    let mut files: Vec<PathBuf> =
        rest.split(',').filter_map(|part| part.split_once('=')).map(|(_, value)| value.into()).collect();
    if ["sgd", "abc"].contains(&model) {
        files.extend(default_file(model).ok());
    }
    files
}

fn fits_file(model: &str, parameters: &mut Parameters<'_>) -> Result<PathBuf, ReadError> {
    parameters.text("file").map_or_else(|| default_file(model), |file| Ok(file.into()))
}

fn default_file(model: &str) -> Result<PathBuf, ReadError> {
    let name = format!("{model}_fit_params.csv");
    std::env::var_os("SRBF_DATA_DIR").map(|folder| Path::new(&folder).join("merl").join(name)).ok_or_else(
        || ReadError::Content("`file=PATH` is needed, or SRBF_DATA_DIR set to the data folder".into()),
    )
}

/// Half vector of two directions, normalised, and its cosine with either.
fn half(wi: [f64; 3], wo: [f64; 3]) -> ([f64; 3], f64) {
    let mut h = [0, 1, 2].map(|k| wi[k] + wo[k]);
    let length = libm::sqrt(dot(h, h)).max(f64::MIN_POSITIVE);
    h.iter_mut().for_each(|v| *v /= length);
    (h, dot(wi, h).min(1.0))
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(super) fn parse(text: &str) -> Result<Named, FitError> {
        super::parse(text, &mut |given| match given {
            Given::Rgb(rgb) => Ok(rgb),
            Given::File(path) => Err(ReadError::Content(path.display().to_string())),
        })
    }
    use crate::numeric::random::Random;
    use crate::table::direction;
    use std::f64::consts::PI;

    /// The albedo towards `wo`, by a quadrature that is fine round the mirror direction: polar coordinates about it, the
    /// angle in a power of 3.
    pub(super) fn albedo(brdf: &dyn Brdf, wo: [f64; 3], channel: usize) -> f64 {
        let mirror = [-wo[0], -wo[1], wo[2]];
        let helper = if mirror[2].abs() > 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 0.0, 1.0] };
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let mut t = cross(helper, mirror);
        let length = libm::sqrt(dot(t, t));
        t.iter_mut().for_each(|v| *v /= length);
        let b = cross(mirror, t);
        let (rings, spokes) = (1500, 720);
        let mut sum = 0.0;
        for i in 0..rings {
            let u = (f64::from(i) + 0.5) / f64::from(rings);
            let (st, ct) = libm::sincos(PI * u * u * u);
            let ring = st * 3.0 * PI * u * u / f64::from(rings) * 2.0 * PI / f64::from(spokes);
            for j in 0..spokes {
                let (sp, cp) = libm::sincos(2.0 * PI * (f64::from(j) + 0.5) / f64::from(spokes));
                let wi = [0, 1, 2].map(|k| mirror[k] * ct + (t[k] * cp + b[k] * sp) * st);
                if wi[2] > 0.0 {
                    sum += ring * brdf.evaluate(wi, wo)[channel] * wi[2];
                }
            }
        }
        sum
    }

    const ALL: [&str; 17] = [
        "ross-li",
        "rpv",
        "hapke",
        "hapke:w=0.99",
        "cox-munk",
        "abg",
        "harvey-shack",
        "oren-nayar:albedo=1,sigma=0.5",
        "sheen:alpha=0.3,tint=0.9/0.5/0.1",
        "lambert",
        "lambert:albedo=0.1/0.2/0.3",
        "phong:exponent=20",
        "ward:alpha=0.3",
        "ward:alpha_x=0.1,alpha_y=0.4,specular=0.3/0.2/0.1",
        "ggx:alpha=0.3,f0=0.9/0.8/0.2",
        "ggx:alpha_x=0.1,alpha_y=0.35,ior=1.5,diffuse=0.2",
        "ggx:alpha=0.05,ior=1.5",
    ];

    #[test]
    fn every_model_is_reciprocal_and_keeps_energy() {
        let mut random = Random::new(21);
        for text in ALL {
            let model = parse(text).unwrap().brdf;
            for _ in 0..200 {
                let mut at = || direction(1.5 * random.uniform(), 6.3 * random.uniform());
                let (a, b) = (at(), at());
                let (f, g) = (model.evaluate(a, b), model.evaluate(b, a));
                for c in 0..3 {
                    assert!((f[c] - g[c]).abs() <= 1e-12 * f[c].abs(), "{text}: {f:?} {g:?}");
                    assert!(f[c] >= 0.0 && f[c].is_finite(), "{text}: {f:?}");
                }
            }
            for (theta, phi) in [(0.0, 0.0), (0.6, 0.4), (1.2, 1.1)] {
                let albedo = albedo(model.as_ref(), direction(theta, phi), 0);
                assert!((0.0..1.0).contains(&albedo), "{text} {theta}: {albedo}");
            }
        }
    }

    #[test]
    fn only_models_that_depend_on_the_azimuth_are_anisotropic() {
        use crate::table::Symmetry;
        for text in ALL {
            let is_isotropic = parse(text).unwrap().brdf.symmetry() == Symmetry::Isotropic;
            assert_eq!(is_isotropic, !text.contains("alpha_x"), "{text}");
        }
        assert_eq!(parse("ward:alpha_x=0.2,alpha_y=0.2").unwrap().brdf.symmetry(), Symmetry::Isotropic);
    }

    #[test]
    fn mistakes_are_named() {
        for (text, expected) in [
            ("", "no model"),
            ("blinn", "blinn"),
            ("lambert:albedo", "albedo"),
            ("lambert:albedo=1.5", "0 to 1"),
            ("lambert:albedo=x", "`x`"),
            ("lambert:albedo=nan", "nan"),
            ("lambert:albedo=0.1/0.2", "0.1/0.2"),
            ("lambert:albedo=0.1,albedo=0.2", "twice"),
            ("lambert:colour=0.1", "colour"),
            ("phong:diffuse=0.8,specular=0.8", "more than 1"),
            ("phong:exponent=-1", "exponent"),
            ("ward:alpha=0", "alpha"),
            ("ward:alpha=0.1,alpha_x=0.2", "alpha_x"),
            ("ggx:f0=0.5,ior=1.5", "ior"),
            ("ggx:ior=0.5", "ior"),
            ("sgd:file=/nowhere.csv,name=x", "nowhere"),
        ] {
            let error = parse(text).err().unwrap_or_else(|| panic!("{text} is taken"));
            let mut shown = error.to_string();
            let mut source = std::error::Error::source(&error);
            while let Some(s) = source {
                shown += &format!(": {s}");
                source = s.source();
            }
            assert!(shown.contains(expected), "{text}: {shown}");
        }
    }
}
