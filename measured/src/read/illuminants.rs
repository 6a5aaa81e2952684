//! Colours of spectra under three lights, and how far two of them are apart.

use super::spectrum::{WEIGHTS, resampled, rgb_of_xyz};
use crate::ReadError;
use crate::file::spectrum::SpectralCurve;

/// A light of the CIE.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Illuminant {
    /// Daylight, in which linear sRGB is white.
    D65,
    /// An incandescent lamp.
    A,
    /// A fluorescent lamp of three narrow bands.
    F11,
}

impl Illuminant {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::D65, Self::A, Self::F11];

    /// Its name.
    pub fn name(self) -> &'static str {
        ["D65", "A", "F11"][self as usize]
    }

    /// Weights of the wavelengths, nm and rising, to X, Y, Z of a reflectance; Y of a reflectance of 1 is 1.
    pub fn weights(self, wavelengths: &[f64]) -> Vec<[f64; 3]> {
        if wavelengths.is_empty() {
            return Vec::new();
        }
        match self {
            Self::D65 => resampled(&WEIGHTS, wavelengths).into_iter().map(xyz_of_rgb).collect(),
            Self::A => resampled(&INCANDESCENT, wavelengths),
            Self::F11 => resampled(&FLUORESCENT, wavelengths),
        }
    }
}

/// The wavelengths of [`under`] and [`seen`]: 400, 410, ... 700 nm.
pub fn wavelengths() -> [f64; 31] {
    std::array::from_fn(|n| 400.0 + 10.0 * n as f64)
}

/// Weights of 400, 410, ... 700 nm to X, Y, Z of a reflectance under a light whose power was measured, in any unit; Y of a reflectance of 1
/// is 1. The power counts as its mean about each of these wavelengths, within 10 nm on either side.
///
/// # Errors
/// [`ReadError::Content`] for a light that is black there.
pub fn under(light: &SpectralCurve) -> Result<[[f64; 3]; 31], ReadError> {
    let mut weights = INCANDESCENT;
    let mut bright = 0.0;
    for (weights, nm) in weights.iter_mut().zip(wavelengths()) {
        // The mean over the wavelengths of a weight: nearer ones count more.
        let near = |by: i32| (1.0 - 0.1 * f64::from(by.abs())) * light.at(nm + f64::from(by));
        let power = 0.1 * (-9..=9).map(near).sum::<f64>();
        weights.iter_mut().for_each(|weight| *weight *= power / incandescent(nm));
        bright += weights[1];
    }
    if bright <= 0.0 {
        return Err(ReadError::Content("a light that is not black from 400 to 700 nm is expected".into()));
    }
    weights.as_flattened_mut().iter_mut().for_each(|weight| *weight /= bright);
    Ok(weights)
}

/// Relative power of illuminant A at a wavelength in nm (CIE 15): 1 at 560 nm.
fn incandescent(nm: f64) -> f64 {
    let planck = |nm: f64| libm::pow(560.0 / nm, 5.0) / libm::expm1(1.435e7 / (2848.0 * nm));
    planck(nm) / planck(560.0)
}

/// Linear sRGB of weights to X, Y, Z of a reflectance, to an eye that is used to the light: a reflectance of 1 is white.
///
/// Source: the transform of Bradford (Lam 1985), of the responses of three kinds of cones.
pub fn seen(weights: &[[f64; 3]]) -> Vec<[f64; 3]> {
    const CONES: [[f64; 3]; 3] =
        [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];
    const BACK: [[f64; 3]; 3] = [
        [0.9869929, -0.1470543, 0.1599627],
        [0.4323053, 0.5183603, 0.0492912],
        [-0.0085287, 0.0400428, 0.9684867],
    ];
    let by =
        |matrix: &[[f64; 3]; 3], v: [f64; 3]| matrix.map(|row| (0..3).map(|c| row[c] * v[c]).sum::<f64>());
    let white = by(&CONES, weighed(weights, std::iter::repeat(1.0)));
    let day = by(&CONES, xyz_of_rgb([1.0; 3]));
    let adapted = |xyz: &[f64; 3]| {
        let cones = by(&CONES, *xyz);
        rgb_of_xyz(by(&BACK, [0, 1, 2].map(|c| cones[c] * day[c] / white[c])))
    };
    let mut found: Vec<[f64; 3]> = weights.iter().map(adapted).collect();
    // The matrices have seven digits.
    let sums = weighed(&found, std::iter::repeat(1.0));
    found.iter_mut().for_each(|rgb| rgb.iter_mut().zip(sums).for_each(|(v, sum)| *v /= sum));
    found
}

/// CIE 1931 X, Y, Z of linear sRGB.
fn xyz_of_rgb([r, g, b]: [f64; 3]) -> [f64; 3] {
    [
        0.4124564 * r + 0.3575761 * g + 0.1804375 * b,
        0.2126729 * r + 0.7151522 * g + 0.072175 * b,
        0.0193339 * r + 0.119192 * g + 0.9503041 * b,
    ]
}

/// Sums of a spectrum with weights.
pub(crate) fn weighed(weights: &[[f64; 3]], spectrum: impl Iterator<Item = f64>) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for (weights, value) in weights.iter().zip(spectrum) {
        sums.iter_mut().zip(weights).for_each(|(sum, weight)| *sum += weight * value);
    }
    sums
}

/// L*, a*, b* of CIE 1976 beside a white.
fn lab(xyz: [f64; 3], white: [f64; 3]) -> [f64; 3] {
    const DELTA: f64 = 6.0 / 29.0;
    let [x, y, z] = [0, 1, 2].map(|c| {
        let v = xyz[c] / white[c];
        if v > DELTA * DELTA * DELTA { libm::cbrt(v) } else { v / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
    });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// The difference dE of CIE 2000 of two colours under one light; 1 is just visible side by side.
pub fn difference_2000(xyz: [[f64; 3]; 2], white: [f64; 3]) -> f64 {
    use std::f64::consts::TAU;
    let [[l1, a1, b1], [l2, a2, b2]] = xyz.map(|xyz| lab(xyz, white));
    let degrees = |v: f64| libm::sin(v.to_radians());
    let power = |c: f64| {
        let c7 = libm::pow(c, 7.0);
        libm::sqrt(c7 / (c7 + 6_103_515_625.0))
    };
    let chroma = |a: f64, b: f64| libm::sqrt(a * a + b * b);
    let shared = 0.5 * (1.0 - power(0.5 * (chroma(a1, b1) + chroma(a2, b2))));
    let [a1, a2] = [a1, a2].map(|a| a * (1.0 + shared));
    let [c1, c2] = [chroma(a1, b1), chroma(a2, b2)];
    let hue = |a: f64, b: f64| if a == 0.0 && b == 0.0 { 0.0 } else { libm::atan2(b, a).rem_euclid(TAU) };
    let [h1, h2] = [hue(a1, b1), hue(a2, b2)];
    let is_grey = c1 * c2 == 0.0;
    let turn = if is_grey { 0.0 } else { (h2 - h1 + 1.5 * TAU).rem_euclid(TAU) - 0.5 * TAU };
    let middle = match () {
        () if is_grey => h1 + h2,
        () if (h1 - h2).abs() <= 0.5 * TAU => 0.5 * (h1 + h2),
        () if h1 + h2 < TAU => 0.5 * (h1 + h2 + TAU),
        () => 0.5 * (h1 + h2 - TAU),
    }
    .to_degrees();
    let (l, c) = (0.5 * (l1 + l2), 0.5 * (c1 + c2));
    let cosine = |times: f64, less: f64| degrees(times * middle - less + 90.0);
    let t = 1.0 - 0.17 * cosine(1.0, 30.0) + 0.24 * cosine(2.0, 0.0) + 0.32 * cosine(3.0, -6.0)
        - 0.2 * cosine(4.0, 63.0);
    let l50 = (l - 50.0) * (l - 50.0);
    let lightness = (l2 - l1) / (1.0 + 0.015 * l50 / libm::sqrt(20.0 + l50));
    let chroma = (c2 - c1) / (1.0 + 0.045 * c);
    let hue = 2.0 * libm::sqrt(c1 * c2) * libm::sin(0.5 * turn) / (1.0 + 0.015 * c * t);
    let blue = 60.0 * libm::exp(-((middle - 275.0) / 25.0) * ((middle - 275.0) / 25.0));
    let together = -2.0 * power(c) * degrees(blue);
    libm::sqrt((lightness * lightness + chroma * chroma + hue * hue + together * chroma * hue).max(0.0))
}

/// Weights to X, Y, Z at 400, 410, ... 700 nm: CIE 1931 2 degree colour matching functions times illuminant A, integrated over 1 nm with
/// spectra linear between these and constant beyond.
#[rustfmt::skip]
const INCANDESCENT: [[f64; 3]; 31] = [
    [0.0002885658, 8.057692e-06, 0.001368024],
    [0.0008175021, 2.288315e-05, 0.003902809],
    [0.00283186, 8.989539e-05, 0.01364523],
    [0.006385149, 0.0002783781, 0.03125804],
    [0.009115313, 0.0006270733, 0.04586776],
    [0.01023733, 0.001197434, 0.05416518],
    [0.0100087, 0.002146774, 0.0575975],
    [0.007705281, 0.003707697, 0.05069895],
    [0.00433873, 0.006328892, 0.03648786],
    [0.001705939, 0.01067341, 0.0236664],
    [0.0003963179, 0.01841615, 0.0153519],
    [0.0008550895, 0.03118288, 0.009748949],
    [0.004602444, 0.04751072, 0.005474307],
    [0.01237125, 0.06297906, 0.003134391],
    [0.02339927, 0.07573728, 0.001669246],
    [0.03762977, 0.0854327, 0.0007922946],
    [0.05533088, 0.0918577, 0.0003799174],
    [0.07578348, 0.09418107, 0.0002189746],
    [0.09693722, 0.09187889, 0.0001714715],
    [0.1152206, 0.08516388, 0.0001300285],
    [0.1261333, 0.07530859, 9.474808e-05],
    [0.1256807, 0.06350071, 4.853845e-05],
    [0.1127076, 0.05059759, 2.371866e-05],
    [0.08992758, 0.03728594, 8.302065e-06],
    [0.06571598, 0.02578869, 2.921431e-06],
    [0.04382683, 0.0165936, 4.68857e-07],
    [0.02670837, 0.009902295, 0.0],
    [0.0149592, 0.005483244, 0.0],
    [0.008186532, 0.002978058, 0.0],
    [0.004215917, 0.001525694, 0.0],
    [0.004471065, 0.001614754, 0.0],
];

/// The same of illuminant F11.
#[rustfmt::skip]
const FLUORESCENT: [[f64; 3]; 31] = [
    [0.0005779939, 1.600218e-05, 0.002744849],
    [0.001072199, 2.986572e-05, 0.005109765],
    [0.002705183, 8.7158e-05, 0.01304538],
    [0.02479786, 0.001192845, 0.1220494],
    [0.03648207, 0.002260064, 0.1822606],
    [0.01666684, 0.001905985, 0.08794985],
    [0.01308738, 0.002723391, 0.07496618],
    [0.007512668, 0.003441674, 0.04898477],
    [0.004657185, 0.008151152, 0.04119953],
    [0.003108773, 0.0176942, 0.04171534],
    [0.0003795048, 0.01120882, 0.01153384],
    [0.0001199162, 0.005546312, 0.002036902],
    [0.0004247208, 0.004579362, 0.0005573026],
    [0.005345736, 0.02194796, 0.0007718058],
    [0.08196048, 0.2465087, 0.004475297],
    [0.09715682, 0.2393566, 0.002667854],
    [0.01833782, 0.03352982, 0.0001764115],
    [0.01544908, 0.01830902, 4.08444e-05],
    [0.06437117, 0.05897056, 0.0001080877],
    [0.08485523, 0.06363596, 9.815413e-05],
    [0.07643846, 0.04484291, 5.401427e-05],
    [0.2503666, 0.1245165, 8.60221e-05],
    [0.1338167, 0.06133376, 3.104081e-05],
    [0.04715954, 0.01968923, 4.733108e-06],
    [0.01105349, 0.004376756, 5.454488e-07],
    [0.00584837, 0.002212143, 5.317282e-08],
    [0.003014694, 0.00111882, 0.0],
    [0.001083528, 0.0003974322, 0.0],
    [0.0004979368, 0.0001810926, 0.0],
    [0.000290616, 0.0001051794, 0.0],
    [0.0003620536, 0.0001307535, 0.0],
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Pairs of G. Sharma, W. Wu and E. Dalal, 2005, with their differences: hues on either side of 0, greys, large ones.
    #[test]
    fn differences_are_those_of_published_pairs() {
        let white = [0.95047, 1.0, 1.08883];
        let xyz = |[l, a, b]: [f64; 3]| {
            let y = (l + 16.0) / 116.0;
            let v = [y + a / 500.0, y, y - b / 200.0].map(|f: f64| {
                if f > 6.0 / 29.0 { f.powi(3) } else { 3.0 * (6.0f64 / 29.0).powi(2) * (f - 4.0 / 29.0) }
            });
            [0, 1, 2].map(|c| v[c] * white[c])
        };
        for (a, b, expected) in [
            ([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485], 2.0425),
            ([50.0, 2.8361, -74.02], [50.0, 0.0, -82.7485], 3.4412),
            ([50.0, -1.3802, -84.2814], [50.0, 0.0, -82.7485], 1.0),
            ([50.0, 0.0, 0.0], [50.0, -1.0, 2.0], 2.3669),
            ([50.0, 2.49, -0.001], [50.0, -2.49, 0.0009], 7.1792),
            ([50.0, 2.49, -0.001], [50.0, -2.49, 0.0011], 7.2195),
            ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.1492),
            ([50.0, 2.5, 0.0], [58.0, 24.0, 15.0], 19.4535),
            ([22.7233, 20.0904, -46.694], [23.0331, 14.973, -42.5619], 2.0373),
            ([90.9257, -0.5406, -0.9208], [88.6381, -0.8985, -0.7239], 1.5381),
            ([2.0776, 0.0795, -1.135], [0.9033, -0.0636, -0.5514], 0.9082),
        ] {
            for pair in [[a, b], [b, a]] {
                let found = difference_2000(pair.map(xyz), white);
                assert!((found - expected).abs() < 1e-4, "{pair:?}: {found} {expected}");
            }
        }
    }

    #[test]
    fn white_is_the_white_of_each_light() {
        let wavelengths: Vec<f64> = (0..61).map(|i| 400.0 + 5.0 * f64::from(i)).collect();
        for (light, white) in Illuminant::ALL.into_iter().zip([
            [0.95047, 1.0, 1.08883],
            [1.0985, 1.0, 0.35585],
            [1.00962, 1.0, 0.6435],
        ]) {
            let found = weighed(&light.weights(&wavelengths), std::iter::repeat(1.0));
            let apart = (0..3).map(|c| (found[c] - white[c]).abs()).fold(0.0, f64::max);
            assert!(apart < 1.5e-3, "{}: {found:?}", light.name());
        }
        // A lamp that was measured is the lamp of the tables; white is white to an eye that is used to it.
        let text: String =
            (76..160).map(|n| format!("{} {}\n", 5 * n, 7.0 * incandescent(5.0 * f64::from(n)))).collect();
        let measured = under(&SpectralCurve::parse(text.as_bytes()).unwrap()).unwrap();
        let apart =
            measured.as_flattened().iter().zip(INCANDESCENT.as_flattened()).map(|(a, b)| (a - b).abs());
        assert!(apart.fold(0.0, f64::max) < 1e-3);
        for light in Illuminant::ALL {
            let seen = seen(&light.weights(&super::wavelengths()));
            assert!(weighed(&seen, std::iter::repeat(1.0)).iter().all(|v| (v - 1.0).abs() < 1e-12));
            let apart = seen.as_flattened().iter().zip(WEIGHTS.as_flattened()).map(|(a, b)| (a - b).abs());
            assert_eq!(apart.fold(0.0, f64::max) < 2e-5, light == Illuminant::D65, "{}", light.name());
        }
        assert!(under(&SpectralCurve::parse(b"700 0\n750 0\n900 2").unwrap()).is_err());
        // The matrix is the inverse of the other.
        assert!((0..3).all(|c| {
            let there = super::super::spectrum::rgb_of_xyz(xyz_of_rgb([0.2, 0.5, 0.9]));
            (there[c] - [0.2, 0.5, 0.9][c]).abs() < 1e-5
        }));
    }
}
