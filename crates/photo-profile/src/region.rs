//! A part of the picture that alone is looked at.

use crate::{
    DrumPixels, DrumReading, Error, HeapReading, PhotoPixels, PhotoReading, PixelPoint,
    RefusedReading, Settings,
};
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
        let ends = |ends: [PixelPoint; 2]| ends.map(point);
        let circle = |c: DrumPixels| moved_circle(c, dx, dy);
        match reading {
            PhotoReading::Drum(bed) => PhotoReading::Drum(DrumReading {
                drum: circle(bed.drum),
                used: points(bed.used),
                rejected: points(bed.rejected),
                line_ends: ends(bed.line_ends),
                mid_ends: ends(bed.mid_ends),
                chord_ends: ends(bed.chord_ends),
                ..bed
            }),
            PhotoReading::Heap(heap) => PhotoReading::Heap(HeapReading {
                used: points(heap.used),
                rejected: points(heap.rejected),
                apex: point(heap.apex),
                lines: heap.lines.map(ends),
                ..heap
            }),
            PhotoReading::Refused(refused) => PhotoReading::Refused(RefusedReading {
                drum: refused.drum.map(circle),
                candidate: refused.candidate.map(circle),
                boundary: points(refused.boundary),
                line: refused.line.map(ends),
                ..refused
            }),
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
