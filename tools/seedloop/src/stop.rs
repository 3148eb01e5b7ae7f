//! Ctrl-C, SIGTERM and SIGHUP, which a closed terminal or a lost connection sends, end a command within two seconds, and what is
//! done is kept.

use anyhow::Context as _;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use std::io::{IsTerminal as _, Write as _};
use std::path::Path;
use std::process::exit;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::time::Duration;

/// The exit code of a process that a signal ended is this and the number of the signal, as shells have it.
const ENDED_BY_SIGNAL: u8 = 128;

/// Time in which the runs break off and the command ends in order; then it ends at once. Batch systems and service managers wait
/// longer; two seconds in all are our choice.
const PATIENCE: Duration = Duration::from_millis(1700);

/// What a command does when it is asked to end.
#[derive(Debug)]
pub(crate) struct Stop {
    /// Raised by the first signal: no further run begins, and running ones break off.
    flag: Arc<AtomicBool>,
    /// What the watcher shares with the command.
    state: Arc<State>,
}

/// What the watcher shares with the command.
#[derive(Debug)]
struct State {
    /// Number of the signal; 0 before it.
    signal: AtomicU8,
    /// Set once the user knows what is kept.
    told: AtomicBool,
    /// States what is kept and how to continue, as the end of a sentence.
    kept: Told,
}

/// Tells something at the moment at which it is asked.
struct Told(Box<dyn Fn() -> String + Send + Sync>);

impl std::fmt::Debug for Told {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Told").field(&(self.0)()).finish()
    }
}

impl Stop {
    /// Listens to Ctrl-C, SIGTERM and, unless `nohup` asked to ignore it, SIGHUP. `kept` states, when the command ends, what is kept and how to continue, as the end of a sentence.
    ///
    /// # Errors
    /// A system that does not let the process listen.
    pub(crate) fn new(kept: impl Fn() -> String + Send + Sync + 'static) -> anyhow::Result<Self> {
        let mut numbers = vec![SIGINT, SIGTERM];
        numbers.extend((!ignores_hang_up()).then_some(SIGHUP));
        let mut signals = Signals::new(numbers).context("cannot listen to Ctrl-C and SIGTERM")?;
        let stop = Self {
            flag: Arc::default(),
            state: Arc::new(State {
                signal: AtomicU8::new(0),
                told: AtomicBool::new(false),
                kept: Told(Box::new(kept)),
            }),
        };
        let (flag, state) = (Arc::clone(&stop.flag), Arc::clone(&stop.state));
        std::thread::spawn(move || {
            for signal in &mut signals {
                if flag.load(Ordering::SeqCst) {
                    state.end();
                }
                let number = u8::try_from(signal).unwrap_or_default();
                state.signal.store(number, Ordering::SeqCst);
                flag.store(true, Ordering::SeqCst);
                let state = Arc::clone(&state);
                std::thread::spawn(move || {
                    std::thread::sleep(PATIENCE);
                    state.end();
                });
            }
        });
        Ok(stop)
    }

    /// The same for a loop of runs whose records are in a folder.
    ///
    /// # Errors
    /// As [`Stop::new`].
    pub(crate) fn of_runs(folder: &Path) -> anyhow::Result<Self> {
        let runs = folder.join("runs");
        let told = format!(
            "finished runs are kept in {}; the same command with --resume continues",
            runs.display()
        );
        Self::new(move || told.clone())
    }

    /// The flag that the first signal raises.
    pub(crate) fn flag(&self) -> &Arc<AtomicBool> {
        &self.flag
    }

    /// The result of what was done, or the exit code where a signal ended it, after saying what is kept.
    ///
    /// # Errors
    /// The error of what was done, if no signal came.
    pub(crate) fn result<T, E>(&self, result: Result<T, E>) -> Result<Result<T, u8>, E> {
        match result {
            Ok(result) => Ok(Ok(result)),
            Err(_) if self.flag.load(Ordering::SeqCst) => Ok(Err(self.state.tell())),
            Err(error) => Err(error),
        }
    }
}

impl State {
    /// Says once what is kept, also when the log is quiet: it is the answer. Gives the exit code.
    fn tell(&self) -> u8 {
        let signal = self.signal.load(Ordering::SeqCst);
        if !self.told.swap(true, Ordering::SeqCst) {
            let name = match i32::from(signal) {
                SIGTERM => "SIGTERM",
                SIGHUP => "SIGHUP (the terminal was closed)",
                _ => "Ctrl-C",
            };
            // A closed standard error does not keep the process alive.
            let _ = writeln!(std::io::stderr(), "stopped by {name}: {}", (self.kept.0)());
        }
        ENDED_BY_SIGNAL.saturating_add(signal)
    }

    /// Ends the process: for a run that does not break off in time. What is written is written whole or not at all.
    fn end(&self) {
        exit(self.tell().into());
    }
}

/// Whether the process was started, as by `nohup`, to live on after its terminal.
fn ignores_hang_up() -> bool {
    match std::fs::read_to_string("/proc/self/status") {
        Ok(status) => is_ignored(&status, SIGHUP),
        // A system without this file does not say it; `nohup` then leaves no terminal to standard error.
        Err(_) => !std::io::stderr().is_terminal(),
    }
}

/// Whether the status of a process, as Linux writes it, has a signal among those that are ignored: bit N - 1 of `SigIgn` is signal
/// N.
fn is_ignored(status: &str, signal: i32) -> bool {
    let mask = status
        .lines()
        .find_map(|line| line.strip_prefix("SigIgn:"))
        .and_then(|digits| u64::from_str_radix(digits.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}

#[cfg(test)]
mod tests {
    use super::{SIGHUP, SIGINT, is_ignored};

    /// The line that `nohup` leads to: SIGHUP is signal 1, the lowest bit; SIGINT is 2.
    #[test]
    fn an_ignored_signal_is_read_from_the_status() {
        let status = "Name:\tseedloop\nSigBlk:\t0000000000000003\nSigIgn:\t0000000000001001\n";
        assert!(is_ignored(status, SIGHUP) && !is_ignored(status, SIGINT));
        assert!(!is_ignored("Name:\tseedloop\n", SIGHUP));
    }
}
