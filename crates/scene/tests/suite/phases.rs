//! The computing time of a run is reported by phase.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use scene::{FillingLibrary, Override, Scene, run};
use std::path::Path;
use std::time::Instant;

/// Some beads in an apparatus.
fn beads(apparatus: &str) -> Scene {
    let text = format!(
        r#"
        [apparatus]
        {apparatus}
        [[seed]]
        name = "bead"
        sphere = "4 mm"
        density = "1250 kg/m3"
        count = 60
        material = "glass"
        [material.glass]
        poisson_ratio = 0.3
        shear_modulus = "1 MPa"
        [contact.glass-glass]
        restitution = 0.5
        static_friction = 0.4
        rolling_friction = 0.1
        [protocol]
        settle_limit = "0.2 s"
        frames = 4
        rotation_limit = "1.2 s"
        [camera]
        pixels = 200
        "#
    );
    Scene::from_text(&text, "beads.toml", Path::new("."), &[]).unwrap()
}

/// The phases that an apparatus has take time, the others none, and together they are the time of the call but for what lies
/// between them, here at most 5 % and 20 ms.
#[test]
fn the_phases_are_the_time_of_the_run() {
    let drum = "kind = \"drum\"\ninner_diameter = \"40 mm\"\nwidth = \"12 mm\"\nspeed = \"20 rpm\"\n\
                shell = \"glass\"\ncover = \"glass\"";
    let heap = "kind = \"heap\"\nfloor = \"glass\"\ncylinder = \"glass\"\nlift_speed = \"500 mm/s\"\n\
                height = \"60 mm\"\ninner_diameter = \"30 mm\"";
    let tilt = "kind = \"tilt\"\nplate = \"glass\"\nrepeats = 2";
    for (apparatus, present) in [
        (drum, [true; 5]),
        (heap, [true, true, false, true, true]),
        (tilt, [true, false, false, true, false]),
    ] {
        let scene = beads(apparatus);
        let begin = Instant::now();
        let phases = run(&scene, &FillingLibrary::default(), 1).unwrap().phases;
        let whole = begin.elapsed().as_secs_f64();
        let named = phases.named();
        assert_eq!(named.map(|(_, time)| time > 0.0), present, "{phases:?}");
        let told = phases.total_s();
        assert!(told <= whole, "{phases:?} of {whole}");
        assert!(told > 0.95 * whole - 0.02, "{phases:?} of {whole}");
    }
}

/// Pictures of the same run by another camera cost their reading alone.
#[test]
fn what_is_seen_again_is_only_read() {
    let drum = "kind = \"drum\"\ninner_diameter = \"40 mm\"\nwidth = \"12 mm\"\nspeed = \"20 rpm\"\n\
                shell = \"glass\"\ncover = \"glass\"";
    let mut scene = beads(drum);
    let whole = run(&scene, &FillingLibrary::default(), 1).unwrap();
    let pixels = Override {
        name: "camera.pixels".into(),
        value: "240".into(),
    };
    scene = scene.with(&[pixels]).unwrap();
    let again = whole.seen_in(&scene).unwrap().phases;
    assert!(again.reading_s > 0.0);
    assert_eq!(again.reading_s, again.total_s());
}
