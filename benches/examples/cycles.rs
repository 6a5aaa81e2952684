//! Cycles that every operation takes, in rounds in which no neighbour shares the core.
//!
//! `cargo run --release -p srbf-benches --example cycles [LEVEL...]`, a minute: 1024 directions, cycles for each direction, and of
//! batches of values and densities for each direction and lobe. A round is 60 microseconds of an operation between two looks at the
//! core; it counts where both found the full rate of the core and the same clock. x86-64 only.

#[cfg(target_arch = "x86_64")]
fn main() -> std::process::ExitCode {
    x86::main()
}

#[cfg(not(target_arch = "x86_64"))]
fn main() -> std::process::ExitCode {
    eprintln!("cycles: x86-64 only");
    std::process::ExitCode::from(2)
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use srbf_benches::clock::Probe;
    use srbf_benches::harness::{Table, arguments, levels_of};
    use srbf_benches::work::{Operation, Subject, Work};
    use srbf_core::Level;
    use std::process::ExitCode;
    use std::time::{Duration, Instant};

    const DIRECTIONS: usize = 1024;
    const LOBES: f64 = 12.0;
    const ROUND: Duration = Duration::from_micros(60);
    /// How long every operation is at work, and in how many passes, as neighbours come and go.
    const TURN: Duration = Duration::from_millis(60);
    const PASSES: usize = 12;
    /// Fewest rounds that have to count.
    const ENOUGH: usize = 20;
    /// Share of the full rate that counts as full, and change of the clock that counts as none.
    const FULL: f64 = 0.93;
    const STEADY: f64 = 0.02;
    /// Clock for which times are given beside cycles, GHz: that of the goals.
    const CLOCK: f64 = 3.7;

    /// An operation, and its rounds.
    struct Row {
        level: Level,
        name: &'static str,
        operation: Operation,
        subject: Subject,
        rounds: Vec<Round>,
    }

    /// The measurements of a round.
    struct Round {
        /// Cycles for each direction.
        cycles: f64,
        /// Instructions a cycle, the smaller of those before and after.
        rate: f64,
        is_steady: bool,
    }

    pub fn main() -> ExitCode {
        let levels = match levels_of("cycles", &arguments()) {
            Ok(levels) => levels,
            Err(status) => return status,
        };
        let row = |level, (name, operation), subject| Row { level, name, operation, subject, rounds: vec![] };
        let mut rows = vec![];
        for &level in &levels {
            for named in Operation::ALL {
                if named.1.has_mixture() {
                    rows.push(row(level, named, Subject::Round));
                }
                rows.push(row(level, named, Subject::Preset));
                rows.push(row(level, named, Subject::Factored));
            }
        }
        for _ in 0..PASSES {
            for rows in rows.chunk_by_mut(|a, b| a.level == b.level) {
                rows[0].level.set().expect("an available level");
                let mut work = Work::new(DIRECTIONS);
                rows.iter_mut().for_each(|row| row.measure(&mut work));
            }
        }
        let mut rates: Vec<f64> = rows.iter().flat_map(|row| row.rounds.iter().map(|r| r.rate)).collect();
        rates.sort_by(f64::total_cmp);
        let (full, typical) = (rates[rates.len() * 99 / 100], rates[rates.len() / 2]);
        println!(
            "instructions that do nothing, a cycle: up to {full:.2}, {typical:.2} in the median of all rounds"
        );
        let mut table = Table::new("operation", ["cycles", "ns at 3.7 GHz", "rounds that count"]);
        rows.iter().for_each(|row| row.tell(FULL * full, &mut table));
        table.print();
        ExitCode::SUCCESS
    }

    impl Row {
        fn measure(&mut self, work: &mut Work) {
            let mut run = || work.run(self.operation, self.subject);
            run();
            let once = Instant::now();
            run();
            let runs = (ROUND.as_secs_f64() / once.elapsed().as_secs_f64()).ceil().max(1.0) as u32;
            let start = Instant::now();
            while start.elapsed() < TURN {
                let before = Probe::take();
                let begin = Instant::now();
                (0..runs).for_each(|_| run());
                let seconds = begin.elapsed().as_secs_f64() / f64::from(runs) / DIRECTIONS as f64;
                let after = Probe::take();
                self.rounds.push(Round {
                    cycles: seconds / (0.5 * (before.cycle + after.cycle)),
                    rate: before.rate.min(after.rate),
                    is_steady: (before.cycle / after.cycle - 1.0).abs() < STEADY,
                });
            }
        }

        /// Tells the median of the rounds of at least some rate.
        fn tell(&self, rate: f64, table: &mut Table) {
            let counts = |r: &&Round| r.is_steady && r.rate >= rate;
            let mut cycles: Vec<f64> = self.rounds.iter().filter(counts).map(|r| r.cycles).collect();
            cycles.sort_by(f64::total_cmp);
            let is_own = |(subject, _, _): &&(Subject, &str, &str)| *subject == self.subject;
            let (_, before, behind) = Subject::ALL.iter().find(is_own).expect("all subjects");
            let name = format!("{} {before}{}{behind}", self.level.name(), self.name);
            let lobes = if let Operation::Evaluate | Operation::Pdf = self.operation { LOBES } else { 1.0 };
            let (counted, all) = (cycles.len(), self.rounds.len());
            let [cycles, ns] = if counted < ENOUGH {
                ["the core was shared".to_owned(), String::new()]
            } else {
                let each = cycles[counted / 2] / lobes;
                [format!("{each:.3}"), format!("{:.3}", each / CLOCK)]
            };
            table.row(&name, [cycles, ns, format!("{counted} of {all}")]);
        }
    }
}
