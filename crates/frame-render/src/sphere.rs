//! One sphere of a picture.

use crate::Error;

/// A sphere to be drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RenderSphere {
    /// Centre, m. In drum pictures x points right, y up and z to the camera.
    pub centre: [f64; 3],
    /// Radius, m.
    pub radius: f64,
    /// Colour of a face that faces the camera, sRGB.
    pub colour: [u8; 3],
}

/// Names of the components of a centre, for messages.
const COMPONENTS: [&str; 3] = ["centre x", "centre y", "centre z"];

/// Refuses spheres without a finite place and a positive size.
pub(crate) fn check_spheres(spheres: &[RenderSphere]) -> Result<(), Error> {
    let most = u32::MAX as usize - 1;
    if spheres.len() > most {
        return Err(Error::TooManySpheres {
            count: spheres.len(),
            most,
        });
    }
    for (index, sphere) in spheres.iter().enumerate() {
        for (field, value) in COMPONENTS.into_iter().zip(sphere.centre) {
            if !value.is_finite() {
                return Err(Error::InvalidSphere {
                    index,
                    field,
                    value,
                });
            }
        }
        if !(sphere.radius.is_finite() && sphere.radius > 0.0) {
            return Err(Error::InvalidSphere {
                index,
                field: "radius",
                value: sphere.radius,
            });
        }
    }
    Ok(())
}
