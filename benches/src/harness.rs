//! The frame of the programs that print times: levels by their names, ways that take turns, and one table.

use srbf_core::{Level, Processor};
use std::process::ExitCode;
use std::time::Instant;

/// The levels that are named, or all that the machine has if none is; prints the processor.
///
/// # Errors
/// Exit status 2, after a message, for a level that is not here.
pub fn levels_of(program: &str, names: &[String]) -> Result<Vec<Level>, ExitCode> {
    let here: Vec<Level> = crate::levels().collect();
    if let Some(name) = names.iter().find(|name| !here.iter().any(|level| level.name() == **name)) {
        eprintln!("{program}: no such level here: {name}");
        return Err(ExitCode::from(2));
    }
    println!("processor: {}", Processor::this());
    let is_named = |level: &Level| names.is_empty() || names.iter().any(|name| name == level.name());
    Ok(here.into_iter().filter(is_named).collect())
}

/// AVX2, as most processors have no more, and the best level of this machine: the levels of tables with one column or one table for each.
pub fn capped_and_best() -> Vec<Level> {
    let best = crate::levels().last();
    let mut levels: Vec<Level> = crate::levels().filter(|level| *level == Level::Avx2).collect();
    levels.extend(best.filter(|best| !levels.contains(best)));
    levels
}

/// The arguments of the program.
pub fn arguments() -> Vec<String> {
    std::env::args().skip(1).collect()
}

/// Nanoseconds an item of each of `ways`: the least of many rounds, in each of which all ways take turns. `run` does the work of a way
/// on all items.
pub fn least_of(rounds: usize, ways: usize, items: usize, mut run: impl FnMut(usize)) -> Vec<f64> {
    let mut least = vec![f64::INFINITY; ways];
    for _ in 0..rounds {
        for (way, least) in least.iter_mut().enumerate() {
            let start = Instant::now();
            run(way);
            *least = least.min(start.elapsed().as_secs_f64() * 1e9 / items as f64);
        }
    }
    least
}

/// A table: names to the left, columns to the right as wide as their widest cell.
#[derive(Debug)]
pub struct Table(Vec<Vec<String>>);

impl Table {
    /// With a title above the names, and heads of columns.
    pub fn new<S: Into<String>>(title: &str, heads: impl IntoIterator<Item = S>) -> Self {
        let mut table = Self(Vec::new());
        table.row(title, heads);
        table
    }

    /// Adds a line.
    pub fn row<S: Into<String>>(&mut self, name: &str, cells: impl IntoIterator<Item = S>) {
        self.0.push(std::iter::once(name.to_owned()).chain(cells.into_iter().map(Into::into)).collect());
    }

    /// Prints it, with an empty line before.
    pub fn print(&self) {
        let width = |column: usize| {
            self.0
                .iter()
                .filter_map(|row| row.get(column))
                .map(|cell| cell.chars().count())
                .max()
                .unwrap_or(0)
        };
        println!();
        for row in &self.0 {
            let mut line = format!("{:<1$}", row[0], width(0));
            for (column, cell) in row.iter().enumerate().skip(1) {
                line += &format!("  {cell:>0$}", width(column));
            }
            println!("{}", line.trim_end());
        }
    }
}
