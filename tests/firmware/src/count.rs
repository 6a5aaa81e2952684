//! Instructions of each verb: the emulator's clock goes on by one nanosecond an instruction, so that counts repeat exactly.

use crate::machine::now;
use crate::print::{decimal, line, text};
use crate::reference;
use crate::road::Numbers;
use core::hint::black_box;
use srbf_core::{Domain, Material, Mixture};

/// Calls that are counted together, as the clock is coarse.
const CALLS: usize = 64;

/// The outgoing direction of values and draws: turned, and squeezed by the preset.
const OUTGOING: [f32; 3] = [-0.48, -0.36, 0.8];

/// Directions of all calls.
type Inputs = [[f32; 3]; CALLS];

/// Instructions a call of a verb, less those of the loop.
fn count(inputs: &Inputs, mut verb: impl FnMut([f32; 3]) -> f32) -> u32 {
    let empty = many(inputs, &mut |input| input[0]);
    (many(inputs, &mut verb) - empty) / CALLS as u32
}

/// Instructions of all calls.
#[inline(never)]
fn many(inputs: &Inputs, verb: &mut impl FnMut([f32; 3]) -> f32) -> u32 {
    let start = now();
    for input in inputs {
        black_box(verb(*input));
    }
    now() - start
}

fn show(name: &str, count: u32) {
    text("instructions of ");
    text(name);
    text(" ");
    decimal(count);
    line();
}

/// Prints instructions of preparing a material.
pub fn print_prepare(name: &str, material: &Material<&'static [u8]>) {
    let (mut numbers, mut directions) = (Numbers(2), [[0.0; 3]; CALLS]);
    directions.iter_mut().for_each(|direction| *direction = numbers.direction());
    let mut mixture = Mixture::<16>::empty();
    show(name, count(&directions, |wo| material.prepare(wo, &mut mixture).map_or(0.0, |()| 1.0)));
}

/// Prints instructions a call of each verb, and of the same with libm's functions.
pub fn print(material: &Material<&'static [u8]>) -> Result<(), &'static str> {
    let mut numbers = Numbers(2);
    let (mut directions, mut uniform) = ([[0.0; 3]; CALLS], [[0.0; 3]; CALLS]);
    directions.iter_mut().for_each(|direction| *direction = numbers.direction());
    uniform.iter_mut().for_each(|u| *u = numbers.three());
    let mut mixture = Mixture::<16>::empty();
    let mut prepared = |wo| material.prepare(wo, &mut mixture).map_or(0.0, |()| 1.0);
    show("prepare", count(&directions, &mut prepared));
    material.prepare(OUTGOING, &mut mixture).map_err(|_| "no mixture")?;
    let m = &mixture;
    let value = count(&directions, |wi| m.evaluate(wi).x);
    show("value", value);
    show("value, over the lobes", value / m.len() as u32);
    show("value, a further lobe", further_lobe(&directions, m)?);
    show("density", count(&directions, |wi| m.pdf(wi)));
    show("draw with density", count(&uniform, |u| m.sample(u).map_or(0.0, |sample| sample.pdf)));
    show("hit", count(&uniform, |u| material.sample_and_evaluate(OUTGOING, u, [0.0, 0.6, 0.8]).1.1));
    let mut lobes = reference::Lobes::default();
    show("prepare, by libm", count(&directions, |wo| lobes.prepare(material, wo)));
    lobes.prepare(material, OUTGOING);
    let value = count(&directions, |wi| lobes.value(wi)[0]);
    show("value, by libm", value);
    show("value, over the lobes, by libm", value / m.len() as u32);
    show("draw with density, by libm", count(&uniform, |u| lobes.draw(u).1));
    Ok(())
}

/// Instructions that a value takes more for a lobe more: all lobes of a mixture beside every second one.
fn further_lobe(directions: &Inputs, m: &Mixture<'_, 16>) -> Result<u32, &'static str> {
    let first = m.lobe(0).ok_or("no lobes")?;
    let lobes: [_; 12] = core::array::from_fn(|k| m.lobe(k).unwrap_or(first));
    let half: [_; 6] = core::array::from_fn(|k| lobes[2 * k]);
    let squeezed = m.squeezed_len().min(lobes.len());
    let of = |(squeezed, round): (&[_], &[_])| {
        Mixture::<16>::new(Domain::Hemisphere, m.squeeze(), squeezed, round)
    };
    let all = of(lobes.split_at(squeezed)).map_err(|_| "no mixture")?;
    let all = count(directions, |wi| all.evaluate(wi).x);
    let some = of(half.split_at(squeezed.div_ceil(2))).map_err(|_| "no mixture")?;
    let some = count(directions, |wi| some.evaluate(wi).x);
    Ok((all - some) / (lobes.len() - half.len()) as u32)
}
