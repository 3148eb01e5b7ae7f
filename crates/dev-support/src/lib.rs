//! For tests and trials alone: the fixtures of the workspace, and drawn pictures of drums and heaps whose surface is known exactly.

pub mod drawn_pictures;
pub mod fixture_files;
