//! The page in a real browser: slow, and only where Chromium is installed (`trials/programs.sh browser`).

use super::{REFUSED, folder, photo, run};
use std::path::Path;
use std::process::Command;

/// What Chromium makes of a page with a script of the test behind its own, which its policy would refuse; in a window of so
/// many pixels.
fn seen(page: &Path, script: &str, width: u32) -> String {
    let text = std::fs::read_to_string(page).unwrap();
    let (before, policy) = text.split_once("script-src").unwrap();
    let (_, after) = policy.split_once('"').unwrap();
    let text = format!("{before}script-src 'unsafe-inline'\"{after}");
    let text = text.replace("</body>", &format!("<script>{script}</script></body>"));
    let path = page.with_file_name(format!("scripted-{width}.html"));
    std::fs::write(&path, text).unwrap();
    chromium(&["--dump-dom", "--virtual-time-budget=5000"], &path, width)
}

/// Runs Chromium without a window; nothing may be complained about in its console.
fn chromium(words: &[&str], page: &Path, width: u32) -> String {
    let profile = folder("browser profile");
    let output = Command::new("chromium")
        .args(["--headless=new", "--no-sandbox", "--disable-gpu"])
        .arg("--enable-logging=stderr")
        .arg(format!("--window-size={width},900"))
        .arg(format!("--user-data-dir={}", profile.display()))
        .args(words)
        .arg(format!("file://{}", page.display()))
        .output()
        .expect("`trials/programs.sh browser` installs chromium");
    let log = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!log.contains("CONSOLE"), "{log}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Clicks at places of the picture (px of the file) with one of the tools, in the only figure.
fn clicks(tool: usize, places: &[[f64; 2]]) -> String {
    format!(
        "const root = document.querySelector('.pointing');
         const select = root.querySelector('select');
         select.value = '{tool}'; select.dispatchEvent(new Event('change'));
         const image = root.querySelector('img');
         const stage = root.querySelector('.pointed');
         addEventListener('load', () => {{
           for (const [x, y] of {places:?}) {{
             const box = image.getBoundingClientRect();
             const clientX = box.left + (x + 0.5) / root.dataset.width * box.width;
             const clientY = box.top + (y + 0.5) / root.dataset.height * box.height;
             stage.dispatchEvent(new MouseEvent('click', {{ clientX, clientY, bubbles: true }}));
           }}
           document.body.dataset.told = root.querySelector('code').textContent;
           document.body.dataset.shown = root.innerText;
           document.body.dataset.scale = root.dataset.width / image.getBoundingClientRect().width;
         }});"
    )
}

/// What the page tells behind the clicks.
fn told(dom: &str, key: &str) -> String {
    let (_, rest) = dom.split_once(&format!("data-{key}=\"")).unwrap();
    rest.split_once('"').unwrap().0.replace("&quot;", "\"")
}

/// Places that a user points at with a tool, and the flag of the command that they give.
struct Pointing {
    /// Number of the tool on the page.
    tool: usize,
    places: Vec<[f64; 2]>,
    flag: &'static str,
    numbers: Vec<f64>,
}

/// Four places on a circle about (800.5, 600.25) of radius 321.5.
fn places_on_a_rim() -> Vec<[f64; 2]> {
    [0.2_f64, 1.0, 2.5, 4.0]
        .iter()
        .map(|turn| [800.5 + 321.5 * turn.cos(), 600.25 + 321.5 * turn.sin()])
        .collect()
}

/// A use of each tool that gives a flag.
fn pointings() -> [Pointing; 5] {
    let marks = [[100.0, 50.0], [120.0, 450.0]];
    let surface = [
        [600.0, 500.0],
        [700.0, 560.0],
        [800.0, 610.0],
        [900.0, 650.0],
        [1000.0, 720.0],
    ];
    let square = [
        [900.0, 820.0],
        [110.0, 130.0],
        [880.0, 100.0],
        [90.0, 800.0],
    ];
    let in_order = [square[1], square[2], square[0], square[3]];
    let of = |tool, places: &[[f64; 2]], flag, numbers: &[f64]| Pointing {
        tool,
        places: places.to_vec(),
        flag,
        numbers: numbers.to_vec(),
    };
    [
        of(0, &places_on_a_rim(), "--drum", &[800.5, 600.25, 321.5]),
        of(1, &surface, "--surface", &surface.concat()),
        of(2, &marks, "--region", &[100.0, 50.0, 20.0, 400.0]),
        of(3, &marks, "--plumb-line", &marks.concat()),
        of(5, &square, "--corners", &in_order.concat()),
    ]
}

/// Asserts that the page, in a window of so many pixels, gives the flag to a pixel of the screen both ways, to which browsers
/// round the place of a click, and that the command takes it.
fn assert_gives_flag(page: &Path, pointing: &Pointing, width: u32) {
    let dom = seen(page, &clicks(pointing.tool, &pointing.places), width);
    let given = told(&dom, "told");
    let scale: f64 = told(&dom, "scale").parse().expect("a number");
    let (name, value) = given.split_once(' ').expect("a flag with its value");
    assert_eq!(name, pointing.flag, "{given}");
    let shown = told(&dom, "shown");
    assert!(!shown.contains('{'), "data are not text: {shown}");
    let value = value.trim_matches('\'');
    let numbers = value
        .split([',', ';'])
        .map(|n| n.parse().expect("a number"));
    let numbers: Vec<f64> = numbers.collect();
    assert_eq!(numbers.len(), pointing.numbers.len(), "{given}");
    for (found, expected) in numbers.iter().zip(&pointing.numbers) {
        let off = (found - expected).abs();
        assert!(
            off < 2.0_f64.sqrt() * scale + 0.1,
            "{width}: {given}, {scale}"
        );
    }
    let output = run(&[photo(REFUSED).to_str().expect("a path"), name, value]);
    assert!(output.status.code() < Some(2), "{given}");
}

/// Each tool of the page gives its flag, in a wide window and on a phone. Too few places give none.
#[test]
#[ignore = "needs Chromium: trials/programs.sh browser"]
fn pointing_at_places_gives_the_flags() {
    let folder = folder("pointing");
    let page = folder.join("page.html");
    let output = run(&[
        photo(REFUSED).to_str().unwrap(),
        "--html",
        page.to_str().unwrap(),
    ]);
    assert_eq!(output.status.code(), Some(1));
    for width in [1200, 390] {
        for pointing in pointings() {
            assert_gives_flag(&page, &pointing, width);
        }
    }
    let two = &places_on_a_rim()[..2];
    let missing = told(&seen(&page, &clicks(0, two), 1200), "told");
    assert_eq!(missing, "", "two places tell no circle");
    let picture = format!("--screenshot={}", folder.join("page.png").display());
    chromium(&[&picture], &page, 1200);
}
