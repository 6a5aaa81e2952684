//! Every public function of `core` has an oracle: a file of this package that compares it with something else. A new
//! public function fails here until it is listed, and a file that does not call it fails too.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use syn::{Attribute, ImplItem, Item, TraitItem, Type, UseTree, Visibility};

/// Function, and the file that holds its oracle. `Type::name` for methods, the bare name for functions.
const ORACLES: &[(&str, &str)] = &[
    ("Material::grid_turns", "tests/anisotropic.rs"),
    ("Blend::ask", "tests/blends.rs"),
    ("Blend::ask_each", "tests/blends.rs"),
    ("Blend::albedo", "tests/blends.rs"),
    ("Blend::choose", "tests/blends.rs"),
    ("Blend::evaluate", "tests/blends.rs"),
    ("Blend::evaluate_and_pdf", "tests/blends.rs"),
    ("Blend::new", "tests/blends.rs"),
    ("Blend::pdf", "tests/blends.rs"),
    ("Blend::sample", "tests/blends.rs"),
    ("Blend::sample_and_evaluate", "tests/blends.rs"),
    ("BlendPart::coated", "tests/blends.rs"),
    ("BlendPart::new", "tests/blends.rs"),
    ("BlendPart::of_mixture", "tests/blends.rs"),
    ("BlendPart::tint", "tests/blends.rs"),
    ("BlendPart::tinted", "tests/blends.rs"),
    ("BlendPart::weight", "tests/blends.rs"),
    ("fresnel", "tests/blends.rs"),
    ("Quarter::is_back", "tests/sheets.rs"),
    ("Quarter::is_transmission", "tests/sheets.rs"),
    ("Sheet::ask", "tests/sheets.rs"),
    ("Sheet::bytes", "tests/sheets.rs"),
    ("Sheet::encode", "tests/sheets.rs"),
    ("Sheet::encoded_len", "tests/sheets.rs"),
    ("Sheet::evaluate", "tests/sheets.rs"),
    ("Sheet::evaluate_and_pdf", "tests/sheets.rs"),
    ("Sheet::from_bytes", "tests/sheets.rs"),
    ("Sheet::is_symmetric", "tests/sheets.rs"),
    ("Sheet::lobe_count", "tests/sheets.rs"),
    ("Sheet::pdf", "tests/sheets.rs"),
    ("Sheet::prepare", "tests/sheets.rs"),
    ("Sheet::provenance", "tests/sheets.rs"),
    ("Sheet::quarter", "tests/sheets.rs"),
    ("Sheet::reflected_share", "tests/sheets.rs"),
    ("Sheet::sample", "tests/sheets.rs"),
    ("Sheet::sample_and_evaluate", "tests/sheets.rs"),
    ("SheetMixture::albedos", "tests/sheets.rs"),
    ("SheetMixture::empty", "tests/sheets.rs"),
    ("SheetMixture::evaluate_and_pdf", "tests/sheets.rs"),
    ("SheetMixture::half", "tests/sheets.rs"),
    ("SheetMixture::sample", "tests/sheets.rs"),
    ("sphere_integral", "src/reference.rs"),
    ("cap_integral", "src/reference.rs"),
    ("share_within", "src/reference.rs"),
    ("one_minus_cos", "src/reference.rs"),
    ("share_below_horizon_bound", "tests/extremes.rs"),
    ("bessel_i0_scaled", "src/reference.rs"),
    ("mean_cosine", "src/reference.rs"),
    ("luminance", "tests/estimators.rs"),
    ("power_heuristic", "tests/estimators.rs"),
    ("legendre_coefficients_into", "tests/estimators.rs"),
    ("legendre_series", "tests/estimators.rs"),
    ("legendre_singular_integral", "tests/estimators.rs"),
    ("gaussian_coefficients_into", "src/reference.rs"),
    ("abel_poisson_coefficients_into", "src/reference.rs"),
    ("Expanded::ask", "tests/verbs/main.rs"),
    ("Expanded::check", "tests/expanded.rs"),
    ("Expanded::material", "tests/expanded.rs"),
    ("Expanded::new", "tests/expanded.rs"),
    ("Expanded::prepare", "tests/expanded.rs"),
    ("Material::expanded_len", "tests/expanded.rs"),
    ("environment_len", "tests/environment/map.rs"),
    ("Environment::new", "tests/environment/map.rs"),
    ("Environment::from_table", "tests/environment/map.rs"),
    ("Environment::turned", "tests/environment/map.rs"),
    ("Environment::table", "tests/environment/map.rs"),
    ("Environment::width", "tests/environment/map.rs"),
    ("Environment::height", "tests/environment/map.rs"),
    ("Environment::power", "tests/environment/map.rs"),
    ("Environment::radiance", "tests/environment/map.rs"),
    ("Environment::pdf", "tests/environment/map.rs"),
    ("Environment::prefetch", "tests/environment/map.rs"),
    ("Environment::radiance_and_pdf", "tests/environment/map.rs"),
    ("Environment::sample", "tests/environment/map.rs"),
    ("Environment::cell", "tests/environment/map.rs"),
    ("Environment::cell_count", "tests/environment/map.rs"),
    ("ProductSampling::new", "tests/environment/product.rs"),
    ("ProductSampling::candidates", "tests/environment/product.rs"),
    ("ProductSampling::lobe_candidates", "tests/environment/product.rs"),
    ("ProductSampling::ray_weight", "tests/environment/product.rs"),
    ("AnyMixture::sample_product", "tests/environment/product.rs"),
    ("Environment::sample_cell", "tests/environment/reflect.rs"),
    ("Environment::prefetch_cell", "tests/environment/reflect.rs"),
    ("LightBlock::new", "tests/environment/reflect.rs"),
    ("LightSource::sample_into", "tests/environment/any.rs"),
    ("LightSource::evaluate_into", "tests/environment/any.rs"),
    ("LightSource::environment", "tests/environment/any.rs"),
    ("LightBlock::of", "tests/environment/reflect.rs"),
    ("LightBlock::prefetch", "tests/environment/reflect.rs"),
    ("AnyMixture::reflect", "tests/environment/reflect.rs"),
    ("Reflection::light_from", "tests/environment/any.rs"),
    ("Reflection::light", "tests/environment/reflect.rs"),
    ("Reflection::light_of", "tests/environment/reflect.rs"),
    ("encoded_len", "tests/chi_square.rs"),
    ("color_differences", "tests/agreement.rs"),
    ("Gaussian::new", "tests/extremes.rs"),
    ("Gaussian::value", "src/reference.rs"),
    ("Gaussian::integral", "tests/extremes.rs"),
    ("Gaussian::cap_integral", "tests/estimators.rs"),
    ("Gaussian::pdf", "src/reference.rs"),
    ("Gaussian::sample", "tests/sampling.rs"),
    ("Gaussian::invert_sample", "tests/properties.rs"),
    ("Gaussian::hemisphere_integral", "src/reference.rs"),
    ("Gaussian::product", "src/reference.rs"),
    ("GaussianProduct::value", "src/reference.rs"),
    ("GaussianProduct::integral", "src/reference.rs"),
    ("Lobe::new", "tests/extremes.rs"),
    ("Lobe::value", "tests/estimators.rs"),
    ("Lobe::integral", "tests/extremes.rs"),
    ("Lobe::product", "src/reference.rs"),
    ("Lobe::inner_product", "tests/estimators.rs"),
    ("Kernel::axis", "tests/properties.rs"),
    ("Kernel::value_at", "src/reference.rs"),
    ("Kernel::integral", "tests/sampling.rs"),
    ("Kernel::one_minus_cos", "src/reference.rs"),
    ("Kernel::share_within", "src/reference.rs"),
    ("Kernel::value", "tests/properties.rs"),
    ("Kernel::pdf", "tests/properties.rs"),
    ("Kernel::sample", "tests/sampling.rs"),
    ("Kernel::invert_sample", "tests/properties.rs"),
    ("Folded::new", "tests/extremes.rs"),
    ("Folded::squeezed", "src/reference.rs"),
    ("Folded::kernel", "tests/extremes.rs"),
    ("Folded::value", "src/reference.rs"),
    ("Folded::integral", "tests/sampling.rs"),
    ("Folded::pdf", "src/reference.rs"),
    ("Folded::sample", "tests/sampling.rs"),
    ("Folded::invert_sample", "tests/sampling.rs"),
    ("AbelPoisson::new", "tests/extremes.rs"),
    ("AbelPoisson::from_epsilon", "src/reference.rs"),
    ("AbelPoisson::inner_product", "src/reference.rs"),
    ("KernelTable::new", "tests/sampling.rs"),
    ("Metropolis::range", "tests/estimators.rs"),
    ("Metropolis::one_minus_cos", "tests/estimators.rs"),
    ("Metropolis::sample", "tests/estimators.rs"),
    ("Defensive::new", "tests/estimators.rs"),
    ("Defensive::pdf", "tests/estimators.rs"),
    ("Defensive::sample", "tests/estimators.rs"),
    ("Mixture::empty", "tests/extremes.rs"),
    ("Mixture::hemisphere", "tests/extremes.rs"),
    ("Mixture::sphere", "tests/estimators.rs"),
    ("Mixture::new", "src/reference.rs"),
    ("Mixture::with_diffuse", "tests/estimators.rs"),
    ("Mixture::with_level", "tests/agreement.rs"),
    ("AnyMixture::diffuse", "tests/material.rs"),
    ("AnyMixture::len", "src/oracle.rs"),
    ("AnyMixture::is_empty", "tests/material.rs"),
    ("AnyMixture::squeezed_len", "src/oracle.rs"),
    ("AnyMixture::squeeze", "src/oracle.rs"),
    ("AnyMixture::squeeze_along", "src/partition.rs"),
    ("AnyMixture::azimuth_cos_sin", "src/partition.rs"),
    ("AnyMixture::domain", "src/oracle.rs"),
    ("AnyMixture::level", "levels/src/lib.rs"),
    ("AnyMixture::is_folded", "tests/extremes.rs"),
    ("AnyMixture::lobe", "src/oracle.rs"),
    ("AnyMixture::albedo", "tests/extremes.rs"),
    ("AnyMixture::power", "tests/factors.rs"),
    ("AnyMixture::evaluate", "src/reference.rs"),
    ("AnyMixture::pdf", "src/reference.rs"),
    ("AnyMixture::evaluate_and_pdf", "tests/extremes.rs"),
    ("AnyMixture::sample", "tests/chi_square.rs"),
    ("AnyMixture::sample_direction", "levels/src/lib.rs"),
    ("LeaveOut::new", "tests/leave_out.rs"),
    ("Material::prepare_with", "tests/leave_out.rs"),
    ("AnyMixture::product_into", "tests/estimators.rs"),
    ("AnyMixture::product_len", "tests/estimators.rs"),
    ("AnyMixture::inner_product", "tests/estimators.rs"),
    ("Material::from_bytes", "tests/presets.rs"),
    ("read_file", "tests/presets.rs"),
    ("printable", "src/attack/material.rs"),
    ("printable_lines", "src/attack/material.rs"),
    ("Material::bytes", "tests/material.rs"),
    ("Material::view_count", "tests/presets.rs"),
    ("Material::lobe_count", "tests/material.rs"),
    ("Material::view_lobe_count", "tests/material.rs"),
    ("Material::squeezed_count", "tests/material.rs"),
    ("Material::mirrored_count", "tests/material.rs"),
    ("Material::provenance", "tests/material.rs"),
    ("Material::is_isotropic", "tests/anisotropic.rs"),
    ("Material::view_theta", "tests/presets.rs"),
    ("Material::view_azimuth", "tests/anisotropic.rs"),
    ("Material::view_log2_squeeze_matrix", "tests/anisotropic.rs"),
    ("Material::view_tilted_lobe", "tests/anisotropic.rs"),
    ("Grid::encoded_len", "tests/anisotropic.rs"),
    ("Line::encoded_len", "tests/material.rs"),
    ("Line::encode", "tests/material.rs"),
    ("Grid::encode", "tests/anisotropic.rs"),
    ("Material::view_log2_squeeze", "tests/material.rs"),
    ("Material::view_log2_diffuse", "tests/material.rs"),
    ("Material::view_diffuse_color_differences", "tests/material.rs"),
    ("Material::view_lobe", "tests/material.rs"),
    ("Material::factor", "tests/factors.rs"),
    ("Material::factor_len", "tests/factors.rs"),
    ("Material::factor_node", "tests/factors.rs"),
    ("Material::factor_nodes", "tests/factors.rs"),
    ("Material::has_signed_factors", "tests/factors.rs"),
    ("Material::largest_factor", "tests/factors.rs"),
    ("Material::view_albedo_difference", "tests/factors.rs"),
    ("AnyMixture::factor_bytes", "tests/factors.rs"),
    ("AnyMixture::has_factors", "tests/factors.rs"),
    ("Material::code_bits", "tests/packed.rs"),
    ("Material::has_spectrum", "tests/spectra.rs"),
    ("Material::primaries", "tests/spectra.rs"),
    ("Material::spectral_map", "tests/spectra.rs"),
    ("Material::with_spectral_map", "tests/spectra.rs"),
    ("Material::with_spectral_map_len", "tests/spectra.rs"),
    ("Primaries::columns", "tests/spectra.rs"),
    ("Primaries::from_columns", "tests/spectra.rs"),
    ("Primaries::of", "tests/spectra.rs"),
    ("SpectralMap::bytes", "tests/spectra.rs"),
    ("SpectralMap::column", "tests/spectra.rs"),
    ("SpectralMap::column_at", "tests/spectra.rs"),
    ("SpectralMap::encode", "tests/spectra.rs"),
    ("SpectralMap::encoded_len", "tests/spectra.rs"),
    ("SpectralMap::error", "tests/spectra.rs"),
    ("SpectralMap::from_bytes", "tests/spectra.rs"),
    ("SpectralMap::is_grey", "tests/spectra.rs"),
    ("SpectralMap::len", "tests/spectra.rs"),
    ("SpectralMap::wavelength", "tests/spectra.rs"),
    ("Material::pack", "tests/packed.rs"),
    ("Material::packed_len", "tests/packed.rs"),
    ("Material::unpack", "tests/packed.rs"),
    ("Material::unpacked_len", "tests/packed.rs"),
    ("Material::prepare", "tests/presets.rs"),
    ("Material::ask", "tests/asked.rs"),
    ("Material::ask_each", "tests/asked.rs"),
    ("Material::evaluate", "tests/asked.rs"),
    ("Material::evaluate_and_pdf", "tests/asked.rs"),
    ("Material::pdf", "tests/asked.rs"),
    ("Material::sample", "tests/asked.rs"),
    ("Material::sample_and_evaluate", "tests/asked.rs"),
    ("AnyMixture::ask", "tests/asked.rs"),
    ("AnyMixture::ask_each", "tests/asked.rs"),
    ("AnyMixture::capacity", "tests/verbs/main.rs"),
    ("AnyMixture::copy_from", "tests/verbs/main.rs"),
    ("Processor::this", "tests/asked.rs"),
    ("AnyMixture::sample_and_evaluate", "tests/verbs/main.rs"),
    ("Material::prepare_into", "tests/material.rs"),
    ("Level::name", "src/reference.rs"),
    ("Level::from_name", "tests/material.rs"),
    ("Level::is_available", "src/inputs.rs"),
    ("Level::current", "tests/material.rs"),
    ("Level::set", "src/reference.rs"),
];

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// Whether an attribute hides an item from users: from their documentation, or from their builds.
fn is_hidden(attributes: &[Attribute]) -> bool {
    let says = |attribute: &Attribute, name: &str, word: &str| {
        attribute.path().is_ident(name)
            && attribute.meta.require_list().is_ok_and(|list| list.tokens.to_string() == word)
    };
    attributes.iter().any(|attribute| says(attribute, "doc", "hidden") || says(attribute, "cfg", "test"))
}

/// The names that a `use` hands on.
fn handed_on(tree: &UseTree, names: &mut BTreeSet<String>) {
    match tree {
        UseTree::Path(path) => handed_on(&path.tree, names),
        UseTree::Name(name) => drop(names.insert(name.ident.to_string())),
        UseTree::Rename(name) => drop(names.insert(name.rename.to_string())),
        UseTree::Group(group) => group.items.iter().for_each(|tree| handed_on(tree, names)),
        UseTree::Glob(_) => panic!("lib.rs hands on all of a module, of which the names are not known here"),
    }
}

/// The public functions of the items of a file.
fn functions_of(
    items: &[Item],
    exported: &BTreeSet<String>,
    public_module: bool,
    found: &mut BTreeSet<String>,
) {
    let is_public = |visibility: &Visibility| matches!(visibility, Visibility::Public(_));
    for item in items {
        match item {
            Item::Fn(function) if is_public(&function.vis) && !is_hidden(&function.attrs) => {
                let name = function.sig.ident.to_string();
                found.extend((public_module || exported.contains(&name)).then_some(name));
            }
            Item::Impl(block) if block.trait_.is_none() && !is_hidden(&block.attrs) => {
                let Type::Path(owner) = &*block.self_ty else { continue };
                let owner = owner.path.segments.last().expect("a name").ident.to_string();
                for item in &block.items {
                    let ImplItem::Fn(method) = item else { continue };
                    if is_public(&method.vis) && !is_hidden(&method.attrs) && exported.contains(&owner) {
                        found.insert(format!("{owner}::{}", method.sig.ident));
                    }
                }
            }
            Item::Trait(of) if is_public(&of.vis) && exported.contains(&of.ident.to_string()) => {
                for item in &of.items {
                    let TraitItem::Fn(method) = item else { continue };
                    if !is_hidden(&method.attrs) {
                        found.insert(format!("{}::{}", of.ident, method.sig.ident));
                    }
                }
            }
            Item::Mod(inner) if !is_hidden(&inner.attrs) => {
                let inside = inner.content.as_ref().map_or(&[][..], |(_, items)| items);
                functions_of(inside, exported, public_module && is_public(&inner.vis), found);
            }
            _ => {}
        }
    }
}

/// Every function that a user of `core` can call.
fn public_functions() -> BTreeSet<String> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../core/src");
    let parsed = |file: &Path| {
        let text = std::fs::read_to_string(file).expect("a source file");
        syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", file.display())).items
    };
    let (mut exported, mut public_modules) = (BTreeSet::new(), BTreeSet::new());
    for item in parsed(&source.join("lib.rs")) {
        match item {
            Item::Use(line) if matches!(line.vis, Visibility::Public(_)) => {
                handed_on(&line.tree, &mut exported)
            }
            Item::Mod(module) if matches!(module.vis, Visibility::Public(_)) => {
                public_modules.insert(module.ident.to_string());
            }
            _ => {}
        }
    }
    assert!(public_modules.contains("special"), "{public_modules:?}");
    let mut files = Vec::new();
    rust_files(&source, &mut files);
    let mut functions = BTreeSet::new();
    for file in files {
        let place = file.strip_prefix(&source).expect("within").with_extension("");
        let public_module = place.to_str().is_some_and(|place| public_modules.contains(place));
        functions_of(&parsed(&file), &exported, public_module, &mut functions);
    }
    functions
}

#[test]
fn every_public_function_of_core_has_an_oracle() {
    let functions = public_functions();
    assert!(functions.len() > 80, "the source was not understood: {functions:?}");
    let mut failures = Vec::new();
    for function in &functions {
        if !ORACLES.iter().any(|(name, _)| name == function) {
            failures.push(format!("{function} has no oracle"));
        }
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    for (function, file) in ORACLES {
        if !functions.contains(*function) {
            failures.push(format!("{function} is listed, but core has no such function"));
        }
        let text = std::fs::read_to_string(folder.join(file)).unwrap_or_default();
        let bare = function.rsplit("::").next().expect("a name");
        let calls = |c: char| text.contains(&format!("{bare}{c}"));
        if !(calls('(') || calls(',') || calls(')') || text.contains(&format!("{bare}::<"))) {
            failures.push(format!("{function}: {file} does not call it"));
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

/// The manifest names the programs, as not every file is one: a file that is forgotten would never run.
#[test]
fn every_file_of_this_folder_is_run() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = |path: &str| std::fs::read_to_string(folder.join(path)).unwrap();
    let (manifest, library) = (text("Cargo.toml"), text("tests/library.rs"));
    for entry in folder.join("tests").read_dir().unwrap() {
        let path = entry.unwrap().path();
        let stem = path.file_stem().unwrap().to_str().unwrap();
        let place = if path.is_dir() { format!("{stem}/main.rs") } else { format!("{stem}.rs") };
        let is_program = manifest.contains(&format!("path = \"tests/{place}\""));
        assert!(is_program || library.contains(&format!("mod {stem};")), "{place} is not run");
    }
}
