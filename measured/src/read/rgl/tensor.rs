//! The container of `.bsdf` files: named arrays of numbers.
//!
//! `tensor_file\0`, two bytes of version, u32 number of fields; for each field u16 length of the name, the name, u16 number of
//! dimensions, u8 type; u64 offset of its data in the file, and a u64 for each dimension. Little endian.

use crate::ReadError;

/// Most fields, dimensions and numbers that a file may have; real ones have a dozen, five, and a few million.
const MAX_FIELDS: usize = 64;
const MAX_DIMENSIONS: usize = 8;
const MAX_NUMBERS: usize = 1 << 27;

/// Type of 32-bit floating point numbers, and the bytes of each type by its number.
const F32: u8 = 10;
const TYPE_BYTES: [usize; 12] = [0, 1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8];

/// One field, its data not yet looked at.
#[derive(Debug)]
pub struct Field<'a> {
    name: &'a [u8],
    kind: u8,
    shape: Vec<usize>,
    pub bytes: &'a [u8],
}

/// The numbers of a field, finite ones, or NaN where that may be missing; read in place, since a spectral file has a hundred megabytes of them.
#[derive(Debug)]
pub struct Numbers<'a> {
    pub shape: &'a [usize],
    bytes: &'a [u8],
}

impl Numbers<'_> {
    /// Number `i` in the order of the file.
    pub fn value(&self, i: usize) -> f64 {
        let b = &self.bytes[4 * i..4 * i + 4];
        f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
    }

    /// All of them.
    pub fn to_vec(&self) -> Vec<f64> {
        (0..self.bytes.len() / 4).map(|i| self.value(i)).collect()
    }
}

/// A parsed container.
#[derive(Debug)]
pub struct File<'a>(Vec<Field<'a>>);

/// Takes bytes off the front.
fn take<'a>(rest: &mut &'a [u8], n: usize) -> Result<&'a [u8], ReadError> {
    if rest.len() < n {
        return Err(ReadError::Content("ends inside the list of fields".into()));
    }
    let (front, back) = rest.split_at(n);
    *rest = back;
    Ok(front)
}

fn integer(rest: &mut &[u8], bytes: usize) -> Result<u64, ReadError> {
    Ok(take(rest, bytes)?.iter().rev().fold(0, |n, b| n << 8 | u64::from(*b)))
}

/// Refuses a file that has no room for the head and a field.
pub fn check_size(bytes: u64) -> Result<(), ReadError> {
    // The head is 18 bytes, a field of no name and no number 13.
    if bytes >= 31 {
        return Ok(());
    }
    Err(ReadError::Content(format!("{bytes} bytes: not an RGL .bsdf file, which has at least 31")))
}

/// Parses the list of fields.
pub fn parse(bytes: &[u8]) -> Result<File<'_>, ReadError> {
    let fail = |text: String| Err(ReadError::Content(text));
    let mut rest = bytes.strip_prefix(b"tensor_file\0").ok_or_else(|| {
        ReadError::Content("does not begin with `tensor_file`: not an RGL .bsdf file".into())
    })?;
    let version = integer(&mut rest, 2)?;
    if version & 0xff != 1 {
        return fail(format!("version {}.{}; 1.x is read", version & 0xff, version >> 8));
    }
    let count = integer(&mut rest, 4)? as usize;
    if count > MAX_FIELDS {
        return fail(format!("{count} fields; at most {MAX_FIELDS}"));
    }
    let mut fields = Vec::new();
    for _ in 0..count {
        let length = integer(&mut rest, 2)? as usize;
        let name = take(&mut rest, length)?;
        let shown = String::from_utf8_lossy(name);
        let dimensions = integer(&mut rest, 2)? as usize;
        let kind = integer(&mut rest, 1)? as u8;
        let offset = integer(&mut rest, 8)?;
        if dimensions > MAX_DIMENSIONS || kind == 0 || usize::from(kind) >= TYPE_BYTES.len() {
            return fail(format!("field {shown}: {dimensions} dimensions of type {kind}"));
        }
        let mut shape = Vec::new();
        let mut numbers = 1usize;
        for _ in 0..dimensions {
            let size = usize::try_from(integer(&mut rest, 8)?).unwrap_or(usize::MAX);
            numbers = numbers.saturating_mul(size);
            shape.push(size);
        }
        let data = usize::try_from(offset)
            .ok()
            .filter(|_| numbers <= MAX_NUMBERS)
            .and_then(|start| bytes.get(start..start.checked_add(numbers * TYPE_BYTES[usize::from(kind)])?));
        let Some(data) = data else {
            return fail(format!("field {shown}: its {numbers} numbers at {offset} are not in the file"));
        };
        fields.push(Field { name, kind, shape, bytes: data });
    }
    Ok(File(fields))
}

impl File<'_> {
    /// The field of a name.
    pub fn find(&self, name: &str) -> Option<&Field<'_>> {
        self.0.iter().find(|f| f.name == name.as_bytes())
    }

    /// The finite numbers of an f32 field with a number of dimensions, at least one number.
    pub fn numbers(&self, name: &str, dimensions: usize) -> Result<Numbers<'_>, ReadError> {
        self.numbers_that(f64::is_finite, name, dimensions)
    }

    /// The same of which some may be missing: NaN.
    pub fn numbers_or_holes(&self, name: &str, dimensions: usize) -> Result<Numbers<'_>, ReadError> {
        self.numbers_that(|v| !v.is_infinite(), name, dimensions)
    }

    fn numbers_that(
        &self,
        is_taken: impl Fn(f64) -> bool,
        name: &str,
        dimensions: usize,
    ) -> Result<Numbers<'_>, ReadError> {
        let fail = |text: String| Err(ReadError::Content(text));
        let Some(field) = self.find(name) else {
            return fail(format!("no field {name}"));
        };
        if field.kind != F32 || field.shape.len() != dimensions || field.bytes.is_empty() {
            return fail(format!("field {name}: {dimensions} dimensions of f32 were expected"));
        }
        let numbers = Numbers { shape: &field.shape, bytes: field.bytes };
        match (0..field.bytes.len() / 4).find(|&n| !is_taken(numbers.value(n))) {
            Some(n) => fail(format!("field {name}: number {n} is {}", numbers.value(n))),
            None => Ok(numbers),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file() -> Vec<u8> {
        let mut bytes = b"tensor_file\0\x01\0\x01\0\0\0\x05\0theta\x01\0\x0a".to_vec();
        let offset = bytes.len() as u64 + 16;
        bytes.extend(offset.to_le_bytes());
        bytes.extend(2u64.to_le_bytes());
        bytes.extend(0.5f32.to_le_bytes());
        bytes.extend(1.5f32.to_le_bytes());
        bytes
    }

    #[test]
    fn every_truncation_is_an_error() {
        let good = file();
        assert_eq!(parse(&good).unwrap().numbers("theta", 1).unwrap().to_vec(), [0.5, 1.5]);
        for cut in 0..good.len() {
            assert!(parse(&good[..cut]).is_err(), "{cut}");
        }
    }

    #[test]
    fn every_flipped_byte_is_an_error_or_numbers() {
        for at in 0..file().len() {
            for byte in [0, 1, 0x7f, 0x80, 0xff] {
                let mut bad = file();
                bad[at] = byte;
                if let Ok(file) = parse(&bad) {
                    let _ =
                        file.numbers("theta", 1).map(|n| assert!(n.to_vec().iter().all(|v| v.is_finite())));
                }
            }
        }
    }
}
