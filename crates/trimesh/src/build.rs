//! From loose triangles to a checked mesh.

use crate::crossings::Crossings;
use crate::crumbs::cut_crumbs;
use crate::holes::{close_holes, rims_of, widest_closed, width_of};
use crate::orientation::{Edges, turn_outward};
use crate::proposal::{Proposal, Tried};
use crate::rebuild::rebuild;
use crate::report::suspect_unit;
use crate::weld::{Welded, joined, weld};
use crate::{
    BoundingBox, Changes, Error, LengthUnit, MeshReport, Repair, Topology, TriMesh, Warning,
};
use geometry::triangle::area_vector;
use nalgebra::{Matrix3, Vector3};
use rustc_hash::{FxBuildHasher, FxHashSet};

/// Most triangles: indices of sides then have 32 bits. A file of them has 25 gigabytes.
const MOST_TRIANGLES: usize = 500_000_000;

/// Least extent of a body, m: its moments of inertia are then still above the least number.
const SMALLEST: f64 = 1e-40;

/// Largest coordinate in the unit of the file: volumes and moments of inertia stay finite.
const LARGEST: f64 = 1e30;

/// Bodies thinner than this part of their length are refused as flat.
///
/// Welding joins vertices at 1e-6 of the diagonal, so anything thinner has no inside.
const FLATTEST: f64 = 1e-6;

/// A mesh and the report of what was found and repaired.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckedMesh {
    /// The mesh, m.
    pub mesh: TriMesh,
    /// Report of faults and repairs.
    pub report: MeshReport,
}

impl TriMesh {
    /// Makes a mesh of loose triangles: joins vertices, drops faulty triangles, cuts crumbs
    /// away, closes small holes, turns outward.
    ///
    /// Corner coordinates are in `unit`; `source` names them in messages. An open mesh is
    /// accepted with a warning (see [`TriMesh::require_closed`]).
    ///
    /// # Errors
    ///
    /// A coordinate that is not finite, no triangle left, all vertices in one plane.
    pub fn from_triangles(
        soup: &[[Vector3<f64>; 3]],
        unit: LengthUnit,
        source: &str,
    ) -> Result<CheckedMesh, Error> {
        build(soup.to_vec(), unit, source, &Repair::default(), Vec::new())
    }
}

/// Makes a mesh of loose triangles, with what is already known to be odd.
pub(crate) fn build(
    mut soup: Vec<[Vector3<f64>; 3]>,
    unit: LengthUnit,
    source: &str,
    repair: &Repair,
    mut warnings: Vec<Warning>,
) -> Result<CheckedMesh, Error> {
    into_metres(&mut soup, unit, source)?;
    let mut welded = weld(&soup);
    // The memory is needed for the edges.
    drop(soup);
    let (degenerate_dropped, duplicates_dropped) = drop_faulty(&mut welded, source)?;
    refuse_flat(&welded.vertices, source)?;
    drop_unused(&mut welded.vertices, &mut welded.triangles);
    let (edges, changes) = mend(&mut welded, repair);
    let rims = rims_of(&welded.triangles, &edges);
    let widths = rims.iter().map(|rim| width_of(rim, &welded.vertices));
    let turned = turn_outward(&welded.vertices, &mut welded.triangles, &edges);
    let crossings = Crossings::new(&welded.vertices, &welded.triangles);
    let middle = |edge: &[usize; 2]| (welded.vertices[edge[0]] + welded.vertices[edge[1]]) * 0.5;
    let topology = Topology {
        open_edges: edges.open.len(),
        first_open_edge: edges.open.first().map(middle),
        holes: rims.len(),
        widest_hole: widths.fold(0.0, f64::max),
        non_manifold_edges: edges.crowded.len(),
        first_non_manifold_edge: edges.crowded.first().map(middle),
        shells: turned.shells,
        bodies: turned.outer.iter().filter(|&&outer| outer).count(),
        bodies_apart: turned.bodies_apart(&crossings.pairs),
        orientable: turned.orientable,
        crossings: crossings.pairs.len(),
        first_crossing: crossings.first,
        folded_share: crossings.folded,
        way_out: way_out(&welded, &edges, &rims, (&changes, turned.shells), repair),
    };
    if crossings.unfinished {
        warnings.push(Warning::CrossingsUnfinished);
    }
    let mesh = TriMesh {
        source: source.to_owned(),
        vertices: welded.vertices,
        triangles: welded.triangles,
        topology,
    };
    let counts = Repairs {
        degenerate_dropped,
        duplicates_dropped,
        triangles_turned: turned.count,
        changes,
    };
    warnings.extend(warnings_of(&mesh, unit, &counts));
    let report = report_of(&mesh, unit, counts, warnings);
    let checked = CheckedMesh { mesh, report };
    match repair.rebuild {
        Some(cell) => rebuild(checked, cell, repair.crumbs),
        None => Ok(checked),
    }
}

/// What would mend a mesh with open or crowded edges; `None` without them.
fn way_out(
    welded: &Welded,
    edges: &Edges,
    rims: &[Vec<usize>],
    (changes, shells): (&Changes, usize),
    repair: &Repair,
) -> Option<Proposal> {
    if edges.open.is_empty() && edges.crowded.is_empty() {
        return None;
    }
    let tried = Tried {
        cut_share: changes.cut_share,
        closed: widest_closed(&welded.vertices, repair.close_holes),
    };
    Some(Proposal::of(welded, edges, rims, shells, &tried))
}

/// Joins open edges, cuts crumbs away and closes holes, as far as that is allowed. Where the surface is rebuilt, only what is
/// asked for: lids on loose triangles would undo them, and each crumb encloses something.
fn mend(welded: &mut Welded, repair: &Repair) -> (Edges, Changes) {
    let mut changes = Changes::default();
    let mut edges = Edges::new(&welded.triangles);
    if let Some(distance) = repair.join.filter(|_| !edges.open.is_empty()) {
        changes.joined = join_rims(welded, &edges, distance);
        edges = Edges::new(&welded.triangles);
    }
    let anew = repair.rebuild.is_some();
    let is_clean = edges.open.is_empty() && edges.crowded.is_empty();
    if !(anew || is_clean) {
        cut_crumbs(welded, repair.crumbs, &mut changes);
        drop_unused(&mut welded.vertices, &mut welded.triangles);
        edges = Edges::new(&welded.triangles);
    }
    if !edges.open.is_empty() && (!anew || repair.close_holes.is_some()) {
        close_holes(welded, &edges, repair.close_holes, &mut changes);
        let area_of = |t: &[usize; 3]| area_vector(&t.map(|i| welded.vertices[i])).norm();
        let whole: f64 = welded.triangles.iter().map(area_of).sum();
        changes.lid_share = changes.lids.iter().map(|lid| lid.area).sum::<f64>() / whole;
        edges = Edges::new(&welded.triangles);
    }
    (edges, changes)
}

/// Joins vertices on open edges that lie near to each other; gives their number.
fn join_rims(welded: &mut Welded, edges: &Edges, distance: f64) -> usize {
    let mut at_rims = edges.open.concat();
    at_rims.sort_unstable();
    at_rims.dedup();
    let names = joined(&welded.vertices, at_rims.into_iter(), distance);
    welded
        .triangles
        .iter_mut()
        .flatten()
        .for_each(|i| *i = names[*i]);
    welded
        .triangles
        .retain(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]);
    drop_repeated(&mut welded.triangles);
    names
        .iter()
        .enumerate()
        .filter(|(i, name)| i != *name)
        .count()
}

/// Drops degenerate and repeated triangles; gives their numbers.
fn drop_faulty(welded: &mut Welded, source: &str) -> Result<(usize, usize), Error> {
    let read = welded.triangles.len();
    welded
        .triangles
        .retain(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]);
    let degenerate = read - welded.triangles.len();
    let duplicates = drop_repeated(&mut welded.triangles);
    if welded.triangles.is_empty() {
        return Err(Error::NoTriangles {
            file: source.to_owned(),
            read,
            dropped: degenerate + duplicates,
        });
    }
    Ok((degenerate, duplicates))
}

/// Counts of what was changed.
struct Repairs {
    /// Triangles dropped because two corners coincide.
    degenerate_dropped: usize,
    /// Triangles dropped because they repeat another.
    duplicates_dropped: usize,
    /// Triangles turned to face outward.
    triangles_turned: usize,
    /// What else was repaired.
    changes: Changes,
}

/// Checks that all is finite and converts to metres.
fn into_metres(
    soup: &mut [[Vector3<f64>; 3]],
    unit: LengthUnit,
    source: &str,
) -> Result<(), Error> {
    let file = || source.to_owned();
    if soup.len() > MOST_TRIANGLES {
        return Err(Error::TooManyTriangles {
            file: file(),
            triangles: soup.len(),
            most: MOST_TRIANGLES,
        });
    }
    let factor = unit.in_metres();
    for (triangle, corners) in soup.iter_mut().enumerate() {
        for (corner, point) in corners.iter_mut().enumerate() {
            if let Some(&value) = point
                .iter()
                .find(|value| value.abs() > LARGEST || value.is_nan())
            {
                return Err(Error::NotFinite {
                    file: file(),
                    triangle,
                    corner,
                    value,
                });
            }
            *point *= factor;
        }
    }
    Ok(())
}

/// Drops triangles that name the same corners in the same sense as an earlier one.
fn drop_repeated(triangles: &mut Vec<[usize; 3]>) -> usize {
    let canonical = |t: &[usize; 3]| {
        let first = (0..3).min_by_key(|&k| t[k]).unwrap_or(0);
        [t[first], t[(first + 1) % 3], t[(first + 2) % 3]]
    };
    let before = triangles.len();
    let mut seen = FxHashSet::with_capacity_and_hasher(before, FxBuildHasher);
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the number of triangles is limited"
    )]
    triangles.retain(|t| seen.insert(canonical(t).map(|index| index as u32)));
    before - triangles.len()
}

/// Removes vertices that no triangle uses.
fn drop_unused(vertices: &mut Vec<Vector3<f64>>, triangles: &mut [[usize; 3]]) {
    let mut used = vec![false; vertices.len()];
    triangles.iter().flatten().for_each(|&i| used[i] = true);
    let mut next = 0;
    let renamed: Vec<usize> = used
        .iter()
        .map(|&is_used| {
            let name = next;
            next += usize::from(is_used);
            name
        })
        .collect();
    triangles
        .iter_mut()
        .flatten()
        .for_each(|i| *i = renamed[*i]);
    let mut index = 0;
    vertices.retain(|_| {
        index += 1;
        used[index - 1]
    });
}

/// Refuses vertices that all lie in one plane.
fn refuse_flat(vertices: &[Vector3<f64>], source: &str) -> Result<(), Error> {
    let bounds = BoundingBox::of(vertices.iter());
    let scale = bounds.size().amax().max(SMALLEST);
    let n = vertices.len() as f64;
    let relative = || vertices.iter().map(|v| (v - bounds.centre()) / scale);
    let mean = relative().sum::<Vector3<f64>>() / n;
    let spread: Matrix3<f64> = relative()
        .map(|v| (v - mean) * (v - mean).transpose())
        .sum();
    let eigen = spread.symmetric_eigenvalues();
    let ratio = (eigen.min().max(0.0) / eigen.max().max(f64::MIN_POSITIVE)).sqrt();
    if ratio > FLATTEST && bounds.size().amax() > SMALLEST {
        return Ok(());
    }
    Err(Error::Flat {
        file: source.to_owned(),
        ratio,
    })
}

/// Warnings of a mesh and of what was repaired.
fn warnings_of(mesh: &TriMesh, unit: LengthUnit, repairs: &Repairs) -> Vec<Warning> {
    let topology = mesh.topology();
    let bounding_box = mesh.bounding_box();
    let counted = [
        (
            repairs.degenerate_dropped,
            Warning::DegenerateDropped as fn(usize) -> Warning,
        ),
        (repairs.duplicates_dropped, Warning::DuplicatesDropped),
        (repairs.triangles_turned, Warning::Turned),
        (repairs.changes.joined, Warning::Joined),
        (topology.open_edges, Warning::OpenEdges),
        (topology.non_manifold_edges, Warning::NonManifoldEdges),
    ];
    let mut warnings: Vec<Warning> = suspect_unit(bounding_box.size().amax(), unit)
        .into_iter()
        .collect();
    warnings.extend(
        counted
            .iter()
            .filter(|(n, _)| *n > 0)
            .map(|(n, warning)| warning(*n)),
    );
    warnings.extend(told_changes(&repairs.changes));
    if !topology.orientable {
        warnings.push(Warning::NotOrientable);
    }
    if topology.crossings > 0 {
        warnings.push(Warning::Crossings {
            pairs: topology.crossings,
            folded_share: topology.folded_share,
        });
    }
    if topology.watertight() && topology.bodies_apart < topology.bodies {
        warnings.push(Warning::BodiesCross {
            bodies: topology.bodies,
            way_out: Proposal::rebuilt(&bounding_box),
        });
    }
    if topology.shells > 1 {
        warnings.push(Warning::SeveralShells {
            shells: topology.shells,
            bodies: topology.bodies,
        });
    }
    warnings
}

/// Collects the figures.
fn report_of(
    mesh: &TriMesh,
    unit: LengthUnit,
    repairs: Repairs,
    warnings: Vec<Warning>,
) -> MeshReport {
    let topology = mesh.topology();
    MeshReport {
        source: mesh.source.clone(),
        unit,
        triangles: mesh.triangles.len(),
        vertices: mesh.vertices.len(),
        watertight: topology.watertight(),
        shells: topology.shells,
        degenerate_dropped: repairs.degenerate_dropped,
        duplicates_dropped: repairs.duplicates_dropped,
        triangles_turned: repairs.triangles_turned,
        holes_closed: repairs.changes.lids.len(),
        changes: repairs.changes,
        bounding_box: mesh.bounding_box(),
        area: (0..mesh.triangles.len())
            .map(|t| area_vector(&mesh.corners(t)).norm())
            .sum(),
        volume: topology.watertight().then(|| mesh.moments().volume),
        warnings,
    }
}

/// What was cut away and what was closed, as warnings.
pub(crate) fn told_changes(changes: &Changes) -> Vec<Warning> {
    let mut told = Vec::new();
    if changes.triangles_cut > 0 {
        told.push(Warning::CrumbsCut {
            pieces: changes.pieces_cut,
            triangles: changes.triangles_cut,
            share: changes.cut_share,
        });
    }
    if let Some(widest) = changes.lids.first() {
        told.push(Warning::HolesClosed {
            holes: changes.lids.len(),
            widest: widest.width,
            share: changes.lid_share,
        });
    }
    told
}
