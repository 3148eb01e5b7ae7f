//! How a command ends.

use std::io::Write as _;
use std::process::ExitCode;

/// The exit code of a command that did what it was asked.
pub const DONE: u8 = 0;
/// The exit code of a command that ran, but whose criterion was not met or whose answer is a
/// refusal.
pub const NOT_MET: u8 = 1;
/// The exit code of a command that could not run: bad input, bad usage, files.
pub const ERROR: u8 = 2;

/// Turns the outcome of a command into its exit code.
///
/// An error is written once on standard error, with its causes, as `error: what: why`. A reader
/// that closes the pipe early, such as `head`, has what it wanted: that is no error.
pub fn finish(outcome: anyhow::Result<u8>) -> ExitCode {
    match outcome {
        Ok(code) => ExitCode::from(code),
        Err(error) if is_broken_pipe(&error) => ExitCode::from(DONE),
        Err(error) => {
            // Nothing is left to do about a closed standard error.
            let _ = writeln!(std::io::stderr(), "error: {}", describe(&error));
            ExitCode::from(ERROR)
        }
    }
}

/// Returns whether an error came from a closed pipe.
fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        cause
            .downcast_ref::<std::io::Error>()
            .is_some_and(|error| error.kind() == std::io::ErrorKind::BrokenPipe)
    })
}

/// Writes an error with its causes; a cause that the text before already tells is left out.
fn describe(error: &anyhow::Error) -> String {
    let mut text = String::new();
    for cause in error.chain() {
        let cause = cause.to_string();
        if text.is_empty() {
            text = cause;
        } else if !text.contains(cause.trim()) {
            text.push_str(": ");
            text.push_str(&cause);
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::{DONE, ERROR, NOT_MET, describe, finish, is_broken_pipe};
    use anyhow::anyhow;
    use std::process::ExitCode;

    #[test]
    fn causes_follow_the_error_and_are_told_once() {
        let error = anyhow!("line 3 has no unit")
            .context("scene.toml: line 3 has no unit")
            .context("cannot read the scene");
        assert_eq!(
            describe(&error),
            "cannot read the scene: scene.toml: line 3 has no unit"
        );
    }

    #[test]
    fn a_broken_pipe_is_recognised_under_its_context() {
        let pipe = std::io::Error::from(std::io::ErrorKind::BrokenPipe);
        assert!(is_broken_pipe(&anyhow::Error::new(pipe).context("writing")));
        let other = std::io::Error::from(std::io::ErrorKind::NotFound);
        assert!(!is_broken_pipe(&anyhow::Error::new(other)));
    }

    #[test]
    fn outcomes_end_with_their_exit_codes() {
        assert_eq!(finish(Ok(DONE)), ExitCode::from(0));
        assert_eq!(finish(Ok(NOT_MET)), ExitCode::from(1));
        assert_eq!(finish(Err(anyhow!("bad input"))), ExitCode::from(2));
        assert_eq!(ERROR, 2);
        let pipe = std::io::Error::from(std::io::ErrorKind::BrokenPipe);
        assert_eq!(finish(Err(pipe.into())), ExitCode::from(0));
    }
}
