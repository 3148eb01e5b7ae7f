//! Apparatus that go through phases, held to closed forms and to rules of the field.

use crate::restart::goes_on_with_the_same_bits;
use dev_support::fixture_files::fixture;
use scene::{Doubt, Ending, Error, FillingLibrary, Override, RunResult, Scene, run};
use std::f64::consts::PI;

/// A scene of `fixtures/benches` with changes.
fn bench(name: &str, changes: &[(&str, &str)]) -> Result<Scene, Error> {
    let changes: Vec<_> = changes.iter().map(change).collect();
    Scene::read(&fixture(&format!("benches/{name}.toml")), &changes)
}

/// A scene of `fixtures/benches` with a part of its text replaced, for settings that are lists or absent.
fn edited(name: &str, [from, to]: [&str; 2], changes: &[(&str, &str)]) -> Result<Scene, Error> {
    let file = fixture(&format!("benches/{name}.toml"));
    let text = std::fs::read_to_string(&file).expect("the fixture");
    assert!(text.contains(from), "{from} in {name}");
    let changes: Vec<_> = changes.iter().map(change).collect();
    let folder = file.parent().expect("a folder");
    Scene::from_text(&text.replacen(from, to, 1), name, folder, &changes)
}

/// A change of a setting.
fn change((name, value): &(&str, &str)) -> Override {
    Override {
        name: (*name).into(),
        value: (*value).into(),
    }
}

/// A run of it, whose observables are among those that the scene names.
fn run_of(name: &str, changes: &[(&str, &str)]) -> RunResult {
    run_scene(&bench(name, changes).expect("a scene"))
}

/// A run of a scene, likewise.
fn run_scene(scene: &Scene) -> RunResult {
    let result = run(scene, &FillingLibrary::default(), 1).expect("a run");
    let known = scene.observables();
    for found in &result.observables {
        assert!(known.contains(&&*found.name), "{}", found.name);
    }
    result
}

/// Mean of an observable.
fn mean(result: &RunResult, name: &str) -> f64 {
    let found = result.observables.iter().find(|o| o.name == name);
    let values = found.map_or(&[][..], |found| &found.values);
    assert!(!values.is_empty(), "{name} has no value");
    values.iter().sum::<f64>() / values.len() as f64
}

/// Beads of 3 mm, fewer than in the fixture.
const FEW: (&str, &str) = ("seed.0.count", "500");

/// Beverloo: `W = 0.58 rho sqrt(g) (D - k d)^(5/2)` `[Beverloo1961]`, k 1.2 to 1.6 for spheres, with a bulk density of 0.58 times that of the
/// beads. A flow through 5 diameters lies within the k of 1.2 to 1.6 to either side, and 10 % for the bulk density and the scatter of one run.
#[test]
fn a_hopper_flows_as_beverloo_says() {
    let flow = 1e-3 * mean(&run_of("hopper", &[FEW]), "mass_flow_g_s");
    let beverloo =
        |k: f64| 0.58 * 0.58 * 2500.0 * 9.81_f64.sqrt() * (15e-3 - k * 3e-3_f64).powf(2.5);
    let (low, high) = (0.9 * beverloo(1.6), 1.1 * beverloo(1.2));
    assert!(
        (low..=high).contains(&flow),
        "{flow} kg/s, not {low} to {high}"
    );
}

/// Openings of 5, 6.5 and 8 diameters: the exponent 5/2 makes `W^(2/5)` a line in D whose zero is k d, k 1.2 to 1.6 `[Beverloo1961]`; twice the
/// head changes the flow by no more than two runs scatter, 6 %.
#[test]
#[ignore = "minutes; `trials/checks.sh benches`"]
fn openings_and_heads_of_a_hopper_obey_beverloo() {
    let flow = |outlet: &str, count: &str| {
        let changes = [
            ("apparatus.outlet", outlet),
            ("apparatus.inner_diameter", "45 mm"),
            ("apparatus.height", "120 mm"),
            ("seed.0.count", count),
        ];
        mean(&run_of("hopper", &changes), "mass_flow_g_s")
    };
    let openings = [("15 mm", 15.0), ("19.5 mm", 19.5), ("24 mm", 24.0)];
    let points = openings.map(|(text, mm)| [mm, flow(text, "3000").powf(0.4)]);
    let middle = [0, 1].map(|k| points.iter().map(|p| p[k]).sum::<f64>() / 3.0);
    let of = |f: &dyn Fn(&[f64; 2]) -> f64| points.iter().map(f).sum::<f64>();
    let slope =
        of(&|p| (p[0] - middle[0]) * (p[1] - middle[1])) / of(&|p| (p[0] - middle[0]).powi(2));
    let k = (middle[0] - middle[1] / slope) / 3.0;
    assert!((1.2..=1.6).contains(&k), "k = {k}");
    let [half, whole] = ["2000", "4000"].map(|count| flow("19.5 mm", count));
    assert!((whole / half - 1.0).abs() < 0.06, "{half} and {whole} g/s");
}

/// Walls without friction carry no weight: the bottom of a column carries all of it, to the 0.5 % by which the bed still swings.
#[test]
fn smooth_walls_of_a_hopper_carry_no_weight() {
    let changes = [
        ("apparatus.inner_diameter", "18 mm"),
        ("apparatus.outlet", "12 mm"),
        ("apparatus.height", "160 mm"),
        ("seed.0.count", "200"),
        ("contact.glass-acrylic.static_friction", "0"),
        ("time_s", "0.12"),
    ];
    let share = mean(&run_of("hopper", &changes), "bottom_load_share");
    assert!((share - 1.0).abs() < 5e-3, "{share}");
}

/// Under a piston rough walls carry a part of the load, at most that of Janssen with friction at its limit everywhere: the floor carries at least
/// `exp(-4 mu K h/L)` of load and weight `[Janssen1895]`, L the side of the cell, h the height of the bed, at most 25 mm of 250 peas, and K the stress
/// ratio at the walls. Smooth walls carry nothing, to the 2 % to which a phase asks that the load is carried.
#[test]
fn rough_walls_carry_no_more_of_a_load_than_janssen_says() {
    let run = |friction: &str| {
        let changes = [
            ("seed.0.count", "250"),
            ("apparatus.height", "40 mm"),
            ("contact.pea-steel.static_friction", friction),
        ];
        let stresses = [FIXTURE_STRESSES, r#"["1 kPa", "4 kPa"]"#];
        run_scene(&edited("compression", stresses, &changes).expect("a scene"))
    };
    let smooth = mean(&run("0"), "bottom_load_share");
    assert!((smooth - 1.0).abs() < 0.02, "{smooth}");
    let rough = run("0.5");
    let (share, ratio) = (
        mean(&rough, "bottom_load_share"),
        mean(&rough, "wall_stress_ratio"),
    );
    assert!((0.2..0.9).contains(&ratio), "{ratio}");
    let bound = (-4.0 * 0.5 * ratio * 25.0 / 40.0_f64).exp();
    assert!(share > bound && share < 0.95, "{share}, at least {bound}");
}

/// The stresses of the fixture.
const FIXTURE_STRESSES: &str = r#"["2 kPa", "5 kPa", "10 kPa"]"#;

/// Six spheres on each other in a cell that is 0.1 mm wider than they, between floor and piston: `h = 6 d - sum of (3 F / (4 E* sqrt(R)))^(2/3)`
/// `[Hertz1881]`, F the load and the weight above. Stress goes with strain^(3/2), loading and unloading alike. The spheres lie aside by 0.1 mm at most,
/// which shortens a distance of 5 mm by 1 um, 1 % of the overlaps; a phase ends within 2 % of its load, which moves the heights by 1 % of the
/// compression.
#[test]
fn a_column_of_spheres_is_as_stiff_as_hertz_says() {
    let changes = [
        ("apparatus.length", "5.1 mm"),
        ("apparatus.width", "5.1 mm"),
        ("apparatus.height", "90 mm"),
        ("seed.0.count", "6"),
        ("protocol.settle_limit", "0.3 s"),
        ("contact.pea-pea.static_friction", "0"),
        ("contact.pea-steel.static_friction", "0"),
    ];
    let stresses = [FIXTURE_STRESSES, r#"["20 kPa", "40 kPa", "80 kPa"]"#];
    let scene = edited("compression", stresses, &changes).expect("a scene");
    let result = run_scene(&scene);
    assert_eq!(result.ending, Ending::Rested(None));
    let weight = 1250.0 * PI / 6.0 * 125e-9 * 9.81;
    // Effective moduli of two peas, E / (2 (1 - nu²)), and of a pea on steel.
    let plane_strain = |shear: f64, nu: f64| 2.0 * shear / (1.0 - nu);
    let pea = plane_strain(5e6, 0.3);
    let steel = 1.0 / (1.0 / pea + 1.0 / plane_strain(70e9, 0.3));
    let overlap = |force: f64, young: f64, radius: f64| {
        (0.75 * force / (young * radius.sqrt())).powf(2.0 / 3.0)
    };
    let height = |stress: f64| {
        let load = stress * 5.1e-3 * 5.1e-3;
        let between = (1..6).map(|k| overlap(load + f64::from(k) * weight, 0.5 * pea, 1.25e-3));
        let ends = overlap(load, steel, 2.5e-3) + overlap(load + 6.0 * weight, steel, 2.5e-3);
        0.03 - between.sum::<f64>() - ends
    };
    let [first, middle, last] = [20e3, 40e3, 80e3].map(height);
    let strain = mean(&result, "strain");
    let expected = 1.0 - last / first;
    assert!(
        (strain / expected - 1.0).abs() < 0.01,
        "{strain}, not {expected}"
    );
    let loading = 1e3 * mean(&result, "loading_modulus_kpa");
    let expected = 40e3 * first / (middle - last);
    assert!(
        (loading / expected - 1.0).abs() < 0.02,
        "{loading}, not {expected} Pa"
    );
    let unloading = 1e3 * mean(&result, "unloading_modulus_kpa");
    let expected = 60e3 * first / (first - last);
    assert!(
        (unloading / expected - 1.0).abs() < 0.02,
        "{unloading}, not {expected} Pa"
    );
}

/// Dry spheres have no cohesion: the ratio of steady shear stress to normal stress is that of friction alone, so that a line through two normal
/// stresses meets the axis at 0, to a tenth of the lower shear stress, which one run of a small box scatters.
#[test]
#[ignore = "minutes; `trials/checks.sh benches`"]
fn dry_spheres_have_no_cohesion() {
    let stress = |normal: &str| {
        let changes = [("normal_stress", normal)];
        mean(&run_of("direct-shear", &changes), "steady_shear_stress_kpa")
    };
    let [low, high] = ["2 kPa", "6 kPa"].map(stress);
    let cohesion = low - 2.0 * (high - low) / 4.0;
    assert!(
        cohesion.abs() < 0.1 * low,
        "{cohesion} kPa beside {low} kPa"
    );
    let friction = (high - low) / 4.0;
    assert!((0.3..0.9).contains(&friction), "{friction}");
}

/// Spheres rain into a cup: porosity between the densest random packing, 0.36, and a loose one beside walls ten diameters apart, 0.46; taps
/// make the bed denser.
#[test]
fn a_cup_is_filled_at_random_and_tapped() {
    let changes = [
        ("apparatus.inner_diameter", "24 mm"),
        ("apparatus.height", "24 mm"),
        ("apparatus.taps", "5"),
        ("seed.0.count", "600"),
        ("protocol.insertion_rate", "3000 1/s"),
        ("protocol.settle_limit", "0.3 s"),
        ("time_s", "0.4"),
    ];
    let result = run_of("bulk-density", &changes);
    let porosity = mean(&result, "porosity");
    assert!((0.36..0.46).contains(&porosity), "{porosity}");
    let density = mean(&result, "bulk_density_kg_m3");
    assert!(
        (density / (2500.0 * (1.0 - porosity)) - 1.0).abs() < 1e-9,
        "{density}"
    );
    let ratio = mean(&result, "hausner_ratio");
    assert!((1.0..1.15).contains(&ratio), "{ratio}");
    let tapped = mean(&result, "tapped_density_kg_m3");
    assert!((tapped / density / ratio - 1.0).abs() < 1e-9, "{tapped}");
}

/// A flat probe displaces beads against friction and weight: the force is more than the weight of the beads that it has displaced
/// (buoyancy), and the work is less than that force over the whole depth and half more. More friction makes it larger.
#[test]
fn a_probe_is_pushed_back_by_more_than_buoyancy() {
    let force = |friction: &str| {
        let changes = [
            ("seed.0.count", "600"),
            ("apparatus.inner_diameter", "30 mm"),
            ("apparatus.height", "36 mm"),
            ("speed", "0.1 m/s"),
            ("depth", "6 mm"),
            ("contact.glass-glass.static_friction", friction),
        ];
        let result = run_of("penetration", &changes);
        assert_eq!(result.ending, Ending::Rested(None));
        let work = 1e-3 * mean(&result, "penetration_energy_mj");
        let force = mean(&result, "penetration_force_n");
        assert!(
            work > 0.0 && work < 1.5 * force * 6e-3,
            "{work} J at {force} N"
        );
        force
    };
    let (smooth, rough) = (force("0.2"), force("0.8"));
    let buoyancy = 0.6 * 2500.0 * 9.81 * PI * 36e-6 * 6e-3;
    assert!(smooth > buoyancy, "{smooth} N, {buoyancy} N");
    assert!(rough > smooth, "{smooth} and {rough} N");
}

/// What stays above a slot are two wedges of the angle that is read: their mass over `rho w b² tan(angle)`, b the length of a floor and w the
/// width, is the solid fraction, 0.55 to 0.64 of random packings, to the width of a seed in the 35 mm of a floor. Seeds that slide and roll easily
/// stay in flatter slopes, and more of them fall.
#[test]
fn a_draw_down_box_keeps_two_wedges() {
    let smooth = [
        ("contact.pea-pea.static_friction", "0.2"),
        ("contact.pea-pea.rolling_friction", "0.01"),
    ];
    let [rough, smooth] = [&[][..], &smooth].map(|changes| {
        let result = run_of("draw-down", changes);
        assert_eq!(result.ending, Ending::Rested(None));
        ["shear_angle_deg", "discharged_share"].map(|name| mean(&result, name))
    });
    let [angle, share] = rough;
    let left = (1.0 - share) * 900.0 * 1250.0 * PI / 6.0 * 64e-9;
    let solid = left / (1250.0 * 0.016 * 0.035_f64.powi(2) * angle.to_radians().tan());
    assert!((0.5..0.7).contains(&solid), "{solid} at {angle} deg");
    assert!(
        smooth[0] < angle && smooth[1] > share,
        "{smooth:?}, {rough:?}"
    );
}

/// Of a heap on a plate more stays, in steeper flanks, if its seeds slide and roll less easily `[Zhou2002]`. All seeds are above or below: none is
/// taken out.
#[test]
fn a_ledge_keeps_more_of_rough_seeds() {
    let run = |friction: &str, rolling: &str| {
        let changes = [
            ("seed.0.count", "500"),
            ("apparatus.plate", "40 mm"),
            ("apparatus.outlet", "16 mm"),
            ("contact.pea-pea.static_friction", friction),
            ("contact.pea-pea.rolling_friction", rolling),
        ];
        let result = run_of("ledge", &changes);
        assert_eq!(result.frames[0].position.len(), 500);
        ["angle_of_repose_deg", "discharged_share"].map(|name| mean(&result, name))
    };
    let (smooth, rough) = (run("0.2", "0"), run("0.6", "0.2"));
    assert!(
        smooth[0] < rough[0] && smooth[1] > rough[1],
        "{smooth:?}, {rough:?}"
    );
}

/// Of poured spheres a heap remains by rolling friction alone: without it they roll off the disc, however rough they are; with more of it the heap is higher and steeper, by a constant
/// torque as by a spring and a dashpot, whose heaps come to rest `[Ai2011, section 4, types A and C]`. Differences of 15 to 34 deg and 13 mm stand against
/// errors of 3 deg and one seed, 4 mm.
#[test]
#[ignore = "a minute; `trials/checks.sh benches`"]
fn a_heap_stands_by_rolling_friction() {
    for law in ["constant-torque", "spring-dashpot"] {
        let heap = |rolling: &str| {
            let changes = [
                ("model.rolling_law", law),
                ("contact.pea-pea.rolling_friction", rolling),
                ("contact.pea-felt.rolling_friction", rolling),
            ];
            run_of("poured-heap", &changes)
        };
        let none = heap("0");
        assert!(mean(&none, "heap_mass_g") < 1.0, "{law}");
        let [some, more] = ["0.1", "0.3"].map(heap);
        for heap in [&some, &more] {
            assert_eq!(heap.ending, Ending::Rested(None), "{law}");
        }
        for (name, least) in [
            ("angle_by_position_deg", 6.0),
            ("height_mm", 4.0),
            ("heap_mass_g", 5.0),
        ] {
            let [low, high] = [&some, &more].map(|heap| mean(heap, name));
            assert!(high > low + least, "{law}, {name}: {low} and {high}");
        }
    }
}

/// A hopper that is left during its discharge and continued gives the same bits: the seeds that have gone stay gone and counted.
#[test]
fn a_hopper_goes_on_where_it_was_left() {
    let changes = [
        ("seed.0.count", "150"),
        ("time_s", "0.3"),
        ("protocol.settle_limit", "0.1 s"),
    ];
    let scene = bench("hopper", &changes).expect("a scene");
    let (whole, _) = goes_on_with_the_same_bits(&scene, &[4, 20, 40]);
    assert!(
        whole.frames[0].position.len() < 120,
        "the hopper hardly flows"
    );
}

/// What cannot be built or run is refused before the first step, by the name of its setting.
#[test]
fn wrong_benches_are_refused_by_the_name_of_the_setting() {
    let refused = |scene: Result<Scene, Error>| {
        let built = scene.and_then(|scene| scene.build_check(&FillingLibrary::default()));
        let Err(Error::BadValue { name, .. }) = built else {
            panic!("{built:?}");
        };
        name
    };
    for (name, key, value) in [
        ("hopper", "apparatus.outlet", "2.9 mm"),
        ("hopper", "apparatus.outlet", "0 mm"),
        ("hopper", "apparatus.outlet", "31 mm"),
        ("draw-down", "apparatus.outlet", "3.9 mm"),
        ("draw-down", "apparatus.outlet", "90 mm"),
        ("bulk-density", "apparatus.tap_height", "0 mm"),
        ("bulk-density", "apparatus.tap_frequency", "0 Hz"),
        ("direct-shear", "apparatus.normal_stress", "-1 kPa"),
        ("direct-shear", "apparatus.displacement", "40 mm"),
        ("direct-shear", "apparatus.shear_height", "60 mm"),
        ("poured-heap", "apparatus.disc", "10 mm"),
        ("penetration", "apparatus.speed", "10 mm/s"),
        ("penetration", "apparatus.depth", "50 mm"),
        ("penetration", "apparatus.probe_diameter", "40 mm"),
    ] {
        let found = refused(bench(name, &[(key, value)]));
        assert!(found.ends_with(key), "{name} with {key} = {value}: {found}");
    }
    for stresses in [
        r#"["5 kPa", "2 kPa"]"#,
        r#"["0 kPa", "2 kPa"]"#,
        r#"["2 kPa"]"#,
    ] {
        let found = refused(edited("compression", [FIXTURE_STRESSES, stresses], &[]));
        assert!(found.ends_with("apparatus.stresses"), "{stresses}: {found}");
    }
    let few = refused(bench("bulk-density", &[("seed.0.count", "300")]));
    assert!(few.ends_with("number of seeds"), "{few}");
    let mut poured = bench("poured-heap", &[]).expect("a scene");
    poured.protocol.insertion_rate = None;
    let Err(Error::BadValue { name, .. }) = poured.check() else {
        panic!("a heap poured at no rate");
    };
    assert!(name.ends_with("protocol.insertion_rate"), "{name}");
}

/// A piston that finds no seeds to carry its load: the run ends at the limit, says why, and keeps what there is.
#[test]
fn a_load_that_nothing_carries_ends_the_run_with_the_reason() {
    let changes = [
        ("seed.0.count", "20"),
        ("time_s", "0.05"),
        ("protocol.settle_limit", "0.1 s"),
    ];
    let result = run_of("compression", &changes);
    assert_eq!(result.ending, Ending::Rested(Some(Doubt::LoadNotCarried)));
    let strain = result.observables.iter().find(|o| o.name == "strain");
    assert!(strain.is_some_and(|strain| strain.values.is_empty()));
}
