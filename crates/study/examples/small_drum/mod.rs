//! The study's drum, cut to 100 mm and 320 seeds, for tables of many runs.

use scene::{Error, Override, Scene};
use std::path::Path;

/// What makes a drum of the study a small one.
const SMALL: [(&str, &str); 6] = [
    ("apparatus.inner_diameter", "100 mm"),
    ("apparatus.width", "24 mm"),
    ("seed.0.count", "282"),
    ("seed.1.count", "38"),
    // 0.42 of the drum holds at 10 rpm, not at 40.
    ("protocol.flow_step_share", "0.36"),
    ("protocol.frame_interval", "0.1 s"),
];

/// The small drum of a scene file of the study, with further changes.
pub(crate) fn small_drum(file: &str, further: &[(&str, &str)]) -> Result<Scene, Error> {
    scene_with(file, &[&SMALL, further].concat())
}

/// The scene of a file, with changes.
pub(crate) fn scene_with(file: &str, changes: &[(&str, &str)]) -> Result<Scene, Error> {
    let changes: Vec<Override> = changes
        .iter()
        .map(|(name, value)| Override {
            name: (*name).into(),
            value: (*value).into(),
        })
        .collect();
    Scene::read(Path::new(file), &changes)
}
