//! What the decks of benches have in common for all tools: walls by name, the box of the simulation, times in steps, and the phases as
//! a script.
//!
//! # What a deck does
//!
//! The seeds start where they start here, in a poured heap at random places in the inlet. Each phase then runs until it ends by the
//! rule of the run here, which the script tests itself: at rest, after a time, at a force, a depth, a discharged fraction. A level outlet
//! below the bed is the lower face of the box, at which both codes take spheres out.
//!
//! # What a deck leaves
//!
//! For each phase `K-NAME.dump` with the spheres, and `K-NAME.txt` with the forces on the walls and their displacements.
//! [`crate::exchange::bench_results`] reads them.

mod phases;
pub(crate) mod surfaces;

pub(crate) use phases::{AXES, Dialect, prescribed, script, since_begin};

use crate::exchange::Error;
use crate::exchange::drum_deck::supported_model;
use crate::exchange::vtk::add;
use dem_solver::Motion;
use nalgebra::Vector3;
use scene::{Apparatus, End, Procedure, Scene, SeedBody, Surface};
use std::sync::Arc;

/// Time between two dumps, s, unless samples are taken less often.
const DUMP_INTERVAL: f64 = 5e-3;
/// Time between two tests for rest, s, as in the runs here.
const TEST_INTERVAL: f64 = 0.02;
/// Most bins of the box: what fits into some 100 MB.
const MOST_BINS: f64 = 2e6;
/// Steps of which the gain of a loaded wall without mass is made.
const SERVO_STEPS: f64 = 25.0;

/// A bench that a tool can run.
#[derive(Debug)]
pub(crate) struct BenchDeck<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) bodies: &'a [Arc<SeedBody>],
    pub(crate) procedure: Procedure,
    /// Words for the walls, in their order.
    pub(crate) ids: Vec<String>,
    /// Time step of the deck, s.
    pub(crate) time_step: f64,
    /// Lower and upper corner of the box, m.
    pub(crate) domain: [Vector3<f64>; 2],
}

impl<'a> BenchDeck<'a> {
    /// The bench of a scene.
    ///
    /// # Errors
    ///
    /// What the tool does not have, by name.
    pub(crate) fn of(
        scene: &'a Scene,
        bodies: &'a [Arc<SeedBody>],
        time_step: f64,
        tool: &'static str,
    ) -> Result<Self, Error> {
        check(scene, tool)?;
        let Some(procedure) = Procedure::of(scene, bodies)? else {
            return Err(not_there(
                format!("the apparatus '{}'", scene.apparatus.kind()),
                tool,
                OTHER_APPARATUS,
            ));
        };
        if procedure.is_periodic {
            let what = "periodic sides".to_owned();
            return Err(not_there(what, tool, "remove apparatus.periodic"));
        }
        check_outlets(&procedure, tool)?;
        let domain = domain(scene, bodies, &procedure);
        Ok(Self {
            ids: ids(&procedure),
            scene,
            bodies,
            procedure,
            time_step,
            domain,
        })
    }

    /// Number of steps between two rows of the table of walls.
    pub(crate) fn every(&self) -> u64 {
        whole(self.procedure.plan.interval / self.time_step)
    }

    /// Number of steps between two dumps, a multiple of [`Self::every`].
    pub(crate) fn dump_every(&self) -> u64 {
        let times = (DUMP_INTERVAL / self.procedure.plan.interval).ceil();
        whole(times) * self.every()
    }

    /// Number of steps between two tests for rest, a multiple of [`Self::dump_every`].
    fn test_every(&self) -> u64 {
        self.steps(TEST_INTERVAL)
    }

    /// Steps in at least a time (s), a multiple of [`Self::dump_every`].
    fn steps(&self, time: f64) -> u64 {
        let every = self.dump_every();
        let moments = (time / (self.time_step * every as f64) - 1e-6).ceil();
        whole(moments) * every
    }

    /// Words for bins of a size at which the box has at most two million, behind the default size (m); empty if the default has fewer. The
    /// first are those of `neigh_modify`, the others a command that sorts by such bins.
    pub(crate) fn bins(&self, usual: f64) -> [String; 2] {
        let size = ((self.domain[1] - self.domain[0]).product() / MOST_BINS).cbrt();
        if size <= usual {
            return [String::new(), String::new()];
        }
        [
            format!(" binsize {size:e}"),
            format!("atom_modify sort 1000 {size:e}\n"),
        ]
    }

    /// Place of a wall by its name.
    pub(crate) fn wall(&self, name: &str) -> usize {
        let mut walls = self.procedure.walls.iter();
        walls.position(|wall| wall.name == name).unwrap_or(0)
    }

    /// The first load that a wall carries in any phase; `None` if it never carries one.
    pub(crate) fn first_load(&self, wall: usize) -> Option<dem_solver::AxialLoad> {
        self.motions_of(wall).find_map(|motion| motion.load)
    }

    /// The motions that a wall gets, phase by phase.
    pub(crate) fn motions_of(&self, wall: usize) -> impl Iterator<Item = &Motion> {
        let name = &self.procedure.walls[wall].name;
        let phases = self.procedure.plan.phases.iter();
        let motions = phases.flat_map(|phase| &phase.motions);
        motions.filter(move |(of, _)| of == name).map(|(_, m)| m)
    }

    /// Speed of a loaded wall without mass over the force that is left, m/(s N).
    ///
    /// # Formula
    ///
    /// `T/m`, the speed at which the damping of [`dem_solver::AxialLoad`] carries a force, with T at most 25 steps. The dashpots of a layer
    /// of n seeds of a mass M push a wall by `c v`, c of the order `n M / 20` a step: with more than some 100 steps the speed swings
    /// between its limits, because a wall of half the mass of the bed has some layers.
    pub(crate) fn servo_gain(&self, load: &dem_solver::AxialLoad) -> f64 {
        load.damping_time.min(SERVO_STEPS * self.time_step) / load.mass
    }

    /// Most times between two rows of the table of walls in which a loaded wall may come to the bed.
    pub(crate) fn approaches(&self) -> u64 {
        self.steps(self.scene.protocol.rotation_limit.si()) / self.every()
    }

    /// Name of the files of a phase, without its ending.
    pub(crate) fn stem(&self, phase: usize) -> String {
        stem(phase, &self.procedure.plan.phases[phase].name)
    }

    /// Materials of the seeds and then of the walls, each once.
    pub(crate) fn materials(&self) -> Vec<&str> {
        let mut names = vec![self.scene.seed[0].material.as_str()];
        for wall in &self.procedure.walls {
            if !names.contains(&wall.material.as_str()) {
                names.push(&wall.material);
            }
        }
        names
    }

    /// Region in which seeds appear over time, as radius, lower and upper end, m.
    ///
    /// Seeds here appear as low in the inlet as there is room. The region is therefore as high as the seeds need that have not yet fallen
    /// by their diameter, at a fraction of 0.2 of its volume (our choice), and two diameters at least.
    pub(crate) fn inlet(&self) -> Option<[f64; 3]> {
        let [radius, low, high] = self.procedure.inlet?;
        let spheres = self.bodies.iter().map(|b| b.clump.bounding_radius());
        let diameter = 2.0 * spheres.fold(0.0, f64::max);
        let fall = (2.0 * diameter / self.scene.model.gravity_m_s2).sqrt();
        let volume = std::f64::consts::FRAC_PI_6 * diameter.powi(3);
        let area = std::f64::consts::PI * radius * radius;
        let height = (self.rate() * fall * volume / (0.2 * area)).max(2.0 * diameter);
        Some([radius, low, (low + height).min(high)])
    }

    /// Seeds that appear in a second.
    pub(crate) fn rate(&self) -> f64 {
        let rate = self.scene.protocol.insertion_rate;
        rate.map_or(f64::INFINITY, input::quantity::Frequency::si)
    }
}

/// A number of steps, at least one.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "positive, and a cast saturates"
)]
fn whole(number: f64) -> u64 {
    number.round().max(1.0) as u64
}

/// What to do about an apparatus that decks do not have.
const OTHER_APPARATUS: &str =
    "export a drum or a bench with phases, or its settings as a table for EDEM";

fn not_there(what: String, tool: &'static str, way_out: &'static str) -> Error {
    Error::NotThere {
        what,
        tool,
        way_out,
    }
}

/// Refuses what no tool has of a scene with a bench.
///
/// # Errors
///
/// What is missing, by name.
pub(crate) fn check(scene: &Scene, tool: &'static str) -> Result<(), Error> {
    if !scene.apparatus.has_phases() || matches!(scene.apparatus, Apparatus::Drum(_)) {
        let what = format!("the apparatus '{}'", scene.apparatus.kind());
        return Err(not_there(what, tool, OTHER_APPARATUS));
    }
    supported_model(scene, tool)
}

/// Refuses outlets that are not the lower face of a box.
fn check_outlets(procedure: &Procedure, tool: &'static str) -> Result<(), Error> {
    let Some(first) = lowest_outlet(procedure) else {
        return Ok(());
    };
    let phases = procedure.plan.phases.iter();
    for outlet in phases.flat_map(|phase| &phase.outlets) {
        let is_level = (outlet.normal + Vector3::y()).norm() < 1e-9;
        if !is_level || (outlet.point.y - first).abs() > 1e-9 {
            return Err(not_there(
                "an outlet that is not one level plane below the bed".into(),
                tool,
                "simulate this bench here; a deck takes seeds out at the bottom of its box alone",
            ));
        }
    }
    Ok(())
}

/// Height of the lowest outlet, m; `None` without any.
fn lowest_outlet(procedure: &Procedure) -> Option<f64> {
    let phases = procedure.plan.phases.iter();
    let outlets = phases.flat_map(|phase| &phase.outlets);
    outlets.map(|outlet| outlet.point.y).reduce(f64::min)
}

/// The box of the simulation, m: around walls, the room and the ways of the walls, and on a floor without sides three sizes of the room
/// beyond.
fn domain(scene: &Scene, bodies: &[Arc<SeedBody>], procedure: &Procedure) -> [Vector3<f64>; 2] {
    let [mut low, mut high] = procedure.room;
    let mut include = |point: &Vector3<f64>| {
        low = low.inf(point);
        high = high.sup(point);
    };
    // A phase ends with a whole number of tests for rest.
    let longest = 1.05 * scene.protocol.rotation_limit.si() + 0.1;
    for wall in &procedure.walls {
        match &wall.surface {
            Surface::Plane { point, normal } => {
                // The coordinates in which it is anywhere do not count.
                let here = 0.5 * (procedure.room[0] + procedure.room[1]);
                include(&(here - normal * (here - point).dot(normal)));
            }
            Surface::Triangles(triangles) => {
                let motions = (procedure.plan.phases.iter())
                    .flat_map(|phase| phase.motions.iter().map(move |m| (&phase.end, m)))
                    .filter(|(_, (name, _))| *name == wall.name);
                let mut way = Vector3::zeros();
                let mut ends = vec![way];
                for (end, (_, motion)) in motions {
                    let time = match end {
                        End::After(time) => *time,
                        _ => longest,
                    };
                    let swing = motion
                        .vibration
                        .map_or_else(Vector3::zeros, |v| v.amplitude);
                    way += motion.velocity * time;
                    ends.extend([way + swing, way - swing]);
                }
                for corner in triangles.iter().flatten() {
                    for end in &ends {
                        include(&(corner + end));
                    }
                }
            }
        }
    }
    let radii = bodies.iter().map(|body| body.clump.bounding_radius());
    let margin = 4.0 * radii.fold(0.0, f64::max);
    let size = (procedure.room[1] - procedure.room[0]).max();
    for (axis, sign) in [(0, -1.0), (0, 1.0), (2, -1.0), (2, 1.0)] {
        let beyond = if is_closed(procedure, axis, sign) {
            margin
        } else {
            3.0 * size
        };
        if sign < 0.0 {
            low[axis] -= beyond;
        } else {
            high[axis] += beyond;
        }
    }
    high.y += margin;
    low.y = lowest_outlet(procedure).unwrap_or(low.y - margin);
    [low, high]
}

/// Whether a plane bounds the bed on a side.
fn is_closed(procedure: &Procedure, axis: usize, sign: f64) -> bool {
    let bounds = |wall: &scene::ProcedureWall| matches!(wall.surface, Surface::Plane { normal, .. } if normal[axis] * sign < -0.99);
    procedure.walls.iter().any(bounds)
}

/// Words for walls: their names with `_` for all but letters and digits, and a number behind a word that is there already.
fn ids(procedure: &Procedure) -> Vec<String> {
    let mut ids: Vec<String> = Vec::new();
    for wall in &procedure.walls {
        let word = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
        let word: String = wall.name.chars().map(word).collect();
        let mut id = word.clone();
        let mut number = 1;
        while ids.contains(&id) {
            number += 1;
            id = format!("{word}_{number}");
        }
        ids.push(id);
    }
    ids
}

/// Name of the files of a phase by its number and name, without its ending.
pub(crate) fn stem(phase: usize, name: &str) -> String {
    let word = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
    format!("{phase}-{}", name.chars().map(word).collect::<String>())
}

/// A surface of triangles as an STL file.
pub(crate) fn stl(name: &str, triangles: &[[Vector3<f64>; 3]]) -> String {
    let mut text = format!("solid {name}\n");
    for [a, b, c] in triangles {
        let normal = (b - a).cross(&(c - a)).normalize();
        let corner = |p: &Vector3<f64>| format!("vertex {:e} {:e} {:e}\n", p.x, p.y, p.z);
        let facet = format_args!(
            "facet normal {:e} {:e} {:e}\nouter loop\n{}{}{}endloop\nendfacet\n",
            normal.x,
            normal.y,
            normal.z,
            corner(a),
            corner(b),
            corner(c)
        );
        add(&mut text, facet);
    }
    add(&mut text, format_args!("endsolid {name}\n"));
    text
}

#[cfg(test)]
mod tests;
