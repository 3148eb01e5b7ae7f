//! Walls of a bench as regions of LAMMPS.

use super::TOOL;
use crate::exchange::Error;
use crate::exchange::bench_deck::surfaces::{Part, parts};
use crate::exchange::bench_deck::{AXES, BenchDeck};
use crate::exchange::drum_deck::are_spheres;
use crate::exchange::vtk::add;
use nalgebra::{Matrix3, Rotation3, Vector3};
use scene::Surface;

/// Height of a ring over its radius.
const FLAT: f64 = 1e-6;

/// The regions of each wall, as the words behind `region NAME`, and the axis and angle by which they are turned.
pub(super) type Regions = Vec<Vec<Region>>;

/// Shape of a part of a wall in the words of the deck, and the axis and angle by which it is turned.
pub(super) type Region = (String, Option<(Vector3<f64>, f64)>);

fn missing(what: String, way_out: &'static str) -> Error {
    Error::NotThere {
        what,
        tool: TOOL,
        way_out,
    }
}

/// The walls as regions, or what cannot be one.
pub(super) fn regions(deck: &BenchDeck<'_>) -> Result<Regions, Error> {
    if deck.procedure.inlet.is_some() && !are_spheres(deck.bodies) {
        return Err(missing(
            "seeds of several spheres that appear over time".into(),
            "pour spheres, or export for LIGGGHTS",
        ));
    }
    let mut all = Vec::new();
    for (k, wall) in deck.procedure.walls.iter().enumerate() {
        let spins: Vec<_> = deck
            .motions_of(k)
            .map(|m| m.spin)
            .filter(|w| w.norm() > 0.0)
            .collect();
        let of_wall = match &wall.surface {
            Surface::Plane {
                point: p,
                normal: n,
            } => {
                vec![(
                    format!(
                        "plane {:e} {:e} {:e} {} {} {}",
                        p.x, p.y, p.z, n.x, n.y, n.z
                    ),
                    None,
                )]
            }
            Surface::Triangles(triangles) => {
                let Some(parts) = parts(triangles) else {
                    return Err(missing(
                        format!("wall '{}' of triangles", wall.name),
                        "remove it, or export for LIGGGHTS: regions are planes, rectangles and surfaces of revolution",
                    ));
                };
                parts.iter().map(|part| region(deck, part)).collect()
            }
        };
        let is_turned = of_wall.iter().any(|(_, turn)| turn.is_some());
        let one = spins.first().copied().unwrap_or_default();
        let two_axes = spins
            .iter()
            .any(|w| w.cross(&one).norm() > 1e-9 * w.norm() * one.norm());
        if two_axes || (is_turned && !spins.is_empty()) {
            return Err(missing(
                format!("wall '{}', which spins about two axes", wall.name),
                "export for LIGGGHTS: a region turns about one axis, and an inclined rectangle or a disc is turned already",
            ));
        }
        all.push(of_wall);
    }
    Ok(all)
}

/// A part of a wall as the words of a region, and how it is turned.
fn region(deck: &BenchDeck<'_>, part: &Part) -> (String, Option<(Vector3<f64>, f64)>) {
    let thick = 8.0
        * deck
            .bodies
            .iter()
            .map(|b| b.clump.bounding_radius())
            .fold(0.0, f64::max);
    match part {
        Part::Rectangle {
            corner,
            edges: [a, b],
        } => rectangle(corner, [a, b], thick),
        Part::Revolved {
            axis,
            centre,
            circles,
        } => {
            let across = [(axis + 1) % 3, (axis + 2) % 3];
            let (mut c1, mut c2) = (centre[across[0]], centre[across[1]]);
            // LAMMPS names the two coordinates in the order of the alphabet.
            if *axis == 1 {
                std::mem::swap(&mut c1, &mut c2);
            }
            let [mut from, mut to] = *circles;
            if from[1] > to[1] {
                std::mem::swap(&mut from, &mut to);
            }
            let [[r0, y0], [r1, y1]] = [from, to];
            let name = AXES[*axis];
            let words = if (r0 - r1).abs() <= 1e-9 * r0.max(r1) {
                format!("cylinder {name} {c1:e} {c2:e} {r0:e} {y0:e} {y1:e} side in open 1 open 2")
            } else if y1 - y0 > FLAT * r0.max(r1) {
                format!(
                    "cone {name} {c1:e} {c2:e} {r0:e} {r1:e} {y0:e} {y1:e} side in open 1 open 2"
                )
            } else if r0.min(r1) > 0.0 {
                let (small, large) = (r0.min(r1), r0.max(r1));
                let top = y0 + FLAT * large;
                format!(
                    "cone {name} {c1:e} {c2:e} {small:e} {large:e} {y0:e} {top:e} side in open 1 open 2"
                )
            } else {
                return disc(*axis, centre, [r0.max(r1), y0], thick);
            };
            (words, None)
        }
    }
}

/// A disc: the lower end of a cylinder along z, turned to its axis about its middle. Ends of cylinders along y push along z in LAMMPS of
/// July 2025.
fn disc(
    axis: usize,
    centre: &Vector3<f64>,
    [radius, place]: [f64; 2],
    thick: f64,
) -> (String, Option<(Vector3<f64>, f64)>) {
    let mut middle = *centre;
    middle[axis] = place;
    let words = format!(
        "cylinder z {:e} {:e} {radius:e} {:e} {:e} side in open 2 open 3",
        middle.x,
        middle.y,
        middle.z,
        middle.z + thick
    );
    let quarter = std::f64::consts::FRAC_PI_2;
    match axis {
        0 => (words, Some((Vector3::y(), quarter))),
        1 => (words, Some((-Vector3::x(), quarter))),
        _ => (words, None),
    }
    .about(middle)
}

/// Puts the point about which a region turns into its words.
trait About {
    fn about(self, middle: Vector3<f64>) -> Self;
}

impl About for (String, Option<(Vector3<f64>, f64)>) {
    fn about(mut self, middle: Vector3<f64>) -> Self {
        if let Some((axis, angle)) = self.1 {
            add(
                &mut self.0,
                format_args!(
                    " rotate {angle:e} {:e} {:e} {:e} {} {} {}",
                    middle.x, middle.y, middle.z, axis.x, axis.y, axis.z
                ),
            );
        }
        self
    }
}

/// A rectangle: the lower z face of a block.
fn rectangle(
    corner: &Vector3<f64>,
    [a, b]: [&Vector3<f64>; 2],
    thick: f64,
) -> (String, Option<(Vector3<f64>, f64)>) {
    let normal = a.cross(b).normalize();
    let upright = (0..3).find(|k| normal[*k].abs() > 1.0 - 1e-12);
    let along = |v: &Vector3<f64>| (0..3).any(|k| v[k].abs() > (1.0 - 1e-12) * v.norm());
    if let (Some(axis), true, true) = (upright, along(a), along(b)) {
        let (low, mut high) = (corner.inf(&(corner + a + b)), corner.sup(&(corner + a + b)));
        high[axis] = low[axis] + thick;
        let open: Vec<String> = (1..=6)
            .filter(|face| *face != 2 * axis + 1)
            .map(|face| format!("open {face}"))
            .collect();
        let words = format!(
            "block {:e} {:e} {:e} {:e} {:e} {:e} side in {}",
            low.x,
            high.x,
            low.y,
            high.y,
            low.z,
            high.z,
            open.join(" ")
        );
        return (words, None);
    }
    let middle = corner + 0.5 * (a + b);
    let (half, other) = (0.5 * a.norm(), 0.5 * b.norm());
    let words = format!(
        "block {:e} {:e} {:e} {:e} {:e} {:e} side in open 1 open 2 open 3 open 4 open 6",
        middle.x - half,
        middle.x + half,
        middle.y - other,
        middle.y + other,
        middle.z,
        middle.z + thick
    );
    let frame = Matrix3::from_columns(&[a.normalize(), b.normalize(), normal]);
    let turn = Rotation3::from_matrix_unchecked(frame);
    let (axis, angle) = turn
        .axis_angle()
        .map_or((Vector3::z(), 0.0), |(axis, angle)| {
            (axis.into_inner(), angle)
        });
    (words, Some((axis, angle))).about(middle)
}

/// A region that is turned by a constant angle, which LAMMPS takes from a variable.
pub(super) fn constant_turn(shape: &str, is_turned: bool, name: &str) -> (String, String) {
    let Some((before, behind)) = shape.split_once(" rotate ").filter(|_| is_turned) else {
        return (shape.to_owned(), String::new());
    };
    let (angle, rest) = behind.split_once(' ').unwrap_or((behind, ""));
    (
        format!("{before} rotate v_angle_{name} {rest}"),
        format!("variable angle_{name} equal {angle}\n"),
    )
}

/// The turn of a wall that spins about one axis.
pub(super) fn spin_of(deck: &BenchDeck<'_>, wall: usize) -> String {
    let about = deck.procedure.walls[wall].about;
    let mut spins = deck.motions_of(wall).map(|motion| motion.spin);
    let axis = spins
        .find(|w| w.norm() > 0.0)
        .unwrap_or_else(Vector3::z)
        .normalize();
    format!(
        " rotate v_turn_{} {:e} {:e} {:e} {} {} {}",
        deck.ids[wall], about.x, about.y, about.z, axis.x, axis.y, axis.z
    )
}
