//! Pictures of drums and objects.
//!
//! One program for all files: it is linked once, and its tests share the cores.

mod coat;
mod drum;
mod object;
