//! What photos of one measurement tell beside their means: how these go together, and what the angle tells of time.

use super::folder::{Folder, STUDY, changed, right};
use dev_support::drawn_pictures::Scene;
use probability::random_stream::Stream;
use study::Study;

/// The study with a folder of drawn pictures in the place of the angle at 30 rpm; `more` are further keys.
fn with_pictures(scenes: &[Scene], more: &str) -> Study {
    let folder = Folder::new(&changed(
        "angle_deg = { mean = 35.1, sd = 0.8, n = 10 }",
        &format!("photos = \"photos\"\n{more}"),
    ));
    std::fs::create_dir(folder.path("photos")).expect("a new folder");
    for (k, scene) in scenes.iter().enumerate() {
        let file = folder.path(&format!("photos/{k:03}.png"));
        dev_support::drawn_pictures::save(scene.draw(), file).expect("written");
    }
    folder.read(None).expect("a study that is right")
}

/// A small picture of a powder.
fn powder() -> Scene {
    Scene {
        size: 240,
        radius: 112.0,
        ..Scene::default()
    }
}

/// The correlation of two observables in the pictures of a study; 0 if none is reported.
fn of(study: &Study, a: &str, b: &str) -> f64 {
    let mut all = study.photos[0].correlations.iter();
    all.find(|c| (c.a == a && c.b == b) || (c.a == b && c.b == a))
        .map_or(0.0, |c| c.value)
}

/// 60 pictures whose curvature rises with their angle, correlation 0.8, and whose filling changes on its own. The sample
/// correlation has an error of (1 - 0.64) / sqrt(60) = 0.05; the shrinkage takes up to a third of it, since most of the seven
/// observables have nothing to do with each other; the other has an error of 0.13. The same numbers stand in the problem of the loop, which refuses a block that is not positive definite.
#[test]
fn photos_tell_how_their_means_go_together() {
    let mut stream = Stream::new(3, "photos");
    let scenes: Vec<Scene> = (0..60)
        .map(|_| {
            let [one, two, three] = [stream.normal(), stream.normal(), stream.normal()];
            Scene {
                inclination: -0.6 - 0.03 * one,
                curvature: 0.06 + 0.02 * (0.8 * one + 0.6 * two),
                height: -0.1 + 0.02 * three,
                ..powder()
            }
        })
        .collect();
    let study = with_pictures(&scenes, "photo = { also = [\"fill_level\"] }");
    let found = of(&study, "angle_deg", "curvature");
    assert!(
        (0.4..0.95).contains(&found),
        "{found}: {:?}",
        study.photos[0]
    );
    let other = of(&study, "angle_deg", "fill_level").abs();
    assert!(other < 0.5, "{other}");
    let problem = &study.problem;
    let number = |name: &str| {
        let mut all = problem.measurements.iter();
        all.position(|m| m.model == 1 && m.observable == name)
            .unwrap()
    };
    let (a, b) = (number("angle_deg"), number("curvature"));
    let mut stated = problem.correlations.iter();
    let stated = stated.find(|c| (c.a, c.b) == (a, b)).unwrap();
    assert_eq!(stated.value, found);
    let p = study.photos[0].values.len();
    assert_eq!(problem.correlations.len(), p * (p - 1) / 2, "every pair");
    assert!(study.photos[0].values.contains_key("fluctuation_deg"));
}

/// A bed that rises by 12 deg/s for 0.5 s and falls within a picture, every 50 ms one: 11 pictures from one fall to the next,
/// and a fall of 6 deg, of which 0.6 deg of rise may be missed. Without the time between pictures nothing is said about it.
#[test]
fn photos_at_a_known_rate_tell_avalanches() {
    let scenes: Vec<Scene> = (0..72)
        .map(|k| Scene {
            inclination: -(30.0 + 0.6 * f64::from((k + 4) % 11) + 0.02 * f64::from(k % 3))
                .to_radians(),
            ..powder()
        })
        .collect();
    let told = with_pictures(
        &scenes,
        "photo = { frame_interval = \"50 ms\", also = [\"avalanche_size_deg\", \"avalanche_waiting_time_s\"] }",
    );
    let values = &told.photos[0].values;
    let (size, wait) = (
        values["avalanche_size_deg"],
        values["avalanche_waiting_time_s"],
    );
    assert!((size.mean - 6.0).abs() < 0.6, "{size:?}");
    assert!((wait.mean - 0.55).abs() < 0.01, "{wait:?}");
    // Falls that come as a clock have the error of two times that are known to a picture.
    assert!((wait.sd - 0.05 / 6.0_f64.sqrt()).abs() < 1e-3, "{wait:?}");
    assert!(!values.contains_key("fluctuation_deg"), "size tells it");
    assert!(
        told.photos[0]
            .remarks
            .iter()
            .any(|r| r.contains("avalanches")),
        "{:?}",
        told.photos[0].remarks
    );
    // Not every run gives them: what the file does not name is reported and not taken over.
    let timed = with_pictures(&scenes[..40], "photo = { frame_interval = \"50 ms\" }");
    let photos = &timed.photos[0];
    assert!(
        photos.further["avalanche_size_deg"].mean > 5.0,
        "{photos:?}"
    );
    assert!(photos.values.contains_key("fluctuation_deg"));
    assert!(!photos.values.contains_key("avalanche_size_deg"));
    assert!(
        photos.remarks.iter().any(|r| r.contains("photo.also")),
        "{:?}",
        photos.remarks
    );
    let plain = with_pictures(&scenes[..40], "");
    let told: Vec<&String> = plain.photos[0].further.keys().collect();
    assert_eq!(told, ["fill_level"], "an input of the scene");
}

#[test]
fn a_stated_correlation_joins_two_measurements() {
    let study = right(&changed(
        "curvature = { mean = 0.1, sd = 0.02, n = 7.5 }",
        "curvature = { mean = 0.1, sd = 0.02, n = 7.5 }\ncorrelation = [[\"curvature\", \"angle_deg\", -0.4]]",
    ));
    let all = &study.problem.correlations;
    assert_eq!(all.len(), 1);
    assert_eq!((all[0].a, all[0].b, all[0].value), (1, 0, -0.4));
    assert!(right(STUDY).problem.correlations.is_empty());
}
