//! The simulator seen from outside, and lists of its runs done in parallel, once each.
//!
//! A [`Simulator`] turns a [`RunRequest`] into observables, by way of a [`PreparedRun`]. A [`Campaign`] takes a list of
//! requests, finds those that a [`crate::run_store::Store`] already has, does the others on several
//! threads, and stores each as soon as it is finished. Lists that belong to one loop share a [`Pace`] with what
//! lies ahead of them, so that the time left is that of the whole loop.
//!
//! ```
//! use campaign::{Campaign, RunOutcome, RunRequest, Silent, Simulator, SimulatorError};
//! use campaign::run_store::{Observation, Store};
//!
//! struct Doubler;
//! impl Simulator for Doubler {
//!     fn version(&self) -> String {
//!         "doubler 1".into()
//!     }
//!     fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
//!         let x = request.parameter("x")?;
//!         let y = Observation { mean: 2.0 * x, sd: None, n: 1, unit: "1".into() };
//!         Ok(RunOutcome::default().with_observable("y", y))
//!     }
//! }
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let folder = tempfile::tempdir()?;
//! let store = Store::open(folder.path())?;
//! let requests: Vec<_> = (0..3)
//!     .map(|i| RunRequest::new("toy", 7).with_parameter("x", f64::from(i)))
//!     .collect();
//! let records = Campaign::new(&store, 2, &Silent).run_all(&Doubler, &requests)?;
//! assert_eq!(records[2].observable("y").map(|y| y.mean), Some(4.0));
//! # Ok(())
//! # }
//! ```
//!
//! Invariants:
//! - the records do not depend on the number of threads, nor on what was in the store before;
//! - a finished run is never lost: not by the failure of another, nor by a stop or a kill;
//! - campaigns that share a folder share the runs: each is done once, and one whose campaign died is taken over;
//! - requests with the same inputs and seed are one run, and a refused request is reported before any run.

mod board;
mod claims;
mod cores;
mod error;
mod jobs;
mod pace;
mod progress;
mod records;
mod request;
pub mod run_store;
mod runner;
mod simulator;
mod time_left;
mod workers;

pub use cores::Cores;
pub use error::{Error, in_full};
pub use pace::Pace;
pub use progress::{LineProgress, Progress, ProgressState, Silent, range_in_words, time_in_words};
pub use request::{RunOutcome, RunRequest};
pub use runner::Campaign;
pub use simulator::{PreparedRun, Simulator, SimulatorError};
