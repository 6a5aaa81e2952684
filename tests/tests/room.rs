//! Mixtures of 1 to 64 lobes: the results do not depend on the free room.

use glam::Vec3;
use srbf_core::{
    AnyMixture, Domain, Draws, Error, Expanded, Groups, Line, Lobe, Material, Mixture, PlaneLobe, Room,
    Towards, View, color_differences,
};
use srbf_tests::inputs::{Random, levels};

/// Directions of a batch: more than the widest vectors take at a time, and no multiple of any.
const BATCH: usize = 77;

/// A material of some lobes, of which some are squeezed and some stand for two.
fn material(random: &mut Random, lobes: usize, squeezed: usize, mirrored: usize) -> Material<Vec<u8>> {
    let stored = lobes - mirrored;
    let mut view = |theta: f32| -> Vec<PlaneLobe> {
        let mut lobe = |k: usize| {
            let (log2_luminance, color_differences) = color_differences([0.0, -1.0, -2.0]);
            PlaneLobe {
                angle: if theta > 0.0 { random.between(-1.5, 1.5) } else { 0.0 },
                off_plane: if theta > 0.0 && k >= stored - mirrored { random.between(0.1, 1.0) } else { 0.0 },
                log2_sharpness: random.between(-1.0, 9.0),
                log2_luminance,
                color_differences,
            }
        };
        (0..stored).map(&mut lobe).collect()
    };
    let (normal, tilted) = (view(0.0), view(1.2));
    let views = [(0.0, 0.0, &normal), (1.2, -1.0, &tilted)].map(|(theta, log2_squeeze, lobes)| View {
        theta,
        log2_squeeze,
        log2_diffuse: -4.0,
        diffuse_color_differences: [0.0; 2],
        lobes,
    });
    let line = Line { views: &views, squeezed, mirrored, factors: None };
    let mut bytes = vec![0; line.encoded_len("room")];
    line.encode("room", &mut bytes).unwrap();
    Material::from_bytes(bytes).unwrap()
}

/// Everything that two mixtures of the same lobes say.
fn same(a: &AnyMixture<'_>, b: &AnyMixture<'_>, random: &mut Random, of: &str) {
    assert_eq!((a.len(), a.power(), a.albedo()), (b.len(), b.power(), b.albedo()), "{of}");
    let numbers = [(); 3].map(|()| (0..BATCH).map(|_| random.uniform()).collect::<Vec<f32>>());
    let mut wi = [(); 3].map(|()| vec![0.0; BATCH]);
    for i in 0..BATCH {
        let d = random.direction();
        (wi[0][i], wi[1][i], wi[2][i]) = (d.x, d.y, d.z);
        let u = [numbers[0][i], numbers[1][i], numbers[2][i]];
        assert_eq!(a.evaluate_and_pdf(d), b.evaluate_and_pdf(d), "{of}, {d}");
        assert_eq!((a.evaluate(d), a.pdf(d)), (b.evaluate(d), b.pdf(d)), "{of}, {d}");
        assert_eq!(a.sample(u), b.sample(u), "{of}, {u:?}");
        assert_eq!(a.sample_direction(u), b.sample_direction(u), "{of}, {u:?}");
    }
    assert_eq!(batches(a, &wi, &numbers), batches(b, &wi, &numbers), "{of}");
}

/// The results of the batches, one after the other.
fn batches(m: &AnyMixture<'_>, wi: &[Vec<f32>; 3], u: &[Vec<f32>; 3]) -> Vec<Vec<f32>> {
    let (wi, u) = (wi.each_ref().map(Vec::as_slice), u.each_ref().map(Vec::as_slice));
    let mut out = vec![vec![0.0; BATCH]; 12];
    let [red, green, blue, pdf, both, x, y, z, density, r, g, b] = out.as_mut_slice() else { unreachable!() };
    m.ask(Towards { wi, value: Some([&mut *red, &mut *green, &mut *blue]), pdf: None }.into()).unwrap();
    m.ask(Towards { wi, value: None, pdf: Some(pdf) }.into()).unwrap();
    m.ask(Towards { wi, value: Some([&mut *red, &mut *green, &mut *blue]), pdf: Some(both) }.into()).unwrap();
    m.ask(Draws { u, direction: [x, y, z], pdf: Some(density), weight: Some([r, g, b]) }.into()).unwrap();
    out
}

fn check<const N: usize>(counts: &[usize])
where
    Room<N>: Groups,
{
    let mut random = Random(N as u64 + 1);
    for &lobes in counts {
        for (squeezed, mirrored) in [(0, 0), (lobes.div_ceil(2), 0), (lobes / 4, lobes / 4)] {
            let made = material(&mut random, lobes, squeezed, mirrored);
            assert_eq!(made.lobe_count(), lobes);
            for wo in [Vec3::Z, Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.48, 0.64, 0.6)] {
                for level in levels() {
                    let of = format!(
                        "room for {N}, {lobes} lobes, {squeezed} squeezed, {mirrored} pairs, {level:?}"
                    );
                    let (mut m, mut whole) = (Mixture::<N>::empty(), Mixture::<64>::empty());
                    made.prepare_with(wo, level.into(), &mut m).unwrap();
                    made.prepare_with(wo, level.into(), &mut whole).unwrap();
                    same(&m, &whole, &mut random, &of);
                }
                let mut memory = vec![0.0; made.expanded_len(64)];
                let expanded = Expanded::new(&made, 64, &mut memory).unwrap();
                let (mut m, mut whole) = (Mixture::<N>::empty(), Mixture::<64>::empty());
                expanded.prepare(wo, &mut m).unwrap();
                expanded.prepare(wo, &mut whole).unwrap();
                same(&m, &whole, &mut random, "expanded");
            }
        }
        let given: Vec<Lobe> = (0..lobes).map(|_| random.lobe(-1.0, 4.0)).collect();
        for domain in [Domain::Sphere, Domain::Hemisphere] {
            let (squeezed, round) = given.split_at(lobes / 2);
            let m = Mixture::<N>::new(domain, 0.5, squeezed, round).unwrap();
            same(&m, &Mixture::<64>::new(domain, 0.5, squeezed, round).unwrap(), &mut random, "given lobes");
        }
    }
    if N < 64 {
        let more = material(&mut random, N + 1, 0, 0);
        let needed = Err(Error::Capacity { needed: N + 1, available: N });
        assert_eq!(more.prepare(Vec3::Z, &mut Mixture::<N>::empty()), needed);
        let [x, y, z] = [&[0.0f32][..], &[0.0], &[1.0]];
        assert_eq!(more.prepare_into([x, y, z], &mut [Mixture::<N>::empty()]), needed);
    }
}

#[test]
fn any_room_gives_the_same() {
    check::<16>(&[1, 2, 4, 5, 8, 11, 12, 15, 16]);
    check::<32>(&[1, 16, 17, 31, 32]);
    check::<48>(&[1, 32, 33, 47, 48]);
    check::<64>(&[1, 32, 63, 64]);
}
