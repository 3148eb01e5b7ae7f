//! Where a bed ends at the shell of its drum: toe and top.

use crate::{DrumCircle, Field};
use std::f64::consts::PI;

/// The ring on which the bed is followed, over the radius: within the seeds that touch the shell.
const RING: f64 = 0.92;
/// Steps along the ring, rad: a quarter of a degree.
const STEP: f64 = PI / 720.0;

/// Directions in which a bed ends at the shell, from straight down, counter-clockwise positive, rad: the clockwise and
/// the counter-clockwise end.
///
/// From the direction of the centroid of all cells above the level, the ring at 0.92 of the radius is followed either way
/// to the first place where the field falls below the level. `None` if the bed does not lie on the ring there, or if
/// it fills the ring.
pub fn shell_ends(field: &Field, level: f64, drum: &DrumCircle) -> Option<[f64; 2]> {
    let (mut x, mut y) = (0.0, 0.0);
    for (cell_x, cell_y, value) in field.cells() {
        let (dx, dy) = (cell_x - drum.x, cell_y - drum.y);
        if value > level && dx.hypot(dy) < drum.radius {
            x += dx;
            y += dy;
        }
    }
    let middle = x.atan2(-y);
    let at = |turn: f64| {
        let (sin, cos) = turn.sin_cos();
        let r = RING * drum.radius;
        field.at(drum.x + r * sin, drum.y - r * cos)
    };
    let end = |side: f64| {
        let mut before = at(middle);
        if before <= level {
            return None;
        }
        let mut turned = 0.0;
        while turned < 2.0 * PI {
            let value = at(middle + side * (turned + STEP));
            if value <= level {
                let part = (before - level) / (before - value);
                return Some(middle + side * (turned + STEP * part));
            }
            before = value;
            turned += STEP;
        }
        None
    };
    Some([end(-1.0)?, end(1.0)?])
}

#[cfg(test)]
mod tests {
    use super::shell_ends;
    use crate::{DrumCircle, Field, SurfacePoint};

    /// A sharp field of cells of 0.005 radii that is 1 where a condition holds.
    fn field(is_bed: impl Fn(f64, f64) -> bool) -> Field {
        let n = 401_usize;
        let place = |k: usize| -1.0 + 0.005 * k as f64;
        let values = (0..n * n)
            .map(|k| f32::from(u8::from(is_bed(place(k % n), place(k / n)))))
            .collect();
        Field::new(SurfacePoint { x: -1.0, y: -1.0 }, 0.005, n, values).expect("a field")
    }

    const DRUM: DrumCircle = DrumCircle {
        x: 0.0,
        y: 0.0,
        radius: 1.0,
    };

    /// A bed below a line at 30 degrees through a point 0.4 below the axis: the line meets the ring at the arc cosine of
    /// its distance over 0.92, 67.9 deg on either side of its normal. A cell is a third of a degree there.
    #[test]
    fn ends_of_a_half_plane_are_where_its_line_meets_the_ring() {
        let slope = 30_f64.to_radians();
        let distance = 0.4 * slope.cos();
        let bed = field(|x, y| -x * slope.sin() + y * slope.cos() < -distance && x.hypot(y) < 1.0);
        let half = (distance / 0.92).acos();
        let [low, high] = shell_ends(&bed, 0.5, &DRUM).expect("ends");
        for (got, expected) in [(low, slope - half), (high, slope + half)] {
            let error = (got - expected).to_degrees();
            assert!(error.abs() < 0.4, "{error} deg off");
        }
    }

    #[test]
    fn a_full_ring_and_an_empty_one_have_no_ends() {
        assert_eq!(
            shell_ends(&field(|x, y| x.hypot(y) < 1.0), 0.5, &DRUM),
            None
        );
        let lump = field(|x, y| x.hypot(y + 0.3) < 0.2);
        assert_eq!(shell_ends(&lump, 0.5, &DRUM), None);
    }
}
