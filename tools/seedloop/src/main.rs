//! The seedloop command.

fn main() {}
