//! From a clump to single spheres and the pairs to be bonded.

use super::Error;
use crate::Placement;
use geometry::clump::Clump;
use nalgebra::Vector3;

/// A body of single spheres.
#[derive(Debug, Clone)]
pub struct Agglomerate {
    /// Where each sphere starts; its template is the number of the sphere in the clump plus the
    /// first template.
    pub placements: Vec<Placement>,
    /// Pairs to be bonded, numbered from the first body.
    pub pairs: Vec<[usize; 2]>,
}

/// Takes a clump apart into its spheres, moving as the rigid body would, and pairs up the spheres
/// whose gap is at most `gap` (m).
///
/// `first_template` and `first_body` are the numbers of the first sphere in the world. Sphere k gets
/// template `first_template + k`.
///
/// # Errors
///
/// A negative gap, an agglomerate that the pairs do not hold together.
pub fn agglomerate(
    clump: &Clump,
    start: &Placement,
    first_template: usize,
    first_body: usize,
    gap: f64,
) -> Result<Agglomerate, Error> {
    if gap.is_nan() || gap < 0.0 {
        return Err(Error::Gap { gap });
    }
    let spheres = clump.spheres();
    let placements = spheres.iter().enumerate().map(|(k, sphere)| {
        let offset: Vector3<f64> = start.orientation * sphere.centre;
        Placement {
            template: first_template + k,
            position: start.position + offset,
            velocity: start.velocity + start.spin.cross(&offset),
            ..*start
        }
    });
    let mut pairs = Vec::new();
    for (i, a) in spheres.iter().enumerate() {
        for (j, b) in spheres.iter().enumerate().skip(i + 1) {
            if (a.centre - b.centre).norm() <= a.radius + b.radius + gap {
                pairs.push([i, j]);
            }
        }
    }
    let loose = n_loose(spheres.len(), &pairs);
    if loose > 0 {
        let count = spheres.len();
        return Err(Error::Loose { loose, count, gap });
    }
    let shifted = pairs.iter().map(|p| p.map(|k| k + first_body));
    Ok(Agglomerate {
        placements: placements.collect(),
        pairs: shifted.collect(),
    })
}

/// Number of spheres that no chain of pairs joins to the first.
fn n_loose(count: usize, pairs: &[[usize; 2]]) -> usize {
    let mut joined = vec![false; count];
    let mut waiting = vec![0];
    while let Some(k) = waiting.pop() {
        if std::mem::replace(&mut joined[k], true) {
            continue;
        }
        for pair in pairs.iter().filter(|p| p.contains(&k)) {
            waiting.extend(pair.iter().filter(|&&other| !joined[other]));
        }
    }
    joined.iter().filter(|j| !**j).count()
}
