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
/// The bytes go to a temporary file in the same folder and reach the disk before the file gets its name.
///
/// # Errors
/// A file that exists when `overwrite` is `Refuse`, a folder that does not exist, a name that
/// belongs to something other than a file, a full disk.
pub fn write_new(path: &Path, bytes: &[u8], overwrite: Overwrite) -> anyhow::Result<()> {
    let cannot_write = || format!("cannot write {}", path.display());
    let folder = folder_of(path);
    require_place(path, overwrite)?;
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

/// Tests whether a file could be written, and leaves nothing. Call it before long work.
///
/// # Errors
/// As [`write_new`], except that the disk may be full later.
pub fn try_new(path: &Path, overwrite: Overwrite) -> anyhow::Result<()> {
    require_place(path, overwrite)?;
    let aside = Aside::write(path, &[]);
    aside.with_context(|| format!("cannot write {}", path.display()))?;
    Ok(())
}

/// Tests whether files could be written into a folder, which is made with its parents if missing; leaves no file.
/// Call it before long work.
///
/// # Errors
/// A path that contains something other than a folder, or a folder that cannot be written.
pub fn try_folder(folder: &Path) -> anyhow::Result<()> {
    let is_there = |path: &&Path| fs::symlink_metadata(path).is_ok();
    let named = |path: &Path| !path.as_os_str().is_empty();
    let above = folder.ancestors().filter(|path| named(path)).find(is_there);
    let above = above.unwrap_or(Path::new("."));
    if !above.is_dir() {
        bail!(
            "cannot write into {}: {} is not a folder; give another name",
            folder.display(),
            above.display()
        );
    }
    // The file system may refuse a name, such as one of 300 letters: that is an error, and the folder is not just missing.
    for part in folder.strip_prefix(above).unwrap_or(folder) {
        match fs::symlink_metadata(above.join(part)) {
            Err(why) if why.kind() != ErrorKind::NotFound => {
                bail!(
                    "cannot write into {}: {why}; give another name",
                    folder.display()
                )
            }
            _ => {}
        }
    }
    let aside = Aside::write(&above.join("seedloop"), &[]);
    aside.with_context(|| format!("cannot write into {}", above.display()))?;
    if above == folder {
        sweep(folder);
    }
    Ok(())
}

/// Removes temporary files that killed processes have left in a folder: those without a lock. If
/// locks are not supported, nothing is removed.
fn sweep(folder: &Path) {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    for path in entries.map(|entry| entry.path()) {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let is_aside = name.starts_with('.') && name.ends_with(PART);
        if is_aside
            && fs::symlink_metadata(&path).is_ok_and(|entry| entry.is_file())
            && File::open(&path).is_ok_and(|file| file.try_lock().is_ok())
        {
            // What stays is in nobody's way.
            let _ = fs::remove_file(&path);
        }
    }
}

/// End of the name of a temporary file.
const PART: &str = ".part";

/// Refuses a name whose folder is missing, or that belongs to a file that may not be replaced.
fn require_place(path: &Path, overwrite: Overwrite) -> anyhow::Result<()> {
    let folder = folder_of(path);
    if !folder.is_dir() {
        bail!(
            "cannot write {}: the folder {} does not exist; create it first",
            path.display(),
            folder.display()
        );
    }
    match fs::symlink_metadata(path) {
        Ok(entry) if entry.is_dir() => bail!(
            "cannot write {}: it is a folder; give the name of a file",
            path.display()
        ),
        Ok(_) if overwrite == Overwrite::Refuse => Err(exists(path)),
        // A device or a pipe would be gone behind the file.
        Ok(entry) if !entry.is_file() && !entry.is_symlink() => bail!(
            "cannot write {}: it is not a plain file; give another name",
            path.display()
        ),
        _ => Ok(()),
    }
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
        "{} exists: add --force to overwrite it, or give another name",
        path.display()
    )
}

/// A complete file under a name that nobody looks for; it is removed unless it takes its name.
struct Aside {
    /// Where it lies.
    path: PathBuf,
    /// The file, locked until it has its name.
    _file: File,
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
            hidden.push(format!(".{}-{attempt}{PART}", std::process::id()));
            let aside = folder_of(path).join(hidden);
            let mut file = match OpenOptions::new().write(true).create_new(true).open(&aside) {
                Err(error) if error.kind() == ErrorKind::AlreadyExists => continue,
                outcome => outcome?,
            };
            // Tells those who sweep that its writer lives; where there are no locks nobody sweeps.
            let _ = file.lock();
            let written = file.write_all(bytes).and_then(|()| match bytes {
                [] => Ok(()),
                _ => file.sync_all(),
            });
            let aside = Self {
                path: aside,
                _file: file,
            };
            return written.map(|()| aside);
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
