//! Pictures, comparisons, figures.

use crate::{folder, refused, srbf};

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

/// Ball and scene, whatever the material and what stands beside it: under one light a surface has one colour.
#[test]
fn pictures_under_one_light_have_one_exposure() {
    let place = folder("exposure");
    let middle = |name: &str, [x, y]: [u32; 2]| -> [u8; 3] {
        image::open(place.join(name)).unwrap().to_rgb8().get_pixel(x, y).0
    };
    let drawn = |arguments: &[&str], says: &str| {
        let output = srbf(&place, arguments);
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        assert!(text.contains(says), "{text}");
    };
    let light = ["--env", "constant:3", "--spp", "32"];
    drawn(&[&["ball", "matte", "-o", "a.png"], &light[..]].concat(), "exposure 0.667");
    let beside = ["ball", "matte", "--against", "model:lambert:albedo=0.05", "-o", "b.png"];
    drawn(&[&beside, &light[..]].concat(), "exposure 0.667");
    let render = ["render", "--material", "matte", "--size", "64x64", "--max-bounces", "1"];
    drawn(&[&render, &light[..], &["-o", "c.png"]].concat(), "exposure of the PNG: 0.667");
    let shown = [middle("a.png", [128, 150]), middle("b.png", [128, 150]), middle("c.png", [32, 32])];
    assert!(shown.iter().all(|rgb| rgb[0].abs_diff(shown[0][0]) <= 4), "{shown:?}");
    // A stop is a factor of two.
    drawn(&[&render, &light[..], &["--exposure=-1", "-o", "d.png"]].concat(), "-1 stops");
    assert!(middle("d.png", [32, 32])[0] < shown[2][0] - 20);
}

#[test]
fn a_picture_is_written_as_png_alone() {
    let place = folder("png");
    let render = ["render", "--size", "16x16", "--spp", "4", "-o"];
    for name in ["a.png", "b.exr"] {
        let output = srbf(&place, &[&render[..], &[name]].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    let [alone, beside] = ["a.png", "b.png"].map(|name| std::fs::read(place.join(name)).unwrap());
    assert_eq!(alone, beside);
    assert!(!place.join("a.exr").exists() && place.join("b.exr").exists());
}

/// Under a light that a file has; the furnace in daylight has the albedo of colours.
#[test]
fn pictures_are_spectral_by_option() {
    let place = folder("spectral");
    std::fs::write(place.join("lamp.txt"), "# a lamp\n380 1\n780 4\n").unwrap();
    let render = |options: &[&str]| {
        let call = [&["render", "--size", "12x12", "--spp", "16", "-o", "a.exr"], options].concat();
        let output = srbf(&place, &call);
        assert!(output.status.success(), "{call:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let said = render(&["--spectral", "--scene", "furnace", "--material", "garnet_red"]);
    assert!(said.contains("under D65") && said.contains("white furnace"), "{said}");
    let said = render(&["--spectral", "f11", "--scene", "teapot", "--sampler", "product"]);
    assert!(said.contains("under F11; colours are made smooth spectra of matte"), "{said}");
    let said = render(&["--spectral", "lamp.txt", "--material", "model:ggx:alpha=0.3"]);
    assert!(said.contains("under lamp.txt; colours are made smooth spectra of"), "{said}");
    let refused = |options: &[&str], says: &[&str]| {
        refused(&place, &[&["render", "-o", "b.exr", "--spectral"], options].concat(), says);
    };
    refused(&["D50"], &["D50", "F11"]);
    refused(&["none.txt"], &["none.txt"]);
    std::fs::write(place.join("bad.txt"), "400 1\n500 x\n").unwrap();
    refused(&["bad.txt"], &["bad.txt", "line 2"]);
    refused(&["--wavefront"], &["--wavefront", "--spectral"]);
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

/// A lamp and a window show a sheet; a material where a sheet is expected is refused, and the other way round.
#[test]
fn scenes_of_sheets_take_a_sheet_alone() {
    let place = folder("sheets-rendered");
    let presets = concat!(env!("CARGO_MANIFEST_DIR"), "/presets");
    let [sheet, material] =
        ["sheets/ground_glass.srbf", "cayman.srbf"].map(|file| format!("{presets}/{file}"));
    for scene in ["lamp-shade", "window"] {
        for sampler in ["even", "mis", "product", "light", "lobes", "lobes-multi"] {
            let call = ["render", "--scene", scene, "--material", &sheet, "--sampler", sampler];
            let output =
                srbf(&place, &[&call[..], &["--size", "12x8", "--spp", "16", "-o", "a.exr"]].concat());
            let text = String::from_utf8_lossy(&output.stdout);
            assert!(output.status.success(), "{sampler}: {}", String::from_utf8_lossy(&output.stderr));
            assert!(
                text.contains("object: rendered is ground_glass, a sheet, lobes: ")
                    && text.contains("sampled by its lobes on both sides"),
                "{sampler}: {text}"
            );
            assert!(text.contains("ball: rendered is krylon_blue"), "{text}");
        }
    }
    let own = [
        "render",
        "--scene",
        "window",
        "--size",
        "8x8",
        "--spp",
        "4",
        "--spectral",
        "--explain",
        "-o",
        "a.exr",
    ];
    let output = srbf(&place, &own);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(
        text.contains("ground_glass, a sheet") && text.contains("smooth spectra of ground_glass"),
        "{text}"
    );

    let refused = |arguments: &[&str], says: &[&str]| {
        refused(&place, &[&["render", "-o", "b.exr"], arguments].concat(), says);
    };
    for scene in ["lamp-shade", "window"] {
        refused(
            &["--scene", scene, "--material", &material],
            &[scene, "cayman", "a material where a sheet is expected"],
        );
        refused(
            &["--scene", scene, "--material", "cayman"],
            &[scene, "cayman", "a .srbf file of a sheet is expected"],
        );
        refused(&["--scene", scene, "--material", "absent.srbf"], &["absent.srbf"]);
        refused(&["--scene", scene, "--mesh", "step.obj"], &["--mesh", "teapot"]);
        refused(&["--scene", scene, "--sampler", "ggx"], &["ggx", "its own lobes", "mis"]);
        refused(&["--scene", scene, "--lobes", "cayman"], &["--lobes", "table"]);
        refused(&["--scene", scene, "--wavefront", "--sampler", "mis"], &["waves", "materials of lobes"]);
    }
    for scene in ["sphere", "teapot", "furnace", "room"] {
        refused(
            &["--scene", scene, "--material", &sheet],
            &[scene, "window", "where one material is expected"],
        );
    }
    refused(&["--scene", "teapot", "--ground-material", &sheet], &["where one material is expected"]);
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
    let poor = [
        "compare",
        "--materials",
        "garnet_red",
        "--samplers",
        "even,mis,ggx+mis",
        "--spp",
        "512,1024",
        "--reference-spp",
        "2",
    ];
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
    let gloss = "model:ggx:alpha=0.3";
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

/// Maps with suns, black pixels and dark ones beside bright ones: the six that pictures were once lost under.
const MAPS: [&str; 6] = [
    "cc0_forest_512",
    "cc0_hall_512",
    "cc0_venice_512",
    "funston_beach_latlong",
    "grace_latlong",
    "uffizi_latlong",
];

#[test]
#[ignore = "needs SRBF_DATA_DIR, and renders 60 pictures of 16 million paths: many minutes"]
fn no_picture_is_lost_under_six_maps_with_ten_seeds() {
    let data = std::env::var("SRBF_DATA_DIR").expect("SRBF_DATA_DIR names the folder of the data");
    let place = folder("six-maps");
    println!("lost samples of 512 x 512 x 64, at seeds 0 to 9:");
    for map in MAPS {
        let file = format!("{data}/envmaps/{map}.hdr");
        let lost: Vec<String> = (0..10)
            .map(|seed| {
                let seed = seed.to_string();
                let arguments = ["render", "--env", &file, "--seed", &seed, "-o", "one.exr"];
                let output = srbf(&place, &arguments);
                let warnings = String::from_utf8_lossy(&output.stderr).into_owned();
                assert!(output.status.success(), "{map}, seed {seed}: {warnings}");
                assert!(place.join("one.exr").is_file(), "{map}, seed {seed}: no picture");
                let count = warnings.lines().find_map(|line| line.strip_prefix("warning: "));
                count.and_then(|text| text.split(' ').next()).unwrap_or("0").to_owned()
            })
            .collect();
        println!("{map:>22}  {}", lost.join(" "));
    }
}

#[test]
fn a_mesh_has_its_materials_by_maps() {
    let place = folder("maps");
    let mesh = "v -1 0 0\nv 1 0 0\nv 1 2 0\nv -1 2 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";
    std::fs::write(place.join("wall.obj"), mesh).unwrap();
    image::GrayImage::from_raw(2, 1, vec![0, 1]).unwrap().save(place.join("mask.png")).unwrap();
    let shared = ["render", "--scene", "statue", "--mesh", "wall.obj", "--size", "16x16", "--spp", "4"];
    let of = |rest: &[&'static str]| [&shared[..], rest].concat();
    let maps = ["--palette", "matte,garnet_red", "--index-map", "mask.png", "--tint-map", "mask.png"];
    let output = srbf(&place, &of(&[&maps[..], &["-o", "a.exr"]].concat()));
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && text.contains("palette 1: rendered is garnet_red"), "{output:?}");
    let weights =
        ["--palette", "matte,garnet_red", "--weight-map", "mask.png", "--wavefront", "--sampler", "mis"];
    assert!(srbf(&place, &of(&[&weights[..], &["-o", "b.exr"]].concat())).status.success());
    refused(&place, &of(&["--palette", "matte,cayman", "-o", "c.exr"]), &["--index-map"]);
    refused(
        &place,
        &of(&["--palette", "matte", "--index-map", "mask.png", "-o", "c.exr"]),
        &["mask.png", "column 1, row 0"],
    );
    refused(&place, &of(&["--weight-map", "mask.png", "-o", "c.exr"]), &["--palette"]);
    refused(&place, &["render", "--palette", "matte,cayman", "-o", "c.exr"], &["--mesh"]);
}
