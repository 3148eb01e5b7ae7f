//! The time step of a run: what the hardest contact allows.

use crate::health::impact_speed;
use crate::interactions::{material_of, mean_radius};
use crate::rest_load::{RestLoad, largest_radius};
use crate::{Error, RollingLaw, Scene, SeedBody, SeedSettings};
use contact_law::ViscousBridge;
use contact_law::hard_contact::{self, BodyDashpots, Impact};
use contact_law::hertz_mindlin::damping_ratio;
use contact_law::material::effective_moduli;
use dem_solver::DashpotMass;
use std::sync::Arc;

/// How much shorter a contact with a rolling spring counts: spring and sliding together swing faster than the
/// normal spring, by an estimate for one sphere at a wall 2.7 times, damped strongly.
const ROLLING_SPRING: f64 = 0.6;

/// Friction up to which contacts slide before their tangential springs count, by how much the time of a contact falls with
/// more friction, and what is left at most friction.
///
/// The higher the friction, the more contacts stick, and the more springs hold a body at a time. Seeds of 50 spheres flew off at
/// a share of 0.42 with a friction of 0.56 (3 of 9 runs; none of 6 at 0.36), plain spheres at 0.36 from 0.65 on and at
/// 0.30 with 0.97.
const STICKING: [f64; 3] = [0.35, 0.5, 0.7];

/// Share of the longest stable time step that a bed at rest takes: of any seeds, and of single spheres with a rolling
/// friction of type A.
///
/// Twice as much throws beads of 250 kPa out of their drum; they are right at 1, and with rolling friction at 0.7. Beads of 20 kPa
/// with rolling friction stand 0.5 deg too low at 0.7, and 3 deg at 1.4 (docs/time-step.md). Packings with rolling friction are right
/// at 0.9.
const AT_REST: [f64; 2] = [1.0, 0.7];

/// Change of the spin by rolling friction of type A under attraction in one step, over the spin that the load gives on a way of the
/// radius. At twice this share the base of a heap of 600 peas with an attraction of 4.9 weights is a third too narrow; at this share and
/// half of it, it agrees within the scatter of three heaps. Smaller heaps show no difference (docs/time-step.md).
const TURN_OF_STEP: f64 = 0.0025;

/// Contacts of a seed in a bed: as many as spheres of one size can touch one of them.
const CONTACTS_AT_REST: f64 = 12.0;

/// Contacts of a seed of several spheres whose dashpots damp at their most at a time. With twelve a drum shows the same and costs
/// nearly twice as much (docs/time-step.md).
const DAMPING_AT_REST: f64 = 6.0;

/// Share of the time step at which viscous bridges become unstable. A dashpot of c between a mass m and the world is stable up to
/// `2 m / c`; between bodies of one mass, with twelve of them on each, up to `m / (12 c)`, and less beside the springs of
/// the contacts.
const VISCOUS_SHARE: f64 = 0.5;

/// Viscous bridges that pull at a seed at a time: as many as spheres of one size can touch one of them.
const VISCOUS_BRIDGES: f64 = 12.0;

/// Time steps of the phases of a run, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TimeSteps {
    /// While the seeds settle, or run out behind a wall that is lifted.
    pub(crate) settling: f64,
    /// While the drive runs.
    pub(crate) flow: f64,
}

impl TimeSteps {
    /// The steps that the protocol of a scene gives its seeds.
    ///
    /// # Errors
    ///
    /// A fixed step that is longer than the longest, seeds too soft to bear their bed, a vibration that the steps do not
    /// resolve, invalid materials.
    pub(crate) fn of(scene: &Scene, bodies: &[Arc<SeedBody>]) -> Result<Self, Error> {
        Self::chosen(scene, bodies).map_err(|error| error.in_file(&scene.file))
    }

    /// [`Self::of`], with errors that do not name the file.
    fn chosen(scene: &Scene, bodies: &[Arc<SeedBody>]) -> Result<Self, Error> {
        let protocol = &scene.protocol;
        let stiffer = match scene.model.rolling_law {
            RollingLaw::ConstantTorque => 1.0,
            RollingLaw::SpringDashpot => ROLLING_SPRING,
        };
        let hard = stiffer * sticking(scene) * hardest_contact(scene, bodies)?;
        let at_rest = AtRest::of(scene, bodies)?;
        let duration = hard.min(at_rest.longest() / hard_contact::STEP_SHARE);
        let share = protocol.step_share;
        let viscous = viscous_limit(scene, bodies);
        let longest = (share * duration).min(viscous);
        let steps = match protocol.time_step {
            Some(step) if step.si() > longest => {
                let reason = if longest == viscous {
                    "what the viscosity of model.liquid allows".into()
                } else if duration < hard && at_rest.rolling < at_rest.springs {
                    format!(
                        "what a rolling friction of constant torque under this attraction allows at protocol.step_share = \
                         {share} (model.rolling_law = \"spring-dashpot\" does not need it)"
                    )
                } else if duration < hard {
                    format!(
                        "what soft contacts under the load of the bed at rest allow at protocol.step_share = {share}"
                    )
                } else {
                    format!(
                        "a share of {share} (protocol.step_share) of a hard contact of these seeds"
                    )
                };
                return Err(Error::BadValue {
                    name: "protocol.time_step".into(),
                    value: step.to_string(),
                    requirement: format!(
                        "at most {:.4} ms, {reason}; without protocol.time_step it is chosen",
                        // Rounded down: what is advised must be taken.
                        (1e7 * longest).floor() * 1e-4
                    ),
                });
            }
            Some(step) => Self {
                settling: step.si(),
                flow: step.si(),
            },
            None => Self {
                settling: longest,
                flow: (protocol.flow_step_share.unwrap_or(share) * duration).min(viscous),
            },
        };
        steps.resolve_vibrations(scene)?;
        let steps = steps.halved(scene);
        steps.suit_times(scene)?;
        Ok(steps)
    }

    /// Refuses steps longer than the time between two looks at the bed, and ones so short that the run would not end.
    fn suit_times(self, scene: &Scene) -> Result<(), Error> {
        for step in [self.settling, self.flow] {
            if let Some(limit) = scene.protocol.limit_of_step(step) {
                return Err(Error::BadValue {
                    name: "the time step, which follows from material.*.shear_modulus, seeds and model,".into(),
                    value: format!("{step:.1e} s"),
                    requirement: limit,
                });
            }
        }
        Ok(())
    }

    /// The steps, halved once for each attempt that broke off.
    fn halved(self, scene: &Scene) -> Self {
        let factor = halving(scene);
        Self {
            settling: factor * self.settling,
            flow: factor * self.flow,
        }
    }

    /// The steps, each at most a length (s), which is halved as they are.
    ///
    /// # Errors
    ///
    /// Steps so short that the run would not end.
    pub(crate) fn at_most(self, scene: &Scene, longest: f64) -> Result<Self, Error> {
        let longest = longest * halving(scene);
        let steps = Self {
            settling: self.settling.min(longest),
            flow: self.flow.min(longest),
        };
        let suited = steps.suit_times(scene);
        suited.map_err(|error| error.in_file(&scene.file))?;
        Ok(steps)
    }

    /// Refuses a vibration with fewer than 20 steps in a swing.
    fn resolve_vibrations(self, scene: &Scene) -> Result<(), Error> {
        let shaken = scene.wall.iter().filter_map(|wall| wall.vibration.as_ref());
        for vibration in shaken.chain(&scene.surroundings.vibration) {
            let longest = self.settling.max(self.flow);
            if 20.0 * longest * vibration.frequency.si() > 1.0 {
                return Err(Error::BadValue {
                    name: "vibration.frequency".into(),
                    value: vibration.frequency.to_string(),
                    requirement: format!(
                        "with 20 time steps of {:.4} ms or more in a swing; a shorter \
                         protocol.time_step resolves it",
                        1e3 * longest
                    ),
                });
            }
        }
        Ok(())
    }
}

/// By how much attempts that broke off have shortened the steps.
fn halving(scene: &Scene) -> f64 {
    let attempts = scene.protocol.broken_off.iter();
    attempts.fold(1.0, |factor, _| 0.5 * factor)
}

/// Longest time step with which the viscous forces of the bridges of liquid are stable, s; infinite without bridges.
///
/// # Formula
///
/// `dt = 0.5 m / (12 c)`: m the [mass felt at the tip](geometry::clump::Clump::mass_felt_at_tip), or of the lightest sphere if
/// seeds are bonded; c the greatest resistance between two seeds, along the surface times `7/2` for the turn that it
/// causes. A wall resists four times as much as a seed, and counts as four of the twelve.
fn viscous_limit(scene: &Scene, bodies: &[Arc<SeedBody>]) -> f64 {
    let Some(liquid) = scene.model.liquid.filter(|liquid| liquid.content > 0.0) else {
        return f64::INFINITY;
    };
    let Ok(law) = ViscousBridge::new(liquid.viscosity_pa_s, liquid.roughness.si()) else {
        return f64::INFINITY;
    };
    let limit = |(seed, body): (&SeedSettings, &Arc<SeedBody>)| {
        let radius = mean_radius(scene, bodies, &seed.material)?;
        let [normal, along] = law.between(radius)?.most();
        let resistance = normal.max(3.5 * along);
        let mass = lightest_mass(scene, body);
        Some(VISCOUS_SHARE * mass / (VISCOUS_BRIDGES * resistance))
    };
    let limits = scene.seed.iter().zip(bodies).filter_map(limit);
    limits.fold(f64::INFINITY, f64::min)
}

/// Longest time steps of a bed at rest, s, for a share of [`hard_contact::STEP_SHARE`]; infinite if seeds are bonded, and on
/// the bench, which has no bed.
#[derive(Debug, Clone, Copy)]
struct AtRest {
    /// What the springs of the contacts bear.
    springs: f64,
    /// What the rolling friction of type A bears that attraction loads.
    rolling: f64,
}

impl AtRest {
    /// The longest steps with all kinds of seeds.
    ///
    /// In a bed of soft seeds the contacts are nearly as stiff at rest as in a hard contact, and each seed has many: the
    /// bed then swings too fast for the step, slides where it should stick and stands too low, without a seed that flies off. The
    /// torque of a rolling friction of type A, which changes its sign with the spin, drives the swing.
    ///
    /// Attraction loads all contacts alike, those at the surface too. Their torques of type A then turn a seed within a step to and
    /// fro: the bed shakes, and the rolling friction that it shows is less than that put in.
    ///
    /// # Formula
    ///
    /// `dt = 2 X (sqrt(1 + z²) - z) / w` with `w² = 12 k_t / (2/7 m)`: what is [stable](hard_contact::stable_share) for a sphere held
    /// at twelve contacts. `k_t = 8 G* sqrt(R d)` is their stiffness along the surface at the [load at rest](RestLoad::of). X is 1,
    /// or 0.7 for seeds of one sphere with a rolling friction of type A (docs/time-step.md). z is 0 unless dashpots know the
    /// whole seed, a share s of it, and for seeds of one sphere in a bed under its own weight: n of `c_t = 2 sqrt(5/6) b sqrt(k_t m/2)`
    /// give `z = n s c_t / (2 sqrt(12 k_t 2/7 m)) = s b n sqrt(5/6 7/4 / 12)`, n six for seeds of several spheres and twelve for one.
    ///
    /// `dt = 0.0025 sqrt(P r I) / (12 T)`: the change of the spin by twelve torques T, each that which the attraction of a
    /// contact gives, is 0.0025 of the spin `sqrt(P r / I)` that the load P gives on a way of the bounding radius r; I is the least
    /// moment of inertia.
    fn of(scene: &Scene, bodies: &[Arc<SeedBody>]) -> Result<Self, Error> {
        let mut least = Self {
            springs: f64::INFINITY,
            rolling: f64::INFINITY,
        };
        if scene.model.bonds.is_some() || scene.apparatus.is_bench_test() {
            return Ok(least);
        }
        for (seed, body) in scene.seed.iter().zip(bodies) {
            let load = RestLoad::of(scene, bodies, (seed, body))?;
            let tangential = 8.0 * load.shear * (load.radius * load.overlap).sqrt();
            let mass = body.clump.mass();
            let frequency = (CONTACTS_AT_REST * tangential / (2.0 / 7.0 * mass)).sqrt();
            let [share, of_rolling] = AT_REST;
            let share = if body.outer.spheres().len() == 1 && load.rolls_with_constant_torque {
                of_rolling
            } else {
                share
            };
            let stable = hard_contact::stable_share(damping_at_rest(scene, seed, body));
            least.springs = least.springs.min(2.0 * share * stable / frequency);
            if load.torque_by_attraction > 0.0 {
                let inertia = body.clump.inertia().min();
                let scale = (load.force * body.clump.bounding_radius() * inertia).sqrt();
                let turning = CONTACTS_AT_REST * load.torque_by_attraction;
                least.rolling = least.rolling.min(TURN_OF_STEP * scale / turning);
            }
        }
        Ok(least)
    }

    /// The shorter of the two, s.
    fn longest(self) -> f64 {
        self.springs.min(self.rolling)
    }
}

/// Damping ratio of a seed held at twelve contacts with dashpots of the whole seed, see [`AtRest::of`]; 0 without such dashpots.
fn damping_at_rest(scene: &Scene, seed: &SeedSettings, body: &SeedBody) -> f64 {
    let is_sphere = body.outer.spheres().len() == 1;
    // A loaded wall keeps a bed at its stiffest for the whole time. Under its own weight alone the rule of X was found to hold.
    let is_loaded = scene.apparatus.device().greatest_stress() > 0.0;
    let [share, contacts] = if is_sphere {
        [f64::from(u8::from(is_loaded)), CONTACTS_AT_REST]
    } else {
        [whole_damping(scene), DAMPING_AT_REST]
    };
    if share == 0.0 {
        return 0.0;
    }
    let touching = scene.touching_pairs().into_iter();
    let own = touching.filter(|pair| pair.contains(&seed.material.as_str()));
    let ratios = own.filter_map(|[a, b]| {
        let contact = scene.contact_of(a, b)?;
        Some(damping_ratio(contact.restitution.get()))
    });
    let of_contacts = contacts * (5.0 / 6.0 * 7.0 / 4.0 / CONTACTS_AT_REST).sqrt();
    share * of_contacts * ratios.fold(0.0, f64::max)
}

/// Share of the damping of the whole seed in the dashpots.
fn whole_damping(scene: &Scene) -> f64 {
    match scene.model.dashpot_mass {
        DashpotMass::Sphere => scene.model.whole_seed_damping,
        DashpotMass::Body | DashpotMass::Shared => 1.0,
    }
}

/// Mass that a contact of a seed feels, kg: that at its tip, or of its lightest sphere where seeds are bonded.
fn lightest_mass(scene: &Scene, body: &SeedBody) -> f64 {
    if scene.model.bonds.is_none() {
        return body.clump.mass_felt_at_tip();
    }
    let spheres = 0..body.clump.spheres().len();
    let masses = spheres.map(|k| body.clump.fraction_mass(k));
    masses.fold(f64::INFINITY, f64::min)
}

/// How much shorter contacts count for the greatest friction at which seeds touch anything.
///
/// # Formula
///
/// `1 - 0.5 (mu - 0.35)`, from 0.7 to 1; mu with its rise at high speed.
fn sticking(scene: &Scene) -> f64 {
    let [free, fall, least] = STICKING;
    let friction = |pair: [&str; 2]| {
        let contact = scene.contact_of(pair[0], pair[1])?;
        let rise = contact.friction_rate.unwrap_or(0.0).max(0.0);
        Some(contact.static_friction.get() * (1.0 + rise))
    };
    let touching = scene.touching_pairs();
    let greatest = touching
        .into_iter()
        .filter_map(friction)
        .fold(0.0, f64::max);
    (1.0 - fall * (greatest - free)).clamp(least, 1.0)
}

/// Duration of the hardest contact of any seed with any material, s: the least [of two seeds or of a seed with a
/// wall](hard_contact::duration_between), or of the lightest sphere where seeds are bonded.
fn hardest_contact(scene: &Scene, bodies: &[Arc<SeedBody>]) -> Result<f64, Error> {
    let kinds: Vec<_> = scene.seed.iter().zip(bodies).collect();
    let speed = impact_speed(scene);
    let mut least = f64::INFINITY;
    for (number, (seed, body)) in kinds.iter().enumerate() {
        let with = |name: &str| meeting(scene, [&seed.material, name], speed);
        let mut met = Vec::new();
        for wall in scene.wall_materials() {
            met.push((None, with(wall)?));
        }
        for (other, met_body) in &kinds[number..] {
            met.push((Some(&met_body.outer), with(&other.material)?));
        }
        for (other, meeting) in met {
            least = least.min(if scene.model.bonds.is_some() {
                hard_contact::duration(lightest_mass(scene, body), largest_radius(body), &meeting)
            } else {
                hard_contact::duration_between(&body.outer, other, &meeting)
            });
        }
    }
    Ok(least)
}

/// How two materials meet at a speed, m/s.
fn meeting(scene: &Scene, names: [&str; 2], speed: f64) -> Result<Impact, Error> {
    let pair = names.join("-");
    let [a, b] = [
        material_of(scene, names[0], &pair)?,
        material_of(scene, names[1], &pair)?,
    ];
    let contact = scene.contact_of(names[0], names[1]);
    Ok(Impact {
        young: effective_moduli(&a, &b).young,
        speed,
        dashpots: contact.map(|contact| BodyDashpots {
            restitution: contact.restitution.get(),
            share: whole_damping(scene),
            shared: scene.model.dashpot_mass != DashpotMass::Body,
        }),
    })
}
