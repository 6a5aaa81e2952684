//! What `srbf-core` says of pairs of directions, for tests of what says the same elsewhere: in Python, in shaders.
//!
//!     reference FILE.srbf [blend] < in > out
//!
//! With `blend` the front of a sheet is asked as a blend of its reflection, tinted (.7, .7, .7), and of its transmission, (.3, .24, .18).
//!
//! Little-endian f32. In: nine rows of n numbers, x y z of `wo`, of `wi`, and three uniform numbers. Out: fourteen rows: value (3) and
//! density (1) at `wi`; direction (3), density (1) and weight (3) of the sample; albedo (3), of a sheet that of the half in which `wi` lies.

use srbf_core::{Blend, BlendPart, Draws, MAX_LOBES, Mixture, Quarter, SheetMixture, Towards};
use srbf_evaluator::Surface;
use std::error::Error;
use std::io::{Read, Write, stdin, stdout};

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("the name of a material is expected")?;
    let surface = Surface::from_bytes(std::fs::read(path)?)?;
    let mut bytes = Vec::new();
    stdin().read_to_end(&mut bytes)?;
    let numbers: Vec<f32> = bytes.as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
    let n = numbers.len() / 9;
    if numbers.len() != 9 * n {
        return Err("nine rows of as many numbers are expected".into());
    }
    let rows = |from: usize| [0, 1, 2].map(|c| &numbers[(from + c) * n..(from + c + 1) * n]);
    let (wo, wi, u) = (rows(0), rows(3), rows(6));
    let mut out = vec![vec![0f32; n]; 14];
    let mut parts = out.iter_mut().map(|row| &mut row[..]);
    let mut next = || parts.next().expect("fourteen rows");
    let (value, pdf) = ([next(), next(), next()], next());
    let samples = Draws {
        u,
        direction: [next(), next(), next()],
        pdf: Some(next()),
        weight: Some([next(), next(), next()]),
    };
    let albedo = [next(), next(), next()];
    let towards = Towards { wi, value: Some(value), pdf: Some(pdf) };
    let at = |i: usize| [wo[0][i], wo[1][i], wo[2][i]];
    let mut put = |i: usize, found: glam::Vec3| (0..3).for_each(|c| albedo[c][i] = found[c]);
    match &surface {
        Surface::Material(material) => {
            material.ask(wo, towards.into())?;
            material.ask(wo, samples.into())?;
            let mut mixture = Mixture::<MAX_LOBES>::empty();
            for i in 0..n {
                material.prepare(at(i), &mut mixture)?;
                put(i, mixture.albedo());
            }
        }
        Surface::Sheet(sheet) if std::env::args().nth(2).is_some_and(|word| word == "blend") => {
            let of = |quarter| sheet.quarter(quarter).ok_or("a blend has two parts");
            let (first, second) = (of(Quarter::FrontReflection)?, of(Quarter::FrontTransmission)?);
            let parts = [
                BlendPart::new(&first, 1.0).tinted([0.7; 3]),
                BlendPart::new(&second, 1.0).tinted([0.3, 0.24, 0.18]),
            ];
            let blend = Blend::new(&parts)?;
            blend.ask(wo, towards.into())?;
            blend.ask(wo, samples.into())?;
            (0..n).for_each(|i| put(i, blend.albedo(at(i))));
        }
        Surface::Sheet(sheet) => {
            sheet.ask(wo, towards.into())?;
            sheet.ask(wo, samples.into())?;
            let mut pair = SheetMixture::<MAX_LOBES>::empty();
            for i in 0..n {
                sheet.prepare(at(i), &mut pair)?;
                let is_transmission = (wo[2][i] < 0.0) != (wi[2][i] < 0.0);
                put(i, pair.albedos()[usize::from(is_transmission)]);
            }
        }
    }
    let bytes: Vec<u8> = out.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    stdout().write_all(&bytes)?;
    Ok(())
}
