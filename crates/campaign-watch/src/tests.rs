//! The server over real connections, on folders that a closed form fills in milliseconds.

use crate::test_campaign::{Served, pixel, plan, run, told};
use crate::{CampaignFolder, Error};
use campaign::run_store::{Attempt, CLAIM_LIFE, Store, record_path};
use campaign::{CampaignState, PlannedList, ProgressFolder, Silent};
use serde_json::json;
use std::fs;
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, UNIX_EPOCH};

/// A folder with three runs done and one failed.
fn folder() -> tempfile::TempDir {
    let place = tempfile::tempdir().unwrap();
    run(place.path(), &[0.1, -1.0, 0.3, 0.5]);
    place
}

/// All files with their times.
fn files(folder: &Path) -> Vec<(PathBuf, Duration)> {
    let mut all = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let data = path.metadata().unwrap();
        if data.is_dir() {
            all.extend(files(&path));
        }
        let time = data.modified().unwrap().duration_since(UNIX_EPOCH);
        all.push((path, time.unwrap()));
    }
    all.sort();
    all
}

/// Without the token, with a wrong one, with a longer or shorter one, or for anything else under it there is nothing; two servers
/// have different tokens of 128 bits.
#[test]
fn only_the_address_with_its_token_leads_to_the_page() {
    let place = folder();
    let served = Served::of(place.path());
    let path = served.path();
    assert_eq!(path.len(), 2 + 32, "{path}");
    assert_ne!(path, Served::of(place.path()).path());
    assert_eq!(served.get(&path).0, 200);
    assert_eq!(served.get(&format!("{path}data.json")).0, 200);
    let other = path.replace(|c: char| c == path.chars().nth(9).unwrap(), "z");
    let short = format!("{}/", &path[..path.len() - 2]);
    let long = format!("{}0/", &path[..path.len() - 1]);
    for wrong in [
        "/",
        "/data.json",
        "//",
        "/x/",
        &other,
        &short,
        &long,
        &path[..33],
    ] {
        let (status, reply) = served.get(wrong);
        assert_eq!(status, 404, "{wrong}");
        assert!(!reply.contains("beans"), "{wrong}");
    }
    for wrong in [
        "runs/",
        "../",
        "..%2f",
        "frame/../../progress/state.json",
        "frame/",
        "data.json?x",
        "/etc/passwd",
    ] {
        assert_eq!(served.get(&format!("{path}{wrong}")).0, 404, "{wrong}");
    }
}

/// A page of another site that a browser has open, and one whose name was made to lead here, get nothing.
#[test]
fn other_hosts_and_origins_are_refused() {
    let place = folder();
    let served = Served::of(place.path());
    let (host, path) = (served.host(), served.path());
    let port = host.split(':').nth(1).unwrap();
    let ask = |headers: &str| {
        told(&served.send(format!("GET {path} HTTP/1.1\r\n{headers}\r\n\r\n").as_bytes())).0
    };
    for (headers, status) in [
        (format!("Host: {host}"), 200),
        (format!("Host: localhost:{port}"), 200),
        (format!("host:{host}\r\nOrigin: http://{host}"), 200),
        (format!("Host: example.org:{port}"), 403),
        ("Host: 127.0.0.1".to_owned(), 403),
        (format!("Host: 127.0.0.1:{port}.example.org"), 403),
        ("Accept: */*".to_owned(), 400),
        (format!("Host: {host}\r\nHost: {host}"), 400),
        (format!("Host: {host}\r\nHost: example.org"), 403),
        (format!("Host: {host}\r\nOrigin: http://example.org"), 403),
        (format!("Host: {host}\r\nOrigin: null"), 403),
        (format!("Host: {host}\r\nOrigin: https://{host}"), 403),
    ] {
        assert_eq!(ask(&headers), status, "{headers}");
    }
}

/// A damaged file of the progress may hold any number: the page shows what is there, at once. 2 s is far above the milliseconds of a
/// page, and far below a walk to 10^15.
#[test]
fn no_number_in_a_damaged_progress_file_holds_up_the_page() {
    let place = folder();
    let path = CampaignState::path(place.path());
    let sound: serde_json::Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    let served = Served::of(place.path());
    for (name, value) in [
        ("lists", json!(1_000_000_000_000_000_u64)),
        ("lists", json!(u64::MAX)),
        ("lists", json!(0)),
        ("runs", json!(u64::MAX)),
        ("failed", json!(u64::MAX)),
        ("failed_before", json!(u64::MAX)),
        ("elapsed_s", json!(1e308)),
        ("left_s", json!([-1e308, 1e308])),
        ("lists", json!(-1)),
    ] {
        let mut state = sound.clone();
        state[name] = value.clone();
        state["plan"]["measured"][0]["mean"] = json!(1e308);
        fs::write(&path, serde_json::to_vec(&state).unwrap()).unwrap();
        let begin = Instant::now();
        let table = served.part("results");
        assert!(
            table.contains("40") && begin.elapsed().as_secs() < 2,
            "{name} {value}: {table}"
        );
    }
}

/// GET alone, without a body, in the one form that browsers send.
#[test]
fn other_methods_forms_and_bodies_are_refused() {
    let place = folder();
    let served = Served::of(place.path());
    let (host, path) = (served.host(), served.path());
    for (line, status) in [
        (format!("HEAD {path} HTTP/1.1"), 405),
        (format!("POST {path} HTTP/1.1"), 405),
        (format!("DELETE {path} HTTP/1.1"), 405),
        (format!("OPTIONS {path} HTTP/1.1"), 405),
        (format!("get {path} HTTP/1.1"), 405),
        (format!("GET {path} HTTP/1.0"), 505),
        (format!("GET {path}"), 400),
        (format!("GET  {path} HTTP/1.1"), 400),
        (format!("GET http://{host}{path} HTTP/1.1"), 400),
        (format!("GET {path} HTTP/1.1\r\nContent-Length: 5"), 400),
        (
            format!("GET {path} HTTP/1.1\r\nTransfer-Encoding: chunked"),
            400,
        ),
        (format!("GET {path} HTTP/1.1\r\n folded"), 400),
        (format!("GET {path} HTTP/1.1\r\nName : x"), 400),
        (format!("GET {path} HTTP/1.1\r\nname: \u{e4}"), 400),
    ] {
        let request = format!("{line}\r\nHost: {host}\r\n\r\n");
        assert_eq!(told(&served.send(request.as_bytes())).0, status, "{line}");
    }
    let with_body = format!("GET {path} HTTP/1.1\r\nHost: {host}\r\n\r\nbody");
    assert_eq!(told(&served.send(with_body.as_bytes())).0, 400);
    assert_eq!(told(&served.send(b"\x16\x03\x01\x02\r\n\r\n")).0, 400);
}

/// 100 kB without an end are refused before they are all read.
#[test]
fn a_long_request_is_refused() {
    let place = folder();
    let served = Served::of(place.path());
    let (host, path) = (served.host(), served.path());
    let long = "a".repeat(100_000);
    let request = format!("GET {path} HTTP/1.1\r\nHost: {host}\r\nX: {long}\r\n\r\n");
    assert_eq!(told(&served.send(request.as_bytes())).0, 431);
    let request = format!("GET {path}{long} HTTP/1.1\r\nHost: {host}\r\n\r\n");
    assert_eq!(told(&served.send(request.as_bytes())).0, 431);
}

/// Twenty clients that begin a request and say no more hold up nobody; one that sends a byte now and then is sent away after three
/// seconds in all, not after each byte.
#[test]
fn a_slow_client_holds_up_nobody() {
    let place = folder();
    let served = Served::of(place.path());
    let slow: Vec<_> = (0..20)
        .map(|_| {
            let mut stream = served.connect();
            stream.write_all(b"GET /").unwrap();
            stream
        })
        .collect();
    let begin = Instant::now();
    assert_eq!(served.get(&served.path()).0, 200);
    assert!(
        begin.elapsed() < Duration::from_secs(1),
        "{:?}",
        begin.elapsed()
    );
    drop(slow);
    let mut drop_by_drop = served.connect();
    let begin = Instant::now();
    while begin.elapsed() < Duration::from_millis(3800) {
        // The server may have closed.
        let _ = drop_by_drop.write_all(b"x");
        std::thread::sleep(Duration::from_millis(200));
    }
    drop_by_drop
        .set_read_timeout(Some(Duration::from_millis(300)))
        .unwrap();
    let mut reply = Vec::new();
    let _ = drop_by_drop.read_to_end(&mut reply);
    assert_eq!(told(&reply).0, 408);
}

/// The policy names style and script of the page by their digests and nothing is inline; names with markup stand as text, in the
/// page and in what its script fetches.
#[test]
fn the_page_runs_its_own_script_alone_and_escapes_names() {
    let place = folder();
    let served = Served::of(place.path());
    let (_, page) = served.get(&served.path());
    let (head, body) = page.split_once("\r\n\r\n").unwrap();
    for says in [
        "default-src 'none'",
        "script-src 'sha256-",
        "style-src 'sha256-",
        "frame-ancestors 'none'",
        "nosniff",
        "no-referrer",
        "no-store",
    ] {
        assert!(head.contains(says), "{says}: {head}");
    }
    assert!(!head.contains("unsafe"));
    assert_eq!(body.matches("<script").count(), 1);
    let (_, data) = served.get(&format!("{}data.json", served.path()));
    let names = [
        served.part("name"),
        served.part("results"),
        served.part("charts"),
    ];
    for text in [body, &data, &names.concat()] {
        for markup in [
            "<img src=x",
            "alert(1)</script><",
            "<script>alert",
            "friction <b>",
        ] {
            assert!(!text.contains(markup), "{markup} in {text}");
        }
    }
    assert!(names[0].contains("beans &lt;/title&gt;"), "{}", names[0]);
    assert!(names[1].contains("drum &lt;img"), "{}", names[1]);
    assert!(!page.contains(" style="), "inline style");
}

/// The fourth of four failed; the latest run is at 0.5, where the closed form has 40 degrees.
#[test]
fn the_page_tells_stage_runs_results_and_frames() {
    let place = folder();
    let served = Served::of(place.path());
    let status = served.part("status");
    for says in [
        "Running: surfaces &amp; estimate",
        "<dt>Done of this list</dt><dd>3 of 4</dd>",
        "<dt>Running</dt><dd>0</dd>",
        "<dt>Waiting</dt><dd>0</dd>",
        "<dt>Failed</dt><dd>1</dd>",
        "<dt>Records in the folder</dt><dd>3</dd>",
        "<dt>Time of runs left, whole loop</dt><dd>about 0 s</dd>",
        "<progress max=\"4\" value=\"4\">",
    ] {
        assert!(status.contains(says), "{says}: {status}");
    }
    let stages = served.part("stages");
    let row = "surfaces &amp; estimate</th><td class=\"right\">3</td><td class=\"right\">4</td><td class=\"right\">7</td>";
    assert!(stages.contains(row), "{stages}");
    let results = served.part("results");
    let row = "<td>angle (deg)</td><td class=\"right\">3</td><td class=\"right\">24</td><td class=\"right\">40</td>\
               <td class=\"right\">40</td><td class=\"right\">33.25</td><td>fit</td>";
    assert!(results.contains(row), "{results}");
    let charts = served.part("charts");
    assert_eq!(charts.matches("<figure>").count(), 1);
    assert!(
        charts.contains("measured") && charts.contains("latest"),
        "{charts}"
    );
    assert!(charts.contains("static friction &lt;b&gt; F"), "{charts}");
    let frames = served.part("frames");
    assert!(frames.contains("F = 0.5, seed 7: rolling"), "{frames}");
    let address = frames
        .split("src=\"")
        .nth(1)
        .unwrap()
        .split('"')
        .next()
        .unwrap();
    let request = format!(
        "GET {}{address} HTTP/1.1\r\nHost: {}\r\n\r\n",
        served.path(),
        served.host()
    );
    let reply = served.send(request.as_bytes());
    assert!(reply.ends_with(&pixel()));
    assert!(told(&reply).1.contains("Content-Type: image/png"));
}

/// A run in progress is one that has a claim of its list.
#[test]
fn a_run_that_someone_does_is_told_as_running() {
    let place = tempfile::tempdir().unwrap();
    run(place.path(), &[0.1, -1.0, -2.0]);
    let list = campaign::PlannedList::read(place.path(), 1)
        .unwrap()
        .unwrap();
    let store = Store::open(place.path().join("runs")).unwrap();
    let claim = store.claim(&list.runs[1].key, CLAIM_LIFE).unwrap();
    assert!(matches!(claim, Attempt::Won(_)));
    let served = Served::of(place.path());
    let status = served.part("status");
    assert!(status.contains("<dt>Running</dt><dd>1</dd>"), "{status}");
}

/// Half a record, one that was altered, a folder and a pipe in the place of one, and half a state: each costs its own place and is
/// told, and a record that is whole again is shown again.
#[test]
fn what_is_damaged_is_left_out_and_told() {
    let place = folder();
    let runs = place.path().join("runs");
    let mut records: Vec<PathBuf> = fs::read_dir(&runs)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    records.sort();
    let key = |path: &Path| path.file_name().unwrap().to_str().unwrap().to_owned();
    let whole = fs::read(&records[0]).unwrap();
    fs::write(&records[0], &whole[..whole.len() / 2]).unwrap();
    let altered = fs::read_to_string(&records[1])
        .unwrap()
        .replace("\"n\": 10", "\"n\": 11");
    fs::write(&records[1], altered).unwrap();
    let [folder, pipe] = ["a", "b"].map(|digit| runs.join(format!("{}.json", digit.repeat(64))));
    fs::create_dir(&folder).unwrap();
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.unwrap().success());
    let served = Served::of(place.path());
    let problems = served.part("problems");
    for (path, why) in [
        (&records[0], "EOF"),
        (&records[1], "altered"),
        (&folder, "no plain file"),
        (&pipe, "no plain file"),
    ] {
        let line = problems
            .split("<li>")
            .find(|line| line.contains(&key(path)));
        assert!(
            line.is_some_and(|line| line.contains(why)),
            "{why}: {problems}"
        );
    }
    assert!(
        served
            .part("results")
            .contains("<td class=\"right\">1</td>")
    );
    let state = CampaignState::path(place.path());
    let text = fs::read(&state).unwrap();
    fs::write(&state, &text[..text.len() / 2]).unwrap();
    fs::write(&records[0], &whole).unwrap();
    std::thread::sleep(Duration::from_millis(1100));
    let problems = served.part("problems");
    assert!(problems.contains("state.json"), "{problems}");
    assert!(!problems.contains(&key(&records[0])), "{problems}");
    assert_eq!(served.get(&served.path()).0, 200);
}

/// Every file and folder has the same name and time as before.
#[test]
fn watching_changes_nothing() {
    let place = folder();
    let before = files(place.path());
    let served = Served::of(place.path());
    for _ in 0..3 {
        assert_eq!(served.get(&served.path()).0, 200);
        assert_eq!(served.get(&format!("{}data.json", served.path())).0, 200);
    }
    drop(served);
    assert_eq!(files(place.path()), before);
}

/// A folder with records alone, such as one of an older version, shows them without a plan; one that ended, and one that was
/// killed, say so.
#[test]
fn the_end_and_the_lack_of_a_plan_are_told() {
    let place = folder();
    let end = |how: &str| {
        let progress = ProgressFolder::new(place.path(), plan(), &Silent);
        progress.end(how);
    };
    end("finished");
    assert!(Served::of(place.path()).part("status").contains("Finished"));
    end("ended early");
    assert!(
        Served::of(place.path())
            .part("status")
            .contains("--resume goes on")
    );
    run(place.path(), &[0.1]);
    let state = fs::File::options()
        .write(true)
        .open(CampaignState::path(place.path()))
        .unwrap();
    let written = state.metadata().unwrap().modified().unwrap();
    let before = written - Duration::from_mins(10);
    state.set_modified(before).unwrap();
    let status = Served::of(place.path()).part("status");
    assert!(status.contains("No sign of life for 10 min"), "{status}");
    fs::remove_dir_all(place.path().join("progress")).unwrap();
    let served = Served::of(place.path());
    assert!(served.part("status").contains("<dd>3</dd>"));
    assert!(
        served
            .part("results")
            .contains("<td>angle (deg)</td><td class=\"right\">3</td>")
    );
}

/// The reason, and the way out: the folder above where the records themselves were given.
#[test]
fn a_folder_that_is_no_campaign_is_refused() {
    let place = folder();
    let told = |path: &Path| CampaignFolder::open(path).unwrap_err();
    let missing = told(&place.path().join("none"));
    assert!(matches!(missing, Error::NoFolder { .. }), "{missing}");
    let record = fs::read_dir(place.path().join("runs")).unwrap().next();
    assert!(matches!(
        told(&record.unwrap().unwrap().path()),
        Error::NoFolder { .. }
    ));
    let runs = told(&place.path().join("runs")).to_string();
    let above = place.path().canonicalize().unwrap();
    assert!(
        runs.contains(&format!("give {}", above.display())),
        "{runs}"
    );
    let other = tempfile::tempdir().unwrap();
    let told = told(other.path()).to_string();
    assert!(told.contains("--out of calibrate"), "{told}");
}

/// More frames than are kept: the latest six are shown, also where they are read one look after the other.
#[test]
fn the_latest_frames_are_kept() {
    let place = tempfile::tempdir().unwrap();
    let frictions: Vec<f64> = (1..=9).map(|i| f64::from(i) / 10.0).collect();
    run(place.path(), &frictions);
    let served = Served::of(place.path());
    let frames = served.part("frames");
    assert_eq!(frames.matches("<img").count(), 6, "{frames}");
    assert!(frames.find("F = 0.9").unwrap() < frames.find("F = 0.4").unwrap());
    assert!(!frames.contains("F = 0.3"), "{frames}");
}

/// Where the clock of the files is too coarse to tell runs apart, they ended in the order of their list; where it
/// is not, the file that was written last is the latest.
#[test]
fn runs_of_one_time_ended_in_the_order_of_their_list() {
    let place = tempfile::tempdir().unwrap();
    let frictions: Vec<f64> = (1..=9).map(|i| f64::from(i) / 10.0).collect();
    run(place.path(), &frictions);
    let moment = UNIX_EPOCH + Duration::from_hours(500_000);
    let list = PlannedList::read(place.path(), 1).unwrap().unwrap();
    let set = |run: usize, time| {
        let record = record_path(&place.path().join("runs"), &list.runs[run].key).unwrap();
        let file = fs::File::options().write(true).open(record).unwrap();
        file.set_modified(time).unwrap();
    };
    for run in 0..frictions.len() {
        set(run, moment);
    }
    let shown = || {
        let frames = Served::of(place.path()).part("frames");
        let mut shown: Vec<(usize, f64)> = frictions
            .iter()
            .filter_map(|friction| Some((frames.find(&format!("F = {friction}"))?, *friction)))
            .collect();
        shown.sort_unstable_by_key(|(at, _)| *at);
        shown.into_iter().map(|(_, friction)| friction).collect()
    };
    let by_place: Vec<f64> = shown();
    assert_eq!(by_place, [0.9, 0.8, 0.7, 0.6, 0.5, 0.4]);
    set(0, moment + Duration::from_secs(10));
    let by_time: Vec<f64> = shown();
    assert_eq!(by_time, [0.1, 0.9, 0.8, 0.7, 0.6, 0.5]);
}

/// Where scripts are refused the page holds the same parts, and is told to be loaded again.
#[test]
fn without_scripts_the_tables_are_there() {
    let place = folder();
    let served = Served::of(place.path());
    let (_, page) = served.get(&served.path());
    assert!(page.contains("<noscript><meta http-equiv=\"refresh\" content=\"2\"></noscript>"));
    for part in ["results", "charts", "frames", "stages"] {
        let text = served.part(part);
        assert!(!text.is_empty() && page.contains(&text), "{part}");
    }
}
