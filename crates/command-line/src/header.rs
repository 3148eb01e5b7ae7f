//! Origin of a JSON output.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::Read as _;
use std::path::Path;

use anyhow::Context as _;
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};

/// Origin of a JSON output; embed it with `#[serde(flatten)]`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// The version of the workspace.
    pub version: String,
    /// The seed of all random numbers; `None` if the command uses none.
    pub seed: Option<u64>,
    /// The SHA-256 of each input file in hexadecimal digits, by the name under which it was given.
    pub inputs: BTreeMap<String, String>,
}

impl Header {
    /// Describes a result that comes from these input files.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn new(
        seed: impl Into<Option<u64>>,
        files: impl IntoIterator<Item = impl AsRef<Path>>,
    ) -> anyhow::Result<Self> {
        let mut inputs = BTreeMap::new();
        for file in files {
            let file = file.as_ref();
            inputs.insert(file.display().to_string(), file_sha256(file)?);
        }
        Ok(Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            seed: seed.into(),
            inputs,
        })
    }
}

/// Returns the SHA-256 of a file's content in hexadecimal digits.
///
/// # Errors
/// A file that cannot be read.
pub fn file_sha256(path: &Path) -> anyhow::Result<String> {
    let cannot_read = || format!("cannot read {}", path.display());
    let mut file = input::file::open(path).with_context(cannot_read)?;
    let mut hash = Sha256::new();
    let mut buffer = vec![0; 1 << 16];
    loop {
        let length = file.read(&mut buffer).with_context(cannot_read)?;
        if length == 0 {
            break;
        }
        hash.update(&buffer[..length]);
    }
    let mut digits = String::new();
    for byte in hash.finalize() {
        write!(digits, "{byte:02x}").expect("a string takes all text");
    }
    Ok(digits)
}
