//! What a user writes: quantities with their unit, numbers as people read them, and plain files of a plausible size.

pub mod file;
pub mod quantity;
