//! `srbf-levels [LEVEL...]`: checks the levels, by default all; a line each. Exit 1 if one fails, 77 if one that was named is lacking.

use srbf_core::Level;
use std::process::ExitCode;

fn main() -> ExitCode {
    let named: Vec<String> = std::env::args().skip(1).collect();
    let mut exit = ExitCode::SUCCESS;
    for level in Level::ALL {
        let is_named = named.iter().any(|name| name == level.name());
        if !named.is_empty() && !is_named {
            continue;
        }
        match srbf_levels::check(level) {
            Err(_) => {
                println!("level {} NOT RUN: this machine lacks it", level.name());
                if is_named {
                    exit = ExitCode::from(77);
                }
            }
            Ok(found) => {
                let failures = found.failures();
                let count: usize = found.worst.iter().map(|w| w.count).sum();
                let verdict = if failures.is_empty() { "passes" } else { "FAILS" };
                println!("level {} {verdict}: {count} numbers compared with f64", level.name());
                for worst in &found.worst {
                    println!("  {}: {:.2e}", worst.name, worst.error);
                }
                failures.iter().for_each(|failure| println!("  {failure}"));
                if !failures.is_empty() {
                    return ExitCode::FAILURE;
                }
            }
        }
    }
    exit
}
