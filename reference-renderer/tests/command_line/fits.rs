//! Fits and their verdicts.

use crate::{command, folder, refused, rows, srbf};
use srbf_core::{Line, PlaneLobe, View};

#[test]
fn damaged_tables_are_refused_with_file_and_line() {
    let place = folder("tables");
    let good = rows();
    let lines: Vec<&str> = good.lines().collect();
    let with_line_5 = |line: &str| {
        let mut lines = lines.clone();
        lines[4] = line;
        lines.join("\n")
    };
    for (name, text, says) in [
        ("empty.csv", String::new(), "no line names the columns"),
        ("header.csv", good.replace("wi_x", "x"), "line 1 names the columns"),
        ("short.csv", with_line_5("0,0,1,0,0,1,0.2,0.1"), "line 5"),
        ("word.csv", with_line_5("0,0,1,0,0,1,0.2,0.1,red"), "line 5"),
        ("wavelength.csv", good.replace("r,g,b", "400nm,NaN,700nm"), "`NaN`"),
        ("long.csv", with_line_5("0,0,9,0,0,1,0.2,0.1,0.1"), "line 5"),
        ("cut.binary", "abc".into(), "cut.binary"),
        ("cut.bsdf", "tensor_file".into(), "cut.bsdf"),
        ("what.xyz", "?".into(), "what.xyz"),
    ] {
        std::fs::write(place.join(name), text).unwrap();
        refused(&place, &["fit", name, "-o", "out.srbf"], &[name, says]);
    }
    refused(&place, &["fit", "absent.csv", "-o", "out.srbf"], &["absent.csv"]);
}

#[test]
fn a_table_is_fitted_and_the_material_inspected_and_a_cut_one_refused() {
    let place = folder("fit");
    std::fs::write(place.join("diffuse.csv"), rows()).unwrap();
    let fit =
        ["fit", "diffuse.csv", "--lobes", "2", "--starts", "2", "--exchanges", "0", "-o", "diffuse.srbf"];
    let output = srbf(&place, &fit);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let json = std::fs::read_to_string(place.join("diffuse.json")).unwrap();
    for key in ["mean_relative_l2", "\"summary\"", "\"verdict\"", "\"fitted views\"", "\"try\""] {
        assert!(json.contains(key), "{key}: {json}");
    }
    // A heading, the input, the verdict, the files that were written, and the next step, which works.
    let text = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let [heading, verdict @ .., written, next] = &lines[..] else { panic!("{text}") };
    assert!(heading.starts_with("diffuse.srbf: ") && lines.len() < 20, "{text}");
    let labels = ["data", "use ", "good", "fair", "off ", "try ", "note"];
    assert!(verdict.iter().all(|line| labels.contains(&&line[..4])), "{text}");
    assert!(text.contains("good relative L2: median"), "{text}");
    assert_eq!(*written, "wrote diffuse.srbf, diffuse.json, diffuse.png");
    assert!(place.join("diffuse.png").exists());
    let next: Vec<&str> = next.strip_prefix("next  srbf ").unwrap().split(' ').collect();
    let output = srbf(&place, &[&next[..], &["--size", "16x16", "--spp", "1"]].concat());
    assert!(output.status.success() && place.join("diffuse.exr").exists());

    let inspected = srbf(&place, &["inspect", "diffuse.srbf", "--lobes"]);
    let text = String::from_utf8(inspected.stdout).unwrap();
    assert!(inspected.status.success() && text.contains("luminance  (R-Y)/Y  (B-Y)/Y"), "{text}");

    let bytes = std::fs::read(place.join("diffuse.srbf")).unwrap();
    std::fs::write(place.join("cut.srbf"), &bytes[..bytes.len() / 2]).unwrap();
    refused(&place, &["inspect", "cut.srbf"], &["cut.srbf"]);
    refused(&place, &["render", "--material", "cut.srbf", "-o", "out.exr"], &["cut.srbf"]);
    refused(&place, &["inspect", "absent.srbf"], &["absent.srbf"]);
}

#[test]
fn samples_too_few_to_be_meant_are_refused_with_the_number_that_is_needed() {
    let place = folder("few");
    let head = "theta_i,phi_i,theta_o,phi_o,value\n";
    let near = |n: i32| format!("{},0,30,180,0.5\n", 10 * n);
    for (name, rows, says) in [
        ("one.csv", near(1), "1 sample;"),
        ("four.csv", (1..=4).map(near).collect(), "4 samples;"),
        ("same.csv", near(3).repeat(40), "40 samples at 1 pair of directions;"),
        ("twice.csv", (1..=4).map(near).collect::<String>().repeat(2), "8 samples at 4 pairs of directions;"),
    ] {
        std::fs::write(place.join(name), format!("{head}{rows}")).unwrap();
        for command in ["fit", "pack"] {
            refused(&place, &[command, name, "-o", "out.srbf"], &[name, says, "need 5 at least"]);
        }
    }
}

/// Of samples, which are fitted with less effort than the options name.
#[test]
fn the_provenance_tells_the_options_as_they_were_given() {
    let place = folder("provenance");
    std::fs::write(place.join("s.csv"), rows()).unwrap();
    let options = ["--lobes", "2", "--starts", "3", "--steps", "7", "--exchanges", "1", "--bytes", "7000"];
    let fit = ["fit", "s.csv", "--smoothness", "1e-4", "--views", "3", "--no-picture", "-o", "s.srbf"];
    assert!(srbf(&place, &[&fit[..], &options].concat()).status.success());
    let output = srbf(&place, &["inspect", "s.srbf", "--json"]);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let line = json["provenance"][1].as_str().unwrap();
    let says = "smoothness 1e-4, 3 starts, 7 steps, 1 exchanges, 7000 bytes at most";
    assert!(line.contains("2 lobes, ") && line.ends_with(says), "{line}");
    assert_eq!((&json["kind"], &json["lobes"]), (&"material".into(), &2.into()));
}

#[test]
fn the_content_is_printed_as_json() {
    let place = folder("inspect");
    let json = |arguments: &[&str]| -> serde_json::Value {
        let output = srbf(&place, &[&["inspect", "--json"], arguments].concat());
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let material = json(&["garnet_red", "--lobes"]);
    let views = material["views"].as_array().unwrap();
    assert_eq!((material["bytes"].as_u64(), views.len()), (Some(4512), 17));
    assert_eq!(material["spectra"]["wavelengths"].as_array().unwrap().len(), 31);
    let text = String::from_utf8(srbf(&place, &["inspect", "garnet_red"]).stdout).unwrap();
    for (view, line) in views.iter().zip(text.lines().skip_while(|line| !line.starts_with("view ")).skip(1)) {
        let numbers: Vec<f64> = line.split_whitespace().map(|word| word.parse().unwrap()).collect();
        let albedo = view["albedo"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap());
        let of_json = [view["degrees"].as_f64().unwrap(), view["squeeze"].as_f64().unwrap()];
        for (shown, stored) in numbers[1..6].iter().zip(of_json.into_iter().chain(albedo)) {
            assert!((shown - stored).abs() < 6e-3, "{line}: {view}");
        }
        let share = view["diffuse"].as_f64().unwrap();
        assert!((numbers[6] - 100.0 * share).abs() < 0.06, "{line}: {view}");
        assert_eq!(view["lobes"].as_array().unwrap().len(), 10);
    }
    assert!(json(&["garnet_red"])["views"][0].get("lobes").is_none());
    let sheet = json(&[concat!(env!("CARGO_MANIFEST_DIR"), "/presets/sheets/ground_glass.srbf")]);
    assert_eq!(sheet["kind"], "sheet");
    assert!(sheet["quarters"]["back-reflection"].is_null());
    assert_eq!(sheet["quarters"]["front-transmission"]["kind"], "material");
    assert_eq!(sheet["light"].as_array().unwrap().len(), 6);
    refused(&place, &["inspect", "garnet_red", "--json", "--quiet"], &["--json", "--quiet"]);
}

/// The folder that is written to without -o has a name for each.
#[test]
fn models_and_methods_have_files_of_their_own() {
    let place = folder("names");
    for arguments in [
        &["model:lambert:albedo=0.3", "--lobes", "1", "--method", "thesis"][..],
        &["model:lambert:albedo=1e-155", "--lobes", "2", "--method", "thesis"],
    ] {
        let output = srbf(&place, &[&["fit"], arguments].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    let mut names: Vec<_> =
        std::fs::read_dir(place.join("out")).unwrap().map(|f| f.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["lambert-albedo=0.3-thesis.json", "lambert-albedo=1e-155-thesis.json"]);
    let json = std::fs::read_to_string(place.join("out/lambert-albedo=0.3-thesis.json")).unwrap();
    assert!(json.contains("model:lambert:albedo=0.3"), "{json}");
}

/// A fit of a moment.
const QUICK: [&str; 10] =
    ["--lobes", "1", "--starts", "1", "--steps", "2", "--exchanges", "0", "--no-picture", "--views=2"];

#[test]
fn as_much_is_printed_as_is_asked_for() {
    let place = folder("words");
    let fit = |options: &[&str]| {
        let call = [&["fit", "model:lambert:albedo=0.3", "-o", "a.srbf"], &QUICK[..], options].concat();
        let output = srbf(&place, &call);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap())
    };
    let tables = "albedo r g b, fit (data)";
    assert!(!fit(&[]).0.contains(tables) && fit(&["--verbose"]).0.contains(tables));
    assert_eq!(fit(&["--quiet"]), Default::default());
    assert_eq!(fit(&["--json"]).0, std::fs::read_to_string(place.join("a.json")).unwrap());
    assert_eq!(String::from_utf8(srbf(&place, &["-q", "inspect", "matte"]).stdout).unwrap(), "");
    for both in [["--quiet", "--json"], ["--quiet", "--verbose"], ["--json", "--verbose"]] {
        refused(&place, &["fit", "model:lambert", both[0], both[1]], &both);
    }
    let version = String::from_utf8(srbf(&place, &["--version"]).stdout).unwrap();
    assert_eq!(version, format!("srbf {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn several_files_are_fitted_and_a_bad_one_is_named() {
    let place = folder("several");
    std::fs::write(place.join("bad.csv"), "theta_i\n").unwrap();
    let files = ["fit", "model:lambert:albedo=0.3", "bad.csv", "model:lambert:albedo=0.5", "-o", "fits"];
    let output = srbf(&place, &[&files[..], &QUICK].concat());
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.contains("bad.csv") && text.contains("1 of 3 files were not fitted"), "{text}");
    for name in ["lambert-albedo=0.3", "lambert-albedo=0.5"] {
        assert!(
            place.join(format!("fits/{name}.srbf")).exists()
                && place.join(format!("fits/{name}.json")).exists()
        );
    }
    assert!(!place.join("fits/bad.srbf").exists());
    let place = folder("several-refused");
    let two = ["fit", "model:lambert", "model:phong"];
    for (options, says) in [
        (["-o", "a.srbf"], ["a.srbf", "a folder"]),
        (["--picture", "a.png"], ["--picture", "one file"]),
        (["--material", "blue"], ["--material", "one file"]),
    ] {
        refused(&place, &[&two[..], &options].concat(), &says);
    }
    refused(&place, &["fit", "model:lambert", "model:lambert"], &["both", "out/lambert.srbf"]);
}

#[test]
fn what_is_left_out_is_printed_and_in_the_report() {
    let place = folder("left-out");
    std::fs::write(place.join("diffuse.csv"), rows()).unwrap();
    let fit = "fit diffuse.csv --lobes 1 --starts 1 --steps 5 --views 3 --exchanges 0 --factors none --cross-validate";
    let output = srbf(&place, &fit.split(' ').collect::<Vec<_>>());
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && text.contains("views left out: mean - %"), "{text}");
    assert!(text.contains("no sample within 20 degrees"), "{text}");
    let json = std::fs::read_to_string(place.join("out/diffuse.json")).unwrap();
    assert!(json.contains("mean_relative_l2_of_samples"), "{json}");
}

#[test]
fn an_extreme_material_is_named() {
    let place = folder("extreme");
    let color_differences = [0.0; 2];
    let (angle, off_plane, log2_sharpness, log2_luminance) = (0.0, 0.0, 0.0, 60.0);
    let lobe = PlaneLobe { angle, off_plane, log2_sharpness, log2_luminance, color_differences };
    let (theta, log2_squeeze, log2_diffuse) = (0.0, 0.0, -1.0);
    let diffuse_color_differences = color_differences;
    let view = View { theta, log2_squeeze, log2_diffuse, diffuse_color_differences, lobes: &[lobe] };
    let line = Line { views: &[view], squeezed: 0, mirrored: 0, factors: None };
    let mut bytes = vec![0; line.encoded_len("test")];
    line.encode("test", &mut bytes).unwrap();
    std::fs::write(place.join("hot.srbf"), bytes).unwrap();
    let render = ["render", "--scene", "teapot", "--size", "16x16", "--spp", "4", "--material", "hot.srbf"];
    refused(&place, &[&render[..], &["-o", "a.exr"]].concat(), &["material hot", "matte", "finite radiance"]);
}

#[test]
fn a_fit_is_judged_against_what_it_was_made_from() {
    let place = folder("judge");
    let model = "model:phong:diffuse=0.3,specular=0.3,exponent=50";
    let few = ["--lobes", "2", "--starts", "1", "--steps", "20", "--exchanges", "0", "--views", "4"];
    let fit = [&["fit", model, "--verbose", "--factors", "4x3", "-o", "phong.srbf"], &few[..]].concat();
    // On a terminal of 80 columns.
    let printed = |call: &[&str]| command(&place, call).env("COLUMNS", "80").output().unwrap();
    let output = printed(&fit);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let fitted = String::from_utf8(output.stdout).unwrap();
    assert!(fitted.contains("factors: 4 x 3 x 1 nodes, largest "), "{fitted}");
    assert!(std::fs::read_to_string(place.join("phong.json")).unwrap().contains("\"factors\""));

    for angles in [&["100"][..], &["10", "x"]] {
        let judge = [&["judge", "phong.srbf", "--against", model, "--angles"], angles].concat();
        refused(&place, &judge, &["--angles", "from 0 to below 90"]);
    }
    let preset = srbf(&place, &["judge", "garnet_red", "--against", model, "--angles", "30,60"]);
    let text = String::from_utf8(preset.stdout).unwrap();
    assert!(preset.status.success() && text.contains("2 held-out views:"), "{text}");
    let judge = ["judge", "phong.srbf", "--against", model, "--angles", "10", "50"];
    let output = printed(&judge);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && text.contains("2 held-out views:"), "{text}");
    // Errors and albedos.
    let of_views = text.lines().filter(|line| line.starts_with("  10.0 |") || line.starts_with("  50.0 |"));
    assert_eq!(of_views.count(), 4, "{text}");
    for line in text.lines().chain(fitted.lines()) {
        assert!(line.chars().count() <= 80, "{line}");
    }
    let text = String::from_utf8(srbf(&place, &["inspect", "phong.srbf"]).stdout).unwrap();
    assert!(text.contains("factors     4 x 3 x 1 nodes"), "{text}");
}

/// A look names the rows that were read and left out, and options that change it; a fit says the same.
#[test]
fn a_look_says_what_was_read() {
    let place = folder("look");
    let text = rows().replacen("0.2,0.1,0.05", "-1,-1,-1", 1);
    std::fs::write(place.join("samples.csv"), &text).unwrap();
    let said = |arguments: &[&str]| {
        let output = srbf(&place, arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let look = said(&["look", "samples.csv"]);
    assert!(look.contains("119 samples") && look.contains("left out: 1 row with the value -1"), "{look}");
    let json: serde_json::Value = serde_json::from_str(&said(&["look", "samples.csv", "--json"])).unwrap();
    assert_eq!((json["samples"].as_u64(), json["left_out"][0]["lines"][0].as_u64()), (Some(119), Some(2)));
    let table = said(&["look", "--table", "samples.csv", "model:lambert:albedo=0.5"]);
    assert!(table.lines().count() == 3 && table.lines().skip(1).all(|line| line.ends_with('-')), "{table}");

    let divided = said(&["look", "samples.csv", "--quick", "--divide", "pi", "--mirror", "equal"]);
    assert!(divided.contains("divided by 3.14"), "{divided}");
    refused(&place, &["look", "samples.csv", "--divide", "0"], &["--divide", "100pi"]);
    refused(&place, &["look", "model:lambert", "--divide", "pi"], &["model:lambert", "for samples"]);
    std::fs::write(place.join("bad.csv"), "theta_i,phi_i,theta_o,value\n1,2,3,x\n").unwrap();
    refused(&place, &["look", "samples.csv", "bad.csv"], &["bad.csv", "1 of 2 files"]);
}

/// Samples of a lidar: from the look at the file to a picture.
#[test]
fn a_single_wavelength_is_named_wherever_it_is_shown() {
    let place = folder("lidar");
    let rows: Vec<String> = (0..240)
        .map(|n| [n % 8, n / 8 % 6, n / 48].map(f64::from))
        .map(|[i, o, turn]| {
            let (theta_i, theta_o, phi) = (0.17 * i, 0.05 + 0.2 * o, 0.785 * turn);
            let value = 0.1 + (-20.0 * (theta_i - theta_o).powi(2) - 2.0 * (phi - 3.1).powi(2)).exp();
            format!("[9.05e-07, {theta_i}, {theta_o}, {phi}, {value}]")
        })
        .collect();
    let table = rows.join(", ");
    let text = format!(
        "{{\"metadata\": {{\"name\": \"lidar\"}}, \"brdf\": {{\"wavelengths\": [9.05e-07], \"lookupTable\": [{table}]}}}}"
    );
    std::fs::write(place.join("lidar.xompt"), text).unwrap();
    let names = |call: &[&str]| {
        let output = srbf(&place, call);
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(output.status.success(), "{call:?}: {}", String::from_utf8_lossy(&output.stderr));
        assert!(text.contains("905 nm"), "{call:?}: {text}");
    };
    names(&["look", "lidar.xompt"]);
    names(&["look", "lidar.xompt", "--json"]);
    let quick = QUICK.iter().filter(|option| **option != "--no-picture").copied();
    let fit = ["fit", "lidar.xompt", "-o", "lidar.srbf", "--html"];
    names(&fit.into_iter().chain(quick).collect::<Vec<_>>());
    names(&["inspect", "lidar.srbf"]);
    names(&["render", "--material", "lidar.srbf", "--size", "8x8", "--spp", "1", "-o", "lidar.exr"]);
    names(&["convert", "lidar.srbf", "lidar.csv", "--wavelengths", "905"]);
    for (file, word) in [
        ("lidar.json", "one wavelength, 905 nm"),
        ("lidar.html", "one wavelength, 905 nm"),
        ("lidar.csv", ",905nm"),
    ] {
        let text = std::fs::read_to_string(place.join(file)).unwrap();
        assert!(text.contains(word), "{file}");
    }
}

/// Fits, samples and models of spectra become a column for each wavelength; these are read again.
#[test]
fn spectra_are_written_by_wavelength() {
    let place = folder("wavelengths");
    let preset = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../presets/garnet_red.srbf");
    std::fs::copy(preset, place.join("garnet_red.srbf")).unwrap();
    std::fs::write(place.join("paint.csv"), "nm,value\n400,0.1\n550,0.2\n700,0.6\n").unwrap();
    let text = |call: &[&str]| {
        let output = srbf(&place, call);
        assert!(output.status.success(), "{call:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let head = |file: &str| {
        let text = std::fs::read_to_string(place.join(file)).unwrap();
        text.lines().nth(1).unwrap().to_owned()
    };
    let said = text(&["convert", "garnet_red.srbf", "a.csv", "--wavelengths", "400-700"]);
    assert!(said.contains("31 wavelengths from 400 to 700 nm, by the colours"), "{said}");
    assert!(head("a.csv").ends_with(",400nm,410nm,420nm,430nm,440nm,450nm,460nm,470nm,480nm,490nm,500nm,510nm,520nm,530nm,540nm,550nm,560nm,570nm,580nm,590nm,600nm,610nm,620nm,630nm,640nm,650nm,660nm,670nm,680nm,690nm,700nm"));
    text(&["convert", "garnet_red.srbf", "b.csv", "--wavelengths", "450,650"]);
    assert!(head("b.csv").ends_with("wo_z,450nm,650nm"));
    refused(
        &place,
        &["convert", "garnet_red.srbf", "c.csv", "--wavelengths", "905"],
        &["--wavelengths", "400 to 700"],
    );
    let rows = |file: &str| {
        let text = std::fs::read_to_string(place.join(file)).unwrap();
        let mut rows: Vec<Vec<f64>> = text
            .lines()
            .skip(2)
            .map(|line| line.split(',').skip(6).map(|v| v.parse().unwrap()).collect())
            .collect();
        rows.sort_by(|a, b| a.partial_cmp(b).unwrap());
        rows
    };
    text(&["convert", "model:lambert:albedo=paint.csv", "e.csv"]);
    assert_eq!(head("e.csv"), "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,400nm,550nm,700nm");
    for row in rows("e.csv") {
        let apart = row.iter().zip([0.1, 0.2, 0.6]).map(|(a, b)| (a * std::f64::consts::PI / b - 1.0).abs());
        assert!(apart.fold(0.0, f64::max) < 2e-3, "{row:?}");
    }
    // Samples with spectra of their own keep these to the digit.
    let few: Vec<String> = (0..8)
        .map(|n| (n, (0.15 * f64::from(n)).sin_cos()))
        .map(|(n, (sin, cos))| format!("0.6,0,0.8,{},0,{cos},0.{n}25,0.3{n},0.77", -sin))
        .collect();
    let few = format!("# few\nwi_x,wi_y,wi_z,wo_x,wo_y,wo_z,400nm,550nm,700nm\n{}\n", few.join("\n"));
    std::fs::write(place.join("few.csv"), few).unwrap();
    text(&["convert", "few.csv", "f.csv"]);
    assert_eq!(rows("few.csv"), rows("f.csv"));
    refused(&place, &["convert", "model:lambert:albedo=none.csv", "g.csv"], &["none.csv", "spectrum"]);
    let said = text(&["convert", "garnet_red.srbf", "h.astm"]);
    assert!(!said.contains("wavelengths"), "{said}");
}
