//! `include/srbf.h` is what the source of the C interface says.

use srbf_tests::native::run;
use std::process::Command;

#[test]
fn is_fresh() {
    run(Command::new(env!("CARGO_BIN_EXE_header")).arg("--check"));
}
