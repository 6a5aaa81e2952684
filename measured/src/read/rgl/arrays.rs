//! The fields of a `.bsdf` file, checked against each other.

use super::super::spectrum::ToRgb;
use super::tensor::{File, Numbers};
use super::warp::{Grid, Warp};
use crate::ReadError;
use srbf_core::LUMINANCE;
use std::f64::consts::{FRAC_PI_2, PI};

/// Most outgoing directions and wavelengths: real files have at most 16 x 8, and 195.
const MAX_DIRECTIONS: usize = 4096;
const MAX_WAVELENGTHS: usize = 4096;

/// Largest number of a picture, and least projected area: no product or quotient of some of them overflows.
const LARGEST: f64 = 1e30;
const LEAST_AREA: f64 = 1e-30;

/// The arrays of a material.
#[derive(Clone, Debug)]
pub(super) struct Arrays<T = f64> {
    /// Angles of the measured outgoing directions, radians, rising; one azimuth if isotropic.
    pub phis: Vec<T>,
    pub thetas: Vec<T>,
    /// Distribution of normals over (theta, phi).
    pub ndf: Grid<T>,
    /// Projected area of the normals.
    pub sigma: Grid<T>,
    /// Visible normals, one warp for each outgoing direction, theta fastest.
    pub visible: Vec<Warp<T>>,
    /// Brightness of the colour, one warp for each outgoing direction.
    pub luminance: Vec<Warp<T>>,
    /// Colour, for each outgoing direction and channel.
    pub rgb: Vec<[Grid<T>; 3]>,
    /// Whether the colour is without `D / (4 sigma)`.
    pub jacobian: bool,
}

impl Arrays {
    /// The same in f32.
    pub fn to_f32(&self) -> Arrays<f32> {
        let one = |v: f64| v as f32;
        // As in pictures of other tables: black where nothing was measured.
        let colour = |v: f64| if v.is_nan() { 0.0 } else { v as f32 };
        let warps = |all: &[Warp]| all.iter().map(|warp| warp.to(one)).collect();
        Arrays {
            phis: self.phis.iter().map(|v| one(*v)).collect(),
            thetas: self.thetas.iter().map(|v| one(*v)).collect(),
            ndf: self.ndf.to(one),
            sigma: self.sigma.to(one),
            visible: warps(&self.visible),
            luminance: warps(&self.luminance),
            rgb: self.rgb.iter().map(|rgb| rgb.each_ref().map(|grid| grid.to(colour))).collect(),
            jacobian: self.jacobian,
        }
    }
}

impl Arrays {
    /// The same with fewer numbers: warps of `warp` by `warp`, and pictures of `picture` by `picture`. Gives how many numbers an
    /// evaluation needs of it. `None` if a warp has no mass then.
    pub fn coarser(&self, warp: usize, picture: usize) -> Option<(Self, usize)> {
        // Of an isotropic file the rows are the same.
        let flat = |grid: &Grid| grid.resampled(warp.min(grid.size()[0]), grid.size()[1]);
        let rows = |grid: &Grid| if self.phis.len() == 1 { 1 } else { grid.size()[1] };
        let rgb = self.rgb.iter().map(|rgb| rgb.each_ref().map(|grid| grid.resampled(picture, picture)));
        let (ndf, sigma) = (flat(&self.ndf), flat(&self.sigma));
        let slices = self.rgb.len() * (warp * warp + 3 * picture * picture);
        let count = [&ndf, &sigma].iter().map(|grid| grid.size()[0] * rows(grid)).sum::<usize>() + slices;
        let coarse = Self {
            phis: self.phis.clone(),
            thetas: self.thetas.clone(),
            ndf,
            sigma,
            visible: self.visible.iter().map(|w| w.resampled(warp)).collect::<Option<_>>()?,
            luminance: self.luminance.clone(),
            rgb: rgb.collect(),
            jacobian: self.jacobian,
        };
        Some((coarse, count))
    }
}

fn fail<T>(text: String) -> Result<T, ReadError> {
    Err(ReadError::Content(text))
}

/// Reads and checks every field that an evaluation needs.
pub(super) fn read(file: &File<'_>) -> Result<Arrays, ReadError> {
    let mut phis = angles(file, "phi_i", -PI, PI)?;
    let thetas = angles(file, "theta_i", 0.0, FRAC_PI_2)?;
    let slices = phis.len() * thetas.len();
    if slices > MAX_DIRECTIONS {
        return fail(format!("{slices} outgoing directions; at most {MAX_DIRECTIONS}"));
    }
    // Isotropic: the slices of a second phi_i repeat the first.
    if phis.len() == 2 {
        phis.truncate(1);
    }
    let used = phis.len() * thetas.len();

    let (ndf, sigma) = (flat(file, "ndf")?, flat(file, "sigma")?);
    if sigma.least() < LEAST_AREA {
        return fail(format!("field sigma: {} where an area above {LEAST_AREA} was expected", sigma.least()));
    }

    let vndf = file.numbers("vndf", 4)?;
    check_slices("vndf", &vndf, [&phis, &thetas], slices)?;
    let visible = (0..used)
        .map(|n| picture("vndf", &vndf, n).and_then(|g| Warp::new(g).ok_or_else(|| black(n))))
        .collect::<Result<Vec<_>, _>>()?;

    let rgb = colours(file, used, slices, phis.len() == 1)?;
    let luminance = luminances(file, &rgb, [&phis, &thetas], slices)?;
    Ok(Arrays { rgb, luminance, phis, thetas, ndf, sigma, visible, jacobian: jacobian(file)? })
}

/// Rising angles within a range, at least one.
fn angles(file: &File<'_>, name: &str, low: f64, high: f64) -> Result<Vec<f64>, ReadError> {
    let list = file.numbers(name, 1)?.to_vec();
    if let Some(n) = (1..list.len()).find(|&n| list[n] <= list[n - 1]) {
        return fail(format!("field {name}: {} after {}; the angles have to rise", list[n], list[n - 1]));
    }
    let (first, last) = (list[0], list[list.len() - 1]);
    if first < low - 1e-3 || last > high + 1e-3 {
        return fail(format!("field {name}: from {first} to {last}; from {low} to {high} was expected"));
    }
    Ok(list)
}

/// A field that is one picture.
fn flat(file: &File<'_>, name: &str) -> Result<Grid, ReadError> {
    picture(name, &file.numbers(name, 2)?, 0)
}

/// Picture number `n` of a field whose last two dimensions are rows and columns.
fn picture(name: &str, field: &Numbers<'_>, n: usize) -> Result<Grid, ReadError> {
    let [.., rows, columns] = field.shape[..] else {
        return fail(format!("field {name}: two dimensions or more were expected"));
    };
    let cells = rows * columns;
    let values: Vec<f64> = (n * cells..(n + 1) * cells).map(|i| field.value(i)).collect();
    if let Some(i) = values.iter().position(|v| v.abs() > LARGEST) {
        let (row, column) = (i / columns, i % columns);
        return fail(format!(
            "field {name}, picture {n}, row {row}, column {column}: {} where at most {LARGEST} in size was expected",
            values[i]
        ));
    }
    Grid::new(values, columns, rows).ok_or_else(|| {
        ReadError::Content(format!(
            "field {name}: pictures of {rows} x {columns}; at least 2 x 2 was expected"
        ))
    })
}

fn black(n: usize) -> ReadError {
    ReadError::Content(format!("field vndf, outgoing direction {n}: all numbers are 0 or less"))
}

/// Whether a field has a slice for every outgoing direction.
fn check_slices(
    name: &str,
    field: &Numbers<'_>,
    [phis, thetas]: [&[f64]; 2],
    slices: usize,
) -> Result<(), ReadError> {
    let (shape, theta_count) = (field.shape, thetas.len());
    let phi_count = slices / theta_count;
    debug_assert!(phis.len() <= phi_count);
    if shape[0] == phi_count && shape[1] == theta_count {
        return Ok(());
    }
    fail(format!(
        "field {name}: {} x {} slices where phi_i and theta_i have {phi_count} x {theta_count}",
        shape[0], shape[1]
    ))
}

/// The colours, from `rgb`, or from `spectra` and `wavelengths`. Those of isotropic files may have holes, which are filled later.
fn colours(
    file: &File<'_>,
    used: usize,
    slices: usize,
    may_have_holes: bool,
) -> Result<Vec<[Grid; 3]>, ReadError> {
    let name = if file.find("rgb").is_some() { "rgb" } else { "spectra" };
    let field = if may_have_holes { file.numbers_or_holes(name, 5)? } else { file.numbers(name, 5)? };
    let channels = field.shape[2];
    if field.shape[0] * field.shape[1] != slices {
        return fail(format!(
            "field {name}: {} x {} slices where phi_i and theta_i have {slices}",
            field.shape[0], field.shape[1]
        ));
    }
    let picture = |n: usize| picture(name, &field, n);
    if name == "rgb" {
        if channels != 3 {
            return fail(format!("field rgb: {channels} channels where 3 were expected"));
        }
        return (0..used).map(|n| Ok([picture(3 * n)?, picture(3 * n + 1)?, picture(3 * n + 2)?])).collect();
    }
    let wavelengths = file.numbers("wavelengths", 1)?.to_vec();
    if wavelengths.len() != channels || channels > MAX_WAVELENGTHS {
        return fail(format!(
            "field spectra: {channels} channels where wavelengths has {}; at most {MAX_WAVELENGTHS}",
            wavelengths.len()
        ));
    }
    let to_rgb = ToRgb::new(&wavelengths)?;
    // The conversion is linear, so it may come before the interpolation; it is not clamped, as the RGB files are not.
    let colour = |n: usize| {
        let zero = picture(n * channels)?.zeros();
        let mut sums = [zero.clone(), zero.clone(), zero];
        for (w, weights) in to_rgb.weights().iter().enumerate() {
            let spectral = picture(n * channels + w)?;
            sums.iter_mut().zip(weights).for_each(|(sum, share)| sum.add_scaled(*share, &spectral));
        }
        Ok(sums)
    };
    (0..used).map(colour).collect()
}

/// Pictures of three wavelengths in place of a colour, of each outgoing direction.
///
/// # Errors
/// A field `spectra` that is not as [`read`] found it.
pub(super) fn wavelengths(
    file: &File<'_>,
    views: usize,
    of: [usize; 3],
) -> Result<Vec<[Grid; 3]>, ReadError> {
    let field = file.numbers_or_holes("spectra", 5)?;
    let (channels, slices) = (field.shape[2], field.shape[0] * field.shape[1]);
    if views > slices || of.iter().any(|&n| n >= channels) {
        return fail(format!(
            "field spectra: {slices} slices of {channels} channels where more were expected"
        ));
    }
    let one = |n: usize, of: usize| picture("spectra", &field, n * channels + of);
    (0..views).map(|n| Ok([one(n, of[0])?, one(n, of[1])?, one(n, of[2])?])).collect()
}

/// The warps by brightness that directions are drawn with: of `luminance` if there is one, else of the colours. Where all is black
/// every point is as good.
fn luminances(
    file: &File<'_>,
    rgb: &[[Grid; 3]],
    directions: [&[f64]; 2],
    slices: usize,
) -> Result<Vec<Warp>, ReadError> {
    let name = "luminance";
    let field = file.find(name).map(|_| file.numbers_or_holes(name, 4)).transpose()?;
    if let Some(field) = &field {
        check_slices(name, field, directions, slices)?;
    }
    let even = || Grid::new(vec![1.0; 4], 2, 2).and_then(Warp::new);
    let grid = |(n, colour): (usize, &[Grid; 3])| match &field {
        Some(field) => picture(name, field, n),
        None => Ok(brightness(colour)),
    };
    // No direction is drawn where nothing was measured.
    let dark = |grid: Grid| grid.to(|v: f64| if v.is_nan() { 0.0 } else { v });
    let grids: Vec<Grid> =
        rgb.iter().enumerate().map(|slice| grid(slice).map(dark)).collect::<Result<_, _>>()?;
    let warps: Option<Vec<Warp>> = grids.into_iter().map(Warp::new).collect();
    // Warps of different sizes cannot be blended: if one is black, none is used.
    let warps = warps.or_else(|| Some(vec![even()?; rgb.len()]));
    warps.ok_or_else(|| ReadError::Content(format!("field {name}: no warp")))
}

/// Luminance of a colour.
fn brightness(rgb: &[Grid; 3]) -> Grid {
    let mut sum = rgb[0].zeros();
    rgb.iter().zip(LUMINANCE).for_each(|(channel, share)| sum.add_scaled(f64::from(share), channel));
    sum
}

/// Whether the colour is without the factor that the warp brings.
fn jacobian(file: &File<'_>) -> Result<bool, ReadError> {
    match file.find("jacobian").map(|f| f.bytes) {
        None | Some([1]) => Ok(true),
        Some([0]) => Ok(false),
        Some(bytes) => fail(format!("field jacobian: {} bytes; one, 0 or 1, was expected", bytes.len())),
    }
}
