//! Errors in a stage.

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
    Diagnosis(#[from] crate::diagnosis::Error),
    /// A problem whose numbers do not fit together.
    #[error("the calibration is invalid:\n  {}", lines.join("\n  "))]
    Problem {
        /// The faults, one line each.
        lines: Vec<String>,
    },
    /// Runs too few for a surface.
    #[error(
        "{n} runs of {model} are too few for a surface{}",
        match reasons.as_slice() {
            [] => String::new(),
            [only] => format!(": {only}"),
            [first, others @ ..] => format!(": {first}; other reasons: {}", others.len()),
        }
    )]
    TooFewRuns {
        /// Name of the model.
        model: String,
        /// Number of runs that could be used.
        n: usize,
        /// Why others could not.
        reasons: Vec<String>,
    },
    /// No run with the parameters in use before gives a result: the simulator does not work.
    #[error(
        "all {n} runs with the parameters in use before failed, and nothing else was run: {reason}; where only these \
         parameters fail, set before_runs = 0 in [design]"
    )]
    AllFailed {
        /// Number of runs.
        n: usize,
        /// Why the first failed.
        reason: String,
    },
    /// A screening whose failed runs leave too few to fix its effects.
    #[error(
        "the screening of {model} cannot do without the {failed} of its runs that failed: {reason}"
    )]
    Screening {
        /// Name of the model.
        model: String,
        /// Number of runs that failed.
        failed: usize,
        /// Why the first of them failed.
        reason: String,
    },
    /// Too few replicates of a condition for its mean.
    #[error("{left} of {of} runs of {name} gave a result, and a mean needs two: {reason}")]
    Cell {
        /// Name of the condition.
        name: String,
        /// Its number.
        condition: usize,
        /// Number of runs that gave a result.
        left: usize,
        /// Number of runs.
        of: usize,
        /// Why the first of the others failed.
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
    /// Runs with coarse grains that say too little about real ones: a refusal.
    #[error("the grains are too coarse:\n  {}", lines.join("\n  "))]
    CoarseGraining {
        /// Why, one line for each measurement.
        lines: Vec<String>,
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
