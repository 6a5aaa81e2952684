//! One function that uses every part of `core`; a C program with its own `_start` calls it.
#![cfg_attr(not(feature = "std"), no_std)]

use srbf_core::{
    AbelPoisson, Domain, FactorTable, Folded, Gaussian, Kernel, Lobe, Line, Material, Mixture, PlaneLobe, Vec3, View,
    gaussian_coefficients_into, legendre_series,
};

#[cfg(not(feature = "std"))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}

/// 0 if every result is as expected, else the number of the first check that fails.
#[unsafe(no_mangle)]
pub extern "C" fn srbf_freestanding_check() -> i32 {
    #[cfg(feature = "std")]
    std::println!("{:?}", std::time::SystemTime::now());
    check().err().unwrap_or(0)
}

fn near(got: f32, want: f32, number: i32) -> Result<(), i32> {
    let error = got / want - 1.0;
    if (-1e-5..=1e-5).contains(&error) { Ok(()) } else { Err(number) }
}

fn check() -> Result<(), i32> {
    let axis = Vec3::new(0.36, 0.48, 0.8);
    let g = Gaussian::new(axis, 40.0).map_err(|_| 1)?;
    near(g.integral(), 0.157_079_64, 2)?;
    near(g.pdf(g.sample([0.5, 0.25])), 0.5 / 0.157_079_64, 3)?;
    near(g.product(&g).integral(), 0.078_539_82, 4)?;
    near(srbf_core::special::mean_cosine(40.0), 1.0 - 1.0 / 40.0, 5)?;
    let folded = Folded::squeezed(g, 0.5).map_err(|_| 6)?;
    let d = folded.sample([0.3, 0.6]);
    let [u, _] = folded.invert_sample(d, 0.0);
    near(u, 0.3, 7)?;

    let lobe = Lobe::new(axis, 40.0, Vec3::ONE).map_err(|_| 8)?;
    let m = Mixture::<16>::new(Domain::Hemisphere, 0.5, &[lobe], &[lobe]).map_err(|_| 9)?;
    near(m.albedo().x, 2.0 * 0.157_079_64, 10)?;
    let sample = m.sample([0.7, 0.3, 0.6]).ok_or(11)?;
    near(sample.pdf, m.pdf(sample.direction), 12)?;

    let a = AbelPoisson::new(axis, 0.5).map_err(|_| 13)?;
    near(a.value(axis), 6.0, 14)?;
    let mut coefficients = [0.0; 64];
    gaussian_coefficients_into(10.0, &mut coefficients);
    near(legendre_series(&coefficients, 0.0), 1.0, 15)?;

    let lobes = [PlaneLobe {
        angle: 0.0,
        off_plane: 0.0,
        log2_sharpness: 5.0,
        log2_luminance: 0.0,
        color_differences: [0.0; 2],
    }];
    let view = |theta| View {
        theta,
        log2_squeeze: 0.0,
        log2_diffuse: -126.0,
        diffuse_color_differences: [0.0; 2],
        lobes: &lobes,
    };
    let mut bytes = [0; 512];
    // Factors of 1, 2 by 2 of them.
    let factors = FactorTable { half: 2, difference: 2, azimuth: 1, is_signed: false, factors: &[[1.0; 3]; 4], albedo_differences: &[[0.2; 3]; 2] };
    let line = Line { views: &[view(0.0), view(1.0)], squeezed: 0, mirrored: 0, factors: Some(factors) };
    let length = line.encode("", &mut bytes).map_err(|_| 16)?;
    let material = Material::from_bytes(&bytes[..length]).map_err(|_| 17)?;
    let mut m = Mixture::<16>::empty();
    material.prepare(Vec3::new(0.6, 0.0, 0.8), &mut m).map_err(|_| 18)?;
    near(m.evaluate(Vec3::Z).x, 1.0, 19)
}
