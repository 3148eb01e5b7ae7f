//! A bench as a deck for LAMMPS: walls are regions, which move and are taken away phase by phase.
//!
//! # What is converted
//!
//! | here | LAMMPS |
//! |---|---|
//! | plane | `region plane` |
//! | rectangle | the one face of a `region block` that is not open, turned if it is inclined; both its sides touch |
//! | tube, cone | `region cylinder`, `region cone` with open ends; of equal cross-section, since the walls here have 48 sides |
//! | disc | the one end of a `region cylinder` along z that is not open, turned |
//! | ring | a `region cone` of nearly no height; LAMMPS takes its circles for curved, so that contacts on it are stiffer by some percent |
//! | rolling friction | `rolling sds` with the spring and the dashpot of type C under ten times the weight of a seed |
//! | wall under a load | the region moves by the same law, which two `fix controller` integrate |
//! | seeds that appear over time | `fix deposit` |

use super::motion::Lammps;
use super::regions::{Region, Regions, constant_turn, regions, spin_of};
use super::{
    GranularContact, TOOL, contact, data, dump_columns, rigid_bodies, surface_atoms, words_with,
};
use crate::exchange::Error;
use crate::exchange::bench_deck::{AXES, BenchDeck, script};
use crate::exchange::drum_deck::{are_spheres, coheres, first_of, plain_atoms};
use crate::exchange::vtk::{File, add};
use contact_law::rolling_spring_dashpot::{DAMPING_RATIO, STIFFNESS_RATIO};
use scene::{Frame, RollingLaw, Scene, SeedBody};
use std::sync::Arc;

/// The deck: `in.bench`, and `bench.data`, `bench.bodies` or the molecules that appear.
pub(super) fn deck(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    (start, seed): (&Frame, u64),
    time_step: f64,
) -> Result<Vec<File>, Error> {
    if scene.contact.values().any(coheres) {
        return Err(super::no_cohesion());
    }
    let deck = BenchDeck::of(scene, bodies, time_step, TOOL)?;
    let regions = regions(&deck)?;
    let lammps = Lammps {
        regions: &regions,
        columns: dump_columns(bodies),
    };
    let mut text = head(&deck, start);
    text.push_str(&walls(&deck, &regions, seed)?);
    text.push_str(&script(&deck, &lammps));
    let file = |name: String, text| File { name, text };
    let mut files = vec![file("in.bench".into(), text)];
    if deck.procedure.inlet.is_some() {
        let kinds = bodies.iter().enumerate();
        files
            .extend(kinds.map(|(k, body)| file(format!("seed{}.molecule", k + 1), molecule(body))));
        return Ok(files);
    }
    if are_spheres(bodies) {
        let atoms = (plain_atoms(bodies, start), "sphere");
        files.push(file(
            "bench.data".into(),
            data(&deck.domain, atoms, start.kind.len()),
        ));
        return Ok(files);
    }
    let atoms = surface_atoms(bodies, start);
    let n = atoms.lines().count();
    files.push(file(
        "bench.data".into(),
        data(&deck.domain, (atoms, "hybrid"), n),
    ));
    files.push(file("bench.bodies".into(), rigid_bodies(bodies, start)));
    Ok(files)
}

/// The head of the script up to the walls.
fn head(deck: &BenchDeck<'_>, start: &Frame) -> String {
    let (scene, bodies) = (deck.scene, deck.bodies);
    let spheres = bodies.iter().flat_map(|b| b.outer.spheres());
    let smallest = spheres.map(|s| s.radius).fold(f64::INFINITY, f64::min);
    let longest = bodies
        .iter()
        .map(|b| b.clump.bounding_radius())
        .fold(0.0, f64::max);
    let [bins, sorted] = deck.bins(smallest);
    let [style, cutoff, exclude, disable] = if are_spheres(bodies) {
        [
            "sphere".to_owned(),
            String::new(),
            String::new(),
            String::new(),
        ]
    } else {
        [
            "hybrid sphere molecular".to_owned(),
            format!(" cutoff {:e}", 2.0 * longest + 4.0 * smallest),
            " exclude molecule/intra all".to_owned(),
            " disable".to_owned(),
        ]
    };
    let atoms = if deck.procedure.inlet.is_some() {
        let [low, high] = deck.domain;
        format!(
            "region box block {:e} {:e} {:e} {:e} {:e} {:e}\ncreate_box 1 box\n",
            low.x, high.x, low.y, high.y, low.z, high.z
        )
    } else {
        "read_data bench.data\n".into()
    };
    format!(
        "# {} seeds in the apparatus '{}', written from {}; run it with -in, since it jumps to labels.\n\
         # Contacts are converted, not copied: E and nu of a contact are those of both sides, the restitution is that\n\
         # of a dashpot with the mass of the rigid body, rolling friction that of the spheres' arm.\n\
         # {} seeds are where they start here.\n\
         units si\n\
         atom_style {style}\n\
         boundary f f f\n\
         newton off\n\
         comm_modify vel yes{cutoff}\n\
         {atoms}\
         neighbor {:e} bin\n\
         neigh_modify delay 0 every 1 check yes{bins}{exclude}\n\
         {sorted}\
         timestep {:e}\n\
         pair_style granular\n\
         fix weight all gravity {} vector 0 -1 0{disable}\n",
        scene.seed_count(),
        scene.apparatus.kind(),
        scene.file,
        start.position.len(),
        0.5 * smallest,
        deck.time_step,
        scene.model.gravity_m_s2,
    )
}

/// Laws, walls, seeds and variables.
fn walls(deck: &BenchDeck<'_>, regions: &Regions, seed_number: u64) -> Result<String, Error> {
    let (scene, bodies) = (deck.scene, deck.bodies);
    let law = |other: &str, is_wall| {
        contact(scene, bodies, other).map(|c| words_with(scene, &c, rolling(deck, &c, is_wall)))
    };
    let seed = &scene.seed[0].material;
    let mut text = format!("pair_coeff * * {}\n", law(seed, false)?);
    let motion = if are_spheres(bodies) {
        "fix seeds all nve/sphere"
    } else {
        "fix seeds all rigid/small molecule infile bench.bodies gravity weight"
    };
    add(
        &mut text,
        format_args!("{motion}\n{}", pour(deck, seed_number)),
    );
    let (moving, turning) = if are_spheres(bodies) {
        ("all ke", "all erotate/sphere")
    } else {
        ("all ke/rigid seeds", "all erotate/rigid seeds")
    };
    add(
        &mut text,
        format_args!(
            "compute moving {moving}\ncompute turning {turning}\n\
             variable kinetic equal c_moving+c_turning\n\
             variable mass equal mass(all)\n\
             variable seeds equal {}\n",
            if are_spheres(bodies) {
                "count(all)".to_owned()
            } else {
                scene.seed_count().to_string()
            },
        ),
    );
    for (k, wall) in deck.procedure.walls.iter().enumerate() {
        text += &wall_of(deck, k, &regions[k], &law(&wall.material, true)?);
    }
    Ok(text)
}

/// Wall k by its regions, with the variables of its way and of the force on it.
fn wall_of(deck: &BenchDeck<'_>, k: usize, regions: &[Region], law: &str) -> String {
    let (id, mut text) = (&deck.ids[k], String::new());
    let mut way = String::new();
    if deck.motions_of(k).next().is_some() {
        let first = |d: &str| format!("variable {d}_{id} equal 0.0\n");
        text.extend(["dx", "dy", "dz", "turn"].map(first));
        way = format!(" move v_dx_{id} v_dy_{id} v_dz_{id}");
    }
    let mut spin = String::new();
    if deck.motions_of(k).any(|motion| motion.spin.norm() > 0.0) {
        spin = spin_of(deck, k);
    }
    let mut sums = [String::new(), String::new(), String::new()];
    for (part, (shape, turn)) in regions.iter().enumerate() {
        let name = format!("{id}_{}", part + 1);
        let (shape, constant) = constant_turn(shape, turn.is_some(), &name);
        add(
            &mut text,
            format_args!(
                "{constant}region at_{name} {shape}{way}{spin}\n\
                 fix wall_{name} all wall/gran/region granular {law} region at_{name} contacts\n\
                 compute push_{name} all reduce sum f_wall_{name}[2] f_wall_{name}[3] f_wall_{name}[4]\n"
            ),
        );
        for (k, sum) in sums.iter_mut().enumerate() {
            add(sum, format_args!("-c_push_{name}[{}]", k + 1));
        }
    }
    for (axis, sum) in AXES.iter().zip(sums) {
        add(
            &mut text,
            format_args!("variable f{axis}_{id} equal 0.0{sum}\n"),
        );
    }
    text
}

/// Spring (N/m) and dashpot (N s/m) of rolling in a bench.
///
/// # Formula
///
/// ```text
/// k = 2.25 k_t      c = 2 eta sqrt(I_r k) / R*      k_t = 8 G* sqrt(R* d)      d = (3 F / (4 E* sqrt(R*)))^(2/3)
/// ```
///
/// Those of type C ([`contact_law::rolling_spring_dashpot`]) under ten times the weight of a seed, since LAMMPS has a constant spring; type A
/// has no dashpot. A spring that is softer gives way while a poured seed hits the bed: its torque then stays far below the limit, and
/// the seed rolls away.
fn rolling(deck: &BenchDeck<'_>, contact: &GranularContact, is_wall: bool) -> [f64; 2] {
    let clump = &deck.bodies[0].clump;
    let radius = clump.spheres()[0].radius;
    let (mass, share) = (clump.mass(), if is_wall { 1.0 } else { 0.5 });
    let reduced = share * radius;
    // E and nu of LAMMPS are those of both sides alike.
    let young = contact.young / (2.0 * (1.0 - contact.poisson * contact.poisson));
    let shear = contact.young / (4.0 * (2.0 - contact.poisson) * (1.0 + contact.poisson));
    let load = 10.0 * mass * deck.scene.model.gravity_m_s2;
    let overlap = (3.0 * load / (4.0 * young * reduced.sqrt())).powf(2.0 / 3.0);
    let stiffness = STIFFNESS_RATIO * 8.0 * shear * (reduced * overlap).sqrt();
    if deck.scene.model.rolling_law == RollingLaw::ConstantTorque {
        return [stiffness, 0.0];
    }
    let inertia = share * 1.4 * mass * radius * radius;
    let damping = 2.0 * DAMPING_RATIO * (inertia * stiffness).sqrt() / reduced;
    [stiffness, damping]
}

/// The insertion of seeds that appear over time.
fn pour(deck: &BenchDeck<'_>, seed: u64) -> String {
    let Some([radius, low, high]) = deck.inlet() else {
        return String::new();
    };
    let scene = deck.scene;
    let mut text = String::new();
    let all = scene.seed_count().max(1) as f64;
    let radii = deck.bodies.iter().map(|b| b.clump.bounding_radius());
    let largest = radii.fold(0.0, f64::max);
    for (k, (kind, body)) in scene.seed.iter().zip(deck.bodies).enumerate() {
        let own = body.clump.bounding_radius();
        let every = all / (deck.rate() * scene.count_of(kind).max(1) as f64 * deck.time_step);
        let number = k + 1;
        add(
            &mut text,
            format_args!(
                "molecule seed{number} seed{number}.molecule\n\
                 region inlet{number} cylinder y 0 0 {:e} {:e} {:e}\n\
                 fix pour{number} all deposit {} 0 {} {} region inlet{number} near {:e} attempt 10000 mol seed{number}\n",
                radius - own,
                low + own,
                (high - own).max(low + 1.01 * own),
                scene.count_of(kind),
                every.floor().max(1.0),
                first_of(seed) + 1009 * k as u64,
                own + largest,
            ),
        );
    }
    text
}

/// A plain sphere as a molecule.
fn molecule(body: &SeedBody) -> String {
    format!(
        "# A seed that appears\n\n1 atoms\n\nCoords\n\n1 0 0 0\n\nTypes\n\n1 1\n\nDiameters\n\n1 {:e}\n\nMasses\n\n1 {:e}\n",
        2.0 * body.clump.spheres()[0].radius,
        body.clump.mass()
    )
}
