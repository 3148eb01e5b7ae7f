//! What does the runs of a study.

use campaign::{PreparedRun, RunOutcome, RunRequest, Simulator, SimulatorError};
use scene::FillingLibrary;
use simulators::external_simulator::{CommandSimulator, PeerSimulator};
use simulators::scene_simulator::SceneSimulator;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// The simulator of a study.
#[derive(Debug)]
pub enum StudySimulator {
    /// The solver here.
    Own(SceneSimulator),
    /// LAMMPS or LIGGGHTS.
    Peer(PeerSimulator),
    /// A program of the user.
    Command(CommandSimulator),
}

impl StudySimulator {
    /// Bodies that were made for its scenes; `None` if a program of the user knows them.
    pub fn fillings(&self) -> Option<&FillingLibrary> {
        match self {
            Self::Own(scenes) => Some(scenes.fillings()),
            Self::Peer(peer) => Some(peer.scenes().fillings()),
            Self::Command(_) => None,
        }
    }

    /// Sets how often a run of the solver here that diverges is tried again, each time with half the time step; other programs
    /// choose their steps themselves.
    #[must_use]
    pub fn with_retries(self, retries: u32) -> Self {
        match self {
            Self::Own(scenes) => Self::Own(scenes.with_retries(retries)),
            other => other,
        }
    }

    /// Honours a flag: once it is true running runs end soon, without a result, and so do the programs that do them.
    #[must_use]
    pub fn with_stop(self, stop: &Arc<AtomicBool>) -> Self {
        match self {
            Self::Own(scenes) => Self::Own(scenes.with_stop(stop)),
            Self::Peer(peer) => Self::Peer(peer.with_stop(stop)),
            Self::Command(command) => Self::Command(command.with_stop(stop)),
        }
    }

    fn inner(&self) -> &dyn Simulator {
        match self {
            Self::Own(scenes) => scenes,
            Self::Peer(peer) => peer,
            Self::Command(command) => command,
        }
    }
}

impl Simulator for StudySimulator {
    fn version(&self) -> String {
        self.inner().version()
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        self.inner().run(request)
    }

    fn prepare<'s>(
        &'s self,
        request: &RunRequest,
    ) -> Result<Box<dyn PreparedRun + 's>, SimulatorError> {
        self.inner().prepare(request)
    }
}
