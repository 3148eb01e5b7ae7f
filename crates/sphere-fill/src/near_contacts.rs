//! How many pairs of spheres come near each other where two seeds touch.

use geometry::clump::{Sphere, volume_of_sphere};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use probability::random_stream::Stream;

/// Gap up to which two spheres are near, as a share of the size of the seed (twice the distance of its farthest point from its
/// centroid).
///
/// A solver lists pairs within a skin of about this width and looks at each of them in every step. Of 0.2, 0.5, 1, 2 and 3 %,
/// 1 % ranks the fillings of `docs/benchmarks.md` best.
const NEAR: f64 = 0.01;

/// Contacts that are drawn: the standard error of the mean is then 1 to 4 %.
const CONTACTS: usize = 1000;
/// Spheres times contacts at most, and fewest contacts, so that the count takes less than 0.1 s up to 10 000 spheres.
const MOST_TURNED: usize = 1_000_000;
/// See [`MOST_TURNED`].
const FEWEST_CONTACTS: usize = 50;

/// Mean number of pairs of spheres with a gap of at most 1 % of the size where two seeds of the same spheres touch: 1 for single
/// spheres, more the smoother the seed.
///
/// A solver computes forces for the pairs that touch, but has to look at all that are near: their number decides what a step of
/// a bed of such seeds costs. It depends on the shape alone and not on the size.
///
/// # Method
///
/// Two copies, each turned at random, approach along the line through their centroids until their first spheres touch; then the
/// pairs are counted. The turns belong to a fixed seed.
pub fn near_pairs_at_contact(spheres: &[Sphere]) -> f64 {
    let volumes = || spheres.iter().map(|s| volume_of_sphere(s.radius));
    let weighted = spheres.iter().zip(volumes()).map(|(s, v)| s.centre * v);
    let centroid = weighted.sum::<Vector3<f64>>() / volumes().sum::<f64>();
    let centred: Vec<Sphere> = spheres
        .iter()
        .map(|s| Sphere {
            centre: s.centre - centroid,
            radius: s.radius,
        })
        .collect();
    let reach = centred.iter().map(|s| s.centre.norm() + s.radius);
    let near = NEAR * 2.0 * reach.fold(0.0, f64::max);
    let contacts = (MOST_TURNED / spheres.len().max(1)).clamp(FEWEST_CONTACTS, CONTACTS);
    let mut stream = Stream::new(1, "turns of touching seeds");
    let mut turn = || {
        let [w, x, y, z] = stream.rotation();
        UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z))
    };
    let (mut pairs, mut met) = (0, 0);
    for _ in 0..contacts {
        let (left, right) = (
            facing(&centred, turn(), 1.0),
            facing(&centred, turn(), -1.0),
        );
        // Two rings may pass through each other's hole.
        if let Some(distance) = touching_distance(&left, &right) {
            met += 1;
            pairs += pairs_within(&left, &right, distance, near);
        }
    }
    pairs as f64 / f64::from(met)
}

/// A turned sphere, and how far it reaches toward the other seed, m.
struct Facing {
    sphere: Sphere,
    reach: f64,
}

/// Turned spheres, those that reach farthest along x (`side` 1) or against it (-1) first.
fn facing(spheres: &[Sphere], turn: UnitQuaternion<f64>, side: f64) -> Vec<Facing> {
    let mut turned: Vec<Facing> = spheres
        .iter()
        .map(|s| {
            let centre = turn * s.centre;
            Facing {
                sphere: Sphere { centre, ..*s },
                reach: side * centre.x + s.radius,
            }
        })
        .collect();
    turned.sort_by(|a, b| b.reach.total_cmp(&a.reach));
    turned
}

/// Distance of the centroids at which the first spheres touch, m; none if they pass each other.
fn touching_distance(left: &[Facing], right: &[Facing]) -> Option<f64> {
    let mut farthest = f64::NEG_INFINITY;
    for a in left {
        for b in right {
            // No later sphere of the right seed reaches farther.
            if a.reach + b.reach <= farthest {
                break;
            }
            let across = (a.sphere.centre - b.sphere.centre).yz().norm_squared();
            let room = (a.sphere.radius + b.sphere.radius).powi(2) - across;
            if room >= 0.0 {
                let along = a.sphere.centre.x - b.sphere.centre.x + room.sqrt();
                farthest = farthest.max(along);
            }
        }
    }
    farthest.is_finite().then_some(farthest)
}

/// Pairs with a gap of at most `near` (m) if the centroids are `distance` (m) apart.
fn pairs_within(left: &[Facing], right: &[Facing], distance: f64, near: f64) -> usize {
    let shift = Vector3::new(distance, 0.0, 0.0);
    let mut pairs = 0;
    for a in left {
        for b in right {
            // The gap along x is a lower bound of the gap.
            if distance - a.reach - b.reach > near {
                break;
            }
            let way = b.sphere.centre + shift - a.sphere.centre;
            let gap = way.norm() - a.sphere.radius - b.sphere.radius;
            pairs += usize::from(gap <= near);
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::near_pairs_at_contact;
    use geometry::clump::Sphere;
    use nalgebra::Vector3;

    fn ball(x: f64) -> Sphere {
        Sphere {
            centre: Vector3::new(x, 2.0, 3.0),
            radius: 1.0,
        }
    }

    /// Single spheres meet in one pair; n spheres about one centre in n².
    #[test]
    fn special_bodies_have_counts_that_are_known() {
        assert_eq!(near_pairs_at_contact(&[ball(0.0)]), 1.0);
        assert_eq!(near_pairs_at_contact(&[ball(5.0); 4]), 16.0);
    }

    /// The count by sorted reaches is that of all pairs, compared for one contact of thirty spheres.
    #[test]
    fn pruning_leaves_no_pair_out() {
        use super::{facing, pairs_within, touching_distance};
        use nalgebra::UnitQuaternion;
        use probability::random_stream::Stream;
        let mut stream = Stream::new(3, "near contacts");
        let spheres: Vec<Sphere> = (0..30)
            .map(|_| Sphere {
                centre: Vector3::from_fn(|_, _| stream.between(-1.0, 1.0)),
                radius: stream.between(0.1, 0.5),
            })
            .collect();
        let none = UnitQuaternion::identity();
        let (left, right) = (facing(&spheres, none, 1.0), facing(&spheres, none, -1.0));
        let gap = |d: f64, a: &Sphere, b: &Sphere| {
            (b.centre + Vector3::new(d, 0.0, 0.0) - a.centre).norm() - a.radius - b.radius
        };
        let all = |d: f64| {
            spheres
                .iter()
                .flat_map(|a| spheres.iter().map(move |b| (a, b)))
                .map(move |(a, b)| gap(d, a, b))
        };
        let d = touching_distance(&left, &right).unwrap();
        let least = all(d).fold(f64::INFINITY, f64::min);
        assert!(least.abs() < 1e-12, "{least}");
        for near in [0.01, 0.3, 1.0] {
            let plain = all(d).filter(|gap| *gap <= near).count();
            assert_eq!(pairs_within(&left, &right, d, near), plain);
            assert!(plain > 1 || near < 1.0, "the test sees no pair");
        }
    }

    /// Lengths times a power of two change no bit of the count.
    #[test]
    fn the_count_knows_no_size() {
        let seed: Vec<Sphere> = (0..20).map(|k| ball(0.3 * f64::from(k))).collect();
        let scaled = |factor: f64| {
            let grown = |s: &Sphere| Sphere {
                centre: s.centre * factor,
                radius: s.radius * factor,
            };
            near_pairs_at_contact(&seed.iter().map(grown).collect::<Vec<_>>())
        };
        let one = scaled(1.0);
        assert!(one > 1.0);
        assert_eq!(
            (scaled(2.0_f64.powi(-17)), scaled(2.0_f64.powi(4))),
            (one, one)
        );
    }
}
