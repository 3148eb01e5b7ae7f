//! Apparatus without ends along z: periodic sides.

use dev_support::fixture_files::fixture;
use scene::{Error, FillingLibrary, Override, RunResult, Scene, run};

/// A scene of the fixtures with changes.
fn scene(name: &str, changes: &[(&str, &str)]) -> Result<Scene, Error> {
    let changes = changes.iter().map(|(name, value)| Override {
        name: (*name).into(),
        value: (*value).into(),
    });
    Scene::read(
        &fixture(&format!("{name}.toml")),
        &changes.collect::<Vec<_>>(),
    )
}

/// A run of it.
fn run_of(name: &str, changes: &[(&str, &str)]) -> RunResult {
    let scene = scene(name, changes).expect("a scene");
    run(&scene, &FillingLibrary::default(), 1).expect("a run")
}

/// Mean of an observable.
fn mean(result: &RunResult, name: &str) -> f64 {
    let found = result.observables.iter().find(|o| o.name == name);
    let values = &found.expect(name).values;
    values.iter().sum::<f64>() / values.len() as f64
}

/// A slice is a part of a slot without end: one of twice the depth with twice the spheres discharges twice as much, and nothing but the bottom
/// carries what lies between smooth walls. A flow of 700 spheres scatters by 3 %, the difference of two by 4 %; three times that is 12 %.
/// In all frames all spheres are between the sides.
#[test]
fn a_slice_of_a_slot_is_a_part_of_it() {
    let slice = |depth: &str, count: &str| {
        let result = run_of(
            "anand-hopper/periodic",
            &[
                ("apparatus.depth", depth),
                ("apparatus.inner_diameter", "60 mm"),
                ("apparatus.height", "120 mm"),
                ("seed.0.count", count),
                ("contact.glass-wall.static_friction", "0"),
                ("time_s", "0.4"),
                ("protocol.settle_limit", "0.4 s"),
            ],
        );
        let half = 0.5 * if depth == "5.6 mm" { 5.6e-3 } else { 11.2e-3 };
        let places = result.frames.iter().flat_map(|frame| &frame.position);
        assert!(places.into_iter().all(|p| p.z.abs() <= half), "{depth}");
        result
    };
    let [one, two] = [slice("5.6 mm", "1000"), slice("11.2 mm", "2000")];
    let [flow, double] = [&one, &two].map(|result| mean(result, "mass_flow_g_s"));
    assert!(
        (double / flow / 2.0 - 1.0).abs() < 0.12,
        "{flow} and {double} g/s"
    );
    // The bed still trembles by some 0.1 % of its weight.
    for result in [&one, &two] {
        let share = mean(result, "bottom_load_share");
        assert!((share - 1.0).abs() < 0.01, "{share}");
    }
}

/// The published discharge of a flat hopper of 6790 spheres `[Anand2008]`, whose curve the slice with a rolling friction of 0.09 follows from 20 % on: the
/// differences of a run (0.9 % of the mass as root mean square) stay below 2 %, and what is left in the end within 1.5 %.
#[test]
#[ignore = "a minute; `trials/checks.sh benches`"]
fn a_slice_discharges_as_published() {
    let result = run_of(
        "anand-hopper/periodic",
        &[
            ("contact.glass-glass.rolling_friction", "0.09"),
            ("contact.glass-wall.rolling_friction", "0.09"),
        ],
    );
    let published =
        std::fs::read_to_string(fixture("anand-hopper/published.csv")).expect("the table");
    let rows = published.lines().skip(1).map(|row| {
        let (time, percent) = row.split_once(',').expect("two columns");
        [time, percent].map(|cell| cell.parse::<f64>().expect("a number"))
    });
    let curve = result.curve.expect("a discharge");
    // Rows of time, mass and percentage.
    let at = |time: f64| {
        let next = curve.rows.partition_point(|row| row[0] < time);
        curve.rows[next.min(curve.rows.len() - 1)][2]
    };
    let (end, flowing): (Vec<_>, Vec<_>) = rows
        .filter(|[_, percent]| *percent > 20.0)
        .partition(|[time, _]| *time > 1.2);
    let squares = flowing
        .iter()
        .map(|[time, percent]| (at(*time) - percent).powi(2));
    let off = (squares.sum::<f64>() / flowing.len() as f64).sqrt();
    assert!(off < 2.0, "{off} %");
    for [time, percent] in end {
        assert!(
            (at(time) - percent).abs() < 1.5,
            "{} % at {time} s",
            at(time)
        );
    }
}

/// Covers carry seeds along and hold them: a drum of four diameters between covers stands steeper than one without end. The difference of
/// means is several degrees, their errors half a degree each.
#[test]
fn a_drum_without_covers_stands_less_steep() {
    let angle = |cover: &str| {
        let changes = [
            ("apparatus.cover", cover),
            ("protocol.rotation_limit", "3 s"),
        ];
        let result = run_of("benches/drum", &changes);
        let all: Vec<f64> = result.series.iter().map(|s| s.centre_of_mass_deg).collect();
        let half = &all[all.len() / 2..];
        half.iter().sum::<f64>() / half.len() as f64
    };
    let [between, without] = ["acrylic", "periodic"].map(angle);
    assert!(between > without + 1.5, "{between} and {without} deg");
}

/// Name and requirement with which a scene is refused before the first step.
#[track_caller]
#[expect(clippy::panic, reason = "helpers of tests fail like tests")]
fn refused(scene: Result<Scene, Error>) -> String {
    let built = scene.and_then(|scene| scene.build_check(&FillingLibrary::default()));
    let Err(Error::BadValue {
        name, requirement, ..
    }) = built
    else {
        panic!("{built:?}");
    };
    format!("{name}: {requirement}")
}

/// An apparatus that has ends along z, or is too thin between periodic sides, is refused by name before the first step.
#[test]
fn what_is_not_periodic_is_refused() {
    let drum = |key, value| [("apparatus.cover", "periodic"), (key, value)];
    for (name, changes, says) in [
        (
            "anand-hopper/periodic",
            &[("apparatus.depth", "4 mm"), ("seed.0.count", "20")][..],
            "apparatus.depth: at least 4.480 mm",
        ),
        (
            "benches/hopper",
            &[("apparatus.periodic", "true")],
            "apparatus.periodic: beside apparatus.depth",
        ),
        (
            "benches/drum",
            &drum("apparatus.covers_at_rest", "true"),
            "apparatus.cover",
        ),
        (
            "benches/drum",
            &drum("apparatus.tilt", "2 deg"),
            "apparatus.cover",
        ),
    ] {
        let message = refused(scene(name, changes));
        assert!(message.contains(says), "{message}");
    }
}

/// A wall of a machine that ends at a periodic side or moves along it would not hold the seeds that come in there: a floor
/// across z, a round cup at the sides, a paddle that ends at one, and one that turns about y between sides far away.
#[test]
fn walls_of_a_machine_that_are_not_periodic_are_refused() {
    let file = fixture("benches/machine.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    let text = text.replace("kind = \"machine\"", "kind = \"machine\"\nperiodic = true");
    for (from, to, says) in [
        (
            "normal = [0, 1, 0]",
            "normal = [0, 0, 1]",
            &["wall 'floor': shape.plane.normal"][..],
        ),
        ("count = 400", "count = 4", &["wall 'cup'", "parallel to z"]),
        (
            "from = [\"25 mm\", \"0 mm\"]",
            "axis = \"z\", from = [\"25 mm\", \"0 mm\"]",
            &["wall 'cup'", "beyond both"],
        ),
        (
            "room = [[\"-17 mm\", \"0 mm\", \"-17 mm\"], [\"17 mm\", \"88 mm\", \"17 mm\"]]",
            "room = [[\"-17 mm\", \"0 mm\", \"-60 mm\"], [\"17 mm\", \"88 mm\", \"60 mm\"]]",
            &["motion of wall 'paddle'"],
        ),
    ] {
        assert!(text.contains(from), "{from}");
        let text = text.replacen(from, to, 1);
        let folder = file.parent().unwrap();
        let message = refused(Scene::from_text(&text, "machine.toml", folder, &[]));
        for part in says {
            assert!(message.contains(part), "{message}");
        }
    }
}
