//! What a world needs beside bodies and walls.

use crate::template::Template;
use nalgebra::Vector3;

/// Skin of the lists of bodies of overlapping spheres, radii of the smallest.
const OVERLAPPING_SKIN: f64 = 0.1;
/// Skin of the lists of separate spheres, radii of the smallest.
const SEPARATE_SKIN: f64 = 0.7;

/// Settings of a world besides its bodies and walls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Time step, s.
    pub time_step: f64,
    /// Gravity, m/s².
    pub gravity: Vector3<f64>,
    /// Skin of the sphere lists, m. It decides the speed only: 0.6 to 1 of the least radius suits separate spheres, a tenth of
    /// it overlapping ones.
    pub skin: f64,
    /// Margin of the bounding spheres, m. It decides the speed only.
    pub margin: f64,
}

impl Settings {
    /// Settings with lists that suit these body types.
    ///
    /// Smooth seeds of overlapping spheres have many pairs nearly in touch, and a wide skin lists all of them. Seeds of many small
    /// spheres have margins of some of these, bodies of few spheres of a part of their own size: a wider one lists pairs that do not
    /// meet before the next search.
    pub fn for_templates(time_step: f64, gravity: Vector3<f64>, templates: &[Template]) -> Self {
        let least =
            |of: fn(&Template) -> f64| templates.iter().map(of).fold(f64::INFINITY, f64::min);
        let radius = least(Template::smallest_radius);
        let skin = if templates.iter().any(Template::overlaps) {
            OVERLAPPING_SKIN
        } else {
            SEPARATE_SKIN
        };
        Self {
            time_step,
            gravity,
            skin: skin * radius,
            margin: (4.5 * radius).min(0.5 * least(Template::bounding_radius)),
        }
    }
}
