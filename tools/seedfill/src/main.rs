//! Fills a closed mesh with spheres.

fn main() {}
