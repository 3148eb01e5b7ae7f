//! The operations that a store asks of the disk, one by one, so that tests can make each of them fail.

use std::fs::{File, OpenOptions};
use std::io::{Error, ErrorKind, Read as _, Result, Write as _};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

/// Fault of an operation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// It fails once; the next one works again.
    Fails,
    /// The disk is full from there on: written files are cut in half, and no file can be made; reading, renaming and
    /// removing still work.
    Fills,
    /// The power is lost: what is written is cut in half, and nothing is done from there on.
    Tears,
}

/// A disk; without faults by default.
#[derive(Debug, Default)]
pub struct Disk {
    /// The fault, and the number of its operation, from 0.
    fault: Option<(Fault, u64)>,
    /// Operations so far.
    done: AtomicU64,
}

/// Allowed part of an operation.
#[derive(Debug, PartialEq, Eq)]
enum Completion {
    /// All of it.
    Whole,
    /// Half of the bytes, if it writes.
    Half(ErrorKind),
}

impl Disk {
    /// A disk whose operation with this number, from 0, fails. For tests.
    pub fn with_fault(fault: Fault, operation: u64) -> Self {
        Self {
            fault: Some((fault, operation)),
            done: AtomicU64::new(0),
        }
    }

    /// Number of operations so far.
    pub fn operations(&self) -> u64 {
        self.done.load(Ordering::SeqCst)
    }

    /// Counts an operation, and returns its allowed part.
    fn begin(&self, takes_room: bool) -> Completion {
        let number = self.done.fetch_add(1, Ordering::SeqCst);
        let Some((fault, at)) = self.fault else {
            return Completion::Whole;
        };
        match fault {
            Fault::Fails if number == at => Completion::Half(ErrorKind::Other),
            Fault::Fills if number >= at && takes_room => Completion::Half(ErrorKind::StorageFull),
            Fault::Tears if number >= at => Completion::Half(ErrorKind::Other),
            _ => Completion::Whole,
        }
    }

    /// Does an operation that writes nothing.
    fn whole<T>(&self, takes_room: bool, operation: impl FnOnce() -> Result<T>) -> Result<T> {
        match self.begin(takes_room) {
            Completion::Whole => operation(),
            Completion::Half(kind) => Err(Error::new(kind, "a fault of the disk")),
        }
    }

    /// Makes a file that does not exist yet.
    pub(crate) fn create(&self, path: &Path) -> Result<File> {
        let mut options = OpenOptions::new();
        self.whole(true, || options.write(true).create_new(true).open(path))
    }

    /// Writes all bytes.
    pub(crate) fn write(&self, file: &mut File, bytes: &[u8]) -> Result<()> {
        match self.begin(true) {
            Completion::Whole => file.write_all(bytes),
            Completion::Half(kind) => {
                file.write_all(&bytes[..bytes.len() / 2])?;
                Err(Error::new(kind, "a fault of the disk"))
            }
        }
    }

    /// Waits until the disk has a file.
    pub(crate) fn sync(&self, file: &File) -> Result<()> {
        self.whole(false, || file.sync_all())
    }

    /// Gives a file another name.
    pub(crate) fn rename(&self, from: &Path, to: &Path) -> Result<()> {
        self.whole(false, || std::fs::rename(from, to))
    }

    /// Gives a file a second, unused name.
    pub(crate) fn link(&self, file: &Path, name: &Path) -> Result<()> {
        self.whole(true, || std::fs::hard_link(file, name))
    }

    /// Removes a file.
    pub(crate) fn remove(&self, path: &Path) -> Result<()> {
        self.whole(false, || std::fs::remove_file(path))
    }

    /// Reads at most this number of bytes of an open file.
    pub(crate) fn read(&self, file: &mut File, most: u64) -> Result<Vec<u8>> {
        self.whole(false, || {
            let mut bytes = Vec::new();
            file.take(most).read_to_end(&mut bytes)?;
            Ok(bytes)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{Disk, Fault};
    use std::io::ErrorKind;

    /// The second operation, the writing, goes wrong in each way; what the third, a removal, does then tells them apart.
    #[test]
    fn each_fault_is_what_it_says() {
        for (fault, kind, removed) in [
            (Fault::Fails, ErrorKind::Other, true),
            (Fault::Fills, ErrorKind::StorageFull, true),
            (Fault::Tears, ErrorKind::Other, false),
        ] {
            let place = tempfile::tempdir().unwrap();
            let path = place.path().join("file");
            let disk = Disk::with_fault(fault, 1);
            let mut file = disk.create(&path).unwrap();
            assert_eq!(disk.write(&mut file, b"1234").unwrap_err().kind(), kind);
            assert_eq!(std::fs::read(&path).unwrap(), b"12");
            assert_eq!(disk.remove(&path).is_ok(), removed, "{fault:?}");
            let again = disk.create(&place.path().join("other"));
            assert_eq!(again.is_ok(), fault == Fault::Fails, "{fault:?}");
            assert_eq!(disk.operations(), 4);
        }
    }
}
