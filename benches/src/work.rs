//! Operations by name, each on the same directions: `fixed-work` counts their instructions, `cycles` their time.

use crate::{
    Triples, brushed_material, factored_material, garnet_mixture, garnet_red, general_mixture,
    mixture_at_50_degrees, packed_material,
};
use srbf_core::{
    Draws, Environment, LeaveOut, LightBlock, Material, Mixture, Request, Towards, Vec3, environment_len,
};

/// The work for every direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// Value in RGB, in a batch.
    Evaluate,
    /// Density, in a batch.
    Pdf,
    /// Direction, density and weight, in a batch.
    Sample,
    /// Density, one direction a call.
    OnePdf,
    /// Value and density at a direction whose numbers have just been stored one by one.
    FreshEvaluate,
    /// Direction, one a call.
    OneDraw,
    /// Direction, density and value, one a call.
    OneSample,
    /// The mixture for an outgoing direction, one a call.
    Prepare,
    /// The same for one whose numbers have just been stored one by one.
    FreshPrepare,
    /// The mixture without lobes and folds that hardly matter.
    PrepareDropping,
    /// The same, where none is left out.
    PrepareKeeping,
    /// Direction, density and weight, every pair with a mixture of its own.
    Pairs,
    /// Direction and density, every pair with a mixture of its own.
    SamplePdfPairs,
    /// Value and density, every pair with a mixture of its own.
    EvaluatePairs,
    /// Density, every pair with a mixture of its own.
    PdfPairs,
    /// A draw with density and weight, and value and density towards another direction: a hit, by one call.
    Hit,
    /// The same in a batch.
    Hits,
    /// Even sums of a block of light and 8 directions of the mixture.
    Even,
}

impl Operation {
    /// Every operation with its name.
    pub const ALL: [(&'static str, Self); 18] = [
        ("evaluate", Self::Evaluate),
        ("pdf", Self::Pdf),
        ("sample", Self::Sample),
        ("one-pdf", Self::OnePdf),
        ("fresh-evaluate", Self::FreshEvaluate),
        ("one-draw", Self::OneDraw),
        ("one-sample", Self::OneSample),
        ("prepare", Self::Prepare),
        ("fresh-prepare", Self::FreshPrepare),
        ("prepare-dropping", Self::PrepareDropping),
        ("prepare-keeping", Self::PrepareKeeping),
        ("pairs", Self::Pairs),
        ("sample-pdf-pairs", Self::SamplePdfPairs),
        ("evaluate-pairs", Self::EvaluatePairs),
        ("pdf-pairs", Self::PdfPairs),
        ("hit", Self::Hit),
        ("hits", Self::Hits),
        ("even", Self::Even),
    ];

    /// Whether it is of a mixture that is there already.
    pub fn has_mixture(self) -> bool {
        use Operation::*;
        matches!(self, Evaluate | Pdf | Sample | OnePdf | FreshEvaluate | OneDraw | OneSample | Even)
    }
}

/// What an operation is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// The garnet red preset.
    Preset,
    /// 12 general round lobes, where the operation is of a mixture that is there already; else the preset.
    Round,
    /// The preset with a table of factors.
    Factored,
    /// The preset in codes of 8 bits, where the operation is of a material; else the preset.
    Packed,
    /// The preset as a brushed surface, where the operation is of a material; else the preset.
    Brushed,
}

impl Subject {
    /// Each with what stands before and behind the name of an operation of it.
    pub const ALL: [(Self, &'static str, &'static str); 5] = [
        (Self::Preset, "", ""),
        (Self::Round, "", "-round"),
        (Self::Factored, "factored-", ""),
        (Self::Packed, "packed-", ""),
        (Self::Brushed, "brushed-", ""),
    ];
}

/// Operations, at one level, on a number of directions.
#[derive(Debug)]
pub struct Work {
    directions: Triples,
    uniforms: Triples,
    incident: Triples,
    out: [Vec<f32>; 11],
    material: &'static Material,
    round: Mixture<'static, 64>,
    garnet: Mixture<'static, 64>,
    prepared: Mixture<'static, 16>,
    factored_material: &'static Material,
    packed_material: &'static Material,
    brushed_material: &'static Material,
    factored: Mixture<'static, 64>,
    light: Environment<Vec<u32>>,
}

impl Work {
    /// For `n` directions, at the current level.
    pub fn new(n: usize) -> Self {
        Self {
            directions: Triples::directions(n, 1),
            uniforms: Triples::uniforms(n, 2),
            incident: Triples::directions(n, 3),
            out: [(); 11].map(|()| vec![0.0; n]),
            material: garnet_red(),
            round: general_mixture(12),
            garnet: garnet_mixture(),
            prepared: Mixture::empty(),
            factored_material: factored_material(),
            packed_material: packed_material(),
            brushed_material: brushed_material(),
            factored: mixture_at_50_degrees(factored_material()),
            light: light(),
        }
    }

    /// Does an operation for every direction.
    pub fn run(&mut self, operation: Operation, subject: Subject) {
        let Self { directions, uniforms, incident, out, .. } = self;
        let (mixture, material) = match subject {
            Subject::Preset => (&self.garnet, self.material),
            Subject::Round => (&self.round, self.material),
            Subject::Factored => (&self.factored, self.factored_material),
            Subject::Packed => (&self.garnet, self.packed_material),
            Subject::Brushed => (&self.garnet, self.brushed_material),
        };
        let prepared = &mut self.prepared;
        let n = out[0].len();
        let [x, y, z, pdf, red, green, blue, r, g, b, density] = out;
        match operation {
            Operation::Evaluate => {
                mixture
                    .ask(
                        Towards { wi: directions.slices(), value: Some([red, green, blue]), pdf: None }
                            .into(),
                    )
                    .expect("equal lengths");
            }
            Operation::Pdf => mixture
                .ask(Towards { wi: directions.slices(), value: None, pdf: Some(pdf) }.into())
                .expect("equal lengths"),
            Operation::Sample => {
                let samples = Draws {
                    u: uniforms.slices(),
                    direction: [x, y, z],
                    pdf: Some(pdf),
                    weight: Some([red, green, blue]),
                };
                mixture.ask(samples.into()).expect("equal lengths");
            }
            Operation::OnePdf => (0..n).for_each(|i| pdf[i] = mixture.pdf(directions.at(i))),
            Operation::FreshEvaluate => {
                let mut fresh = Vec3::ZERO;
                (0..n).for_each(|i| {
                    let Vec3 { x, y, z } = directions.at(i);
                    store(&mut fresh, x, y, z);
                    pdf[i] = mixture.evaluate_and_pdf(fresh).1;
                });
            }
            Operation::OneDraw => (0..n).for_each(|i| {
                pdf[i] =
                    mixture.sample_direction(uniforms.at(i).to_array()).map_or(0.0, |direction| direction.z);
            }),
            Operation::OneSample => (0..n).for_each(|i| {
                pdf[i] = mixture.sample(uniforms.at(i).to_array()).map_or(0.0, |sample| sample.pdf);
            }),
            Operation::Prepare => prepare(material, directions, 0.0, prepared, pdf),
            Operation::FreshPrepare => {
                let mut fresh = Vec3::ZERO;
                for (i, power) in pdf.iter_mut().enumerate() {
                    let Vec3 { x, y, z } = directions.at(i);
                    store(&mut fresh, x, y, z);
                    material.prepare(fresh, prepared).expect("a valid direction");
                    *power = prepared.power();
                }
            }
            Operation::PrepareDropping => prepare(material, directions, 0.01, prepared, pdf),
            Operation::PrepareKeeping => prepare(material, directions, 1e-12, prepared, pdf),
            Operation::Pairs => {
                let samples = Draws {
                    u: uniforms.slices(),
                    direction: [x, y, z],
                    pdf: Some(pdf),
                    weight: Some([red, green, blue]),
                };
                material.ask(directions.slices(), samples.into()).expect("equal lengths");
            }
            Operation::SamplePdfPairs => material
                .ask(
                    directions.slices(),
                    Draws { u: uniforms.slices(), direction: [x, y, z], pdf: Some(pdf), weight: None }.into(),
                )
                .expect("equal lengths"),
            Operation::EvaluatePairs => material
                .ask(
                    directions.slices(),
                    Towards { wi: incident.slices(), value: Some([red, green, blue]), pdf: Some(pdf) }.into(),
                )
                .expect("equal lengths"),
            Operation::PdfPairs => {
                material
                    .ask(
                        directions.slices(),
                        Towards { wi: incident.slices(), value: None, pdf: Some(pdf) }.into(),
                    )
                    .expect("equal lengths");
            }
            Operation::Hit => (0..n).for_each(|i| {
                let u = uniforms.at(i).to_array();
                let (sample, (_, towards)) =
                    material.sample_and_evaluate(directions.at(i), u, incident.at(i));
                pdf[i] = sample.map_or(0.0, |sample| sample.pdf) + towards;
            }),
            Operation::Hits => {
                let draw = Draws {
                    u: uniforms.slices(),
                    direction: [x, y, z],
                    pdf: Some(pdf),
                    weight: Some([red, green, blue]),
                };
                let towards = Towards { wi: incident.slices(), value: Some([r, g, b]), pdf: Some(density) };
                let request = Request { draw: Some(draw), evaluate: Some(towards) };
                material.ask(directions.slices(), request).expect("equal lengths");
            }
            Operation::Even => {
                let block = LightBlock::of(|i| self.light.sample(uniforms.at(i % n).to_array()));
                let [u, v, w] = uniforms.slices();
                for (i, pdf) in pdf.iter_mut().enumerate() {
                    let normal = directions.at(i);
                    let tangent = normal.any_orthonormal_vector();
                    let frame = [tangent, normal.cross(tangent), normal];
                    let from = i % (n - 8);
                    let u = [u, v, w].map(|u| &u[from..from + 8]);
                    let drawn = mixture.reflect(&self.light, &block, &frame, normal, u, w[i]);
                    *pdf = drawn.expect("equal lengths").light(true, true).x;
                }
            }
        }
    }

    /// The sum of the last results, so that no work is optimised away.
    pub fn sum(&self) -> f32 {
        self.out.iter().flatten().sum()
    }
}

/// A map of 64 x 32 pixels, brighter above, with a lamp.
fn light() -> Environment<Vec<u32>> {
    let mut map: Vec<[f32; 3]> = (0..64 * 32).map(|i| [1.5 - i as f32 / 2048.0; 3]).collect();
    map[64 * 8 + 20..64 * 8 + 24].fill([40.0; 3]);
    let memory = vec![0; environment_len(64, 32).expect("a size of a map")];
    Environment::new(64, &map, memory).expect("a map with light")
}

/// Stores a direction number by number, as a renderer's own vectors do: where it is then read by larger parts, the read
/// waits until it has gone through the cache.
#[inline(never)]
fn store(to: &mut Vec3, x: f32, y: f32, z: f32) {
    (to.x, to.y, to.z) = (x, y, z);
}

/// Prepares a mixture for each direction, without lobes of less than a share of the albedo; writes its power.
fn prepare(
    material: &'static Material,
    directions: &Triples,
    share: f32,
    mixture: &mut Mixture<'static, 16>,
    power: &mut [f32],
) {
    let leave_out = LeaveOut::new(share, 1e-7).expect("shares");
    for (i, power) in power.iter_mut().enumerate() {
        let wo: Vec3 = directions.at(i);
        material.prepare_with(wo, leave_out.into(), mixture).expect("a valid direction");
        *power = mixture.power();
    }
}
