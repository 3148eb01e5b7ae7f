//! A contact as it is kept where its list is not.

use crate::contact::Memory;
use serde::{Deserialize, Serialize};

/// What one contact of two bodies, or of a body and a wall, remembers.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct KeptContact {
    pub(crate) body: usize,
    /// The other body, or the wall.
    pub(crate) other: usize,
    /// The spheres.
    pub(crate) key: u32,
    /// What is remembered.
    pub(crate) memory: Memory,
}

impl KeptContact {
    /// The contact of two bodies that go to other places. Where the second comes to stand before the first, their sides
    /// are exchanged, and what acted on the one acts on the other.
    pub(crate) fn between(&self, places: &[usize]) -> Self {
        let (body, other) = (places[self.body], places[self.other]);
        if body < other {
            return Self {
                body,
                other,
                ..*self
            };
        }
        Self {
            body: other,
            other: body,
            key: self.key.rotate_left(16),
            memory: Memory {
                slip: -self.memory.slip,
                rolling: -self.memory.rolling,
            },
        }
    }
}
