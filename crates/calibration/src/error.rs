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
