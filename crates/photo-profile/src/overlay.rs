//! The picture with what was found drawn over it.

use crate::digits::dots;
use crate::{PhotoReading, PixelPoint, Settings};
use image::{DynamicImage, GrayImage, Rgb, RgbImage};

/// Colour of the drum circle: blue.
const DRUM: Rgb<u8> = Rgb([40, 120, 255]);
/// Colour of surface points that count: green.
const USED: Rgb<u8> = Rgb([0, 200, 60]);
/// Colour of surface points set aside: magenta.
const REJECTED: Rgb<u8> = Rgb([230, 0, 200]);
/// Colour of the line and of the angle: orange.
const LINE: Rgb<u8> = Rgb([255, 130, 0]);
/// Longer side of the overlay at most, px.
const MOST_SIDE: u32 = 1600;

/// Draws the drum circle (blue), the surface points that count (green) and those set aside
/// (magenta), the chosen line or the flanks of a heap (orange) and the angle in degrees over the picture.
///
/// A picture longer than 1600 px is scaled down. A refused reading shows the drum, if any.
pub fn overlay(picture: &DynamicImage, reading: &PhotoReading, settings: &Settings) -> RgbImage {
    let longer = picture.width().max(picture.height());
    let scale = f64::from(MOST_SIDE.min(longer)) / f64::from(longer.max(1));
    let canvas = if longer > MOST_SIDE {
        picture.thumbnail(MOST_SIDE, MOST_SIDE).to_rgb8()
    } else {
        picture.to_rgb8()
    };
    let mut pen = Pen { canvas, scale };
    if let Some(drum) = reading.drum {
        let n = 3000;
        for k in 0..n {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(n)).sin_cos();
            pen.dot(
                PixelPoint {
                    x: drum.cx + drum.r * cos,
                    y: drum.cy + drum.r * sin,
                },
                DRUM,
            );
        }
    }
    for (points, colour) in [(&reading.used, USED), (&reading.rejected, REJECTED)] {
        for p in points {
            pen.dot(*p, colour);
        }
    }
    let ends = match settings.definition {
        surface_profile::Definition::Line => reading.line_ends,
        surface_profile::Definition::Mid => reading.mid_ends,
        surface_profile::Definition::Chord => reading.chord_ends,
    };
    let flanks = reading.heap.iter().flat_map(|heap| heap.lines);
    for [from, to] in ends.into_iter().chain(flanks) {
        pen.line(from, to);
    }
    let angle = reading.angle.map(|angle| angle.by(settings.definition));
    if let Some(angle) = angle.or(reading.heap.as_ref().map(|heap| heap.mean)) {
        let degrees = angle.to_degrees();
        pen.text(&format!("{degrees:.2}\u{b0}"));
    }
    pen.canvas
}

/// Draws over a grey picture; see [`overlay`].
pub fn overlay_gray(picture: &GrayImage, reading: &PhotoReading, settings: &Settings) -> RgbImage {
    overlay(
        &DynamicImage::ImageLuma8(picture.clone()),
        reading,
        settings,
    )
}

/// What draws: the canvas and its scale.
struct Pen {
    /// The picture drawn on.
    canvas: RgbImage,
    /// Canvas pixels per picture pixel, 1.
    scale: f64,
}

impl Pen {
    /// A dot of two by two pixels at a place of the picture; outside nothing.
    fn dot(&mut self, place: PixelPoint, colour: Rgb<u8>) {
        let (x, y) = (place.x * self.scale, place.y * self.scale);
        for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
            self.paint(x + dx, y + dy, colour);
        }
    }

    /// One pixel of the canvas; outside nothing.
    fn paint(&mut self, x: f64, y: f64, colour: Rgb<u8>) {
        if x >= 0.0 && y >= 0.0 {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "not negative; a huge one saturates and is outside"
            )]
            if let Some(pixel) = self.canvas.get_pixel_mut_checked(x as u32, y as u32) {
                *pixel = colour;
            }
        }
    }

    /// A straight line between two places of the picture, dashed to leave the points visible.
    fn line(&mut self, from: PixelPoint, to: PixelPoint) {
        let n = ((to.x - from.x).hypot(to.y - from.y) * self.scale)
            .ceil()
            .clamp(1.0, 1e5);
        let mut k = 0.0;
        while k <= n {
            if k % 12.0 < 7.0 {
                let t = k / n;
                let place = PixelPoint {
                    x: from.x + t * (to.x - from.x),
                    y: from.y + t * (to.y - from.y),
                };
                self.dot(place, LINE);
            }
            k += 1.0;
        }
    }

    /// Text at the upper left corner, on black.
    fn text(&mut self, text: &str) {
        let size = f64::from(self.canvas.width().max(200) / 200);
        let columns = text.chars().count() as f64 * 4.0 + 1.0;
        let mut block = |column: f64, row: f64, colour| {
            let mut k = 0.0;
            while k < size * size {
                let (dx, dy) = (k % size, (k / size).floor());
                self.paint((column + 1.0) * size + dx, (row + 1.0) * size + dy, colour);
                k += 1.0;
            }
        };
        for k in 0..7_u32 {
            let mut column = 0.0;
            while column < columns {
                block(column, f64::from(k), Rgb([0, 0, 0]));
                column += 1.0;
            }
        }
        for (i, rows) in text.chars().filter_map(dots).enumerate() {
            for (row, bits) in rows.iter().enumerate() {
                for bit in 0..3_u32 {
                    if bits >> (2 - bit) & 1 == 1 {
                        let column = 1.0 + 4.0 * i as f64 + f64::from(bit);
                        block(column, 1.0 + row as f64, LINE);
                    }
                }
            }
        }
    }
}
