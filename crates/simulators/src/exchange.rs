//! Scenes and frames in the formats of other tools.
//!
//! [`lammps`] and [`liggghts`] write a drum or a bench as a deck that these run, with every convention converted and the
//! conversion written into the deck. [`bench_results`] reads what the deck of a bench leaves. [`read_positions`] reads what any code gives back as a [`Moment`], so that its bed is
//! measured with the ruler of this workspace. [`edem`] writes a table of settings. [`vtk`] and
//! [`csv`] write every sphere of every seed, for `ParaView` and for a fluid solver, [`npz`] the frames as arrays for `NumPy`.

mod bench_deck;
pub mod bench_results;
pub mod csv;
mod drum_deck;
pub mod dump;
pub mod edem;
pub mod fractions;
pub mod lammps;
pub mod liggghts;
mod moment;
pub mod npz;
mod positions;
mod remarks;
pub mod vtk;
mod vtk_points;

pub use drum_deck::{FINER, require_drum};
pub use moment::{BedSphere, Moment};
pub use positions::read_positions;
pub use remarks::add_warnings;

use std::path::PathBuf;

/// Why something cannot be written or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The other tool has no such thing.
    #[error("{what} cannot be written for {tool}: {way_out}")]
    NotThere {
        /// What the scene asks for.
        what: String,
        /// The tool.
        tool: &'static str,
        /// What to do.
        way_out: &'static str,
    },
    /// A file of positions cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file of positions is not what such a file looks like.
    #[error("{file}: line {line}: {what}")]
    Positions {
        /// The file.
        file: String,
        /// The line, from 1.
        line: usize,
        /// The fault.
        what: String,
    },
    /// A file is of another kind than one of positions.
    #[error("{file}: {what}")]
    OtherKind {
        /// The file.
        file: String,
        /// What it lacks.
        what: String,
    },
    /// The scene.
    #[error(transparent)]
    Scene(#[from] scene::Error),
    /// A contact parameter.
    #[error(transparent)]
    Contact(#[from] contact_law::Error),
}

impl Error {
    /// Whether a file holds no positions of spheres but something else, such as a restart, a mesh or the box of a domain.
    pub fn is_other_kind(&self) -> bool {
        matches!(self, Self::OtherKind { .. })
    }
}
