//! The text, compiled as C++ and as Metal beside the library: values, exports of strangers' materials.

mod driver;
mod exports;
mod values;
