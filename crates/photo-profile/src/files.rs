//! Which picture files are meant.

use crate::Error;
use input_file::name_order;
use std::path::{Path, PathBuf};

/// Name endings of pictures that are taken from a folder.
const ENDINGS: [&str; 8] = ["png", "jpg", "jpeg", "bmp", "gif", "tif", "tiff", "webp"];

/// The files, folders replaced by the pictures in them in the order of their names, numbers in them by their value.
///
/// # Errors
/// [`Error::Read`] for a folder that cannot be listed, [`Error::NoPicture`] for one without pictures.
pub fn picture_files(photos: &[PathBuf]) -> Result<Vec<PathBuf>, Error> {
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

/// The files in the folders among `photos` that are no pictures by the ending of their names, in the order of their names.
///
/// # Errors
/// [`Error::Read`] for a folder that cannot be listed.
pub fn skipped_files(photos: &[PathBuf]) -> Result<Vec<PathBuf>, Error> {
    let mut skipped = Vec::new();
    for folder in photos.iter().filter(|photo| photo.is_dir()) {
        skipped.extend(files_in(folder)?.1);
    }
    Ok(skipped)
}

/// The pictures in a folder, in the order of their names.
fn pictures_in(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let (found, _) = files_in(folder)?;
    if found.is_empty() {
        return Err(Error::NoPicture {
            folder: folder.to_path_buf(),
            endings: ENDINGS.join(", "),
        });
    }
    Ok(found)
}

/// The files in a folder that are pictures by the ending of their names, and the others, in the order of their names.
fn files_in(folder: &Path) -> Result<(Vec<PathBuf>, Vec<PathBuf>), Error> {
    let cannot_read = |source| Error::Read {
        path: folder.to_path_buf(),
        source,
    };
    let mut all = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(cannot_read)? {
        let path = entry.map_err(cannot_read)?.path();
        if path.is_file() {
            all.push(path);
        }
    }
    all.sort_by_cached_key(|path| name_order(path));
    Ok(all.into_iter().partition(|path| {
        let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("");
        ENDINGS.contains(&ending.to_lowercase().as_str())
    }))
}
