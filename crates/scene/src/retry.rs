//! A run that diverges is tried again with half the time step.

use crate::keeper::Keeper;
use crate::motion::Progress;
use crate::run::{RunResult, run_on};
use crate::{Error, FillingLibrary, Scene};

/// Default number of times that a run that diverges is tried again.
pub const USUAL_RETRIES: u32 = 1;

/// [`run_on`]; a run that diverges starts again with half the time step, at most `retries` times.
///
/// The result says why each earlier attempt broke off. It can be compared with results of the longer step if the observables do
/// not depend on the step in this range, which holds for the seeds of docs/time-step.md but not for every bed. A state that
/// was `left` contains the attempts before it.
///
/// # Errors
///
/// As [`run_on`]; [`Error::Diverged`] if more than one attempt broke off and no other is allowed.
pub fn run_retrying(
    scene: &Scene,
    library: &FillingLibrary,
    seed: u64,
    threads: usize,
    mut left: Option<Progress>,
    keeper: &mut dyn Keeper,
    retries: u32,
) -> Result<RunResult, Error> {
    let mut scene = scene.clone();
    if let Some(left) = &left {
        scene.protocol.broken_off = left.broken_off().to_vec();
    }
    loop {
        let error = match run_on(&scene, library, seed, threads, left.take(), keeper) {
            Ok(result) => return Ok(result),
            Err(error) => error,
        };
        if !error.is_divergence() {
            return Err(error);
        }
        let before = &mut scene.protocol.broken_off;
        if before.len() as u64 >= u64::from(retries) {
            let before = std::mem::take(before);
            return Err(if before.is_empty() {
                error
            } else {
                Error::Diverged {
                    last: Box::new(error),
                    before,
                }
            });
        }
        let why = error.to_string();
        let told = keeper.begin_anew(&why);
        told.map_err(|reason| Error::NotKept {
            file: scene.file.clone(),
            reason,
        })?;
        before.push(why);
    }
}
