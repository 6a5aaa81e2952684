//! The program `srbf` as a user calls it: what is wrong is named, the exit status is 2, and nothing half-written is left.

use srbf_core::{Line, PlaneLobe, View};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder of a test.
fn folder(name: &str) -> PathBuf {
    let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("command-line").join(name);
    let _ = std::fs::remove_dir_all(&place);
    std::fs::create_dir_all(&place).unwrap();
    place
}

fn command(place: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_srbf"));
    command.current_dir(place).args(arguments).env_remove("SRBF_DATA_DIR");
    command
}

fn srbf(place: &Path, arguments: &[&str]) -> Output {
    command(place, arguments).output().unwrap()
}

/// The call fails with status 2, says all of this, and leaves no file but those that were there.
fn refused(place: &Path, arguments: &[&str], says: &[&str]) {
    refused_with_data(place, None, arguments, says);
}

/// The same with SRBF_DATA_DIR.
fn refused_with_data(place: &Path, data: Option<&str>, arguments: &[&str], says: &[&str]) {
    let files = || std::fs::read_dir(place).unwrap().map(|f| f.unwrap().file_name()).collect::<Vec<_>>();
    let before = files();
    let output = command(place, arguments).envs(data.map(|data| ("SRBF_DATA_DIR", data))).output().unwrap();
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
    for key in ["mean_relative_l2", "\"summary\"", "\"verdict\"", "\"fitted views\"", "\"try\""] {
        assert!(json.contains(key), "{key}: {json}");
    }
    // A heading, the verdict, what was written, and what to do next, which works.
    let text = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let [heading, verdict @ .., written, next] = &lines[..] else { panic!("{text}") };
    assert!(heading.starts_with("diffuse.srbf: ") && lines.len() < 16, "{text}");
    let labels = ["good", "fair", "off ", "try ", "note"];
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
fn the_command_line_describes_itself() {
    let place = folder("pages");
    for (shell, says) in [("bash", "_srbf"), ("zsh", "#compdef srbf"), ("fish", "complete -c srbf")] {
        let output = srbf(&place, &["project", "completions", shell]);
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.contains(says) && text.contains("cross-validate"), "{shell}: {text}");
    }
    assert!(srbf(&place, &["project", "man", "man1"]).status.success());
    let page = |name: &str| std::fs::read_to_string(place.join("man1").join(name)).unwrap();
    assert!(page("srbf.1").contains("srbf\\-fit") && page("srbf-fit.1").contains("cross\\-validate"));
    assert!(page("srbf-project-survey.1").contains("SRBF_DATA_DIR"));
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

#[test]
fn options_that_do_not_fit_are_refused_by_name() {
    let place = folder("options");
    std::fs::write(place.join("diffuse.csv"), rows()).unwrap();
    let fits = "material,term,lobe,r,g,b\nblue,diffuse,,0.3,0.3,0.3\ngrey,diffuse,,0.1,0.1,0.1\n";
    std::fs::write(place.join("published.csv"), fits).unwrap();
    refused(&place, &["fit", "diffuse.csv", "--factors", "4"], &["--factors", "24x10"]);
    refused(&place, &["fit", "published.csv"], &["published.csv", "--material", "blue, grey"]);
    refused(&place, &["fit", "published.csv", "--material", "red"], &["red", "blue, grey"]);
    refused(&place, &["fit", "diffuse.csv", "--method", "thesis", "--exchanges", "3"], &["--exchanges"]);
    for (option, value) in
        [("--lobes", "0"), ("--lobes", "65"), ("--smoothness", "NaN"), ("--starts", "0"), ("--steps", "0")]
    {
        refused(&place, &["fit", "diffuse.csv", option, value], &[option.trim_start_matches('-')]);
    }
    refused(&place, &["fit", "model:phong:shine=3"], &["shine"]);
    refused(&place, &["project", "survey"], &["SRBF_DATA_DIR"]);
    refused(&place, &["project", "lobes-table", "diffuse.csv", "--lobes", "3"], &["--lobes", "of its own"]);
    refused(&place, &["--out", "a", "inspect", "matte"], &["--out"]);
    let brushed = "model:ward:alpha_x=0.1,alpha_y=0.4";
    let isotropic = [("--views", "9"), ("--exchanges", "3"), ("--mirrored", "1"), ("--factors", "4x3")];
    for (option, value) in isotropic {
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
    refused(&place, &["compare", "--seconds", "0.5,0.2"], &["--seconds", "rise"]);
    for wrong in ["0", "-1", "nan", "inf", "1e9", "x"] {
        refused(&place, &["compare", &format!("--seconds={wrong}")], &["--seconds", "above 0"]);
    }
    refused(&place, &["compare", "--seconds", "1", "--spp", "4"], &["--seconds", "--spp"]);
    refused(&place, &["compare", "--repeats", "0"], &["--repeats"]);
    refused(&place, &["compare", "--samplers", "lobes,lobes"], &["--samplers", "lobes", "twice"]);
    refused(
        &place,
        &["compare", "--samplers", "fit:lobes", "--materials", "matte"],
        &["material matte", "--lobes"],
    );
    refused(&place, &["compare", "--scenes", "statue"], &["--mesh"]);
    refused(&place, &["compare", "--mesh", "a.obj"], &["--mesh", "teapot"]);
    refused(&place, &["compare", "--scenes", "furnace"], &["constant:VALUE"]);
    refused(&place, &["compare", "--scenes", "nowhere"], &["nowhere", "teapot"]);
    refused(&place, &["compare", "--scenes", "teapot", "--mesh", "a.obj"], &["a.obj"]);
    refused(&place, &["compare", "--materials", "a.f32le:chrome"], &["a.f32le"]);
    refused(&place, &["project", "equal-time", "-o", "a.txt"], &["a.txt", ".md"]);
    refused(&place, &["project", "equal-time", "--repeats", "1"], &["--repeats"]);
    refused_with_data(&place, None, &["project", "equal-time"], &["SRBF_DATA_DIR"]);
    refused(
        &place,
        &["compare", "--samplers", "lobes,rgl", "--materials", "matte"],
        &["material matte", "rgl"],
    );
    refused(&place, &["compare", "--samplers", "ggx+light"], &["ggx+light", "+mis"]);
    refused(
        &place,
        &["compare", "--materials", "matte,cayman", "--lobes", "matte"],
        &["--lobes", "one each"],
    );
}

#[test]
fn an_output_that_would_lie_over_another_is_refused() {
    let place = folder("outputs");
    refused(&place, &["project", "samples", "-o", "s.csv"], &["s.csv", ".png"]);
    refused(&place, &["project", "stability", "-o", "t.csv"], &["t.csv", ".png"]);
    refused(&place, &["project", "thesis-table", "-o", "x.csv"], &["x.csv", ".md"]);
    refused(&place, &["render", "-o", "r.png"], &["r.png", ".exr"]);
    std::fs::write(place.join("README.md"), "# Another project\n").unwrap();
    refused_with_data(&place, Some("."), &["project", "presets", "--out", "."], &["README.md"]);
}

#[test]
fn a_place_that_cannot_be_written_is_found_before_the_work() {
    let place = folder("places");
    std::fs::write(place.join("file"), "").unwrap();
    for arguments in [
        &["render", "--size", "4096x4096", "--spp", "16777216", "-o", "file/a.exr"][..],
        &["compare", "--side", "4096", "--reference-spp", "16777216", "-o", "file/a"],
        &["project", "stability", "--inputs", "100000000", "-o", "file/a.png"],
        &["project", "leave-out", "-o", "file/a.csv"],
    ] {
        refused(&place, arguments, &["file/a"]);
    }
}

#[test]
fn options_without_effect_and_numbers_without_end_are_refused() {
    let place = folder("effect");
    std::fs::write(place.join("diffuse.csv"), rows()).unwrap();
    refused(&place, &["render", "--scene", "teapot", "--mesh-up", "z"], &["--mesh"]);
    refused(&place, &["render", "--ground-material", "cayman"], &["--ground-material", "teapot"]);
    refused(&place, &["project", "samples", "--steps", "4294967295"], &["--steps"]);
}

/// Every sampler renders a table, says so, and writes a picture; the furnace finds the albedo.
#[test]
fn every_sampler_is_called_by_name() {
    let place = folder("samplers");
    let gloss = "model:ggx:alpha=0.3,f0=0.6,diffuse=0.2";
    for (sampler, says) in [
        ("mis", "weighted by the table"),
        ("light", "sampled alone"),
        ("uniform", "the uniform hemisphere"),
        ("cosine", "the cosine"),
        ("phong+mis", "a Phong lobe"),
        ("ward", "Ward's lobe"),
        ("ggx", "visible normals of GGX"),
        ("tabulated", "tabulated distributions"),
        ("factored", "a factored distribution"),
        ("guided", "weighted by the material"),
        ("lobes", "weighted by the table"),
        ("lobes-multi", "together"),
        ("defensive+mis", "weighted by the table"),
    ] {
        let call = ["render", "--scene", "furnace", "--material", gloss, "--sampler", sampler];
        let output = srbf(&place, &[&call[..], &["--size", "12x12", "--spp", "16", "-o", "a.exr"]].concat());
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{sampler}: {}", String::from_utf8_lossy(&output.stderr));
        assert!(text.contains(says) && text.contains(", the table; sampled by"), "{sampler}: {text}");
        assert!(text.contains("white furnace"), "{sampler}: {text}");
    }
    let lobes = ["render", "--material", gloss, "--lobes", "garnet_red", "--sampler", "lobes"];
    let output = srbf(&place, &[&lobes[..], &["--size", "8x8", "--spp", "1", "-o", "a.exr"]].concat());
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(text.contains("of garnet_red") && text.contains("5 % of the cosine"), "{text}");

    let refused = |arguments: &[&str], says: &[&str]| {
        refused(&place, &[&["render", "-o", "b.exr"], arguments].concat(), says);
    };
    refused(&["--sampler", "phnog"], &["phnog", "tabulated", "+mis"]);
    refused(&["--sampler", "rgl", "--material", gloss], &["rgl", ".bsdf"]);
    refused(
        &["--sampler", "thesis", "--material", "model:ward:alpha_x=0.1,alpha_y=0.4"],
        &["thesis", "anisotropic"],
    );
    refused(&["--sampler", "lobes-multi", "--spp", "10"], &["--spp", "16", "--split"]);
    refused(&["--split", "0"], &["--split"]);
    refused(&["--lobes", "garnet_red"], &["--lobes", "table"]);
    refused(&["--lobes", "absent.srbf", "--material", gloss], &["absent.srbf"]);
    refused(&["--light", "on"], &["--light", "only"]);
}

#[test]
fn scenes_load_what_they_use_and_say_what_they_left_out() {
    let place = folder("scenes");
    std::fs::write(place.join("step.obj"), "v 0 0 0\nv 2 0 0\nv 0 1 0\nv 0 0 3\nf 1 2 3\nf 1 3 4\nf 2 4 3\n")
        .unwrap();
    let render = |arguments: &[&str]| {
        let call =
            [&["render", "--size", "16x12", "--spp", "1", "--explain", "-o", "a.exr"], arguments].concat();
        let output = srbf(&place, &call);
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let text = render(&["--scene", "sphere"]);
    assert!(text.contains("material of the ground: the scene sphere has none"), "{text}");
    assert!(text.contains("triangles") && !text.contains("ground: rendered"), "{text}");
    let text = render(&["--scene", "room", "--ball-material", "cayman", "--eye", "0,-9,3", "--fov", "50"]);
    for part in [
        "object: rendered is garnet_red",
        "ball: rendered is cayman",
        "left wall: ",
        "right wall: ",
        "ground: ",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let text = render(&["--scene", "statue", "--mesh", "step.obj", "--look-at", "0,0,0", "--sampler", "ggx"]);
    assert!(
        text.contains("teapot: step.obj takes its place") && text.contains("samples of the light"),
        "{text}"
    );
    // Straight down, and from a place under the ground.
    render(&["--scene", "teapot", "--eye", "0,0,9", "--look-at", "0,0,0"]);
    render(&["--scene", "teapot", "--eye", "0,0,-9", "--look-at", "0,0,0"]);

    let refused = |arguments: &[&str], says: &[&str]| {
        refused(&place, &[&["render", "-o", "b.exr"], arguments].concat(), says);
    };
    refused(&["--scene", "statue"], &["statue", "--mesh"]);
    refused(&["--scene", "sphere", "--mesh", "step.obj"], &["--mesh", "teapot"]);
    refused(&["--scene", "statue", "--mesh", "absent.ply"], &["absent.ply"]);
    refused(&["--scene", "furnace", "--env", "sky"], &["furnace", "constant:VALUE"]);
    refused(&["--ball-material", "cayman"], &["--ball-material", "room"]);
    refused(&["--eye", "1,2"], &["--eye", "X,Y,Z"]);
    refused(&["--eye", "1,2,3", "--look-at", "1,2,3"], &["--eye", "--look-at"]);
    for angle in ["0", "180", "nan", "-5"] {
        refused(&[&format!("--fov={angle}")], &["--fov"]);
    }
    for (name, text) in [
        ("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"),
        ("empty.ply", ""),
        ("far.obj", "v 0 0 1e30\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("what.stl", "solid"),
        ("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"),
    ] {
        std::fs::write(place.join(name), text).unwrap();
        refused(&["--scene", "statue", "--mesh", name], &["mesh", name]);
    }
    for (name, text) in [("cut.hdr", "#?RADIANCE\n"), ("what.exr", "no"), ("a.jpg", "")] {
        std::fs::write(place.join(name), text).unwrap();
        for map in ["lat-long", "angular"] {
            refused(&["--env", name, "--env-map", map], &["environment", name]);
        }
    }
    refused(&["--env-map", "cube"], &["--env-map", "angular"]);
}

#[test]
fn many_turns_of_the_light_are_drawn_as_one() {
    let place = folder("turns");
    let picture = |turn: &str| {
        let turned = ["render", "--size", "16x16", "--spp", "1", "--env-turn", turn, "-o", "a.exr"];
        assert!(srbf(&place, &turned).status.success());
        std::fs::read(place.join("a.exr")).unwrap()
    };
    assert_eq!(picture("1e9"), picture("280"));
}

#[test]
fn a_furnace_of_one_sample_has_no_error() {
    let place = folder("furnace");
    let one = ["render", "--env", "constant:1", "--size", "8x8", "--spp", "1", "-o", "a.exr"];
    let text = String::from_utf8(srbf(&place, &one).stdout).unwrap();
    assert!(text.contains("at least two samples"), "{text}");
    let matte = ["render", "--material", "matte", "--env", "constant:1", "--sampler", "cosine"];
    let size = ["--size", "16x16", "--spp", "4", "-o", "a.exr"];
    let text = String::from_utf8(srbf(&place, &[&matte[..], &size].concat()).stdout).unwrap();
    assert!(text.contains("red        0.500000") && text.contains(" -\n") && !text.contains("NaN"), "{text}");
}

#[test]
fn a_comparison_with_a_poor_reference_says_so() {
    let place = folder("poor");
    let poor = ["compare", "--materials", "garnet_red", "--spp", "512,1024", "--reference-spp", "2"];
    let output = srbf(&place, &[&poor[..], &["--side", "12", "-o", "a"]].concat());
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains(" *\n") && !text.contains("NaN") && !text.contains(" x +- "), "{text}");
    let csv = std::fs::read_to_string(place.join("a.csv")).unwrap();
    let head: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    let column = head.iter().position(|name| *name == "below_reference").unwrap();
    assert!(csv.lines().skip(1).all(|line| line.split(',').nth(column) == Some("1")), "{csv}");
}

/// The page is complete by itself, and a reference is kept until it is harmed.
#[test]
fn a_comparison_writes_numbers_plots_and_a_page() {
    let place = folder("compare");
    let gloss = "model:ggx:alpha=0.3,f0=0.6,diffuse=0.2";
    let arguments = [
        "compare",
        "--scenes",
        "sphere,room",
        "--materials",
        gloss,
        "--lobes",
        "garnet_red",
        "--env",
        "haze",
    ];
    let how = [
        "--samplers",
        "mis,product,fit:mis",
        "--spp",
        "1,4,16",
        "--reference-spp",
        "16",
        "--side",
        "12",
        "-o",
        "a",
    ];
    let run = || String::from_utf8(srbf(&place, &[&arguments[..], &how].concat()).stdout).unwrap();
    let text = run();
    assert!(text.contains("room under haze") && !text.contains("kept from before"), "{text}");
    let csv = std::fs::read_to_string(place.join("a.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + 2 * 3 * 3, "{csv}");
    let html = std::fs::read_to_string(place.join("a.html")).unwrap();
    for outside in ["http://", "https://", "<link", "<script", "url("] {
        assert!(!html.contains(outside), "{outside}");
    }
    let pictures = html.matches("src=\"data:image/png;base64,").count();
    assert_eq!((pictures, html.matches("src=").count()), (2 * (1 + 2 * 4), pictures));
    assert!(std::fs::read(place.join("a.png")).unwrap().starts_with(b"\x89PNG"));

    assert_eq!(run().matches("kept from before").count(), 2);
    for file in std::fs::read_dir(place.join("out/references")).unwrap() {
        let path = file.unwrap().path();
        let mut bytes = std::fs::read(&path).unwrap();
        bytes[100] ^= 1;
        std::fs::write(&path, bytes).unwrap();
    }
    assert!(!run().contains("kept from before"));
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
    let output = srbf(&place, &fit);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let fitted = String::from_utf8(output.stdout).unwrap();
    assert!(fitted.contains("factors: 4 x 3 nodes, largest "), "{fitted}");
    assert!(std::fs::read_to_string(place.join("phong.json")).unwrap().contains("\"factors\""));

    let judge = ["judge", "phong.srbf", "--against", model, "--angles", "10,50"];
    let output = srbf(&place, &judge);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && text.contains("2 held-out views:"), "{text}");
    assert!(
        text.lines().filter(|line| line.starts_with("  10.0 |") || line.starts_with("  50.0 |")).count() == 2
    );
    for line in text.lines().chain(fitted.lines()) {
        assert!(line.chars().count() <= 115, "{line}");
    }
    let text = String::from_utf8(srbf(&place, &["inspect", "phong.srbf"]).stdout).unwrap();
    assert!(text.contains("factors     4 x 3 nodes"), "{text}");
}

#[test]
fn a_damaged_survey_is_named_and_the_table_before_it_is_kept() {
    let place = folder("survey");
    for folder in ["data/rgl", "data/merl"] {
        std::fs::create_dir_all(place.join(folder)).unwrap();
    }
    std::fs::write(place.join("old.csv"), "old").unwrap();
    let survey = |lobes, says: &[&str]| {
        let arguments = ["project", "survey", "--csv", "old.csv", "--lobes", lobes];
        refused_with_data(&place, Some("data"), &arguments, says);
        assert_eq!(std::fs::read(place.join("old.csv")).unwrap(), b"old");
    };
    refused_with_data(&place, Some(""), &["project", "survey"], &["SRBF_DATA_DIR"]);
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
        refused(
            &place,
            &["project", "bench-report", "--measured", "criterion"],
            &["evaluate.scalar", "a median of"],
        );
    }
    measured(&place, "2.5");
    let output = srbf(&place, &["project", "bench-report", "--measured", "criterion"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[cfg(unix)]
#[test]
fn links_that_make_a_ring_are_not_followed() {
    let place = folder("ring");
    measured(&place, "2.5");
    std::os::unix::fs::symlink("..", place.join("criterion/ring")).unwrap();
    let output = srbf(&place, &["project", "bench-report", "--measured", "criterion"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(String::from_utf8(output.stdout).unwrap().matches("scalar").count(), 1);
}

#[cfg(unix)]
#[test]
fn only_files_are_read() {
    let place = folder("devices");
    for name in ["a.hdr", "a.obj"] {
        std::os::unix::fs::symlink("/dev/null", place.join(name)).unwrap();
    }
    refused(&place, &["render", "--env", "a.hdr", "-o", "a.exr"], &["a.hdr", "regular file"]);
    let mesh = ["render", "--scene", "teapot", "--mesh", "a.obj", "-o", "a.exr"];
    refused(&place, &mesh, &["a.obj", "regular file"]);
}

/// Before any work, and what is there stays: a pipe without a reader does not hold the program either.
#[cfg(unix)]
#[test]
fn only_files_are_written() {
    use std::os::unix::fs::symlink;
    let place = folder("outputs");
    for name in ["null.srbf", "null.exr", "null.png", "beside.png", "null.json", "null.csv", "null.md"] {
        symlink("/dev/null", place.join(name)).unwrap();
    }
    for name in ["pipe.srbf", "pipe.exr"] {
        assert!(Command::new("mkfifo").arg(place.join(name)).status().unwrap().success());
    }
    for name in ["folder.srbf", "folder.exr"] {
        std::fs::create_dir(place.join(name)).unwrap();
    }
    let other = "a device, a pipe or a socket";
    let fit = ["fit", "model:lambert:albedo=0.3", "-o"];
    let render = ["render", "--material", "garnet_red", "-o"];
    for (arguments, output, named, reason) in [
        (&fit[..], "null.srbf", "null.srbf", other),
        (&fit, "/dev/null", "/dev/null", other),
        (&fit, "pipe.srbf", "pipe.srbf", other),
        (&fit, "folder.srbf", "folder.srbf", "a folder"),
        (&["fit", "model:lambert:albedo=0.3", "--method", "thesis", "-o"], "null.json", "null.json", other),
        (&render, "null.exr", "null.exr", other),
        (&render, "pipe.exr", "pipe.exr", other),
        (&render, "folder.exr", "folder.exr", "a folder"),
        (&render, "beside.exr", "beside.png", other),
        (&["project", "leave-out", "-o"], "null.csv", "null.csv", other),
        (&["project", "samples", "-o"], "null.png", "null.png", other),
        (&["project", "thesis-table", "-o"], "null.md", "null.md", other),
    ] {
        refused(&place, &[arguments, &[output]].concat(), &["cannot write", named, reason]);
    }
}

#[cfg(unix)]
#[test]
fn a_picture_is_written_through_a_link_and_keeps_its_mode() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let place = folder("link");
    std::fs::write(place.join("real.exr"), "old").unwrap();
    std::fs::set_permissions(place.join("real.exr"), std::fs::Permissions::from_mode(0o640)).unwrap();
    symlink("real.exr", place.join("a.exr")).unwrap();
    let render = ["render", "--material", "garnet_red", "--size", "8x8", "--spp", "1", "-o", "a.exr"];
    let output = srbf(&place, &render);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(place.join("a.exr").is_symlink() && std::fs::read(place.join("real.exr")).unwrap().len() > 100);
    let mode = std::fs::metadata(place.join("real.exr")).unwrap().permissions().mode() & 0o777;
    assert_eq!(mode, 0o640, "{mode:o}");
}

/// By its size, of which the file has holes alone: nothing is read.
#[test]
fn a_file_of_a_size_that_none_of_its_format_has_is_refused() {
    let place = folder("sizes");
    for (name, bytes, says) in [
        ("one-less.binary", 34_992_011u64, "34992011 bytes; a MERL file has 34992012"),
        ("huge.binary", 900_000_000, "900000000 bytes; a MERL file has 34992012"),
        ("short.bsdf", 30, "30 bytes: not an RGL .bsdf file"),
        ("huge.csv", 1 << 40, "a file of at most 1073741824 bytes"),
        ("huge.xyz", 1 << 30, "the name has to end in"),
    ] {
        std::fs::File::create(place.join(name)).unwrap().set_len(bytes).unwrap();
        refused(&place, &["fit", name, "-o", "out.srbf"], &[name, says]);
    }
}

/// Under a limit of the address space, which a shell sets.
#[cfg(target_os = "linux")]
#[test]
fn memory_that_is_not_there_is_an_error() {
    let place = folder("memory");
    let mut text = rows();
    let sample = "0.1,0,0.99498743,0,0,1,0.2,0.1,0.05\n".repeat(1_000_000);
    text += &sample;
    std::fs::write(place.join("long.csv"), text).unwrap();
    for (megabytes, arguments, says) in [
        (150, "fit long.csv -o out.srbf", &["long.csv", "of memory are needed"][..]),
        (20, "fit long.csv -o out.srbf", &["long.csv", "37 MB of memory are needed"]),
        (
            600,
            "render --material garnet_red --size 4096x4096 --spp 1 --threads 1 -o out.exr",
            &["4096x4096", "MB of memory"],
        ),
    ] {
        let limited = format!("ulimit -v {} && exec \"$0\" {arguments}", 1000 * megabytes);
        let output = Command::new("sh")
            .args(["-c", &limited, env!("CARGO_BIN_EXE_srbf")])
            .current_dir(&place)
            .output()
            .unwrap();
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments} in {megabytes} MB: {text}");
        for part in says {
            assert!(text.contains(part), "{arguments} in {megabytes} MB does not say `{part}`: {text}");
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn output_that_cannot_be_written_is_an_error() {
    let place = folder("full");
    for arguments in [&["inspect", "garnet_red"][..], &["--help"]] {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = command(&place, arguments).stdout(full).output().unwrap();
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(text.starts_with("srbf: cannot write to standard output: "), "{text}");
    }
}

#[test]
fn a_reader_that_has_gone_ends_the_program_without_a_word() {
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let output = command(&folder("gone"), &["inspect", "garnet_red"]).stdout(writer).output().unwrap();
    assert_eq!(output.status.code(), Some(141));
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
}

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
fn points_are_named() {
    let place = folder("points");
    refused(&place, &["render", "--points", "halton"], &["halton", "sobol", "random"]);
    let furnace = [
        "render",
        "--scene",
        "furnace",
        "--material",
        "matte",
        "--size",
        "16x16",
        "--spp",
        "4",
        "-o",
        "a.exr",
    ];
    let text =
        |points: &[&str]| String::from_utf8(srbf(&place, &[&furnace[..], points].concat()).stdout).unwrap();
    assert!(text(&["--points", "sobol"]).contains("no standard error, --points random is expected"));
    assert_eq!(
        text(&[]).replace(char::is_numeric, ""),
        text(&["--points", "random"]).replace(char::is_numeric, "")
    );
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
    // Two readings, four materials, two probes, three methods.
    assert_eq!(claims.lines().count(), 1 + 2 * 4 * 2 * 3, "{claims}");
    let page = std::fs::read_to_string(place.join("f/index.html")).unwrap();
    for figure in ["The claim", "Table 5.1", "Figure 5.1", "Figure 5.5: cayman", "Figure 5.6", "Figure 5.7"] {
        assert!(page.contains(figure), "{figure}");
    }
}
