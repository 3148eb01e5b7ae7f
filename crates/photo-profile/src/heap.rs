//! The outline of a heap seen from the side.

use crate::channel::channel_below_sky;
use crate::measure::Unfit;
use crate::tone::air_and_bed;
use crate::{Channel, Foreground, PhotoPixels, PixelPoint, Refusal, Settings};
use image::{GrayImage, Luma};
use imageproc::region_labelling::{Connectivity, connected_components};
use surface_profile::{HeapAngle, HeapFlank, SurfacePoint, measure_heap};

/// Columns of the outline at most.
const MOST_COLUMNS: usize = 1000;
/// Smoothing of the bed share, parts of the width of the picture.
const SMOOTHING: f64 = 0.004;
/// Part of the picture's height, from above, that must be air.
const SKY: f64 = 0.06;
/// The lower edge of a heap may hang below its feet by this part of its height: a camera 10 degrees above the foot of a heap of
/// 30 degrees shows 0.3, one that looks from above 1.
const MOST_BULGE: f64 = 0.6;
/// Fewest columns of a lower edge.
const FEWEST_EDGE: usize = 24;
/// Step of a numeric derivative, rad.
const STEP: f64 = 1e-4;
/// A heap that comes nearer to the upper border than this part of the height is cut.
const CLEAR_OF_TOP: f64 = 0.01;

/// A heap in a picture. Where the camera is said to look down, all inclinations are those of the cone that looks so.
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
    /// Inclination of the base beside the heap, positive when it rises to the right, rad; none where it does not show.
    pub base: Option<f64>,
    /// How far above the foot the camera stands by the bulge of the heap's lower edge, rad; none where that edge does not show.
    pub elevation_seen: Option<f64>,
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

/// Finds the outline of a heap and measures it.
pub(crate) fn read_heap(picture: &PhotoPixels, settings: &Settings) -> Result<HeapReading, Unfit> {
    let HeapShare {
        channel,
        foreground,
        scale,
        share,
    } = HeapShare::of(picture, settings)?;
    let (mut outline, cut) = outline(&share);
    let in_picture = |cell: f64| (cell + 0.5) * scale - 0.5;
    outline.retain(|(i, j)| {
        let (x, y) = (in_picture(*i), in_picture(*j));
        !picture.is_hidden_near(PixelPoint { x, y }, 2.0 * scale)
    });
    let (sin, cos) = settings.camera_roll.sin_cos();
    // Level coordinates, y up.
    let level: Vec<SurfacePoint> = outline
        .iter()
        .map(|(i, j)| SurfacePoint {
            x: i * cos - j * sin,
            y: -i * sin - j * cos,
        })
        .collect();
    let to_picture = |p: &SurfacePoint| PixelPoint {
        x: in_picture(p.x * cos - p.y * sin),
        y: in_picture(-p.x * sin - p.y * cos),
    };
    let unfit = |reason| Unfit {
        boundary: level.iter().map(to_picture).collect(),
        ..Unfit::from(reason)
    };
    if cut * 20 > share.width() {
        return Err(unfit(Refusal::HeapCut));
    }
    let heap = measure_heap(&level).map_err(|e| unfit(Refusal::Surface(e)))?;
    let edge = LowerEdge::of(&share, (sin, cos));
    if let Some(edge) = edge.filter(|edge| edge.bulge > MOST_BULGE * heap.height) {
        return Err(unfit(Refusal::HeapFromAbove {
            bulge: edge.bulge / heap.height,
            most: MOST_BULGE,
        }));
    }
    let [left, right] = of_flanks(&heap, settings.camera_elevation);
    let cone = HeapAngle {
        left,
        right,
        // Where no table shows beside the heap, its lower edge tells how it leans.
        base: heap.base.or(edge.map(|edge| edge.lean)),
        ..heap
    };
    let pick = |wanted: bool| -> Vec<PixelPoint> {
        let flagged = level.iter().zip(&cone.used);
        flagged
            .filter(|(_, used)| **used == wanted)
            .map(|(p, _)| to_picture(p))
            .collect()
    };
    let used = pick(true);
    Ok(HeapReading {
        left: left.inclination,
        left_standard_error: left.standard_error,
        right: right.inclination,
        right_standard_error: right.standard_error,
        mean: cone.mean(),
        standard_error: cone.standard_error(),
        apex: to_picture(&cone.apex),
        rounding: cone.rounding * scale,
        lines: [left, right].map(|flank| flank.ends.map(|p| to_picture(&p))),
        tops: [left.top, right.top],
        toes: [left.toe, right.toe],
        base: cone.base,
        elevation_seen: edge.map(|edge| edge.elevation()),
        quality: (2.0 * used.len() as f64 / level.len().max(1) as f64).clamp(0.0, 1.0),
        used,
        rejected: pick(false),
        foreground,
        channel,
    })
}

/// The share of bed in the largest connected part of it alone: dust, noise and what else stands about are no heap.
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
    /// By how much it hangs below the outermost places of the heap, cells.
    bulge: f64,
    /// Half of the distance of these places, cells.
    half_width: f64,
    /// Inclination of the line between them, positive when it rises to the right, rad.
    lean: f64,
}

impl LowerEdge {
    /// The edge; none where it does not show: where the bed reaches the lower border of the picture, as it does on a table of
    /// its tone.
    fn of(share: &PhotoPixels, (sin, cos): (f64, f64)) -> Option<Self> {
        let (width, height) = (share.width(), share.height());
        let level = |i: usize, j: usize| {
            let (column, row) = (i as f64, j as f64);
            (column * cos - row * sin, -column * sin - row * cos)
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
        let hangs = columns.iter().map(|&(i, _, bottom)| {
            let (x, y) = level(i, bottom);
            left.1 + slope * (x - left.0) - y
        });
        let mut hangs: Vec<f64> = hangs.collect();
        hangs.sort_by(f64::total_cmp);
        // The deepest fiftieth may be a shadow.
        let deepest = hangs[hangs.len() * 49 / 50];
        Some(Self {
            bulge: deepest.max(0.0),
            half_width: 0.5 * (right.0 - left.0),
            lean: slope.atan(),
        })
    }

    /// How far above the base the camera stands that sees a round base so, rad.
    fn elevation(&self) -> f64 {
        (self.bulge / self.half_width).min(1.0).asin()
    }
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

/// The flanks of the cone whose outline a camera sees so from an elevation, rad.
fn of_flanks(heap: &HeapAngle, elevation: f64) -> [HeapFlank; 2] {
    let cone = |seen: f64| of_cone(seen, elevation);
    [heap.left, heap.right].map(|flank| {
        // A small difference of the outline, as it is one of the cone.
        let part = (cone(flank.inclination + STEP) - cone(flank.inclination - STEP)) / (2.0 * STEP);
        HeapFlank {
            inclination: cone(flank.inclination),
            standard_error: part * flank.standard_error,
            top: cone(flank.top),
            toe: cone(flank.toe),
            ..flank
        }
    })
}
