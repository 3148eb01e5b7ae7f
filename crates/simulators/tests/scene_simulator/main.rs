//! Scenes as a simulator: requests, records, failed runs, the revision of the physics.
//!
//! One program for all files: it is linked once, and its tests share the cores.

mod divergence;
mod parameter_file;
mod revision;
mod simulator;
