//! The files of `core` and of `fit` import each other in no circle, and the rooms of `core` neither.
//!
//! An import is a `use` of something of the crate, or a path to it in the code: `crate::`, `super::`,
//! `self::`, or the name of a module that is a child or was imported. A name is followed through re-exports
//! to the file that defines it: a file that only re-exports, as `lib.rs` does, imports nothing. In `fit` a
//! file may also take from the one whose folder it is in. Methods of one type that stand in several files are
//! calls without a path, which no text shows.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A module path: names from the root of the crate on.
type Module = Vec<String>;

/// Which file imports from which.
type Graph = BTreeMap<String, BTreeSet<String>>;

/// The code of one file, comments, strings and tests taken out, and what its `use` lines say.
struct File {
    name: String,
    /// Everything but `use` statements.
    code: String,
    /// Local names, and the paths that they stand for; a glob is `*`.
    imports: Vec<(String, Module)>,
    /// Names that it hands on.
    exports: Vec<(String, Module)>,
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The code without comments, and with strings emptied.
fn without_comments(text: &str) -> String {
    let mut code = String::new();
    for line in text.lines() {
        let mut rest = line;
        while let Some(at) = rest.find(['"', '/']) {
            code.push_str(&rest[..at]);
            rest = &rest[at..];
            if rest.starts_with("//") {
                rest = "";
            } else if let Some(string) = rest.strip_prefix('"') {
                // What ends behind the line leaves the next lines as code, of which a path is no part.
                let end = string.replace("\\\"", "__").find('"').map_or(string.len(), |end| end + 1);
                rest = &string[end..];
            } else {
                code.push('/');
                rest = &rest[1..];
            }
        }
        code.push_str(rest);
        code.push('\n');
    }
    code
}

/// Leaves out what is compiled for unit tests alone: an item behind `#[cfg(test)]`.
fn without_tests(code: &str) -> String {
    let mut kept = String::new();
    let mut rest = code;
    while let Some(at) = rest.find("#[cfg(test)]") {
        kept.push_str(&rest[..at]);
        rest = &rest[at..];
        let mut depth = 0;
        let end = rest["#[cfg(test)]".len()..].char_indices().find(|&(_, c)| {
            depth += i32::from(c == '{') - i32::from(c == '}');
            depth == 0 && (c == '}' || c == ';')
        });
        rest = end.map_or("", |(end, _)| &rest["#[cfg(test)]".len() + end + 1..]);
    }
    kept + rest
}

/// The local names and paths of the tree of a `use`.
fn flatten(tree: &str, prefix: &[&str], found: &mut Vec<(String, Vec<String>)>) {
    let tree = tree.trim();
    if let Some(open) = tree.find('{') {
        let path = tree[..open].split("::").map(str::trim).filter(|s| !s.is_empty());
        let prefix: Vec<&str> = prefix.iter().copied().chain(path).collect();
        let inside = &tree[open + 1..tree.rfind('}').unwrap_or(tree.len())];
        let (mut depth, mut from) = (0, 0);
        for (at, c) in inside.char_indices().chain([(inside.len(), ',')]) {
            depth += i32::from(c == '{') - i32::from(c == '}');
            if c == ',' && depth == 0 {
                flatten(&inside[from..at], &prefix, found);
                from = at + 1;
            }
        }
    } else if !tree.is_empty() {
        let (path, alias) = tree.split_once(" as ").map_or((tree, None), |(p, a)| (p, Some(a.trim())));
        let mut path: Vec<&str> = prefix.iter().copied().chain(path.split("::").map(str::trim)).collect();
        if path.last() == Some(&"self") {
            path.pop();
        }
        let Some(&last) = path.last() else { return };
        found.push((alias.unwrap_or(last).to_owned(), path.iter().map(|s| s.to_string()).collect()));
    }
}

/// The absolute module path that a path in a module stands for, if it is one of the crate.
fn absolute(path: &[String], module: &[String], modules: &BTreeMap<Module, File>) -> Option<Module> {
    let mut base = module.to_vec();
    let mut rest = path;
    match path.first()?.as_str() {
        "crate" | "$crate" => (base, rest) = (Vec::new(), &path[1..]),
        "self" => rest = &path[1..],
        "super" => {
            while rest.first().is_some_and(|s| s == "super") {
                base.pop();
                rest = &rest[1..];
            }
        }
        first => {
            // A child.
            base.push(first.to_owned());
            modules.get(&base)?;
            rest = &path[1..];
        }
    }
    base.extend(rest.iter().cloned());
    Some(base)
}

/// The file that defines what an absolute path names, through the re-exports that hand it on; `None` for a
/// module as such.
fn defining<'a>(path: &[String], modules: &'a BTreeMap<Module, File>, depth: usize) -> Option<&'a str> {
    let length = (0..=path.len()).rev().find(|n| modules.contains_key(&path[..*n]))?;
    let (module, file) = (&path[..length], &modules[&path[..length]]);
    let item = path.get(length)?;
    for (name, target) in file.exports.iter().filter(|_| depth < 8) {
        if name == item
            && let Some(mut target) = absolute(target, module, modules)
        {
            target.extend(path[length + 1..].iter().cloned());
            return defining(&target, modules, depth + 1);
        }
    }
    Some(&file.name)
}

/// Reads what a file says.
fn file(name: &str, text: &str) -> File {
    let code = without_tests(&without_comments(text));
    let (mut kept, mut imports, mut exports) = (String::new(), Vec::new(), Vec::new());
    let mut rest = code.as_str();
    let begins = |code: &str| {
        code.match_indices("use ").map(|(at, _)| at).find(|&at| {
            let before = code[..at].rsplit(['\n', ';']).next().unwrap_or("").trim();
            before.is_empty() || before == "pub" || before.starts_with("pub(") && before.ends_with(')')
        })
    };
    while let Some(at) = begins(rest) {
        let end = rest[at..].find(';').map_or(rest.len(), |end| at + end);
        let is_handed_on = rest[..at].trim_end().ends_with(['b', ')'])
            && rest[..at].rsplit('\n').next().is_some_and(|line| line.trim_start().starts_with("pub"));
        kept.push_str(rest[..at].trim_end_matches(|c: char| c != '\n' && c != ';'));
        flatten(&rest[at + "use ".len()..end], &[], if is_handed_on { &mut exports } else { &mut imports });
        rest = &rest[(end + 1).min(rest.len())..];
    }
    kept.push_str(rest);
    File { name: name.to_owned(), code: kept, imports, exports }
}

/// Every path of at least two names in the code.
fn paths(code: &str) -> BTreeSet<Vec<String>> {
    code.split(|c: char| !(is_word(c) || c == ':' || c == '$'))
        .filter(|word| word.contains("::"))
        .map(|word| word.split("::").map(str::to_owned).filter(|s| !s.is_empty()).collect::<Vec<_>>())
        .filter(|path| path.len() > 1)
        .collect()
}

/// Which file imports from which, of the files of a crate by their places in its `src`, with their text.
fn graph(sources: &[(String, String)]) -> Graph {
    let modules: BTreeMap<Module, File> = sources
        .iter()
        .map(|(place, text)| {
            let stem = place.trim_end_matches(".rs").trim_end_matches("/mod");
            let path = stem.split('/').filter(|s| *s != "lib").map(str::to_owned).collect();
            (path, file(place, text))
        })
        .collect();
    let mut graph = Graph::new();
    for (module, file) in &modules {
        let words: BTreeSet<&str> = file.code.split(|c| !is_word(c)).collect();
        let handed_on = file.exports.iter().filter(|(name, _)| words.contains(name.as_str()));
        let mut targets: Vec<Module> = Vec::new();
        for (name, path) in file.imports.iter().chain(handed_on) {
            if name == "*" {
                // All of a module: the item has no name of its own.
                targets.extend(absolute(path, module, &modules));
                continue;
            }
            targets.extend(absolute(path, module, &modules));
            // What is reached through an imported module.
            for inside in paths(&file.code).iter().filter(|inside| inside[0] == *name) {
                let whole: Vec<String> = path.iter().chain(&inside[1..]).cloned().collect();
                targets.extend(absolute(&whole, module, &modules));
            }
        }
        targets.extend(paths(&file.code).iter().filter_map(|path| absolute(path, module, &modules)));
        let edges = graph.entry(file.name.clone()).or_default();
        edges.extend(targets.iter().filter_map(|path| defining(path, &modules, 0)).map(str::to_owned));
        edges.remove(&file.name);
    }
    graph
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

/// The rooms that the head of a file names behind `May import:`, to the end of the sentence.
fn may_import(text: &str) -> Option<BTreeSet<String>> {
    let head: String = text.lines().map_while(|line| line.strip_prefix("//!")).collect::<Vec<_>>().join(" ");
    let (_, list) = head.split_once("May import:")?;
    let list = list.split(['.', ';']).next()?;
    Some(list.split('`').skip(1).step_by(2).map(str::to_owned).collect())
}

/// Without what a file takes from the one whose folder it is in: those two are one text in two files.
fn without_parents(graph: &Graph) -> Graph {
    let is_parent = |child: &str, of: &str| child.starts_with(&format!("{}/", of.trim_end_matches(".rs")));
    let others = |child: &String, all: &BTreeSet<String>| {
        all.iter().filter(|parent| !is_parent(child, parent)).cloned().collect()
    };
    graph.iter().map(|(file, targets)| (file.clone(), others(file, targets))).collect()
}

/// The sources of a crate of this repository, without files that are tests.
fn sources(of: &str) -> Vec<(String, String)> {
    fn walk(folder: &Path, prefix: &str, found: &mut Vec<(String, String)>) {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            let name = path.file_name().and_then(|n| n.to_str()).expect("a name").to_owned();
            if path.is_dir() {
                walk(&path, &format!("{prefix}{name}/"), found);
            } else if name.ends_with(".rs") && name != "tests.rs" {
                found.push((format!("{prefix}{name}"), std::fs::read_to_string(&path).expect("a text")));
            }
        }
    }
    let mut found = Vec::new();
    walk(&Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(of).join("src"), "", &mut found);
    found
}

/// A crate of given files.
fn imagined(files: &[(&str, &str)]) -> Graph {
    graph(&files.iter().map(|(name, text)| (name.to_string(), text.to_string())).collect::<Vec<_>>())
}

#[test]
fn a_planted_circle_is_found() {
    let edge = |graph: &Graph, from: &str, to: &str| graph[from].contains(to);

    let straight = [
        ("lib.rs", "mod a; mod b;\npub use a::{A, deep::Deep};\npub use b::B;"),
        ("a.rs", "pub mod deep;\npub(crate) use deep::Low;\nuse crate::B;\npub struct A(B);"),
        (
            "a/deep.rs",
            "pub struct Deep; pub struct Low;\n#[cfg(test)]\nmod tests { use super::super::A; }\n// crate::A",
        ),
        ("b.rs", "use core::fmt;\npub struct B;"),
        ("c.rs", "use crate::{a as first, b};\nfn f() { first::Low; b::B }"),
    ];
    let found = imagined(&straight);
    assert_eq!(circle(&found), None, "{found:?}");
    assert_eq!(circle(&rooms(&found)), None);
    assert!(found["lib.rs"].is_empty() && found["a/deep.rs"].is_empty() && found["b.rs"].is_empty());
    assert!(edge(&found, "a.rs", "b.rs"), "{found:?}");
    // Through the re-export of `a.rs`, and by the name that the module goes by there.
    assert!(edge(&found, "c.rs", "a/deep.rs") && edge(&found, "c.rs", "b.rs"), "{found:?}");
    assert!(!edge(&found, "c.rs", "a.rs"), "{found:?}");

    // Through a `use`, through a re-export, through a path in the code, and through the parent.
    for planted in ["use crate::a::A;", "use crate::A;", "fn f(_: crate::a::A) {}", "use super::{a::A as X};"]
    {
        let mut files = straight;
        files[3].1 = planted;
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
    let family =
        imagined(&[("a.rs", "mod b; use b::B;"), ("a/b.rs", "use super::A; use crate::c::C;"), ("c.rs", "")]);
    assert_eq!(circle(&family).map(|way| way.len()), Some(2));
    assert_eq!(circle(&without_parents(&family)), None);
    assert!(edge(&without_parents(&family), "a/b.rs", "c.rs"));
    assert_eq!(circle(&rooms(&crossed)).map(|way| way.len()), Some(2));
}

#[test]
fn imports_of_core_go_in_no_circle_and_where_the_rooms_say() {
    let sources = sources("core");
    let graph = graph(&sources);
    // What must be there, if the text was understood.
    for (from, to) in [
        ("kernel/prepare.rs", "kernel/between_views.rs"),
        ("mixture/rows.rs", "mixture/factors.rs"),
        ("zonal/folded.rs", "squeeze.rs"),
        ("simd/dispatch.rs", "simd/portable.rs"),
        ("lobe/gaussian.rs", "special.rs"),
    ] {
        assert!(graph[from].contains(to), "{from} imports {to}, was read as {:?}", graph[from]);
    }
    assert_eq!(circle(&graph), None);
    assert_eq!(circle(&rooms(&graph)), None);
    // Every room says at its door where its imports may go.
    for (room, targets) in rooms(&graph) {
        let Some((_, door)) = sources.iter().find(|(place, _)| *place == format!("{room}.rs")) else {
            continue;
        };
        let Some(may) = may_import(door) else { continue };
        let strays: Vec<_> = targets.iter().filter(|target| !may.contains(*target)).collect();
        assert!(strays.is_empty(), "{room} may not import {strays:?}");
        let idle: Vec<_> = may.iter().filter(|room| !targets.contains(*room)).collect();
        assert!(idle.is_empty(), "{room} imports nothing of {idle:?}, which it names");
    }
    for room in ["simd", "zonal", "lobe", "material", "mixture", "kernel"] {
        let (_, door) = sources.iter().find(|(place, _)| *place == format!("{room}.rs")).expect("a room");
        assert!(may_import(door).is_some(), "{room}.rs does not say what may be imported");
    }
}

#[test]
fn imports_of_fit_go_in_no_circle() {
    let graph = graph(&sources("fit"));
    assert!(graph["fit.rs"].contains("fewest_lobes.rs"), "{:?}", graph["fit.rs"]);
    assert_eq!(circle(&without_parents(&graph)), None);
}
