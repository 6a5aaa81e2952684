//! One hit on a small processor: the lobes are worked out anew for each sum over them, which needs less than a
//! kilobyte of stack for any number of them. The numbers are those of the scalar level.

use super::super::between_views::{Place, head_at, views_passed};
use super::super::draw::{Choice, Frame, chosen_power, draw_unscaled};
use super::super::one_direction::with_diffuse;
use super::super::one_lobe::{OneLobe, OneRows, lobe};
use super::super::outgoing::Outgoing;
use super::super::sights::folded_falloff;
use super::question::{Answer, Hit};
use crate::color::luminance;
use crate::material::borrowed::MaterialRef;
use crate::material::layout::Header;
use crate::mixture::complete::LEAST_SHARPNESS;
use crate::mixture::factors::Nodes;
use crate::mixture::rows::{Sample, density_of, drawn_density, weight_of};
use crate::simd::elementary::exp2_and_rest;
use crate::simd::lanes::scale;
use crate::squeeze::{Sight, Squeeze};
use core::f32::consts::{LOG2_E, PI};
use glam::Vec3;

/// The numbers by which a lobe is drawn from: `1 / s`, `1 - exp(-2 s)` and `exp(-2 s)`.
struct Shape {
    inverse: f32,
    inside: f32,
    tail: f32,
}

impl Shape {
    #[inline(always)]
    fn new(sharpness: f32) -> Self {
        let s = sharpness.max(LEAST_SHARPNESS);
        let [tail, inside] = exp2_and_rest(s * (-2.0 * LOG2_E));
        Self { inverse: 1.0 / s, inside, tail }
    }
}

/// The lobes of one outgoing direction.
struct Lobes<'a> {
    header: &'a Header,
    rows: OneRows<'a>,
    squeeze: Squeeze,
    diffuse: [f32; 3],
}

impl Lobes<'_> {
    /// Lobe `k`, the images of the mirrored ones included, above the horizon.
    #[inline(never)]
    fn lobe(&self, k: usize) -> OneLobe {
        let is_image = k >= self.header.lobes;
        let mut lobe = lobe::<true>(&self.rows, if is_image { k - self.header.mirrored } else { k });
        if is_image {
            lobe.axis[1] = 0.0 - lobe.axis[1];
        }
        lobe.axis[2] = lobe.axis[2].abs();
        lobe
    }

    /// Adds the value of lobe `k` towards a direction, as round and as squeezed lobes see it.
    #[inline(always)]
    fn add(&self, k: usize, lobe: &OneLobe, sights: &[Sight; 2], sum: &mut [f32; 3]) {
        let seen = &sights[usize::from(k < self.header.squeezed)];
        let rate = lobe.sharpness * (-0.5 * LOG2_E);
        let g = folded_falloff::<f32, true>(lobe.axis, rate, rate * 4.0 * lobe.axis[2], seen);
        for (sum, amplitude) in sum.iter_mut().zip(lobe.rgb) {
            *sum += g * amplitude;
        }
    }

    /// The first lobe, but for the last, beyond whose running sum of powers a number lies; the sum of the powers up to it.
    #[inline(never)]
    fn powers(&self, target: f32) -> (usize, f32) {
        let (mut k, mut passed) = (0, 0.0);
        loop {
            let lobe = self.lobe(k);
            let Shape { inverse, inside, .. } = Shape::new(lobe.sharpness);
            passed += lobe.luminance * (inverse * inside * (2.0 * PI));
            if target < passed || k + 1 >= self.header.lobe_count() {
                return (k, passed);
            }
            k += 1;
        }
    }

    /// The sum of the values of the lobes towards a direction.
    #[inline(never)]
    fn sum(&self, direction: [f32; 3]) -> [f32; 3] {
        let (sights, mut sum) = (self.squeeze.see::<f32>(direction), [0.0; 3]);
        for k in 0..self.header.lobe_count() {
            self.add(k, &self.lobe(k), &sights, &mut sum);
        }
        sum
    }

    /// Value and density towards a direction.
    #[inline(never)]
    fn towards(
        &self,
        direction: [f32; 3],
        inverse_power: f32,
        factors: Option<&(Nodes<'_>, [f32; 3])>,
    ) -> (Vec3, f32) {
        // False for a NaN too.
        let above = direction[2] >= 0.0;
        if !above {
            return (Vec3::ZERO, 0.0);
        }
        let value = Vec3::from_array(with_diffuse(self.sum(direction), self.diffuse, direction[2]));
        let pdf = density_of(luminance(value), inverse_power);
        (factors.map_or(value, |(nodes, wo)| value * nodes.towards::<f32>(*wo, direction)), pdf)
    }

    /// Draws a direction from lobe `k`, or from the diffuse term.
    #[inline(never)]
    fn draw(&self, outgoing: &Outgoing, squeeze: f32, k: usize, is_lobe: bool, u: [f32; 3]) -> [f32; 3] {
        let lobe = self.lobe(k);
        let shape = Shape::new(lobe.sharpness);
        let frame = Frame {
            in_plane: self.header.mirrored == 0,
            any_squeezed: self.header.squeezed > 0,
            any_diffuse: true,
            is_folded: true,
            azimuth: outgoing.azimuth,
            widen: [1.0, squeeze],
        };
        let choice = Choice {
            axis: lobe.axis,
            inside: shape.inside,
            gone: shape.tail,
            inverse_sharpness: shape.inverse,
            is_squeezed: k < self.header.squeezed,
            is_lobe,
        };
        let (d, inverse) = draw_unscaled::<f32, true>(&frame, choice, u[1], u[2]);
        scale(d, inverse)
    }
}

/// Answers a question to an isotropic material.
#[inline(never)]
pub(super) fn answer(hit: &Hit<'_>, outgoing: &Outgoing) -> Answer {
    let (material, which): (MaterialRef<'_>, _) = (hit.material, hit.which);
    let header = material.header;
    let place = Place::after(material, views_passed::<f32>(material, outgoing.theta), outgoing.theta);
    let (squeeze, diffuse) = head_at::<f32>(material, place);
    let lobes = Lobes {
        header,
        rows: OneRows::new(material, place.between_views()),
        squeeze: Squeeze::new(outgoing.azimuth, 1.0, 1.0 / squeeze),
        diffuse,
    };
    let (_, lobes_power) = lobes.powers(f32::INFINITY);
    let power = lobes_power + luminance(Vec3::from_array(diffuse));
    // A sum so small that its inverse is infinite reflects nothing.
    let shines = power >= f32::MIN_POSITIVE;
    let inverse_power = if shines { 1.0 / power } else { 0.0 };
    let factors =
        (which.colors && header.has_factors()).then(|| (Nodes::new(material), outgoing.wo.to_array()));
    let mut answer = Answer::NOTHING;
    if which.evaluates {
        (answer.value, answer.pdf) = lobes.towards(hit.wi, inverse_power, factors.as_ref());
    }
    if which.draws && shines {
        let target = chosen_power(power, hit.u[0]);
        let (k, _) = lobes.powers(target);
        let direction = lobes.draw(outgoing, squeeze, k, target < lobes_power, hit.u);
        let (value, pdf) = lobes.towards(direction, inverse_power, factors.as_ref());
        let direction = Vec3::from_array(direction);
        answer.sample = Some(Sample { direction, pdf: drawn_density(pdf), weight: weight_of(value, pdf) });
    }
    answer
}
