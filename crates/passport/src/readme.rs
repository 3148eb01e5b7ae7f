//! The page of a passport: values, where they hold, conventions, and the self-test in prose.

use crate::case::Case;
use crate::convention::rolling_law_in_words;
use crate::folder::{Grain, Passport};
use crate::model::Model;
use crate::packing::{FARTHEST, Packing, SLICE};
use contact_law::{NormalForceEnd, RollingLever};
use dem_solver::DashpotMass;
use input::quantity::significant;
use scene::RollingLaw;

/// The page.
pub(crate) fn readme(passport: &Passport, cases: &[Case]) -> String {
    [
        "# Passport of contact parameters\n\nThese parameters belong to the conventions below. The self-test finds out \
         whether another code reads them in the same way.\n"
            .to_owned(),
        values(passport),
        validity(passport),
        LIMITS.to_owned(),
        conventions(&passport.model),
        self_test(passport, cases),
    ]
    .join("\n")
}

/// Parameters of the model and the calibrated ones with their errors.
fn values(passport: &Passport) -> String {
    let model = &passport.model;
    let mut text = String::from(
        "## Values\n\n| contact | restitution | static friction | rolling friction | attraction, N | cohesion energy density, J/m3 |\n\
         |---|--:|--:|--:|--:|--:|\n",
    );
    for (other, c) in [&model.grain, &model.wall].into_iter().zip(&model.contacts) {
        let numbers = [
            c.restitution,
            c.static_friction,
            c.rolling_friction,
            c.attraction_n,
            c.cohesion_energy_density_j_m3,
        ]
        .map(|x| significant(x, 6));
        text.extend([format!(
            "| {}-{other} | {} |\n",
            model.grain,
            numbers.join(" | ")
        )]);
    }
    text += "\n| material | shear modulus, Pa | Young's modulus, Pa | Poisson's ratio |\n|---|--:|--:|--:|\n";
    for (name, m) in [&model.grain, &model.wall]
        .into_iter()
        .zip(&model.materials)
    {
        let [g, e, nu] =
            [m.shear_modulus, m.youngs_modulus(), m.poisson_ratio].map(|x| significant(x, 6));
        text.extend([format!("| {name} | {g} | {e} | {nu} |\n")]);
    }
    text.extend([format!(
        "\nThe spheres of the self-test have the mean volume and mass of the grains: radius {} m, density {} kg/m3.\n",
        significant(model.radius_m, 6),
        significant(model.density_kg_m3, 6),
    )]);
    if !passport.calibrated.is_empty() {
        text += "\nCalibrated:\n\n| symbol | name | value | standard error | 95 % interval |\n|---|---|--:|--:|--:|\n";
        for row in &passport.calibrated {
            let interval = row.interval95.map_or("unknown".into(), |[low, high]| {
                format!("{} to {}", significant(low, 3), significant(high, 3))
            });
            let se = row.se.map_or("not fixed".into(), |se| significant(se, 2));
            let unit = if row.unit == "1" { "" } else { &row.unit };
            text.extend([format!(
                "| {} | {} | {} {unit} | {se} | {interval} |\n",
                row.symbol,
                row.name,
                significant(row.value, 4)
            )]);
        }
    }
    if let Some(rows) = &passport.correlation {
        text += "\nCorrelations, in the order of the table:\n\n```text\n";
        for row in rows {
            let row: Vec<String> = row.iter().map(|x| format!("{x:6.2}")).collect();
            text.extend([format!("{}\n", row.join(" "))]);
        }
        text += "```\n\n`covariance.csv` has the covariance: each cell is in the product of the units of its row and column.\n";
    }
    text
}

/// Where the values were fitted.
fn validity(passport: &Passport) -> String {
    let v = &passport.validity;
    let grains: Vec<String> = v.grains.iter().map(grain).collect();
    let mut text = format!(
        "## Where they hold\n\n\
         - Grains: {}; the diameter is that of the sphere of equal volume.\n\
         - Apparatus: {}.\n\
         - Speed: up to {} m/s.\n\
         - Stress: up to {} Pa, the weight of a bed as deep as the apparatus.\n\
         - Regime: {}.\n",
        grains.join("; "),
        v.apparatus,
        significant(v.speed_m_s, 3),
        significant(v.stress_pa, 2),
        if v.regimes.is_empty() {
            "unknown, as the values come without a result".to_owned()
        } else {
            v.regimes.join(", ")
        },
    );
    match v.met {
        Some(true) => text += "- The calibration met its measurements and checks.\n",
        Some(false) => text += "- **The calibration did not meet all measurements and checks.**\n",
        None => {
            text += "- Whether the values met any measurement is not known: they come without a result.\n";
        }
    }
    if let Some(verdict) = &v.verdict {
        text.extend([format!("- Verdict: {verdict}.\n")]);
    }
    for row in &v.measurements {
        text.extend([format!("- {row}\n")]);
    }
    text
}

/// Grains of one kind in words.
fn grain(grain: &Grain) -> String {
    let shape = match grain.spheres {
        1 => "a sphere".to_owned(),
        n => format!("{n} spheres"),
    };
    let diameter = significant(1e3 * grain.diameter_m, 3);
    format!("{} of {diameter} mm, {shape} each", grain.name)
}

/// What no parameters can promise.
const LIMITS: &str = "\
## What they cannot promise

- **Another regime.** The values are those of the motion named above. A faster or slower flow, impacts instead of sliding, or a higher
  load may need other effects; then the same values can be wrong in every code.
- **Another size.** Rolling friction and cohesion act against weight and inertia in other proportions if the grains are larger or
  smaller, or coarse-grained.
- **Another shape.** Rolling friction makes up for shape. With other spheres per grain, or real shape, calibrate again.
- **Another pair.** The self-test covers one wall; coefficients at another wall are not tested.
- A passed self-test says that two codes read the parameters alike. It does not say that the parameters are right.
";

/// The conventions with formula and source.
fn conventions(model: &Model) -> String {
    let end = match model.normal_force_end {
        NormalForceEnd::Clipped => {
            "clipped: `F_n = max(F_n, 0)`; the normal force never pulls, so the rebound exceeds the coefficient"
        }
        NormalForceEnd::Attractive => {
            "attractive: the dashpot may pull until the surfaces part, as the formula of the restitution assumes"
        }
    };
    let mass = match model.dashpot_mass {
        DashpotMass::Sphere => {
            "the mass of the sphere in contact (in a clump its fraction of the mass)"
        }
        DashpotMass::Body | DashpotMass::Shared => "the mass of the whole body",
    };
    let lever = match model.rolling_lever {
        RollingLever::Centre => "from the contact to the centre of mass of the body",
        RollingLever::Sphere => "from the contact to the centre of the sphere, `R - d/2`",
    };
    let law = rolling_law_in_words(model.rolling_law);
    let twist = match model.rolling_law {
        RollingLaw::ConstantTorque => {
            "the torque is against the whole relative spin, twisting about the normal included"
        }
        RollingLaw::SpringDashpot => {
            "none: the rolling spring takes the part of the relative spin across the normal; its stiffness is `2.25 * 8 G* a L^2`, its dashpot \
             `0.6 sqrt(I k)` below the limit and zero at it, with I the moments of both bodies about the contact in series"
        }
    };
    format!(
        "## Conventions\n\n\
         With overlap d, radius of the contact `a = sqrt(R* d)`, `1/R* = 1/R_i + 1/R_j` (R at a wall), `1/m* = 1/m_i + 1/m_j` (m at a wall), \
         and the damping ratio `b = -ln e / sqrt(ln^2 e + pi^2)`:\n\n\
         | convention | here | source |\n|---|---|---|\n\
         | moduli | the scene states G or E, `E = 2 G (1 + nu)`; `1/E* = (1 - nu_i^2)/E_i + (1 - nu_j^2)/E_j`, `1/G* = (2 - nu_i)/G_i + (2 - nu_j)/G_j` | Hertz 1881; Mindlin 1949 |\n\
         | normal force | `4/3 E* a d + 2 sqrt(5/6) b sqrt(2 E* a m*) v_n` | Hertz 1881; Tsuji 1992 |\n\
         | end of the normal force | {end} | own |\n\
         | mass of the dashpot | m is {mass} | own |\n\
         | restitution, friction, rolling | stated for each pair of materials; nothing is averaged or mixed | own |\n\
         | tangential force | `-(8 G* a s + 2 sqrt(5/6) b sqrt(8 G* a m*) v_t)` | Tsuji 1992 |\n\
         | tangential history | the displacement s is kept and turned with the contact; on unloading the force falls with a, s stays | Cundall and Strack 1979 |\n\
         | order of the limits | first s is shortened until `8 G* a s <= mu max(F_n, 0)`, then spring and dashpot together to the same; a normal force that pulls carries no friction | own |\n\
         | rolling resistance | {law}: `mu_r F_n L`, `1/L = 1/l_i + 1/l_j` (l at a wall); two equal spheres have `L = R/2`, not R and not 2 R | Ai 2011 |\n\
         | lever arm l | {lever} | Ai 2011 |\n\
         | twisting | {twist} | Ai 2011 |\n\
         | point of contact | the middle of the overlap: forces act at the distance `R - d/2` from the centre of a sphere | own |\n\
         | wall | a plane at rest, of infinite mass and radius | own |\n\
         | cohesion | constant attraction while the surfaces overlap, and `k 2 pi R* d`; the limit of sliding is `mu` times the repulsive part | Kloss 2012 |\n\
         | time step | a fraction of the duration of a Hertz impact, `2.94 (15 m / (16 sqrt(R) E*))^(2/5) v^(-1/5)`; not of a Rayleigh time | Hertz 1881 |\n\n\
         Sources: Hertz, Journal für die reine und angewandte Mathematik 92 (1881) 156; Mindlin, Journal of Applied Mechanics 16 (1949) 259; \
         Cundall and Strack, Géotechnique 29 (1979) 47; Tsuji, Tanaka and Ishida, Powder Technology 71 (1992) 239; Ai, Chen, Rotter and Ooi, \
         Powder Technology 206 (2011) 269; Kloss and others, Progress in Computational Fluid Dynamics 12 (2012) 140; own: a choice of seedloop.\n"
    )
}

/// How to run the self-test, and the cases.
fn self_test(passport: &Passport, cases: &[Case]) -> String {
    let model = &passport.model;
    let mut text = format!(
        "## Self-test\n\n\
         1. Build each case from `runs.csv` (time step, gravity, times), `walls.csv` (planes; the normal points to the spheres), \
         `bodies.csv` (positions of the centres of mass, velocities, spins) and `spheres.csv`. All is in SI units; y is up.\n\
         2. Run it to t1, and to t2 if there is one, and write the numbers into `RESULTS.csv`. Velocity, spin (angular velocity) and displacement \
         are those of body 1, in the frame of the world; of bed and heap report the mean x, each x counted as {FARTHEST} radii at most, and the mean y \
         of all centres. A shorter time step is as good.\n\
         3. Run `seedloop passport --check RESULTS.csv` beside this folder's `passport.json`; for a code of `other-codes.md` with `--code NAME`.\n\n\
         `expected.csv` has the expected numbers, computed by seedloop, the band (one standard deviation: numerical for the small cases, \
         over random starts for bed and heap), and a closed form if there is one. `run_lammps.py`, `run_liggghts.py` and `run_yade.py` \
         do steps 1 and 2. `other-codes.md` compares the conventions of other codes.\n\n| case | shows |\n|---|---|\n"
    );
    for case in cases {
        text.extend([format!("| {} | {} |\n", case.name, case.shows)]);
    }
    for packing in Packing::ALL {
        let n = packing.starts(model, 1).len();
        let shows = match packing {
            Packing::Bed => format!(
                "{n} spheres fall into a slice of {} by {} radii while gravity is tilted by 20 deg.",
                SLICE[0], SLICE[1]
            ),
            Packing::Heap => format!(
                "A column of {n} spheres in a slice {} radii wide, open on one side, collapses into a heap.",
                SLICE[1]
            ),
        };
        text.extend([format!("| {} | {shows} |\n", packing.name())]);
    }
    text
}
