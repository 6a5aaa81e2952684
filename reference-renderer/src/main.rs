//! `srbf`: fits, inspects, renders and compares materials. Without a command it does the main job on embedded defaults.

use srbf_reference_renderer::command;
use std::process::ExitCode;

fn main() -> ExitCode {
    command::program("srbf", command::run)
}
