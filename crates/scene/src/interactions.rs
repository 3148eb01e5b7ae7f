//! From the contacts of a scene to the laws of the solver.

use crate::settings::RollingLaw;
use crate::{Apparatus, ContactSettings, Error, LiquidSettings, Scene, SeedBody, SeedSettings};
use contact_law::material::effective_moduli;
use contact_law::rolling_spring_dashpot::{DAMPING_RATIO, STIFFNESS_RATIO};
use contact_law::{
    BridgeForce, CapillaryBridge, LinearCohesion, Material, PairParameters, RateDependentFriction,
    RollingSpringDashpot, ViscoelasticDamping, ViscousBridge, constant_attraction,
    hard_contact::{self, Impact},
};
use dem_solver::{Interaction, InteractionSettings, OptionalLaws};
use std::sync::Arc;

/// Speed of sliding at which friction has changed by half of what it does at high speed, m/s: that of
/// seeds in a flowing layer.
const HALF_SPEED: f64 = 0.05;

/// An overlap that a law takes, for a check that needs none, m.
const ANY_OVERLAP: f64 = 1e-6;

/// Liquid content at which the bridges have half of the force of smooth surfaces: less stays in the
/// valleys of the roughness.
const HALF_WETTED: f64 = 0.001;

/// Coefficients of two materials that never meet.
const WITHOUT_CONTACT: PairParameters = PairParameters {
    restitution: 1.0,
    static_friction: 0.0,
    rolling_friction: 0.0,
};

/// The coefficients of a contact.
fn parameters_of(contact: &ContactSettings) -> PairParameters {
    PairParameters {
        restitution: contact.restitution.get(),
        static_friction: contact.static_friction.get(),
        rolling_friction: contact.rolling_friction.get(),
    }
}

/// What the laws of a contact refuse of its values; none of them needs the bodies for that.
pub(crate) fn refusals(contact: &ContactSettings) -> Vec<contact_law::Error> {
    let coefficients = parameters_of(contact).check();
    let attraction = contact.attraction_n.map(constant_attraction::check);
    let cohesion = contact.cohesion_energy_density_j_m3;
    let cohesion = cohesion.map(LinearCohesion::new);
    let damping = contact.viscoelastic_damping;
    let damping = damping.map(|share| ViscoelasticDamping::new(share, ANY_OVERLAP));
    let rate = contact.friction_rate;
    let rate = rate.map(|change| RateDependentFriction::new(change, HALF_SPEED));
    [
        coefficients.err(),
        attraction.and_then(Result::err),
        cohesion.and_then(Result::err),
        damping.and_then(Result::err),
        rate.and_then(Result::err),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Elastic constants of a named material; `pair` is named in the message.
pub(crate) fn material_of(scene: &Scene, name: &str, pair: &str) -> Result<Material, Error> {
    let refused = |source| Error::Contact {
        file: scene.file.clone(),
        pair: pair.to_owned(),
        source,
    };
    scene.material[name].constants().map_err(refused)
}

/// Interactions of all pairs of materials, row by row.
pub(crate) fn interactions(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    names: &[&str],
) -> Result<Vec<Interaction>, Error> {
    let heaviest = scene
        .seed
        .iter()
        .map(SeedSettings::mass_kg)
        .fold(0.0, f64::max);
    let model = &scene.model;
    let pull = constant_attraction::attraction(model.bond_number, heaviest, model.gravity_m_s2);
    let mut table = Vec::new();
    for a in names {
        for b in names {
            let pair = format!("{a}-{b}");
            let refused = |source| Error::Contact {
                file: scene.file.clone(),
                pair: pair.clone(),
                source,
            };
            // Two walls never meet: their entry is filled with an inert law.
            let contact = scene.contact_of(a, b);
            let parameters = contact.map_or(WITHOUT_CONTACT, parameters_of);
            let settings = InteractionSettings {
                materials: [material_of(scene, a, &pair)?, material_of(scene, b, &pair)?],
                parameters,
                attraction: pull + contact.and_then(|c| c.attraction_n).unwrap_or(0.0),
                end: model.normal_force_end,
            };
            let usual = Interaction::new(&settings).map_err(refused)?;
            let further = optional_laws(scene, bodies, [a, b], &settings).map_err(refused)?;
            table.push(usual.with(&further));
        }
    }
    Ok(table)
}

/// The laws beside the usual ones between two materials.
fn optional_laws(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    names: [&str; 2],
    settings: &InteractionSettings,
) -> Result<OptionalLaws, contact_law::Error> {
    let of_seed = |name: &str| scene.seed.iter().any(|s| s.material == name);
    let Some(contact) = scene.contact_of(names[0], names[1]) else {
        return Ok(OptionalLaws::default());
    };
    if !names.into_iter().any(of_seed) {
        // Two walls never meet.
        return Ok(OptionalLaws::default());
    }
    let rolling_spring = match scene.model.rolling_law {
        RollingLaw::ConstantTorque => None,
        RollingLaw::SpringDashpot => Some(RollingSpringDashpot::new(
            settings.parameters.rolling_friction,
            DAMPING_RATIO,
            STIFFNESS_RATIO,
        )?),
    };
    let overlap = || reference_overlap(scene, bodies, names, &settings.materials);
    let viscoelastic = contact
        .viscoelastic_damping
        .map(|share| ViscoelasticDamping::new(share, overlap()));
    let rate_dependent = contact
        .friction_rate
        .map(|change| RateDependentFriction::new(change, HALF_SPEED));
    let linear_cohesion = contact
        .cohesion_energy_density_j_m3
        .map(LinearCohesion::new);
    let bridge = scene
        .model
        .liquid
        .map(|liquid| bridge(scene, bodies, names, &liquid));
    Ok(OptionalLaws {
        viscoelastic: viscoelastic.transpose()?,
        rate_dependent: rate_dependent.transpose()?,
        rolling_spring,
        rolling_lever: scene.model.rolling_lever,
        linear_cohesion: linear_cohesion.transpose()?,
        bridge: bridge.transpose()?.flatten(),
        // The sled is no seed: its spheres keep their masses.
        pull: match scene.apparatus {
            Apparatus::Slider(_) => 0.0,
            _ => scene.model.whole_seed_damping,
        },
    })
}

/// Numbers and bodies of the seeds of a material.
fn of_material<'a>(
    scene: &'a Scene,
    bodies: &'a [Arc<SeedBody>],
    name: &'a str,
) -> impl Iterator<Item = (f64, &'a Arc<SeedBody>)> {
    let kinds = scene.seed.iter().zip(bodies);
    kinds
        .filter(move |(s, _)| s.material == name)
        .map(move |(s, body)| (scene.count_of(s) as f64, body))
}

/// [Overlap](hard_contact::overlap) of a straight blow at 1 m/s of the seeds of two materials, m: the least of
/// all, each against a fixed plane.
fn reference_overlap(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    names: [&str; 2],
    materials: &[Material; 2],
) -> f64 {
    let impact = Impact::usual(effective_moduli(&materials[0], &materials[1]).young);
    let seeds = names
        .iter()
        .flat_map(|name| of_material(scene, bodies, name));
    let overlaps = seeds.map(|(_, body)| {
        let outer = body.outer.spheres().iter();
        let largest = outer.map(|s| s.radius).fold(0.0, f64::max);
        hard_contact::overlap(body.clump.mass(), largest, &impact)
    });
    overlaps.fold(f64::INFINITY, f64::min)
}

/// The bridge of liquid between two materials; none between two walls, and none without liquid.
///
/// The radii are those of spheres with the volume of a seed, a wall is flat. Each touching pair of spheres has a
/// bridge: a seed that lies on several spheres is held several times, by bridges that share its liquid.
fn bridge(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    names: [&str; 2],
    liquid: &LiquidSettings,
) -> Result<Option<BridgeForce>, contact_law::Error> {
    let radii: Vec<f64> = names
        .iter()
        .filter_map(|name| mean_radius(scene, bodies, name))
        .collect();
    let curvature: f64 = radii.iter().map(|r| 1.0 / r).sum();
    if radii.is_empty() || liquid.content <= 0.0 {
        return Ok(None);
    }
    let radius = 2.0 / curvature;
    let bridge = CapillaryBridge::new(liquid.surface_tension_n_m, liquid.contact_angle.si())?;
    let viscous = ViscousBridge::new(liquid.viscosity_pa_s, liquid.roughness.si())?;
    let wetted = liquid.content / (liquid.content + HALF_WETTED);
    let bridge = bridge.between(radius).scaled(wetted);
    Ok(Some(bridge.with_viscosity(viscous.between(radius))))
}

/// Mean radius of the spheres with the volumes of the seeds of a material, m; none for a wall.
pub(crate) fn mean_radius(scene: &Scene, bodies: &[Arc<SeedBody>], name: &str) -> Option<f64> {
    let (mut sum, mut n) = (0.0, 0.0);
    for (count, body) in of_material(scene, bodies, name) {
        sum += count * body.volume_radius();
        n += count;
    }
    (n > 0.0).then(|| sum / n)
}

#[cfg(test)]
mod tests {
    use super::{bridge, interactions};
    use crate::{FillingLibrary, LiquidSettings, Override, Scene};
    use dev_support::fixture_files::fixture;
    use input::quantity::Angle;
    use std::f64::consts::PI;

    /// The study's drum with changes.
    fn drum(changes: &[(&str, &str)]) -> Scene {
        let file = fixture("cotton/drum.toml");
        let changes: Vec<_> = changes
            .iter()
            .map(|(name, value)| Override {
                name: (*name).into(),
                value: (*value).into(),
            })
            .collect();
        Scene::read(&file, &changes).unwrap()
    }

    /// Between two seeds 2 pi R g, at a wall twice as much, times 10/11 for 1 % of water; and 6 pi h R*²/D against
    /// parting at the touch, at a wall four times as much. Both kinds of seeds count by their number. Rounding only.
    #[test]
    fn bridges_have_the_forces_of_the_radii_of_the_seeds() {
        let (scene, library) = (drum(&[]), FillingLibrary::default());
        let bodies: Vec<_> = scene
            .seed
            .iter()
            .map(|s| library.body(&scene, s).unwrap())
            .collect();
        let liquid = LiquidSettings::new(0.01, 0.07, Angle::from_si(0.0).unwrap());
        let radius =
            (1056.0 * bodies[0].volume_radius() + 144.0 * bodies[1].volume_radius()) / 1200.0;
        for (names, size) in [(["seed", "seed"], 1.0), (["seed", "tough_resin"], 2.0)] {
            let found = bridge(&scene, &bodies, names, &liquid).unwrap().unwrap();
            let force = 2.0 * PI * size * radius * 0.07 * 10.0 / 11.0;
            assert!(
                (found.attraction(0.0, 1e-11) / force - 1.0).abs() < 1e-12,
                "{names:?}"
            );
            let [normal, _] = found.viscous().unwrap().most();
            let reduced = 0.5 * size * radius;
            let expected = 6.0 * PI * 1e-3 * reduced * reduced / 1e-5;
            assert!((normal / expected - 1.0).abs() < 1e-12, "{names:?}");
        }
        let walls = ["tough_resin", "clear_resin"];
        assert_eq!(bridge(&scene, &bodies, walls, &liquid).unwrap(), None);
    }

    /// What a scene states about a contact reaches its law: each further setting gives another interaction of
    /// the seeds, and none that the scene does not state.
    #[test]
    fn each_further_law_reaches_the_solver() {
        let library = FillingLibrary::default();
        let table = |scene: &Scene| {
            let bodies: Vec<_> = scene
                .seed
                .iter()
                .map(|s| library.body(scene, s).unwrap())
                .collect();
            interactions(scene, &bodies, &["clear_resin", "seed", "tough_resin"]).unwrap()
        };
        let plain = table(&drum(&[]));
        let mut seen = vec![plain.clone()];
        for change in 0..5 {
            let mut scene = drum(&[]);
            let contact = scene.contact.get_mut("seed-seed").unwrap();
            match change {
                0 => contact.viscoelastic_damping = Some(0.5),
                1 => contact.friction_rate = Some(0.5),
                2 => scene.model.rolling_law = crate::RollingLaw::SpringDashpot,
                3 => contact.cohesion_energy_density_j_m3 = Some(1e4),
                _ => {
                    let angle = Angle::from_si(0.0).unwrap();
                    scene.model.liquid = Some(LiquidSettings::new(0.01, 0.07, angle));
                }
            }
            let changed = table(&scene);
            assert!(!seen.contains(&changed), "change {change} is lost");
            assert!(
                changed[4] != plain[4],
                "seeds among themselves, change {change}"
            );
            assert!(
                changed[2] == plain[2],
                "walls among themselves, change {change}"
            );
            seen.push(changed);
        }
    }
}
