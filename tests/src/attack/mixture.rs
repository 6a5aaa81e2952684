//! Mixtures of lobes of one's own, at every end of their ranges.

use super::input::{any_direction, random, uniform};
use crate::inputs::{Random, levels};
use glam::Vec3;
use srbf_core::{AnyMixture, Domain, Draws, Error, Lobe, Mixture, Towards};

/// Directions of a batch: one more than fills vectors of any width.
const BATCH: usize = 17;

/// Largest amplitude whose square, times a sphere and the number of pairs of lobes, is a float.
const LARGEST_TO_MULTIPLY: f32 = 1e16;

/// Builds lobes of five bytes each, and mixtures of them.
pub fn mixture(bytes: &[u8]) -> bool {
    let Some((head, rest)) = bytes.split_first_chunk::<4>() else { return false };
    let mut random = random(bytes);
    let squeeze = [1.0, 0.01, 2.0, 0.5, 0.010_000_1, 1.999_9][usize::from(head[1] % 6)];
    let lobes: Vec<Lobe> = rest.as_chunks::<5>().0.iter().take(40).filter_map(lobe).collect();
    if lobes.is_empty() {
        return false;
    }
    let squeezed = usize::from(head[2]) % (lobes.len() + 1);
    let domain = if head[3] & 1 == 0 { Domain::Hemisphere } else { Domain::Sphere };
    let Ok(m) = Mixture::<64>::new(domain, squeeze, &lobes[..squeezed], &lobes[squeezed..]) else {
        return false;
    };
    let albedo = [f32::from(head[3]) / 300.0; 3];
    let m = if head[3] & 2 == 0 { m } else { m.clone().with_diffuse(albedo).unwrap_or(m) };
    for level in levels() {
        let m = m.clone().with_level(level).expect("an available level");
        check(&m, &mut random, &format!("{level:?}, squeeze {squeeze} of {squeezed}, {domain:?}"));
    }
    // Products of round lobes: a number, or an error. Where powers multiply to more than a float holds, it may be that of amplitudes.
    let largest = lobes.iter().map(|lobe| lobe.amplitude.abs().max_element()).fold(0.0, f32::max);
    let one = Mixture::<16>::sphere(&lobes[..1]).expect("a lobe of the mixture");
    for product in [m.inner_product(&m), m.inner_product(&one)] {
        let holds = match product {
            Ok(integral) => integral.is_finite(),
            Err(Error::Amplitude) => largest > LARGEST_TO_MULTIPLY,
            Err(error) => error == Error::Squeezed,
        };
        assert!(holds, "inner product {product:?}");
    }
    true
}

/// A lobe whose numbers lie over their whole ranges, ends included.
fn lobe(bytes: &[u8; 5]) -> Option<Lobe> {
    let [tilt, azimuth, sharpness, amplitude, color] = *bytes;
    let axis = match tilt % 8 {
        0 => Vec3::Z,
        1 => Vec3::X,
        2 => Vec3::NEG_Z,
        _ => {
            let [theta, phi] = [
                f32::from(tilt) / 255.0 * core::f32::consts::PI,
                f32::from(azimuth) / 255.0 * core::f32::consts::TAU,
            ];
            Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()).normalize()
        }
    };
    let sharpness = match sharpness {
        0 => 0.0,
        255 => 1e8,
        254 => 1e8f32.next_down(),
        253 => f32::MIN_POSITIVE,
        252 => f32::from_bits(1),
        code => 10f32.powf(-12.0 + 20.0 * f32::from(code) / 252.0),
    };
    let a = match amplitude {
        0 => 0.0,
        code => 10f32.powf(-44.0 + 70.0 * f32::from(code) / 255.0),
    };
    let amplitude = [a, a * f32::from(color % 16) / 8.0, a * (f32::from(color) / 16.0 - 2.0)];
    Lobe::new(axis, sharpness, amplitude).ok()
}

/// Evaluates a mixture and draws from it, one direction at a time and in batches.
///
/// # Panics
/// If something does not hold; `place` is said then.
pub fn check(mixture: &AnyMixture<'_>, random: &mut Random, place: &str) {
    assert!(mixture.albedo().is_finite() && mixture.power().is_finite(), "{place}: albedo");
    let d: [Vec3; BATCH] = core::array::from_fn(|_| any_direction(random));
    let u: [[f32; 3]; BATCH] = core::array::from_fn(|_| [uniform(random), uniform(random), uniform(random)]);
    #[allow(clippy::type_complexity, clippy::needless_range_loop)] // three rows are written at a time
    let rows = |of: fn(usize, &[Vec3; BATCH], &[[f32; 3]; BATCH]) -> [f32; 3]| {
        let mut rows = [[0.0; BATCH]; 3];
        for n in 0..BATCH {
            let numbers = of(n, &d, &u);
            (0..3).for_each(|i| rows[i][n] = numbers[i]);
        }
        rows
    };
    let [d_rows, u_rows] = [rows(|n, d, _| d[n].to_array()), rows(|n, _, u| u[n])];
    let (mut value, mut pdf) = ([[0.0; BATCH]; 3], [0.0; BATCH]);
    let [x, y, z] = d_rows.each_ref().map(|row| &row[..]);
    mixture
        .ask(
            Towards {
                wi: [x, y, z],
                value: Some(value.each_mut().map(|row| &mut row[..])),
                pdf: Some(&mut pdf),
            }
            .into(),
        )
        .expect("slices of one length");
    for n in 0..BATCH {
        let place = || format!("{place}, {}", d[n]);
        let (one, one_pdf) = mixture.evaluate_and_pdf(d[n]);
        for (value, pdf) in [(Vec3::new(value[0][n], value[1][n], value[2][n]), pdf[n]), (one, one_pdf)] {
            let is_number = value.is_finite() || mixture.domain() == Domain::Sphere;
            assert!(is_number && pdf >= 0.0 && !pdf.is_nan(), "{}: value {value}, density {pdf}", place());
        }
    }
    let (mut direction, mut pdf, mut weight) = ([[0.0; BATCH]; 3], [0.0; BATCH], [[0.0; BATCH]; 3]);
    let samples = Draws {
        u: u_rows.each_ref().map(|row| &row[..]),
        direction: direction.each_mut().map(|row| &mut row[..]),
        pdf: Some(&mut pdf),
        weight: Some(weight.each_mut().map(|row| &mut row[..])),
    };
    mixture.ask(samples.into()).expect("slices of one length");
    let is_folded = mixture.domain() == Domain::Hemisphere;
    for n in 0..BATCH {
        let place = || format!("{place}, {:?}", u[n]);
        let one = mixture.sample(u[n]);
        assert_eq!(one.is_some(), mixture.power() > 0.0, "{}: what reflects draws", place());
        let Some(one) = one else { continue };
        let batch = [direction, weight].map(|rows| Vec3::new(rows[0][n], rows[1][n], rows[2][n]));
        for (direction, pdf, weight) in [(one.direction, one.pdf, one.weight), (batch[0], pdf[n], batch[1])] {
            // Over the sphere a direction may point down.
            let up =
                if is_folded { direction } else { Vec3::new(direction.x, direction.y, direction.z.abs()) };
            is_sound(up, pdf, weight, place);
        }
    }
}

/// A direction of the hemisphere, a density, and a weight that is 0 where there is nothing to divide by.
///
/// # Panics
/// If it is not.
pub fn is_sound(direction: Vec3, pdf: f32, weight: Vec3, place: impl Fn() -> String) {
    let is_drawn = (direction.length() - 1.0).abs() < 1e-6 && direction.z >= 0.0;
    let is_weighed = weight.is_finite() && (weight == Vec3::ZERO || pdf >= f32::MIN_POSITIVE);
    assert!(
        is_drawn && pdf >= 0.0 && pdf.is_finite() && is_weighed,
        "{}: {direction} {pdf:e} {weight}",
        place()
    );
}
