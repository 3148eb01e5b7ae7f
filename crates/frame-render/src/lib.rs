//! Pictures of spheres as a camera would see them.
