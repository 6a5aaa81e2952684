//! A progress bar on standard error, with the time that is left; nothing where that is not a terminal, or under `--quiet`.

use crate::out::print;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::time::Duration;

/// One line of any terminal: the bar takes the free columns, and a long label is cut.
const LINE: &str = "{prefix:20!} [{wide_bar}] {percent:>3} %, {eta:>3} left";

/// Steps of a work whose share is known and no number of steps.
const SHARES: f64 = 1000.0;

/// Shows how far a long work is; disappears when dropped.
pub struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// Starts a bar of `total` steps.
    pub fn new(label: &str, total: u64) -> Self {
        // indicatif itself hides the bar if standard error is not a terminal.
        let target =
            if print::is_quiet() { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let progress = Self::on(target, label, total);
        // Its ticks are a thread's: indicatif panics where there is none to be had.
        if !progress.bar.is_hidden() && std::thread::Builder::new().spawn(|| ()).is_ok() {
            progress.bar.enable_steady_tick(Duration::from_millis(200));
        }
        progress
    }

    /// Starts a bar of a work that says which share is done: [`set_share`](Self::set_share).
    pub fn of_shares(label: &str) -> Self {
        Self::new(label, SHARES as u64)
    }

    fn on(target: ProgressDrawTarget, label: &str, total: u64) -> Self {
        let style = ProgressStyle::with_template(LINE).expect("the template is right").progress_chars("=> ");
        let bar = ProgressBar::with_draw_target(Some(total), target);
        Self { bar: bar.with_style(style).with_prefix(label.to_owned()) }
    }

    /// A bar that shows nothing.
    pub fn hidden() -> Self {
        Self { bar: ProgressBar::hidden() }
    }

    /// Moves on by some steps.
    pub fn advance(&self, steps: u64) {
        self.bar.inc(steps);
    }

    /// Moves to a share of the whole, 0 to 1.
    pub fn set_share(&self, share: f64) {
        self.bar.set_position((SHARES * share) as u64);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io;
    use std::sync::{Arc, Mutex};

    /// A terminal of few columns that remembers its text.
    #[derive(Clone, Debug)]
    struct Terminal(u16, Arc<Mutex<Vec<String>>>);

    impl indicatif::TermLike for Terminal {
        fn width(&self) -> u16 {
            self.0
        }
        fn move_cursor_up(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_down(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_right(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_left(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn write_line(&self, text: &str) -> io::Result<()> {
            self.write_str(text)
        }
        fn write_str(&self, text: &str) -> io::Result<()> {
            self.1.lock().unwrap().push(text.to_owned());
            Ok(())
        }
        fn clear_line(&self) -> io::Result<()> {
            Ok(())
        }
        fn flush(&self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_bar_says_what_is_left_and_fits_into_narrow_terminals() {
        for width in [50, 60, 80] {
            let written = Arc::new(Mutex::new(Vec::new()));
            let terminal = Box::new(Terminal(width, written.clone()));
            let label = "a_material_with_a_long_name_of_its_own.binary";
            let progress = Progress::on(ProgressDrawTarget::term_like(terminal), label, 1000);
            progress.set_share(0.4);
            progress.bar.tick();
            let written = written.lock().unwrap();
            let line = written.iter().find(|text| text.contains("40 %")).expect("a bar");
            assert!(line.starts_with("a_material_with_a_lo [=") && line.contains("left"), "{line}");
            assert!(written.iter().all(|text| text.chars().count() <= width.into()), "{width}: {written:?}");
        }
    }
}
