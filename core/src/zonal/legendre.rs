//! Any zonal kernel as a series in Legendre polynomials, `K(cos theta) = sum of K_l P_l(cos theta)`.
//!
//! The angle enters as `w = 1 - cos theta`, so that sharp kernels keep their digits at the axis.

use crate::float;
use crate::quadrature::GAUSS_LEGENDRE;
use core::f32::consts::PI;

/// Coefficients per pass over the quadrature nodes.
const BLOCK: usize = 16;

/// Integrates for the Legendre coefficients of a kernel given as a function of `w = 1 - cos theta`.
///
/// `K_l = (2 l + 1) / 2 integral of K P_l sin theta d theta`, by 12-point Gauss-Legendre. The panels halve towards the axis, down
/// to 1e-7 radians, and are short enough elsewhere for the highest `P_l` asked for.
///
/// Shapes: `coefficients` any length, overwritten with l = 0, 1, ... Cost: about `(336 + 3 n) ceil(n / 16)`
/// evaluations of the kernel for n coefficients; meant for offline work.
/// Range: kernels that are smooth off the axis. Accuracy: `4e-7 (2 l + 1)` of the mean of |K| over the
/// sphere.
/// Source: Weng and Shih 2006, eq. 2.
pub fn legendre_coefficients_into(kernel: impl Fn(f32) -> f32, coefficients: &mut [f32]) {
    let count = coefficients.len();
    for (block, chunk) in coefficients.chunks_mut(BLOCK).enumerate() {
        let first = block * BLOCK;
        // Kahan's sums: thousands of terms would otherwise lose three digits.
        let (mut sum, mut lost) = ([0f32; BLOCK], [0f32; BLOCK]);
        for_each_node(count, |w, weight| {
            let value = kernel(w) * weight;
            legendre_polynomials(w, first + chunk.len(), |l, p| {
                if l >= first {
                    let i = l - first;
                    let term = value * p - lost[i];
                    let next = sum[i] + term;
                    lost[i] = (next - sum[i]) - term;
                    sum[i] = next;
                }
            });
        });
        for (i, coefficient) in chunk.iter_mut().enumerate() {
            *coefficient = (first + i) as f32 * sum[i] + 0.5 * sum[i];
        }
    }
}

/// Calls with `w` and the weight, `sin theta d theta`, of every quadrature node over the sphere.
fn for_each_node(count: usize, mut each: impl FnMut(f32, f32)) {
    let mut panel = |from: f32, width: f32| {
        for (node, share) in GAUSS_LEGENDRE {
            // Turns of half the angle: sine and cosine come without reduction of pi.
            let (sin, cos) = float::sin_cos_turns((from + width * node) * 0.25);
            // theta = pi x: w = 2 sin^2(theta / 2), sin theta = 2 sin cos of the half angle.
            each(2.0 * sin * sin, share * width * PI * 2.0 * sin * cos);
        }
    };
    // Panels of the fraction x = theta / pi of the range.
    let panels = 4 + count / 4;
    let width = 1.0 / panels as f32;
    let mut inner = width;
    for _ in 0..24 {
        panel(0.5 * inner, 0.5 * inner);
        inner *= 0.5;
    }
    panel(0.0, inner);
    for i in 1..panels {
        panel(i as f32 * width, width);
    }
}

/// Calls with `P_0 .. P_(count - 1)` at `cos theta = 1 - w`.
///
/// The recurrence runs over the differences `D = P_(l+1) - P_l`: `(l + 1) D' = l D - (2 l + 1) w P_l`, which
/// keeps the digits of w next to the axis.
fn legendre_polynomials(w: f32, count: usize, mut each: impl FnMut(usize, f32)) {
    let (mut p, mut difference) = (1.0, 0.0);
    for l in 0..count {
        each(l, p);
        let n = l as f32;
        difference = (n * difference - (2.0 * n + 1.0) * w * p) / (n + 1.0);
        p += difference;
    }
}

/// Evaluates a series of Legendre polynomials at `w = 1 - cos theta`, by Clenshaw's recurrence.
///
/// Range: `w` in [0, 2]. Accuracy: `1e-7 (n + 8)` of the sum of |coefficients|, n their number.
/// Source: Clenshaw 1955; Weng and Shih 2006, eq. 2.
pub fn legendre_series(coefficients: &[f32], one_minus_cos: f32) -> f32 {
    clenshaw(coefficients.len(), one_minus_cos, |l| coefficients[l])
}

/// Evaluates the spherical singular integral of two kernels, whose axes are `w = 1 - cos angle` apart; sr.
///
/// `sum over l of G_l H_l (4 pi / (2 l + 1)) P_l`: the integral over the sphere of the product of the two.
/// The shorter of the two series decides how many terms are summed.
/// Source: Weng and Shih 2006, eq. 4 with m = 2.
#[doc(alias = "convolution")]
pub fn legendre_singular_integral(g: &[f32], h: &[f32], one_minus_cos: f32) -> f32 {
    clenshaw(g.len().min(h.len()), one_minus_cos, |l| g[l] * h[l] * (4.0 * PI / (2 * l + 1) as f32))
}

/// `sum of c(l) P_l`, from the last term to the first: `b = c + (2 l + 1)/(l + 1) x b' - (l + 1)/(l + 2)
/// b''`.
fn clenshaw(count: usize, w: f32, coefficient: impl Fn(usize) -> f32) -> f32 {
    let x = 1.0 - w;
    let (mut b1, mut b2) = (0.0, 0.0);
    for l in (0..count).rev() {
        let n = l as f32;
        let b = coefficient(l) + (2.0 * n + 1.0) / (n + 1.0) * x * b1 - (n + 1.0) / (n + 2.0) * b2;
        (b1, b2) = (b, b1);
    }
    b1
}

/// Writes the Legendre coefficients of a Gaussian of unit amplitude in closed form.
///
/// `(2 l + 1) exp(-s) i_l(s)`, `i_l` the modified spherical Bessel function. The ratios `i_(l+1) / i_l` come
/// from their continued fraction, downwards, which is stable and positive; the recurrence upwards is not.
///
/// Range: sharpness in [0, 1e8]; 0 gives 1, 0, 0, ... Accuracy: relative `1e-7 (l + 5)`.
pub fn gaussian_coefficients_into(sharpness: f32, coefficients: &mut [f32]) {
    let s = sharpness;
    let count = coefficients.len();
    coefficients.fill(0.0);
    // Begin above the last ratio with a bound of Amos 1974, whose relative error is about n / (4 s^2); n
    // steps down shrink it by exp(-n^2 / s).
    let above = 20 + (4.0 * float::sqrt(s)).min(400.0) as usize;
    let start = (count + above + 1) as f32;
    let mut ratio = s / (start + float::sqrt((start + 1.0) * (start + 1.0) + s * s));
    for l in (0..count + above).rev() {
        ratio = s / ((2 * l + 3) as f32 + s * ratio);
        if l + 1 < count {
            coefficients[l + 1] = ratio;
        }
    }
    if let Some(first) = coefficients.first_mut() {
        // exp(-s) i_0(s) = (1 - exp(-2 s)) / (2 s).
        *first = crate::special::sphere_integral(s) / (4.0 * PI);
    }
    let mut running = 1.0;
    for (l, coefficient) in coefficients.iter_mut().enumerate() {
        running *= *coefficient;
        *coefficient = running * (2 * l + 1) as f32;
    }
}

/// Writes the Legendre coefficients of an Abel-Poisson kernel, `(2 l + 1) h^l`.
///
/// Range: `epsilon = 1 - h` in [0, 1]. Accuracy: relative `1e-7 (l + 2)`.
pub fn abel_poisson_coefficients_into(epsilon: f32, coefficients: &mut [f32]) {
    // The power as an exponential: repeated products of a rounded h would drift.
    let log = float::ln_1p(-epsilon);
    for (l, coefficient) in coefficients.iter_mut().enumerate() {
        let power = if l == 0 { 1.0 } else { float::exp(l as f32 * log) };
        *coefficient = (2 * l + 1) as f32 * power;
    }
}
