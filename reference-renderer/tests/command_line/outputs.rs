//! No output replaces an input of its command, by any name; what `srbf` did not write goes by `--force` alone.
//!
//! Commands and their arguments are those of clap's own tree: one without a case fails the test. A case first runs where its outputs are
//! free, so that none is refused for another reason.

use crate::{folder, refused, rows, srbf};
use clap::CommandFactory;
use srbf_reference_renderer::command::{Cli, inputs};
use std::collections::BTreeSet;
use std::path::Path;

/// A call and its files.
struct Case {
    call: &'static str,
    /// The arguments that name inputs, and the files that they name.
    inputs: &'static [(&'static str, &'static str)],
    writes: &'static [&'static str],
    /// Calls whose output `@` is to be this input under its own name, where the endings of both fit.
    onto: &'static [(&'static str, &'static str)],
}

const CASES: &[Case] = &[
    Case {
        call: "fit s.csv --lobes 1 --starts 1 --steps 2 --views 3 --exchanges 0 --factors none --env map.hdr --picture p.png --html -o f.srbf",
        inputs: &[("files", "s.csv"), ("env", "map.hdr")],
        writes: &["f.srbf", "f.json", "p.png", "p.html"],
        // The name of the report is made of that of the material.
        onto: &[
            ("fit s.csv --no-picture -o @", "s.csv"),
            ("fit model:sgd:name=felt,file=sgd.csv --no-picture -o @", "sgd.csv"),
            ("fit s.json --no-picture -o s.srbf", "s.json"),
            ("fit s.json --method thesis -o @", "s.json"),
        ],
    },
    Case {
        call: "convert t.bsdf x.csv",
        inputs: &[("input", "t.bsdf")],
        writes: &["x.csv"],
        onto: &[
            ("convert s.csv @", "s.csv"),
            ("convert t.bsdf @", "t.bsdf"),
            ("convert model:sgd:name=felt,file=sgd.csv @", "sgd.csv"),
            ("convert model:lambert:albedo=lamp.csv @", "lamp.csv"),
        ],
    },
    Case {
        call: "export m.srbf --glsl -o x.glsl",
        inputs: &[("file", "m.srbf")],
        writes: &["x.glsl"],
        onto: &[("export m.srbf --glsl -o @", "m.srbf"), ("export m.srbf --json -o @", "m.srbf")],
    },
    Case {
        // Of a material that does not name us.
        call: "export n.srbf --json -o x.json",
        inputs: &[("file", "n.srbf")],
        writes: &["x.json"],
        onto: &[],
    },
    Case {
        call: "pack m.srbf --against t.bsdf -o x.srbf",
        inputs: &[("input", "m.srbf"), ("against", "t.bsdf")],
        writes: &["x.srbf"],
        onto: &[("pack m.srbf -o @", "m.srbf"), ("pack m.srbf --against t.bsdf -o @", "t.bsdf")],
    },
    Case {
        call: "join --front-reflection m.srbf --front-transmission g.srbf --back-reflection b.srbf --back-transmission n.srbf \
            -o sheet.srbf",
        inputs: &[
            ("front_reflection", "m.srbf"),
            ("front_transmission", "g.srbf"),
            ("back_reflection", "b.srbf"),
            ("back_transmission", "n.srbf"),
        ],
        writes: &["sheet.srbf"],
        onto: &[("join --front-reflection m.srbf -o @", "m.srbf")],
    },
    Case {
        call: "render --scene room --mesh a.obj --material net.f32le:one --lobes m.srbf --ground-material g.srbf \
            --ball-material b.srbf --env map.hdr --spectral lamp.csv --size 4x4 --spp 1 -o r.exr",
        inputs: &[
            ("mesh", "a.obj"),
            ("material", "net.f32le"),
            // Which is read beside the weights.
            ("material", "net_names.txt"),
            ("lobes", "m.srbf"),
            ("ground_material", "g.srbf"),
            ("ball_material", "b.srbf"),
            ("env", "map.hdr"),
            ("spectral", "lamp.csv"),
        ],
        writes: &["r.exr", "r.png"],
        onto: &[("render --env map.exr --size 4x4 --spp 1 -o @", "map.exr")],
    },
    Case {
        call: "render --scene statue --mesh a.obj --palette m.srbf,g.srbf --index-map i.png --weight-map w.png --tint-map t.png \
            --size 4x4 --spp 1 -o r.exr",
        inputs: &[
            ("mesh", "a.obj"),
            ("palette", "m.srbf"),
            ("palette", "g.srbf"),
            ("index_map", "i.png"),
            ("weight_map", "w.png"),
            ("tint_map", "t.png"),
        ],
        writes: &["r.exr", "r.png"],
        onto: &[("render --scene statue --mesh a.obj --tint-map t.png --size 4x4 --spp 1 -o @", "t.png")],
    },
    Case {
        // Against samples, of which no ball is drawn: that takes seconds.
        call: "plot m.srbf --against s.csv --env map.hdr --html -o p.png",
        inputs: &[("material", "m.srbf"), ("against", "s.csv"), ("env", "map.hdr")],
        writes: &["p.png", "p.html"],
        onto: &[],
    },
    Case {
        call: "ball m.srbf --against t.bsdf --env map.hdr --spp 1 -o b.png",
        inputs: &[("material", "m.srbf"), ("against", "t.bsdf"), ("env", "map.hdr")],
        writes: &["b.png"],
        onto: &[],
    },
    Case {
        call: "compare --scenes room --mesh a.obj --materials t.bsdf --lobes m.srbf --env map.hdr --samplers lobes \
            --spp 1 --repeats 1 --reference-spp 2 --side 4 --no-references -o c",
        inputs: &[("mesh", "a.obj"), ("materials", "t.bsdf"), ("lobes", "m.srbf"), ("env", "map.hdr")],
        writes: &["c.csv", "c.png", "c.html"],
        onto: &[("compare --materials s.csv --no-references -o @", "s.csv")],
    },
    Case { call: "man .", inputs: &[], writes: &["srbf.1", "srbf-fit.1", "srbf-view.1"], onto: &[] },
];

/// Commands that write no file.
const SILENT: [&str; 5] = ["inspect", "look", "judge", "view", "completions"];

/// Arguments that name folders to write to.
const FOLDERS: [(&str, &str); 2] = [("man", "folder"), ("compare", "references")];

/// A folder with every input.
fn place(name: &str) -> std::path::PathBuf {
    let place = folder(&format!("outputs-{name}"));
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for (name, from) in [
        ("m.srbf", "presets/garnet_red.srbf"),
        ("g.srbf", "presets/krylon_blue.srbf"),
        ("b.srbf", "presets/cayman.srbf"),
        ("n.srbf", "fuzz/seeds/material/packed"),
        ("map.hdr", "fuzz/seeds/scene-hdr/small"),
        ("map.exr", "fuzz/seeds/scene-exr/small"),
        ("a.obj", "fuzz/seeds/scene-obj/small"),
        ("t.bsdf", "fuzz/seeds/rgl/small"),
        ("net.f32le", "fuzz/seeds/neural/one"),
    ] {
        std::fs::copy(root.join(from), place.join(name)).unwrap();
    }
    #[cfg(unix)]
    std::os::unix::fs::symlink(".", place.join("link")).unwrap();
    std::fs::create_dir(place.join("sub")).unwrap();
    let map = image::GrayImage::from_raw(2, 1, vec![0, 1]).unwrap();
    ["i.png", "w.png", "t.png"].iter().for_each(|name| map.save(place.join(name)).unwrap());
    std::fs::write(place.join("net_names.txt"), "one").unwrap();
    std::fs::write(place.join("s.csv"), rows()).unwrap();
    std::fs::write(place.join("lamp.csv"), "400,0.2\n700,0.8\n").unwrap();
    std::fs::write(place.join("s.json"), rows()).unwrap();
    std::fs::write(place.join("sgd.csv"), SGD).unwrap();
    place
}

/// A published fit.
const SGD: &str = "name,rhoD_r,rhoD_g,rhoD_b,rhoS_r,rhoS_g,rhoS_b,alpha_r,alpha_g,alpha_b,p_r,p_g,p_b,\
f0_r,f0_g,f0_b,f1_r,f1_g,f1_b,kap_r,kap_g,kap_b,lambda_r,lambda_g,lambda_b,c_r,c_g,c_b,k_r,k_g,k_b,\
theta0_r,theta0_g,theta0_b,error_r,error_g,error_b\n\
felt,0.1,0.1,0.1,0.3,0.3,0.3,0.2,0.2,0.2,0.5,0.5,0.5,0.5,0.5,0.5,0,0,0,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,0,0,0\n";

/// The arguments of a call, `@` being a file.
fn words<'a>(call: &'a str, file: &'a str, options: &[&'a str]) -> Vec<&'a str> {
    let words = call.split_whitespace().map(|word| if word == "@" { file } else { word });
    words.chain(options.iter().copied()).collect()
}

fn succeeds(place: &Path, call: &str, options: &[&str]) {
    let output = srbf(place, &words(call, "", options));
    assert!(output.status.success(), "{call}: {}", String::from_utf8_lossy(&output.stderr));
}

fn names(place: &Path) -> BTreeSet<String> {
    let entries = std::fs::read_dir(place).unwrap();
    entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

/// Puts another name for a file in place of an output, in all ways that a file system has.
#[cfg(unix)]
const WAYS: &[fn(&Path, &str, &str)] = &[
    |place, file, output| std::os::unix::fs::symlink(file, place.join(output)).unwrap(),
    |place, file, output| {
        std::os::unix::fs::symlink(place.join("link").join(file), place.join(output)).unwrap()
    },
    |place, file, output| std::fs::hard_link(place.join(file), place.join(output)).unwrap(),
];
#[cfg(not(unix))]
const WAYS: &[fn(&Path, &str, &str)] = &[];

#[test]
fn every_command_that_writes_has_a_case_with_all_of_its_inputs() {
    let program = Cli::command();
    for command in program.get_subcommands() {
        let name = command.get_name();
        let cases: Vec<&Case> =
            CASES.iter().filter(|case| case.call.split(' ').next() == Some(name)).collect();
        let outputs: Vec<_> = command
            .get_arguments()
            .filter(|argument| inputs::OUTPUTS.contains(&argument.get_id().as_str()))
            .collect();
        assert_eq!(
            cases.is_empty(),
            SILENT.contains(&name),
            "{name}: a case, or a place among the silent ones"
        );
        assert!(outputs.is_empty() || !cases.is_empty(), "{name} writes {outputs:?}");
        if cases.is_empty() {
            continue;
        }
        let is_used = |output: &clap::Arg| {
            let names = [
                output.get_long().map(|name| format!("--{name}")),
                output.get_short().map(|name| format!("-{name}")),
            ];
            let mut words = cases.iter().flat_map(|case| case.call.split(' '));
            output.is_positional() || words.any(|word| names.iter().flatten().any(|name| name == word))
        };
        assert!(outputs.iter().all(|output| is_used(output)), "{name}: a case for each of {outputs:?}");
        let covered: BTreeSet<_> = cases.iter().flat_map(|case| case.inputs).map(|input| input.0).collect();
        let there = inputs::arguments(command).map(|argument| argument.get_id().as_str());
        let there: BTreeSet<_> = there.filter(|id| !FOLDERS.contains(&(name, id))).collect();
        assert_eq!(covered, there, "{name}: a case for each argument that may name a file");
    }
}

#[test]
fn no_output_replaces_an_input_by_any_name() {
    for (number, Case { call, inputs, writes, onto }) in CASES.iter().enumerate() {
        let place = place(&format!("input-{number}"));
        let before = names(&place);
        let bytes = |name: &str| std::fs::read(place.join(name)).unwrap();
        succeeds(&place, call, &[]);
        let new: BTreeSet<String> = names(&place).difference(&before).cloned().collect();
        if *call != "man ." {
            assert_eq!(new, writes.iter().map(|name| (*name).to_owned()).collect(), "{call}");
        }
        new.iter().for_each(|output| std::fs::remove_file(place.join(output)).unwrap());
        for output in *writes {
            for (_, input) in *inputs {
                for way in WAYS {
                    let old = bytes(input);
                    way(&place, input, output);
                    for options in [&[][..], &["--force"]] {
                        refused(
                            &place,
                            &words(call, "", options),
                            &[output, "the command's own input", input],
                        );
                        assert!(bytes(input) == old && bytes(output) == old, "{call}: {output} is {input}");
                    }
                    std::fs::remove_file(place.join(output)).unwrap();
                }
            }
        }
        for (call, input) in *onto {
            let old = bytes(input);
            let whole = place.join(input).to_string_lossy().into_owned();
            let mut spelled =
                vec![input.to_string(), format!("./{input}"), format!("sub/.././{input}"), whole];
            // Where capital letters are the same as small ones.
            spelled.extend(Some(input.to_uppercase()).filter(|name| place.join(name).exists()));
            for name in spelled {
                for options in [&[][..], &["--force"]] {
                    refused(&place, &words(call, &name, options), &["the command's own input", input]);
                    assert!(bytes(input) == old, "{call} onto {name}");
                }
            }
        }
    }
}

#[test]
fn what_others_wrote_is_overwritten_by_force_alone() {
    for (number, Case { call, writes, .. }) in CASES.iter().enumerate() {
        let place = place(&format!("others-{number}"));
        let mine = b"a text of somebody else";
        let bytes = |name: &str| std::fs::read(place.join(name)).unwrap();
        std::fs::write(place.join("mine"), mine).unwrap();
        for output in *writes {
            std::fs::write(place.join(output), mine).unwrap();
            refused(&place, &words(call, "", &[]), &[output, "srbf did not write it", "--force"]);
            assert!(bytes(output) == mine, "{call}: {output}");
            std::fs::remove_file(place.join(output)).unwrap();
            for way in WAYS {
                way(&place, "mine", output);
                refused(&place, &words(call, "", &[]), &[output, "srbf did not write it"]);
                assert!(bytes(output) == mine && bytes("mine") == mine, "{call}: {output} is a link");
                std::fs::remove_file(place.join(output)).unwrap();
            }
        }
        writes.iter().for_each(|output| std::fs::write(place.join(output), mine).unwrap());
        succeeds(&place, call, &["--force"]);
        assert!(writes.iter().all(|output| bytes(output) != mine), "{call}");
        // Its own files are no others'.
        succeeds(&place, call, &[]);
    }
}

/// The job without a command takes minutes: of it the refusal alone, before the work.
#[test]
fn the_main_job_keeps_what_others_wrote() {
    let place = folder("outputs-main");
    std::fs::create_dir(place.join("out")).unwrap();
    for name in
        ["sphere.exr", "sphere.png", "teapot.png", "error-vs-time.csv", "error-vs-time.png", "report.html"]
    {
        let file = place.join("out").join(name);
        std::fs::write(&file, "mine").unwrap();
        refused(&place, &[], &[name, "srbf did not write it"]);
        assert_eq!(std::fs::read(&file).unwrap(), b"mine");
        std::fs::remove_file(file).unwrap();
    }
    assert!(names(&place.join("out")).is_empty());
}
