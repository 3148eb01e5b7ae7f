//! Bench tests as apparatus, held against closed forms.
#![expect(
    clippy::unwrap_used,
    clippy::panic,
    reason = "helpers of tests fail like tests"
)]

use dev_support::fixture_files::fixture;
use scene::{Error, FillingLibrary, Override, RunResult, Scene, run};

/// A ball on a bench: the lines of its apparatus, and the material of the plate's contact.
fn ball(apparatus: &str) -> Scene {
    let text = format!(
        r#"
        [apparatus]
        {apparatus}

        [[seed]]
        name = "ball"
        sphere = "6 mm"
        density = "1250 kg/m3"
        material = "pea"

        [material.pea]
        poisson_ratio = 0.3
        shear_modulus = "5 MPa"

        [material.steel]
        poisson_ratio = 0.3
        shear_modulus = "100 MPa"

        [contact.pea-steel]
        restitution = 0.6
        static_friction = 0.35
        rolling_friction = 0.1

        [contact.pea-pea]
        restitution = 0.4
        static_friction = 0.2

        [model]
        dashpot_mass = "body"
        normal_force_end = "attractive"
        "#
    );
    let folder = fixture("cotton");
    Scene::from_text(&text, "ball.toml", &folder, &[]).unwrap()
}

/// The cotton study's seeds with few spheres on a bench, an eighth as stiff: a third of the steps.
fn cotton(apparatus: &str) -> Scene {
    let file = fixture("cotton/drum.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    let from = text.find("[apparatus]").unwrap();
    let to = text.find("[[seed]]").unwrap();
    let text = format!("{}[apparatus]\n{apparatus}\n{}", &text[..from], &text[to..])
        .replace("start_slope", "# start_slope")
        .replace("4.01 MPa", "0.5 MPa")
        .replace(
            "0.45 mm\", sphere_count = 146",
            "0.8 mm\", sphere_count = 20",
        )
        .replace(
            "0.45 mm\", sphere_count = 127",
            "0.8 mm\", sphere_count = 16",
        );
    Scene::from_text(&text, "cotton.toml", file.parent().unwrap(), &[]).unwrap()
}

/// Values of an observable.
fn values(result: &RunResult, name: &str) -> Vec<f64> {
    let found = result.observables.iter().find(|f| f.name == name);
    found.unwrap_or_else(|| panic!("no {name}")).values.clone()
}

/// Runs a scene with a seed.
fn go(scene: &Scene, seed: u64) -> RunResult {
    run(scene, &FillingLibrary::default(), seed).unwrap()
}

/// With the dashpot of the whole body and a force that may pull, the rebound of one ball is the law's own
/// restitution; gravity during the contact and the finite step change it by less than 1 %.
#[test]
fn a_ball_comes_back_with_the_restitution_put_in() {
    let scene = ball("kind = \"drop\"\nplate = \"steel\"\nheight = \"200 mm\"\nrepeats = 3");
    let result = go(&scene, 1);
    let shown = values(&result, "shown_restitution");
    assert_eq!(shown.len(), 3);
    for e in shown {
        assert!((e / 0.6 - 1.0).abs() < 0.01, "{e}");
    }
    assert!(result.frames.is_empty() && result.series.is_empty());
    assert_eq!(result.regime, None);
    assert!(result.n_steps > 100);
}

/// Whole-seed damping of 1 lets the pull of the dashpot in: a ball comes back with the 0.6 put in, which the clipped end makes 0.632 by
/// the closed form of the clipped oscillator `[SchwagerPoschel2007]`. Steps of 1/45 of a contact err by less than 0.006. A seed of many
/// spheres, of which one hits, comes back less than half as fast as with the dashpots of its spheres, whose mass is a fiftieth of its own.
#[test]
fn whole_seed_damping_stops_the_seed() {
    let with = |scene: &Scene, share: f64, end: &str| {
        let set = |name: &str, value: String| Override {
            name: name.into(),
            value,
        };
        let changes = [
            set("model.dashpot_mass", "sphere".into()),
            set("model.normal_force_end", end.into()),
            set("model.whole_seed_damping", share.to_string()),
        ];
        let shown = values(&go(&scene.with(&changes).unwrap(), 1), "shown_restitution");
        shown.iter().sum::<f64>() / shown.len() as f64
    };
    let ball = ball("kind = \"drop\"\nplate = \"steel\"\nheight = \"200 mm\"\nrepeats = 2");
    let [own, half, whole] = [0.0, 0.5, 1.0].map(|share| with(&ball, share, "clipped"));
    assert!(
        (own - 0.632).abs() < 0.006 && (whole - 0.6).abs() < 0.006,
        "{own} {whole}"
    );
    assert!(half < own && half > whole, "{own} {half} {whole}");
    let seed = cotton("kind = \"drop\"\nplate = \"tough_resin\"\nheight = \"200 mm\"\nrepeats = 6");
    let [own, whole] = [0.0, 1.0].map(|share| with(&seed, share, "clipped"));
    assert!(whole < 0.5 * own && whole > 0.05, "{own} {whole}");
}

/// A ball that is thrown aside by the balls it falls on rolls away for ever, since nothing hinders its rolling: it never rests. How high
/// it came back is known all the same: less than the 0.4 of two balls that meet head on gives, and not nothing for all.
#[test]
fn a_seed_that_never_rests_has_a_rebound() {
    let scene = ball("kind = \"drop\"\nplate = \"pea\"\nheight = \"20 mm\"\nrepeats = 4");
    let shown = values(&go(&scene, 1), "shown_restitution");
    assert_eq!(shown.len(), 4);
    assert!(shown.iter().all(|e| (0.0..0.41).contains(e)), "{shown:?}");
    assert!(shown.iter().any(|e| *e > 0.01), "{shown:?}");
}

/// Balls on a smooth plate slide by Coulomb's law at each moment; 1e-4 is what the sled may still gain in speed up or down.
#[test]
fn a_sled_of_balls_shows_the_friction_put_in() {
    let scene = ball("kind = \"slider\"\nplate = \"steel\"\nrepeats = 2");
    for shown in values(&go(&scene, 1), "shown_static_friction") {
        assert!((shown / 0.35 - 1.0).abs() < 1e-4, "{shown}");
    }
}

/// Balls lie on plate and sled at random: each pull meets other bumps, so that a mean of pulls has an error. Bumps give back on
/// the way down what they took on the way up, but for what friction and collisions keep: the longer way along the slopes shows
/// a little more than the 0.2 put in, and without friction each pull shows nearly nothing. A damper that holds the sled adds
/// 0.008, a lattice into whose pits all nine balls fall at once 0.015. Means of 12 pulls stray by 0.0015. Where the height that
/// is won or lost on the short way counts, pulls differ by up to 0.13, and without friction show up to 0.09.
#[test]
fn pulls_of_balls_over_balls_differ_and_lose_nothing_to_the_tractor() {
    let balls = |friction: f64| {
        let mut scene = ball("kind = \"slider\"\nplate = \"pea\"\nrepeats = 12");
        let contact = scene.contact.get_mut("pea-pea").unwrap();
        contact.static_friction = input::quantity::FrictionCoefficient::new(friction).unwrap();
        // The way of a pull is three quarters of a ball.
        scene.seed[0].sphere = Some("8 mm".parse().unwrap());
        values(&go(&scene, 1), "shown_static_friction")
    };
    let mean = |shown: &[f64]| shown.iter().sum::<f64>() / 12.0;
    let shown = balls(0.2);
    assert!(mean(&shown) > 0.2 && mean(&shown) < 0.214, "{shown:?}");
    let least = shown.iter().copied().fold(f64::MAX, f64::min);
    let most = shown.iter().copied().fold(0.0, f64::max);
    assert!((0.003..0.03).contains(&(most - least)), "{shown:?}");
    let without = balls(0.0);
    assert!(without.iter().all(|f| f.abs() < 0.005), "{without:?}");
}

/// A ball starts to roll where its weight overcomes the rolling resistance, at the tangent that was put in. Type A lets it creep
/// until then, at 0.5 rad/s in the end, behind by `w 0.5 7/5 R / (g mu_r)`, 0.0004 at 0.05. Without friction, and with type C, it starts from rest: it has
/// gained that spin, `5/7 (g / R) w t² / 2` in a tilt by w t, 0.35 degrees later; a tenth is the room for the spring of type C.
#[test]
fn a_ball_starts_to_roll_at_its_rolling_friction() {
    let rate = 5_f64.to_radians();
    let later = rate * (2.0 * 0.5 * 7.0 / 5.0 * 3e-3 / 9.81 / rate).sqrt();
    for (law, rolling, later, room) in [
        ("constant-torque", 0.05, 0.0, 5e-4),
        ("constant-torque", 0.4, 0.0, 1e-4),
        ("constant-torque", 0.0, later, 0.1 * later),
        ("spring-dashpot", 0.05, later, 0.1 * later),
        ("spring-dashpot", 0.4, later, 0.1 * later),
    ] {
        let mut scene = ball("kind = \"tilt\"\nplate = \"steel\"\nrepeats = 2");
        let contact = scene.contact.get_mut("pea-steel").unwrap();
        contact.rolling_friction = input::quantity::FrictionCoefficient::new(rolling).unwrap();
        contact.static_friction = input::quantity::FrictionCoefficient::new(0.9).unwrap();
        let scene = scene.with(&[Override {
            name: "model.rolling_law".into(),
            value: law.into(),
        }]);
        let result = go(&scene.unwrap(), 1);
        let expected = (rolling.atan() + later).tan();
        for shown in values(&result, "shown_rolling_friction") {
            assert!(
                (shown - expected).abs() < room,
                "{law}: {shown}, {expected}"
            );
        }
        assert_eq!(values(&result, "slid_share"), [0.0, 0.0]);
    }
}

/// A ball that cannot roll slides where the tangent is its friction, by Coulomb's law. What it gains until it goes by 0.5 rad/s of its
/// radius takes `t = sqrt(2 v / (g w))`, 0.003 in the tangent.
#[test]
fn a_ball_that_cannot_roll_slides_at_its_friction() {
    let mut scene = ball("kind = \"tilt\"\nplate = \"steel\"\nrepeats = 2");
    let contact = scene.contact.get_mut("pea-steel").unwrap();
    contact.rolling_friction = input::quantity::FrictionCoefficient::new(1.5).unwrap();
    let result = go(&scene, 1);
    for shown in values(&result, "shown_rolling_friction") {
        assert!(shown > 0.349 && shown < 0.355, "{shown}");
    }
    assert_eq!(values(&result, "slid_share"), [1.0, 1.0]);
}

/// Without rolling friction a ball starts to roll at once on a smooth plate, but from a hollow of a plate of balls
/// of its own size only where its weight points past its supports: three that touch each other end that at
/// tan = 1 / (2 sqrt 2) = 0.35 towards the lowest pass, four in a square at 0.71, and the laid rows lie
/// between or, where they gape, above. A half of the least is the bound.
#[test]
fn a_plate_of_seeds_is_not_smooth() {
    let smooth = ball("kind = \"tilt\"\nplate = \"steel\"\nrepeats = 3");
    let smooth = {
        let mut scene = smooth;
        let contact = scene.contact.get_mut("pea-steel").unwrap();
        contact.rolling_friction = input::quantity::FrictionCoefficient::new(0.0).unwrap();
        values(&go(&scene, 1), "shown_rolling_friction")
    };
    let seeds = ball("kind = \"tilt\"\nplate = \"pea\"\nrepeats = 3");
    let seeds = values(&go(&seeds, 1), "shown_rolling_friction");
    assert!(smooth.iter().all(|t| *t < 0.05), "{smooth:?}");
    assert!(seeds.iter().all(|t| *t > 0.175 && *t < 6.0), "{seeds:?}");
}

/// Every test gives one value for each repeat, on a plate and on seeds, the same bits for the same seed and
/// others for another. Restitution lies between 0 and 1: a drop gains no energy.
#[test]
fn the_same_seed_gives_the_same_bits() {
    for plate in ["tough_resin", "seed"] {
        for (kind, name) in [
            ("drop\"\nheight = \"50 mm", "shown_restitution"),
            ("slider", "shown_static_friction"),
            ("tilt", "shown_rolling_friction"),
        ] {
            let scene = cotton(&format!(
                "kind = \"{kind}\"\nplate = \"{plate}\"\nrepeats = 2"
            ));
            let once = values(&go(&scene, 1), name);
            assert_eq!(once.len(), 2, "{kind} on {plate}");
            assert_eq!(once, values(&go(&scene, 1), name), "{kind} on {plate}");
            // A sled on a smooth plate shows the same whatever the turns of its seeds.
            if (kind, plate) != ("slider", "tough_resin") {
                assert_ne!(once, values(&go(&scene, 2), name), "{kind} on {plate}");
            }
            let most = if name == "shown_restitution" {
                1.0
            } else {
                6.0
            };
            assert!(once.iter().all(|v| (0.0..=most).contains(v)), "{once:?}");
        }
    }
}

/// A sled and a seed on a smooth plate that tilts hit nothing: the longest step that a scene may ask for shows what a tenth of it
/// shows. A thousandth is far less than repeats differ by, 0.01 to 0.1.
#[test]
fn pulls_and_tilts_do_not_hang_on_the_step() {
    for (kind, plate, name) in [
        ("slider", "seed", "shown_static_friction"),
        ("slider", "tough_resin", "shown_static_friction"),
        ("tilt", "tough_resin", "shown_rolling_friction"),
    ] {
        let shown = |share: f64| {
            let mut scene = cotton(&format!(
                "kind = \"{kind}\"\nplate = \"{plate}\"\nrepeats = 3"
            ));
            scene.protocol.step_share = share;
            values(&go(&scene, 1), name)
        };
        for (long, short) in shown(1.0).into_iter().zip(shown(0.1)) {
            assert!(
                (long - short).abs() < 1e-3,
                "{kind} on {plate}: {long}, {short}"
            );
        }
    }
}

/// A setting that a bench test lacks or cannot have is refused by its key, and no bed is required.
#[test]
fn wrong_bench_scenes_are_refused() {
    let scene = ball("kind = \"tilt\"\nplate = \"steel\"\nrepeats = 2");
    let told = |scene: &Scene, words: &[&str]| {
        let all: Vec<String> = scene.problems().iter().map(ToString::to_string).collect();
        let all = all.join("\n");
        for word in words {
            assert!(all.contains(word), "'{word}' is not in '{all}'");
        }
    };
    let mut wrong = scene.clone();
    let scene::Apparatus::Tilt(tilt) = &mut wrong.apparatus else {
        panic!("a tilt")
    };
    tilt.repeats = 1;
    tilt.seed = Some("bean".into());
    wrong.surroundings.air_drag = Some(1.0);
    told(
        &wrong,
        &[
            "ball.toml",
            "repeats is 1",
            "'bean'",
            "ball",
            "[surroundings]",
        ],
    );
    let mut wrong = scene.clone();
    wrong.contact.remove("pea-steel");
    told(&wrong, &["'pea-steel' is missing"]);
    let library = FillingLibrary::default();
    let refused = scene::starting_frame(&scene, &library, 1).unwrap_err();
    assert!(matches!(refused, Error::BadValue { .. }), "{refused}");
}
