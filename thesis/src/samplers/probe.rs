//! The directions and values of a reflection that samplers are fitted to.

use super::ggx_parts::{GgxProposal, PARTS};
use glam::DVec3;

/// Steps of the R2 sequence: powers of the inverse of the root of `x^3 = x + 1`.
const R2: [f64; 2] = [0.754_877_666_246_693, 0.569_840_290_998_053];

/// Steps to the least variance; each lowers it.
const STEPS: usize = 60;

/// Angles of the outgoing directions, degrees: even, and the last one where the renderer still looks.
pub const THETAS: usize = 16;
const LAST: f64 = 88.5;

/// An incident direction, the size of `f cos` there, and its weight in a sum over the hemisphere, sr.
pub struct Direction {
    /// The direction.
    pub wi: DVec3,
    /// Sum of the sizes of the channels of `f cos`, 1/sr.
    pub value: f64,
    /// Its weight, sr.
    pub weight: f64,
}

/// Angle of view number `n` of `count` even ones, radians.
pub fn theta(n: usize, count: usize) -> f64 {
    LAST.to_radians() * n as f64 / (count - 1) as f64
}

/// Number of the view before an angle, of `count`, and how far towards the next one it lies, 0 to 1.
pub fn place(cos: f64, count: usize) -> (usize, f64) {
    let at = cos.clamp(0.0, 1.0).acos() / LAST.to_radians() * (count - 1) as f64;
    let before = (at as usize).min(count - 2);
    (before, (at - before as f64).min(1.0))
}

/// An outgoing direction; an azimuth of pi is that of the frame of a view.
pub fn outgoing(theta: f64, azimuth: f64) -> DVec3 {
    DVec3::new(theta.sin() * azimuth.cos(), theta.sin() * azimuth.sin(), theta.cos())
}

/// Directions of all roughness alike.
pub fn directions(wo: DVec3, drawn: usize, f_cos: &dyn Fn(DVec3) -> DVec3) -> Vec<Direction> {
    let proposal = GgxProposal::even(wo);
    let total = (PARTS * drawn) as f64;
    let mut seen = Vec::with_capacity(PARTS * drawn);
    for part in 0..PARTS {
        for i in 0..drawn {
            let n = (part * drawn + i) as f64;
            let wi = proposal.draw(part, (R2[0] * n).fract(), (R2[1] * n).fract());
            if wi.z > 0.0 {
                let weight = 1.0 / (proposal.density(wi) * total);
                seen.push(Direction { wi, value: f_cos(wi).abs().element_sum(), weight });
            }
        }
    }
    seen
}

/// The weights of parts for which samples of their mixture have the least variance: from the second moment at directions, `f^2` times
/// the weight there, and the densities of the parts.
pub fn least_variance<const N: usize>(moments: &[(f64, [f64; N])]) -> [f64; N] {
    let mut weights = [1.0 / N as f64; N];
    for _ in 0..STEPS {
        // The sum over f^2 / q is convex in the weights of q. A bound of it that touches it where the weights are has its
        // least value at weights times the root of this slope (Hunter and Lange 2004, "A Tutorial on MM Algorithms").
        let mut slope = [0.0; N];
        for (moment, densities) in moments {
            let q: f64 = densities.iter().zip(&weights).map(|(density, weight)| density * weight).sum();
            if q > 0.0 {
                (0..N).for_each(|k| slope[k] += moment * densities[k] / (q * q));
            }
        }
        let next: [f64; N] = std::array::from_fn(|k| weights[k] * slope[k].sqrt());
        let sum: f64 = next.iter().sum();
        if !(sum > 0.0 && sum.is_finite()) {
            break;
        }
        weights = next.map(|weight| weight / sum);
    }
    weights
}
