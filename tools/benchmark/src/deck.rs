//! Input of LIGGGHTS and LAMMPS: the same positions and motion, the same law; for plain spheres also the same
//! step.

use crate::seed_drum::SeedDrum;
use crate::sphere_drum::{DENSITY, GRAVITY, RADIUS, SphereDrum};
use simulators::exchange::vtk::File;
use simulators::exchange::{lammps, liggghts};
use std::fmt::Write as _;

/// Name of the script in each folder.
pub(crate) const SCRIPT: &str = "in.drum";

/// A code to compare with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Code {
    Liggghts,
    Lammps,
}

impl Code {
    /// Name of the code.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Liggghts => "LIGGGHTS",
            Self::Lammps => "LAMMPS",
        }
    }
}

/// Script that the peers start between blocks: it adds the time on the processor, of several processes that by the clock (ns), and the
/// peak memory (KiB) of the process that started it to a file.
pub(crate) fn sample(plan: &Plan) -> String {
    let time = if plan.ranks > 1 {
        "date +%s%N"
    } else {
        "cut -d' ' -f1 /proc/$PPID/schedstat"
    };
    format!("echo \"$({time}) $(awk '/VmHWM/ {{print $2}}' /proc/$PPID/status)\" >> samples.txt\n")
}

/// How a peer is run.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plan {
    pub(crate) block_steps: usize,
    /// Blocks behind the first, which warms up.
    pub(crate) blocks: u32,
    /// Time step, s.
    pub(crate) time_step: f64,
    /// Neighbour skin of plain spheres, m.
    pub(crate) skin: f64,
    /// Processes of a peer, and threads of this solver.
    pub(crate) ranks: u8,
}

/// The files of a drum of plain spheres.
pub(crate) fn of_spheres(drum: &SphereDrum, code: Code, plan: &Plan) -> Vec<File> {
    let script = match code {
        Code::Liggghts => spheres_in_liggghts(drum, plan),
        Code::Lammps => spheres_in_lammps(drum, plan),
    };
    let file = |name: &str, text| File {
        name: name.into(),
        text,
    };
    vec![file(SCRIPT, script), file("spheres.data", data(drum))]
}

/// The files of a drum of seeds: those of `seedloop export`, from the flow on.
///
/// # Errors
///
/// A drum that the code cannot run.
pub(crate) fn of_seeds(drum: &SeedDrum, code: Code, plan: &Plan) -> anyhow::Result<Vec<File>> {
    let mut scene = drum.scene.clone();
    // The seeds flow already: the shell turns from the first step on.
    scene.protocol.settle_limit = input::quantity::Time::from_si(0.0)?;
    let (start, step) = (drum.frame(), plan.time_step);
    let (mut files, energy) = match code {
        Code::Liggghts => {
            let from = liggghts::Start::Frame(&start);
            let files = liggghts::setup(&scene, &drum.bodies, from, step)?;
            (files, "compute energy all ke/multisphere\n")
        }
        Code::Lammps => {
            let files = lammps::setup(&scene, &drum.bodies, &start, step)?;
            (files, "compute energy all ke/rigid seeds\n")
        }
    };
    files[0].text.push_str(energy);
    files[0].text.push_str(&run_blocks(plan, "c_energy"));
    Ok(files)
}

/// Spheres as both codes read them.
fn data(drum: &SphereDrum) -> String {
    let reach = drum.radius + RADIUS;
    let half = 0.5 * drum.width + RADIUS;
    let n = drum.placements.len();
    let mut text = format!(
        "spheres in a drum\n\n{n} atoms\n3 atom types\n\n{0:e} {reach:e} xlo xhi\n\
         {0:e} {reach:e} ylo yhi\n{1:e} {half:e} zlo zhi\n\nAtoms\n\n",
        -reach, -half
    );
    for (i, at) in drum.placements.iter().enumerate() {
        let (p, diameter) = (at.position, 2.0 * RADIUS);
        let id = i + 1;
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{id} 1 {diameter:e} {DENSITY:e} {:e} {:e} {:e}",
            p.x, p.y, p.z
        );
    }
    text.push_str("\nVelocities\n\n");
    for (i, at) in drum.placements.iter().enumerate() {
        let (v, w) = (at.velocity, at.spin);
        let id = i + 1;
        let _ = writeln!(
            text,
            "{id} {:e} {:e} {:e} {:e} {:e} {:e}",
            v.x, v.y, v.z, w.x, w.y, w.z
        );
    }
    text
}

/// Deck of LIGGGHTS.
fn spheres_in_liggghts(drum: &SphereDrum, plan: &Plan) -> String {
    let contacts = &drum.contacts;
    let young = contacts.materials.map(|m| m.youngs_modulus());
    let poisson = contacts.materials.map(|m| m.poisson_ratio);
    let pairs = |of: fn(&contact_law::PairParameters) -> f64| {
        let table = (0..3).flat_map(|i| (0..3).map(move |j| usize::max(i, j)));
        list(table.map(|k| of(&contacts.parameters[k])))
    };
    // A wall takes its shape between the name of the law and its settings.
    let (law, end) = ("model hertz tangential history", "limitForce on");
    // The shear of a cylinder along z is named after x and given in rad/s: a sphere laid on the
    // shell came to roll at 2/7 of its surface speed.
    let (radius, half, spin) = (drum.radius, 0.5 * drum.width, drum.spin);
    format!(
        "atom_style granular\natom_modify map array\nboundary f f f\nnewton off\n\
         communicate single vel yes\nunits si\nhard_particles yes\nread_data spheres.data\n\
         neighbor {skin:e} bin\nneigh_modify delay 0\n\
         fix young all property/global youngsModulus peratomtype {young}\n\
         fix poisson all property/global poissonsRatio peratomtype {poisson}\n\
         fix restitution all property/global coefficientRestitution peratomtypepair 3 {restitution}\n\
         fix friction all property/global coefficientFriction peratomtypepair 3 {friction}\n\
         pair_style gran {law} {end}\npair_coeff * *\ntimestep {step:e}\n\
         fix weight all gravity {GRAVITY} vector 0.0 -1.0 0.0\n\
         fix shell all wall/gran {law} primitive type 2 zcylinder {radius:e} 0. 0. shear x {spin:e} {end}\n\
         fix back all wall/gran {law} primitive type 3 zplane {low:e} {end}\n\
         fix front all wall/gran {law} primitive type 3 zplane {half:e} {end}\n\
         fix motion all nve/sphere\n{run}",
        skin = plan.skin,
        step = plan.time_step,
        young = list(young),
        poisson = list(poisson),
        restitution = pairs(|p| p.restitution),
        friction = pairs(|p| p.static_friction),
        low = -half,
        run = run_blocks(plan, "ke"),
    )
}

/// Deck of LAMMPS.
fn spheres_in_lammps(drum: &SphereDrum, plan: &Plan) -> String {
    let moduli = drum.contacts.moduli();
    let law = |k: usize| {
        let (m, p) = (&moduli[k], &drum.contacts.parameters[k]);
        format!(
            "hertz {:e} {:e} tangential mindlin {:e} {:e} {:e} damping coeff_restitution limit_damping",
            4.0 / 3.0 * m.young,
            p.restitution,
            8.0 * m.shear,
            // Ratio of the dashpots, c_t / c_n.
            (4.0 * m.shear / m.young).sqrt(),
            p.static_friction
        )
    };
    // A cylinder of wall/gran does not turn about its axis; a region does.
    let (radius, half) = (drum.radius, 0.5 * drum.width);
    format!(
        "atom_style sphere\natom_modify map array\nboundary f f f\nnewton off\ncomm_modify vel yes\n\
         units si\nread_data spheres.data\nneighbor {skin:e} bin\nneigh_modify delay 0\n\
         pair_style granular\npair_coeff * * {own}\ntimestep {step:e}\n\
         fix weight all gravity {GRAVITY} vector 0 -1 0\n\
         variable angle equal {spin:e}*dt*step\n\
         region shell cylinder z 0 0 {radius:e} {beyond_low:e} {beyond:e} side in open 1 open 2 &\n\
         rotate v_angle 0 0 0 0 0 1\n\
         fix shell all wall/gran/region granular {shell} region shell\n\
         fix covers all wall/gran granular {cover} zplane {low:e} {half:e}\n\
         fix motion all nve/sphere\n{run}",
        skin = plan.skin,
        step = plan.time_step,
        own = law(0),
        shell = law(1),
        cover = law(2),
        spin = drum.spin,
        beyond = half + RADIUS,
        beyond_low = -half - RADIUS,
        low = -half,
        run = run_blocks(plan, "ke"),
    )
}

/// The steps with a sample behind each block, and the bed at the end; `energy` is what the code calls the kinetic
/// energy of translation.
fn run_blocks(plan: &Plan, energy: &str) -> String {
    let mut text = format!(
        "variable x equal xcm(all,x)\nvariable y equal xcm(all,y)\nvariable e equal {energy}\n\
         thermo_style custom step {energy}\nthermo_modify norm no\nthermo 1000000\n",
    );
    for _ in 0..=plan.blocks {
        let _ = writeln!(text, "run {}\nshell exec sh sample.sh", plan.block_steps);
    }
    text.push_str("print \"result $x $y $e\"\n");
    text
}

/// Numbers with blanks between.
fn list(numbers: impl IntoIterator<Item = f64>) -> String {
    let words: Vec<_> = numbers.into_iter().map(|n| format!("{n:e}")).collect();
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::{Code, Plan, of_seeds, of_spheres};
    use crate::contacts::Contacts;
    use crate::seed_drum::SeedDrum;
    use crate::sphere_drum::{SphereDrum, TIME_STEP};
    use dev_support::fixture_files::fixture;
    use scene::{FillingLibrary, Scene};

    // Values by hand for the study's materials: E = 2 G (1 + nu) = 9.1428 MPa; of two seeds
    // E* = G / (1 - nu) = 4.6628 MPa, so 4/3 E* = 6.2171 MPa; G* = G / (2 (2 - nu)) = 1.0780 MPa,
    // so 8 G* = 8.6237 MPa; ratio of the dashpots sqrt(2 (1 - nu) / (2 - nu)) = 0.96163.
    #[test]
    fn both_decks_carry_the_moduli_of_the_scene() {
        let file = fixture("cotton/drum.toml");
        let drum = SphereDrum {
            contacts: Contacts::of(&Scene::read(&file, &[]).unwrap()).unwrap(),
            radius: 0.07,
            width: 0.046,
            spin: 1.0,
            placements: Vec::new(),
        };
        let plan = Plan {
            block_steps: 10,
            blocks: 2,
            time_step: TIME_STEP,
            skin: 1e-3,
            ranks: 1,
        };
        let script = |code| of_spheres(&drum, code, &plan).swap_remove(0).text;
        let (one, other) = (script(Code::Liggghts), script(Code::Lammps));
        let number = |deck: &str, line: &str, word: usize| -> f64 {
            let line = deck.lines().find(|l| l.starts_with(line)).unwrap();
            line.split_whitespace().nth(word).unwrap().parse().unwrap()
        };
        let near = |got: f64, expected: f64| {
            assert!((got / expected - 1.0).abs() < 1e-4, "{got} {expected}");
        };
        near(number(&one, "fix young", 6), 9.1428e6);
        near(number(&other, "pair_coeff", 4), 6.2171e6);
        near(number(&other, "pair_coeff", 8), 8.6237e6);
        near(number(&other, "pair_coeff", 9), 0.96163);
        for deck in [one, other] {
            assert_eq!(deck.matches("run 10\n").count(), 3, "{deck}");
        }
    }

    /// The peers continue with a flow: no step passes before the shell turns, at its 10 rpm = 1.0472 rad/s, and no seed rains
    /// in. Each takes the step of the plan, and gives the energy of the bodies, not that of their spheres.
    #[test]
    fn decks_of_seeds_go_on_from_the_flow() {
        let file = fixture("cotton/drum.toml");
        let scene = Scene::read(&file, &[]).unwrap();
        let library = FillingLibrary::default();
        let bodies = scene.seed.iter().map(|s| library.body(&scene, s).unwrap());
        let drum = SeedDrum {
            bodies: bodies.collect(),
            scene,
            library,
            placements: Vec::new(),
            spheres: 0,
        };
        let plan = Plan {
            block_steps: 10,
            blocks: 2,
            time_step: 1e-5,
            skin: 1e-3,
            ranks: 1,
        };
        let script = |code| of_seeds(&drum, code, &plan).unwrap().swap_remove(0).text;
        let (one, other) = (script(Code::Liggghts), script(Code::Lammps));
        assert!(
            other.contains("1.0471975511965976*dt*(step-0)*(step>0)"),
            "{other}"
        );
        assert!(!one.contains("insert/rate"), "{one}");
        for (deck, energy) in [(one, "ke/multisphere"), (other, "ke/rigid seeds")] {
            assert_eq!(deck.matches("run 10\n").count(), 3, "{deck}");
            assert!(deck.contains("timestep 1e-5\n"), "{deck}");
            assert!(
                deck.contains(&format!("compute energy all {energy}\n")),
                "{deck}"
            );
            assert!(deck.contains("variable e equal c_energy\n"), "{deck}");
        }
    }
}
