//! Programs of the user as simulators.

use campaign::run_store::Store;
use campaign::{Campaign, RunOutcome, RunRequest, Silent, Simulator};
use scene::{FillingLibrary, OBSERVABLES_OF_PICTURES, Override, RunResult, Scene};
use simulators::exchange::{csv, vtk};
use simulators::external_simulator::{
    CommandModel, CommandSettings, CommandSimulator, DrumDescription, Keep, ResultFiles,
};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

/// A shell script as a program in a folder of its own, with a scene `mill` at 10 rpm.
struct Script {
    folder: tempfile::TempDir,
    settings: CommandSettings,
    drum: Option<DrumDescription>,
}

impl Script {
    fn new(script: &str) -> Self {
        let folder = tempfile::tempdir().expect("as the test prepared it");
        let template = folder.path().join("template");
        fs::create_dir(&template).expect("as the test prepared it");
        fs::write(template.join("run.sh"), script).expect("as the test prepared it");
        let settings = CommandSettings {
            command: vec!["sh".into(), "run.sh".into()],
            template: Some(template),
            version: "1".into(),
            wall_limit_s: 20.0,
            expected_s: 1.0,
            results: ResultFiles {
                observables: Some("results.json".into()),
                ..ResultFiles::default()
            },
            work: folder.path().join("work"),
            keep: Keep::Failed,
        };
        Self {
            folder,
            settings,
            drum: None,
        }
    }

    fn simulator(&self) -> CommandSimulator {
        let model = CommandModel {
            scene: "mill".into(),
            condition: BTreeMap::from([("rpm".to_owned(), "10".to_owned())]),
            parameters: vec!["mu".into()],
            drum: self.drum.clone(),
        };
        let models = BTreeMap::from([("mill @ rpm = 10".to_owned(), model)]);
        CommandSimulator::new(self.settings.clone(), models, &["mu".to_owned()])
            .expect("as the test prepared it")
    }

    fn store(&self) -> Store {
        Store::open(self.folder.path().join("runs")).expect("as the test prepared it")
    }

    /// Remainder of the folders of runs.
    fn left(&self) -> Vec<PathBuf> {
        let entries = fs::read_dir(&self.settings.work).into_iter().flatten();
        entries
            .map(|e| e.expect("as the test prepared it").path())
            .collect()
    }
}

fn request(mu: f64) -> RunRequest {
    RunRequest::new("mill @ rpm = 10", 7).with_parameter("mu", mu)
}

/// Arguments, environment, template and JSON tell the same values; the run is a record like any other.
#[test]
fn values_arrive_in_four_ways() {
    let script = Script::new(
        "cat filled.txt > told; echo $SEEDLOOP_MU $SEEDLOOP_RPM $SEEDLOOP_SEED $SEEDLOOP_SCENE >> told\n\
         echo $* | tr ' ' '\\n' | grep -v '^{' | sed 's/.*=//' | tr '\\n' ' ' >> told\n\
         tr -d ' \\n{}\"' < request.json >> told\n\
         printf '{\"angle_deg\": {\"mean\": 31.5, \"sd\": 0.4, \"n\": 9}, \"told\": %s}' $(wc -l < told) > results.json\n\
         cp told ../../told",
    );
    let template = script.settings.template.clone().unwrap();
    fs::write(
        template.join("filled.txt.template"),
        "{{mu}} {{rpm}} {{seed}} {{scene}}\n",
    )
    .unwrap();
    let store = script.store();
    let campaign = Campaign::new(&store, 1, &Silent);
    let records = campaign
        .run_all(&script.simulator(), &[request(0.25)])
        .unwrap();
    let angle = records[0].observable("angle_deg").unwrap();
    assert_eq!((angle.mean, angle.sd, angle.n), (31.5, Some(0.4), 9));
    let told = fs::read_to_string(script.folder.path().join("told")).unwrap();
    let lines: Vec<&str> = told.lines().collect();
    assert_eq!(lines[..2], ["0.25 10 7 mill"; 2]);
    // In the order of the names: mu, rpm, scene, seed.
    assert!(lines[2].starts_with("0.25 10 mill 7"), "{told}");
    for part in ["parameters:mu:0.25", "condition:rpm:10", "seed:7"] {
        assert!(lines[2].contains(part), "{part}: {told}");
    }
    assert_eq!(
        script.left(),
        Vec::<PathBuf>::new(),
        "success leaves nothing"
    );
}

/// Each run that fails does so alone, says why with its log, keeps its files, and can be done again.
#[test]
fn a_run_that_fails_fails_alone_and_can_be_repeated() {
    let mut script = Script::new(
        "echo mu is $SEEDLOOP_MU\n\
         case $SEEDLOOP_MU in\n\
         0.1) exit 4;;\n\
         0.2) sleep 60;;\n\
         0.3) ;;\n\
         0.4) echo '{\"angle_deg\": NaN}' > results.json;;\n\
         0.5) echo '{\"angle_deg\": 3' > results.json;;\n\
         *) echo '{\"angle_deg\": 31}' > results.json;;\n\
         esac",
    );
    script.settings.wall_limit_s = 1.0;
    let store = script.store();
    let campaign = Campaign::new(&store, 3, &Silent);
    let requests = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6].map(request);
    let each = campaign.run_each(&script.simulator(), &requests).unwrap();
    let words = [
        "exit status: 4",
        "wall limit of 1 s",
        "left no",
        "NaN",
        "line 2",
    ];
    for (k, word) in words.iter().enumerate() {
        let reason = each[k].as_ref().unwrap_err();
        let log = format!("mu is 0.{}", k + 1);
        assert!(
            reason.contains(word) && reason.contains(&log),
            "{word}: {reason}"
        );
    }
    assert_eq!(
        each[5]
            .as_ref()
            .unwrap()
            .observable("angle_deg")
            .unwrap()
            .mean,
        31.0
    );
    assert_eq!(
        script.left().len(),
        5,
        "the files of those that failed stay"
    );
    let again = campaign
        .run_each(&script.simulator(), &requests[..1])
        .unwrap();
    assert!(again[0].is_err());
    assert_eq!(
        script.left().len(),
        6,
        "a second attempt has a folder of its own"
    );
}

/// Another file of the template, another word for the version, another command: other runs. The time limit is none.
#[test]
fn the_key_holds_what_the_result_depends_on() {
    let mut script = Script::new("echo '{\"a\": 1}' > results.json");
    let key = |script: &Script| {
        let simulator = script.simulator();
        let inputs = simulator.prepare(&request(0.1)).unwrap().inputs().unwrap();
        let record = campaign::run_store::Record::new(&simulator.version(), inputs, 7).unwrap();
        record.key().to_owned()
    };
    let first = key(&script);
    script.settings.wall_limit_s = 5.0;
    script.settings.keep = Keep::All;
    assert_eq!(key(&script), first);
    script.settings.version = "2".into();
    let second = key(&script);
    fs::write(script.settings.template.clone().unwrap().join("extra"), "x").unwrap();
    let third = key(&script);
    script.settings.command.push("-v".into());
    let fourth = key(&script);
    let all = BTreeMap::from([(&first, 1), (&second, 2), (&third, 3), (&fourth, 4)]);
    assert_eq!(all.len(), 4);
}

#[test]
fn a_command_that_cannot_be_meant_is_refused_before_any_run() {
    let refused = |change: fn(&mut CommandSettings)| {
        let mut script = Script::new("true");
        change(&mut script.settings);
        let error = CommandSimulator::new(script.settings.clone(), BTreeMap::new(), &["mu".into()]);
        error.unwrap_err().to_string()
    };
    assert!(refused(|s| s.command.clear()).contains("names no program"));
    assert!(refused(|s| s.command.push("{nu}".into())).contains("{nu}"));
    assert!(refused(|s| s.results = ResultFiles::default()).contains("names no file"));
    assert!(refused(|s| s.template = Some("no/such/folder".into())).contains("no/such/folder"));
}

/// A drum that was run here.
struct DrumRun {
    scene: Scene,
    result: RunResult,
    /// Angles of the frames that can be read, degrees.
    angles: Vec<f64>,
}

/// The run whose frames the tests hand over.
static DRUM_RUN: LazyLock<DrumRun> = LazyLock::new(|| {
    let file =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tools/seedloop/tests/peers/drum.toml");
    let short = Override {
        name: "protocol.rotation_limit".into(),
        value: "2 s".into(),
    };
    let scene = Scene::read(&file, &[short]).expect("a scene of the tests");
    let result = scene::run(&scene, &FillingLibrary::default(), 1).expect("a run");
    let angles = result.readings.iter().filter_map(|r| r.photo.angle());
    let angles = angles.map(|a| a.line.to_degrees()).collect();
    DrumRun {
        scene,
        result,
        angles,
    }
});

/// The drum of that run in the frame of axes of its files, without times.
fn described_drum() -> DrumDescription {
    DrumDescription {
        inner_diameter: "60 mm".into(),
        width: "20 mm".into(),
        speed: "{rpm} rpm".into(),
        centre: ["0 mm", "0 mm", "0 mm"].map(str::to_owned),
        axis: "z".into(),
        up: "y".into(),
        gravity_m_s2: 9.81,
        interval: None,
        time_step: None,
        start_up: None,
        pixels: 480,
        max_angle_error: photo_profile::MAX_ANGLE_ERROR,
    }
}

/// A program that hands over the files of a folder as its results, with that folder.
fn handing_over(results: ResultFiles) -> (Script, PathBuf) {
    let mut script = Script::new("cp ../../handed/* .");
    let handed = script.folder.path().join("handed");
    fs::create_dir(&handed).expect("as the test prepared it");
    script.settings.results = results;
    script.drum = Some(described_drum());
    (script, handed)
}

/// Files of positions with names of one pattern as results.
fn positions(pattern: &str) -> ResultFiles {
    ResultFiles {
        positions: Some(pattern.into()),
        ..ResultFiles::default()
    }
}

/// Writes files into a folder.
fn write_all(folder: &Path, files: Vec<vtk::File>) {
    for file in files {
        fs::write(folder.join(file.name), file.text).expect("as the test prepared it");
    }
}

/// Mean of some values.
fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The frames before the end of the start-up, 1.5 swings to half a frame of 0.1 s, are not used.
fn assert_start_up_is_left_out(outcome: &RunOutcome, frames: usize) {
    let time = |key: &str| outcome.details[key].as_f64().expect("a time");
    let (start_up, swing) = (time("start_up_s"), time("swing_s"));
    // Both are given in whole frames: 1.5 times half a frame and half a frame.
    assert!(
        swing > 0.3 && start_up > 1.5 * swing - 0.125,
        "{start_up} s"
    );
    let left_out = (start_up / 0.1).round();
    let kept = outcome.details["frames"]["times_s"].as_array();
    let kept = kept.expect("a list of times").len();
    assert_eq!(left_out, (frames - kept) as f64, "frames of the start-up");
}

/// Another code hands over the spheres of a drum: CSV with times, and VTK files, which give no times. The ruler is the same,
/// so that the angle in the pictures is the same to rounding. Hidden spheres are handed over too; the reading of positions
/// sees them and the camera does not.
#[test]
fn positions_of_another_code_are_read_by_the_same_ruler() {
    let DrumRun {
        scene,
        result,
        angles,
    } = &*DRUM_RUN;
    let (frames, bodies) = (&result.frames, &result.bodies);
    let (mut script, handed) = handing_over(positions("bed_*.csv"));
    write_all(&handed, csv::series("bed", scene, frames, bodies));
    let outcome = script.simulator().run(&request(0.1)).unwrap();
    assert_start_up_is_left_out(&outcome, frames.len());
    // The rule keeps what follows its start-up: the last frames.
    let n = outcome.observables["angle_deg"].n;
    let of_last = mean(&angles[angles.len() - n..]);
    let angle = outcome.observables["angle_deg"].mean;
    assert!((angle - of_last).abs() < 1e-9, "{angle} for {of_last}");
    let of_all = mean(angles);
    assert!((angle - of_all).abs() < 3.0, "{angle} for {of_all}");
    assert!(outcome.observables.contains_key("shell_slip"));
    assert!(outcome.regime.is_some());

    write_all(&handed, vtk::series("bed", scene, frames, bodies).unwrap());
    script.settings.results = positions("bed_*.vtp");
    let error = script.simulator().run(&request(0.1)).unwrap_err();
    let error = error.to_string();
    assert!(error.contains("[scene.drum] time_step"), "{error}");
    script.drum.as_mut().unwrap().interval = Some("100 ms".into());
    let by_vtk = script.simulator().run(&request(0.1)).unwrap();
    let angle = by_vtk.observables["angle_deg"].mean;
    assert!((angle - of_last).abs() < 1e-9, "{angle} for {of_last}");
}

/// Pictures of the same drum give the mean angle of its frames, and the observables that a study receives from pictures. They
/// hold grey levels of 8 bits a channel.
#[test]
fn pictures_of_another_code_are_read_by_the_same_ruler() {
    let drum = &*DRUM_RUN;
    let (mut script, handed) = handing_over(ResultFiles {
        pictures: Some("frame*.png".into()),
        ..ResultFiles::default()
    });
    script.drum.as_mut().unwrap().interval = Some("100 ms".into());
    for (k, frame) in drum.result.frames.iter().enumerate() {
        let picture = scene::drum_picture(&drum.scene, &drum.result.bodies, frame).unwrap();
        dev_support::drawn_pictures::save(picture, handed.join(format!("frame{k}.png"))).unwrap();
    }
    let outcome = script.simulator().run(&request(0.1)).unwrap();
    let (angle, expected) = (outcome.observables["angle_deg"].mean, mean(&drum.angles));
    assert!((angle - expected).abs() < 0.02, "{angle} for {expected}");
    let mut said = OBSERVABLES_OF_PICTURES;
    said.sort_unstable();
    let given: Vec<&str> = outcome.observables.keys().map(String::as_str).collect();
    assert_eq!(given, said, "observables of pictures");
}
