//! Renaming of files that are not the record of their name, without losing them.

use std::fs::OpenOptions;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use crate::run_store::error::io;
use crate::run_store::{Error, names, record_file};

/// Largest number of files that are set aside under one name.
const MOST: usize = 10_000;

/// Renames a damaged file to the first free one of `NAME.damaged`, `NAME.damaged-2`, ..., and gives the new name.
///
/// # Errors
///
/// [`Error::Io`] when it cannot be renamed.
pub fn set_file_aside(path: &Path) -> Result<PathBuf, Error> {
    let away = reserve(path, path.is_dir())?;
    std::fs::rename(path, &away).map_err(|why| {
        unreserve(&away);
        io("set aside", path)(why)
    })?;
    Ok(away)
}

/// Renames a file, or anything else with its name, to a name that no reader reads as a record. `None` if it is gone, or
/// if another process has replaced it by the record of the name meanwhile: that record stays.
pub(crate) fn set_aside(path: &Path, key: &str) -> Result<Option<PathBuf>, Error> {
    let Ok(kind) = path.symlink_metadata() else {
        return Ok(None);
    };
    let away = reserve(path, kind.is_dir())?;
    if let Err(why) = std::fs::rename(path, &away) {
        unreserve(&away);
        if why.kind() == ErrorKind::NotFound {
            return Ok(None);
        }
        return Err(io("set aside", path)(why));
    }
    let moved = std::fs::symlink_metadata(&away);
    if moved.is_ok_and(|moved| moved.is_file())
        && std::fs::read(&away).is_ok_and(|bytes| record_file::from_bytes(&bytes, key).is_ok())
    {
        // The link fails where yet another has written the record again: then ours is one too many.
        match std::fs::hard_link(&away, path) {
            Err(why) if why.kind() != ErrorKind::AlreadyExists => {
                std::fs::rename(&away, path).map_err(io("put back", &away))?;
            }
            _ => unreserve(&away),
        }
        return Ok(None);
    }
    Ok(Some(away))
}

/// Takes the first free name, so that no other process takes it too.
fn reserve(path: &Path, is_folder: bool) -> Result<PathBuf, Error> {
    let mut name = names::damaged(path, 1);
    for number in 1..=MOST {
        name = names::damaged(path, number);
        let made = if is_folder {
            std::fs::create_dir(&name)
        } else {
            let mut options = OpenOptions::new();
            options.write(true).create_new(true).open(&name).map(drop)
        };
        match made {
            Err(why) if why.kind() == ErrorKind::AlreadyExists => {}
            made => return made.map(|()| name.clone()).map_err(io("create", &name)),
        }
    }
    Err(io("create", &name)(ErrorKind::AlreadyExists.into()))
}

/// Releases a name that holds nothing needed.
fn unreserve(name: &Path) {
    // What stays is an empty file that no reader minds.
    let _ = std::fs::remove_file(name).or_else(|_| std::fs::remove_dir(name));
}
