//! The study file: what it gives, and everything that it refuses before any run.

mod study_file {
    mod coarse_graining;
    pub(crate) mod correlated;
    mod curves;
    pub(crate) mod example;
    pub(crate) mod fixtures;
    pub(crate) mod folder;
    pub(crate) mod given;
    mod of_a_program;
    mod refused;
    mod unread_photos;
    pub(crate) mod values;
}
