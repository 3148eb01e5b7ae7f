//! Records of finished runs under a content key, written whole or not at all.
//!
//! A store is one folder with one file per finished run. The name of the file is the key of the
//! run: a hash of everything that the run depends on (code version, inputs, seed), so a finished run is
//! found again and a run that differs in anything is not.
//!
//! ```
//! use campaign::run_store::{Lookup, Observation, Record, Store};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let folder = tempfile::tempdir()?;
//! let store = Store::open(folder.path())?;
//! let inputs = serde_json::json!({"rpm": 15.0, "friction": 0.32});
//! let angle = Observation { mean: 38.9, sd: Some(0.6), n: 10, unit: "deg".into() };
//! let record = Record::new("0.1.0", inputs, 7)?.with_observable("angle", angle)?;
//! store.put(&record)?;
//! assert_eq!(store.get(record.key())?, Lookup::Found(record));
//! # Ok(())
//! # }
//! ```
//!
//! Processes that share a folder claim their runs ([`Store::claim`]).
//!
//! Invariants:
//! - a record file is complete or absent, whatever kills the process and whoever else writes;
//! - a file that was altered after it was written is never read as a record, and never deleted;
//! - the key does not depend on the order of map keys, nor on whether 1 was written 1.0;
//! - only finite numbers are stored.

mod canonical;
mod claim;
mod disk;
mod error;
mod failures;
mod folder;
mod machine;
mod names;
mod owner;
mod record;
mod record_file;
mod sealed;
mod set_aside;
mod store;
mod write_whole;

pub use canonical::{SCHEMA, canonical_json, run_key};
pub use claim::{Attempt, CLAIM_LIFE, Claim, Holder};
pub use disk::{Disk, Fault};
pub use error::Error;
pub use owner::{ClaimKeeper, Entry};
pub use record::{Observation, Record};
pub use sealed::{seal, seal_text, seal_without, unseal, unseal_text};
pub use set_aside::set_file_aside;
pub use store::{Lookup, Store};
pub use write_whole::{write_whole, write_whole_unsynced};
