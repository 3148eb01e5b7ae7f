//! A study as a page: while it runs, and its result.
//!
//! [`write()`] shows a [`inference::Calibration`]: the error of every measurement before and after, the parameters,
//! what the measurements fix and what they leave open, and how that was found. [`write_diagnosis`] shows the study of
//! a residual alone. Nothing is simulated or fitted here, and no file is read: everything comes in the input.
//!
//! Invariants: the same input gives the same bytes; the page is written whole or not at all; what is undefined is a dash;
//! what is not there leaves no heading.

mod answer;
mod design_points;
mod error;
mod exploration;
mod input;
mod measurement_rows;
mod numbers;
mod open_words;
mod output;
mod page;
mod pictures;
mod residual;
mod run_details;
mod running;
#[cfg(test)]
mod test_input;
#[cfg(test)]
mod test_residual;
#[cfg(test)]
mod test_scene;
#[cfg(test)]
mod test_study;
#[cfg(test)]
mod test_surfaces;
#[cfg(test)]
mod tests;
mod unit_of_name;

pub use answer::{Answer, answer};
pub use error::Error;
pub use exploration::{SurfaceWithSliders, explored_surface};
pub use input::{ComparedValue, CurvePoints, DiagnosisInput, ReportInput};
pub use open_words::open_in_words;
pub use output::{write, write_diagnosis};
pub use running::{RunningCampaign, RunningPage, RunningStage};
