//! The conversation with LAMMPS, held with a script that answers like it.

use campaign::{RunRequest, Simulator};
use scene::OBSERVABLES_OF_A_BED;
use scene::{Override, Scene};
use simulators::external_simulator::{Keep, Peer, PeerSettings, PeerSimulator};
use simulators::scene_simulator::SceneSimulator;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

fn simulator(folder: &Path, swing: f64, dies_at: u64, further: &[&str]) -> PeerSimulator {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fake_lammps.py");
    let file =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tools/seedloop/tests/peers/drum.toml");
    let few = [("seed.0.count", "30"), ("seed.1.count", "5")].map(|(name, value)| Override {
        name: name.into(),
        value: value.into(),
    });
    let scene = Scene::read(&file, &few).expect("the scene");
    let scenes = BTreeMap::from([("drum".to_owned(), scene)]);
    let settings = PeerSettings {
        peer: Peer::Lammps,
        command: ["python3", &script.display().to_string()]
            .into_iter()
            .chain([swing.to_string().as_str(), &dies_at.to_string()])
            .chain(further.iter().copied())
            .map(str::to_owned)
            .collect(),
        ranks: 2,
        environment: Vec::new(),
        wall_limit_s: 60.0,
        work: folder.join("work"),
        keep: Keep::All,
    };
    let scenes = SceneSimulator::new(scenes, BTreeMap::new()).expect("scenes");
    PeerSimulator::new(scenes, settings).expect("it answers")
}

/// The folder of the only run.
fn run_folder(folder: &Path) -> PathBuf {
    let entries = fs::read_dir(folder.join("work")).expect("folders");
    let folders: Vec<PathBuf> = entries.map(|e| e.expect("an entry").path()).collect();
    folders.first().expect("a run").clone()
}

/// The bed that the code shows is at 30 deg: its swing averages out over whole swings. The code was asked to continue until
/// the rule was content, and no longer.
#[test]
fn the_code_goes_on_for_as_long_as_the_bed_asks_for() {
    let folder = tempfile::tempdir().unwrap();
    let simulator = simulator(folder.path(), 2.0, u64::MAX, &[]);
    assert!(simulator.version().starts_with("LAMMPS (a fake)"));
    let outcome = simulator.run(&RunRequest::new("drum", 1)).unwrap();
    let angle = outcome.observables["angle_deg"].mean;
    assert!((angle - 30.0).abs() < 0.5, "{angle}");
    assert_eq!(outcome.regime.as_deref(), Some("rolling"));
    // All that is said to be read is read, and nothing else: the swing carries the bed along in a part of the time. A swing
    // up and down alike is not an avalanche, and an even swing has no correlation time.
    let none = [
        "angle_correlation_time_s",
        "avalanche_size_deg",
        "avalanche_waiting_time_s",
    ];
    let mut said = OBSERVABLES_OF_A_BED.to_vec();
    said.retain(|name| !none.contains(name));
    said.sort_unstable();
    let read: Vec<&str> = outcome.observables.keys().map(String::as_str).collect();
    assert_eq!(read, said);
    assert_eq!(outcome.details["timing"]["threads"], 2);
    // The spheres turn with the drum, 10 rpm = 1.047 rad/s; those that count lie one to two of their radii, 5 to 10 % of that
    // of the drum, inside the shell, and are slower by that.
    let slip = outcome.observables["shell_slip"].mean;
    assert!((0.05..0.1).contains(&slip), "{slip}");
    let commands = fs::read_to_string(run_folder(folder.path()).join("commands.txt")).unwrap();
    let runs = commands.lines().filter(|l| l.starts_with("run ")).count();
    assert!((3..8).contains(&runs), "{runs} runs");
}

/// A code that breaks off: the reason, the end of its log and the folder are reported.
#[test]
fn a_code_that_breaks_off_is_told_with_its_log() {
    let folder = tempfile::tempdir().unwrap();
    let simulator = simulator(folder.path(), 2.0, 1, &[]);
    let error = simulator.run(&RunRequest::new("drum", 1)).unwrap_err();
    let error = error.to_string();
    let told = run_folder(folder.path()).display().to_string();
    for word in ["Lost atoms", "exit status: 1", &told] {
        assert!(error.contains(word), "{word}: {error}");
    }
}

/// What the code would run otherwise is refused by name before any run.
#[test]
fn what_the_code_does_not_have_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let simulator = simulator(folder.path(), 2.0, u64::MAX, &[]);
    let request = RunRequest::new("drum", 1).with_effect("cohesion", 0.5);
    let error = simulator.prepare(&request).err().unwrap().to_string();
    assert!(
        error.contains("LAMMPS") && error.contains("attraction"),
        "{error}"
    );
}

/// A bed that lost a sphere gives no result.
#[test]
fn a_lost_sphere_ends_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let simulator = simulator(folder.path(), 2.0, u64::MAX, &["loses"]);
    let error = simulator.run(&RunRequest::new("drum", 1)).unwrap_err();
    let error = error.to_string();
    assert!(error.contains("spheres are in the drum"), "{error}");
}
