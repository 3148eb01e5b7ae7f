//! Worlds in which every body is one sphere: nothing depends on how a body is turned, so that lists, forces and
//! motion are simpler than those of agglomerates, and several times as fast.

pub(crate) mod batch;
pub(crate) mod force;
pub(crate) mod motion;
pub(crate) mod pairs;
pub(crate) mod sphere;
pub(crate) mod walls;
