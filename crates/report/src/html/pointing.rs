//! A picture whose places are pointed at, which gives the flags that state them.

use super::script::data_element;
use crate::escape::escaped;
use serde::Serialize;

/// Texts shown by pointing at places.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Pointed {
    /// A circle, by three or more places on it: `CX,CY,R`.
    Circle,
    /// Two places: `X,Y;X,Y`.
    Places,
    /// Five or more places on a line: `X,Y;X,Y;...`.
    Path,
    /// Two opposite corners of a rectangle of whole pixels: `LEFT,TOP,WIDTH,HEIGHT`.
    Rectangle,
    /// The four corners of a square seen in perspective, in any order, given clockwise from the upper left:
    /// `X,Y;X,Y;X,Y;X,Y`.
    Square,
}

/// One thing that can be pointed at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct PointingTool<'a> {
    /// The thing to point at.
    pub what: &'a str,
    /// The flag that states it.
    pub flag: &'a str,
    /// The text of each place.
    pub told: Pointed,
}

/// A picture to be pointed at.
#[derive(Debug, Clone, Copy)]
pub struct PointingPicture<'a> {
    /// The bytes of a PNG or JPEG file.
    pub bytes: &'a [u8],
    /// Text for readers who cannot see the picture.
    pub description: &'a str,
    /// Pixels along x and y of the picture in which the places are given; the one that is shown may be smaller. The centre of
    /// the first pixel is (0, 0), y down.
    pub size: [u32; 2],
    /// Tools for pointing.
    pub tools: &'a [PointingTool<'a>],
}

impl PointingPicture<'_> {
    /// The element that the script looks for, with the picture inside.
    pub(crate) fn markup(&self, image: &str) -> String {
        let [width, height] = self.size;
        let tools = data_element("pointing-data", &self.tools);
        let description = escaped(self.description);
        format!(
            "<div class=\"pointing\" data-width=\"{width}\" data-height=\"{height}\" data-what=\"{description}\">\
             <div class=\"pointed\">{image}</div>{tools}</div>"
        )
    }
}
