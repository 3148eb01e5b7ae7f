//! Input of a user: quantities with their unit, numbers in readable form, and plain files of a plausible size.

pub mod file;
pub mod quantity;
