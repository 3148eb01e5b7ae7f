//! Sizes of the lists of a world.

use std::ops::AddAssign;

/// Sizes of the lists at one moment.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Census {
    /// Pairs of bodies whose bounding spheres are near.
    pub body_pairs: usize,
    /// Those of them with at least one pair of spheres within the skin in their list; none in a world of bodies
    /// of one sphere each.
    pub pairs_with_candidates: usize,
    /// Groups of up to eight candidates.
    pub chunks: usize,
    /// Pairs of bodies that touch.
    pub touching_pairs: usize,
    /// Touching pairs of spheres.
    pub sphere_contacts: usize,
    /// Bytes of the lists that a step reads.
    pub bytes: usize,
    /// Lists rebuilt since the start.
    pub rebuilds: u64,
    /// Lists looked at since the start.
    pub checks: u64,
}

impl AddAssign for Census {
    fn add_assign(&mut self, other: Self) {
        self.body_pairs += other.body_pairs;
        self.pairs_with_candidates += other.pairs_with_candidates;
        self.chunks += other.chunks;
        self.touching_pairs += other.touching_pairs;
        self.sphere_contacts += other.sphere_contacts;
        self.bytes += other.bytes;
        self.rebuilds += other.rebuilds;
        self.checks += other.checks;
    }
}
