//! How the spheres of a filling hang together.

use crate::near_pairs::near_pairs;
use crate::pieces::Pieces;
use geometry::clump::Sphere;
use std::collections::BTreeMap;

/// Largest gap that counts as contact, over the smallest radius, if none is given.
///
/// A packing keeps its overlaps to 0.1 % and its surface to 1 % of the radius, so a gap below 1 % is no
/// more than its own inaccuracy; our choice. At half of it some of the 473 spheres of 0.3 mm in the flat
/// cotton seed are loose; double of it adds 4 % of contacts. Lattices and overlapping spheres do not feel it.
const CONTACT: f64 = 0.01;

/// Two spheres whose gap is small enough to count as contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpherePair {
    /// Indices of the spheres, rising.
    pub spheres: [usize; 2],
    /// Distance of the centres, m.
    pub distance: f64,
    /// Distance of the surfaces, m; negative where they overlap.
    pub gap: f64,
    /// Radius of the neck, m: see [`neck_radius`].
    pub neck_radius: f64,
}

/// How spheres hang together.
///
/// Two spheres are joined when the distance of their centres is at most the sum of their radii and a
/// largest gap: the rule by which `dem_solver::bonds` bonds the spheres of a seed.
#[derive(Debug, Clone, PartialEq)]
pub struct Connectivity {
    /// Largest gap that counts as contact, m.
    pub largest_gap: f64,
    /// All pairs in contact, in the order of their indices.
    pub pairs: Vec<SpherePair>,
    /// Number of parts that no contact joins.
    pub pieces: usize,
    /// Spheres of the largest part.
    pub largest_piece: usize,
    /// Spheres without contact: rattlers.
    pub without_contact: usize,
    /// Mean number of contacts of a sphere, 2 contacts / spheres.
    pub mean_coordination: f64,
    /// The narrowest neck that cannot be gone round: of the pairs of a maximum spanning tree over the
    /// neck radii the one with the least; none without contact. 0 where spheres meet in a point.
    pub loosest: Option<SpherePair>,
    /// Smallest gap (m) at which all spheres are one part, 0 where overlaps alone join them: the
    /// largest gap of a minimum spanning tree.
    pub joining_gap: f64,
}

impl Connectivity {
    /// Looks at spheres; pairs with a gap of at most `largest_gap` (m) are in contact, if none is
    /// given 1 % of the smallest radius.
    pub fn new(spheres: &[Sphere], largest_gap: Option<f64>) -> Self {
        let smallest = spheres
            .iter()
            .fold(f64::INFINITY, |least, s| least.min(s.radius));
        let largest_gap = largest_gap.unwrap_or(CONTACT * smallest);
        let pairs = pairs_within(spheres, largest_gap);
        let mut contacts = vec![0_usize; spheres.len()];
        for index in pairs.iter().flat_map(|pair| pair.spheres) {
            contacts[index] += 1;
        }
        let (pieces, loosest) = widest_tree(spheres.len(), &pairs);
        Self {
            largest_gap,
            pieces: pieces.count(),
            largest_piece: pieces.largest(),
            without_contact: contacts.iter().filter(|&&n| n == 0).count(),
            mean_coordination: 2.0 * pairs.len() as f64 / spheres.len() as f64,
            loosest,
            joining_gap: joining_gap(spheres, &pairs, largest_gap.max(CONTACT * smallest)),
            pairs,
        }
    }
}

/// Radius of the neck between two spheres of radii a and b whose centres are d apart, m: that of the
/// smallest section of their union between the centres, at most the smaller radius; 0 without overlap.
///
/// # Formula
///
/// The surfaces meet in a circle at x = (d² + a² − b²) / 2d from the centre of a, of radius √(a² − x²).
/// Where it lies beyond one of the centres, the smaller sphere is itself the narrowest place.
pub fn neck_radius(a: f64, b: f64, d: f64) -> f64 {
    if d >= a + b {
        return 0.0;
    }
    let x = (d * d + a * a - b * b) / (2.0 * d);
    // Spheres about one centre give no finite x.
    if (0.0..=d).contains(&x) {
        (a * a - x * x).max(0.0).sqrt().min(a.min(b))
    } else {
        a.min(b)
    }
}

/// All pairs with a gap of at most `reach` (m), in the order of their indices.
fn pairs_within(spheres: &[Sphere], reach: f64) -> Vec<SpherePair> {
    let mut pairs = Vec::new();
    near_pairs(spheres, reach, |i, j, gap| {
        let (a, b) = (spheres[i].radius, spheres[j].radius);
        let distance = (spheres[i].centre - spheres[j].centre).norm();
        pairs.push(SpherePair {
            spheres: [i, j],
            distance,
            gap,
            neck_radius: neck_radius(a, b, distance),
        });
    });
    pairs.sort_by_key(|pair| pair.spheres);
    pairs
}

/// The parts that pairs make, and the narrowest pair of a maximum spanning tree over the neck radii.
fn widest_tree(count: usize, pairs: &[SpherePair]) -> (Pieces, Option<SpherePair>) {
    let mut order: Vec<&SpherePair> = pairs.iter().collect();
    // Of point contacts the nearest come first.
    order.sort_by(|a, b| {
        let wider = b.neck_radius.total_cmp(&a.neck_radius);
        wider.then(a.gap.total_cmp(&b.gap))
    });
    let mut pieces = Pieces::new(count);
    let mut loosest = None;
    for pair in order {
        if pieces.join(pair.spheres) {
            loosest = Some(*pair);
        }
    }
    (pieces, loosest)
}

/// Largest gap of a minimum spanning tree over the gaps, m; not below 0. `reach` (m, above 0) is where
/// the search beyond the contacts begins.
fn joining_gap(spheres: &[Sphere], contacts: &[SpherePair], mut reach: f64) -> f64 {
    let mut pieces = Pieces::new(spheres.len());
    let mut nearest: Vec<(f64, [usize; 2])> = contacts.iter().map(|p| (p.gap, p.spheres)).collect();
    let mut widest = 0.0_f64;
    loop {
        nearest.sort_by(|a, b| a.0.total_cmp(&b.0));
        for &(gap, pair) in &nearest {
            if pieces.join(pair) {
                widest = widest.max(gap);
            }
        }
        if pieces.count() <= 1 {
            return widest;
        }
        // Of each two parts only the smallest gap matters; it bounds the memory as well.
        reach *= 2.0;
        let mut between: BTreeMap<[usize; 2], (f64, [usize; 2])> = BTreeMap::new();
        near_pairs(spheres, reach, |i, j, gap| {
            let (a, b) = (pieces.root(i), pieces.root(j));
            if a != b {
                let least = between.entry([a.min(b), a.max(b)]).or_insert((gap, [i, j]));
                if gap < least.0 {
                    *least = (gap, [i, j]);
                }
            }
        });
        nearest = between.into_values().collect();
    }
}

#[cfg(test)]
mod tests {
    use super::{Connectivity, neck_radius};
    use geometry::clump::Sphere;
    use nalgebra::Vector3;
    use probability::random_stream::Stream;

    fn row(places: &[(f64, f64)]) -> Vec<Sphere> {
        let sphere = |&(x, radius): &(f64, f64)| Sphere {
            centre: Vector3::new(x, 0.0, 0.0),
            radius,
        };
        places.iter().map(sphere).collect()
    }

    /// Closed forms: equal spheres of radius r at distance d meet in a circle of radius √(r² − d²/4); of
    /// unlike ones at the distance of a right angle it is ab/√(a² + b²); touching ones meet in a point,
    /// and a sphere within another is as wide as itself. The tolerance is rounding.
    #[test]
    fn a_neck_is_the_circle_in_which_two_spheres_meet() {
        let near =
            |found: f64, exact: f64| assert!((found - exact).abs() < 1e-14, "{found} {exact}");
        near(neck_radius(1.0, 1.0, 1.2), 0.8);
        near(neck_radius(3.0, 4.0, 5.0), 2.4);
        near(neck_radius(1.0, 2.0, 3.0), 0.0);
        near(neck_radius(1.0, 2.0, 3.5), 0.0);
        near(neck_radius(2.0, 0.5, 0.0), 0.5);
        near(neck_radius(2.0, 0.5, 1.0), 0.5);
        // Where the circle passes the centre of the smaller sphere, at d² = a² − b², nothing jumps.
        let d = 3.75_f64.sqrt();
        near(neck_radius(2.0, 0.5, d), 0.5);
        let beyond = neck_radius(2.0, 0.5, d + 1e-6);
        assert!(beyond < 0.5 && beyond > 0.5 - 1e-9, "{beyond}");
    }

    /// Two overlapping pairs and a sphere alone, counted by hand: gaps of 0.5 and 1 part them.
    #[test]
    fn pieces_contacts_and_the_gap_that_joins_them_are_counted() {
        let spheres = row(&[(0.0, 1.0), (1.2, 1.0), (3.7, 1.0), (5.3, 1.0), (8.3, 1.0)]);
        let found = Connectivity::new(&spheres, None);
        assert_eq!(found.largest_gap, 0.01);
        assert_eq!((found.pieces, found.largest_piece), (3, 2));
        assert_eq!(found.pairs.len(), 2);
        assert_eq!(found.without_contact, 1);
        assert_eq!(found.mean_coordination, 0.8);
        // The pairs at 1.2 and 1.6 have necks of 0.8 and 0.6.
        let loosest = found.loosest.unwrap();
        assert_eq!(loosest.spheres, [2, 3]);
        assert!((loosest.neck_radius - 0.6).abs() < 1e-14);
        assert!(
            (found.joining_gap - 1.0).abs() < 1e-14,
            "{}",
            found.joining_gap
        );
        let joined = Connectivity::new(&spheres, Some(found.joining_gap));
        assert_eq!((joined.pieces, joined.pairs.len()), (1, 4));
        let loose = Connectivity::new(&spheres, Some(found.joining_gap * (1.0 - 1e-9)));
        assert_eq!(loose.pieces, 2);
    }

    /// In a ring of overlapping spheres a narrow neck is gone round: the loosest that counts is the
    /// second narrowest.
    #[test]
    fn a_neck_that_can_be_gone_round_does_not_count() {
        let at = |x: f64, y: f64| Sphere {
            centre: Vector3::new(x, y, 0.0),
            radius: 1.0,
        };
        // Sides of 1.9, 1.3 and 1.0: necks of 0.312, 0.760 and 0.866.
        let x = (1.9_f64.powi(2) + 1.3_f64.powi(2) - 1.0) / 3.8;
        let y = (1.3_f64.powi(2) - x * x).sqrt();
        let spheres = [at(0.0, 0.0), at(1.9, 0.0), at(x, y)];
        let found = Connectivity::new(&spheres, None);
        assert_eq!(found.pairs.len(), 3);
        let exact = (1.0 - 0.65_f64.powi(2)).sqrt();
        assert!((found.loosest.unwrap().neck_radius - exact).abs() < 1e-14);
        assert_eq!(found.joining_gap, 0.0);
    }

    /// The gap that joins, found by growing the reach, is that of Prim's algorithm over all pairs.
    #[test]
    fn the_joining_gap_is_that_of_the_minimum_spanning_tree() {
        let mut stream = Stream::new(7, "joining gap");
        let spheres: Vec<Sphere> = (0..60)
            .map(|_| Sphere {
                centre: Vector3::from_fn(|_, _| stream.between(-3.0, 3.0)),
                radius: stream.between(0.05, 0.4),
            })
            .collect();
        let gap = |i: usize, j: usize| {
            let (a, b): (&Sphere, &Sphere) = (&spheres[i], &spheres[j]);
            (a.centre - b.centre).norm() - a.radius - b.radius
        };
        let mut outside: Vec<usize> = (1..spheres.len()).collect();
        let mut inside = vec![0];
        let mut widest = 0.0_f64;
        while !outside.is_empty() {
            let near = |&j: &usize| {
                inside
                    .iter()
                    .map(|&i| gap(i, j))
                    .fold(f64::INFINITY, f64::min)
            };
            let best =
                (0..outside.len()).min_by(|&a, &b| near(&outside[a]).total_cmp(&near(&outside[b])));
            let place = best.unwrap();
            widest = widest.max(near(&outside[place]));
            inside.push(outside.swap_remove(place));
        }
        let found = Connectivity::new(&spheres, None).joining_gap;
        assert!((found - widest).abs() < 1e-14, "{found} {widest}");
        assert!(widest > 0.1, "the case is not a case");
    }
}
