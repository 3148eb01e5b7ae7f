//! The slope of a heap, read from its outline as a photo from the side would show it.

use crate::{Apparatus, ObservableValues};
use geometry::clump::Sphere;
use nalgebra::Vector3;

/// Shares of the height between which a whole flank is read: the foot is ragged and the top is round.
pub(crate) const FLANK: [f64; 2] = [0.2, 0.8];

/// The lower part of a flank.
const TOE: [f64; 2] = [0.1, 0.5];

/// The upper part of a flank.
const TOP: [f64; 2] = [0.5, 0.9];

/// A direction of looking: which coordinate runs to the right.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum View {
    /// x to the right, seen along z.
    AlongZ,
    /// z to the right, seen along x.
    AlongX,
}

/// Slope, height and extent of what lies in an apparatus at the end: spheres at rest, from here or from another code, in the frame
/// of the apparatus. The columns of the outline are half as wide as the radius of the largest seed, m.
pub fn read_pile(
    apparatus: &Apparatus,
    spheres: &[Sphere],
    largest_radius: f64,
) -> Vec<ObservableValues> {
    apparatus.device().read_pile(spheres, largest_radius)
}

/// Angle of all flanks, height and radius of a round heap, seen along z and x.
pub(crate) fn read_round_heap(spheres: &[Sphere], largest_radius: f64) -> Vec<ObservableValues> {
    let views = [View::AlongZ, View::AlongX].into_iter();
    let outlines: Vec<_> = views
        .filter_map(|view| Outline::of(spheres, view, 0.5 * largest_radius))
        .collect();
    let sides: Vec<_> = outlines
        .iter()
        .flat_map(|outline| [outline.clone(), outline.mirrored()])
        .collect();
    let flanks = sides.iter().filter_map(|side| side.right_flank(FLANK));
    let radii = sides.iter().map(|side| 1e3 * side.right_end()).collect();
    let height = outlines.first().map(|outline| 1e3 * outline.height());
    vec![
        ObservableValues::new(
            "angle_of_repose_deg",
            "deg",
            flanks.map(f64::to_degrees).collect(),
        ),
        ObservableValues::new("height_mm", "mm", height.into_iter().collect()),
        ObservableValues::new("base_radius_mm", "mm", radii),
    ]
}

/// Angles of the flank, its parts, and the extent of a heap that has run out to the right.
pub(crate) fn read_run_out(spheres: &[Sphere], largest_radius: f64) -> Vec<ObservableValues> {
    let outline = Outline::of(spheres, View::AlongZ, 0.5 * largest_radius);
    let angle = |part: [f64; 2]| {
        let angle = outline
            .as_ref()
            .and_then(|outline| outline.right_flank(part));
        angle.map(f64::to_degrees).into_iter().collect()
    };
    let length = |read: &dyn Fn(&Outline) -> f64| {
        let length = outline.as_ref().map(read);
        length.map(|length| 1e3 * length).into_iter().collect()
    };
    let mut all = vec![
        ObservableValues::new("angle_of_repose_deg", "deg", angle(FLANK)),
        ObservableValues::new("height_mm", "mm", length(&Outline::height)),
        ObservableValues::new("runout_mm", "mm", length(&Outline::right_end)),
    ];
    if outline.is_some() {
        let foot = |outline: &Outline| outline.right_foot(2.0 * largest_radius);
        all.push(ObservableValues::new("length_mm", "mm", length(&foot)));
        all.push(ObservableValues::new("toe_angle_deg", "deg", angle(TOE)));
        all.push(ObservableValues::new("top_angle_deg", "deg", angle(TOP)));
    }
    all
}

/// Upper outline: highest point of any sphere in columns of a width (m) from the left on.
#[derive(Debug, Clone)]
pub(crate) struct Outline {
    /// Left end of the first column, m.
    start: f64,
    /// Width of a column, m.
    width: f64,
    /// Heights, m; 0 in an empty column.
    heights: Vec<f64>,
}

impl Outline {
    /// The outline of spheres over the floor y = 0; `None` without spheres.
    pub(crate) fn of(spheres: &[Sphere], view: View, width: f64) -> Option<Self> {
        let across = |c: &Vector3<f64>| match view {
            View::AlongZ => c.x,
            View::AlongX => c.z,
        };
        let ends = |sign: f64| {
            spheres
                .iter()
                .map(move |s| sign * across(&s.centre) + s.radius)
        };
        let start = -ends(-1.0).fold(f64::NEG_INFINITY, f64::max);
        let end = ends(1.0).fold(f64::NEG_INFINITY, f64::max);
        if !(start.is_finite() && end > start) {
            return None;
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to a million columns"
        )]
        let column = |x: f64| ((x - start) / width).clamp(0.0, 1e6) as usize;
        let mut heights = vec![0.0_f64; column(end) + 1];
        for sphere in spheres {
            let x = across(&sphere.centre);
            let n = heights.len();
            let columns = column(x - sphere.radius)..=column(x + sphere.radius).min(n - 1);
            for (k, height) in heights
                .iter_mut()
                .enumerate()
                .take(columns.end() + 1)
                .skip(*columns.start())
            {
                let aside = (start + width * (k as f64 + 0.5) - x)
                    .abs()
                    .min(sphere.radius);
                let top = sphere.centre.y + (sphere.radius.powi(2) - aside * aside).sqrt();
                *height = height.max(top);
            }
        }
        Some(Self {
            start,
            width,
            heights,
        })
    }

    /// Height of the highest point, m.
    pub(crate) fn height(&self) -> f64 {
        self.heights.iter().copied().fold(0.0, f64::max)
    }

    /// Angle of the flank that falls to the right, rad: least squares through the columns right of the
    /// top between two shares of the height. None with fewer than five columns.
    pub(crate) fn right_flank(&self, [low, high]: [f64; 2]) -> Option<f64> {
        let height = self.height();
        let top = self.heights.iter().position(|h| *h >= height)?;
        let points: Vec<(f64, f64)> = (top..self.heights.len())
            .map(|k| (self.start + self.width * (k as f64 + 0.5), self.heights[k]))
            .skip_while(|p| p.1 > high * height)
            .take_while(|p| p.1 >= low * height)
            .collect();
        if points.len() < 5 {
            return None;
        }
        let n = points.len() as f64;
        let mean = |f: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / n;
        let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
        let slope = mean(&|p| (p.0 - x) * (p.1 - y)) / mean(&|p| (p.0 - x).powi(2));
        Some((-slope).atan())
    }

    /// Where seeds no longer lie on seeds, m: the first place beyond the top where the outline stays below one and a half
    /// diameters of a seed (m) over the width of one, or else the end of the outline. A second layer of spheres rises to 1.7
    /// diameters at least. What lies before it in a single layer has rolled ahead, the farther the smoother the floor.
    pub(crate) fn right_foot(&self, diameter: f64) -> f64 {
        let height = self.height();
        let top = self.heights.iter().position(|h| *h >= height).unwrap_or(0);
        let mut low = 0;
        for (k, height) in self.heights.iter().enumerate().skip(top) {
            low = if *height < 1.5 * diameter { low + 1 } else { 0 };
            if self.width * f64::from(low) >= diameter {
                return self.start + self.width * (k as f64 + 1.0 - f64::from(low));
            }
        }
        self.right_end()
    }

    /// The same outline seen from the other side.
    pub(crate) fn mirrored(&self) -> Self {
        let mut heights = self.heights.clone();
        heights.reverse();
        Self {
            start: -(self.start + self.width * self.heights.len() as f64),
            heights,
            ..*self
        }
    }

    /// Where the outline ends on the right, at half a percent of the height, m.
    pub(crate) fn right_end(&self) -> f64 {
        self.start + self.width * self.heights.len() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::{FLANK, Outline, TOE, TOP, View};
    use geometry::clump::Sphere;
    use nalgebra::Vector3;

    /// Small spheres on a cone of 30 degrees: both flanks in both views read 30 degrees; half a degree
    /// is the roughness of spheres of a fortieth of the height.
    #[test]
    fn flanks_of_a_cone_have_its_angle() {
        let slope = 30_f64.to_radians().tan();
        let mut spheres = Vec::new();
        for i in -60..=60_i32 {
            for j in -60..=60_i32 {
                let (x, z) = (f64::from(i) * 1e-3, f64::from(j) * 1e-3);
                let y = 0.04 * slope - slope * x.hypot(z);
                if y > 0.0 {
                    spheres.push(Sphere {
                        centre: Vector3::new(x, y, z),
                        radius: 0.6e-3,
                    });
                }
            }
        }
        for view in [View::AlongX, View::AlongZ] {
            let outline = Outline::of(&spheres, view, 1e-3).unwrap();
            for outline in [outline.mirrored(), outline] {
                let angle = outline.right_flank(FLANK).unwrap().to_degrees();
                assert!((angle - 30.0).abs() < 0.5, "{view:?}: {angle} deg");
            }
        }
    }

    /// A row of spheres on two lines, of 25 degrees above the middle of the height and of 12 below it: each part
    /// reads its own. Half a degree is the roughness of the spheres; read over the whole flank it would be 18.
    #[test]
    fn foot_and_top_of_a_hollow_flank_have_their_own_angles() {
        let (steep, flat) = (25_f64.to_radians().tan(), 12_f64.to_radians().tan());
        let middle = 0.05 / steep;
        let on_line = |i: i32| {
            let x = f64::from(i) * 1e-3;
            let y = if x < middle {
                0.1 - steep * x
            } else {
                0.05 - flat * (x - middle)
            };
            (y > 0.0).then(|| Sphere {
                centre: Vector3::new(x, y, 0.0),
                radius: 0.6e-3,
            })
        };
        let spheres: Vec<_> = (0..400).filter_map(on_line).collect();
        let outline = Outline::of(&spheres, View::AlongZ, 1e-3).unwrap();
        for (part, expected) in [(TOP, 25.0), (TOE, 12.0)] {
            let angle = outline.right_flank(part).unwrap().to_degrees();
            assert!((angle - expected).abs() < 0.5, "{part:?}: {angle} deg");
        }
    }

    /// Two layers of touching spheres of 2 mm, the lower up to 30 mm and the upper up to 19.8 mm, with a hollow of one sphere's
    /// half in it, and two spheres far ahead: the deposit ends with the upper layer, to a column of 0.5 mm, though the
    /// outline continues. A heap that ends at a wall ends there.
    #[test]
    fn a_deposit_ends_where_seeds_no_longer_lie_on_seeds() {
        let at = |x: f64, y: f64| Sphere {
            centre: Vector3::new(x, y, 0.0),
            radius: 1e-3,
        };
        let lower = (0..15).map(|i| at(1e-3 + 2e-3 * f64::from(i), 1e-3));
        let upper = [1.0, 2.8, 4.8, 6.8, 9.8, 12.8, 14.8, 16.8, 18.8].map(|x| at(1e-3 * x, 3e-3));
        let ahead = [0.060, 0.0798].map(|x| at(x, 1e-3));
        let spheres: Vec<_> = upper.into_iter().chain(lower).chain(ahead).collect();
        let outline = Outline::of(&spheres, View::AlongZ, 0.5e-3).unwrap();
        let (foot, end) = (outline.right_foot(2e-3), outline.right_end());
        assert!((foot - 0.0198).abs() <= 0.5e-3, "foot at {foot} m");
        assert!((end - 0.0808).abs() <= 0.5e-3, "end at {end} m");
        let walled = Outline::of(&spheres[..9], View::AlongZ, 0.5e-3).unwrap();
        assert_eq!(walled.right_foot(2e-3), walled.right_end(), "wall");
    }

    #[test]
    fn a_single_sphere_has_no_flank() {
        let sphere = Sphere {
            centre: Vector3::new(0.0, 1e-3, 0.0),
            radius: 1e-3,
        };
        let outline = Outline::of(&[sphere], View::AlongZ, 1e-3).unwrap();
        assert!(outline.right_flank(FLANK).is_none());
        assert!(Outline::of(&[], View::AlongZ, 1e-3).is_none());
    }
}
