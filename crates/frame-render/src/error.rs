//! Errors of a requested picture.

/// Reason for a refused picture.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A sphere without a finite position or size.
    #[error(
        "sphere {index} has {field} = {value} m; the centre must be finite and the radius finite and \
         above 0 m, so look for a simulation that has become unstable"
    )]
    InvalidSphere {
        /// Position in the list of spheres, from 0.
        index: usize,
        /// Which of `centre x`, `centre y`, `centre z`, `radius`.
        field: &'static str,
        /// The value, m.
        value: f64,
    },
    /// A length or an angle of the view that is invalid.
    #[error("view setting {field} = {value} must be {requirement}")]
    InvalidView {
        /// Name of the setting.
        field: &'static str,
        /// The value in the unit named by the requirement.
        value: f64,
        /// Requirement, with the unit.
        requirement: &'static str,
    },
    /// A picture too small to show anything or too large to hold in memory.
    #[error("the picture is {pixels} pixels wide; choose from {least} to {most}")]
    InvalidPixels {
        /// Asked width, pixels.
        pixels: u32,
        /// Smallest width, pixels.
        least: u32,
        /// Largest width, pixels.
        most: u32,
    },
    /// A corner of a triangle or an end of a segment that is not a number.
    #[error("{what} {index} has the coordinate {value} m; all coordinates must be finite")]
    InvalidCoordinate {
        /// `triangle` or `segment`.
        what: &'static str,
        /// Position in its list, from 0.
        index: usize,
        /// The coordinate, m.
        value: f64,
    },
    /// The scene is empty, so no view can be chosen.
    #[error("there is neither a sphere nor a triangle to look at")]
    NothingToShow,
    /// More spheres than the depth buffer can number.
    #[error("{count} spheres are more than the {most} that one picture can hold")]
    TooManySpheres {
        /// Number of spheres.
        count: usize,
        /// Largest number of spheres.
        most: usize,
    },
}
