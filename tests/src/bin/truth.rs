//! Value and density of a material in f64 by the equations of `oracle`, of the mixtures that `prepare` makes: `truth FILE.srbf < in > out`.
//!
//! In as `reference` of srbf-evaluator reads it; out are its first four rows. A mixture is as the library has interpolated it, in f32.

use glam::Vec3;
use srbf_core::{MAX_LOBES, Material, Mixture};
use srbf_tests::oracle;
use std::error::Error;
use std::io::{Read, Write, stdin, stdout};

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("the name of a material is expected")?;
    let material = Material::from_bytes(std::fs::read(path)?)?;
    let mut bytes = Vec::new();
    stdin().read_to_end(&mut bytes)?;
    let numbers: Vec<f32> = bytes.as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
    let n = numbers.len() / 9;
    let at = |row: usize, i: usize| Vec3::from_array([0, 1, 2].map(|c| numbers[(row + c) * n + i]));
    let node = |i, j, k| Vec3::from_array(material.factor_node(i, j, k).expect("a node")).as_dvec3();
    let mut out = vec![0f32; 4 * n];
    let mut mixture = Mixture::<MAX_LOBES>::empty();
    for i in 0..n {
        let (wo, wi) = (at(0, i), at(3, i));
        material.prepare(wo, &mut mixture)?;
        let (mut value, pdf) = oracle::mixture_and_pdf(&mixture, wi.as_dvec3().normalize());
        if let Some(nodes) = material.factor_nodes() {
            let shape = (nodes, material.has_signed_factors());
            value *= oracle::factor(shape, node, wo.as_dvec3(), wi.as_dvec3());
        }
        (0..3).for_each(|c| out[c * n + i] = value[c] as f32);
        out[3 * n + i] = pdf as f32;
    }
    let bytes: Vec<u8> = out.iter().flat_map(|v| v.to_le_bytes()).collect();
    stdout().write_all(&bytes)?;
    Ok(())
}
