//! Rounding errors by sharpness: the library's result in f32, and that of the plain formula in f32, against f64.

use glam::{DVec3, Vec3};
use srbf_core::{Domain, Folded, Gaussian, Lobe, Mixture, special};
use srbf_reference_renderer::numbers::random::Random;
use std::f32::consts::PI;

/// One operation over all sharpnesses.
pub struct Operation {
    /// The function of the library.
    pub name: &'static str,
    /// Its result.
    pub meaning: &'static str,
    /// The plain formula, evaluated in f32.
    pub plain: &'static str,
    /// The quantity along the rows.
    pub along: &'static str,
    /// A row for each decade, rising.
    pub rows: Vec<Decade>,
}

impl Operation {
    /// The row where ours is worst.
    pub fn worst(&self) -> Option<&Decade> {
        self.rows.iter().max_by(|a, b| a.ours.total_cmp(&b.ours))
    }
}

/// Worst relative errors of one operation within a decade.
pub struct Decade {
    /// Middle of the decade.
    pub at: f64,
    /// The library's.
    pub ours: f64,
    /// The plain formula's, where there is one; infinite where it gives no number.
    pub plain: Option<f64>,
}

/// Largest exponent of the inputs: larger ones have lost 4 of 10000 to rounding the exponent alone.
const EXPONENT: f32 = 10.0;

/// A result in f64, the library's, and the plain formula's.
type Results = (f64, f32, f32);

/// Measures every operation with `inputs` inputs a decade.
pub fn measure(inputs: u32, seed: u64) -> Vec<Operation> {
    type Measure = fn(f32, &mut Random) -> Results;
    let operations: [(&str, &str, &str, Measure); 9] = [
        ("Gaussian::value", "value of a lobe towards a direction", "exp(s (d . axis - 1))", value),
        ("special::sphere_integral", "integral over the sphere", "2 pi (1 - exp(-2 s)) / s", sphere_integral),
        (
            "Gaussian::pdf",
            "density towards a direction",
            "s exp(s (d . axis - 1)) / (2 pi (1 - exp(-2 s)))",
            pdf,
        ),
        (
            "special::cap_integral",
            "integral within an angle of the axis",
            "2 pi (1 - exp(s (cos - 1))) / s",
            cap,
        ),
        (
            "special::one_minus_cos",
            "1 - cos of a sample, from u",
            "cos = 1 + log(1 - u (1 - exp(-2 s))) / s, then 1 - cos",
            one_minus_cos,
        ),
        (
            "GaussianProduct::integral",
            "integral of the product of two lobes",
            "exp(|r| - s1 - s2) I(|r|)",
            product,
        ),
        (
            "Folded::pdf",
            "folded density, squeezed by 0.1",
            "exp(s (u . axis - 1)) + exp(s (u' . axis - 1))",
            folded,
        ),
        ("Mixture::pdf", "the same in the mixture's vector kernels", "as above", mixture),
        ("special::mean_cosine", "mean cosine to the axis", "1 / tanh(s) - 1 / s", mean_cosine),
    ];
    operations
        .into_iter()
        .enumerate()
        .map(|(k, (name, meaning, plain, operation))| {
            let rows = (-8..=8)
                .map(|decade| {
                    let mut random = Random::new(seed, k as u64, (decade + 8) as u64);
                    let mut row = Decade { at: 10f64.powi(decade), ours: 0.0, plain: Some(0.0) };
                    for _ in 0..inputs {
                        let s = 10f32.powf(decade as f32 + random.unit() - 0.5).min(1e8);
                        let (want, ours, plain) = operation(s, &mut random);
                        row.ours = row.ours.max(relative(want, ours));
                        row.plain = row.plain.map(|worst| worst.max(relative(want, plain)));
                    }
                    row
                })
                .collect();
            Operation { name, meaning, plain, along: "sharpness", rows }
        })
        .collect()
}

/// Relative error; infinite for a NaN.
pub fn relative(want: f64, got: f32) -> f64 {
    let error = (f64::from(got) - want).abs() / want.abs();
    if error.is_nan() { f64::INFINITY } else { error }
}

fn direction(random: &mut Random) -> Vec3 {
    let (z, phi) = (2.0 * random.unit() - 1.0, 2.0 * PI * random.unit());
    let r = (1.0 - z * z).sqrt();
    Vec3::new(r * phi.cos(), r * phi.sin(), z).normalize()
}

/// A direction whose exponent with the axis is at most [`EXPONENT`], rounded from f64.
fn near(axis: Vec3, s: f32, random: &mut Random) -> Vec3 {
    let w = f64::from((EXPONENT * random.unit() / s).min(2.0));
    let axis = axis.as_dvec3().normalize();
    let (t, b) = axis.any_orthonormal_pair();
    let (sin_phi, cos_phi) = (f64::from(random.unit()) * std::f64::consts::TAU).sin_cos();
    let sin = (w * (2.0 - w)).sqrt();
    (axis * (1.0 - w) + (t * cos_phi + b * sin_phi) * sin).normalize().as_vec3()
}

/// `s (1 - cos)` of the angle between two vectors.
fn exponent(s: f32, a: DVec3, b: DVec3) -> f64 {
    0.5 * f64::from(s) * (a.normalize() - b.normalize()).length_squared()
}

fn integral_f64(s: f64) -> f64 {
    if s == 0.0 { 4.0 * std::f64::consts::PI } else { -std::f64::consts::TAU * (-2.0 * s).exp_m1() / s }
}

fn integral_plain(s: f32) -> f32 {
    2.0 * PI * (1.0 - (-2.0 * s).exp()) / s
}

fn value(s: f32, random: &mut Random) -> Results {
    let axis = direction(random);
    let d = near(axis, s, random);
    let want = (-exponent(s, axis.as_dvec3(), d.as_dvec3())).exp();
    (want, Gaussian { axis, sharpness: s }.value(d), (s * (d.dot(axis) - 1.0)).exp())
}

fn sphere_integral(s: f32, _: &mut Random) -> Results {
    (integral_f64(f64::from(s)), special::sphere_integral(s), integral_plain(s))
}

fn pdf(s: f32, random: &mut Random) -> Results {
    let axis = direction(random);
    let d = near(axis, s, random);
    let want = (-exponent(s, axis.as_dvec3(), d.as_dvec3())).exp() / integral_f64(f64::from(s));
    let plain = s * (s * (d.dot(axis) - 1.0)).exp() / (2.0 * PI * (1.0 - (-2.0 * s).exp()));
    (want, Gaussian { axis, sharpness: s }.pdf(d), plain)
}

fn cap(s: f32, random: &mut Random) -> Results {
    let w = (EXPONENT * random.unit() / s).min(2.0);
    let want = -std::f64::consts::TAU * (-f64::from(s) * f64::from(w)).exp_m1() / f64::from(s);
    let cos = 1.0 - w;
    (want, special::cap_integral(s, w), 2.0 * PI * (1.0 - (s * (cos - 1.0)).exp()) / s)
}

fn one_minus_cos(s: f32, random: &mut Random) -> Results {
    let u = random.unit().max(1e-7);
    let (s64, u64) = (f64::from(s), f64::from(u));
    let want = -(u64 * (-2.0 * s64).exp_m1()).ln_1p() / s64;
    let cos = 1.0 + (1.0 - u * (1.0 - (-2.0 * s).exp())).ln() / s;
    (want, special::one_minus_cos(u, s), 1.0 - cos)
}

fn product(s: f32, random: &mut Random) -> Results {
    let a = direction(random);
    let b = near(a, s, random);
    let s2 = s * (0.1 + random.unit());
    let r = a.as_dvec3().normalize() * f64::from(s) + b.as_dvec3().normalize() * f64::from(s2);
    let sum = f64::from(s) + f64::from(s2);
    let apart = (a.as_dvec3().normalize() - b.as_dvec3().normalize()).length_squared();
    let e = f64::from(s) * f64::from(s2) * apart / (sum + r.length());
    let want = (-e).exp() * integral_f64(r.length());
    let ours = Gaussian { axis: a, sharpness: s }.product(&Gaussian { axis: b, sharpness: s2 });
    let length = (a * s + b * s2).length();
    (want, ours.integral(), (length - s - s2).exp() * integral_plain(length))
}

/// Squeeze of the folded rows.
const SQUEEZE: f32 = 0.1;

/// A folded, squeezed density in f64 and by the plain formula, with its inputs.
fn squeezed(s: f32, random: &mut Random) -> (f64, f32, Vec3, Vec3) {
    let axis = direction(random);
    let u = near(axis, s, random);
    let d = Vec3::new(u.x, u.y * SQUEEZE, u.z.abs()).normalize();
    let inverse = 1.0 / SQUEEZE;
    let m = DVec3::new(f64::from(d.x), f64::from(d.y) * f64::from(inverse), f64::from(d.z));
    let r = m.length() / d.as_dvec3().length();
    let image = DVec3::new(m.x, m.y, -m.z);
    let value = (-exponent(s, m, axis.as_dvec3())).exp() + (-exponent(s, image, axis.as_dvec3())).exp();
    let want = value * f64::from(inverse) / r.powi(3) / integral_f64(f64::from(s));
    let m = Vec3::new(d.x, d.y * inverse, d.z);
    let (u, r) = (m / m.length(), m.length());
    let image = Vec3::new(u.x, u.y, -u.z);
    let value = (s * (u.dot(axis) - 1.0)).exp() + (s * (image.dot(axis) - 1.0)).exp();
    (want, value * inverse / (r * r * r) / integral_plain(s), axis, d)
}

fn folded(s: f32, random: &mut Random) -> Results {
    let (want, plain, axis, d) = squeezed(s, random);
    let lobe = Folded::squeezed(Gaussian { axis, sharpness: s }, SQUEEZE).expect("a squeeze in range");
    (want, lobe.pdf(d), plain)
}

fn mixture(s: f32, random: &mut Random) -> Results {
    let (want, plain, axis, d) = squeezed(s, random);
    let lobe = Lobe { gaussian: Gaussian { axis, sharpness: s }, amplitude: Vec3::ONE };
    let mixture = Mixture::<16>::new(Domain::Hemisphere, SQUEEZE, &[lobe], &[]).expect("a valid lobe");
    (want, mixture.pdf(d), plain)
}

fn mean_cosine(s: f32, _: &mut Random) -> Results {
    let x = f64::from(s);
    // The difference in f64 loses as many digits as s^2 has; the series has none to lose.
    let want = if x < 1e-2 {
        x / 3.0 - x.powi(3) / 45.0 + 2.0 * x.powi(5) / 945.0
    } else {
        1.0 / x.tanh() - 1.0 / x
    };
    (want, special::mean_cosine(s), 1.0 / s.tanh() - 1.0 / s)
}
