//! The colours of a picture and how a colour is darkened.

use image::Rgb;

/// Lit back cover of the drum: luma about 215.
pub const BACKGROUND_COLOUR: [u8; 3] = [218, 215, 208];
/// Room around the drum: luma about 20.
pub const OUTSIDE_COLOUR: [u8; 3] = [20, 20, 22];
/// Front face of the drum wall.
pub const RIM_COLOUR: [u8; 3] = [92, 96, 102];

/// Walls of triangles: blue, to distinguish them from seeds and covers.
pub(crate) const WALL_COLOUR: [u8; 3] = [70, 110, 165];

/// Mean colour of a seed coat, luma 110.
const SEED_COLOUR: [f64; 3] = [124.0, 108.0, 90.0];
/// Largest relative departure of one seed's colour from the mean.
const SEED_COLOUR_SPREAD: f64 = 0.07;

/// Dark brown of a seed, slightly different from seed to seed so that neighbours can be distinguished.
///
/// Luma is 102 to 118 before shading and therefore 41 to 118 in a drum picture; the background
/// has 215. The colour depends on the number of the seed only.
pub fn seed_colour(index: usize) -> [u8; 3] {
    // Multiples of the golden section fill [0, 1) evenly, so neighbours differ.
    let fraction = (index as f64 * 0.618_033_988_749_895).fract();
    let factor = 1.0 + SEED_COLOUR_SPREAD * (2.0 * fraction - 1.0);
    SEED_COLOUR.map(|channel| channel_from(channel * factor))
}

/// A colour made darker by a factor in [0, 1].
pub(crate) fn shaded(colour: [u8; 3], factor: f64) -> Rgb<u8> {
    Rgb(colour.map(|channel| channel_from(f64::from(channel) * factor)))
}

/// Mixture of two colours, `share` of the upper one in [0, 1].
pub(crate) fn mixed(lower: [u8; 3], upper: [u8; 3], share: f64) -> Rgb<u8> {
    let mut result = [0; 3];
    for ((mixture, below), above) in result.iter_mut().zip(lower).zip(upper) {
        *mixture = channel_from(f64::from(below) * (1.0 - share) + f64::from(above) * share);
    }
    Rgb(result)
}

/// Nearest 8-bit channel value.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped to 0..=255 just before"
)]
pub(crate) fn channel_from(value: f64) -> u8 {
    (value + 0.5).clamp(0.0, 255.0) as u8
}
