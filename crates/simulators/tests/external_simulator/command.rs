//! Programs of the user as simulators.

use campaign::run_store::Store;
use campaign::{Campaign, RunRequest, Silent, Simulator};
use scene::{FillingLibrary, OBSERVABLES_OF_PICTURES, Override, Scene};
use simulators::exchange::{csv, vtk};
use simulators::external_simulator::{
    CommandModel, CommandSettings, CommandSimulator, DrumDescription, Keep, ResultFiles,
};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

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

/// A drum run here, its spheres handed over as another code would: CSV with times, and VTK files in another frame of axes. The
/// ruler is the same, so that the angle in the pictures is the same to rounding; hidden spheres are handed over too, which
/// the reading of positions sees and the camera does not.
#[test]
fn positions_of_another_code_are_read_by_the_same_ruler() {
    let file =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tools/seedloop/tests/peers/drum.toml");
    let set = |name: &str, value: &str| Override {
        name: name.into(),
        value: value.into(),
    };
    let scene = Scene::read(&file, &[set("protocol.rotation_limit", "2 s")]).unwrap();
    let run = scene::run(&scene, &FillingLibrary::default(), 1).unwrap();
    let frames = &run.frames;
    let readings = &run.readings;
    let angles: Vec<f64> = readings
        .iter()
        .filter_map(|r| r.photo.angle().map(|a| a.line.to_degrees()))
        .collect();
    let expected = angles.iter().sum::<f64>() / angles.len() as f64;

    let mut script = Script::new("cp ../../handed/* .");
    let handed = script.folder.path().join("handed");
    fs::create_dir(&handed).unwrap();
    script.settings.results = ResultFiles {
        positions: Some("bed_*.csv".into()),
        ..ResultFiles::default()
    };
    script.drum = Some(DrumDescription {
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
    });
    for file in csv::series("bed", &scene, frames, &run.bodies) {
        fs::write(handed.join(file.name), file.text).unwrap();
    }
    let outcome = script.simulator().run(&request(0.1)).unwrap();
    // The rule keeps what follows its start-up: the last frames.
    let n = outcome.observables["angle_deg"].n;
    // The start-up, 1.5 swings to half a frame of 0.1 s, is not part of it.
    let time = |key: &str| outcome.details[key].as_f64().unwrap();
    let (start_up, swing) = (time("start_up_s"), time("swing_s"));
    // Both are given in whole frames: 1.5 times half a frame and half a frame.
    assert!(
        swing > 0.3 && start_up > 1.5 * swing - 0.125,
        "{start_up} s"
    );
    let left_out = (start_up / 0.1).round();
    let kept = outcome.details["frames"]["times_s"]
        .as_array()
        .unwrap()
        .len();
    assert_eq!(
        left_out,
        (frames.len() - kept) as f64,
        "frames of the start-up"
    );
    let last = &angles[angles.len() - n..];
    let of_last = last.iter().sum::<f64>() / n as f64;
    let angle = outcome.observables["angle_deg"].mean;
    assert!((angle - of_last).abs() < 1e-9, "{angle} for {of_last}");
    assert!((angle - expected).abs() < 3.0, "{angle} for {expected}");
    assert!(outcome.observables.contains_key("shell_slip"));
    assert!(outcome.regime.is_some());

    // The same as VTK, whose files tell no times.
    for file in vtk::series("bed", &scene, frames, &run.bodies).unwrap() {
        fs::write(handed.join(file.name), file.text).unwrap();
    }
    script.settings.results.positions = Some("bed_*.vtp".into());
    let error = script
        .simulator()
        .run(&request(0.1))
        .unwrap_err()
        .to_string();
    assert!(error.contains("[scene.drum] time_step"), "{error}");
    script.drum.as_mut().unwrap().interval = Some("100 ms".into());
    let by_vtk = script.simulator().run(&request(0.1)).unwrap();
    let angle = by_vtk.observables["angle_deg"].mean;
    assert!((angle - of_last).abs() < 1e-9, "{angle} for {of_last}");

    // The same as pictures.
    let bodies = &run.bodies;
    for (k, frame) in frames.iter().enumerate() {
        let picture = scene::drum_picture(&scene, bodies, frame).unwrap();
        dev_support::drawn_pictures::save(picture, handed.join(format!("frame{k}.png"))).unwrap();
    }
    script.settings.results = ResultFiles {
        pictures: Some("frame*.png".into()),
        ..ResultFiles::default()
    };
    let by_picture = script.simulator().run(&request(0.1)).unwrap();
    let angle = by_picture.observables["angle_deg"].mean;
    // Pictures hold grey levels of 8 bits a channel.
    assert!((angle - expected).abs() < 0.02, "{angle} for {expected}");
    let mut said = OBSERVABLES_OF_PICTURES;
    said.sort_unstable();
    let given: Vec<&str> = by_picture.observables.keys().map(String::as_str).collect();
    assert_eq!(
        given, said,
        "observables of pictures, as a study receives them"
    );
}
