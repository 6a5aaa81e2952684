//! The source of a package, parsed: its modules, the names that they define, and the paths in them.

use proc_macro2::{TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use syn::visit::Visit;
use syn::{Attribute, Item, UseTree, Visibility};

/// A module path: names from the root of the package on.
type Module = Vec<String>;

/// A file of a package.
pub struct File {
    /// Its place in `src`.
    pub place: String,
    /// The text of the documentation at its head.
    pub head: String,
    /// The module that it is, and those within it.
    modules: BTreeMap<Module, Names>,
    /// Modules that it declares and other files hold, without those of unit tests: their places and paths.
    children: Vec<(String, Module)>,
}

/// The items of a module.
#[derive(Default)]
struct Names {
    /// Its definitions.
    items: BTreeSet<String>,
    /// Types and traits among them.
    types: BTreeSet<String>,
    /// Macros that it defines at the root of the package.
    macros: BTreeSet<String>,
    /// Local names, and the paths that they stand for; a glob is `*`.
    imports: Vec<(String, Module)>,
    /// Names that it hands on.
    exports: Vec<(String, Module)>,
    /// Every path in its code.
    paths: BTreeSet<Module>,
}

/// Whether an item is compiled for unit tests alone.
fn is_for_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("cfg")
            && attribute.meta.require_list().is_ok_and(|list| {
                let text = list.tokens.to_string();
                text == "test" || text.starts_with("all (test") || text.starts_with("all(test")
            })
    })
}

/// Collects the paths of the code of one module.
struct Paths<'a>(&'a mut BTreeSet<Module>);

impl Paths<'_> {
    /// The paths in text that is not parsed: the arguments of macros and attributes.
    fn in_tokens(&mut self, tokens: TokenStream) {
        let mut path: Module = Vec::new();
        // Colons since the last name.
        let mut colons = 0;
        for token in tokens {
            match token {
                TokenTree::Ident(name) => {
                    if colons != 2 {
                        self.0.extend((!path.is_empty()).then(|| std::mem::take(&mut path)));
                        path.clear();
                    }
                    path.push(name.to_string());
                    colons = 0;
                }
                TokenTree::Punct(sign) if sign.as_char() == ':' => colons += 1,
                other => {
                    self.0.extend((!path.is_empty()).then(|| std::mem::take(&mut path)));
                    colons = 0;
                    if let TokenTree::Group(group) = other {
                        self.in_tokens(group.stream());
                    }
                }
            }
        }
        self.0.extend((!path.is_empty()).then_some(path));
    }
}

impl<'ast> Visit<'ast> for Paths<'_> {
    fn visit_path(&mut self, path: &'ast syn::Path) {
        // One that begins with `::` is of another package.
        if path.leading_colon.is_none() {
            self.0.insert(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        }
        syn::visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, of: &'ast syn::Macro) {
        self.in_tokens(of.tokens.clone());
        syn::visit::visit_macro(self, of);
    }

    fn visit_attribute(&mut self, attribute: &'ast Attribute) {
        if let syn::Meta::List(list) = &attribute.meta {
            self.in_tokens(list.tokens.clone());
        }
        syn::visit::visit_attribute(self, attribute);
    }

    fn visit_item_use(&mut self, _: &'ast syn::ItemUse) {}
}

/// The local names and paths of the tree of a `use`.
fn flatten(tree: &UseTree, prefix: &[String], found: &mut Vec<(String, Module)>) {
    let with = |name: String| prefix.iter().cloned().chain([name]).collect::<Module>();
    // `a::{self}` is `a`.
    let whole =
        |name: String| if name == "self" && !prefix.is_empty() { prefix.to_vec() } else { with(name) };
    match tree {
        UseTree::Path(path) => flatten(&path.tree, &with(path.ident.to_string()), found),
        UseTree::Name(name) => {
            let path = whole(name.ident.to_string());
            found.push((path.last().expect("a name").clone(), path));
        }
        UseTree::Rename(name) => found.push((name.rename.to_string(), whole(name.ident.to_string()))),
        UseTree::Glob(_) => found.push(("*".to_owned(), prefix.to_vec())),
        UseTree::Group(group) => group.items.iter().for_each(|tree| flatten(tree, prefix, found)),
    }
}

/// The name that an item defines.
fn defined(item: &Item) -> Option<String> {
    Some(match item {
        Item::Const(item) => item.ident.to_string(),
        Item::Enum(item) => item.ident.to_string(),
        Item::Fn(item) => item.sig.ident.to_string(),
        Item::Static(item) => item.ident.to_string(),
        Item::Struct(item) => item.ident.to_string(),
        Item::Trait(item) => item.ident.to_string(),
        Item::Type(item) => item.ident.to_string(),
        Item::Union(item) => item.ident.to_string(),
        Item::Macro(item) => item.ident.as_ref()?.to_string(),
        _ => return None,
    })
}

/// The attributes of an item.
fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::ExternCrate(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::ForeignMod(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::TraitAlias(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Union(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

impl File {
    /// Parses a file whose module follows from its place in `src`; `package` is the name of the package in code.
    pub fn new(place: &str, text: &str, package: &str) -> Self {
        let stem = place.trim_end_matches(".rs");
        Self::of_module(
            place,
            stem.split('/').filter(|s| *s != "lib").map(str::to_owned).collect(),
            text,
            package,
        )
    }

    /// Parses the file of a module.
    fn of_module(place: &str, module: Module, text: &str, package: &str) -> Self {
        let parsed = syn::parse_file(text).unwrap_or_else(|error| panic!("{place}: {error}"));
        let doc = parsed.attrs.iter().filter(|attribute| attribute.path().is_ident("doc"));
        let head = doc.filter_map(|attribute| {
            let syn::Expr::Lit(line) = &attribute.meta.require_name_value().ok()?.value else { return None };
            let syn::Lit::Str(line) = &line.lit else { return None };
            Some(line.value())
        });
        let mut file = Self {
            place: place.to_owned(),
            head: head.collect::<Vec<_>>().join(" "),
            modules: BTreeMap::new(),
            children: Vec::new(),
        };
        file.take(&module, &parsed.items);
        // The package's own name is the root.
        for names in file.modules.values_mut() {
            let root = |path: &Module| -> Module {
                let own = path.first().is_some_and(|first| first == package);
                path.iter()
                    .enumerate()
                    .map(|(n, s)| if n == 0 && own { "crate" } else { s }.to_owned())
                    .collect()
            };
            names.imports.iter_mut().chain(&mut names.exports).for_each(|(_, path)| *path = root(path));
            names.paths = names.paths.iter().map(root).collect();
        }
        file
    }

    /// The names of the types and traits that it defines.
    pub fn types(&self) -> impl Iterator<Item = &String> {
        self.modules.values().flat_map(|names| &names.types)
    }

    /// The place of the file of a module that is declared here.
    fn place_of(&self, module: &syn::ItemMod) -> String {
        let stem = self.place.trim_end_matches(".rs");
        let folder = stem.rsplit_once('/').map_or(String::new(), |(folder, _)| format!("{folder}/"));
        let named = module.attrs.iter().filter(|attribute| attribute.path().is_ident("path"));
        for attribute in named {
            if let syn::Expr::Lit(path) = &attribute.meta.require_name_value().expect("path = \"...\"").value
                && let syn::Lit::Str(path) = &path.lit
            {
                return format!("{folder}{}", path.value());
            }
        }
        let is_root = ["lib", "main"].contains(&stem);
        let prefix = if is_root { String::new() } else { format!("{stem}/") };
        format!("{prefix}{}.rs", module.ident)
    }

    /// Takes in the items of a module.
    fn take(&mut self, module: &Module, items: &[Item]) {
        let mut names = Names::default();
        for item in items.iter().filter(|item| !is_for_tests(attributes(item))) {
            match item {
                Item::Mod(inner) => {
                    let path: Module = module.iter().cloned().chain([inner.ident.to_string()]).collect();
                    match &inner.content {
                        None => self.children.push((self.place_of(inner), path)),
                        Some((_, items)) => self.take(&path, items),
                    }
                }
                Item::Use(line) if line.leading_colon.is_none() => {
                    let is_private = matches!(line.vis, Visibility::Inherited);
                    let found = if is_private { &mut names.imports } else { &mut names.exports };
                    flatten(&line.tree, &[], found);
                }
                item => {
                    if attributes(item).iter().any(|attribute| attribute.path().is_ident("macro_export")) {
                        names.macros.extend(defined(item));
                    }
                    let is_type = matches!(
                        item,
                        Item::Enum(_) | Item::Struct(_) | Item::Trait(_) | Item::Type(_) | Item::Union(_)
                    );
                    names.types.extend(defined(item).filter(|_| is_type));
                    names.items.extend(defined(item));
                    Paths(&mut names.paths).visit_item(item);
                }
            }
        }
        self.modules.insert(module.clone(), names);
    }
}

/// The modules of a package, with the place of the file of each.
type Modules<'a> = BTreeMap<&'a [String], (&'a str, &'a Names)>;

/// The absolute path that a path in a module stands for, if it is one of the package.
fn absolute(path: &[String], module: &[String], modules: &Modules<'_>) -> Option<Module> {
    let mut base = module.to_vec();
    let mut rest = path;
    match path.first()?.as_str() {
        "crate" => (base, rest) = (Vec::new(), &path[1..]),
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
            modules.get(&base[..])?;
            rest = &path[1..];
        }
    }
    base.extend(rest.iter().cloned());
    Some(base)
}

/// The file that defines what an absolute path names, through what hands it on; `None` where no file is found to.
fn defining<'a>(path: &[String], modules: &Modules<'a>, depth: usize) -> Option<&'a str> {
    let length = (0..=path.len()).rev().find(|n| modules.contains_key(&path[..*n]))?;
    let (module, (place, names)) = (&path[..length], modules[&path[..length]]);
    let item = path.get(length)?;
    if names.items.contains(item) {
        return Some(place);
    }
    if depth == 8 {
        return None;
    }
    if module.is_empty() {
        let exported = modules.values().find(|(_, names)| names.macros.contains(item));
        if let Some((place, _)) = exported {
            return Some(place);
        }
    }
    let handed_on = names.exports.iter().chain(&names.imports);
    handed_on.filter(|(name, _)| name == item || name == "*").find_map(|(name, target)| {
        let mut target = absolute(target, module, modules)?;
        target.extend(path[if name == "*" { length } else { length + 1 }..].iter().cloned());
        // A glob of the module itself leads nowhere.
        (target != path).then(|| defining(&target, modules, depth + 1))?
    })
}

/// The file of the module that an absolute path names something in: macros define names that no item shows.
fn holding<'a>(path: &[String], modules: &Modules<'a>) -> Option<&'a str> {
    let length = (0..path.len()).rev().find(|n| modules.contains_key(&path[..*n]))?;
    let (place, names) = modules[&path[..length]];
    // A name of another package, which this one hands on, is in no file here.
    let is_foreign = names
        .exports
        .iter()
        .any(|(name, target)| *name == path[length] && absolute(target, &path[..length], modules).is_none());
    (!modules.contains_key(path) && !is_foreign).then_some(place)
}

/// Which file imports from which.
pub fn graph(files: &[File]) -> BTreeMap<String, BTreeSet<String>> {
    let modules: Modules<'_> = files
        .iter()
        .flat_map(|file| file.modules.iter().map(|(path, names)| (&path[..], (&file.place[..], names))))
        .collect();
    let mut graph: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (module, (place, names)) in &modules {
        let (mut targets, mut perhaps): (Vec<Module>, Vec<Module>) = (Vec::new(), Vec::new());
        let starts: BTreeSet<&String> = names.paths.iter().filter_map(|path| path.first()).collect();
        let used = names.exports.iter().filter(|(name, _)| starts.contains(name));
        for (name, path) in names.imports.iter().chain(used) {
            let Some(path) = absolute(path, module, &modules) else { continue };
            if name == "*" {
                // Names of this module that the other one may give.
                let open = names.paths.iter().filter(|inside| !names.items.contains(&inside[0]));
                perhaps.extend(open.map(|inside| [&path[..], &inside[..]].concat()));
                continue;
            }
            // Items that are reached through an imported module.
            for inside in names.paths.iter().filter(|inside| inside[0] == *name && inside.len() > 1) {
                targets.push([&path[..], &inside[1..]].concat());
            }
            targets.push(path);
        }
        targets.extend(names.paths.iter().filter_map(|path| absolute(path, module, &modules)));
        let edges = graph.entry((*place).to_owned()).or_default();
        let known = targets.iter().filter_map(|path| defining(path, &modules, 0).or(holding(path, &modules)));
        let found = known.chain(perhaps.iter().filter_map(|path| defining(path, &modules, 0)));
        edges.extend(found.map(str::to_owned));
        edges.remove(*place);
    }
    graph
}

/// The parsed files of a package, from the roots in its `src` on, without those that are unit tests.
pub fn read(folder: &Path) -> Vec<File> {
    let manifest = std::fs::read_to_string(folder.join("Cargo.toml")).expect("a manifest");
    // The name of a library of its own, or that of the package.
    let name = |section: &str| {
        let (_, rest) = manifest.split_once(section)?;
        let section = rest.split("\n[").next()?;
        let line = section.lines().find_map(|line| line.strip_prefix("name = "))?;
        Some(line.trim_matches('"').replace('-', "_"))
    };
    let package = name("[lib]").or_else(|| name("[package]")).expect("a name");
    let src = folder.join("src");
    // The root of a library, or of a program that has none.
    let door = if src.join("lib.rs").exists() { "lib" } else { "main" };
    let root = |place: String| {
        let module =
            place.trim_end_matches(".rs").split('/').filter(|s| *s != door).map(str::to_owned).collect();
        (place, module)
    };
    let mut open: Vec<(String, Module)> = ["lib.rs", "main.rs"].map(|place| root(place.to_owned())).to_vec();
    for entry in src.join("bin").read_dir().into_iter().flatten() {
        open.push(root(format!("bin/{}", entry.expect("an entry").file_name().to_string_lossy())));
    }
    open.retain(|(place, _)| place.ends_with(".rs") && src.join(place).exists());
    let mut files: Vec<File> = Vec::new();
    while let Some((place, module)) = open.pop() {
        let text =
            std::fs::read_to_string(src.join(&place)).unwrap_or_else(|error| panic!("{place}: {error}"));
        let mut file = File::of_module(&place, module, &text, &package);
        open.append(&mut file.children);
        files.push(file);
    }
    files
}
