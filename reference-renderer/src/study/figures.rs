//! The figures of Weng and Shih 2006, chapter 5, made again: what is rendered, how it is measured, and how it is put on one sheet.
//!
//! The truth is one for all methods, the measurement: methods only draw directions for it. A second reading is what the thesis rendered, where
//! the lobes of a method are the material themselves.
//!
//! | file | holds |
//! |---|---|
//! | `materials` | the four materials, and all that samples them |
//! | `measure` | pictures and errors of methods at counts of samples |
//! | `claim` | the count at which another method has the error of 300 samples |
//! | `sheet` | labelled pictures side by side |

pub mod claim;
pub mod materials;
pub mod measure;
pub mod sheet;
