//! How long a run takes, relative to other runs.

use scene::{Apparatus, Scene};

/// Time of one core for one unit of [`campaign::PreparedRun::cost`], s.
///
/// A guess of ours for as long as no planned run is finished: the drum of 1200 seeds of 140 spheres takes some 20 s for a cost of 8200. Other machines and
/// seeds of few spheres differ by a factor of several. Nothing but the estimate told and a budget in core hours
/// depends on it.
pub const SECONDS_PER_COST: f64 = 0.0025;

/// Simulated time of one repeat of a bench test, s: the pull of the sled is fixed, a drop and a tilt end with the
/// motion of the seed (measured on coated cotton seeds, 4 repeats each).
const PULL_S: f64 = 0.75;
const DROP_S: f64 = 0.08;
const TILT_S: f64 = 6.0;

/// What a step on a plate of seeds costs over one on a smooth plate: 1 to 2 with 20 spheres a seed, 3 to 15 with
/// 146.
const SEEDED_PLATE: f64 = 3.0;

/// Expected time of a run in units of some 1 ms of one core.
///
/// # Formula
///
/// (number of moving seeds) * (simulated time, s) / (time step as a share of a hard contact). In a drum or a release
/// the time is that to settle and that of the rotation ([`Scene::expected_rotation`]); the number of spheres hardly matters there (146 instead
/// of 20 a seed: 9 % more), since few of them touch. In a bench test it is that of all repeats, with steps as
/// much finer as [`Apparatus::finer`] says.
///
/// Measured over this: drums of 40 to 306 seeds 0.9 to 1.9 ms; bench tests of smooth seeds of 12 spheres 1.1 to 4.5 ms, of
/// which tilts that end early take a tenth.
pub(crate) fn expected_cost(scene: &Scene) -> f64 {
    let (seeds, time_s) = match &scene.apparatus {
        Apparatus::Slider(test) => (1.0, bench_s(scene, &test.plate, test.repeats, PULL_S)),
        Apparatus::Drop(test) => (1.0, bench_s(scene, &test.plate, test.repeats, DROP_S)),
        Apparatus::Tilt(test) => (1.0, bench_s(scene, &test.plate, test.repeats, TILT_S)),
        _ => {
            let time_s = scene.protocol.settle_limit.si() + scene.expected_rotation();
            (scene.seed_count() as f64, time_s)
        }
    };
    seeds * time_s / scene.protocol.step_share
}

/// Simulated time of all repeats of a bench test, s, as long as a drum's steps would take for its steps.
fn bench_s(scene: &Scene, plate: &str, repeats: usize, repeat_s: f64) -> f64 {
    let is_seeded = scene.seed.iter().any(|seed| seed.material == plate);
    let per_step = if is_seeded { SEEDED_PLATE } else { 1.0 };
    scene.apparatus.finer() * per_step * repeats as f64 * repeat_s
}
