//! A touching pair of spheres.

use crate::contact::Memory;

/// A touching pair of spheres and what its contact remembers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SphereContact {
    /// Sphere of i in the upper half, sphere of j (or 0 for a wall) in the lower half.
    pub(crate) key: u32,
    /// What the contact remembers.
    pub(crate) memory: Memory,
}
