//! Help of the command line, and options that are refused.

use crate::{command, folder, refused, rows, srbf};
use clap::CommandFactory;
use srbf_reference_renderer::command::Cli;

#[test]
fn the_command_line_describes_itself() {
    let place = folder("pages");
    for (shell, says) in [("bash", "_srbf"), ("zsh", "#compdef srbf"), ("fish", "complete -c srbf")] {
        let output = srbf(&place, &["completions", shell]);
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.contains(says) && text.contains("cross-validate"), "{shell}: {text}");
    }
    assert!(srbf(&place, &["man", "man1"]).status.success());
    let page = |name: &str| std::fs::read_to_string(place.join("man1").join(name)).unwrap();
    assert!(page("srbf.1").contains("srbf\\-fit") && page("srbf-fit.1").contains("cross\\-validate"));
}

/// The output for a terminal of that width.
fn printed_on(place: &std::path::Path, columns: Option<usize>, arguments: &[&str]) -> String {
    let mut call = command(place, arguments);
    let output = call.envs(columns.map(|columns| ("COLUMNS", columns.to_string()))).output().unwrap();
    String::from_utf8([output.stdout, output.stderr].concat()).unwrap()
}

#[test]
fn text_is_as_wide_as_the_terminal() {
    let place = folder("columns");
    let widest = |text: &str| text.lines().map(|line| line.chars().count()).max().unwrap_or(0);
    let program = Cli::command();
    for name in program.get_subcommands().map(clap::Command::get_name) {
        for help in ["-h", "--help"] {
            for (columns, most) in [(Some(80), 80), (Some(60), 60), (None, 100)] {
                let text = printed_on(&place, columns, &[name, help]);
                assert!((20..=most).contains(&widest(&text)), "{name} {help}, {columns:?}: {text}");
            }
        }
    }
    // Tables are no wider by themselves: broken at 80 columns they have no line more.
    for arguments in [&["inspect", "garnet_red", "--lobes"][..], &["inspect", "cayman"]] {
        let [narrow, whole] = [Some(80), None].map(|columns| printed_on(&place, columns, arguments));
        assert!(widest(&narrow) <= 80, "{narrow}");
        let table = |text: &str| text.split_once("\n\n").unwrap().1.to_owned();
        assert_eq!(table(&narrow), table(&whole));
    }
    let wrong = printed_on(&place, Some(60), &["render", "--scene", "statue"]);
    assert!(widest(&wrong) <= 60 && wrong.lines().count() > 1, "{wrong}");
    // Of data no line is broken.
    let data = ["inspect", "garnet_red", "--json"];
    assert_eq!(printed_on(&place, Some(20), &data), printed_on(&place, None, &data));
}

#[test]
fn options_that_do_not_fit_are_refused_by_name() {
    let place = folder("options");
    std::fs::write(place.join("diffuse.csv"), rows()).unwrap();
    let fits = "material,term,lobe,r,g,b\nblue,diffuse,,0.3,0.3,0.3\ngrey,diffuse,,0.1,0.1,0.1\n";
    std::fs::write(place.join("published.csv"), fits).unwrap();
    refused(&place, &["fit", "diffuse.csv", "--factors", "4"], &["--factors", "24x6x3"]);
    refused(&place, &["fit", "published.csv"], &["published.csv", "--material", "blue, grey"]);
    refused(&place, &["fit", "published.csv", "--material", "red"], &["red", "blue, grey"]);
    refused(&place, &["fit", "diffuse.csv", "--method", "thesis", "--exchanges", "3"], &["--exchanges"]);
    for (option, value) in
        [("--lobes", "0"), ("--lobes", "65"), ("--smoothness", "NaN"), ("--starts", "0"), ("--steps", "0")]
    {
        refused(&place, &["fit", "diffuse.csv", option, value], &[option.trim_start_matches('-')]);
    }
    refused(&place, &["fit", "model:phong:shine=3"], &["shine"]);
    refused(&place, &["--out", "a", "inspect", "matte"], &["--out"]);
    let brushed = "model:ward:alpha_x=0.1,alpha_y=0.4";
    for (option, value) in [("--exchanges", "3"), ("--mirrored", "1")] {
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
fn options_without_effect_and_numbers_without_end_are_refused() {
    let place = folder("effect");
    std::fs::write(place.join("diffuse.csv"), rows()).unwrap();
    refused(&place, &["render", "--scene", "teapot", "--mesh-up", "z"], &["--mesh"]);
    refused(&place, &["render", "--ground-material", "cayman"], &["--ground-material", "teapot"]);
}
