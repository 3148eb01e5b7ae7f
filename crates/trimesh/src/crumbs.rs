//! Cutting away loose pieces and edges of more than two triangles, where they are small.

use crate::orientation::{Edges, shells_of};
use crate::repair::Changes;
use crate::weld::Welded;
use geometry::triangle::area_vector;
use rustc_hash::FxHashSet;

/// Cuts away small pieces, then the triangles at edges that still have more than two, then what
/// fell off by that; all together at most a share of the area.
pub(crate) fn cut_crumbs(welded: &mut Welded, share: f64, changes: &mut Changes) {
    let areas = areas_of(welded);
    let whole: f64 = areas.iter().sum();
    let mut cutting = Cutting {
        areas,
        left: share * whole,
    };
    let before = welded.triangles.len();
    let mut edges = Edges::new(&welded.triangles);
    for at_edges in [false, true] {
        if at_edges && edges.crowded.is_empty() {
            break;
        }
        if at_edges && cutting.cut_at_edges(welded, &edges) {
            edges = Edges::new(&welded.triangles);
        }
        let pieces = cutting.cut_pieces(welded, &edges);
        changes.pieces_cut += pieces;
        if pieces > 0 {
            edges = Edges::new(&welded.triangles);
        }
    }
    changes.triangles_cut = before - welded.triangles.len();
    changes.cut_share = share - cutting.left / whole;
    if changes.triangles_cut == 0 {
        changes.cut_share = 0.0;
    }
}

/// Share of the area that the triangles at edges of more than two have.
pub(crate) fn share_at_edges(welded: &Welded, edges: &Edges) -> f64 {
    let areas = areas_of(welded);
    let at_edges = areas.iter().zip(at_crowded(welded, edges));
    let area: f64 = at_edges.filter(|(_, at)| *at).map(|(area, _)| area).sum();
    area / areas.iter().sum::<f64>()
}

/// Area of each triangle, m².
fn areas_of(welded: &Welded) -> Vec<f64> {
    let area = |t: &[usize; 3]| area_vector(&t.map(|i| welded.vertices[i])).norm();
    welded.triangles.iter().map(area).collect()
}

/// Whether each triangle lies at an edge of more than two.
fn at_crowded(welded: &Welded, edges: &Edges) -> Vec<bool> {
    let crowded: FxHashSet<[usize; 2]> = edges.crowded.iter().copied().collect();
    let at_edge = |t: &[usize; 3]| {
        [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]
            .iter()
            .any(|&[a, b]| crowded.contains(&[a.min(b), a.max(b)]))
    };
    welded.triangles.iter().map(at_edge).collect()
}

/// The triangles that are left and the area that may still be cut away.
struct Cutting {
    /// Area of each triangle, m².
    areas: Vec<f64>,
    /// Area that may still be cut away, m².
    left: f64,
}

impl Cutting {
    /// Cuts away the smallest pieces as long as the area allows; never the largest.
    fn cut_pieces(&mut self, welded: &mut Welded, edges: &Edges) -> usize {
        let piece_of = shells_of(edges);
        let count = piece_of.iter().max().map_or(0, |most| most + 1);
        let mut area_of = vec![0.0; count];
        for (piece, area) in piece_of.iter().zip(&self.areas) {
            area_of[*piece] += area;
        }
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|&a, &b| area_of[a].total_cmp(&area_of[b]));
        order.pop();
        let mut cut = vec![false; count];
        for piece in order {
            if area_of[piece] > self.left {
                break;
            }
            self.left -= area_of[piece];
            cut[piece] = true;
        }
        self.keep(welded, |triangle| !cut[piece_of[triangle]]);
        cut.iter().filter(|&&cut| cut).count()
    }

    /// Cuts away all triangles at edges of more than two, if the area allows.
    fn cut_at_edges(&mut self, welded: &mut Welded, edges: &Edges) -> bool {
        let cut = at_crowded(welded, edges);
        let area: f64 = self
            .areas
            .iter()
            .zip(&cut)
            .filter(|(_, cut)| **cut)
            .map(|(area, _)| area)
            .sum();
        if area > self.left {
            return false;
        }
        self.left -= area;
        self.keep(welded, |triangle| !cut[triangle]);
        true
    }

    /// Keeps some triangles.
    fn keep(&mut self, welded: &mut Welded, is_kept: impl Fn(usize) -> bool) {
        let mut index = 0;
        let mut next = || {
            index += 1;
            is_kept(index - 1)
        };
        welded.triangles.retain(|_| next());
        let mut index = 0;
        self.areas.retain(|_| {
            index += 1;
            is_kept(index - 1)
        });
    }
}
