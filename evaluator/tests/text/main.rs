//! The text, compiled as C++ and as Metal beside the library: values, hostile files and directions, exports of strangers' materials.

mod device;
mod driver;
mod exports;
mod pbrt;
mod values;
