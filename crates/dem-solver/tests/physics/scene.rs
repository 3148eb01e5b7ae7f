//! Worlds for the tests: surfaces, bodies, walls, starts.

use contact_law::{
    BridgeForce, CapillaryBridge, LinearCohesion, NormalForceEnd, RateDependentFriction,
    RollingLever, RollingSpringDashpot, ViscoelasticDamping, ViscousBridge,
};
use dem_solver::{
    DashpotMass, Interaction, InteractionSettings, OptionalLaws, Placement, Settings, Template,
    Wall, World,
};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use probability::random_stream::Stream;
use verification::worlds::{self, DENSITY, soft_surface};
pub(crate) use verification::worlds::{box_of_planes, plane};

/// A surface that neither damps nor rubs nor sticks; soft, so that a contact lasts many time steps.
pub(crate) fn smooth() -> InteractionSettings {
    rough(1.0, 0.0)
}

/// A surface with a restitution and a static friction.
pub(crate) fn rough(restitution: f64, static_friction: f64) -> InteractionSettings {
    soft_surface([restitution, static_friction, 0.0]).expect("the constants are possible")
}

/// A surface with everything that the laws know; the attraction (N) is a tenth of the weight of
/// a body of 0.3 g.
pub(crate) fn sticky() -> InteractionSettings {
    InteractionSettings {
        attraction: 3e-4,
        end: NormalForceEnd::Clipped,
        ..soft_surface([0.4, 0.4, 0.05]).expect("the constants are possible")
    }
}

/// The interaction of a surface with its like.
pub(crate) fn interaction(settings: &InteractionSettings) -> Interaction {
    Interaction::new(settings).expect("the parameters are possible")
}

/// Settings with lists that suit bodies of some millimetres; the time step in s.
pub(crate) fn settings(time_step: f64, gravity: Vector3<f64>) -> Settings {
    worlds::settings(time_step, gravity, 2e-3)
}

/// Bridges of a liquid ten times as viscous as water, between surfaces of a mean radius of 1 mm.
pub(crate) fn wet_bridge() -> BridgeForce {
    let bridge = CapillaryBridge::new(0.07, 0.1).expect("water");
    let viscous = ViscousBridge::new(0.01, 1e-5).expect("syrup");
    bridge.between(1e-3).with_viscosity(viscous.between(1e-3))
}

/// All further laws at once; rolling springs and bridges remember, and a bridge lives on beyond the contact.
pub(crate) fn every_law() -> OptionalLaws {
    OptionalLaws {
        viscoelastic: ViscoelasticDamping::new(0.7, 1e-5).ok(),
        rate_dependent: RateDependentFriction::new(-0.5, 0.05).ok(),
        rolling_spring: RollingSpringDashpot::new(0.2, 0.3, 2.25).ok(),
        rolling_lever: RollingLever::Sphere,
        linear_cohesion: LinearCohesion::new(1e4).ok(),
        bridge: Some(wet_bridge()),
        pull: 0.0,
    }
}

/// Body types that carry liquid, as much as gives bridges of 10 nl between two that have few.
pub(crate) fn wetted(templates: Vec<Template>) -> Vec<Template> {
    let wet = templates.into_iter().map(|t| t.with_liquid(3e-11));
    wet.collect()
}

/// A single sphere of a radius (m), whose dashpots see its mass.
pub(crate) fn ball(radius: f64) -> Template {
    worlds::ball(radius, DENSITY).expect("the radius is positive")
}

/// A body of spheres (centre and radius in m) with the mass of these.
pub(crate) fn cluster(
    spheres: &[([f64; 3], f64)],
    material: usize,
    dashpot_mass: DashpotMass,
) -> Template {
    let clump = worlds::cluster(spheres).expect("the spheres are proper");
    Template::new(&clump, material, dashpot_mass)
}

/// A seed of five spheres in a bent row, `size` times 2 mm thick, of material 0, and a block of
/// eight of material 1.
pub(crate) fn seed_and_block(size: f64) -> Vec<Template> {
    seed_and_block_with(size, DashpotMass::Body)
}

/// [`seed_and_block`] with the choice of the mass in the dashpots of the block.
pub(crate) fn seed_and_block_with(size: f64, block: DashpotMass) -> Vec<Template> {
    let row = [
        ([0.0, 0.0, 0.0], 1.0),
        ([1.5, 0.1, 0.0], 0.9),
        ([-1.5, 0.2, 0.1], 0.8),
        ([2.8, 0.4, 0.0], 0.6),
        ([-2.7, 0.5, 0.2], 0.5),
    ];
    let mut corners = Vec::new();
    for k in 0..8 {
        let side = |bit: i32, half: f64| if k >> bit & 1 == 1 { half } else { -half };
        corners.push(([side(0, 1.1), side(1, 0.9), side(2, 0.8)], 0.9));
    }
    let scaled = |spheres: &[([f64; 3], f64)], material, dashpot_mass| {
        let unit = 1e-3 * size;
        let spheres: Vec<_> = spheres
            .iter()
            .map(|&(c, radius)| (c.map(|x| x * unit), radius * unit))
            .collect();
        cluster(&spheres, material, dashpot_mass)
    };
    vec![
        scaled(&row, 0, DashpotMass::Sphere),
        scaled(&corners, 1, block),
    ]
}

/// Random placements of the two templates of [`seed_and_block`] on a lattice of 7 mm times `size`
/// that fits into a half width (m) in each direction; velocities up to `speed` (m/s).
pub(crate) fn scattered(
    half_widths: [f64; 3],
    size: f64,
    speed: f64,
    stream: &mut Stream,
) -> Vec<Placement> {
    let spacing = 7e-3 * size;
    let counts = half_widths.map(|half| (2.0 * half / spacing).floor());
    let mut placements = Vec::new();
    let mut cell = Vector3::zeros();
    while cell.z < counts[2] {
        let position = Vector3::from_fn(|k, _| (cell[k] + 0.5 - 0.5 * counts[k]) * spacing);
        let [w, i, j, k] = stream.rotation();
        placements.push(Placement {
            template: placements.len() % 2,
            position,
            orientation: UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k)),
            velocity: Vector3::from_fn(|_, _| stream.between(-speed, speed)),
            spin: Vector3::from_fn(|_, _| stream.between(-1.0, 1.0) * speed / (3e-3 * size)),
        });
        cell.x += 1.0;
        if cell.x >= counts[0] {
            (cell.x, cell.y) = (0.0, cell.y + 1.0);
        }
        if cell.y >= counts[1] {
            (cell.y, cell.z) = (0.0, cell.z + 1.0);
        }
    }
    placements
}

/// A world whose two materials have one surface.
pub(crate) fn world(
    settings: Settings,
    surface: &InteractionSettings,
    templates: Vec<Template>,
    walls: Vec<Wall>,
    placements: &[Placement],
) -> World {
    let interactions = vec![interaction(surface); 4];
    World::new(settings, templates, interactions, walls, placements).expect("the scene is possible")
}

/// Moves a world by a number of steps.
pub(crate) fn run(world: &mut World, n_steps: usize) {
    worlds::run(world, n_steps).expect("the time step is small enough");
}
