//! Which channel of a colour picture separates bed from air.

use crate::pixels::to_f32;
use crate::tone::straight_sides;
use crate::view::DiscView;
use crate::{DrumPixels, Foreground, PhotoPixels, Settings};
use nalgebra::{Matrix3, Vector3};
use serde::Serialize;

/// Weights of the luminance on stored values, ITU-R BT.709.
const LUMA: [f64; 3] = [0.2126, 0.7152, 0.0722];
/// Standard deviation that the noise of any camera is taken for at least, levels.
const NOISE: f64 = 4.0;
/// The luminance is kept where bed and air lie so many standard deviations apart in it.
const CLEAR: f64 = 4.0;
/// A channel is taken instead only where bed and air lie at least so many standard deviations apart in it.
const LEAST: f64 = 2.0;
/// Part of the best squared distance from which on the luminance is good enough, and a single channel.
const GOOD_ENOUGH: [f64; 2] = [0.5, 0.8];

/// Source of the grey level of a measurement.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Channel {
    /// The luminance, which is all that a grey picture has.
    #[default]
    Luma,
    /// Red alone.
    Red,
    /// Green alone.
    Green,
    /// Blue alone.
    Blue,
    /// The largest of red, green and blue less the smallest.
    Saturation,
    /// A sum of red, green and blue with these weights, whose sizes add up to 1.
    Sum([f64; 3]),
}

impl std::fmt::Display for Channel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Luma => f.write_str("luma"),
            Self::Red => f.write_str("red"),
            Self::Green => f.write_str("green"),
            Self::Blue => f.write_str("blue"),
            Self::Saturation => f.write_str("saturation"),
            Self::Sum([r, g, b]) => write!(f, "{r:.2} red {g:+.2} green {b:+.2} blue"),
        }
    }
}

impl Channel {
    /// All but the luminance in which a circle is looked for.
    pub(crate) const COLOURS: [Self; 4] = [Self::Red, Self::Green, Self::Blue, Self::Saturation];

    /// The level of a colour, 0 to 255; of a sum, -255 to 255.
    pub(crate) fn of(self, colour: [f64; 3]) -> f64 {
        let [r, g, b] = colour;
        let sum = |w: [f64; 3]| w[0] * r + w[1] * g + w[2] * b;
        match self {
            Self::Luma => sum(LUMA),
            Self::Red => r,
            Self::Green => g,
            Self::Blue => b,
            Self::Saturation => r.max(g).max(b) - r.min(g).min(b),
            Self::Sum(weights) => sum(weights),
        }
    }

    /// Standard deviation of the channel where each colour has noise of one level.
    fn noise(self) -> f64 {
        let size = |w: [f64; 3]| (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]).sqrt();
        match self {
            Self::Luma => size(LUMA),
            Self::Red | Self::Green | Self::Blue => 1.0,
            Self::Saturation => std::f64::consts::SQRT_2,
            Self::Sum(weights) => size(weights),
        }
    }

    /// Squared distance of two groups of colours in standard deviations.
    fn distance(self, groups: &[Vec<[f64; 3]>; 2]) -> f64 {
        let moments = |group: &[[f64; 3]]| {
            let n = group.len().max(1) as f64;
            let mean = group.iter().map(|c| self.of(*c)).sum::<f64>() / n;
            let square = |c: &[f64; 3]| (self.of(*c) - mean).powi(2);
            (mean, group.iter().map(square).sum::<f64>() / n)
        };
        let ((one, a), (other, b)) = (moments(&groups[0]), moments(&groups[1]));
        (one - other).powi(2) / (0.5 * (a + b) + (NOISE * self.noise()).powi(2))
    }
}

/// The channel in which two groups of colours lie farthest apart.
///
/// # Formula
/// The squared distance of two groups in a channel is `J = (m1 - m2)^2 / ((v1 + v2) / 2 + s^2)`, with their means and
/// variances and the noise s of a camera. The sum of channels with the largest J has the weights
/// `((V1 + V2) / 2 + s^2 I)^-1 (m1 - m2)` `[Fisher1936]`. The luminance is kept where it reaches `J = 16`, or half of the
/// best J, or if no channel reaches 4; then a channel alone that reaches 0.8 of the best is taken, and then the sum.
///
/// Where the caller says which tone the bed has, only channels count that have one.
pub(crate) fn separating(groups: &[Vec<[f64; 3]>; 2], foreground: Foreground) -> Channel {
    let luma = Channel::Luma.distance(groups);
    if groups.iter().any(Vec::is_empty) || luma >= CLEAR * CLEAR {
        return Channel::Luma;
    }
    let single = Channel::COLOURS.map(|channel| (channel, channel.distance(groups)));
    let single = single
        .into_iter()
        .filter(|(c, _)| foreground == Foreground::Auto || *c != Channel::Saturation)
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or((Channel::Luma, luma));
    let sum = best_sum(groups).filter(|_| foreground == Foreground::Auto);
    let sum = sum.map_or(single, |sum| (sum, sum.distance(groups)));
    let best = single.1.max(sum.1);
    let [luma_part, single_part] = GOOD_ENOUGH;
    if best < LEAST * LEAST || luma >= luma_part * best {
        Channel::Luma
    } else if single.1 >= single_part * best {
        single.0
    } else {
        sum.0
    }
}

/// The sum of channels in which two groups lie farthest apart.
fn best_sum(groups: &[Vec<[f64; 3]>; 2]) -> Option<Channel> {
    let moments = |group: &[[f64; 3]]| {
        let n = group.len().max(1) as f64;
        let colours = group.iter().map(|c| Vector3::from(*c));
        let mean = colours.clone().sum::<Vector3<f64>>() / n;
        let square = |c: Vector3<f64>| (c - mean) * (c - mean).transpose();
        (mean, colours.map(square).sum::<Matrix3<f64>>() / n)
    };
    let ((one, a), (other, b)) = (moments(&groups[0]), moments(&groups[1]));
    let within = 0.5 * (a + b) + Matrix3::identity() * NOISE.powi(2);
    let weights = within.cholesky()?.solve(&(one - other));
    let size = weights.abs().sum();
    let weights = weights / size;
    weights
        .iter()
        .all(|w| w.is_finite())
        .then_some(Channel::Sum([weights[0], weights[1], weights[2]]))
}

/// The channel in which the two sides of a drum lie farthest apart: of the straight cuts that tell most about each channel
/// the one that tells most of all.
pub(crate) fn channel_of_disc(
    picture: &PhotoPixels,
    drum: DrumPixels,
    settings: &Settings,
) -> Channel {
    if !picture.has_colour() {
        return Channel::Luma;
    }
    let view = |channel| DiscView::new(&picture.channel(channel), drum, settings.camera_roll);
    let views = [Channel::Red, Channel::Green, Channel::Blue].map(view);
    let colour = |k: usize| [0, 1, 2].map(|c: usize| f64::from(views[c].gray.values()[k]));
    let [first, ..] = &views;
    let planes = [Channel::Luma].into_iter().chain(Channel::COLOURS);
    let sides = planes.filter_map(|channel| {
        let levels = (0..first.inside.len()).map(|k| to_f32(channel.of(colour(k))));
        straight_sides(first, &levels.collect::<Vec<f32>>())
    });
    let best = sides.max_by(|a, b| a.information.total_cmp(&b.information));
    best.map_or(Channel::Luma, |sides| {
        let colours = |cells: &[usize]| cells.iter().map(|k| colour(*k)).collect();
        let groups = [colours(&sides.below), colours(&sides.above)];
        separating(&groups, settings.foreground)
    })
}

/// The channel in which what differs from the sky, the first `n_sky` pixels, lies farthest from it.
///
/// The pixels are parted by the distance of their colour from the median colour of the sky.
pub(crate) fn channel_below_sky(
    picture: &PhotoPixels,
    n_sky: usize,
    settings: &Settings,
) -> Channel {
    if !picture.has_colour() {
        return Channel::Luma;
    }
    let planes = [Channel::Red, Channel::Green, Channel::Blue].map(|c| picture.channel(c));
    let n = planes[0].values().len();
    let colour = |k: usize| [0, 1, 2].map(|c: usize| f64::from(planes[c].values()[k]));
    let sky = [0, 1, 2].map(|c: usize| {
        let sky = planes[c].values().iter().take(n_sky);
        surface_profile::median(&mut sky.map(|v| f64::from(*v)).collect::<Vec<f64>>())
    });
    let off = |k: usize| {
        let c = colour(k);
        (c[0] - sky[0]).hypot(c[1] - sky[1]).hypot(c[2] - sky[2])
    };
    let mut histogram = [0_u64; 256];
    for k in 0..n {
        histogram[usize::from(crate::pixels::to_level(off(k)))] += 1;
    }
    let Some(threshold) = crate::otsu_threshold(&histogram) else {
        return Channel::Luma;
    };
    let (bed, air): (Vec<usize>, Vec<usize>) = (0..n).partition(|k| off(*k) > threshold);
    let groups = [bed, air].map(|cells| cells.into_iter().map(colour).collect());
    separating(&groups, settings.foreground)
}

#[cfg(test)]
mod tests {
    use super::{Channel, separating};
    use crate::Foreground;

    /// Colours about a middle with the same spread along the grey diagonal, as light and shade give it.
    fn shaded(middle: [f64; 3]) -> Vec<[f64; 3]> {
        (-20..=20)
            .map(|k| middle.map(|m| m + f64::from(k)))
            .collect()
    }

    /// Light and shade move all channels alike; only a difference of channels is free of them. Its weights then add up to
    /// about 0: the noise of 4 levels beside a spread of 12 leaves a few hundredths.
    #[test]
    fn a_difference_of_hue_under_uneven_light_is_told_by_a_difference_of_channels() {
        let groups = [shaded([120.0, 90.0, 100.0]), shaded([90.0, 120.0, 100.0])];
        let Channel::Sum(weights) = separating(&groups, Foreground::Auto) else {
            panic!("a sum of channels")
        };
        assert!(weights.iter().sum::<f64>().abs() < 0.05, "{weights:?}");
        assert!(weights[0] * weights[1] < 0.0, "{weights:?}");
    }

    /// Blue of 60 against black is 4 levels of luminance.
    #[test]
    fn blue_on_black_is_told_by_blue_and_grey_by_luma() {
        let plain = |colour: [f64; 3]| vec![colour; 9];
        let blue = [plain([3.0, 3.0, 60.0]), plain([3.0, 3.0, 3.0])];
        assert_eq!(separating(&blue, Foreground::Auto), Channel::Blue);
        let grey = [plain([90.0; 3]), plain([60.0; 3])];
        assert_eq!(separating(&grey, Foreground::Auto), Channel::Luma);
        let alike = [plain([60.0, 61.0, 63.0]), plain([60.0; 3])];
        assert_eq!(separating(&alike, Foreground::Auto), Channel::Luma);
    }
}
