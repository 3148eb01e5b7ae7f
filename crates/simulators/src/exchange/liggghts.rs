//! A drum as a deck for LIGGGHTS-PUBLIC 3.8 (`fix multisphere`).
//!
//! # What is converted
//!
//! | here | LIGGGHTS |
//! |---|---|
//! | moduli of each material | the same: one type of atoms for the seeds, one for the shell, one for the covers |
//! | dashpot with the mass of the sphere | LIGGGHTS takes that of the rigid body: the ratio b is scaled by sqrt(`m_sphere` / `m_body`) and turned back into a restitution |
//! | clipped end of the normal force | `limitForce on` |
//! | rolling friction of type A with the arm of the body or of the sphere | `rolling_friction cdt torsionTorque on`, whose arm is the reduced radius of the spheres: with the arm of the body the coefficient is scaled by arm over radius |
//! | cohesion by the area of contact | `cohesion sjkr` |
//! | mass and inertia of the seed | `mass` and `inertia_tensor` of the template |
//! | places of the seeds | [`deck`] lets seeds rain into the turning drum; [`setup`] can also put each where a frame has it, by an insertion of its own |

use crate::exchange::Error;
use crate::exchange::drum_deck::{
    FINER, Shares, are_spheres, coheres, density_of_sphere, restitution_of_body, steps, supported,
};
use crate::exchange::vtk::{File, add};
use contact_law::NormalForceEnd;
use dem_solver::DashpotMass;
use input::quantity::Frequency;
use nalgebra::Vector3;
use scene::{ContactSettings, Drum, Frame, RollingLaw, Scene, SeedBody};
use std::sync::Arc;

/// The tool, for messages.
const TOOL: &str = "LIGGGHTS";

/// Time between two insertions, s: seeds fall by some millimetres.
const INSERTION: f64 = 0.02;

/// Seeds a second where the scene does not say.
const RATE: f64 = 5000.0;

/// Half the edge of the box in which the centre of a seed is put, m: far below the overlaps of contacts.
const PLACE: f64 = 1e-8;

/// How the seeds get into the drum.
#[derive(Debug, Clone, Copy)]
pub enum Start<'a> {
    /// They rain into it, at places drawn from this seed.
    Rain(u64),
    /// They are where a frame has them, with its motion.
    Frame(&'a Frame),
}

/// The deck: `in.drum`, `cover.stl`, and one file of spheres for each kind of seeds. `time_step` is the one that
/// the solver here takes, s; `seed` that of the places of the seeds.
///
/// # Errors
///
/// As of [`setup`].
pub fn deck(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    time_step: f64,
    seed: u64,
) -> Result<Vec<File>, Error> {
    let time_step = time_step / FINER;
    let mut files = setup(scene, bodies, Start::Rain(seed), time_step)?;
    files[0].text.push_str(&runs(scene, time_step));
    Ok(files)
}

/// The same files, but `in.drum`, the first, ends before the run; `time_step` is that of the deck, s. A start from a
/// frame takes the first step.
///
/// # Errors
///
/// An apparatus other than a drum of constant speed, a tilted axis, cohesion, rolling resistance of type C, several
/// materials of seeds.
pub fn setup(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    start: Start<'_>,
    time_step: f64,
) -> Result<Vec<File>, Error> {
    let drum = runnable(scene)?;
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

/// The drum, if LIGGGHTS can run the scene.
fn runnable(scene: &Scene) -> Result<&Drum, Error> {
    let drum = supported(scene, TOOL)?;
    if scene.model.rolling_law == RollingLaw::SpringDashpot {
        return Err(Error::NotThere {
            what: "rolling resistance of type C".into(),
            tool: TOOL,
            way_out: "calibrate with model.rolling_law = \"constant-torque\"",
        });
    }
    Ok(drum)
}

/// Refuses scenes that LIGGGHTS would run otherwise, or not at all.
///
/// # Errors
///
/// Those of [`setup`], and that of the restitution of agglomerates, which depends on their bodies.
pub fn check(scene: &Scene) -> Result<(), Error> {
    let drum = runnable(scene)?;
    let whole = scene.model.dashpot_mass != DashpotMass::Sphere;
    let share_is_one = whole || scene.seed.iter().all(|seed| seed.sphere.is_some());
    refuse_values(scene, drum, if share_is_one { 1.0 } else { 0.0 })
}

/// Time in which the seeds rain in and come to lie, s.
pub fn filling_time(scene: &Scene) -> f64 {
    let rate = scene.protocol.insertion_rate.map_or(RATE, Frequency::si);
    scene.seed_count() as f64 / rate + scene.protocol.settle_limit.si()
}

/// Name of the file with the spheres of a kind of seeds.
fn spheres_file(kind: usize) -> String {
    format!("seed{}.spheres", kind + 1)
}

/// Spheres at the surface, about the centre of mass, in principal axes.
fn spheres(body: &SeedBody) -> String {
    let mut text = String::new();
    for sphere in body.outer.spheres() {
        let c = sphere.centre;
        let row = format_args!("{:e} {:e} {:e} {:e}\n", c.x, c.y, c.z, sphere.radius);
        add(&mut text, row);
    }
    text
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

/// The shape of a kind of seeds, and a distribution of it alone: one of all kinds does not keep their
/// numbers. Mass and inertia are given, but the centre of mass is found from so many random points.
fn shape(
    kind: usize,
    body: &SeedBody,
    points: u32,
    primes: &mut impl Iterator<Item = u64>,
) -> String {
    let (number, file) = (kind + 1, spheres_file(kind));
    if body.clump.spheres().len() == 1 {
        let [first, second] = [(); 2].map(|()| primes.next().unwrap_or(0));
        return format!(
            "fix seed{number} all particletemplate/sphere {first} atom_type 1 density constant {} radius constant {:e}\n\
             fix kind{number} all particledistribution/discrete {second} 1 seed{number} 1.0\n",
            density_of_sphere(body),
            body.clump.spheres()[0].radius,
        );
    }
    let (n, i) = (body.outer.spheres().len(), body.clump.inertia());
    let [first, second] = [(); 2].map(|()| primes.next().unwrap_or(0));
    format!(
        "fix seed{number} all particletemplate/multisphere {first} atom_type 1 density constant {} \
         nspheres {n} ntry {points} spheres file {file} scale 1.0 type {number} mass {:e} \
         inertia_tensor {:e} 0.0 0.0 {:e} 0.0 {:e} use_volume\n\
         fix kind{number} all particledistribution/discrete {second} 1 seed{number} 1.0\n",
        body.fraction_density,
        body.clump.mass(),
        i.x,
        i.y,
        i.z,
    )
}

/// The seeds of each kind and how they rain in.
fn rain(scene: &Scene, bodies: &[Arc<SeedBody>], every: f64, seed: u64) -> String {
    let mut primes = primes_from(first_of(seed));
    let rate = scene.protocol.insertion_rate.map_or(RATE, Frequency::si);
    let turned = if are_spheres(bodies) {
        ""
    } else {
        "orientation random "
    };
    let mut text = String::new();
    for (k, (kind, body)) in scene.seed.iter().zip(bodies).enumerate() {
        text.push_str(&shape(k, body, 100_000, &mut primes));
        let number = k + 1;
        let rate = rate * scene.count_of(kind) as f64 / scene.seed_count() as f64;
        add(
            &mut text,
            format_args!(
                "fix rain{number} all insert/rate/region seed {} distributiontemplate kind{number} \
                 nparticles {} particlerate {rate} insert_every {every} overlapcheck yes all_in yes \
                 {turned}region sky ntry_mc 10000\n",
                primes.next().unwrap_or(0),
                scene.count_of(kind),
            ),
        );
    }
    text
}

/// The seeds of a frame, one insertion each.
fn placed(bodies: &[Arc<SeedBody>], frame: &Frame) -> String {
    let mut primes = primes_from(10_007);
    let mut text = String::new();
    for (k, body) in bodies.iter().enumerate() {
        // The points scatter by about a millimetre, so the centre is right to about a micrometre.
        text.push_str(&shape(k, body, 10_000_000, &mut primes));
    }
    let centroids: Vec<_> = bodies.iter().map(|body| centroid(body)).collect();
    for i in 0..frame.position.len() {
        let (kind, turn) = (frame.kind[i], frame.orientation[i]);
        // What is put into the place is the centre of the spheres' volume.
        let c = frame.position[i] + turn * centroids[kind];
        let (v, w, q) = (frame.velocity[i], frame.spin[i], turn.coords);
        let edges = [c.x, c.y, c.z].map(|x| format!("{:.10} {:.10}", x - PLACE, x + PLACE));
        add(
            &mut text,
            format_args!(
                "region place{i} block {} units box volume_limit 1e-30\n\
                 fix put{i} all insert/pack seed {} distributiontemplate kind{} insert_every once \
                 overlapcheck no all_in no vel constant {:e} {:e} {:e} omega constant {:e} {:e} {:e} \
                 orientation constant {} {} {} {} particles_in_region 1 region place{i} ntry_mc 1000\n",
                edges.join(" "),
                primes.next().unwrap_or(0),
                kind + 1,
                v.x,
                v.y,
                v.z,
                w.x,
                w.y,
                w.z,
                q.w,
                q.x,
                q.y,
                q.z,
            ),
        );
    }
    text
}

/// Centre of the volume of the spheres at the surface, as if they did not overlap, m.
fn centroid(body: &SeedBody) -> Vector3<f64> {
    let (mut moment, mut volume) = (Vector3::zeros(), 0.0);
    for sphere in body.outer.spheres() {
        let own = sphere.radius.powi(3);
        moment += sphere.centre * own;
        volume += own;
    }
    moment / volume
}

/// The step in which the seeds of a frame are put in, and the end of the insertions.
fn put(frame: &Frame) -> String {
    let mut text = "run 1\n".to_owned();
    for i in 0..frame.position.len() {
        add(
            &mut text,
            format_args!("unfix put{i}\nregion place{i} delete\n"),
        );
    }
    text
}

/// The contact laws in the words of LIGGGHTS.
struct Law {
    /// Commands that state the properties of the materials and their pairs.
    properties: String,
    /// The model, before the shape of a wall.
    model: String,
    /// Its settings, behind the shape.
    settings: String,
    /// Whether a material is softer than it takes without being told.
    is_soft: bool,
}

/// Restitutions that it takes lie above this.
const LEAST_RESTITUTION: f64 = 0.05;
/// Young's modulus below which it wants to be told that particles are soft, Pa.
const SOFT: f64 = 5e6;

/// The materials of seeds, shell and cover.
fn surfaces<'a>(scene: &'a Scene, drum: &'a Drum) -> [&'a String; 3] {
    [&scene.seed[0].material, &drum.shell, &drum.cover]
}

/// The contacts of the first material with each.
fn contacts<'a>(scene: &'a Scene, names: [&String; 3]) -> Result<[&'a ContactSettings; 3], Error> {
    let contact = |name: &String| -> Result<&ContactSettings, Error> {
        let missing = || scene::Error::MissingContact {
            file: scene.file.clone(),
            pair: format!("{}-{name}", names[0]),
        };
        Ok(scene.contact_of(names[0], name).ok_or_else(missing)?)
    };
    Ok([contact(names[0])?, contact(names[1])?, contact(names[2])?])
}

/// Refuses values at which it stops when it reads a deck; `mass_share` is that of a sphere that touches, over its body.
fn refuse_values(scene: &Scene, drum: &Drum, mass_share: f64) -> Result<(), Error> {
    let names = surfaces(scene, drum);
    let refused = |what: String, way_out| {
        Err(Error::NotThere {
            what,
            tool: TOOL,
            way_out,
        })
    };
    for (contact, name) in contacts(scene, names)?.iter().zip(names) {
        let restitution = restitution_of_body(contact.restitution.get(), mass_share);
        if restitution <= LEAST_RESTITUTION {
            let shown = input::quantity::significant(restitution, 3);
            let what = format!("restitution {shown} between {} and {name}", names[0]);
            return refused(what, "it takes values above 0.05 alone");
        }
    }
    for name in names {
        let ratio = scene.material[name].poisson_ratio.get();
        if ratio < 0.0 {
            let what = format!("Poisson's ratio {ratio} of {name}");
            return refused(what, "it takes values from 0 to 0.5 alone");
        }
    }
    Ok(())
}

/// The laws of the contacts of a scene.
fn law(scene: &Scene, drum: &Drum, bodies: &[Arc<SeedBody>]) -> Result<Law, Error> {
    let names = surfaces(scene, drum);
    let materials = names.map(|name| &scene.material[name]);
    let young = materials.map(scene::MaterialSettings::youngs_modulus_pa);
    let poisson = materials.map(|m| m.poisson_ratio.get());
    let contacts = contacts(scene, names)?;
    // Row by row; shell and cover never meet.
    let pairs = |of: &dyn Fn(&ContactSettings) -> f64| {
        let table = (0..3).flat_map(|i| (0..3).map(move |j| usize::max(i, j)));
        list(table.map(|k| of(contacts[k])))
    };
    let shares = Shares::of(scene, bodies);
    refuse_values(scene, drum, shares.mass)?;
    let mut properties = format!(
        "fix young all property/global youngsModulus peratomtype {}\n\
         fix poisson all property/global poissonsRatio peratomtype {}\n\
         fix restitution all property/global coefficientRestitution peratomtypepair 3 {}\n\
         fix friction all property/global coefficientFriction peratomtypepair 3 {}\n\
         fix rolling all property/global coefficientRollingFriction peratomtypepair 3 {}\n",
        list(young),
        list(poisson),
        pairs(&|c| restitution_of_body(c.restitution.get(), shares.mass)),
        pairs(&|c| c.static_friction.get()),
        pairs(&|c| c.rolling_friction.get() * shares.lever),
    );
    let rolls = contacts.iter().any(|c| c.rolling_friction.get() > 0.0);
    let mut model = "model hertz tangential history".to_owned();
    let mut settings = String::new();
    if contacts.iter().any(|c| coheres(c)) {
        model.push_str(" cohesion sjkr");
        let densities = pairs(&|c| c.cohesion_energy_density_j_m3.unwrap_or(0.0));
        let words = "fix cohesion all property/global cohesionEnergyDensity peratomtypepair 3";
        properties.extend([
            words, " ", &densities, "
",
        ]);
    }
    if rolls {
        model.push_str(" rolling_friction cdt");
        settings.push_str(" torsionTorque on");
    }
    if scene.model.normal_force_end == NormalForceEnd::Clipped {
        settings.push_str(" limitForce on");
    }
    Ok(Law {
        is_soft: young.iter().any(|modulus| *modulus < SOFT),
        properties,
        model,
        settings,
    })
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
    let law = law(scene, drum, bodies)?;
    let (radius, half) = (0.5 * drum.inner_diameter.si(), 0.5 * drum.width.si());
    let outer = bodies.iter().flat_map(|b| b.outer.spheres());
    let smallest = outer.map(|s| s.radius).fold(f64::INFINITY, f64::min);
    let down = drum.tilt.map_or(0.0, input::quantity::Angle::si);
    let [shapes, first, how] = match start {
        Start::Rain(seed) => [
            rain(scene, bodies, steps(INSERTION, time_step), seed),
            String::new(),
            "The seeds rain into the turning drum.".into(),
        ],
        Start::Frame(frame) => [
            placed(bodies, frame),
            put(frame),
            format!("The seeds are where they were after {} s.", frame.time),
        ],
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
         hard_particles yes\n{soft}\
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
        -1.2 * half,
        1.2 * half,
        scene.model.gravity_m_s2,
        -down.cos(),
        down.sin(),
        low = -1.6 * radius,
        high = 1.6 * radius,
        soft = if law.is_soft {
            "soft_particles yes\n"
        } else {
            ""
        },
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

/// Where the primes of a seed begin. LIGGGHTS reads them as signed 32-bit numbers, so that a seed is spread over those: seeds
/// from 0 on are as far apart as the golden section puts them.
fn first_of(seed: u64) -> u64 {
    const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;
    10_007 + (seed.wrapping_mul(GOLDEN) >> 32) % 2_000_000_000
}

/// Prime numbers from a number on, as LIGGGHTS wants them for its random numbers.
fn primes_from(first: u64) -> impl Iterator<Item = u64> {
    let is_prime = |n: &u64| !(2..=n.isqrt()).any(|d| n.is_multiple_of(d));
    (first..).filter(is_prime)
}

/// Numbers with blanks between.
fn list(numbers: impl IntoIterator<Item = f64>) -> String {
    let words: Vec<_> = numbers.into_iter().map(|n| format!("{n:e}")).collect();
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::{Start, check, deck, first_of, primes_from, setup};
    use contact_law::RollingLever;
    use dev_support::fixture_files::fixture;
    use input::quantity::FrictionCoefficient;
    use nalgebra::Vector3;
    use scene::{FillingLibrary, RollingLaw, Scene, starting_frame};

    fn drum() -> Scene {
        let file = fixture("cotton/drum.toml");
        Scene::read(&file, &[]).unwrap()
    }

    /// What it stops at when it reads a deck is refused here, or told to it: soft seeds, and restitutions of 0.05 or less. These
    /// spheres have the mass of their body.
    #[test]
    fn what_it_would_stop_at_is_refused_or_told() {
        let deck_of = |changes: &[(&str, &str)]| {
            let set = changes.iter().map(|(name, value)| scene::Override {
                name: (*name).into(),
                value: (*value).into(),
            });
            let set: Vec<_> = set.collect();
            let scene = Scene::read(&fixture("peers-study/spheres.toml"), &set).unwrap();
            let (_, bodies, step) = starting_frame(&scene, &FillingLibrary::default(), 1).unwrap();
            let deck = deck(&scene, &bodies, step, 1).map(|files| files[0].text.clone());
            // This much needs no body, and is checked before one is made.
            assert_eq!(check(&scene).is_ok(), deck.is_ok());
            deck
        };
        let hard = deck_of(&[]).unwrap();
        assert!(!hard.contains("soft_particles"), "{hard}");
        let soft = deck_of(&[("material.bead.shear_modulus", "1 MPa")]).unwrap();
        assert!(
            soft.contains("hard_particles yes\nsoft_particles yes\n"),
            "{soft}"
        );
        for (name, value, word) in [
            ("contact.bead-bead.restitution", "0.02", "restitution 0.02"),
            (
                "material.bead.poisson_ratio",
                "-0.2",
                "Poisson's ratio -0.2",
            ),
        ] {
            let told = deck_of(&[(name, value)]).unwrap_err().to_string();
            assert!(told.contains(word) && told.contains("LIGGGHTS"), "{told}");
        }
    }

    /// Values by hand for the study's drum: `E = 2 G (1 + nu)` = 9.1428e6 Pa; 10 rpm. Restitution 0.06 has b = 0.66713;
    /// with the mass of one of 146 or 127 spheres, a mean of 0.0069723 of a seed, b is 0.05571, which is a
    /// restitution of 0.8392. The numbers of the seeds stay.
    #[test]
    fn deck_carries_the_study_s_drum() {
        let scene = drum();
        let (_, bodies, step) = starting_frame(&scene, &FillingLibrary::default(), 1).unwrap();
        let files = deck(&scene, &bodies, step, 1).unwrap();
        let names: Vec<_> = files.iter().map(|f| f.name.as_str()).collect();
        assert_eq!(
            names,
            ["in.drum", "cover.stl", "seed1.spheres", "seed2.spheres"]
        );
        let text = &files[0].text;
        let number = |line: &str, word: usize| -> f64 {
            let line = text.lines().find(|l| l.starts_with(line)).unwrap();
            line.split_whitespace().nth(word).unwrap().parse().unwrap()
        };
        let near = |got: f64, expected: f64| {
            assert!((got / expected - 1.0).abs() < 1e-3, "{got} for {expected}");
        };
        near(number("fix young", 6), 9.1428e6);
        near(number("fix friction", 7), 0.10);
        near(number("fix restitution", 7), 0.8392);
        near(number("fix shell", 17), 10.0 * std::f64::consts::TAU / 60.0);
        for count in ["nparticles 1056 ", "nparticles 144 "] {
            assert!(text.contains(count), "{count} is missing");
        }
    }

    /// A start from a frame puts in each seed once, where it is and as fast. LIGGGHTS takes the place for that of the
    /// centre of the spheres at the surface, so the centre of mass is found back from all of them: the spheres of a
    /// kind have one size, and those of the packings here overlap by nothing. Places are written to 1e-10 m.
    #[test]
    fn seeds_of_a_frame_keep_their_places_and_motion() {
        let scene = drum();
        let (mut frame, bodies, step) =
            starting_frame(&scene, &FillingLibrary::default(), 1).unwrap();
        for i in 0..frame.position.len() {
            frame.velocity[i] = Vector3::new(0.1 * i as f64, -0.2, 0.3);
            frame.spin[i] = Vector3::new(1.0, 2.0 * i as f64, -3.0);
        }
        let text = setup(&scene, &bodies, Start::Frame(&frame), step)
            .unwrap()
            .swap_remove(0)
            .text;
        let numbers = |line: &str, behind: &str, n: usize| -> Vec<f64> {
            let (_, rest) = line.split_once(behind).unwrap();
            let words = rest.split_whitespace().take(n);
            words.map(|word| word.parse().unwrap()).collect()
        };
        let starting = |with: &str| {
            let lines: Vec<&str> = text.lines().filter(|l| l.starts_with(with)).collect();
            lines
        };
        let places = starting("region place");
        let puts = starting("fix put");
        assert_eq!([places.len(), puts.len()], [2 * 1200, 1200]);
        for i in [0, 1, 700, 1199] {
            let box_of = numbers(places[i], " block ", 6);
            let at = Vector3::from_fn(|axis, _| 0.5 * (box_of[2 * axis] + box_of[2 * axis + 1]));
            let spheres = bodies[frame.kind[i]].outer.spheres();
            let centres = spheres.iter().map(|s| frame.orientation[i] * s.centre);
            let centroid = centres.sum::<Vector3<f64>>() / spheres.len() as f64;
            let error = (at - centroid - frame.position[i]).norm();
            assert!(error < 1e-9, "seed {i} is {error} m away");
            assert_eq!(
                numbers(puts[i], "vel constant ", 3),
                frame.velocity[i].as_slice()
            );
            assert_eq!(
                numbers(puts[i], "omega constant ", 3),
                frame.spin[i].as_slice()
            );
            let q = frame.orientation[i];
            assert_eq!(
                numbers(puts[i], "orientation constant ", 4),
                [q.w, q.i, q.j, q.k]
            );
            let kind = format!("distributiontemplate kind{} ", frame.kind[i] + 1);
            assert!(puts[i].contains(&kind), "{kind}: {}", puts[i]);
        }
    }

    /// With the arm of the sphere, which is LIGGGHTS' own, the coefficient goes out as it is; with that of the body it
    /// grows by the mean of arm over radius: the mean seed is 4.5 to 9.3 mm across, so that a surface sphere of 0.45 mm has its
    /// contact at an arm of 5.0 to 10.3 radii.
    #[test]
    fn rolling_friction_goes_out_for_the_arm_of_the_sphere() {
        let mut scene = drum();
        for contact in scene.contact.values_mut() {
            contact.rolling_friction = FrictionCoefficient::new(0.1).unwrap();
        }
        let (_, bodies, step) = starting_frame(&scene, &FillingLibrary::default(), 1).unwrap();
        let greatest = |lever: RollingLever| -> f64 {
            let mut scene = scene.clone();
            scene.model.rolling_lever = lever;
            let files = deck(&scene, &bodies, step, 1).unwrap();
            let line = files[0].text.lines().find(|l| l.contains("fix rolling "));
            let words = line.unwrap().split_whitespace().skip(7);
            words.map(|w| w.parse().unwrap()).fold(0.0, f64::max)
        };
        assert_eq!(greatest(RollingLever::Sphere), 0.1);
        let of_body = greatest(RollingLever::Centre);
        assert!((0.50..1.03).contains(&of_body), "{of_body}");
    }

    /// Cohesion of the seeds among themselves goes out for their pair, 0 for the walls, and the model is on in all contacts; a scene
    /// without it names no cohesion.
    #[test]
    fn cohesion_by_area_goes_out_as_sjkr() {
        let mut scene = drum();
        let (_, bodies, step) = starting_frame(&scene, &FillingLibrary::default(), 1).unwrap();
        let deck = |scene: &Scene| deck(scene, &bodies, step, 1).unwrap()[0].text.clone();
        assert!(!deck(&scene).contains("cohesion"));
        let own = scene.contact.get_mut("seed-seed").unwrap();
        own.cohesion_energy_density_j_m3 = Some(4e3);
        let text = deck(&scene);
        assert_eq!(
            text.matches("tangential history cohesion sjkr").count(),
            3,
            "{text}"
        );
        let line = text.lines().find(|l| l.contains("fix cohesion ")).unwrap();
        let words = line.split_whitespace().skip(7);
        let numbers: Vec<f64> = words.map(|w| w.parse().unwrap()).collect();
        assert_eq!(numbers[0], 4e3);
        assert!(numbers[1..].iter().all(|k| *k == 0.0), "{line}");
    }

    #[test]
    fn what_liggghts_would_run_otherwise_is_refused() {
        let scene = drum();
        let (_, bodies, step) = starting_frame(&scene, &FillingLibrary::default(), 1).unwrap();
        let mut spring = scene.clone();
        spring.model.rolling_law = RollingLaw::SpringDashpot;
        let mut shared = scene.clone();
        shared.model.dashpot_mass = dem_solver::DashpotMass::Shared;
        let mut mixed = scene;
        mixed.model.whole_seed_damping = 0.25;
        let refused = [
            (spring, "type C"),
            (shared, "shares the mass"),
            (mixed, "whole-seed damping of 0.25"),
        ];
        for (scene, word) in refused {
            let error = deck(&scene, &bodies, step, 1).unwrap_err().to_string();
            assert!(
                error.contains(word) && error.contains("LIGGGHTS"),
                "{error}"
            );
        }
    }

    /// LIGGGHTS reads signed 32-bit numbers: no seed of a loop exceeds them, and no two of a thousand share their first primes.
    #[test]
    fn primes_of_any_seed_are_numbers_that_liggghts_reads() {
        let seeds = (0..500).chain(5_000_000..5_000_500).chain([u64::MAX]);
        let mut firsts: Vec<u64> = seeds.map(first_of).collect();
        assert!(firsts.iter().all(|first| *first < 2_147_000_000));
        firsts.sort_unstable();
        assert!(firsts.windows(2).all(|w| w[1] - w[0] > 500), "they overlap");
    }

    #[test]
    fn primes_are_primes() {
        let found: Vec<u64> = primes_from(10_007).take(3).collect();
        assert_eq!(found, [10_007, 10_009, 10_037]);
    }
}
