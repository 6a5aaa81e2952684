//! Readers, fitters and error metrics: makes `.srbf` materials, offline.
