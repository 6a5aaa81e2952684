//! Attacks with a seeded generator: damaged bytes give an error or something sound, never a panic, a hang or a NaN.
//!
//! Every target of `tests/src/attack.rs` gets its kept inputs as they are, at every SIMD level, and then damaged ones.
//! `SRBF_FUZZ=N` runs N executions of each target in place of the few of every test run. `fuzz/run` does the same with inputs that
//! follow the coverage; its findings are kept in `fuzz/found/`.

use srbf_core::Level;
use srbf_tests::attack::{self, TARGETS};
use srbf_tests::inputs::Random;
use srbf_tests::seeds;

/// Executions of a target in an ordinary run: about a second each.
const EXECUTIONS: u64 = 20_000;

fn executions() -> u64 {
    match std::env::var("SRBF_FUZZ") {
        Ok(text) => text.parse().expect("SRBF_FUZZ is a number of executions"),
        Err(_) => EXECUTIONS,
    }
}

/// Damages a seed in one to eight places.
fn mutate(random: &mut Random, seed: &[u8]) -> Vec<u8> {
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

/// Every kept input, whole, at every level of this processor.
#[test]
fn kept_inputs() {
    for target in TARGETS {
        let kept = attack::kept(target.name);
        let mut accepted = 0;
        for (path, bytes) in &kept {
            println!("{}", path.display());
            for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
                level.set().expect("an available level");
                accepted += usize::from((target.run)(bytes));
            }
        }
        assert!(accepted > 0, "no input of {} is sound: its objects are never reached", target.name);
    }
}

/// Damaged inputs of every target; some are still sound.
#[test]
fn damaged_inputs() {
    for target in TARGETS {
        let kept = attack::kept(target.name);
        let mut random = Random(1);
        let share = if target.name == "merl" { 1000 } else { 8 };
        let executions = executions() / share;
        let mut accepted = 0;
        for execution in 0..executions {
            let (path, seed) = &kept[random.below(kept.len())];
            let bytes = mutate(&mut random, seed);
            let place = format!("{}, execution {execution}, from {}", target.name, path.display());
            let run = std::panic::catch_unwind(|| (target.run)(&bytes));
            accepted += u64::from(run.unwrap_or_else(|_| panic!("{place}: {bytes:02x?}")));
        }
        println!("{}: {executions} executions, {accepted} accepted", target.name);
        assert!(accepted > 0 || share > 8, "no damaged input of {} is sound", target.name);
    }
}

/// Every number at an end of its range in the format, in both kinds of material.
#[test]
fn materials_of_extremes() {
    let mut random = Random(3);
    for execution in 0..executions() / 4 {
        let bytes = seeds::extreme(&mut random);
        let run = std::panic::catch_unwind(|| attack::run("material", &bytes));
        assert!(run.expect("sound, whatever its numbers"), "execution {execution}: {bytes:02x?}");
    }
}
