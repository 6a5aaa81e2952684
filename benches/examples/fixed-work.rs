//! A fixed amount of work, for counting instructions: `.ci/checks/60-instructions` runs it under callgrind.
//!
//! `fixed-work LEVEL OPERATION`, operation `none` or a name of [`Operation`], with `-round` of 12 general round lobes and
//! without of the garnet red preset.

use srbf_benches::work::{Operation, Work};
use srbf_core::Level;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [level, name] = &arguments[..] else {
        eprintln!("usage: fixed-work LEVEL OPERATION");
        return ExitCode::from(2);
    };
    let Some(level) = Level::from_name(level) else {
        eprintln!("no such level: {level}");
        return ExitCode::from(2);
    };
    let (plain, is_round) = name.strip_suffix("-round").map_or((&name[..], false), |plain| (plain, true));
    let operation = Operation::ALL.into_iter().find(|(known, _)| *known == plain);
    if operation.is_none() && name != "none" {
        eprintln!("no such operation: {name}");
        return ExitCode::from(2);
    }
    if level.set().is_err() {
        eprintln!("this machine lacks {}", level.name());
        return ExitCode::from(77);
    }
    let mut work = Work::new(4096);
    if let Some((_, operation)) = operation {
        work.run(operation, is_round);
    }
    println!("{}", work.sum());
    ExitCode::SUCCESS
}
