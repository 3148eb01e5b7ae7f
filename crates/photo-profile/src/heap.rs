//! The outline of a heap seen from the side.

use crate::channel::channel_below_sky;
use crate::measure::Unfit;
use crate::tone::{BedShare, air_and_bed};
use crate::{Channel, PhotoPixels, PixelPoint, Refusal, Settings};
use serde::Serialize;
use surface_profile::{HeapAngle, SurfacePoint, measure_heap};

/// Columns of the outline at most.
const MOST_COLUMNS: usize = 1000;
/// Smoothing of the bed share, parts of the width of the picture.
const SMOOTHING: f64 = 0.004;
/// Part of the picture's height, from above, that must be air.
const SKY: f64 = 0.06;
/// A heap that comes nearer to the upper border than this part of the height is cut.
const CLEAR_OF_TOP: f64 = 0.01;

/// A heap in a picture.
#[derive(Debug, Clone, PartialEq, Serialize)]
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
}

/// A heap and the points of its outline that count and that do not, px.
pub(crate) struct FoundHeap {
    /// The heap.
    pub(crate) heap: HeapReading,
    /// Points that count.
    pub(crate) used: Vec<PixelPoint>,
    /// Points that do not.
    pub(crate) rejected: Vec<PixelPoint>,
    /// The tones.
    pub(crate) bed: BedShare,
    /// The channel in which they were parted.
    pub(crate) channel: Channel,
}

/// Finds the outline of a heap and measures it.
pub(crate) fn read_heap(picture: &PhotoPixels, settings: &Settings) -> Result<FoundHeap, Unfit> {
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
    let share = PhotoPixels::from_values(small.width(), bed.share.clone())
        .blurred((SMOOTHING * small.width() as f64).max(0.8));
    let (outline, cut) = outline(&share);
    let (sin, cos) = settings.camera_roll.sin_cos();
    // Level coordinates, y up.
    let level: Vec<SurfacePoint> = outline
        .iter()
        .map(|(i, j)| SurfacePoint {
            x: i * cos - j * sin,
            y: -i * sin - j * cos,
        })
        .collect();
    let scale = factor as f64;
    let to_picture = |p: &SurfacePoint| PixelPoint {
        x: (p.x * cos - p.y * sin + 0.5) * scale - 0.5,
        y: (-p.x * sin - p.y * cos + 0.5) * scale - 0.5,
    };
    let unfit = |reason| Unfit {
        boundary: level.iter().map(to_picture).collect(),
        ..Unfit::from(reason)
    };
    if cut * 20 > share.width() {
        return Err(unfit(Refusal::HeapCut));
    }
    let heap = measure_heap(&level).map_err(|e| unfit(Refusal::Surface(e)))?;
    let pick = |wanted: bool| {
        let flagged = level.iter().zip(&heap.used);
        flagged
            .filter(|(_, used)| **used == wanted)
            .map(|(p, _)| to_picture(p))
            .collect()
    };
    Ok(FoundHeap {
        used: pick(true),
        rejected: pick(false),
        heap: reading(&heap, scale, to_picture),
        bed,
        channel,
    })
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

/// The heap in pixels of the picture.
fn reading(
    heap: &HeapAngle,
    scale: f64,
    to_picture: impl Fn(&SurfacePoint) -> PixelPoint,
) -> HeapReading {
    HeapReading {
        left: heap.left.inclination,
        left_standard_error: heap.left.standard_error,
        right: heap.right.inclination,
        right_standard_error: heap.right.standard_error,
        mean: heap.mean(),
        standard_error: heap.standard_error(),
        apex: to_picture(&heap.apex),
        rounding: heap.rounding * scale,
        lines: [heap.left, heap.right].map(|flank| flank.ends.map(|p| to_picture(&p))),
    }
}
