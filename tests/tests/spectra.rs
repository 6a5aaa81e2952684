//! Spectra of colours against sums in f64 by the bytes of the file.

use srbf_core::{LUMINANCE, Material, Primaries, SpectralColumns, SpectralMap};
use srbf_tests::kinds::KINDS;

const NM: [f32; 4] = [420.0, 532.1, 640.0, 905.0];
const COLUMNS: [[f32; 3]; 4] = [[0.1, -0.2, 1.5], [0.2, 0.9, 0.1], [0.9, 0.3, 0.0], [2.0, 1.0, -1.0]];

/// The columns at a wavelength, between those that were given.
fn column(nm: f64, columns: &[[f32; 3]; 4]) -> [f64; 3] {
    let at = NM.map(f64::from);
    let nm = nm.clamp(at[0], at[3]);
    let n = (0..3).rfind(|n| at[*n] <= nm).unwrap();
    let share = (nm - at[n]) / (at[n + 1] - at[n]);
    [0, 1, 2].map(|c| (1.0 - share) * f64::from(columns[n][c]) + share * f64::from(columns[n + 1][c]))
}

#[test]
fn values_at_wavelengths_are_products_with_columns() {
    let grey = [0.3, 0.6, 1.2, 0.9];
    let of_grey = grey.map(|v| LUMINANCE.map(|share| share * v));
    let kinds = [(SpectralColumns::Rgb(&COLUMNS), COLUMNS), (SpectralColumns::Luminance(&grey), of_grey)];
    for (kind, (columns, expected)) in kinds.into_iter().enumerate() {
        let mut map = vec![0; SpectralMap::encoded_len(4, kind == 1)];
        assert_eq!(SpectralMap::encode(&NM, columns, 0.25, &mut map), Ok(map.len()));
        let map = SpectralMap::from_bytes(&map).unwrap();
        assert_eq!((map.len(), map.is_grey(), map.error()), (4, kind == 1, 0.25));
        // A code is off by half a step of the range, which is 2.5.
        let near = |a: f32, b: f64| (f64::from(a) - b).abs() < 4e-5;
        for n in 0..4 {
            let found = map.column(n).unwrap();
            assert!((0..3).all(|c| near(found[c], f64::from(expected[n][c]))), "{found:?}");
            assert!((map.wavelength(n).unwrap() - NM[n]).abs() < 1e-3);
        }
        for made in &KINDS {
            let bytes = made.bytes();
            let plain = Material::from_bytes(&bytes[..]).unwrap();
            let mut with = vec![0; plain.with_spectral_map_len(map)];
            assert_eq!(plain.with_spectral_map(map, &mut with), Ok(with.len()), "{}", made.name);
            let material = Material::from_bytes(&with[..]).unwrap();
            assert!(material.has_spectrum() && !plain.has_spectrum());
            assert_eq!(material.spectral_map().unwrap().bytes(), map.bytes());
            for step in 0..40 {
                let nm = 380.0 + 15.3 * step as f32;
                let rgb = [0.5, 0.1 * step as f32 - 1.0, 0.75];
                let want = column(f64::from(nm), &expected);
                let at = map.column_at(nm);
                assert!((0..3).all(|c| near(at[c], want[c])), "{nm}: {at:?} {want:?}");
                let primaries = material.primaries(&[nm, 905.0]);
                assert_eq!((primaries.columns()[0], Primaries::from_columns([at]).columns()[0]), (at, at));
                let value: f64 = (0..3).map(|c| want[c] * f64::from(rgb[c])).sum();
                let [found, _] = primaries.of(rgb);
                assert!((f64::from(found) - value.max(0.0)).abs() < 4e-4, "{nm}: {found} {value}");
            }
        }
    }
}
