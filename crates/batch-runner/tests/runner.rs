//! Campaigns on a pretended Slurm: the same records as local ones, whatever is lost, killed or silent.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod fake_slurm;
#[path = "../examples/stand_in/simulator.rs"]
mod simulator;

use batch_runner::{BatchSettings, CommandLines};
use campaign::run_store::{Record, Store};
use campaign::{Campaign, Error, RunRequest, Silent};
use fake_slurm::{FakeSlurm, stand_in, until};
use simulator::{StandIn, requests};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};

/// The simulator in the submitting process, which runs nothing itself.
fn simulator() -> StandIn {
    StandIn {
        notes: None,
        records: None,
        version: "stand-in 1".into(),
    }
}

/// A run with this x, without sleep.
fn with_x(x: f64) -> RunRequest {
    requests(1, 0.0)[0].clone().with_parameter("x", x)
}

/// What the campaign of these requests gives on the pretended Slurm.
fn on_slurm(
    slurm: &FakeSlurm,
    settings: BatchSettings,
    requests: &[RunRequest],
) -> Result<Vec<Record>, Error> {
    let store = Store::open(slurm.path("runs")).unwrap();
    let runner = slurm.runner(settings);
    let campaign = Campaign::new(&store, 1, &Silent).with_executor(&runner);
    campaign.run_all(&simulator(), requests)
}

/// The records of a local campaign.
fn local(requests: &[RunRequest]) -> Vec<Record> {
    let store = Store::in_memory();
    Campaign::new(&store, 2, &Silent)
        .run_all(&simulator(), requests)
        .unwrap()
}

/// 12 runs of 0.1 s in tasks of 0.3 s: four tasks in one submission, each run done once.
#[test]
fn a_campaign_of_jobs_gives_the_records_of_a_local_one() {
    let slurm = FakeSlurm::new();
    let list = requests(12, 0.1);
    let records = on_slurm(&slurm, slurm.settings(), &list).unwrap();
    assert_eq!(records, local(&list));
    assert_eq!(slurm.calls("sbatch"), 1);
    assert_eq!(slurm.noted("ended"), 12);
    let scripts = std::fs::read_to_string(slurm.path("calls")).unwrap();
    assert!(scripts.contains("--array=0-3"), "{scripts}");
}

/// Workers measure how long a run of cost 1 takes; later lists are packed by it: ten runs of 10 ms then fit into one
/// task of 0.3 s, where the first list had a task for each. Ten runs take 0.1 s and starting them some ms each.
#[test]
fn later_lists_are_packed_by_the_measured_pace() {
    let slurm = FakeSlurm::new();
    let settings = BatchSettings {
        seconds_per_cost: None,
        // A longer look makes sure that the reports of the first list are there.
        poll_s: 0.5,
        poll_most_s: 0.5,
        ..slurm.settings()
    };
    let list = requests(20, 0.01);
    on_slurm(&slurm, settings.clone(), &list[..10]).unwrap();
    on_slurm(&slurm, settings, &list).unwrap();
    let calls = std::fs::read_to_string(slurm.path("calls")).unwrap();
    assert!(calls.contains("--array=0-9"), "{calls}");
    assert!(calls.contains("--array=0-0"), "{calls}");
}

/// The submitting process is killed while its jobs run, and again between the submission and the note of its id: the
/// next one waits for them and submits nothing twice.
#[test]
fn a_killed_submitter_is_attached_again_and_submits_nothing_twice() {
    for forgets_id in [false, true] {
        let slurm = FakeSlurm::new();
        let mut settings = slurm.settings();
        settings.task_seconds = 1.0;
        std::fs::write(
            slurm.path("settings.json"),
            serde_json::to_vec(&settings).unwrap(),
        )
        .unwrap();
        slurm.set("hold", "");
        if forgets_id {
            slurm.set("forget-id", "");
        }
        let start = || {
            Command::new(stand_in())
                .args(["run", "slurm"])
                .arg(slurm.path(""))
                .args(["10", "0.2", "8"])
                .arg(slurm.path("settings.json"))
                .stderr(Stdio::null())
                .stdout(Stdio::null())
                .spawn()
                .unwrap()
        };
        let mut first = start();
        let ledger =
            || std::fs::read_to_string(slurm.path("batch/ledger.json")).unwrap_or_default();
        if forgets_id {
            until("the array is submitted", || {
                slurm.path("jobs/1/name").exists() && !slurm.path("forget-id").exists()
            });
            assert!(ledger().contains("meant"), "{}", ledger());
        } else {
            until("the id is noted", || ledger().contains("known"));
        }
        first.kill().unwrap();
        first.wait().unwrap();
        let mut second = start();
        slurm.unset("hold");
        assert!(second.wait().unwrap().success());
        assert_eq!(slurm.calls("sbatch"), 1);
        assert_eq!((slurm.noted("began"), slurm.noted("ended")), (10, 10));
    }
}

/// The first task of job 1 falls to a failed node, and its place in job 2 to a time-out: submitted again, with twice
/// the time limit after that; the same records in the end.
#[test]
fn a_lost_task_is_submitted_again_and_a_time_out_gets_more_time() {
    let slurm = FakeSlurm::new();
    slurm.set("fault-1", "NODE_FAIL");
    slurm.set("fault-2", "TIMEOUT");
    let settings = BatchSettings {
        time_limit_s: Some(60),
        ..slurm.settings()
    };
    let list = requests(6, 0.1);
    assert_eq!(on_slurm(&slurm, settings, &list).unwrap(), local(&list));
    let calls = std::fs::read_to_string(slurm.path("calls")).unwrap();
    let submissions: Vec<&str> = calls.lines().filter(|l| l.starts_with("sbatch")).collect();
    assert_eq!(submissions.len(), 3);
    assert!(submissions[1].contains("--time=0:01:00"), "{calls}");
    assert!(submissions[2].contains("--time=0:02:00"), "{calls}");
    // After two losses each run is alone.
    assert!(submissions[2].contains("--array=0-2"), "{calls}");
    assert_eq!(slurm.noted("ended"), 6);
}

/// A run that kills its worker is tried once and twice more, then told as lost with the log; the run that shared its
/// task is done.
#[test]
fn a_run_that_kills_its_worker_is_given_up_and_the_others_are_done() {
    let slurm = FakeSlurm::new();
    let settings = BatchSettings {
        retries: 2,
        ..slurm.settings()
    };
    let error = on_slurm(&slurm, settings, &[with_x(666.0), with_x(1.0)]).unwrap_err();
    let Error::Run {
        source, n_failed, ..
    } = &error
    else {
        panic!("{error}");
    };
    assert_eq!(*n_failed, 1);
    let reason = source.in_full();
    assert!(reason.starts_with("lost 3 times"), "{reason}");
    assert!(reason.contains(".log"), "{reason}");
    assert_eq!(slurm.calls("sbatch"), 3);
    assert_eq!(slurm.noted("ended"), 1);
}

/// A run that fails is no lost one: it is told with its reason at once, and not repeated.
#[test]
fn a_run_that_fails_is_told_with_its_reason_and_not_repeated() {
    let slurm = FakeSlurm::new();
    let error = on_slurm(&slurm, slurm.settings(), &[with_x(13.0), with_x(1.0)]).unwrap_err();
    let Error::Run {
        source, n_failed, ..
    } = &error
    else {
        panic!("{error}");
    };
    let reason = source.in_full();
    assert!(
        reason.starts_with("the run failed: x is 13; log: "),
        "{reason}"
    );
    assert_eq!((*n_failed, slurm.calls("sbatch")), (1, 1));
    assert_eq!(slurm.noted("began"), 2);
}

/// Workers of another version would do other runs; all are told as failed, and nothing is tried again.
#[test]
fn workers_of_another_version_are_found_out() {
    let slurm = FakeSlurm::new();
    let store = Store::open(slurm.path("runs")).unwrap();
    let runner = slurm.runner(slurm.settings());
    let newer = StandIn {
        notes: None,
        records: None,
        version: "stand-in 2".into(),
    };
    let error = Campaign::new(&store, 1, &Silent)
        .with_executor(&runner)
        .run_all(&newer, &requests(2, 0.0))
        .unwrap_err();
    let Error::Run {
        source, n_failed, ..
    } = &error
    else {
        panic!("{error}");
    };
    assert!(source.in_full().contains("version or inputs differ"));
    assert_eq!((*n_failed, slurm.calls("sbatch")), (2, 1));
    assert_eq!(slurm.noted("began"), 0);
}

/// A stop cancels the jobs, unless it is not to: then they run on and are found.
#[test]
fn a_stop_cancels_the_jobs_or_leaves_them() {
    for cancels in [true, false] {
        let slurm = FakeSlurm::new();
        let settings = BatchSettings {
            cancel_on_stop: cancels,
            ..slurm.settings()
        };
        slurm.set("hold", "");
        let list = requests(4, 0.05);
        let store = Store::open(slurm.path("runs")).unwrap();
        let runner = slurm.runner(settings.clone());
        let stop = AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                let _end = RaiseAtEnd(&stop);
                until("job 1 is noted", || {
                    std::fs::read_to_string(slurm.path("batch/ledger.json"))
                        .is_ok_and(|text| text.contains("known"))
                });
            });
            let error = Campaign::new(&store, 1, &Silent)
                .with_executor(&runner)
                .with_stop(&stop)
                .run_all(&simulator(), &list)
                .unwrap_err();
            assert!(matches!(error, Error::Stopped { n_done: 0, .. }), "{error}");
        });
        assert_eq!(slurm.calls("scancel"), usize::from(cancels));
        slurm.unset("hold");
        on_slurm(&slurm, settings, &list).unwrap();
        assert_eq!(slurm.calls("sbatch"), if cancels { 2 } else { 1 });
        assert_eq!(slurm.noted("began"), 4);
    }
}

/// The controller is away: at the submission, which is tried again, and while the tasks run, which does not matter.
#[test]
fn a_controller_that_does_not_answer_for_a_while_is_waited_for() {
    let slurm = FakeSlurm::new();
    slurm.set("down", "");
    let list = requests(6, 0.1);
    let records = std::thread::scope(|scope| {
        scope.spawn(|| {
            until("a submission was tried", || slurm.calls("sbatch") > 0);
            slurm.unset("down");
            until("a task runs", || slurm.noted("began") > 0);
            slurm.set("down", "");
        });
        on_slurm(&slurm, slurm.settings(), &list).unwrap()
    });
    assert_eq!(records, local(&list));
    assert_eq!(slurm.noted("ended"), 6);
}

/// Patience is finite where nothing comes.
#[test]
fn a_controller_that_never_answers_is_given_up() {
    let slurm = FakeSlurm::new();
    slurm.set("down", "");
    let settings = BatchSettings {
        patience_s: 0.5,
        ..slurm.settings()
    };
    let error = on_slurm(&slurm, settings, &requests(1, 0.0)).unwrap_err();
    let text = std::error::Error::source(&error).unwrap().to_string();
    assert!(text.contains("has not answered for 0.5 s"), "{text}");
    assert!(text.contains("Unable to contact"), "{text}");
}

/// A wrong partition is no matter of patience.
#[test]
fn a_refused_submission_is_told_at_once() {
    let slurm = FakeSlurm::new();
    slurm.set("refuse", "");
    let error = on_slurm(&slurm, slurm.settings(), &requests(1, 0.0)).unwrap_err();
    let text = std::error::Error::source(&error).unwrap().to_string();
    assert!(text.contains("Invalid partition name"), "{text}");
    assert_eq!(slurm.calls("sbatch"), 1);
}

#[test]
fn a_damaged_ledger_ends_the_campaign_before_anything_is_submitted() {
    let slurm = FakeSlurm::new();
    std::fs::create_dir_all(slurm.path("batch")).unwrap();
    slurm.set("batch/ledger.json", "{\"schema\": 1, \"arr");
    let error = on_slurm(&slurm, slurm.settings(), &requests(1, 0.0)).unwrap_err();
    let text = std::error::Error::source(&error).unwrap().to_string();
    assert!(text.contains("ledger.json is damaged"), "{text}");
    assert!(text.contains("delete the file"), "{text}");
    assert_eq!(slurm.calls("sbatch"), 0);
}

/// Raises a flag when it is dropped, so that a check that fails does not leave a campaign waiting.
struct RaiseAtEnd<'a>(&'a AtomicBool);

impl Drop for RaiseAtEnd<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::SeqCst);
    }
}

/// Background processes as a batch system, with a command for states and without: the same records; a task that is
/// killed with its script is seen by its silence, and its runs are done again.
fn command_lines_stand_for_a_batch_system(has_status: bool) {
    let slurm = FakeSlurm::new();
    let status = "for job in {jobs}; do kill -0 $job 2> /dev/null && echo $job running || echo $job ended; done";
    let settings = BatchSettings {
        seconds_per_cost: None,
        // A machine that is busy may be late by a second or two with a sign of life.
        heartbeat_s: 1.0,
        command: Some(CommandLines {
            submit: format!(
                "sh {{script}} < /dev/null > /dev/null 2>&1 & echo $! | tee -a '{}'",
                slurm.path("pids").display()
            ),
            status: has_status.then(|| status.into()),
            cancel: Some("kill {jobs}".into()),
        }),
        ..slurm.settings()
    };
    let runner = batch_runner::BatchRunner::command(slurm.path("batch"), slurm.worker(), settings);
    let runner = runner.unwrap();
    let store = Store::open(slurm.path("runs")).unwrap();
    let mut list = requests(5, 0.1);
    let long = requests(1, 60.0)[0].clone();
    let campaign = Campaign::new(&store, 1, &Silent).with_executor(&runner);
    let records = campaign.run_all(&simulator(), &list).unwrap();
    assert_eq!(records, local(&list));
    assert_eq!(slurm.noted("began"), 5);
    list.push(long);
    let stop = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let _end = RaiseAtEnd(&stop);
            until("the long run has begun", || slurm.noted("began") == 6);
            // The script first: it would leave the code of its worker.
            let pids = std::fs::read_to_string(slurm.path("pids")).unwrap();
            let notes = std::fs::read_to_string(slurm.path("notes")).unwrap();
            for text in [pids, notes] {
                let last = text.split_whitespace().last().unwrap().to_owned();
                Command::new("kill").args(["-9", &last]).status().unwrap();
            }
            until("it has begun again", || slurm.noted("began") == 7);
        });
        let error = campaign
            .with_stop(&stop)
            .run_all(&simulator(), &list)
            .unwrap_err();
        assert!(matches!(error, Error::Stopped { n_done: 5, .. }), "{error}");
    });
    assert_eq!((slurm.noted("began"), slurm.noted("ended")), (7, 5));
}

#[test]
fn command_lines_stand_for_a_batch_system_that_tells_states() {
    command_lines_stand_for_a_batch_system(true);
}

#[test]
fn command_lines_stand_for_a_batch_system_that_tells_no_states() {
    command_lines_stand_for_a_batch_system(false);
}
