//! What may be changed in a mesh on reading, and what was.

use input::quantity::significant;
use nalgebra::Vector3;
use serde::Serialize;

/// Share of the area that may be cut away as crumbs, unless another is asked for.
///
/// Pieces of a thousandth of a ball's area stand for at most 3e-5 of its volume; ten times as much
/// would take off thin parts such as a stalk.
const CRUMBS: f64 = 1e-3;

/// Changes allowed in a mesh so that it bounds a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Repair {
    /// Vertices on open edges that lie this near to each other are joined, m; none: only corners
    /// that coincide to a millionth of the diagonal.
    pub join: Option<f64>,
    /// Holes up to this width are closed by a flat lid, m; none: 3 % of the diagonal. The width is
    /// the diagonal of the box round the rim.
    pub close_holes: Option<f64>,
    /// Loose pieces, and triangles at edges of more than two, that together have at most this
    /// share of the area are cut away.
    pub crumbs: f64,
    /// The surface is rebuilt on cubes of this edge length, m, round all points that it encloses more than half; none: it
    /// stays as it is.
    pub rebuild: Option<f64>,
}

impl Default for Repair {
    fn default() -> Self {
        Self {
            join: None,
            close_holes: None,
            crumbs: CRUMBS,
            rebuild: None,
        }
    }
}

/// A hole that was closed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Lid {
    /// Diagonal of the box round the rim, m.
    pub width: f64,
    /// Edges of the rim.
    pub edges: usize,
    /// Area of the lid, m².
    pub area: f64,
    /// Mean of the vertices of the rim, m.
    pub middle: Vector3<f64>,
}

/// A surface that was rebuilt.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Rebuilt {
    /// Edge length of the cubes, m.
    pub cell: f64,
    /// Open edges that the surface had.
    pub open_edges: usize,
    /// Pairs of its triangles that crossed.
    pub crossings: usize,
}

impl std::fmt::Display for Rebuilt {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self {
            cell,
            open_edges,
            crossings,
        } = self;
        write!(
            f,
            "rebuilt on cubes of {} mm: {open_edges} open edges and {crossings} crossings are gone, and with them details \
             finer than that",
            significant(cell * 1e3, 4)
        )
    }
}

/// Changes made in a mesh so that it bounds a body.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Changes {
    /// Vertices on open edges that were joined with another.
    pub joined: usize,
    /// Loose pieces that were cut away.
    pub pieces_cut: usize,
    /// Triangles that were cut away with them or at edges of more than two.
    pub triangles_cut: usize,
    /// Share of the area that they had.
    pub cut_share: f64,
    /// Holes that were closed, the widest first.
    pub lids: Vec<Lid>,
    /// Share of the area that the lids have.
    pub lid_share: f64,
    /// Triangles of the lids: the last ones of the mesh.
    pub lid_triangles: usize,
    /// How the surface was rebuilt, if it was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rebuilt: Option<Rebuilt>,
}
