//! Other codes as simulators: LAMMPS, LIGGGHTS, and any command of the user.
//!
//! [`PeerSimulator`] lets LAMMPS or LIGGGHTS do the mechanics of the scenes here, by the exported decks. Start-up, steady state and
//! the surface follow the same rules and the same ruler as the runs here: the code is asked to continue for as long as the bed
//! asks for.
//!
//! [`CommandSimulator`] runs any program: it gets the values of parameters and conditions as `name=value`, in its environment, in
//! the files of a template and as JSON, and leaves observables, positions of spheres, or pictures.
//!
//! Invariants:
//! - a run that fails, hangs or leaves nothing fails alone, and its files and its log stay where the message says;
//! - a program and all that it started end with their run, also when this process is killed. What leaves the group of processes of
//!   the program, as `setsid` does, is out of reach.

mod bed;
mod command;
mod command_line;
mod deck;
mod drum;
mod error;
mod file_pattern;
mod folder;
mod guard;
mod left_moments;
mod peer;
mod process;
mod reading;
mod results;
mod session;
mod template;

pub use command::{CommandModel, CommandSettings, CommandSimulator, ResultFiles};
pub use command_line::variable;
pub use drum::DrumDescription;
pub use error::Error;
pub use folder::Keep;
pub use peer::{Peer, PeerSettings, PeerSimulator};
pub use reading::read_scene;
