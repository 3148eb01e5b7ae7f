//! Positions that another code left of a scene, read by the rules and the ruler here.

use crate::bed::{Bed, Drive, Took};
use crate::error::Error;
use campaign::SimulatorError;
use exchange::Moment;
use quantity::Time;
use run_store::Observation;
use scene::{DrumCamera, Scene, SteadyRule, read_pile};
use scene_simulator::over_frames;
use std::collections::BTreeMap;

/// Observables of a scene from moments of another code, in the axes of CONVENTIONS.md.
///
/// A drum was turning from the first moment on, and its moments are `interval` (s) apart; of a heap or a box the last moment
/// counts, at which it is at rest.
///
/// # Errors
///
/// No moment, a moment without spheres, a drum without a surface or whose bed is not steady, another apparatus.
pub fn read_scene(
    scene: &Scene,
    moments: Vec<Moment>,
    interval: f64,
) -> Result<BTreeMap<String, Observation>, Error> {
    let refused = |problem: &str| Error::Setting {
        what: format!("positions of {}", scene.file),
        problem: problem.to_owned(),
    };
    if moments.iter().any(|m| m.spheres.is_empty()) {
        return Err(refused("a moment holds no sphere"));
    }
    let last = moments.last().ok_or_else(|| refused("there is no moment"))?;
    if scene.apparatus.is_release() {
        let spheres: Vec<_> = last.spheres.iter().map(|s| s.sphere).collect();
        let largest = spheres.iter().map(|s| s.radius).fold(0.0, f64::max);
        let read = read_pile(&scene.apparatus, &spheres, largest);
        let told = read.iter().filter_map(|further| {
            let value = over_frames(&further.values, further.unit)?;
            Some((further.name.to_owned(), value))
        });
        return Ok(told.collect());
    }
    if scene.apparatus.speed() == 0.0 {
        return Err(refused("positions are read of a turning drum, a heap or a box"));
    }
    if !(interval > 0.0 && interval.is_finite()) {
        return Err(refused("the interval of moments must be above 0 s"));
    }
    let mut bed = Bed::new(Drive {
        camera: DrumCamera::of(scene),
        spin: scene.apparatus.speed(),
        gravity: scene.model.gravity_m_s2,
        interval,
    });
    for moment in moments {
        bed.push(moment);
    }
    let protocol = &scene.protocol;
    let rule = SteadyRule::for_bed(
        bed.swing(),
        protocol.start_up.map(Time::si),
        bed.len() as f64 * interval,
        interval,
        protocol.angle_error.map(|e| e.si().to_degrees()),
    );
    let state = bed.judge(&rule);
    if let Some(doubt) = state.doubt {
        return Err(refused(&format!("the bed is not steady: {}", doubt.words())));
    }
    let outcome = bed.outcome(state, 1, Took::default());
    let outcome = outcome.map_err(|error: SimulatorError| refused(&error.in_full()))?;
    Ok(outcome.observables)
}
