//! The page in a real browser: slow, and only where Chromium is installed (`just browser-test`).

use crate::test_campaign::{Served, run};
use crate::{CampaignFolder, Server};
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What the browser shows at an address after some seconds of its own clock, and what its console said.
fn chromium(arguments: &[&str], address: &str) -> (String, Vec<String>) {
    let profile = tempfile::tempdir().unwrap();
    let output = Command::new("chromium")
        .args(["--headless=new", "--no-sandbox", "--disable-gpu"])
        .args(["--enable-logging=stderr", "--dump-dom"])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .args(arguments)
        .arg(address)
        .output()
        .unwrap_or_else(|e| panic!("chromium: {e}; `just browser-test` installs it"));
    let log = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{log}");
    let console = log.lines().filter(|line| line.contains("CONSOLE"));
    let console = console.map(String::from).collect();
    (
        String::from_utf8_lossy(&output.stdout).into_owned(),
        console,
    )
}

/// A server of a folder whose campaign does one run more before each time that the script of the page asks; with the number of
/// runs.
fn growing(folder: &Path) -> (Served, Arc<AtomicUsize>) {
    let frictions =
        |runs: usize| -> Vec<f64> { (0..runs).map(|i| 0.1 + 0.05 * i as f64).collect() };
    run(folder, &frictions(2));
    let server = Server::bind(CampaignFolder::open(folder).unwrap(), 0).unwrap();
    let runs = Arc::new(AtomicUsize::new(2));
    let (counter, place) = (Arc::clone(&runs), folder.to_owned());
    server.before_data(move || {
        let number = counter.fetch_add(1, Ordering::SeqCst) + 1;
        run(&place, &frictions(number));
    });
    (Served::with(server), runs)
}

/// Loaded once with two runs, the page asks every two seconds and shows the runs that were added, in its numbers, its charts and
/// its frames; its policy refuses nothing of it, and a phone is wide enough.
#[test]
#[ignore = "needs Chromium; `just browser-test` runs it"]
fn the_page_moves_while_records_are_added() {
    let place = tempfile::tempdir().unwrap();
    let (served, runs) = growing(place.path());
    let (page, console) = chromium(&["--virtual-time-budget=9000"], &served.address);
    assert_eq!(console, Vec::<String>::new());
    let number = runs.load(Ordering::SeqCst);
    // Nine seconds hold four looks, the last of which may come too late for the page.
    assert!((5..=7).contains(&number), "{number} runs");
    let tells = |n: usize| page.contains(&format!("<dt>Records in the folder</dt><dd>{n}</dd>"));
    assert!(tells(number) || tells(number - 1), "{number}: {page}");
    assert!(page.matches("<img src=\"frame/").count() >= 4, "{page}");
    assert!(page.contains("<svg"), "{page}");
    assert!(
        page.contains("<div id=\"lost\" class=\"verdict bad\" hidden"),
        "{page}"
    );
}
