//! One sample of a file, on its own, so that what looks at samples needs to know nothing of how they are read.

/// One sample as it stands in a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Line, or number of the entry in a format without lines, from 1.
    pub line: usize,
    /// Incident direction, towards the light; unit vector, +z the normal.
    pub wi: [f64; 3],
    /// Outgoing direction, towards the viewer; unit vector in the same frame.
    pub wo: [f64; 3],
    /// The BRDF f, linear sRGB; 1/sr.
    pub rgb: [f64; 3],
}
