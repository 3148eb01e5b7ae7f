//! The folder of a batch runner: writing whole or not at all, and names.

use serde::Serialize;
use std::fs::{File, OpenOptions, TryLockError};
use std::path::{Path, PathBuf};

use crate::Error;
use crate::error::io;

/// The files of one task; all begin with its name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct TaskFiles {
    /// Folder and name, without an ending.
    stem: PathBuf,
}

impl TaskFiles {
    /// The files of the task of that name in a folder.
    pub(crate) fn new(folder: &Path, name: &str) -> Self {
        Self {
            stem: folder.join(name),
        }
    }

    /// The files of the task whose file this is.
    pub(crate) fn of(task_file: &Path) -> Self {
        Self {
            stem: task_file.with_extension(""),
        }
    }

    /// What is to be run.
    pub(crate) fn task(&self) -> PathBuf {
        self.with("json")
    }

    /// What the worker says at its end.
    pub(crate) fn report(&self) -> PathBuf {
        self.with("report.json")
    }

    /// The code with which the worker ended.
    pub(crate) fn exit(&self) -> PathBuf {
        self.with("exit")
    }

    /// What changes as long as the task is alive.
    pub(crate) fn beat(&self) -> PathBuf {
        self.with("beat")
    }

    /// Where it is, the task does not begin, or ends soon.
    pub(crate) fn void(&self) -> PathBuf {
        self.with("void")
    }

    /// Output and errors of worker and batch system.
    pub(crate) fn log(&self) -> PathBuf {
        self.with("log")
    }

    /// Adds an ending.
    fn with(&self, ending: &str) -> PathBuf {
        self.stem.with_added_extension(ending)
    }
}

/// Writes a file, whole or not at all.
pub(crate) fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    campaign::run_store::write_whole(path, bytes).map_err(io("write", path))
}

/// Writes a value as JSON, whole or not at all.
pub(crate) fn write_json(path: &Path, value: &impl Serialize) -> Result<(), Error> {
    let mut bytes = serde_json::to_vec_pretty(value)
        .map_err(std::io::Error::other)
        .map_err(io("write", path))?;
    bytes.push(b'\n');
    write_whole(path, &bytes)
}

/// Makes a folder with all above it, and gives its whole path.
pub(crate) fn made_folder(path: &Path) -> Result<PathBuf, Error> {
    std::fs::create_dir_all(path).map_err(io("make folder", path))?;
    path.canonicalize().map_err(io("find", path))
}

/// Locks a file against other processes until it is dropped, also by the death of this process.
pub(crate) fn locked(path: &Path) -> Result<File, Error> {
    let file = OpenOptions::new()
        .create(true)
        .write(true)
        .truncate(false)
        .open(path)
        .map_err(io("create", path))?;
    match file.try_lock() {
        // Some shared file systems have no locks; there the user takes care.
        Ok(()) | Err(TryLockError::Error(_)) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(Error::InUse {
            path: path.to_owned(),
        }),
    }
}

/// The last lines of a log, as one line; empty where there is none.
pub(crate) fn end_of_log(path: &Path) -> String {
    /// Number of lines.
    const LINES: usize = 5;
    let text = std::fs::read(path).unwrap_or_default();
    let text = String::from_utf8_lossy(&text);
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let filled: Vec<&str> = lines.into_iter().filter(|line| !line.is_empty()).collect();
    filled[filled.len().saturating_sub(LINES)..].join(" / ")
}

#[cfg(test)]
mod tests {
    use super::{TaskFiles, end_of_log, locked, write_whole};
    use crate::Error;
    use std::path::Path;

    /// A name with a point keeps it.
    #[test]
    fn files_of_a_task_are_found_from_its_own() {
        let files = TaskFiles::new(Path::new("tasks"), "a.1-0");
        assert_eq!(files.task(), Path::new("tasks/a.1-0.json"));
        assert_eq!(TaskFiles::of(&files.task()), files);
        assert_eq!(files.report(), Path::new("tasks/a.1-0.report.json"));
    }

    #[test]
    fn a_folder_is_used_by_one_process_at_a_time() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lock");
        let lock = locked(&path).unwrap();
        assert!(matches!(locked(&path), Err(Error::InUse { .. })));
        drop(lock);
        locked(&path).unwrap();
    }

    #[test]
    fn the_end_of_a_log_is_one_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log");
        assert_eq!(end_of_log(&path), "");
        write_whole(&path, b"1\n2\n\n3\n4\n5\n6\n").unwrap();
        assert_eq!(end_of_log(&path), "2 / 3 / 4 / 5 / 6");
    }
}
