//! What can go wrong in a store.

use std::path::PathBuf;

/// Why a record was refused, or a store could not be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The inputs hold a null: a non-finite number became one, or a value is missing.
    #[error(
        "inputs hold null at {place}: NaN and infinity cannot be kept; give a finite number or leave the key out"
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
        /// Which number of it.
        field: &'static str,
        /// The number, in the unit of the observable.
        value: f64,
    },
    /// The key is not 64 hexadecimal digits in lower case.
    #[error("'{key}' is no key: a key is 64 hexadecimal digits in lower case")]
    BadKey {
        /// What was given.
        key: String,
    },
    /// A file of the store cannot be read as a record.
    #[error("{} is damaged: {reason}; delete it to let its run be done again", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What the reader met.
        reason: String,
    },
    /// A record of another form of this store.
    #[error(
        "{} has schema {found}, this program writes {expected}; use another folder or delete it",
        path.display()
    )]
    OtherSchema {
        /// The file.
        path: PathBuf,
        /// Schema in the file.
        found: u32,
        /// Schema of this program.
        expected: u32,
    },
    /// A file in the folder of the store that no store wrote.
    #[error("{} does not belong to a run store; move it out of the folder", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// A record could not be put into words.
    #[error("record {key} cannot be written as JSON")]
    Unwritable {
        /// Key of the record.
        key: String,
        /// The writer's reason.
        source: serde_json::Error,
    },
    /// The operating system refused.
    #[error("cannot {action} {}", path.display())]
    Io {
        /// What was tried.
        action: &'static str,
        /// On which file or folder.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
}
