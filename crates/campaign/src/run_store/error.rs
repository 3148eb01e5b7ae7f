//! Errors of a store.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Reason for a refused record, or for a store that cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The inputs hold a null: a non-finite number became one, or a value is missing.
    #[error(
        "inputs hold null at {place}: NaN and infinity cannot be stored; give a finite number or omit the key"
    )]
    NullInput {
        /// Path inside the inputs, such as `inputs.condition.rpm`.
        place: String,
    },
    /// An observable holds a number that is not finite, or a negative standard deviation.
    #[error("observable {name}: {field} is {value}, it must be finite and, for sd, not below 0")]
    BadObservation {
        /// Name of the observable.
        name: String,
        /// Name of the number.
        field: &'static str,
        /// The number, in the unit of the observable.
        value: f64,
    },
    /// The key is not 64 hexadecimal digits in lower case.
    #[error("'{key}' is not a key: a key has 64 hexadecimal digits in lower case")]
    BadKey {
        /// The given text.
        key: String,
    },
    /// A file in the folder of the store that no store wrote.
    #[error("{} does not belong to a run store; move it out of the folder", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// A record cannot be written as JSON.
    #[error("record {key} cannot be written as JSON")]
    Unwritable {
        /// Key of the record.
        key: String,
        /// The writer's reason.
        source: serde_json::Error,
    },
    /// The operating system refused.
    #[error("cannot {action} {}{}", path.display(), way_out(source))]
    Io {
        /// The attempted operation.
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
}

/// Remedy for a refusal of the operating system, as the end of a sentence.
fn way_out(why: &std::io::Error) -> &'static str {
    match why.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
            "; make room there or use another folder, then start again: finished runs are kept"
        }
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            "; allow to write there or take another folder"
        }
        ErrorKind::NotADirectory | ErrorKind::AlreadyExists => {
            "; something else has this name: move it away or take another folder"
        }
        _ => "",
    }
}

/// Makes an error of a failed operation on a path.
pub(crate) fn io(action: &'static str, path: &Path) -> impl Fn(std::io::Error) -> Error {
    let path = path.to_owned();
    move |source| Error::Io {
        action,
        path: path.clone(),
        source,
    }
}
