//! Writing a file whole or not at all.

use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Write as _};
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};

/// Whether a file that exists may be replaced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Overwrite {
    /// An existing file is an error.
    Refuse,
    /// An existing file is replaced.
    Allow,
}

/// Writes a file whole or not at all.
///
/// The bytes go to a file aside in the same folder, reach the disk, and take their name last.
///
/// # Errors
/// A file that exists when `overwrite` is `Refuse`, a folder that does not exist, a name that
/// belongs to something other than a file, a disk that does not take the bytes.
pub fn write_new(path: &Path, bytes: &[u8], overwrite: Overwrite) -> anyhow::Result<()> {
    let cannot_write = || format!("cannot write {}", path.display());
    let folder = folder_of(path);
    if !folder.is_dir() {
        bail!(
            "cannot write {}: the folder {} does not exist; create it first",
            path.display(),
            folder.display()
        );
    }
    match fs::symlink_metadata(path) {
        Ok(_) if overwrite == Overwrite::Refuse => return Err(exists(path)),
        Ok(entry) if entry.is_dir() => bail!("cannot write {}: it is a folder", path.display()),
        _ => {}
    }
    let aside = Aside::write(path, bytes).with_context(cannot_write)?;
    match aside.take_name(path, overwrite) {
        Err(error) if error.kind() == ErrorKind::AlreadyExists => return Err(exists(path)),
        outcome => outcome.with_context(cannot_write)?,
    }
    // The new name itself reaches the disk with the folder; where folders cannot be opened as
    // files, the system takes care of it.
    if let Ok(folder) = File::open(folder) {
        let _ = folder.sync_all();
    }
    Ok(())
}

/// Returns the folder that holds a file.
fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Makes the error for a file that exists.
fn exists(path: &Path) -> anyhow::Error {
    anyhow::anyhow!(
        "{} exists: say --force to overwrite it, or give another name",
        path.display()
    )
}

/// A complete file under a name that nobody looks for; it is removed unless it takes its name.
struct Aside {
    /// Where it lies.
    path: PathBuf,
}

impl Aside {
    /// Writes the bytes beside their final name and waits for the disk.
    fn write(path: &Path, bytes: &[u8]) -> io::Result<Self> {
        let name = path.file_name().ok_or_else(|| {
            io::Error::new(ErrorKind::InvalidInput, "the name of the file is missing")
        })?;
        for attempt in 0_u32.. {
            let mut hidden = std::ffi::OsString::from(".");
            hidden.push(name);
            hidden.push(format!(".{}-{attempt}.part", std::process::id()));
            let aside = folder_of(path).join(hidden);
            let mut file = match OpenOptions::new().write(true).create_new(true).open(&aside) {
                Err(error) if error.kind() == ErrorKind::AlreadyExists => continue,
                outcome => outcome?,
            };
            let aside = Self { path: aside };
            file.write_all(bytes)?;
            file.sync_all()?;
            return Ok(aside);
        }
        Err(io::Error::from(ErrorKind::AlreadyExists))
    }

    /// Gives the file its final name.
    fn take_name(&self, path: &Path, overwrite: Overwrite) -> io::Result<()> {
        if overwrite == Overwrite::Refuse {
            // A hard link, unlike a rename, fails if the name was taken in the meantime.
            match fs::hard_link(&self.path, path) {
                Err(error) if error.kind() != ErrorKind::AlreadyExists => {
                    // A file system without hard links: the check at the start must do.
                }
                outcome => return outcome,
            }
        }
        fs::rename(&self.path, path)
    }
}

impl Drop for Aside {
    fn drop(&mut self) {
        // After a rename there is nothing to remove.
        let _ = fs::remove_file(&self.path);
    }
}
