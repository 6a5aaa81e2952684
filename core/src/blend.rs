//! Blends: several materials at one hit, each with a weight and a tint.
//!
//! A draw chooses a part by weight times power, and the density is the sum of all densities by those shares. So a draw has the density that
//! is evaluated. A part that is alone is asked as if there were no blend.
//!
//! [`part`] has the parts, [`coat`] a clear coat, [`requests`] asks for many hits.
//! May import: `mixture`, `kernel`, `material`, `color`, `simd`, `error`.

pub(crate) mod coat;
pub(crate) mod part;
mod requests;

use crate::error::Error;
use crate::kernel::draw::choose;
use crate::kernel::prepare::prepare;
use crate::kernel::streamed::one::Asked;
use crate::kernel::streamed::question::Answer;
use crate::material::layout::MAX_LOBES;
use crate::mixture::leave_out::LeaveOut;
use crate::mixture::rows::{AnyMixture, Groups, Mixture, Room, Sample, drawn_density, weight_of};
use crate::simd::detect::Level;
use crate::simd::lanes::WIDEST;
use coat::through;
use glam::Vec3;
use part::{BlendPart, Of};

/// Most parts of a [`Blend`].
pub const MAX_BLEND: usize = 8;

/// Several materials or mixtures at one hit: the value is the sum of theirs, each times its weight and its tint.
///
/// It borrows its [parts](BlendPart), so that one is made at every hit. The verbs are those of a [`Material`](crate::Material), with the same
/// directions and units. A part that is a mixture has its outgoing direction already, which has to be `wo`.
///
/// Draws choose a part by the luminance of weight and tint, times its power. Where a single part is not black, the cost is that of a hit
/// on it alone. With weight and tint 1 the answers are its own to the bit. Otherwise each material makes a mixture on the stack: 1.3 kB,
/// or 4.4 of a material of more than 16 lobes, in room for two, four or eight.
///
/// Weights need not sum to 1. Energy is kept where the parts keep it and the sum of the weights, times their tints, is at most 1 in each channel.
///
/// # Examples
/// ```
/// # #[cfg(feature = "std")] {
/// use srbf_core::{Blend, BlendPart, Material};
///
/// # let folder = if std::path::Path::new("presets").exists() { "presets" } else { "../presets" };
/// # let load = |name| Material::from_bytes(std::fs::read(format!("{folder}/{name}.srbf")).unwrap()).unwrap();
/// let (paint, metal) = (load("garnet_red"), load("cayman"));
/// // At every hit: the weights of a texture.
/// let parts = [BlendPart::new(&paint, 0.7), BlendPart::new(&metal, 0.3).tinted([1.0, 0.8, 0.6])];
/// let blend = Blend::new(&parts).unwrap();
/// let wo = [0.6, 0.0, 0.8];
/// let sample = blend.sample(wo, [0.9, 0.6, 0.1]).expect("it reflects");
/// let (value, pdf) = blend.evaluate_and_pdf(wo, sample.direction);
/// assert!((value / pdf - sample.weight).abs().max_element() < 1e-4);
/// assert!(blend.albedo(wo).max_element() < 1.0);
///
/// // Or one of them at random, at the cost of one hit: the same in the mean.
/// let (_, part, left) = blend.choose(0.9);
/// let one = [part];
/// let sample = Blend::new(&one).unwrap().sample(wo, [left, 0.6, 0.1]);
/// assert!(sample.is_some());
/// # }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Blend<'a> {
    parts: &'a [BlendPart<'a>],
    /// Bit k: part k is not black.
    seen: u32,
}

impl<'a> Blend<'a> {
    /// Blends 1 to [`MAX_BLEND`] parts. One of weight 0, or of a black tint, costs nothing.
    ///
    /// # Errors
    /// [`Error::Parts`] for no part and for too many; [`Error::Weight`] for a weight or a tint that is NaN or outside [0, 1000]. It is for a coat
    /// outside [1, 10] too, and where no weight is above 0.
    #[inline]
    pub fn new(parts: &'a [BlendPart<'a>]) -> Result<Self, Error> {
        if parts.is_empty() || parts.len() > MAX_BLEND {
            return Err(Error::Parts);
        }
        let (mut seen, mut weight, mut is_valid) = (0, 0.0, true);
        for (k, part) in parts.iter().enumerate() {
            // Without branches.
            is_valid &= part.is_valid();
            weight += part.weight;
            seen |= u32::from(part.brightness() > 0.0) << k;
        }
        if is_valid & (weight > 0.0) { Ok(Self { parts, seen }) } else { Err(Error::Weight) }
    }

    /// Evaluates `f cos` for an outgoing and an incident direction, linear sRGB; 1/sr.
    #[inline]
    pub fn evaluate(&self, wo: impl Into<Vec3>, wi: impl Into<Vec3>) -> Vec3 {
        self.evaluate_and_pdf(wo, wi).0
    }

    /// Evaluates the density of [`sample`](Self::sample) at an incident direction; 1/sr.
    #[inline]
    pub fn pdf(&self, wo: impl Into<Vec3>, wi: impl Into<Vec3>) -> f32 {
        self.ask_one(wo.into(), Asked { u: None, wi: Some(wi.into().to_array()), colors: false }).pdf
    }

    /// Value and density in one pass over the lobes.
    #[inline]
    pub fn evaluate_and_pdf(&self, wo: impl Into<Vec3>, wi: impl Into<Vec3>) -> (Vec3, f32) {
        let asked = Asked { u: None, wi: Some(wi.into().to_array()), colors: true };
        let answer = self.ask_one(wo.into(), asked);
        (answer.value, answer.pdf)
    }

    /// Draws an incident direction: part and lobe by `u[0]`, direction in it by `u[1]` and `u[2]`, uniform in [0, 1).
    ///
    /// `None` where nothing is reflected.
    #[inline]
    pub fn sample(&self, wo: impl Into<Vec3>, u: [f32; 3]) -> Option<Sample> {
        self.ask_one(wo.into(), Asked { u: Some(u), wi: None, colors: true }).sample
    }

    /// Draws an incident direction, and evaluates value and density towards another one: what next-event estimation needs at every
    /// hit.
    #[inline]
    pub fn sample_and_evaluate(
        &self,
        wo: impl Into<Vec3>,
        u: [f32; 3],
        wi: impl Into<Vec3>,
    ) -> (Option<Sample>, (Vec3, f32)) {
        let asked = Asked { u: Some(u), wi: Some(wi.into().to_array()), colors: true };
        let answer = self.ask_one(wo.into(), asked);
        (answer.sample, (answer.value, answer.pdf))
    }

    /// Integral of the value over the hemisphere, in closed form: the sum of the albedos, each times weight and tint; linear sRGB.
    ///
    /// Below a coat it is a bound from above, as the transmittance of the coat towards `wi` is taken as 1.
    pub fn albedo(&self, wo: impl Into<Vec3>) -> Vec3 {
        self.with_mixtures(wo.into(), None).value
    }

    /// Chooses one of the parts at random, by the luminance of weight and tint, and the number that is left of `u` for its draw.
    ///
    /// A blend of that part alone has the values of this one in the mean, at the cost of one hit. Its densities are its
    /// own. All that is asked at a hit, draws and values, has to be asked of the one part that was chosen for it.
    ///
    /// Returns: its place, the part, and the number.
    pub fn choose(&self, u: f32) -> (usize, BlendPart<'a>, f32) {
        let mut shares = [0.0; MAX_BLEND];
        for (share, part) in shares.iter_mut().zip(self.parts) {
            *share = part.brightness();
        }
        complete(&mut shares[..self.parts.len()]);
        let (k, left) = choose(&shares, u);
        let part = self.parts[k.min(self.parts.len() - 1)];
        let share = shares[k];
        let color = if share > 0.0 { part.color() / share } else { Vec3::ZERO };
        // Alone it is the same to the bit.
        (
            k,
            if self.seen.count_ones() == 1 { part } else { BlendPart { weight: 1.0, tint: color, ..part } },
            left,
        )
    }

    /// The parts that are not black.
    #[inline(always)]
    fn seen(&self) -> impl Iterator<Item = &'a BlendPart<'a>> {
        let seen = self.seen;
        self.parts.iter().enumerate().filter(move |(k, _)| seen >> k & 1 == 1).map(|(_, part)| part)
    }

    /// The part that is not black, if there is but one.
    #[inline(always)]
    fn only(&self) -> Option<&'a BlendPart<'a>> {
        if self.seen.is_power_of_two() { self.parts.get(self.seen.trailing_zeros() as usize) } else { None }
    }

    /// Asks for one hit.
    #[inline(always)]
    fn ask_one(&self, wo: Vec3, asked: Asked) -> Answer {
        match self.only() {
            Some(part) => part.alone(wo, asked),
            None => self.mixed(wo, asked),
        }
    }

    /// The answer of more parts than one, or of none.
    #[inline(never)]
    fn mixed(&self, wo: Vec3, asked: Asked) -> Answer {
        #[cfg(feature = "simd")]
        if let (None, Some(wi)) = (asked.u, asked.wi) {
            return self.towards(wo, wi.into(), asked);
        }
        self.with_mixtures(wo, Some(asked))
    }

    /// Value and density of all parts towards a direction: without mixtures, as no draw needs them again.
    #[cfg(feature = "simd")]
    fn towards(&self, wo: Vec3, wi: Vec3, asked: Asked) -> Answer {
        let (mut answer, mut total) = (Answer::NOTHING, 0.0);
        for part in self.seen() {
            let own = part.ask(wo, asked);
            let power = part.draws(wo) * own.power;
            total += power;
            answer.value += own.value * part.scale(wo, wi);
            answer.pdf += own.pdf * power;
        }
        answer.pdf = if is_shining(total) { answer.pdf / total } else { 0.0 };
        answer
    }

    /// Asks by mixtures, in room on the stack for those of materials; the value is the albedo if nothing else is asked.
    fn with_mixtures(&self, wo: Vec3, asked: Option<Asked>) -> Answer {
        let (mut count, mut lobes) = (0, 0);
        for part in self.seen() {
            if let Of::Material(material) = part.of {
                (count, lobes) = (count + 1, lobes.max(material.header.lobe_count()));
            }
        }
        // Room that is not needed is not cleared.
        match (count, lobes <= WIDEST) {
            (0, _) => self.answer(wo, asked, &mut []),
            (1..=2, true) => self.in_room::<WIDEST, 2>(wo, asked),
            (1..=2, false) => self.in_room::<MAX_LOBES, 2>(wo, asked),
            (3..=4, true) => self.in_room::<WIDEST, 4>(wo, asked),
            (3..=4, false) => self.in_room::<MAX_LOBES, 4>(wo, asked),
            (_, true) => self.in_room::<WIDEST, MAX_BLEND>(wo, asked),
            (_, false) => self.in_room::<MAX_LOBES, MAX_BLEND>(wo, asked),
        }
    }

    #[inline(never)]
    fn in_room<const N: usize, const K: usize>(&self, wo: Vec3, asked: Option<Asked>) -> Answer
    where
        Room<N>: Groups,
    {
        let mut mixtures = [const { Mixture::<N>::empty() }; K];
        self.answer(wo, asked, &mut mixtures.each_mut().map(AsMut::as_mut))
    }

    /// Not generic over the room.
    #[inline(never)]
    fn answer<'r>(&'r self, wo: Vec3, asked: Option<Asked>, room: &'r mut [&mut AnyMixture<'a>]) -> Answer {
        let (mut left, level) = (room.iter_mut(), Level::current());
        let mut mixed = Mixed { of: [None; MAX_BLEND], shares: [0.0; MAX_BLEND] };
        let mut count = 0;
        for part in self.seen() {
            let mixture: &'r AnyMixture<'r> = match part.of {
                Of::Mixture(mixture) => mixture,
                Of::Material(material) => {
                    let Some(room) = left.next() else { continue };
                    // No direction leaves an empty mixture, and there is room for all lobes.
                    let _ = prepare(material, wo, LeaveOut::default(), level, room);
                    room
                }
            };
            mixed.of[count] = Some(Part { mixture, part });
            mixed.shares[count] = part.draws(wo) * mixture.power();
            count += 1;
        }
        complete(&mut mixed.shares[..count]);
        match asked {
            Some(asked) => mixed.answer(wo, asked),
            None => Answer { value: mixed.albedo(wo), ..Answer::NOTHING },
        }
    }
}

/// The mixtures of a blend for one outgoing direction.
struct Mixed<'a> {
    of: [Option<Part<'a>>; MAX_BLEND],
    /// Shares of the draws, which sum to 1; all of them 0 where nothing is drawn.
    shares: [f32; MAX_BLEND],
}

#[derive(Clone, Copy)]
struct Part<'a> {
    mixture: &'a AnyMixture<'a>,
    part: &'a BlendPart<'a>,
}

/// Whether something is drawn where powers have a sum: of a sum so small that its inverse is infinite nothing is.
#[inline(always)]
fn is_shining(total: f32) -> bool {
    (f32::MIN_POSITIVE..=f32::MAX).contains(&total)
}

/// Divides shares by their sum.
fn complete(shares: &mut [f32]) {
    let total: f32 = shares.iter().sum();
    let shines = is_shining(total);
    shares.iter_mut().for_each(|share| *share = if shines { *share / total } else { 0.0 });
}

impl Mixed<'_> {
    fn albedo(&self, wo: Vec3) -> Vec3 {
        let all = self.of.iter().flatten();
        all.map(|Part { mixture, part }| part.color() * through(part.coat, wo.z) * mixture.albedo()).sum()
    }

    #[inline(always)]
    fn answer(&self, wo: Vec3, asked: Asked) -> Answer {
        let mut answer = Answer::NOTHING;
        if let Some(wi) = asked.wi {
            (answer.value, answer.pdf) = self.towards(wo, wi.into(), asked.colors, None);
        }
        if let Some([first, second, third]) = asked.u {
            let (k, first) = choose(&self.shares, first);
            let drawn = self.of[k].and_then(|of| of.mixture.sample([first, second, third]));
            if let Some(Sample { direction, pdf, weight }) = drawn.filter(|_| self.shares[k] > 0.0) {
                let (value, pdf) = self.towards(wo, direction, asked.colors, Some((k, weight * pdf, pdf)));
                answer.sample =
                    Some(Sample { direction, pdf: drawn_density(pdf), weight: weight_of(value, pdf) });
            }
        }
        answer
    }

    /// Value and density towards a direction. `known`: the place of a part of which they are known.
    #[inline(always)]
    fn towards(&self, wo: Vec3, wi: Vec3, colors: bool, known: Option<(usize, Vec3, f32)>) -> (Vec3, f32) {
        let (mut value, mut pdf) = (Vec3::ZERO, 0.0);
        for (k, of) in self.of.iter().enumerate() {
            let Some(Part { mixture, part }) = of else { break };
            let share = self.shares[k];
            if mixture.is_nothing() {
                continue;
            }
            if let Some((_, own, density)) = known.filter(|(place, ..)| *place == k) {
                value += own * part.scale(wo, wi);
                pdf += share * density;
            } else if colors {
                let (own, density) = mixture.evaluate_and_pdf(wi);
                value += own * part.scale(wo, wi);
                pdf += share * density;
            } else {
                pdf += share * mixture.pdf(wi);
            }
        }
        (value, pdf)
    }
}
