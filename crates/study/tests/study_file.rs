//! The study file: what it gives, and everything that it refuses before any run.

mod study_file {
    mod coarse_graining;
    pub(crate) mod correlated;
    pub(crate) mod example;
    pub(crate) mod fixtures;
    pub(crate) mod folder;
    pub(crate) mod given;
    pub(crate) mod plausible;
    pub(crate) mod refused;
    pub(crate) mod refused_measurements;
    mod unread_photos;
    pub(crate) mod values;
}
