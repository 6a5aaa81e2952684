//! Value and density of a material in f64 by the equations of `oracle`, of the mixtures that `prepare` makes: `truth FILE.srbf < in > out`.
//!
//! In as `reference` of srbf-evaluator reads it; out are its first four rows. A mixture is as the library has interpolated it, in f32.

use glam::{DVec3, Vec3};
use srbf_core::{MAX_LOBES, Material, Mixture};
use srbf_tests::oracle;
use std::error::Error;
use std::io::{Read, Write, stdin, stdout};

/// Value of the lobes and of the diffuse term, and its density.
fn of_mixture(mixture: &Mixture<'_, MAX_LOBES>, wi: DVec3) -> (DVec3, f64) {
    let [cos, sin] = mixture.azimuth_cos_sin().map(f64::from);
    // In the frame of the view, as lobes see it.
    let turn =
        DVec3::new(cos * wi.x + sin * wi.y, cos * wi.y - sin * wi.x, wi.z * cos.hypot(sin)).normalize();
    let [along, across] = [mixture.squeeze_along(), mixture.squeeze()].map(f64::from);
    let seen = DVec3::new(turn.x / along, turn.y / across, turn.z);
    let squeezed = 1.0 / (along * across * seen.length().powi(3));
    let diffuse = mixture.diffuse().as_dvec3();
    let (mut value, mut power) = (diffuse * (turn.z / std::f64::consts::PI), oracle::luminance(diffuse));
    for k in 0..mixture.len() {
        let lobe = mixture.lobe(k).expect("a lobe");
        let (axis, sharpness) = (lobe.gaussian.axis.as_dvec3(), f64::from(lobe.gaussian.sharpness));
        let (d, scale) = if k < mixture.squeezed_len() { (seen, squeezed) } else { (turn, 1.0) };
        let fold = oracle::gaussian(axis, sharpness, oracle::mirrored(d));
        let amplitude = lobe.amplitude.as_dvec3();
        value += amplitude * (scale * (oracle::gaussian(axis, sharpness, d) + fold));
        power += oracle::luminance(amplitude) * oracle::sphere_integral(sharpness);
    }
    (value, oracle::luminance(value) / power)
}

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
        let (mut value, pdf) = of_mixture(&mixture, wi.as_dvec3());
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
