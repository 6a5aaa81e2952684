//! The program `srbf-lab` as its users call it: errors are named, the exit status is 2, and nothing half-written is left.

#[path = "../../reference-renderer/tests/command_line/harness.rs"]
mod harness;

use harness::{command, folder, refused, refused_with_data, srbf};
use std::path::Path;

/// The program that is tested.
const PROGRAM: &str = env!("CARGO_BIN_EXE_srbf-lab");

#[test]
fn an_output_that_would_lie_over_another_is_refused() {
    let place = folder("lab-outputs");
    refused(&place, &["samples", "-o", "s.csv"], &["s.csv", ".png"]);
    refused(&place, &["stability", "-o", "t.csv"], &["t.csv", ".png"]);
    refused(&place, &["thesis-table", "-o", "x.csv"], &["x.csv", ".md"]);
    refused(&place, &["equal-time", "-o", "a.txt"], &["a.txt", ".md"]);
    std::fs::write(place.join("README.md"), "# Another project\n").unwrap();
    refused_with_data(&place, Some("."), &["presets", "--out", "."], &["README.md"]);
}

#[test]
fn a_place_that_cannot_be_written_is_found_before_the_work() {
    let place = folder("lab-places");
    std::fs::write(place.join("file"), "").unwrap();
    for arguments in
        [&["stability", "--inputs", "100000000", "-o", "file/a.png"][..], &["leave-out", "-o", "file/a.csv"]]
    {
        refused(&place, arguments, &["file/a"]);
    }
}

#[cfg(unix)]
#[test]
fn an_input_is_not_replaced() {
    let place = folder("lab-input");
    std::fs::copy("../presets/garnet_red.srbf", place.join("m.srbf")).unwrap();
    std::os::unix::fs::symlink("m.srbf", place.join("s.png")).unwrap();
    refused(&place, &["slice", "m.srbf", "-o", "s.png"], &["s.png", "the command's own input m.srbf"]);
    std::fs::remove_file(place.join("s.png")).unwrap();
    assert!(srbf(&place, &["slice", "m.srbf", "-o", "s.png"]).status.success());
}

/// Before any work, and files that are there stay.
#[cfg(unix)]
#[test]
fn only_files_are_written() {
    let place = folder("lab-devices");
    for (command, output) in [("leave-out", "null.csv"), ("samples", "null.png"), ("thesis-table", "null.md")]
    {
        std::os::unix::fs::symlink("/dev/null", place.join(output)).unwrap();
        refused(&place, &[command, "-o", output], &["cannot write", output, "a device, a pipe or a socket"]);
    }
}

#[test]
fn options_that_do_not_fit_are_refused_by_name() {
    let place = folder("lab-options");
    refused(&place, &["survey"], &["SRBF_DATA_DIR"]);
    refused(&place, &["equal-time", "--repeats", "1"], &["--repeats"]);
    refused(&place, &["equal-time"], &["SRBF_DATA_DIR"]);
    refused(&place, &["samples", "--steps", "4294967295"], &["--steps"]);
}

/// What criterion leaves of a bench.
fn measured(place: &Path, nanoseconds: &str) {
    let new = place.join("criterion/evaluate.scalar/12/1024/new");
    std::fs::create_dir_all(&new).unwrap();
    let id =
        r#"{"group_id":"evaluate.scalar","function_id":"12","value_str":"1024","throughput":{"Elements":1}}"#;
    std::fs::write(new.join("benchmark.json"), id).unwrap();
    let estimates = format!(r#"{{"median":{{"point_estimate":{nanoseconds}}}}}"#);
    std::fs::write(new.join("estimates.json"), estimates).unwrap();
}

#[test]
fn times_without_meaning_are_refused_with_their_file() {
    let place = folder("times");
    for nanoseconds in ["0", "-1", "1e300", "1e-300", "null"] {
        measured(&place, nanoseconds);
        refused(&place, &["bench-report", "--measured", "criterion"], &["evaluate.scalar", "a median of"]);
    }
    measured(&place, "2.5");
    let output = srbf(&place, &["bench-report", "--measured", "criterion"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[cfg(unix)]
#[test]
fn links_that_make_a_ring_are_not_followed() {
    let place = folder("lab-ring");
    measured(&place, "2.5");
    std::os::unix::fs::symlink("..", place.join("criterion/ring")).unwrap();
    let output = srbf(&place, &["bench-report", "--measured", "criterion"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(String::from_utf8(output.stdout).unwrap().matches("scalar").count(), 1);
}

#[test]
fn a_damaged_survey_is_named_and_the_table_before_it_is_kept() {
    let place = folder("survey");
    for folder in ["data/rgl", "data/merl"] {
        std::fs::create_dir_all(place.join(folder)).unwrap();
    }
    std::fs::write(place.join("old.csv"), "old").unwrap();
    let survey = |lobes, says: &[&str]| {
        let arguments = ["survey", "--csv", "old.csv", "--lobes", lobes];
        refused_with_data(&place, Some("data"), &arguments, says);
        assert_eq!(std::fs::read(place.join("old.csv")).unwrap(), b"old");
    };
    refused_with_data(&place, Some(""), &["survey"], &["SRBF_DATA_DIR"]);
    survey("0", &["lobes"]);
    survey("2", &["nbrdf_merl80.f32le"]);
    let (weights, names) = ("data/merl/nbrdf_merl80.f32le", "data/merl/nbrdf_merl80_names.txt");
    std::fs::write(place.join(weights), [0; 7]).unwrap();
    survey("2", &["nbrdf_merl80.f32le", "7 bytes"]);
    std::fs::write(place.join(weights), [0; 2 * 4 * NETWORK]).unwrap();
    survey("2", &["nbrdf_merl80_names.txt"]);
    std::fs::write(place.join(names), "one two three").unwrap();
    survey("2", &["2 networks", "3 names"]);
}

/// Numbers of a network: 6 inputs, two layers of 21, 3 outputs, and a constant for each.
const NETWORK: usize = 7 * 21 + 22 * 21 + 22 * 3;

#[test]
fn figures_say_what_they_miss() {
    let place = folder("figures");
    refused(&place, &["figures"], &["SRBF_DATA_DIR"]);
    refused(&place, &["figures", "--side", "7"], &["--side", "8..=1024"]);
    std::fs::write(place.join("file"), []).unwrap();
    std::fs::create_dir_all(place.join("data/envmaps")).unwrap();
    let refused = |arguments: &[&str], says: &[&str]| {
        refused_with_data(&place, Some("data"), &[&["figures"], arguments].concat(), says);
    };
    refused(&["-o", "file"], &["file", "a folder is expected"]);
    refused(&["-o", "figures"], &["data/envmaps/funston_beach_latlong.hdr"]);
    std::fs::write(place.join("data/envmaps/funston_beach_latlong.hdr"), b"#?RADIANCE\n").unwrap();
    refused(&["-o", "figures"], &["data/envmaps/funston_beach_latlong.hdr"]);
}

#[test]
#[ignore = "needs SRBF_DATA_DIR"]
fn the_figures_of_the_thesis_are_made() {
    let place = folder("thesis-figures");
    let data = std::env::var("SRBF_DATA_DIR").expect("SRBF_DATA_DIR names the folder of the data");
    let output =
        command(&place, &["figures", "--quick", "-o", "f"]).env("SRBF_DATA_DIR", data).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let claims = std::fs::read_to_string(place.join("f/claim.csv")).unwrap();
    // Two readings, two materials, two probes, six methods; no claim from so few pixels.
    assert_eq!(claims.lines().count(), 1 + 2 * 2 * 2 * 6, "{claims}");
    assert!(claims.lines().skip(1).all(|line| line.ends_with(",-")), "{claims}");
    let page = std::fs::read_to_string(place.join("f/index.html")).unwrap();
    for figure in ["The claim", "Table 5.1", "Figure 5.1", "Figure 5.5: cayman", "Figure 5.6", "Figure 5.7"] {
        assert!(page.contains(figure), "{figure}");
    }
}

/// The documents of this repository, with every figure as it is stated.
fn documents(place: &Path) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    std::fs::create_dir_all(place.join("docs")).unwrap();
    std::fs::copy(root.join("README.md"), place.join("README.md")).unwrap();
    for entry in root.join("docs").read_dir().unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            std::fs::copy(&path, place.join("docs").join(path.file_name().unwrap())).unwrap();
        }
    }
}

#[test]
fn a_planted_stale_figure_is_found_and_written_right() {
    let place = folder("stated");
    documents(&place);
    let check = ["stated", "--check", "--only", "bytes"];
    let output = srbf(&place, &check);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));

    let page = place.join("docs/figures.md");
    let right = std::fs::read_to_string(&page).unwrap();
    let bytes = include_bytes!("../../presets/garnet_red.srbf").len();
    let row = format!("| preset garnet red | {bytes} |");
    assert!(right.contains(&row), "{row}");
    std::fs::write(&page, right.replace(&row, "| preset garnet red | 4321 |")).unwrap();
    refused(&place, &check, &["docs/figures.md:", "bytes garnet_red", "stated as 4321", "--write"]);
    let output = srbf(&place, &["stated", "--write", "--only", "bytes"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(std::fs::read_to_string(&page).unwrap(), right);

    // The table of figures, a sentence whose words changed, and a time of nobody knows which processor.
    let table = place.join("docs/figures.csv");
    let figures = std::fs::read_to_string(&table).unwrap();
    std::fs::write(&table, figures.replace("bytes cayman,", "bytes cayman,1")).unwrap();
    refused(&place, &check, &["docs/figures.csv", "bytes cayman"]);
    std::fs::write(&table, &figures).unwrap();
    std::fs::write(&page, right.replace(&row, "| garnet rot | 7 |")).unwrap();
    refused(&place, &check, &["docs/figures.md", "garnet red", "once is expected"]);
    std::fs::write(&page, format!("{right}\n## More\n\nA call takes 12 ns.\n")).unwrap();
    refused(&place, &check, &["docs/figures.md:", "More", "without commit and processor"]);
    refused(&place, &["stated", "--only", "nothing"], &["--only nothing", "furnace"]);
}
