//! Edge points with their direction.

use crate::PhotoPixels;
use crate::pixels::to_f32;

#[derive(Debug, Clone, Copy)]
pub(crate) struct EdgePoint {
    /// Horizontal coordinate, px.
    pub(crate) x: f64,
    /// Vertical coordinate, positive down, px.
    pub(crate) y: f64,
    /// Unit normal of the edge, x part, 1.
    pub(crate) nx: f64,
    /// Unit normal of the edge, y part, 1.
    pub(crate) ny: f64,
    /// Grey gradient, levels per px.
    pub(crate) strength: f64,
}

/// Weakest gradient that counts as an edge, levels per px; below it is noise of any camera.
const WEAKEST: f64 = 1.5;
/// Most edge points kept, the strongest ones; enough for a rim among a bed full of grains.
const MOST_EDGES: usize = 8000;

/// Points where the gradient is largest along its own direction.
///
/// Both neighbours on the normal are interpolated, so that a mirrored picture has mirrored
/// edges. The strongest points come first.
pub(crate) fn find_edges(picture: &PhotoPixels) -> Vec<EdgePoint> {
    let (width, height) = (picture.width(), picture.height());
    let values = picture.values();
    let gray = |i: usize, j: usize| f64::from(values[j.min(height - 1) * width + i.min(width - 1)]);
    let gradient = |i: usize, j: usize| {
        let gx = 0.5 * (gray(i + 1, j) - gray(i.saturating_sub(1), j));
        let gy = 0.5 * (gray(i, j + 1) - gray(i, j.saturating_sub(1)));
        (gx, gy)
    };
    let mut strength = vec![0.0_f32; values.len()];
    for j in 0..height {
        for i in 0..width {
            let (gx, gy) = gradient(i, j);
            strength[j * width + i] = to_f32((gx * gx + gy * gy).sqrt());
        }
    }
    let strength = PhotoPixels::from_values(width, strength);
    let mut edges = Vec::new();
    for j in 0..height {
        for i in 0..width {
            let here = f64::from(strength.values()[j * width + i]);
            if here < WEAKEST {
                continue;
            }
            let (gx, gy) = gradient(i, j);
            let (nx, ny) = (gx / here, gy / here);
            let (x, y) = (i as f64, j as f64);
            let before = strength.at(x - nx, y - ny);
            let after = strength.at(x + nx, y + ny);
            if here >= before && here >= after && here > before.min(after) {
                // Vertex of the parabola through the three, in steps along the normal.
                let shift = 0.5 * (before - after) / (before - 2.0 * here + after);
                edges.push(EdgePoint {
                    x: x + shift * nx,
                    y: y + shift * ny,
                    nx,
                    ny,
                    strength: here,
                });
            }
        }
    }
    edges.sort_by(|a, b| b.strength.total_cmp(&a.strength));
    edges.truncate(MOST_EDGES);
    edges
}
