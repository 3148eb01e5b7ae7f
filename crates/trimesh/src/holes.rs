//! Finding holes and closing those that may be.

use crate::BoundingBox;
use crate::lid::triangulated;
use crate::orientation::Edges;
use crate::repair::{Changes, Lid};
use crate::weld::Welded;
use geometry::triangle::area_vector;
use nalgebra::Vector3;
use rustc_hash::FxHashSet;

/// A hole that extends over at most this part of the mesh's diagonal is closed.
///
/// A flat lid over a dent of that width in a surface of curvature 1/R misses about w⁴/(64 R) of
/// volume: less than 1e-6 of the body's. A wider hole may be a missing part.
const SMALL: f64 = 0.03;

/// Closes the holes up to a width (m; none: [`SMALL`]) whose rim is a simple loop.
pub(crate) fn close_holes(
    welded: &mut Welded,
    edges: &Edges,
    width: Option<f64>,
    changes: &mut Changes,
) {
    let widest = widest_closed(&welded.vertices, width);
    let first = welded.triangles.len();
    let rims = rims_of(&welded.triangles, edges);
    let at_rims: FxHashSet<usize> = rims.iter().flatten().copied().collect();
    // A chord of a lid along an edge that is there would give this edge more than two triangles.
    let mut taken: FxHashSet<[usize; 2]> = FxHashSet::default();
    for t in &welded.triangles {
        for [a, b] in [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]] {
            if at_rims.contains(&a) && at_rims.contains(&b) {
                taken.insert([a.min(b), a.max(b)]);
            }
        }
    }
    for rim in &rims {
        let width = width_of(rim, &welded.vertices);
        if width > widest {
            continue;
        }
        let Some(lid) = triangulated(rim, &welded.vertices, &taken) else {
            continue;
        };
        let area = lid
            .iter()
            .map(|t| area_vector(&t.map(|i| welded.vertices[i])).norm())
            .sum();
        let middle = rim
            .iter()
            .map(|&i| welded.vertices[i])
            .sum::<Vector3<f64>>()
            / rim.len() as f64;
        changes.lids.push(Lid {
            width,
            edges: rim.len(),
            area,
            middle,
        });
        for t in &lid {
            taken.extend(
                [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]].map(|[a, b]| [a.min(b), a.max(b)]),
            );
        }
        welded.triangles.extend(lid);
    }
    changes.lids.sort_by(|a, b| b.width.total_cmp(&a.width));
    changes.lid_triangles = welded.triangles.len() - first;
}

/// Width up to which holes are closed, m, where `width` is asked for.
pub(crate) fn widest_closed(vertices: &[Vector3<f64>], width: Option<f64>) -> f64 {
    width.unwrap_or_else(|| SMALL * BoundingBox::of(vertices.iter()).size().norm())
}

/// Diagonal of the box round a rim, m.
pub(crate) fn width_of(rim: &[usize], vertices: &[Vector3<f64>]) -> f64 {
    BoundingBox::of(rim.iter().map(|&i| &vertices[i]))
        .size()
        .norm()
}

/// Simple loops of open edges, each against the sense of the triangles along it.
///
/// Where several rims meet in a vertex, the next open edge is the one that bounds the same fan
/// of triangles round the vertex; a walk that comes to a vertex again has closed a loop.
pub(crate) fn rims_of(triangles: &[[usize; 3]], edges: &Edges) -> Vec<Vec<usize>> {
    let mut rims = Vec::new();
    let mut walked: FxHashSet<Side> = FxHashSet::default();
    for triangle in 0..triangles.len() {
        for side in 0..3 {
            if edges.is_open(triangle, side) && !walked.contains(&(triangle, side)) {
                walk((triangle, side), triangles, edges, &mut walked, &mut rims);
            }
        }
    }
    rims
}

/// A triangle and one of its sides.
type Side = (usize, usize);

/// Walks from one open side on until the walk comes back, and notes the loops met.
fn walk(
    start: Side,
    triangles: &[[usize; 3]],
    edges: &Edges,
    walked: &mut FxHashSet<Side>,
    rims: &mut Vec<Vec<usize>>,
) {
    let ends = |(triangle, side): Side| {
        let t: [usize; 3] = triangles[triangle];
        [t[side], t[(side + 1) % 3]]
    };
    // Against the sense of the triangle: the lid then has the sense of its neighbours.
    let [mut vertex, first] = ends(start);
    let mut path = vec![first];
    let mut at = start;
    walked.insert(start);
    loop {
        if let Some(place) = path.iter().rposition(|&passed| passed == vertex) {
            let rim = path.split_off(place);
            if rim.len() >= 3 {
                rims.push(rim);
            }
            if path.is_empty() {
                return;
            }
        }
        path.push(vertex);
        match next_open(at, vertex, triangles, edges) {
            Some(next) if walked.insert(next) => at = next,
            _ => return,
        }
        let [from, to] = ends(at);
        vertex = if from == vertex { to } else { from };
    }
}

/// The other open side of the fan of triangles round a vertex that begins at an open side.
fn next_open(
    (mut triangle, mut side): Side,
    vertex: usize,
    triangles: &[[usize; 3]],
    edges: &Edges,
) -> Option<Side> {
    // A fan has at most as many triangles as there are.
    for _ in 0..triangles.len() {
        let t = triangles[triangle];
        // The other side of this triangle that has the vertex.
        side = (0..3)
            .find(|&other| other != side && (t[other] == vertex || t[(other + 1) % 3] == vertex))?;
        let Some(beyond) = edges.beyond(triangle, side) else {
            // An edge of more than two triangles ends the walk.
            return edges.is_open(triangle, side).then_some((triangle, side));
        };
        let (a, b) = (t[side], t[(side + 1) % 3]);
        triangle = beyond;
        let t = triangles[triangle];
        side = (0..3).find(|&k| {
            let (c, d) = (t[k], t[(k + 1) % 3]);
            (c, d) == (a, b) || (c, d) == (b, a)
        })?;
    }
    None
}
