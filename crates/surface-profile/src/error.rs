//! Errors of a surface, a field or a series.

/// Reason for a missing angle, surface or summary.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The drum circle is not finite or has no positive radius.
    #[error("drum circle (x {x}, y {y}, radius {radius}) must be finite with a positive radius")]
    BadDrum {
        /// Horizontal coordinate of the axis, unit of the caller.
        x: f64,
        /// Vertical coordinate of the axis, unit of the caller.
        y: f64,
        /// Radius, unit of the caller.
        radius: f64,
    },
    /// A coordinate is NaN or infinite.
    #[error("surface point {index} (x {x}, y {y}) is not finite")]
    NotFinitePoint {
        /// Index of the point in the input.
        index: usize,
        /// Horizontal coordinate, unit of the caller.
        x: f64,
        /// Vertical coordinate, unit of the caller.
        y: f64,
    },
    /// Too few points to fit a surface.
    #[error("the surface has {n} points, at least {least} are needed")]
    TooFewPoints {
        /// Points or stations given.
        n: usize,
        /// Least number needed.
        least: usize,
    },
    /// The points cover too little of the chord from rim to rim.
    #[error("the surface covers {covered:.3} of the chord of the drum, at least {least} is needed")]
    TooShort {
        /// Covered part of the chord, 1.
        covered: f64,
        /// Least part, 1.
        least: f64,
    },
    /// The surface lies outside the drum.
    #[error(
        "the surface passes {distance} from the axis, which is not inside the drum radius {radius}"
    )]
    OutsideDrum {
        /// Distance of the surface line from the axis, unit of the caller.
        distance: f64,
        /// Radius of the drum, unit of the caller.
        radius: f64,
    },
    /// An outline that is not that of a heap.
    #[error("the outline is not that of a heap: {what}")]
    NoHeap {
        /// Missing feature.
        what: &'static str,
    },
    /// A setting is outside its limits.
    #[error("{name} is {value}, it must be {limit}")]
    BadSetting {
        /// Name of the setting.
        name: &'static str,
        /// Value given, in its own unit.
        value: f64,
        /// Allowed range.
        limit: &'static str,
    },
    /// The bed fills nothing or all of the drum, so it has no free surface.
    #[error("the bed covers {fraction:.4} of the drum, a free surface needs {least} to {most}")]
    NoSurface {
        /// Part of the drum's area inside the level contour, 1.
        fraction: f64,
        /// Least part, 1.
        least: f64,
        /// Largest part, 1.
        most: f64,
    },
    /// A value of a series or field is NaN or infinite.
    #[error("{what} {index} is {value}, it must be finite")]
    NotFinite {
        /// Name of the value.
        what: &'static str,
        /// Its index in the input.
        index: usize,
        /// The value, in its own unit.
        value: f64,
    },
    /// A field whose number of values is not its width times its height.
    #[error("a field of {columns} by {rows} cells needs as many values, not {values}")]
    FieldShape {
        /// Cells along x.
        columns: usize,
        /// Cells along y.
        rows: usize,
        /// Values given.
        values: usize,
    },
    /// Observables of the same frames with different numbers of values.
    #[error("observables of the same frames need as many values each, not {first} and {other}")]
    UnequalColumns {
        /// Values of the first observable.
        first: usize,
        /// Values of another.
        other: usize,
    },
}
