//! Draws by an environment have the bits that they always had, at each level: other kinds of light change nothing of them.

use glam::Vec3;
use srbf_core::{Domain, LightBlock, Lobe, Mixture, ProductSampling};
use srbf_tests::inputs::{Random, levels};
use srbf_tests::maps::{Map, frame};

/// FNV-1a of words.
struct Hash(u64);

impl Hash {
    fn add(&mut self, numbers: impl IntoIterator<Item = f32>) {
        for number in numbers {
            self.0 = (self.0 ^ u64::from(number.to_bits())).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

/// By the name of a level, on x86-64: of `sample_product`, and of `reflect`.
const KNOWN: [(&str, [u64; 2]); 3] = [
    ("scalar", [0x6afc42f2308917c1, 0x79ef3ca7a0f7acc]),
    ("portable", [0x5d0f48cd646c043e, 0xf17f323ef0771f9f]),
    ("avx2", [0x1338b518952a2b90, 0x635e114a03d46ea0]),
];

// Inputs are sums, products and roots: no library of mathematics, and no level that `SRBF_LEVEL` caps, changes a bit of them.

fn direction(random: &mut Random) -> Vec3 {
    (2.0 * Vec3::from(random.three()) - 1.0 + Vec3::Z * 1e-3).normalize()
}

fn mixture(random: &mut Random, count: usize) -> Mixture<'static, 64> {
    let lobes: Vec<Lobe> = (0..count)
        .map(|i| {
            let sharpness = (1 << (i % 14)) as f32;
            Lobe::new(direction(random), sharpness, Vec3::from(random.three()) * sharpness).unwrap()
        })
        .collect();
    Mixture::new(Domain::Hemisphere, 1.0, &[], &lobes).unwrap()
}

/// Four powers of two of brightness, and one pixel that has a thousand times the light of another.
fn map(random: &mut Random, width: usize, height: usize) -> Map {
    let mut pixels: Vec<[f32; 3]> =
        (0..width * height).map(|_| random.three().map(|c| c * (1 << random.below(5)) as f32)).collect();
    pixels[width * height / 3] = [4000.0; 3];
    Map { name: "powers".into(), width, pixels }
}

#[test]
fn an_environment_draws_the_bits_that_it_always_drew() {
    let mut got = Vec::new();
    for level in levels() {
        let (mut product, mut even) = (Hash(0xcbf2_9ce4_8422_2325), Hash(0xcbf2_9ce4_8422_2325));
        for lobes in [16, 24] {
            let m = mixture(&mut Random(7), lobes).with_level(level).unwrap();
            for (width, height) in [(128, 64), (64, 33)] {
                let environment = map(&mut Random(11), width, height).environment().turned(0.4);
                let mut random = Random(31);
                for round in 0..300 {
                    let mut u = [[0.0; 32]; 3];
                    u.as_flattened_mut().fill_with(|| random.uniform());
                    let axes = frame(direction(&mut random));
                    let (choice, count) = (random.uniform(), [2, 8, 13, 16, 32][round % 5]);
                    let sampling =
                        ProductSampling::new(count, [0.5, 0.0, 1.0][round % 3], f32::INFINITY).unwrap();
                    let drawn = m.sample_product(
                        &environment,
                        &axes,
                        &sampling,
                        u.each_ref().map(|u| &u[..count]),
                        choice,
                    );
                    if let Some(drawn) = drawn.unwrap() {
                        product.add(drawn.direction.to_array().into_iter().chain(drawn.weight.to_array()));
                    }
                    let mut v = [[0.0; 16]; 3];
                    v.as_flattened_mut().fill_with(|| random.uniform());
                    let block = LightBlock::new(&environment, v.each_ref());
                    let rays = [1, 8, 11, 16][round % 4];
                    let u = u.each_ref().map(|u| &u[..rays]);
                    let drawn = m.reflect(&environment, &block, &axes, axes[2], u, choice).unwrap();
                    for seen in [[true, true], [true, false], [false, true]] {
                        even.add(drawn.light(seen[0], seen[1]).to_array());
                    }
                    even.add(drawn.ray_light.to_array().into_iter().chain(drawn.shadow_light.to_array()));
                    even.add(drawn.shadow.unwrap_or(Vec3::ZERO).to_array());
                }
            }
        }
        println!("(\"{}\", [{:#x}, {:#x}]),", level.name(), product.0, even.0);
        got.push((level.name(), [product.0, even.0]));
    }
    if cfg!(target_arch = "x86_64") {
        // Of AVX-512 none is known.
        for (name, bits) in KNOWN {
            if let Some((_, got)) = got.iter().find(|(level, _)| *level == name) {
                assert_eq!(*got, bits, "{name}");
            }
        }
    }
}
