//! Formulas of one triangle: nearest point, area, solid angle.
//!
//! A triangle is its three corners, m. Solver and mesh reader share these; neither needs the other.
//!
//! ```
//! use nalgebra::Vector3;
//! let corners = [Vector3::zeros(), Vector3::x(), Vector3::y()];
//! let nearest = geometry::triangle::nearest_on_triangle(&Vector3::new(0.2, 0.3, 0.5), &corners);
//! assert!((nearest - Vector3::new(0.2, 0.3, 0.0)).norm() < 1e-15);
//! assert_eq!(geometry::triangle::area_vector(&corners), Vector3::new(0.0, 0.0, 0.5));
//! ```

mod area;
mod closest_point;
mod solid_angle;

pub use area::area_vector;
pub use closest_point::{ClosestPoint, Feature, closest_point, nearest_on_triangle};
pub use solid_angle::solid_angle;
