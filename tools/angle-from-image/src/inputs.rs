//! Which files are meant.

use anyhow::Context as _;
use std::path::{Path, PathBuf};

/// Name endings of pictures that are taken from a folder.
const ENDINGS: [&str; 5] = ["png", "jpg", "jpeg", "bmp", "gif"];

/// The files, folders replaced by the pictures in them in the order of their names.
pub(crate) fn files(photos: &[PathBuf]) -> anyhow::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for photo in photos {
        if photo.is_dir() {
            files.extend(pictures_in(photo)?);
        } else {
            files.push(photo.clone());
        }
    }
    Ok(files)
}

/// The pictures in a folder; frames in the order of their numbers when these have equal width.
fn pictures_in(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let cannot_read = || format!("cannot read the folder {}", folder.display());
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).with_context(cannot_read)? {
        let path = entry.with_context(cannot_read)?.path();
        let ending = path
            .extension()
            .and_then(|e| e.to_str())
            .unwrap_or("")
            .to_lowercase();
        if path.is_file() && ENDINGS.contains(&ending.as_str()) {
            found.push(path);
        }
    }
    anyhow::ensure!(
        !found.is_empty(),
        "the folder {} holds no picture ({})",
        folder.display(),
        ENDINGS.join(", ")
    );
    found.sort();
    Ok(found)
}
