//! Which picture files are meant.

use crate::Error;
use std::num::NonZeroUsize;
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
    input_file::files_in(folder, &ENDINGS).map_err(|source| Error::Read {
        path: folder.to_path_buf(),
        source,
    })
}

/// One of so many pictures: of several files each `every`-th file, and all pictures in it; of one file all of it. Also the number that
/// tells which pictures of a file to take, 1 for all.
pub fn one_of(every: NonZeroUsize, files: Vec<PathBuf>) -> (Vec<PathBuf>, usize) {
    if files.len() > 1 {
        (files.into_iter().step_by(every.get()).collect(), 1)
    } else {
        (files, every.get())
    }
}
