//! Charts as SVG and a report as one HTML file.
//!
//! Every chart is a plain struct of numbers and names with a method `draw` that gives an [`Svg`];
//! [`Report`] puts charts, tables, pictures and words into one page that opens without a network.
//!
//! ```
//! use report::{AxisTitle, LineSeries, Report, Series, SeriesPoint};
//!
//! let points = vec![SeriesPoint::new(0.1, 30.2, 0.4), SeriesPoint::new(0.3, 36.9, 0.5)];
//! let chart = LineSeries {
//!     x: AxisTitle::new("Sliding friction", ""),
//!     y: AxisTitle::new("Repose angle", "°"),
//!     series: vec![Series { name: "simulated".into(), points }],
//!     levels: vec![],
//! };
//! let mut report = Report::new("Friction & angle");
//! report.section("Result").figure(&chart.draw()?, "The angle grows with friction.");
//! assert!(report.html().contains("<h1>Friction &amp; angle</h1>"));
//! # Ok::<(), report::Error>(())
//! ```
//!
//! Invariants:
//! - No number that is not finite gets into a picture: it is refused with its place in the input.
//! - Every text is escaped; no script, font, style or picture is fetched from anywhere. The policy of a page names its
//!   style and its scripts by their digests, and browsers run nothing else.
//! - The same input gives the same bytes: there is no clock and no randomness.

mod chart;
mod check;
mod counted;
mod error;
mod escape;
mod geometry;
mod html;
mod label_places;
mod legend;
mod marching_squares;
mod plot;
mod png;
mod style;
mod svg;
mod text;
mod ticks;

pub use chart::bars_with_target::{Bar, BarsWithTarget, Target};
pub use chart::contour::{Contour, MarkedPoint};
pub use chart::cube::{Cube, CubeEdge};
pub use chart::design_runs::DesignRun;
pub use chart::half_normal::{FactorEffect, HalfNormal};
pub use chart::line_series::{LineSeries, Series, SeriesPoint};
pub use chart::pareto::Pareto;
pub use chart::predicted_against_measured::{Comparison, PredictedAgainstMeasured, Role};
pub use chart::residuals::{ResidualCondition, ResidualPanel, Residuals};
pub use chart::scatter::Scatter;
pub use chart::stacked_bars::{StackedBar, StackedBars};
pub use chart::surface::Surface;
pub use chart::timeseries::{TimeSeries, TimeSpan};
pub use chart::{AxisTitle, Level};
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
pub use png::PngPrinter;
pub use svg::Svg;
