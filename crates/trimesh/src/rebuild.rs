//! A closed surface from a damaged one: round all points that it encloses more than half.

use crate::build::{build, told_changes};
use crate::crumbs::cut_crumbs;
use crate::weld::weld;
use crate::winding_tree::WindingTree;
use crate::{
    Changes, CheckedMesh, CubeGrid, Error, LengthUnit, MeshReport, Rebuilt, Repair, Warning,
};
use nalgebra::Vector3;

/// Most nodes of the grid: half a minute.
const MOST_NODES: f64 = 1e7;

/// Winding number from which a point counts as inside.
const INSIDE: f64 = 0.5;

/// Halvings of an edge: a corner lies within a hundredth of an edge of the surface.
const HALVINGS: u32 = 6;

/// Makes a mesh again on cubes of an edge length `cell` (m): its surface parts points round which the mesh goes more than half
/// from all others.
///
/// Crossings, folds, overlapping bodies, cracks and holes leave no trace but where a hole was, over which the surface goes smoothly;
/// details finer than a cell are lost. Loose pieces of the new surface, as noise leaves them, are cut away up to a share `crumbs`
/// of its area.
///
/// # Source
///
/// `[Jacobson2013, section 4]`: the winding number of a surface with holes grades between 0 outside and 1 inside.
///
/// # Errors
///
/// A cell that is not a positive number, so small that the grid has more nodes than are handled, or so large that nothing is inside; a
/// result that holds no body.
pub(crate) fn rebuild(checked: CheckedMesh, cell: f64, crumbs: f64) -> Result<CheckedMesh, Error> {
    let CheckedMesh { mesh, report } = checked;
    let cell_mm = cell * 1e3;
    let unfit = |least_mm| Error::RebuildCell {
        file: report.source.clone(),
        cell_mm,
        least_mm,
        most_mm: report.bounding_box.size().min() * 0.5e3,
    };
    if !(cell.is_finite() && cell > 0.0) {
        return Err(unfit(0.0));
    }
    let bounds = report.bounding_box;
    let grid = CubeGrid::around(bounds.low, bounds.high, cell, MOST_NODES)
        .map_err(|nodes| unfit(cell_mm * (nodes / MOST_NODES).cbrt() * 1.05))?;
    let corners = (0..mesh.triangles().len()).map(|t| mesh.corners(t));
    let tree = WindingTree::new(corners.collect());
    let is_inside = |place: &Vector3<f64>| tree.winding_number(place) > INSIDE;
    let inside = on_all_threads(grid.nodes(), |node| is_inside(&grid.place(node)));
    let mut edges = Vec::new();
    grid.boundary(&inside, |inner, outer| {
        edges.push([inner, outer]);
        0.5
    });
    edges.sort_unstable();
    edges.dedup();
    let shares = on_all_threads(edges.len(), |k| {
        let [from, to] = edges[k].map(|node| grid.place(node));
        last_inside(|share| is_inside(&(from + (to - from) * share)))
    });
    let soup = grid.boundary(&inside, |inner, outer| {
        let place = edges.binary_search(&[inner, outer]);
        place.map_or(0.5, |place| shares[place])
    });
    if soup.is_empty() {
        return Err(unfit(cell_mm * (grid.nodes() as f64 / MOST_NODES).cbrt()));
    }
    let mut welded = weld(&soup);
    let mut cut = Changes::default();
    cut_crumbs(&mut welded, crumbs, &mut cut);
    let corners = |t: &[usize; 3]| t.map(|i| welded.vertices[i]);
    let soup = welded.triangles.iter().map(corners).collect();
    let topology = mesh.topology();
    let rebuilt = Rebuilt {
        cell,
        open_edges: topology.open_edges,
        crossings: topology.crossings,
    };
    let new = build(
        soup,
        LengthUnit::Metre,
        &report.source,
        &Repair::default(),
        Vec::new(),
    )?;
    Ok(CheckedMesh {
        mesh: new.mesh,
        report: told(report, new.report, rebuilt, &cut),
    })
}

/// A function of each number below a count, in their order.
fn on_all_threads<T: Clone + Default + Send>(
    count: usize,
    of: impl Fn(usize) -> T + Sync,
) -> Vec<T> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut found = vec![T::default(); count];
    let part = count.div_ceil(threads).max(1);
    std::thread::scope(|scope| {
        for (k, part_of_found) in found.chunks_mut(part).enumerate() {
            let of = &of;
            scope.spawn(move || {
                for (i, found) in part_of_found.iter_mut().enumerate() {
                    *found = of(k * part + i);
                }
            });
        }
    });
    found
}

/// Share of an edge on which it leaves the inside, by halving; it begins inside.
fn last_inside(is_inside: impl Fn(f64) -> bool) -> f64 {
    let (mut inner, mut outer) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (inner + outer);
        if is_inside(middle) {
            inner = middle;
        } else {
            outer = middle;
        }
    }
    0.5 * (inner + outer)
}

/// The report of the new mesh, with what was found and changed before, and the crumbs that were cut from it.
fn told(old: MeshReport, new: MeshReport, rebuilt: Rebuilt, cut: &Changes) -> MeshReport {
    let mut changes = old.changes;
    changes.pieces_cut += cut.pieces_cut;
    changes.triangles_cut += cut.triangles_cut;
    changes.cut_share += cut.cut_share;
    changes.rebuilt = Some(rebuilt);
    // The new mesh ends with no lid.
    changes.lid_triangles = 0;
    let gone = |warning: &Warning| {
        matches!(
            warning,
            Warning::OpenEdges(_)
                | Warning::NonManifoldEdges(_)
                | Warning::NotOrientable
                | Warning::Crossings { .. }
                | Warning::CrossingsUnfinished
                | Warning::BodiesCross { .. }
                | Warning::SeveralShells { .. }
        )
    };
    let mut warnings = old.warnings;
    warnings.retain(|warning| !gone(warning));
    warnings.push(Warning::Rebuilt(rebuilt));
    warnings.extend(told_changes(cut));
    let known = |warning: &Warning| matches!(warning, Warning::UnitSuspect { .. });
    warnings.extend(new.warnings.into_iter().filter(|warning| !known(warning)));
    MeshReport {
        unit: old.unit,
        degenerate_dropped: old.degenerate_dropped,
        duplicates_dropped: old.duplicates_dropped,
        triangles_turned: old.triangles_turned,
        holes_closed: old.holes_closed,
        changes,
        warnings,
        ..new
    }
}

#[cfg(test)]
mod tests {
    use crate::build::build;
    use crate::{CheckedMesh, Error, LengthUnit, Repair, TriMesh, Warning, shapes};
    use nalgebra::Vector3;
    use std::f64::consts::PI;

    type Soup = Vec<[Vector3<f64>; 3]>;

    /// Triangles of a ball about a place, mm.
    fn ball(x: f64, radius: f64) -> Soup {
        let mesh = shapes::ellipsoid([1.0, 1.0, 1.0], 40).unwrap();
        (0..mesh.triangles().len())
            .map(|t| {
                mesh.corners(t)
                    .map(|c| c * radius + Vector3::new(x, 0.0, 0.0))
            })
            .collect()
    }

    /// The mesh of loose triangles (mm), rebuilt on cubes of an edge length (mm) or as it is.
    fn read(soup: Soup, cell: Option<f64>) -> Result<CheckedMesh, Error> {
        let repair = Repair {
            rebuild: cell.map(|cell| cell * 1e-3),
            ..Repair::default()
        };
        build(soup, LengthUnit::Millimetre, "soup", &repair, Vec::new())
    }

    /// Volume of a closed mesh of one shell, mm³.
    fn volume(mesh: &TriMesh) -> f64 {
        mesh.require_closed().unwrap();
        assert_eq!(mesh.topology().shells, 1);
        assert_eq!(mesh.topology().crossings, 0);
        mesh.moments().volume * 1e9
    }

    /// A whole ball loses what facets with their corners on it cut off: 0.3 (cell / radius)^2 of its volume, as measured on
    /// unions of spheres on the same cubes, and what a corner may be moved.
    #[test]
    fn a_whole_body_stays_what_it_was() {
        let whole = volume(&read(ball(0.1, 2.0), None).unwrap().mesh);
        for cell in [0.4, 0.2] {
            let new = read(ball(0.1, 2.0), Some(cell)).unwrap();
            let lost = 1.0 - volume(&new.mesh) / whole;
            assert!(
                lost > 0.0 && lost < 0.5 * (cell / 2.0_f64).powi(2),
                "{cell}: {lost}"
            );
            assert!(matches!(new.report.warnings[..], [Warning::Rebuilt(_)]));
        }
    }

    /// Two balls that share a lens become one body of the volume of their union (closed form); read as they are they cross.
    #[test]
    fn bodies_that_overlap_become_one() {
        let both = [ball(0.0, 2.0), ball(2.4, 2.0)].concat();
        let as_is = read(both.clone(), None).unwrap();
        assert!(as_is.mesh.topology().crossings > 0 && as_is.mesh.topology().shells == 2);
        let lens = PI * (8.0 + 2.4) * (4.0_f64 - 2.4).powi(2) / 12.0;
        let union = 2.0 * 4.0 / 3.0 * PI * 8.0 - lens;
        let found = volume(&read(both, Some(0.15)).unwrap().mesh);
        assert!((found / union - 1.0).abs() < 0.01, "{found} for {union}");
    }

    /// Damage to a ball of 2 mm that is refused as it is, and what it may cost: a bottom that is open below 1.2 mm and the row of
    /// triangles there (a cap of 10.4 to 13.9 % of the volume, which a surface through the rim cuts off), one triangle in thirty missing, and corners thrown
    /// about by 0.08 mm each on its own, so that all edges are cracks and triangles cross.
    #[test]
    fn damaged_bodies_are_bodies_again() {
        let exact = 4.0 / 3.0 * PI * 8.0;
        let open: Soup = ball(0.0, 2.0)
            .into_iter()
            .filter(|t| t.iter().all(|c| c.z > -1.2))
            .collect();
        let holes: Soup = ball(0.0, 2.0)
            .into_iter()
            .enumerate()
            .filter(|(k, _)| k % 30 != 7)
            .map(|(_, t)| t)
            .collect();
        let mut turn = 0_u32;
        let mut thrown = || {
            turn = turn.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            0.16 * (f64::from(turn >> 8) / f64::from(1 << 24) - 0.5)
        };
        let noisy: Soup = ball(0.0, 2.0)
            .into_iter()
            .map(|t| t.map(|c| c + Vector3::new(thrown(), thrown(), thrown())))
            .collect();
        for (name, soup, cost) in [
            ("open", open, [-0.139, -0.08]),
            ("holes", holes, [-0.01, 0.01]),
            ("noisy", noisy, [-0.03, 0.03]),
        ] {
            let as_is = read(soup.clone(), None).unwrap();
            as_is.mesh.require_closed().unwrap_err();
            let new = read(soup, Some(0.2)).unwrap();
            // Crumbs may come loose where triangles are thrown about.
            let body = new.mesh.largest_body().unwrap().mesh;
            let off = volume(&body) / exact - 1.0;
            assert!((cost[0]..cost[1]).contains(&off), "{name}: {off}");
            let told = new.report.changes.rebuilt.unwrap();
            assert!(told.open_edges > 0, "{name}");
        }
    }

    /// A mote beside a ball with a hole, of which the volume is a thousandth and the area a hundredth: cut away from 1 % on and told,
    /// else a second body.
    #[test]
    fn crumbs_of_the_new_surface_are_cut_away() {
        let soup = [ball(0.0, 2.0).split_off(1), ball(3.0, 0.19)].concat();
        for (crumbs, shells) in [(0.02, 1), (0.001, 2)] {
            let repair = Repair {
                rebuild: Some(0.1e-3),
                crumbs,
                ..Repair::default()
            };
            let new = build(
                soup.clone(),
                LengthUnit::Millimetre,
                "soup",
                &repair,
                Vec::new(),
            );
            let new = new.unwrap();
            assert_eq!(new.mesh.topology().shells, shells);
            assert_eq!(new.report.changes.pieces_cut, 2 - shells);
            let told = new.report.warnings.iter();
            let cut = told.filter(|w| matches!(w, Warning::CrumbsCut { pieces: 1, .. }));
            assert_eq!(cut.count(), 2 - shells);
        }
    }

    /// Cubes that are not a length, too small for the memory, or larger than the body: refused with the lengths that work.
    #[test]
    fn cubes_that_cannot_be_meant_are_refused() {
        for cell in [0.0, -1.0, f64::NAN, 1e-3, 9.0] {
            let error = read(ball(0.0, 2.0), Some(cell)).unwrap_err();
            assert!(
                matches!(error, Error::RebuildCell { .. }),
                "{cell}: {error}"
            );
        }
    }
}
