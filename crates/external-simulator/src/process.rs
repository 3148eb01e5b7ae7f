//! A program in a folder: its log, its time limit, its end.

use std::fs::{self, File};
use std::io;
use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Name of the file that takes what the program prints.
pub(crate) const LOG: &str = "output.log";
/// Bytes of the end of a log that are told.
const TOLD: usize = 2000;
/// First and longest wait between two looks at a running program.
const WAITS: [Duration; 2] = [Duration::from_millis(1), Duration::from_millis(200)];

/// A program that runs.
#[derive(Debug)]
pub(crate) struct Process {
    /// The program.
    child: Child,
    /// Where it runs.
    folder: PathBuf,
    /// When it began.
    begin: Instant,
    /// When it is ended before its own end.
    limits: Limits,
}

/// When a program is ended before its own end.
#[derive(Debug, Clone, Default)]
pub(crate) struct Limits {
    /// How long it may take.
    pub(crate) wall: Duration,
    /// Raised by someone who wants it to end.
    pub(crate) stop: Arc<AtomicBool>,
}

/// Why a program gave no result; the end of its log is part of it.
pub(crate) type Failure = String;

impl Process {
    /// Starts a program in a folder; what it prints goes to a file there. With `input`, it reads what is sent to it.
    ///
    /// The program is the leader of a group of processes, so that all that it starts can be ended with it.
    pub(crate) fn start(
        arguments: &[String],
        environment: &[(String, String)],
        folder: &Path,
        limits: &Limits,
        input: bool,
    ) -> Result<(Self, Option<ChildStdin>), Failure> {
        let Some((program, rest)) = arguments.split_first() else {
            return Err("the command is empty".into());
        };
        let log = |error: io::Error| format!("cannot write {}/{LOG}: {error}", folder.display());
        let output = File::create(folder.join(LOG)).map_err(log)?;
        let errors = output.try_clone().map_err(log)?;
        let mut child = Command::new(program)
            .args(rest)
            .envs(environment.iter().map(|(name, value)| (name, value)))
            .current_dir(folder)
            .stdin(if input { Stdio::piped() } else { Stdio::null() })
            .stdout(output)
            .stderr(errors)
            .process_group(0)
            .spawn()
            .map_err(|error| cannot_start(program, &error))?;
        let stdin = child.stdin.take();
        let process = Self {
            child,
            folder: folder.to_owned(),
            begin: Instant::now(),
            limits: limits.clone(),
        };
        Ok((process, stdin))
    }

    /// Waits until something is there, or the program ended or took too long, which is a failure.
    pub(crate) fn wait_for(&mut self, mut is_there: impl FnMut() -> bool) -> Result<(), Failure> {
        let mut wait = WAITS[0];
        loop {
            // In this order: what a program left at its end is there.
            let ended = self.ended()?;
            if is_there() {
                return Ok(());
            }
            if let Some(status) = ended {
                return Err(self.told(&format!("ended early with {status}")));
            }
            self.check_time()?;
            sleep(wait);
            wait = (2 * wait).min(WAITS[1]);
        }
    }

    /// Waits for the end of the program; another exit code than 0 is a failure.
    pub(crate) fn wait(mut self) -> Result<(), Failure> {
        let mut wait = WAITS[0];
        loop {
            match self.ended()? {
                Some(status) if status.success() => return Ok(()),
                Some(status) => return Err(self.told(&format!("ended with {status}"))),
                None => {}
            }
            self.check_time()?;
            sleep(wait);
            wait = (2 * wait).min(WAITS[1]);
        }
    }

    /// How the program ended; none while it runs.
    fn ended(&mut self) -> Result<Option<ExitStatus>, Failure> {
        let status = self.child.try_wait();
        status.map_err(|error| format!("the program cannot be watched: {error}"))
    }

    /// Fails where the program took too long or is to end; it is then ended.
    fn check_time(&mut self) -> Result<(), Failure> {
        if self.limits.stop.load(Ordering::SeqCst) {
            self.end();
            return Err("the program was ended: the run was stopped".into());
        }
        if self.begin.elapsed() < self.limits.wall {
            return Ok(());
        }
        self.end();
        let limit = self.limits.wall.as_secs_f64();
        Err(self.told(&format!(
            "was ended: it took longer than the wall limit of {limit} s"
        )))
    }

    /// Ends the program and all that it started.
    fn end(&mut self) {
        if let Some(group) = rustix::process::Pid::from_raw(self.child.id().cast_signed()) {
            // Where the group is gone already there is nothing to end.
            let _ = rustix::process::kill_process_group(group, rustix::process::Signal::KILL);
        }
        let _ = self.child.wait();
    }

    /// What happened, with the end of the log.
    fn told(&self, what: &str) -> Failure {
        format!("the program {what}{}", end_of_log(&self.folder.join(LOG)))
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        if matches!(self.child.try_wait(), Ok(None)) {
            self.end();
        }
    }
}

/// Why a program cannot be started, with the way out.
fn cannot_start(program: &str, error: &io::Error) -> Failure {
    let way_out = match error.kind() {
        io::ErrorKind::NotFound => ": install it, or give its path in [simulator] command",
        io::ErrorKind::PermissionDenied => ": make it executable",
        _ => "",
    };
    format!("'{program}' cannot be started ({error}){way_out}")
}

/// The end of a log as a part of a message; empty where there is none.
pub(crate) fn end_of_log(log: &Path) -> String {
    let Ok(bytes) = fs::read(log) else {
        return String::new();
    };
    let text = String::from_utf8_lossy(&bytes[bytes.len().saturating_sub(TOLD)..]);
    let text = text.trim();
    if text.is_empty() {
        return format!("; it printed nothing ({})", log.display());
    }
    format!("; the end of {}:\n{text}", log.display())
}

#[cfg(test)]
mod tests {
    use super::{Limits, Process};
    use std::sync::atomic::Ordering;
    use std::time::{Duration, Instant};

    fn shell(script: &str, limit_s: f64) -> Result<(), String> {
        shell_within(script, &within(limit_s))
    }

    fn shell_within(script: &str, limits: &Limits) -> Result<(), String> {
        let folder = tempfile::tempdir().unwrap();
        let arguments = ["sh", "-c", script].map(str::to_owned);
        let (process, _) = Process::start(&arguments, &[], folder.path(), limits, false)?;
        process.wait()
    }

    fn within(limit_s: f64) -> Limits {
        let wall = Duration::from_secs_f64(limit_s);
        Limits {
            wall,
            ..Limits::default()
        }
    }

    /// A program that would take a minute ends with its child well within the two seconds that a stopped command has: it is
    /// looked at five times a second. The child would write its file after 1 s.
    #[test]
    fn a_program_is_ended_with_its_children_when_the_flag_is_raised() {
        let folder = tempfile::tempdir().unwrap();
        let mark = folder.path().join("mark");
        let script = format!("(sleep 1; touch {}) & sleep 60", mark.display());
        let limits = within(60.0);
        let stop = limits.stop.clone();
        let begin = Instant::now();
        let raise = std::thread::spawn(move || {
            std::thread::sleep(Duration::from_millis(100));
            stop.store(true, Ordering::SeqCst);
        });
        let error = shell_within(&script, &limits).unwrap_err();
        assert!(error.contains("stopped"), "{error}");
        assert!(
            begin.elapsed() < Duration::from_secs(1),
            "{:?}",
            begin.elapsed()
        );
        raise.join().unwrap();
        std::thread::sleep(Duration::from_millis(1300));
        assert!(!mark.exists(), "the child lived on");
    }

    #[test]
    fn an_exit_code_and_the_log_are_told() {
        assert_eq!(shell("exit 0", 10.0), Ok(()));
        let error = shell("echo the mill is empty; exit 3", 10.0).unwrap_err();
        assert!(
            error.contains("exit status: 3") && error.contains("the mill is empty"),
            "{error}"
        );
        let killed = shell("kill -9 $$", 10.0).unwrap_err();
        assert!(killed.contains("signal: 9"), "{killed}");
    }

    /// The child of the program ends with it: it would write its file after 1 s.
    #[test]
    fn a_program_that_takes_too_long_is_ended_with_its_children() {
        let folder = tempfile::tempdir().unwrap();
        let mark = folder.path().join("mark");
        let script = format!("(sleep 1; touch {}) & sleep 60", mark.display());
        let begin = Instant::now();
        let error = shell(&script, 0.2).unwrap_err();
        assert!(error.contains("wall limit of 0.2 s"), "{error}");
        assert!(begin.elapsed() < Duration::from_secs(10));
        std::thread::sleep(Duration::from_millis(1300));
        assert!(!mark.exists(), "the child lived on");
    }

    #[test]
    fn a_program_that_is_not_there_is_told_with_the_way_out() {
        let folder = tempfile::tempdir().unwrap();
        let limits = within(1.0);
        let error = Process::start(&["no-such-code".into()], &[], folder.path(), &limits, false);
        let error = error.map(|_| ()).unwrap_err();
        assert!(
            error.contains("no-such-code") && error.contains("install it"),
            "{error}"
        );
    }
}
