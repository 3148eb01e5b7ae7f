//! A reduced scene runs as the whole one, and states nothing that its run does not depend on.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use scene::{FillingLibrary, Scene, run};
use std::path::Path;

/// A scene of a few balls and ellipsoids with more materials, contacts and settings than any run needs.
fn scene(apparatus: &str, protocol: &str) -> Scene {
    let text = format!(
        r#"
        [apparatus]
        {apparatus}
        [[seed]]
        name = "ball"
        sphere = "6 mm"
        density = "1250 kg/m3"
        total_mass = "2 g"
        material = "pea"
        [[seed]]
        name = "bean"
        ellipsoid = ["9 mm", "6 mm", "5 mm"]
        density = "1250 kg/m3"
        count = 8
        material = "bean"
        [material]
        pea = {{ poisson_ratio = 0.3, shear_modulus = "5 MPa" }}
        bean = {{ poisson_ratio = 0.3, shear_modulus = "6 MPa" }}
        steel = {{ poisson_ratio = 0.3, shear_modulus = "90 MPa" }}
        glass = {{ poisson_ratio = 0.2, shear_modulus = "80 MPa" }}
        [contact]
        pea-pea = {{ restitution = 0.5, static_friction = 0.4, rolling_friction = 0.1 }}
        bean-pea = {{ restitution = 0.5, static_friction = 0.35, rolling_friction = 0.1 }}
        bean-bean = {{ restitution = 0.5, static_friction = 0.45, rolling_friction = 0.1 }}
        pea-steel = {{ restitution = 0.6, static_friction = 0.3, rolling_friction = 0.1 }}
        steel-bean = {{ restitution = 0.6, static_friction = 0.25, rolling_friction = 0.1 }}
        pea-glass = {{ restitution = 0.7, static_friction = 0.2 }}
        glass-steel = {{ restitution = 0.7, static_friction = 0.2 }}
        [protocol]
        flow_step_share = 0.38
        session = 0.5
        frames = 2
        frame_interval = "0.1 s"
        rotation_limit = "0.4 s"
        settle_limit = "0.3 s"
        {protocol}
        [camera]
        pixels = 300
        "#
    );
    Scene::from_text(&text, "any.toml", Path::new("."), &[]).unwrap()
}

/// One of each apparatus, at tiny size, with the number of seeds, materials and contacts that its run depends on.
fn all() -> Vec<(Scene, [usize; 3])> {
    let turned = "inner_diameter = \"50 mm\"\nwidth = \"30 mm\"\nspeed = \"30 rpm\"";
    let walls = "floor = \"steel\"\nlift_speed = \"500 mm/s\"\nheight = \"60 mm\"";
    let bench = "plate = \"steel\"\nrepeats = 2";
    let seeds = "plate = \"pea\"\nrepeats = 2";
    let drum = format!("kind = \"drum\"\n{turned}\nshell = \"steel\"\ncover = \"steel\"");
    let metering = format!(
        "kind = \"metering\"\n{turned}\nplate = \"steel\"\nfront = \"steel\"\nboard = \"steel\"\n\
         board_angle = \"-10 deg\"\nboard_length = \"15 mm\""
    );
    let heap =
        format!("kind = \"heap\"\n{walls}\ninner_diameter = \"40 mm\"\ncylinder = \"steel\"");
    let body = format!(
        "kind = \"box-collapse\"\n{walls}\nlength = \"40 mm\"\nwidth = \"30 mm\"\nwall = \"steel\""
    );
    vec![
        (scene(&drum, "start_slope = \"10 deg\""), [2, 3, 5]),
        (scene(&metering, ""), [2, 3, 5]),
        (scene(&heap, ""), [2, 3, 5]),
        (scene(&body, ""), [2, 3, 5]),
        (scene(&format!("kind = \"slider\"\n{bench}"), ""), [1, 2, 1]),
        (scene(&format!("kind = \"slider\"\n{seeds}"), ""), [1, 1, 1]),
        (
            scene(&format!("kind = \"drop\"\n{bench}\nheight = \"50 mm\""), ""),
            [1, 2, 1],
        ),
        (
            scene(&format!("kind = \"drop\"\n{seeds}\nheight = \"50 mm\""), ""),
            [1, 1, 1],
        ),
        (scene(&format!("kind = \"tilt\"\n{bench}"), ""), [1, 2, 1]),
        (
            scene(&format!("kind = \"tilt\"\nseed = \"bean\"\n{bench}"), ""),
            [1, 2, 1],
        ),
    ]
}

/// Series, frames and observables agree to the last bit; nothing is left to reduce, and what is left is a scene.
#[test]
fn a_reduced_scene_runs_the_same() {
    let library = FillingLibrary::default();
    for (scene, [seeds, materials, contacts]) in all() {
        let kind = format!("{:?}", scene.apparatus);
        let reduced = scene.reduced();
        assert_ne!(reduced, scene);
        assert_eq!(reduced.reduced(), reduced, "{kind}");
        assert!(
            reduced.problems().is_empty(),
            "{kind}: {:?}",
            reduced.problems()
        );
        assert_eq!(reduced.seed.len(), seeds, "{kind}");
        assert_eq!(reduced.material.len(), materials, "{kind}");
        assert_eq!(reduced.contact.len(), contacts, "{kind}");
        let [a, b] = [&scene, &reduced].map(|s| run(s, &library, 3).unwrap());
        assert_eq!(a.series, b.series, "{kind}");
        assert_eq!(a.frames, b.frames, "{kind}");
        assert_eq!(a.observables, b.observables, "{kind}");
        assert_eq!(a.ending, b.ending, "{kind}");
        assert_eq!(a.n_steps, b.n_steps, "{kind}");
        assert_eq!(a.filling_angles, b.filling_angles, "{kind}");
        for found in &a.observables {
            let known = scene.observables();
            assert!(known.contains(&&*found.name), "{} of {kind}", found.name);
        }
    }
}
