//! Inputs of the attacks: bytes put right, numbers and directions that follow from them.

use crate::inputs::Random;
use glam::Vec3;

/// Writes the length and the checksum that the bytes should have, so that the fields behind them are reached. The checksum is
/// CRC-32 (IEEE 802.3).
pub fn put_right(bytes: &mut [u8]) {
    if bytes.len() < 48 {
        return;
    }
    let length = bytes.len() as u32;
    bytes[16..20].copy_from_slice(&length.to_le_bytes());
    let end = bytes.len() - 4;
    let crc = crc32fast::hash(&bytes[..end]);
    bytes[end..].copy_from_slice(&crc.to_le_bytes());
}

/// Damages a seed in one to eight places.
pub fn mutate(random: &mut Random, seed: &[u8]) -> Vec<u8> {
    /// What numbers and lengths are replaced with.
    const WORDS: [&[u8]; 12] = [
        &[0xff; 4],
        &[0; 8],
        &[0x7f, 0xff, 0xff, 0xff],
        &[0, 0, 0xc0, 0x7f],
        &[0, 0, 0x80, 0x7f],
        &[0, 0, 0, 0x80],
        b" NaN ",
        b" 1e400 ",
        b"-1",
        b" 99999999999999999999 ",
        b"\n",
        b",",
    ];
    let mut bytes = seed.to_vec();
    for _ in 0..=random.below(8) {
        let at = random.below(bytes.len().max(1));
        match random.below(7) {
            0 => bytes.truncate(at),
            1 if at < bytes.len() => bytes[at] ^= 1 << random.below(8),
            2 if at < bytes.len() => bytes[at] = random.below(256) as u8,
            3 => {
                let word = WORDS[random.below(WORDS.len())];
                let end = (at + word.len()).min(bytes.len());
                bytes[at.min(end)..end].copy_from_slice(&word[..end - at.min(end)]);
            }
            4 => {
                let word = WORDS[random.below(WORDS.len())];
                bytes.splice(at..at, word.iter().copied());
            }
            5 => {
                let end = (at + random.below(64)).min(bytes.len());
                let part = bytes[at.min(end)..end].to_vec();
                bytes.splice(at..at, part);
            }
            _ => {
                let end = (at + random.below(64)).min(bytes.len());
                bytes.drain(at.min(end)..end);
            }
        }
    }
    bytes
}

/// Random numbers that follow from the bytes, so that an input always does the same.
pub fn random(bytes: &[u8]) -> Random {
    Random(u64::from(crc32fast::hash(bytes)))
}

/// A direction: any, or one of those where formulas change.
pub fn any_direction(random: &mut Random) -> Vec3 {
    match random.below(8) {
        0 => Vec3::Z,
        1 => Vec3::X,
        2 => Vec3::new(0.0, -1.0, 1e-20),
        3 => {
            let phi = random.between(0.0, core::f32::consts::TAU);
            let z = 10f32.powf(random.between(-9.0, 0.0));
            let across = (1.0 - z * z).max(0.0).sqrt();
            Vec3::new(across * phi.cos(), across * phi.sin(), z).normalize()
        }
        _ => random.direction(),
    }
}

/// A direction above the horizon or on it.
pub fn above(random: &mut Random) -> Vec3 {
    let d = any_direction(random);
    Vec3::new(d.x, d.y, d.z.abs())
}

/// A uniform number: any, or an end.
pub fn uniform(random: &mut Random) -> f32 {
    match random.below(6) {
        0 => 0.0,
        1 => 1.0 - f32::EPSILON / 2.0,
        2 => random.uniform() * 1e-7,
        _ => random.uniform(),
    }
}
