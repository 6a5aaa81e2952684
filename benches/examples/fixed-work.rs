//! A fixed amount of work, for counting instructions: `.ci/checks/60-instructions` runs it under callgrind.
//!
//! `fixed-work LEVEL OPERATION [TIMES]`, operation `none` or a name of [`Operation`]: with `-round` behind it of 12 general round lobes, with
//! `factored-` before it of the garnet red preset with a table of factors, alone of the preset, with `packed-` of the preset in codes, with `brushed-` of an anisotropic material of as many lobes. It is done
//! 4096 times, or as often as is said.

use srbf_benches::work::{Operation, Subject, Work};
use srbf_core::Level;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let asked = match &arguments[..] {
        [level, name] => Some((level, name, 4096)),
        [level, name, times] => times.parse().ok().map(|times| (level, name, times)),
        _ => None,
    };
    let Some((level, name, times)) = asked else {
        eprintln!("usage: fixed-work LEVEL OPERATION [TIMES]");
        return ExitCode::from(2);
    };
    let Some(level) = Level::from_name(level) else {
        eprintln!("no such level: {level}");
        return ExitCode::from(2);
    };
    let named = |before: &str, behind: &str| {
        let plain = name.strip_prefix(before)?.strip_suffix(behind)?;
        Operation::ALL.into_iter().find(|(known, _)| *known == plain)
    };
    let operation = Subject::ALL
        .into_iter()
        .find_map(|(subject, before, behind)| Some((named(before, behind)?.1, subject)));
    if operation.is_none() && name != "none" {
        eprintln!("no such operation: {name}");
        return ExitCode::from(2);
    }
    if level.set().is_err() {
        eprintln!("this machine lacks {}", level.name());
        return ExitCode::from(77);
    }
    let mut work = Work::new(times);
    if let Some((operation, subject)) = operation {
        work.run(operation, subject);
    }
    println!("{}", work.sum());
    ExitCode::SUCCESS
}
