//! libFuzzer's program for every attack: `SRBF_TARGET` names the target, as they all run the same code. `fuzz/run` sets it.
#![no_main]

use std::sync::LazyLock;

static TARGET: LazyLock<String> = LazyLock::new(|| {
    std::env::var("SRBF_TARGET").expect("SRBF_TARGET names a target of tests/src/attack.rs")
});

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    #[cfg(feature = "scene")]
    if srbf_fuzz::scene::run(&TARGET, bytes).is_some() {
        return;
    }
    if TARGET.as_str() == "view" {
        return srbf_fuzz::view::run(bytes);
    }
    srbf_fuzz::attack::run(&TARGET, bytes);
});
