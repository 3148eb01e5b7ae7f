//! The state of a world between two steps: taken, and continued from.

use super::World;
use crate::bodies::Bodies;
use crate::error::Error;
use crate::kept_contact::KeptContact;
use crate::mesh_wall::Moving;
use crate::part::Part;
use crate::snapshot::Snapshot;

impl World {
    /// Contacts of bodies, as of the last step.
    pub(crate) fn kept_pairs(&self) -> impl Iterator<Item = KeptContact> + '_ {
        self.parts.iter().flat_map(Part::kept_pairs)
    }

    /// Contacts of bodies and walls, as of the last step.
    pub(super) fn kept_walls(&self) -> impl Iterator<Item = KeptContact> + '_ {
        self.parts.iter().flat_map(Part::kept_walls)
    }

    /// The state between two steps.
    pub fn snapshot(&self) -> Snapshot {
        self.snapshot_with(self.bodies.clone())
    }

    /// The state between two steps with a copy of the bodies.
    pub(super) fn snapshot_with(&self, mut bodies: Bodies) -> Snapshot {
        let loads = self.wall_load.iter().zip(&self.wall_torque);
        // Ways count from the search that the lists come from.
        bodies.travel.fill(0.0);
        bodies.shift.clear();
        // Lists of spheres lie wall by wall in each part.
        let mut walls: Vec<_> = self.kept_walls().collect();
        walls.sort_by_key(|contact| (contact.body, contact.other));
        Snapshot {
            bodies,
            pairs: self.kept_pairs().collect(),
            walls,
            meshes: self.mesh_walls.kept(),
            paths: self.mesh_walls.moving.iter().map(Moving::path).collect(),
            spins: self.walls.iter().map(|wall| wall.spin).collect(),
            wall_loads: loads.map(|(&force, &torque)| (force, torque)).collect(),
            time: self.time,
            n_steps: self.n_steps,
            time_step: self.settings.time_step,
            gravity: self.settings.gravity,
        }
    }

    /// Continues from a snapshot of a world that was built like this one; this one has not moved yet.
    ///
    /// The steps that follow give the same bits as those of the world that the snapshot was taken of.
    ///
    /// # Errors
    ///
    /// A world that has moved already, a snapshot of another world.
    pub fn resume(&mut self, snapshot: Snapshot) -> Result<(), Error> {
        let other = |what, found: String, expected: String| Error::OtherWorld {
            what,
            found,
            expected,
        };
        if self.n_steps > 0 {
            return Err(other("steps done", self.n_steps.to_string(), "0".into()));
        }
        let (walls, mesh_walls) = (self.walls.len(), self.mesh_walls.moving.len());
        snapshot.check(&self.bodies, walls, mesh_walls)?;
        self.take_up(snapshot)
    }

    /// Continues from a snapshot, which fits this world.
    pub(super) fn take_up(&mut self, snapshot: Snapshot) -> Result<(), Error> {
        self.bodies = snapshot.bodies;
        // Lists of before may be of other bodies.
        self.cut_parts();
        self.mesh_walls.forget();
        self.bodies.shift.resize(self.bodies.position.len(), 0.0);
        for (wall, spin) in self.walls.iter_mut().zip(snapshot.spins) {
            wall.spin = spin;
        }
        (self.wall_load, self.wall_torque) = snapshot.wall_loads.into_iter().unzip();
        for (moving, path) in self.mesh_walls.moving.iter_mut().zip(&snapshot.paths) {
            moving.put(path);
        }
        (self.time, self.n_steps) = (snapshot.time, snapshot.n_steps);
        (self.settings.time_step, self.settings.gravity) = (snapshot.time_step, snapshot.gravity);
        self.choose_reference_spin();
        self.search_pairs()?;
        self.longest = 0.0;
        self.recall(&snapshot.pairs, &snapshot.walls)?;
        if self.mesh_walls.recall(&snapshot.meshes) {
            self.deal_liquid();
            Ok(())
        } else {
            Err(contacts_of_another_world())
        }
    }

    /// Takes up the contacts of bodies and of bodies and walls, whose lists are there and empty.
    pub(super) fn recall(
        &mut self,
        pairs: &[KeptContact],
        walls: &[KeptContact],
    ) -> Result<(), Error> {
        let mut taken = [0, 0];
        for part in &mut self.parts {
            taken[0] += part.recall_pairs(pairs);
            taken[1] += part.recall_walls(walls);
        }
        if taken == [pairs.len(), walls.len()] {
            Ok(())
        } else {
            Err(contacts_of_another_world())
        }
    }
}

/// The refusal of contacts of bodies that are not near each other.
fn contacts_of_another_world() -> Error {
    Error::OtherWorld {
        what: "contacts",
        found: "between bodies far apart".into(),
        expected: "between bodies that touch".into(),
    }
}
