//! Plain spheres in a drum of the study's diameter, with the study's contact parameters.

use crate::arguments::Arguments;
use crate::contacts::Contacts;
use crate::measure::{Row, measure_world};
use crate::scenes::{BenchmarkScene, SPHERES_OF_TILE};
use crate::seed_drum::{as_asked, as_in_a_run, side_by_side};
use dem_solver::{DashpotMass, Placement, Settings, Shape, Template, Wall, World};
use geometry::clump::Clump;
use nalgebra::{UnitQuaternion, Vector3};
use probability::random_stream::Stream;
use scene::Scene;

/// Radius of a sphere, m: chosen so that 2000 fill a third of the study's drum.
pub(crate) const RADIUS: f64 = 2.5e-3;
/// Density, kg/m³: a seed's mass of 94.5 mg over the volume of an ellipsoid with its half-axes
/// of 4.595, 2.54 and 2.225 mm.
pub(crate) const DENSITY: f64 = 868.0;
/// Time step of all codes, s: 16 % of the Rayleigh time of a sphere, inside the 10 to 20 % that
/// users of the peers keep to.
pub(crate) const TIME_STEP: f64 = 2e-5;
/// Time step of the preparation, s: nothing is measured there.
const PREPARATION_STEP: f64 = 6e-5;
/// Gravity, m/s².
pub(crate) const GRAVITY: f64 = 9.81;
/// Time in which the spheres fall and come to rest, s.
const FALL_S: f64 = 0.25;
/// Rotation after which the surface flows, s.
const START_UP_S: f64 = 0.8;
/// Skin and margin of the solver's lists, in radii: from 0.1 and 0.2 to 0.5 and 1.2 the cost
/// changed by no more than the noise of 5 %.
const SKIN: f64 = 0.3;
const MARGIN: f64 = 0.7;

/// A drum of plain spheres.
#[derive(Debug, Clone)]
pub(crate) struct SphereDrum {
    /// Contact laws.
    pub(crate) contacts: Contacts,
    /// Inner radius, m.
    pub(crate) radius: f64,
    /// Inner width, m.
    pub(crate) width: f64,
    /// Spin of the shell, rad/s; the covers stand still, for the peers have no plane that turns
    /// about its normal.
    pub(crate) spin: f64,
    /// The spheres in motion.
    pub(crate) placements: Vec<Placement>,
}

/// Measures a drum with this many spheres.
pub(crate) fn measure(arguments: &Arguments, count: usize) -> anyhow::Result<Row> {
    let mut world = as_asked(flowing(arguments, count)?.world(TIME_STEP)?, arguments)?;
    let name = BenchmarkScene::Spheres(count);
    measure_world(
        &name.to_string(),
        &mut world,
        count,
        name.block_steps(),
        (arguments.blocks, arguments.phases),
    )
}

/// A drum in which the spheres flow: copies of a short one side by side.
pub(crate) fn flowing(arguments: &Arguments, count: usize) -> anyhow::Result<SphereDrum> {
    let scene = Scene::read(&arguments.drum, &[])?;
    let contacts = Contacts::of(&scene)?;
    if arguments.peers {
        contacts.check_for_peers(&scene.file)?;
    }
    let mut drum = SphereDrum {
        contacts,
        radius: scene.apparatus.radius(),
        width: scene.apparatus.width(),
        spin: 0.0,
        placements: Vec::new(),
    };
    drum.placements = lattice(&drum, arguments.seed);
    anyhow::ensure!(
        drum.placements.len() == SPHERES_OF_TILE,
        "{}: the drum has room for {} of {SPHERES_OF_TILE} spheres",
        scene.file,
        drum.placements.len()
    );
    let mut world = drum.world(PREPARATION_STEP)?;
    run(&mut world, FALL_S)?;
    drum.spin = scene.apparatus.speed();
    world.set_wall_spin("shell", drum.spin)?;
    run(&mut world, START_UP_S)?;
    let tiles = count / SPHERES_OF_TILE;
    drum.placements = side_by_side(world.bodies(), tiles, drum.width);
    drum.width *= tiles as f64;
    Ok(drum)
}

impl SphereDrum {
    /// The solver's world with a time step in s.
    pub(crate) fn world(&self, time_step: f64) -> anyhow::Result<World> {
        let template = Template::new(&Clump::sphere(RADIUS, DENSITY)?, 0, DashpotMass::Sphere);
        let cover = |sign: f64| Wall {
            name: "cover".into(),
            shape: Shape::Plane {
                point: Vector3::new(0.0, 0.0, sign * self.width / 2.0),
                normal: Vector3::new(0.0, 0.0, -sign),
            },
            material: 2,
            spin: 0.0,
        };
        let shell = Wall {
            name: "shell".into(),
            shape: Shape::Cylinder {
                radius: self.radius,
            },
            material: 1,
            spin: self.spin,
        };
        let settings = Settings {
            time_step,
            gravity: Vector3::new(0.0, -GRAVITY, 0.0),
            skin: SKIN * RADIUS,
            margin: MARGIN * RADIUS,
        };
        as_in_a_run(World::new(
            settings,
            vec![template],
            self.contacts.interactions()?,
            vec![shell, cover(1.0), cover(-1.0)],
            &self.placements,
        )?)
    }
}

/// Starts of the spheres: a cubic lattice with small random offsets, from the bottom up.
fn lattice(drum: &SphereDrum, seed: u64) -> Vec<Placement> {
    let spacing = 2.2 * RADIUS;
    let offset = 0.09 * RADIUS;
    let mut stream = Stream::new(seed, "placement");
    let mut placements = Vec::new();
    let ticks = |half: f64| {
        let n = (half / spacing).floor();
        let from = (0..).map(f64::from).map(move |k| k - n);
        from.take_while(move |k| *k <= n).map(|k| k * spacing)
    };
    for y in ticks(drum.radius) {
        for x in ticks(drum.radius) {
            for z in ticks(0.5 * drum.width - 1.1 * RADIUS) {
                let free = x.hypot(y) < drum.radius - 1.2 * RADIUS;
                if free && placements.len() < SPHERES_OF_TILE {
                    let moved = Vector3::from_fn(|_, _| stream.between(-offset, offset));
                    let position = Vector3::new(x, y, z) + moved;
                    placements.push(Placement::at_rest(0, position, UnitQuaternion::identity()));
                }
            }
        }
    }
    placements
}

/// Moves a world by a time, s.
fn run(world: &mut World, seconds: f64) -> Result<(), dem_solver::Error> {
    world.steps_until(world.time() + seconds)
}

#[cfg(test)]
mod tests {
    use super::{SPHERES_OF_TILE, SphereDrum, TIME_STEP, lattice};
    use crate::contacts::Contacts;
    use crate::seed_drum::side_by_side;
    use dev_support::fixture_files::fixture;
    use scene::Scene;

    /// Copies must neither overlap nor leave the longer drum: no contact at the start, as in the
    /// lattice they come from.
    #[test]
    fn copies_side_by_side_fill_the_longer_drum_without_contacts() {
        let file = fixture("cotton/drum.toml");
        let mut drum = SphereDrum {
            contacts: Contacts::of(&Scene::read(&file, &[]).unwrap()).unwrap(),
            radius: 0.07,
            width: 0.046,
            spin: 0.0,
            placements: Vec::new(),
        };
        drum.placements = lattice(&drum, 1);
        assert_eq!(drum.placements.len(), SPHERES_OF_TILE);
        let short = drum.world(TIME_STEP).unwrap();
        drum.placements = side_by_side(short.bodies(), 3, drum.width);
        drum.width *= 3.0;
        let mut long = drum.world(TIME_STEP).unwrap();
        long.step().unwrap();
        assert_eq!(long.bodies().len(), 3 * SPHERES_OF_TILE);
        assert_eq!(long.census().sphere_contacts + long.n_wall_contacts(), 0);
    }
}
