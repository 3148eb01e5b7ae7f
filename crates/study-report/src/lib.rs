//! The result of a study as a report page, tables and pictures.
//!
//! [`write()`] shows a [`inference::Calibration`]: the error of every measurement before and after, the parameters,
//! what the measurements fix and what they leave open, and how that was found. [`write_diagnosis`] shows the study of
//! a residual alone. Nothing is simulated or fitted here, and no file is read: everything comes in the input.
//!
//! Invariants: the same input gives the same bytes; a file is written whole or not at all; what is undefined is a dash
//! on the page and an empty field in a table; what is not there leaves no heading.

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
mod tables;
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
pub use input::{ComparedValue, DiagnosisInput, ReportInput};
pub use open_words::open_in_words;
pub use output::{Extent, write, write_diagnosis};
pub use running::{RunningCampaign, RunningPage, RunningStage};
