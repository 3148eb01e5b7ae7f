//! Places where a surface cuts itself.

use crate::BoundingBox;
use crate::winding::solid_angle_sum;
use geometry::triangle::area_vector;
use nalgebra::Vector3;

/// Triangles that are compared all with all; 16 to 64 take about equally long.
const LEAF: usize = 32;

/// Comparisons per triangle after which the search ends unfinished.
///
/// A scan takes about 30. Thousands of needles through one point take a number that grows with
/// the square of theirs.
const MOST_COMPARISONS: usize = 500;

/// Part of the cube of the triangles' size below which a volume has no certain sign.
const ROUNDING: f64 = 1e-13;

/// Solid angles that are summed where triangles cross: about two seconds.
const SOLID_ANGLES: usize = 100_000_000;

/// Fewest and most points of a surface that are looked at.
const FEWEST_POINTS: usize = 100;
/// See [`FEWEST_POINTS`].
const MOST_POINTS: usize = 1000;

/// Where a surface cuts itself.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Crossings {
    /// Pairs of triangles without a common vertex of which one pierces the other.
    pub(crate) pairs: Vec<[u32; 2]>,
    /// A point where the first pair cross, m.
    pub(crate) first: Option<Vector3<f64>>,
    /// Share of the area that does not part inside from outside.
    pub(crate) folded: f64,
    /// Whether the comparisons ran out before all pairs were looked at.
    pub(crate) unfinished: bool,
}

impl Crossings {
    /// Finds the pairs of triangles that cross; those that lie in one plane or share a vertex are
    /// not looked at.
    pub(crate) fn new(vertices: &[Vector3<f64>], triangles: &[[usize; 3]]) -> Self {
        let mut search = Search {
            vertices,
            triangles,
            boxes: rough_boxes(vertices, triangles),
            left: MOST_COMPARISONS * triangles.len() + 1_000_000,
            found: Vec::new(),
        };
        #[expect(
            clippy::cast_possible_truncation,
            reason = "the number of triangles is limited"
        )]
        search.split((0..triangles.len() as u32).collect());
        let unfinished = search.left == 0;
        let mut found = search.found;
        found.sort_by_key(|crossing| crossing.pair);
        // A pair that lies on both sides of a cut is met twice.
        found.dedup_by_key(|crossing| crossing.pair);
        Self {
            first: found.first().map(|crossing| crossing.point),
            folded: if found.is_empty() {
                0.0
            } else {
                folded_share(vertices, triangles)
            },
            unfinished,
            pairs: found.into_iter().map(|crossing| crossing.pair).collect(),
        }
    }
}

/// Two triangles that cross.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    /// The triangles, rising.
    pair: [u32; 2],
    /// Where an edge of one pierces the other, m.
    point: Vector3<f64>,
}

/// Box of a triangle as parts of the extent of all: lowest coordinates, then highest.
type RoughBox = [f32; 6];

/// State of the search.
struct Search<'a> {
    vertices: &'a [Vector3<f64>],
    triangles: &'a [[usize; 3]],
    boxes: Vec<RoughBox>,
    /// Comparisons left.
    left: usize,
    found: Vec<Crossing>,
}

impl Search<'_> {
    /// Looks for crossings within a set, halving space until the set is small.
    ///
    /// Triangles on the cut go to both sides: two whose boxes meet are so together on one of them.
    fn split(&mut self, set: Vec<u32>) {
        if set.len() <= LEAF || self.left == 0 {
            return self.compare_all(&set);
        }
        let boxes = &self.boxes;
        let middle = |t: u32, axis: usize| {
            let b = &boxes[t as usize];
            b[axis] + b[axis + 3]
        };
        // A part of the set tells where it is widest and where its middle lies.
        let told: Vec<u32> = set.iter().copied().step_by(set.len() / LEAF).collect();
        let extent = |axis: usize| {
            let ends = told.iter().map(|&t| middle(t, axis));
            let (low, high) = ends.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), m| {
                (low.min(m), high.max(m))
            });
            high - low
        };
        let extents = [0, 1, 2].map(extent);
        let axis = (0..3)
            .max_by(|&a, &b| extents[a].total_cmp(&extents[b]))
            .unwrap_or(0);
        let mut middles: Vec<f32> = told.iter().map(|&t| middle(t, axis)).collect();
        let half = middles.len() / 2;
        let cut = 0.5 * *middles.select_nth_unstable_by(half, f32::total_cmp).1;
        let low: Vec<u32> = of_set(&set, |t| boxes[t as usize][axis] <= cut);
        let high: Vec<u32> = of_set(&set, |t| boxes[t as usize][axis + 3] >= cut);
        if low.len().max(high.len()) > set.len() - set.len() / 8 {
            return self.compare_all(&set);
        }
        drop(set);
        self.split(low);
        self.split(high);
    }

    /// Compares all pairs of a set.
    fn compare_all(&mut self, set: &[u32]) {
        let boxes: Vec<RoughBox> = set.iter().map(|&t| self.boxes[t as usize]).collect();
        for (place, one) in boxes.iter().enumerate() {
            let rest = boxes.len() - place - 1;
            if self.left < rest {
                self.left = 0;
                return;
            }
            self.left -= rest;
            for (other, two) in boxes.iter().enumerate().skip(place + 1) {
                if meet(one, two) {
                    self.compare(set[place].min(set[other]), set[place].max(set[other]));
                }
            }
        }
    }

    /// Notes two triangles that cross.
    fn compare(&mut self, s: u32, t: u32) {
        let (a, b) = (self.triangles[s as usize], self.triangles[t as usize]);
        if a.iter().any(|vertex| b.contains(vertex)) {
            return;
        }
        let corners = |triangle: [usize; 3]| triangle.map(|i| self.vertices[i]);
        if let Some(point) = crossing_point(&corners(a), &corners(b)) {
            self.found.push(Crossing {
                pair: [s, t],
                point,
            });
        }
    }
}

/// Members of a set that keep a condition.
fn of_set(set: &[u32], keep: impl Fn(u32) -> bool) -> Vec<u32> {
    set.iter().copied().filter(|&t| keep(t)).collect()
}

/// Whether two boxes have a common point.
fn meet(a: &RoughBox, b: &RoughBox) -> bool {
    (0..3).all(|k| a[k] <= b[k + 3] && b[k] <= a[k + 3])
}

/// Boxes round the triangles, wider by more than their rounding.
fn rough_boxes(vertices: &[Vector3<f64>], triangles: &[[usize; 3]]) -> Vec<RoughBox> {
    const WIDER: f64 = 1e-6;
    let bounds = BoundingBox::of(vertices.iter());
    let scale = bounds.size().amax().max(f64::MIN_POSITIVE);
    let of_triangle = |t: &[usize; 3]| {
        let own = BoundingBox::of(t.iter().map(|&i| &vertices[i]));
        let low = (own.low - bounds.low) / scale;
        let high = (own.high - bounds.low) / scale;
        #[expect(clippy::cast_possible_truncation, reason = "between 0 and 1")]
        [0, 1, 2, 3, 4, 5].map(|k| {
            if k < 3 {
                (low[k] - WIDER) as f32
            } else {
                (high[k - 3] + WIDER) as f32
            }
        })
    };
    triangles.iter().map(of_triangle).collect()
}

/// A point where an edge of one triangle pierces the other.
fn crossing_point(a: &[Vector3<f64>; 3], b: &[Vector3<f64>; 3]) -> Option<Vector3<f64>> {
    let sides = |t: &[Vector3<f64>; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    let through_b = sides(a)
        .into_iter()
        .find_map(|side| piercing_point(&side, b));
    through_b.or_else(|| {
        sides(b)
            .into_iter()
            .find_map(|side| piercing_point(&side, a))
    })
}

/// The point where a segment whose ends lie on both sides of a triangle goes through it.
fn piercing_point(
    segment: &[Vector3<f64>; 2],
    triangle: &[Vector3<f64>; 3],
) -> Option<Vector3<f64>> {
    let [p, q] = segment;
    let [a, b, c] = triangle.map(|corner| corner - p);
    let end = q - p;
    // Six-fold volumes of the tetrahedra of each end with the triangle.
    let (at_p, at_q) = (
        -a.dot(&b.cross(&c)),
        (end - a).dot(&(b - a).cross(&(c - a))),
    );
    let size = [a, b, c, end].iter().fold(0.0, |m: f64, v| m.max(v.amax()));
    let rounding = ROUNDING * size.powi(3);
    if at_p.abs() <= rounding || at_q.abs() <= rounding || (at_p > 0.0) == (at_q > 0.0) {
        return None;
    }
    // The line passes all sides of the triangle on the same hand, or touches one.
    let turns = [(a, b), (b, c), (c, a)].map(|(from, to)| end.dot(&from.cross(&to)));
    let inside =
        turns.iter().all(|turn| *turn >= -rounding) || turns.iter().all(|turn| *turn <= rounding);
    inside.then(|| p + end * (at_p / (at_p - at_q)))
}

/// Share of the area that does not part inside from outside.
///
/// Seen from a point of the surface, the triangles round about fill half of all directions if one
/// of its sides lies inside (once) and the other outside; any other number tells of a part that
/// lies within the body or is turned over. The points share the area evenly.
fn folded_share(vertices: &[Vector3<f64>], triangles: &[[usize; 3]]) -> f64 {
    let corners = |t: usize| triangles[t].map(|i| vertices[i]);
    let areas: Vec<f64> = (0..triangles.len())
        .map(|t| area_vector(&corners(t)).norm())
        .collect();
    let points = (SOLID_ANGLES / triangles.len()).clamp(FEWEST_POINTS, MOST_POINTS);
    let share = areas.iter().sum::<f64>() / points as f64;
    let (mut folded, mut passed, mut next) = (0.0, 0.0, 0.5 * share);
    for (triangle, area) in areas.iter().enumerate() {
        passed += area;
        if passed < next {
            continue;
        }
        // A large triangle represents several shares.
        let shares = ((passed - next) / share).floor() + 1.0;
        next += shares * share;
        let middle = corners(triangle).iter().sum::<Vector3<f64>>() / 3.0;
        let others = (0..triangles.len()).filter(|&t| t != triangle).map(corners);
        let half_turns = solid_angle_sum(&middle, others) / std::f64::consts::TAU;
        if (half_turns - 1.0).abs() > 0.5 {
            folded += shares;
        }
    }
    folded / points as f64
}

#[cfg(test)]
mod tests {
    use super::{Crossings, crossing_point};
    use nalgebra::Vector3;
    use probability::random_stream::Stream;

    /// Loose triangles of mixed size: the halving finds the pairs that the comparison of all with
    /// all finds.
    #[test]
    fn halving_misses_no_pair() {
        let mut stream = Stream::new(1, "crossings");
        let mut vertices = Vec::new();
        let mut triangles = Vec::new();
        for i in 0..600_usize {
            let size = if i % 50 == 0 { 0.5 } else { 0.05 };
            let middle = Vector3::from_fn(|_, _| stream.uniform());
            for _ in 0..3 {
                let corner = Vector3::from_fn(|_, _| stream.between(-size, size));
                vertices.push(middle + corner);
            }
            triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
        }
        let corners = |t: &[usize; 3]| t.map(|i| vertices[i]);
        let mut plain = 0;
        for (i, a) in triangles.iter().enumerate() {
            for b in &triangles[i + 1..] {
                plain += usize::from(crossing_point(&corners(a), &corners(b)).is_some());
            }
        }
        let found = Crossings::new(&vertices, &triangles);
        assert!(plain > 50, "{plain} crossings are too few for a test");
        assert_eq!((found.pairs.len(), found.unfinished), (plain, false));
    }

    /// A wedge through a plate: the points lie on the plate, in both.
    #[test]
    fn crossings_of_known_triangles() {
        let plate = [[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]].map(|[x, y]| Vector3::new(x, y, 0.0));
        let upright = |x: f64, top: f64| {
            [
                Vector3::new(x, 1.0, -1.0),
                Vector3::new(x + 0.2, 1.0, -1.0),
                Vector3::new(x + 0.1, 1.0, top),
            ]
        };
        let point = crossing_point(&plate, &upright(1.0, 1.0)).unwrap();
        assert!(point.z.abs() < 1e-12 && (point.y - 1.0).abs() < 1e-12);
        // Beside the plate; below it; touching it from below.
        assert!(crossing_point(&plate, &upright(3.5, 1.0)).is_none());
        assert!(crossing_point(&plate, &upright(1.0, -0.1)).is_none());
        assert!(crossing_point(&plate, &upright(1.0, 0.0)).is_none());
        // In the plane of the plate.
        let shifted = plate.map(|corner| corner + Vector3::new(0.5, 0.5, 0.0));
        assert!(crossing_point(&plate, &shifted).is_none());
    }
}
