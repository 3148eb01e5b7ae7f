//! Errors in a study.

use crate::Problem;
use std::path::PathBuf;

/// Why a study gave no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file cannot be read.
    #[error("cannot read {path}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The file is invalid.
    #[error("{}", told(list))]
    Problems {
        /// Everything that is wrong with it.
        list: Vec<Problem>,
    },
    /// The values from which a diagnosis is to start are invalid.
    #[error("{file}: {problem}")]
    Start {
        /// The file that should hold them.
        file: String,
        /// Its fault, and the remedy.
        problem: String,
    },
    /// A diagnosis may need more runs than the budget allows.
    #[error(
        "[budget] allows {most} runs, and the diagnosis may need {needed}: raise it, or search fewer [effects]"
    )]
    Budget {
        /// Runs of the budget.
        most: usize,
        /// Runs that may be needed.
        needed: usize,
    },
    /// A result has no form in a file, or cannot be written.
    #[error("cannot write {path}: {reason}")]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A table is refused.
    #[error(transparent)]
    Table(#[from] command_line::table_file::Error),
    /// A scene is refused.
    #[error(transparent)]
    Scene(Box<scene::Error>),
    /// The simulator is refused.
    #[error(transparent)]
    Simulator(Box<simulators::scene_simulator::Error>),
    /// Another code cannot be used.
    #[error(transparent)]
    External(#[from] simulators::external_simulator::Error),
    /// A stage of the calibration failed.
    #[error(transparent)]
    Calibration(#[from] inference::Error),
    /// The runs of a design table came to no end.
    #[error(transparent)]
    Campaign(#[from] campaign::Error),
    /// The run store cannot be used.
    #[error(transparent)]
    Store(#[from] campaign::run_store::Error),
}

// Boxed: these two are much larger than the others, and every result of a study carries room for the largest.
impl From<scene::Error> for Error {
    fn from(error: scene::Error) -> Self {
        Self::Scene(Box::new(error))
    }
}

impl From<simulators::scene_simulator::Error> for Error {
    fn from(error: simulators::scene_simulator::Error) -> Self {
        Self::Simulator(Box::new(error))
    }
}

impl Error {
    /// Whether the process has waited for the runs of others as long as it may.
    pub fn has_waited(&self) -> bool {
        let (Self::Campaign(error) | Self::Calibration(inference::Error::Campaign(error))) = self
        else {
            return false;
        };
        matches!(error, campaign::Error::Waited { .. })
    }
}

/// All problems, one a line.
fn told(list: &[Problem]) -> String {
    if let [one] = list {
        return one.to_string();
    }
    let lines: Vec<String> = list.iter().map(|p| format!("\n  {p}")).collect();
    format!(
        "{} things are wrong; nothing was run:{}",
        list.len(),
        lines.concat()
    )
}
