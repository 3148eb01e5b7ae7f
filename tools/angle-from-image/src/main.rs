//! Reads the angle of repose from photos and frames.
//!
//! Thin: arguments in, [`photo_profile`] does the work, text, JSON, tables, pages and overlays out.

mod advice;
mod arguments;
mod interface;
mod page;
mod results;
mod ruler;
mod run;
mod summary;
mod table;

use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = command_line::parse::<arguments::Arguments>();
    command_line::finish(run::run(&arguments))
}
