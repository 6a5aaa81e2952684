//! Networks that stand for measured materials, by their names: a file of weights `X.f32le`, and `X_names.txt` beside it.

use crate::out::print::shown;
use anyhow::{Context, ensure};
use sha2::{Digest, Sha256};
use srbf_fit::read::{Source, neural};
use std::path::{Path, PathBuf};

/// Largest file of networks and of their names that is read, bytes.
const MAX_FILE: u64 = 1 << 24;

/// Networks with their names.
pub struct Networks {
    pub all: Vec<(String, neural::Neural)>,
    /// SHA-256 of the weights, hexadecimal.
    sha256: String,
}

impl Networks {
    /// Reads the networks of a file, and their names.
    ///
    /// # Errors
    /// Names the file; as many names as networks are expected.
    pub fn read(path: &Path) -> anyhow::Result<Self> {
        let parse = |bytes: Vec<u8>| Ok((neural::parse(&bytes)?, format!("{:x}", Sha256::digest(&bytes))));
        let (networks, sha256) = srbf_fit::read_if(path, MAX_FILE, neural::check_size)
            .map_err(anyhow::Error::new)
            .and_then(parse)
            .with_context(|| shown(path))?;
        let list = Self::names_beside(path);
        let list = list.as_path();
        let text = |bytes: Vec<u8>| Ok(String::from_utf8(bytes)?);
        let names = srbf_fit::read_at_most(list, MAX_FILE)
            .map_err(anyhow::Error::new)
            .and_then(text)
            .with_context(|| shown(list))?;
        let names: Vec<&str> = names.split_whitespace().collect();
        ensure!(
            names.len() == networks.len(),
            "{}: {} networks, and {} names in {}",
            shown(path),
            networks.len(),
            names.len(),
            shown(list)
        );
        Ok(Self { all: names.into_iter().map(str::to_owned).zip(networks).collect(), sha256 })
    }

    /// The file of the names beside a file of networks.
    pub fn names_beside(path: &Path) -> PathBuf {
        let mut list = path.with_extension("").into_os_string();
        list.push("_names.txt");
        list.into()
    }

    /// One of them as a measurement.
    ///
    /// # Errors
    /// A name that none has.
    pub fn source(mut self, name: &str) -> anyhow::Result<Source> {
        let names = || self.all.iter().map(|entry| entry.0.as_str()).collect::<Vec<&str>>().join(", ");
        let place = self.all.iter().position(|entry| entry.0 == name);
        let place = place
            .with_context(|| format!("no network is called {name:?}; one of {} is expected", names()))?;
        let (name, network) = self.all.swap_remove(place);
        Ok(Source::evaluable(Box::new(network), name, self.sha256))
    }
}
