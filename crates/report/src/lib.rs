//! Charts as SVG and a report as one HTML file.
//!
//! A [`Plot`] has two axes and marks over them - points with error bars, lines, areas, levels and texts - and is drawn as an
//! [`Svg`]; [`Report`] puts charts, tables, pictures and words into one page that opens without a network.
//!
//! ```
//! use report::{Axis, Plot, PlotPoint, Report, series};
//!
//! let points = vec![PlotPoint::new(0.1, 30.2).with_error(0.4), PlotPoint::new(0.3, 36.9).with_error(0.5)];
//! let plot = Plot::new(Axis::numbers("Sliding friction", ""), Axis::numbers("Repose angle", "°"))
//!     .with_all(series(0, "simulated", points));
//! let mut report = Report::new("Friction & angle");
//! report.section("Result").figure(&plot.draw()?, "The angle grows with friction.");
//! assert!(report.html().contains("<h1>Friction &amp; angle</h1>"));
//! # Ok::<(), report::Error>(())
//! ```
//!
//! Invariants:
//! - No number that is not finite gets into a picture: it is refused with its place in the input.
//! - Every text is escaped; no script, font, style or picture is fetched from anywhere. The policy of a page names its
//!   style and its scripts by their digests, and browsers run nothing else.
//! - The same input gives the same bytes: there is no clock and no randomness.

mod charts;
mod check;
mod counted;
mod draw;
mod error;
mod escape;
mod frame;
mod geometry;
mod html;
mod label_places;
mod legend;
mod marching_squares;
mod plot;
mod style;
mod svg;
mod text;
mod ticks;

pub use charts::{Grid, design_runs, half_normal, marked_points, pareto, scatter, series};
pub use counted::counted;
pub use error::Error;
pub use escape::escaped;
pub use html::explorer::{
    ExploredPrediction, ExploredSurface, ExploredTarget, Explorer, NamedPlace, SliderParameter,
};
pub use html::pointing::{Pointed, PointingPicture, PointingTool};
pub use html::table::{Alignment, Column, Table};
pub use html::viewer::{SphereViewer, ViewerBody, ViewerKind, ViewerSphere};
pub use html::{Fact, Report, Tone};
pub use plot::{Axis, AxisTitle, ColourBar, Format, Mark, Plot, PlotPoint, colour};
pub use svg::{Anchor, Shape, Svg};
