//! Where the seeds start: at random, without touching each other or a wall.

mod insertion;

use crate::{Apparatus, Error};
use dem_solver::Placement;
use geometry::clump::Clump;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use probability::random_stream::Stream;

/// Orientations tried at a place before it is left empty.
pub(crate) const TRIES: usize = 60;

/// Most seeds side by side across the apparatus: our choice, a hundred times the study's, far from a grid that cannot be
/// gone through.
const MOST_ACROSS: f64 = 3000.0;

/// A body's outline: all points within `radius` of a segment along its x axis.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Capsule {
    /// Half of the segment's length, m.
    half_length: f64,
    /// Radius, m.
    radius: f64,
}

/// A capsule in the apparatus.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Placed {
    /// Middle of the segment, m.
    centre: Vector3<f64>,
    /// Half of the segment, m.
    half: Vector3<f64>,
    /// Radius, m.
    radius: f64,
}

impl Capsule {
    /// The capsule about the x axis that holds all spheres of a body.
    pub(crate) fn around(clump: &Clump) -> Self {
        let spheres = clump.spheres().iter();
        let radius = spheres
            .clone()
            .map(|s| s.centre.yz().norm() + s.radius)
            .fold(0.0, f64::max);
        // Beyond the segment the capsule is a ball; each sphere must lie within it.
        let needed = |s: &geometry::clump::Sphere| {
            let free = radius - s.radius;
            let side = s.centre.yz().norm().min(free);
            s.centre.x.abs() - (free * free - side * side).sqrt()
        };
        let half_length = spheres.map(needed).fold(0.0, f64::max);
        Self {
            half_length,
            radius,
        }
    }

    /// Farthest reach from its middle, m.
    pub(crate) fn reach(&self) -> f64 {
        self.half_length + self.radius
    }

    /// Width across the longest axis, m.
    pub(crate) fn width(&self) -> f64 {
        2.0 * self.radius
    }

    /// Its volume, m³.
    fn volume(&self) -> f64 {
        let across = std::f64::consts::PI * self.radius * self.radius;
        across * (2.0 * self.half_length + 4.0 / 3.0 * self.radius)
    }

    /// The capsule of a body at a place (m), turned.
    pub(crate) fn at(&self, centre: Vector3<f64>, turn: &UnitQuaternion<f64>) -> Placed {
        Placed {
            centre,
            half: turn * Vector3::new(self.half_length, 0.0, 0.0),
            radius: self.radius,
        }
    }
}

impl Placed {
    /// Middle, m.
    pub(crate) fn centre(&self) -> Vector3<f64> {
        self.centre
    }
}

/// What leaves room for bodies.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Room<'a> {
    pub(crate) apparatus: &'a Apparatus,
    /// Triangles of further walls, m.
    pub(crate) obstacles: &'a [[Vector3<f64>; 3]],
}

/// Places `kinds[k].1` bodies of each kind `kinds[k].0`, in an order shuffled by the seed.
///
/// Places are the points of a cubic grid, filled from the bottom up, with a small random offset;
/// at each the orientation is drawn until the body is clear of walls and of bodies placed before.
/// The grid is made finer until all bodies have a place. If no grid has enough, as with bodies of unlike sizes, they are
/// inserted one after another at random places, the largest first, and shaken if they leave no room: by their capsules or,
/// if these are too large, as about flat bodies, by their spheres.
///
/// # Errors
///
/// More bodies than fit.
pub(crate) fn place(
    room: Room<'_>,
    kinds: &[(&Clump, usize)],
    seed: u64,
) -> Result<Vec<Placement>, Error> {
    let capsules: Vec<_> = kinds
        .iter()
        .map(|(clump, _)| Capsule::around(clump))
        .collect();
    let largest = capsules.iter().fold(0.0_f64, |m, c| m.max(c.reach()));
    let thickest = capsules.iter().fold(0.0_f64, |m, c| m.max(c.radius));
    let count: usize = kinds.iter().map(|k| k.1).sum();
    let [low, high] = room.apparatus.device().room();
    let across = (high - low).max() / (2.0 * thickest);
    if across.is_nan() || across > MOST_ACROSS {
        return Err(Error::BadValue {
            name: "size of the apparatus over that of the seeds".into(),
            value: format!("{across:.0}"),
            requirement: format!("at most {MOST_ACROSS}: take a smaller apparatus or larger seeds"),
        });
    }
    // At 2.5 radii the offsets of two round bodies cannot bring them together.
    let mut spacing = f64::max(2.0 * largest, 2.5 * thickest);
    let mut places = 0;
    while spacing > 2.0 * thickest {
        let mut stream = Stream::new(seed, "placement");
        let mut order: Vec<usize> = kinds
            .iter()
            .enumerate()
            .flat_map(|(k, kind)| std::iter::repeat_n(k, kind.1))
            .collect();
        stream.shuffle(&mut order);
        let placed = fill_grid(room, &capsules, &order, spacing, &mut stream);
        if placed.len() == count {
            return Ok(placed);
        }
        places = places.max(placed.len());
        spacing *= 0.97;
    }
    for outline in insertion::outlines(kinds) {
        let placed = insertion::insert(room, outline, kinds, seed);
        if placed.len() == count {
            return Ok(placed);
        }
        places = places.max(placed.len());
    }
    Err(Error::TooManySeeds { count, places })
}

/// Fills a grid of a given spacing (m) as far as it goes.
fn fill_grid(
    room: Room<'_>,
    capsules: &[Capsule],
    order: &[usize],
    spacing: f64,
    stream: &mut Stream,
) -> Vec<Placement> {
    let [low, high] = room.apparatus.device().room();
    let thin = capsules
        .iter()
        .map(|c| c.radius)
        .fold(f64::INFINITY, f64::min);
    let [across, up, along] = [0, 1, 2].map(|axis| {
        let middle = 0.5 * (low[axis] + high[axis]);
        let mut points = ticks(0.5 * (high[axis] - low[axis]) - thin, spacing);
        // A middle of 0 is left alone: adding it could change the sign of a zero.
        if middle != 0.0 {
            for point in &mut points {
                *point += middle;
            }
        }
        points
    });
    let mut placed: Vec<Placed> = Vec::new();
    let mut result = Vec::new();
    for &y in &up {
        for &x in &across {
            for &z in &along {
                let Some(&kind) = order.get(result.len()) else {
                    return result;
                };
                let capsule = capsules[kind];
                if room
                    .apparatus
                    .device()
                    .is_out_of_reach(x, y, capsule.radius)
                {
                    continue;
                }
                let at = Vector3::new(x, y, z);
                // Rows are filled from the bottom: only the last layers can be near.
                let reach = 3.0 * spacing;
                let layers = placed.iter().rev();
                let near: Vec<&Placed> = layers
                    .take_while(|p| p.centre.y > y - reach)
                    .filter(|p| (p.centre.x - x).abs() < reach && (p.centre.z - z).abs() < reach)
                    .collect();
                let beside = |stream: &mut Stream| {
                    at + Vector3::from_fn(|_, _| stream.between(-0.1, 0.1) * spacing)
                };
                let fits =
                    |body: &Placed, turn: &UnitQuaternion<f64>| if_free(room, body, turn, &near);
                if let Some((body, turn)) = try_place(capsule, beside, fits, stream) {
                    placed.push(body);
                    result.push(Placement::at_rest(kind, body.centre, turn));
                }
            }
        }
    }
    result
}

/// Draws places (m) and orientations until the body fits; returns the answer of `fits` for that one.
pub(crate) fn try_place<T>(
    capsule: Capsule,
    mut draw: impl FnMut(&mut Stream) -> Vector3<f64>,
    fits: impl Fn(&Placed, &UnitQuaternion<f64>) -> Option<T>,
    stream: &mut Stream,
) -> Option<T> {
    for _ in 0..TRIES {
        let centre = draw(stream);
        let [w, i, j, k] = stream.rotation();
        let turn = UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k));
        let body = capsule.at(centre, &turn);
        let found = fits(&body, &turn);
        if found.is_some() {
            return found;
        }
    }
    None
}

/// A capsule and its turn, if it is clear of all walls and of the capsules near it.
pub(crate) fn if_free(
    room: Room<'_>,
    body: &Placed,
    turn: &UnitQuaternion<f64>,
    near: &[&Placed],
) -> Option<(Placed, UnitQuaternion<f64>)> {
    let is_free = is_inside(room, body) && near.iter().all(|other| clear(body, other));
    is_free.then_some((*body, *turn))
}

/// Whether a capsule is clear of all walls.
fn is_inside(room: Room<'_>, body: &Placed) -> bool {
    let has_room = |point: &Vector3<f64>| room.apparatus.device().has_room(point, body.radius);
    // A ball has no ends.
    let ends_inside = || {
        let is_ball = body.half == Vector3::zeros();
        is_ball || (has_room(&(body.centre - body.half)) && has_room(&(body.centre + body.half)))
    };
    has_room(&body.centre) && ends_inside() && is_clear_of(room.obstacles, body)
}

/// Whether a capsule is clear of triangles: by balls along it, a half of its radius apart.
fn is_clear_of(obstacles: &[[Vector3<f64>; 3]], body: &Placed) -> bool {
    let length = body.half.norm();
    obstacles.iter().all(|corners| {
        let middle = geometry::triangle::nearest_on_triangle(&body.centre, corners) - body.centre;
        if middle.norm() > length + 2.0 * body.radius {
            return true;
        }
        let n = (2.0 * length / body.radius).ceil().max(1.0);
        let mut step = 0.0;
        while step <= n {
            let point = body.centre + body.half * (2.0 * step / n - 1.0);
            let gap = (geometry::triangle::nearest_on_triangle(&point, corners) - point).norm();
            // Between two balls the capsule is nearer by less than a sixteenth of its radius.
            if gap < 1.07 * body.radius {
                return false;
            }
            step += 1.0;
        }
        true
    })
}

/// Whether two capsules do not touch.
fn clear(a: &Placed, b: &Placed) -> bool {
    segment_distance(a, b) > a.radius + b.radius
}

/// Distance of the segments of two capsules, m (Ericson 2005, section 5.1.9).
fn segment_distance(a: &Placed, b: &Placed) -> f64 {
    let (d1, d2) = (a.half * 2.0, b.half * 2.0);
    let (p1, p2) = (a.centre - a.half, b.centre - b.half);
    let r = p1 - p2;
    let (aa, ee, f) = (d1.norm_squared(), d2.norm_squared(), d2.dot(&r));
    let tiny = 1e-18;
    let (s, t) = if aa <= tiny && ee <= tiny {
        (0.0, 0.0)
    } else if aa <= tiny {
        (0.0, (f / ee).clamp(0.0, 1.0))
    } else {
        let c = d1.dot(&r);
        if ee <= tiny {
            ((-c / aa).clamp(0.0, 1.0), 0.0)
        } else {
            let bb = d1.dot(&d2);
            let denominator = aa * ee - bb * bb;
            let s = if denominator > tiny * aa * ee {
                ((bb * f - c * ee) / denominator).clamp(0.0, 1.0)
            } else {
                0.0
            };
            let t = (bb * s + f) / ee;
            if t < 0.0 {
                ((-c / aa).clamp(0.0, 1.0), 0.0)
            } else if t > 1.0 {
                (((bb - c) / aa).clamp(0.0, 1.0), 1.0)
            } else {
                (s, t)
            }
        }
    };
    ((p1 + d1 * s) - (p2 + d2 * t)).norm()
}

/// Points of equal spacing, centred on 0, within `reach` (m), rising.
fn ticks(reach: f64, spacing: f64) -> Vec<f64> {
    if reach < 0.0 {
        return Vec::new();
    }
    #[expect(
        clippy::cast_possible_truncation,
        reason = "bounded by MOST_ACROSS: below 1e6"
    )]
    let n = (2.0 * reach / spacing).min(1e6) as i32 + 1;
    let start = -0.5 * spacing * f64::from(n - 1);
    (0..n).map(|i| start + spacing * f64::from(i)).collect()
}

#[cfg(test)]
mod tests {
    use super::{Placed, segment_distance};
    use nalgebra::Vector3;

    fn placed(centre: [f64; 3], half: [f64; 3]) -> Placed {
        Placed {
            centre: Vector3::from(centre),
            half: Vector3::from(half),
            radius: 0.1,
        }
    }

    /// Crossing, parallel, end-to-end and point-like segments with known distances.
    #[test]
    fn distance_of_segments_is_the_constructed_one() {
        let x = placed([0.0; 3], [1.0, 0.0, 0.0]);
        for (other, expected) in [
            (placed([0.0, 0.0, 2.0], [0.0, 1.0, 0.0]), 2.0),
            (placed([0.5, 3.0, 0.0], [1.0, 0.0, 0.0]), 3.0),
            (placed([4.0, 0.0, 0.0], [1.0, 0.0, 0.0]), 2.0),
            (placed([4.0, 4.0, 0.0], [0.0; 3]), 5.0),
            (placed([0.0, 0.5, 0.0], [0.0; 3]), 0.5),
        ] {
            let got = segment_distance(&x, &other);
            assert!((got - expected).abs() < 1e-12, "{other:?}: {got}");
            assert!(
                (segment_distance(&other, &x) - expected).abs() < 1e-12,
                "not symmetric"
            );
        }
    }
}
