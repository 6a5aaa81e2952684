//! The program `srbf` as a user calls it: what is wrong is named, the exit status is 2, and nothing half-written is left.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// A folder of a test.
fn folder(name: &str) -> PathBuf {
    let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("command-line").join(name);
    let _ = std::fs::remove_dir_all(&place);
    std::fs::create_dir_all(&place).unwrap();
    place
}

fn srbf(place: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_srbf"));
    command.current_dir(place).args(arguments).env_remove("SRBF_DATA_DIR").output().unwrap()
}

/// The call fails with status 2, says all of this, and leaves no file but those that were there.
fn refused(place: &Path, arguments: &[&str], says: &[&str]) {
    let files = || std::fs::read_dir(place).unwrap().map(|f| f.unwrap().file_name()).collect::<Vec<_>>();
    let before = files();
    let output = srbf(place, arguments);
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
    for part in says {
        assert!(text.contains(part), "{arguments:?} does not say `{part}`: {text}");
    }
    assert!(!text.contains("panicked"), "{text}");
    assert_eq!(files(), before, "{arguments:?}");
}

/// Samples of a diffuse surface at two views.
fn rows() -> String {
    let mut text = String::from("wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,r,g,b\n");
    for (wo_x, wo_z) in [(0.0f64, 1.0f64), (0.6, 0.8)] {
        for i in 0..60 {
            let (z, phi) = ((f64::from(i) + 0.5) / 60.0, 2.4 * f64::from(i));
            let r = (1.0 - z * z).sqrt();
            text += &format!("{},{},{z},{wo_x},0,{wo_z},0.2,0.1,0.05\n", r * phi.cos(), r * phi.sin());
        }
    }
    text
}

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
        ("empty.csv", String::new(), "the first line"),
        ("header.csv", good.replace("wi_x", "x"), "the first line"),
        ("short.csv", with_line_5("0,0,1,0,0,1,0.2,0.1"), "line 5"),
        ("word.csv", with_line_5("0,0,1,0,0,1,0.2,0.1,red"), "line 5"),
        ("nan.csv", with_line_5("NaN,0,1,0,0,1,0.2,0.1,0.1"), "line 5"),
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
    assert!(json.contains("mean_relative_l2"), "{json}");
    assert!(srbf(&place, &["inspect", "diffuse.srbf"]).status.success());

    let bytes = std::fs::read(place.join("diffuse.srbf")).unwrap();
    std::fs::write(place.join("cut.srbf"), &bytes[..bytes.len() / 2]).unwrap();
    refused(&place, &["inspect", "cut.srbf"], &["cut.srbf"]);
    refused(&place, &["render", "--material", "cut.srbf", "-o", "out.exr"], &["cut.srbf"]);
    refused(&place, &["inspect", "absent.srbf"], &["absent.srbf"]);
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

#[test]
fn what_is_left_out_is_printed_and_in_the_report() {
    let place = folder("left-out");
    std::fs::write(place.join("diffuse.csv"), rows()).unwrap();
    let fit = ["fit", "diffuse.csv", "--lobes", "1", "--starts", "1", "--exchanges", "0", "--cross-validate"];
    let output = srbf(&place, &fit);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && text.contains("views left out: mean - %"), "{text}");
    let json = std::fs::read_to_string(place.join("out/diffuse.json")).unwrap();
    assert!(json.contains("mean_relative_l2_of_samples"), "{json}");
}

/// As `srbf ... | head` does it.
#[test]
fn a_reader_that_goes_away_ends_the_program_quietly() {
    let place = folder("pipe");
    let mut command = Command::new(env!("CARGO_BIN_EXE_srbf"));
    command
        .current_dir(&place)
        .args(["inspect", concat!(env!("CARGO_MANIFEST_DIR"), "/../presets/cayman.srbf")]);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && text.is_empty(), "{text}");
}

#[test]
fn options_that_do_not_fit_are_refused_by_name() {
    let place = folder("options");
    std::fs::write(place.join("diffuse.csv"), rows()).unwrap();
    let fits = "material,term,lobe,r,g,b\nblue,diffuse,,0.3,0.3,0.3\ngrey,diffuse,,0.1,0.1,0.1\n";
    std::fs::write(place.join("published.csv"), fits).unwrap();
    refused(&place, &["fit", "diffuse.csv", "--views", "9"], &["diffuse.csv", "--views"]);
    refused(&place, &["fit", "published.csv"], &["published.csv", "--material", "blue, grey"]);
    refused(&place, &["fit", "published.csv", "--material", "red"], &["red", "blue, grey"]);
    refused(&place, &["fit", "diffuse.csv", "--method", "thesis", "--exchanges", "3"], &["--exchanges"]);
    for (option, value) in
        [("--lobes", "0"), ("--lobes", "65"), ("--smoothness", "NaN"), ("--starts", "0"), ("--steps", "0")]
    {
        refused(&place, &["fit", "diffuse.csv", option, value], &[option.trim_start_matches('-')]);
    }
    refused(&place, &["fit", "model:phong:shine=3"], &["shine"]);
    refused(&place, &["fit", "--survey", "6"], &["SRBF_DATA_DIR"]);
    for other in [["--method", "thesis"], ["-o", "a.srbf"], ["--material", "blue"]] {
        refused(&place, &["fit", "--survey", "6", other[0], other[1]], &[other[0], "--survey"]);
    }
    for other in [["--method", "thesis"], ["-o", "a.srbf"]] {
        refused(
            &place,
            &["fit", "diffuse.csv", "--lobes-table", other[0], other[1]],
            &[other[0], "--lobes-table"],
        );
    }
    let brushed = "model:ward:alpha_x=0.1,alpha_y=0.4";
    for (option, value) in [("--views", "9"), ("--exchanges", "3"), ("--mirrored", "1")] {
        refused(&place, &["fit", brushed, option, value], &[option, "anisotropic"]);
    }
    for method in ["thesis", "lafortune"] {
        refused(&place, &["fit", brushed, "--method", method], &["anisotropic"]);
    }
    refused(&place, &["fit", "model:lambert", "--cross-validate"], &["--cross-validate", "samples"]);
    refused(&place, &["fit", "diffuse.csv", "-o", "diffuse.json"], &["diffuse.json", "-o"]);
    refused(&place, &["render", "--env", "constant:NaN", "-o", "out.exr"], &["NaN"]);
    refused(&place, &["render", "--size", "0x9", "-o", "out.exr"], &["0x9"]);
    refused(&place, &["compare", "--spp", "4,2"], &["--spp"]);
}
