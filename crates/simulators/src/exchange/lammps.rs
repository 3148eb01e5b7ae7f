//! A drum as a deck for LAMMPS (`pair_style granular`, `fix rigid/small`).
//!
//! # What is converted
//!
//! | here | LAMMPS |
//! |---|---|
//! | contact of two materials, `E*` and `G*` of both sides | one Young's modulus and Poisson's ratio that, mixed with themselves as LAMMPS does, give the same `E*` and `G*` |
//! | dashpot with the mass of the sphere | LAMMPS takes that of the rigid body: the ratio b is scaled by sqrt(`m_sphere` / `m_body`) and turned back into a restitution |
//! | tangential dashpot with its own stiffness | `x_gammat = 2 sqrt(G* / E*)` |
//! | clipped end of the normal force | `limit_damping` |
//! | rolling friction, type A or C, with the arm of the body or of the sphere | `rolling sds` (type C), whose arm is the reduced radius of the spheres: with the arm of the body the coefficient is scaled by arm over radius |
//! | mass and inertia of the seed | `infile` of `fix rigid/small` |
//! | gravity on bodies | `fix gravity ... disable`, and `gravity` of `fix rigid/small` |

mod bench;
mod motion;
mod regions;

use crate::exchange::Error;
use crate::exchange::bench_deck;
use crate::exchange::drum_deck::{
    FINER, Shares, are_spheres, coheres, plain_atoms, restitution_of_body, steps, supported,
};
use crate::exchange::vtk::{File, add};
use contact_law::{Material, NormalForceEnd, material::effective_moduli};
use nalgebra::Vector3;
use scene::{Drum, Frame, Scene, SeedBody};
use std::sync::Arc;

/// The tool, for messages.
const TOOL: &str = "LAMMPS";

/// Stiffness of the rolling spring: it reaches its limit under ten times the weight of a seed on a way
/// of this share of the sphere's radius.
const ROLLING_WAY: f64 = 0.05;

/// A contact in the words of LAMMPS.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GranularContact {
    /// Young's modulus of both sides, Pa.
    pub young: f64,
    /// Poisson's ratio of both sides.
    pub poisson: f64,
    /// Restitution for the mass of rigid bodies.
    pub restitution: f64,
    /// Tangential over normal damping.
    pub tangential_damping: f64,
    /// Static friction.
    pub static_friction: f64,
    /// Rolling friction for the reduced radius of the spheres.
    pub rolling_friction: f64,
}

/// Inputs of the conversion of a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conversion {
    /// Materials of both sides.
    pub materials: [Material; 2],
    /// Restitution, static and rolling friction as in the scene.
    pub coefficients: [f64; 3],
    /// Mass that the dashpot sees here over the mass of the body.
    pub mass_share: f64,
    /// Lever arm of rolling resistance over the radius of the sphere.
    pub lever_share: f64,
}

/// Converts a contact.
pub fn convert(from: &Conversion) -> GranularContact {
    let moduli = effective_moduli(&from.materials[0], &from.materials[1]);
    // One material against itself: E* = E / (2 (1 - nu²)), G* = E / (4 (2 - nu)(1 + nu)).
    let q = 2.0 * moduli.shear / moduli.young;
    let poisson = (1.0 - 2.0 * q) / (1.0 - q);
    let [restitution, static_friction, rolling_friction] = from.coefficients;
    GranularContact {
        young: 2.0 * (1.0 - poisson * poisson) * moduli.young,
        poisson,
        restitution: restitution_of_body(restitution, from.mass_share),
        tangential_damping: 2.0 * (moduli.shear / moduli.young).sqrt(),
        static_friction,
        rolling_friction: rolling_friction * from.lever_share,
    }
}

/// The deck: of a drum `in.drum`, `drum.data`, `drum.bodies`; of a bench `in.bench` and the same. `time_step` is the one that the solver
/// here takes, s; `seed` that of the places of seeds that are poured.
///
/// # Errors
///
/// As of [`setup`], and of a bench a wall that is not of rectangles and surfaces of revolution.
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
    let mut files = setup(scene, bodies, start, time_step)?;
    let columns = dump_columns(bodies);
    files[0].text.push_str(&runs(scene, columns, time_step));
    Ok(files)
}

/// Refuses scenes that LAMMPS would not run until a bed is steady, or otherwise than here.
///
/// # Errors
///
/// As of [`setup`].
pub fn check(scene: &Scene) -> Result<(), Error> {
    runnable(scene).map(|_| ())
}

/// The drum, if LAMMPS can run the scene.
fn runnable(scene: &Scene) -> Result<&Drum, Error> {
    let drum = supported(scene, TOOL)?;
    if scene.contact.values().any(coheres) {
        return Err(no_cohesion());
    }
    Ok(drum)
}

/// Refuses what no deck can have, before seeds are placed: the apparatus, the model.
///
/// # Errors
///
/// What LAMMPS does not have, by name.
pub fn check_deck(scene: &Scene) -> Result<(), Error> {
    if !scene.apparatus.has_phases() {
        return check(scene);
    }
    bench_deck::check(scene, TOOL)?;
    if scene.contact.values().any(coheres) {
        return Err(no_cohesion());
    }
    Ok(())
}

fn no_cohesion() -> Error {
    Error::NotThere {
        what: "an attraction by the area of contact".into(),
        tool: TOOL,
        way_out: "remove cohesion_energy_density_j_m3",
    }
}

/// The same files, but `in.drum`, the first, ends before the first run; `time_step` is that of the deck, s.
///
/// # Errors
///
/// An apparatus other than a drum of constant speed, cohesion, several materials of seeds.
pub fn setup(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    start: &Frame,
    time_step: f64,
) -> Result<Vec<File>, Error> {
    let drum = runnable(scene)?;
    let file = |name: &str, text| File {
        name: name.into(),
        text,
    };
    let script = file("in.drum", script(scene, drum, bodies, start, time_step)?);
    if are_spheres(bodies) {
        let rows = (plain_atoms(bodies, start), "sphere");
        return Ok(vec![
            script,
            file("drum.data", data(&box_of(drum), rows, start.kind.len())),
        ]);
    }
    let atoms = surface_atoms(bodies, start);
    let n = atoms.lines().count();
    Ok(vec![
        script,
        file("drum.data", data(&box_of(drum), (atoms, "hybrid"), n)),
        file("drum.bodies", rigid_bodies(bodies, start)),
    ])
}

/// Columns of the dump for each sphere.
pub fn dump_columns(bodies: &[Arc<SeedBody>]) -> &'static str {
    if are_spheres(bodies) {
        "id type x y z radius vx vy vz"
    } else {
        "id type mol x y z radius vx vy vz"
    }
}

/// The contact of the seeds with a material, as LAMMPS takes it; shares are means over all seeds.
fn contact(scene: &Scene, bodies: &[Arc<SeedBody>], other: &str) -> Result<GranularContact, Error> {
    let seed = &scene.seed[0].material;
    let missing = || scene::Error::MissingContact {
        file: scene.file.clone(),
        pair: format!("{seed}-{other}"),
    };
    let c = scene.contact_of(seed, other).ok_or_else(missing)?;
    let material = |name: &str| scene.material[name].constants();
    let shares = Shares::of(scene, bodies);
    Ok(convert(&Conversion {
        materials: [material(seed)?, material(other)?],
        coefficients: [
            c.restitution.get(),
            c.static_friction.get(),
            c.rolling_friction.get(),
        ],
        mass_share: shares.mass,
        lever_share: shares.lever,
    }))
}

/// A contact as the words of `pair_coeff` and `fix wall/gran/region`.
fn words(scene: &Scene, bodies: &[Arc<SeedBody>], c: &GranularContact) -> String {
    let load = 10.0 * bodies[0].clump.mass() * scene.model.gravity_m_s2;
    let way = ROLLING_WAY * bodies[0].clump.spheres()[0].radius;
    words_with(scene, c, [c.rolling_friction * load / way, 0.0])
}

/// The same with the spring (N/m) and the dashpot (N s/m) of rolling.
fn words_with(scene: &Scene, c: &GranularContact, [stiffness, damping]: [f64; 2]) -> String {
    let mut text = format!(
        "hertz/material {:e} {} {} tangential mindlin NULL {} {} damping coeff_restitution",
        c.young, c.restitution, c.poisson, c.tangential_damping, c.static_friction
    );
    if c.rolling_friction > 0.0 {
        let text_of_rolling = format_args!(
            " rolling sds {stiffness:e} {damping:?} {}",
            c.rolling_friction
        );
        add(&mut text, text_of_rolling);
    }
    if scene.model.normal_force_end == NormalForceEnd::Clipped {
        text.push_str(" limit_damping");
    }
    text
}

/// The end of the script: the seeds settle, then the drum turns.
fn runs(scene: &Scene, columns: &str, time_step: f64) -> String {
    let protocol = &scene.protocol;
    let every = steps(protocol.frame_interval.si(), time_step);
    format!(
        "thermo_style custom step time\n\
         thermo {every}\n\
         run {}\n\
         dump bed all custom {every} bed.dump {columns}\n\
         run {}\n",
        steps(protocol.settle_limit.si(), time_step),
        steps(protocol.rotation_limit.si(), time_step),
    )
}

/// The input script up to the first run.
fn script(
    scene: &Scene,
    drum: &Drum,
    bodies: &[Arc<SeedBody>],
    start: &Frame,
    time_step: f64,
) -> Result<String, Error> {
    let (radius, half) = (0.5 * drum.inner_diameter.si(), 0.5 * drum.width.si());
    let [pair, shell, cover] = [&scene.seed[0].material, &drum.shell, &drum.cover]
        .map(|name| contact(scene, bodies, name).map(|c| words(scene, bodies, &c)));
    let (pair, shell, cover) = (pair?, shell?, cover?);
    let radii = bodies.iter().map(|b| b.clump.bounding_radius());
    let longest = radii.fold(0.0, f64::max);
    let radii = bodies[0].clump.spheres().iter().map(|s| s.radius);
    let smallest = radii.fold(f64::INFINITY, f64::min);
    let settle = steps(scene.protocol.settle_limit.si(), time_step);
    let down = drum.tilt.map_or(0.0, input::quantity::Angle::si);
    // Plain spheres move by themselves; spheres of a seed move with it.
    let [style, cutoff, exclude, disable, motion] = if are_spheres(bodies) {
        let none = String::new;
        let motion = "fix seeds all nve/sphere".to_owned();
        ["sphere".to_owned(), none(), none(), none(), motion]
    } else {
        [
            "hybrid sphere molecular".to_owned(),
            format!(" cutoff {:e}", 2.0 * longest + 4.0 * smallest),
            " exclude molecule/intra all".to_owned(),
            " disable".to_owned(),
            "fix seeds all rigid/small molecule infile drum.bodies gravity weight".to_owned(),
        ]
    };
    Ok(format!(
        "# {} seeds in a drum of {} mm, written from {}.\n\
         # Contacts are converted, not copied: E and nu stand for both sides, the restitution is that\n\
         # of a dashpot with the mass of the rigid body, rolling friction that of the spheres' arm.\n\
         units si\n\
         atom_style {style}\n\
         boundary f f f\n\
         newton off\n\
         comm_modify vel yes{cutoff}\n\
         read_data drum.data\n\
         neighbor {:e} bin\n\
         neigh_modify delay 0 every 1 check yes{exclude}\n\
         timestep {time_step:e}\n\
         pair_style granular\n\
         pair_coeff * * {pair}\n\
         fix weight all gravity {} vector 0 {} {}{disable}\n\
         {motion}\n\
         # The drum stands still while the seeds settle.\n\
         variable angle equal {}*dt*(step-{settle})*(step>{settle})\n\
         region shell cylinder z 0 0 {radius} {} {} side in open 1 open 2 rotate v_angle 0 0 0 0 0 1\n\
         region front plane 0 0 {half} 0 0 -1 side in rotate v_angle 0 0 0 0 0 1\n\
         region back plane 0 0 {} 0 0 1 side in rotate v_angle 0 0 0 0 0 1\n\
         fix shell all wall/gran/region granular {shell} region shell\n\
         fix front all wall/gran/region granular {cover} region front\n\
         fix back all wall/gran/region granular {cover} region back\n",
        start.position.len(),
        2e3 * radius,
        scene.file,
        0.5 * smallest,
        scene.model.gravity_m_s2,
        -down.cos(),
        down.sin(),
        drum.speed.si(),
        -2.0 * half,
        2.0 * half,
        -half,
    ))
}

/// The spheres at the surface of all seeds, as rows of atoms.
fn surface_atoms(bodies: &[Arc<SeedBody>], start: &Frame) -> String {
    let mut rows = String::new();
    let mut n = 0_usize;
    for i in 0..start.position.len() {
        let body = &bodies[start.kind[i]];
        for sphere in body.outer.spheres() {
            n += 1;
            let c = start.position[i] + start.orientation[i] * sphere.centre;
            // The density is not used: mass and inertia of the seeds stand in drum.bodies.
            let row = format_args!(
                "{n} 1 {:e} {:e} {:e} {:e} {} {}\n",
                c.x,
                c.y,
                c.z,
                2.0 * sphere.radius,
                body.fraction_density,
                i + 1
            );
            add(&mut rows, row);
        }
    }
    rows
}

/// Lower and upper corner of the box about a drum, m.
fn box_of(drum: &Drum) -> [Vector3<f64>; 2] {
    let (r, h) = (0.55 * drum.inner_diameter.si(), 0.6 * drum.width.si());
    [Vector3::new(-r, -r, -h), Vector3::new(r, r, h)]
}

/// The data file with its `n` atoms in a box, whose rows are of a style.
fn data([low, high]: &[Vector3<f64>; 2], (rows, style): (String, &str), n: usize) -> String {
    format!(
        "Spheres at the surface of seeds\n\n{n} atoms\n1 atom types\n\n{} {} xlo xhi\n{} {} ylo \
         yhi\n{} {} zlo zhi\n\nAtoms # {style}\n\n{rows}",
        low.x, high.x, low.y, high.y, low.z, high.z
    )
}

/// Mass, place, inertia and motion of each seed.
fn rigid_bodies(bodies: &[Arc<SeedBody>], start: &Frame) -> String {
    let mut text = format!("{}\n", start.position.len());
    for i in 0..start.position.len() {
        let clump = &bodies[start.kind[i]].clump;
        let turn = start.orientation[i].to_rotation_matrix();
        let moments = nalgebra::Matrix3::from_diagonal(&clump.inertia());
        let inertia = turn.matrix() * moments * turn.matrix().transpose();
        let (p, v) = (start.position[i], start.velocity[i]);
        let l = inertia * start.spin[i];
        let row = format_args!(
            "{} {:e} {:e} {:e} {:e} {:e} {:e} {:e} {:e} {:e} {:e} {:e} {:e} {:e} {:e} {:e} {:e} 0 0 0\n",
            i + 1,
            clump.mass(),
            p.x,
            p.y,
            p.z,
            inertia.m11,
            inertia.m22,
            inertia.m33,
            inertia.m12,
            inertia.m13,
            inertia.m23,
            v.x,
            v.y,
            v.z,
            l.x,
            l.y,
            l.z
        );
        add(&mut text, row);
    }
    text
}

#[cfg(test)]
mod tests;
