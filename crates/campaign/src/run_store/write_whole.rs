//! Other files than records, written completely or not at all.

use std::fs::{self, File};
use std::io::{Result, Write as _};
use std::path::Path;

/// Writes a temporary file, forces it to the disk, and renames it: a reader finds the previous file or the
/// complete new one, also after a loss of power.
///
/// # Errors
///
/// A folder that is missing or full, or another kind of file with this name; the previous file stays, and no other remains.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    write(path, bytes, File::sync_all)?;
    // The name is safe once the folder is on the disk; some systems cannot force a folder.
    if let Some(Ok(folder)) = path.parent().map(File::open) {
        let _ = folder.sync_all();
    }
    Ok(())
}

/// As [`write_whole`], but not forced to the disk: for a file that is soon rewritten.
///
/// # Errors
///
/// As [`write_whole`].
pub fn write_whole_unsynced(path: &Path, bytes: &[u8]) -> Result<()> {
    write(path, bytes, |_| Ok(()))
}

/// Writes a temporary file, calls a function on it, and renames it.
fn write(path: &Path, bytes: &[u8], before_its_name: impl Fn(&File) -> Result<()>) -> Result<()> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let aside = path.with_file_name(format!(".{name}.{}.aside", std::process::id()));
    // What a process of this number left behind, or a link that somebody planted, is not written through.
    let _ = fs::remove_file(&aside);
    let written = File::create_new(&aside)
        .and_then(|mut file| file.write_all(bytes).and_then(|()| before_its_name(&file)))
        .and_then(|()| fs::rename(&aside, path));
    if written.is_err() {
        // What was written aside is of no use.
        let _ = fs::remove_file(&aside);
    }
    written
}

#[cfg(test)]
mod tests {
    use super::{write_whole, write_whole_unsynced};
    use std::fs;

    #[test]
    fn a_written_file_replaces_the_old_one_and_leaves_nothing_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result.json");
        for write in [write_whole, write_whole_unsynced] {
            for text in ["first, and longer", "second"] {
                write(&path, text.as_bytes()).unwrap();
                assert_eq!(fs::read_to_string(&path).unwrap(), text);
            }
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    /// A folder with content has the name: the rename is refused at the last step.
    #[test]
    fn a_write_that_fails_leaves_no_piece_behind() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("report.html");
        fs::create_dir_all(path.join("occupied")).unwrap();
        for write in [write_whole, write_whole_unsynced] {
            write(&path, b"text").unwrap_err();
            assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "a piece");
        }
    }

    /// A link under the name of the aside file, planted to have another file written, is replaced and not followed.
    #[cfg(unix)]
    #[test]
    fn a_link_in_the_way_is_not_written_through() {
        let folder = tempfile::tempdir().unwrap();
        let (path, other) = (
            folder.path().join("state.json"),
            folder.path().join("other"),
        );
        fs::write(&other, "kept").unwrap();
        let aside = folder
            .path()
            .join(format!(".state.json.{}.aside", std::process::id()));
        std::os::unix::fs::symlink(&other, &aside).unwrap();
        write_whole(&path, b"new").unwrap();
        assert_eq!(fs::read_to_string(&other).unwrap(), "kept");
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
    }
}
