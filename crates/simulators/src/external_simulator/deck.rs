//! A deck as a conversation: what is sent to the code, part by part.

use crate::exchange::vtk::File;
use crate::exchange::{FINER, Moment, lammps, liggghts};
use crate::external_simulator::bed::Bed;
use crate::external_simulator::peer::Peer;
use crate::external_simulator::process::Failure;
use crate::external_simulator::session::DUMP;
use campaign::SimulatorError;
use scene::{FillingLibrary, Scene, starting_frame};

/// Least number of moments in one swing of the bed.
const LEAST_IN_SWING: f64 = 5.0;

/// A deck and how it is run.
#[derive(Debug)]
pub(crate) struct Deck {
    /// Its files, the script first.
    files: Vec<File>,
    /// Its time step, s.
    pub(crate) time_step: f64,
    /// Time between two moments, s.
    pub(crate) interval: f64,
    /// The same in steps.
    every: u64,
    /// Steps until the drum turns, or all seeds have come to lie in the turning drum.
    start_steps: u64,
    /// Moments from frame to frame.
    pub(crate) frame_every: usize,
    /// Number of spheres that are dumped.
    spheres: usize,
    /// What is dumped of each.
    columns: &'static str,
}

impl Deck {
    /// The deck of a scene.
    ///
    /// # Errors
    ///
    /// A scene that cannot be built, or that the code does not run.
    pub(crate) fn of(
        scene: &Scene,
        peer: Peer,
        fillings: &FillingLibrary,
        seed: u64,
    ) -> Result<Self, SimulatorError> {
        let (start, bodies, time_step) =
            starting_frame(scene, fillings, seed).map_err(SimulatorError::other)?;
        let time_step = time_step / FINER;
        let (files, filling_s) = match peer {
            Peer::Lammps => (
                lammps::setup(scene, &bodies, &start, time_step),
                scene.protocol.settle_limit.si(),
            ),
            Peer::Liggghts => (
                liggghts::setup(scene, &bodies, liggghts::Start::Rain(seed), time_step),
                liggghts::filling_time(scene),
            ),
        };
        let files = files.map_err(SimulatorError::other)?;
        // A free pendulum as long as the radius: a bed swings no faster.
        let pendulum = (scene.apparatus.radius() / scene.model.gravity_m_s2).sqrt();
        let longest = std::f64::consts::TAU * pendulum / LEAST_IN_SWING;
        let frame = scene.protocol.frame_interval.si();
        let parts = (frame / longest).ceil().max(1.0);
        let spheres = start.kind.iter().map(|k| bodies[*k].outer.spheres().len());
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "positive numbers of steps"
        )]
        let (every, filling, frame_every) = (
            (frame / parts / time_step).round().max(1.0) as u64,
            (filling_s / time_step).ceil() as u64,
            parts as usize,
        );
        Ok(Self {
            files,
            time_step,
            interval: every as f64 * time_step,
            every,
            // Dumps are written at steps that are multiples of their interval.
            start_steps: filling.div_ceil(every) * every,
            frame_every,
            spheres: spheres.sum(),
            columns: match peer {
                Peer::Lammps => lammps::dump_columns(&bodies),
                Peer::Liggghts => "id type x y z radius vx vy vz",
            },
        })
    }

    /// The files that the script reads.
    pub(crate) fn further_files(&self) -> &[File] {
        &self.files[1..]
    }

    /// The script, and the run in which the seeds come to lie.
    pub(crate) fn start(&self) -> String {
        format!(
            "{}\nthermo_style custom step time\nthermo {}\nrun {}",
            self.files[0].text, self.every, self.start_steps
        )
    }

    /// The begin of the dump, and the first moments of the turning drum.
    pub(crate) fn turn(&self) -> String {
        let columns = self.columns;
        format!(
            "dump bed all custom {every} {DUMP} {columns}\ndump_modify bed first yes\nrun {every}",
            every = self.every
        )
    }

    /// So many moments more.
    pub(crate) fn go_on(&self, moments: usize) -> String {
        format!("run {}", moments as u64 * self.every)
    }

    /// Number of steps behind so many moments.
    pub(crate) fn steps_of(&self, moments: usize) -> u64 {
        self.start_steps + moments.saturating_sub(1) as u64 * self.every
    }

    /// Adds moments to a bed; fails where spheres were lost.
    pub(crate) fn add(&self, bed: &mut Bed, moments: Vec<Moment>) -> Result<(), Failure> {
        for moment in moments {
            if moment.spheres.len() != self.spheres {
                return Err(format!(
                    "{} of {} spheres are in the drum at step {}",
                    moment.spheres.len(),
                    self.spheres,
                    moment.step.unwrap_or(0)
                ));
            }
            bed.push(moment);
        }
        Ok(())
    }
}
