//! Tables and models as materials of `srbf render`, and the pictures of `srbf ball` and `srbf fit --picture`, as a user calls them.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder of a test.
fn folder(name: &str) -> PathBuf {
    let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("tables").join(name);
    let _ = std::fs::remove_dir_all(&place);
    std::fs::create_dir_all(&place).unwrap();
    place
}

fn srbf(place: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_srbf")).current_dir(place).args(arguments).output().unwrap()
}

/// Standard output of a call that succeeds.
fn printed(place: &Path, arguments: &[&str]) -> String {
    let output = srbf(place, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// The call fails with status 2, says all of this, and writes nothing.
fn refused(place: &Path, arguments: &[&str], says: &[&str]) {
    let files = || std::fs::read_dir(place).unwrap().map(|f| f.unwrap().file_name()).collect::<Vec<_>>();
    let before = files();
    let output = srbf(place, arguments);
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
    assert!(says.iter().all(|part| text.contains(part)), "{arguments:?} does not say {says:?}: {text}");
    assert!(!text.contains("panicked"), "{text}");
    assert_eq!(files(), before, "{arguments:?}");
}

/// The print of a white furnace: for each channel the rendered value, its standard error, and the expected one.
fn furnace(place: &Path, material: &str) -> [[f64; 3]; 3] {
    let light = ["render", "--material", material, "--env", "constant:1", "--seed", "2"];
    let text = printed(place, &[&light[..], &["--size", "64x64", "--spp", "64", "-o", "a.exr"]].concat());
    ["red", "green", "blue"].map(|channel| {
        let line = text.lines().find(|line| line.starts_with(channel)).expect(&text);
        let numbers: Vec<f64> = line.split_whitespace().skip(1).take(3).map(|n| n.parse().unwrap()).collect();
        [numbers[0], numbers[1], numbers[2]]
    })
}

/// The rendered mean is the quadrature, within what chance explains.
fn check_furnace(place: &Path, material: &str) -> [[f64; 3]; 3] {
    let channels = furnace(place, material);
    for [rendered, error, expected] in channels {
        // Beside chance, the six digits that are printed, and a quadrature that is interpolated.
        let allowed = 4.5 * error + 2e-6 + 2e-4 * expected.abs();
        assert!((rendered - expected).abs() < allowed, "{material}: {channels:?}");
        assert!(error < 0.01 * expected.abs().max(0.01), "{material}: {channels:?}");
    }
    channels
}

#[test]
fn the_mean_of_a_model_in_a_furnace_is_its_quadrature() {
    let place = folder("furnace");
    let lambert = check_furnace(&place, "model:lambert:albedo=0.6/0.2/0.1");
    for (channel, albedo) in lambert.iter().zip([0.6, 0.2, 0.1]) {
        assert!((channel[2] - albedo).abs() < 1e-4, "{lambert:?}");
    }
    for model in [
        "model:ggx:alpha=0.003,f0=0.9/0.5/0.1",
        "model:ggx:alpha=0.3,ior=1.5,diffuse=0.2",
        "model:phong:diffuse=0.3,specular=0.3,exponent=50",
        "model:ward:alpha_x=0.05,alpha_y=0.3,specular=0.5",
    ] {
        check_furnace(&place, model);
    }
}

#[test]
fn published_fits_are_rendered_by_name() {
    let place = folder("published");
    let fits = "material,term,lobe,r,g,b\nblue,diffuse,,0.3,0.2,0.1\ngrey,diffuse,,0.1,0.1,0.1\n";
    std::fs::write(place.join("fits.csv"), fits).unwrap();
    assert!(check_furnace(&place, "fits.csv:blue")[0][2] > 0.05);
    refused(&place, &["render", "--material", "fits.csv"], &["fits.csv:NAME", "blue, grey"]);
    refused(&place, &["render", "--material", "fits.csv:red"], &["red", "blue, grey"]);
}

#[test]
fn what_cannot_be_rendered_is_refused_by_name() {
    let place = folder("refused");
    write_samples(&place, [0.2, 0.1, 0.05]);
    std::fs::rename(place.join("samples.csv"), place.join("bright.csv")).unwrap();
    std::fs::write(place.join("cut.bsdf"), "tensor_file").unwrap();
    std::fs::write(place.join("cut.BINARY"), "abc").unwrap();
    let render = |material: &str, says: &[&str]| {
        refused(&place, &["render", "--material", material, "-o", "a.exr"], says);
        refused(&place, &["ball", "matte", "--against", material, "-o", "a.png"], says);
        let ground = ["render", "--scene", "teapot", "--ground-material", material, "-o", "a.exr"];
        refused(&place, &ground, says);
    };
    render("cut.bsdf", &["cut.bsdf"]);
    render("cut.BINARY", &["cut.BINARY", "3 bytes"]);
    render("absent.bsdf", &["absent.bsdf"]);
    render("model:phong:shine=3", &["shine"]);
    render("model:blinn", &["blinn"]);
}

/// Black is a measurement.
#[test]
fn black_samples_are_rendered_black() {
    let place = folder("black");
    write_samples(&place, [0.0; 3]);
    assert!(check_furnace(&place, "samples.csv").iter().all(|channel| channel[2].abs() < 1e-6));
}

#[test]
fn samples_are_rendered_completed() {
    let place = folder("completed");
    write_samples(&place, [0.2, 0.1, 0.05]);
    let [red, ..] = check_furnace(&place, "samples.csv");
    // 0.2 everywhere is an albedo of 0.2 pi.
    assert!((red[2] - 0.2 * std::f64::consts::PI).abs() < 0.05, "{red:?}");
}

/// Writes samples of one view, the same f in all directions, `samples.csv`.
fn write_samples(place: &Path, [red, green, blue]: [f64; 3]) {
    let mut rows = String::from("wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,r,g,b\n");
    for i in 0..40 {
        let (z, phi) = ((f64::from(i) + 0.5) / 40.0, 2.4 * f64::from(i));
        let r = (1.0 - z * z).sqrt();
        rows += &format!("{},{},{z},0,0,1,{red},{green},{blue}\n", r * phi.cos(), r * phi.sin());
    }
    std::fs::write(place.join("samples.csv"), rows).unwrap();
}

#[test]
fn the_picture_of_samples_has_curves() {
    let place = folder("curves");
    write_samples(&place, [0.2, 0.1, 0.05]);
    let few = ["--lobes", "2", "--views", "3", "--starts", "1", "--steps", "2", "--exchanges", "0"];
    // Beside the material, unless it is not wanted.
    let fit = ["fit", "samples.csv", "-o", "a.srbf"];
    printed(&place, &[&fit[..], &few, &["--no-picture"]].concat());
    assert!(!place.join("a.png").exists());
    printed(&place, &[&fit[..], &few, &["--env", "constant:1"]].concat());
    let [width, height] = png_size(&place.join("a.png"));
    assert!(width == 800 && (800..2000).contains(&height), "{width} {height}");
    printed(&place, &["plot", "a.srbf", "-o", "alone.png", "--env", "constant:1"]);
    let text = printed(
        &place,
        &["plot", "a.srbf", "--against", "samples.csv", "-o", "b.png", "--env", "constant:1"],
    );
    assert!(text.contains("relative L2"), "{text}");
    // A ball and five views are three rows, whatever stands beside the fit; the samples have fewer views.
    let [alone, beside] = ["alone.png", "b.png"].map(|name| png_size(&place.join(name)));
    assert!(alone[0] == 800 && beside[0] == 800 && beside[1] <= alone[1], "{alone:?} {beside:?}");
}

#[test]
fn pictures_that_cannot_be_drawn_are_refused_before_the_fit() {
    let place = folder("pictures-refused");
    let fit = |options: &[&str], says: &[&str]| {
        refused(&place, &[&["fit", "model:lambert"], options].concat(), says);
    };
    fit(&["--picture", "a.jpg"], &["a.jpg", ".png"]);
    fit(&["--picture", "a.png", "-o", "a.png"], &["a.png", "the same file"]);
    fit(&["--picture", "a.png", "--env", "nowhere"], &["nowhere"]);
    fit(&["--picture", "a.png", "--method", "thesis"], &["--picture", "our own method"]);
    fit(&["--env", "haze", "--no-picture"], &["--env", "--no-picture"]);
    refused(&place, &["ball", "matte", "-o", "a.exr"], &["a.exr", ".png"]);
    refused(&place, &["ball", "matte", "--exposure", "NaN"], &["--exposure"]);
}

#[test]
fn tables_are_converted_and_read_again() {
    let place = folder("convert");
    let model = "model:ggx:alpha=0.3,f0=0.6,diffuse=0.2";
    for (name, says) in [
        ("a.binary", "34992012 bytes; read again"),
        ("a.bsdf", "read again"),
        ("a.csv", "16 outgoing directions, chosen here"),
        ("a.astm", "16 outgoing directions, chosen here"),
    ] {
        let text = printed(&place, &["convert", model, name]);
        assert!(text.contains(says), "{text}");
    }
    for name in ["a.binary", "a.bsdf"] {
        check_furnace(&place, name);
        // Our own file may be overwritten, another program's not.
        printed(&place, &["convert", model, name]);
        let bytes = std::fs::read(place.join(name)).unwrap();
        std::fs::write(place.join(name), &bytes[4096..bytes.len() - 8]).unwrap();
        refused(&place, &["convert", model, name], &[name, "--force"]);
        printed(&place, &["--force", "convert", model, name]);
    }
    let spectra = "theta_i,phi_i,theta_o,phi_o,420nm,500nm,550nm,600nm,680nm\n";
    let rows = (0..40)
        .map(|n| format!("{},0,{},{},.1,.1,.2,.3,.3\n", 20 * (n % 4), 15 + 15 * (n / 10), 40 * (n % 5)));
    std::fs::write(place.join("spectra.csv"), format!("{spectra}{}", rows.collect::<String>())).unwrap();
    let text = printed(&place, &["convert", "spectra.csv", "spectra.bsdf"]);
    assert!(text.contains("spectra: 5 wavelengths"), "{text}");
    let text = printed(&place, &["convert", "a.csv", "b.astm"]);
    assert!(text.contains("as they were read"), "{text}");
    write_samples(&place, [0.2, 0.1, 0.05]);
    assert!(printed(&place, &["convert", "samples.csv", "c.binary"]).contains("completed first"));

    let place = folder("convert-refused");
    for (output, says) in
        [("a.srbf", "srbf fit"), ("a.brdf", "spectra"), ("a.xyz", ".binary, .bsdf, .csv, .astm or .xml")]
    {
        refused(&place, &["convert", model, output], &[output, says]);
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("/dev/null", place.join("device.csv")).unwrap();
        refused(&place, &["convert", model, "device.csv"], &["cannot write", "device.csv"]);
    }
    let brushed = "model:ward:alpha_x=0.1,alpha_y=0.4";
    refused(&place, &["convert", brushed, "a.binary"], &[brushed, "anisotropic"]);
    refused(&place, &["convert", "absent.csv", "a.bsdf"], &["absent.csv"]);
}

/// Samples of a turned sample stay as they are, by whatever columns they were read; a model is sampled at every turn.
#[test]
fn turned_samples_are_converted_as_they_were_read() {
    let place = folder("convert-turned");
    let model = "model:ward:diffuse=0.1,specular=0.3,alpha_x=0.1,alpha_y=0.4";
    assert!(printed(&place, &["convert", model, "a.csv"]).contains("chosen here"));
    let rows = |name: &str| -> Vec<[f64; 7]> {
        let text = std::fs::read_to_string(place.join(name)).unwrap();
        let row = |line: &str| {
            let numbers: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
            std::array::from_fn(|k| numbers[k])
        };
        text.lines().skip_while(|line| !line.starts_with("wi_x")).skip(1).map(row).collect()
    };
    let first: Vec<[f64; 7]> = rows("a.csv").into_iter().step_by(101).collect();
    // Some of the samples by angles, azimuths counted from the plane of the light, and a turn of the sample.
    let mut text = "theta_i,theta_o,dphi,rotation,value\n".to_owned();
    for [x, y, z, a, b, c, f] in &first {
        let [light, viewer] = [y.atan2(*x), b.atan2(*a)].map(f64::to_degrees);
        let [i, o] = [x.hypot(*y).atan2(*z), a.hypot(*b).atan2(*c)].map(f64::to_degrees);
        text += &format!("{i},{o},{},{},{f:e}\n", viewer - light, -light);
    }
    std::fs::write(place.join("b.csv"), text).unwrap();
    let said = printed(&place, &["convert", "b.csv", "c.csv"]);
    assert!(said.contains("as they were read"), "{said}");
    let again = rows("c.csv");
    assert_eq!(first.len(), again.len());
    for (a, b) in first.iter().zip(&again) {
        assert!(
            (0..6).all(|k| (a[k] - b[k]).abs() < 1e-9) && (a[6] / b[6] - 1.0).abs() < 1e-9,
            "{a:?} {b:?}"
        );
    }
}

/// Width and height in the head of a PNG.
fn png_size(path: &Path) -> [u32; 2] {
    let bytes = std::fs::read(path).unwrap();
    assert_eq!(&bytes[1..4], b"PNG");
    [16, 20].map(|at| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()))
}

/// The mean difference of two balls that a line names, in per cent.
fn mean_difference(text: &str) -> f64 {
    let after = text.split("difference of the balls: mean ").nth(1).expect(text);
    after.split_whitespace().next().unwrap().parse().unwrap()
}

#[test]
fn balls_are_drawn_alone_and_side_by_side() {
    let place = folder("balls");
    let grey = ["--against", "model:lambert:albedo=0.5", "--spp", "2"];
    let text = printed(&place, &[&["ball", "matte", "-o", "same.png"], &grey[..]].concat());
    assert!(mean_difference(&text) < 0.01, "{text}");
    let text = printed(&place, &[&["ball", "garnet_red", "-o", "other.png"], &grey[..]].concat());
    assert!(mean_difference(&text) > 20.0, "{text}");
    let [width, height] = png_size(&place.join("other.png"));
    printed(&place, &["ball", "cayman", "--spp", "2", "--env", "haze", "-o", "one.png"]);
    assert_eq!(png_size(&place.join("one.png")), [width / 3, height]);
    // A turn is of the sample of an anisotropic surface alone.
    let bytes = |name: &str, material: &str, turn: &str| {
        printed(&place, &["ball", material, "--spp", "2", "--env", "haze", "--turn", turn, "-o", name]);
        std::fs::read(place.join(name)).unwrap()
    };
    let brushed = "model:ward:alpha_x=0.1,alpha_y=0.4";
    assert_ne!(bytes("brushed.png", brushed, "0"), bytes("turned.png", brushed, "90"));
    assert_eq!(bytes("isotropic.png", "cayman", "0"), bytes("same_turned.png", "cayman", "90"));
    for turn in ["NaN", "1e6", "x"] {
        refused(&place, &["ball", brushed, "--turn", turn, "-o", "no.png"], &["--turn"]);
    }
    // The same bytes on any number of threads.
    printed(&place, &["ball", "cayman", "--spp", "2", "--env", "haze", "--threads", "1", "-o", "two.png"]);
    assert_eq!(std::fs::read(place.join("one.png")).unwrap(), std::fs::read(place.join("two.png")).unwrap());
}

#[test]
fn a_fit_is_pictured_beside_its_model() {
    let place = folder("fit");
    let quick = ["--lobes", "2", "--starts", "1", "--exchanges", "0", "--steps", "2", "--views", "3"];
    let fit = ["fit", "model:lambert:albedo=0.6/0.2/0.1", "-o", "a.srbf", "--picture", "a.png"];
    printed(&place, &[&fit[..], &quick].concat());
    assert_eq!(png_size(&place.join("a.png"))[0], 800);
    assert!(place.join("a.srbf").exists() && place.join("a.json").exists());
}

#[test]
fn a_page_holds_the_material_and_its_verdict() {
    let place = folder("page");
    let quick = [
        "--lobes",
        "2",
        "--starts",
        "1",
        "--exchanges",
        "0",
        "--steps",
        "2",
        "--views",
        "3",
        "--env",
        "constant:1",
    ];
    let text = printed(
        &place,
        &[&["fit", "model:lambert:albedo=0.6/0.2/0.1", "-o", "a.srbf", "--html"][..], &quick].concat(),
    );
    assert!(text.contains("wrote a.srbf, a.json, a.png, a.html"), "{text}");
    let page = std::fs::read_to_string(place.join("a.html")).unwrap();
    for part in ["\"name\":\"a\"", "\"are\":\"table\"", "<style>", "self.srbfData = "] {
        assert!(page.contains(part), "{part}");
    }
    // The verdict stands there once, and nothing is asked of a network.
    assert_eq!(page.matches("relative L2: median").count(), 1);
    assert!(!page.contains(" src=\"") && !page.contains("href=\"style"));
    let plot = ["plot", "a.srbf", "--against", "model:lambert:albedo=0.6/0.2/0.1", "--env", "constant:1"];
    printed(&place, &[&plot[..], &["-o", "b.png", "--html"]].concat());
    assert!(std::fs::read_to_string(place.join("b.html")).unwrap().contains("relative L2: median"));
    refused(&place, &["fit", "model:lambert", "--html", "--no-picture"], &["--html", "--no-picture"]);
    refused(&place, &["fit", "model:lambert", "--html", "--method", "thesis"], &["--html", "our own method"]);
}

#[test]
#[ignore = "needs SRBF_DATA_DIR"]
fn the_mean_of_measured_tables_in_a_furnace_is_their_quadrature() {
    let data = std::env::var("SRBF_DATA_DIR").expect("SRBF_DATA_DIR names the folder of the data");
    let place = folder("measured");
    for name in ["cc_green_malachite", "irid_flake_paint1", "ilm_solo_m_68", "chm_light_blue"] {
        let channels = check_furnace(&place, &format!("{data}/rgl/{name}_rgb.bsdf"));
        println!("{name}: {channels:?}");
    }
}
