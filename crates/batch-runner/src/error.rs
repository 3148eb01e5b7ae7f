//! What can go wrong between a campaign and a batch system.

use std::path::PathBuf;

/// Why runs could not be submitted, watched or done.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// An invalid setting.
    #[error("setting '{name}' of the runner is {value}: {limit}")]
    Setting {
        /// Name of the setting.
        name: &'static str,
        /// What was given.
        value: String,
        /// What may be given.
        limit: &'static str,
    },
    /// A store that workers cannot reach.
    #[error("the records are kept in memory, where no job can leave any; give the store a folder")]
    NoFolder,
    /// The operating system refused.
    #[error("cannot {action} {}", path.display())]
    Io {
        /// What was tried.
        action: &'static str,
        /// On which file or folder.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// Another process submits from the same folder.
    #[error(
        "{} is in use: another process submits runs from this folder; wait for its end, or stop it",
        path.display()
    )]
    InUse {
        /// The locked file.
        path: PathBuf,
    },
    /// The ledger cannot be read.
    #[error(
        "{} is damaged: {reason}; cancel the jobs whose names begin with '{prefix}' (squeue --me shows them) and delete the file: finished runs are in the store and are not repeated",
        path.display()
    )]
    LedgerDamaged {
        /// The ledger.
        path: PathBuf,
        /// What the reader met.
        reason: String,
        /// How the names of the jobs begin.
        prefix: &'static str,
    },
    /// The ledger has another form.
    #[error(
        "{} has schema {found}, this program writes {expected}; go on with the program that began it, or give another folder",
        path.display()
    )]
    OtherSchema {
        /// The ledger.
        path: PathBuf,
        /// Schema in the file.
        found: u32,
        /// Schema of this program.
        expected: u32,
    },
    /// A task file cannot be read.
    #[error("{} is no task of a campaign: {reason}; a task is written by the submitting process and read by its worker", path.display())]
    TaskDamaged {
        /// The file.
        path: PathBuf,
        /// What the reader met.
        reason: String,
    },
    /// The worker would do another run than the one that was asked for.
    #[error(
        "run '{request}' of {} has key {found} here and key {expected} where it was submitted: version or inputs differ; let workers use the same program and files as the submitting process",
        path.display()
    )]
    OtherKey {
        /// The task file.
        path: PathBuf,
        /// The run.
        request: String,
        /// Key in the task file.
        expected: String,
        /// Key that this program gives.
        found: String,
    },
    /// The simulator of the worker refuses a run that the submitting process accepted.
    #[error("run '{request}' of {} is refused here", path.display())]
    Refused {
        /// The task file.
        path: PathBuf,
        /// The run.
        request: String,
        /// The simulator's reason.
        source: campaign::SimulatorError,
    },
    /// The runs of a task broke off.
    #[error("the runs of {} broke off", path.display())]
    Campaign {
        /// The task file.
        path: PathBuf,
        /// The campaign's reason.
        source: campaign::Error,
    },
    /// A program could not be started.
    #[error("cannot start '{program}': {source}; is it installed, and on the search path?")]
    NoProgram {
        /// Name or path of the program.
        program: String,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A command of the batch system did not end in time.
    #[error("'{command}' did not end within {limit_s} s and was ended")]
    Silent {
        /// The command line.
        command: String,
        /// Time that it had, s.
        limit_s: f64,
    },
    /// A command of the batch system failed.
    #[error("'{command}' failed ({status}): {output}")]
    Command {
        /// The command line.
        command: String,
        /// How it ended.
        status: String,
        /// What it wrote, shortened.
        output: String,
    },
    /// Nothing was heard of the batch system for too long.
    #[error(
        "the batch system has not answered for {limit_s} s, and no record has come: {trouble}; give the same command again when it answers: jobs that still run are found, and finished runs are not repeated"
    )]
    Patience {
        /// The patience, s.
        limit_s: f64,
        /// Its last trouble.
        trouble: String,
    },
    /// A command of the batch system wrote something that cannot be understood.
    #[error("'{command}' wrote '{output}', where {expected} was expected")]
    Answer {
        /// The command line.
        command: String,
        /// What it wrote, shortened.
        output: String,
        /// What should have been there.
        expected: &'static str,
    },
}

impl Error {
    /// The error with its causes, as one line.
    pub(crate) fn in_full(&self) -> String {
        campaign::in_full(self)
    }
}

/// Makes an error of a failed operation on a path.
pub(crate) fn io(
    action: &'static str,
    path: &std::path::Path,
) -> impl Fn(std::io::Error) -> Error + use<> {
    let path = path.to_owned();
    move |source| Error::Io {
        action,
        path: path.clone(),
        source,
    }
}
