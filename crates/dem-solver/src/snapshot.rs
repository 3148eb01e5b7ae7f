//! The state of a world between two steps, to be kept and continued from.
//!
//! A snapshot holds what the next step depends on: bodies, what each contact remembers, the walls on
//! their way, and the time. The lists are not part of it. They are rebuilt, and since the forces are
//! summed in the order of bodies and spheres whatever the age of the lists, a world that continues from
//! a snapshot continues with the same bits.

use crate::bodies::{Bodies, Placement};
use crate::error::Error;
use crate::kept_contact::KeptContact;
use crate::mesh_force::MeshContact;
use crate::mesh_wall::Path;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// State of a world between two steps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    pub(crate) bodies: Bodies,
    /// Contacts of bodies, in order of the later body, then of the other, then of the spheres.
    pub(crate) pairs: Vec<KeptContact>,
    /// Contacts of bodies and walls, in order of the bodies, walls and spheres.
    pub(crate) walls: Vec<KeptContact>,
    /// Contacts of bodies and walls of triangles, likewise.
    pub(crate) meshes: Vec<MeshContact>,
    /// Way of each wall of triangles.
    pub(crate) paths: Vec<Path>,
    /// Spin of each wall, rad/s.
    pub(crate) spins: Vec<f64>,
    /// Force (N) and torque (N m) on each wall in the last step.
    pub(crate) wall_loads: Vec<(Vector3<f64>, f64)>,
    /// Time since the start, s.
    pub(crate) time: f64,
    /// Steps since the start.
    pub(crate) n_steps: u64,
    /// Time step, s.
    pub(crate) time_step: f64,
    /// Gravity, m/s².
    pub(crate) gravity: Vector3<f64>,
}

impl Snapshot {
    /// Time since the start, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Where the bodies are and how they move.
    pub fn placements(&self) -> impl Iterator<Item = Placement> + '_ {
        let b = &self.bodies;
        (0..b.len()).map(|i| Placement {
            template: b.template[i],
            position: b.position[i],
            orientation: b.orientation[i],
            velocity: b.velocity[i],
            spin: b.spin[i],
        })
    }

    /// The same with the contacts of bodies that have gone to other places.
    pub(crate) fn renumbered(self, places: &[usize]) -> Self {
        let pairs = self.pairs.iter().map(|c| c.between(places)).collect();
        let mut walls = self.walls;
        for contact in &mut walls {
            contact.body = places[contact.body];
        }
        walls.sort_by_key(|contact| (contact.body, contact.other));
        let mut meshes = self.meshes;
        for contact in &mut meshes {
            contact.body = places[contact.body];
        }
        Self {
            pairs,
            walls,
            meshes,
            ..self
        }
    }

    /// The same with the contacts of the bodies alone that have a new place; these are in the order of before.
    pub(crate) fn without(mut self, places: &[Option<usize>]) -> Self {
        let is_kept = |body: usize| places[body].is_some();
        self.pairs.retain(|c| is_kept(c.body) && is_kept(c.other));
        self.walls.retain(|c| is_kept(c.body));
        self.meshes.retain(|c| is_kept(c.body));
        // Contacts of bodies without a place are gone: what stands for it is never read.
        let places: Vec<usize> = places.iter().map(|p| p.unwrap_or(0)).collect();
        self.renumbered(&places)
    }

    /// Refuses a snapshot of another world than that of these bodies, and so many walls and walls of triangles.
    pub(crate) fn check(
        &self,
        bodies: &Bodies,
        walls: usize,
        mesh_walls: usize,
    ) -> Result<(), Error> {
        let counts = [
            ("bodies", self.bodies.template.len(), bodies.len()),
            ("walls", self.spins.len(), walls),
            ("loads of walls", self.wall_loads.len(), walls),
            ("walls of triangles", self.paths.len(), mesh_walls),
        ];
        for (what, found, expected) in counts {
            if found != expected {
                return Err(Error::OtherWorld {
                    what,
                    found: found.to_string(),
                    expected: expected.to_string(),
                });
            }
        }
        if self.bodies.template != bodies.template {
            return Err(Error::OtherWorld {
                what: "types of the bodies",
                found: "another order".into(),
                expected: "the same".into(),
            });
        }
        if !self.bodies.is_consistent() || self.time_step <= 0.0 {
            return Err(Error::OtherWorld {
                what: "state of the bodies",
                found: "incomplete".into(),
                expected: "whole".into(),
            });
        }
        Ok(())
    }
}
