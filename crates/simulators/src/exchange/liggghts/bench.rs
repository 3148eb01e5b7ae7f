//! A bench as a deck for LIGGGHTS: each wall is a mesh, from an STL file.
//!
//! # What is converted
//!
//! | here | LIGGGHTS |
//! |---|---|
//! | endless plane | a rectangle across the box of the simulation; both its sides touch |
//! | wall of triangles | the same triangles |
//! | prescribed motion | `fix move/mesh`, one for each of velocity, spin and vibration |
//! | wall under a load | `servo` of the mesh: a wall without mass, whose speed is in proportion to the force that is left |
//! | wall that is taken away | all walls are made again without it, since LIGGGHTS has one set of meshes: the tangential springs at walls start from 0 |
//! | seeds at their places | `read_data` of spheres, an insertion for each agglomerate |
//! | seeds that appear over time | `fix insert/rate/region` |

use super::TOOL;
use super::law::{Law, law};
use super::motion::{Liggghts, refuse_motions, touched};
use super::seeds::{placed, put, rain, spheres, spheres_file};
use crate::exchange::Error;
use crate::exchange::bench_deck::{AXES, BenchDeck, script, stl};
use crate::exchange::drum_deck::{are_spheres, plain_atoms, steps};
use crate::exchange::vtk::{File, add};
use dem_solver::AxialLoad;
use nalgebra::Vector3;
use scene::{Frame, Scene, SeedBody, Surface};
use std::sync::Arc;

/// Time between two insertions of poured seeds, s: in lots of 20 ms a narrow inlet has room for four fifths of 500 seeds a second.
const POUR: f64 = 5e-3;

/// Attempts for each seed: with the 50 of LIGGGHTS fewer seeds appear in a narrow inlet than the rate asks for.
const ATTEMPTS: &str = " maxattempt 1000";

/// Distance of a plane's rectangle from the faces of the box over the size of the box: a mesh must be inside.
const INSIDE: f64 = 1e-3;

/// The deck: `in.bench`, an STL file for each wall, and `bench.data` or a file of spheres for each kind of seeds.
pub(super) fn deck(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    (start, seed): (&Frame, u64),
    time_step: f64,
) -> Result<Vec<File>, Error> {
    let deck = BenchDeck::of(scene, bodies, time_step, TOOL)?;
    refuse_motions(&deck)?;
    let law = law(scene, &deck.materials(), bodies)?;
    let mut text = head(&deck, &law, start);
    text.push_str(&seeds(&deck, (start, seed)));
    text.push_str(&walls(&deck, &law));
    text.push_str(&script(&deck, &Liggghts { law: &law }));
    let file = |name: String, text| File { name, text };
    let mut files = vec![file("in.bench".into(), text)];
    for (wall, id) in deck.procedure.walls.iter().zip(&deck.ids) {
        let triangles = triangles(&deck, &wall.surface);
        files.push(file(format!("{id}.stl"), stl(id, &triangles)));
    }
    if !are_spheres(bodies) {
        let kinds = bodies.iter().enumerate();
        files.extend(kinds.map(|(k, body)| file(spheres_file(k), spheres(body))));
    } else if deck.procedure.inlet.is_none() {
        files.push(file("bench.data".into(), data(&deck, start)));
    }
    Ok(files)
}

/// Triangles of a wall, m: of a plane those of a rectangle across the box.
fn triangles(deck: &BenchDeck<'_>, surface: &Surface) -> Vec<[Vector3<f64>; 3]> {
    match surface {
        Surface::Triangles(triangles) => triangles.clone(),
        Surface::Plane { point, normal } => {
            let [low, high] = deck.domain;
            let inset = (high - low) * INSIDE;
            let (low, high) = (low + inset, high - inset);
            let axis = normal.iamax();
            let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
            let at = |u: f64, v: f64| {
                let mut corner = Vector3::zeros();
                (corner[a], corner[b]) = (u, v);
                // The height over the two other coordinates.
                corner[axis] = (normal.dot(point) - normal[a] * u - normal[b] * v) / normal[axis];
                corner
            };
            let corners = [
                at(low[a], low[b]),
                at(high[a], low[b]),
                at(high[a], high[b]),
                at(low[a], high[b]),
            ];
            let [p, q, r, s] = corners;
            if normal[axis] > 0.0 {
                vec![[p, q, r], [p, r, s]]
            } else {
                vec![[p, r, q], [p, s, r]]
            }
        }
    }
}

/// The head of the script up to the seeds.
fn head(deck: &BenchDeck<'_>, law: &Law, start: &Frame) -> String {
    let (scene, bodies) = (deck.scene, deck.bodies);
    let outer = bodies.iter().flat_map(|b| b.outer.spheres());
    let smallest = outer.map(|s| s.radius).fold(f64::INFINITY, f64::min);
    let [bins, sorted] = deck.bins(smallest);
    let [low, high] = deck.domain;
    let atoms = if are_spheres(bodies) && deck.procedure.inlet.is_none() {
        "read_data bench.data\n".to_owned()
    } else {
        format!(
            "region box block {:e} {:e} {:e} {:e} {:e} {:e} units box\ncreate_box {} box\n",
            low.x,
            high.x,
            low.y,
            high.y,
            low.z,
            high.z,
            deck.materials().len()
        )
    };
    format!(
        "# {} seeds in the apparatus '{}', written from {}; run it with -in, since it jumps to labels.\n\
         # Contacts are converted, not copied: the restitution is that of a dashpot with the mass of the rigid body,\n\
         # rolling friction that of the spheres' arm. {} seeds are where they start here.\n\
         units si\n\
         atom_style granular\n\
         atom_modify map array\n\
         boundary f f f\n\
         newton off\n\
         communicate single vel yes\n\
         hard_particles yes\n{}\
         {atoms}\
         neighbor {smallest:e} bin\n\
         neigh_modify delay 0{bins}\n\
         {sorted}\
         {}\
         pair_style gran {}{}\n\
         pair_coeff * *\n\
         timestep {:e}\n\
         fix weight all gravity {} vector 0.0 -1.0 0.0\n",
        scene.seed_count(),
        scene.apparatus.kind(),
        scene.file,
        start.position.len(),
        law.soft,
        law.properties,
        law.model,
        law.settings,
        deck.time_step,
        scene.model.gravity_m_s2,
    )
}

/// How the seeds get in and move.
fn seeds(deck: &BenchDeck<'_>, (start, seed): (&Frame, u64)) -> String {
    let (scene, bodies) = (deck.scene, deck.bodies);
    let are_spheres = are_spheres(bodies);
    let motion = if are_spheres {
        "fix seeds all nve/sphere\n"
    } else {
        "fix seeds all multisphere allow_group_and_set yes\n"
    };
    let energies = if are_spheres {
        "compute moving all ke\ncompute turning all erotate/sphere\n"
    } else {
        "compute moving all ke/multisphere\ncompute turning all erotate/multisphere\n"
    };
    let count = if are_spheres {
        "count(all)".to_owned()
    } else {
        scene.seed_count().to_string()
    };
    let variables = format!(
        "{energies}variable kinetic equal c_moving+c_turning\nvariable mass equal mass(all)\nvariable seeds equal {count}\n"
    );
    if let Some([radius, low, high]) = deck.inlet() {
        let every = steps(POUR, deck.time_step);
        let rain = rain(scene, bodies, (every, ATTEMPTS), seed);
        return format!(
            "region sky cylinder y 0.0 0.0 {radius:e} {low:e} {high:e} units box\n{rain}{motion}{variables}"
        );
    }
    if are_spheres {
        return format!("{motion}{variables}");
    }
    let (shapes, first) = (placed(bodies, start), put(start));
    format!("{shapes}{motion}{first}{variables}")
}

/// Spheres and their motion as a data file.
fn data(deck: &BenchDeck<'_>, start: &Frame) -> String {
    let [low, high] = deck.domain;
    let mut text = format!(
        "Seeds\n\n{} atoms\n{} atom types\n\n{:e} {:e} xlo xhi\n{:e} {:e} ylo yhi\n{:e} {:e} zlo zhi\n\nAtoms\n\n",
        start.position.len(),
        deck.materials().len(),
        low.x,
        high.x,
        low.y,
        high.y,
        low.z,
        high.z
    );
    text.push_str(&plain_atoms(deck.bodies, start));
    text
}

/// Meshes, their contacts and variables.
fn walls(deck: &BenchDeck<'_>, law: &Law) -> String {
    let materials = deck.materials();
    let mut text = String::new();
    for (k, wall) in deck.procedure.walls.iter().enumerate() {
        let id = &deck.ids[k];
        let kind = materials
            .iter()
            .position(|name| *name == wall.material)
            .unwrap_or(0)
            + 1;
        let load = deck.first_load(k);
        let servo = load.map(|load| servo(wall_centre(&wall.surface), &load));
        let [style, words] = match &servo {
            Some(servo) => ["/servo", servo],
            None => ["", ""],
        };
        add(
            &mut text,
            format_args!(
                "fix {id} all mesh/surface/stress{style} file {id}.stl type {kind}{words}\n"
            ),
        );
        if servo.is_some() {
            add(
                &mut text,
                format_args!("fix_modify {id} servo/integrate stop\n"),
            );
        }
        let centre = wall_centre(&wall.surface);
        for (axis, name) in AXES.iter().enumerate() {
            add(
                &mut text,
                format_args!("variable f{name}_{id} equal f_{id}[{}]\n", axis + 1),
            );
            if servo.is_some() {
                add(
                    &mut text,
                    format_args!(
                        "variable d{name}_{id} equal f_{id}[{}]-({:e})\n",
                        axis + 7,
                        centre[axis]
                    ),
                );
            } else if deck.motions_of(k).next().is_some() {
                add(&mut text, format_args!("variable d{name}_{id} equal 0.0\n"));
            }
        }
    }
    let all: Vec<usize> = (0..deck.ids.len()).collect();
    text + &touched(deck, law, &all)
}

/// The middle of the corners of a wall, m.
fn wall_centre(surface: &Surface) -> Vector3<f64> {
    match surface {
        Surface::Plane { point, .. } => *point,
        Surface::Triangles(triangles) => {
            let corners = triangles.iter().flatten();
            corners.sum::<Vector3<f64>>() / (3 * triangles.len()).max(1) as f64
        }
    }
}

/// Words of a servo.
fn servo(centre: Vector3<f64>, load: &AxialLoad) -> String {
    let axis = load.axis;
    format!(
        " com {:e} {:e} {:e} ctrlPV force axis {} {} {} target_val {:e} vel_max {:e} kp 1.0",
        centre.x, centre.y, centre.z, axis.x, axis.y, axis.z, load.force, load.greatest_speed,
    )
}
