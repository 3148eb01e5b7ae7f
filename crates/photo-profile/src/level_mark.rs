//! The horizontal by a mark in the picture.

use crate::{Error, PixelPoint};

/// Shortest mark, px: two ends half a pixel off turn it by half a degree.
const SHORTEST: f64 = 80.0;
/// Error of an end of a mark across it, px of the picture, whose coordinates are read off at full size: one, our choice. Twice as much
/// doubles the error.
const END: f64 = 1.0;

/// Turn of the camera by two places on a plumb line, rad: the angle of the true horizontal in the picture, counter-clockwise
/// positive.
///
/// # Errors
/// [`Error::BadMark`] for places nearer than 80 px, and for a line more than 45 degrees off upright.
pub fn roll_by_plumb_line(places: [PixelPoint; 2]) -> Result<f64, Error> {
    let [a, b] = places;
    let (upper, lower) = if a.y <= b.y { (a, b) } else { (b, a) };
    roll(lower.y - upper.y, lower.x - upper.x)
}

/// Turn of the camera by two places of the same height, such as a bubble level or the edge of a table, rad: the angle of the
/// true horizontal in the picture, counter-clockwise positive.
///
/// # Errors
/// [`Error::BadMark`] for places nearer than 80 px, and for a line more than 45 degrees off level.
pub fn roll_by_level(places: [PixelPoint; 2]) -> Result<f64, Error> {
    let [a, b] = places;
    let (left, right) = if a.x <= b.x { (a, b) } else { (b, a) };
    roll(right.x - left.x, left.y - right.y)
}

/// Standard error of the turn that a mark gives, rad: both its ends err by one pixel across it.
///
/// # Formula
/// `sqrt(2) c / L` with the length L of the mark and the error c of its ends, 1 px of the picture.
pub fn mark_error(places: [PixelPoint; 2]) -> f64 {
    let [a, b] = places;
    std::f64::consts::SQRT_2 * END / (a.x - b.x).hypot(a.y - b.y)
}

/// Turn of a mark that runs `along` its direction in a picture that is level, and `aside`, px.
fn roll(along: f64, aside: f64) -> Result<f64, Error> {
    let length = along.hypot(aside);
    // Also what is not a number.
    if !(length.is_finite() && length >= SHORTEST && aside.abs() <= along) {
        return Err(Error::BadMark {
            length,
            least: SHORTEST,
        });
    }
    Ok(aside.atan2(along))
}

#[cfg(test)]
mod tests {
    use super::{roll_by_level, roll_by_plumb_line};
    use crate::PixelPoint;

    /// A mark of a picture that is turned by an angle about (300, 200), counter-clockwise as it is seen: the angle comes back,
    /// whichever end is named first, to rounding.
    #[test]
    fn a_turned_mark_gives_the_turn() {
        for turn in [-0.6_f64, -0.02, 0.0, 0.3] {
            let (sin, cos) = turn.sin_cos();
            let place = |x: f64, y: f64| PixelPoint {
                x: 300.0 + x * cos - y * sin,
                y: 200.0 - x * sin - y * cos,
            };
            let level = [place(-70.0, 40.0), place(90.0, 40.0)];
            let plumb = [place(15.0, 80.0), place(15.0, -60.0)];
            for (name, found) in [
                ("level", roll_by_level(level)),
                ("level", roll_by_level([level[1], level[0]])),
                ("plumb line", roll_by_plumb_line(plumb)),
                ("plumb line", roll_by_plumb_line([plumb[1], plumb[0]])),
            ] {
                let found = found.unwrap();
                assert!((found - turn).abs() < 1e-12, "{name}: {found} for {turn}");
            }
        }
    }

    /// A mark of a few pixels tells no angle, and one that lies is not a plumb line.
    #[test]
    fn a_mark_that_tells_no_horizontal_is_refused() {
        let places = |x: f64, y: f64| [PixelPoint { x: 0.0, y: 0.0 }, PixelPoint { x, y }];
        assert!(roll_by_plumb_line(places(0.0, 79.0)).is_err());
        assert!(roll_by_plumb_line(places(200.0, 100.0)).is_err());
        assert!(roll_by_level(places(100.0, 200.0)).is_err());
        assert!(roll_by_level(places(f64::NAN, 0.0)).is_err());
    }

    /// Ends of a mark of 100 px that err by a pixel each, drawn 4000 times, turn it by the stated error within 4 standard errors of
    /// a standard deviation of so many, 4.5 %.
    #[test]
    fn the_error_of_a_mark_is_that_of_its_ends() {
        let mut stream = probability::random_stream::Stream::new(5, "ends of a mark");
        let mut place = |x: f64| PixelPoint {
            x: x + stream.normal(),
            y: stream.normal(),
        };
        let rolls = (0..4000).map(|_| roll_by_level([place(0.0), place(100.0)]).unwrap());
        let squares: f64 = rolls.map(|roll| roll * roll).sum();
        let ends = [0.0, 100.0].map(|x| PixelPoint { x, y: 0.0 });
        let ratio = (squares / 4000.0).sqrt() / super::mark_error(ends);
        assert!((ratio - 1.0).abs() < 0.045, "{ratio}");
    }
}
