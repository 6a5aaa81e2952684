//! `srbf project`: what the project itself needs, its tables, figures and presets.

mod bench_report;
mod equal_time;
mod leave_out;
mod lobes_table;
mod pages;
mod presets;
pub mod samples;
mod slice;
mod stability;
mod survey;
pub mod thesis_table;

use clap::Subcommand;

/// The commands of the project.
#[derive(Debug, Subcommand)]
pub enum Command {
    Survey(Box<survey::Args>),
    ThesisTable(thesis_table::Args),
    LobesTable(lobes_table::Args),
    EqualTime(equal_time::Args),
    Presets(presets::Args),
    Stability(stability::Args),
    LeaveOut(leave_out::Args),
    Samples(samples::Args),
    Slice(slice::Args),
    BenchReport(bench_report::Args),
    Completions(pages::Completions),
    Man(pages::Man),
}

/// Runs one of them.
pub fn run(command: Command) -> anyhow::Result<()> {
    match command {
        Command::Survey(args) => survey::run(*args),
        Command::ThesisTable(args) => thesis_table::run(args),
        Command::LobesTable(args) => lobes_table::run(args),
        Command::EqualTime(args) => equal_time::run(&args),
        Command::Presets(args) => presets::run(args),
        Command::Stability(args) => stability::run(args),
        Command::LeaveOut(args) => leave_out::run(args),
        Command::Slice(args) => slice::run(args),
        Command::Samples(args) => samples::run(args),
        Command::BenchReport(args) => bench_report::run(args),
        Command::Completions(args) => pages::completions(args),
        Command::Man(args) => pages::man(args),
    }
}
