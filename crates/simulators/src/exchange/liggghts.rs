//! A drum or a bench as a deck for LIGGGHTS-PUBLIC 3.8 (`fix multisphere`); walls of a bench are STL files.
//!
//! # What is converted
//!
//! | here | LIGGGHTS |
//! |---|---|
//! | moduli of each material | the same: one type of atoms for the seeds, one for the shell, one for the covers |
//! | dashpot with the mass of the sphere | LIGGGHTS takes that of the rigid body: the ratio b is scaled by sqrt(`m_sphere` / `m_body`) and turned back into a restitution |
//! | clipped end of the normal force | `limitForce on` |
//! | rolling friction of type A with the arm of the body or of the sphere | `rolling_friction cdt torsionTorque on`, whose arm is the reduced radius of the spheres: with the arm of the body the coefficient is scaled by arm over radius |
//! | rolling friction of type C | `rolling_friction epsd2`, whose spring is `k_t R*²` for 2.25 of that here, without the dashpot here; the limit is the same |
//! | cohesion by the area of contact | `cohesion sjkr` |
//! | mass and inertia of the seed | `mass` and `inertia_tensor` of the template |
//! | places of the seeds | [`deck`] lets seeds rain into the turning drum, and puts those of a bench where they start here; [`setup`] can also put each where a frame has it, by an insertion of its own |

mod bench;
mod law;
mod motion;
mod seeds;

use crate::exchange::Error;
use crate::exchange::bench_deck;
use crate::exchange::drum_deck::{FINER, are_spheres, steps, supported};
use crate::exchange::vtk::File;
use dem_solver::DashpotMass;
use input::quantity::Frequency;
use law::{Law, law, refuse_values, surfaces};
use scene::{Drum, Frame, Scene, SeedBody};
use seeds::{placed, put, rain, spheres, spheres_file};
use std::sync::Arc;

/// The tool, for messages.
const TOOL: &str = "LIGGGHTS";

/// Time between two insertions, s: seeds fall by some millimetres.
const INSERTION: f64 = 0.02;

/// Seeds a second where the scene does not say.
const RATE: f64 = 5000.0;

/// How the seeds get into the drum.
#[derive(Debug, Clone, Copy)]
pub enum Start<'a> {
    /// They rain into it, at places drawn from this seed.
    Rain(u64),
    /// They are where a frame has them, with its motion.
    Frame(&'a Frame),
}

/// The deck: of a drum `in.drum`, `cover.stl`, and one file of spheres for each kind of seeds, which rain in; of a bench `in.bench`, an STL
/// file for each wall, and the seeds where they start here. `time_step` is the one that the solver here takes, s; `seed` that of the
/// places of seeds that rain in.
///
/// # Errors
///
/// As of [`setup`], and of a bench a wall that both moves and carries a load.
pub fn deck(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    start: &Frame,
    time_step: f64,
    seed: u64,
) -> Result<Vec<File>, Error> {
    let time_step = time_step / FINER;
    if scene.apparatus.has_phases() {
        return bench::deck(scene, bodies, (start, seed), time_step);
    }
    let mut files = setup(scene, bodies, Start::Rain(seed), time_step)?;
    files[0].text.push_str(&runs(scene, time_step));
    Ok(files)
}

/// The same files, but `in.drum`, the first, ends before the run; `time_step` is that of the deck, s. A start from a
/// frame takes the first step.
///
/// # Errors
///
/// An apparatus other than a drum of constant speed, several materials of seeds.
pub fn setup(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    start: Start<'_>,
    time_step: f64,
) -> Result<Vec<File>, Error> {
    let drum = supported(scene, TOOL)?;
    if are_spheres(bodies) && matches!(start, Start::Frame(_)) {
        return Err(Error::NotThere {
            what: "a start of plain spheres from a frame".into(),
            tool: TOOL,
            way_out: "let them rain in",
        });
    }
    let mut files = vec![
        File {
            name: "in.drum".into(),
            text: script(scene, drum, bodies, start, time_step)?,
        },
        File {
            name: "cover.stl".into(),
            text: cover(drum),
        },
    ];
    if are_spheres(bodies) {
        return Ok(files);
    }
    let kinds = bodies.iter().enumerate();
    files.extend(kinds.map(|(k, body)| File {
        name: spheres_file(k),
        text: spheres(body),
    }));
    Ok(files)
}

/// Refuses scenes that LIGGGHTS would not run until a bed is steady, or otherwise than here.
///
/// # Errors
///
/// Those of [`setup`], and that of the restitution of agglomerates, which depends on their bodies.
pub fn check(scene: &Scene) -> Result<(), Error> {
    let drum = supported(scene, TOOL)?;
    refuse_values(scene, &surfaces(scene, drum), known_share(scene))
}

/// Refuses what no deck can have, before seeds are placed: the apparatus, the model, values.
///
/// # Errors
///
/// What LIGGGHTS does not have, by name.
pub fn check_deck(scene: &Scene) -> Result<(), Error> {
    if !scene.apparatus.has_phases() {
        return check(scene);
    }
    bench_deck::check(scene, TOOL)
}

/// Mass in the dashpot over that of the body, as far as it is known without the body: the least restitution otherwise.
fn known_share(scene: &Scene) -> f64 {
    let whole = scene.model.dashpot_mass != DashpotMass::Sphere;
    let is_one = whole || scene.seed.iter().all(|seed| seed.sphere.is_some());
    if is_one { 1.0 } else { 0.0 }
}

/// Time in which the seeds rain in and come to lie, s.
pub fn filling_time(scene: &Scene) -> f64 {
    let rate = scene.protocol.insertion_rate.map_or(RATE, Frequency::si);
    scene.seed_count() as f64 / rate + scene.protocol.settle_limit.si()
}

/// A square that covers the drum.
fn cover(drum: &Drum) -> String {
    let r = 0.525 * drum.inner_diameter.si();
    let corner = |x: f64, y: f64| format!("vertex {:e} {:e} 0\n", x * r, y * r);
    let facet = |corners: [String; 3]| {
        let corners = corners.concat();
        format!("facet normal 0 0 1\nouter loop\n{corners}endloop\nendfacet\n")
    };
    let [a, b, c, d] =
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| corner(x, y));
    let (one, other) = (facet([a.clone(), b, c.clone()]), facet([a, c, d]));
    format!("solid cover\n{one}{other}endsolid cover\n")
}

/// The turning shell and covers, and the region in the upper half in which seeds appear.
fn walls(drum: &Drum, law: &Law) -> String {
    let (radius, half) = (0.5 * drum.inner_diameter.si(), 0.5 * drum.width.si());
    let (
        Law {
            model, settings, ..
        },
        spin,
    ) = (law, drum.speed.si());
    let cover = |name: &str, z: f64| {
        format!(
            "fix {name} all mesh/surface file cover.stl type 3 move 0.0 0.0 {z} \
             surface_ang_vel origin 0.0 0.0 0.0 axis 0.0 0.0 1.0 omega {spin}\n"
        )
    };
    let (front, back) = (cover("front", half), cover("back", -half));
    format!(
        "{front}{back}\
         fix covers all wall/gran {model} mesh n_meshes 2 meshes front back{settings}\n\
         fix shell all wall/gran {model} primitive type 2 zcylinder {radius} 0.0 0.0 shear x {spin}{settings}\n\
         region upper block {low} {radius} 0.0 {radius} {behind} {half} units box\n\
         region inside cylinder z 0.0 0.0 {} {behind} {half} units box\n\
         region sky intersect 2 upper inside\n",
        0.98 * radius,
        low = -radius,
        behind = -half,
    )
}

/// The end of the script: seeds rain in, settle and flow.
fn runs(scene: &Scene, time_step: f64) -> String {
    let protocol = &scene.protocol;
    let whole = filling_time(scene) + protocol.rotation_limit.si();
    let every = steps(protocol.frame_interval.si(), time_step);
    format!(
        "thermo_style custom step time\n\
         thermo {every}\n\
         dump bed all custom {every} bed.dump id type x y z radius vx vy vz\n\
         run {}\n",
        steps(whole, time_step),
    )
}

/// The input script up to the run.
fn script(
    scene: &Scene,
    drum: &Drum,
    bodies: &[Arc<SeedBody>],
    start: Start<'_>,
    time_step: f64,
) -> Result<String, Error> {
    let law = law(scene, &surfaces(scene, drum), bodies)?;
    let (radius, half) = (0.5 * drum.inner_diameter.si(), 0.5 * drum.width.si());
    let outer = bodies.iter().flat_map(|b| b.outer.spheres());
    let smallest = outer.map(|s| s.radius).fold(f64::INFINITY, f64::min);
    let down = drum.tilt.map_or(0.0, input::quantity::Angle::si);
    let [shapes, first, how] = match start {
        Start::Rain(seed) => {
            let shapes = rain(scene, bodies, (steps(INSERTION, time_step), ""), seed);
            let how = "The seeds rain into the turning drum.";
            [shapes, String::new(), how.into()]
        }
        Start::Frame(frame) => {
            let how = format!("The seeds are where they were after {} s.", frame.time);
            [placed(bodies, frame), put(frame), how]
        }
    };
    Ok(format!(
        "# {} seeds in a drum of {} mm, written from {}.\n\
         # Contacts are converted, not copied: the restitution is that of a dashpot with the mass of the rigid body,\n\
         # rolling friction that of the spheres' arm. {how}\n\
         units si\n\
         atom_style granular\n\
         atom_modify map array\n\
         boundary f f f\n\
         newton off\n\
         communicate single vel yes\n\
         hard_particles yes\n{}\
         region box block {low} {high} {low} {high} {} {} units box\n\
         create_box 3 box\n\
         neighbor {smallest:e} bin\n\
         neigh_modify delay 0\n\
         {properties}\
         pair_style gran {model}{settings}\n\
         pair_coeff * *\n\
         timestep {time_step:e}\n\
         fix weight all gravity {} vector 0.0 {} {}\n\
         {walls}{shapes}\
         fix seeds all {motion}\n{first}",
        scene.seed_count(),
        2e3 * radius,
        scene.file,
        law.soft,
        -1.2 * half,
        1.2 * half,
        scene.model.gravity_m_s2,
        -down.cos(),
        down.sin(),
        low = -1.6 * radius,
        high = 1.6 * radius,
        properties = law.properties,
        model = law.model,
        settings = law.settings,
        walls = walls(drum, &law),
        motion = if are_spheres(bodies) {
            "nve/sphere"
        } else {
            "multisphere allow_group_and_set yes"
        },
    ))
}

/// Numbers with blanks between.
fn list(numbers: impl IntoIterator<Item = f64>) -> String {
    let words: Vec<_> = numbers.into_iter().map(|n| format!("{n:e}")).collect();
    words.join(" ")
}

#[cfg(test)]
mod tests;
