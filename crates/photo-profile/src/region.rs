//! A part of the picture that alone is looked at.

use crate::{DrumPixels, Error, PhotoPixels, PhotoReading, PixelPoint, Settings};
use serde::{Deserialize, Serialize};

/// A rectangle of whole pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct PixelRegion {
    /// First column.
    pub left: u32,
    /// First row, from the top.
    pub top: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl PixelRegion {
    /// Refuses a rectangle without pixels, or with pixels outside a picture.
    pub(crate) fn check(self, picture: &PhotoPixels) -> Result<(), Error> {
        let ends = [
            u64::from(self.left) + u64::from(self.width),
            u64::from(self.top) + u64::from(self.height),
        ];
        let sizes = [picture.width() as u64, picture.height() as u64];
        let is_empty = self.width == 0 || self.height == 0;
        if is_empty || ends[0] > sizes[0] || ends[1] > sizes[1] {
            return Err(Error::BadRegion {
                region: self,
                width: sizes[0],
                height: sizes[1],
            });
        }
        Ok(())
    }

    /// Settings in the pixels of the part.
    pub(crate) fn settings(self, settings: &Settings) -> Settings {
        let [dx, dy] = self.corner();
        Settings {
            region: None,
            drum: settings.drum.map(|drum| moved_circle(drum, -dx, -dy)),
            ..*settings
        }
    }

    /// A reading of the part in the pixels of the whole picture.
    pub(crate) fn in_the_whole(self, reading: PhotoReading) -> PhotoReading {
        let [dx, dy] = self.corner();
        let point = |p: PixelPoint| PixelPoint {
            x: p.x + dx,
            y: p.y + dy,
        };
        let points = |points: Vec<PixelPoint>| points.into_iter().map(point).collect();
        let ends = |ends: Option<[PixelPoint; 2]>| ends.map(|ends| ends.map(point));
        let circle = |circle: Option<DrumPixels>| circle.map(|c| moved_circle(c, dx, dy));
        PhotoReading {
            drum: circle(reading.drum),
            used: points(reading.used),
            rejected: points(reading.rejected),
            glimpse: crate::Glimpse {
                circle: circle(reading.glimpse.circle),
                boundary: points(reading.glimpse.boundary),
                line: ends(reading.glimpse.line),
            },
            line_ends: ends(reading.line_ends),
            mid_ends: ends(reading.mid_ends),
            chord_ends: ends(reading.chord_ends),
            heap: reading.heap.map(|heap| crate::HeapReading {
                apex: point(heap.apex),
                lines: heap.lines.map(|line| line.map(point)),
                ..heap
            }),
            ..reading
        }
    }

    /// The first pixel, px.
    fn corner(self) -> [f64; 2] {
        [f64::from(self.left), f64::from(self.top)]
    }
}

/// A circle somewhere else.
fn moved_circle(circle: DrumPixels, dx: f64, dy: f64) -> DrumPixels {
    DrumPixels {
        cx: circle.cx + dx,
        cy: circle.cy + dy,
        r: circle.r,
    }
}
