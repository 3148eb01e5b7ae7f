//! The crate arrows agree with the map.
