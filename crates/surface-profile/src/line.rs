//! The least-squares line.

/// Direction of the line that minimises the sum of squared normal distances.
///
/// # Formula
/// `tan 2 theta = 2 Sxy / (Sxx - Syy)` with sums about the centroid, theta in (-pi/2, pi/2].
/// Normal distances, not vertical ones, make the line turn with the picture and stay the same
/// under a mirror.
///
/// # Source
/// `[Pearson1901]`, principal axis of the points.
///
/// Returns `None` for fewer than two distinct points.
pub(crate) fn direction(points: impl Iterator<Item = (f64, f64)> + Clone) -> Option<f64> {
    let (mut n, mut x, mut y) = (0.0, 0.0, 0.0);
    for (px, py) in points.clone() {
        n += 1.0;
        x += px;
        y += py;
    }
    let (x, y) = (x / n, y / n);
    let (mut sxx, mut sxy, mut syy) = (0.0, 0.0, 0.0);
    for (px, py) in points {
        sxx += (px - x) * (px - x);
        sxy += (px - x) * (py - y);
        syy += (py - y) * (py - y);
    }
    (sxx + syy > 0.0).then(|| 0.5 * (2.0 * sxy).atan2(sxx - syy))
}
