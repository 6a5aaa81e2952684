//! The levels at which commands time.

use srbf_core::Level;

/// AVX2, as most processors have no more, and the best level of this machine, if that is another.
pub fn capped_and_best() -> Vec<Level> {
    let available = || Level::ALL.into_iter().filter(|level| level.is_available());
    let mut levels: Vec<Level> = available().filter(|level| *level == Level::Avx2).collect();
    levels.extend(available().next_back().filter(|best| !levels.contains(best)));
    levels
}
