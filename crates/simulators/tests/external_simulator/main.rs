//! Other programs as simulators.
//!
//! One program for all files: it is linked once, and its tests share the cores.

mod command;
mod conversation;
