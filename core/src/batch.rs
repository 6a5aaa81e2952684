//! Batches: lanes are directions, the lobes of one mixture are taken one after the other.
//!
//! Structure of arrays in and out, any count, any alignment, no allocation.

use crate::lanes::{Lanes, exp2, ln, sin_cos_turns};
use crate::mixture::Mixture;
use crate::simd::Kernel;
use crate::squeeze::Seen;
use crate::{Domain, Error, LUMINANCE};

/// Widest vector: what a tail is padded to.
const WIDEST: usize = 16;

impl<const N: usize> Mixture<N> {
    /// Evaluates `f cos` towards n incident directions; 1/sr. Same values as [`evaluate`](Self::evaluate).
    ///
    /// Shapes: `directions` x, y, z, each [n], unit vectors; `value` red, green, blue, each [n], overwritten.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn evaluate_into(&self, directions: [&[f32]; 3], value: [&mut [f32]; 3]) -> Result<(), Error> {
        same_length(directions.iter().map(|s| s.len()).chain(value.iter().map(|s| s.len())))?;
        self.level.run(EvaluateInto { mixture: self, directions, value });
        Ok(())
    }

    /// Evaluates the density of [`sample`](Self::sample) at n directions; 1/sr.
    ///
    /// Shapes: `directions` x, y, z, each [n], unit vectors; `pdf` [n], overwritten.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn pdf_into(&self, directions: [&[f32]; 3], pdf: &mut [f32]) -> Result<(), Error> {
        same_length(directions.iter().map(|s| s.len()).chain([pdf.len()]))?;
        self.level.run(PdfInto { mixture: self, directions, pdf });
        Ok(())
    }

    /// Draws n directions, with density and weight `f cos / pdf`, in one pass.
    ///
    /// Shapes: `u` three uniform numbers in [0, 1) a sample, each [n]; `samples`, every slice [n], overwritten. A
    /// mixture that reflects nothing gives the normal with density 0 and weight 0.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn sample_into(&self, u: [&[f32]; 3], samples: SamplesMut<'_>) -> Result<(), Error> {
        let outputs = samples.direction.iter().chain(&samples.weight).map(|s| s.len());
        same_length(u.iter().map(|s| s.len()).chain(outputs).chain([samples.pdf.len()]))?;
        self.level.run(SampleInto { mixture: self, u, samples });
        Ok(())
    }
}

/// Where a batch of samples goes.
#[derive(Debug)]
pub struct SamplesMut<'a> {
    /// Incident directions, x, y, z, in the caller's shading frame.
    pub direction: [&'a mut [f32]; 3],
    /// Density at them; 1/sr.
    pub pdf: &'a mut [f32],
    /// `f cos / pdf`, linear sRGB.
    pub weight: [&'a mut [f32]; 3],
}

fn same_length(lengths: impl IntoIterator<Item = usize>) -> Result<(), Error> {
    let mut lengths = lengths.into_iter();
    let first = lengths.next().unwrap_or(0);
    if lengths.all(|n| n == first) { Ok(()) } else { Err(Error::Length) }
}

struct EvaluateInto<'a, 'b, const N: usize> {
    mixture: &'a Mixture<N>,
    directions: [&'b [f32]; 3],
    value: [&'b mut [f32]; 3],
}

impl<const N: usize> Kernel for EvaluateInto<'_, '_, N> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let m = self.mixture;
        for_each_block::<L, 3, 3>(self.directions, self.value, |d| sums(m, [&m.red, &m.green, &m.blue], d));
    }
}

struct PdfInto<'a, 'b, const N: usize> {
    mixture: &'a Mixture<N>,
    directions: [&'b [f32]; 3],
    pdf: &'b mut [f32],
}

impl<const N: usize> Kernel for PdfInto<'_, '_, N> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let m = self.mixture;
        let inverse_power = L::splat(m.inverse_power);
        for_each_block::<L, 3, 1>(self.directions, [self.pdf], |d| {
            sums(m, [&m.luminance], d).map(|sum| sum * inverse_power)
        });
    }
}

struct SampleInto<'a, 'b, const N: usize> {
    mixture: &'a Mixture<N>,
    u: [&'b [f32]; 3],
    samples: SamplesMut<'b>,
}

impl<const N: usize> Kernel for SampleInto<'_, '_, N> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let m = self.mixture;
        let SamplesMut { direction: [x, y, z], pdf, weight: [red, green, blue] } = self.samples;
        if m.power == 0.0 {
            z.fill(1.0);
            [x, y, pdf, red, green, blue].into_iter().for_each(|slice| slice.fill(0.0));
            return;
        }
        for_each_block::<L, 3, 7>(self.u, [x, y, z, pdf, red, green, blue], |u| {
            let direction = sample_direction(m, u);
            let value = sums(m, [&m.red, &m.green, &m.blue], direction);
            let (pdf, weight) = density_and_weight(m, value);
            let [x, y, z] = direction;
            let [red, green, blue] = weight;
            [x, y, z, pdf, red, green, blue]
        });
    }
}

/// Density and weight of a value: the density is the luminance of the value over its integral.
#[inline(always)]
pub(crate) fn density_and_weight<L: Lanes, const N: usize>(m: &Mixture<N>, value: [L; 3]) -> (L, [L; 3]) {
    let [red, green, blue] = LUMINANCE.map(L::splat);
    let luminance = value[0].mul_add(red, value[1].mul_add(green, value[2] * blue));
    // power / luminance is 1 / pdf; where f32 rounds the density to 0, the weight is 0 as well.
    let seen = L::splat(0.0).lt(luminance);
    let inverse = L::select(seen, L::splat(m.power) / luminance, L::splat(0.0));
    (luminance * L::splat(m.inverse_power), value.map(|v| v * inverse))
}

/// Calls with `COUNT` inputs at a time and stores what comes back; the tail goes through a padded copy.
#[inline(always)]
fn for_each_block<L: Lanes, const I: usize, const O: usize>(
    inputs: [&[f32]; I],
    mut outputs: [&mut [f32]; O],
    mut block: impl FnMut([L; I]) -> [L; O],
) {
    let n = inputs[0].len();
    let whole = n - n % L::COUNT;
    let mut at = 0;
    while at < whole {
        let results = block(inputs.map(|s| L::load(&s[at..at + L::COUNT])));
        for (output, result) in outputs.iter_mut().zip(results) {
            result.store(&mut output[at..at + L::COUNT]);
        }
        at += L::COUNT;
    }
    if at < n {
        let results = block(inputs.map(|s| {
            // 0.5 is a valid uniform number and a harmless direction.
            let mut padded = [0.5; WIDEST];
            padded[..n - at].copy_from_slice(&s[at..]);
            L::load(&padded)
        }));
        for (output, result) in outputs.iter_mut().zip(results) {
            let mut padded = [0.0; WIDEST];
            result.store(&mut padded);
            output[at..].copy_from_slice(&padded[..n - at]);
        }
    }
}

/// Sums the lobes towards a vector of directions, once for each of `C` sets of amplitudes.
#[inline(always)]
pub(crate) fn sums<L: Lanes, const N: usize, const C: usize>(
    m: &Mixture<N>,
    amplitudes: [&[f32; N]; C],
    d: [L; 3],
) -> [L; C] {
    let mut acc = [L::splat(0.0); C];
    let turned = m.squeeze.turn(d);
    if m.squeezed > 0 {
        let seen = m.squeeze.squeeze(&turned);
        if m.in_plane {
            run::<L, N, C, true, true>(m, amplitudes, &seen, 0, m.squeezed, &mut acc);
        } else {
            run::<L, N, C, false, true>(m, amplitudes, &seen, 0, m.squeezed, &mut acc);
        }
        acc = acc.map(|sum| sum * seen.scale);
    }
    let (from, to) = (m.squeezed, m.count);
    match (m.in_plane, m.squeeze.is_unturned()) {
        (true, false) => run::<L, N, C, true, true>(m, amplitudes, &turned, from, to, &mut acc),
        (true, true) => run::<L, N, C, true, false>(m, amplitudes, &turned, from, to, &mut acc),
        (false, false) => run::<L, N, C, false, true>(m, amplitudes, &turned, from, to, &mut acc),
        (false, true) => run::<L, N, C, false, false>(m, amplitudes, &turned, from, to, &mut acc),
    }
    if m.domain == Domain::Hemisphere {
        let zero = L::splat(0.0);
        let above = d[2].ge(zero);
        acc = acc.map(|sum| L::select(above, sum, zero));
    }
    acc
}

/// Adds a run of lobes that see the same direction. `PLANE`: every axis has y = 0. `LOW`: the direction has a low part.
#[inline(always)]
fn run<L: Lanes, const N: usize, const C: usize, const PLANE: bool, const LOW: bool>(
    m: &Mixture<N>,
    amplitudes: [&[f32; N]; C],
    seen: &Seen<L>,
    from: usize,
    to: usize,
    acc: &mut [L; C],
) {
    let ([x, y, z], [x_low, y_low, z_low]) = (seen.high, seen.low);
    // Axes in the plane share the part across it; its low part would only count relative to itself.
    let yy = y * y;
    for k in from..to.min(N) {
        let mut dx = x - L::splat(m.axis_x[k]);
        let mut dz = z - L::splat(m.axis_z[k]);
        if LOW {
            dx = dx + x_low;
            dz = dz + z_low;
        }
        let chord_squared = if PLANE {
            dx.mul_add(dx, dz.mul_add(dz, yy))
        } else {
            let mut dy = y - L::splat(m.axis_y[k]);
            if LOW {
                dy = dy + y_low;
            }
            dx.mul_add(dx, dz.mul_add(dz, dy * dy))
        };
        let t = L::splat(m.rate[k]) * chord_squared;
        let mut g = exp2(t);
        if m.folded >> k & 1 == 1 {
            // |d - mirrored axis|^2 = |d - axis|^2 + 4 d.z axis.z, both terms of one sign.
            g = g + exp2(L::splat(m.fold_rate[k]).mul_add(z, t));
        }
        for (sum, amplitude) in acc.iter_mut().zip(amplitudes) {
            *sum = g.mul_add(L::splat(amplitude[k]), *sum);
        }
    }
}

/// Draws directions: lobe by `u[0]`, direction in it by `u[1]` and `u[2]`.
#[inline(always)]
pub(crate) fn sample_direction<L: Lanes, const N: usize>(m: &Mixture<N>, u: [L; 3]) -> [L; 3] {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    // Below the whole, so that a lobe that adds something is found whatever the product rounds to.
    let target = (u[0] * L::splat(m.power)).min(L::splat(m.power * (1.0 - f32::EPSILON)));
    let count = m.count.min(N);
    let k = target.search(&m.cumulative[..count.saturating_sub(1)]);

    // Angle from the axis, as w = 1 - cos: see special::one_minus_cos.
    let gone = L::lookup(&m.tail, count, k);
    let w =
        one_minus_cos(u[1], L::lookup(&m.inside, count, k), gone, L::lookup(&m.inverse_sharpness, count, k));
    let sin_theta = (w * (L::splat(2.0) - w)).sqrt();
    let (sin_phi, cos_phi) = sin_cos_turns(u[2]);
    let (across, along) = (sin_theta * cos_phi, sin_theta * sin_phi);

    // The frame round the axis: Duff et al. 2017.
    let x = L::lookup(&m.axis_x, count, k);
    let z = L::lookup(&m.axis_z, count, k);
    let y = if m.in_plane { zero } else { L::lookup(&m.axis_y, count, k) };
    let sign = one.copy_sign(z);
    let a = zero - one / (sign + z);
    let (xa, ya) = (x * a, y * a);
    let b = x * ya;
    let tangent = [(sign * x).mul_add(xa, one), sign * b, zero - sign * x];
    let bitangent = [b, y.mul_add(ya, sign), zero - y];
    // The axis is added last and whole: `axis (1 - w)` would round a narrow lobe to the grid round its axis.
    let component = |axis: L, t: L, b: L| axis + t.mul_add(across, b.mul_add(along, zero - axis * w));
    let round = [
        component(x, tangent[0], bitangent[0]),
        component(y, tangent[1], bitangent[1]),
        component(z, tangent[2], bitangent[2]),
    ];
    let mut d = round;
    if m.squeezed > 0 {
        let through = L::index_below(k, m.squeezed);
        d[1] = L::select(through, m.squeeze.unsqueeze(round)[1], round[1]);
    }
    if m.domain == Domain::Hemisphere {
        d[2] = d[2].abs();
    }
    let d = m.squeeze.turn_back(d);
    let length_squared = d[0].mul_add(d[0], d[1].mul_add(d[1], d[2] * d[2]));
    let shrink = one / length_squared.sqrt();
    d.map(|component| component * shrink)
}

/// `-ln(1 - u inside) / s` with `inside = 1 - exp(-2 s)` and `gone = exp(-2 s)`, both to full precision.
#[inline(always)]
fn one_minus_cos<L: Lanes>(u: L, inside: L, gone: L, inverse_sharpness: L) -> L {
    let one = L::splat(1.0);
    let drop = u * inside;
    // Small drop: ln(1 - drop) = ln(y) + c / y, c what rounding y = 1 - drop lost. Large: 1 - u is exact.
    let near = drop.lt(L::splat(0.5));
    let y_near = one - drop;
    let lost = (one - y_near) - drop;
    let y = L::select(near, y_near, gone.mul_add(u, one - u));
    let correction = L::select(near, lost / y_near, L::splat(0.0));
    // u = 1 at a large sharpness: the smallest normal number stands for 0.
    let log = ln(y.max(L::splat(f32::MIN_POSITIVE))) + correction;
    (L::splat(0.0) - log * inverse_sharpness).max(L::splat(0.0)).min(L::splat(2.0))
}
