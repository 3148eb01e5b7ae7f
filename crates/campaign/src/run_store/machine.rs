//! Identity of this machine, and its living processes.

use crate::run_store::canonical::hexadecimal;

/// Longest part of the name of a host that is used, so that names of files stay far below 255 bytes.
const LONGEST_NAME: usize = 48;

/// Identity of this machine for others on a shared folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Machine {
    /// Name of the host.
    pub(crate) host: String,
    /// Identifies the space in which process numbers are unique: one start of one system, and within it one
    /// container. Two machines of the same name, or one before and after a restart, differ in it.
    pub(crate) process_space: String,
}

impl Machine {
    /// The machine that this process runs on.
    pub(crate) fn this() -> Self {
        let host = host_name();
        let space = format!(
            "{host}\n{}\n{}",
            std::fs::read_to_string("/proc/sys/kernel/random/boot_id").unwrap_or_default(),
            std::fs::read_link("/proc/self/ns/pid")
                .unwrap_or_default()
                .display()
        );
        Self {
            host,
            process_space: hexadecimal(space.as_bytes()).chars().take(8).collect(),
        }
    }

    /// Host and process space in letters that any file system takes.
    pub(crate) fn label(&self) -> String {
        let name = self.host.chars().take(LONGEST_NAME);
        let plain = |c: char| {
            if c.is_ascii_alphanumeric() || c == '-' {
                c
            } else {
                '_'
            }
        };
        format!(
            "{}-{}",
            name.map(plain).collect::<String>(),
            self.process_space
        )
    }
}

#[cfg(unix)]
fn host_name() -> String {
    rustix::system::uname()
        .nodename()
        .to_string_lossy()
        .into_owned()
}

/// Name of this host, which this system does not provide.
#[cfg(not(unix))]
fn host_name() -> String {
    "host".to_owned()
}

/// Whether a process of this machine has certainly ended, even if its parent has not yet waited for it.
#[cfg(unix)]
pub(crate) fn has_ended(process: u32) -> bool {
    let number = i32::try_from(process).unwrap_or(0);
    let Some(number) = rustix::process::Pid::from_raw(number) else {
        return false;
    };
    if rustix::process::test_kill_process(number) == Err(rustix::io::Errno::SRCH) {
        return true;
    }
    let state = std::fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
    // The name of the program stands in brackets before the state and may hold any sign.
    state
        .rsplit_once(") ")
        .is_some_and(|(_, rest)| rest.starts_with(['Z', 'X']))
}

/// Whether a process of this machine has certainly ended: unknown on this system.
#[cfg(not(unix))]
pub(crate) fn has_ended(_process: u32) -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::{Machine, has_ended};

    #[test]
    fn label_has_plain_letters_alone_and_is_the_same_each_time() {
        let odd = Machine {
            host: "käfer.lab/7".to_owned(),
            process_space: "0a1b2c3d".to_owned(),
        };
        assert_eq!(odd.label(), "k_fer_lab_7-0a1b2c3d");
        assert_eq!(Machine::this(), Machine::this());
    }

    /// An ended child that nobody waited for still has a number; it counts as ended all the same.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_process_lives_until_it_ends() {
        assert!(!has_ended(std::process::id()), "this one lives");
        let mut child = std::process::Command::new("true").spawn().unwrap();
        let begin = std::time::Instant::now();
        while !has_ended(child.id()) {
            assert!(begin.elapsed().as_secs() < 10, "the child never ends");
            std::thread::sleep(std::time::Duration::from_millis(2));
        }
        child.wait().unwrap();
        assert!(has_ended(child.id()), "gone for good");
        assert!(!has_ended(0) && !has_ended(u32::MAX), "no process at all");
    }
}
