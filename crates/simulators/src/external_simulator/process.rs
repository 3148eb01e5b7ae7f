//! A program in a folder: its log, its time limit, its end.

use crate::external_simulator::guard::Guard;
use rustix::process::{Pid, Signal, WaitId, WaitIdOptions, kill_process_group, waitid};
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
/// Bytes of the end of a log that are reported.
const TOLD: usize = 2000;
/// First and longest wait between two looks at a running program.
const WAITS: [Duration; 2] = [Duration::from_millis(1), Duration::from_millis(200)];
/// Time that a program has to end by itself when it is asked to, so that `mpirun` can end its ranks, which have groups of their
/// own. Our choice, well within the two seconds that a stopped command has.
const GRACE: Duration = Duration::from_millis(300);

/// A program that runs.
#[derive(Debug)]
pub(crate) struct Process {
    /// The program.
    child: Child,
    /// The group of processes that it leads.
    group: Option<Pid>,
    /// How it ended; none while it runs.
    over: Option<ExitStatus>,
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
    /// Ends it if this process cannot.
    pub(crate) guard: Arc<Guard>,
}

/// Why a program gave no result; the end of its log is part of it.
pub(crate) type Failure = String;

impl Process {
    /// Starts a program in a folder; what it prints goes to a file there. With `input`, it reads what is sent to it.
    ///
    /// The program is the leader of a group of processes, which ends with it: what it leaves running is ended too.
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
        let group = Pid::from_raw(child.id().cast_signed());
        if let Some(group) = group {
            limits.guard.watch(group);
        }
        let process = Self {
            child,
            group,
            over: None,
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

    /// How the program ended; none while it runs. With it ends what it left running.
    fn ended(&mut self) -> Result<Option<ExitStatus>, Failure> {
        if self.over.is_none() && self.has_exited()? {
            self.close()?;
        }
        Ok(self.over)
    }

    /// Whether the program has exited. It is not taken off the list of processes yet, so that its number stays that of its group.
    fn has_exited(&self) -> Result<bool, Failure> {
        let Some(group) = self.group else {
            return Ok(true);
        };
        let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
        match waitid(WaitId::Pid(group), options) {
            Ok(status) => Ok(status.is_some()),
            Err(error) => Err(not_watched(&error.into())),
        }
    }

    /// Ends all that is left of the group of the program, and takes the program off the list of processes.
    fn close(&mut self) -> Result<(), Failure> {
        if let Some(group) = self.group.take() {
            // A group that is gone already needs no end.
            let _ = kill_process_group(group, Signal::KILL);
            self.limits.guard.forget(group);
        }
        let status = self.child.wait();
        self.over = Some(status.map_err(|error| not_watched(&error))?);
        Ok(())
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

    /// Ends the program and all that it started: it is asked to end, and does so at once after a short time.
    fn end(&mut self) {
        if let Some(group) = self.group {
            let _ = kill_process_group(group, Signal::TERM);
            let begin = Instant::now();
            while begin.elapsed() < GRACE && self.has_exited() == Ok(false) {
                sleep(WAITS[0]);
            }
        }
        // The run has no result in any case.
        let _ = self.close();
    }

    /// What happened, with the end of the log.
    fn told(&self, what: &str) -> Failure {
        format!("the program {what}{}", end_of_log(&self.folder.join(LOG)))
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        if self.over.is_none() {
            self.end();
        }
    }
}

/// That the system does not say how a program is.
fn not_watched(error: &io::Error) -> Failure {
    format!("the program cannot be watched: {error}")
}

/// Why a program cannot be started, with the remedy.
fn cannot_start(program: &str, error: &io::Error) -> Failure {
    let way_out = match error.kind() {
        io::ErrorKind::NotFound => ": install it, or give its path in [simulator] command",
        io::ErrorKind::PermissionDenied => ": make it executable",
        _ => "",
    };
    format!("'{program}' cannot be started ({error}){way_out}")
}

/// The end of a log as a part of a message; empty if there is none.
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

    /// The child of a program that ended well, or with a failure, would write its file after 0.4 s: a second later there is none.
    #[test]
    fn what_a_program_leaves_running_ends_with_it() {
        let folder = tempfile::tempdir().unwrap();
        for code in [0, 3] {
            let mark = folder.path().join(code.to_string());
            let script = format!("(sleep 0.4; touch {}) & exit {code}", mark.display());
            assert_eq!(shell(&script, 10.0).is_ok(), code == 0);
        }
        std::thread::sleep(Duration::from_secs(1));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    /// A program that does not answer to SIGTERM is ended all the same, and one that does can clear up first.
    #[test]
    fn a_program_is_asked_before_it_is_ended() {
        let folder = tempfile::tempdir().unwrap();
        let mark = folder.path().join("mark");
        let deaf = "trap '' TERM; sleep 60 & wait; sleep 60";
        assert!(shell(deaf, 0.1).is_err());
        let clears = format!(
            "trap 'touch {}; exit 1' TERM; sleep 60 & wait",
            mark.display()
        );
        assert!(shell(&clears, 0.1).is_err());
        assert!(mark.exists());
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
