//! Where tests and examples find the fixtures of the workspace. No product needs this crate.
//!
//! ```
//! assert!(dev_support::fixture_files::fixture("cotton/drum.toml").is_file());
//! ```

use std::path::{Path, PathBuf};

/// The path of a file or folder below `fixtures/`.
pub fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../fixtures")
        .join(name)
}
