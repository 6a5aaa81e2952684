//! Compiles the C baselines and the evaluator's C++ text twice: as a careful author would, and with everything the compiler may do to floating point.

fn main() {
    for (name, flags) in [("careful", &["-O3"][..]), ("fast", &["-O3", "-ffast-math"])] {
        let mut build = cc::Build::new();
        build.file("c/baseline.c").opt_level(3).define("SUFFIX", name).flag_if_supported("-march=native");
        flags.iter().for_each(|flag| {
            build.flag(flag);
        });
        build.compile(&format!("srbf_baseline_{name}"));
        let mut device = cc::Build::new();
        device.cpp(true).std("c++17").file("c/device.cpp").opt_level(3).define("SUFFIX", name);
        device.flag_if_supported("-march=native");
        flags.iter().for_each(|flag| {
            device.flag(flag);
        });
        device.compile(&format!("srbf_device_{name}"));
    }
    let mut ggx = cc::Build::new();
    ggx.file("c/ggx.c").opt_level(3).flag_if_supported("-march=native").flag_if_supported("-fno-math-errno");
    ggx.compile("srbf_ggx");
    println!("cargo::rerun-if-changed=c/baseline.c");
    println!("cargo::rerun-if-changed=c/ggx.c");
    println!("cargo::rerun-if-changed=c/device.cpp");
    println!("cargo::rerun-if-changed=../include/srbf_device.hpp");
    println!("cargo::rustc-link-lib=m");
}
