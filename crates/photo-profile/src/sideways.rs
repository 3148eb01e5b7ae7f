//! Pictures of a series that lie on their side.

use crate::PhotoReading;
use std::cmp::Reverse;
use surface_profile::{HighSide, median};

/// An angle is the complement of another if both add up to 90 degrees within this, rad: 3 degrees, or three standard
/// deviations of the other pictures if these scatter more. Our choice: twice as much would begin to ask about beds of 42
/// degrees that stand high on the other side.
const TOLERANCE: f64 = 3.0 * std::f64::consts::PI / 180.0;
/// Standard deviations of the other pictures within which an angle is one of theirs.
const WITHIN_SD: f64 = 3.0;

/// Evidence of one picture of a series about how it was taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Posture {
    /// Pixels along x and y.
    size: [u32; 2],
    /// Angle of the bed of a drum, rad, and the side on which it stands higher; none if it was not measured.
    bed: Option<(f64, HighSide)>,
}

impl Posture {
    /// The posture of a picture of a size (px along x and y).
    pub fn new(size: [u32; 2], reading: &PhotoReading) -> Self {
        let bed = reading.angle().map(|angle| (angle.line, angle.high_side));
        Self { size, bed }
    }
}

/// The pictures of a series that seem to lie on their side, with what supports it in words; a picture is counted from 0.
///
/// A bed that is turned by 90 degrees shows 90 degrees less its angle and stands high on the other side, whichever way it is
/// turned, and its picture has width and height exchanged. Each of the two is compared with what most pictures show; of as many
/// pictures either way, the flatter beds and the first size count.
pub fn sideways(pictures: &[Posture]) -> Vec<(usize, String)> {
    let usual_bed = usual_bed(pictures);
    let usual_size = usual_size(pictures);
    let of_one = |posture: &Posture| -> Option<String> {
        if let (Some((angle, side)), Some(usual)) = (posture.bed, usual_bed) {
            let [a, u] = [angle, usual.angle].map(f64::to_degrees);
            if side == usual.side && (angle - usual.angle).abs() <= usual.tolerance {
                return None;
            }
            let complement = (angle + usual.angle - std::f64::consts::FRAC_PI_2).abs();
            if side != usual.side
                && complement <= usual.tolerance
                && (angle - usual.angle).abs() > usual.tolerance
            {
                return Some(format!(
                    "its {a:.1} degrees and the {u:.1} of the others add up to 90, and it is high on the other side"
                ));
            }
        }
        let [width, height] = posture.size;
        (width != height && usual_size == Some([height, width]))
            .then(|| format!("it has {width} by {height} px, and the others {height} by {width}"))
    };
    let all = pictures.iter().enumerate();
    all.filter_map(|(k, posture)| Some((k, of_one(posture)?)))
        .collect()
}

/// The bed that most pictures show.
#[derive(Debug, Clone, Copy)]
struct UsualBed {
    /// Median angle, rad.
    angle: f64,
    /// The side on which it stands higher.
    side: HighSide,
    /// How far an angle may lie from it, rad.
    tolerance: f64,
}

/// The bed that most pictures show.
fn usual_bed(pictures: &[Posture]) -> Option<UsualBed> {
    let of_side = |side: HighSide| {
        let beds = pictures.iter().filter_map(|posture| posture.bed);
        let mut angles: Vec<f64> = beds.filter(|bed| bed.1 == side).map(|bed| bed.0).collect();
        (!angles.is_empty()).then(|| {
            let angle = median(&mut angles);
            // A standard deviation by the median of the distances, which a few other pictures do not widen.
            let mut off: Vec<f64> = angles.iter().map(|a| (a - angle).abs()).collect();
            let tolerance = TOLERANCE.max(WITHIN_SD * 1.4826 * median(&mut off));
            let usual = UsualBed {
                angle,
                side,
                tolerance,
            };
            (angles.len(), usual)
        })
    };
    let sides = [HighSide::Left, HighSide::Right]
        .into_iter()
        .filter_map(of_side);
    sides
        .min_by(|a, b| {
            (Reverse(a.0), a.1.angle)
                .partial_cmp(&(Reverse(b.0), b.1.angle))
                .unwrap_or(std::cmp::Ordering::Equal)
        })
        .map(|(_, usual)| usual)
}

/// The size of most pictures, the first one of several that are as frequent.
fn usual_size(pictures: &[Posture]) -> Option<[u32; 2]> {
    let count = |size: [u32; 2]| pictures.iter().filter(|p| p.size == size).count();
    let sizes = pictures.iter().map(|p| p.size);
    // `min_by_key` gives the first of equals.
    sizes.min_by_key(|size| Reverse(count(*size)))
}

#[cfg(test)]
mod tests {
    use super::{Posture, sideways};
    use surface_profile::HighSide::{Left, Right};

    /// A picture of 600 by 400 px, or turned, with a bed at an angle in degrees.
    fn posture(turned: bool, bed: Option<(f64, surface_profile::HighSide)>) -> Posture {
        Posture {
            size: if turned { [400, 600] } else { [600, 400] },
            bed: bed.map(|(angle, side)| (angle.to_radians(), side)),
        }
    }

    /// The places of the pictures that are reported.
    fn found(pictures: &[Posture]) -> Vec<usize> {
        sideways(pictures).into_iter().map(|(k, _)| k).collect()
    }

    /// One of five lies on its side: by its angle and side, by its size if no bed is seen, and by both. With two pictures the
    /// steeper one is named. None is named among beds that scatter, in a drum that was also turned the other way, and if an
    /// upright picture was taken in another format.
    #[test]
    fn the_picture_on_its_side_is_named() {
        let upright = |angle| posture(false, Some((angle, Left)));
        let mut series = [34.0, 35.5, 34.6, 36.0, 35.1].map(upright);
        assert!(found(&series).is_empty());
        series[3] = posture(false, Some((55.4, Right)));
        assert_eq!(found(&series), [3]);
        series[3] = posture(true, None);
        assert_eq!(found(&series), [3]);
        series[3] = posture(true, Some((54.9, Right)));
        let told = sideways(&series);
        assert!(
            told.len() == 1 && told[0].1.contains("add up to 90"),
            "{told:?}"
        );
        assert_eq!(
            found(&[posture(false, Some((55.3, Right))), upright(34.7)]),
            [0]
        );
        series[3] = posture(true, Some((34.9, Left)));
        assert!(found(&series).is_empty(), "upright in another format");
        series[3] = posture(false, Some((35.2, Right)));
        assert!(found(&series).is_empty(), "turned the other way");
        series[3] = upright(55.3);
        assert!(found(&series).is_empty(), "a steep bed on the same side");
        assert!(found(&[]).is_empty());
    }
}
