//! The content of a `.srbf` file, a material or a sheet: written out by the same calls.

use crate::export::{can_read, export_as, json, json_of_sheet, plain_bytes, written};
use crate::language::Language;
use crate::usage::Content;
use srbf_core::{FormatError, Material, Quarter, Sheet};
use std::borrow::Cow;

/// Names of the quarters of a sheet, in the order of [`Quarter::ALL`].
pub const QUARTERS: [&str; 4] =
    ["front-reflection", "front-transmission", "back-reflection", "back-transmission"];

/// A material, or a sheet of them.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant)] // one is made of a file, and used in place
pub enum Surface<B> {
    /// One material.
    Material(Material<B>),
    /// Up to four.
    Sheet(Sheet<B>),
}

impl<B: AsRef<[u8]>> Surface<B> {
    /// Takes the bytes of either, after checking every field once.
    ///
    /// # Errors
    /// [`FormatError`], with the place.
    pub fn from_bytes(bytes: B) -> Result<Self, FormatError> {
        match bytes.as_ref().get(12) {
            Some(2) => Sheet::from_bytes(bytes).map(Self::Sheet),
            _ => Material::from_bytes(bytes).map(Self::Material),
        }
    }

    /// Whether it can be written out: as [`can_read`], of each quarter.
    pub fn can_read(&self) -> bool {
        match self {
            Self::Material(material) => can_read(material),
            Self::Sheet(sheet) => {
                Quarter::ALL.into_iter().filter_map(|of| sheet.quarter(of)).all(|of| can_read(&of))
            }
        }
    }

    /// Its bytes in plain numbers, as [`plain_bytes`], of each quarter.
    pub fn plain_bytes(&self) -> Cow<'_, [u8]> {
        match self {
            Self::Material(material) => plain_bytes(material),
            Self::Sheet(sheet) => plain_sheet(sheet),
        }
    }

    /// Writes it and the text that evaluates it, as [`export`](crate::export): of a sheet `srbf_sheet(srbf_data)` or `srbf_sheet(0)`.
    pub fn export(&self, language: Language) -> String {
        self.export_as(language, "srbf")
    }

    /// As [`export`](Self::export), with names that begin with another one than `srbf`, so that two exports stand in one program: see
    /// [`renamed`](crate::renamed). The name has to be one by [`is_name`](crate::is_name).
    pub fn export_as(&self, language: Language, name: &str) -> String {
        match self {
            Self::Material(material) => export_as(material, language, name),
            Self::Sheet(sheet) => {
                written(&plain_sheet(sheet), sheet.provenance(), Content::Sheet, language, name)
            }
        }
    }

    /// Its numbers as JSON, as [`json`]: of a sheet an object of each quarter by name, null for one that is black, and the shares of draws
    /// that are reflected in front and behind, for the heights n / 15 of `wo`.
    pub fn json(&self) -> String {
        match self {
            Self::Material(material) => json(material),
            Self::Sheet(sheet) => json_of_sheet(sheet, QUARTERS),
        }
    }
}

/// The bytes of a sheet whose quarters are in plain numbers: its own where they are already.
fn plain_sheet<B: AsRef<[u8]>>(sheet: &Sheet<B>) -> Cow<'_, [u8]> {
    let quarters = Quarter::ALL.map(|quarter| sheet.quarter(quarter));
    if quarters.iter().flatten().all(|material| material.code_bits().is_none()) {
        return sheet.bytes().into();
    }
    let plain = quarters.each_ref().map(|material| material.as_ref().map(|of| plain_bytes(of).into_owned()));
    let encoded = || {
        let mut parts: [Option<Material<&[u8]>>; 4] = [const { None }; 4];
        for (quarter, (part, bytes)) in Quarter::ALL.into_iter().zip(parts.iter_mut().zip(&plain)) {
            // The back of a sheet whose back is like the front is not stored.
            let stored = bytes.as_deref().filter(|_| !(sheet.is_symmetric() && quarter.is_back()));
            *part = stored.map(Material::from_bytes).transpose()?;
        }
        let parts = parts.each_ref().map(Option::as_ref);
        let mut bytes = vec![0; Sheet::encoded_len(parts, sheet.provenance())];
        Sheet::encode(parts, sheet.is_symmetric(), sheet.provenance(), &mut bytes)?;
        Ok::<_, FormatError>(bytes)
    };
    // There is room, and every quarter is a material.
    encoded().map_or_else(|_| sheet.bytes().into(), Cow::Owned)
}
