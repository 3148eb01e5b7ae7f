//! A slice of the study's drum with coarse seeds, for tests that run it.

use dev_support::fixture_files::fixture;
use scene::{Override, Scene};

/// The study's drum, 14 mm wide, with seeds of 20 and 16 spheres of 0.8 mm, and further changes.
pub(crate) fn drum(changes: &[(&str, &str)]) -> Scene {
    let coarse = [
        ("apparatus.width", "14 mm"),
        ("seed.1.filling.sphere_radius", "0.8 mm"),
        ("seed.1.filling.sphere_count", "16"),
    ];
    of_file("drum.toml", &[&coarse, changes].concat())
}

/// Another scene of the study's seeds; the first kind has 20 spheres of 0.8 mm.
pub(crate) fn of_file(name: &str, changes: &[(&str, &str)]) -> Scene {
    let folder = fixture("cotton");
    let file = folder.join(name);
    let coarse = [
        ("seed.0.filling.sphere_radius", "0.8 mm"),
        ("seed.0.filling.sphere_count", "20"),
    ];
    let all: Vec<_> = coarse
        .iter()
        .chain(changes)
        .map(|&(name, value)| Override {
            name: name.into(),
            value: value.into(),
        })
        .collect();
    Scene::read(&file, &all).expect("the scene is possible")
}

/// Five coarse seeds in a small drum that turns for a time, s.
pub(crate) fn five_seeds(time_s: &str) -> Scene {
    drum(&[
        ("apparatus.inner_diameter", "40 mm"),
        ("seed.0.count", "4"),
        ("seed.1.count", "1"),
        ("protocol.frames", "2"),
        ("protocol.frame_interval", "0.02 s"),
        ("protocol.settle_limit", "0.12 s"),
        ("time_s", time_s),
    ])
}
