//! How a drum starts: a bed that is laid at a slope before it turns, and the time steps of both phases.

use crate::limits::beads;
use dev_support::fixture_files::fixture;
use input::quantity::{Angle, Length, Time};
use scene::{FillingLibrary, LiquidSettings, Override, Scene, run, settled_world, starting_frame};
use std::path::Path;

/// A slice of the study's drum with coarse seeds, and further changes.
fn drum(changes: &[(&str, &str)]) -> Result<Scene, scene::Error> {
    let file = fixture("cotton/drum.toml");
    let slice = [
        ("apparatus.width", "12 mm"),
        ("seed.0.count", "180"),
        ("seed.1.count", "20"),
        ("seed.0.filling.sphere_radius", "0.8 mm"),
        ("seed.0.filling.sphere_count", "20"),
        ("seed.1.filling.sphere_radius", "0.8 mm"),
        ("seed.1.filling.sphere_count", "16"),
    ];
    let changes: Vec<Override> = slice
        .iter()
        .chain(changes)
        .map(|(name, value)| Override {
            name: (*name).into(),
            value: (*value).into(),
        })
        .collect();
    Scene::read(&file, &changes)
}

/// Direction of the centre of mass of the settled bed from straight down, deg.
fn direction(slope: &str, speed: &str) -> Result<f64, scene::Error> {
    let scene = drum(&[("protocol.start_slope", slope), ("apparatus.speed", speed)])?;
    let world = settled_world(&scene, &FillingLibrary::default(), 1)?;
    assert_eq!(
        world.settings().gravity.x,
        0.0,
        "gravity points down again when the drum starts"
    );
    let sum: nalgebra::Vector3<f64> = world.bodies().position.iter().sum();
    Ok(sum.x.atan2(-sum.y).to_degrees())
}

/// The bed lies across gravity as it was while it settled: towards the side that rises. Seeds that
/// fall at random leave the surface within a few degrees of level; with friction 0.10 it could not
/// stay as far off as the 20 degrees that are tested.
#[test]
fn bed_settles_across_the_turned_gravity_on_the_side_that_rises() {
    for (slope, speed, expected) in [
        ("0 deg", "10 rpm", 0.0),
        ("20 deg", "10 rpm", 20.0),
        ("20 deg", "-10 rpm", -20.0),
    ] {
        let found = direction(slope, speed).unwrap();
        assert!(
            (found - expected).abs() < 5.0,
            "{slope} at {speed}: {found:.1} deg"
        );
    }
}

#[test]
fn a_slope_that_no_bed_keeps_is_refused() {
    let error = drum(&[("protocol.start_slope", "60 deg")]).unwrap_err();
    let text = error.to_string();
    assert!(
        text.contains("start_slope") && text.contains("45 deg"),
        "{text}"
    );
}

/// The step is the share of a settling bed at first and that of the flow then, 0.36 and 0.42 of a hard contact in
/// the study's drum; without a share for the flow one step serves for both. Rounding only.
#[test]
fn the_flow_has_a_time_step_of_its_own() -> Result<(), scene::Error> {
    let library = FillingLibrary::default();
    let steps = |scene: &Scene| -> Result<[f64; 2], scene::Error> {
        let (_, _, settling) = starting_frame(scene, &library, 1)?;
        let flow = settled_world(scene, &library, 1)?.settings().time_step;
        Ok([settling, flow])
    };
    let mut scene = drum(&[("protocol.settle_limit", "0.02 s")])?;
    let [settling, flow] = steps(&scene)?;
    assert!(
        (flow / settling - 0.42 / 0.36).abs() < 1e-12,
        "{settling} {flow}"
    );
    scene.protocol.flow_step_share = None;
    assert_eq!(steps(&scene)?, [settling, settling]);
    Ok(())
}

/// Contacts that rub hard stick, and count shorter: by `1 - 0.5 (mu - 0.35)`, and by 0.7 at most. Rounding only.
#[test]
fn the_time_step_falls_with_the_friction() -> Result<(), scene::Error> {
    let library = FillingLibrary::default();
    let step = |friction: &str| -> Result<f64, scene::Error> {
        let scene = drum(&[("contact.seed-seed.static_friction", friction)])?;
        Ok(starting_frame(&scene, &library, 1)?.2)
    };
    let smooth = step("0.1")?;
    for (friction, share) in [("0.35", 1.0), ("0.55", 0.9), ("0.95", 0.7), ("2", 0.7)] {
        let got = step(friction)? / smooth;
        assert!((got - share).abs() < 1e-12, "{friction}: {got} for {share}");
    }
    Ok(())
}

/// Water changes no step; a liquid a thousand times as thick shortens it, twice the viscosity or half of the roughness by half,
/// and a fixed step that it does not stand is refused. Rounding only.
#[test]
fn the_time_step_stands_the_viscosity_of_the_liquid() -> Result<(), scene::Error> {
    let library = FillingLibrary::default();
    let wet = |viscosity: f64, roughness: f64| -> Result<Scene, scene::Error> {
        let mut scene = drum(&[])?;
        let mut liquid = LiquidSettings::new(0.01, 0.0727, Angle::from_si(0.0).unwrap());
        liquid.viscosity_pa_s = viscosity;
        liquid.roughness = Length::from_si(roughness).unwrap();
        scene.model.liquid = Some(liquid);
        Ok(scene)
    };
    let step = |scene: &Scene| Ok::<f64, scene::Error>(starting_frame(scene, &library, 1)?.2);
    let dry = step(&drum(&[])?)?;
    assert_eq!(step(&wet(0.001, 1e-5)?)?, dry, "water");
    let thick = step(&wet(1.0, 1e-5)?)?;
    assert!(thick < 0.5 * dry, "{thick} s, dry {dry} s");
    for half in [wet(2.0, 1e-5)?, wet(1.0, 0.5e-5)?] {
        let ratio = step(&half)? / thick;
        assert!((ratio - 0.5).abs() < 1e-12, "{ratio}");
    }
    let mut fixed = wet(1.0, 1e-5)?;
    fixed.protocol.time_step = Some(Time::from_si(2.0 * thick).unwrap());
    let error = starting_frame(&fixed, &library, 1).unwrap_err().to_string();
    assert!(error.contains("viscosity of model.liquid"), "{error}");
    Ok(())
}

/// Dashpots of whole bodies shorten the step of seeds of many spheres, the more of the damping is that of the whole, and not less if the
/// spheres do not share the mass; beads damp with their own mass in any case, and keep their step to the last bit.
#[test]
fn the_time_step_stands_dashpots_of_whole_bodies() -> Result<(), scene::Error> {
    const MASS: &str = "model.dashpot_mass";
    let library = FillingLibrary::default();
    let step = |scene: &Scene| Ok::<f64, scene::Error>(starting_frame(scene, &library, 1)?.2);
    let own = step(&drum(&[])?)?;
    let shared = step(&drum(&[(MASS, "shared")])?)?;
    let body = step(&drum(&[(MASS, "body")])?)?;
    assert!(
        body <= shared && shared < 0.6 * own,
        "{body} {shared} {own}"
    );
    let [half, whole] =
        ["0.5", "1"].map(|share| step(&drum(&[("model.whole_seed_damping", share)])?));
    let (half, whole) = (half?, whole?);
    assert_eq!(whole, shared);
    assert!(half > 1.2 * whole && half < own, "{half} {whole} {own}");
    let of_beads = step(&beads(MASS, "sphere")?)?;
    for mass in ["shared", "body"] {
        assert_eq!(step(&beads(MASS, mass)?)?, of_beads, "{mass}");
    }
    Ok(())
}

/// The bed at rest limits the step of strongly damped seeds: six of twelve contacts damp at their most, `z = 6 b sqrt(5/6 7/4 / 12)`, and a
/// spring beside z allows `sqrt(1 + z²) - z` of its step. Rounding only.
#[test]
fn the_time_step_of_a_damped_bed_follows_its_damping_ratio() -> Result<(), scene::Error> {
    let library = FillingLibrary::default();
    let step = |restitution: &str| {
        let scene = drum(&[
            ("model.whole_seed_damping", "1"),
            ("contact.seed-seed.restitution", restitution),
        ])?;
        Ok::<f64, scene::Error>(starting_frame(&scene, &library, 1)?.2)
    };
    let allowed = |restitution: f64| {
        let log = restitution.ln();
        let b = -log / log.hypot(std::f64::consts::PI);
        let z = 6.0 * b * (5.0 / 6.0 * 7.0 / 4.0 / 12.0_f64).sqrt();
        z.hypot(1.0) - z
    };
    let ratio = step("0.001")? / step("0.01")?;
    let expected = allowed(0.001) / allowed(0.01);
    assert!((ratio / expected - 1.0).abs() < 1e-9, "{ratio} {expected}");
    Ok(())
}

/// In a drum of 0.8 m seeds meet with 2.19 m/s: a step is shorter by the power 1/5 of that or by more, since more spheres touch deeper
/// down. In a drum of 0.1 m it is that of the study's to the last bit.
#[test]
fn the_time_step_falls_with_the_speed_of_meetings() -> Result<(), scene::Error> {
    let library = FillingLibrary::default();
    let step = |diameter: &str| {
        let scene = drum(&[("apparatus.inner_diameter", diameter)])?;
        Ok::<f64, scene::Error>(starting_frame(&scene, &library, 1)?.2)
    };
    let small = step("140 mm")?;
    assert_eq!(step("100 mm")?, small);
    let ratio = step("800 mm")? / small;
    let alone = 2.19_f64.powf(-0.2);
    assert!(
        ratio < 1.0001 * alone && ratio > 0.8 * alone,
        "{ratio} {alone}"
    );
    Ok(())
}

/// A heap of sticky peas, 4 mm, 42 mg, with changes.
fn peas(changes: &[(&str, &str)]) -> Result<Scene, scene::Error> {
    let text = r#"
        [apparatus]
        kind = "heap"
        inner_diameter = "40 mm"
        height = "80 mm"
        lift_speed = "50 mm/s"
        floor = "wall"
        cylinder = "wall"
        [[seed]]
        name = "pea"
        sphere = "4 mm"
        density = "1250 kg/m3"
        count = 216
        material = "pea"
        [material]
        pea = { poisson_ratio = 0.3, shear_modulus = "2 MPa" }
        wall = { poisson_ratio = 0.3, shear_modulus = "1 GPa" }
        [contact]
        pea-pea = { restitution = 0.3, static_friction = 0.6, rolling_friction = 0.3, attraction_n = 0.002 }
        pea-wall = { restitution = 0.3, static_friction = 0.2, rolling_friction = 0.1 }
    "#;
    let set = |(name, value): &(&str, &str)| Override {
        name: (*name).to_owned(),
        value: (*value).to_owned(),
    };
    let changes: Vec<Override> = changes.iter().map(set).collect();
    Scene::from_text(text, "peas.toml", Path::new("."), &changes)
}

/// The torques of type A that the attraction gives at twelve contacts turn a pea in one step by 0.0025 of `sqrt(P r / I)`: with an
/// attraction F, six weights of 216 peas on each other and the half radius as arm
/// `12 0.3 F r/2 dt / I = 0.0025 sqrt((6 m g + F) r / I)`. Rounding only. The other law of rolling and peas without rolling friction
/// keep the step of hard contacts, to the last bit for weak attractions; what the attraction is made of does not matter.
#[test]
fn the_time_step_stands_rolling_friction_under_attraction() -> Result<(), scene::Error> {
    const ATTRACTION: &str = "contact.pea-pea.attraction_n";
    let library = FillingLibrary::default();
    let step = |changes: &[(&str, &str)]| {
        let scene = peas(changes)?;
        Ok::<f64, scene::Error>(starting_frame(&scene, &library, 1)?.2)
    };
    let dry = step(&[(ATTRACTION, "0")])?;
    let radius: f64 = 2e-3;
    let mass = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3) * 1250.0;
    let inertia = 0.4 * mass * radius * radius;
    for (text, attraction) in [("0.002", 0.002), ("0.05", 0.05)] {
        let got = step(&[(ATTRACTION, text)])?;
        let load = 6.0 * mass * 9.81 + attraction;
        let spin = 0.0025 * (load * radius / inertia).sqrt();
        let expected = spin * inertia / (12.0 * 0.3 * attraction * 0.5 * radius);
        assert!((got / expected - 1.0).abs() < 1e-9, "{got} s, {expected} s");
        assert!(got < 0.4 * dry, "{got} s, dry {dry} s");
    }
    let weak = [(ATTRACTION, "0.0002")];
    for change in [
        ("model.rolling_law", "spring-dashpot"),
        ("contact.pea-pea.rolling_friction", "0"),
    ] {
        let without = step(&[(ATTRACTION, "0"), change])?;
        assert_eq!(step(&[weak[0], change])?, without, "{change:?}");
    }
    // As many newtons by the Bond number, which pulls at the wall too, where the whole radius is the arm and 0.1 the friction.
    let bond = (0.002 / (mass * 9.81)).to_string();
    let by_bond = step(&[(ATTRACTION, "0"), ("model.bond_number", &bond)])?;
    assert!((by_bond / step(&[])? - 1.0).abs() < 1e-9, "{by_bond} s");
    let mut wet = peas(&[(ATTRACTION, "0")])?;
    wet.model.liquid = Some(LiquidSettings::new(
        0.01,
        0.07,
        Angle::from_si(0.0).unwrap(),
    ));
    let wet = starting_frame(&wet, &library, 1)?.2;
    // 2 pi r g 10/11 = 0.8 mN between peas, which counts 0.3/2, and twice that at a wall, which counts 0.1: the wall decides.
    let attraction = 4.0 * std::f64::consts::PI * radius * 0.07 / 1.1;
    let load = 6.0 * mass * 9.81 + attraction;
    let spin = 0.0025 * (load * radius / inertia).sqrt();
    let expected = spin * inertia / (12.0 * 0.1 * attraction * radius);
    assert!((wet / expected - 1.0).abs() < 1e-9, "{wet} s, {expected} s");
    Ok(())
}

/// Springs of contacts at rest carry the attraction too: peas of 2 kPa that pull at each other by 4 mN, and do not roll, take the step
/// of `2 / w` with the load `6 m g + F`, whose stiffness grows by its power 1/3. An attraction that presses them flat is refused, with the
/// modulus that bears it.
#[test]
fn the_time_step_stands_springs_under_attraction() -> Result<(), scene::Error> {
    let library = FillingLibrary::default();
    let soft = [
        ("material.pea.shear_modulus", "2 kPa"),
        ("contact.pea-pea.static_friction", "0.1"),
        ("contact.pea-pea.rolling_friction", "0"),
        ("contact.pea-wall.rolling_friction", "0"),
    ];
    let step = |attraction: &'static str| {
        let scene = peas(&[&soft[..], &[("contact.pea-pea.attraction_n", attraction)]].concat())?;
        Ok::<f64, scene::Error>(starting_frame(&scene, &library, 1)?.2)
    };
    let weight = 6.0 * 4.0 / 3.0 * std::f64::consts::PI * 8e-9 * 1250.0 * 9.81;
    let ratio = step("0.004")? / step("0")?;
    let expected = ((weight + 0.004) / weight).powf(-1.0 / 6.0);
    assert!((ratio / expected - 1.0).abs() < 1e-9, "{ratio} {expected}");
    let error = step("1").unwrap_err().to_string();
    assert!(error.contains("and the attraction would press"), "{error}");
    let modulus = error
        .split("at least ")
        .nth(1)
        .and_then(|rest| rest.split(' ').next());
    let modulus: f64 = modulus.and_then(|m| m.parse().ok()).expect("a modulus");
    let bears = format!("{} Pa", 1.1 * modulus);
    let mut changes = soft.to_vec();
    changes[0].1 = &bears;
    changes.push(("contact.pea-pea.attraction_n", "1"));
    assert!(
        starting_frame(&peas(&changes)?, &library, 1).is_ok(),
        "{bears}"
    );
    Ok(())
}

/// A bed that is driven ever faster is not steady, however little it rises: what is kept begins 1.5 swings behind the ramp, and
/// a run is expected to last as much longer.
#[test]
fn nothing_is_kept_of_a_ramp() -> Result<(), scene::Error> {
    let scene = beads("protocol.rotation_limit", "6 s")?;
    let set = |name: &str, value: &str| Override {
        name: name.into(),
        value: value.into(),
    };
    let ramped = scene.with(&[set("ramp", "2 s")])?;
    let longer = ramped.expected_rotation() - scene.expected_rotation();
    assert!((longer - 2.0).abs() < 1e-12, "{longer}");
    let kept_from = |scene: &Scene| -> Result<f64, scene::Error> {
        let result = run(scene, &FillingLibrary::default(), 1)?;
        // The bed is looked at every 20 ms.
        Ok(0.02 * result.ending.cut() as f64)
    };
    let (at_once, behind) = (kept_from(&scene)?, kept_from(&ramped)?);
    assert!(at_once < 2.0 && behind > 2.2, "{at_once} s, {behind} s");
    Ok(())
}

/// A setting that the file omits can be set, be it a number, a switch or a quantity; only a drum has covers.
#[test]
fn settings_that_a_file_leaves_out_can_be_set() -> Result<(), scene::Error> {
    let file = fixture("cotton");
    let set = |name: &str, value: &str| Override {
        name: name.into(),
        value: value.into(),
    };
    let changes = [
        set("protocol.flow_step_share", "0.2"),
        set("apparatus.covers_at_rest", "true"),
        set("ramp", "0.5 s"),
    ];
    let scene = Scene::read(&file.join("measured.toml"), &changes)?;
    assert_eq!(scene.protocol.flow_step_share, Some(0.2));
    let scene::Apparatus::Drum(drum) = &scene.apparatus else {
        panic!("a drum")
    };
    assert!(drum.covers_at_rest, "the switch is set");
    assert_eq!(drum.ramp.map(Time::si), Some(0.5));
    let other = Scene::read(&file.join("heap.toml"), &changes[1..]);
    assert!(other.is_err(), "a heap has no covers");
    Ok(())
}
