//! One hit on a material: values, densities and draws for one outgoing direction, without a mixture.

#[cfg(feature = "simd")]
use super::super::among_rings::Frame as TurnedFrame;
#[cfg(feature = "simd")]
use super::super::between_views::{Place, head_at, views_passed};
#[cfg(feature = "simd")]
use super::super::block::{add, axes, chosen_lobe};
#[cfg(feature = "simd")]
use super::super::draw::{Choice, Frame, chosen_power, draw_unscaled};
#[cfg(feature = "simd")]
use super::super::one_direction::with_diffuse;
#[cfg(feature = "simd")]
use super::super::outgoing::Outgoing;
use super::super::outgoing::facing;
use super::super::prepare::prepare;
#[cfg(feature = "simd")]
use super::super::sights::folded_falloff;
#[cfg(feature = "simd")]
use super::lobes::{fill, fill_second, fold_rate};
use super::question::{Answer, Hit, Which};
#[cfg(feature = "simd")]
use crate::color::luminance;
use crate::material::borrowed::{Material, MaterialRef};
use crate::material::layout::MAX_LOBES;
#[cfg(feature = "simd")]
use crate::mixture::factors::Nodes;
use crate::mixture::leave_out::LeaveOut;
#[cfg(feature = "simd")]
use crate::mixture::row::{self, Aligned, Group};
use crate::mixture::rows::{AnyMixture, Groups, Mixture, Room, Sample};
#[cfg(feature = "simd")]
use crate::mixture::rows::{density_of, drawn_density, weight_of};
use crate::simd::detect::Level;
use crate::simd::lanes::{Lanes, WIDEST};
#[cfg(feature = "simd")]
use crate::simd::lanes::{PARTS, scale};
use crate::simd::routine::One;
#[cfg(feature = "simd")]
use crate::squeeze::{Sight, Squeeze};
use glam::Vec3;

/// One outgoing direction, for a few incident ones: the calls of a renderer at a hit. [`prepare`](Self::prepare) makes a
/// [`Mixture`] for many.
///
/// The lobes go from the bytes of the material through registers, in less time than a mixture takes to be made
/// and asked. Values and densities are those of the mixture but for rounding, below 1e-5 of the largest; draws
/// are its draws. Without vectors an anisotropic material makes a mixture on the stack.
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
}

/// The request to a material, beside the outgoing direction.
#[derive(Clone, Copy)]
pub(crate) struct Asked {
    /// Uniform numbers of a draw.
    pub u: Option<[f32; 3]>,
    /// Where else it is to be evaluated.
    pub wi: Option<[f32; 3]>,
    /// Whether values, or the weight of the draw, are wanted, and not densities alone.
    pub colors: bool,
}

/// Asks a material.
#[inline(always)]
pub(crate) fn ask_one(material: MaterialRef<'_>, wo: Vec3, asked: Asked) -> Answer {
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
    if !material.header.is_isotropic() && (cfg!(not(feature = "simd")) || level == Level::Scalar) {
        let Which { draws, evaluates, colors } = which;
        let asked = Asked { u: draws.then_some(u), wi: evaluates.then_some(wi), colors };
        // Room that is not needed is not cleared.
        return if material.header.lobe_count() <= WIDEST {
            by_mixture::<16>(material, wo.into(), asked, level)
        } else {
            by_mixture::<MAX_LOBES>(material, wo.into(), asked, level)
        };
    }
    #[cfg(not(feature = "simd"))]
    return level.run_one::<_, Ask>(Hit { material, u, wi, which }, wo);
    #[cfg(feature = "simd")]
    if material.header.lobe_count() <= WIDEST {
        in_groups::<1>(material, u, wi, which, level, wo)
    } else {
        in_groups::<PARTS>(material, u, wi, which, level, wo)
    }
}

/// The same in room on the stack, which only such a call takes.
#[cfg(feature = "simd")]
#[inline(never)]
fn in_groups<const G: usize>(
    material: MaterialRef<'_>,
    u: [f32; 3],
    wi: [f32; 3],
    which: Which,
    level: Level,
    wo: [f32; 3],
) -> Answer {
    let mut groups = Aligned::<G>::EMPTY;
    let groups = &mut groups.0[..];
    if material.header.is_isotropic() {
        level.run_one::<_, Ask>(Hit { material, u, wi, which, groups, frame: None }, wo)
    } else {
        turned(material, u, wi, which, level, wo, groups)
    }
}

/// The same of an anisotropic material: a text of its own fills the lobes.
#[cfg(feature = "simd")]
#[inline(never)]
fn turned(
    material: MaterialRef<'_>,
    u: [f32; 3],
    wi: [f32; 3],
    which: Which,
    level: Level,
    wo: [f32; 3],
    groups: &mut [Group],
) -> Answer {
    let frame = TurnedFrame::of_one(material, wo.into(), level, groups);
    if !frame.is_there {
        return Answer::NOTHING;
    }
    level.run_one::<_, Ask>(Hit { material, u, wi, which, groups, frame: Some(&frame) }, wo)
}

/// The same by a mixture on the stack, which only such a call takes.
#[inline(never)]
fn by_mixture<const N: usize>(material: MaterialRef<'_>, wo: Vec3, asked: Asked, level: Level) -> Answer
where
    Room<N>: Groups,
{
    in_room(material, wo, asked, level, &mut Mixture::<N>::empty())
}

#[inline(never)]
fn in_room<'m>(
    material: MaterialRef<'m>,
    wo: Vec3,
    asked: Asked,
    level: Level,
    m: &mut AnyMixture<'m>,
) -> Answer {
    if prepare(material, wo, LeaveOut::default(), level, m).is_err() {
        return Answer::NOTHING;
    }
    ask_mixture(m, asked)
}

/// Asks a mixture.
pub(crate) fn ask_mixture(m: &AnyMixture<'_>, asked: Asked) -> Answer {
    let mut answer = Answer::NOTHING;
    #[cfg(feature = "simd")]
    {
        answer.power = m.power();
    }
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
        #[cfg(feature = "simd")]
        let framed = hit.frame.map(|frame| frame.outgoing(wo.into()));
        #[cfg(not(feature = "simd"))]
        let framed = None;
        let Some(outgoing) = framed.or_else(|| facing::<L>(Vec3::from_array(wo))) else {
            return Answer::NOTHING;
        };
        // A unit vector is no NaN.
        if wo[2] < 0.0 {
            return Answer::NOTHING;
        }
        #[cfg(not(feature = "simd"))]
        return super::small::answer(&hit, &outgoing);
        #[cfg(feature = "simd")]
        {
            let Hit { groups, .. } = hit;
            let hit = Hit { groups: &mut [], ..hit };
            if L::FUSED && groups.len() == 1 {
                answer::<L, true>(&hit, &outgoing, groups)
            } else {
                answer::<L, false>(&hit, &outgoing, groups)
            }
        }
    }
}

#[cfg(feature = "simd")]
#[inline(always)]
fn answer<L: Lanes, const FEW: bool>(hit: &Hit<'_>, outgoing: &Outgoing, groups: &mut [Group]) -> Answer {
    let (material, header, which) = (hit.material, hit.material.header, hit.which);
    let ([along, inverse], widen, diffuse, lobes_power) = if let Some(frame) = hit.frame {
        let widen = [1.0 / frame.stretch[0], 1.0 / frame.stretch[1]];
        let lobes_power = fill_second::<L::Lobes, FEW>(header.lobes, groups);
        (frame.stretch, widen, frame.diffuse, lobes_power)
    } else {
        let place = Place::after(material, views_passed::<L>(material, outgoing.theta), outgoing.theta);
        let (squeeze, diffuse) = head_at::<L>(material, place);
        let lobes_power = fill::<L::Lobes, FEW>(material, place, groups);
        ([1.0, 1.0 / squeeze], [1.0, squeeze], diffuse, lobes_power)
    };
    let diffuse_power = luminance(Vec3::from_array(diffuse));
    let lobes = Lobes {
        groups,
        count: header.lobe_count(),
        squeezed: header.squeezed,
        squeeze: Squeeze::new(outgoing.azimuth, along, inverse),
        diffuse,
    };
    let power = lobes_power + diffuse_power;
    // A sum so small that its inverse is infinite reflects nothing.
    let shines = power >= f32::MIN_POSITIVE;
    let inverse_power = if shines { 1.0 / power } else { 0.0 };
    let factors =
        (which.colors && header.has_factors()).then(|| (Nodes::new(material), outgoing.wo.to_array()));
    let mut answer = Answer { power: if shines { power } else { 0.0 }, ..Answer::NOTHING };
    // First, as it waits for less: the draw waits for the running sum.
    if which.evaluates {
        (answer.value, answer.pdf) = lobes.towards::<L, FEW>(hit.wi, inverse_power, factors.as_ref());
    }
    if which.draws && shines {
        let target = chosen_power(power, L::One::splat(hit.u[0]));
        let k = chosen_lobe::<L::Lobes, FEW>(lobes.groups, lobes.count, target.first());
        let frame = Frame {
            in_plane: header.mirrored == 0 && hit.frame.is_none(),
            any_squeezed: header.squeezed > 0,
            // Without a branch that depends on the direction.
            any_diffuse: true,
            is_folded: true,
            azimuth: [L::One::splat(outgoing.azimuth[0]), L::One::splat(outgoing.azimuth[1])],
            widen: [L::One::splat(widen[0]), L::One::splat(widen[1])],
        };
        let (group, at) = (&lobes.groups[(k / WIDEST).min(lobes.groups.len() - 1)], k % WIDEST);
        let choice = Choice {
            axis: [
                L::One::splat(group[row::AXIS_X][at]),
                L::One::splat(group[row::AXIS_Y][at]),
                L::One::splat(group[row::AXIS_Z][at]),
            ],
            inside: L::One::splat(group[row::INSIDE][at]),
            gone: L::One::splat(group[row::TAIL][at]),
            inverse_sharpness: L::One::splat(group[row::INVERSE_SHARPNESS][at]),
            is_squeezed: L::One::index_below(k, header.squeezed),
            is_lobe: target.lt(L::One::splat(lobes_power)),
        };
        let (d, inverse) =
            draw_unscaled::<L::One, true>(&frame, choice, L::One::splat(hit.u[1]), L::One::splat(hit.u[2]));
        let [x, y, z] = scale(d, inverse);
        let direction = [x.first(), y.first(), z.first()];
        let (value, pdf) = lobes.towards::<L, FEW>(direction, inverse_power, factors.as_ref());
        let direction = Vec3::from_array(direction);
        answer.sample = Some(Sample { direction, pdf: drawn_density(pdf), weight: weight_of(value, pdf) });
    }
    answer
}

/// The lobes of one outgoing direction, with the squeeze and the diffuse term.
#[cfg(feature = "simd")]
struct Lobes<'a> {
    groups: &'a [Group],
    count: usize,
    squeezed: usize,
    squeeze: Squeeze,
    diffuse: [f32; 3],
}

#[cfg(feature = "simd")]
impl Lobes<'_> {
    /// Value and density towards a direction.
    #[inline(always)]
    fn towards<L: Lanes, const FEW: bool>(
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
        let acc = self.sums::<L::Lobes, FEW>(&self.squeeze.see::<L>(direction));
        let value = Vec3::from_array(with_diffuse(L::Lobes::three_sums(acc), self.diffuse, direction[2]));
        let pdf = density_of(luminance(value), inverse_power);
        (factor.map_or(value, |factor| value * factor), pdf)
    }

    /// Sums the lobes in red, green and blue towards a direction, as round and as squeezed ones see it.
    #[inline(always)]
    fn sums<L: Lanes, const FEW: bool>(&self, [turned, squeezed]: &[Sight; 2]) -> [L; 3] {
        let mut acc = [L::splat(0.0); 3];
        row::for_lobes!(FEW, L, self.groups, self.count, |group, at, k| {
            let mask = L::first_lanes(self.squeezed.saturating_sub(k).min(L::COUNT));
            let (axis, rate) = (axes(group, at), L::load(&group[row::RATE][at..]));
            let seen = Sight::splat_either::<L>(mask, squeezed, turned);
            let g = folded_falloff::<L, true>(axis, rate, fold_rate(rate, axis[2]), &seen);
            add(group, at, g, &mut acc);
        });
        acc
    }
}
