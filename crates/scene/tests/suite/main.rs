//! What a scene gives: protocols, benches, restarts, limits.
//!
//! One program for all files: it is linked once, and its tests share the cores.

mod bench;
mod benches;
mod bonded;
mod coarse;
mod factory;
mod limits;
mod machine;
mod numbers;
mod periodic;
mod phases;
mod readings;
mod reduced;
mod restart;
mod seeds;
mod spheres;
mod start;
