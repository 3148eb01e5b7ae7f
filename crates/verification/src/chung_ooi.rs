//! The eight impact tests of `[ChungOoi2011]`.
//!
//! Bodies, materials and speeds are those of the paper as open implementations use them. Tests 1 and 2
//! have closed forms; test 3 compares the restitution that comes out with the one put in. Tests 4 to
//! 8 compare velocity and spin after the impact with the closed form where the contact slides
//! throughout, and with an independent integration of the law elsewhere.

use crate::CheckError;
use crate::impact_reference::{Impact, Outcome};
use crate::row::{Basis, Kind, Row, Tolerance};
use crate::worlds::{ball, clipped, collide, elastic, plane, settings, surface, thrown, world};
use contact_law::{Material, material};
use dem_solver::{InteractionSettings, Placement, World};
use nalgebra::Vector3;

/// Steps of the solver in one contact.
const STEPS: f64 = 4000.0;

/// What a sphere is made of: Young's modulus (Pa), Poisson's ratio, density (kg/m³).
#[derive(Debug, Clone, Copy)]
struct Stuff {
    name: &'static str,
    young: f64,
    poisson: f64,
    density: f64,
}

const fn stuff(name: &'static str, young: f64, poisson: f64, density: f64) -> Stuff {
    Stuff {
        name,
        young,
        poisson,
        density,
    }
}

const GLASS: Stuff = stuff("glass", 48e9, 0.20, 2800.0);
const LIMESTONE: Stuff = stuff("limestone", 20e9, 0.25, 2500.0);
const ALUMINIUM_ALLOY: Stuff = stuff("aluminium alloy", 70e9, 0.30, 2699.0);
const MAGNESIUM_ALLOY: Stuff = stuff("magnesium alloy", 40e9, 0.35, 1800.0);
const ALUMINIUM_OXIDE: Stuff = stuff("aluminium oxide", 380e9, 0.23, 4000.0);
const CAST_IRON: Stuff = stuff("cast iron", 100e9, 0.25, 7000.0);
const ALUMINIUM_ALLOY_B: Stuff = stuff("aluminium alloy", 70e9, 0.33, 2700.0);
const STEEL: Stuff = stuff("steel", 208e9, 0.30, 7850.0);
const NYLON: Stuff = stuff("nylon", 2.5e9, 0.40, 1000.0);

/// A sphere that meets the plane x = 0, or another sphere.
#[derive(Debug, Clone, Copy)]
struct Case {
    stuff: Stuff,
    /// Radius, m.
    radius: f64,
    /// Restitution and friction.
    restitution: f64,
    friction: f64,
    /// Speed of approach and along the plane, m/s.
    approach: f64,
    along: f64,
    /// Spin about z, rad/s.
    spin: f64,
    /// Whether the dashpot may pull.
    pulls: bool,
}

/// Velocity and spin of the first sphere after the impact.
#[derive(Debug, Clone, Copy)]
struct After {
    /// Speed away from the partner, m/s.
    separation: f64,
    /// Velocity along the plane, m/s.
    along: f64,
    /// Spin about z, rad/s.
    spin: f64,
    /// Largest force, N.
    force: f64,
    /// Time of contact, s.
    duration: f64,
}

impl Case {
    /// Mass of the sphere, kg.
    fn mass(&self) -> f64 {
        self.stuff.density * geometry::clump::volume_of_sphere(self.radius)
    }

    /// The surface against a material.
    fn surface(&self, other: Material) -> Result<InteractionSettings, CheckError> {
        let own = elastic(self.stuff.young, self.stuff.poisson)?;
        let settings = surface([own, other], [self.restitution, self.friction, 0.0]);
        Ok(if self.pulls {
            settings
        } else {
            clipped(settings)
        })
    }

    /// The impact as the reference sees it; the partner by its reduced masses and radius.
    fn reference(&self, other: Material, radius: f64, mass: f64) -> Result<Impact, CheckError> {
        let own = elastic(self.stuff.young, self.stuff.poisson)?;
        let moduli = material::effective_moduli(&own, &other);
        Ok(Impact {
            radius,
            mass,
            tangential_mass: 2.0 / 7.0 * mass,
            young: moduli.young,
            shear: moduli.shear,
            restitution: self.restitution,
            friction: self.friction,
            pulls: self.pulls,
            approach: self.approach,
            sliding: self.along + self.spin * self.radius,
        })
    }

    /// Impact on a plane that is rigid against the sphere.
    fn on_a_plane(&self) -> Result<(After, Impact), CheckError> {
        let rigid = Material::new(0.3, 1e13)?;
        let reference = self.reference(rigid, self.radius, self.mass())?;
        // The sphere lies to the right of the plane x = 0 and flies to the left. At the contact, at
        // its left side, the spin about z moves the surface by -w R along y.
        let start = Placement {
            spin: Vector3::z() * -self.spin,
            ..thrown(
                0,
                Vector3::x() * (self.radius * (1.0 + 1e-9)),
                Vector3::new(-self.approach, self.along, 0.0),
            )
        };
        let step = reference.hertz_duration() / STEPS;
        let mut world = world(
            settings(step, Vector3::zeros(), self.radius),
            &self.surface(rigid)?,
            vec![ball(self.radius, self.stuff.density)?],
            vec![plane(Vector3::zeros(), Vector3::x())],
            &[start],
        )?;
        let (force, duration) = peak(&mut world)?;
        let bodies = world.bodies();
        let after = After {
            separation: bodies.velocity[0].x,
            along: bodies.velocity[0].y,
            spin: -bodies.spin[0].z,
            force,
            duration,
        };
        Ok((after, reference))
    }

    /// Impact on a sphere of the same material that is `size` times as large and `heavier` times as
    /// dense; each comes with half of the approach if they are equal, otherwise only the first moves.
    fn on_a_sphere(&self, size: f64, heavier: f64) -> Result<(After, Impact), CheckError> {
        let own = elastic(self.stuff.young, self.stuff.poisson)?;
        let (other_radius, other_mass) = (size * self.radius, self.mass() * size.powi(3) * heavier);
        let reduced = |a: f64, b: f64| a * b / (a + b);
        let equal = size == 1.0 && heavier == 1.0;
        let share = if equal { 0.5 } else { 1.0 };
        let mut reference = self.reference(
            own,
            reduced(self.radius, other_radius),
            reduced(self.mass(), other_mass),
        )?;
        if equal {
            // Both spin alike, so that their surfaces move against each other twice as fast.
            reference.sliding = 2.0 * self.spin * self.radius;
        }
        let turning = |spin: f64, start: Placement| Placement {
            spin: Vector3::z() * -spin,
            ..start
        };
        let gap = 1e-9 * self.radius;
        let speed = Vector3::x() * self.approach;
        let starts = [
            turning(
                self.spin,
                thrown(0, Vector3::x() * (self.radius + gap), -speed * share),
            ),
            turning(
                if equal { self.spin } else { 0.0 },
                thrown(1, Vector3::x() * -other_radius, speed * (1.0 - share)),
            ),
        ];
        let templates = vec![
            ball(self.radius, self.stuff.density)?,
            ball(other_radius, self.stuff.density * heavier)?,
        ];
        let step = reference.hertz_duration() / STEPS;
        let mut world = world(
            settings(step, Vector3::zeros(), self.radius),
            &self.surface(own)?,
            templates,
            Vec::new(),
            &starts,
        )?;
        let (force, duration) = peak(&mut world)?;
        let bodies = world.bodies();
        let after = After {
            separation: bodies.velocity[0].x - bodies.velocity[1].x,
            along: bodies.velocity[0].y,
            spin: -bodies.spin[0].z,
            force,
            duration,
        };
        Ok((after, reference))
    }

    /// What the reference says of velocity and spin of this sphere.
    fn expected(&self, outcome: &Outcome) -> (f64, f64) {
        let mass = self.mass();
        let inertia = 0.4 * mass * self.radius * self.radius;
        let spin = self.spin + outcome.impulse * self.radius / inertia;
        (self.along + outcome.impulse / mass, spin)
    }
}

/// Runs an impact; largest force on the first body (N) and time of contact (s).
fn peak(world: &mut World) -> Result<(f64, f64), CheckError> {
    let (mut force, mut n) = (0.0_f64, 0_u32);
    for _ in 0..20_000 {
        world.step()?;
        if world.census().sphere_contacts + world.n_wall_contacts() > 0 {
            n += 1;
            force = force.max(world.bodies().load[0].force().norm());
        } else if n > 0 {
            return Ok((force, f64::from(n) * world.settings().time_step));
        }
    }
    // Only to tell why: a contact that never ends.
    collide(world, 1).map(|duration| (force, duration))
}

/// Tests 1 and 2: force and duration of elastic impacts.
pub(crate) fn elastic_impacts() -> Result<Vec<Row>, CheckError> {
    let basis = Basis {
        check: "chung-ooi-1-2",
        kind: Kind::Analytical,
        tolerance: Tolerance::Relative(1e-3),
        reason: "4000 steps a contact: first order of the step, twice over",
        source: "Hertz; [ChungOoi2011, tests 1 and 2]",
    };
    let case = |stuff, radius, approach| Case {
        stuff,
        radius,
        restitution: 1.0,
        friction: 0.35,
        approach,
        along: 0.0,
        spin: 0.0,
        pulls: true,
    };
    let mut rows = Vec::new();
    for stuff in [GLASS, LIMESTONE] {
        let (after, reference) = case(stuff, 0.01, 20.0).on_a_sphere(1.0, 1.0)?;
        let name = |what| format!("test 1, two {} spheres: {what}", stuff.name);
        rows.push(basis.row(
            name("largest force"),
            "N",
            reference.hertz_force(),
            after.force,
        ));
        let duration = reference.hertz_duration();
        rows.push(basis.row(name("duration"), "s", duration, after.duration));
    }
    for stuff in [ALUMINIUM_ALLOY, MAGNESIUM_ALLOY] {
        let (after, reference) = case(stuff, 0.1, 0.2).on_a_plane()?;
        let name = |what| format!("test 2, {} on a plane: {what}", stuff.name);
        rows.push(basis.row(
            name("largest force"),
            "N",
            reference.hertz_force(),
            after.force,
        ));
        let duration = reference.hertz_duration();
        rows.push(basis.row(name("duration"), "s", duration, after.duration));
    }
    Ok(rows)
}

/// Test 3: restitution out against restitution in.
pub(crate) fn restitutions() -> Result<Vec<Row>, CheckError> {
    let basis = Basis {
        check: "chung-ooi-3",
        kind: Kind::Analytical,
        tolerance: Tolerance::Absolute(1e-3),
        reason: "the damping formula is exact for this law; first order of the step",
        source: "[Tsuji1992]; [ChungOoi2011, test 3]",
    };
    let mut rows = Vec::new();
    for stuff in [ALUMINIUM_OXIDE, CAST_IRON] {
        for restitution in [0.2, 0.4, 0.6, 0.8, 1.0] {
            let case = Case {
                stuff,
                radius: 0.0025,
                restitution,
                friction: 0.0,
                approach: 3.9,
                along: 0.0,
                spin: 0.0,
                pulls: true,
            };
            let (after, _) = case.on_a_plane()?;
            let name = format!("test 3, {}: restitution {restitution}", stuff.name);
            rows.push(basis.row(name, "1", restitution, after.separation / 3.9));
        }
    }
    Ok(rows)
}

/// Rows of velocity and spin after one oblique impact.
fn oblique(
    label: &str,
    check: &'static str,
    case: &Case,
    (after, reference): &(After, Impact),
) -> Vec<Row> {
    let outcome = reference.integrate();
    let (along, spin) = case.expected(&outcome);
    // Sliding throughout: the impulse is mu times the normal impulse, to the last step.
    let normal = reference.mass * (reference.approach + outcome.separation);
    let full = reference.friction * normal;
    let slides = (outcome.impulse.abs() / full - 1.0).abs() < 1e-6;
    let scale = reference.sliding.abs().max(1e-12);
    let (kind, reason, source) = if slides {
        (
            Kind::Analytical,
            "sliding throughout; the overlap over the radius shortens the arm",
            "impulse mu (1 + e) m v; [ChungOoi2011]",
        )
    } else {
        (
            Kind::CrossCode,
            "independent integration with 100 times finer steps; arm as above",
            "the law's formulas integrated apart; [ChungOoi2011]",
        )
    };
    let (along, spin) = if slides {
        let exact = Outcome {
            impulse: -full.copysign(reference.sliding),
            ..outcome
        };
        case.expected(&exact)
    } else {
        (along, spin)
    };
    let basis = |tolerance| Basis {
        check,
        kind,
        tolerance: Tolerance::Absolute(tolerance),
        reason,
        source,
    };
    let share = 2e-3 + 4.0 * reference.hertz_overlap() / case.radius;
    vec![
        basis(share * scale).row(
            format!("{label}: velocity along"),
            "m/s",
            along,
            after.along,
        ),
        basis(share * scale * 2.5 / case.radius).row(
            format!("{label}: spin"),
            "rad/s",
            spin,
            after.spin,
        ),
    ]
}

/// Tests 4 and 5: oblique impacts on a plane.
pub(crate) fn oblique_impacts() -> Result<Vec<Row>, CheckError> {
    let mut rows = Vec::new();
    for (stuff, restitution, friction) in [
        (ALUMINIUM_OXIDE, 0.98, 0.092),
        (ALUMINIUM_ALLOY_B, 0.80, 0.180),
    ] {
        for degrees in [5.0_f64, 25.0, 45.0, 65.0] {
            let angle = degrees.to_radians();
            let case = Case {
                stuff,
                radius: 0.0025,
                restitution,
                friction,
                approach: 3.9 * angle.cos(),
                along: 3.9 * angle.sin(),
                spin: 0.0,
                pulls: false,
            };
            let label = format!("test 4, {} at {degrees} deg", stuff.name);
            rows.extend(oblique(&label, "chung-ooi-4-5", &case, &case.on_a_plane()?));
        }
    }
    for along in [1.0, 5.0, 10.0, 20.0] {
        let case = Case {
            stuff: STEEL,
            radius: 1e-5,
            restitution: 1.0,
            friction: 0.3,
            approach: 5.0,
            along,
            spin: 0.0,
            pulls: false,
        };
        let label = format!("test 5, steel, {along} m/s along");
        rows.extend(oblique(&label, "chung-ooi-4-5", &case, &case.on_a_plane()?));
    }
    Ok(rows)
}

/// Tests 6 to 8: spinning spheres on a plane, on their like, on a large and heavy one.
pub(crate) fn spinning_impacts() -> Result<Vec<Row>, CheckError> {
    let mut rows = Vec::new();
    for stuff in [ALUMINIUM_ALLOY_B, NYLON] {
        for spin in [0.5, 5.0, 20.0] {
            let case = Case {
                stuff,
                radius: 0.1,
                restitution: 0.5,
                friction: 0.4,
                approach: 0.2,
                along: 0.0,
                spin,
                pulls: false,
            };
            let check = "chung-ooi-6-8";
            let label = |test: &str| format!("{test}, {}, {spin} rad/s", stuff.name);
            rows.extend(oblique(&label("test 6"), check, &case, &case.on_a_plane()?));
            let pair = Case {
                approach: 0.4,
                ..case
            };
            let twin = pair.on_a_sphere(1.0, 1.0)?;
            rows.extend(oblique(&label("test 7"), check, &pair, &twin));
            let large = case.on_a_sphere(5.0, 1000.0)?;
            rows.extend(oblique(&label("test 8"), check, &case, &large));
        }
    }
    Ok(rows)
}
