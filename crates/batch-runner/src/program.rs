//! Running the commands of a batch system.

use rustix::process::{Pid, Signal, kill_process_group};
use std::fs::File;
use std::io::{Read as _, Seek as _, SeekFrom};
use std::os::unix::process::CommandExt as _;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::Error;

/// Characters of an output that an error shows.
const SHOWN: usize = 500;

/// Runs a command and gives what it wrote to standard output.
///
/// It is not waited for what the command leaves running in the background, and Ctrl-C in the terminal does not reach
/// it: a submission must not be cut in two.
///
/// # Errors
///
/// [`Error::NoProgram`], [`Error::Silent`], or [`Error::Command`] when it ends with another code than 0.
pub(crate) fn output_of(
    program: &str,
    arguments: &[String],
    limit_s: f64,
) -> Result<String, Error> {
    let shown = shown_command(program, arguments);
    let broken = |source| Error::NoProgram {
        program: program.to_owned(),
        source,
    };
    // Files in place of pipes: a pipe has no end while a child of the command holds it.
    let mut output = tempfile::tempfile().map_err(broken)?;
    let mut errors = tempfile::tempfile().map_err(broken)?;
    let mut child = Command::new(program)
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(output.try_clone().map_err(broken)?)
        .stderr(errors.try_clone().map_err(broken)?)
        .process_group(0)
        .spawn()
        .map_err(broken)?;
    let begin = Instant::now();
    let mut pause = Duration::from_millis(2);
    let status = loop {
        if let Some(status) = child.try_wait().map_err(broken)? {
            break status;
        }
        if begin.elapsed().as_secs_f64() > limit_s {
            // With all that it started: a script that hangs often hangs in its child. One that ends by itself in this moment is waited for
            // below, so that its number stays that of its group.
            if let Some(group) = Pid::from_raw(child.id().cast_signed()) {
                let _ = kill_process_group(group, Signal::KILL);
            }
            let _ = child.wait();
            return Err(Error::Silent {
                command: shown,
                limit_s,
            });
        }
        std::thread::sleep(pause);
        pause = (2 * pause).min(Duration::from_millis(50));
    };
    let text = text_of(&mut output).map_err(broken)?;
    if status.success() {
        return Ok(text);
    }
    let words = text_of(&mut errors).map_err(broken)?;
    Err(Error::Command {
        command: shown,
        status: status.to_string(),
        output: shortened(if words.trim().is_empty() {
            &text
        } else {
            &words
        }),
    })
}

/// The command line as an error shows it.
pub(crate) fn shown_command(program: &str, arguments: &[String]) -> String {
    let words: Vec<&str> = std::iter::once(program)
        .chain(arguments.iter().map(String::as_str))
        .collect();
    shortened(&words.join(" "))
}

/// A text without its blank ends, cut where it is too long for a message.
pub(crate) fn shortened(text: &str) -> String {
    let text = text.trim();
    if text.chars().count() <= SHOWN {
        return text.to_owned();
    }
    let begin: String = text.chars().take(SHOWN).collect();
    format!("{begin} ...")
}

/// Puts a word into quotes so that a shell reads it as it is.
pub(crate) fn quoted(word: &str) -> String {
    format!("'{}'", word.replace('\'', r"'\''"))
}

/// All that was written to a file.
fn text_of(file: &mut File) -> std::io::Result<String> {
    let mut bytes = Vec::new();
    file.seek(SeekFrom::Start(0))?;
    file.read_to_end(&mut bytes)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

#[cfg(test)]
mod tests {
    use super::{output_of, quoted};
    use crate::Error;
    use std::time::Instant;

    /// Runs a line of `sh`.
    fn sh(line: &str, limit_s: f64) -> Result<String, Error> {
        output_of("sh", &["-c".into(), line.into()], limit_s)
    }

    #[test]
    fn output_is_given_and_a_failure_told_with_its_words() {
        assert_eq!(sh("echo 12", 10.0).unwrap(), "12\n");
        let error = sh("echo no such partition >&2; exit 3", 10.0).unwrap_err();
        let text = error.to_string();
        assert!(
            text.contains("no such partition") && text.contains('3'),
            "{text}"
        );
        let error = output_of("no-such-program", &[], 10.0).unwrap_err();
        assert!(matches!(error, Error::NoProgram { .. }), "{error}");
    }

    /// The child would write its file after 0.5 s.
    #[test]
    fn a_command_that_is_too_slow_ends_with_its_children() {
        let folder = tempfile::tempdir().unwrap();
        let mark = folder.path().join("mark");
        let line = format!("(sleep 0.5; touch {}) & wait", mark.display());
        assert!(matches!(sh(&line, 0.1), Err(Error::Silent { .. })));
        std::thread::sleep(std::time::Duration::from_secs(1));
        assert!(!mark.exists(), "the child lived on");
    }

    /// Half a second is far from the 20 s that both commands would take.
    #[test]
    fn neither_a_slow_command_nor_its_children_are_waited_for() {
        let begin = Instant::now();
        assert!(matches!(sh("sleep 20", 0.2), Err(Error::Silent { .. })));
        assert_eq!(sh("sleep 20 & echo 5", 10.0).unwrap(), "5\n");
        assert!(begin.elapsed().as_secs_f64() < 10.0);
    }

    #[test]
    fn a_quoted_word_is_read_by_a_shell_as_it_is() {
        let word = r#"it's "$HOME" \n"#;
        assert_eq!(
            sh(&format!("printf %s {}", quoted(word)), 10.0).unwrap(),
            word
        );
    }
}
