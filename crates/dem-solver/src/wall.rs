//! Analytic walls.

use nalgebra::Vector3;

/// Shape of a wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// The inside of a circular cylinder about the z axis; radius in m.
    Cylinder {
        /// Inner radius, m.
        radius: f64,
    },
    /// A plane; bodies are on the side to which the unit normal points.
    Plane {
        /// A point of the plane, m.
        point: Vector3<f64>,
        /// Unit normal, towards the bodies.
        normal: Vector3<f64>,
    },
    /// A thin rectangle with two faces and rounded by nothing: edges and corners count.
    Rectangle {
        /// Centre, m.
        centre: Vector3<f64>,
        /// Half-edge vectors, perpendicular to each other, m.
        half_edges: [Vector3<f64>; 2],
    },
}

/// A wall: shape, material, and rotation about the z axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Wall {
    /// Name for messages and reports.
    pub name: String,
    /// Shape.
    pub shape: Shape,
    /// Index of the material in the world's table.
    pub material: usize,
    /// Speed of the surface as a rotation about the z axis, counter-clockwise positive, rad/s.
    /// The shape itself stays where it is: only a surface of revolution may have one.
    pub spin: f64,
}

/// Nearest point of a wall as seen from a sphere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Nearest {
    /// Distance of the sphere's centre from the wall, negative behind a one-sided wall, m.
    pub(crate) distance: f64,
    /// Unit vector from the sphere towards the wall.
    pub(crate) towards: Vector3<f64>,
}

impl Wall {
    /// Whether the wall is a surface of revolution about the z axis.
    pub fn is_axisymmetric(&self) -> bool {
        match self.shape {
            Shape::Cylinder { .. } => true,
            Shape::Plane { normal, .. } => normal.x == 0.0 && normal.y == 0.0,
            Shape::Rectangle { .. } => false,
        }
    }

    /// Velocity of the wall's surface at a point, m/s.
    #[inline]
    pub(crate) fn velocity_at(&self, point: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(-self.spin * point.y, self.spin * point.x, 0.0)
    }

    /// Distance of a point from the wall, negative behind it, m: that of [`Self::nearest`].
    #[inline]
    pub(crate) fn distance(&self, centre: &Vector3<f64>) -> f64 {
        match &self.shape {
            Shape::Cylinder { radius } => radius - from_axis(centre),
            Shape::Plane { point, normal } => (centre - point).dot(normal),
            Shape::Rectangle { .. } => self.nearest(centre).distance,
        }
    }

    /// Nearest point of the wall.
    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "it is in the loop over the spheres near a wall"
    )]
    pub(crate) fn nearest(&self, centre: &Vector3<f64>) -> Nearest {
        match &self.shape {
            Shape::Cylinder { radius } => {
                let r = from_axis(centre);
                let towards = if r > 0.0 {
                    Vector3::new(centre.x / r, centre.y / r, 0.0)
                } else {
                    Vector3::x()
                };
                Nearest {
                    distance: radius - r,
                    towards,
                }
            }
            Shape::Plane { normal, .. } => Nearest {
                distance: self.distance(centre),
                towards: -normal,
            },
            Shape::Rectangle {
                centre: middle,
                half_edges,
            } => {
                let offset = centre - middle;
                let mut inside = Vector3::zeros();
                for edge in half_edges {
                    let along = offset.dot(edge) / edge.norm_squared();
                    inside += edge * along.clamp(-1.0, 1.0);
                }
                let away = inside - offset;
                let distance = away.norm();
                let towards = if distance > 0.0 {
                    away / distance
                } else {
                    Vector3::x()
                };
                Nearest { distance, towards }
            }
        }
    }
}

/// Distance from the z axis, m.
#[inline]
fn from_axis(point: &Vector3<f64>) -> f64 {
    (point.x * point.x + point.y * point.y).sqrt()
}

#[cfg(test)]
mod tests {
    use super::{Shape, Wall};
    use nalgebra::Vector3;

    fn wall(shape: Shape) -> Wall {
        Wall {
            name: "test".into(),
            shape,
            material: 0,
            spin: 2.0,
        }
    }

    #[test]
    fn nearest_point_of_each_shape_is_the_constructed_one() {
        let cylinder = wall(Shape::Cylinder { radius: 2.0 });
        let near = cylinder.nearest(&Vector3::new(0.0, -1.5, 9.0));
        assert!((near.distance - 0.5).abs() < 1e-15, "{near:?}");
        assert!((near.towards + Vector3::y()).norm() < 1e-15, "{near:?}");

        let rectangle = wall(Shape::Rectangle {
            centre: Vector3::zeros(),
            half_edges: [Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 0.0, 2.0)],
        });
        let face = rectangle.nearest(&Vector3::new(0.5, 0.25, -1.0));
        assert!((face.distance - 0.25).abs() < 1e-15, "{face:?}");
        let corner = rectangle.nearest(&Vector3::new(4.0, 0.0, 6.0));
        assert!(
            (corner.distance - 5.0).abs() < 1e-15,
            "3-4-5 triangle: {corner:?}"
        );
    }

    /// The force loop asks for the distance alone, and for the nearest point where that says touch: both
    /// must be one number, to the last bit.
    #[test]
    fn distance_is_that_of_the_nearest_point() {
        let point = Vector3::new(0.3, -0.7, 0.2);
        let shapes = [
            (Shape::Cylinder { radius: 2.0 }, 2.0 - 0.58_f64.sqrt()),
            (
                Shape::Plane {
                    point: Vector3::y() * -1.0,
                    normal: Vector3::y(),
                },
                0.3,
            ),
            (
                Shape::Rectangle {
                    centre: Vector3::zeros(),
                    half_edges: [Vector3::x(), Vector3::z()],
                },
                0.7,
            ),
        ];
        for (shape, expected) in shapes {
            let wall = wall(shape);
            let distance = wall.distance(&point);
            assert!((distance - expected).abs() < 1e-15, "{distance}: {shape:?}");
            assert!(
                distance.to_bits() == wall.nearest(&point).distance.to_bits(),
                "{shape:?}"
            );
        }
    }

    #[test]
    fn surface_speed_is_spin_times_radius() {
        let velocity =
            wall(Shape::Cylinder { radius: 2.0 }).velocity_at(&Vector3::new(0.0, -2.0, 0.0));
        assert!(
            (velocity - Vector3::new(4.0, 0.0, 0.0)).norm() < 1e-15,
            "{velocity}"
        );
    }
}
