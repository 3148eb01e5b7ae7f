//! Triangle meshes: reading, checking, volume, inertia, inside test.
