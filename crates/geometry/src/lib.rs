//! Bodies and triangles: the multi-sphere body with its mass and inertia, and formulas of one triangle.

pub mod clump;
pub mod triangle;
