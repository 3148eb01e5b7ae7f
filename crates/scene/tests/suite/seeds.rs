//! Seeds without a mesh, and masses and numbers as a laboratory states them.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use dev_support::fixture_files::fixture;
use nalgebra::Vector3;
use scene::{FillingLibrary, Frame, Override, Scene, SeedBody, starting_frame};
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
        let rough = body.shape.as_ref().unwrap().report.roughness_rms / (0.5e-3 * c);
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
    let volume = body(&scene).volume;
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

/// Every wrong combination is reported with the seed, the keys and the remedy, all of them at once.
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

/// Peas that overfill the drum are reported before a run; those that fit are not.
#[test]
fn a_dry_build_reports_too_many_seeds() {
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

/// No ball of a frame touches another, by the radius (m) of its kind, or lies outside.
fn assert_apart(
    frame: &Frame,
    radius: impl Fn(usize) -> f64,
    is_inside: impl Fn(&Vector3<f64>, f64) -> bool,
) {
    let balls = || frame.position.iter().zip(&frame.kind);
    for (i, (a, kind)) in balls().enumerate() {
        assert!(is_inside(a, radius(*kind)), "body {i} at {a} is in a wall");
        for (j, (b, other)) in balls().enumerate().skip(i + 1) {
            let gap = (a - b).norm() - radius(*kind) - radius(*other);
            assert!(gap > 0.0, "bodies {i} and {j} overlap by {} m", -gap);
        }
    }
}

/// Balls of 5.2 and 2.8 mm that take 0.32 of a narrow box: more than jam there when they are put in one after another
/// (some 0.27 between its walls), and less than half of what a shaken gas of balls can take.
#[test]
fn balls_that_jam_in_a_narrow_box_are_shaken_until_all_have_a_place() {
    let text = std::fs::read_to_string(fixture("other-code/box.toml")).unwrap();
    let mut scene: Scene = toml::from_str(&text).unwrap();
    let mut small = scene.seed[0].clone();
    small.name = "small".into();
    small.sphere = Some("2.8 mm".parse().unwrap());
    scene.seed[0].sphere = Some("5.2 mm".parse().unwrap());
    for seed in [&mut scene.seed[0], &mut small] {
        seed.set_count(130);
    }
    scene.seed.push(small);
    let (frame, ..) = starting_frame(&scene, &FillingLibrary::default(), 3).unwrap();
    assert_eq!(frame.position.len(), 260);
    let radius = |kind: usize| [2.6e-3, 1.4e-3][kind];
    assert_apart(&frame, radius, |_, _| true);
    // Within walls of 24, 90 and 16 mm, wherever they stand.
    for (axis, length) in [24e-3, 90e-3, 16e-3].into_iter().enumerate() {
        let balls = || frame.position.iter().zip(&frame.kind);
        let high = balls().map(|(a, kind)| a[axis] + radius(*kind));
        let low = balls().map(|(a, kind)| a[axis] - radius(*kind));
        let taken = high.fold(f64::MIN, f64::max) - low.fold(f64::MAX, f64::min);
        assert!(taken <= length, "{taken} m of {length}");
    }
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
    let radius = |kind: usize| [4e-3, 2e-3][kind];
    let in_drum = |a: &Vector3<f64>, r: f64| a.xy().norm() + r < 30e-3 && a.z.abs() + r < 15e-3;
    assert_apart(&frame, radius, in_drum);
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

/// Flat seeds that fill 0.35 of the drum are twice as many as their capsules have room for, which are balls as wide as they
/// are. They start all the same, at the same places for the same seed, and no sphere touches one of another seed or a wall.
#[test]
fn flat_seeds_start_where_their_spheres_have_room() {
    let lentil =
        "ellipsoid = [\"6 mm\", \"6 mm\", \"2.4 mm\"]\nmass = \"60 mg\"\nfill_level = 0.35";
    let scene = read(lentil).unwrap();
    let library = FillingLibrary::default();
    let (frame, bodies, ..) = starting_frame(&scene, &library, 3).unwrap();
    // 0.35 of 84.8 cm3, 0.6 of that solid, 45.2 mm3 each.
    assert_eq!(frame.position.len(), 394);
    let spheres: Vec<_> = (0..frame.position.len())
        .flat_map(|body| {
            let (place, turn) = (frame.position[body], frame.orientation[body]);
            let own = bodies[frame.kind[body]].clump.spheres().iter();
            own.map(move |s| (body, place + turn * s.centre, s.radius))
        })
        .collect();
    for (i, (body, a, radius)) in spheres.iter().enumerate() {
        assert!(
            a.xy().norm() + radius < 30e-3 && a.z.abs() + radius < 15e-3,
            "a sphere of seed {body} is in a wall"
        );
        for (other, b, their) in &spheres[i + 1..] {
            assert!(
                body == other || (a - b).norm() > radius + their,
                "seeds {body} and {other} overlap"
            );
        }
    }
    let (again, ..) = starting_frame(&scene, &library, 3).unwrap();
    assert_eq!(frame, again);
}

/// A mass in grams that was meant in milligrams, or a size in centimetres that was meant in millimetres, gives a density
/// that no material has. It is reported with mass and volume for balls, ellipsoids and meshes alike; the densities of foam
/// and tungsten are accepted.
#[test]
fn a_density_that_nothing_has_is_refused() {
    // 113.1 mm3.
    let pea = |mass: &str| format!("sphere = \"6 mm\"\nmass = \"{mass}\"\ncount = 3");
    for mass in ["1.2 mg", "0.147 g", "2.2 g"] {
        read(&pea(mass)).unwrap();
    }
    let of_mesh = |mass: &str| {
        let file = fixture("stl/sphere.stl");
        format!(
            "mesh = '{}'\nmesh_unit = \"mm\"\nmass = \"{mass}\"\ncount = 3\n\
             filling = {{ method = \"pack\", sphere_radius = \"0.3 mm\", seed = 1 }}",
            file.display()
        )
    };
    read(&of_mesh("5 mg")).unwrap();
    for wrong in [
        pea("147 g"),
        pea("0.3 mg"),
        "sphere = \"6 cm\"\nmass = \"147 mg\"\ncount = 3".to_owned(),
        "sphere = \"6 mm\"\ndensity = \"1.3 kg/m3\"\ncount = 3".to_owned(),
        "ellipsoid = [\"6 mm\", \"6 mm\", \"6 mm\"]\nmass = \"147 g\"\ncount = 3".to_owned(),
        of_mesh("5 g"),
    ] {
        let error = read(&wrong).unwrap_err().to_string();
        assert!(
            error.contains("density of seed 'pea' is") && error.contains("mind the units"),
            "{wrong}: {error}"
        );
    }
}

/// Reads the drum beside the tables of spheres.
fn read_beside_tables(seed: &str) -> Result<Scene, scene::Error> {
    Scene::from_text(&drum(seed), "peas.toml", &fixture("clump"), &[])
}

/// Volume of `three-spheres.csv`, m3: a ball of 2.1 mm with one of 1.5 mm at 2.2 mm to either side, less their two lenses.
fn volume_of_three_spheres() -> f64 {
    let (big, small, d): (f64, f64, f64) = (2.1, 1.5, 2.2);
    let lens = PI
        * (big + small - d).powi(2)
        * (d * d + 2.0 * d * (big + small) - 3.0 * (big - small).powi(2))
        / (12.0 * d);
    1e-9 * (4.0 / 3.0 * PI * (big.powi(3) + 2.0 * small.powi(3)) - 2.0 * lens)
}

/// Three balls as a table beside the scene: volume without the lenses, mass by the density, centre in the middle ball, two
/// equal moments across. The volume is integrated on chords, whose error is below 1e-4. `scale` grows all of it.
#[test]
fn a_table_of_spheres_is_a_seed_as_it_is() {
    for (size, line) in [(1.0_f64, ""), (2.0, "scale = 2.0")] {
        let scene = read_beside_tables(&format!(
            "spheres = \"three-spheres.csv\"\ndensity = \"1250 kg/m3\"\nfill_level = 0.3\n{line}"
        ))
        .unwrap();
        let body = body(&scene);
        let volume = volume_of_three_spheres() * size.powi(3);
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-4;
        let mass = body.clump.mass();
        assert!(near(mass, 1250.0 * volume), "{mass}");
        assert!(near(body.volume, volume));
        let spheres = body.clump.spheres();
        assert_eq!(spheres.len(), 3);
        let middle = spheres.iter().find(|s| near(s.radius, size * 2.1e-3));
        let centre = middle.unwrap().centre;
        assert!(centre.norm() < 1e-4 * size * 2.1e-3, "{centre}");
        let moments = body.clump.inertia();
        assert!(
            near(moments.y, moments.z) && moments.x < 0.6 * moments.y,
            "{moments}"
        );
        let bed = 0.3 * 0.6 * PI * 0.03_f64.powi(2) * 0.03 / volume;
        assert!((scene.seed_count() as f64 - bed).abs() <= 0.5 + 1e-4 * bed);
        // The unit that was taken is written down.
        assert_eq!(
            scene.seed[0].spheres_unit,
            Some(trimesh::LengthUnit::Millimetre)
        );
    }
}

/// A table beside another shape, without its file or with a unit that makes no seed is refused. A unit that is stated is
/// taken.
#[test]
fn a_table_of_spheres_that_cannot_be_meant_is_refused() {
    let list = "density = \"1250 kg/m3\"\ncount = 5\nspheres = \"three-spheres.csv\"";
    let metres = list.replace("three-spheres.csv", "three-spheres-metres.txt");
    for (seed, message) in [
        (
            format!(
                "{list}\nfilling = {{ method = \"pack\", sphere_radius = \"1 mm\", seed = 1 }}"
            ),
            "filling is stated beside spheres",
        ),
        (
            format!("{list}\nsphere = \"6 mm\""),
            "sphere and spheres of mesh, sphere",
        ),
        (
            "sphere = \"6 mm\"\nmass = \"9 mg\"\ncount = 5\nspheres_unit = \"mm\"".to_owned(),
            "without spheres",
        ),
        (
            metres.clone(),
            "in mm the seed would be 0.00740 mm long; state",
        ),
        (
            format!("{list}\nspheres_unit = \"m\""),
            "a seed is 0.001 mm to 1 m",
        ),
        (list.replace("three", "four"), "four-spheres.csv"),
    ] {
        let error = read_beside_tables(&seed).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
    }
    let stated = read_beside_tables(&format!("{metres}\nspheres_unit = \"m\"")).unwrap();
    let volume = stated.seed[0].volume().unwrap();
    assert!((volume / volume_of_three_spheres() - 1.0).abs() < 1e-4);
}

/// A fill level is a share of the apparatus that there is in the end: 0.35 of a drum becomes 0.35 of the cylinder of a heap, and
/// again after the cylinder is changed. A level takes the place of a count, and a count that of a level.
#[test]
fn the_number_of_seeds_follows_from_the_apparatus_after_all_changes() {
    let set = |changes: &[(&str, &str)]| -> Vec<Override> {
        let change = |(name, value): &(&str, &str)| Override {
            name: (*name).into(),
            value: (*value).into(),
        };
        changes.iter().map(change).collect()
    };
    let heap = r#"{ kind = "heap", inner_diameter = "80 mm", height = "100 mm", lift_speed = "20 mm/s", floor = "steel",
        cylinder = "steel" }"#;
    let heap: toml::Table = format!("a = {heap}").replace('\n', " ").parse().unwrap();
    let heap: scene::Apparatus = heap["a"].clone().try_into().unwrap();
    let drum = read("sphere = \"6 mm\"\nmass = \"150 mg\"\nfill_level = 0.35").unwrap();
    let scene = drum.in_apparatus(heap.clone()).unwrap();
    let expected = |d: f64, h: f64| {
        let cylinder = PI / 4.0 * d * d * h;
        (0.35 * 0.6 * cylinder / (PI / 6.0 * 0.006_f64.powi(3))).round()
    };
    assert_eq!(scene.seed_count() as f64, expected(0.08, 0.1));
    let small = set(&[
        ("apparatus.inner_diameter", "50 mm"),
        ("apparatus.height", "60 mm"),
    ]);
    let small = scene.with(&small).unwrap();
    assert_eq!(small.seed_count() as f64, expected(0.05, 0.06));
    let counted = read("sphere = \"6 mm\"\nmass = \"150 mg\"\ncount = 20").unwrap();
    let counted = counted.in_apparatus(heap).unwrap();
    let level = counted
        .with(&set(&[("seed.0.fill_level", "0.35")]))
        .unwrap();
    assert_eq!(level.seed_count() as f64, expected(0.08, 0.1));
    let again = level
        .with(&set(&[("count", "7"), ("density", "1250 kg/m3")]))
        .unwrap();
    assert_eq!((again.seed_count(), again.seed[0].mass), (7, None));
    // In a bench test the number does not matter, and the plate may be changed to another material.
    let sled = "a = { kind = \"slider\", plate = \"pea\" }"
        .parse::<toml::Table>()
        .unwrap();
    let sled = drum
        .in_apparatus(sled["a"].clone().try_into().unwrap())
        .unwrap();
    let steel = sled.with(&set(&[("apparatus.plate", "steel")])).unwrap();
    assert_eq!(steel.reduced().contact.len(), 1);
}

/// Spheres 2.5 times as large: 1000 / 2.5³ = 64 of 15.625 times the mass and the same density, so that the mass of the bed stays; of 70
/// some 4.48 are left, which is 4.
#[test]
fn coarser_seeds_are_fewer_by_the_cube_of_their_size() {
    for (count, expected) in [(1000, 64), (70, 4)] {
        let seed = format!("sphere = \"2 mm\"\ndensity = \"1250 kg/m3\"\ncount = {count}");
        let real = read(&seed).unwrap();
        let mut coarse = real.clone();
        coarse.coarsen_seeds(2.5);
        coarse.check().unwrap();
        assert_eq!(coarse.seed_count(), expected);
        let [a, b] = [&real, &coarse].map(|scene| body(scene).clump.clone());
        assert!((b.mass() / a.mass() / 15.625 - 1.0).abs() < 1e-12);
        assert!((b.spheres()[0].radius / a.spheres()[0].radius - 2.5).abs() < 1e-12);
    }
}
