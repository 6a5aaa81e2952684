//! Checks every field of a material's bytes once: what passes is read without a further check.

use super::checksum::crc32;
use super::factor_table::{SIZES, largest};
use super::format_error::{FORMAT_VERSION, FormatError};
use super::layout::{
    CHECKSUM, HEADER, Header, Kind, MAGIC, MAX_LOBES, MIRRORED, NODES, SMALLEST, Shape, f32_at, u32_at,
};
use crate::color::MOST_DIFFERENCE;
use crate::float;
use core::f32::consts::{FRAC_PI_2, PI};

/// Largest magnitude of a stored difference of albedos, relative to the luminance.
const MOST_ALBEDO_DIFFERENCE: f32 = 16.0;

const MAX_VIEWS: usize = 1024;

const MAX_AZIMUTHS: usize = 64;

/// Views of an anisotropic material.
const MAX_GRID_VIEWS: usize = 4096;

/// Bounds of the eigenvalues of the logarithm of the squeeze matrix. Matrices within form a convex set that
/// turning keeps, so what is interpolated and turned lies within too.
const SQUEEZE: (f32, f32) = (-5.0, 6.64);

/// Checks how bytes start, of which [`SMALLEST`] are enough, and returns the length that they announce.
pub(crate) fn announced_len(bytes: &[u8]) -> Result<usize, FormatError> {
    if bytes.len() < MAGIC.len() || bytes[..MAGIC.len()] != MAGIC {
        return Err(FormatError::Magic);
    }
    if bytes.len() < SMALLEST {
        return Err(FormatError::Length { expected: SMALLEST, actual: bytes.len() });
    }
    let version = u32_at(bytes, 8);
    if !(1..=FORMAT_VERSION).contains(&version) {
        return Err(FormatError::Version(version));
    }
    if u32_at(bytes, 12) > 1 {
        return Err(FormatError::Field { name: "kind", offset: 12 });
    }
    Ok(u32_at(bytes, 16) as usize)
}

/// Checks every field once; what passes can be read without a further check.
pub(crate) fn validate(bytes: &[u8]) -> Result<Header, FormatError> {
    let announced = announced_len(bytes)?;
    if announced != bytes.len() {
        return Err(FormatError::Length { expected: announced, actual: bytes.len() });
    }
    let field = |name, offset| Err(FormatError::Field { name, offset });
    let count = |offset| u32_at(bytes, offset) as usize;
    let mut header = Header {
        kind: Kind::Line,
        views: count(20),
        lobes: count(24),
        squeezed: count(28),
        mirrored: 0,
        provenance: count(32),
        has_luminance: count(8) > 1,
        factors: [0; 2],
    };
    if !(1..=MAX_VIEWS).contains(&header.views) {
        return field("number of views", 20);
    }
    let mut reserved = 40;
    if count(12) == 1 {
        (header.kind, header.views) = read_shape(bytes)?;
        reserved = 44;
    } else {
        header.mirrored = count(MIRRORED);
    }
    let mut free = HEADER;
    if header.has_luminance {
        header.factors = read_table_shape(count(NODES))?;
        free = NODES;
    }
    if !(1..=MAX_LOBES).contains(&header.lobes) {
        return field("number of lobes", 24);
    }
    if header.squeezed > header.lobes {
        return field("number of squeezed lobes", 28);
    }
    if header.mirrored > header.lobes - header.squeezed || header.lobes + header.mirrored > MAX_LOBES {
        return field("number of mirrored lobes", MIRRORED);
    }
    // The counts are small by now, and the text is no longer than the file: the sum cannot overflow.
    if header.provenance > bytes.len() || header.len() != bytes.len() {
        return field("length of the provenance", 32);
    }
    if (reserved..free).step_by(4).any(|offset| count(offset) != 0) {
        return field("reserved field", reserved);
    }
    if crc32(&bytes[..bytes.len() - CHECKSUM]) != u32_at(bytes, bytes.len() - CHECKSUM) {
        return Err(FormatError::Checksum);
    }
    let text = bytes.len() - CHECKSUM - header.provenance;
    if core::str::from_utf8(&bytes[text..text + header.provenance]).is_err() {
        return field("provenance (not UTF-8)", text);
    }
    match header.kind {
        Kind::Line => {
            validate_thetas(bytes, &header, header.views)?;
            validate_views(bytes, &header)?;
        }
        Kind::Grid(shape) => {
            validate_thetas(bytes, &header, shape.thetas)?;
            validate_grid(bytes, &header, shape)?;
        }
    }
    if header.factors[0] > 0 {
        validate_table(bytes, &header)?;
    }
    Ok(header)
}

/// Reads the numbers of nodes of a table of factors; two of 0 for none.
fn read_table_shape(both: usize) -> Result<[u8; 2], FormatError> {
    let nodes = [both & 0xffff, both >> 16];
    if both != 0 && !nodes.iter().all(|n| SIZES.contains(n)) {
        return Err(FormatError::Field { name: "size of the table of factors", offset: NODES });
    }
    Ok(nodes.map(|n| n as u8))
}

/// Checks the table of factors, and what stands with it.
fn validate_table(bytes: &[u8], header: &Header) -> Result<(), FormatError> {
    for offset in (header.albedo_difference(0)..header.albedo_difference(header.views)).step_by(4) {
        check(bytes, "albedo difference", offset, -MOST_ALBEDO_DIFFERENCE, MOST_ALBEDO_DIFFERENCE)?;
    }
    let start = header.nodes();
    let mut most = 0f32;
    for offset in (start..bytes.len() - CHECKSUM - header.provenance).step_by(4) {
        let node = u32_at(bytes, offset);
        if node >> 30 != 0 {
            return Err(FormatError::Field { name: "node of the table of factors", offset });
        }
        most = most.max(largest(node));
    }
    // Another writer may round it otherwise.
    check(bytes, "largest factor", start - 4, most * (1.0 - 1e-6), most * (1.0 + 1e-6))
}

/// Whether the number at an offset is within a range.
fn check(bytes: &[u8], name: &'static str, offset: usize, low: f32, high: f32) -> Result<(), FormatError> {
    // False for NaN too.
    let inside = (low..=high).contains(&f32_at(bytes, offset));
    if inside { Ok(()) } else { Err(FormatError::Field { name, offset }) }
}

/// Bounds of the three numbers that say an amplitude or albedo, of which the logarithms are at most `most`.
fn color_bounds(header: &Header, number: usize, most: f32) -> (f32, f32) {
    if header.has_luminance && number > 0 { (-MOST_DIFFERENCE, MOST_DIFFERENCE) } else { (-126.0, most) }
}

/// The first angle is the normal, the others rise from it.
fn validate_thetas(bytes: &[u8], header: &Header, count: usize) -> Result<(), FormatError> {
    let mut previous = -1.0;
    for n in 0..count {
        let theta = header.theta(n);
        check(bytes, "angle of a view", theta, 0.0, if n == 0 { 0.0 } else { FRAC_PI_2 })?;
        if f32_at(bytes, theta) <= previous {
            return Err(FormatError::Field { name: "angle of a view (must rise)", offset: theta });
        }
        previous = f32_at(bytes, theta);
    }
    Ok(())
}

fn validate_views(bytes: &[u8], header: &Header) -> Result<(), FormatError> {
    for view in 0..header.views {
        let check = |name, offset: usize, low: f32, high: f32| check(bytes, name, offset, low, high);
        // The first view is the normal, where nothing may depend on the azimuth of the outgoing direction.
        let limit = |free: f32| if view == 0 { 0.0 } else { free };
        check("squeeze", header.head(view), limit(-6.64), limit(1.0))?;
        for number in 0..3 {
            let (low, high) = color_bounds(header, number, 2.0);
            check("diffuse albedo", header.head(view) + 4 * (1 + number), low, high)?;
        }
        for lobe in 0..header.lobes {
            check("angle of an axis", header.row(view, 0) + 4 * lobe, limit(-PI), limit(PI))?;
            check("sharpness", header.row(view, 1) + 4 * lobe, -100.0, 26.5)?;
            for number in 0..3 {
                let (low, high) = color_bounds(header, number, 60.0);
                check("amplitude", header.row(view, 2 + number) + 4 * lobe, low, high)?;
            }
        }
        for lobe in 0..header.mirrored {
            let offset = header.row(view, 5) + 4 * lobe;
            check("angle out of the plane of incidence", offset, limit(-FRAC_PI_2), limit(FRAC_PI_2))?;
        }
    }
    Ok(())
}

/// Reads how the views lie, and how many there are; the number of angles has been checked.
fn read_shape(bytes: &[u8]) -> Result<(Kind, usize), FormatError> {
    let count = |offset| u32_at(bytes, offset) as usize;
    let shape = Shape { thetas: count(20), azimuths: count(36), turns: count(40) };
    if !(1..=MAX_AZIMUTHS).contains(&shape.azimuths) || shape.views() > MAX_GRID_VIEWS {
        return Err(FormatError::Field { name: "number of views of a ring", offset: 36 });
    }
    if !(1..=2).contains(&shape.turns) {
        return Err(FormatError::Field { name: "turns", offset: 40 });
    }
    Ok((Kind::Grid(shape), shape.views()))
}

/// Checks heads and lobes of every view.
fn validate_grid(bytes: &[u8], header: &Header, shape: Shape) -> Result<(), FormatError> {
    debug_assert!(header.len() == bytes.len());
    for view in 0..header.views {
        let head = shape.head(view);
        let [xx, xy, yy] = [0, 1, 2].map(|i| f32_at(bytes, head + 4 * i));
        let (middle, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let reach = float::sqrt(half * half + xy * xy);
        // False for NaN too.
        if !(middle - reach >= SQUEEZE.0 && middle + reach <= SQUEEZE.1) {
            return Err(FormatError::Field { name: "squeeze matrix", offset: head });
        }
        for number in 0..3 {
            let (low, high) = color_bounds(header, number, 2.0);
            check(bytes, "diffuse albedo", head + 4 * (3 + number), low, high)?;
        }
        for lobe in 0..header.lobes {
            let at = |row| shape.row(header, view, row) + 4 * lobe;
            let [along, across] = [f32_at(bytes, at(0)), f32_at(bytes, at(1))];
            // False for NaN too.
            let inside = along * along + across * across <= PI * PI;
            if !inside {
                return Err(FormatError::Field { name: "angle of an axis", offset: at(0) });
            }
            check(bytes, "sharpness", at(2), -100.0, 26.5)?;
            for number in 0..3 {
                let (low, high) = color_bounds(header, number, 60.0);
                check(bytes, "amplitude", at(3 + number), low, high)?;
            }
        }
    }
    Ok(())
}
