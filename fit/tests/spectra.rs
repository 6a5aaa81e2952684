//! What fits keep of the wavelengths of their samples.

use srbf_core::{Material, Mixture};
use srbf_fit::judge::reciprocity::reciprocity;
use srbf_fit::judge::report::Input;
use srbf_fit::judge::verdict::Verdict;
use srbf_fit::pack::{PackedForm, Subject};
use srbf_fit::read::{ChosenWavelengths, Conventions, Source, read_from};
use srbf_fit::{FactorNodes, Fit, Settings, fit_content, fit_source};
use std::fmt::Write;

fn settings() -> Settings {
    Settings {
        lobes: 2,
        starts: 1,
        steps: 4,
        exchanges: 0,
        views: Some(3),
        factors: FactorNodes::None,
        ..Settings::default()
    }
}

/// A table of text: a diffuse body and a highlight, each with a spectrum of its own, and what more `odd` adds.
fn table(nm: &[f64], odd: impl Fn(f64, f64) -> f64) -> String {
    let names: Vec<String> = nm.iter().map(|w| format!("{w}nm")).collect();
    let mut text = format!("theta_i,phi_i,theta_o,phi_o,{}\n", names.join(","));
    for theta_o in [5.0f64, 25.0, 45.0, 65.0] {
        for theta_i in [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0] {
            for phi in [0.0f64, 60.0, 120.0, 180.0] {
                let away = (theta_i - theta_o).powi(2) + (phi - 180.0).powi(2) * 0.2;
                let gloss = (-away / 300.0).exp();
                let _ = write!(text, "{theta_i},0,{theta_o},{phi}");
                for w in nm {
                    let body = 0.05 + 0.2 * (w - 400.0) / 600.0;
                    let _ = write!(text, ",{}", body + gloss * (0.4 + odd(*w, theta_i)));
                }
                text.push('\n');
            }
        }
    }
    text
}

fn read(text: &str, wavelengths: Option<&str>) -> Source {
    let wavelengths = wavelengths.map(|text| ChosenWavelengths::parse(text).unwrap());
    read_from("a.csv", text.as_bytes(), &Conventions { wavelengths, ..Conventions::default() }).unwrap()
}

fn fit(source: &Source) -> (Fit, Material<Vec<u8>>, Verdict) {
    let fit = fit_source(source, &settings(), |_| {}).unwrap();
    let material = Material::from_bytes(fit.bytes.clone()).unwrap();
    let verdict = Verdict::of_material(&fit.report, &reciprocity(&material).unwrap());
    (fit, material, verdict)
}

fn wavelengths() -> Vec<f64> {
    (0..31).map(|n| 400.0 + 10.0 * f64::from(n)).chain([905.0]).collect()
}

#[test]
fn a_fit_keeps_the_spectra_of_its_samples() {
    let source = read(&table(&wavelengths(), |_, _| 0.0), None);
    let (fit, material, verdict) = fit(&source);
    let report = fit.report.spectra.as_ref().unwrap();
    // The bytes are those of the colours, the block and no more.
    let plain = fit_content(&source.content, &settings(), |_| {}).unwrap().bytes;
    let map = material.spectral_map().unwrap();
    assert_eq!(fit.bytes.len(), plain.len() + (8 + map.bytes().len()).next_multiple_of(4));
    assert_eq!(fit.bytes[20..plain.len() - 4], plain[20..plain.len() - 4]);
    assert!(map.bytes().len() < 300 && map.len() == 32 && !map.is_grey());
    // Two spectra are said by three numbers.
    assert!(report.of_map.error < 1e-3 && report.bands.len() == 4, "{report:?}");
    let [[exact, _], [lamp, _], [tube, _]] = report.of_map.colour.unwrap();
    assert!(exact < 1e-6 && lamp < 0.1 && tube < 0.1);
    assert!(report.of_fit.error < 0.5 && report.of_fit.error > report.of_map.error);
    assert!(
        verdict.good.iter().any(|line| line.contains("32 wavelengths from 400 to 905 nm")),
        "{verdict:?}"
    );
    let json = fit.report.to_json(&material, &Input::default(), &settings()).unwrap();
    assert!(json.contains("delta_e_2000") && json.contains("\"worst_nm\""));

    // The value at a wavelength is as far from the samples as the colour is.
    let mut mixture = Mixture::<64>::empty();
    let sample = source.intake.as_ref().unwrap().spectra.as_ref().unwrap().samples[40].clone();
    material.prepare(sample.wo.map(|v| v as f32), &mut mixture).unwrap();
    let value = mixture.evaluate(sample.wi.map(|v| v as f32)) / sample.wi[2] as f32;
    let [red, lidar] = material.primaries(&[600.0, 905.0]).of(value);
    assert!((f64::from(red) / sample.values[20] - 1.0).abs() < 0.5, "{red} {}", sample.values[20]);
    assert!((f64::from(lidar) / sample.values[31] - 1.0).abs() < 0.5, "{lidar} {}", sample.values[31]);

    // Packed, cut and fitted again.
    let subject = Subject::new(&source.content, &fit.bytes).unwrap();
    for lobes in [2, 1] {
        let form = PackedForm { lobes, ..PackedForm::of(&material, Default::default()) };
        let packed = subject.pack(&form, &settings(), true, |_| {}).unwrap();
        let packed = Material::from_bytes(packed.bytes).unwrap();
        assert_eq!(packed.spectral_map().unwrap().bytes(), map.bytes());
    }
}

#[test]
fn single_wavelengths_and_chosen_ones_are_named() {
    let text = table(&wavelengths(), |_, _| 0.0);
    let (_, material, verdict) = fit(&read(&text, Some("905")));
    let map = material.spectral_map().unwrap();
    assert_eq!((map.len(), map.wavelength(0), map.is_grey()), (1, Some(905.0), true));
    assert_eq!(material.primaries(&[905.0, 400.0]).of([0.25; 3]), [0.25; 2]);
    assert!(verdict.good.iter().any(|line| line.contains("one wavelength, 905 nm")), "{verdict:?}");

    let (fit, material, _) = fit(&read(&text, Some("600-700,905")));
    assert!(material.spectral_map().is_some_and(|map| map.is_grey() && map.len() == 12));
    assert!(fit.report.spectra.unwrap().of_map.colour.is_none());

    for (chosen, word) in [("800", "400 to 905 nm"), ("906", "none")] {
        let wavelengths = Some(ChosenWavelengths::parse(chosen).unwrap());
        let conventions = Conventions { wavelengths, ..Conventions::default() };
        let error = read_from("a.csv", text.as_bytes(), &conventions).err().unwrap();
        let reason = std::error::Error::source(&error).unwrap().to_string();
        assert!(reason.contains("--wavelengths") && reason.contains(word), "{reason}");
        let grey = "theta_i,phi_i,theta_o,phi_o,value\n10,0,20,180,0.5\n";
        let error = read_from("a.csv", grey.as_bytes(), &conventions).err().unwrap();
        assert!(std::error::Error::source(&error).unwrap().to_string().contains("has none"));
    }
}

/// A thin film: its band moves with the angle, which three numbers cannot say.
#[test]
fn spectra_that_colours_do_not_tell_are_told() {
    let film = |w: f64, theta: f64| 2.0 * (w / (25.0 + 0.3 * theta)).sin();
    let (fit, _, verdict) = fit(&read(&table(&wavelengths()[..31], film), None));
    let report = fit.report.spectra.unwrap();
    assert!(report.of_map.error > 0.05, "{report:?}");
    let line = verdict.off.iter().find(|line| line.contains("spectra")).unwrap();
    assert!(line.contains(&format!("at {} nm", report.worst.0)), "{line}");
}

/// Cornell's four files and the spectra in one plane: of the samples' own colours.
#[test]
#[ignore = "needs SRBF_DATA_DIR"]
fn spectra_of_measurements_are_said_by_their_colours() {
    let data = std::path::PathBuf::from(std::env::var_os("SRBF_DATA_DIR").unwrap());
    // Under D65 nothing but values that are cut off at 0 is off: of dark samples, which are noise.
    for (name, most, [day, lamp, tube]) in [
        ("cornell/garnet_red.brdf", 0.03, [0.01, 0.2, 0.4]),
        ("cornell/krylon_blue.brdf", 0.03, [0.01, 0.3, 0.6]),
        ("cornell/cayman.brdf", 0.01, [0.3, 0.7, 1.2]),
        ("cornell/acryl_blue.brdf", 0.05, [0.9, 2.3, 3.4]),
        ("field/in_plane_spectra.csv", 0.01, [0.01, 0.2, 0.2]),
    ] {
        let source = srbf_fit::read::read(&data.join(name)).unwrap();
        let spectra = source.intake.unwrap().spectra.unwrap();
        let [d65, a, f11] = spectra.errors.colour.unwrap().map(|[median, _]| median);
        println!(
            "{name}: {:.2} %, {:?}, dE {d65:.2} {a:.2} {f11:.2}",
            100.0 * spectra.errors.error,
            spectra.worst(&spectra.errors)
        );
        assert!(spectra.errors.error < most, "{name}: {}", spectra.errors.error);
        assert!(d65 < day && a < lamp && f11 < tube, "{name}: {d65} {a} {f11}");
        let map = spectra.to_map().unwrap();
        assert!(map.len() <= 300, "{name}: {} bytes", map.len());
    }
    let lidar =
        srbf_fit::read::read(&data.join("field/lidar_905nm.xompt")).unwrap().intake.unwrap().spectra.unwrap();
    assert!(lidar.is_grey && lidar.text() == "905 nm" && lidar.errors.error < 1e-6, "{}", lidar.text());
}
