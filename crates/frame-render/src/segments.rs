//! Smooth line segments over a drum picture.

use image::RgbImage;

use crate::Error;
use crate::colour::mixed;
use crate::drum_view::{DrumProjection, DrumView, PixelPoint};

/// Half the width of a drawn line, pixels.
const HALF_WIDTH: f64 = 0.9;

/// Draws segments given by x and y of both ends in m, for instance walls seen end-on.
///
/// Lines are 1.8 pixels wide with smooth edges and rounded ends. The picture may be larger or
/// smaller than the view's; what lies outside is cut.
///
/// # Errors
/// [`Error::InvalidCoordinate`] for an end that is not finite, and the errors of
/// [`DrumView::projection`]; the picture is then unchanged.
pub fn draw_segments(
    picture: &mut RgbImage,
    view: &DrumView,
    segments: &[[[f64; 2]; 2]],
    colour: [u8; 3],
) -> Result<(), Error> {
    let projection = view.projection()?;
    for (index, segment) in segments.iter().enumerate() {
        if let Some(&value) = segment
            .as_flattened()
            .iter()
            .find(|value| !value.is_finite())
        {
            return Err(Error::InvalidCoordinate {
                what: "segment",
                index,
                value,
            });
        }
    }
    for segment in segments {
        draw_segment(picture, &projection, segment, colour);
    }
    Ok(())
}

/// Draws one segment.
fn draw_segment(
    picture: &mut RgbImage,
    projection: &DrumProjection,
    segment: &[[f64; 2]; 2],
    colour: [u8; 3],
) {
    let [start, end] = segment.map(|point| projection.pixel_from_metre(point));
    let reach = HALF_WIDTH + 0.5;
    let columns = pixel_range(start.column, end.column, reach, picture.width());
    let rows = pixel_range(start.row, end.row, reach, picture.height());
    for row in rows {
        for column in columns.clone() {
            let place = PixelPoint {
                column: f64::from(column),
                row: f64::from(row),
            };
            let share = (reach - distance_to_segment(place, start, end)).clamp(0.0, 1.0);
            if share > 0.0 {
                let pixel = picture.get_pixel_mut(column, row);
                *pixel = mixed(pixel.0, colour, share);
            }
        }
    }
}

/// Pixels from one end to the other and a little beyond, cut to the picture.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped to the picture just before"
)]
fn pixel_range(one: f64, other: f64, reach: f64, pixels: u32) -> std::ops::Range<u32> {
    let end = f64::from(pixels);
    let first = (one.min(other) - reach).floor().clamp(0.0, end) as u32;
    let past = ((one.max(other) + reach).ceil() + 1.0).clamp(0.0, end) as u32;
    first..past
}

/// Distance of a place from a segment, pixels.
fn distance_to_segment(place: PixelPoint, start: PixelPoint, end: PixelPoint) -> f64 {
    let along = [end.column - start.column, end.row - start.row];
    let from_start = [place.column - start.column, place.row - start.row];
    let length_squared = along[0] * along[0] + along[1] * along[1];
    let share = if length_squared > 0.0 {
        let projected = from_start[0] * along[0] + from_start[1] * along[1];
        (projected / length_squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (from_start[0] - share * along[0]).hypot(from_start[1] - share * along[1])
}
