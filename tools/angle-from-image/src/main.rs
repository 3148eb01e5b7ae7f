//! Reads the angle of repose from photos and frames.

fn main() {}
