//! The 50-digit tables of `tests/data`, and the worst error of every function of `core` against them.

use crate::inputs::levels;
use crate::tolerance::Worst;
use glam::Vec3;
use srbf_core::special;
use srbf_core::{AbelPoisson, Domain, Folded, Gaussian, Kernel, Lobe, Mixture};
use srbf_core::{abel_poisson_coefficients_into, gaussian_coefficients_into};
use std::path::Path;

/// One table: its header is known to its reader.
pub struct Table {
    rows: Vec<Vec<f64>>,
}

impl Table {
    /// Reads a table by its name without `.csv`.
    ///
    /// # Panics
    /// If the file is missing, or holds text where a number is expected.
    pub fn load(name: &str) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data").join(format!("{name}.csv"));
        let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let row = |line: &str| line.split(',').map(|x| x.parse().expect("a number")).collect();
        Self { rows: text.lines().skip(1).map(row).collect() }
    }

    /// The rows of `N` columns.
    pub fn rows<const N: usize>(&self) -> impl Iterator<Item = [f64; N]> {
        self.rows.iter().map(|row| row.as_slice().try_into().expect("number of columns"))
    }
}

/// A vector of three columns that hold f32.
fn vec3(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::new(x as f32, y as f32, z as f32)
}

/// Whether f32 holds a number with all its digits.
fn is_normal(x: f64) -> bool {
    x >= f64::from(f32::MIN_POSITIVE) && x <= f64::from(f32::MAX)
}

/// Relative error; 0 is to be met exactly, and numbers that are no normal f32 are passed over.
fn relative(got: f32, want: f64) -> Option<f64> {
    if want == 0.0 {
        Some(if got == 0.0 { 0.0 } else { f64::INFINITY })
    } else {
        is_normal(want.abs()).then(|| (f64::from(got) - want).abs() / want.abs())
    }
}

fn see(worst: &mut Worst, got: f32, want: f64, unit: f64, place: impl FnOnce() -> String) {
    if let Some(error) = relative(got, want) {
        worst.see(error / unit, || format!("{}: got {got:e}, want {want:e}", place()));
    }
}

/// Every entry that this machine can measure, with its worst error.
pub fn measure() -> Vec<Worst> {
    [scalars(), gaussian(), horizon(), product(), folded(), abel_poisson(), coefficients()].concat()
}

fn scalars() -> Vec<Worst> {
    type One = fn(f32) -> f32;
    type Two = fn(f32, f32) -> f32;
    let one: [(&str, One); 3] = [
        ("sphere_integral", special::sphere_integral),
        ("mean_cosine", special::mean_cosine),
        ("bessel_i0_scaled", special::bessel_i0_scaled),
    ];
    let two: [(&str, Two); 3] = [
        ("cap_integral", special::cap_integral),
        ("share_within", special::share_within),
        ("one_minus_cos", special::one_minus_cos),
    ];
    let mut all = Vec::new();
    for (name, f) in one {
        let mut worst = Worst::new(format!("special::{name}"));
        for [x, want] in Table::load(name).rows() {
            see(&mut worst, f(x as f32), want, 1.0, || format!("{x:e}"));
        }
        all.push(worst);
    }
    for (name, f) in two {
        let mut worst = Worst::new(format!("special::{name}"));
        for [x, y, want] in Table::load(name).rows() {
            see(&mut worst, f(x as f32, y as f32), want, 1.0, || format!("{x:e}, {y:e}"));
        }
        all.push(worst);
    }
    all
}

fn gaussian() -> Vec<Worst> {
    let mut value = Worst::new("Gaussian::value");
    let mut pdf = Worst::new("Gaussian::pdf");
    for [s, ax, ay, az, dx, dy, dz, t, want, log] in Table::load("gaussian").rows() {
        let (axis, d) = (vec3(ax, ay, az), vec3(dx, dy, dz));
        let g = Gaussian::new(axis, s as f32).expect("a valid lobe");
        let place = || format!("s {s:e}, axis {axis}, d {d}, t {t:e}");
        see(&mut value, g.value(d), want, 2.0 + t, place);
        see(&mut pdf, g.pdf(d), log.exp(), 2.0 + t, place);
    }
    vec![value, pdf]
}

fn horizon() -> Vec<Worst> {
    let mut hemisphere = Worst::new("Gaussian::hemisphere_integral");
    for [s, ax, ay, az, t, half, _weighted] in Table::load("horizon").rows() {
        let axis = vec3(ax, ay, az);
        let g = Gaussian::new(axis, s as f32).expect("a valid lobe");
        let place = || format!("s {s:e}, axis {axis}, t {t:e}");
        see(&mut hemisphere, g.hemisphere_integral(), half, 2.0 + t, place);
    }
    vec![hemisphere]
}

fn product() -> Vec<Worst> {
    let mut exponent = Worst::new("GaussianProduct::exponent");
    let mut sharpness = Worst::new("GaussianProduct::sharpness");
    let mut value = Worst::new("GaussianProduct::value");
    let mut integral = Worst::new("GaussianProduct::integral");
    let mut amplitude = Worst::new("Lobe::product");
    for [s1, ax, ay, az, s2, bx, by, bz, dx, dy, dz, e, length, t, want, whole] in
        Table::load("product").rows()
    {
        let a = Gaussian::new(vec3(ax, ay, az), s1 as f32).expect("a valid lobe");
        let b = Gaussian::new(vec3(bx, by, bz), s2 as f32).expect("a valid lobe");
        let d = vec3(dx, dy, dz);
        let p = a.product(&b);
        let place = || format!("{s1:e} {}, {s2:e} {}, d {d}, e {e:e}, t {t:e}", a.axis, b.axis);
        exponent.see((f64::from(p.exponent) - e).abs() / (2.0 + e), place);
        // Below 1e-6 of the sharpness of the factors the axes have no digits left that decide it.
        if length > 1e-6 * s1.max(s2) {
            see(&mut sharpness, p.gaussian.sharpness, length, 1.0, place);
        }
        see(&mut value, p.value(d), want, 2.0 + t, place);
        see(&mut integral, p.integral(), whole, 2.0 + e, place);
        let lobe = |gaussian, scale: f32| Lobe { gaussian, amplitude: Vec3::splat(scale) };
        let product = lobe(a, 1e38).product(&lobe(b, 1e-20));
        see(
            &mut amplitude,
            product.amplitude.x,
            (-e).exp() * f64::from(1e38f32) * f64::from(1e-20f32),
            2.0 + e,
            place,
        );
    }
    vec![exponent, sharpness, value, integral, amplitude]
}

fn folded() -> Vec<Worst> {
    let table = Table::load("folded");
    let mut value = Worst::new("Folded::value");
    let mut pdf = Worst::new("Folded::pdf");
    let rows = || table.rows::<11>();
    for [s, c, ax, ay, az, dx, dy, dz, t, want, density] in rows() {
        let (axis, d) = (vec3(ax, ay, az), vec3(dx, dy, dz));
        let g = Gaussian::new(axis, s as f32).expect("a valid lobe");
        let f = Folded::squeezed(g, c as f32).expect("a valid squeeze");
        let place = || format!("s {s:e}, c {c}, axis {axis}, d {d}, t {t:e}");
        see(&mut value, f.value(d), want, 2.0 + t, place);
        see(&mut pdf, f.pdf(d), density, 2.0 + t, place);
    }
    let mut all = vec![value, pdf];
    for level in levels() {
        level.set().expect("an available level");
        let mut value = Worst::new(format!("Mixture::evaluate {}", level.name()));
        let mut pdf = Worst::new(format!("Mixture::pdf {}", level.name()));
        for [s, c, ax, ay, az, dx, dy, dz, t, want, density] in rows() {
            let (axis, d) = (vec3(ax, ay, az), vec3(dx, dy, dz));
            let lobe = Lobe::new(axis, s as f32, Vec3::ONE).expect("a valid lobe");
            let m = Mixture::<16>::new(Domain::Hemisphere, c as f32, &[lobe], &[]).expect("a valid mixture");
            let place = || format!("s {s:e}, c {c}, axis {axis}, d {d}, t {t:e}");
            // Below 2^-100 of its amplitude, t = 69.3, a lobe is 0; the bound itself may be rounded.
            let is_cut = t > 69.32 || t > 69.31 && m.evaluate(d) == Vec3::ZERO;
            let kept = |want: f64| if is_cut { 0.0 } else { want };
            see(&mut value, m.evaluate(d).x, kept(want), 2.0 + t, place);
            see(&mut pdf, m.pdf(d), kept(density), 2.0 + t, place);
        }
        all.extend([value, pdf]);
    }
    all
}

fn abel_poisson() -> Vec<Worst> {
    let mut value = Worst::new("AbelPoisson::value");
    let mut share = Worst::new("AbelPoisson::share_within");
    let mut inverse = Worst::new("AbelPoisson::one_minus_cos");
    let mut inner = Worst::new("AbelPoisson::inner_product");
    let kernel =
        |epsilon: f64, axis| AbelPoisson::from_epsilon(axis, epsilon as f32).expect("a valid kernel");
    for [epsilon, w, want, within] in Table::load("abel_poisson").rows() {
        let place = || format!("epsilon {epsilon:e}, w {w:e}");
        let k = kernel(epsilon, Vec3::Z);
        see(&mut value, k.value_at(2.0 * w as f32), want, 1.0, place);
        see(&mut share, k.share_within(w as f32), within, 1.0, place);
    }
    for [epsilon, u, want] in Table::load("abel_poisson_inverse").rows() {
        let place = || format!("epsilon {epsilon:e}, u {u:e}");
        see(&mut inverse, kernel(epsilon, Vec3::Z).one_minus_cos(u as f32), want, 1.0, place);
    }
    for [e1, ax, ay, az, e2, bx, by, bz, want] in Table::load("abel_poisson_product").rows() {
        let (a, b) = (kernel(e1, vec3(ax, ay, az)), kernel(e2, vec3(bx, by, bz)));
        let place = || format!("{e1:e} {}, {e2:e} {}", a.axis(), b.axis());
        see(&mut inner, a.inner_product(&b), want, 1.0, place);
    }
    vec![value, share, inverse, inner]
}

fn coefficients() -> Vec<Worst> {
    let mut gaussian = Worst::new("gaussian_coefficients_into");
    let mut abel = Worst::new("abel_poisson_coefficients_into");
    for [s, l, want] in Table::load("gaussian_coefficients").rows() {
        // The number of coefficients asked for must not change one of them.
        for extra in [1, 8] {
            let mut out = vec![0.0; l as usize + extra];
            gaussian_coefficients_into(s as f32, &mut out);
            see(&mut gaussian, out[l as usize], want, l + 5.0, || format!("s {s:e}, l {l}"));
        }
    }
    for [epsilon, l, want] in Table::load("abel_poisson_coefficients").rows() {
        let mut out = vec![0.0; l as usize + 1];
        abel_poisson_coefficients_into(epsilon as f32, &mut out);
        see(&mut abel, out[l as usize], want, l + 2.0, || format!("epsilon {epsilon:e}, l {l}"));
    }
    vec![gaussian, abel]
}
