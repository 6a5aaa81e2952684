//! Every level of this machine, at every count.

use srbf_core::Level;
use srbf_levels::check;
use srbf_levels::tolerance::Worst;

#[test]
fn every_level_of_this_machine_gives_the_f64_values_at_every_count() {
    let mut worst: Vec<Worst> = Vec::new();
    for level in Level::ALL {
        let Ok(found) = check(level) else {
            println!("level {} NOT RUN: this machine lacks it", level.name());
            continue;
        };
        assert_eq!(found.failures(), Vec::<String>::new(), "level {}", level.name());
        for w in found.worst {
            println!("level {}: {}: {:.2e} at {}", level.name(), w.name, w.error, w.place);
            match worst.iter_mut().find(|other| other.name == w.name) {
                Some(other) if other.error >= w.error => {}
                Some(other) => *other = w,
                None => worst.push(w),
            }
        }
    }
    // No entry is looser than needed either.
    let failures: Vec<String> = worst.iter().filter_map(Worst::failure).collect();
    assert_eq!(failures, Vec::<String>::new());
}
