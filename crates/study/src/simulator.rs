//! What does the runs of a study.

use crate::curves::CurveScores;
use campaign::run_store::{Observation, Record};
use campaign::{PreparedRun, RunOutcome, RunRequest, Simulator, SimulatorError};
use scene::FillingLibrary;
use simulators::external_simulator::{CommandSimulator, PeerSimulator};
use simulators::scene_simulator::SceneSimulator;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// The simulator of a study.
#[derive(Debug)]
pub struct StudySimulator {
    code: Code,
    /// Measured curves, each with the name of its model: records are read in the same way.
    curves: Vec<(String, CurveScores)>,
}

/// What does the runs.
#[derive(Debug)]
enum Code {
    /// The solver here.
    Own(SceneSimulator),
    /// LAMMPS or LIGGGHTS.
    Peer(PeerSimulator),
    /// A program of the user.
    Command(CommandSimulator),
}

impl StudySimulator {
    /// The solver here; measured curves have the names of their models.
    pub(crate) fn own(scenes: SceneSimulator, curves: Vec<(String, CurveScores)>) -> Self {
        Self {
            code: Code::Own(scenes),
            curves,
        }
    }

    /// LAMMPS or LIGGGHTS.
    pub(crate) fn peer(peer: PeerSimulator) -> Self {
        Self {
            code: Code::Peer(peer),
            curves: Vec::new(),
        }
    }

    /// A program of the user.
    pub(crate) fn command(command: CommandSimulator) -> Self {
        Self {
            code: Code::Command(command),
            curves: Vec::new(),
        }
    }

    /// Bodies that were made for its scenes; `None` if a program of the user knows them.
    pub fn fillings(&self) -> Option<&FillingLibrary> {
        match &self.code {
            Code::Own(scenes) => Some(scenes.fillings()),
            Code::Peer(peer) => Some(peer.scenes().fillings()),
            Code::Command(_) => None,
        }
    }

    /// Sets how often a run of the solver here that diverges is tried again, each time with half the time step; other programs
    /// choose their steps themselves.
    #[must_use]
    pub fn with_retries(mut self, retries: u32) -> Self {
        if let Code::Own(scenes) = self.code {
            self.code = Code::Own(scenes.with_retries(retries));
        }
        self
    }

    /// Honours a flag: once it is true running runs end soon, without a result, and so do the programs that do them.
    #[must_use]
    pub fn with_stop(mut self, stop: &Arc<AtomicBool>) -> Self {
        self.code = match self.code {
            Code::Own(scenes) => Code::Own(scenes.with_stop(stop)),
            Code::Peer(peer) => Code::Peer(peer.with_stop(stop)),
            Code::Command(command) => Code::Command(command.with_stop(stop)),
        };
        self
    }

    fn inner(&self) -> &dyn Simulator {
        match &self.code {
            Code::Own(scenes) => scenes,
            Code::Peer(peer) => peer,
            Code::Command(command) => command,
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

    fn read_further(
        &self,
        request: &RunRequest,
        record: &Record,
    ) -> Result<BTreeMap<String, Observation>, SimulatorError> {
        let mut all = BTreeMap::new();
        let of_model = self
            .curves
            .iter()
            .filter(|(model, _)| *model == request.model);
        for (_, curve) in of_model {
            let scores = curve.read(record);
            all.extend(scores.map_err(|reason| SimulatorError::Failed { reason })?);
        }
        Ok(all)
    }
}
