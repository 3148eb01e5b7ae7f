//! A contact as it is kept where its list is not.

use crate::contact::Memory;
use serde::{Deserialize, Serialize};

/// What one contact of two bodies, or of a body and a wall, remembers.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct KeptContact {
    /// The body.
    pub(crate) body: usize,
    /// The other body, or the wall.
    pub(crate) other: usize,
    /// The spheres.
    pub(crate) key: u32,
    /// What is remembered.
    pub(crate) memory: Memory,
}
