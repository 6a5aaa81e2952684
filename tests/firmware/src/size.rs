//! The whole run-time road, and by features of this package what else `core` can do: the bytes that are linked are counted. It is
//! not run.
#![no_std]
#![no_main]

use srbf_core::{Material, Mixture};

/// Loads, prepares, evaluates, asks for the density and draws; three directions in, ten numbers out.
#[inline(never)]
pub extern "C" fn road(
    bytes: &&'static [u8],
    #[cfg(feature = "environment")] table: &&[u32],
    numbers: &[[f32; 3]; 3],
    out: &mut [f32; 11],
) -> bool {
    let Ok(material) = Material::from_bytes(*bytes) else { return false };
    let mut mixture = Mixture::<16>::empty();
    let [wo, wi, u] = *numbers;
    if material.prepare(wo, &mut mixture).is_err() {
        return false;
    }
    let Some(sample) = mixture.sample(u) else { return false };
    let [value, direction, weight] =
        [mixture.evaluate(wi), sample.direction, sample.weight].map(|vector| vector.to_array());
    let pdf = [mixture.pdf(wi), sample.pdf];
    let all = value.into_iter().chain(direction).chain(weight).chain(pdf);
    out.iter_mut().zip(all).for_each(|(to, number)| *to = number);
    #[cfg(feature = "hit")]
    {
        let (sample, (value, pdf)) = material.sample_and_evaluate(wo, u, wi);
        out[0] = value.x + pdf + sample.map_or(0.0, |sample| sample.pdf);
    }
    #[cfg(feature = "environment")]
    {
        let Ok(light) = srbf_core::Environment::from_table(*table) else { return false };
        out[1] = light.sample(u).pdf + light.pdf(wi.into());
    }
    #[cfg(feature = "zonal")]
    {
        use srbf_core::Kernel;
        let Ok(kernel) = srbf_core::AbelPoisson::new(wo, u[0]) else { return false };
        out[2] = kernel.value(wi.into());
    }
    true
}

/// Where the linker begins.
#[unsafe(no_mangle)]
pub extern "C" fn reset() -> bool {
    let (nothing, numbers): (&[u8], _) = (&[], [[0.0; 3]; 3]);
    #[cfg(feature = "environment")]
    let table: &[u32] = core::hint::black_box(&[]);
    road(
        core::hint::black_box(&nothing),
        #[cfg(feature = "environment")]
        &table,
        core::hint::black_box(&numbers),
        &mut [0.0; 11],
    )
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}
