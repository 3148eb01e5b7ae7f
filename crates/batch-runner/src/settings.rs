//! What a user may set about the jobs of a campaign.

use serde::{Deserialize, Serialize};

use crate::Error;

/// Settings of a batch runner; in a study file the table `[runner]`.
///
/// What is not set of the jobs (partition, account, time limit, memory) is left to the batch system, and for Slurm
/// to the `SBATCH_` variables of the user's shell, which `sbatch` reads itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BatchSettings {
    /// Partition (queue) of the jobs.
    pub partition: Option<String>,
    /// Account that the jobs are charged to.
    pub account: Option<String>,
    /// Time limit of a task, s; doubled for runs that met it.
    pub time_limit_s: Option<u64>,
    /// Memory of a task, MB; doubled for runs that ran out of it.
    pub memory_mb: Option<u64>,
    /// Cores of a task: so many of its runs go on at a time.
    pub cpus_per_task: usize,
    /// Tasks of one array that may run at a time; the runs are spread over so many tasks at least.
    pub array_limit: Option<usize>,
    /// Further lines at the head of each job script, such as `#SBATCH --qos=long` or `module load gcc`.
    pub extra_lines: Vec<String>,

    /// Time of a run of cost 1, s; measured by the workers where absent.
    pub seconds_per_cost: Option<f64>,
    /// Runs are packed into tasks of about this time, s.
    pub task_seconds: f64,
    /// Runs are not spread over tasks shorter than this, s.
    pub least_task_seconds: f64,
    /// Most tasks of one submission; Slurm allows 1000 where its administrator did not set `MaxArraySize`.
    pub most_tasks: usize,

    /// How often a run that was lost (node failure, time-out, killed) is submitted again.
    pub retries: u32,
    /// Whether a stop cancels the jobs; left alone they run on, and the next call finds them.
    pub cancel_on_stop: bool,
    /// Time between two looks at the records, s, at first.
    pub poll_s: f64,
    /// Time between two looks at the records, s, when nothing has come for long.
    pub poll_most_s: f64,
    /// Time between two questions to the batch system, s.
    pub state_interval_s: f64,
    /// Time that a shared file system may take to show a file, s.
    pub file_latency_s: f64,
    /// Time between two signs of life of a task, s.
    pub heartbeat_s: f64,
    /// Time without an answer of the batch system and without a new record after which to give up, s.
    pub patience_s: f64,
    /// Time that a command of the batch system may take, s.
    pub command_limit_s: f64,

    /// Names or paths of the commands of Slurm.
    pub programs: SlurmPrograms,
    /// Command lines of another batch system.
    pub command: Option<CommandLines>,
}

/// Names or paths of the commands of Slurm.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SlurmPrograms {
    /// Submits.
    pub sbatch: String,
    /// Tells the states of jobs that wait or run.
    pub squeue: String,
    /// Tells the states of jobs that ended long ago; not asked where it does not answer.
    pub sacct: String,
    /// Cancels.
    pub scancel: String,
}

/// Command lines for a batch system other than Slurm, read by `sh`.
///
/// Placeholders are replaced by quoted values: `{script}` the job script, `{name}` the name of the job, `{log}` its
/// log file, `{cpus}`, and where they are set `{partition}`, `{account}`, `{time_limit_s}`, `{time_limit}`
/// (hours:minutes:seconds) and `{memory_mb}`; `{jobs}` are the ids of jobs, with blanks between them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CommandLines {
    /// Submits `{script}`; the last word that it prints is the id of the job.
    pub submit: String,
    /// Prints a line `ID STATE` for each of `{jobs}`; absent where there is no such command: tasks are then watched
    /// by their signs of life.
    pub status: Option<String>,
    /// Cancels `{jobs}`; where absent, tasks see at their next sign of life that they are cancelled.
    pub cancel: Option<String>,
}

impl Default for SlurmPrograms {
    fn default() -> Self {
        Self {
            sbatch: "sbatch".into(),
            squeue: "squeue".into(),
            sacct: "sacct".into(),
            scancel: "scancel".into(),
        }
    }
}

impl Default for BatchSettings {
    fn default() -> Self {
        Self {
            partition: None,
            account: None,
            time_limit_s: None,
            memory_mb: None,
            cpus_per_task: 1,
            array_limit: None,
            extra_lines: Vec::new(),
            seconds_per_cost: None,
            // Chosen here: a batch system needs seconds to begin a task, so that ten minutes make this one percent.
            task_seconds: 600.0,
            least_task_seconds: 30.0,
            most_tasks: 500,
            retries: 3,
            cancel_on_stop: true,
            poll_s: 1.0,
            poll_most_s: 15.0,
            state_interval_s: 10.0,
            file_latency_s: 30.0,
            heartbeat_s: 30.0,
            patience_s: 600.0,
            command_limit_s: 60.0,
            programs: SlurmPrograms::default(),
            command: None,
        }
    }
}

impl BatchSettings {
    /// Refuses invalid values.
    ///
    /// # Errors
    ///
    /// [`Error::Setting`] with the first of them.
    pub fn check(&self) -> Result<(), Error> {
        let times = [
            ("task_seconds", Some(self.task_seconds)),
            ("seconds_per_cost", self.seconds_per_cost),
            ("poll_s", Some(self.poll_s)),
            ("poll_most_s", Some(self.poll_most_s)),
            ("heartbeat_s", Some(self.heartbeat_s)),
            ("patience_s", Some(self.patience_s)),
            ("command_limit_s", Some(self.command_limit_s)),
        ];
        for (name, value) in times {
            if let Some(value) = value.filter(|value| !(value.is_finite() && *value > 0.0)) {
                return Err(refused(name, &value, "give a finite number above 0"));
            }
        }
        let spans = [
            ("least_task_seconds", self.least_task_seconds),
            ("state_interval_s", self.state_interval_s),
            ("file_latency_s", self.file_latency_s),
        ];
        for (name, value) in spans {
            if !(value.is_finite() && value >= 0.0) {
                return Err(refused(name, &value, "give a finite number, 0 or more"));
            }
        }
        let counts = [
            ("cpus_per_task", Some(self.cpus_per_task)),
            ("most_tasks", Some(self.most_tasks)),
            ("array_limit", self.array_limit),
        ];
        for (name, value) in counts {
            if value == Some(0) {
                return Err(refused(name, &0, "give 1 or more"));
            }
        }
        let limits = [
            ("time_limit_s", self.time_limit_s),
            ("memory_mb", self.memory_mb),
        ];
        for (name, value) in limits {
            if value == Some(0) {
                return Err(refused(
                    name,
                    &0,
                    "give 1 or more, or leave it out for the limit of the partition",
                ));
            }
        }
        if let Some(line) = self.extra_lines.iter().find(|line| line.contains('\n')) {
            return Err(refused("extra_lines", line, "give one line an entry"));
        }
        self.check_submit_line()
    }

    /// A submission that does not name the script cannot start it.
    fn check_submit_line(&self) -> Result<(), Error> {
        match &self.command {
            Some(lines) if !lines.submit.contains("{script}") => Err(refused(
                "command.submit",
                &lines.submit,
                "it must hold {script}, the script that is to run",
            )),
            _ => Ok(()),
        }
    }
}

/// Makes the error of a setting.
fn refused(name: &'static str, value: &impl ToString, limit: &'static str) -> Error {
    Error::Setting {
        name,
        value: value.to_string(),
        limit,
    }
}

#[cfg(test)]
mod tests {
    use super::BatchSettings;

    #[test]
    fn defaults_are_accepted_and_an_unknown_name_is_not() {
        BatchSettings::default().check().unwrap();
        let settings: BatchSettings =
            serde_json::from_str(r#"{"partition": "short", "command": null}"#).unwrap();
        assert_eq!(settings.partition.as_deref(), Some("short"));
        let error = serde_json::from_str::<BatchSettings>(r#"{"time_limit": 5}"#).unwrap_err();
        assert!(error.to_string().contains("time_limit_s"), "{error}");
    }

    #[test]
    fn a_value_that_cannot_be_meant_is_told_with_its_name() {
        for text in [
            r#"{"task_seconds": 0}"#,
            r#"{"seconds_per_cost": -1}"#,
            r#"{"file_latency_s": -1}"#,
            r#"{"most_tasks": 0}"#,
            r#"{"array_limit": 0}"#,
            r#"{"time_limit_s": 0}"#,
            r#"{"extra_lines": ["a\nb"]}"#,
            r#"{"command": {"submit": "qsub job"}}"#,
        ] {
            let settings: BatchSettings = serde_json::from_str(text).unwrap();
            let name = text.split('"').nth(1).unwrap();
            let error = settings.check().unwrap_err().to_string();
            assert!(error.contains(name), "{text}: {error}");
        }
    }
}
