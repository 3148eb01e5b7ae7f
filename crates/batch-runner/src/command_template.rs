//! Any batch system, through command lines of the user.

use std::collections::BTreeMap;

use crate::program::{output_of, quoted, shortened};
use crate::slurm::clock;
use crate::{
    BatchSettings, BatchSystem, CommandLines, Error, JobId, LossReason, TaskArray, TaskId,
    TaskState,
};

/// A batch system that command lines of the user stand for; each task is a job of its own.
#[derive(Debug, Clone)]
pub struct CommandTemplate {
    /// The command lines.
    lines: CommandLines,
    /// What the user set.
    settings: BatchSettings,
}

impl CommandTemplate {
    /// The batch system of these command lines.
    ///
    /// # Errors
    ///
    /// [`Error::Setting`] when the settings hold none.
    pub fn new(settings: &BatchSettings) -> Result<Self, Error> {
        let lines = settings.command.clone().ok_or(Error::Setting {
            name: "command",
            value: "absent".into(),
            limit: "give the command lines 'submit', 'status' and 'cancel' of your batch system",
        })?;
        Ok(Self {
            lines,
            settings: settings.clone(),
        })
    }

    /// Runs a command line.
    fn run(&self, line: &str) -> Result<String, Error> {
        let arguments = ["-c".to_owned(), line.to_owned()];
        output_of("sh", &arguments, self.settings.command_limit_s)
    }
}

impl BatchSystem for CommandTemplate {
    fn most_tasks(&self) -> usize {
        1
    }

    fn submit(&self, array: &TaskArray) -> Result<JobId, Error> {
        let line = &self.lines.submit;
        let mut values = vec![
            ("script", Some(array.script.display().to_string())),
            ("name", Some(array.name.clone())),
            ("cpus", Some(self.settings.cpus_per_task.to_string())),
            ("partition", self.settings.partition.clone()),
            ("account", self.settings.account.clone()),
            ("time_limit_s", array.time_limit_s.map(|s| s.to_string())),
            ("time_limit", array.time_limit_s.map(clock)),
            ("memory_mb", array.memory_mb.map(|mb| mb.to_string())),
        ];
        let log = array.logs.first().map(|log| log.display().to_string());
        values.push(("log", log));
        let output = self.run(&filled(line, &values)?)?;
        let id = output.split_whitespace().last();
        id.map(|id| JobId(id.to_owned())).ok_or(Error::Answer {
            command: shortened(line),
            output: String::new(),
            expected: "the id of a job as the last word",
        })
    }

    fn find(&self, _name: &str) -> Result<Option<JobId>, Error> {
        Ok(None)
    }

    fn states(&self, tasks: &[TaskId]) -> Result<BTreeMap<TaskId, TaskState>, Error> {
        let mut states = BTreeMap::new();
        let Some(line) = self.lines.status.as_ref().filter(|_| !tasks.is_empty()) else {
            return Ok(states);
        };
        let jobs: Vec<JobId> = tasks.iter().map(|task| task.job.clone()).collect();
        for line in self.run(&with_jobs(line, &jobs))?.lines() {
            let mut words = line.split_whitespace();
            let (Some(id), Some(state)) = (words.next(), words.next()) else {
                continue;
            };
            if let Some(task) = tasks.iter().find(|task| is_same(&task.job.0, id)) {
                states.insert(task.clone(), state_of(state));
            }
        }
        Ok(states)
    }

    fn cancel(&self, jobs: &[JobId]) -> Result<(), Error> {
        match &self.lines.cancel {
            Some(line) if !jobs.is_empty() => self.run(&with_jobs(line, jobs)).map(drop),
            _ => Ok(()),
        }
    }

    fn may_be_taken_later(&self, error: &Error) -> bool {
        matches!(error, Error::Silent { .. })
    }
}

/// Puts quoted values into the placeholders of a command line.
fn filled(line: &str, values: &[(&str, Option<String>)]) -> Result<String, Error> {
    let mut text = line.to_owned();
    for (name, value) in values {
        let place = format!("{{{name}}}");
        match value {
            Some(value) => text = text.replace(&place, &quoted(value)),
            None if text.contains(&place) => {
                return Err(Error::Setting {
                    name: "command.submit",
                    value: line.to_owned(),
                    limit: "it names a placeholder whose setting is not given; give it in [runner], or drop the placeholder",
                });
            }
            None => {}
        }
    }
    Ok(text)
}

/// Whether an id in a table means a job: PBS shortens `123.server.name` there.
fn is_same(job: &str, id: &str) -> bool {
    let number = |text: &str| -> Option<u64> { text.split_once('.')?.0.parse().ok() };
    job == id || (number(job).is_some() && number(job) == number(id))
}

/// Puts the ids of jobs into a command line.
fn with_jobs(line: &str, jobs: &[JobId]) -> String {
    let ids: Vec<String> = jobs.iter().map(|job| quoted(&job.0)).collect();
    line.replace("{jobs}", &ids.join(" "))
}

/// The state that a word stands for: plain words, and the letters of PBS, LSF and SGE. How a job ended is seen from its
/// files, so that all words for an end are one.
fn state_of(word: &str) -> TaskState {
    match word.to_ascii_lowercase().as_str() {
        "waiting" | "pending" | "queued" | "held" | "pend" | "psusp" | "q" | "h" | "w" | "t"
        | "qw" | "hqw" | "s" => TaskState::Waiting,
        "running" | "run" | "r" | "e" | "x" | "ususp" | "ssusp" | "b" => TaskState::Running,
        "ended" | "done" | "completed" | "finished" | "c" | "f" => TaskState::Ended { ok: true },
        "failed" | "exit" => TaskState::Ended { ok: false },
        "lost" => TaskState::Lost {
            reason: LossReason::NodeFailure,
        },
        "timeout" => TaskState::Lost {
            reason: LossReason::TimeOut,
        },
        "cancelled" => TaskState::Lost {
            reason: LossReason::Cancelled,
        },
        _ => TaskState::Unknown,
    }
}

#[cfg(test)]
mod tests {
    use super::CommandTemplate;
    use crate::{
        BatchSettings, BatchSystem as _, CommandLines, Error, JobId, TaskArray, TaskId, TaskState,
    };

    /// A system of these lines.
    fn system(submit: &str, status: &str) -> CommandTemplate {
        let settings = BatchSettings {
            command: Some(CommandLines {
                submit: submit.into(),
                status: Some(status.into()),
                cancel: None,
            }),
            ..BatchSettings::default()
        };
        CommandTemplate::new(&settings).unwrap()
    }

    /// A job of one task.
    fn array() -> TaskArray {
        TaskArray {
            name: "seedloop-1".into(),
            script: "it's here/b.sh".into(),
            logs: vec!["b-0.log".into()],
            time_limit_s: None,
            memory_mb: None,
        }
    }

    #[test]
    fn placeholders_are_quoted_and_the_last_word_is_the_id() {
        let system = system("printf 'on %s: Submitted %s' {name} {script}/12", "true");
        let id = system.submit(&array()).unwrap();
        assert_eq!(id.0, "here/b.sh/12");
        let unset = super::filled("qsub {script} -t {time_limit}", &[("time_limit", None)]);
        assert!(matches!(unset, Err(Error::Setting { .. })), "{unset:?}");
    }

    #[test]
    fn states_are_lines_of_an_id_and_a_word() {
        let lines = "printf '%s R\\n' {jobs}; echo 13.host C; echo nonsense";
        let tasks = ["12.host.org", "13.host.org"].map(|id| TaskId {
            job: JobId(id.into()),
            index: 0,
        });
        // The second is answered twice, the last word counts; hosts with points in their names are no such ids.
        let states = system("sh {script}", lines).states(&tasks).unwrap();
        assert_eq!(states[&tasks[0]], TaskState::Running);
        assert_eq!(states[&tasks[1]], TaskState::Ended { ok: true });
        assert!(!super::is_same("node.a.org:7", "node.b.org:7"));
    }
}
