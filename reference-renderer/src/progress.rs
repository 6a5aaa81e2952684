//! A progress bar on standard error; nothing where that is not a terminal.

use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// Shows how far a long work is; disappears when dropped.
pub struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// Starts a bar of `total` steps.
    pub fn new(label: &str, total: u64) -> Self {
        // indicatif itself hides the bar if standard error is not a terminal.
        let style = ProgressStyle::with_template("{prefix:24} [{bar:40}] {percent:>3} %  {eta} left")
            .expect("the template is right")
            .progress_chars("=> ");
        let bar = ProgressBar::new(total).with_style(style).with_prefix(label.to_owned());
        bar.enable_steady_tick(Duration::from_millis(200));
        Self { bar }
    }

    /// A bar that shows nothing.
    pub fn hidden() -> Self {
        Self { bar: ProgressBar::hidden() }
    }

    /// Moves on by some steps.
    pub fn advance(&self, steps: u64) {
        self.bar.inc(steps);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
