//! Exit codes and errors of a command.

use std::io::Write as _;
use std::process::ExitCode;

/// The exit code of a command that succeeded.
pub const DONE: u8 = 0;
/// The exit code of a command that ran, but whose criterion was not met or whose answer is a
/// refusal.
pub const NOT_MET: u8 = 1;
/// The exit code of a command that could not run: bad input, bad usage, files.
pub const ERROR: u8 = 2;

/// Turns the outcome of a command into its exit code.
///
/// An error is written once on standard error, with its causes, as `error: what: why`.
pub fn finish(outcome: anyhow::Result<u8>) -> ExitCode {
    match outcome {
        Ok(code) => ExitCode::from(code),
        Err(error) => {
            // Nothing is left to do about a closed standard error.
            let _ = writeln!(std::io::stderr(), "error: {}", describe(&error));
            ExitCode::from(ERROR)
        }
    }
}

/// Writes an error with its causes, without those that the text before already contains.
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
    use super::{DONE, ERROR, NOT_MET, describe, finish};
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
    fn outcomes_end_with_their_exit_codes() {
        assert_eq!(finish(Ok(DONE)), ExitCode::from(0));
        assert_eq!(finish(Ok(NOT_MET)), ExitCode::from(1));
        assert_eq!(finish(Err(anyhow!("bad input"))), ExitCode::from(2));
        assert_eq!(ERROR, 2);
    }
}
