//! Estimators: several samples of one mixture, stratified over its lobes; the weights that combine
//! techniques; and a mixture with a defensive component, whose weights are bounded.

use crate::error::Error;
use crate::kernel::draw::{chosen_power, draw_one};
use crate::material::layout::MAX_LOBES;
use crate::mixture::rows::{Domain, Mixture, Sample};
use crate::simd::lanes::scale;
use crate::zonal::around::where_around;
use crate::zonal::kernel::Kernel;
use crate::{float, special};
use core::f32::consts::{FRAC_1_PI, PI};
use glam::Vec3;

/// Weight of a sample that technique A drew, where A draws `count_a` samples with density `pdf_a` there and B
/// `count_b` with `pdf_b`: `n_a p_a / (n_a p_a + n_b p_b)`.
///
/// Returns: in [0, 1]; with the weight of B it sums to 1; 0 where both densities are 0.
/// Source: Veach and Guibas 1995; Weng and Shih 2006, eq. 13.
#[inline]
pub fn balance_heuristic(count_a: f32, pdf_a: f32, count_b: f32, pdf_b: f32) -> f32 {
    let ratio = weight_ratio(count_a, pdf_a, count_b, pdf_b);
    ratio.map_or(0.0, |r| 1.0 / (1.0 + r))
}

/// As [`balance_heuristic`], with the squares: `(n_a p_a)^2 / ((n_a p_a)^2 + (n_b p_b)^2)`.
///
/// Lower variance where one technique is much the better one. The square is of the ratio, so that a density
/// of 1e30 does not overflow.
/// Source: Veach and Guibas 1995, beta = 2.
#[inline]
pub fn power_heuristic(count_a: f32, pdf_a: f32, count_b: f32, pdf_b: f32) -> f32 {
    let ratio = weight_ratio(count_a, pdf_a, count_b, pdf_b);
    ratio.map_or(0.0, |r| 1.0 / (1.0 + r * r))
}

/// `n_b p_b / (n_a p_a)`, infinite where A cannot draw the sample; `None` where neither can.
#[inline]
fn weight_ratio(count_a: f32, pdf_a: f32, count_b: f32, pdf_b: f32) -> Option<f32> {
    if count_a > 0.0 && pdf_a > 0.0 {
        Some((count_b / count_a) * (pdf_b / pdf_a)).map(|r| if r.is_nan() { 0.0 } else { r })
    } else {
        (count_b > 0.0 && pdf_b > 0.0).then_some(f32::INFINITY)
    }
}

impl<const N: usize> Mixture<'_, N> {
    /// Allocates `samples` to the lobes in proportion to their integrals, by systematic resampling.
    ///
    /// Sample `i` goes to the lobe at share `(i + offset) / samples` of the running integral, so that lobe k
    /// gets `samples I_k / sum I` rounded down or up, and exactly that many on average over `offset` uniform
    /// in [0, 1). Hence `sum of value / (samples pdf)` over all of them, with the density of the whole
    /// mixture, is unbiased; it is the balance heuristic of eq. 13 for these allocations on average.
    ///
    /// Shapes: `counts` [`component_len`](Self::component_len), overwritten; longer is cleared. All 0 for a
    /// black mixture.
    /// Source: Weng and Shih 2006, sections 4.2.1 and 4.2.2, eq. 14; differs: one random number, not one a
    /// sample.
    ///
    /// # Errors
    /// [`Error::Capacity`] if `counts` is shorter than [`component_len`](Self::component_len).
    pub fn allocate_into(&self, samples: u32, offset: f32, counts: &mut [u32]) -> Result<(), Error> {
        self.check_counts(counts)?;
        counts.fill(0);
        if self.power == 0.0 {
            return Ok(());
        }
        // The number of strata that begin before a share c of the integral: the least i with i + offset >= c
        // n.
        let mut taken = 0;
        for (k, count) in counts[..self.component_len()].iter_mut().enumerate() {
            // The last component that adds anything ends at the whole.
            let share = self.running_power(k) / self.running_power(MAX_LOBES);
            let reach = share * samples as f32 - offset;
            // The cast saturates: 0 for what is negative.
            let whole = reach as u32;
            let until = whole.saturating_add(u32::from(reach > whole as f32)).min(samples);
            let until = if share >= 1.0 { samples } else { until };
            *count = until.saturating_sub(taken);
            taken = taken.max(until);
        }
        Ok(())
    }

    /// Draws a direction from lobe `k`, as one of the samples that [`allocate_into`](Self::allocate_into)
    /// gave it.
    ///
    /// The density and value in the sample are those of the whole mixture. `None` past the last lobe, and for a
    /// black mixture.
    pub fn sample_lobe(&self, k: usize, u: [f32; 2]) -> Option<Sample> {
        if k >= self.component_len() || self.power == 0.0 {
            return None;
        }
        let mut d = if k == self.count { cosine_weighted(u) } else { self.gaussian(k).sample(u) }.to_array();
        if k < self.squeezed {
            d = self.squeeze.unsqueeze(d);
        }
        if self.domain == Domain::Hemisphere {
            d[2] = d[2].abs();
        }
        let direction = Vec3::from_array(self.squeeze.turn_back(d)).normalize();
        let (value, pdf) = self.evaluate_and_pdf(direction);
        Some(Sample { direction, pdf, value })
    }

    /// Evaluates `sum over lobes of count_k p_k(d)`, the divisor of eq. 13: the estimate is the sum over all
    /// samples, of all lobes, of `value / divisor`, unbiased for any counts that are positive where the value
    /// is.
    ///
    /// Shapes: `counts` [`component_len`](Self::component_len). Source: Weng and Shih 2006, eq. 13 (balance
    /// heuristic).
    ///
    /// # Errors
    /// [`Error::Capacity`] if `counts` is shorter than [`component_len`](Self::component_len).
    pub fn balance_divisor(&self, counts: &[u32], direction: Vec3) -> Result<f32, Error> {
        self.check_counts(counts)?;
        let mut sum = 0.0;
        self.for_each_component(direction, |k, g| {
            let integral = if k == self.count { 1.0 } else { special::sphere_integral(self.sharpness[k]) };
            sum += counts[k] as f32 * (g / integral);
        });
        Ok(sum)
    }

    /// Inverts [`sample`](Self::sample): three numbers that lead to a direction, drawn among all that do.
    ///
    /// Every lobe can make the direction, a folded one in two ways. `choice`, uniform in [0, 1), takes one of
    /// the ways by its part of the density and is used up for the first number, so that directions drawn from
    /// the mixture give numbers that are uniform in the cube. `None` where the density is 0.
    pub fn invert_sample(&self, direction: Vec3, choice: f32) -> Option<[f32; 3]> {
        // The lobe: the first whose running part of the density exceeds the choice.
        let mut whole = 0.0;
        let luminance_of = |k: usize| if k == self.count { self.diffuse_power } else { self.luminance[k] };
        self.for_each_component(direction, |k, g| whole += luminance_of(k) * g);
        let target = choice * whole;
        let (mut before, mut found) = (0.0, None);
        self.for_each_component(direction, |k, g| {
            let part = luminance_of(k) * g;
            // The last lobe with any part takes what rounding leaves over.
            if part > 0.0 && found.is_none_or(|(_, start, size)| target >= start + size) {
                found = Some((k, before, part));
            }
            before += part;
        });
        let (k, start, part) = found?;
        let mut rest = ((target - start) / part).clamp(0.0, 1.0 - f32::EPSILON / 2.0);

        let below_one = |x: f32| x.min(1.0 - f32::EPSILON / 2.0);
        let low = if k == 0 { 0.0 } else { self.running_power(k - 1) };
        let high = self.running_power(k);
        let component = |rest| self.choosing(low, high, below_one((low + rest * (high - low)) / self.power));
        if k == self.count {
            // Cosine-weighted heights: u = sin^2.
            let [_, turns] = where_around(Vec3::Z, self.turned(direction));
            let across = direction.x * direction.x + direction.y * direction.y;
            return Some([component(rest), below_one(across), turns]);
        }

        // The direction as the lobe sees it, or its mirror image.
        let turned = self.squeeze.turn(direction.to_array());
        let seen = if k < self.squeezed { self.squeeze.squeeze(&turned) } else { turned };
        let mut u = Vec3::from_array(seen.high) + Vec3::from_array(seen.low);
        let gaussian = self.gaussian(k);
        if self.domain == Domain::Hemisphere {
            // Ratio of the image's part to the direct one.
            let ratio = float::exp(-2.0 * gaussian.sharpness * gaussian.axis.z * u.z);
            let direct = 1.0 / (1.0 + ratio);
            if rest < direct {
                rest /= direct;
            } else {
                rest = (rest - direct) / (1.0 - direct);
                u.z = -u.z;
            }
        }
        let [w, turns] = where_around(gaussian.axis, u);
        let share = special::share_within(gaussian.sharpness, w);
        Some([component(rest), below_one(share), turns])
    }

    /// Number of components that samples are drawn from: the lobes, then the diffuse term if there is one.
    pub fn component_len(&self) -> usize {
        self.count + usize::from(self.lobes_power < self.power)
    }

    fn check_counts(&self, counts: &[u32]) -> Result<(), Error> {
        let (needed, available) = (self.component_len(), counts.len());
        if available < needed { Err(Error::Capacity { needed, available }) } else { Ok(()) }
    }

    /// Luminance of the integral of the components up to and with `k`; of all past the last lobe.
    fn running_power(&self, k: usize) -> f32 {
        if k >= self.count { self.power } else { self.cumulative[k] }
    }

    fn turned(&self, direction: Vec3) -> Vec3 {
        Vec3::from_array(self.squeeze.turn(direction.to_array()).high)
    }

    /// The number nearest to `u`, but for a few roundings, that chooses the component from `low` to `high` of
    /// the running power.
    fn choosing(&self, low: f32, high: f32, mut u: f32) -> f32 {
        for _ in 0..4 {
            let target = chosen_power(self, u);
            if target < low {
                u = u.next_up();
            } else if target >= high {
                u = u.next_down();
            } else {
                break;
            }
        }
        u
    }

    /// Calls with every lobe and its unit value at the direction, fold and change of solid angle included;
    /// last with the diffuse term, if there is one, and `cos / pi`.
    fn for_each_component(&self, direction: Vec3, mut each: impl FnMut(usize, f32)) {
        // The comparison is false for a NaN too.
        let above = direction.z >= 0.0;
        if !above && self.domain == Domain::Hemisphere {
            return;
        }
        let turned = self.squeeze.turn(direction.to_array());
        let squeezed = if self.squeezed > 0 { self.squeeze.squeeze(&turned) } else { turned };
        for k in 0..self.count {
            let seen = if k < self.squeezed { &squeezed } else { &turned };
            let gaussian = self.gaussian(k);
            let high = Vec3::from_array(seen.high);
            let chord = (high - gaussian.axis) + Vec3::from_array(seen.low);
            let mut g = gaussian.value_at(chord.length_squared());
            if self.folded >> k & 1 == 1 {
                g += g * float::exp(-2.0 * gaussian.sharpness * gaussian.axis.z * high.z);
            }
            each(k, g * seen.scale);
        }
        if self.component_len() > self.count {
            each(self.count, direction.z * FRAC_1_PI);
        }
    }
}

/// A cosine-weighted direction of the upper hemisphere: heights `z = sqrt(1 - u)`.
fn cosine_weighted(u: [f32; 2]) -> Vec3 {
    let (sin_phi, cos_phi) = float::sin_cos_turns(u[1]);
    let across = float::sqrt(u[0]);
    Vec3::new(across * cos_phi, across * sin_phi, float::sqrt(1.0 - u[0]))
}

/// A mixture with a defensive component: with probability `share` a cosine-weighted direction of the
/// hemisphere (a uniform one of the sphere for a mixture there), else one of the mixture.
///
/// For a renderer that keeps another function as the truth, the measured table for example, and uses the
/// mixture to sample it: where the mixture misses the table, the weight stays bounded. See
/// [`max_weight`](Self::max_weight).
#[derive(Clone, Copy, Debug)]
pub struct Defensive<'a, const N: usize> {
    mixture: &'a Mixture<'a, N>,
    share: f32,
}

impl<'a, const N: usize> Defensive<'a, N> {
    /// Adds a defensive component of a share in [0, 1]; 0.02 to 0.05 serves well. A black mixture gives it
    /// all.
    ///
    /// # Errors
    /// [`Error::Share`] for a share outside the range.
    pub fn new(mixture: &'a Mixture<'a, N>, share: f32) -> Result<Self, Error> {
        if !(0.0..=1.0).contains(&share) {
            return Err(Error::Share);
        }
        Ok(Self { mixture, share: if mixture.power == 0.0 { 1.0 } else { share } })
    }

    /// Largest weight `f cos / pdf` that a BRDF of at most `max_brdf`, 1/sr, can have: `pi max_brdf / share`.
    ///
    /// Since `pdf >= share cos / pi`. On the sphere, of a function of at most `max_brdf`: `4 pi max_brdf /
    /// share`.
    pub fn max_weight(&self, max_brdf: f32) -> f32 {
        let solid_angle = if self.mixture.domain == Domain::Hemisphere { PI } else { 4.0 * PI };
        solid_angle * max_brdf / self.share
    }

    /// Evaluates the density; 1/sr.
    #[inline]
    pub fn pdf(&self, direction: Vec3) -> f32 {
        self.mix(direction, self.mixture.pdf(direction))
    }

    #[inline]
    fn mix(&self, direction: Vec3, pdf: f32) -> f32 {
        let defensive = match self.mixture.domain {
            Domain::Hemisphere => direction.z.max(0.0) * FRAC_1_PI,
            Domain::Sphere => 0.25 * FRAC_1_PI,
        };
        (1.0 - self.share) * pdf + self.share * defensive
    }

    /// Draws a direction, three uniform numbers in [0, 1); `value` is the mixture's, `pdf` the whole density.
    ///
    /// `None` only where the density is 0: never, for a share above 0.
    #[inline]
    pub fn sample(&self, u: [f32; 3]) -> Option<Sample> {
        let direction = if u[0] < self.share {
            match self.mixture.domain {
                Domain::Hemisphere => cosine_weighted([u[1], u[2]]),
                Domain::Sphere => {
                    // Heights z = 1 - 2 u are uniform.
                    let (sin_phi, cos_phi) = float::sin_cos_turns(u[2]);
                    let across = 2.0 * float::sqrt(u[1] * (1.0 - u[1]));
                    Vec3::new(across * cos_phi, across * sin_phi, 1.0 - 2.0 * u[1])
                }
            }
        } else {
            let lobe = ((u[0] - self.share) / (1.0 - self.share)).min(1.0 - f32::EPSILON / 2.0);
            let (d, inverse) = draw_one::<f32, N, true>(self.mixture, [lobe, u[1], u[2]]);
            Vec3::from_array(scale(d, inverse))
        };
        let (value, pdf) = self.mixture.evaluate_and_pdf(direction);
        let pdf = self.mix(direction, pdf);
        (pdf > 0.0).then_some(Sample { direction, pdf, value })
    }
}
