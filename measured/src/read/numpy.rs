//! Reader of NumPy's `.npy`: an array of rows, with names of its fields or in a usual order.

use super::conventions::Conventions;
use super::csv;
use super::intake::Intake;
use crate::ReadError;

/// First bytes.
pub(super) const HEAD: &[u8] = b"\x93NUMPY";

/// The columns that an array without names is taken to have.
const USUAL: [(usize, &[&str]); 2] = [
    (5, &["theta_i", "phi_i", "theta_o", "phi_o", "value"]),
    (7, &["theta_i", "phi_i", "theta_o", "phi_o", "r", "g", "b"]),
];
const VECTORS: [(usize, &[&str]); 2] = [
    (7, &["wi_x", "wi_y", "wi_z", "wo_x", "wo_y", "wo_z", "value"]),
    (9, &["wi_x", "wi_y", "wi_z", "wo_x", "wo_y", "wo_z", "r", "g", "b"]),
];

/// Advice for arrays that are not read.
const WAY: &str = "save it with names, as a structured array or by numpy.savetxt with header='theta_i phi_i theta_o phi_o value'; or give it \
                   in Python to srbf_brdf.table(wo, wi, f)";

/// The kind of a number: letter, bytes, and whether the first byte is the largest.
#[derive(Clone, Copy)]
struct Kind {
    letter: u8,
    size: usize,
    is_big: bool,
}

impl Kind {
    fn of(text: &str) -> Option<Self> {
        let [order, letter, size] = *text.as_bytes() else { return None };
        let size = usize::from(size.checked_sub(b'0')?);
        let fits = match letter {
            b'f' => matches!(size, 4 | 8),
            b'i' | b'u' => matches!(size, 1 | 2 | 4 | 8),
            _ => false,
        };
        fits.then_some(Self { letter, size, is_big: order == b'>' })
    }

    fn number(self, bytes: &[u8]) -> f64 {
        let mut wide = [0u8; 8];
        wide[..self.size].copy_from_slice(bytes);
        if self.is_big {
            wide[..self.size].reverse();
        }
        let bits = u64::from_le_bytes(wide);
        let shift = 64 - 8 * self.size as u32;
        match (self.letter, self.size) {
            (b'f', 4) => f64::from(f32::from_bits(bits as u32)),
            (b'f', _) => f64::from_bits(bits),
            (b'i', _) => ((bits << shift) as i64 >> shift) as f64,
            _ => bits as f64,
        }
    }
}

/// Parses the bytes of a file.
///
/// # Errors
/// [`ReadError`] for a damaged file, and for arrays that are no rows of samples.
pub fn parse(bytes: &[u8], conventions: &Conventions) -> Result<Intake, ReadError> {
    let fail = |text: String| ReadError::Content(format!("NumPy array {text}"));
    let damaged = || fail("with a damaged head".into());
    let version = *bytes.get(6).ok_or_else(damaged)?;
    let (length, at) = match version {
        1 => (bytes.get(8..10).map(|b| usize::from(u16::from_le_bytes([b[0], b[1]]))), 10),
        _ => (bytes.get(8..12).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize), 12),
    };
    let end = length.and_then(|length| length.checked_add(at)).ok_or_else(damaged)?;
    let head = bytes.get(at..end).and_then(|head| std::str::from_utf8(head).ok()).ok_or_else(damaged)?;
    let after =
        |key: &str| head.split_once(key).map(|parts| parts.1.trim_start_matches([':', ' ', '\'', '"']));
    let described = head.split_once("'descr':").map(|parts| parts.1.trim_start()).ok_or_else(damaged)?;
    let is_fortran = after("fortran_order").ok_or_else(damaged)?.starts_with("True");
    let shape = after("shape").and_then(|s| s.strip_prefix('(')?.split_once(')')).ok_or_else(damaged)?.0;
    let shape: Vec<usize> = shape.split(',').map_while(|n| n.trim().parse().ok()).collect();
    let data = &bytes[end..];
    let is_structured = described.starts_with('[');
    let quoted: Vec<&str> = if is_structured {
        described.split_once(']').ok_or_else(damaged)?.0.split('\'').skip(1).step_by(2).collect()
    } else {
        described.split('\'').skip(1).step_by(2).take(1).collect()
    };
    let kind = |text: &&str| {
        Kind::of(text).ok_or_else(|| {
            fail(format!(
                "of kind `{}`: numbers of 32 or 64 bits are read; {WAY}",
                text.chars().take(20).collect::<String>()
            ))
        })
    };
    let (names, kinds, rows): (Vec<&str>, Vec<Kind>, usize) = if is_structured {
        let kinds = quoted.iter().skip(1).step_by(2).map(kind).collect::<Result<Vec<_>, _>>()?;
        let rows = shape.iter().try_fold(1usize, |all, n| all.checked_mul(*n)).ok_or_else(damaged)?;
        (quoted.iter().copied().step_by(2).collect(), kinds, rows)
    } else {
        let [rows, columns] = *shape else {
            return Err(fail(format!("of shape {shape:?}: rows by columns are expected; {WAY}")));
        };
        let kind = kind(quoted.first().ok_or_else(damaged)?)?;
        if columns > 1000 {
            return Err(fail(format!("of shape {shape:?}: a sample a row is expected; {WAY}")));
        }
        (Vec::new(), vec![kind; columns], rows)
    };
    let width: usize = kinds.iter().map(|kind| kind.size).sum();
    let size = width.checked_mul(rows).filter(|size| *size > 0 && *size == data.len());
    let Some(_) = size else {
        let found = data.len();
        return Err(fail(format!(
            "of shape {shape:?}: {found} bytes of numbers, which is another count; or no rows"
        )));
    };
    let starts: Vec<usize> =
        kinds.iter().scan(0, |at, kind| Some(std::mem::replace(at, *at + kind.size))).collect();
    let number = |row: usize, column: usize| {
        let kind = kinds[column];
        let at = match is_fortran && !is_structured {
            true => (column * rows + row) * kind.size,
            false => row * width + starts[column],
        };
        kind.number(&data[at..at + kind.size])
    };
    let mut notes = Vec::new();
    let names: Vec<String> = if is_structured {
        names.into_iter().map(str::to_owned).collect()
    } else {
        let is_unit = |row: usize, from: usize| {
            ((from..from + 3).map(|c| number(row, c).powi(2)).sum::<f64>() - 1.0).abs() < 1e-3
        };
        let are_vectors = kinds.len() >= 7 && (0..rows).all(|row| is_unit(row, 0) && is_unit(row, 3));
        let known = if are_vectors { VECTORS } else { USUAL };
        let Some((_, names)) = known.iter().find(|known| known.0 == kinds.len()) else {
            return Err(fail(format!("of shape {shape:?}, without names of its columns: {WAY}")));
        };
        notes.push(format!(
            "the columns have no names, and are taken as {}; in another order, save them with names",
            names.join(", ")
        ));
        names.iter().map(|name| (*name).to_owned()).collect()
    };
    let row = |n: usize| (n + 1, (0..names.len()).map(|c| number(n, c).to_string()).collect());
    csv::parse_rows("NumPy array", &names, (0..rows).map(row).collect(), notes, conventions)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(head: &str, numbers: &[f64]) -> Vec<u8> {
        let mut bytes = [HEAD, &[1, 0]].concat();
        bytes.extend((head.len() as u16).to_le_bytes());
        bytes.extend(head.bytes());
        numbers.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
        bytes
    }

    #[test]
    fn rows_with_and_without_names_are_read_and_damage_is_an_error() {
        let parse = |bytes: &[u8]| parse(bytes, &Conventions::default());
        let rows = [10.0, 0.0, 40.0, 180.0, 0.25, 20.0, 0.0, 50.0, 180.0, 0.5];
        let plain = file("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 5), }", &rows);
        let intake = parse(&plain).unwrap();
        assert_eq!((intake.rows.len(), intake.rows[1].rgb), (2, [0.5; 3]));
        assert!(intake.notes.iter().any(|note| note.text.contains("no names")), "{:?}", intake.notes);
        let columns = [10.0, 20.0, 0.0, 0.0, 40.0, 50.0, 180.0, 180.0, 0.25, 0.5];
        let turned = file("{'descr': '<f8', 'fortran_order': True, 'shape': (2, 5), }", &columns);
        assert_eq!(parse(&turned).unwrap().rows, intake.rows);
        let named = "{'descr': [('BRDF', '<f8'), ('AOI', '<f8'), ('theta_r', '<f8')], 'fortran_order': False, 'shape': (2,), }";
        let found = parse(&file(named, &[0.25, 10.0, 40.0, 0.5, 20.0, 50.0])).unwrap();
        assert_eq!((found.rows.len(), found.rows[0].rgb), (2, [0.25; 3]));
        for cut in 0..plain.len() {
            assert!(parse(&plain[..cut]).is_err(), "{cut}");
        }
        let odd = file("{'descr': '|O', 'fortran_order': False, 'shape': (2, 5), }", &rows);
        assert!(parse(&odd).unwrap_err().to_string().contains("srbf_brdf.table"));
        let shape = file("{'descr': '<f8', 'fortran_order': False, 'shape': (5, 2), }", &rows);
        assert!(parse(&shape).unwrap_err().to_string().contains("[5, 2]"));
    }

    #[test]
    fn seven_columns_of_two_unit_vectors_and_a_value_are_directions() {
        let rows = [0.6, 0.0, 0.8, -0.28, 0.0, 0.96, 0.25, 0.0, 0.6, 0.8, 0.0, -0.8, 0.6, 0.5];
        let bytes = file("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 7), }", &rows);
        let intake = parse(&bytes, &Conventions::default()).unwrap();
        for (row, wanted) in intake.rows.iter().zip(rows.chunks(7)) {
            let found = [row.wi, row.wo].concat();
            assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-9), "{row:?} {wanted:?}");
            assert_eq!(row.rgb, [wanted[6]; 3]);
        }
        assert_eq!(intake.rows.len(), 2);
    }
}
