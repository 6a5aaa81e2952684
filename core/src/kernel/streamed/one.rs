//! One hit on a material: values, densities and draws for one outgoing direction, without a mixture.

use super::super::between_views::Place;
#[cfg(feature = "simd")]
use super::super::between_views::{head_at, views_passed};
#[cfg(feature = "simd")]
use super::super::draw::{Frame, chosen_power, draw_unscaled};
#[cfg(feature = "simd")]
use super::super::one_direction::with_diffuse;
#[cfg(feature = "simd")]
use super::super::outgoing::Outgoing;
use super::super::outgoing::facing;
use super::super::prepare::prepare;
#[cfg(feature = "simd")]
use super::lobes::{Kept, NOTHING, choice, chosen_lobe, keep, numbers_of, sums};
use super::question::{Answer, Hit, Which};
#[cfg(feature = "simd")]
use crate::color::luminance;
use crate::material::borrowed::{Material, MaterialRef};
use crate::material::layout::{MAX_LOBES, f32_at};
#[cfg(feature = "simd")]
use crate::mixture::factors::Nodes;
use crate::mixture::leave_out::LeaveOut;
use crate::mixture::rows::{Mixture, Sample};
#[cfg(feature = "simd")]
use crate::mixture::rows::{density_of, drawn_density, weight_of};
use crate::simd::detect::Level;
use crate::simd::lanes::Lanes;
#[cfg(feature = "simd")]
use crate::simd::lanes::{WIDEST, scale};
use crate::simd::routine::One;
#[cfg(feature = "simd")]
use crate::squeeze::Squeeze;
use glam::Vec3;

/// One outgoing direction, for a few incident ones: the calls of a renderer at a hit. [`prepare`](Self::prepare) makes a
/// [`Mixture`] for many.
///
/// The lobes go from the bytes of the material through registers, in less time than a mixture takes to be made
/// and asked. Values and densities are those of the mixture but for rounding, below 1e-5 of the largest; draws
/// are its draws. An anisotropic material makes a mixture on the stack.
///
/// An outgoing direction below the horizon, or none at all (not finite, not of unit length), reflects nothing.
impl<B: AsRef<[u8]>> Material<B> {
    /// Evaluates `f cos` for an outgoing and an incident direction, linear sRGB; 1/sr.
    #[inline]
    pub fn evaluate(&self, wo: impl Into<Vec3>, wi: impl Into<Vec3>) -> Vec3 {
        self.evaluate_and_pdf(wo, wi).0
    }

    /// Evaluates the density of [`sample`](Self::sample) at an incident direction; 1/sr.
    #[inline]
    pub fn pdf(&self, wo: impl Into<Vec3>, wi: impl Into<Vec3>) -> f32 {
        ask_one(self.borrowed(), wo.into(), Asked { u: None, wi: Some(wi.into().to_array()), colors: false })
            .pdf
    }

    /// Value and density in one pass over the lobes.
    #[inline]
    pub fn evaluate_and_pdf(&self, wo: impl Into<Vec3>, wi: impl Into<Vec3>) -> (Vec3, f32) {
        let asked = Asked { u: None, wi: Some(wi.into().to_array()), colors: true };
        let answer = ask_one(self.borrowed(), wo.into(), asked);
        (answer.value, answer.pdf)
    }

    /// Draws an incident direction: lobe by `u[0]`, direction in it by `u[1]` and `u[2]`, uniform in [0, 1).
    ///
    /// `None` where nothing is reflected.
    #[inline]
    pub fn sample(&self, wo: impl Into<Vec3>, u: [f32; 3]) -> Option<Sample> {
        ask_one(self.borrowed(), wo.into(), Asked { u: Some(u), wi: None, colors: true }).sample
    }

    /// Draws an incident direction, and evaluates value and density towards another one: what next-event
    /// estimation needs at every hit.
    #[inline]
    pub fn sample_and_evaluate(
        &self,
        wo: impl Into<Vec3>,
        u: [f32; 3],
        wi: impl Into<Vec3>,
    ) -> (Option<Sample>, (Vec3, f32)) {
        let asked = Asked { u: Some(u), wi: Some(wi.into().to_array()), colors: true };
        let answer = ask_one(self.borrowed(), wo.into(), asked);
        (answer.sample, (answer.value, answer.pdf))
    }

    /// Asks for the bytes that a hit from such a direction will read, so that waiting for memory and other work go
    /// side by side: a few hits ahead, where a scene has more materials than caches hold.
    ///
    /// Only a hint; nothing for an anisotropic material, or one in codes.
    #[inline]
    pub fn prefetch(&self, wo: impl Into<Vec3>) {
        prefetch(self.borrowed(), wo.into());
    }
}

/// Bytes of a cache line.
const LINE: usize = 64;

fn prefetch(material: MaterialRef<'_>, wo: Vec3) {
    let header = material.header;
    if !header.is_isotropic() || header.codes.is_some() {
        return;
    }
    // A root and a cubic: within .01 radians of the angle, and anything of a vector that is no direction.
    let fall = 1.0 - wo.z;
    let theta = Lanes::sqrt((fall + fall).max(0.0)) * (fall * (fall * 0.025 + 0.083) + 1.0);
    let angles = &material.bytes[header.theta(0)..header.theta(header.views - 1)];
    let passed = angles.chunks_exact(4).filter(|angle| theta >= f32_at(angle, 0)).count();
    let [from, last] = Place::after(material, passed, theta).rows(header);
    let end = (last + 4 * (5 * header.lobes + header.mirrored)).min(material.bytes.len());
    for line in material.bytes[from..end].chunks(LINE) {
        crate::simd::prefetch(&line[0]);
    }
}

/// The request to a material, beside the outgoing direction.
#[derive(Clone, Copy)]
pub(super) struct Asked {
    /// Uniform numbers of a draw.
    pub u: Option<[f32; 3]>,
    /// Where else it is to be evaluated.
    pub wi: Option<[f32; 3]>,
    /// Whether values, or the weight of the draw, are wanted, and not densities alone.
    pub colors: bool,
}

/// Asks a material.
#[inline(always)]
pub(super) fn ask_one(material: MaterialRef<'_>, wo: Vec3, asked: Asked) -> Answer {
    let Asked { u, wi, colors } = asked;
    let which = Which { draws: u.is_some(), evaluates: wi.is_some(), colors };
    let ([a, b, c], [x, y, z]) = (u.unwrap_or_default(), wi.unwrap_or_default());
    ask_numbers(material, which, wo.x, wo.y, wo.z, a, b, c, x, y, z)
}

/// The same. Numbers travel in registers: who has just stored them one by one would wait for a struct that is read by larger parts.
/// Not generic over who owns the bytes: the kernels are compiled here, once.
#[inline(never)]
#[allow(clippy::too_many_arguments)]
fn ask_numbers(
    material: MaterialRef<'_>,
    which: Which,
    x: f32,
    y: f32,
    z: f32,
    a: f32,
    b: f32,
    c: f32,
    ix: f32,
    iy: f32,
    iz: f32,
) -> Answer {
    let level = Level::current();
    let (wo, u, wi) = ([x, y, z], [a, b, c], [ix, iy, iz]);
    if !material.header.is_isotropic() {
        let Which { draws, evaluates, colors } = which;
        let asked = Asked { u: draws.then_some(u), wi: evaluates.then_some(wi), colors };
        return match material.header.lobe_count() {
            0..=16 => by_mixture::<16>(material, wo.into(), asked, level),
            // A text for each capacity: small programs have one fewer.
            #[cfg(feature = "simd")]
            17..=32 => by_mixture::<32>(material, wo.into(), asked, level),
            _ => by_mixture::<MAX_LOBES>(material, wo.into(), asked, level),
        };
    }
    level.run_one::<_, Ask>(Hit { material, u, wi, which }, wo)
}

/// The same by a mixture on the stack, which only such a call takes.
#[inline(never)]
fn by_mixture<const N: usize>(material: MaterialRef<'_>, wo: Vec3, asked: Asked, level: Level) -> Answer {
    let mut m = Mixture::<N>::empty();
    if prepare(material, wo, LeaveOut::default(), level, &mut m).is_err() {
        return Answer::NOTHING;
    }
    let mut answer = Answer::NOTHING;
    if let Some(u) = asked.u {
        answer.sample = m.sample(u);
    }
    // A mixture of nothing has none but for directions.
    if let Some(wi) = asked.wi.filter(|_| !m.is_nothing()) {
        (answer.value, answer.pdf) = m.evaluate_and_pdf(wi);
    }
    answer
}

/// One hit. The kind of the question is a branch and no parameter of the text: a text for each would be three times the bytes.
struct Ask;

impl One<Hit<'_>> for Ask {
    type Output = Answer;
    const IS_WIDE: bool = true;
    #[inline(always)]
    fn run<L: Lanes>(hit: Hit<'_>, wo: [f32; 3]) -> Answer {
        let Some(outgoing) = facing::<L>(Vec3::from_array(wo)) else { return Answer::NOTHING };
        // A unit vector is no NaN.
        if wo[2] < 0.0 {
            return Answer::NOTHING;
        }
        #[cfg(not(feature = "simd"))]
        return super::small::answer(&hit, &outgoing);
        #[cfg(feature = "simd")]
        {
            let header = hit.material.header;
            match (header.mirrored > 0, header.lobe_count() <= WIDEST) {
                (false, true) => answer::<L, 1, false>(&hit, &outgoing),
                (true, true) => answer::<L, 1, true>(&hit, &outgoing),
                (_, false) => answer::<L, GROUPS, true>(&hit, &outgoing),
            }
        }
    }
}

/// Most groups of sixteen lobes.
#[cfg(feature = "simd")]
pub(super) const GROUPS: usize = MAX_LOBES / WIDEST;

#[cfg(feature = "simd")]
#[inline(always)]
fn answer<L: Lanes, const G: usize, const MIRRORED: bool>(hit: &Hit<'_>, outgoing: &Outgoing) -> Answer {
    let (material, header, which) = (hit.material, hit.material.header, hit.which);
    let place = Place::after(material, views_passed::<L>(material, outgoing.theta), outgoing.theta);
    let (squeeze, diffuse) = head_at::<L>(material, place);
    let diffuse_power = luminance(Vec3::from_array(diffuse));
    let mut lobes = Lobes::<G> {
        kept: [NOTHING; G],
        count: header.lobe_count(),
        squeezed: header.squeezed,
        squeeze: Squeeze::new(outgoing.azimuth, 1.0, 1.0 / squeeze),
        diffuse,
    };
    let lobes_power = keep::<L::Lobes, G, MIRRORED>(material, place, &mut lobes.kept);
    let power = lobes_power + diffuse_power;
    // A sum so small that its inverse is infinite reflects nothing.
    let shines = power >= f32::MIN_POSITIVE;
    let inverse_power = if shines { 1.0 / power } else { 0.0 };
    let factors =
        (which.colors && header.has_factors()).then(|| (Nodes::new(material), outgoing.wo.to_array()));
    let mut answer = Answer::NOTHING;
    // First, as it waits for less: the draw waits for the running sum.
    if which.evaluates {
        (answer.value, answer.pdf) = lobes.towards::<L>(hit.wi, inverse_power, factors.as_ref());
    }
    if which.draws && shines {
        let one = L::One::splat(1.0);
        let target = chosen_power(power, L::One::splat(hit.u[0]));
        let k = chosen_lobe::<L::Lobes, G>(&lobes.kept, lobes.count, target.first());
        let frame = Frame {
            in_plane: !MIRRORED,
            any_squeezed: header.squeezed > 0,
            // Without a branch that depends on the direction.
            any_diffuse: true,
            is_folded: true,
            azimuth: [L::One::splat(outgoing.azimuth[0]), L::One::splat(outgoing.azimuth[1])],
            widen: [one, L::One::splat(squeeze)],
        };
        let mut numbers = [one; 6];
        for (to, number) in numbers.iter_mut().zip(numbers_of(&lobes.kept, k)) {
            *to = L::One::splat(number);
        }
        let is_squeezed = L::One::index_below(k, header.squeezed);
        let choice = choice(numbers, is_squeezed, target.lt(L::One::splat(lobes_power)));
        let (d, inverse) =
            draw_unscaled::<L::One, true>(&frame, choice, L::One::splat(hit.u[1]), L::One::splat(hit.u[2]));
        let [x, y, z] = scale(d, inverse);
        let direction = [x.first(), y.first(), z.first()];
        let (value, pdf) = lobes.towards::<L>(direction, inverse_power, factors.as_ref());
        let direction = Vec3::from_array(direction);
        answer.sample = Some(Sample { direction, pdf: drawn_density(pdf), weight: weight_of(value, pdf) });
    }
    answer
}

#[cfg(feature = "simd")]
/// The lobes of one outgoing direction, with the squeeze and the diffuse term.
struct Lobes<const G: usize> {
    kept: Kept<G>,
    count: usize,
    squeezed: usize,
    squeeze: Squeeze,
    diffuse: [f32; 3],
}

#[cfg(feature = "simd")]
impl<const G: usize> Lobes<G> {
    /// Value and density towards a direction.
    #[inline(always)]
    fn towards<L: Lanes>(
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
        // First, as it is the longer chain of dependent operations: the lobes are summed beside it.
        let factor = factors.map(|(nodes, wo)| nodes.towards::<L::One>(*wo, direction));
        let sights = self.squeeze.see::<L>(direction);
        let acc = sums::<L::Lobes, G>(&self.kept, self.count, self.squeezed, &sights);
        let value = Vec3::from_array(with_diffuse(L::Lobes::three_sums(acc), self.diffuse, direction[2]));
        let pdf = density_of(luminance(value), inverse_power);
        (factor.map_or(value, |factor| value * factor), pdf)
    }
}
