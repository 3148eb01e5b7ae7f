//! Errors of a scene and of a run.

use std::path::PathBuf;

/// Why a scene cannot be read or run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file cannot be read.
    #[error("cannot read {path}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The text of a scene is not what a scene looks like.
    #[error("{file}: {message}")]
    Text {
        /// The file.
        file: String,
        /// Line, column, fault, and what is expected.
        message: String,
    },
    /// A setting has no such name.
    #[error("no setting '{name}' in {file}; {near}")]
    UnknownSetting {
        /// The name given.
        name: String,
        /// The file.
        file: String,
        /// What could be meant: the name here of what another code calls so, or settings with a like name.
        near: String,
    },
    /// A short name fits several settings.
    #[error("'{name}' may mean {candidates}; write the whole path")]
    AmbiguousSetting {
        /// The name given.
        name: String,
        /// What it may mean.
        candidates: String,
    },
    /// Two surfaces can touch, but nothing says how.
    #[error(
        "{file}: contact '{pair}' is missing; add a section [contact.{pair}] with restitution, \
         static_friction and rolling_friction"
    )]
    MissingContact {
        /// The file.
        file: String,
        /// Names of the two materials.
        pair: String,
    },
    /// A name refers to nothing.
    #[error("{file}: {what} '{name}' is not defined; defined are {known}")]
    Undefined {
        /// The file.
        file: String,
        /// Kind of thing.
        what: &'static str,
        /// The name.
        name: String,
        /// The names that exist.
        known: String,
    },
    /// Keys of a seed contradict each other or leave something open.
    #[error("{file}: seed '{seed}': {problem}")]
    SeedKeys {
        /// The file.
        file: String,
        /// Name of the seed.
        seed: String,
        /// The fault and its remedy.
        problem: String,
    },
    /// A value is invalid.
    #[error("{name} is {value}; it must be {requirement}")]
    BadValue {
        /// Name of the setting, with its unit.
        name: String,
        /// The value.
        value: String,
        /// What it must be.
        requirement: String,
    },
    /// The apparatus has no room for the seeds where they start.
    #[error(
        "{count} seeds do not fit into the apparatus without touching; about {places} do: take \
         fewer seeds or a larger apparatus, or let them rain in (protocol.insertion_rate)"
    )]
    TooManySeeds {
        /// Seeds asked for.
        count: usize,
        /// Places found.
        places: usize,
    },
    /// The apparatus was full before all seeds had rained in.
    #[error(
        "the apparatus was full when {inside} of {count} seeds had rained in: take fewer seeds, a larger \
         apparatus, or a lower protocol.insertion_rate"
    )]
    FullBeforeAllSeeds {
        /// Seeds asked for.
        count: usize,
        /// Those that found room.
        inside: usize,
    },
    /// The mesh of a seed is refused.
    #[error("mesh of seed '{seed}': {source}")]
    Mesh {
        /// Name of the seed.
        seed: String,
        /// Why.
        source: trimesh::Error,
    },
    /// The table of the spheres of a seed is refused.
    #[error("spheres of seed '{seed}': {source}")]
    Spheres {
        /// Name of the seed.
        seed: String,
        /// Why.
        source: geometry::clump::files::TableError,
    },
    /// The mesh of a wall is refused.
    #[error("mesh of wall '{wall}': {source}")]
    WallMesh {
        /// Name of the wall.
        wall: String,
        /// Why.
        source: trimesh::Error,
    },
    /// The mesh of a seed cannot be filled.
    #[error("filling of seed '{seed}': {source}")]
    Filling {
        /// Name of the seed.
        seed: String,
        /// Why.
        source: sphere_fill::Error,
    },
    /// A quantity of a seed cannot be.
    #[error("seed '{seed}': {source}")]
    SeedQuantity {
        /// Name of the seed.
        seed: String,
        /// Why.
        source: input::quantity::Error,
    },
    /// A body of spheres cannot be made.
    #[error("body of seed '{seed}': {source}")]
    Body {
        /// Name of the seed.
        seed: String,
        /// Why.
        source: geometry::clump::Error,
    },
    /// A contact parameter is out of range.
    #[error("{file}: contact '{pair}': {source}")]
    Contact {
        /// The file.
        file: String,
        /// Names of the two materials.
        pair: String,
        /// Why.
        source: contact_law::Error,
    },
    /// Bonds do not hold the spheres of a seed together.
    #[error("bonds of seed '{seed}': {source}")]
    Bonds {
        /// Name of the seed.
        seed: String,
        /// Why.
        source: dem_solver::bonds::Error,
    },
    /// A bench test did not come to its end.
    #[error("repeat {repeat}: {what} within {limit:.1} s of simulated time")]
    NoEvent {
        /// Number of the repeat, from 1.
        repeat: usize,
        /// What did not happen.
        what: &'static str,
        /// The limit, s.
        limit: f64,
    },
    /// The state of a run cannot be kept, or cannot be one that was.
    #[error("{file}: the state of the run cannot be kept or taken up: {reason}")]
    NotKept {
        /// The scene.
        file: String,
        /// Why.
        reason: String,
    },
    /// A run was asked to stop before its end.
    #[error("{file}: the run was stopped at {time:.2} s")]
    Stopped {
        /// The scene.
        file: String,
        /// Simulated time at which it stopped, s.
        time: f64,
    },
    /// A run has left what can be believed.
    #[error("{file}: the run is stopped: {source}")]
    Unhealthy {
        /// The scene.
        file: String,
        /// What was found, where and when, and the remedy.
        source: dem_solver::Error,
    },
    /// A run has left what can be believed at each time step that was tried.
    #[error("{last}; with the longer steps that were tried before: {}", before.join("; "))]
    Diverged {
        /// What the last attempt, with the shortest step, says.
        last: Box<Error>,
        /// What those before it say.
        before: Vec<String>,
    },
    /// The solver stopped.
    #[error(transparent)]
    Solver(#[from] dem_solver::Error),
    /// A frame cannot be drawn.
    #[error(transparent)]
    Render(#[from] frame_render::Error),
    /// A frame cannot be measured at all (a refusal is not an error).
    #[error(transparent)]
    Photo(#[from] photo_profile::Error),
}

impl Error {
    /// Whether the run has left what can be believed, so that a shorter time step may end it well.
    pub fn is_divergence(&self) -> bool {
        match self {
            Self::Unhealthy { source, .. } | Self::Solver(source) => source.is_divergence(),
            Self::Diverged { .. } => true,
            _ => false,
        }
    }

    /// The same with the file whose value is invalid.
    pub(crate) fn in_file(self, file: &str) -> Self {
        match self {
            Self::BadValue {
                name,
                value,
                requirement,
            } => Self::BadValue {
                name: format!("{file}: {name}"),
                value,
                requirement,
            },
            other => other,
        }
    }
}
