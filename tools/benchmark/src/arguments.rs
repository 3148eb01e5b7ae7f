//! What the command can be asked.

use crate::instruments::{Instrument, Subject};
use crate::scenes::BenchmarkScene;
use clap::Parser;
use std::path::PathBuf;

/// Measures what a step of the solver costs, and a call of the other instruments
///
/// Cost is time on the processor, as the kernel counts it: other work on the machine does not
/// count. Each scene is measured in the flowing state, in blocks of steps; the figure is the median
/// of the blocks. With --scaling and --ranks it is time on the clock instead. Exit code: 0 measured; 2 error.
#[derive(Debug, Parser)]
#[command(name = "benchmark", version, about)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a flag of the command line"
)]
pub(crate) struct Arguments {
    /// Scenes: seeds-N (the drum of the study, its length in proportion to N) or spheres-N (plain
    /// spheres); or calls: frame (drawn and read), photo-12mp, seedfill, analyse, and the bench tests
    /// sled and tilt (two repeats) [default: seeds 300, 1200, 4800 and spheres 2000, 10000, 100000; with --peers the
    /// spheres alone, with --scaling seeds 1200 and 4800, with --against seeds 1200]
    #[arg(value_name = "WHAT")]
    subject: Vec<Subject>,

    /// Add the large scenes to the default set: seeds-19200 and spheres-1000000
    #[arg(long)]
    large: bool,

    /// Scene file of the drum
    #[arg(long, value_name = "FILE", default_value = "fixtures/cotton/drum.toml")]
    pub(crate) drum: PathBuf,

    /// Seed of the filling
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,

    /// Blocks of steps
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..1000))]
    pub(crate) blocks: u32,

    /// Run LIGGGHTS and LAMMPS on the same scenes in turn with this solver
    ///
    /// Plain spheres at the same time step; seeds at the step of each code, which costs minutes a round.
    #[arg(long)]
    pub(crate) peers: bool,

    /// Compare a step on one thread with the same step on --threads, by the clock
    ///
    /// Two worlds from one start take their blocks in turn; the bodies must be the same at the end.
    #[arg(long, conflicts_with_all = ["peers", "large"])]
    pub(crate) scaling: bool,

    /// Compare this build with another build of this program
    ///
    /// Both take blocks of 40 steps in turn, --blocks of them, so that a change of the machine meets both;
    /// the median ratio is what counts. Says whether both worlds are the same at the end.
    #[arg(long, value_name = "PROGRAM", conflicts_with_all = ["peers", "large", "scaling"])]
    pub(crate) against: Option<PathBuf>,

    /// Tell how long the phases of a step take, by the clock
    ///
    /// The search for pairs, contacts, walls of triangles with liquid, and motion. Reading the clock costs a step 0.2 us.
    #[arg(long, conflicts_with_all = ["peers", "scaling", "against"])]
    pub(crate) phases: bool,

    /// Leave the bodies in a random order in memory, as in a bed that has mixed and is not sorted
    #[arg(long, conflicts_with_all = ["peers", "scaling", "against"])]
    pub(crate) unsorted: bool,

    /// Wait for a line before each block: what --against starts
    #[arg(long, hide = true, requires = "subject")]
    pub(crate) on_demand: bool,

    /// Rounds of all codes with --peers
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..100))]
    pub(crate) rounds: u32,

    /// Processes of each peer, by `mpirun`, and threads of this solver with --peers; above 1, times are by the clock
    #[arg(long, value_name = "N", default_value_t = 1, requires = "peers", value_parser = clap::value_parser!(u8).range(1..65))]
    pub(crate) ranks: u8,

    /// Program of LIGGGHTS
    #[arg(long, value_name = "FILE", default_value = "liggghts")]
    pub(crate) liggghts: PathBuf,

    /// Program of LAMMPS
    #[arg(long, value_name = "FILE", default_value = ".tools/lammps/bin/lmp")]
    pub(crate) lammps: PathBuf,

    /// Time step of the peers in a drum of seeds in us
    #[arg(long, value_name = "US", default_value_t = 10.0, value_parser = peer_step)]
    pub(crate) peer_step_us: f64,

    /// Neighbour skin of the peers on plain spheres in mm
    #[arg(long, value_name = "MM", default_value_t = 0.5, value_parser = skin)]
    pub(crate) peer_skin_mm: f64,

    /// Folder for decks and logs of the peers
    #[arg(long, value_name = "FOLDER", default_value = "out/benchmark")]
    pub(crate) work: PathBuf,

    #[command(flatten)]
    pub(crate) common: command_line::Common,
}

impl Arguments {
    /// The scenes asked for, or the default set.
    pub(crate) fn scenes(&self) -> Vec<BenchmarkScene> {
        if !self.subject.is_empty() {
            let scenes = self.subject.iter().filter_map(|subject| match subject {
                Subject::Scene(scene) => Some(*scene),
                Subject::Instrument(_) => None,
            });
            return scenes.collect();
        }
        let mut all = vec![];
        if self.scaling {
            return vec![BenchmarkScene::Seeds(1200), BenchmarkScene::Seeds(4800)];
        }
        if !self.peers {
            all.extend([300, 1200, 4800].map(BenchmarkScene::Seeds));
            all.extend(self.large.then_some(BenchmarkScene::Seeds(19200)));
        }
        all.extend([2000, 10_000, 100_000].map(BenchmarkScene::Spheres));
        all.extend(self.large.then_some(BenchmarkScene::Spheres(1_000_000)));
        all
    }

    /// What is compared with another build.
    pub(crate) fn subjects(&self) -> Vec<Subject> {
        if self.subject.is_empty() {
            return vec![Subject::Scene(BenchmarkScene::Seeds(1200))];
        }
        self.subject.clone()
    }

    /// The calls asked for.
    ///
    /// # Errors
    ///
    /// Calls beside scenes, or where only scenes can be compared.
    pub(crate) fn instruments(&self) -> anyhow::Result<Vec<Instrument>> {
        let instruments = self.subject.iter().filter_map(|subject| match subject {
            Subject::Instrument(instrument) => Some(*instrument),
            Subject::Scene(_) => None,
        });
        let instruments: Vec<Instrument> = instruments.collect();
        if let [first, ..] = instruments.as_slice() {
            anyhow::ensure!(
                instruments.len() == self.subject.len() && !self.peers && !self.scaling,
                "{} is a call, the others are steps of the solver: measure calls by themselves, without --peers and --scaling",
                first.name()
            );
        }
        Ok(instruments)
    }
}

/// Reads a time step.
fn peer_step(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|step: &f64| (0.1..=100.0).contains(step))
        .ok_or_else(|| "a time step must be from 0.1 to 100 us".into())
}

/// Reads a skin.
fn skin(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|skin: &f64| *skin > 0.0 && *skin <= 5.0)
        .ok_or_else(|| "a skin must be above 0 and at most 5 mm".into())
}
