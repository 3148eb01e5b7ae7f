//! Rotating drum between two covers that turn with it.

use super::{NamedWall, cover};
use dem_solver::Shape;
use quantity::{AngularSpeed, Length};
use serde::{Deserialize, Serialize};

/// The drum of the study: a shell and two covers, turning about a level axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drum {
    /// Inner diameter.
    pub inner_diameter: Length,
    /// Width between the covers.
    pub width: Length,
    /// Speed, counter-clockwise positive as the camera sees it.
    pub speed: AngularSpeed,
    /// Material of the shell.
    pub shell: String,
    /// Material of the covers.
    pub cover: String,
}

impl Drum {
    /// Shell and covers.
    pub(crate) fn walls(&self) -> Vec<NamedWall> {
        let (half, spin) = (0.5 * self.width.si(), self.speed.si());
        let radius = 0.5 * self.inner_diameter.si();
        let wall = |name, shape, material: &String| NamedWall {
            name,
            shape,
            material: material.clone(),
            spin,
        };
        vec![
            wall("shell", Shape::Cylinder { radius }, &self.shell),
            wall("front cover", cover(half), &self.cover),
            wall("back cover", cover(-half), &self.cover),
        ]
    }
}
