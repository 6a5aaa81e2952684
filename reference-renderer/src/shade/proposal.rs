//! A sampler got ready for one outgoing direction.

use crate::numbers::points::{Decision, Points};
use crate::numbers::random::Random;
use crate::truth::LargeMixture;
use glam::{DVec3, Vec3};
use srbf_core::{MAX_LOBES, SheetMixture};
use srbf_thesis::samplers::ggx_parts;
use srbf_thesis::samplers::plain::{UNIFORM_DENSITY, cosine, cosine_density, uniform};
use srbf_thesis::samplers::{analytic, factored, lafortune, rgl, tabulated, thesis};

/// Storage that a proposal may need: our lobes, those of the thesis, and those of a sheet, once one is met.
pub struct Mixtures<'a> {
    pub lobes: LargeMixture<'a>,
    pub round: LargeMixture<'a>,
    pub sheet: Option<Box<SheetMixture<'a, MAX_LOBES>>>,
}

impl Mixtures<'_> {
    /// Without lobes.
    pub fn empty() -> Self {
        Self { lobes: LargeMixture::empty(), round: LargeMixture::empty(), sheet: None }
    }
}

/// What draws.
pub enum Part<'a> {
    Uniform,
    Cosine,
    /// The mixture `lobes`.
    Lobes,
    Guided(ggx_parts::GgxProposal),
    Analytic(analytic::AnalyticProposal),
    Lafortune(lafortune::LafortuneProposal),
    Tabulated(tabulated::TabulatedProposal<'a>),
    Factored(factored::FactoredProposal<'a>),
    Rgl(rgl::RglProposal<'a>),
    /// The mixture `round`.
    Thesis(thesis::ThesisProposal),
    /// The mixtures `sheet`, which draw on both sides.
    Sheet,
}

/// A sampler for one outgoing direction: a part that is like the material, and a share of the cosine. All directions are unit vectors
/// in the shading frame.
pub struct Proposal<'a> {
    pub part: Part<'a>,
    /// Share of directions that are drawn from the cosine, 0 to 1: with any, no weight explodes where the part misses the material.
    pub cosine: f32,
    /// Whether several directions are drawn together.
    pub is_multi: bool,
}

/// A direction that was drawn together with others.
#[derive(Clone, Copy, Debug)]
pub struct Drawn {
    pub direction: Vec3,
    /// Divisor of the value: the mean of such quotients estimates the integral.
    pub divisor: f32,
    /// Density of a direction drawn alone, which is what weights beside the light are made of; 1/sr.
    pub pdf: f32,
}

impl Proposal<'_> {
    /// Nothing but the cosine.
    pub fn cosine() -> Self {
        Self { part: Part::Cosine, cosine: 0.0, is_multi: false }
    }

    /// The warps of a file, and the numbers that draw by them; `None` where another part draws, or the cosine does.
    #[inline]
    pub fn warps(&self, [choice, u, v]: [f32; 3]) -> Option<(&rgl::RglProposal<'_>, [f32; 3])> {
        match &self.part {
            Part::Rgl(warps) if choice >= self.cosine => Some((warps, [0.0, u, v])),
            _ => None,
        }
    }

    /// Draws a direction, three uniform numbers in [0, 1); `None` where there is none to draw, which counts as black.
    #[inline]
    pub fn sample(&self, mixtures: &Mixtures<'_>, [choice, u, v]: [f32; 3]) -> Option<Vec3> {
        let direction = if choice < self.cosine {
            cosine(u.into(), v.into()).as_vec3()
        } else {
            let rest = ((choice - self.cosine) / (1.0 - self.cosine)).min(LARGEST);
            self.sample_part(mixtures, [rest, u, v])?
        };
        // Rounded first: value and density are those of the direction that is handed out.
        self.is_seen(direction).then_some(direction)
    }

    /// Whether light from a direction is seen: on the side of the viewer, and through a sheet.
    #[inline]
    fn is_seen(&self, direction: Vec3) -> bool {
        direction.z > 0.0 || matches!(self.part, Part::Sheet)
    }

    /// Density of [`sample`](Self::sample); 1/sr. Its integral over the hemisphere is at most 1: of most parts, some directions lie
    /// below it.
    #[inline]
    pub fn pdf(&self, mixtures: &Mixtures<'_>, wi: Vec3) -> f32 {
        if !self.is_seen(wi) {
            return 0.0;
        }
        self.mix(self.part_pdf(mixtures, wi), wi)
    }

    /// The density of the whole from that of the part.
    #[inline]
    pub fn mix(&self, pdf: f32, wi: Vec3) -> f32 {
        if self.cosine > 0.0 {
            (1.0 - self.cosine) * pdf + self.cosine * cosine_density(wi.as_dvec3()) as f32
        } else {
            pdf
        }
    }

    /// The number that chooses the lobe of direction `i` of `n`: of several drawn together by systematic resampling, such that each
    /// lobe has as many as its integral is worth, rounded up or down. The balance heuristic of equation 13 then divides by the
    /// density of the whole mixture.
    pub fn choice(&self, i: u32, n: u32, offset: f32) -> f32 {
        ((i as f32 + offset) / n as f32).min(LARGEST)
    }

    /// Draws `n` directions as the thesis says: each of a lobe by equation 14, divided by what equation 13 makes of how many each
    /// lobe has. One is of the cosine: lobes that have none by chance leave no hole. `None` if another sampler draws, or a single
    /// direction is asked for.
    pub fn sample_as_thesis(&self, mixtures: &Mixtures<'_>, n: u32, points: &Points) -> Option<Vec<Drawn>> {
        let Part::Thesis(lobes) = &self.part else { return None };
        if !self.is_multi || n == 1 {
            return None;
        }
        let numbers = |i: u32| points.branch(i as usize, n as usize).draw(Decision::Material, 0);
        let [_, u, v, _] = numbers(0);
        let mut directions = vec![cosine(u.into(), v.into()).as_vec3()];
        let densities = lobes.sample_together((1..n).map(numbers), &mut directions);
        let share = 1.0 / n as f32;
        let drawn = |direction: Vec3| {
            let of_lobes = densities.as_ref().map_or(0.0, |mixture| mixture.evaluate(direction).x);
            let of_cosine = cosine_density(direction.as_dvec3()) as f32;
            let divisor = share * of_cosine + (1.0 - share) * of_lobes;
            Drawn { direction, divisor, pdf: self.pdf(mixtures, direction) }
        };
        Some(directions.into_iter().filter(|direction| direction.z > 0.0).map(drawn).collect())
    }

    fn sample_part(&self, mixtures: &Mixtures<'_>, u: [f32; 3]) -> Option<Vec3> {
        let wide = u.map(f64::from);
        let direction = match &self.part {
            Part::Lobes => return mixtures.lobes.sample(u).map(|sample| sample.direction),
            Part::Sheet => return mixtures.sheet.as_ref()?.sample(u).map(|sample| sample.direction),
            Part::Thesis(lobes) => {
                return lobes.sample(&mixtures.round, u, |[a, b, c]| Random::new(a, b, c));
            }
            Part::Uniform => uniform(wide[1], wide[2]),
            Part::Cosine => cosine(wide[1], wide[2]),
            Part::Guided(proposal) => proposal.sample(wide),
            Part::Analytic(proposal) => proposal.sample(wide),
            Part::Lafortune(proposal) => proposal.sample(wide),
            Part::Tabulated(proposal) => proposal.sample(wide),
            Part::Factored(proposal) => proposal.sample(wide),
            Part::Rgl(proposal) => return Some(proposal.draw(u).0),
        };
        Some(direction.as_vec3())
    }

    fn part_pdf(&self, mixtures: &Mixtures<'_>, wi: Vec3) -> f32 {
        let wide: DVec3 = match &self.part {
            Part::Lobes => return mixtures.lobes.pdf(wi),
            Part::Sheet => return mixtures.sheet.as_ref().map_or(0.0, |pair| pair.evaluate_and_pdf(wi).1),
            Part::Thesis(_) => return mixtures.round.pdf(wi),
            Part::Uniform => return UNIFORM_DENSITY as f32,
            Part::Rgl(proposal) => return proposal.look_up(wi).density,
            _ => wi.as_dvec3().normalize(),
        };
        let density = match &self.part {
            Part::Lobes | Part::Sheet | Part::Thesis(_) | Part::Uniform | Part::Rgl(_) => 0.0,
            Part::Cosine => cosine_density(wide),
            Part::Guided(proposal) => proposal.density(wide),
            Part::Analytic(proposal) => proposal.density(wide),
            Part::Lafortune(proposal) => proposal.density(wide),
            Part::Tabulated(proposal) => proposal.density(wide),
            Part::Factored(proposal) => proposal.density(wide),
        };
        density as f32
    }
}

/// The largest f32 below 1.
const LARGEST: f32 = 1.0 - 0.5 * f32::EPSILON;
