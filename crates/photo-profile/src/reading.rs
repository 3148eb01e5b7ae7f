//! What a measurement of one picture gives.

use crate::{Channel, DrumPixels, Foreground, HeapReading};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use surface_profile::{HighSide, SurfaceAngle};

/// A place in the picture; y down, the centre of the first pixel is (0, 0).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PixelPoint {
    /// Horizontal coordinate, px.
    pub x: f64,
    /// Vertical coordinate, positive down, px.
    pub y: f64,
}

/// Why a picture was not measured.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// No circle that could be the drum.
    #[error(
        "no drum circle: the best circle shows on {covered:.2} of its way round, {least} is \
         needed; a camera off the drum axis shows an ellipse, which is not measured"
    )]
    NoDrum {
        /// Part of the circle with an edge, 1.
        covered: f64,
        /// Least part, 1.
        least: f64,
    },
    /// A circle shows in parts, and edges run off it.
    #[error(
        "no drum circle: an edge lies on the best circle on {shown:.2} of its way round and beside \
         it on {elsewhere:.2}; a camera off the drum axis shows an ellipse, which is not measured"
    )]
    BrokenRim {
        /// Part of the way round with an edge on the circle, 1.
        shown: f64,
        /// Part of the way round with an edge beside the circle only, 1.
        elsewhere: f64,
    },
    /// The drum is an ellipse: the camera was not on its axis.
    #[error(
        "tilted camera view: the drum is {flattening:.3} flatter one way than the other, at \
         most {most} is measured"
    )]
    TiltedView {
        /// 1 minus the ratio of the axes, 1.
        flattening: f64,
        /// Largest value measured, 1.
        most: f64,
    },
    /// Two drums, and nothing says which is meant.
    #[error(
        "two drums with a surface each: about ({:.0}, {:.0}) and ({:.0}, {:.0}) px",
        first.cx, first.cy, second.cx, second.cy
    )]
    TwoDrums {
        /// The one that shows best, px.
        first: DrumPixels,
        /// The other, px.
        second: DrumPixels,
    },
    /// Too few pixels across the drum.
    #[error("the picture is too small: {pixels} px on its shorter side, at least {least} needed")]
    TooSmall {
        /// Pixels on the shorter side, px.
        pixels: u32,
        /// Least number, px.
        least: u32,
    },
    /// The drum given lies outside the picture.
    #[error("only {inside:.2} of the given drum circle lies in the picture, 0.8 is needed")]
    DrumOutside {
        /// Part of the disc inside the picture, 1.
        inside: f64,
    },
    /// The drum holds one tone only.
    #[error(
        "the drum shows one tone only (bed and air differ by {difference:.1} of 255): empty, full or blank"
    )]
    OneTone {
        /// Difference of the tones of the lower and the upper part, grey levels of 255.
        difference: f64,
    },
    /// Two tones, but no boundary between them.
    #[error(
        "no clear surface: the bed share drops by {step:.2} across the boundary found, {least} \
         is needed (empty, full or unclear drum)"
    )]
    NoClearSurface {
        /// Drop of the bed share across the boundary, 1.
        step: f64,
        /// Least drop, 1.
        least: f64,
    },
    /// The boundary found shows on a part of its length only.
    #[error(
        "no clear surface: only {clear:.2} of the boundary found parts bed from air, {least} is \
         needed"
    )]
    SurfaceInParts {
        /// Part of the boundary with a clear step, 1.
        clear: f64,
        /// Least part, 1.
        least: f64,
    },
    /// Bed above the surface or air below it.
    #[error(
        "no single surface: the bed fills only {contrast:.2} more of the drum below the boundary \
         found than above it, {least} is needed (bed thrown round the drum, or two surfaces)"
    )]
    BedOnBothSides {
        /// Mean bed share below less that above, 1.
        contrast: f64,
        /// Least difference, 1.
        least: f64,
    },
    /// A stretch of the surface is vertical or hangs over, far off the line through the whole.
    #[error(
        "the surface overhangs: a stretch of it stands at {steepest:.0} degrees, its line at {line:.0} (crumbling bed)"
    )]
    Overhang {
        /// Steepest inclination, degrees.
        steepest: f64,
        /// Inclination of the line, degrees.
        line: f64,
    },
    /// The surface is too rough to have an angle.
    #[error(
        "the surface is too rough: {roughness:.3} of the drum radius (at most {most}), standard \
         error of the angle {error:.1} degrees (at most {most_error:.1})"
    )]
    TooRough {
        /// Root mean square height about the smooth surface, drum radii.
        roughness: f64,
        /// Largest roughness, drum radii.
        most: f64,
        /// Standard error of the line, degrees.
        error: f64,
        /// Largest standard error, degrees.
        most_error: f64,
        /// Inclination of the line all the same, degrees: it shows whether leaving such surfaces out shifts a mean.
        line: f64,
    },
    /// The heap reaches out of the picture.
    #[error("no air above: the heap reaches the upper border of the picture")]
    HeapCut,
    /// The heap is seen from so far above that its flanks do not show.
    #[error(
        "the heap is seen from about {elevation:.0} degrees above: its lower edge hangs below its feet by {bulge:.2} of its \
         height, the limit is {most}"
    )]
    HeapFromAbove {
        /// Elevation of the camera that sees a round base so, degrees.
        elevation: f64,
        /// How far it hangs, parts of the height.
        bulge: f64,
        /// Largest part.
        most: f64,
    },
    /// The flanks of the heap leave its angle too uncertain.
    #[error(
        "the angle of the heap is too uncertain: standard error {error:.1} degrees (at most {most_error:.1}), flanks of {:.1} and \
         {:.1} degrees", flanks[0], flanks[1]
    )]
    HeapUncertain {
        /// Mean inclination of the flanks all the same, degrees: it shows whether leaving such heaps out shifts a mean.
        mean: f64,
        /// Inclinations of the left and the right flank, degrees.
        flanks: [f64; 2],
        /// Standard error of the mean, degrees.
        error: f64,
        /// Largest standard error, degrees.
        most_error: f64,
    },
    /// The ruler itself refused the surface.
    #[error("no surface: {0}")]
    Surface(surface_profile::Error),
}

/// Where a bed ends at the shell: directions from straight down, positive towards the side on which the surface stands
/// higher, rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BedEnds {
    /// The lower end.
    pub toe: f64,
    /// The upper end.
    pub top: f64,
}

/// The reading of one picture.
#[derive(Debug, Clone, PartialEq)]
pub enum PhotoReading {
    /// The bed of a drum was measured.
    Drum(DrumReading),
    /// A heap was measured.
    Heap(HeapReading),
    /// Nothing was measured.
    Refused(RefusedReading),
}

/// The bed of a drum.
#[derive(Debug, Clone, PartialEq)]
pub struct DrumReading {
    /// The angle and the shape of the surface.
    pub angle: SurfaceAngle,
    /// Share of the drum that the bed takes: of the disc within 0.96 of the radius, where the smoothed bed share is above
    /// half of its bulk value; none if the surface was pointed at.
    pub fill_level: Option<f64>,
    /// Directions in which the bed ends at the shell, from straight down, counter-clockwise positive, rad: the clockwise end
    /// and the other. None of a bed that fills the shell all round, and where the surface was pointed at.
    pub ends: Option<[f64; 2]>,
    /// The drum, px.
    pub drum: DrumPixels,
    /// Surface points that count, px.
    pub used: Vec<PixelPoint>,
    /// Surface points set aside, px.
    pub rejected: Vec<PixelPoint>,
    /// Ends of the least-squares line on the drum circle: high, low, px.
    pub line_ends: [PixelPoint; 2],
    /// Ends of the tangent of the middle: high, low, px.
    pub mid_ends: [PixelPoint; 2],
    /// Ends of the chord: high, low, px.
    pub chord_ends: [PixelPoint; 2],
    /// The tone of the bed against the air that was used.
    pub foreground: Foreground,
    /// The channel in which bed and air were parted.
    pub channel: Channel,
    /// How far to trust the reading, 0 to 1: the drop of the bed share across the surface times
    /// the part of the chord covered times the part of points used.
    pub quality: f64,
}

/// A picture that was not measured, and what was found in it all the same: to be looked at, no measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct RefusedReading {
    /// Why not; its text is meant for people.
    pub reason: Refusal,
    /// The drum, when one was given or found, px.
    pub drum: Option<DrumPixels>,
    /// Where the bed ends at the shell, as in [`DrumReading::ends`]; told also where its surface has no angle.
    pub ends: Option<[f64; 2]>,
    /// The best circle of a search that found no drum, or a second drum, px; none if no part of a circle shows.
    pub candidate: Option<DrumPixels>,
    /// Points of the boundary that was found, px.
    pub boundary: Vec<PixelPoint>,
    /// Ends of the line through the boundary: high, low, px.
    pub line: Option<[PixelPoint; 2]>,
    /// The channel in which bed and air were to be parted.
    pub channel: Channel,
}

impl PhotoReading {
    /// The bed of a drum; none of a heap and if nothing was measured.
    pub fn bed(&self) -> Option<&DrumReading> {
        match self {
            Self::Drum(bed) => Some(bed),
            Self::Heap(_) | Self::Refused(_) => None,
        }
    }

    /// The heap; none of a drum and if nothing was measured.
    pub fn heap(&self) -> Option<&HeapReading> {
        match self {
            Self::Heap(heap) => Some(heap),
            Self::Drum(_) | Self::Refused(_) => None,
        }
    }

    /// The findings if nothing was measured.
    pub fn refused(&self) -> Option<&RefusedReading> {
        match self {
            Self::Refused(refused) => Some(refused),
            Self::Drum(_) | Self::Heap(_) => None,
        }
    }

    /// The angle of the bed of a drum.
    pub fn angle(&self) -> Option<SurfaceAngle> {
        Some(self.bed()?.angle)
    }

    /// The drum, measured or not, px.
    pub fn drum(&self) -> Option<DrumPixels> {
        match self {
            Self::Drum(bed) => Some(bed.drum),
            Self::Heap(_) => None,
            Self::Refused(refused) => refused.drum,
        }
    }

    /// Where the bed ends at the shell, as in [`DrumReading::ends`], its surface measured or not.
    pub fn ends(&self) -> Option<[f64; 2]> {
        match self {
            Self::Drum(bed) => bed.ends,
            Self::Heap(_) => None,
            Self::Refused(refused) => refused.ends,
        }
    }

    /// The channel in which bed and air were parted.
    pub fn channel(&self) -> Channel {
        match self {
            Self::Drum(bed) => bed.channel,
            Self::Heap(heap) => heap.channel,
            Self::Refused(refused) => refused.channel,
        }
    }

    /// How far to trust the reading, 0 to 1; 0 if nothing was measured.
    pub fn quality(&self) -> f64 {
        match self {
            Self::Drum(bed) => bed.quality,
            Self::Heap(heap) => heap.quality,
            Self::Refused(_) => 0.0,
        }
    }
}

impl RefusedReading {
    /// A reason, and the drum where one is known.
    pub(crate) fn new(reason: Refusal, drum: Option<DrumPixels>) -> Self {
        Self {
            reason,
            drum,
            ends: None,
            candidate: None,
            boundary: Vec::new(),
            line: None,
            channel: Channel::Luma,
        }
    }
}

impl From<RefusedReading> for PhotoReading {
    fn from(refused: RefusedReading) -> Self {
        Self::Refused(refused)
    }
}

impl DrumReading {
    /// Toe and top of the bed at the shell; none if the bed has no ends.
    pub fn bed_ends(&self) -> Option<BedEnds> {
        let [clockwise, other] = self.ends?;
        Some(match self.angle.high_side {
            HighSide::Right => BedEnds {
                toe: clockwise,
                top: other,
            },
            HighSide::Left => BedEnds {
                toe: -other,
                top: -clockwise,
            },
        })
    }

    /// Slope of the lowest fifth of the surface along its line, positive as the surface itself, rad: less than that of the line
    /// where the toe turns up. Least squares over all points there, those set aside too; none of fewer than 8 points.
    pub fn toe_slope(&self) -> Option<f64> {
        let toe = self.along_line().into_iter().filter(|p| p[0] < 0.2);
        Some(self.angle.line + slope(&toe.collect::<Vec<_>>())?)
    }

    /// Inclination of the least-squares line through all points, those set aside too, each hundredth of the way along the line
    /// with one weight, rad: differs from `line` where a broad toe or top stands off it. None of fewer than 8 stations.
    pub fn line_through_all(&self) -> Option<f64> {
        let mut stations: BTreeMap<i64, (f64, [f64; 2])> = BTreeMap::new();
        for p in self.along_line() {
            #[expect(clippy::cast_possible_truncation, reason = "a float cast saturates")]
            let station = (100.0 * p[0]).floor() as i64;
            let (n, sum) = stations.entry(station).or_default();
            *n += 1.0;
            *sum = [sum[0] + p[0], sum[1] + p[1]];
        }
        let means = stations.values().map(|(n, sum)| sum.map(|s| s / n));
        Some(self.angle.line + slope(&means.collect::<Vec<_>>())?)
    }

    /// All points of the surface by their way along the line from its low to its high end, and their height over it, both in
    /// parts of its length.
    fn along_line(&self) -> Vec<[f64; 2]> {
        let [high, low] = self.line_ends;
        let (along, up) = (high.x - low.x, low.y - high.y);
        let squared = along * along + up * up;
        // To the left of a way that climbs to the right lies the air, of one that climbs to the left the bed.
        let outwards = along.signum();
        let points = self.used.iter().chain(&self.rejected);
        let place = |p: &PixelPoint| {
            let (x, y) = (p.x - low.x, low.y - p.y);
            [along * x + up * y, outwards * (along * y - up * x)].map(|part| part / squared)
        };
        points.map(place).collect()
    }
}

/// Angle of the least-squares line through some points, rad; none of fewer than 8.
fn slope(points: &[[f64; 2]]) -> Option<f64> {
    if points.len() < 8 {
        return None;
    }
    let n = points.len() as f64;
    let mean = [0, 1].map(|k: usize| points.iter().map(|p| p[k]).sum::<f64>() / n);
    let sum = |k: usize| -> f64 {
        let product = |p: &[f64; 2]| (p[0] - mean[0]) * (p[k] - mean[k]);
        points.iter().map(product).sum()
    };
    Some(sum(1).atan2(sum(0)))
}

#[cfg(test)]
mod tests {
    use super::{DrumReading, PixelPoint};
    use crate::{Channel, DrumPixels, Foreground};
    use surface_profile::{HighSide, SurfaceAngle};

    /// A surface of 30 degrees, high on either side, whose points stand at the middles of the hundredths of its line; the lowest ten
    /// stand off it by a twentieth of its length and are set aside. By hand: the ten add 10 (0.05 - 0.5) 0.05 to the sum of
    /// products, the hundred (1 - 1e-4) 100 / 12 to that of squares. Within the lowest fifth the same ten of twenty lie
    /// before the others: 10 (0.05 - 0.1) 0.05 over 20 (0.04 - 1e-4) / 12.
    #[test]
    fn points_set_aside_turn_the_line_through_all() {
        let line = 30.0_f64.to_radians();
        for side in [1.0, -1.0] {
            let high_side = if side > 0.0 {
                HighSide::Right
            } else {
                HighSide::Left
            };
            let place = |t: f64, height: f64| PixelPoint {
                x: 300.0 + side * 200.0 * (t * line.cos() - height * line.sin()),
                y: 300.0 - 200.0 * (t * line.sin() + height * line.cos()),
            };
            let middle = |k: u32| 0.01 * f64::from(k) + 0.005;
            let angle = SurfaceAngle {
                line,
                chord: line,
                mid: line,
                standard_error: 0.0,
                chord_standard_error: 0.0,
                mid_standard_error: 0.0,
                curvature: 0.0,
                s_shape: 0.0,
                shape: None,
                high_side,
                n_points: 90,
                n_rejected: 10,
            };
            let ends = [place(1.0, 0.0), place(0.0, 0.0)];
            let reading = DrumReading {
                angle,
                fill_level: None,
                ends: None,
                drum: DrumPixels {
                    cx: 300.0,
                    cy: 300.0,
                    r: 200.0,
                },
                used: (10..100).map(|k| place(middle(k), 0.0)).collect(),
                rejected: (0..10).map(|k| place(middle(k), 0.05)).collect(),
                line_ends: ends,
                mid_ends: ends,
                chord_ends: ends,
                foreground: Foreground::Auto,
                channel: Channel::Luma,
                quality: 1.0,
            };
            let all: f64 = -10.0 * 0.45 * 0.05 / ((1.0 - 1e-4) * 100.0 / 12.0);
            let toe: f64 = -10.0 * 0.05 * 0.05 / (20.0 * (0.04 - 1e-4) / 12.0);
            let found = reading.line_through_all().unwrap();
            assert!((found - line - all.atan()).abs() < 1e-9, "{found}");
            let found = reading.toe_slope().unwrap();
            assert!((found - line - toe.atan()).abs() < 1e-9, "{found}");
        }
    }
}
