#![allow(missing_docs)]
use srbf_benches::*;
use srbf_core::*;
fn main() {
    let verb = std::env::args().nth(1).unwrap();
    if let Some(l) = std::env::args().nth(2) {
        Level::from_name(&l).unwrap().set().unwrap();
    }
    let m = Material::from_bytes(GARNET_RED).unwrap();
    let mut memory = vec![0.0; m.expanded_len(256)];
    let e = Expanded::new(&m, 256, &mut memory).unwrap();
    let n = 4096;
    let (wo, wi, u) = (Triples::directions(n, 1), Triples::directions(n, 3), Triples::uniforms(n, 2));
    let mut out: [Vec<f32>; 7] = [(); 7].map(|()| vec![0.0; n]);
    let mut best = f64::INFINITY;
    let mut mix = Mixture::<16>::empty();
    for _ in 0..3000 {
        let t = std::time::Instant::now();
        let [x, y, z, pdf, red, green, blue] = &mut out;
        match &verb[..] {
            "e" => e.evaluate_and_pdf_pairs_into(wo.slices(), wi.slices(), [red, green, blue], pdf).unwrap(),
            "v" => e.evaluate_pairs_into(wo.slices(), wi.slices(), [red, green, blue]).unwrap(),
            "p" => e.pdf_pairs_into(wo.slices(), wi.slices(), pdf).unwrap(),
            "o" => {
                for i in 0..n {
                    e.prepare(wo.at(i), &mut mix).unwrap();
                }
            }
            "x" => {
                for i in 0..n {
                    m.prepare(wo.at(i), &mut mix).unwrap();
                }
            }
            _ => e
                .sample_pairs_into(
                    wo.slices(),
                    u.slices(),
                    SamplesMut { direction: [x, y, z], pdf, weight: [red, green, blue] },
                )
                .unwrap(),
        }
        best = best.min(t.elapsed().as_secs_f64() * 1e9 / n as f64);
    }
    println!("{verb} {best:.1} {}", out[3][7]);
}
