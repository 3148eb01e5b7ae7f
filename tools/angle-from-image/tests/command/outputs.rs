//! Tables, pages, overlays and help.

use super::{GOOD, REFUSED, folder, photo, run, table_of, text};
use image::codecs::jpeg::JpegDecoder;
use serde_json::Value;

/// The table of the same pictures as CSV and as workbook holds the same fields; a name that is not a table of ours is CSV.
#[test]
fn the_table_may_be_a_workbook() {
    let folder = folder("workbook");
    let (good, refused) = (photo(GOOD), photo(REFUSED));
    let tables = ["angles.csv", "angles.xlsx"].map(|name| {
        let file = folder.join(name);
        let output = run(&[
            good.to_str().unwrap(),
            refused.to_str().unwrap(),
            "--csv",
            file.to_str().unwrap(),
        ]);
        assert_eq!(output.status.code(), Some(1), "one is refused");
        command_line::table_file::read(&file).unwrap()
    });
    assert!(
        std::fs::read(folder.join("angles.xlsx"))
            .unwrap()
            .starts_with(b"PK")
    );
    assert_eq!(tables[0].header(), tables[1].header());
    for (row, expected) in tables[1].rows().iter().zip(tables[0].rows()) {
        for (column, name) in tables[0].header().iter().enumerate() {
            let (found, expected) = (row.text(column), expected.text(column));
            let alike = found == expected || found.parse::<f64>() == expected.parse::<f64>();
            assert!(alike, "{name}: {found} is not {expected}");
        }
    }
}

/// The completion and the man page know the flags, and the example of the help is understood: the folder that it names is
/// missing, but no word of it is wrong.
#[test]
fn completion_man_page_and_example_fit_the_flags() {
    for kind in [
        "complete-bash",
        "complete-zsh",
        "complete-fish",
        "complete-powershell",
        "man",
    ] {
        let output = run(&["--generate", kind]);
        assert_eq!(output.status.code(), Some(0), "{kind}");
        assert!(text(&output.stdout).contains("overlay"), "{kind}");
    }
    let help = text(&run(&["--help"]).stdout);
    let (_, example) = help.split_once("Example:\n  angle-from-image ").unwrap();
    let words: Vec<&str> = example.trim().split(' ').collect();
    let output = run(&words);
    let told = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{told}");
    assert!(
        told.contains("frames") && !told.contains("Usage:"),
        "{told}"
    );
}

#[test]
fn an_overlay_is_written_once_and_replaced_only_by_force() {
    let good = photo(GOOD);
    let out = folder("overlay").join("out.png");
    let arguments = [
        good.to_str().unwrap(),
        "--overlay",
        out.to_str().unwrap(),
        "--quiet",
    ];
    assert_eq!(run(&arguments).status.code(), Some(0));
    let drawn = photo_profile::read_photo(&out).unwrap().to_rgb8();
    assert_eq!(drawn.dimensions(), (406, 406));
    let green = drawn.pixels().filter(|p| p.0 == [0, 200, 60]).count();
    assert!(green > 300, "{green} green pixels of the surface");
    assert_eq!(
        run(&arguments).status.code(),
        Some(2),
        "not without --force"
    );
    let forced: Vec<&str> = arguments.iter().copied().chain(["--force"]).collect();
    assert_eq!(run(&forced).status.code(), Some(0));
}

/// A measured, a refused and an unread picture at 4 a second: a row each, times of 0, 0.25 and 0.5 s, the numbers of the JSON
/// to the bit and reasons in words. A heap has columns of its own.
#[test]
fn a_table_has_a_row_for_every_picture() {
    let folder = folder("table");
    std::fs::copy(photo(GOOD), folder.join("a.bmp")).unwrap();
    std::fs::copy(photo(REFUSED), folder.join("b.jpg")).unwrap();
    std::fs::write(folder.join("c.png"), "no picture").unwrap();
    let table = folder.join("angles.csv");
    let words = [folder.to_str().unwrap(), "--fps", "4", "--json", "--csv"];
    let output = run(&[&words[..], &[table.to_str().unwrap()]].concat());
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    let rows = table_of(&table);
    assert_eq!(rows.len(), 3);
    for (k, (verdict, reason)) in [("ok", ""), ("refused", "no drum"), ("error", "decode")]
        .into_iter()
        .enumerate()
    {
        let (row, image) = (&rows[k], &json["images"][k]);
        assert_eq!(row["verdict"], verdict);
        assert!(row["reason"].contains(reason), "{row:?}");
        assert_eq!(row["time_s"].parse::<f64>().unwrap(), k as f64 * 0.25);
        assert_eq!(image["time_s"].as_f64(), Some(k as f64 * 0.25));
        for (column, key) in [
            ("angle_deg", "angle_deg"),
            ("standard_error_deg", "angle_se_deg"),
        ] {
            assert_eq!(row[column].parse().ok(), image[key].as_f64(), "{column}");
        }
    }
    let heap = folder.join("heap.png");
    let scene = dev_support::drawn_pictures::HeapScene::default();
    dev_support::drawn_pictures::save(scene.draw(), &heap).unwrap();
    let heaps = folder.join("heaps.csv");
    let words = [heap.to_str().unwrap(), "--mode", "heap", "--json", "--csv"];
    let output = run(&[&words[..], &[heaps.to_str().unwrap()]].concat());
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    let rows = table_of(&heaps);
    assert_eq!(
        rows[0]["left_deg"].parse().ok(),
        json["heap"]["left_deg"].as_f64()
    );
    assert!(!rows[0].contains_key("chord_deg") && !rows[0].contains_key("time_s"));
    let onto = run(&[
        heap.to_str().unwrap(),
        "--force",
        "--csv",
        heap.to_str().unwrap(),
    ]);
    assert_eq!(onto.status.code(), Some(2), "a picture is not replaced");
    assert!(text(&onto.stderr).contains("is read by this command"));
}

/// A page of a measured, a refused and an unread file, whose names are markup: everything is in the page, nothing is markup
/// but the page's own, each picture that was read shows the blue circle that was found (2 px round the drum, blurred by
/// JPEG), and a refused one says how to continue before it says why.
#[test]
fn a_page_shows_every_picture_and_how_to_go_on() {
    use base64::Engine as _;
    let folder = folder("page");
    let names = ["a<img src=x onerror=y>&\".bmp", "b.jpg", "c.png"];
    std::fs::copy(photo(GOOD), folder.join(names[0])).unwrap();
    std::fs::copy(photo(REFUSED), folder.join(names[1])).unwrap();
    std::fs::write(folder.join(names[2]), "no picture").unwrap();
    let page = folder.join("page.html");
    let output = run(&[
        folder.to_str().unwrap(),
        "--quiet",
        "--html",
        page.to_str().unwrap(),
    ]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    let page = std::fs::read_to_string(&page).unwrap();
    assert!(page.contains("http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'"));
    for outside in ["http:", "https:", "url(", "<img src=x", "<link"] {
        let own = page.replace("http://www.w3.org/2000/svg", "");
        assert!(!own.contains(outside), "{outside}");
    }
    assert!(page.contains("a&lt;img src=x onerror=y&gt;&amp;"));
    assert!(page.contains("1 measured, 1 refused, 1 not read."));
    let place = |words: &str| {
        page.find(words)
            .unwrap_or_else(|| panic!("{words} is missing"))
    };
    assert!(
        place("How to continue") < place("<pre>--drum ")
            && place("<pre>--drum ") < place("Refused: no drum")
    );
    assert!(place("Not read: cannot decode") < place("</span> Measured pictures"));
    let pictures: Vec<&str> = page.split("data:image/jpeg;base64,").skip(1).collect();
    assert_eq!(pictures.len(), 2);
    for picture in pictures {
        let data = picture.split('"').next().unwrap();
        let bytes = base64::engine::general_purpose::STANDARD
            .decode(data)
            .unwrap();
        let drawn = JpegDecoder::new(std::io::Cursor::new(&bytes)).unwrap();
        let drawn = image::DynamicImage::from_decoder(drawn).unwrap().to_rgb8();
        let is_blue = |p: &&image::Rgb<u8>| p.0[2] > 180 && p.0[0] < 120 && p.0[1] < 170;
        let blue = drawn.pixels().filter(is_blue).count();
        assert!(blue > 500, "{blue} blue pixels of the circle");
        assert!(drawn.width().max(drawn.height()) <= 800);
    }
}
