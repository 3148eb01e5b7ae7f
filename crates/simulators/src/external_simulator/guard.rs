//! A shell that ends the programs of runs if this process cannot: after `kill -9`, or when the system ends it for its memory.

use rustix::process::Pid;
use std::io::Write as _;
use std::os::unix::process::CommandExt as _;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::{Mutex, PoisonError};

/// What the shell does: it reads `+ GROUP` and `- GROUP` until its input ends, which it does with this process, however that
/// ends. Then it ends the groups that are left. Signals to a terminal or a session do not end it before.
const SCRIPT: &str = r#"trap '' HUP INT TERM
groups=
while read -r sign group; do
  case $sign in
    +) groups="$groups $group" ;;
    -) rest=
       for one in $groups; do [ "$one" = "$group" ] || rest="$rest $one"; done
       groups=$rest ;;
  esac
done
[ -n "$groups" ] || exit 0
for one in $groups; do kill -s TERM -- "-$one"; done
sleep 1
for one in $groups; do kill -s KILL -- "-$one"; done
"#;

/// Ends groups of processes when this process is gone. The shell is started with the first group; a machine on which it cannot
/// be started runs programs all the same.
#[derive(Debug, Default)]
pub(crate) struct Guard {
    /// The shell and what it reads; none before the first group.
    shell: Mutex<Option<(Child, ChildStdin)>>,
}

impl Guard {
    /// Takes a group under guard.
    pub(crate) fn watch(&self, group: Pid) {
        let mut shell = self.shell.lock().unwrap_or_else(PoisonError::into_inner);
        if shell.is_none() {
            *shell = start();
        }
        write_line(&mut shell, '+', group);
    }

    /// Lets a group go, before its number can become that of others.
    pub(crate) fn forget(&self, group: Pid) {
        let mut shell = self.shell.lock().unwrap_or_else(PoisonError::into_inner);
        write_line(&mut shell, '-', group);
    }
}

/// Starts the shell, in a group of its own so that Ctrl-C does not reach it.
fn start() -> Option<(Child, ChildStdin)> {
    let mut child = Command::new("sh")
        .args(["-c", SCRIPT])
        .current_dir("/")
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .process_group(0)
        .spawn()
        .ok()?;
    let input = child.stdin.take()?;
    Some((child, input))
}

/// Sends a line to the shell. One that is gone guards nothing, and hinders no run.
fn write_line(shell: &mut Option<(Child, ChildStdin)>, sign: char, group: Pid) {
    if let Some((_, input)) = shell {
        let _ = writeln!(input, "{sign} {}", group.as_raw_nonzero());
    }
}

impl Drop for Guard {
    fn drop(&mut self) {
        let shell = self.shell.get_mut().unwrap_or_else(PoisonError::into_inner);
        if let Some((mut child, input)) = shell.take() {
            drop(input);
            let _ = child.wait();
        }
    }
}
