//! Seeds without a mesh, and masses and numbers as a laboratory states them.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use fixture_files::fixture;
use scene::{FillingLibrary, Override, Scene, SeedBody, starting_frame};
use std::f64::consts::PI;
use std::sync::Arc;

/// A drum of peas in as few lines as it takes; the lines of the seed are given.
fn drum(seed: &str) -> String {
    format!(
        r#"
        [apparatus]
        kind = "drum"
        inner_diameter = "60 mm"
        width = "30 mm"
        speed = "20 rpm"
        shell = "steel"
        cover = "steel"
        [[seed]]
        name = "pea"
        material = "pea"
        {seed}
        [material]
        pea = {{ poisson_ratio = 0.3, shear_modulus = "5 MPa" }}
        steel = {{ poisson_ratio = 0.3, shear_modulus = "100 MPa" }}
        [contact]
        pea-pea = {{ restitution = 0.5, static_friction = 0.4 }}
        pea-steel = {{ restitution = 0.5, static_friction = 0.3 }}
        "#
    )
}

/// Reads the drum.
fn read(seed: &str) -> Result<Scene, scene::Error> {
    let folder = fixture("stl");
    Scene::from_text(&drum(seed), "peas.toml", &folder, &[])
}

/// The body of its seed.
fn body(scene: &Scene) -> Arc<SeedBody> {
    let library = FillingLibrary::default();
    library.body(scene, &scene.seed[0]).unwrap()
}

/// A ball of 6 mm and 1250 kg/m3: pi/6 d^3 rho, 2/5 m r^2, one sphere at the centre; a scale of 2 gives 8 times
/// the mass and 32 times the moments. Rounding only.
#[test]
fn a_sphere_is_one_sphere_of_its_diameter_and_density() {
    let mass = PI / 6.0 * 6e-3_f64.powi(3) * 1250.0;
    for (scale, line) in [(1.0, ""), (2.0, "scale = 2.0")] {
        let seed = format!("sphere = \"6 mm\"\ndensity = \"1250 kg/m3\"\ncount = 5\n{line}");
        let clump = body(&read(&seed).unwrap()).clump.clone();
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
        assert_eq!(clump.spheres().len(), 1);
        assert!(near(clump.spheres()[0].radius, scale * 3e-3));
        assert!(clump.spheres()[0].centre.norm() < 1e-15);
        let whole = mass * scale.powi(3);
        assert!(near(clump.mass(), whole), "{}", clump.mass());
        let moment = 0.4 * whole * (scale * 3e-3).powi(2);
        assert!(clump.inertia().iter().all(|i| near(*i, moment)));
    }
}

/// The declared filling of an ellipsoid has 20 spheres, follows the surface as told (root mean square over the
/// shortest semi-axis: 2 % for stout ones, 7 % for a flat one), and has the mass and the moments
/// m/5 (b^2 + c^2) of the ellipsoid; the mesh of 2048 triangles gives these within 0.5 %.
#[test]
fn an_ellipsoid_is_filled_as_the_guide_says() {
    for ([a, b, c], most) in [
        ([8.0, 6.0, 5.0], 0.02),
        ([9.0, 4.5, 4.0], 0.02),
        ([10.0, 6.0, 3.0], 0.07),
        ([5.2, 5.0, 4.9], 0.02),
    ] {
        let seed = format!(
            "ellipsoid = [\"{a} mm\", \"{b} mm\", \"{c} mm\"]\ndensity = \"1200 kg/m3\"\ncount = 5"
        );
        let scene = read(&seed).unwrap();
        let body = body(&scene);
        assert_eq!(body.clump.spheres().len(), 20);
        let rough = body.report.roughness_rms / (0.5e-3 * c);
        assert!(rough < most, "{a} {b} {c}: roughness {rough}");
        let mass = PI / 6.0 * a * b * c * 1e-9 * 1200.0;
        assert!((body.clump.mass() / mass - 1.0).abs() < 1e-9);
        let semi = [a, b, c].map(|x| 0.5e-3 * x);
        let moment = |x: f64, y: f64| 0.2 * mass * (x * x + y * y);
        let mut expected = [
            moment(semi[1], semi[2]),
            moment(semi[0], semi[2]),
            moment(semi[0], semi[1]),
        ];
        expected.sort_by(f64::total_cmp);
        for (found, expected) in body.clump.inertia().iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 5e-3, "{found} {expected}");
        }
    }
}

/// 250 g of peas of 0.1414 g; a third of the drum at a solid fraction of 0.6, or as stated: closed forms, rounded to
/// the nearest whole seed.
#[test]
fn the_number_of_seeds_follows_from_mass_or_fill_level() {
    let pea = "sphere = \"6 mm\"\ndensity = \"1250 kg/m3\"\n";
    let volume = PI / 6.0 * 6e-3_f64.powi(3);
    let drum = PI * 0.03 * 0.03 * 0.03;
    for (line, exact) in [
        ("total_mass = \"10 g\"", 10e-3 / (1250.0 * volume)),
        ("fill_level = 0.35", 0.35 * drum * 0.6 / volume),
        (
            "fill_level = 0.35\nsolid_fraction = 0.5",
            0.35 * drum * 0.5 / volume,
        ),
    ] {
        let scene = read(&format!("{pea}{line}")).unwrap();
        assert_eq!(scene.seed_count() as f64, exact.round(), "{line}");
        // The number is that of bodies that a run begins with.
        let (frame, ..) = starting_frame(&scene, &FillingLibrary::default(), 1).unwrap();
        assert_eq!(frame.position.len(), scene.seed_count());
    }
    let mesh = "mesh = \"sphere.stl\"\nmesh_unit = \"mm\"\nscale = 3.0\n\
        filling = { method = \"pack\", sphere_radius = \"0.9 mm\", sphere_count = 1, seed = 1 }\n";
    let scene = read(&format!(
        "{mesh}density = \"1250 kg/m3\"\ntotal_mass = \"10 g\""
    ))
    .unwrap();
    let volume = body(&scene).mesh.mesh.moments().volume;
    assert_eq!(
        scene.seed_count() as f64,
        (10e-3 / (1250.0 * volume)).round()
    );
    assert!((body(&scene).clump.mass() / (1250.0 * volume) - 1.0).abs() < 1e-9);
}

/// What was read, written and read again is the same scene, whichever keys state it, and settings change on the way.
#[test]
fn a_scene_reads_back_as_itself_and_takes_changes() {
    for (seed, path, value) in [
        (
            "sphere = \"6 mm\"\nmass = \"0.14 g\"\ncount = 5",
            "seed.0.count",
            "9",
        ),
        (
            "ellipsoid = [\"8 mm\", \"6 mm\", \"5 mm\"]\ndensity = \"1200 kg/m3\"\nfill_level = 0.3",
            "seed.0.ellipsoid.0",
            "9 mm",
        ),
        (
            "sphere = \"6 mm\"\ndensity = \"1250 kg/m3\"\ntotal_mass = \"10 g\"",
            "density",
            "1300 kg/m3",
        ),
        (
            "mesh = \"sphere.stl\"\nmesh_unit = \"mm\"\ndensity = \"1250 kg/m3\"\nfill_level = 0.3\n\
          filling = { method = \"pack\", sphere_radius = \"0.9 mm\", sphere_count = 1, seed = 1 }",
            "fill_level",
            "0.2",
        ),
    ] {
        let scene = read(seed).unwrap();
        assert_eq!(scene.with(&[]).unwrap(), scene, "{seed}");
        let text = toml::to_string(&scene).unwrap();
        assert_eq!(
            Scene::from_text(&text, &scene.file, &scene.folder, &[]).unwrap(),
            scene
        );
        let change = Override {
            name: path.into(),
            value: value.into(),
        };
        let changed = scene.with(&[change]).unwrap();
        assert_ne!(changed, scene, "{seed}");
        let before = scene.seed[0].mass_kg() * scene.seed_count() as f64;
        let after = changed.seed[0].mass_kg() * changed.seed_count() as f64;
        assert!(before > 0.0 && after > 0.0);
    }
}

/// Every wrong combination is told with the seed, the keys and the way out; all of them at once.
#[test]
fn wrong_combinations_of_keys_are_refused() {
    for (seed, words) in [
        (
            "mass = \"0.1 g\"\ncount = 5",
            vec!["none of mesh, sphere, ellipsoid"],
        ),
        (
            "sphere = \"6 mm\"\nellipsoid = [\"8 mm\", \"6 mm\", \"5 mm\"]\nmass = \"0.1 g\"\ncount = 5",
            vec!["sphere and ellipsoid of"],
        ),
        (
            "sphere = \"6 mm\"\ncount = 5",
            vec!["none of mass, density"],
        ),
        (
            "sphere = \"6 mm\"\nmass = \"0.1 g\"\ndensity = \"1200 kg/m3\"\ncount = 5",
            vec!["mass and density of"],
        ),
        (
            "sphere = \"6 mm\"\nmass = \"0.1 g\"",
            vec!["none of count, total_mass, fill_level"],
        ),
        (
            "sphere = \"6 mm\"\nmass = \"0.1 g\"\ncount = 5\nfill_level = 0.3",
            vec!["count and fill_level of"],
        ),
        (
            "mesh = \"sphere.stl\"\nmass = \"0.1 g\"\ncount = 5",
            vec!["without mesh_unit", "without filling"],
        ),
        (
            "sphere = \"6 mm\"\nmesh_unit = \"mm\"\nmass = \"0.1 g\"\ncount = 5\nsolid_fraction = 0.5",
            vec![
                "mesh_unit is stated without mesh",
                "solid_fraction is stated without fill_level",
            ],
        ),
        (
            "sphere = \"6 mm\"\nmass = \"0.1 g\"\nfill_level = 1.2",
            vec!["fill_level", "1.2", "at most 1"],
        ),
        (
            "sphere = \"0 mm\"\nmass = \"0.1 g\"\ncount = 5",
            vec!["sphere of seed 'pea'", "0.001 mm"],
        ),
    ] {
        let scene: Scene = toml::from_str(&drum(seed)).unwrap();
        let all: Vec<_> = scene.problems().iter().map(ToString::to_string).collect();
        let all = all.join("\n");
        assert!(all.contains("pea"), "{all}");
        for word in words {
            assert!(all.contains(word), "'{word}' is not in '{all}'");
        }
        assert!(read(seed).is_err());
    }
}

/// Peas that overfill the drum are told before a run; those that fit are not.
#[test]
fn a_dry_build_tells_too_many_seeds() {
    let pea = "sphere = \"6 mm\"\nmass = \"0.14 g\"\ncount = ";
    let library = FillingLibrary::default();
    read(&format!("{pea}100"))
        .unwrap()
        .build_check(&library)
        .unwrap();
    let error = read(&format!("{pea}1000"))
        .unwrap()
        .build_check(&library)
        .unwrap_err();
    assert!(
        matches!(error, scene::Error::TooManySeeds { .. }),
        "{error}"
    );
}

/// Balls of 8 and 4 mm that fill a quarter of the drum are more than a grid of 8 mm has places for. They start all the same, none
/// touching another or a wall, and at the same places for the same seed. More than balls can fill are refused.
#[test]
fn balls_of_unlike_sizes_have_room_between_each_other() {
    let large = "sphere = \"8 mm\"\nmass = \"0.3 g\"\ncount = 60";
    let small = |count: usize| {
        format!(
            "{large}\n[[seed]]\nname = \"lentil\"\nmaterial = \"pea\"\nsphere = \"4 mm\"\nmass = \"0.04 g\"\ncount = {count}"
        )
    };
    let library = FillingLibrary::default();
    let scene = read(&small(120)).unwrap();
    let (frame, ..) = starting_frame(&scene, &library, 3).unwrap();
    assert_eq!(frame.position.len(), 180);
    let radius = |i: usize| [4e-3, 2e-3][frame.kind[i]];
    for (i, a) in frame.position.iter().enumerate() {
        let out = a.xy().norm() + radius(i) < 30e-3 && a.z.abs() + radius(i) < 15e-3;
        assert!(out, "body {i} at {a} is in a wall");
        for (j, b) in frame.position.iter().enumerate().skip(i + 1) {
            let gap = (a - b).norm() - radius(i) - radius(j);
            assert!(gap > 0.0, "bodies {i} and {j} overlap by {} m", -gap);
        }
    }
    let (again, ..) = starting_frame(&scene, &library, 3).unwrap();
    assert_eq!(frame, again);
    let error = read(&small(3000))
        .unwrap()
        .build_check(&library)
        .unwrap_err();
    assert!(
        matches!(error, scene::Error::TooManySeeds { .. }),
        "{error}"
    );
}
