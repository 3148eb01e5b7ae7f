//! LAMMPS or LIGGGHTS as a partner in a conversation: it reads its script line by line, so that it continues for as long as the
//! bed asks for, and not for a time that was guessed before.

use crate::exchange::{Moment, dump};
use crate::external_simulator::process::{Failure, Limits, Process};
use std::fs::{self, File};
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};
use std::process::ChildStdin;
use std::time::Duration;

/// Name of the dump.
pub(crate) const DUMP: &str = "bed.dump";

/// A code that waits for commands.
#[derive(Debug)]
pub(crate) struct Session {
    /// The code.
    process: Process,
    /// What it reads.
    input: ChildStdin,
    /// Where it runs.
    folder: PathBuf,
    /// Number of parts that it ran.
    parts: usize,
    /// Bytes of the dump that were read.
    read: u64,
    /// Lines of the dump that were read.
    lines: usize,
}

impl Session {
    /// Starts the code in a folder that holds the files of the deck.
    pub(crate) fn start(
        command: &[String],
        environment: &[(String, String)],
        folder: &Path,
        limits: &Limits,
    ) -> Result<Self, Failure> {
        let (process, input) = Process::start(command, environment, folder, limits, true)?;
        Ok(Self {
            process,
            input: input.ok_or("the program takes no input")?,
            folder: folder.to_owned(),
            parts: 0,
            read: 0,
            lines: 0,
        })
    }

    /// Sends commands and waits until they are done; the moments that the code dumped meanwhile.
    pub(crate) fn run(&mut self, commands: &str) -> Result<Vec<Moment>, Failure> {
        self.parts += 1;
        let mark = format!("part{}.done", self.parts);
        let text = format!("{commands}\nprint \"done\" file {mark} screen no\n");
        let sent = self
            .input
            .write_all(text.as_bytes())
            .and_then(|()| self.input.flush());
        let path = self.folder.join(mark);
        // A code that ended takes no commands; why it ended is reported by its log.
        let result = self.process.wait_for(|| path.exists());
        result?;
        sent.map_err(|error| format!("the program takes no commands: {error}"))?;
        self.new_moments()
    }

    /// Ends the conversation; the code must end well.
    pub(crate) fn finish(self) -> Result<(), Failure> {
        drop(self.input);
        self.process.wait()
    }

    /// What the dump holds beyond what was read before.
    fn new_moments(&mut self) -> Result<Vec<Moment>, Failure> {
        let path = self.folder.join(DUMP);
        if !path.exists() {
            return Ok(Vec::new());
        }
        let told = |error: std::io::Error| format!("cannot read {}: {error}", path.display());
        let mut file = File::open(&path).map_err(told)?;
        file.seek(SeekFrom::Start(self.read)).map_err(told)?;
        let mut text = String::new();
        self.read += file.read_to_string(&mut text).map_err(told)? as u64;
        let name = path.display().to_string();
        let moments = dump::read(&text, &name, self.lines + 1).map_err(|e| e.to_string())?;
        self.lines += text.lines().count();
        Ok(moments)
    }
}

/// First line that a code prints about itself, which holds its version.
///
/// # Errors
///
/// A code that cannot be started or says nothing of the kind.
pub(crate) fn version_line(
    command: &[String],
    environment: &[(String, String)],
    folder: &Path,
    name: &str,
) -> Result<String, Failure> {
    let limits = Limits {
        wall: Duration::from_mins(1),
        ..Limits::default()
    };
    let (process, input) = Process::start(command, environment, folder, &limits, true)?;
    drop(input);
    process.wait()?;
    let log = folder.join(crate::external_simulator::process::LOG);
    let text = fs::read_to_string(&log).unwrap_or_default();
    let line = text.lines().find(|line| line.contains(name));
    line.map(|line| line.trim().to_owned())
        .ok_or_else(|| format!("'{}' does not call itself {name}", command.join(" ")))
}
