//! The diagnosis on problems with known answers.
//!
//! One program for all files: it is linked once, and its tests share the cores.

mod behaviour;
mod fixtures;
mod limits;
mod next_measurements;
mod problem_file;
mod rates;
