//! The files of every package import each other in no circle, and the rooms of a package neither.
//!
//! The code is parsed with `syn`. An import is a `use` of something of the package, or a path to it in the code: `crate::`,
//! `super::`, `self::`, the package's own name, or the name of a module that is a child or was imported. A name is followed
//! through re-exports to the file that defines it, so that a file that only re-exports imports nothing. Unit tests are left out.
//! Two things show in no path, and are not seen: calls of methods, and macros by their bare name.

mod glossary;
mod links;
mod one_door;
mod plain_text;
mod source;

use source::{File, read};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Which file imports from which.
type Graph = BTreeMap<String, BTreeSet<String>>;

/// The packages, their rule for imports from the file whose folder a file is in, and what an understood text must show.
struct Package {
    folder: &'static str,
    /// Whether a file may take from the file whose folder it is in: those two are one text in two files.
    may_take_from_parent: bool,
    /// An import that exists: where it is missing, the text was not understood.
    known: &'static [[&'static str; 2]],
}

const PACKAGES: &[Package] = &[
    Package {
        folder: "core",
        may_take_from_parent: false,
        known: &[
            ["kernel/prepare.rs", "kernel/between_views.rs"],
            ["mixture/rows.rs", "mixture/factors.rs"],
            ["zonal/folded.rs", "squeeze.rs"],
            ["simd/dispatch.rs", "simd/portable.rs"],
            ["lobe/gaussian.rs", "special.rs"],
            ["environment/directions.rs", "kernel/draw.rs"],
        ],
    },
    Package {
        folder: "measured",
        may_take_from_parent: true,
        known: &[["read.rs", "isotropy.rs"], ["look.rs", "row.rs"]],
    },
    Package { folder: "fit", may_take_from_parent: true, known: &[["fit.rs", "fewest_lobes.rs"]] },
    Package { folder: "thesis", may_take_from_parent: true, known: &[["thesis/optimize.rs", "lbfgsb.rs"]] },
    Package { folder: "evaluator", may_take_from_parent: false, known: &[["export.rs", "language.rs"]] },
    Package {
        folder: "web",
        may_take_from_parent: false,
        known: &[["open.rs", "points.rs"], ["page.rs", "open.rs"]],
    },
    Package {
        folder: "capi",
        may_take_from_parent: false,
        known: &[["request.rs", "streams.rs"], ["ask.rs", "arrays.rs"]],
    },
    Package {
        folder: "reference-renderer",
        may_take_from_parent: true,
        known: &[["trace/render.rs", "trace/settings.rs"], ["truth.rs", "truth/measured.rs"]],
    },
    Package { folder: "lab", may_take_from_parent: true, known: &[["figures.rs", "samples.rs"]] },
    Package { folder: "tests", may_take_from_parent: false, known: &[["reference.rs", "tolerance.rs"]] },
    Package { folder: "python", may_take_from_parent: false, known: &[["material.rs", "table.rs"]] },
    Package { folder: "tests/levels", may_take_from_parent: false, known: &[] },
    Package { folder: "benches", may_take_from_parent: false, known: &[] },
];

impl Package {
    /// The parsed files.
    fn files(&self) -> Vec<File> {
        read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(self.folder))
    }

    /// What counts as an import in this package.
    fn graph(&self, files: &[File]) -> Graph {
        let graph = source::graph(files);
        if self.may_take_from_parent { without_parents(&graph) } else { graph }
    }
}

/// A circle of imports, each importing from the next and the last from the first; `None` if there is none.
fn circle(graph: &Graph) -> Option<Vec<String>> {
    fn search(at: &str, graph: &Graph, way: &mut Vec<String>, done: &mut BTreeSet<String>) -> bool {
        if let Some(start) = way.iter().position(|passed| passed == at) {
            way.drain(..start);
            return true;
        }
        if done.contains(at) {
            return false;
        }
        way.push(at.to_owned());
        if graph.get(at).into_iter().flatten().any(|next| search(next, graph, way, done)) {
            return true;
        }
        way.pop();
        done.insert(at.to_owned());
        false
    }
    let (mut way, mut done) = (Vec::new(), BTreeSet::new());
    graph.keys().any(|start| search(start, graph, &mut way, &mut done)).then_some(way)
}

/// The same between rooms: a folder, with the file of its name, or a file that has none.
fn rooms(graph: &Graph) -> Graph {
    let room = |file: &str| file.trim_end_matches(".rs").split('/').next().unwrap_or("").to_owned();
    let mut rooms = Graph::new();
    for (file, targets) in graph {
        let edges = rooms.entry(room(file)).or_default();
        edges.extend(targets.iter().map(|target| room(target)).filter(|target| *target != room(file)));
    }
    rooms
}

/// Floors of a house without circles: a room stands one above the highest that it imports.
fn floors(graph: &Graph) -> usize {
    fn floor(at: &str, graph: &Graph) -> usize {
        1 + graph.get(at).into_iter().flatten().map(|next| floor(next, graph)).max().unwrap_or(0)
    }
    graph.keys().map(|room| floor(room, graph)).max().unwrap_or(0)
}

/// The rooms that the head of a file names behind `May import:`, to the end of the sentence.
fn may_import(head: &str) -> Option<BTreeSet<String>> {
    let (_, list) = head.split_once("May import:")?;
    let list = list.split(['.', ';']).next()?;
    Some(list.split('`').skip(1).step_by(2).map(str::to_owned).collect())
}

/// Without imports of a file from the one whose folder it is in.
fn without_parents(graph: &Graph) -> Graph {
    let is_parent = |child: &str, of: &str| child.starts_with(&format!("{}/", of.trim_end_matches(".rs")));
    let others = |child: &String, all: &BTreeSet<String>| {
        all.iter().filter(|parent| !is_parent(child, parent)).cloned().collect()
    };
    graph.iter().map(|(file, targets)| (file.clone(), others(file, targets))).collect()
}

/// A package of given files.
fn imagined(files: &[(&str, &str)]) -> Graph {
    source::graph(&files.iter().map(|(place, text)| File::new(place, text, "imagined")).collect::<Vec<_>>())
}

#[test]
fn a_planted_circle_is_found() {
    let edge = |graph: &Graph, from: &str, to: &str| graph[from].contains(to);

    let straight = [
        (
            "lib.rs",
            "mod a; mod b;\npub use a::{A, deep::Deep};\npub use b::*;\npub use other::{Foreign, far};",
        ),
        ("a.rs", "pub mod deep;\npub(crate) use deep::Low;\nuse crate::B;\npub struct A(B);"),
        (
            "a/deep.rs",
            "pub struct Deep; pub struct Low;\n#[cfg(test)]\nmod tests { use super::super::A; }\n// crate::A\n\
             const TEXT: &str = \"crate::A\n crate::A\"; /* crate::A */ const C: char = '\"';",
        ),
        ("b.rs", "use core::fmt;\npub struct B;"),
        ("c.rs", "use crate::{a as first, b};\nfn f() { first::Low; b::B }"),
        ("d.rs", "fn f() { println!(\"{}\", crate::c::f()); }"),
        ("e.rs", "use crate::*; fn f(_: A) {}"),
        ("f.rs", "use crate::{Foreign, far}; fn f(_: Foreign, _: far::Near) {}"),
        ("main.rs", "fn main() { imagined::Deep; }"),
    ];
    let found = imagined(&straight);
    assert_eq!(circle(&found), None, "{found:?}");
    assert_eq!(circle(&rooms(&found)), None);
    assert!(found["lib.rs"].is_empty() && found["a/deep.rs"].is_empty() && found["b.rs"].is_empty());
    assert!(edge(&found, "a.rs", "b.rs"), "{found:?}");
    // A name that a file hands on from another package is in no file here.
    assert!(found["f.rs"].is_empty(), "{found:?}");
    // Through the re-export of `a.rs`, and by the name that the module goes by there.
    assert!(edge(&found, "c.rs", "a/deep.rs") && edge(&found, "c.rs", "b.rs"), "{found:?}");
    assert!(!edge(&found, "c.rs", "a.rs"), "{found:?}");
    // Within a macro, through a glob, by the name of the package.
    assert!(edge(&found, "d.rs", "c.rs") && edge(&found, "main.rs", "a/deep.rs"), "{found:?}");
    assert_eq!(found["e.rs"].iter().collect::<Vec<_>>(), ["a.rs"]);

    // Through a `use`, a re-export, a path in the code, the parent, a nested module, a trait's path, an attribute.
    for planted in [
        "use crate::a::A;",
        "use crate::A;",
        "fn f(_: crate::a::A) {}",
        "use super::{a::A as X};",
        "mod inner { use super::super::A; }",
        "impl From<imagined::A> for u8 {}",
        "#[arg(default_value_t = crate::A::new())] fn f() {}",
    ] {
        let mut files = straight;
        let text = format!("{planted} pub struct B;");
        files[3].1 = &text;
        let way = circle(&imagined(&files)).unwrap_or_else(|| panic!("{planted} was not seen"));
        assert_eq!(way, ["a.rs", "b.rs"], "{planted}");
    }

    // Files in no circle whose rooms are in one.
    let crossed = imagined(&[
        ("a/one.rs", "use crate::b::two::Two;"),
        ("b/two.rs", "pub struct Two;"),
        ("b/three.rs", "use crate::a::four::Four;"),
        ("a/four.rs", "pub struct Four;"),
    ]);
    assert_eq!(circle(&crossed), None);
    assert_eq!(circle(&rooms(&crossed)).map(|way| way.len()), Some(2));
    let family = imagined(&[
        ("a.rs", "mod b; use b::B; struct A;"),
        ("a/b.rs", "use super::A; use crate::c::C; pub struct B;"),
        ("c.rs", "pub struct C;"),
    ]);
    assert_eq!(circle(&family).map(|way| way.len()), Some(2));
    assert_eq!(circle(&without_parents(&family)), None);
    assert!(edge(&without_parents(&family), "a/b.rs", "c.rs"));
    assert_eq!(floors(&rooms(&without_parents(&family))), 2);
}

#[test]
fn imports_go_in_no_circle_and_where_the_rooms_say() {
    for package in PACKAGES {
        let files = package.files();
        assert!(!files.is_empty(), "{}: no files", package.folder);
        let graph = package.graph(&files);
        for [from, to] in package.known {
            let found = &graph[*from];
            assert!(found.contains(*to), "{}: {from} imports {to}, was read as {found:?}", package.folder);
        }
        assert_eq!(circle(&graph), None, "{}: files", package.folder);
        let rooms = rooms(&graph);
        assert_eq!(circle(&rooms), None, "{}: rooms", package.folder);
        // A room that says at its door where its imports may go keeps to it.
        for (room, targets) in &rooms {
            let Some(door) = files.iter().find(|file| file.place == format!("{room}.rs")) else { continue };
            let Some(may) = may_import(&door.head) else { continue };
            let strays: Vec<_> = targets.iter().filter(|target| !may.contains(*target)).collect();
            assert!(strays.is_empty(), "{}: {room} may not import {strays:?}", package.folder);
            let idle: Vec<_> = may.iter().filter(|room| !targets.contains(*room)).collect();
            assert!(idle.is_empty(), "{}: {room} imports nothing of {idle:?}", package.folder);
        }
    }
}

#[test]
fn the_doors_of_core_and_of_the_renderer_say_where_imports_may_go() {
    for (folder, names) in [
        ("core", &["simd", "zonal", "lobe", "material", "mixture", "kernel", "environment"][..]),
        ("reference-renderer", &["show", "study", "trace", "shade", "world", "truth", "numbers", "out"]),
    ] {
        let package = PACKAGES.iter().find(|package| package.folder == folder).expect("a package");
        let files = package.files();
        for room in names {
            let door = files.iter().find(|file| file.place == format!("{room}.rs")).expect("a room");
            assert!(may_import(&door.head).is_some(), "{folder}: {room}.rs does not list its imports");
        }
        let rooms = rooms(&package.graph(&files));
        match folder {
            // An optional room is imported by no other.
            "core" => {
                let users: Vec<_> = rooms.iter().filter(|(_, to)| to.contains("environment")).collect();
                assert!(users.is_empty(), "{users:?}");
            }
            _ => {
                let count = rooms.keys().filter(|room| !["main", "lib"].contains(&room.as_str())).count();
                assert!(count <= 10 && floors(&rooms) <= 7, "{count} rooms on {} floors", floors(&rooms));
            }
        }
    }
}
