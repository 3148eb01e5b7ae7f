//! The angle of repose of a surface: its three definitions, its shape and its standard error.

use crate::cubic::Cubic;
use crate::frame::SurfaceFrame;
use crate::line::direction;
use crate::line_error::{functional_errors, line_error};
use crate::shape::shape_of;
use crate::stations::Stations;
use crate::{DrumCircle, Error, SurfacePoint};
use serde::{Deserialize, Serialize};

/// Fewest surface points that [`measure`] takes.
const FEWEST_POINTS: usize = 8;
/// The surface must cover at least this part of its chord; below, the line through a piece is
/// not the line through the whole surface.
const LEAST_COVER: f64 = 0.5;
/// Half of the central fifth of the drum diameter, in drum radii.
const MIDDLE: f64 = 0.2;
/// Part of the half-chord over which the shape is fitted.
const SHAPE_REACH: f64 = 0.8;
/// The stations beyond this part of the half-chord extrapolate the line to the rim.
const END_FROM: f64 = 0.8;
/// Factor from the difference between two extrapolations of the surface to the rim to the standard
/// deviation of the chord: that of a distribution of two equally likely values.
const CARRY_PART: f64 = 0.5;
/// Rotations of the frame until it lies along the line; each reduces the difference by about 1e-3.
const TURNS: usize = 8;

/// Definition of the angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Definition {
    /// Least-squares line through the whole free surface.
    #[default]
    Line,
    /// Slope of the part of the surface in the central fifth of the drum diameter.
    Mid,
    /// Line from rim to rim.
    Chord,
}

/// The side on which the surface is higher.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum HighSide {
    /// High at small x.
    Left,
    /// High at large x.
    Right,
}

/// The inclination and the shape of a free surface.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SurfaceAngle {
    /// Inclination of the least-squares line through the whole surface, 0 to pi/2, rad.
    pub line: f64,
    /// Inclination of the chord from rim to rim, positive as `line`, rad.
    pub chord: f64,
    /// Inclination of the central fifth of the drum diameter, positive as `line`, rad.
    pub mid: f64,
    /// Standard error of `line` from the roughness of this one surface, rad.
    pub standard_error: f64,
    /// Standard error of `chord` from the roughness of this one surface, rad.
    pub chord_standard_error: f64,
    /// Standard error of `mid` from the roughness of this one surface, rad.
    pub mid_standard_error: f64,
    /// Quadratic coefficient over 80 % of the half-chord, lengths in half-chords; positive when
    /// the ends are higher than the middle, 1.
    pub curvature: f64,
    /// Cubic coefficient over 80 % of the half-chord, lengths in half-chords; positive when the
    /// middle is steeper than the ends, 1.
    pub s_shape: f64,
    /// Coefficients of the orthonormal shapes of degree 2 to 5 over the whole chord, in drum radii: the root mean square height
    /// of each shape. `None` if the surface does not reach both ends of the chord.
    ///
    /// The first two are `curvature` and `s_shape` in another unit and over a longer range.
    #[serde(default)]
    pub shape: Option<[f64; 4]>,
    /// The side on which the surface is higher.
    pub high_side: HighSide,
    /// Points that count.
    pub n_points: usize,
    /// Points set aside as outliers.
    pub n_rejected: usize,
}

impl SurfaceAngle {
    /// The inclination by one of the three definitions, rad.
    pub fn by(&self, definition: Definition) -> f64 {
        match definition {
            Definition::Line => self.line,
            Definition::Mid => self.mid,
            Definition::Chord => self.chord,
        }
    }

    /// The standard error of the inclination by one of the three definitions, rad.
    pub fn error_by(&self, definition: Definition) -> f64 {
        match definition {
            Definition::Line => self.standard_error,
            Definition::Mid => self.mid_standard_error,
            Definition::Chord => self.chord_standard_error,
        }
    }
}

/// A [`SurfaceAngle`] with the data for a picture of it.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceReading {
    /// The angle and the shape.
    pub angle: SurfaceAngle,
    /// For each point given, whether it counts.
    pub used: Vec<bool>,
    /// Where the least-squares line cuts the drum circle: high end, low end.
    pub line_ends: [SurfacePoint; 2],
    /// Where the chord meets the drum circle: high end, low end.
    pub chord_ends: [SurfacePoint; 2],
    /// The tangent of the middle over the central fifth of the diameter: high end, low end.
    pub mid_ends: [SurfacePoint; 2],
    /// Root mean square height of the surface about its cubic, unit of the points.
    pub roughness: f64,
    /// Part of the chord that has points, 0 to 1.
    pub covered: f64,
}

/// Measures the angle of repose of a free surface in a drum.
///
/// This is the one definition that photos and simulated beds share. The points are averaged in
/// equal steps along the surface, so that neither their order nor their density matters, and
/// points far from the robust cubic through all (a curl at the rim, a stuck or flying particle)
/// are set aside.
///
/// # Formula
/// `line`: principal axis of the stations `[Pearson1901]`. `mid`: the same over the stations
/// within a tenth of the diameter of the foot of the drum axis. `chord`: the least-squares
/// cubic, plus the least-squares line through the residuals of the outer fifth of a half-chord,
/// extrapolated to the drum circle on either side; ends joined.
/// Shape: `v / c = a0 + a1 (u / c) + a2 (u / c)^2 + a3 (u / c)^3` for `|u| <= 0.8 c`, with u
/// downhill along the line, v its upward normal, c the half-chord; `curvature = a2`,
/// `s_shape = a3`. The whole surface: `v / R = sum_k shape_k sqrt(2 k + 1) P_k(u / c)` over all stations, k = 0 to 5, with the
/// Legendre polynomials `P_k` `[Abramowitz1964, eq. 22.7.10]` and the drum radius R; of a surface that is cubic from rim to rim
/// `shape_2 = 2 / (3 sqrt 5) curvature c / R` and `shape_3 = 2 / (5 sqrt 7) s_shape c / R`, and `shape_4 = shape_5 = 0`.
/// Standard error: `sqrt(s^2 tau / Suu)`, `s^2 = (RSS / n) m / (m - 4)`,
/// `m = n / tau`, with the residuals of the n stations about their cubic and their correlation
/// factor tau along the surface `[Geyer1992, section 3.3]`; m - 4 is held at 3 or more. Those of
/// `mid` and `chord`: `sqrt(sum_ij w_i C(i - j) w_j)` with the lag covariance C of the residuals
/// and the change w of the slope by the height of a station; that of `chord` also holds half of the change
/// if the cubic alone is extrapolated to the rim. All three are widened by
/// `t / 1.96`, t being the 97.5 % point of Student's distribution with m - 4 degrees of freedom (a third as many for `line`, whose tau is estimated as well)
/// `[Abramowitz1964, eq. 26.7.5]`, so that 1.96 of them are half of the 95 % interval.
///
/// # Errors
/// [`Error::BadDrum`], [`Error::NotFinitePoint`], [`Error::TooFewPoints`], [`Error::TooShort`],
/// [`Error::OutsideDrum`].
pub fn measure(points: &[SurfacePoint], drum: &DrumCircle) -> Result<SurfaceAngle, Error> {
    read_surface(points, drum).map(|reading| reading.angle)
}

/// As [`measure`]; also returns which points count and where the lines end.
///
/// # Errors
/// As [`measure`].
pub fn read_surface(points: &[SurfacePoint], drum: &DrumCircle) -> Result<SurfaceReading, Error> {
    check(points, drum)?;
    let (frame, stations) = align(points, drum)?;
    let covered = cover(&stations);
    if covered < LEAST_COVER {
        return Err(Error::TooShort {
            covered,
            least: LEAST_COVER,
        });
    }
    let whole = shape(&stations, f64::INFINITY)?;
    let middle = shape(&stations, SHAPE_REACH).unwrap_or(whole);
    let error = line_error(&stations, &whole);
    let steepness = frame.inclination.abs();
    let ends_of = |s: &_, w: &_| [-1.0, 1.0].map(|side| end(s, w, drum.radius, side));
    let ends = ends_of(&stations, &whole);
    let mid_slope = middle_slope(&stations, &whole, drum.radius);
    let errors = functional_errors(
        &stations,
        &whole,
        error.widening,
        [&|s, w| middle_slope(s, w, drum.radius), &|s, w| {
            chord_slope(&ends_of(s, w))
        }],
    );
    let slope_by_rest = chord_slope(&ends);
    let cubic = |side| carried_on(&stations, &whole, &Regression::LEVEL, drum.radius, side);
    let slope_by_cubic = chord_slope(&[-1.0, 1.0].map(cubic));
    let n_points = stations.used.iter().filter(|used| **used).count();
    let angle = SurfaceAngle {
        line: steepness,
        chord: steepness - slope_by_rest,
        mid: steepness - mid_slope,
        standard_error: error.slope,
        chord_standard_error: errors[1].hypot(CARRY_PART * (slope_by_cubic - slope_by_rest)),
        mid_standard_error: errors[0],
        curvature: middle.coefficients[2] / stations.half_chord,
        s_shape: middle.coefficients[3] / stations.half_chord,
        shape: shape_of(&stations, drum.radius),
        high_side: if frame.inclination > 0.0 {
            HighSide::Right
        } else {
            HighSide::Left
        },
        n_points,
        n_rejected: points.len() - n_points,
    };
    let height = stations.all.iter().map(|s| s.height).sum::<f64>() / stations.all.len() as f64;
    let square = drum.radius * drum.radius - height * height;
    let reach = square.max(0.0).sqrt();
    Ok(SurfaceReading {
        angle,
        used: stations.used,
        line_ends: [frame.place(-reach, height), frame.place(reach, height)],
        mid_ends: [-MIDDLE * drum.radius, MIDDLE * drum.radius]
            .map(|u| frame.place(u, whole.at(0.0) + u * mid_slope.tan())),
        chord_ends: ends.map(|(u, v)| frame.place(u, v)),
        roughness: error.roughness,
        covered,
    })
}

/// Refuses points that cannot be a surface in a drum.
fn check(points: &[SurfacePoint], drum: &DrumCircle) -> Result<(), Error> {
    drum.check()?;
    if points.len() < FEWEST_POINTS {
        return Err(Error::TooFewPoints {
            n: points.len(),
            least: FEWEST_POINTS,
        });
    }
    for (index, p) in points.iter().enumerate() {
        if !(p.x.is_finite() && p.y.is_finite()) {
            return Err(Error::NotFinitePoint {
                index,
                x: p.x,
                y: p.y,
            });
        }
    }
    Ok(())
}

/// Turns the frame until the least-squares line of its stations is level in it.
fn align(points: &[SurfacePoint], drum: &DrumCircle) -> Result<(SurfaceFrame, Stations), Error> {
    let first = direction(points.iter().map(|p| (p.x, p.y))).ok_or(Error::TooShort {
        covered: 0.0,
        least: LEAST_COVER,
    })?;
    let mut frame = SurfaceFrame::new(*drum, first);
    let mut stations = Stations::build(points, drum, &frame)?;
    for _ in 0..TURNS {
        let slope = direction(stations.positions()).unwrap_or(0.0);
        let turn = if frame.inclination > 0.0 {
            -slope
        } else {
            slope
        };
        frame = SurfaceFrame::new(*drum, frame.inclination + turn);
        stations = Stations::build(points, drum, &frame)?;
        if slope.abs() < 1e-12 {
            break;
        }
    }
    Ok((frame, stations))
}

/// Part of the chord between the outermost stations, 0 to 1.
fn cover(stations: &Stations) -> f64 {
    let along = stations.all.iter().map(|s| s.along);
    let low = along.clone().fold(f64::INFINITY, f64::min);
    let high = along.fold(f64::NEG_INFINITY, f64::max);
    (0.5 * (high - low)).clamp(0.0, 1.0)
}

/// Cubic through the stations within the reach (in half-chords).
fn shape(stations: &Stations, reach: f64) -> Result<Cubic, Error> {
    let near = stations.all.iter().filter(|s| s.along.abs() <= reach);
    Cubic::fit(near.map(|s| (s.along, s.height, 1.0))).ok_or(Error::TooFewPoints {
        n: stations.all.len(),
        least: FEWEST_POINTS,
    })
}

/// Slope from one end of the chord to the other against the line, rad.
fn chord_slope(ends: &[(f64, f64); 2]) -> f64 {
    (ends[1].1 - ends[0].1).atan2(ends[1].0 - ends[0].0)
}

/// Slope of the central fifth of the diameter against the line, rad.
///
/// If too few stations lie there, it is the slope of the cubic at the foot of the axis.
fn middle_slope(stations: &Stations, whole: &Cubic, radius: f64) -> f64 {
    let near = stations
        .positions()
        .filter(|p| p.0.abs() <= MIDDLE * radius);
    if near.clone().count() < 4 {
        return (whole.coefficients[1] / stations.half_chord).atan();
    }
    direction(near).unwrap_or(0.0)
}

/// Where the surface meets the rim on one side (-1 uphill, 1 downhill): (u, v).
///
/// The cubic through the whole surface plus the line through the residuals of the outer fifth
/// is extrapolated to the drum circle.
fn end(stations: &Stations, whole: &Cubic, radius: f64, side: f64) -> (f64, f64) {
    let near: Vec<(f64, f64)> = stations
        .all
        .iter()
        .filter(|s| s.along * side >= END_FROM)
        .map(|s| (s.along, s.height - whole.at(s.along)))
        .collect();
    carried_on(stations, whole, &regression(&near), radius, side)
}

/// Where the cubic plus the line of the residuals meets the rim on one side: (u, v).
fn carried_on(
    stations: &Stations,
    whole: &Cubic,
    rest: &Regression,
    radius: f64,
    side: f64,
) -> (f64, f64) {
    let height = whole.at(side) + rest.at(side);
    let [_, c1, c2, c3] = whole.coefficients;
    let slope = (c1 + 2.0 * c2 * side + 3.0 * c3 + rest.slope) / stations.half_chord;
    // v = start + slope u meets u^2 + v^2 = radius^2.
    let at_chord = side * stations.half_chord;
    let start = height - slope * at_chord;
    let (a, b, c) = (
        1.0 + slope * slope,
        slope * start,
        start * start - radius * radius,
    );
    let root = b * b - a * c;
    if root < 0.0 {
        return (at_chord, height);
    }
    let meeting = (-b + side * root.sqrt()) / a;
    (meeting, start + slope * meeting)
}

/// A straight line y over x.
struct Regression {
    /// Mean of x.
    x: f64,
    /// Mean of y.
    y: f64,
    /// Rise of y per x.
    slope: f64,
}

impl Regression {
    /// A line of zero.
    const LEVEL: Self = Self {
        x: 0.0,
        y: 0.0,
        slope: 0.0,
    };

    /// The value at `x`.
    fn at(&self, x: f64) -> f64 {
        self.y + self.slope * (x - self.x)
    }
}

/// Least-squares line; level at zero for fewer than three points.
fn regression(points: &[(f64, f64)]) -> Regression {
    let n = points.len() as f64;
    if points.len() < 3 {
        return Regression::LEVEL;
    }
    let (x, y) = points
        .iter()
        .fold((0.0, 0.0), |sum, p| (sum.0 + p.0 / n, sum.1 + p.1 / n));
    let sxx: f64 = points.iter().map(|p| (p.0 - x).powi(2)).sum();
    let sxy: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    Regression {
        x,
        y,
        slope: if sxx > 0.0 { sxy / sxx } else { 0.0 },
    }
}
