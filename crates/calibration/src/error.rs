//! What can go wrong in a stage.

/// Why a stage gave no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The runs were not all done.
    #[error(transparent)]
    Campaign(#[from] campaign::Error),
    /// The design cannot be made.
    #[error(transparent)]
    Design(#[from] experiment_design::Error),
    /// The response surface cannot be fitted.
    #[error(transparent)]
    Surface(#[from] response_surface::Error),
    /// The residual cannot be diagnosed.
    #[error(transparent)]
    Diagnosis(#[from] residual_diagnosis::Error),
    /// A problem whose numbers do not fit together.
    #[error("the calibration cannot be meant:\n  {}", lines.join("\n  "))]
    Problem {
        /// What is wrong, one line each.
        lines: Vec<String>,
    },
    /// Runs too few for a surface.
    #[error(
        "{n} runs of {model} are too few for a surface{}",
        if reasons.is_empty() { String::new() } else { format!(": {}", reasons.join("; ")) }
    )]
    TooFewRuns {
        /// Name of the model.
        model: String,
        /// Number of runs that could be used.
        n: usize,
        /// Why others could not.
        reasons: Vec<String>,
    },
    /// A screening with a run that failed: its columns are then no longer orthogonal.
    #[error("the screening of {model} has a run that failed: {reason}")]
    Screening {
        /// Name of the model.
        model: String,
        /// Why the run failed.
        reason: String,
    },
    /// No run of a model gives a result at the estimate.
    #[error("no run of {model} gives a result at the estimate: {reason}")]
    NoRun {
        /// Name of the model.
        model: String,
        /// Why the first failed.
        reason: String,
    },
    /// More runs than the budget allows.
    #[error(
        "{needed} runs are needed, and the budget is {most}: raise it, or take a smaller design"
    )]
    Budget {
        /// Number needed.
        needed: usize,
        /// Number allowed.
        most: usize,
    },
    /// A run lacks an observable.
    #[error("run '{run}' gave no observable '{name}'; it gave {given}")]
    NoObservable {
        /// Key of the run.
        run: String,
        /// Name of the observable.
        name: String,
        /// Names of those it gave.
        given: String,
    },
    /// Numbers of a plan do not fit together.
    #[error("{what}: {got} given, {expected} needed")]
    Count {
        /// What is counted.
        what: &'static str,
        /// Number given.
        got: usize,
        /// Number needed, in words.
        expected: &'static str,
    },
    /// A search did not end.
    #[error("the search for {what} failed: {reason}")]
    Search {
        /// What was searched.
        what: &'static str,
        /// What the optimiser said.
        reason: String,
    },
}
