//! What to ask for so that a damaged mesh bounds a body, by its fault.

use crate::BoundingBox;
use crate::crumbs::share_at_edges;
use crate::holes::width_of;
use crate::orientation::Edges;
use crate::weld::Welded;
use nalgebra::Vector3;
use serde::Serialize;

/// Largest share of the area that is proposed to be cut away: more is not a crumb but a part.
const MOST_CRUMBS: f64 = 0.02;

/// Open edges run along a crack where this share of their vertices has a vertex of another part of the rim nearer than half of
/// an edge.
const ALONG_CRACK: f64 = 0.9;

/// A rim that encloses less than this part of the square of its width is a slit, which no flat lid closes; a circle encloses
/// pi/8 = 0.39 of the square of the diagonal of its box.
const SLIT: f64 = 0.05;

/// Nodes of the grid on which a surface is proposed to be rebuilt: some seconds.
const NODES: f64 = 3e5;

/// The least change that closes a mesh or separates its bodies.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Proposal {
    /// Cut away crumbs of this share of the area.
    Crumbs(f64),
    /// Join vertices on open edges that lie this near to each other, m.
    Join(f64),
    /// Close holes of this width with flat lids, m.
    CloseHoles(f64),
    /// Make the surface again on cubes of this edge length, m.
    Rebuild(f64),
}

/// What was done already.
pub(crate) struct Tried {
    /// Share of the area that is cut away.
    pub(crate) cut_share: f64,
    /// Width up to which holes are closed where a flat lid fits, m.
    pub(crate) closed: f64,
}

impl Proposal {
    /// What would mend a mesh with open edges or with edges of more than two triangles.
    pub(crate) fn of(
        welded: &Welded,
        edges: &Edges,
        rims: &[Vec<usize>],
        shells: usize,
        tried: &Tried,
    ) -> Self {
        let vertices = &welded.vertices;
        let anew = Self::rebuilt(&BoundingBox::of(vertices.iter()));
        if !edges.crowded.is_empty() {
            let share = tried.cut_share + share_at_edges(welded, edges);
            return if share < MOST_CRUMBS {
                Self::Crumbs(1.2 * share)
            } else {
                anew
            };
        }
        if let Some(gap) = gap_of_crack(vertices, edges) {
            return Self::Join(1.1 * gap);
        }
        let widths = rims.iter().map(|rim| width_of(rim, vertices));
        let widest = widths.fold(0.0, f64::max);
        let is_slit =
            |rim: &Vec<usize>| enclosed(rim, vertices) < SLIT * width_of(rim, vertices).powi(2);
        // Lids on the two sides of a gap would make two bodies of one. Into a hole that is open though it might be closed, no lid fits.
        if shells > 1 || widest <= tried.closed || rims.iter().any(is_slit) {
            return anew;
        }
        Self::CloseHoles(1.01 * widest)
    }

    /// The surface rebuilt, as finely as some seconds allow.
    pub(crate) fn rebuilt(bounds: &BoundingBox) -> Self {
        Self::Rebuild((bounds.size().product() / NODES).cbrt())
    }
}

/// The flag of `seedfill`, with what it does.
impl std::fmt::Display for Proposal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mm = |length: f64| rounded_up(length * 1e3);
        match *self {
            Self::Crumbs(share) => write!(
                f,
                "cut away the triangles at them and loose pieces (seedfill: --crumbs {})",
                rounded_up(share * 100.0)
            ),
            Self::Join(distance) => write!(
                f,
                "join the open edges, which lie side by side (seedfill: --join {}mm)",
                mm(distance)
            ),
            Self::CloseHoles(width) => write!(
                f,
                "close them with flat lids (seedfill: --close-holes {}mm)",
                mm(width)
            ),
            Self::Rebuild(cell) => write!(
                f,
                "make the surface again (seedfill: --rebuild {}mm), or repair it in the scanning software",
                mm(cell)
            ),
        }
    }
}

/// A positive number with two digits, not smaller than it was; others stay.
pub(crate) fn rounded_up(x: f64) -> f64 {
    if x <= 0.0 {
        return x;
    }
    let unit = 10_f64.powf(x.log10().floor() - 1.0);
    let digits = (x / unit).ceil();
    // Through text, so that no digits of rounding are shown.
    format!("{:.1e}", digits * unit).parse().unwrap_or(x)
}

/// Width of the crack along which the open edges lie: the largest distance of a vertex on them to the nearest one that no open
/// edge joins it with, of those that have one nearer than half of their edges; none if these are too few.
fn gap_of_crack(vertices: &[Vector3<f64>], edges: &Edges) -> Option<f64> {
    let mut neighbours: Vec<[usize; 2]> = edges
        .open
        .iter()
        .flat_map(|&[a, b]| [[a, b], [b, a]])
        .collect();
    neighbours.sort_unstable();
    // Vertex, its neighbours on the rim, and half of the mean length of the edges to them.
    let mut at_rims: Vec<(usize, &[[usize; 2]], f64)> = neighbours
        .chunk_by(|a, b| a[0] == b[0])
        .map(|own| {
            let length = |&[a, b]: &[usize; 2]| (vertices[a] - vertices[b]).norm();
            let half = 0.5 * own.iter().map(length).sum::<f64>() / own.len() as f64;
            (own[0][0], own, half)
        })
        .collect();
    at_rims.sort_by(|a, b| vertices[a.0].x.total_cmp(&vertices[b.0].x));
    let count = at_rims.len();
    let mut gaps = Vec::new();
    for (place, &(vertex, own, half)) in at_rims.iter().enumerate() {
        let at = vertices[vertex];
        let near = |k: &usize| (vertices[at_rims[*k].0].x - at.x).abs() < half;
        let before = (0..place).rev().take_while(near);
        let others = before.chain((place + 1..count).take_while(near));
        let apart = others
            .map(|k| at_rims[k].0)
            .filter(|other| own.iter().all(|[_, joined]| joined != other))
            .map(|other| (vertices[other] - at).norm());
        gaps.extend(apart.min_by(f64::total_cmp).filter(|gap| *gap < half));
    }
    let along = gaps.len() as f64 >= ALONG_CRACK * count as f64;
    gaps.into_iter().max_by(f64::total_cmp).filter(|_| along)
}

/// Area that a rim encloses, seen from where it is largest, m².
fn enclosed(rim: &[usize], vertices: &[Vector3<f64>]) -> f64 {
    let origin = rim.first().map_or_else(Vector3::zeros, |&i| vertices[i]);
    let next = rim.iter().cycle().skip(1);
    let fans = rim.iter().zip(next);
    let sum: Vector3<f64> = fans
        .map(|(&a, &b)| (vertices[a] - origin).cross(&(vertices[b] - origin)))
        .sum();
    0.5 * sum.norm()
}

#[cfg(test)]
mod tests {
    use super::{Proposal, Tried, rounded_up};
    use crate::build::build;
    use crate::holes::rims_of;
    use crate::orientation::Edges;
    use crate::weld::weld;
    use crate::{LengthUnit, Repair, Warning, shapes};
    use nalgebra::Vector3;

    const MM: LengthUnit = LengthUnit::Millimetre;

    /// The triangles of a ball of 4 mm, mm.
    fn ball() -> Vec<[Vector3<f64>; 3]> {
        let ball = shapes::ellipsoid([2e-3; 3], 40).unwrap();
        (0..ball.triangles().len())
            .map(|t| ball.corners(t).map(|c| c * 1e3))
            .collect()
    }

    /// What is proposed for a mesh; that mends it.
    fn proposed(soup: &[[Vector3<f64>; 3]]) -> Option<Proposal> {
        let read = |repair: &Repair| build(soup.to_vec(), MM, "ball", repair, Vec::new()).unwrap();
        let mut repair = Repair::default();
        let way_out = read(&repair).mesh.topology().way_out;
        match way_out {
            None => {}
            Some(Proposal::Crumbs(share)) => repair.crumbs = share,
            Some(Proposal::Join(distance)) => repair.join = Some(distance),
            Some(Proposal::CloseHoles(width)) => repair.close_holes = Some(width),
            Some(Proposal::Rebuild(cell)) => repair.rebuild = Some(cell),
        }
        read(&repair).mesh.require_closed().unwrap();
        way_out
    }

    fn middle(t: &[Vector3<f64>; 3]) -> Vector3<f64> {
        (t[0] + t[1] + t[2]) / 3.0
    }

    #[test]
    fn a_whole_mesh_needs_nothing() {
        assert_eq!(proposed(&ball()), None);
    }

    /// A cap of the ball is cut off at x = 1 mm: the rim has the radius sqrt(4 - 1) mm, so that the diagonal of its box is at
    /// most 2 sqrt(2) times as much; the cut follows the edges, which are at most 0.3 mm long.
    #[test]
    fn a_hole_is_closed_by_its_width() {
        let mut soup = ball();
        soup.retain(|t| middle(t).x < 1.0);
        let Some(Proposal::CloseHoles(width)) = proposed(&soup) else {
            unreachable!("{:?}", proposed(&soup));
        };
        assert!((4.4e-3..5.5e-3).contains(&width), "{width}");
    }

    /// A hole that stays open though flat lids of its width were allowed is not proposed to be closed by one again.
    #[test]
    fn what_was_tried_is_not_proposed_again() {
        let mut soup = ball();
        soup.retain(|t| middle(t).x < 1.0);
        let welded = weld(&soup);
        let edges = Edges::new(&welded.triangles);
        let rims = rims_of(&welded.triangles, &edges);
        let after = |closed: f64| {
            let tried = Tried {
                cut_share: 0.0,
                closed,
            };
            Proposal::of(&welded, &edges, &rims, 1, &tried)
        };
        assert!(matches!(after(1.0), Proposal::CloseHoles(_)));
        assert!(matches!(after(10.0), Proposal::Rebuild(_)));
    }

    /// A cup whose rim has short edges between long ones, so that each vertex has a neighbour nearer than half of its edges: no
    /// crack, for an open edge joins them.
    #[test]
    fn uneven_edges_of_a_rim_are_no_crack() {
        let at = |k: usize| {
            let degrees = 60.0 * (k / 2) as f64 + 5.0 * (k % 2) as f64;
            let (y, x) = degrees.to_radians().sin_cos();
            Vector3::new(3.0 * x, 3.0 * y, 0.0)
        };
        let bottom = Vector3::new(0.0, 0.0, -4.0);
        let cup: Vec<_> = (0..12).map(|k| [bottom, at((k + 1) % 12), at(k)]).collect();
        assert!(matches!(proposed(&cup), Some(Proposal::CloseHoles(_))));
    }

    /// Two halves, 0.02 mm apart where they were cut: that distance and a tenth.
    #[test]
    fn a_crack_is_joined_by_its_gap() {
        let mut soup = ball();
        for t in &mut soup {
            if middle(t).x > 0.0 {
                *t = t.map(|c| c + Vector3::new(0.02, 0.0, 0.0));
            }
        }
        let Some(Proposal::Join(gap)) = proposed(&soup) else {
            unreachable!("{:?}", proposed(&soup));
        };
        assert!((gap / 2.2e-5 - 1.0).abs() < 1e-6, "{gap}");
    }

    /// Halves that lie farther apart than their edges are long are not a crack; two lids would make two bodies. A slit is closed by
    /// no flat lid.
    #[test]
    fn a_wide_gap_and_a_slit_are_made_anew() {
        let mut soup = ball();
        for t in &mut soup {
            if middle(t).x > 0.0 {
                *t = t.map(|c| c + Vector3::new(0.5, 0.0, 0.0));
            }
        }
        assert!(matches!(proposed(&soup), Some(Proposal::Rebuild(_))));
        let mut soup = ball();
        soup.retain(|t| middle(t).x.abs() > 0.1 || middle(t).y < 0.0);
        assert!(matches!(proposed(&soup), Some(Proposal::Rebuild(_))));
    }

    /// Fins on one in 640 triangles, which have two neighbours each: more than the 0.1 % of the area that is cut away unasked, less
    /// than 2 %.
    #[test]
    fn fins_are_cut_away_by_their_share() {
        let mut soup = ball();
        let fins: Vec<_> = soup
            .iter()
            .skip(400)
            .step_by(640)
            .map(|t| [t[0], t[1], t[0] * 1.1])
            .collect();
        soup.extend(fins);
        let Some(Proposal::Crumbs(share)) = proposed(&soup) else {
            unreachable!("{:?}", proposed(&soup));
        };
        assert!((1e-3..2e-2).contains(&share), "{share}");
    }

    /// What the refusal of several bodies proposes makes one body of them: those that cross are joined, which has the volume of
    /// their union, of others the largest is kept. Boxes of 9 x 5 x 4 mm; the second is shifted by 6 mm along x, 0.7 and 0.4 mm
    /// across. Cubes of 0.1 mm round edges and corners off: 1 %.
    #[test]
    fn several_bodies_are_joined_or_parted_as_the_refusal_proposes() {
        let cuboid = shapes::cuboid([9.0, 5.0, 4.0]).unwrap();
        let at = |x: f64| -> Vec<[Vector3<f64>; 3]> {
            let shift = Vector3::new(x, 0.7, 0.4);
            let corners = |t: usize| cuboid.corners(t).map(|c| c + shift);
            (0..cuboid.triangles().len()).map(corners).collect()
        };
        let first = || {
            at(0.0)
                .iter()
                .map(|t| t.map(|c| c - Vector3::new(0.0, 0.7, 0.4)))
                .collect()
        };
        let union = 360.0 - 3.0 * 4.3 * 3.6;
        let join = "cross each other: make the surface again (seedfill: --rebuild ";
        let keep = "keep the largest (seedfill: --largest-body)";
        let cases: [(Vec<Vec<_>>, [bool; 2], f64); 3] = [
            (vec![first(), at(6.0)], [true, false], union),
            (vec![first(), at(20.0)], [false, true], 180.0),
            (vec![first(), at(6.0), at(30.0)], [true, true], union),
        ];
        for (bodies, proposed, volume) in cases {
            let soup = bodies.concat();
            let with =
                |repair: &Repair| build(soup.clone(), MM, "boxes", repair, Vec::new()).unwrap();
            let refused = with(&Repair::default());
            let message = refused.mesh.require_closed().unwrap_err().to_string();
            assert_eq!(
                [message.contains(join), message.contains(keep)],
                proposed,
                "{message}"
            );
            let crossing = |w: &Warning| matches!(w, Warning::BodiesCross { .. });
            assert_eq!(refused.report.warnings.iter().any(crossing), proposed[0]);
            let cell = message
                .split_once(join)
                .map(|(_, rest)| rest.split_once("mm)").unwrap().0);
            if proposed == [true, false] {
                // Followed with the third body.
                continue;
            }
            let read = with(&Repair {
                rebuild: cell.map(|cell| 1e-3 * cell.parse::<f64>().unwrap()),
                ..Repair::default()
            });
            let body = if proposed[1] {
                read.mesh.largest_body().unwrap()
            } else {
                read
            };
            body.mesh.require_closed().unwrap();
            let found = body.report.volume.unwrap() * 1e9;
            assert!(
                (found / volume - 1.0).abs() < 0.01,
                "{found} instead of {volume}"
            );
        }
    }

    /// What is pasted is never too small, and has two digits.
    #[test]
    fn lengths_are_rounded_up_to_two_digits() {
        for (x, expected) in [
            (0.0201, 0.021),
            (6.77, 6.8),
            (12.0, 12.0),
            (99.9, 100.0),
            (0.3, 0.3),
            (0.0, 0.0),
        ] {
            assert_eq!(rounded_up(x).to_string(), expected.to_string());
        }
        assert_eq!(
            Proposal::Join(2.2e-5).to_string(),
            "join the open edges, which lie side by side (seedfill: --join 0.022mm)"
        );
    }
}
