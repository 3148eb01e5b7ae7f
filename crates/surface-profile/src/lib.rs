//! The free surface, the definition of its angle, and the uncertainty of that angle.
//!
//! This crate contains the only definition of the angle in the workspace: a photo of a drum and a
//! simulated bed both become [`SurfacePoint`]s inside a [`DrumCircle`], and [`measure`] computes
//! the [`SurfaceAngle`] of either. No other crate defines an angle of repose.
//!
//! Frame: x to the right, y up, any unit of length (metres for a simulated bed, pixels for a
//! photo). Angles are radians. A mirrored surface gives the same angle and the other high side.
//!
//! ```
//! use surface_profile::{DrumCircle, HighSide, SurfacePoint, measure};
//! let drum = DrumCircle { x: 0.0, y: 0.0, radius: 1.0 };
//! let points: Vec<SurfacePoint> = (-80..=80)
//!     .map(|i| f64::from(i) / 100.0)
//!     .map(|x| SurfacePoint { x, y: -0.5 * x })
//!     .collect();
//! let angle = measure(&points, &drum)?;
//! assert!((angle.line - 0.5_f64.atan()).abs() < 1e-9);
//! assert_eq!(angle.high_side, HighSide::Left);
//! # Ok::<(), surface_profile::Error>(())
//! ```
//!
//! Invariants: [`measure`] and [`free_surface`] refuse values that are not finite; the crate reads no
//! file and draws no random number.

mod angle;
mod contour;
mod correlation;
mod correlations;
mod cubic;
mod discs;
mod error;
mod field;
mod frame;
mod geometry;
mod heap;
mod heap_flank;
mod line;
mod line_error;
mod median;
mod series;
mod series_times;
mod shape;
mod shell_ends;
mod stations;

pub use angle::{Definition, HighSide, SurfaceAngle, SurfaceReading, measure, read_surface};
pub use contour::{bulk_level, free_surface};
pub use correlations::shrunk_correlations;
pub use discs::{DensitySettings, Disc, density_of_discs, profile_from_discs};
pub use error::Error;
pub use field::Field;
pub use geometry::{DrumCircle, SurfacePoint};
pub use heap::{HeapAngle, measure_heap, measure_heap_above};
pub use heap_flank::HeapFlank;
pub use median::median;
pub use series::{SeriesSummary, summarise};
pub use series_times::{
    Avalanches, CorrelationTime, avalanches, correlation_time, longest_unbroken,
};
pub use shell_ends::shell_ends;

#[cfg(test)]
mod angle_tests;
#[cfg(test)]
mod contour_tests;
#[cfg(test)]
mod discs_tests;
#[cfg(test)]
mod test_noise;
