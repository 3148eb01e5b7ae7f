//! Meshes: reading, repair, moments, distance.
//!
//! One program for all files: it is linked once, and its tests share the cores.

mod distance;
mod formats;
mod moments;
mod mutated;
mod other_reader;
mod reading;
mod shape;
