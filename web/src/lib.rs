//! A page that shows materials, and fits measurements, in a browser; and the functions behind it.
//!
//! The module for WebAssembly calls [`open()`] and [`export()`]. [`files`] are those of the page, for `srbf view` and `packaging/web`;
//! [`one_file`] has all of them, for `srbf fit --html`.

mod export;
mod open;
#[cfg(feature = "page")]
mod page;
mod points;
mod spectra;

pub use export::export;
pub use open::{Opened, fitted, of_fit, open};
#[cfg(feature = "page")]
pub use page::{Preset, Teapot, files, fitter_script, one_file};
