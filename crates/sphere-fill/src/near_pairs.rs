//! Pairs of spheres whose surfaces lie near each other.

use geometry::clump::Sphere;

/// Calls with the indices and the gap (m, negative where they overlap) of every pair of spheres whose
/// gap is at most `reach` (m), by a sweep along x.
pub(crate) fn near_pairs(spheres: &[Sphere], reach: f64, mut found: impl FnMut(usize, usize, f64)) {
    let mut order: Vec<usize> = (0..spheres.len()).collect();
    order.sort_by(|&a, &b| spheres[a].centre.x.total_cmp(&spheres[b].centre.x));
    let largest = spheres.iter().fold(0.0, |m: f64, s| m.max(s.radius));
    for (place, &i) in order.iter().enumerate() {
        let a = &spheres[i];
        for &j in &order[place + 1..] {
            let b = &spheres[j];
            if b.centre.x - a.centre.x > a.radius + largest + reach {
                break;
            }
            let gap = (a.centre - b.centre).norm() - (a.radius + b.radius);
            if gap <= reach {
                found(i.min(j), i.max(j), gap);
            }
        }
    }
}
