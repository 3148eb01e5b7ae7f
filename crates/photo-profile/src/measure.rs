//! The path from a picture to its angle.

use crate::agreement::agreement;
use crate::channel::channel_of_disc;
use crate::drum::{FoundDrum, NotFound, find_drum};
use crate::heap::read_heap;
use crate::tone::{BedShare, bed_share};
use crate::uncertainty::widened;
use crate::view::{DiscView, REACH};
use crate::{
    Channel, DrumPixels, DrumReading, Error, Foreground, Mode, PhotoPixels, PhotoReading,
    PixelPoint, PixelRegion, Refusal, RefusedReading, Settings,
};
use image::GrayImage;
use surface_profile::{
    DrumCircle, Field, SurfacePoint, SurfaceReading, bulk_level, free_surface, read_surface,
    shell_ends,
};

/// Smoothing of the bed share, in drum radii; the simulated bed's density has the same.
const SMOOTHING: f64 = 0.03;
/// Shortest side of a picture, px: below, a step of one pixel turns a surface by a degree.
const LEAST_SIDE: u32 = 64;
/// Largest roughness, in drum radii: twice that of seeds of a seventh of the radius.
pub(crate) const MOST_ROUGHNESS: f64 = 0.1;

/// Measures the angle in a grey picture, for example a rendered frame.
///
/// # Errors
/// As [`Settings::check`].
pub fn measure_image(picture: &GrayImage, settings: &Settings) -> Result<PhotoReading, Error> {
    measure_photo(&PhotoPixels::from_gray(picture), settings)
}

/// Measures the angle in a picture.
///
/// # Errors
/// As [`Settings::check`], and [`Error::BadRegion`].
pub fn measure_photo(picture: &PhotoPixels, settings: &Settings) -> Result<PhotoReading, Error> {
    settings.check()?;
    if let Some(region) = settings.region {
        region.check(picture)?;
        let reading = measure_photo(&picture.part(region), &region.settings(settings))?;
        return Ok(region.in_the_whole(reading));
    }
    let shorter = u32::try_from(picture.width().min(picture.height())).unwrap_or(u32::MAX);
    if shorter < LEAST_SIDE {
        let reason = Refusal::TooSmall {
            pixels: shorter,
            least: LEAST_SIDE,
        };
        return Ok(RefusedReading::new(reason, settings.drum).into());
    }
    if settings.mode == Mode::Heap {
        return Ok(match read_heap(picture, settings) {
            Ok(heap) => PhotoReading::Heap(heap),
            Err(unfit) => unfit.refused(None).into(),
        });
    }
    Ok(read_drum(picture, settings))
}

/// Measures the drum that is stated, or the one that the picture shows; of two that can be measured none is meant.
fn read_drum(picture: &PhotoPixels, settings: &Settings) -> PhotoReading {
    if let Some(circle) = settings.drum {
        return read_disc(picture, &FoundDrum { circle, rim: None }, settings);
    }
    let reading = search_drum(picture, settings);
    let Some(first) = reading.bed().map(|bed| bed.drum) else {
        return reading;
    };
    match other_drum(picture, first, settings) {
        Some(second) => PhotoReading::Refused(RefusedReading {
            candidate: Some(second),
            ..RefusedReading::new(Refusal::TwoDrums { first, second }, Some(first))
        }),
        None => reading,
    }
}

/// A second drum beside the first that can be measured as well, at least half as large.
fn other_drum(picture: &PhotoPixels, first: DrumPixels, settings: &Settings) -> Option<DrumPixels> {
    beside(picture, first).into_iter().find_map(|region| {
        let reading = search_drum(&picture.part(region), &region.settings(settings));
        let second = region.in_the_whole(reading).bed()?.drum;
        (second.r >= 0.5 * first.r).then_some(second)
    })
}

/// The parts of a picture left of, right of, above and below a circle that are as wide as its radius or wider.
fn beside(picture: &PhotoPixels, circle: DrumPixels) -> Vec<PixelRegion> {
    let [width, height] = [picture.width(), picture.height()].map(|n| n as f64);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to the picture"
    )]
    let whole = |v: f64, most: f64| v.round().clamp(0.0, most) as u32;
    let (left, right) = (
        whole(circle.cx - circle.r, width),
        whole(circle.cx + circle.r, width),
    );
    let (above, below) = (
        whole(circle.cy - circle.r, height),
        whole(circle.cy + circle.r, height),
    );
    let (all_columns, all_rows) = (whole(width, width), whole(height, height));
    let strips = [
        [0, 0, left, all_rows],
        [right, 0, all_columns - right, all_rows],
        [0, 0, all_columns, above],
        [0, below, all_columns, all_rows - below],
    ];
    let strips = strips.map(|[left, top, width, height]| PixelRegion {
        left,
        top,
        width,
        height,
    });
    let wide = |region: &PixelRegion| f64::from(region.width.min(region.height)) >= circle.r;
    strips.into_iter().filter(wide).collect()
}

/// Measures a drum by the circle that the luminance shows, or another channel where that one leads nowhere. A circle that was
/// looked at already is not looked at again: each look chooses among all channels for itself, and further chances would let
/// pass what was refused.
fn search_drum(picture: &PhotoPixels, settings: &Settings) -> PhotoReading {
    let look = |found: Result<FoundDrum, NotFound>| match found {
        Ok(drum) => read_disc(picture, &drum, settings),
        Err(not_found) => not_found.reading(),
    };
    let mut told = look(find_drum(&picture.channel(Channel::Luma)));
    let mut seen: Vec<DrumPixels> = told.drum().into_iter().collect();
    let colours = Channel::COLOURS.into_iter();
    for channel in colours.filter(|_| picture.has_colour()) {
        if told.bed().is_some() {
            break;
        }
        let found = find_drum(&picture.channel(channel));
        let is_seen = |drum: &FoundDrum| seen.iter().any(|known| known.is_like(&drum.circle));
        if found.as_ref().is_ok_and(is_seen) {
            continue;
        }
        let other = look(found);
        seen.extend(other.drum());
        // A refusal with a circle tells more than one without.
        if other.bed().is_some() || told.drum().is_none() && other.drum().is_some() {
            told = other;
        }
    }
    told
}

/// Measures the disc of a known drum in the channel that parts its two sides best.
fn read_disc(picture: &PhotoPixels, found: &FoundDrum, settings: &Settings) -> PhotoReading {
    let channel = channel_of_disc(picture, found.circle, settings);
    let circle = Some(found.circle);
    let disc = match Disc::of(&picture.channel(channel), found.circle, settings) {
        Ok(disc) => disc,
        Err(reason) => {
            return PhotoReading::Refused(RefusedReading {
                channel,
                ..RefusedReading::new(reason, circle)
            });
        }
    };
    let ends = shell_ends(&disc.field, disc.level, &disc.circle);
    match read_surface_of(picture, &disc, found, settings) {
        Ok(bed) => PhotoReading::Drum(DrumReading {
            ends,
            channel,
            ..bed
        }),
        Err(unfit) => PhotoReading::Refused(RefusedReading {
            ends,
            channel,
            ..unfit.refused(circle)
        }),
    }
}

/// The disc of a drum and how much bed each place of it shows.
struct Disc {
    /// The disc in the picture.
    view: DiscView,
    /// Bed by tone.
    bed: BedShare,
    /// The same, smoothed.
    field: Field,
    /// The same by the tone alone, smoothed.
    plain: Field,
    /// The share at the surface.
    level: f64,
    /// The drum about the origin, px.
    circle: DrumCircle,
}

impl Disc {
    /// Looks at the disc of a known drum.
    fn of(picture: &PhotoPixels, drum: DrumPixels, settings: &Settings) -> Result<Self, Refusal> {
        let view = DiscView::new(picture, drum, settings.camera_roll);
        view.check()?;
        let bed = bed_share(&view, settings.foreground)?;
        let circle = DrumCircle {
            x: 0.0,
            y: 0.0,
            radius: drum.r,
        };
        let [field, plain] = smoothed(&view, [&bed.share, &bed.plain], drum.r);
        let (field, plain) = (
            field.map_err(Refusal::Surface)?,
            plain.map_err(Refusal::Surface)?,
        );
        let level = bulk_level(&field, &circle);
        Ok(Self {
            view,
            bed,
            field,
            plain,
            level,
            circle,
        })
    }
}

/// Measures the surface in the disc of a drum.
fn read_surface_of(
    picture: &PhotoPixels,
    disc: &Disc,
    found: &FoundDrum,
    settings: &Settings,
) -> Result<DrumReading, Unfit> {
    let (drum, level) = (found.circle, disc.level);
    let (view, bed, field, circle) = (&disc.view, &disc.bed, &disc.field, &disc.circle);
    let mut points =
        free_surface(field, level, circle, REACH).map_err(|e| Unfit::from(Refusal::Surface(e)))?;
    // What was put into a hidden place reaches as far as the smoothing.
    points.retain(|p| !picture.is_hidden_near(view.to_picture(p), 2.0 * SMOOTHING * drum.r));
    let boundary = || points.iter().map(|p| view.to_picture(p)).collect();
    let mut surface = read_surface(&points, circle).map_err(|e| Unfit {
        boundary: boundary(),
        ..Unfit::from(Refusal::Surface(e))
    })?;
    let line = surface.line_ends.map(|p| view.to_picture(&p));
    let unfit = |reason| Unfit {
        reason,
        boundary: boundary(),
        line: Some(line),
    };
    let agreement = agreement(view, bed, &points, &surface);
    agreement.check().map_err(unfit)?;
    surface.angle = widened(
        [field, &disc.plain],
        level,
        &points,
        &surface,
        (circle, REACH),
        found.rim.as_ref(),
    );
    let angle = &mut surface.angle;
    for error in [
        &mut angle.standard_error,
        &mut angle.mid_standard_error,
        &mut angle.chord_standard_error,
    ] {
        *error = error.hypot(settings.camera_roll_error);
    }
    let error = surface.angle.standard_error;
    if surface.roughness > MOST_ROUGHNESS * drum.r || error > settings.max_angle_error {
        return Err(unfit(Refusal::TooRough {
            roughness: surface.roughness / drum.r,
            most: MOST_ROUGHNESS,
            error: error.to_degrees(),
            most_error: settings.max_angle_error.to_degrees(),
            line: surface.angle.line.to_degrees(),
        }));
    }
    let trust = Trust {
        step: agreement.step,
        foreground: bed.foreground,
        fill_level: field.share_above(level, circle, REACH),
    };
    let result = reading(view, drum, &points, &surface, &trust);
    let odd = found.rim.as_ref();
    match odd.filter(|rim| rim.hides_oddly(result.chord_ends)) {
        Some(rim) => Err(unfit(Refusal::BrokenRim {
            shown: rim.shown,
            elsewhere: rim.elsewhere,
        })),
        None => Ok(result),
    }
}

/// A boundary that is not measured.
#[derive(Debug)]
pub(crate) struct Unfit {
    /// Why not.
    pub(crate) reason: Refusal,
    /// Its points, px.
    pub(crate) boundary: Vec<PixelPoint>,
    /// Ends of the line through them: high, low, px.
    pub(crate) line: Option<[PixelPoint; 2]>,
}

impl From<Refusal> for Unfit {
    /// Nothing but the reason.
    fn from(reason: Refusal) -> Self {
        Self {
            reason,
            boundary: Vec::new(),
            line: None,
        }
    }
}

impl Unfit {
    fn refused(self, drum: Option<DrumPixels>) -> RefusedReading {
        RefusedReading {
            boundary: self.boundary,
            line: self.line,
            ..RefusedReading::new(self.reason, drum)
        }
    }
}

/// What the mask tells beside the surface.
struct Trust {
    /// Drop of the bed share across the surface, 1.
    step: f64,
    /// Tone of the bed.
    foreground: Foreground,
    /// Share of the disc that the bed takes, 1.
    fill_level: f64,
}

/// Bed shares smoothed inside the disc, as fields about the drum axis.
fn smoothed(
    view: &DiscView,
    shares: [&[f32]; 2],
    radius: f64,
) -> [Result<Field, surface_profile::Error>; 2] {
    let inside: Vec<f32> = view
        .inside
        .iter()
        .map(|i| f32::from(u8::from(*i)))
        .collect();
    let sd = SMOOTHING * radius / view.cell;
    let half = (view.n / 2) as f64 * view.cell;
    let first = SurfacePoint { x: -half, y: -half };
    let masked = |share: &[f32]| share.iter().zip(&inside).map(|(s, i)| s * i).collect();
    let blurred = |values| PhotoPixels::from_values(view.n, values).blurred(sd);
    let sums = shares.map(|share| blurred(masked(share)));
    let weight = blurred(inside);
    sums.map(|sum| {
        let pairs = sum.values().iter().zip(weight.values());
        let mean = |(s, w): (&f32, &f32)| if *w > 1e-3 { s / w } else { 0.0 };
        let values = pairs.map(mean).collect();
        Field::new(first, view.cell, view.n, values)?.smoothed_by(SMOOTHING * radius)
    })
}

/// Puts the reading together in the pixels of the picture.
fn reading(
    view: &DiscView,
    drum: DrumPixels,
    points: &[SurfacePoint],
    surface: &SurfaceReading,
    trust: &Trust,
) -> DrumReading {
    let pick = |wanted: bool| -> Vec<PixelPoint> {
        let flagged = points.iter().zip(&surface.used);
        flagged
            .filter(|(_, used)| **used == wanted)
            .map(|(p, _)| view.to_picture(p))
            .collect()
    };
    let (used, rejected) = (pick(true), pick(false));
    let part_used = used.len() as f64 / points.len().max(1) as f64;
    let quality = trust.step * (surface.covered / REACH) * part_used;
    DrumReading {
        angle: surface.angle,
        fill_level: Some(trust.fill_level),
        ends: None,
        drum,
        used,
        rejected,
        line_ends: surface.line_ends.map(|p| view.to_picture(&p)),
        mid_ends: surface.mid_ends.map(|p| view.to_picture(&p)),
        chord_ends: surface.chord_ends.map(|p| view.to_picture(&p)),
        foreground: trust.foreground,
        channel: Channel::Luma,
        quality: quality.clamp(0.0, 1.0),
    }
}
