//! Tells the linker of macOS that the symbols of Python are there when the library is loaded.

fn main() {
    pyo3_build_config::add_extension_module_link_args();
}
