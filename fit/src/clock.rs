//! The time that a fit takes, as reports say it, and the share of it that is over.

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

/// The share of a bar that is filled by a work that may turn out to be longer; the rest is for its end.
const FILLED: f64 = 0.9;

/// Tells shares that never fall, and end below 1. Where `share` falls, the work has become more, and the rest of the bar is for it.
pub(crate) fn rising(mut tell: impl FnMut(f64) + Send) -> impl FnMut(f64) + Send {
    // The share of the work, and the share that was told: at the last fall, and the last of all.
    let (mut fallen, mut last) = ([0.0, 0.0], [0.0, 0.0]);
    move |share: f64| {
        if share < last[0] {
            fallen = [share, last[1]];
        }
        let [from, told] = fallen;
        let done = (share - from) / (1.0 - from).max(f64::MIN_POSITIVE);
        last = [share, told + FILLED * (1.0 - told) * done.clamp(0.0, 1.0)];
        tell(last[1]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_never_fall_and_never_stand_while_work_goes_on() {
        let mut told = Vec::new();
        let mut rise = rising(|share| told.push(share));
        // A goal is missed at the end, and again.
        let works = [[0.0, 0.4, 1.0], [0.7, 0.8, 1.0], [0.9, 0.95, 1.0]];
        works.iter().flatten().for_each(|share| rise(*share));
        drop(rise);
        assert!(told.is_sorted() && told[8] < 1.0, "{told:?}");
        assert!(told.chunks(3).all(|work| work[0] < work[1] && work[1] < work[2]), "{told:?}");
    }
}
