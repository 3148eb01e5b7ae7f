//! Machines: what a file says by walls, phases and probes, held to a preset, to statics and to rules of the field.

use dev_support::fixture_files::fixture;
use scene::{Doubt, Ending, Error, FillingLibrary, Override, RunResult, Scene, run};
use std::path::Path;

/// Materials, contacts and times of all machines here.
const REST: &str = r#"
[material]
pea = { poisson_ratio = 0.3, shear_modulus = "5 MPa" }
steel = { poisson_ratio = 0.3, shear_modulus = "70 GPa" }

[contact]
pea-pea = { restitution = 0.4, static_friction = 0.4 }
pea-steel = { restitution = 0.4, static_friction = 0.2 }

[protocol]
settle_limit = "0.4 s"
rotation_limit = "0.4 s"
"#;

/// A bed of peas of 5 mm.
fn peas(count: usize) -> String {
    format!(
        "\n[[seed]]\nname = \"pea\"\nsphere = \"5 mm\"\ndensity = \"1250 kg/m3\"\ncount = {count}\nmaterial = \"pea\"\n"
    )
}

/// A scene of the settings of an apparatus and some peas.
fn scene(apparatus: &str, count: usize) -> Result<Scene, Error> {
    let text = format!("{apparatus}{}{REST}", peas(count));
    Scene::from_text(&text, "machine.toml", Path::new(""), &[])
}

/// A run of it.
fn run_of(apparatus: &str, count: usize) -> RunResult {
    let scene = scene(apparatus, count).expect("a scene");
    run(&scene, &FillingLibrary::default(), 1).expect("a run")
}

/// The values of an observable.
fn values(result: &RunResult, name: &str) -> Vec<f64> {
    let found = result.observables.iter().find(|o| o.name == name);
    found.expect(name).values.clone()
}

/// Planes of a cell of 31.25 mm, as the preset of an oedometer has them.
const CELL: &str = r#"
[apparatus]
kind = "machine"
room = [["0 mm", "0 mm", "-15.625 mm"], ["31.25 mm", "50 mm", "15.625 mm"]]
wall = [
  { name = "floor", material = "steel", shape.plane = { point = ["0 mm", "0 mm", "0 mm"], normal = [0, 1, 0] } },
  { name = "left end", material = "steel", shape.plane = { point = ["0 mm", "0 mm", "0 mm"], normal = [1, 0, 0] } },
  { name = "right end", material = "steel", shape.plane = { point = ["31.25 mm", "0 mm", "0 mm"], normal = [-1, 0, 0] } },
  { name = "front side", material = "steel", shape.plane = { point = ["0 mm", "0 mm", "15.625 mm"], normal = [0, 0, -1] } },
  { name = "back side", material = "steel", shape.plane = { point = ["0 mm", "0 mm", "-15.625 mm"], normal = [0, 0, 1] } },
  { name = "piston", material = "steel", shape.rectangle = { corner = ["0 mm", "50 mm", "-15.625 mm"], edges = [["31.25 mm", "0 mm", "0 mm"], ["0 mm", "0 mm", "31.25 mm"]] } },
]
"#;

/// An oedometer written as a machine is the preset to the last bit: the same walls, loads and steps.
#[test]
fn a_preset_written_by_hand_gives_the_same_bits() {
    let preset = r#"
[apparatus]
kind = "compression"
length = "31.25 mm"
width = "31.25 mm"
height = "50 mm"
stresses = ["2048 Pa", "8192 Pa"]
wall = "steel"
piston = "steel"
"#;
    // Force is stress times area, 2^11 Pa 2^-10 m2 and 2^13 Pa 2^-10 m2.
    let by_hand = format!(
        r#"{CELL}
phase = [
  {{ name = "load 0", load = [{{ wall = "piston", force_n = 2.0 }}], end.at-rest = "20 ms" }},
  {{ name = "load 1", load = [{{ wall = "piston", force_n = 8.0 }}], end.at-rest = "20 ms" }},
  {{ name = "unload", load = [{{ wall = "piston", force_n = 2.0 }}], end.at-rest = "20 ms" }},
]
probe = [
  {{ name = "first_mm", reads.displacement = {{ wall = "piston", along = [0, 1, 0] }}, phase = "load 0", value = "last" }},
  {{ name = "second_mm", reads.displacement = {{ wall = "piston", along = [0, 1, 0] }}, phase = "load 1", value = "last" }},
]
"#
    );
    let (preset, machine) = (run_of(preset, 150), run_of(&by_hand, 150));
    assert_eq!(machine.ending, Ending::Rested(None));
    let height = |name| 0.05 + 1e-3 * values(&machine, name)[0];
    let strain = 1.0 - height("second_mm") / height("first_mm");
    assert_eq!(values(&preset, "strain"), [strain]);
}

/// A pea in a groove at x = 20 mm presses with its weight, and turns the wall about the origin by x times the weight. The phase ends when
/// the seeds rest; a thousandth of the weight is left to the swing.
#[test]
fn a_torque_is_the_force_times_its_lever() {
    let groove = r#"
[apparatus]
kind = "machine"
room = [["15 mm", "1 mm", "-5 mm"], ["25 mm", "20 mm", "5 mm"]]
wall = [
  { name = "tray", material = "steel", shape.box = { corners = [["16 mm", "0 mm", "-4 mm"], ["24 mm", "30 mm", "4 mm"]], open = ["+y"] } },
]
phase = [{ name = "rest", end.after = "0.2 s" }]
probe = [
  { name = "force_n", reads.force = { walls = ["tray"], along = [0, -1, 0] }, from = 0.5 },
  { name = "torque_n_mm", reads.torque = { wall = "tray", along = [0, 0, -1] }, from = 0.5 },
]
"#;
    let result = run_of(groove, 1);
    let weight = std::f64::consts::PI / 6.0 * 0.005_f64.powi(3) * 1250.0 * 9.81;
    let force = values(&result, "force_n")[0];
    assert!(
        (force / weight - 1.0).abs() < 1e-3,
        "{force} N of {weight} N"
    );
    let place = 1e3 * result.frames[0].position[0].x;
    let lever = values(&result, "torque_n_mm")[0] / force;
    assert!(
        (lever / place - 1.0).abs() < 1e-3,
        "{lever} mm, the pea is at {place} mm"
    );
}

/// A wall that a phase moves comes as far as velocity times time and stays there in the next; one under a load that the bed carries does not
/// fall. What flows out is what is missing in the machine, and a phase ends with the fraction that it states.
#[test]
fn motions_end_with_their_phase_and_outlets_count() {
    let shaft = r#"
[apparatus]
kind = "machine"
room = [["-12 mm", "0 mm", "-12 mm"], ["12 mm", "60 mm", "12 mm"]]
view = [["-20 mm", "-30 mm", "-20 mm"], ["20 mm", "60 mm", "20 mm"]]
wall = [
  { name = "shaft", material = "steel", shape.box = { corners = [["-13 mm", "-20 mm", "-13 mm"], ["13 mm", "80 mm", "13 mm"]], open = ["+y", "-y"] } },
  { name = "gate", material = "steel", shape.rectangle = { corner = ["-13 mm", "0 mm", "-13 mm"], edges = [["26 mm", "0 mm", "0 mm"], ["0 mm", "0 mm", "26 mm"]] } },
]
phase = [
  { name = "lower", motion = [{ wall = "gate", velocity = ["0 m/s", "-0.1 m/s", "0 m/s"] }], end.after = "0.1 s" },
  { name = "wait", end.after = "0.05 s" },
  { name = "empty", remove = ["gate"], outlet = [{ point = ["0 mm", "-20 mm", "0 mm"] }], end.discharged = 0.5 },
]
probe = [
  { name = "way_mm", reads.displacement = { wall = "gate", along = [0, -1, 0] }, phase = "lower", value = "last" },
  { name = "stay_mm", reads.displacement = { wall = "gate", along = [0, -1, 0] }, phase = "wait", value = "last" },
  { name = "before_g", reads.mass = {}, phase = "wait", value = "last" },
  { name = "left_g", reads.mass = {}, value = "last" },
  { name = "out_g", reads.discharged = {} },
  { name = "flow_g_s", reads.mass-flow = {} },
]
"#;
    let result = run_of(shaft, 100);
    assert_eq!(result.ending, Ending::Rested(None));
    let value = |name| values(&result, name)[0];
    // A sample comes up to a step late, and a step is 0.1 ms at most.
    assert!(
        (value("way_mm") - 10.0).abs() < 0.02,
        "{} mm",
        value("way_mm")
    );
    assert!(
        (value("stay_mm") - value("way_mm")).abs() < 0.02,
        "{} mm",
        value("stay_mm")
    );
    let sum = value("left_g") + value("out_g");
    assert!((sum / value("before_g") - 1.0).abs() < 1e-12, "{sum} g");
    let fraction = value("out_g") / value("before_g");
    // One sample more than a half: at 1.5 g and 100 g/s no more than a tenth beyond.
    assert!((0.5..0.7).contains(&fraction), "{fraction}");
    assert!(value("flow_g_s") > 0.0);
}

/// An end that never comes ends the run at the limit, with the reason and with what was measured so far.
#[test]
fn a_force_that_is_never_reached_ends_the_run_with_the_reason() {
    let weak = format!(
        r#"{CELL}
phase = [{{ name = "press", motion = [{{ wall = "piston", velocity = ["0 m/s", "-0.01 m/s", "0 m/s"] }}], end.force = {{ wall = "piston", force_n = 100 }} }}]
probe = [{{ name = "way_mm", reads.displacement = {{ wall = "piston", along = [0, -1, 0] }}, value = "last" }}]
"#
    );
    let result = run_of(&weak, 20);
    assert_eq!(result.ending, Ending::Rested(Some(Doubt::ForceNotReached)));
    let way = values(&result, "way_mm")[0];
    assert!((way - 4.0).abs() < 0.05, "{way} mm in 0.4 s");
}

/// A paddle in a bed: with ten times the friction between peas, and of peas on the cup, which else turns under the whole bed, it is harder to
/// turn. One run each gives 0.9 and 2.7 N mm for 400 peas; half of that is asked for.
#[test]
fn friction_makes_a_paddle_hard_to_turn() {
    let torque = |friction: &str| {
        let of = |pair: &str| Override {
            name: format!("contact.{pair}.static_friction"),
            value: friction.into(),
        };
        let changes = ["pea-pea", "pea-steel"].map(of);
        let scene = Scene::read(&fixture("benches/machine.toml"), &changes).expect("a scene");
        let result = run(&scene, &FillingLibrary::default(), 1).expect("a run");
        values(&result, "paddle_torque_n_mm")[0]
    };
    let (smooth, rough) = (torque("0.05"), torque("0.5"));
    assert!(
        smooth > 0.0 && rough > 1.5 * smooth,
        "{smooth} and {rough} N mm"
    );
}

/// Parts of the text of a machine, what replaces them, and the end of the name that the refusal tells.
const WRONG: &[(&str, &str, &str)] = &[
    (
        "\"50 mm\", \"15.625 mm\"]]",
        "\"-1 mm\", \"15.625 mm\"]]",
        "apparatus.room",
    ),
    (
        "name = \"force_n\", reads.force = { walls = [\"piston\"]",
        "name = \"t_n_mm\", reads.torque = { wall = \"floor\"",
        "wall",
    ),
    (
        "name = \"force_n\", reads.force = { walls = [\"piston\"]",
        "name = \"d_mm\", reads.displacement = { wall = \"floor\"",
        "wall",
    ),
    (
        "end.after = \"0.1 s\"",
        "end.depth = { wall = \"floor\", depth = \"1 mm\" }",
        "end.depth.wall",
    ),
    (
        "[\"0 mm\", \"-10 mm\", \"0 mm\"]",
        "[\"0 mm\", \"60 mm\", \"0 mm\"]",
        "outlet.point",
    ),
    (
        "room = ",
        "sample_interval = \"3 ms\"\nroom = ",
        "apparatus.sample_interval",
    ),
    (
        "name = \"left end\"",
        "name = \"floor\"",
        "apparatus.wall.name",
    ),
    ("normal = [0, 1, 0]", "normal = [0, 0, 0]", "plane.normal"),
    (
        "[\"0 mm\", \"0 mm\", \"31.25 mm\"]]",
        "[\"9 mm\", \"0 mm\", \"0 mm\"]]",
        "rectangle.edges",
    ),
    (
        "name = \"press\"",
        "name = \"filling\"",
        "apparatus.phase.name",
    ),
    ("force_n = 5", "force_n = -5", "load.force_n"),
    (
        "force_n = 5",
        "force_n = 5, direction = [1, 0, 0]",
        "load.wall",
    ),
    (
        "force_n = 5",
        "force_n = 5, direction = [0, 0, 0]",
        "load.direction",
    ),
    (
        "load = [{ wall = \"piston\"",
        "load = [{ wall = \"floor\"",
        "wall",
    ),
    ("end.after = \"0.1 s\"", "end.after = \"0 s\"", "end.after"),
    (
        "end.after = \"0.1 s\"",
        "end.discharged = 0.0",
        "end.discharged",
    ),
    (
        "end.after = \"0.1 s\"",
        "end.force = { wall = \"lid\", force_n = 1 }",
        "name of a wall",
    ),
    ("load = [", "hold = [\"piston\"], load = [", "wall"),
    ("load = [", "remove = [\"piston\"], load = [", "wall"),
    (
        "name = \"force_n\"",
        "name = \"force\"",
        "apparatus.probe.name",
    ),
    (
        "walls = [\"piston\"]",
        "walls = [\"lid\"]",
        "name of a wall",
    ),
    (
        "along = [0, 1, 0] } }",
        "along = [0, 1, 0] }, phase = \"pull\" }",
        "phase",
    ),
    (
        "along = [0, 1, 0] } }",
        "along = [0, 1, 0] }, from = 0.8, to = 0.2 }",
        "from and to",
    ),
    ("along = [0, 1, 0] } }", "along = [0, 0, 0] } }", "along"),
];

/// What a machine cannot be or do is refused before a step, by the name of its setting.
#[test]
fn wrong_machines_are_refused_by_the_name_of_the_setting() {
    let right = format!(
        r#"{CELL}
phase = [{{ name = "press", load = [{{ wall = "piston", force_n = 5 }}], outlet = [{{ point = ["0 mm", "-10 mm", "0 mm"] }}], end.after = "0.1 s" }}]
probe = [{{ name = "force_n", reads.force = {{ walls = ["piston"], along = [0, 1, 0] }} }}]
"#
    );
    scene(&right, 20).expect("the machine without a change");
    for (from, to, told) in WRONG {
        assert!(right.contains(from), "{from}");
        let changed = right.replacen(from, to, 1);
        let Err(Error::BadValue { name, .. }) = scene(&changed, 20) else {
            panic!("{to} is accepted");
        };
        assert!(name.ends_with(told), "{to}: {name}");
    }
    // A word that no shape, reading or end has is told with those that there are.
    for (from, to, known) in [
        ("shape.plane", "shape.disk", "revolved"),
        ("reads.force", "reads.pressure", "displacement"),
        ("end.after", "end.never", "at-rest"),
    ] {
        let Err(Error::Text { message, .. }) = scene(&right.replacen(from, to, 1), 20) else {
            panic!("{to} is accepted");
        };
        assert!(message.contains(known), "{message}");
    }
}

/// Load on the floor of a column of beads of 3 mm in a tube of 18 mm, over their weight, while the floor sinks so that all walls hold back, and
/// height of the column over the diameter of the tube: means of three fillings.
fn column_on_a_sinking_floor(count: usize, wall_friction: f64) -> [f64; 2] {
    let text = format!(
        r#"
[apparatus]
kind = "machine"
room = [["-6 mm", "0 mm", "-6 mm"], ["6 mm", "500 mm", "6 mm"]]
wall = [
  {{ name = "floor", material = "acrylic", shape.revolved = {{ from = ["0 mm", "0 mm"], to = ["9 mm", "0 mm"] }} }},
  {{ name = "tube", material = "acrylic", shape.revolved = {{ from = ["9 mm", "-10 mm"], to = ["9 mm", "500 mm"] }} }},
]
phase = [{{ name = "sink", motion = [{{ wall = "floor", velocity = ["0 m/s", "-0.01 m/s", "0 m/s"] }}], end.after = "0.6 s" }}]
probe = [
  {{ name = "load_n", reads.force = {{ walls = ["floor"], along = [0, -1, 0] }}, from = 0.5 }},
  {{ name = "mass_g", reads.mass = {{}} }},
  {{ name = "centre_mm", reads.centre-height = {{}}, from = 0.5 }},
  {{ name = "sunk_mm", reads.displacement = {{ wall = "floor", along = [0, -1, 0] }}, from = 0.5 }},
]

[[seed]]
name = "bead"
sphere = "3 mm"
density = "2500 kg/m3"
count = {count}
material = "glass"

[material]
glass = {{ poisson_ratio = 0.22, shear_modulus = "5 MPa" }}
acrylic = {{ poisson_ratio = 0.35, shear_modulus = "5 MPa" }}

[contact]
glass-glass = {{ restitution = 0.5, static_friction = 0.3 }}
glass-acrylic = {{ restitution = 0.5, static_friction = {wall_friction} }}

[protocol]
settle_limit = "1 s"
rotation_limit = "1 s"
"#
    );
    let scene = Scene::from_text(&text, "column.toml", Path::new(""), &[]).expect("a scene");
    let of_filling = |seed: u64| {
        let result = run(&scene, &FillingLibrary::default(), seed).expect("a run");
        let value = |name| values(&result, name)[0];
        let weight = 1e-3 * value("mass_g") * 9.81;
        let height = 2.0 * (value("centre_mm") + value("sunk_mm"));
        [value("load_n") / weight, height / 18.0]
    };
    let all = [1, 2, 3].map(of_filling);
    [0, 1].map(|k| all.iter().map(|of| of[k]).sum::<f64>() / 3.0)
}

/// The product `x = 4 mu K h/D` at which Janssen's column carries a fraction `(1 - exp(-x))/x` of its weight on the floor `[Janssen1895]`.
fn janssen_product(fraction: f64) -> f64 {
    let (mut low, mut high) = (1e-6, 100.0);
    for _ in 0..100 {
        let x: f64 = 0.5 * (low + high);
        if (1.0 - (-x).exp()) / x > fraction {
            low = x;
        } else {
            high = x;
        }
    }
    low
}

/// Janssen's law with friction at its limit everywhere, which a floor that sinks makes: at three wall frictions the stress ratio K of a low column
/// is that of dense beads (Rankine's active 0.3 to 1), and with it a column twice as high has the load that the law says, to 15 %: the means
/// of three fillings, whose loads differ by a tenth as beads slip. Smooth walls carry nothing, to 2 %.
#[test]
#[ignore = "minutes; `trials/checks.sh benches`"]
fn a_column_on_a_sinking_floor_obeys_janssen() {
    let [all, _] = column_on_a_sinking_floor(300, 0.0);
    assert!((all - 1.0).abs() < 0.02, "smooth walls leave {all}");
    for friction in [0.15, 0.3, 0.6] {
        let [low, high] = [400, 800].map(|count| column_on_a_sinking_floor(count, friction));
        let x = janssen_product(low[0]);
        let ratio = x / (4.0 * friction * low[1]);
        let x = x * high[1] / low[1];
        let expected = (1.0 - (-x).exp()) / x;
        println!(
            "friction {friction}: {:.3} at h/D {:.2}, K {ratio:.2}; {:.3} at {:.2}, expected {expected:.3}",
            low[0], low[1], high[0], high[1]
        );
        assert!((0.3..1.0).contains(&ratio), "K = {ratio}");
        assert!(
            (high[0] / expected - 1.0).abs() < 0.15,
            "{} for {expected}",
            high[0]
        );
    }
}
