//! What a thread works with while it looks at some parts of the bodies.

use crate::batch::Batch;
use crate::candidates::Scratch;
use crate::neighbours::{Due, Previous};
use crate::sphere_contact::SphereContact;
use crate::spheres::batch::SphereBatch;
use crate::spheres::pairs::SpherePairs;
use crate::spheres::walls::SphereWalls;
use crate::wall_batch::WallBatch;
use crate::wall_force::Place;

/// Buffers that no part needs between two visits, so that the parts of a piece of work share one set.
#[derive(Debug, Clone, Default)]
pub(crate) struct Workspace {
    /// Contacts that wait for their forces.
    pub(crate) batch: Batch,
    /// What is awake: pairs of one body or of a block of spheres, or candidates of a body at a wall.
    pub(crate) awake: Vec<u32>,
    /// Pairs of some bodies that are awake, with their bodies.
    pub(crate) due: Vec<Due>,
    /// Those of them whose covered motion is used up.
    pub(crate) stale: Vec<Due>,
    /// Keys of the candidates of one pair that may touch.
    pub(crate) near: Vec<u32>,
    /// Touching pairs of spheres of this step; then those of a body at a wall whose list is rebuilt.
    pub(crate) touches: Vec<SphereContact>,
    /// Buffers of the search for candidates.
    pub(crate) scratch: Scratch,
    /// Partners of one body in the broad phase.
    pub(crate) partners: Vec<u32>,
    /// Lists before the broad phase.
    pub(crate) previous: Previous,
    /// Contacts of bodies at walls that wait for their forces.
    pub(crate) at_walls: WallBatch<Place>,
    /// Contacts of bodies of one sphere that wait for their forces.
    pub(crate) spheres: SphereBatch,
    /// Pairs of bodies of one sphere before the broad phase.
    pub(crate) previous_spheres: SpherePairs,
    /// Contacts of bodies of one sphere at walls that wait for their forces.
    pub(crate) spheres_at_walls: WallBatch<usize>,
    /// Bodies of one sphere near walls before the broad phase.
    pub(crate) previous_at_walls: SphereWalls,
}
