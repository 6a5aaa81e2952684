//! Lobes that a mixture leaves out are within the bound, and the rest is whole.

use glam::Vec3;
use srbf_core::{Domain, Error, LeaveOut, Lobe, Material, Mixture};
use std::sync::OnceLock;

const GARNET_RED: &[u8] = include_bytes!("../../presets/garnet_red.srbf");

fn garnet_red() -> &'static Material {
    static MATERIAL: OnceLock<Material> = OnceLock::new();
    MATERIAL.get_or_init(|| Material::from_bytes(GARNET_RED).unwrap())
}

fn prepare(theta: f32, leave_out: LeaveOut) -> Mixture<'static, 16> {
    let mut mixture = Mixture::empty();
    let wo = Vec3::new(-theta.sin(), 0.0, theta.cos());
    garnet_red().prepare_with(wo, leave_out.into(), &mut mixture).unwrap();
    mixture
}

#[test]
fn dropped_lobes_take_at_most_their_share_and_the_rest_is_whole() {
    let mut dropped = 0;
    for view in 0..9 {
        let theta = 0.17 * view as f32;
        let whole = prepare(theta, LeaveOut::default());
        for share in [1e-4, 1e-2, 0.1] {
            let left = prepare(theta, LeaveOut::new(share, 1e-7).unwrap());
            dropped += whole.len() - left.len();
            let lost = whole.power() - left.power();
            let most = (whole.len() - left.len()) as f32 * share * whole.power();
            assert!(
                (-1e-6..=most + 1e-6).contains(&lost),
                "view {view}, share {share}: lost {lost}, at most {most}"
            );

            // The lobes that stay are lobes of the whole, in order; squeezed ones still come first.
            let mut all =
                (0..whole.len()).map(|k| (whole.lobe(k), k < whole.squeezed_len(), whole.is_folded(k)));
            for k in 0..left.len() {
                let wanted = (left.lobe(k), k < left.squeezed_len(), left.is_folded(k));
                assert!(all.any(|lobe| lobe == wanted), "view {view}, share {share}: lobe {k}");
            }

            // The missing value is that of the dropped lobes, direction by direction.
            let is_left = |lobe: &Option<Lobe>| (0..left.len()).any(|k| left.lobe(k) == *lobe);
            let missing = |range: core::ops::Range<usize>| -> Vec<Lobe> {
                range.map(|k| whole.lobe(k)).filter(|lobe| !is_left(lobe)).flatten().collect()
            };
            let (squeezed, round) =
                (missing(0..whole.squeezed_len()), missing(whole.squeezed_len()..whole.len()));
            let gone = Mixture::<16>::new(Domain::Hemisphere, whole.squeeze(), &squeezed, &round).unwrap();
            assert_eq!(gone.len(), whole.len() - left.len());
            assert!((lost - gone.power()).abs() <= 1e-5 * whole.power(), "view {view}, share {share}");
            for i in 0..2000 {
                let (z, phi) = ((i as f32 + 0.5) / 2000.0, 2.4 * i as f32);
                let across = (1.0 - z * z).sqrt();
                let d = Vec3::new(across * phi.cos(), across * phi.sin(), z);
                let error = whole.evaluate(d) - left.evaluate(d) - gone.evaluate(d);
                let rounding = 1e-5 * whole.evaluate(d).max_element();
                assert!(error.abs().max_element() <= rounding, "view {view}, share {share}, {d}: {error}");
            }
        }
    }
    assert!(dropped > 20, "{dropped} lobes in all: the bounds do nothing");
}

#[test]
fn folds_that_are_left_out_change_the_value_by_at_most_their_share() {
    let mut skipped = 0;
    for view in 0..9 {
        let theta = 0.17 * view as f32;
        let whole = prepare(theta, LeaveOut::new(0.0, 0.0).unwrap());
        assert!((0..whole.len()).all(|k| whole.is_folded(k)));
        for share in [1e-3, 0.1] {
            let left = prepare(theta, LeaveOut::new(0.0, share).unwrap());
            assert_eq!(left.len(), whole.len());
            skipped += (0..left.len()).filter(|&k| !left.is_folded(k)).count();
            let squeezed = 1.0 / left.squeeze().min(1.0).powi(3);
            let amplitudes: Vec3 =
                (0..left.len()).filter_map(|k| left.lobe(k)).map(|lobe| lobe.amplitude).sum();
            for i in 0..500 {
                let (z, phi) = ((i as f32 + 0.5) / 500.0, 2.4 * i as f32);
                let across = (1.0 - z * z).sqrt();
                let d = Vec3::new(across * phi.cos(), across * phi.sin(), z);
                let difference = whole.evaluate(d) - left.evaluate(d);
                let most = amplitudes * share * squeezed + 1e-5 * whole.evaluate(d);
                assert!(difference.cmple(most).all() && difference.min_element() >= -most.max_element());
            }
        }
    }
    assert!(skipped > 20, "{skipped} folds in all: the bounds do nothing");
}

#[test]
fn shares_out_of_range_are_refused() {
    for share in [-0.1, 1.1, f32::NAN, f32::INFINITY] {
        assert_eq!(LeaveOut::new(share, 0.0), Err(Error::Share));
        assert_eq!(LeaveOut::new(0.0, share), Err(Error::Share));
    }
    assert_eq!(LeaveOut::new(0.0, 1e-7).unwrap(), LeaveOut::default());
}
