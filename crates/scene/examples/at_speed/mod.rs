//! The drum of a scene at a speed, for examples that compare readings of its frames.

use scene::{Apparatus, FillingLibrary, Override, RunResult, Scene, run};
use std::error::Error;
use std::path::Path;

/// A result that can cross threads.
pub(crate) type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

/// Runs the drum of a scene file at a speed (rpm), with covers that turn or stand still.
pub(crate) fn drum_at(
    file: &Path,
    rpm: u32,
    covers_at_rest: bool,
    frames: usize,
) -> Outcome<(Scene, RunResult)> {
    let set = |name: &str, value: String| Override {
        name: name.to_owned(),
        value,
    };
    let changes = [
        set("rpm", rpm.to_string()),
        set("frames", frames.to_string()),
        // The longer step of the study's drum is for 10 rpm.
        set("protocol.flow_step_share", "0.36".into()),
        set(
            "protocol.rotation_limit",
            format!("{} s", 6.0 + 0.2 * frames as f64),
        ),
    ];
    let mut scene = Scene::read(file, &changes)?;
    let Apparatus::Drum(drum) = &mut scene.apparatus else {
        return Err("the scene must be a drum".into());
    };
    drum.covers_at_rest = covers_at_rest;
    let result = run(&scene, &FillingLibrary::default(), 1)?;
    Ok((scene, result))
}
