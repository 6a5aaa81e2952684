//! Help of the command line, and options that are refused.

use crate::{folder, refused, rows, srbf};

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
    let isotropic = [("--exchanges", "3"), ("--mirrored", "1"), ("--factors", "4x3")];
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
