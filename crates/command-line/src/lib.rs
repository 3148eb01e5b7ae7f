//! Arguments, exit codes and file writing that all commands share.
//!
//! A tool flattens [`Common`] into its own arguments, does its work in a function that returns
//! the exit code, and hands the outcome to [`finish`]:
//!
//! ```no_run
//! use std::process::ExitCode;
//!
//! /// Counts what must be counted.
//! #[derive(clap::Parser)]
//! #[command(version)]
//! struct Arguments {
//!     #[command(flatten)]
//!     common: command_line::Common,
//! }
//!
//! fn run(arguments: &Arguments) -> anyhow::Result<u8> {
//!     arguments.common.log(|| "counting".to_owned());
//!     arguments.common.print("3")?;
//!     arguments.common.emit_json(&serde_json::json!({ "count": 3 }))?;
//!     Ok(command_line::DONE)
//! }
//!
//! fn main() -> ExitCode {
//!     let arguments: Arguments = command_line::parse();
//!     command_line::finish(run(&arguments))
//! }
//! ```
//!
//! Invariants: standard output carries results only, standard error the rest; a file is written
//! whole or not at all, and no file is overwritten unless the user says so; a reader that closes standard
//! output early, such as `head`, stops neither the work nor the files that were asked for.

mod common;
mod exit;
mod generate;
mod header;
pub mod table_file;
mod words;
mod write;

pub use common::Common;
pub use exit::{DONE, ERROR, NOT_MET, finish};
pub use generate::parse;
pub use header::{Header, file_sha256};
pub use input::quantity::significant;
pub use write::{Overwrite, try_folder, try_new, write_new};
