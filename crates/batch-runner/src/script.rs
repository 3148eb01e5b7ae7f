//! The script that the batch system runs for each task.

use std::path::Path;

use crate::program::quoted;

/// What a script needs to know.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Script<'a> {
    /// Folder of the task files.
    pub(crate) folder: &'a Path,
    /// Name of the array; its tasks are `NAME-0`, `NAME-1` and so on.
    pub(crate) name: &'a str,
    /// Folder in which the worker is started.
    pub(crate) start: &'a Path,
    /// Command of the worker, without the task file.
    pub(crate) worker: &'a [String],
    /// Lines at the head.
    pub(crate) extra_lines: &'a [String],
    /// Time between two signs of life, s.
    pub(crate) heartbeat_s: f64,
    /// Whether the script itself writes the log.
    pub(crate) writes_log: bool,
}

impl Script<'_> {
    /// The text of the script, for any POSIX shell.
    ///
    /// It gives signs of life while the worker lives, ends the worker when the task has become void, passes on a
    /// signal to end, and leaves the code of the worker in a file that is written aside and renamed.
    pub(crate) fn text(&self) -> String {
        let mut extra = self.extra_lines.join("\n");
        if !extra.is_empty() {
            extra.push('\n');
        }
        let worker: Vec<String> = self.worker.iter().map(|word| quoted(word)).collect();
        let stem = quoted(&self.folder.join(self.name).display().to_string());
        let log = if self.writes_log {
            "exec > \"$task.log\" 2>&1\n"
        } else {
            ""
        };
        format!(
            r#"#!/bin/sh
{extra}task={stem}-${{SLURM_ARRAY_TASK_ID:-0}}
{log}leave() {{
    echo "$1" > "$task.exit.aside" && mv "$task.exit.aside" "$task.exit"
    exit "$1"
}}
echo 0 > "$task.beat"
[ ! -e "$task.void" ] || leave 99
cd {start} || leave 98
{worker} "$task.json" &
worker=$!
trap 'kill "$worker" 2> /dev/null' TERM INT HUP
(
    trap - TERM INT HUP
    beat=0
    while kill -0 "$worker" 2> /dev/null; do
        beat=$((beat + 1))
        echo "$beat" > "$task.beat.aside" && mv "$task.beat.aside" "$task.beat"
        [ ! -e "$task.void" ] || kill "$worker" 2> /dev/null
        sleep {heartbeat_s} &
        wait $!
    done
) > /dev/null 2>&1 &
beating=$!
wait "$worker"
code=$?
# A signal interrupts the waiting, not the worker.
while kill -0 "$worker" 2> /dev/null; do
    wait "$worker"
    code=$?
done
kill "$beating" 2> /dev/null
leave "$code"
"#,
            start = quoted(&self.start.display().to_string()),
            worker = worker.join(" "),
            heartbeat_s = self.heartbeat_s,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::Script;
    use std::fs;
    use std::path::Path;
    use std::process::{Child, Command};
    use std::time::{Duration, Instant};

    /// Starts the script of a worker in a folder.
    fn start(folder: &Path, worker: &str) -> Child {
        let words = ["sh", "-c", worker].map(str::to_owned);
        let script = Script {
            folder,
            name: "it's a",
            start: folder,
            worker: &words,
            extra_lines: &["#SBATCH --qos=long".to_owned()],
            heartbeat_s: 0.05,
            writes_log: true,
        };
        let path = folder.join("script.sh");
        fs::write(&path, script.text()).unwrap();
        Command::new("sh").arg(path).spawn().unwrap()
    }

    /// The file of the task with an ending.
    fn read(folder: &Path, ending: &str) -> String {
        fs::read_to_string(folder.join(format!("it's a-0.{ending}"))).unwrap_or_default()
    }

    #[test]
    fn script_leaves_the_code_of_the_worker_and_its_words() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        start(path, "basename \"$0\"; echo trouble >&2; exit 3")
            .wait()
            .unwrap();
        assert_eq!(read(path, "exit"), "3\n");
        assert_eq!(read(path, "log"), "it's a-0.json\ntrouble\n");
        assert!(!read(path, "beat").is_empty());
    }

    #[test]
    fn a_void_task_does_not_begin() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("it's a-0.void"), "").unwrap();
        start(folder.path(), "echo begun").wait().unwrap();
        assert_eq!(read(folder.path(), "exit"), "99\n");
        assert_eq!(read(folder.path(), "log"), "");
    }

    /// The worker would take 60 s; both ways end it within a few.
    #[test]
    fn a_task_ends_its_worker_when_it_is_void_or_told_to_end() {
        for by_signal in [false, true] {
            let folder = tempfile::tempdir().unwrap();
            let begin = Instant::now();
            let mut child = start(folder.path(), "exec sleep 60");
            while read(folder.path(), "beat")
                .trim()
                .parse::<u32>()
                .unwrap_or(0)
                < 2
            {
                assert!(begin.elapsed().as_secs() < 20, "no sign of life");
                std::thread::sleep(Duration::from_millis(10));
            }
            if by_signal {
                Command::new("kill")
                    .arg(child.id().to_string())
                    .status()
                    .unwrap();
            } else {
                fs::write(folder.path().join("it's a-0.void"), "").unwrap();
            }
            child.wait().unwrap();
            assert!(begin.elapsed().as_secs() < 20);
            assert_eq!(read(folder.path(), "exit"), "143\n", "signal 15");
        }
    }
}
