//! `include/srbf.h` is what the source of the C interface says.

use srbf_tests::header;

#[test]
fn the_header_is_fresh() {
    let committed = std::fs::read_to_string(header::path()).unwrap_or_default();
    let generated = header::generate();
    let differing = committed.lines().zip(generated.lines()).position(|(old, new)| old != new);
    assert!(
        committed == generated,
        "include/srbf.h is stale, first at line {}: run `cargo run --release -p srbf-tests --bin header`",
        differing.map_or(committed.lines().count().min(generated.lines().count()), |line| line) + 1
    );
}
