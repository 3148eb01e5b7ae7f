//! Triangle meshes: reading, checking, volume, inertia, inside test.
//!
//! A scan comes as an STL, OBJ or PLY file without units, often with faults. [`read_mesh`] reads
//! it in a declared unit, joins vertices, cuts crumbs away, closes small holes, turns the triangles
//! outward and reports all that it did; [`Repair`] says how much of that is allowed.
//! A [`TriMesh`] is always in metres.
//!
//! ```
//! use trimesh::{LengthUnit, SignedDistance, shapes};
//! let ball = shapes::ellipsoid([1e-3, 1e-3, 1e-3], 20)?;
//! assert!((ball.moments().volume / 4.18879e-9 - 1.0).abs() < 0.01);
//! let distance = SignedDistance::new(&ball)?;
//! assert!(distance.contains(&nalgebra::Vector3::zeros()));
//! assert_eq!(LengthUnit::Millimetre.in_metres(), 1e-3);
//! # Ok::<(), trimesh::Error>(())
//! ```
//!
//! Invariants: every vertex is finite, every index is in range, no triangle names a vertex
//! twice, and in a closed mesh every edge joins exactly two triangles that run through it in
//! opposite directions, outward normals by the right-hand rule. Self-intersection of a single
//! shell is not searched for.

mod bodies;
mod body_shape;
mod bounding_tree;
mod build;
mod crossings;
mod crumbs;
mod cube_grid;
mod error;
mod holes;
mod length_unit;
mod lid;
mod mesh;
mod moments;
mod obj;
mod orientation;
mod ply;
mod polygon;
mod principal;
mod proposal;
mod read;
mod rebuild;
mod repair;
mod report;
mod sampling;
pub mod shapes;
mod signed_distance;
mod smallest_box;
mod soup;
mod stl;
mod voxels;
mod weld;
mod winding;
mod winding_tree;
mod words;

pub use bodies::Shell;
pub use body_shape::BodyShape;
pub use build::CheckedMesh;
pub use cube_grid::CubeGrid;
pub use error::Error;
pub use length_unit::LengthUnit;
pub use mesh::{BoundingBox, Topology, TriMesh};
pub use moments::VolumeMoments;
pub use principal::PrincipalAxes;
pub use proposal::Proposal;
pub use read::{parse_mesh, read_mesh, read_mesh_with};
pub use repair::{Changes, Lid, Rebuilt, Repair};
pub use report::{MeshReport, Warning};
pub use sampling::SurfaceSample;
pub use signed_distance::{SignedDistance, SurfacePoint};
pub use voxels::VoxelStack;
pub use winding::winding_number;
