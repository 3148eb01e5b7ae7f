//! Bodies of spheres that can be turned in the page.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use nalgebra::{UnitQuaternion, Vector3};

use crate::Error;
use crate::check::Field;

/// Name of this part, for messages.
const CHART: &str = "sphere viewer";

/// One sphere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewerSphere {
    /// Centre in the frame of its body, any unit of length.
    pub centre: [f64; 3],
    /// Radius, the same unit.
    pub radius: f64,
}

/// A kind of body.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewerKind {
    /// Its spheres.
    pub spheres: Vec<ViewerSphere>,
    /// Their colour, sRGB.
    pub colour: [u8; 3],
}

/// Where a body is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewerBody {
    /// Its kind.
    pub kind: usize,
    /// Origin of its frame, the unit of the spheres.
    pub position: Vector3<f64>,
    /// Rotation of its frame.
    pub orientation: UnitQuaternion<f64>,
}

impl ViewerBody {
    /// A body of a kind at the origin, not turned.
    pub fn at_origin(kind: usize) -> Self {
        Self {
            kind,
            position: Vector3::zeros(),
            orientation: UnitQuaternion::identity(),
        }
    }
}

/// Bodies for the viewer, z upwards, and the picture that represents them where it cannot run.
#[derive(Debug, Clone, Copy)]
pub struct SphereViewer<'a> {
    /// The kinds of bodies.
    pub kinds: &'a [ViewerKind],
    /// The bodies.
    pub bodies: &'a [ViewerBody],
    /// The same bodies as the bytes of a PNG file.
    pub picture: &'a [u8],
    /// Text for readers who cannot see the picture.
    pub description: &'a str,
}

impl SphereViewer<'_> {
    /// Refuses what cannot be shown.
    ///
    /// # Errors
    /// [`Error`] without a sphere or a body, for a body of a kind that is not there, for a number that is not finite, or a
    /// radius of 0 or below.
    pub fn check(&self) -> Result<(), Error> {
        let spheres = || self.kinds.iter().flat_map(|kind| &kind.spheres);
        Field::new(CHART, "spheres").at_least(1, spheres().count())?;
        Field::new(CHART, "bodies").at_least(1, self.bodies.len())?;
        let coordinates = spheres().flat_map(|sphere| sphere.centre);
        Field::new(CHART, "coordinate").finite(coordinates)?;
        let positions = self.bodies.iter().flat_map(|body| body.position.data.0[0]);
        Field::new(CHART, "position").finite(positions)?;
        let turns = self
            .bodies
            .iter()
            .flat_map(|body| body.orientation.coords.data.0[0]);
        Field::new(CHART, "orientation").finite(turns)?;
        Field::new(CHART, "radius").not_negative(spheres().map(|s| s.radius))?;
        let out_of_range = |field, index, value, requirement| Error::OutOfRange {
            chart: CHART,
            field,
            index,
            value,
            requirement,
        };
        if let Some(index) = spheres().position(|sphere| sphere.radius == 0.0) {
            return Err(out_of_range("radius", index, 0.0, "above 0"));
        }
        let unknown = |body: &ViewerBody| body.kind >= self.kinds.len();
        self.bodies
            .iter()
            .position(unknown)
            .map_or(Ok(()), |index| {
                let kind = self.bodies[index].kind as f64;
                Err(out_of_range("kind", index, kind, "one of the kinds"))
            })
    }

    /// The element that the script looks for, with the picture inside: of each kind its colour and its spheres, and the
    /// bodies.
    pub(crate) fn markup(&self, image: &str) -> String {
        let (kinds, bodies) = self.packed();
        let colours: Vec<String> = self
            .kinds
            .iter()
            .map(|kind| kind.colour.map(|part| part.to_string()).join(","))
            .collect();
        let kinds: Vec<String> = kinds.iter().map(|bytes| STANDARD.encode(bytes)).collect();
        format!(
            "<div class=\"spheres\" data-colours=\"{}\" data-kinds=\"{}\" data-bodies=\"{}\">{image}</div>",
            colours.join(" "),
            kinds.join(" "),
            STANDARD.encode(bodies)
        )
    }

    /// Spheres of each kind (centre and radius) and bodies (kind, position, rotation as w, x, y, z) as 32-bit little-endian
    /// floats, moved and scaled so that everything lies within 1 of the origin.
    fn packed(&self) -> (Vec<Vec<u8>>, Vec<u8>) {
        let mut lower = [f64::INFINITY; 3];
        let mut upper = [f64::NEG_INFINITY; 3];
        for (centre, radius) in self.placed() {
            for axis in 0..3 {
                lower[axis] = lower[axis].min(centre[axis] - radius);
                upper[axis] = upper[axis].max(centre[axis] + radius);
            }
        }
        let middle = Vector3::from_fn(|axis, _| 0.5 * (lower[axis] + upper[axis]));
        let distance = |(centre, radius): (Vector3<f64>, f64)| (centre - middle).norm() + radius;
        let reach = self.placed().map(distance).fold(0.0, f64::max);
        let of_kind = |kind: &ViewerKind| {
            let numbers = kind.spheres.iter().flat_map(|s| {
                let [x, y, z] = s.centre;
                [x, y, z, s.radius]
            });
            floats(numbers.map(|length| length / reach))
        };
        let bodies = self.bodies.iter().flat_map(|body| {
            let (p, q) = ((body.position - middle) / reach, body.orientation);
            [body.kind as f64, p.x, p.y, p.z, q.w, q.i, q.j, q.k]
        });
        (self.kinds.iter().map(of_kind).collect(), floats(bodies))
    }

    /// Centre and radius of each sphere of each body.
    fn placed(&self) -> impl Iterator<Item = (Vector3<f64>, f64)> + '_ {
        self.bodies.iter().flat_map(|body| {
            let spheres = self.kinds[body.kind].spheres.iter();
            spheres.map(|s| {
                let arm = body.orientation * Vector3::from(s.centre);
                (body.position + arm, s.radius)
            })
        })
    }
}

/// Numbers as 32-bit little-endian floats.
#[expect(
    clippy::cast_possible_truncation,
    reason = "32 bits suffice for a screen"
)]
fn floats(numbers: impl Iterator<Item = f64>) -> Vec<u8> {
    numbers.flat_map(|x| (x as f32).to_le_bytes()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    /// Two balls of 0.5 on a rod along x, 1 to both sides: one rod as it is, one turned by 90 deg about z and moved by 3 along y.
    #[test]
    fn packed_bodies_fill_the_unit_ball_around_their_middle() {
        let ball = |x| ViewerSphere {
            centre: [x, 0.0, 0.0],
            radius: 0.5,
        };
        let kinds = [ViewerKind {
            spheres: vec![ball(-1.0), ball(1.0)],
            colour: [1, 2, 3],
        }];
        let turned = ViewerBody {
            kind: 0,
            position: Vector3::new(0.0, 3.0, 0.0),
            orientation: UnitQuaternion::from_axis_angle(&Vector3::z_axis(), FRAC_PI_2),
        };
        let viewer = SphereViewer {
            kinds: &kinds,
            bodies: &[ViewerBody::at_origin(0), turned],
            picture: &[],
            description: "",
        };
        viewer.check().unwrap();
        let (spheres, bodies) = viewer.packed();
        let numbers = |bytes: &[u8]| -> Vec<f64> {
            let chunks = bytes
                .chunks(4)
                .map(|b| b.try_into().expect("chunks of four"));
            chunks.map(|b| f64::from(f32::from_le_bytes(b))).collect()
        };
        // x from -1.5 to 1.5 and y from -0.5 to 4.5: middle (0, 2, 0). The farthest are the balls of the first rod, at
        // (+-1, -2), and the upper one of the second, at (0, 2).
        let reach = 5.0_f64.sqrt() + 0.5;
        let half = 0.5_f64.sqrt();
        let hold = |found: Vec<f64>, expected: &[f64]| {
            assert_eq!(found.len(), expected.len());
            for (found, expected) in found.iter().zip(expected) {
                // Rounding of 32-bit numbers.
                assert!((found - expected).abs() < 1e-6, "{found} {expected}");
            }
        };
        let r = 1.0 / reach;
        hold(
            numbers(&spheres[0]),
            &[-r, 0.0, 0.0, 0.5 * r, r, 0.0, 0.0, 0.5 * r],
        );
        let first = [0.0, 0.0, -2.0 * r, 0.0, 1.0, 0.0, 0.0, 0.0];
        let second = [0.0, 0.0, r, 0.0, half, 0.0, 0.0, half];
        hold(numbers(&bodies), &[first, second].concat());
        let stray = SphereViewer {
            bodies: &[ViewerBody::at_origin(1)],
            ..viewer
        };
        assert!(stray.check().unwrap_err().to_string().contains("kind"));
    }
}
