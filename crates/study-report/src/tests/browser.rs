//! The page in a real browser: slow, and only where Chromium is installed (`trials/programs.sh browser`).

use super::explorer::POINTS;
use crate::test_input::Example;
use crate::test_study::study;
use crate::write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What the browser gave.
struct Seen {
    /// Standard output.
    text: String,
    /// What was logged of the console of the page.
    console: Vec<String>,
}

/// Runs Chromium without a window until it ends by itself.
fn chromium(arguments: &[&str]) -> Seen {
    let profile = tempfile::tempdir().unwrap();
    let output = Command::new("chromium")
        .args([
            "--headless=new",
            "--no-sandbox",
            "--enable-unsafe-swiftshader",
        ])
        .args(["--enable-logging=stderr", "--window-size=1200,900"])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .args(arguments)
        .output()
        .unwrap_or_else(|e| panic!("chromium: {e}; `trials/programs.sh browser` installs it"));
    let log = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{log}");
    Seen {
        text: String::from_utf8_lossy(&output.stdout).into_owned(),
        console: log
            .lines()
            .filter(|line| line.contains("CONSOLE"))
            .map(String::from)
            .collect(),
    }
}

/// The page of a study in the folder of the results of this test, which stays for people to look at.
fn written(study: &Example) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../out/browser-test");
    std::fs::create_dir_all(&root).unwrap();
    let folder = root.canonicalize().unwrap();
    write(&folder, &study.input()).unwrap();
    folder
}

/// A page in the folder with a script of the test behind its own, which its policy would refuse.
fn page_with(folder: &Path, name: &str, script: &str) -> String {
    let page = std::fs::read_to_string(folder.join("report.html")).unwrap();
    let (before, policy) = page.split_once("script-src").unwrap();
    let (_, after) = policy.split_once('"').unwrap();
    let page = format!("{before}script-src 'unsafe-inline'\"{after}");
    let page = page.replace("</body>", &format!("<script>{script}</script></body>"));
    let path = folder.join(name);
    std::fs::write(&path, page).unwrap();
    format!("file://{}", path.display())
}

/// The rows of the table under the sliders as the browser shows them: the numbers of an attribute, by row.
fn attribute(page: &str, name: &str) -> Vec<Vec<f64>> {
    let begin = format!("{name}=\"");
    let parts = page.split(begin.as_str()).skip(1);
    let numbers = |text: &str| -> Vec<f64> {
        let text = text.split('"').next().unwrap();
        text.split(',').map(|x| x.parse().unwrap()).collect()
    };
    parts.map(numbers).collect()
}

/// Holds the numbers that a browser shows at a place of the sliders to those of the fits. Both sum the same terms; 1e-12
/// of the value is rounding.
fn hold(study: &Example, page: &str, point: [f64; 3]) {
    let fits = study.calibration.surfaces.iter();
    let fits: Vec<_> = fits.flat_map(|s| s.fits.values().flatten()).collect();
    let shown = ["data-mean", "data-mean95", "data-new95"].map(|name| attribute(page, name));
    assert!(
        shown.iter().all(|rows| rows.len() == fits.len()),
        "{shown:?}"
    );
    for (row, fit) in fits.iter().enumerate() {
        let own = fit.factors.iter().map(|f| {
            let j = ["F", "E", "G"].iter().position(|s| *s == f.symbol());
            point[j.unwrap()]
        });
        let told = fit.predict(&own.collect::<Vec<f64>>()).unwrap();
        let expected = [
            vec![told.mean],
            told.ci95.unwrap().to_vec(),
            told.pi95.unwrap().to_vec(),
        ];
        for (shown, expected) in shown.iter().zip(&expected) {
            for (x, y) in shown[row].iter().zip(expected) {
                assert!((x - y).abs() < 1e-12 * y.abs(), "{x} {y} at {point:?}");
            }
        }
    }
}

#[test]
#[ignore = "needs Chromium; `trials/programs.sh browser` runs it"]
fn the_page_in_a_browser() {
    let study = study();
    let folder = written(&study);
    let address = format!("file://{}", folder.join("report.html").display());
    // The page as it is: nothing is refused by its policy, nothing fails, and a place in the address moves the sliders.
    for point in POINTS {
        let [f, e, g] = point;
        let seen = chromium(&["--dump-dom", &format!("{address}#at={f},{e},{g}")]);
        assert_eq!(seen.console, Vec::<String>::new());
        hold(&study, &seen.text, point);
    }
    a_slider_moves_the_numbers(&study, &folder);
    tables_are_sorted_and_copied(&folder);
    a_bed_is_drawn_and_turned(&folder);
    the_page_loads_fast_and_fits_a_phone(&folder);
    without_scripts_the_pictures_are_there(&folder);
    let pdf = folder.join("report.pdf");
    let seen = chromium(&[
        &format!("--print-to-pdf={}", pdf.display()),
        "--no-pdf-header-footer",
        &address,
    ]);
    assert_eq!(seen.console, Vec::<String>::new());
    let bytes = std::fs::read(&pdf).unwrap();
    assert!(bytes.starts_with(b"%PDF"));
    let text = String::from_utf8_lossy(&bytes);
    let pages = text.matches("/Type /Page\n").count();
    assert!(pages >= 5, "{pages} pages of a report of many pictures");
}

/// Moves the sliders as a hand would: each gets a value and notifies the page.
fn a_slider_moves_the_numbers(study: &Example, folder: &Path) {
    let point = [0.25, 0.5, 1.75];
    let script = format!(
        "document.querySelectorAll('.sliders .range').forEach((range, j) => {{ \
         range.value = [{}, {}, {}][j]; range.dispatchEvent(new Event('input')); }});",
        point[0], point[1], point[2]
    );
    let address = page_with(folder, "moved.html", &script);
    hold(study, &chromium(&["--dump-dom", &address]).text, point);
}

/// A table of numbers is sorted rising, falling and back by clicks on its heading, what is undefined last; the copy has a
/// point and a hyphen for the machine, quotes where a field needs them, and nothing that a spreadsheet would run.
fn tables_are_sorted_and_copied(folder: &Path) {
    let script = "const box = document.querySelector('.table'); const table = box.querySelector('table'); \
        const values = ['−1.5 ± 0.2°', '–', '10', '3.2e−7', '2']; \
        const body = table.tBodies[0]; const heading = table.tHead.rows[0].cells[0]; \
        const column = () => [...body.rows].map((row) => row.cells[0].textContent).join('|'); \
        [...body.rows].forEach((row, i) => { row.cells[0].textContent = values[i]; }); \
        const told = [column()]; \
        for (let i = 0; i < 3; i += 1) { heading.click(); told.push(column()); } \
        body.rows[0].cells[1].textContent = '=A1'; body.rows[1].cells[1].textContent = 'a, \"b\"'; \
        let copied = ''; \
        Object.defineProperty(navigator, 'clipboard', { value: { writeText: async (text) => { copied = text; } } }); \
        box.querySelector('button').click(); told.push(copied.split('\\n').slice(1, 3).join('|')); \
        document.body.dataset.told = JSON.stringify(told);";
    let address = page_with(folder, "sorted.html", script);
    let seen = chromium(&["--dump-dom", &address]);
    let told = seen.text.split("data-told=\"").nth(1).unwrap();
    let told = told.split("\">").next().unwrap().replace("&quot;", "\"");
    let told: Vec<String> = serde_json::from_str(&told).unwrap();
    // The first table has four rows.
    let asked = "−1.5 ± 0.2°|–|10|3.2e−7";
    let expected = [
        asked,
        "−1.5 ± 0.2°|3.2e−7|10|–",
        "10|3.2e−7|−1.5 ± 0.2°|–",
        asked,
    ];
    assert_eq!(told[..4], expected);
    let (first, second) = told[4].split_once('|').unwrap();
    assert!(first.starts_with("-1.5 ± 0.2°,'=A1,fit,"), "{first}");
    assert!(second.starts_with("–,\"a, \"\"b\"\"\",fit,"), "{second}");
}

/// The bed of the check shows its two peas and the rims of their drum, in their colours, and other pixels once it is turned. A pea
/// of 3 mm takes some 0.2 % of a picture of a drum of 100 mm.
fn a_bed_is_drawn_and_turned(folder: &Path) {
    let script = "const box = [...document.querySelectorAll('.spheres')].find((b) => b.dataset.colours.includes(' ')); \
        const canvas = box.querySelector('canvas'); const seen = []; \
        const look = () => { const flat = document.createElement('canvas'); \
        flat.width = canvas.width; flat.height = canvas.height; \
        const context = flat.getContext('2d'); context.drawImage(canvas, 0, 0); \
        return context.getImageData(0, 0, flat.width, flat.height).data; }; \
        const turn = (key) => new Promise((done) => { canvas.dispatchEvent(new KeyboardEvent('keydown', { key })); \
        requestAnimationFrame(() => { seen.push(look()); done(); }); }); \
        (async () => { await turn('ArrowUp'); await turn('ArrowDown'); let [peas, rims, moved] = [0, 0, 0]; \
        const [a, b] = seen; \
        for (let i = 0; i < a.length; i += 4) { const [red, , blue] = [a[i], a[i + 1], a[i + 2]]; \
        if (red > 1.6 * blue) peas += 1; else if (red < 200 && Math.abs(red - blue) < 4) rims += 1; \
        if (Math.abs(red - b[i]) > 40) moved += 1; } \
        document.body.dataset.bed = [peas, rims, moved].map((n) => n / (canvas.width * canvas.height)).join(' '); })();";
    let address = page_with(folder, "bed.html", script);
    let seen = chromium(&["--dump-dom", "--virtual-time-budget=3000", &address]);
    let told = seen.text.split("data-bed=\"").nth(1).expect("a bed");
    let told = told.split('"').next().unwrap().split(' ');
    let shares: Vec<f64> = told.map(|x| x.parse().unwrap()).collect();
    assert!((1e-3..0.02).contains(&shares[0]), "peas: {shares:?}");
    assert!((5e-3..0.1).contains(&shares[1]), "rims: {shares:?}");
    assert!(shares[2] > 5e-3, "turned: {shares:?}");
}

/// The load event comes within a second, and in a frame of 390 px nothing reaches beyond its width.
fn the_page_loads_fast_and_fits_a_phone(folder: &Path) {
    let script = "addEventListener('load', () => setTimeout(() => { \
        const root = document.documentElement; \
        const loaded = performance.getEntriesByType('navigation')[0].loadEventStart; \
        parent.postMessage([root.scrollWidth, root.clientWidth, loaded], '*'); }, 50));";
    page_with(folder, "phone.html", script);
    let frame = "<!DOCTYPE html><iframe src=\"phone.html\" width=\"390\" height=\"844\"></iframe><p id=\"told\"></p>\
                 <script>addEventListener('message', (event) => { document.querySelector('#told').textContent = \
                 event.data.join(' '); });</script>";
    let path = folder.join("frame.html");
    std::fs::write(&path, frame).unwrap();
    let address = format!("file://{}", path.display());
    let seen = chromium(&["--dump-dom", "--virtual-time-budget=5000", &address]);
    let told = seen.text.split("id=\"told\">").nth(1).unwrap();
    let told: Vec<f64> = told
        .split('<')
        .next()
        .unwrap()
        .split(' ')
        .map(|x| x.parse().unwrap())
        .collect();
    // The frame has a border of 2 px inside of nothing: its page is 390 px wide, less a bar where it scrolls.
    assert!(told[1] <= 390.0 && told[1] > 360.0, "{told:?}");
    assert!(told[0] <= told[1], "scrolls sideways at 390 px: {told:?}");
    assert!(told[2] < 1000.0, "loads in {} ms", told[2]);
}

/// Where scripts are refused, the table of predictions and the pictures stand in the page, and none is hidden.
fn without_scripts_the_pictures_are_there(folder: &Path) {
    let page = std::fs::read_to_string(folder.join("report.html")).unwrap();
    let (before, policy) = page.split_once("script-src").unwrap();
    let (_, after) = policy.split_once('"').unwrap();
    let path = folder.join("still.html");
    std::fs::write(&path, format!("{before}script-src 'none'\"{after}")).unwrap();
    let seen = chromium(&["--dump-dom", &format!("file://{}", path.display())]);
    assert!(!seen.text.contains("class=\"sliders\""));
    assert!(!seen.text.contains(" hidden"));
    assert!(seen.text.matches("<figure").count() >= 8);
    assert!(seen.text.contains("<td class=\"right mean\">"));
}
