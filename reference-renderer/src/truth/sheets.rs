//! Sheets by name: the one that comes with the program, and `.srbf` files.

use crate::truth::stored::Bytes;
use anyhow::{Context, ensure};
use srbf_core::{FormatError, Quarter, Sheet, read_file};
use std::borrow::Cow;
use std::path::Path;

/// The sheet that is rendered where none is named.
pub const GROUND_GLASS: &str = "ground_glass";
const GROUND_GLASS_BYTES: &[u8] = include_bytes!("../../presets/sheets/ground_glass.srbf");

/// A sheet and its name.
#[derive(Clone, Debug)]
pub struct StoredSheet {
    /// `ground_glass`, or the name of the file without folder and extension.
    pub name: String,
    /// The sheet itself.
    pub sheet: Sheet<Bytes>,
    /// Whether the azimuth of the outgoing direction matters in none of its quarters.
    pub is_isotropic: bool,
}

impl StoredSheet {
    /// Finds `ground_glass`, or reads a `.srbf` file.
    ///
    /// # Errors
    /// Names the file and the place in it; says so where it is a material.
    pub fn load(name: &str) -> anyhow::Result<Self> {
        if name == GROUND_GLASS {
            return Self::new(name, Cow::Borrowed(GROUND_GLASS_BYTES));
        }
        let path = Path::new(name);
        ensure!(
            path.extension().is_some_and(|extension| extension == "srbf"),
            "sheet {name}: {GROUND_GLASS} or a .srbf file of a sheet is expected"
        );
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let read = || Self::new(&stem, Cow::Owned(read_file(path)?));
        read().with_context(|| format!("sheet {name}"))
    }

    /// Takes the bytes of a sheet.
    ///
    /// # Errors
    /// Bytes that are no sheet.
    pub fn new(name: &str, bytes: Bytes) -> anyhow::Result<Self> {
        let sheet = Sheet::from_bytes(bytes)?;
        let quarters = Quarter::ALL.into_iter().filter_map(|quarter| sheet.quarter(quarter));
        let is_isotropic = quarters.into_iter().all(|material| material.is_isotropic());
        Ok(Self { name: name.to_owned(), is_isotropic, sheet })
    }
}

/// The sheet that a file of a fit holds; `None` for a material, for a quarter that is named, and for any other file.
///
/// # Errors
/// Names a `.srbf` file that is damaged, or cannot be read.
pub fn sheet_in(name: &Path) -> anyhow::Result<Option<Sheet<Vec<u8>>>> {
    if !name.extension().is_some_and(|end| end.eq_ignore_ascii_case("srbf")) {
        return Ok(None);
    }
    let read = || match Sheet::from_bytes(read_file(name)?) {
        Err(FormatError::Kind { is_sheet: false }) => anyhow::Ok(None),
        sheet => Ok(Some(sheet?)),
    };
    read().with_context(|| format!("fit {}", name.display()))
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use crate::truth::stored::StoredMaterial;
    use srbf_core::Material;

    /// A sheet of these quarters, the back like the front.
    pub fn symmetric(quarters: [Option<&Material<Bytes>>; 2]) -> StoredSheet {
        let quarters = [quarters[0], quarters[1], None, None];
        let mut bytes = vec![0; Sheet::encoded_len(quarters, "test")];
        Sheet::encode(quarters, true, "test", &mut bytes).unwrap();
        StoredSheet::new("test", Cow::Owned(bytes)).unwrap()
    }

    /// A sheet that reflects and transmits by Lambert's law, and keeps nothing.
    pub fn lossless(reflected: [f32; 3]) -> StoredSheet {
        let half = |albedo| StoredMaterial::matte("half", albedo).unwrap();
        let [reflection, transmission] = [half(reflected), half(reflected.map(|v| 1.0 - v))];
        symmetric([Some(&reflection.material), Some(&transmission.material)])
    }

    #[test]
    fn a_sheet_is_told_from_a_material() {
        assert!(StoredSheet::load(GROUND_GLASS).unwrap().is_isotropic);
        let preset = |name: &str| format!("{}/presets/{name}", env!("CARGO_MANIFEST_DIR"));
        assert_eq!(StoredSheet::load(&preset("sheets/ground_glass.srbf")).unwrap().name, GROUND_GLASS);
        let file = preset("garnet_red.srbf");
        for (name, says) in [
            (file.as_str(), "a material where a sheet is expected"),
            ("garnet_red", "a .srbf file of a sheet"),
            ("cloth.xml", "a .srbf file of a sheet"),
            ("absent.srbf", "absent.srbf"),
        ] {
            let error = format!("{:#}", StoredSheet::load(name).unwrap_err());
            assert!(error.contains(name) && error.contains(says), "{error}");
        }
    }
}
