//! The outline of a heap seen from the side.

use crate::channel::channel_below_sky;
use crate::measure::Unfit;
use crate::tone::air_and_bed;
use crate::{Channel, Foreground, PhotoPixels, PixelPoint, Refusal, Settings};
use image::{GrayImage, Luma};
use imageproc::region_labelling::{Connectivity, connected_components};
use surface_profile::{HeapAngle, HeapFlank, SurfacePoint, measure_heap_above, median};

/// Columns of the outline at most.
const MOST_COLUMNS: usize = 1000;
/// Smoothing of the bed share, parts of the width of the picture.
const SMOOTHING: f64 = 0.004;
/// Part of the picture's height, from above, that must be air.
const SKY: f64 = 0.06;
/// The lower edge of a heap may hang below its feet by this part of its height, which is `tan e / tan theta` of a cone of the
/// inclination theta seen from the elevation e: 0.3 for 10 and 30 degrees, 1 if the apex is seen over the base. With more than
/// this the back of the base hides more than a third of the flanks.
const MOST_BULGE: f64 = 0.6;
/// Above the part of the height that the back of the base hides, a flank is not fitted over this further part of it.
const CLEAR_OF_BACK: f64 = 0.05;
/// The elevation of the camera is not known better than this by the lower edge of a heap, rad: 1 degree, by which the bases of
/// heaps are not round (our choice; twice as much adds 0.4 degrees to the error of a heap seen from 15 degrees above).
const LEAST_ELEVATION_ERROR: f64 = 0.0175;
/// Of the correction for the elevation, what counts as standard deviation: no heap is a cone, and no camera is infinitely far
/// (our choice; twice as much refuses heaps of 34 degrees from 20 degrees above by the default limit of the error).
const CORRECTION_PART: f64 = 0.25;
/// Part of half of the width, about the middle, over which the bulge is averaged: towards the ends the edge turns upright.
const EDGE_REACH: f64 = 0.8;
/// Fewest columns of a lower edge.
const FEWEST_EDGE: usize = 24;
/// Step of a numeric derivative, rad.
const STEP: f64 = 1e-4;
/// A heap that comes nearer to the upper border than this part of the height is cut.
const CLEAR_OF_TOP: f64 = 0.01;

/// A heap in a picture. If the camera looks down, all inclinations are those of the cone that looks so from there.
#[derive(Debug, Clone, PartialEq)]
pub struct HeapReading {
    /// Inclination of the left flank, rad.
    pub left: f64,
    /// Its standard error, rad.
    pub left_standard_error: f64,
    /// Inclination of the right flank, rad.
    pub right: f64,
    /// Its standard error, rad.
    pub right_standard_error: f64,
    /// Mean of both, rad.
    pub mean: f64,
    /// Its standard error, rad.
    pub standard_error: f64,
    /// Where the lines of the flanks meet, px.
    pub apex: PixelPoint,
    /// By how much the top of the heap stays below that point, px.
    pub rounding: f64,
    /// Ends of the lines of the left and the right flank, upper and lower, px.
    pub lines: [[PixelPoint; 2]; 2],
    /// Inclinations of the upper halves of the left and the right flank, rad.
    pub tops: [f64; 2],
    /// Inclinations of the lower halves, rad.
    pub toes: [f64; 2],
    /// Inclination of the base beside the heap, positive when it rises to the right, rad; none if it does not show.
    pub base: Option<f64>,
    /// How far above the foot the camera stands by the bulge of the heap's lower edge, or by its feet if that edge does not show,
    /// rad; none if these do not show either.
    pub elevation_seen: Option<f64>,
    /// The elevation that was taken off: as stated, or as seen, rad; 0 if neither is known.
    pub elevation: f64,
    /// Mean inclination of both flanks as the picture shows them, before the elevation is taken off, rad.
    pub mean_seen: f64,
    /// Points of the outline that count, px.
    pub used: Vec<PixelPoint>,
    /// Points of the outline that do not, px.
    pub rejected: Vec<PixelPoint>,
    /// The tone of the heap against the air that was used.
    pub foreground: Foreground,
    /// The channel in which heap and air were parted.
    pub channel: Channel,
    /// How far to trust the reading, 0 to 1: the part of the outline's flanks that counts.
    pub quality: f64,
}

/// Where a picture shows the heap.
struct HeapShare {
    /// The channel in which heap and air were parted.
    channel: Channel,
    /// The tone of the heap against the air.
    foreground: Foreground,
    /// Pixels of the picture along the edge of a cell.
    scale: f64,
    /// Share of each cell that the heap takes, smoothed.
    share: PhotoPixels,
}

impl HeapShare {
    /// Parts the heap from the air below the upper border.
    fn of(picture: &PhotoPixels, settings: &Settings) -> Result<Self, Refusal> {
        let factor = picture.width().div_ceil(MOST_COLUMNS).max(1);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a part of the number of cells"
        )]
        let n_sky = |pixels: &PhotoPixels| (SKY * pixels.values().len() as f64).ceil() as usize;
        let channel = channel_below_sky(picture, n_sky(picture), settings);
        let small = picture.channel(channel).shrunk(factor);
        let bed = air_and_bed(small.values(), n_sky(&small), settings.foreground)?;
        let blur = (SMOOTHING * small.width() as f64).max(0.8);
        Ok(Self {
            channel,
            foreground: bed.foreground,
            scale: factor as f64,
            share: largest_part(PhotoPixels::from_values(small.width(), bed.share).blurred(blur)),
        })
    }
}

/// Level coordinates, y up, in cells of the shrunk picture.
struct LevelFrame {
    /// Sine and cosine of the roll of the camera.
    sin: f64,
    cos: f64,
    /// Side of a cell, px.
    scale: f64,
}

impl LevelFrame {
    fn new(camera_roll: f64, scale: f64) -> Self {
        let (sin, cos) = camera_roll.sin_cos();
        Self { sin, cos, scale }
    }

    fn of_cell(&self, column: f64, row: f64) -> SurfacePoint {
        SurfacePoint {
            x: column * self.cos - row * self.sin,
            y: -column * self.sin - row * self.cos,
        }
    }

    fn to_picture(&self, p: &SurfacePoint) -> PixelPoint {
        // The centre of a cell is half a cell in, that of a pixel half a pixel.
        let in_picture = |cell: f64| (cell + 0.5) * self.scale - 0.5;
        PixelPoint {
            x: in_picture(p.x * self.cos - p.y * self.sin),
            y: in_picture(-p.x * self.sin - p.y * self.cos),
        }
    }
}

/// Finds the outline of a heap and measures it.
pub(crate) fn read_heap(picture: &PhotoPixels, settings: &Settings) -> Result<HeapReading, Unfit> {
    let HeapShare {
        channel,
        foreground,
        scale,
        share,
    } = HeapShare::of(picture, settings)?;
    let frame = LevelFrame::new(settings.camera_roll, scale);
    let (outline, cut) = outline(&share);
    let level = outline.iter().map(|&(i, j)| frame.of_cell(i, j));
    let level: Vec<SurfacePoint> = level
        .filter(|p| !picture.is_hidden_near(frame.to_picture(p), 2.0 * scale))
        .collect();
    let to_picture = |p: &SurfacePoint| frame.to_picture(p);
    let unfit = |reason| Unfit {
        boundary: level.iter().map(to_picture).collect(),
        ..Unfit::from(reason)
    };
    if cut * 20 > share.width() {
        return Err(unfit(Refusal::HeapCut));
    }
    let edge = LowerEdge::of(&share, &frame);
    let Cone {
        heap,
        mean_seen,
        error,
        flank_errors,
        elevation,
        elevation_seen,
    } = Cone::of(&level, edge, settings).map_err(unfit)?;
    let pick = |wanted: bool| -> Vec<PixelPoint> {
        let flagged = level.iter().zip(&heap.used);
        flagged
            .filter(|(_, used)| **used == wanted)
            .map(|(p, _)| to_picture(p))
            .collect()
    };
    let used = pick(true);
    Ok(HeapReading {
        left: heap.left.inclination,
        left_standard_error: flank_errors[0],
        right: heap.right.inclination,
        right_standard_error: flank_errors[1],
        mean: heap.mean(),
        standard_error: error,
        apex: to_picture(&heap.apex),
        rounding: heap.rounding * scale,
        lines: [heap.left, heap.right].map(|flank| flank.ends.map(|p| to_picture(&p))),
        tops: [heap.left.top, heap.right.top],
        toes: [heap.left.toe, heap.right.toe],
        base: heap.base,
        elevation_seen,
        elevation,
        mean_seen,
        quality: (2.0 * used.len() as f64 / level.len().max(1) as f64).clamp(0.0, 1.0),
        used,
        rejected: pick(false),
        foreground,
        channel,
    })
}

/// A heap as a cone that is seen from an elevation.
struct Cone {
    /// The heap with the elevation taken off.
    heap: HeapAngle,
    /// Mean inclination of both flanks before the elevation is taken off, rad.
    mean_seen: f64,
    /// Standard error of the mean, rad.
    error: f64,
    /// Standard errors of the left and the right flank, rad.
    flank_errors: [f64; 2],
    /// The elevation that was taken off, rad.
    elevation: f64,
    /// The elevation that shows, rad.
    elevation_seen: Option<f64>,
}

impl Cone {
    /// Measures an outline (level, y up) over a lower edge, if that shows.
    fn of(
        level: &[SurfacePoint],
        edge: Option<LowerEdge>,
        settings: &Settings,
    ) -> Result<Self, Refusal> {
        if let Some(edge) = edge.filter(LowerEdge::hangs_too_far) {
            return Err(Refusal::HeapFromAbove {
                elevation: edge.elevation().to_degrees(),
                bulge: edge.bulge.max(edge.deepest) / edge.height,
                most: MOST_BULGE,
            });
        }
        let hidden = edge.map_or(0.0, |edge| edge.hidden_part());
        let seen = measure_heap_above(level, hidden + CLEAR_OF_BACK).map_err(Refusal::Surface)?;
        let mean_seen = seen.mean();
        let feet = edge.is_none().then(|| elevation_by_feet(&seen)).flatten();
        let elevation = Elevation::of(settings, edge, feet);
        let heap = HeapAngle {
            left: elevation.taken_off(&seen.left),
            right: elevation.taken_off(&seen.right),
            // If no table shows beside the heap, its lower edge shows how it leans.
            base: seen.base.or(edge.map(|edge| edge.lean)),
            ..seen
        };
        // The elevation errs for both flanks alike; a turn of the camera adds to one flank what it takes from the other.
        let by_elevation = elevation.error_of(mean_seen);
        let of_flank = |flank: &HeapFlank| {
            let elevated = flank.standard_error.hypot(by_elevation);
            elevated.hypot(settings.camera_roll_error)
        };
        let error = heap.standard_error().hypot(by_elevation);
        if error > settings.max_angle_error {
            return Err(Refusal::HeapUncertain {
                mean: heap.mean().to_degrees(),
                flanks: [heap.left, heap.right].map(|flank| flank.inclination.to_degrees()),
                error: error.to_degrees(),
                most_error: settings.max_angle_error.to_degrees(),
            });
        }
        Ok(Self {
            flank_errors: [of_flank(&heap.left), of_flank(&heap.right)],
            heap,
            mean_seen,
            error,
            elevation: elevation.angle,
            elevation_seen: edge.map(|edge| edge.elevation()).or(feet),
        })
    }
}

/// The share of bed in the largest connected part of it alone: dust, noise and other objects are not part of a heap.
fn largest_part(share: PhotoPixels) -> PhotoPixels {
    let (width, height) = (share.width(), share.height());
    let levels = share
        .values()
        .iter()
        .map(|v| if *v >= 0.5 { 255 } else { 0 });
    let sides = [width, height].map(|side| u32::try_from(side).unwrap_or(0));
    let Some(mask) = GrayImage::from_raw(sides[0], sides[1], levels.collect()) else {
        return share;
    };
    let parts = connected_components(&mask, Connectivity::Four, Luma([0]));
    let mut sizes = vec![0_usize; width * height + 1];
    for part in parts.pixels() {
        sizes[part.0[0] as usize] += 1;
    }
    sizes[0] = 0;
    let largest = (0..sizes.len())
        .max_by_key(|part| sizes[*part])
        .unwrap_or(0);
    let kept = share.values().iter().zip(parts.pixels());
    // The half-shaded border belongs to the part, for places between pixels.
    let kept = kept.map(|(value, part)| {
        let other = part.0[0] != 0 && part.0[0] as usize != largest;
        if other { 0.0 } else { value.min(1.0) }
    });
    PhotoPixels::from_values(width, kept.collect())
}

/// The lower edge of a heap.
#[derive(Debug, Clone, Copy)]
struct LowerEdge {
    /// By how much the middle of the half ellipse through it hangs below the outermost places of the heap, cells.
    bulge: f64,
    /// By how much the edge itself hangs below them, cells.
    deepest: f64,
    /// Root mean square distance of the edge from the half ellipse, cells.
    roughness: f64,
    /// Height of the top over the line between the outermost places, cells.
    height: f64,
    /// Half of the distance of these places, cells.
    half_width: f64,
    /// Inclination of the line between them, positive when it rises to the right, rad.
    lean: f64,
}

impl LowerEdge {
    /// The edge; none if it does not show: if the bed reaches the lower border of the picture, as it does on a table of its
    /// tone.
    ///
    /// # Formula
    /// A round base of the radius R is seen from the elevation e as an ellipse with the half axes R and `R sin e`: the edge hangs by
    /// `b sqrt(1 - u^2)` at the part u of half the width, and b is the median of what each column says.
    fn of(share: &PhotoPixels, frame: &LevelFrame) -> Option<Self> {
        let (width, height) = (share.width(), share.height());
        let level = |i: usize, j: usize| {
            let SurfacePoint { x, y } = frame.of_cell(i as f64, j as f64);
            (x, y)
        };
        let columns = (0..width).filter_map(|i| {
            let is_bed = |j: &usize| share.values()[j * width + i] >= 0.5;
            let top = (0..height).find(is_bed)?;
            Some((i, top, (0..height).rev().find(is_bed)?))
        });
        let columns: Vec<(usize, usize, usize)> = columns.collect();
        let open = columns.iter().filter(|(.., bottom)| bottom + 2 >= height);
        if columns.len() < FEWEST_EDGE || 10 * open.count() >= columns.len() {
            return None;
        }
        let end = |&(i, top, bottom): &(usize, usize, usize)| {
            let ((x, y), (_, low)) = (level(i, top), level(i, bottom));
            (x, 0.5 * (y + low))
        };
        let (left, right) = (end(columns.first()?), end(columns.last()?));
        let slope = (right.1 - left.1) / (right.0 - left.0);
        let over = |(x, y): (f64, f64)| y - left.1 - slope * (x - left.0);
        let half_width = 0.5 * (right.0 - left.0);
        // The ends of something upright change places if the camera leans far.
        if half_width < 1.0 {
            return None;
        }
        let middle = 0.5 * (left.0 + right.0);
        // Part of half the width, and how far the edge hangs there.
        let hangs: Vec<(f64, f64)> = columns
            .iter()
            .map(|&(i, _, bottom)| level(i, bottom))
            .map(|p| ((p.0 - middle) / half_width, -over(p)))
            .filter(|(part, _)| part.abs() <= EDGE_REACH)
            .collect();
        let shape = |part: f64| (1.0 - part * part).sqrt();
        let mut bulges: Vec<f64> = hangs
            .iter()
            .map(|(part, hang)| hang / shape(*part))
            .collect();
        let bulge = median(&mut bulges).max(0.0);
        let squares = hangs
            .iter()
            .map(|(part, hang)| (hang - bulge * shape(*part)).powi(2));
        let roughness = (squares.sum::<f64>() / hangs.len().max(1) as f64).sqrt();
        // The deepest fiftieth may be a shadow, and the highest hundredth a grain in flight.
        let part_of = |mut values: Vec<f64>, of_100: usize| {
            values.sort_by(f64::total_cmp);
            values.get(values.len() * of_100 / 100).copied()
        };
        let deepest = part_of(hangs.iter().map(|(_, hang)| *hang).collect(), 98)?;
        let tops = columns.iter().map(|&(i, top, _)| over(level(i, top)));
        Some(Self {
            bulge,
            deepest: deepest.max(0.0),
            roughness,
            height: part_of(tops.collect(), 99)?.max(f64::MIN_POSITIVE),
            half_width,
            lean: slope.atan(),
        })
    }

    /// Whether it hangs so far that the flanks are not seen.
    fn hangs_too_far(&self) -> bool {
        self.bulge.max(self.deepest) > MOST_BULGE * self.height
    }

    /// The part of the height, from below, in which the outline of a cone is the back of its round base.
    ///
    /// # Formula
    /// The lines from the apex, seen at the height h over the middle of the base, touch the ellipse at the height `b^2 / h`.
    fn hidden_part(&self) -> f64 {
        (self.bulge / self.height).powi(2)
    }

    /// How far above the base the camera stands that sees a round base so, rad.
    fn elevation(&self) -> f64 {
        (self.bulge / self.half_width).min(1.0).asin()
    }

    /// Standard error of that, rad: the ellipse may lie off the foot by twice the roughness of the edge, as the grains at the foot
    /// of a heap lie on one side of it.
    fn elevation_error(&self) -> f64 {
        let cos = self.elevation().cos().max(0.1);
        (2.0 * self.roughness / (self.half_width * cos)).max(LEAST_ELEVATION_ERROR)
    }
}

/// How far above the foot of a heap the camera stands.
#[derive(Debug, Clone, Copy)]
struct Elevation {
    /// The elevation, rad.
    angle: f64,
    /// Another elevation that is as good, or better or worse by one standard error, rad.
    other: f64,
}

impl Elevation {
    /// What is stated, or what the lower edge shows. If both are known and differ, each may be right. What the feet show is less
    /// certain, as a heap may stand on round feet: it is not taken off, but may be right.
    fn of(settings: &Settings, edge: Option<LowerEdge>, feet: Option<f64>) -> Self {
        let seen = edge.map(|edge| (edge.elevation(), edge.elevation_error()));
        match (settings.camera_elevation, seen) {
            (Some(angle), Some((seen, error))) if (seen - angle).abs() > 2.0 * error => {
                Self { angle, other: seen }
            }
            (Some(angle), _) => Self {
                angle,
                other: angle,
            },
            (None, Some((angle, error))) => Self {
                angle,
                other: angle + error,
            },
            (None, None) => Self {
                angle: 0.0,
                other: feet.unwrap_or(0.0),
            },
        }
    }

    /// The flank of the cone whose outline is seen so.
    fn taken_off(&self, flank: &HeapFlank) -> HeapFlank {
        let cone = |seen: f64| of_cone(seen, self.angle);
        // A small difference of the outline, as it is one of the cone.
        let part = (cone(flank.inclination + STEP) - cone(flank.inclination - STEP)) / (2.0 * STEP);
        HeapFlank {
            inclination: cone(flank.inclination),
            standard_error: part * flank.standard_error,
            top: cone(flank.top),
            toe: cone(flank.toe),
            ..*flank
        }
    }

    /// What the elevation adds to the standard error of an inclination that is seen, rad: its own error, and a part of the whole
    /// correction.
    fn error_of(&self, seen: f64) -> f64 {
        let cone = of_cone(seen, self.angle);
        let by_error = of_cone(seen, self.other) - cone;
        by_error.hypot(CORRECTION_PART * (cone - seen))
    }
}

/// How far above the foot a camera stands that sees the flanks of a cone fall more steeply at its feet, rad; 0 if they do not.
///
/// # Formula
/// The lines from the apex touch the ellipse of the base at the part `sqrt(1 - t^2)` of its half axis R, and meet its long axis at
/// `R / sqrt(1 - t^2)`, with `t = tan e / tan theta`: the feet are `sqrt(1 - t^2)` as wide as the lines, and
/// `sin^2 e = t^2 tan^2 alpha / (1 - t^2)` with the inclination alpha that is seen.
fn elevation_by_feet(heap: &HeapAngle) -> Option<f64> {
    let ratio = heap.feet?;
    let square = (1.0 - ratio * ratio).max(0.0);
    let sine = square.sqrt() * heap.mean().tan() / ratio.abs().max(f64::MIN_POSITIVE);
    Some(sine.min(1.0).asin())
}

/// Inclination of a cone whose outline is seen at an inclination, rad.
///
/// # Formula
/// `tan theta = sqrt(tan^2 alpha + sin^2 e) / cos e` for parallel rays from an elevation e above the base: the outline of the
/// cone `z = -r tan theta` is `Z = -|X| sqrt(tan^2 theta cos^2 e - sin^2 e)`.
fn of_cone(seen: f64, elevation: f64) -> f64 {
    let (sin, cos) = elevation.sin_cos();
    (seen.tan().hypot(sin) / cos).atan()
}

/// The highest place of bed in each column, (column, row) of the half share, and the number of columns in which it lies at
/// the upper border.
fn outline(share: &PhotoPixels) -> (Vec<(f64, f64)>, usize) {
    let (width, height) = (share.width(), share.height());
    let value = |i: usize, j: usize| f64::from(share.values()[j * width + i]);
    let mut points = Vec::new();
    let mut cut = 0;
    for i in 0..width {
        let Some(j) = (0..height).find(|j| value(i, *j) >= 0.5) else {
            continue;
        };
        if (j as f64) < CLEAR_OF_TOP * height as f64 {
            cut += 1;
            continue;
        }
        let (above, here) = (value(i, j - 1), value(i, j));
        let part = ((0.5 - above) / (here - above)).clamp(0.0, 1.0);
        points.push((i as f64, (j - 1) as f64 + part));
    }
    (points, cut)
}
