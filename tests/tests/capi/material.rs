//! The material that the C programs work with.

use srbf_core::{PlaneLobe, View, encode, encoded_len};
use std::path::PathBuf;
use std::sync::OnceLock;

/// Views, lobes and squeezed lobes; the C programs know these numbers, and the provenance, "made by tests".
const VIEWS: usize = 8;
const LOBES: usize = 12;
const SQUEEZED: usize = 5;

/// A `.srbf` file of a material with lobes of every width, folds and a squeeze.
pub fn file() -> PathBuf {
    static FILE: OnceLock<PathBuf> = OnceLock::new();
    FILE.get_or_init(|| {
        let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("capi.srbf");
        std::fs::write(&path, bytes()).expect("the target folder can be written");
        path
    })
    .clone()
}

/// Its bytes.
pub fn bytes() -> Vec<u8> {
    let lobes: Vec<Vec<PlaneLobe>> = (0..VIEWS)
        .map(|view| {
            let theta = 0.2 * view as f32;
            (0..LOBES)
                .map(|lobe| PlaneLobe {
                    // Towards the mirror direction and, the wide ones, below the horizon.
                    angle: theta * (1.0 + 0.06 * (lobe as f32 - 6.0)),
                    log2_sharpness: 0.5 + 0.6 * lobe as f32,
                    log2_amplitude: [0.0, 0.2, -0.4].map(|tint| tint - 7.0 + 0.4 * lobe as f32),
                })
                .collect()
        })
        .collect();
    let views: Vec<View<'_>> = lobes
        .iter()
        .enumerate()
        .map(|(view, lobes)| View {
            theta: 0.2 * view as f32,
            log2_squeeze: -0.3 * view as f32,
            log2_diffuse: [-5.0, -4.0, -6.0],
            lobes,
        })
        .collect();
    let provenance = "made by tests";
    let mut bytes = vec![0; encoded_len(VIEWS, LOBES, provenance)];
    let written = encode(&views, SQUEEZED, provenance, &mut bytes).expect("the material is valid");
    bytes.truncate(written);
    bytes
}
