//! The run-time road over many directions, and checksums of all numbers that come out of it.

use crate::print::{hexadecimal, line, text};
use srbf_core::{Material, Mixture, Sample};

/// Numbers that look random, the same on every machine.
pub struct Numbers(pub u32);

impl Numbers {
    /// In [0, 1).
    pub fn uniform(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) as f32 * (1.0 / 16_777_216.0)
    }

    /// Three of them.
    pub fn three(&mut self) -> [f32; 3] {
        [self.uniform(), self.uniform(), self.uniform()]
    }

    /// A unit vector above the horizon, by the stereographic projection of a point of the unit disc.
    pub fn direction(&mut self) -> [f32; 3] {
        loop {
            let [x, y] = [2.0 * self.uniform() - 1.0, 2.0 * self.uniform() - 1.0];
            let squared = x * x + y * y;
            if squared < 1.0 {
                let scale = 1.0 / (1.0 + squared);
                return [2.0 * x * scale, 2.0 * y * scale, (1.0 - squared) * scale];
            }
        }
    }
}

/// FNV-1a over the bits of numbers.
struct Checksum(u32);

impl Checksum {
    fn new() -> Self {
        Self(0x811c_9dc5)
    }

    fn add(&mut self, numbers: &[f32]) {
        for byte in numbers.iter().flat_map(|number| number.to_bits().to_le_bytes()) {
            self.0 = (self.0 ^ u32::from(byte)).wrapping_mul(0x0100_0193);
        }
    }

    fn add_sample(&mut self, sample: Option<Sample>) {
        if let Some(sample) = sample {
            self.add(&sample.direction.to_array());
            self.add(&[sample.pdf]);
            self.add(&sample.weight.to_array());
        }
    }
}

/// Outgoing directions, and incident ones and draws for each.
const OUTGOING: usize = 24;
const INCIDENT: usize = 12;

/// Prints a checksum of each of the verbs of a mixture, and of a hit without one, each line beginning with a word.
pub fn print_checksums(word: &str, material: &Material<&'static [u8]>) -> Result<(), &'static str> {
    let (mut numbers, mut mixture) = (Numbers(1), Mixture::<16>::empty());
    let mut sums = [const { Checksum(0) }; 4].map(|_| Checksum::new());
    let [values, densities, draws, hits] = &mut sums;
    for _ in 0..OUTGOING {
        let wo = numbers.direction();
        material.prepare(wo, &mut mixture).map_err(|_| "no mixture")?;
        for _ in 0..INCIDENT {
            let (wi, u) = (numbers.direction(), numbers.three());
            values.add(&mixture.evaluate(wi).to_array());
            densities.add(&[mixture.pdf(wi)]);
            draws.add_sample(mixture.sample(u));
            let (sample, (value, pdf)) = material.sample_and_evaluate(wo, u, wi);
            hits.add_sample(sample);
            hits.add(&value.to_array());
            hits.add(&[pdf]);
        }
    }
    for (name, sum) in ["values", "densities", "draws", "hits"].into_iter().zip(sums) {
        text(word);
        text(" of ");
        text(name);
        text(" ");
        hexadecimal(sum.0);
        line();
    }
    Ok(())
}
