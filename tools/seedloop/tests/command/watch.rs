//! `seedloop watch` as a process, read over TCP.

use super::batch::RUNNER;
use super::{assert_error, seedloop};
use serde_json::Value;
use std::fs;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// The command while it serves; ended where a test fails.
struct Watching {
    /// The process.
    child: Child,
    /// The address that it printed.
    address: String,
}

impl Drop for Watching {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Watching {
    /// Starts it and reads its address.
    fn start(folder: &Path, words: &[&str]) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_seedloop"))
            .current_dir(folder)
            .arg("watch")
            .args(words)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut address = String::new();
        let mut lines = BufReader::new(child.stdout.take().unwrap());
        lines.read_line(&mut address).unwrap();
        let address = address.trim_end().to_owned();
        Self { child, address }
    }

    /// What the page fetches.
    fn data(&self) -> Value {
        let (host, path) = self
            .address
            .strip_prefix("http://")
            .unwrap()
            .split_once('/')
            .unwrap();
        let mut stream = TcpStream::connect(host).unwrap();
        let request = format!("GET /{path}data.json HTTP/1.1\r\nHost: {host}\r\n\r\n");
        stream.write_all(request.as_bytes()).unwrap();
        let mut reply = String::new();
        stream.read_to_string(&mut reply).unwrap();
        let (head, body) = reply.split_once("\r\n\r\n").unwrap();
        assert!(head.starts_with("HTTP/1.1 200 OK\r\n"), "{head}");
        serde_json::from_str(body).unwrap()
    }
}

/// A design of four runs of the ball on the plate.
fn design(folder: &Path) {
    let table = "run,contact.pea-steel.static_friction\n1,0.2\n2,0.3\n3,0.4\n4,0.5\n";
    fs::write(folder.join("design.csv"), table).unwrap();
    fs::write(folder.join("ball.toml"), include_str!("ball.toml")).unwrap();
}

/// The same page over a campaign whose runs are done by the jobs of a batch system.
#[test]
fn a_campaign_by_jobs_is_watched_from_its_first_run_to_its_end() {
    let settings = |folder: &Path| fs::write(folder.join("jobs.toml"), RUNNER).unwrap();
    let words = ["--runner", "command", "--runner-settings", "jobs.toml"];
    watched_to_its_end(settings, &words);
}

/// By threads of its own.
#[test]
fn a_campaign_is_watched_from_its_first_run_to_its_end() {
    watched_to_its_end(|_| (), &["--threads", "1"]);
}

/// Started as soon as the campaign has a folder, it shows the runs as they come, says that the campaign is finished in the end, and
/// Ctrl-C ends it within two seconds with the code of Ctrl-C; the folder then has what the campaign left in it.
fn watched_to_its_end(prepare: impl Fn(&Path), by: &[&str]) {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    design(folder);
    prepare(folder);
    let words = ["run", "design.csv", "--scene", "ball.toml", "--keep", "run"];
    let mut campaign = Command::new(env!("CARGO_BIN_EXE_seedloop"))
        .current_dir(folder)
        .args(words)
        .args(["--out", "out", "--quiet"])
        .args(by)
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let begin = Instant::now();
    while !folder.join("out/progress/list-1.json").exists() {
        assert!(
            begin.elapsed().as_secs() < 60,
            "the campaign does not begin"
        );
        std::thread::sleep(Duration::from_millis(5));
    }
    let mut watching = Watching::start(folder, &["out", "--quiet"]);
    assert!(
        watching.address.starts_with("http://127.0.0.1:"),
        "{}",
        watching.address
    );
    let first = watching.data();
    let status = first["parts"]["status"].as_str().unwrap();
    assert!(status.contains(" of 4</dd>"), "{status}");
    assert!(campaign.wait().unwrap().success());
    std::thread::sleep(Duration::from_millis(1100));
    let last = watching.data();
    let status = last["parts"]["status"].as_str().unwrap();
    assert!(
        status.contains("Finished") && status.contains("4 of 4"),
        "{status}"
    );
    let charts = last["parts"]["charts"].as_str().unwrap();
    assert!(
        charts.contains("shown static friction against contact.pea-steel.static_friction"),
        "{charts}"
    );
    let files = || {
        let mut names: Vec<_> = fs::read_dir(folder.join("out/runs"))
            .unwrap()
            .map(|entry| entry.unwrap().file_name())
            .collect();
        names.sort();
        names
    };
    assert_eq!(files().len(), 4);
    let number = watching.child.id().to_string();
    let told = Command::new("kill").args(["-INT", &number]).status();
    assert!(told.unwrap().success());
    let begin = Instant::now();
    let status = watching.child.wait().unwrap();
    assert!(begin.elapsed() < Duration::from_secs(2));
    assert_eq!(status.code(), Some(130));
    assert_eq!(files().len(), 4);
}

/// A folder that is none of a campaign, the folder of the records itself, and a port that is taken: told before anything is served.
#[test]
fn what_cannot_be_watched_is_told_before_anything_is_served() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    fs::create_dir_all(folder.join("out/runs")).unwrap();
    assert_error(
        &seedloop(folder, &["watch", "none"]),
        &["none is no folder", "--out"],
    );
    assert_error(
        &seedloop(folder, &["watch", "."]),
        &["neither runs/ nor progress/", "--out of calibrate"],
    );
    assert_error(
        &seedloop(folder, &["watch", "out/runs"]),
        &["give ", "/out"],
    );
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    assert_error(
        &seedloop(folder, &["watch", "out", "--port", &port]),
        &[&format!("127.0.0.1:{port}"), "another --port"],
    );
}
