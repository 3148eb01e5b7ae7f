//! The camera: blur, noise and whole grey levels.

use image::GrayImage;
use probability::random_stream::Stream;

/// Half width of the blur, standard deviations: what lies outside weighs 6e-5.
const HALF_WIDTH: f64 = 4.0;

/// Takes a picture as a camera does, grey levels row by row: blurs it, adds noise (both standard deviations, px and grey levels;
/// 0 for none) and rounds to whole grey levels.
pub(crate) fn taken(
    gray: &[f32],
    width: usize,
    (blur, noise): (f64, f64),
    random: &mut Stream,
) -> GrayImage {
    let height = gray.len() / width.max(1);
    let seen = if blur > 0.0 {
        blurred(gray, width, blur)
    } else {
        gray.iter().map(|v| f64::from(*v)).collect()
    };
    let noisy = seen
        .iter()
        .map(|v| to_level(v + noise * random.normal()))
        .collect();
    let side = |n: usize| u32::try_from(n).unwrap_or(0);
    GrayImage::from_raw(side(width), side(height), noisy).unwrap_or_default()
}

/// A picture under a Gaussian of a standard deviation (px), along rows and then along columns; beyond its border it continues as
/// at the border.
fn blurred(gray: &[f32], width: usize, sd: f64) -> Vec<f64> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "some pixels"
    )]
    let reach = (HALF_WIDTH * sd).ceil() as usize;
    let weight = |k: usize| (-0.5 * ((k as f64 - reach as f64) / sd).powi(2)).exp();
    let weights: Vec<f64> = (0..=2 * reach).map(weight).collect();
    let total: f64 = weights.iter().sum();
    let along = |line: &[f64], k: usize| -> f64 {
        let place = |j: usize| (k + j).saturating_sub(reach).min(line.len() - 1);
        let terms = weights.iter().enumerate().map(|(j, w)| w * line[place(j)]);
        terms.sum::<f64>() / total
    };
    let height = gray.len() / width;
    let mut rows = vec![0.0; gray.len()];
    for (row, out) in gray.chunks(width).zip(rows.chunks_mut(width)) {
        let row: Vec<f64> = row.iter().map(|v| f64::from(*v)).collect();
        for (k, value) in out.iter_mut().enumerate() {
            *value = along(&row, k);
        }
    }
    let mut all = vec![0.0; gray.len()];
    for column in 0..width {
        let line: Vec<f64> = (0..height).map(|y| rows[y * width + column]).collect();
        for y in 0..height {
            all[y * width + column] = along(&line, y);
        }
    }
    all
}

/// The grey level nearest to a value, 0 to 255.
pub(crate) fn to_level(value: f64) -> u8 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to 0..=255"
    )]
    let level = value.round().clamp(0.0, 255.0) as u8;
    level
}

/// A grey level as pictures hold it.
pub(crate) fn to_f32(value: f64) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "a picture holds f32")]
    let value = value as f32;
    value
}

#[cfg(test)]
mod tests {
    use super::blurred;

    /// An edge becomes the distribution function of the normal distribution: 0.5 at the edge, 0.159 and 0.841 one standard
    /// deviation beside it. Columns are pixels wide, so that the edge lies half a pixel from either middle; the cut of the
    /// kernel leaves 1e-4.
    #[test]
    fn an_edge_spreads_by_the_standard_deviation() {
        let (width, sd) = (61, 4.0);
        let row: Vec<f32> = (0..width).map(|x| if x < 30 { 0.0 } else { 1.0 }).collect();
        let picture = [row.clone(), row.clone(), row].concat();
        let seen = blurred(&picture, width, sd);
        let middle = width;
        assert!((seen[middle + 29] + seen[middle + 30] - 1.0).abs() < 1e-12);
        let between = |x: usize| 0.5 * (seen[middle + x - 1] + seen[middle + x]);
        assert!(
            (between(30 - 4) - 0.158_655).abs() < 2e-3,
            "{}",
            between(26)
        );
        assert!(
            (between(30 + 4) - 0.841_345).abs() < 2e-3,
            "{}",
            between(34)
        );
        assert!(seen[middle].abs() < 1e-9 && (seen[middle + 60] - 1.0).abs() < 1e-9);
    }
}
