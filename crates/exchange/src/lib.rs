//! Scenes and frames in the formats of other tools.
//!
//! [`lammps`] and [`liggghts`] write a drum as a deck that these run, with every convention converted and the
//! conversion written into the deck; [`dump`] reads what they give back, so that their bed is
//! measured with the ruler of this workspace. [`vtk`] and [`csv`] write every sphere of every seed, for `ParaView` and for a
//! fluid solver.

pub mod csv;
mod drum_deck;
pub mod dump;
pub mod fractions;
pub mod lammps;
pub mod liggghts;
pub mod vtk;

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
    /// A dump is not what a dump looks like.
    #[error("{file}: line {line}: {what}")]
    Dump {
        /// The file.
        file: String,
        /// The line, from 1.
        line: usize,
        /// What is wrong.
        what: String,
    },
    /// The scene.
    #[error(transparent)]
    Scene(#[from] scene::Error),
    /// A contact parameter.
    #[error(transparent)]
    Contact(#[from] contact_law::Error),
}
