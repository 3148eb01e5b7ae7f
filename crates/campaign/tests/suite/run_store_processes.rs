//! Several processes on one folder, processes that are killed, and folders that take nothing.
//!
//! The other processes are this test program itself, with its task in a file.
#![cfg(unix)]
#![expect(clippy::unwrap_used, reason = "a failed step fails its test")]

use crate::common::{RUNS, record, work_through};
use campaign::run_store::{Attempt, CLAIM_LIFE, Error, Lookup, Record, Store};
use std::error::Error as _;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Threads of each process that works.
const THREADS: usize = 8;

/// A folder for the tasks and reports of children, beside the folder of the store.
struct Desk {
    folder: tempfile::TempDir,
}

impl Desk {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("runs")).unwrap();
        Self { folder }
    }

    fn runs(&self) -> std::path::PathBuf {
        self.folder.path().join("runs")
    }

    /// Starts a child with a task, after the words of a shell if there are any.
    fn start(&self, name: &str, task: &str, shell: Option<&str>) -> Child {
        let desk = self.folder.path().join(name);
        fs::create_dir(&desk).unwrap();
        fs::write(desk.join("task"), task).unwrap();
        let this = std::env::current_exe().unwrap();
        let mut command = match shell {
            None => Command::new(this),
            Some(words) => {
                let mut command = Command::new("sh");
                command.args(["-c", &format!("{words}; exec \"$0\" \"$@\"")]);
                command.arg(this);
                command
            }
        };
        command.args([
            "--ignored",
            "--exact",
            "run_store_processes::a_child_does_its_task",
        ]);
        command.current_dir(desk).stdout(Stdio::null());
        command.spawn().unwrap()
    }

    /// Waits until a child has said something.
    fn said(&self, name: &str) -> String {
        let file = self.folder.path().join(name).join("said");
        let begin = Instant::now();
        loop {
            if let Ok(text) = fs::read_to_string(&file)
                && text.ends_with('\n')
            {
                return text;
            }
            assert!(begin.elapsed().as_secs() < 30, "{name} says nothing");
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Names of all hidden files of the store.
    fn hidden(&self) -> Vec<String> {
        let entries = fs::read_dir(self.runs()).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        names.filter(|name| name.starts_with('.')).collect()
    }
}

/// A record larger than the room of a full disk and than what a system writes in one go.
fn large(seed: u64) -> Record {
    record(seed).with_details(serde_json::json!({ "series": vec![0.125; 40_000] }))
}

/// An error with its reason, as one line.
fn words(error: &Error) -> String {
    format!("{error}: {}", error.source().unwrap())
}

/// Task of the children; alone it does nothing.
#[test]
#[ignore = "the process that other tests of this file start: `just test`"]
fn a_child_does_its_task() {
    let Ok(task) = fs::read_to_string("task") else {
        return;
    };
    let say = |text: &str| fs::write("said", format!("{text}\n")).unwrap();
    let runs = Path::new("../runs");
    match task.as_str() {
        "work" => {
            let begin = std::process::id() as usize;
            let worker = |i| std::thread::spawn(move || work_through(runs, begin + i));
            let threads: Vec<_> = (0..THREADS).map(worker).collect();
            let done: usize = threads.into_iter().map(|t| t.join().unwrap()).sum();
            say(&done.to_string());
        }
        "hold" => {
            let store = Store::open(runs).unwrap();
            let claim = store.claim(record(0).key(), CLAIM_LIFE).unwrap();
            assert!(matches!(claim, Attempt::Won(_)));
            say("it is mine");
            std::thread::sleep(Duration::from_mins(5));
        }
        "write on and on" => {
            let store = Store::open(runs).unwrap();
            say("here I go");
            for seed in 0.. {
                store.put(&large(seed % 8)).unwrap();
            }
        }
        "fill up" => {
            // As before: what is there is found, what does not fit leaves nothing, and what fits is taken again.
            let store = Store::open(runs).unwrap();
            store.put(&record(0)).unwrap();
            let error = store.put(&large(1)).unwrap_err();
            assert_eq!(store.get(large(1).key()).unwrap(), Lookup::Absent);
            assert!(matches!(
                store.get(record(0).key()).unwrap(),
                Lookup::Found(_)
            ));
            assert_eq!(fs::read_dir(runs).unwrap().count(), 1);
            store.put(&record(2)).unwrap();
            say(&words(&error));
        }
        "only read" => {
            if fs::write(runs.join(".try"), "").is_ok() {
                return say("it can be written");
            }
            let store = Store::open(runs).unwrap();
            assert!(matches!(
                store.get(record(0).key()).unwrap(),
                Lookup::Found(_)
            ));
            let error = store.put(&record(1)).unwrap_err();
            assert!(store.claim(record(1).key(), CLAIM_LIFE).is_err());
            say(&words(&error));
        }
        other => panic!("unknown task {other}"),
    }
}

/// 64 workers in 8 processes: each run is done once, and its record is whole.
#[test]
fn many_processes_do_each_run_once() {
    let desk = Desk::new();
    let name = |i: usize| format!("worker {i}");
    let children: Vec<_> = (0..8).map(|i| desk.start(&name(i), "work", None)).collect();
    for mut child in children {
        assert!(child.wait().unwrap().success());
    }
    let done = |i| desk.said(&name(i)).trim().parse::<usize>().unwrap();
    assert_eq!((0..8).map(done).sum::<usize>(), RUNS);
    let store = Store::open(desk.runs()).unwrap();
    for seed in 0..RUNS as u64 {
        let written = record(seed);
        let found = store.get(written.key()).unwrap();
        assert_eq!(found, Lookup::Found(written));
    }
    assert!(desk.hidden().is_empty(), "{:?}", desk.hidden());
}

/// The claim of a process that was killed is free at once, whether its parent has noticed or not; and one that nobody
/// asks for goes when the folder is opened.
#[cfg(target_os = "linux")]
#[test]
fn the_claim_of_a_killed_process_is_taken_over() {
    let desk = Desk::new();
    let store = Store::open(desk.runs()).unwrap();
    let key = record(0).key().to_owned();
    for (name, waits_first) in [("first", true), ("second", false)] {
        let mut child = desk.start(name, "hold", None);
        desk.said(name);
        let claim = store.claim(&key, CLAIM_LIFE).unwrap();
        assert!(matches!(claim, Attempt::Taken(_)), "the owner lives");
        child.kill().unwrap();
        if waits_first {
            child.wait().unwrap();
        }
        let begin = Instant::now();
        while !matches!(store.claim(&key, CLAIM_LIFE).unwrap(), Attempt::Won(_)) {
            // The signal takes its time; the life of the claim is ten times as long.
            assert!(begin.elapsed().as_secs() < 6, "{name}");
            std::thread::sleep(Duration::from_millis(5));
        }
        child.wait().unwrap();
    }
    let mut child = desk.start("third", "hold", None);
    desk.said("third");
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(desk.hidden().len(), 1);
    Store::open(desk.runs()).unwrap();
    assert!(desk.hidden().is_empty(), "it is still there");
}

/// A writer that is killed in the middle, at many moments after it began to write aside: every record is whole, and what was written aside is gone
/// once the folder is opened again.
#[test]
fn a_killed_writer_leaves_whole_records() {
    let desk = Desk::new();
    let mut left_aside = 0;
    for round in 0..12 {
        let name = format!("writer {round}");
        let mut child = desk.start(&name, "write on and on", None);
        desk.said(&name);
        let begin = Instant::now();
        while desk.hidden().is_empty() {
            assert!(begin.elapsed().as_secs() < 30, "nothing is written");
        }
        std::thread::sleep(Duration::from_micros(150 * round));
        child.kill().unwrap();
        child.wait().unwrap();
        left_aside += desk.hidden().len();
        let store = Store::open(desk.runs()).unwrap();
        assert!(desk.hidden().is_empty(), "{:?}", desk.hidden());
        for key in store.keys().unwrap() {
            let found = store.get(&key).unwrap();
            assert!(matches!(found, Lookup::Found(_)), "{found:?}");
        }
    }
    assert!(left_aside > 0, "no kill was in the middle of a write");
}

/// A limit to the size of files breaks a write off in the middle, as a full disk does, on any system.
#[test]
fn a_write_that_breaks_off_leaves_the_store_as_before() {
    let desk = Desk::new();
    let limit = "trap '' XFSZ; ulimit -f 64";
    let mut child = desk.start("writer", "fill up", Some(limit));
    assert!(child.wait().unwrap().success());
    let said = desk.said("writer");
    assert!(
        said.contains(".aside") && said.contains("make room"),
        "{said}"
    );
}

/// The same on a disk that is full; needs the right to mount one, in a space of its own that ends with the test.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_the_store_as_before() {
    if !may_mount() {
        println!("skipped: this user may not mount a small disk");
        return;
    }
    let desk = Desk::new();
    let mount = mounted("mount -t tmpfs -o size=64k none ../runs");
    let mut child = desk.start("writer", "fill up", Some(&mount));
    assert!(child.wait().unwrap().success());
    let said = desk.said("writer");
    assert!(
        said.contains("No space left") && said.contains("make room"),
        "{said}"
    );
}

/// A folder that cannot be written can be read, and says so when it is to be written. Where rights do not bind the
/// user of the test, a mount that is for reading only does.
#[cfg(target_os = "linux")]
#[test]
fn a_folder_for_reading_is_read_and_says_that_it_takes_nothing() {
    use std::os::unix::fs::PermissionsExt as _;

    let desk = Desk::new();
    let store = Store::open(desk.runs()).unwrap();
    store.put(&record(0)).unwrap();
    fs::set_permissions(desk.runs(), fs::Permissions::from_mode(0o555)).unwrap();
    let mut child = desk.start("reader", "only read", None);
    assert!(child.wait().unwrap().success());
    let mut said = desk.said("reader");
    fs::set_permissions(desk.runs(), fs::Permissions::from_mode(0o755)).unwrap();
    if said.contains("can be written") {
        if !may_mount() {
            println!("skipped: rights do not bind this user, and it may not mount");
            return;
        }
        let bind = "mount --bind ../runs ../runs && mount -o remount,ro,bind ../runs";
        let mut child = desk.start("bound", "only read", Some(&mounted(bind)));
        assert!(child.wait().unwrap().success());
        said = desk.said("bound");
    }
    assert!(said.contains("allow to write there"), "{said}");
    assert_eq!(store.keys().unwrap(), [record(0).key()]);
}

/// A file where the folder should be.
#[test]
fn a_file_in_the_place_of_the_folder_is_told() {
    let desk = Desk::new();
    let file = desk.folder.path().join("file");
    fs::write(&file, "mine").unwrap();
    let error = Store::open(&file).unwrap_err();
    assert!(error.to_string().contains("move it away"), "{error}");
    let error = Store::open(file.join("runs")).unwrap_err();
    assert!(error.to_string().contains("move it away"), "{error}");
    assert_eq!(fs::read_to_string(&file).unwrap(), "mine");
}

/// Whether this user may mount in a space of its own.
#[cfg(target_os = "linux")]
fn may_mount() -> bool {
    let mut command = Command::new("unshare");
    command.args(["--mount", "sh", "-c", "mount -t tmpfs none ."]);
    command.stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}

/// Words of a shell that mount in a space of their own and continue there.
#[cfg(target_os = "linux")]
fn mounted(mount: &str) -> String {
    format!("exec unshare --mount sh -c '{mount} && exec \"$0\" \"$@\"' \"$0\" \"$@\"; exit 1")
}
