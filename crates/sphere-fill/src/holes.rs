//! The emptiest places of a configuration.

use kiddo::{ImmutableKdTree, SquaredEuclidean};
use nalgebra::Vector3;

/// A hole needs this distance to all centres (in spacings) to be worth a try.
const LEAST: f64 = 0.6;

/// Two holes are at least this far apart, spacings.
const APART: f64 = 0.5;

/// Finds up to `most` candidate points farthest from all centres, the farthest first.
pub(crate) fn deepest_holes(
    candidates: &[Vector3<f64>],
    centres: &[Vector3<f64>],
    spacing: f64,
    most: usize,
) -> Vec<Vector3<f64>> {
    let points: Vec<[f64; 3]> = centres.iter().map(|c| [c.x, c.y, c.z]).collect();
    let tree: Option<ImmutableKdTree<f64, 3>> = (!points.is_empty())
        .then(|| ImmutableKdTree::new_from_slice(&points).ok())
        .flatten();
    let clearance_squared = |point: &Vector3<f64>| match &tree {
        Some(tree) => {
            tree.query(&[point.x, point.y, point.z])
                .nearest_one::<SquaredEuclidean<f64>>()
                .execute()
                .distance
        }
        None => f64::INFINITY,
    };
    let mut roomy: Vec<(f64, usize)> = candidates
        .iter()
        .map(&clearance_squared)
        .enumerate()
        .filter(|(_, squared)| *squared > (LEAST * spacing).powi(2))
        .map(|(index, squared)| (squared, index))
        .collect();
    roomy.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut holes: Vec<Vector3<f64>> = Vec::new();
    for (_, index) in roomy {
        let place = candidates[index];
        let near = |hole: &Vector3<f64>| (hole - place).norm() < APART * spacing;
        if !holes.iter().any(near) {
            holes.push(place);
            if holes.len() == most {
                break;
            }
        }
    }
    holes
}
