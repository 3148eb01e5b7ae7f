//! Files of a user, read only if they are plain files of a plausible size.
//!
//! Reading a pipe would wait, a device such as `/dev/zero` never ends, and a folder has no content: each is a separate error. Links are followed, since a user may keep his data elsewhere.

mod toml_slip;

use std::fs::File;
use std::io::{Error, ErrorKind, Read as _, Result};
use std::path::{Path, PathBuf};

pub use toml_slip::toml_slip;

/// Largest file that is read, bytes (2 GiB): our choice, ten times the largest mesh of a scanner that we know.
pub const MOST_BYTES: u64 = 1 << 31;

/// Opens a plain file.
///
/// # Errors
///
/// A file that is missing or may not be read; a folder, pipe, socket or device; more than [`MOST_BYTES`].
pub fn open(path: &Path) -> Result<File> {
    // Looked at before it is opened: opening a pipe waits for a writer.
    let meta = std::fs::metadata(path)?;
    if meta.is_dir() {
        let what = "it is a folder; give the name of a file";
        return Err(Error::new(ErrorKind::IsADirectory, what));
    }
    if !meta.is_file() {
        let what = "it is a pipe, socket or device; write its content into a plain file";
        return Err(Error::new(ErrorKind::InvalidInput, what));
    }
    if meta.len() > MOST_BYTES {
        let what = format!("it has {} bytes; at most {MOST_BYTES} are read", meta.len());
        return Err(Error::new(ErrorKind::FileTooLarge, what));
    }
    File::open(path)
}

/// Reads a plain file.
///
/// # Errors
///
/// As [`open`]; a failed read.
pub fn read(path: &Path) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    // A file may grow while it is read.
    open(path)?.take(MOST_BYTES).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Reads a plain file of UTF-8 text.
///
/// # Errors
///
/// As [`read`]; bytes that are not UTF-8 text.
pub fn read_text(path: &Path) -> Result<String> {
    String::from_utf8(read(path)?).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let what = format!("it is not UTF-8 text: byte {at} is not part of a character");
        Error::new(ErrorKind::InvalidData, what)
    })
}

/// Whether the name of a file ends, behind its last dot, in one of `endings`, written in small letters.
pub fn has_ending(path: &Path, endings: &[&str]) -> bool {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    endings.contains(&ending.to_lowercase().as_str())
}

/// The files in a folder in [the order of their names](name_order): those with one of these endings, and the others.
///
/// A hidden file belongs to the others whatever its extension: some systems keep notes on `a.png` in `._a.png`.
///
/// # Errors
///
/// A folder that cannot be listed.
pub fn files_in(folder: &Path, endings: &[&str]) -> Result<(Vec<PathBuf>, Vec<PathBuf>)> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_file() {
            all.push(path);
        }
    }
    all.sort_by_cached_key(|path| name_order(path));
    let is_meant = |path: &PathBuf| has_ending(path, endings) && !is_hidden(path);
    Ok(all.into_iter().partition(is_meant))
}

/// Whether the name of a file begins with a dot.
pub fn is_hidden(path: &Path) -> bool {
    let name = path.file_name().map(|name| name.to_string_lossy());
    name.is_some_and(|name| name.starts_with('.'))
}

/// Sort key of a name: runs of digits count by their value, so that `frame-10` comes after
/// `frame-9`; the name itself decides between equal keys.
pub fn name_order(path: &Path) -> (Vec<(String, u128)>, PathBuf) {
    let name = path.to_string_lossy();
    let mut parts = vec![(String::new(), 0_u128)];
    let mut in_number = false;
    for letter in name.chars() {
        match (letter.to_digit(10), parts.last_mut()) {
            (Some(digit), Some((_, number))) => {
                *number = number.saturating_mul(10).saturating_add(u128::from(digit));
                in_number = true;
            }
            (None, Some((text, _))) if !in_number => text.push(letter),
            _ => {
                parts.push((letter.to_string(), 0));
                in_number = false;
            }
        }
    }
    (parts, path.to_path_buf())
}

#[cfg(test)]
mod tests {
    use super::{MOST_BYTES, files_in, name_order, read, read_text};
    use std::fs::File;
    use std::path::Path;

    /// Content comes back as it was written, also through a link; bytes that are not text are reported with their place.
    #[test]
    fn a_plain_file_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.txt");
        std::fs::write(&file, "seed").unwrap();
        assert_eq!(read(&file).unwrap(), b"seed");
        let link = folder.path().join("link");
        std::os::unix::fs::symlink(&file, &link).unwrap();
        assert_eq!(read_text(&link).unwrap(), "seed");
        std::fs::write(&file, b"see\xff").unwrap();
        assert!(read_text(&file).unwrap_err().to_string().contains("byte 3"));
    }

    /// None of these is read, and none is waited for: a pipe without a writer would hang here.
    #[test]
    fn what_is_no_plain_file_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        let mode = rustix::fs::Mode::RUSR | rustix::fs::Mode::WUSR;
        rustix::fs::mkfifoat(rustix::fs::CWD, &pipe, mode).unwrap();
        for (path, word) in [
            (pipe.as_path(), "pipe"),
            (Path::new("/dev/zero"), "device"),
            (folder.path(), "folder"),
        ] {
            let told = read(path).unwrap_err().to_string();
            assert!(told.contains(word), "{}: {told}", path.display());
        }
    }

    /// A file without content on the disk that calls itself one byte too long.
    #[test]
    fn a_file_that_is_too_large_is_refused_before_it_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("large");
        File::create(&path)
            .unwrap()
            .set_len(MOST_BYTES + 1)
            .unwrap();
        let told = read(&path).unwrap_err().to_string();
        assert!(
            told.contains("2147483649") && told.contains("2147483648"),
            "{told}"
        );
    }

    /// A hidden file with the requested extension is not listed.
    #[test]
    fn hidden_files_of_a_folder_are_not_meant() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["b.png", "._b.png", "a.PNG", "a.txt"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let (meant, others) = files_in(folder.path(), &["png"]).unwrap();
        assert_eq!(
            meant,
            ["a.PNG", "b.png"].map(|name| folder.path().join(name))
        );
        assert_eq!(
            others,
            ["._b.png", "a.txt"].map(|name| folder.path().join(name))
        );
    }

    #[test]
    fn frames_come_in_the_order_of_their_numbers() {
        let mut names = ["f10.png", "f9.png", "e.png", "f09.png", "f9b.png"];
        names.sort_by_cached_key(|name| name_order(Path::new(name)));
        assert_eq!(names, ["e.png", "f09.png", "f9.png", "f9b.png", "f10.png"]);
    }
}
