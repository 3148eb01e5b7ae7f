//! `seedloop verify`: the physics of the solver, one row a check.

use command_line::{Common, DONE, Header, NOT_MET, write_new};
use serde::Serialize;
use std::path::PathBuf;
use verification::{Row, page};

/// Checks the solver against mechanics and prints the table; exit code 1 if a row fails
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:\n  seedloop verify --only restitution-trap")]
pub(crate) struct Arguments {
    /// Only the check of this name; may be given several times
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,

    /// Writes the table as a page in Markdown
    #[arg(long, value_name = "FILE.md")]
    out: Option<PathBuf>,

    #[command(flatten)]
    common: Common,
}

/// A row with its verdict.
#[derive(Debug, Serialize)]
struct Judged {
    #[serde(flatten)]
    row: Row,
    /// `PASS` or `FAIL`.
    verdict: &'static str,
}

/// The table in JSON.
#[derive(Debug, Serialize)]
struct Report {
    /// Version, seed, inputs.
    #[serde(flatten)]
    header: Header,
    /// Number of rows that fail.
    failed: usize,
    rows: Vec<Judged>,
}

/// Does the checks and prints the table.
///
/// # Errors
/// A name that no check has, a check that cannot be done, a file that exists or cannot be written.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<u8> {
    let common = &arguments.common;
    common.try_outputs(&arguments.out)?;
    let rows = verification::run(&arguments.only, |name| {
        common.log(|| format!("checking {name}"));
    })?;
    for row in &rows {
        let verdict = verdict(row);
        common.print(format!(
            "{verdict}  {:<10}  {}: {}: expected {:.6e}, got {:.6e} {}",
            row.kind.word(),
            row.check,
            row.name,
            row.expected,
            row.got,
            row.unit
        ))?;
    }
    let failed = rows.iter().filter(|r| !r.passes()).count();
    common.print(format!("{} rows, {failed} failed", rows.len()))?;
    if let Some(file) = &arguments.out {
        write_new(file, page(&rows).as_bytes(), common.overwrite())?;
    }
    let judged = rows.into_iter().map(|row| Judged {
        verdict: verdict(&row),
        row,
    });
    common.emit_json(&Report {
        header: Header::new(None, Vec::<PathBuf>::new())?,
        failed,
        rows: judged.collect(),
    })?;
    Ok(if failed == 0 { DONE } else { NOT_MET })
}

/// The verdict on a row.
fn verdict(row: &Row) -> &'static str {
    if row.passes() { "PASS" } else { "FAIL" }
}
