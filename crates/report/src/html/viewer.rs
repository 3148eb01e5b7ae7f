//! Spheres that can be turned in the page.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use crate::Error;
use crate::check::Field;

/// Name of this part, for messages.
const CHART: &str = "sphere viewer";

/// One sphere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewerSphere {
    /// Centre, any unit of length.
    pub centre: [f64; 3],
    /// Radius, the same unit.
    pub radius: f64,
}

/// Spheres for the viewer, and the picture that stands for them where it cannot run.
#[derive(Debug, Clone, Copy)]
pub struct SphereViewer<'a> {
    /// The spheres.
    pub spheres: &'a [ViewerSphere],
    /// Colour of the spheres, sRGB.
    pub colour: [u8; 3],
    /// The same spheres as the bytes of a PNG file.
    pub picture: &'a [u8],
    /// What is seen, for readers who cannot see it.
    pub description: &'a str,
}

impl SphereViewer<'_> {
    /// Refuses what cannot be shown.
    ///
    /// # Errors
    /// [`Error`] without a sphere, for a number that is not finite, or a radius of 0 or below.
    pub fn check(&self) -> Result<(), Error> {
        Field::new(CHART, "spheres").at_least(1, self.spheres.len())?;
        let coordinates = self.spheres.iter().flat_map(|sphere| sphere.centre);
        Field::new(CHART, "coordinate").finite(coordinates)?;
        Field::new(CHART, "radius").not_negative(self.spheres.iter().map(|s| s.radius))?;
        let zero = self.spheres.iter().position(|sphere| sphere.radius == 0.0);
        zero.map_or(Ok(()), |index| {
            let (chart, field, requirement) = (CHART, "radius", "above 0");
            Err(Error::OutOfRange {
                chart,
                field,
                index,
                value: 0.0,
                requirement,
            })
        })
    }

    /// The element that the script looks for, with the picture inside.
    pub(crate) fn markup(&self, image: &str) -> String {
        let data = STANDARD.encode(self.packed());
        let [red, green, blue] = self.colour;
        format!(
            "<div class=\"spheres\" data-colour=\"{red},{green},{blue}\" data-spheres=\"{data}\">\
             {image}</div>"
        )
    }

    /// Centres and radii as 32-bit little-endian floats, moved and scaled so that everything lies
    /// within 1 of the origin.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "32 bits suffice for a screen"
    )]
    fn packed(&self) -> Vec<u8> {
        let mut lower = [f64::INFINITY; 3];
        let mut upper = [f64::NEG_INFINITY; 3];
        for sphere in self.spheres {
            for axis in 0..3 {
                lower[axis] = lower[axis].min(sphere.centre[axis] - sphere.radius);
                upper[axis] = upper[axis].max(sphere.centre[axis] + sphere.radius);
            }
        }
        let middle: [f64; 3] = std::array::from_fn(|axis| 0.5 * (lower[axis] + upper[axis]));
        let distance = |sphere: &ViewerSphere| {
            let offset: [f64; 3] = std::array::from_fn(|axis| sphere.centre[axis] - middle[axis]);
            offset[0].hypot(offset[1]).hypot(offset[2]) + sphere.radius
        };
        let reach = self.spheres.iter().map(distance).fold(0.0, f64::max);
        let mut bytes = Vec::with_capacity(16 * self.spheres.len());
        for sphere in self.spheres {
            for (coordinate, middle) in sphere.centre.into_iter().zip(middle) {
                bytes.extend((((coordinate - middle) / reach) as f32).to_le_bytes());
            }
            bytes.extend(((sphere.radius / reach) as f32).to_le_bytes());
        }
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_spheres_fill_the_unit_ball_around_their_middle() {
        let spheres = [
            ViewerSphere {
                centre: [1.0, 5.0, -2.0],
                radius: 0.5,
            },
            ViewerSphere {
                centre: [3.0, 5.0, -2.0],
                radius: 0.5,
            },
        ];
        let viewer = SphereViewer {
            spheres: &spheres,
            colour: [1, 2, 3],
            picture: &[],
            description: "",
        };
        let numbers: Vec<f32> = viewer
            .packed()
            .chunks(4)
            .map(|bytes| f32::from_le_bytes(bytes.try_into().expect("chunks of four")))
            .collect();
        // Middle (2, 5, -2), reach 1 + 0.5; rounding of 32-bit numbers.
        let expected = [
            -1.0 / 1.5,
            0.0,
            0.0,
            0.5 / 1.5,
            1.0 / 1.5,
            0.0,
            0.0,
            0.5 / 1.5,
        ];
        for (number, expected) in numbers.iter().zip(expected) {
            assert!((f64::from(*number) - expected).abs() < 1e-7, "{numbers:?}");
        }
    }
}
