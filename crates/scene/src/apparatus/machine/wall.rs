//! Walls of a machine.

use super::{check_box, point, unit};
use crate::Error;
use crate::apparatus::shapes::{Corners, between_circles_about, quadrangle};
use crate::apparatus::{NamedMesh, NamedWall};
use crate::check::bad;
use dem_solver::{Motion, Shape};
use input::quantity::Length;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// A wall.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MachineWall {
    /// Name.
    pub name: String,
    /// Name of the material.
    pub material: String,
    /// Where its surface is at the start.
    pub shape: WallShape,
    /// Point about which it turns, and about which its torque is taken; the origin if omitted. It moves along with the wall.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub about: Option<[Length; 3]>,
}

/// A surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum WallShape {
    /// An endless plane, which cannot move.
    Plane {
        /// A point of the plane.
        point: [Length; 3],
        /// Direction towards the seeds.
        normal: [f64; 3],
    },
    /// A parallelogram, seen from both sides.
    Rectangle {
        /// A corner.
        corner: [Length; 3],
        /// The two edges that begin there.
        edges: [[Length; 3]; 2],
    },
    /// Faces of a box, seen from both sides.
    Box {
        /// Lower and upper corner.
        corners: [[Length; 3]; 2],
        /// Faces that are left out: `-x`, `+x`, `-y` (the bottom), `+y` (the top), `-z` (the back), `+z` (the front).
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        open: Vec<Face>,
    },
    /// Tube, cone, ring or disc: the surface between two circles about an axis, in 48 plane sides.
    Revolved {
        /// Radius and place along the axis of the first circle.
        from: [Length; 2],
        /// The same of the second.
        to: [Length; 2],
        /// Axis; y, upwards, if omitted.
        #[serde(default)]
        axis: Axis,
        /// A point of the axis, from which places along it are counted; the origin if omitted.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        centre: Option<[Length; 3]>,
    },
}

/// An axis of the scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Axis {
    /// To the right.
    X,
    /// Upwards.
    #[default]
    Y,
    /// Towards the camera.
    Z,
}

/// A face of a box.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Face {
    /// Left.
    #[serde(rename = "-x")]
    Left,
    /// Right.
    #[serde(rename = "+x")]
    Right,
    /// Bottom.
    #[serde(rename = "-y")]
    Bottom,
    /// Top.
    #[serde(rename = "+y")]
    Top,
    /// Back.
    #[serde(rename = "-z")]
    Back,
    /// Front.
    #[serde(rename = "+z")]
    Front,
}

impl Face {
    /// All faces: coordinate that is the same on a face, and whether it is the upper one.
    const ALL: [(Self, usize, bool); 6] = [
        (Self::Left, 0, false),
        (Self::Right, 0, true),
        (Self::Bottom, 1, false),
        (Self::Top, 1, true),
        (Self::Back, 2, false),
        (Self::Front, 2, true),
    ];
}

impl MachineWall {
    /// Whether it is made of triangles, so that a phase can move it or take it away.
    pub(super) fn can_move(&self) -> bool {
        !matches!(self.shape, WallShape::Plane { .. })
    }

    /// The wall, if it is a plane.
    pub(super) fn plane(&self) -> Option<NamedWall> {
        let WallShape::Plane { point: at, normal } = &self.shape else {
            return None;
        };
        Some(NamedWall {
            name: self.name.clone(),
            shape: Shape::Plane {
                point: point(at),
                normal: Vector3::from(*normal).normalize(),
            },
            material: self.material.clone(),
            spin: 0.0,
        })
    }

    /// The wall, if it is made of triangles.
    pub(super) fn mesh(&self) -> Option<NamedMesh> {
        let about = self.about.as_ref().map_or_else(Vector3::zeros, point);
        self.can_move().then(|| NamedMesh {
            name: self.name.clone(),
            triangles: self.triangles(),
            material: self.material.clone(),
            motion: Motion {
                about,
                ..Motion::default()
            },
        })
    }

    /// Its triangles at the start, m; none of a plane.
    fn triangles(&self) -> Vec<Corners> {
        match &self.shape {
            WallShape::Plane { .. } => Vec::new(),
            WallShape::Rectangle { corner, edges } => {
                let (corner, [a, b]) = (point(corner), edges.each_ref().map(point));
                quadrangle([corner, corner + a, corner + a + b, corner + b])
            }
            WallShape::Box { corners, open } => {
                let [low, high] = corners.each_ref().map(point);
                let closed = Face::ALL.iter().filter(|(face, ..)| !open.contains(face));
                closed
                    .flat_map(|&(_, k, is_upper)| {
                        let at = |[upper_a, upper_b]: [bool; 2]| {
                            let mut corner = low;
                            let ends = [
                                (k, is_upper),
                                ((k + 1) % 3, upper_a),
                                ((k + 2) % 3, upper_b),
                            ];
                            for (axis, _) in ends.into_iter().filter(|(_, is_upper)| *is_upper) {
                                corner[axis] = high[axis];
                            }
                            corner
                        };
                        let mut round =
                            [[false, false], [true, false], [true, true], [false, true]];
                        // All faces look outwards, so that opposite ones are told apart.
                        if !is_upper {
                            round.reverse();
                        }
                        quadrangle(round.map(at))
                    })
                    .collect()
            }
            WallShape::Revolved {
                from,
                to,
                axis,
                centre,
            } => {
                let centre = centre.as_ref().map_or_else(Vector3::zeros, point);
                let circle = |circle: &[Length; 2]| circle.map(Length::si);
                between_circles_about(*axis as usize, circle(from), circle(to))
                    .into_iter()
                    .map(|corners| corners.map(|corner| corner + centre))
                    .collect()
            }
        }
    }

    /// Area that it shows along a direction, m²: that of the faces which look one way, or the other if they are larger.
    pub(super) fn area_along(&self, direction: &Vector3<f64>) -> f64 {
        let mut sides = [0.0; 2];
        for [a, b, c] in self.triangles() {
            let shown = 0.5 * (b - a).cross(&(c - a)).dot(direction);
            sides[usize::from(shown < 0.0)] += shown.abs();
        }
        sides[0].max(sides[1])
    }

    /// Refuses a plane that seeds would pass.
    pub(super) fn check_beside_periodic_sides(&self) -> Result<(), Error> {
        match &self.shape {
            WallShape::Plane { normal, .. } if normal[2] != 0.0 => {
                let name = format!("apparatus.wall '{}': shape.plane.normal", self.name);
                let requirement =
                    "without a part along z: the machine ends in periodic sides there";
                Err(bad(&name, format!("{normal:?}"), requirement))
            }
            _ => Ok(()),
        }
    }

    /// Refuses a surface that is none.
    pub(super) fn check(&self) -> Result<(), Error> {
        let name = |key: &str| format!("apparatus.wall '{}': shape.{key}", self.name);
        match &self.shape {
            WallShape::Plane { normal, .. } => unit(&name("plane.normal"), *normal).map(|_| ()),
            WallShape::Rectangle { edges, .. } => {
                let [a, b] = edges.each_ref().map(point);
                if a.cross(&b).norm() > 1e-6 * a.norm() * b.norm() {
                    return Ok(());
                }
                let texts = edges.each_ref().map(|e| e.map(|c| c.to_string()));
                let requirement = "two edges of some length that do not point the same way";
                Err(bad(
                    &name("rectangle.edges"),
                    format!("{texts:?}"),
                    requirement,
                ))
            }
            WallShape::Box { corners, open } => {
                check_box(&name("box.corners"), corners)?;
                if Face::ALL.iter().any(|(face, ..)| !open.contains(face)) {
                    return Ok(());
                }
                let requirement = "at most five faces: a box needs a face";
                Err(bad(&name("box.open"), "all faces".into(), requirement))
            }
            WallShape::Revolved { from, to, .. } => {
                let radii = [from[0].si(), to[0].si()];
                let holds = radii.iter().all(|r| *r >= 0.0) && radii.iter().any(|r| *r > 0.0);
                if holds && from != to {
                    return Ok(());
                }
                let value = format!("from {} at {} to {} at {}", from[0], from[1], to[0], to[1]);
                let requirement = "two different circles [radius, place along the axis], with radii of 0 or more and not both 0";
                Err(bad(&name("revolved"), value, requirement))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::MachineWall;
    use nalgebra::Vector3;

    fn wall(shape: &str) -> MachineWall {
        let text = format!("name = \"w\"\nmaterial = \"steel\"\nshape.{shape}");
        toml::from_str(&text).expect("a wall")
    }

    /// A box of 1, 2 and 3 mm shows the product of two edges along each axis, through an open lid too; a cone shows the area of its 48-sided
    /// base along its axis, 24 r² sin(2 pi/48), whichever axis that is; a rectangle along its diagonal shows the cosine. To rounding.
    #[test]
    fn walls_show_their_areas() {
        let close = |found: f64, expected: f64| {
            assert!(
                (found - expected).abs() < 1e-12 * expected,
                "{found} for {expected}"
            );
        };
        let cell = wall(
            "box = { corners = [[\"0 mm\", \"0 mm\", \"0 mm\"], [\"1 mm\", \"2 mm\", \"3 mm\"]], open = [\"+y\"] }",
        );
        assert_eq!(cell.mesh().expect("triangles").triangles.len(), 10);
        close(cell.area_along(&Vector3::x()), 6e-6);
        close(cell.area_along(&Vector3::y()), 3e-6);
        close(cell.area_along(&Vector3::z()), 2e-6);
        for (axis, along) in [
            ("x", Vector3::x()),
            ("y", Vector3::y()),
            ("z", Vector3::z()),
        ] {
            let cone = wall(&format!(
                "revolved = {{ from = [\"5 mm\", \"1 mm\"], to = [\"0 mm\", \"9 mm\"], axis = \"{axis}\" }}"
            ));
            close(
                cone.area_along(&along),
                24.0 * 25e-6 * (std::f64::consts::TAU / 48.0).sin(),
            );
        }
        let plate = wall(
            "rectangle = { corner = [\"0 mm\", \"0 mm\", \"0 mm\"], edges = [[\"2 mm\", \"0 mm\", \"0 mm\"], [\"0 mm\", \"0 mm\", \"4 mm\"]] }",
        );
        close(plate.area_along(&Vector3::new(0.6, 0.8, 0.0)), 6.4e-6);
    }
}
