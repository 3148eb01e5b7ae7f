use crate::effects::{Error, LIBRARY, apply, find};
use dev_support::fixture_files::fixture;
use scene::{Apparatus, FillingLibrary, Override, Scene, run};

/// The study's drum, small: 40 seeds of 16 or 20 spheres in a slice of 14 mm, so that a run takes a
/// second.
pub(crate) fn small_drum() -> Scene {
    let set = |name: &str, value: &str| Override {
        name: name.into(),
        value: value.into(),
    };
    let file = fixture("cotton/drum.toml");
    let mut scene = Scene::read(
        &file,
        &[
            set("apparatus.inner_diameter", "70 mm"),
            set("apparatus.width", "14 mm"),
            set("seed.0.count", "34"),
            set("seed.1.count", "6"),
            set("seed.0.filling.sphere_radius", "0.8 mm"),
            set("seed.1.filling.sphere_radius", "0.8 mm"),
            set("seed.0.filling.sphere_count", "20"),
            set("seed.1.filling.sphere_count", "16"),
            set("protocol.frames", "4"),
            set("time_s", "2.4"),
        ],
    )
    .unwrap();
    scene.protocol.session = Some(0.5);
    scene
}

/// Static friction of a seed at the shell, at the covers, and at another seed.
pub(crate) fn friction_at(scene: &Scene) -> [f64; 3] {
    let Apparatus::Drum(drum) = &scene.apparatus else {
        panic!("no drum");
    };
    [drum.shell.as_str(), drum.cover.as_str(), "seed"].map(|wall| {
        let contact = scene.contact_of("seed", wall).unwrap();
        contact.static_friction.get()
    })
}

/// Unique names, sources that the bibliography holds, ranges with 0 and the probe in them.
#[test]
fn each_effect_is_well_described() {
    let bibliography = include_str!("../../../../REFERENCES.bib");
    let mut names = Vec::new();
    for d in &LIBRARY {
        assert!(!names.contains(&d.name), "{} comes twice", d.name);
        names.push(d.name);
        let range = d.range[0]..=d.range[1];
        assert!(range.contains(&0.0), "{}: 0 must switch it off", d.name);
        assert!(
            range.contains(&d.probe) && d.probe != 0.0,
            "{}: probe {}",
            d.name,
            d.probe
        );
        let entry = format!("{{{},", d.source);
        assert!(bibliography.contains(&entry), "{}: {}", d.name, d.source);
        for text in [d.physics, d.formula, d.unit] {
            assert!(!text.is_empty(), "{}", d.name);
        }
    }
}

/// At its probe every effect of a drum changes the scene to one that can be written and read again: no effect
/// leads to a setting that a file could not state.
#[test]
fn each_probe_gives_another_scene_that_a_file_can_state() {
    let fillings = FillingLibrary::default();
    for d in LIBRARY.iter().filter(|d| d.name != "plate-give") {
        let mut scene = small_drum();
        apply(&mut scene, d.name, d.probe, &fillings).unwrap();
        assert_ne!(scene, small_drum(), "{}", d.name);
        assert_eq!(scene.with(&[]).unwrap(), scene, "{}", d.name);
    }
}

/// Amplitude 0 leaves the scene as it is, bit for bit, for every effect.
#[test]
fn amplitude_zero_changes_nothing() {
    let fillings = FillingLibrary::default();
    for effect in &LIBRARY {
        let mut scene = small_drum();
        apply(&mut scene, effect.name, 0.0, &fillings).unwrap();
        assert_eq!(scene, small_drum(), "{}", effect.name);
    }
}

#[test]
fn unknown_names_and_impossible_amplitudes_are_refused() {
    let (mut scene, fillings) = (small_drum(), FillingLibrary::default());
    assert!(
        matches!(find("magnetism"), Err(Error::Unknown { .. })),
        "unknown name"
    );
    let error = apply(&mut scene, "cohesion", -0.5, &fillings).unwrap_err();
    assert!(error.to_string().contains("-0.5"), "{error}");
}

/// A camera turned by 2 degrees adds 2 degrees to every frame of the same run; the reading of a
/// frame moves by the size of a pixel when the picture is turned, hence 0.8 degrees in a mean of
/// four frames of coarse seeds.
#[test]
fn camera_roll_adds_its_angle() {
    let fillings = FillingLibrary::default();
    let mean = |roll: f64| {
        let mut scene = small_drum();
        apply(&mut scene, "camera-roll", roll, &fillings).unwrap();
        let result = run(&scene, &fillings, 5).unwrap();
        let angles: Vec<f64> = result
            .readings
            .iter()
            .filter_map(|r| r.photo.angle().map(|a| a.line.to_degrees()))
            .collect();
        assert_eq!(angles.len(), result.frames.len(), "a frame was refused");
        angles.iter().sum::<f64>() / angles.len() as f64
    };
    let change = mean(2.0) - mean(0.0);
    assert!((change - 2.0).abs() < 0.8, "the angle changed by {change}");
}

/// Rolling resistance and cohesion hold the bed together: its centre of mass stands higher up the
/// drum than without. The mean over two starts of 80 seeds varies by about 1 degree.
#[test]
fn rolling_resistance_and_cohesion_raise_the_bed() {
    let fillings = FillingLibrary::default();
    let mean = |name: &str, amplitude: f64| {
        let mut scene = small_drum();
        scene.set_seed_count(80);
        apply(&mut scene, name, amplitude, &fillings).unwrap();
        let of_run = |seed: u64| {
            let result = run(&scene, &fillings, seed).unwrap();
            let late = &result.series[result.series.len() / 2..];
            late.iter().map(|p| p.centre_of_mass_deg).sum::<f64>() / late.len() as f64
        };
        std::thread::scope(|scope| {
            let other = scope.spawn(|| of_run(6));
            f64::midpoint(of_run(5), other.join().unwrap())
        })
    };
    let plain = mean("cohesion", 0.0);
    for (name, amplitude) in [("rolling-resistance", 0.4), ("cohesion", 1.0)] {
        let on = mean(name, amplitude);
        assert!(on > plain + 2.0, "{name}: {on} against {plain}");
    }
}

/// The smoother filling is as smooth as was asked for (or smoother), for both seeds.
#[test]
fn smoothness_lowers_the_roughness_by_the_share_asked_for() {
    let fillings = FillingLibrary::default();
    let (rough, mut smooth) = (small_drum(), small_drum());
    apply(&mut smooth, "filling-smoothness", 0.5, &fillings).unwrap();
    for (a, b) in rough.seed.iter().zip(&smooth.seed) {
        let roughness = |scene: &Scene, seed| {
            let body = fillings.body(scene, seed).unwrap();
            body.shape.as_ref().unwrap().report.roughness_rms
        };
        let before = roughness(&rough, a);
        let after = roughness(&smooth, b);
        assert!(after <= 0.505 * before, "{}: {before} -> {after}", a.name);
    }
}

/// A step that was fixed for rough seeds is not kept: smooth ones touch at more spheres, and their step follows from their
/// own share. Seeds whose share is as short already keep theirs.
#[test]
fn smooth_seeds_do_not_keep_the_fixed_step_of_rough_ones() {
    let fillings = FillingLibrary::default();
    for (share, kept) in [(0.5, false), (0.3, true)] {
        let mut scene = small_drum();
        scene.protocol.step_share = share;
        scene.protocol.time_step = Some("0.01 ms".parse().unwrap());
        apply(&mut scene, "filling-smoothness", 0.5, &fillings).unwrap();
        assert_eq!(scene.protocol.time_step.is_some(), kept, "share {share}");
        assert!(scene.protocol.step_share <= 0.3, "share {share}");
    }
}
