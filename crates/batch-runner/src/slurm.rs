//! Slurm: `sbatch`, `squeue`, `sacct` and `scancel`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::program::{output_of, shortened, shown_command};
use crate::{BatchSettings, BatchSystem, Error, JobId, LossReason, TaskArray, TaskId, TaskState};

/// What Slurm says where a submission may be taken later: the controller is away or busy, or the user has as many jobs
/// as allowed.
const LATER: [&str; 9] = [
    "Unable to contact slurm controller",
    "Connection refused",
    "Socket timed out",
    "Zero Bytes were transmitted",
    "temporarily un",
    "Communication connection failure",
    "in an standby mode",
    "SubmitJob",
    "Unable to establish",
];

/// Slurm, through its commands.
///
/// Slurm's own requeue is off: a lost task is submitted again by the runner, which counts and tells it.
#[derive(Debug, Clone)]
pub struct Slurm {
    /// What the user set.
    settings: BatchSettings,
}

impl Slurm {
    /// Slurm with the settings of a user.
    pub fn new(settings: &BatchSettings) -> Self {
        Self {
            settings: settings.clone(),
        }
    }

    /// Runs one of the commands.
    fn ask(&self, program: &str, arguments: &[String]) -> Result<String, Error> {
        output_of(program, arguments, self.settings.command_limit_s)
    }

    /// What `squeue` lists of the user's jobs, also of those that ended a while ago: fields parted by bars.
    fn queue(&self, format: &str, name: Option<&str>) -> Result<String, Error> {
        // By user and not by id: an id that the controller has forgotten would be an error.
        let mut arguments = words(&["--noheader", "--array", "--me", "--states=all"]);
        arguments.push(format!("--format={format}"));
        arguments.extend(name.map(|name| format!("--name={name}")));
        self.ask(&self.settings.programs.squeue, &arguments)
    }

    /// What `sacct` lists, fields parted by bars; nothing where there is no accounting.
    fn accounts(&self, arguments: &[String]) -> String {
        let mut all = words(&["--noheader", "--parsable2", "--allocations"]);
        all.extend_from_slice(arguments);
        self.ask(&self.settings.programs.sacct, &all)
            .unwrap_or_default()
    }

    /// The arguments of `sbatch`.
    fn submission(&self, array: &TaskArray) -> Vec<String> {
        let settings = &self.settings;
        let limit = settings.array_limit.map(|n| format!("%{n}"));
        let mut arguments = words(&["--parsable", "--no-requeue"]);
        arguments.push(format!("--job-name={}", array.name));
        arguments.push(format!(
            "--array=0-{}{}",
            array.logs.len().saturating_sub(1),
            limit.unwrap_or_default()
        ));
        arguments.push(format!("--output={}", log_pattern(array)));
        arguments.push(format!("--cpus-per-task={}", settings.cpus_per_task));
        let of = |name: &str, value: &Option<String>| value.as_ref().map(|v| format!("{name}={v}"));
        arguments.extend(of("--partition", &settings.partition));
        arguments.extend(of("--account", &settings.account));
        arguments.extend(array.time_limit_s.map(|s| format!("--time={}", clock(s))));
        arguments.extend(array.memory_mb.map(|mb| format!("--mem={mb}M")));
        arguments.push(array.script.display().to_string());
        arguments
    }
}

impl BatchSystem for Slurm {
    fn most_tasks(&self) -> usize {
        self.settings.most_tasks
    }

    fn submit(&self, array: &TaskArray) -> Result<JobId, Error> {
        let program = &self.settings.programs.sbatch;
        let arguments = self.submission(array);
        let output = self.ask(program, &arguments)?;
        // `ID`, or `ID;CLUSTER`; warnings may stand before it.
        let id = output
            .lines()
            .last()
            .and_then(|line| line.split(';').next());
        match id.map(str::trim) {
            Some(id) if is_number(id) => Ok(JobId(id.to_owned())),
            _ => Err(Error::Answer {
                command: shown_command(program, &arguments),
                output: shortened(&output),
                expected: "the number of a job",
            }),
        }
    }

    fn find(&self, name: &str) -> Result<Option<JobId>, Error> {
        let queued = self.queue("%F|%j", Some(name))?;
        // By default only the jobs of today.
        let week = [
            format!("--name={name}"),
            "--starttime=now-7days".into(),
            "--format=JobID,JobName%200".into(),
        ];
        let known = [queued, self.accounts(&week)].join("\n");
        let id = known.lines().find_map(|line| {
            let (id, found) = line.split_once('|')?;
            let id = id.split('_').next()?;
            (found.trim() == name && is_number(id)).then(|| JobId(id.to_owned()))
        });
        Ok(id)
    }

    fn states(&self, tasks: &[TaskId]) -> Result<BTreeMap<TaskId, TaskState>, Error> {
        let mut states = parsed(&self.queue("%F_%K|%T", None)?, tasks);
        // A job that ended leaves the queue after some minutes.
        let is_gone = |task: &&TaskId| !states.contains_key(task);
        let gone: Vec<TaskId> = tasks.iter().filter(is_gone).cloned().collect();
        let jobs: BTreeSet<&str> = gone.iter().map(|task| task.job.0.as_str()).collect();
        if !jobs.is_empty() {
            let arguments = [
                format!("--jobs={}", Vec::from_iter(jobs).join(",")),
                "--format=JobID,State".into(),
            ];
            states.extend(parsed(&self.accounts(&arguments), &gone));
        }
        Ok(states)
    }

    fn cancel(&self, jobs: &[JobId]) -> Result<(), Error> {
        if jobs.is_empty() {
            return Ok(());
        }
        let mut arguments = words(&["--quiet"]);
        arguments.extend(jobs.iter().map(|job| job.0.clone()));
        self.ask(&self.settings.programs.scancel, &arguments)
            .map(drop)
    }

    fn may_be_taken_later(&self, error: &Error) -> bool {
        match error {
            Error::Silent { .. } => true,
            Error::Command { output, .. } => LATER.iter().any(|words| output.contains(words)),
            _ => false,
        }
    }
}

/// Words as arguments.
fn words(list: &[&str]) -> Vec<String> {
    list.iter().map(|word| (*word).to_owned()).collect()
}

/// Whether a text is the number of a job.
fn is_number(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit())
}

/// The pattern of the logs: the log of place 0 with `%a` in the place of the last 0 of its name.
fn log_pattern(array: &TaskArray) -> String {
    let first = array
        .logs
        .first()
        .map_or(Path::new(""), |log| log.as_path());
    let text = first.display().to_string().replace('%', "%%");
    match text.rsplit_once("-0.") {
        Some((name, ending)) => format!("{name}-%a.{ending}"),
        None => text,
    }
}

/// A time as Slurm reads it: hours, minutes, seconds.
pub(crate) fn clock(time_s: u64) -> String {
    format!(
        "{}:{:02}:{:02}",
        time_s / 3600,
        time_s / 60 % 60,
        time_s % 60
    )
}

/// Reads lines `JOB_PLACE|STATE` about these tasks. A line without a number as its place, such as `7_[2-9%4]|PENDING`, or
/// `7_N/A|CANCELLED` of an array that was cancelled as a whole, stands for the tasks that have no line of their own.
fn parsed(text: &str, tasks: &[TaskId]) -> BTreeMap<TaskId, TaskState> {
    let mut of_task = BTreeMap::new();
    let mut of_rest = BTreeMap::new();
    for line in text.lines() {
        let Some(((job, place), state)) = line
            .split_once('|')
            .and_then(|(id, state)| Some((id.trim().split_once('_')?, state)))
        else {
            continue;
        };
        match place.parse::<usize>() {
            Ok(index) => drop(of_task.insert((job, index), state_of(state))),
            Err(_) => drop(of_rest.insert(job, state_of(state))),
        }
    }
    tasks
        .iter()
        .filter_map(|task| {
            let job = task.job.0.as_str();
            let own = of_task.get(&(job, task.index));
            own.or_else(|| of_rest.get(job))
                .map(|state| (task.clone(), *state))
        })
        .collect()
}

/// The state that a word of Slurm stands for; `CANCELLED by 1000` has further words.
fn state_of(words: &str) -> TaskState {
    let lost = |reason| TaskState::Lost { reason };
    match words.split_whitespace().next().unwrap_or("") {
        "PENDING" | "CONFIGURING" | "REQUEUED" | "REQUEUE_HOLD" | "REQUEUE_FED"
        | "RESV_DEL_HOLD" | "SPECIAL_EXIT" => TaskState::Waiting,
        "RUNNING" | "COMPLETING" | "SUSPENDED" | "STOPPED" | "STAGE_OUT" | "SIGNALING"
        | "RESIZING" => TaskState::Running,
        "COMPLETED" => TaskState::Ended { ok: true },
        "FAILED" => TaskState::Ended { ok: false },
        "NODE_FAIL" | "BOOT_FAIL" => lost(LossReason::NodeFailure),
        "TIMEOUT" | "DEADLINE" => lost(LossReason::TimeOut),
        "PREEMPTED" => lost(LossReason::Preempted),
        "OUT_OF_MEMORY" => lost(LossReason::OutOfMemory),
        "CANCELLED" | "REVOKED" => lost(LossReason::Cancelled),
        _ => TaskState::Unknown,
    }
}

#[cfg(test)]
mod tests {
    use super::{Slurm, clock, parsed, state_of};
    use crate::{
        BatchSettings, BatchSystem, Error, JobId, LossReason, TaskArray, TaskId, TaskState,
    };

    /// An array of three tasks.
    fn array() -> TaskArray {
        TaskArray {
            name: "seedloop-1".into(),
            script: "a/b.sh".into(),
            logs: (0..3).map(|i| format!("a 100%/b-{i}.log").into()).collect(),
            time_limit_s: Some(3725),
            memory_mb: None,
        }
    }

    /// What is set is passed on, what is not is left to Slurm; a per cent sign of a folder is not read as a pattern.
    #[test]
    fn submission_holds_what_was_set_and_nothing_else() {
        let settings = BatchSettings {
            array_limit: Some(16),
            account: Some("seeds".into()),
            ..BatchSettings::default()
        };
        let arguments = Slurm::new(&settings).submission(&array());
        let expected = "--parsable --no-requeue --job-name=seedloop-1 --array=0-2%16 \
            --output=a 100%%/b-%a.log --cpus-per-task=1 --account=seeds --time=1:02:05 a/b.sh";
        assert_eq!(arguments.join(" "), expected);
        assert_eq!(clock(59), "0:00:59");
    }

    /// Lines as squeue and sacct of Slurm 22.05 write them.
    #[test]
    fn states_are_read_from_the_lines_of_slurm() {
        let text = "7_0|COMPLETED\n7_1|CANCELLED by 1000\n7_[2-9%4]|PENDING\n8_0|RUNNING\n9_N/A|CANCELLED\n";
        let tasks =
            [("7", 0), ("7", 1), ("7", 2), ("9", 5), ("10", 0)].map(|(job, index)| TaskId {
                job: JobId(job.into()),
                index,
            });
        let states = parsed(text, &tasks);
        let cancelled = TaskState::Lost {
            reason: LossReason::Cancelled,
        };
        assert_eq!(states.len(), 4, "{states:?}");
        assert_eq!(states[&tasks[0]], TaskState::Ended { ok: true });
        assert_eq!(states[&tasks[1]], cancelled);
        assert_eq!(states[&tasks[2]], TaskState::Waiting);
        assert_eq!(states[&tasks[3]], cancelled);
        assert_eq!(state_of("SOMETHING_NEW"), TaskState::Unknown);
    }

    #[test]
    fn a_wrong_partition_is_no_matter_of_time_and_a_silent_controller_is() {
        let slurm = Slurm::new(&BatchSettings::default());
        let error = |output: &str| Error::Command {
            command: "sbatch".into(),
            status: "exit status: 1".into(),
            output: output.into(),
        };
        assert!(!slurm.may_be_taken_later(&error(
            "sbatch: error: Batch job submission failed: Invalid partition name specified"
        )));
        for later in [
            "sbatch: error: Batch job submission failed: Unable to contact slurm controller (connect failure)",
            "sbatch: error: QOSMaxSubmitJobPerUserLimit",
            "sbatch: error: Slurm temporarily unable to accept job, sleeping and retrying",
        ] {
            assert!(slurm.may_be_taken_later(&error(later)), "{later}");
        }
    }
}
