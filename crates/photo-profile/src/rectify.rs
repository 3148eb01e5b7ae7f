//! Taking the perspective out of an oblique picture by four known corners.

use crate::{Error, PixelPoint};
use image::{DynamicImage, GrayImage, RgbImage};
use imageproc::geometric_transformations::{Border, Interpolation, Projection, warp_into};

/// Part of the square's side that is kept around it.
const MARGIN: f64 = 0.1;
/// Longer side of the result at most, px.
const MOST_SIDE: f64 = 2000.0;

/// The picture as seen straight on, by the corners of a square in the plane of the drum's end.
///
/// Corners in the order upper left, upper right, lower right, lower left; the result is
/// square, grey where the picture is, and holds a tenth of the side around the square.
///
/// # Formula
/// Homography `x = (a u + b v + c) / (g u + h v + 1)`, `y = (d u + e v + f) / (g u + h v + 1)`
/// through four pairs of points `[HartleyZisserman2004, section 4.1]`, bilinear samples.
///
/// # Errors
/// [`Error::BadCorners`] when the corners are not finite, not convex, or not in that order.
pub fn rectify(picture: &DynamicImage, corners: [PixelPoint; 4]) -> Result<DynamicImage, Error> {
    let bad = Error::BadCorners;
    let turn = |i: usize| {
        let (a, b, c) = (corners[i], corners[(i + 1) % 4], corners[(i + 2) % 4]);
        (b.x - a.x) * (c.y - b.y) - (b.y - a.y) * (c.x - b.x)
    };
    let edge = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % 4]);
        (b.x - a.x).hypot(b.y - a.y)
    };
    let longest = (0..4).map(edge).fold(0.0, f64::max);
    if !(longest.is_finite() && (0..4).all(|i| turn(i) > 1e-3 * longest * longest)) {
        return Err(bad);
    }
    let side = longest.min(MOST_SIDE / (1.0 + 2.0 * MARGIN));
    let (low, high) = (MARGIN * side, (1.0 + MARGIN) * side);
    let square = [(low, low), (high, low), (high, high), (low, high)];
    #[expect(clippy::cast_possible_truncation, reason = "pixels are f32 there")]
    let pair = |(x, y): (f64, f64)| (x as f32, y as f32);
    let projection =
        Projection::from_control_points(corners.map(|p| pair((p.x, p.y))), square.map(pair))
            .ok_or(bad)?;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "positive and at most MOST_SIDE"
    )]
    let size = ((side * (1.0 + 2.0 * MARGIN)).ceil() as u32).max(1);
    let way = Interpolation::Bilinear;
    Ok(if picture.color().has_color() {
        let mut straight = RgbImage::new(size, size);
        warp_into(
            &picture.to_rgb8(),
            projection,
            way,
            Border::Replicate,
            &mut straight,
        );
        straight.into()
    } else {
        let mut straight = GrayImage::new(size, size);
        warp_into(
            &picture.to_luma8(),
            projection,
            way,
            Border::Replicate,
            &mut straight,
        );
        straight.into()
    })
}
