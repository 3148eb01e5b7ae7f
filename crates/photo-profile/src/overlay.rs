//! The picture with what was found drawn over it.

use crate::font::{dots, lines};
use crate::{
    DrumPixels, DrumReading, HeapReading, PhotoReading, PixelPoint, RefusedReading, Settings,
};
use image::{DynamicImage, GrayImage, Rgb, RgbImage};
use std::io::Read as _;
use std::path::Path;
use surface_profile::Definition;

/// Colour of the drum circle: blue.
const DRUM: Rgb<u8> = Rgb([40, 120, 255]);
/// Colour of surface points that count: green.
const USED: Rgb<u8> = Rgb([0, 200, 60]);
/// Colour of surface points set aside and of the boundary in a refused picture: magenta.
const REJECTED: Rgb<u8> = Rgb([230, 0, 200]);
/// Colour of the line and of the angle: orange.
const LINE: Rgb<u8> = Rgb([255, 130, 0]);
/// Longer side of the overlay at most, px.
const MOST_SIDE: u32 = 1600;
/// Dots of a row of text, the gap to the next one included.
const ROW: u32 = 7;

/// The first bytes of a PNG whose pixels have three channels of 8 bits, as an overlay has them: signature and header, with
/// zeros for its width and height.
const RGB_PNG: [u8; 26] = [
    0x89, b'P', b'N', b'G', 0x0D, 0x0A, 0x1A, 0x0A, 0, 0, 0, 13, b'I', b'H', b'D', b'R', 0, 0, 0,
    0, 0, 0, 0, 0, 8, 2,
];
/// Pixels of one of its colours that an overlay has at least: the angle or the reason in words has more.
const LEAST_DRAWN: usize = 40;

/// Whether a file is a picture that [`overlay`] drew, by its format, its size and the colours of its pen. It needs two of these
/// colours, or the one of the words above a black last row: a photo has none of them to the last bit on so many pixels.
///
/// A file that cannot be read is none: whoever reads it says why.
pub(crate) fn is_overlay(path: &Path) -> bool {
    let mut head = [0; RGB_PNG.len()];
    let read = input::file::open(path).and_then(|mut file| file.read_exact(&mut head));
    // Width and height in big-endian order, from byte 16.
    let [width, height] = [16, 20].map(|k: usize| {
        let bytes = [head[k], head[k + 1], head[k + 2], head[k + 3]];
        u32::from_be_bytes(bytes)
    });
    head[16..24].fill(0);
    // The words below a refused picture take less than its width.
    if read.is_err() || head != RGB_PNG || width > MOST_SIDE || height > 2 * MOST_SIDE {
        return false;
    }
    let Ok(picture) = crate::read_photo(path) else {
        return false;
    };
    let picture = picture.to_rgb8();
    let drawn = [LINE, USED, REJECTED, DRUM]
        .map(|colour| picture.pixels().filter(|p| **p == colour).count() >= LEAST_DRAWN);
    let mut last_row = picture.rows().next_back().into_iter().flatten();
    drawn.iter().filter(|d| **d).count() >= 2 || drawn[0] && last_row.all(|p| p.0 == [0; 3])
}

/// Draws the drum circle (blue), the surface points that count (green) and those set aside
/// (magenta), the chosen line or the flanks of a heap (orange) and the angle in degrees over the picture.
///
/// A refused reading shows what was found: the drum, or the best circle of a search that found none (dashed), the
/// boundary and the line through it (magenta), and below the picture the reason in words. A picture longer than 1600 px
/// is scaled down.
pub fn overlay(picture: &DynamicImage, reading: &PhotoReading, settings: &Settings) -> RgbImage {
    let seen = marked(picture, reading, settings, MOST_SIDE);
    match reading.refused() {
        Some(refused) => with_words(&seen, &format!("refused: {}", refused.reason)),
        None => seen,
    }
}

/// The picture as in [`overlay`], without words, scaled down to a longer side of at most `most_side`, px.
pub fn marked(
    picture: &DynamicImage,
    reading: &PhotoReading,
    settings: &Settings,
    most_side: u32,
) -> RgbImage {
    let longer = picture.width().max(picture.height());
    let most_side = most_side.max(1);
    let scale = f64::from(most_side.min(longer)) / f64::from(longer.max(1));
    let canvas = if longer > most_side {
        picture.thumbnail(most_side, most_side).to_rgb8()
    } else {
        picture.to_rgb8()
    };
    let mut pen = Pen { canvas, scale };
    match reading {
        PhotoReading::Drum(bed) => pen.bed(bed, settings.definition),
        PhotoReading::Heap(heap) => pen.heap(heap),
        PhotoReading::Refused(refused) => pen.refused(refused),
    }
    pen.canvas
}

/// A picture with words on a black strip below it.
fn with_words(picture: &RgbImage, words: &str) -> RgbImage {
    let (width, height) = picture.dimensions();
    let size = (width / 320).max(2);
    let across = (width / size).saturating_sub(2) / 4;
    let lines = lines(words, usize::try_from(across).unwrap_or(usize::MAX));
    let rows = u32::try_from(lines.len()).unwrap_or(0);
    let strip = size * (ROW * rows + 2);
    let mut canvas = RgbImage::new(width, height + strip);
    image::imageops::replace(&mut canvas, picture, 0, 0);
    let mut pen = Pen { canvas, scale: 1.0 };
    let mut top = height;
    for line in lines {
        pen.text(&line, (top, size));
        top += size * ROW;
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
    /// The drum, the surface and the chosen line of its bed.
    fn bed(&mut self, bed: &DrumReading, definition: Definition) {
        self.circle(bed.drum, false);
        self.points(&bed.used, USED);
        self.points(&bed.rejected, REJECTED);
        let [from, to] = match definition {
            Definition::Line => bed.line_ends,
            Definition::Mid => bed.mid_ends,
            Definition::Chord => bed.chord_ends,
        };
        self.line(from, to, LINE);
        self.angle(bed.angle.by(definition));
    }

    /// The outline and the flanks of a heap.
    fn heap(&mut self, heap: &HeapReading) {
        self.points(&heap.used, USED);
        self.points(&heap.rejected, REJECTED);
        for [from, to] in heap.lines {
            self.line(from, to, LINE);
        }
        self.angle(heap.mean);
    }

    /// Draws the findings if nothing was measured.
    fn refused(&mut self, refused: &RefusedReading) {
        if let Some(drum) = refused.drum {
            self.circle(drum, false);
        }
        if let Some(circle) = refused.candidate {
            self.circle(circle, true);
        }
        self.points(&refused.boundary, REJECTED);
        if let Some([from, to]) = refused.line {
            self.line(from, to, REJECTED);
        }
    }

    /// Points of the picture.
    fn points(&mut self, points: &[PixelPoint], colour: Rgb<u8>) {
        for p in points {
            self.dot(*p, colour);
        }
    }

    /// An angle (rad) in the corner, degrees.
    fn angle(&mut self, angle: f64) {
        let degrees = angle.to_degrees();
        let size = self.canvas.width().max(200) / 200;
        self.text(&format!("{degrees:.2}\u{b0}"), (0, size));
    }

    /// A circle of the drum, in dashes where it is a guess.
    fn circle(&mut self, drum: DrumPixels, dashed: bool) {
        let n = 3000;
        for k in (0..n).filter(|k| !dashed || k % 50 < 30) {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(n)).sin_cos();
            let place = PixelPoint {
                x: drum.cx + drum.r * cos,
                y: drum.cy + drum.r * sin,
            };
            self.dot(place, DRUM);
        }
    }

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
    fn line(&mut self, from: PixelPoint, to: PixelPoint, colour: Rgb<u8>) {
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
                self.dot(place, colour);
            }
            k += 1.0;
        }
    }

    /// A line of text at the left border, on black; it begins at `top` and its dots have the edge `size`, px of the
    /// canvas.
    fn text(&mut self, text: &str, (top, size): (u32, u32)) {
        let [top, size] = [top, size].map(f64::from);
        let columns = text.chars().count() as f64 * 4.0 + 1.0;
        let mut block = |column: f64, row: f64, colour| {
            let mut k = 0.0;
            while k < size * size {
                let (dx, dy) = (k % size, (k / size).floor());
                self.paint(
                    (column + 1.0) * size + dx,
                    top + (row + 1.0) * size + dy,
                    colour,
                );
                k += 1.0;
            }
        };
        for k in 0..ROW {
            let mut column = 0.0;
            while column < columns {
                block(column, f64::from(k), Rgb([0, 0, 0]));
                column += 1.0;
            }
        }
        let shown = text.chars().enumerate();
        let shown = shown.filter_map(|(i, c)| Some((i, dots(c)?)));
        for (i, rows) in shown {
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
