//! Which files are read and written, and what happens where that fails.

use crate::{command, folder, refused, rows, srbf};
use std::process::Command;

#[test]
fn an_output_that_would_lie_over_another_is_refused() {
    let place = folder("outputs");
    refused(&place, &["render", "-o", "r.jpg"], &["r.jpg", ".exr", ".png"]);
}

#[test]
fn a_place_that_cannot_be_written_is_found_before_the_work() {
    let place = folder("places");
    std::fs::write(place.join("file"), "").unwrap();
    for arguments in [
        &["render", "--size", "4096x4096", "--spp", "16777216", "-o", "file/a.exr"][..],
        &["compare", "--side", "4096", "--reference-spp", "16777216", "-o", "file/a"],
    ] {
        refused(&place, arguments, &["file/a"]);
    }
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

/// Before any work, and files that are there stay: a pipe without a reader does not hold the program either.
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
    let render =
        ["render", "--material", "garnet_red", "--size", "8x8", "--spp", "1", "--force", "-o", "a.exr"];
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
        ("huge.xyz", 1 << 30, "byte 0 is not"),
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
    std::fs::write(place.join("short.csv"), rows()).unwrap();
    for (megabytes, arguments, says) in [
        (60, "view garnet_red", &["64 MB of memory are needed"][..]),
        (20, "inspect garnet_red", &["64 MB of memory are needed"]),
        (40, "plot garnet_red", &["64 MB of memory are needed"]),
        (25, "render --scene sphere --material garnet_red -o out.exr", &["64 MB of memory are needed"]),
        (150, "fit long.csv -o out.srbf", &["long.csv", "of memory are needed"]),
        (20, "fit long.csv -o out.srbf", &["64 MB of memory are needed"]),
        (300, "fit short.csv -o out.srbf", &["too little memory for the fit"]),
        (300, "fit model:lambert:albedo=0.3 -o out.srbf", &["too little memory for the fit"]),
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

/// Few descriptors, few bytes of a file, one thread or none to be had: each command ends by itself, and its files are whole.
#[cfg(target_os = "linux")]
#[test]
fn limits_of_the_system_are_errors_and_leave_nothing() {
    let place = folder("limits");
    std::fs::write(place.join("a.csv"), rows()).unwrap();
    let [convert, render] =
        ["convert a.csv out.csv", "render --material matte --size 64x64 --spp 1 -o out.exr"];
    let [files, bytes] = ["ulimit -n 4", "trap '' XFSZ; ulimit -f 1"];
    let threads = "export RUST_MIN_STACK=1000000000000; ulimit -v 1000000";
    for (limit, arguments, says) in [
        (files, render, Some("Too many open files")),
        (bytes, convert, Some("out.csv: File too large")),
        (bytes, render, Some("File too large")),
        (bytes, "export --buffer --glsl -o out.glsl", Some("File too large")),
        (threads, "look a.csv --quick", None),
        (threads, "pack garnet_red -o out.srbf", None),
        (threads, "view --no-open", Some("no thread for requests")),
        (threads, render, Some("cannot start the threads")),
        ("export RAYON_NUM_THREADS=1", convert, None),
    ] {
        let call = format!("{limit}; exec \"$0\" {arguments}");
        let output =
            Command::new("sh").args(["-c", &call, crate::PROGRAM]).current_dir(&place).output().unwrap();
        let text = String::from_utf8_lossy(&output.stderr);
        let expected = if says.is_some() { 2 } else { 0 };
        let is_right = output.status.code() == Some(expected) && text.contains(says.unwrap_or_default());
        assert!(is_right && !text.contains("panicked"), "{limit}: {arguments}: {:?} {text}", output.status);
        let mut names: Vec<_> = std::fs::read_dir(&place).unwrap().map(|f| f.unwrap().file_name()).collect();
        names.retain(|name| name != "a.csv");
        assert!(names.len() <= usize::from(expected == 0), "{limit}: {arguments} leaves {names:?}");
        names.iter().for_each(|name| std::fs::remove_file(place.join(name)).unwrap());
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
fn a_material_is_exported_for_every_language() {
    let place = folder("export");
    let material = concat!(env!("CARGO_MANIFEST_DIR"), "/../presets/garnet_red.srbf");
    for language in ["glsl", "wgsl", "hlsl", "slang", "cuda", "cpp", "metal"] {
        let output = srbf(&place, &["export", material, &format!("--{language}")]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.contains("srbf_prepare(") && text.contains("srbf_data"), "{language}");
        let output = srbf(&place, &["export", "--buffer", &format!("--{language}"), "-o", language]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let alone = std::fs::read_to_string(place.join(language)).unwrap();
        assert!(alone.contains("srbf_prepare(") && !alone.contains("srbf_data"), "{language}");
    }
    let output = srbf(&place, &["export", material, "--json"]);
    let numbers: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(numbers["views"].as_array().unwrap().len() > 10);
    refused(&place, &["export", material], &["--glsl"]);
    refused(&place, &["export", "--glsl"], &["FILE"]);
    refused(&place, &["export", "nothing.srbf", "--glsl"], &["nothing.srbf"]);
    refused(&place, &["export", "--buffer", "--json"], &["--json"]);
}
