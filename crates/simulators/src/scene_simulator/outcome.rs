//! From the result of a run to observables.

use crate::scene_simulator::surface::{SurfaceReadings, over_frames, scatter_of};
use crate::scene_simulator::{Error, RunDetails};
use campaign::RunOutcome;
use campaign::run_store::Observation;
use scene::{Doubt, Ending, RunResult, Scene};
use serde::Serialize;
use std::collections::BTreeMap;

/// The regime of a run whose bed was not steady before its limit, or is driven by its own rolling torque.
pub const NOT_STEADY: &str = "not steady";

/// Effort of a run; it is kept in the details and changes no result.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Effort {
    /// Time by the clock, s.
    pub wall_s: f64,
    /// Time that the processors worked, s; `None` if it was not measured.
    pub cpu_s: Option<f64>,
    /// Time of filling the meshes, s, where it is not part of `wall_s`; `None` if it was not measured.
    pub filling_s: Option<f64>,
    /// Whether the run went on from a state that an earlier process had left.
    pub continued: bool,
    /// Whether the seeds had moved before, and only new pictures were taken.
    pub only_seen: bool,
}

/// The outcome of a run: observables with their units, regime, and details for the reader.
///
/// An observable that the apparatus does not have is left out: a bench test gives its own values alone. So is what no frame
/// shows: a bed without a measurable surface has no angle, and the details say why; what the places of its seeds show stays.
///
/// # Errors
///
/// Details that have no form in JSON.
pub fn outcome_of(scene: &Scene, result: &RunResult, effort: Effort) -> Result<RunOutcome, Error> {
    let times: Vec<f64> = result.frames.iter().map(|f| f.time).collect();
    let surface = SurfaceReadings::of(&result.readings, interval_of(&times));
    let details = RunDetails::new(scene, result, effort, (&surface.image, &surface.position));
    Ok(RunOutcome {
        observables: observables(result, &surface),
        regime: regime_of(result),
        details: serde_json::to_value(details).map_err(Error::Unwritable)?,
    })
}

/// Time between frames, s; none of fewer than two.
fn interval_of(times: &[f64]) -> Option<f64> {
    let (first, last) = (times.first()?, times.last()?);
    (last > first).then(|| (last - first) / (times.len() - 1) as f64)
}

fn observables(result: &RunResult, surface: &SurfaceReadings) -> BTreeMap<String, Observation> {
    let start = result.ending.cut();
    let steady = &result.series[start.min(result.series.len())..];
    let mass: Vec<f64> = steady.iter().map(|p| p.centre_of_mass_deg).collect();
    let slip: Vec<f64> = steady.iter().map(|p| p.shell_slip).collect();
    let kinetic: Vec<f64> = steady.iter().map(|p| p.kinetic_energy_j * 1e3).collect();
    let filling = result.filling_angles.iter().map(|a| a.to_degrees());
    let filling: Vec<f64> = filling.collect();
    let means = [
        ("filling_angle_deg", "deg", &filling),
        ("centre_of_mass_deg", "deg", &mass),
        ("shell_slip", "1", &slip),
        ("kinetic_energy_mj", "mJ", &kinetic),
    ];
    let others = result
        .observables
        .iter()
        .map(|f| (f.name.as_ref(), f.unit, &f.values));
    let all = means.into_iter().chain(others);
    let mut observables = surface.observables();
    observables.extend(
        all.filter_map(|(name, unit, values)| Some((name.to_owned(), over_frames(values, unit)?))),
    );
    observables.extend(scatter_of(&mass).map(|o| ("centre_of_mass_fluctuation_deg".to_owned(), o)));
    observables
}

/// Regime of a run: a turning bed that was not steady counts neither as rolling nor as sliding, so that it enters no mean
/// of either. What was let go keeps its regime though beads may still roll over the floor: its slope stands, and without
/// rolling friction they never stop; not where their own rolling torque drives them. The details say why in all cases.
fn regime_of(result: &RunResult) -> Option<String> {
    match (&result.ending, result.ending.doubt()) {
        (Ending::Turned(_), Some(_)) | (_, Some(Doubt::DrivenByRolling)) => {
            Some(NOT_STEADY.to_owned())
        }
        _ => word(result.regime),
    }
}

/// The word that a regime or a form of motion has in JSON.
pub fn word(regime: impl Serialize) -> Option<String> {
    let value = serde_json::to_value(regime).ok()?;
    value.as_str().map(str::to_owned)
}
