//! Seeds that are single spheres.

use dev_support::fixture_files::fixture;
use scene::{FillingLibrary, Scene, starting_frame};

/// A quarter of a drum's volume in spheres: all of them have a place, and none touches another (3 mm from
/// centre to centre) or leaves the drum.
#[test]
fn spheres_start_without_touching() {
    let file = fixture("mcc/drum.toml");
    let scene = Scene::read(&file, &[]).unwrap();
    let (frame, bodies, _) = starting_frame(&scene, &FillingLibrary::default(), 1).unwrap();
    let radius = bodies[0].clump.bounding_radius();
    assert!((radius - 1.5e-3).abs() < 1e-15, "{radius}");
    // What the photographs' spheres weigh, to the digits that are known.
    let mass = bodies[0].clump.mass();
    assert!((mass / 22.337e-6 - 1.0).abs() < 1e-4, "{mass}");
    assert_eq!(frame.position.len(), 1999);
    let mut sorted = frame.position.clone();
    sorted.sort_by(|a, b| a.y.total_cmp(&b.y));
    for (k, a) in sorted.iter().enumerate() {
        assert!(a.xy().norm() + radius <= 0.042, "{a:?}");
        let near = sorted[k + 1..]
            .iter()
            .take_while(|b| b.y - a.y < 2.0 * radius);
        for b in near {
            assert!((a - b).norm() >= 2.0 * radius, "{a:?} {b:?}");
        }
    }
}
