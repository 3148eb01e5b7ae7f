//! What is read of the files that a deck leaves.

use super::read;
use dev_support::fixture_files::fixture;
use scene::{FillingLibrary, Override, Scene, starting_frame};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// Number, height and velocity downwards of each sphere.
type Spheres = Vec<(usize, f64, f64)>;

/// A dump of spheres of a radius at some steps.
fn dump(path: &Path, radius: f64, moments: &[(u64, Spheres)]) {
    let mut text = String::new();
    for (step, spheres) in moments {
        let n = spheres.len();
        let head = format!(
            "ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{n}\nITEM: BOX BOUNDS ff ff ff\n0 1\n0 1\n0 1\n"
        );
        text += &head;
        text += "ITEM: ATOMS id type x y z radius vx vy vz\n";
        for (id, y, down) in spheres {
            writeln!(text, "{id} 1 0 {y} 0 {radius} 0 {} 0", -down).unwrap();
        }
    }
    fs::write(path, text).unwrap();
}

fn value(read: &[scene::ObservableValues], name: &str) -> Option<f64> {
    read.iter()
        .find(|o| o.name == name)?
        .values
        .first()
        .copied()
}

/// A bench of so many seeds.
fn bench(name: &str, count: &str) -> Scene {
    let few = [Override {
        name: "seed.0.count".into(),
        value: count.into(),
    }];
    Scene::read(&fixture(&format!("benches/{name}.toml")), &few).unwrap()
}

/// Beads of 35.343 mg that fall at 1 m/s through the outlet, 15 mm below, one every 400 steps of the deck, the last at its own time, and two that
/// stay are left behind. Before, gate and bottom carry 90 % of the weight of all. To rounding of the table; a row more or less at the
/// ends of the steady part does not change an even flow.
#[test]
fn a_discharge_is_read_from_the_spheres_that_leave() {
    let scene = bench("hopper", "42");
    let (_, bodies, step) = starting_frame(&scene, &FillingLibrary::default(), 1).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let every = 400_u64;
    let dt = 400.0 * step / 4.0;
    let all: Vec<_> = (0..42).map(|k| (k + 1, 0.02, 0.0)).collect();
    let mass = bodies[0].clump.mass();
    let carried = -0.9 * 42.0 * mass * 9.81;
    for (stem, force) in [("0-filling", 0.0), ("1-rest", carried)] {
        dump(
            &at(&format!("{stem}.dump")),
            1.5e-3,
            &[(0, all.clone()), (every, all.clone())],
        );
        fs::write(at(&format!("{stem}.txt")), format!("time_s fx_gate fy_gate fz_gate fx_bottom fy_bottom fz_bottom\n{dt} 0 {} 0 0 {} 0\n", 0.25 * force, 0.75 * force)).unwrap();
    }
    // Bead k is 5 mm above the outlet, at 1 m/s, in moment k.
    let moments: Vec<_> = (0..41_usize)
        .map(|k| {
            let left = all.iter().filter(|(id, ..)| *id > k || *id > 40);
            let placed = left.map(|(id, y, v)| {
                if *id == k + 1 && *id <= 40 {
                    (*id, -0.01, 1.0)
                } else {
                    (*id, *y, *v)
                }
            });
            (1000 * every + k as u64 * every, placed.collect())
        })
        .collect();
    dump(&at("2-discharge.dump"), 1.5e-3, &moments);
    let mut rows = String::new();
    for k in 1..=40 {
        writeln!(rows, "{} 0 0 0", f64::from(k) * dt).unwrap();
    }
    fs::write(
        at("2-discharge.txt"),
        format!("time_s fx_bottom fy_bottom fz_bottom\n{rows}"),
    )
    .unwrap();
    let read = read(&scene, &bodies, step, folder.path()).unwrap();
    let flow = value(&read, "mass_flow_g_s").unwrap();
    assert!((flow / (1e3 * mass / dt) - 1.0).abs() < 1e-6, "{flow} g/s");
    let fall = ((1.0_f64 + 2.0 * 9.81 * 0.005).sqrt() - 1.0) / 9.81;
    let last = value(&read, "discharge_time_s").unwrap();
    assert!((last - (39.0 * dt + fall)).abs() < 1e-9, "{last} s");
    let left = value(&read, "left_behind_g").unwrap();
    assert!((left / (2e3 * mass) - 1.0).abs() < 1e-9, "{left} g");
    let share = value(&read, "bottom_load_share").unwrap();
    assert!((share - 0.9).abs() < 1e-9, "{share}");
}

/// A piston that starts at 60 mm and comes to rest at 40, 39 and 38.5 mm under 2, 5 and 10 kPa, and at 38.8 mm under 2 kPa again: strain
/// `1 - 38.5/40`, loading modulus `5 kPa 40/0.5`, unloading modulus `8 kPa 40/0.3`. Each side carries half of the stress of the piston.
#[test]
fn a_press_is_read_from_the_table_of_walls() {
    let scene = bench("compression", "1");
    let (_, bodies, step) = starting_frame(&scene, &FillingLibrary::default(), 1).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let phases = [
        ("0-filling", 0.0, 0.06),
        ("1-load-0", 2e3, 0.04),
        ("2-load-1", 5e3, 0.039),
        ("3-load-2", 1e4, 0.0385),
        ("4-unload", 2e3, 0.0388),
    ];
    for (stem, stress, height) in phases {
        dump(
            &folder.path().join(format!("{stem}.dump")),
            2.5e-3,
            &[(0, vec![(1, 0.01, 0.0)])],
        );
        let (piston, side) = (stress * 1.6e-3, 0.5 * stress * 0.04 * height);
        let text = format!(
            "time_s fy_piston fx_piston fz_piston dx_piston dy_piston dz_piston fx_left_end fy_left_end fz_left_end fx_right_end fy_right_end fz_right_end \
             fx_front_side fy_front_side fz_front_side fx_back_side fy_back_side fz_back_side fx_floor fy_floor fz_floor\n\
             0.002 {piston} 0 0 0 {} 0 {} 0 0 {side} 0 0 0 0 {side} 0 0 {} 0 {} 0\n",
            height - 0.06,
            -side,
            -side,
            -piston
        );
        fs::write(folder.path().join(format!("{stem}.txt")), text).unwrap();
    }
    let read = read(&scene, &bodies, step, folder.path()).unwrap();
    let near = |name: &str, expected: f64| {
        let found = value(&read, name).unwrap();
        assert!(
            (found / expected - 1.0).abs() < 1e-9,
            "{name}: {found} for {expected}"
        );
    };
    near("strain", 1.0 - 38.5 / 40.0);
    near("loading_modulus_kpa", 5.0 * 40.0 / 0.5);
    near("unloading_modulus_kpa", 8.0 * 40.0 / 0.3);
    near("wall_stress_ratio", 0.5);
}

/// A folder without the filling, a bed of another number of seeds, and a row that is cut off, are refused with their file.
#[test]
fn what_is_not_there_or_broken_is_refused() {
    let scene = bench("hopper", "2");
    let (_, bodies, step) = starting_frame(&scene, &FillingLibrary::default(), 1).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let message = || {
        read(&scene, &bodies, step, folder.path())
            .unwrap_err()
            .to_string()
    };
    assert!(message().contains("0-filling.dump"), "{}", message());
    let filling = folder.path().join("0-filling.dump");
    dump(&filling, 1.5e-3, &[(0, vec![(1, 0.01, 0.0)])]);
    assert!(
        message().contains("1 seeds and the scene has 2"),
        "{}",
        message()
    );
    dump(
        &filling,
        1.5e-3,
        &[(0, vec![(1, 0.01, 0.0), (2, 0.01, 0.0)])],
    );
    fs::write(
        folder.path().join("0-filling.txt"),
        "time_s fx_gate\n0.1 1\n0.2\n",
    )
    .unwrap();
    assert!(message().contains("line 3"), "{}", message());
}
