//! Closing holes that are too small to matter.

use crate::BoundingBox;
use crate::orientation::Edges;
use crate::weld::Welded;
use nalgebra::Vector3;
use rustc_hash::FxHashMap;

/// A hole that extends over at most this part of the mesh's diagonal is closed.
///
/// A flat lid over a dent of that width in a surface of curvature 1/R misses about w⁴/(64 R) of
/// volume: less than 1e-6 of the body's. A wider hole may be a missing part.
const SMALL: f64 = 0.03;

/// Closes small holes whose rim is one simple loop; gives their number.
///
/// A rim of three edges gets a triangle, a longer one a fan from the mean of its vertices.
pub(crate) fn close_small_holes(welded: &mut Welded, edges: &Edges) -> usize {
    if edges.open.is_empty() {
        return 0;
    }
    let largest = SMALL * BoundingBox::of(welded.vertices.iter()).size().norm();
    let rims: Vec<Vec<usize>> = rims_of(edges)
        .into_iter()
        .filter(|rim| {
            let bounds = BoundingBox::of(rim.iter().map(|&i| &welded.vertices[i]));
            rim.len() >= 3 && bounds.size().norm() <= largest
        })
        .collect();
    for rim in &rims {
        if let [a, b, c] = rim[..] {
            welded.triangles.push([a, b, c]);
            continue;
        }
        let sum: Vector3<f64> = rim.iter().map(|&i| welded.vertices[i]).sum();
        let middle = welded.vertices.len();
        welded.vertices.push(sum / rim.len() as f64);
        for (k, &from) in rim.iter().enumerate() {
            let to = rim[(k + 1) % rim.len()];
            welded.triangles.push([from, to, middle]);
        }
    }
    rims.len()
}

/// Loops of open edges through vertices of exactly two open edges each.
fn rims_of(edges: &Edges) -> Vec<Vec<usize>> {
    let mut around: FxHashMap<usize, Vec<usize>> = FxHashMap::default();
    for &[a, b] in &edges.open {
        around.entry(a).or_default().push(b);
        around.entry(b).or_default().push(a);
    }
    let mut rims = Vec::new();
    for &[start, second] in &edges.open {
        let mut rim = vec![start];
        let mut next = second;
        // A vertex that was passed before, or where more than two rims meet, ends the walk.
        while let Some([one, other]) = around.remove(rim.last().unwrap_or(&start)).as_deref() {
            if rim.len() > 1 {
                let before = rim[rim.len() - 2];
                next = if *one == before { *other } else { *one };
            }
            if next == start {
                rims.push(rim);
                break;
            }
            rim.push(next);
        }
    }
    rims
}
