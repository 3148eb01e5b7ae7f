//! Fillings of meshes and clumps from elsewhere.
//!
//! One program for all files: it is linked once, and its tests share the cores.

mod clumps;
mod filling;
