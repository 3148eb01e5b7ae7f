//! Ctrl-C ends a loop of runs cleanly.

use anyhow::Context as _;
use command_line::NOT_MET;
use std::io::Write as _;
use std::path::Path;
use std::process::exit;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The exit code of a process that Ctrl-C ended at once, as shells have it: 128 and the number of the signal.
const ENDED_AT_ONCE: i32 = 130;

/// The flag that Ctrl-C raises: no further run begins, and running ones are finished and kept. A second Ctrl-C
/// ends the process at once.
///
/// # Errors
/// A system that does not let the process listen.
pub(crate) fn flag() -> anyhow::Result<Arc<AtomicBool>> {
    let flag = Arc::new(AtomicBool::new(false));
    let raised = Arc::clone(&flag);
    ctrlc::set_handler(move || raise(&raised)).context("cannot listen to Ctrl-C")?;
    Ok(flag)
}

/// Raises the flag; ends the process where it is raised already.
#[expect(
    clippy::exit,
    reason = "the second Ctrl-C: the user does not want to wait for the running runs"
)]
fn raise(flag: &AtomicBool) {
    if flag.swap(true, Ordering::SeqCst) {
        exit(ENDED_AT_ONCE);
    }
    // A closed standard error is no reason to go on.
    let _ = writeln!(
        std::io::stderr(),
        "stopping: the running runs are finished and kept; Ctrl-C again ends at once"
    );
}

/// The result of a loop, or the exit code of one that was stopped, after saying what is kept in the folder.
///
/// # Errors
/// Any other error of the loop.
pub(crate) fn result_or_stopped<T>(
    result: Result<T, study::Error>,
    folder: &Path,
) -> anyhow::Result<Result<T, u8>> {
    let error = match result {
        Ok(result) => return Ok(Ok(result)),
        Err(error) => error,
    };
    let Some(campaign::Error::Stopped { n_done, n_runs }) = of_campaign(&error) else {
        return Err(error.into());
    };
    // Told even when the log is quiet: it is the answer.
    let _ = writeln!(
        std::io::stderr(),
        "stopped: {n_done} of {n_runs} runs of this list are kept in {}; the same command with --resume goes on",
        folder.join("runs").display()
    );
    Ok(Err(NOT_MET))
}

/// The error of the runs in an error of a study.
fn of_campaign(error: &study::Error) -> Option<&campaign::Error> {
    match error {
        study::Error::Calibration(calibration::Error::Campaign(source))
        | study::Error::Campaign(source) => Some(source),
        _ => None,
    }
}
