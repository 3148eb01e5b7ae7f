//! A run that is left on its way and continued gives what it would have given.

use crate::coarse;
use dev_support::fixture_files::fixture;
use scene::{
    BondedSettings, Control, Ending, FillingLibrary, Keeper, Override, Progress, RunResult,
    RunStage, SORTED_FROM, Scene, run, run_on, run_retrying,
};
use std::sync::atomic::AtomicBool;

/// Few coarse seeds in a slice of the study's drum, for a second.
fn drum() -> Scene {
    coarse::drum(&[
        ("apparatus.inner_diameter", "70 mm"),
        ("seed.0.count", "50"),
        ("seed.1.count", "6"),
        ("protocol.frames", "3"),
        ("time_s", "1.2"),
    ])
}

/// The same seeds out of a factory: after 5 intervals some 30 of them are there.
fn drum_with_factory() -> Scene {
    let mut scene = drum();
    scene.protocol.insertion_rate = Some("300 1/s".parse().expect("a rate"));
    scene
}

/// A few coarse seeds in a cylinder that is lifted; all rest after some 0.6 s.
fn heap() -> Scene {
    coarse::of_file(
        "heap.toml",
        &[
            ("apparatus.inner_diameter", "24 mm"),
            ("apparatus.height", "40 mm"),
            ("apparatus.lift_speed", "200 mm/s"),
            ("seed.0.count", "24"),
            ("protocol.settle_limit", "0.2 s"),
            ("time_s", "1"),
        ],
    )
}

/// A few coarse seeds in a box whose gate is lifted.
fn box_collapse() -> Scene {
    coarse::of_file(
        "box.toml",
        &[
            ("apparatus.length", "30 mm"),
            ("apparatus.height", "40 mm"),
            ("apparatus.width", "24 mm"),
            ("apparatus.lift_speed", "200 mm/s"),
            ("seed.0.count", "24"),
            ("protocol.settle_limit", "0.2 s"),
            ("time_s", "1"),
        ],
    )
}

/// Soft spheres of two names in a drum, enough of them to be sorted.
fn large_bed() -> Scene {
    let changes = [
        ("sphere", "2.2 mm"),
        ("seed.0.count", "2100"),
        ("material.mcc.shear_modulus", "0.05 MPa"),
        ("material.wall.shear_modulus", "0.05 MPa"),
        ("rpm", "30"),
        ("protocol.settle_limit", "0.08 s"),
        ("protocol.frames", "2"),
        ("time_s", "0.2"),
        ("camera.pixels", "200"),
    ];
    let changes = changes.map(|(name, value)| Override {
        name: name.into(),
        value: value.into(),
    });
    let mut scene =
        Scene::read(&fixture("mcc/drum.toml"), &changes).expect("the scene is possible");
    let mut twin = scene.seed[0].clone();
    twin.name = "twin".into();
    scene.seed.push(twin);
    scene
}

/// Seeds whose bonds are so weak that some break in the fall, and others later.
fn bonded() -> Scene {
    let mut scene = coarse::five_seeds("0.08");
    let stress = || "1 Pa".parse().expect("a stress");
    scene.model.bonds = Some(BondedSettings {
        normal_stiffness_n_m3: 3e8,
        shear_stiffness_n_m3: 1.2e8,
        radius: "0.8 mm".parse().expect("a length"),
        largest_gap: "0.25 mm".parse().expect("a length"),
        damping_ratio: 0.3,
        strength: Some([stress(), stress()]),
    });
    scene
}

/// Keeps the state after so many intervals and stops the run there, as a broken disk would.
struct StopAfter {
    /// Intervals left.
    left: usize,
    /// The state as it would stand in a file.
    text: Option<String>,
}

impl Keeper for StopAfter {
    fn is_due(&mut self) -> bool {
        self.left -= 1;
        self.left == 0
    }

    fn keep(&mut self, progress: &Progress) -> Result<(), String> {
        self.text = serde_json::to_string(progress).ok();
        Err("stopped here".into())
    }
}

/// Keeps the states after some intervals and lets the run continue.
struct KeepAfter<'a> {
    /// Intervals gone.
    gone: usize,
    /// After how many of them a state is kept.
    stops: &'a [usize],
    /// The states as text of a file.
    states: Vec<String>,
}

impl Keeper for KeepAfter<'_> {
    fn is_due(&mut self) -> bool {
        self.gone += 1;
        self.stops.contains(&self.gone)
    }

    fn keep(&mut self, progress: &Progress) -> Result<(), String> {
        let text = serde_json::to_string(progress).map_err(|e| e.to_string())?;
        self.states.push(text);
        Ok(())
    }
}

/// Everything that a run tells, as text with all digits.
fn all_of(result: &RunResult) -> String {
    let (series, frames) = (&result.series, &result.frames);
    format!(
        "{series:?} {frames:?} {:?} {:?} {}",
        result.ending, result.observables, result.n_steps
    )
}

/// Stopped while the seeds appear or fall (interval 5), or while the drum turns and the bed swings (40 and 60), written as
/// text, read and continued: every digit is that of the run that was never stopped.
#[test]
fn a_run_that_was_stopped_goes_on_with_the_same_bits() {
    goes_on_with_the_same_bits(&drum(), &[5, 40, 60]);
    goes_on_with_the_same_bits(&drum_with_factory(), &[5, 40, 60]);
}

/// The same for a wall that is lifted: while the seeds fall, when it has just begun to rise, and while it is on its way.
#[test]
fn a_release_that_was_stopped_goes_on_with_the_same_bits() {
    goes_on_with_the_same_bits(&heap(), &[3, 11, 20]);
    goes_on_with_the_same_bits(&box_collapse(), &[3, 11, 20]);
}

/// The same for bonds that break: those that are broken stay so.
#[test]
fn bonded_seeds_that_were_stopped_go_on_with_the_same_bits() {
    let broken = |result: &RunResult| {
        let mut all = result.observables.iter();
        all.find(|f| f.name == "broken_bonds").map(|f| f.values[0])
    };
    let result = run(&bonded(), &FillingLibrary::default(), 3).expect("runs");
    assert!(broken(&result) > Some(0.0), "{:?}", broken(&result));
    goes_on_with_the_same_bits(&bonded(), &[4, 8]);
}

/// A large bed is sorted in memory at 0.2 s: stopped before or after this time, it continues with the same bits. Frames number
/// the seeds as they began, and those of a factory as they appeared: their kinds stay, and none has moved along the axis by more
/// than a seed or two, while confused seeds would be 20 mm apart.
#[test]
fn a_large_bed_is_sorted_and_its_seeds_keep_their_numbers() {
    let mut made = large_bed();
    made.protocol.insertion_rate = Some("42000 1/s".parse().expect("a rate"));
    for scene in [large_bed(), made] {
        let (result, states) = goes_on_with_the_same_bits(&scene, &[6, 12]);
        let [before, after] = [0, 1]
            .map(|k| serde_json::from_str::<serde_json::Value>(&states[k]).expect("reads back"));
        assert!(before.get("numbers").is_none(), "sorted too early");
        let numbers = after["numbers"].as_array().expect("it was sorted");
        assert!(numbers.len() >= SORTED_FROM);
        let frame = result.frames.last().expect("frames are asked for");
        let bodies = &before["world"]["bodies"];
        assert_eq!(serde_json::json!(frame.kind), bodies["template"]);
        let mut squares = 0.0;
        for (now, then) in frame
            .position
            .iter()
            .zip(bodies["position"].as_array().unwrap())
        {
            squares += (now.z - then[2].as_f64().expect("a coordinate")).powi(2);
        }
        let moved = (squares / frame.position.len() as f64).sqrt();
        assert!((1e-5..2e-3).contains(&moved), "{moved} m along the axis");
    }
}

/// Bonds that had broken before a stop stay broken, even if the scene of the continued run has bonds that cannot break.
#[test]
fn broken_bonds_stay_broken() {
    let library = FillingLibrary::default();
    let mut stop = StopAfter {
        left: 8,
        text: None,
    };
    let _ = run_on(&bonded(), &library, 3, 1, None, &mut stop);
    let left = serde_json::from_str(&stop.text.expect("a state was kept")).expect("reads back");
    let mut strong = bonded();
    if let Some(bonds) = &mut strong.model.bonds {
        bonds.strength = None;
    }
    let mut never = StopAfter {
        left: usize::MAX,
        text: None,
    };
    let result = run_on(&strong, &library, 3, 1, Some(left), &mut never).expect("continues");
    let broken = result.observables.iter().find(|f| f.name == "broken_bonds");
    assert!(broken.expect("counted").values[0] > 0.0);
}

/// A raised flag ends a run at the next look at the bed.
#[test]
fn a_run_ends_when_its_flag_is_raised() {
    let raised = AtomicBool::new(true);
    let library = FillingLibrary::default();
    let mut control = Control {
        stop: &raised,
        threads: &|| 1,
    };
    for scene in [drum(), heap()] {
        let told = run_on(&scene, &library, 3, 1, None, &mut control);
        let told = told.unwrap_err().to_string();
        assert!(told.contains("was stopped at 0.02 s"), "{told}");
    }
}

/// Stopped after the first of these intervals, and with the states that a run which is not stopped keeps after the others:
/// every digit is that of the run that went on. That run and the states, as text.
pub(crate) fn goes_on_with_the_same_bits(
    scene: &Scene,
    stops: &[usize],
) -> (RunResult, Vec<String>) {
    let library = FillingLibrary::default();
    let mut keeper = KeepAfter {
        gone: 0,
        stops,
        states: Vec::new(),
    };
    let whole = run_on(scene, &library, 3, 1, None, &mut keeper).expect("runs");
    let (digits, mut states) = (all_of(&whole), keeper.states);
    assert_eq!(states.len(), stops.len());
    let mut stop = StopAfter {
        left: stops[0],
        text: None,
    };
    let stopped = run_on(scene, &library, 3, 1, None, &mut stop).expect_err("stopped");
    assert!(stopped.to_string().contains("stopped here"), "{stopped}");
    states[0] = stop.text.expect("a state was kept");
    for (state, intervals) in states.iter().zip(stops) {
        let left = serde_json::from_str(state).expect("reads back");
        let mut never = StopAfter {
            left: usize::MAX,
            text: None,
        };
        let continued = run_on(scene, &library, 3, 1, Some(left), &mut never).expect("continues");
        assert!(
            all_of(&continued) == digits,
            "stopped after {intervals} intervals"
        );
    }
    (whole, states)
}

/// Records attempts that broke off, and stops the run after so many intervals of the next attempt.
#[derive(Default)]
struct StopInRetry {
    /// Intervals of the last attempt that are left; `None` if the run is not stopped.
    left: Option<usize>,
    /// Why attempts broke off.
    broken_off: Vec<String>,
    /// The state as it would stand in a file.
    text: Option<String>,
}

impl Keeper for StopInRetry {
    fn is_due(&mut self) -> bool {
        let counts = !self.broken_off.is_empty();
        let Some(left) = self.left.as_mut().filter(|_| counts) else {
            return false;
        };
        *left -= 1;
        *left == 0
    }

    fn keep(&mut self, progress: &Progress) -> Result<(), String> {
        self.text = serde_json::to_string(progress).ok();
        Err("stopped here".into())
    }

    fn begin_anew(&mut self, why: &str) -> Result<(), String> {
        self.broken_off.push(why.to_owned());
        Ok(())
    }
}

/// With one step for a hard contact the seeds fly apart, and half of it brings the run to its end. Stopped in that second
/// attempt and continued, the run keeps the half step and the reason of the first attempt: every digit is that of
/// the run that was never stopped. If no other attempt is allowed, only the reason of the first is reported.
#[test]
fn a_run_that_was_stopped_in_its_second_attempt_goes_on_with_the_half_step() {
    let mut scene = drum();
    scene.protocol.step_share = 1.0;
    let library = FillingLibrary::default();
    let go = |left, keeper: &mut StopInRetry, retries| {
        run_retrying(&scene, &library, 3, 1, left, keeper, retries)
    };
    let mut heard = StopInRetry::default();
    let whole = go(None, &mut heard, 3).expect("runs with a shorter step");
    assert!(!heard.broken_off.is_empty());
    assert_eq!(whole.broken_off, heard.broken_off);
    let alone = go(None, &mut StopInRetry::default(), 0).unwrap_err();
    assert_eq!(alone.to_string(), heard.broken_off[0]);
    let mut stop = StopInRetry {
        left: Some(20),
        ..StopInRetry::default()
    };
    let stopped = go(None, &mut stop, 3).unwrap_err();
    assert!(stopped.to_string().contains("stopped here"), "{stopped}");
    let left = serde_json::from_str(&stop.text.expect("a state was kept")).expect("reads back");
    let continued = go(Some(left), &mut StopInRetry::default(), 3).expect("continues");
    assert_eq!(continued.broken_off, whole.broken_off);
    assert_eq!(continued.time_step, whole.time_step);
    assert!(all_of(&continued) == all_of(&whole));
}

/// A state of another scene is refused, not continued.
#[test]
fn a_state_of_another_scene_is_refused() {
    for (scene, reason) in [
        (drum(), "another world"),
        (drum_with_factory(), "its seeds are others"),
    ] {
        let library = FillingLibrary::default();
        let mut stop = StopAfter {
            left: 5,
            text: None,
        };
        let _ = run_on(&scene, &library, 3, 1, None, &mut stop);
        let text = stop.text.take().expect("a state was kept");
        let left: Progress = serde_json::from_str(&text).expect("reads back");
        let mut fewer = scene;
        let one_less = fewer.count_of(&fewer.seed[0]) - 1;
        fewer.seed[0].set_count(one_less);
        let error = run_on(&fewer, &library, 3, 1, Some(left), &mut stop).unwrap_err();
        assert!(error.to_string().contains(reason), "{error}");
    }
}

/// The swing by which a bed is judged is that of its start. A continued run takes it from the state and does not measure the
/// moving bed again: with twice the swing in the state it is judged by twice the swing.
#[test]
fn a_continued_run_is_judged_by_the_swing_of_its_start() {
    let library = FillingLibrary::default();
    let swing_of = |factor: f64| {
        let mut stop = StopAfter {
            left: 60,
            text: None,
        };
        let _ = run_on(&drum(), &library, 3, 1, None, &mut stop);
        let text = stop.text.expect("a state was kept");
        let mut state: serde_json::Value = serde_json::from_str(&text).expect("reads back");
        let swing = state["swing"].as_f64().expect("the drive runs");
        state["swing"] = (factor * swing).into();
        let left = serde_json::from_value(state).expect("a state");
        let mut never = StopAfter {
            left: usize::MAX,
            text: None,
        };
        let continued = run_on(&drum(), &library, 3, 1, Some(left), &mut never);
        match continued.expect("continues").ending {
            Ending::Turned(state) => state.swing,
            other => panic!("it turned: {other:?}"),
        }
    };
    // Whole values of the series, each rounded.
    assert!(swing_of(2.0).abs_diff(2 * swing_of(1.0)) <= 1);
}

/// Writes down how far a run is.
#[derive(Default)]
struct Stages(Vec<RunStage>);

impl Keeper for Stages {
    fn is_due(&mut self) -> bool {
        false
    }

    fn keep(&mut self, _: &Progress) -> Result<(), String> {
        Ok(())
    }

    fn hear(&mut self, stage: &RunStage) {
        self.0.push(*stage);
    }
}

/// A drum settles within its limit and then turns within that of the rotation; it is heard of once in 0.02 s, to a step. Its
/// time rises, and the frames are counted as they are taken.
#[test]
fn a_run_tells_how_far_it_is() {
    let scene = coarse::five_seeds("0.3");
    let mut stages = Stages::default();
    run_on(&scene, &FillingLibrary::default(), 1, 1, None, &mut stages).unwrap();
    let (turning, settling): (Vec<RunStage>, Vec<_>) = stages.0.iter().partition(|s| s.driven);
    for (part, limit) in [(&settling, 0.12), (&turning, 0.3)] {
        assert!(part.iter().all(|s| s.limit_s == limit));
        assert!(part.is_sorted_by(|a, b| a.time_s <= b.time_s));
        let ends = [part[0].time_s, part[part.len() - 1].time_s];
        assert!(
            ends[0] < 0.021 && ends[1] <= limit + 0.021,
            "{ends:?} of {limit}"
        );
    }
    assert!(stages.0.is_sorted_by_key(|s| s.driven));
    let last = turning[turning.len() - 1];
    assert!(last.frames[0] >= 1 && last.frames[1] == 2, "{last:?}");
}
