//! Taking the perspective out of an oblique picture by four known corners.

use crate::{Error, PixelPoint};
use image::{DynamicImage, GrayImage, Luma};
use nalgebra::{SMatrix, SVector};

/// Part of the square's side that is kept around it.
const MARGIN: f64 = 0.1;
/// Longer side of the result at most, px.
const MOST_SIDE: f64 = 2000.0;

/// The picture as seen straight on, by the corners of a square in the plane of the drum's end.
///
/// Corners in the order upper left, upper right, lower right, lower left; the result is grey,
/// square, and holds a tenth of the side around the square.
///
/// # Formula
/// Homography `x = (a u + b v + c) / (g u + h v + 1)`, `y = (d u + e v + f) / (g u + h v + 1)`
/// through four pairs of points `[HartleyZisserman2004, section 4.1]`, bilinear samples.
///
/// # Errors
/// [`Error::BadCorners`] when the corners are not finite, not convex, or not in that order.
pub fn rectify(picture: &DynamicImage, corners: [PixelPoint; 4]) -> Result<GrayImage, Error> {
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
    let map = homography(side, &corners).ok_or(bad)?;
    let source = crate::PhotoPixels::from_picture(picture);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "positive and at most MOST_SIDE"
    )]
    let size = (side * (1.0 + 2.0 * MARGIN)).ceil() as u32;
    Ok(GrayImage::from_fn(size.max(1), size.max(1), |i, j| {
        let (u, v) = (f64::from(i) - MARGIN * side, f64::from(j) - MARGIN * side);
        let scale = map[6] * u + map[7] * v + 1.0;
        let x = (map[0] * u + map[1] * v + map[2]) / scale;
        let y = (map[3] * u + map[4] * v + map[5]) / scale;
        Luma([crate::pixels::to_level(source.at(x, y))])
    }))
}

/// Coefficients a to h of the map from the square of this side to the corners.
fn homography(side: f64, corners: &[PixelPoint; 4]) -> Option<SVector<f64, 8>> {
    let square = [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)];
    let mut matrix = SMatrix::<f64, 8, 8>::zeros();
    let mut right = SVector::<f64, 8>::zeros();
    for (i, ((u, v), p)) in square.iter().zip(corners).enumerate() {
        let (u, v) = (*u, *v);
        let rows = [
            [u, v, 1.0, 0.0, 0.0, 0.0, -u * p.x, -v * p.x],
            [0.0, 0.0, 0.0, u, v, 1.0, -u * p.y, -v * p.y],
        ];
        for (k, row) in rows.iter().enumerate() {
            for (j, value) in row.iter().enumerate() {
                matrix[(2 * i + k, j)] = *value;
            }
        }
        right[2 * i] = p.x;
        right[2 * i + 1] = p.y;
    }
    matrix.lu().solve(&right)
}
