//! Every function of `core` against the 50-digit tables, within the one table of allowed errors, which may not be stale.

use srbf_core::Level;
use srbf_tests::inputs::levels;
use srbf_tests::reference::measure;
use srbf_tests::tolerance::TABLE;

#[test]
fn every_function_keeps_its_entry_and_no_entry_is_stale() {
    let measured = measure();
    let mut failures = Vec::new();
    for worst in &measured {
        println!("{:34} {:9.2e}  ({} comparisons)", worst.name, worst.error, worst.count);
        failures.extend(worst.failure());
    }
    let levels = levels();
    for entry in TABLE {
        let missing_level = Level::ALL.iter().any(|l| !levels.contains(l) && entry.name.ends_with(l.name()));
        if missing_level {
            println!("{} NOT RUN: no level of this run", entry.name);
        } else if !measured.iter().any(|worst| worst.name == entry.name) {
            failures.push(format!("{} is in the table but is not measured", entry.name));
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}
