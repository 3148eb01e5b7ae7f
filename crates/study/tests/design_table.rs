//! Design tables: what they ask for, everything that they refuse before any run, and the table of results.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use campaign::{Campaign, RunOutcome, RunRequest, Silent, Simulator, SimulatorError};
use experiment_design::table::{Table, design_to_csv, factors_to_csv};
use experiment_design::{Factor, box_behnken};
use run_store::{Observation, Record, Store};
use scene::{Override, Scene};
use std::fs;
use std::sync::atomic::AtomicBool;
use study::{DesignChoices, DesignTable, Error};
use tempfile::TempDir;

/// A drum with peas. Beans touch the spare wall only.
const DRUM: &str = r#"
seed = [{ name = "pea", sphere = "6 mm", density = "1300 kg/m3", count = 100, material = "pea" }]

[apparatus]
kind = "drum"
inner_diameter = "100 mm"
width = "20 mm"
speed = "15 rpm"
shell = "wall"
cover = "wall"

[material]
pea = { poisson_ratio = 0.3, shear_modulus = "5 MPa" }
bean = { poisson_ratio = 0.3, shear_modulus = "5 MPa" }
wall = { poisson_ratio = 0.3, shear_modulus = "1 GPa" }
spare = { poisson_ratio = 0.3, shear_modulus = "1 GPa" }

[contact]
pea-pea = { restitution = 0.5, static_friction = 0.35 }
pea-wall = { restitution = 0.5, static_friction = 0.3 }
pea-spare = { restitution = 0.5, static_friction = 0.3 }
bean-bean = { restitution = 0.5, static_friction = 0.3 }
bean-spare = { restitution = 0.5, static_friction = 0.3 }
"#;

/// Path of the friction of peas.
const FRICTION: &str = "contact.pea-pea.static_friction";

/// A folder with the scene and a table.
struct Folder {
    /// Where they are; removed at the end.
    folder: TempDir,
    /// What the table is read with.
    choices: DesignChoices,
}

impl Folder {
    /// Writes both; the first seed is 11.
    fn new(table: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("drum.toml"), DRUM).unwrap();
        fs::write(path("design.csv"), table).unwrap();
        let choices = DesignChoices {
            design: path("design.csv"),
            scene: path("drum.toml"),
            seed: 11,
            ..DesignChoices::default()
        };
        Self { folder, choices }
    }

    /// Says which settings a column sets.
    fn bind(mut self, text: &str) -> Self {
        self.choices.bind.push(text.to_owned());
        self
    }

    /// Keeps a column unused.
    fn keep(mut self, column: &str) -> Self {
        self.choices.keep.push(column.to_owned());
        self
    }

    /// Writes the factors.
    fn factors(mut self, factors: &[Factor]) -> Self {
        let file = self.folder.path().join("factors.csv");
        fs::write(&file, factors_to_csv(factors)).unwrap();
        self.choices.factors = Some(file);
        self
    }

    /// Reads the table.
    fn read(&self) -> Result<DesignTable, Error> {
        DesignTable::read(&self.choices)
    }

    /// The scenes of a table that is right, in the order of its runs.
    fn scenes(&self) -> Vec<Scene> {
        let table = self.read().unwrap();
        let simulator = table.simulator().unwrap();
        let requests = table.requests();
        let scenes = requests.iter().map(|request| simulator.scene_of(request));
        scenes.collect::<Result<_, _>>().unwrap()
    }

    /// The scene of the folder with one setting changed.
    fn scene_with(&self, name: &str, value: &str) -> Scene {
        let (name, value) = (name.to_owned(), value.to_owned());
        Scene::read(&self.choices.scene, &[Override { name, value }]).unwrap()
    }

    /// Everything that is wrong with the table, a line each.
    fn problems(&self) -> String {
        match self.read() {
            Err(Error::Problems { list }) => {
                let lines: Vec<String> = list.iter().map(ToString::to_string).collect();
                lines.join("\n")
            }
            other => panic!("{other:?} is no list of problems"),
        }
    }
}

/// Friction, restitution and speed with their ranges.
fn factors() -> Vec<Factor> {
    vec![
        Factor::new("F", "friction", "1", 0.2, 0.5).unwrap(),
        Factor::new("E", "restitution", "1", 0.3, 0.7).unwrap(),
        Factor::new("W", "speed", "rpm", 10.0, 30.0).unwrap(),
    ]
}

/// A Box-Behnken design of them: 12 runs and 2 of the centre.
fn design() -> String {
    design_to_csv(&box_behnken(&factors(), 2).unwrap())
}

/// The design bound to its settings.
fn bound(table: &str) -> Folder {
    let folder = Folder::new(table).factors(&factors());
    let restitution = "E=contact.pea-pea.restitution,contact.pea-wall.restitution";
    let folder = folder.bind(&format!("F={FRICTION}")).bind(restitution);
    folder.bind("W=apparatus.speed")
}

/// The natural values of a design arrive at the settings, the same at both contacts, to the last bit.
#[test]
fn a_design_sets_what_its_factors_are_bound_to() {
    let folder = bound(&design());
    let scenes = folder.scenes();
    assert_eq!(scenes.len(), 14);
    // The first run of the design has both frictions at their low levels and the speed in the middle.
    assert_eq!(scenes[0].number(FRICTION), Some(0.2));
    for contact in ["pea-pea", "pea-wall"] {
        let path = format!("contact.{contact}.restitution");
        assert_eq!(scenes[0].number(&path), Some(0.3));
    }
    let speed = folder.scene_with("rpm", "20").apparatus;
    assert_eq!(scenes[0].apparatus, speed);
}

/// Coded values alone give what the natural ones beside them give, to the rounding of a table (1e-14 of the value).
#[test]
fn coded_values_count_where_the_natural_ones_are_missing() {
    let all = design();
    let cut = |line: &str| line.split(',').take(7).collect::<Vec<_>>().join(",") + "\n";
    let coded: String = all.lines().map(cut).collect();
    assert!(coded.starts_with("run,cell,replicate,block,F,E,W\n"));
    let (all, coded) = (bound(&all).read().unwrap(), bound(&coded));
    for (a, b) in all.requests().iter().zip(coded.read().unwrap().requests()) {
        assert_eq!(a.seed, b.seed);
        for (name, value) in &a.parameters {
            let other = b.parameters[name];
            assert!(
                (value / other - 1.0).abs() < 1e-14,
                "{name}: {value} {other}"
            );
        }
    }
    let mut blind = coded;
    blind.choices.factors = None;
    assert!(
        blind
            .problems()
            .contains("may hold coded or natural values")
    );
}

#[test]
fn columns_are_settings_by_path_short_name_and_unit() {
    let table = format!(
        "rpm,{FRICTION},camera.roll [deg],protocol.rotation_limit,protocol.frames\n20,0.4,3,0.5 s,7\n20,0.4,3,0.1 min,7\n"
    );
    let folder = Folder::new(&table);
    let scenes = folder.scenes();
    assert_eq!(
        scenes[0].apparatus,
        folder.scene_with("rpm", "20").apparatus
    );
    assert_eq!(scenes[0].number(FRICTION), Some(0.4));
    assert_eq!(
        scenes[0].camera,
        folder.scene_with("camera.roll", "3 deg").camera
    );
    assert_eq!(scenes[0].protocol.frames, 7);
    let limits: Vec<f64> = scenes
        .iter()
        .map(|s| s.protocol.rotation_limit.si())
        .collect();
    assert_eq!(limits, [0.5, 6.0]);
}

/// Two laws at two walls: four scenes for six rows, and numbers go with each.
#[test]
fn words_become_scenes_of_their_own_one_for_each_combination() {
    let row = |law: &str, wall: &str| format!("{law},{wall},{wall},0.4\n");
    let mut table = format!("model.rolling_law,wall,apparatus.cover,{FRICTION}\n");
    for law in ["constant-torque", "spring-dashpot"] {
        table += &(row(law, "wall") + &row(law, "spare") + &row(law, "wall"));
    }
    let folder = Folder::new(&table).bind("wall=apparatus.shell");
    let read = folder.read().unwrap();
    let requests = read.requests();
    let mut models: Vec<&str> = requests.iter().map(|r| r.model.as_str()).collect();
    models.sort_unstable();
    models.dedup();
    assert_eq!(models.len(), 4, "{models:?}");
    let scenes = folder.scenes();
    let spare = folder.scene_with("apparatus.shell", "spare");
    let scene::Apparatus::Drum(drum) = &scenes[1].apparatus else {
        panic!("a drum");
    };
    assert_eq!(
        (drum.shell.as_str(), drum.cover.as_str()),
        ("spare", "spare")
    );
    assert_ne!(scenes[1].model, scenes[4].model);
    assert_eq!(scenes[4].model.bond_number, spare.model.bond_number);
    assert_eq!(scenes[4].number(FRICTION), Some(0.4));
}

/// No row may fail for what one of its cells does alone: beans touch no wall but the spare one.
#[test]
fn values_that_hold_only_together_are_taken() {
    let table =
        "seed.0.material,apparatus.shell,apparatus.cover\nbean,spare,spare\npea,wall,wall\n";
    assert_eq!(Folder::new(table).scenes().len(), 2);
    let apart = "seed.0.material,apparatus.shell,apparatus.cover\npea,wall,wall\nbean,spare,wall\n";
    let problems = Folder::new(apart).problems();
    assert!(
        problems.contains("line 3") && problems.contains("bean-wall"),
        "{problems}"
    );
}

/// Without a column `seed` all runs differ in theirs, row by row; with one, the repeats of a row take those that follow.
#[test]
fn seeds_and_repeats_follow_the_table() {
    let seeds = |table: &str| -> Vec<(usize, usize, u64)> {
        let read = Folder::new(table).read().unwrap();
        let runs = read.runs().iter();
        runs.map(|run| (run.line, run.repeat, run.request.seed))
            .collect()
    };
    assert_eq!(
        seeds("# two rows\nrpm,replicates\n20,1\n30,2\n"),
        [(3, 1, 11), (4, 1, 12), (4, 2, 13)]
    );
    assert_eq!(
        seeds("rpm,seed,replicates\n20,5,2\n30,5,1\n"),
        [(2, 1, 5), (2, 2, 6), (3, 1, 5)]
    );
    let mut folder = Folder::new("rpm\n20\n30\n");
    folder.choices.replicates = Some(3);
    assert_eq!(folder.read().unwrap().runs().len(), 6);
}

/// Every row of this list: a table, what is said besides, and what the answer must say.
#[test]
fn what_cannot_be_meant_is_told_with_its_place_and_the_way_out() {
    let one = |table: &str| Folder::new(table);
    let cases: Vec<(Folder, &[&str])> = vec![
        (
            one("frction\n0.3\n"),
            &["line 1", "'frction'", "static_friction", "--bind", "--keep"],
        ),
        (
            one("F,F_natural\n0,0.3\n"),
            &["'F_natural'", "--bind F=PATH"],
        ),
        (
            one("static_friction\n0.3\n"),
            &["'static_friction'", "may mean", FRICTION],
        ),
        (
            one("rpm\n20\nx\n"),
            &["line 3", "'rpm'", "'x'", "finite number"],
        ),
        (one("rpm\ninf\n"), &["line 2", "'inf'", "finite number"]),
        (
            one("rpm,protocol.frames\n20,\n"),
            &["line 2", "'protocol.frames'", "empty"],
        ),
        (
            one("protocol.frames\n2.5\n"),
            &["line 2", "'2.5'", "whole number"],
        ),
        (
            one("apparatus.speed\n20\n"),
            &["'apparatus.speed'", "[rad/s]"],
        ),
        (
            one("apparatus.speed\n20 rpm\n30\n"),
            &["line 3", "'30'", "no unit"],
        ),
        (
            one("apparatus.speed [mm]\n20\n"),
            &["'apparatus.speed'", "'mm'"],
        ),
        (
            one("apparatus.speed\n20 mm\n"),
            &["line 2", "'20 mm'", "rpm"],
        ),
        (
            one("camera.pixels [mm]\n480\n"),
            &["'camera.pixels'", "leave out", "'mm'"],
        ),
        (
            one("model.rolling_law\nnone\n"),
            &["line 2", "'none'", "constant-torque"],
        ),
        (
            one("rpm,apparatus.speed [rpm]\n20,20\n"),
            &["'apparatus.speed'", "'rpm'", "as well"],
        ),
        (one("rpm,rpm\n20,20\n"), &["'rpm'", "twice"]),
        (one("rpm,\n20,1\n"), &["number 2", "no name"]),
        (one("rpm,angle_deg\n20,1\n"), &["'angle_deg'", "results"]),
        (
            one("rpm,replicates\n20,0\n"),
            &["'replicates'", "'0'", "whole number"],
        ),
        (one("rpm,replicates\n20,1000001\n"), &["line 2", "1000000"]),
        (
            one("rpm,seed\n20,1.5\n"),
            &["'seed'", "'1.5'", "whole number"],
        ),
        (
            one("rpm,seed\n20,18446744073709551615\n").replicates(2),
            &["2^64"],
        ),
        (
            one("rpm,seed\n20,1\n20,1\n"),
            &["line 3", "line 2", "another seed"],
        ),
        (
            one("rpm,seed,replicates\n20,1,2\n20,2,1\n"),
            &["line 3", "line 2", "seed 2"],
        ),
        (
            one("rpm,replicates\n20,1\n").replicates(2),
            &["--replicates", "leave out"],
        ),
        (
            one("rpm\n20\n").replicates(0),
            &["--replicates", "1 or more"],
        ),
        (one("rpm\n20\n").keep("note"), &["'note'", "--keep", "rpm"]),
        (one("rpm\n20\n").bind("Q=rpm"), &["'Q'", "--bind", "rpm"]),
        (one("Q\n20\n").bind("Q=rpn"), &["'Q'", "'rpn'", "rpm"]),
        (
            one("Q\n20\n").bind("Q=rpm,camera.pixels"),
            &["'Q'", "same kind"],
        ),
        (one("Q\n20\n").bind("Q"), &["--bind", "COLUMN=PATH"]),
        (one("rpm\n20\n").set("rpm=3"), &["'rpm'", "--set"]),
        (one("rpm\n20\n").set("frames"), &["--set", "NAME=VALUE"]),
        (one("rpm,E\n20\n"), &["line 2 has 1 fields"]),
        (
            bound("F,E,W,F_natural\n0,0,0,0.4\n"),
            &["line 2", "'F'", "0.35", "0.4"],
        ),
        (bound("F,E,W\nx,0,0\n"), &["line 2", "'F'", "'x'"]),
    ];
    for (folder, parts) in cases {
        let problems = folder.problems();
        for part in parts {
            assert!(problems.contains(part), "'{part}' is not in: {problems}");
        }
    }
}

/// One table with a mistake in each part: all of them are told, each once.
#[test]
fn all_mistakes_are_told_at_once() {
    let table =
        format!("frction,{FRICTION},rpm,replicates\n1,-0.1,20,1\n1,0.1,x,1\n1,0.1,20,1.5\n");
    let problems = Folder::new(&table).problems();
    let lines: Vec<&str> = problems.lines().collect();
    assert_eq!(lines.len(), 4, "{problems}");
    for (line, place) in lines.iter().zip(["line 1", "line 2", "line 3", "line 4"]) {
        assert!(
            line.contains("design.csv") && line.contains(place),
            "{problems}"
        );
    }
    let kept = Folder::new("frction,rpm\n1,20\n").keep("frction");
    kept.read().unwrap();
}

/// Seeds that have no room are found by building, which costs no run.
#[test]
fn a_row_without_room_is_told_before_any_run() {
    let table = Folder::new("seed.0.count\n100\n100000\n").read().unwrap();
    let simulator = table.simulator().unwrap();
    let error = table
        .check_builds(&simulator, None)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("line 3") && error.contains("do not fit"),
        "{error}"
    );
}

/// Another process that knows the choices alone asks for runs of the same keys.
#[test]
fn the_runs_follow_from_the_choices_alone() {
    let folder = bound(&design());
    let text = serde_json::to_string(&folder.choices).unwrap();
    let choices: DesignChoices = serde_json::from_str(&text).unwrap();
    let keys = |choices: &DesignChoices| -> Vec<String> {
        let table = DesignTable::read(choices).unwrap();
        let simulator = table.simulator().unwrap();
        let key = |request: &RunRequest| {
            let inputs = simulator.inputs(request).unwrap();
            let blank = Record::new(&simulator.version(), inputs, request.seed).unwrap();
            blank.key().to_owned()
        };
        table.requests().iter().map(key).collect()
    };
    assert_eq!(keys(&choices), keys(&folder.choices));
}

/// Gives the friction as an angle, and nothing for 0.3.
struct Toy;

impl Simulator for Toy {
    fn version(&self) -> String {
        "toy".into()
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        let mean = request.parameter(FRICTION)?;
        if mean == 0.3 {
            let reason = "no \"surface\",\nnone at all".to_owned();
            return Err(SimulatorError::Failed { reason });
        }
        let unit = "deg".to_owned();
        let angle = Observation {
            mean,
            sd: None,
            n: 1,
            unit,
        };
        Ok(RunOutcome::default().with_observable("angle_deg", angle))
    }
}

/// The table of results has all columns and runs of the design in its order; a run that fails leaves its cells empty
/// and says why.
#[test]
fn a_run_that_fails_costs_its_own_row() {
    let table = format!("run,{FRICTION},note,replicates\n1,0.4,\"a, b\",1\n2,0.3,c,1\n3,0.1,d,2\n");
    let table = Folder::new(&table).keep("note").read().unwrap();
    let store = Store::in_memory();
    let campaign = Campaign::new(&store, 2, &Silent);
    let plan = table.plan(&Toy, Some(&store)).unwrap();
    assert_eq!((plan.rows, plan.runs, plan.kept), (3, 4, 0));
    let outcomes = table.run(&campaign, &Toy).unwrap();
    let results = Table::parse(&table.results_csv(&outcomes)).unwrap();
    let column = |name: &str| -> Vec<&str> {
        let column = results.column(name).unwrap();
        results.rows().iter().map(|row| row.text(column)).collect()
    };
    assert_eq!(column("run"), ["1", "2", "3", "3"]);
    assert_eq!(column("note"), ["a, b", "c", "d", "d"]);
    assert_eq!(column("repeat"), ["1", "1", "1", "2"]);
    assert_eq!(column("seed"), ["11", "12", "13", "14"]);
    assert_eq!(column("angle_deg"), ["0.4", "", "0.1", "0.1"]);
    let problem = "the run failed: no \"surface\", none at all";
    assert_eq!(column("problem"), ["", problem, "", ""]);
    let keys = column("key");
    assert_eq!(keys[1], "");
    assert_eq!(Ok(keys[0]), outcomes[0].as_ref().map(Record::key));
    assert!(
        results.column("standard_error_deg").is_err(),
        "nobody has one"
    );
    assert_eq!(table.plan(&Toy, Some(&store)).unwrap().kept, 3);
}

/// A raised flag ends the runs with an error that says how far they came.
#[test]
fn a_stop_is_told_as_such() {
    let table = Folder::new(&format!("{FRICTION}\n0.4\n")).read().unwrap();
    let (store, stop) = (Store::in_memory(), AtomicBool::new(true));
    let campaign = Campaign::new(&store, 1, &Silent).with_stop(&stop);
    let error = table.run(&campaign, &Toy).unwrap_err();
    assert!(matches!(
        error,
        Error::Campaign(campaign::Error::Stopped {
            n_done: 0,
            n_runs: 1
        })
    ));
}

impl Folder {
    /// Says how often each row is run.
    fn replicates(mut self, n: usize) -> Self {
        self.choices.replicates = Some(n);
        self
    }

    /// Changes the scene of all runs.
    fn set(mut self, text: &str) -> Self {
        self.choices.set.push(text.to_owned());
        self
    }
}
