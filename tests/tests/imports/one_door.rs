//! Files leave the programs through one door, which keeps inputs and the files of others: no command can go round it.

use super::plain_text::{files, root};

/// The door.
const DOOR: &str = "reference-renderer/src/out/output.rs";

/// The packages of the programs.
const PROGRAMS: [&str; 3] = ["reference-renderer/src", "lab/src", "web/src"];

/// Functions and types that make, change or remove files.
const WRITERS: [&str; 10] = [
    "write_atomically",
    "Outputs",
    "fs::write",
    "fs::copy",
    "fs::rename",
    "fs::remove_",
    "fs::{",
    "hard_link",
    "File::create",
    "OpenOptions",
];

/// The lines of a program, without its unit tests, that write files.
fn writing(code: &str) -> Vec<&str> {
    let end = ["#[cfg(test)]\nmod tests", "#[cfg(test)]\npub mod tests"]
        .iter()
        .filter_map(|tests| code.find(tests))
        .min();
    let program = &code[..end.unwrap_or(code.len())];
    let is_writing = |line: &&str| WRITERS.iter().any(|writer| line.contains(writer));
    program.lines().filter(is_writing).collect()
}

#[test]
fn files_are_written_through_one_door() {
    let (mut all, mut strays) = (Vec::new(), Vec::new());
    PROGRAMS.iter().for_each(|folder| files(&root().join(folder), &mut all));
    for (file, _) in all {
        let code = std::fs::read_to_string(&file).expect("a file");
        let found = writing(&code);
        if file.ends_with(DOOR) {
            assert!(!found.is_empty(), "the door was not understood");
        } else {
            strays.extend(found.into_iter().map(|line| format!("{}: {line}", file.display())));
        }
    }
    assert!(strays.is_empty(), "not through {DOOR}:\n{}", strays.join("\n"));
    let planted = "use std::fs;\nfn f() { fs::write(a, b); }\n#[cfg(test)]\nmod tests { fs::copy(a, b); }";
    assert_eq!(writing(planted), ["fn f() { fs::write(a, b); }"]);
}
