//! What was found and repaired while a mesh was read.

use crate::{BoundingBox, Changes, LengthUnit, Proposal, Rebuilt};
use input::quantity::significant;
use serde::{Serialize, Serializer};

/// Longest seed that raises no question, m.
const LARGE: f64 = 0.1;

/// Shortest seed (by its longest dimension) that raises no question, m.
const SMALL: f64 = 1e-4;

/// Something that is not wrong, but that the user should know.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// The size is not that of a seed: the unit is probably another one.
    UnitSuspect {
        /// Longest dimension as read, m.
        longest: f64,
        /// Unit that was used.
        unit: LengthUnit,
        /// Unit that would give a seed of common size, and that size, m.
        likely: Option<(LengthUnit, f64)>,
    },
    /// The size of a body in a stack of slices is not that of a seed: the edge length of a voxel is probably another one.
    VoxelSuspect {
        /// Longest dimension, m.
        longest: f64,
    },
    /// Bodies cross each other.
    BodiesCross {
        /// Bodies.
        bodies: usize,
        /// What makes one body of those that cross.
        way_out: Proposal,
    },
    /// The header of a binary STL declares fewer triangles than the file holds; all were read.
    CountCorrected {
        /// Triangles that the header declares.
        declared: u32,
        /// Triangles that the file holds.
        found: usize,
    },
    /// Bytes after the last triangle were left aside.
    TrailingBytes(usize),
    /// A text ends without `endsolid`.
    NoEnd,
    /// Degenerate triangles were dropped.
    DegenerateDropped(usize),
    /// Repeated triangles were dropped.
    DuplicatesDropped(usize),
    /// Triangles were turned to face outward.
    Turned(usize),
    /// Vertices on open edges were joined.
    Joined(usize),
    /// Loose pieces and triangles at edges of more than two were cut away.
    CrumbsCut {
        /// Loose pieces.
        pieces: usize,
        /// Triangles.
        triangles: usize,
        /// Their share of the area.
        share: f64,
    },
    /// Holes were closed by flat lids.
    HolesClosed {
        /// Number of holes.
        holes: usize,
        /// Width of the widest, m.
        widest: f64,
        /// Share of the area that the lids have.
        share: f64,
    },
    /// The surface was rebuilt.
    Rebuilt(Rebuilt),
    /// A body reaches the border of a stack of slices with so many voxels, and is cut off there.
    CutAtBorder(usize),
    /// The surface has holes.
    OpenEdges(usize),
    /// Edges have more than two triangles.
    NonManifoldEdges(usize),
    /// The surface has one side only.
    NotOrientable,
    /// The surface cuts itself.
    Crossings {
        /// Pairs of triangles that cross.
        pairs: usize,
        /// Share of the area that does not part inside from outside.
        folded_share: f64,
    },
    /// Not all pairs of triangles were tested for crossing.
    CrossingsUnfinished,
    /// The file holds several connected surfaces.
    SeveralShells {
        /// Connected surfaces.
        shells: usize,
        /// Of these, outer surfaces of bodies.
        bodies: usize,
    },
}

impl std::fmt::Display for Warning {
    #[allow(clippy::too_many_lines, reason = "each variant has its sentence here")]
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::UnitSuspect {
                longest,
                unit,
                likely,
            } => tell_unit(f, *longest, *unit, *likely),
            Self::VoxelSuspect { longest } => write!(
                f,
                "the longest dimension is {} mm; most seeds have 0.1 to 100 mm: check the edge length of a voxel (seedfill: --voxel)",
                significant(longest * 1e3, 4)
            ),
            Self::BodiesCross { bodies, way_out } => write!(
                f,
                "{bodies} bodies, some of which cross each other; to join those, {way_out}"
            ),
            Self::CountCorrected { declared, found } => write!(
                f,
                "the header declares {declared} triangles, the file holds {found}: all were read"
            ),
            Self::TrailingBytes(n) => write!(f, "{n} bytes after the last triangle left aside"),
            Self::NoEnd => write!(f, "the text ends without endsolid: it may be cut off"),
            Self::Joined(n) => write!(f, "{n} vertices on open edges joined with others"),
            Self::CrumbsCut {
                pieces,
                triangles,
                share,
            } => write!(
                f,
                "{triangles} triangles in {pieces} loose pieces or at shared edges cut away: {:.4} % of the area",
                share * 100.0
            ),
            Self::HolesClosed {
                holes,
                widest,
                share,
            } => write!(
                f,
                "{holes} {} closed, the widest {} mm across; the lids are {:.3} % of the area",
                if *holes == 1 { "hole" } else { "holes" },
                significant(widest * 1e3, 4),
                share * 100.0
            ),
            Self::Rebuilt(rebuilt) => rebuilt.fmt(f),
            Self::CutAtBorder(n) => write!(f, "cut off at the border of the stack ({n} voxels)"),
            Self::DegenerateDropped(n) => write!(f, "{n} degenerate triangles dropped"),
            Self::DuplicatesDropped(n) => write!(f, "{n} repeated triangles dropped"),
            Self::Turned(n) => write!(f, "{n} triangles turned to face outward"),
            Self::OpenEdges(n) => write!(f, "not closed: {n} edges belong to one triangle only"),
            Self::NonManifoldEdges(n) => {
                write!(f, "{n} edges belong to more than two triangles")
            }
            Self::NotOrientable => write!(f, "the surface has one side only"),
            Self::Crossings {
                pairs,
                folded_share,
            } => write!(
                f,
                "the surface cuts itself: {pairs} pairs of triangles cross, {:.1} % of the area lies \
                 in folds",
                folded_share * 100.0
            ),
            Self::CrossingsUnfinished => write!(
                f,
                "not all triangles were tested for crossing others: too many lie in each other's \
                 boxes"
            ),
            Self::SeveralShells { shells, bodies } => {
                write!(
                    f,
                    "{shells} connected surfaces, {bodies} of them outer ones"
                )
            }
        }
    }
}

/// Questions the unit of a size that no seed has.
fn tell_unit(
    f: &mut std::fmt::Formatter<'_>,
    longest: f64,
    unit: LengthUnit,
    likely: Option<(LengthUnit, f64)>,
) -> std::fmt::Result {
    let size = significant(longest * 1e3, 4);
    write!(
        f,
        "the longest dimension is {size} mm when read in {unit}; most seeds have 0.1 to 100 mm"
    )?;
    match likely {
        Some((other, length)) => {
            let factor = other.in_metres() / unit.in_metres();
            let length = significant(length * 1e3, 4);
            write!(
                f,
                ": with the unit {other} (factor {factor:.0e}) it would be {length} mm (seedfill: --unit {other})"
            )
        }
        None => write!(f, ": check the unit (seedfill: --unit)"),
    }
}

impl Serialize for Warning {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Properties of a mesh, and its repairs on reading.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeshReport {
    /// File or shape.
    pub source: String,
    /// Unit in which the numbers were read.
    pub unit: LengthUnit,
    /// Triangles kept.
    pub triangles: usize,
    /// Vertices after joining.
    pub vertices: usize,
    /// Whether the surface is closed and has an inside.
    pub watertight: bool,
    /// Connected surfaces.
    pub shells: usize,
    /// Triangles dropped because two corners coincide.
    pub degenerate_dropped: usize,
    /// Triangles dropped because they repeat another.
    pub duplicates_dropped: usize,
    /// Triangles turned to face outward.
    pub triangles_turned: usize,
    /// Holes that were closed.
    pub holes_closed: usize,
    /// Further changes so that the mesh bounds a body, and their places.
    pub changes: Changes,
    /// Box along the axes, m.
    pub bounding_box: BoundingBox,
    /// Surface area, m².
    pub area: f64,
    /// Enclosed volume, m³; none for an open mesh.
    pub volume: Option<f64>,
    /// Warnings for the user.
    pub warnings: Vec<Warning>,
}

/// Questions a size that no seed has, and looks for a unit that would give a common one.
pub(crate) fn suspect_unit(longest: f64, unit: LengthUnit) -> Option<Warning> {
    if (SMALL..=LARGE).contains(&longest) {
        return None;
    }
    let likely = LengthUnit::ALL
        .into_iter()
        .map(|other| (other, longest / unit.in_metres() * other.in_metres()))
        .filter(|(_, length)| (SMALL..=LARGE).contains(length))
        // The common seed is some millimetres long; take the unit that comes nearest to 5 mm.
        .min_by(|a, b| {
            let far = |length: f64| (length / 5e-3).ln().abs();
            far(a.1).total_cmp(&far(b.1))
        });
    Some(Warning::UnitSuspect {
        longest,
        unit,
        likely,
    })
}
