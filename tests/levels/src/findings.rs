//! Findings of a check of a level.

use crate::tolerance::Worst;
use alloc::borrow::ToOwned;
use alloc::string::String;
use alloc::vec::Vec;

/// The findings at one level.
#[derive(Debug)]
pub struct Findings {
    /// The worst error of each quantity.
    pub worst: Vec<Worst>,
    /// Faults beside errors too large: a guard zone that was written, a length, a sample that is none.
    pub faults: Vec<String>,
}

impl Findings {
    /// Everything that is wrong; nothing if the level passes.
    pub fn failures(&self) -> Vec<String> {
        self.faults.iter().cloned().chain(self.worst.iter().filter_map(Worst::excess)).collect()
    }
}

impl Findings {
    pub(crate) fn see(&mut self, name: &str, got: f32, want: f64, scale: f64, place: &str) {
        let worst = self.worst.iter_mut().find(|w| w.name == name).expect("a name of the list above");
        // What f32 rounds to 0 is no error.
        worst.see((f64::from(got) - want).abs() / (scale + 1e-30), || place.to_owned());
    }

    pub(crate) fn fault(&mut self, text: String) {
        if self.faults.len() < 20 {
            self.faults.push(text);
        }
    }
}
