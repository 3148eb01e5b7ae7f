//! Triangles that close a rim.

use nalgebra::Vector3;
use rustc_hash::FxHashSet;

/// Longest rim that is closed at one go: the work grows with the cube of the number of its edges
/// and is then about half a second.
const LONGEST: usize = 600;

/// Triangulates a rim with the least area; none if chords that are taken leave no way.
///
/// # Formula
///
/// A(i, k) = min over j of A(i, j) + A(j, k) + area(i, j, k), from short spans to long ones
/// `[Barequet1995, section 3]`. A rim of more than [`LONGEST`] edges is first cut in two by the
/// chord that is shortest against the shorter way along the rim.
pub(crate) fn triangulated(
    rim: &[usize],
    vertices: &[Vector3<f64>],
    taken: &FxHashSet<[usize; 2]>,
) -> Option<Vec<[usize; 3]>> {
    if rim.len() <= LONGEST {
        return least_area(rim, vertices, taken);
    }
    let (i, j) = cutting_chord(rim, vertices, taken)?;
    let other = [&rim[j..], &rim[..=i]].concat();
    let mut lid = triangulated(&rim[i..=j], vertices, taken)?;
    lid.extend(triangulated(&other, vertices, taken)?);
    Some(lid)
}

/// Whether a chord between two places of a rim is none of its edges and may not be drawn.
fn is_taken(rim: &[usize], i: usize, j: usize, taken: &FxHashSet<[usize; 2]>) -> bool {
    let is_edge = j == i + 1 || i == 0 && j + 1 == rim.len();
    !is_edge && taken.contains(&[rim[i].min(rim[j]), rim[i].max(rim[j])])
}

/// The chord that is shortest against the shorter way along the rim, of those that cut off a
/// quarter of the edges or more.
fn cutting_chord(
    rim: &[usize],
    vertices: &[Vector3<f64>],
    taken: &FxHashSet<[usize; 2]>,
) -> Option<(usize, usize)> {
    let n = rim.len();
    let mut along = vec![0.0; n + 1];
    for k in 0..n {
        along[k + 1] = along[k] + (vertices[rim[(k + 1) % n]] - vertices[rim[k]]).norm();
    }
    let mut best = None;
    for i in 0..n {
        for j in i + n / 4..n.min(i + n - n / 4) {
            let way = along[j] - along[i];
            let shorter = way.min(along[n] - way).max(f64::MIN_POSITIVE);
            let ratio = (vertices[rim[j]] - vertices[rim[i]]).norm() / shorter;
            if best.is_none_or(|(least, _)| ratio < least) && !is_taken(rim, i, j, taken) {
                best = Some((ratio, (i, j)));
            }
        }
    }
    best.map(|(_, chord)| chord)
}

/// The triangulation of least area.
fn least_area(
    rim: &[usize],
    vertices: &[Vector3<f64>],
    taken: &FxHashSet<[usize; 2]>,
) -> Option<Vec<[usize; 3]>> {
    let n = rim.len();
    let points: Vec<Vector3<f64>> = rim.iter().map(|&i| vertices[i]).collect();
    let mut area = vec![0.0; n * n];
    let mut between = vec![0; n * n];
    for span in 2..n {
        for i in 0..n - span {
            let k = i + span;
            area[i * n + k] = f64::INFINITY;
            if is_taken(rim, i, k, taken) {
                continue;
            }
            let chord = points[k] - points[i];
            for j in i + 1..k {
                let parts = area[i * n + j] + area[j * n + k];
                if parts < area[i * n + k] {
                    let sum = parts + 0.5 * (points[j] - points[i]).cross(&chord).norm();
                    if sum < area[i * n + k] {
                        area[i * n + k] = sum;
                        between[i * n + k] = j;
                    }
                }
            }
        }
    }
    if area[n - 1].is_infinite() {
        return None;
    }
    let mut lid = Vec::with_capacity(n - 2);
    let mut to_do = vec![(0, n - 1)];
    while let Some((i, k)) = to_do.pop() {
        if k - i >= 2 {
            let j = between[i * n + k];
            lid.push([rim[i], rim[j], rim[k]]);
            to_do.extend([(i, j), (j, k)]);
        }
    }
    Some(lid)
}

#[cfg(test)]
mod tests {
    use super::triangulated;
    use geometry::triangle::area_vector;
    use nalgebra::Vector3;
    use rustc_hash::FxHashSet;

    fn area_of(lid: &[[usize; 3]], vertices: &[Vector3<f64>]) -> f64 {
        lid.iter()
            .map(|t| area_vector(&t.map(|i| vertices[i])).norm())
            .sum()
    }

    /// A flat horseshoe: the least area is its own (a chord across the mouth costs more), to
    /// rounding; with many edges as well, where it is cut before.
    #[test]
    fn a_hollow_rim_is_closed_inside_its_outline() {
        for per_arc in [20, 500] {
            let arc = |radius: f64, k: usize| {
                let angle = 5.0 * k as f64 / per_arc as f64;
                Vector3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
            };
            let outer = (0..=per_arc).map(|k| arc(2.0, k));
            let inner = (0..=per_arc).rev().map(|k| arc(1.0, k));
            let vertices: Vec<_> = outer.chain(inner).collect();
            let rim: Vec<usize> = (0..vertices.len()).collect();
            let shoelace: f64 = (0..rim.len())
                .map(|k| vertices[k].cross(&vertices[(k + 1) % rim.len()]).z * 0.5)
                .sum();
            let lid = triangulated(&rim, &vertices, &FxHashSet::default()).unwrap();
            assert_eq!(lid.len(), rim.len() - 2);
            let found = area_of(&lid, &vertices);
            assert!(
                (found / shoelace - 1.0).abs() < 1e-9,
                "{found} instead of {shoelace}"
            );
        }
    }

    /// A chord that is an edge elsewhere is not drawn; with both taken a square cannot be closed.
    #[test]
    fn chords_that_are_taken_are_left_out() {
        let vertices =
            [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vector3::new(x, y, 0.0));
        let rim = [0, 1, 2, 3];
        let taken: FxHashSet<_> = [[0, 2]].into_iter().collect();
        let lid = triangulated(&rim, &vertices, &taken).unwrap();
        assert!(
            lid.iter().all(|t| t.contains(&1) && t.contains(&3)),
            "{lid:?}"
        );
        let taken: FxHashSet<_> = [[0, 2], [1, 3]].into_iter().collect();
        assert!(triangulated(&rim, &vertices, &taken).is_none());
    }
}
