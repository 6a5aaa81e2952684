#![no_main]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    srbf_fuzz::attack::run("formats", bytes);
});
