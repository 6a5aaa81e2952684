//! The time that a fit takes, as reports say it.

use std::time::Instant;

/// Whether the target has a clock: WebAssembly without a system has none, and its host measures.
const IS_THERE: bool = !cfg!(all(target_family = "wasm", target_os = "unknown"));

/// A stopwatch.
pub(crate) struct Clock(Option<Instant>);

impl Clock {
    /// Begins to measure.
    pub fn start() -> Self {
        Self(IS_THERE.then(Instant::now))
    }

    /// Seconds since its start; 0 where there is no clock.
    pub fn seconds(&self) -> f64 {
        self.0.map_or(0.0, |start| start.elapsed().as_secs_f64())
    }
}
